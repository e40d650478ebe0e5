#include "drive/sections.hpp"

#include "drive/read_drive.hpp"

namespace mpm::drive {
namespace {

using Type = ParameterType;

/// Components of a quantity, each a number or a formula of the stage's time.
ParameterSpec components(const std::string& name, const std::string& unit, const std::string& doc,
                         const std::vector<std::string>& names) {
  Section section{name, doc, {}};
  for (const std::string& component : names)
    section.parameters.push_back(
        parameter(component, Type::expression, unit, "Component " + component + ", of the stage's time t.").over("t"));
  return parameter(name, Type::nested, "", doc).made_of(std::move(section));
}

}  // namespace

std::vector<std::string> components_of_matrix(int dimension) {
  std::vector<std::string> names;
  for (int i = 0; i < dimension; ++i)
    for (int j = 0; j < dimension; ++j) names.push_back({"xyz"[i], "xyz"[j]});
  return names;
}

std::vector<std::string> components_of_stress(int dimension) {
  if (dimension == 2) return {"xx", "yy", "xy"};
  return {"xx", "yy", "zz", "yz", "xz", "xy"};
}

Section drive_section() {
  Section compare{"compare",
                  "what to compare the results with",
                  {parameter("expect", Type::nested, "", "a list of expectations").defined_as("expectations")}};
  return {"material point",
          "a material point along a path",
          {
              parameter("$schema", Type::string, "", "Where an editor finds the schema of this file."),
              parameter("title", Type::string, "", "One line that heads report and figures.").standard(""),
              parameter("description", Type::string, "", "What the experiment shows.").standard(""),
              parameter("dimension", Type::integer, "", "3, or 2: plane strain.").from(2).to(3).standard(3),
              parameter("constants", Type::nested, "", "an object of named numbers for expressions")
                  .defined_as("constants"),
              parameter("materials", Type::nested, "", "an object with one material").defined_as("materials").needed(),
              parameter("solver", Type::nested, "", "a solver").made_of(solver_section()).needed(),
              parameter("compare", Type::nested, "", "what to compare the results with").made_of(std::move(compare)),
          }};
}

Section solver_section() {
  return {solver_name,
          "One particle by itself, along stages of imposed deformation and stress.",
          {
              parameter("stages", Type::nested, "", "a list of stages").defined_as("stages").needed(),
              parameter("cell_size", Type::number, "m", "Cell size of a grid, for materials that read it.").above(0),
          },
          true};
}

Section stage_section(int dimension) {
  const std::vector<std::string> matrix = components_of_matrix(dimension), stress = components_of_stress(dimension);
  return {"stage",
          "a stage of a path",
          {
              parameter("name", Type::string, "", "Its name in results; default stage_ and its place."),
              parameter("duration", Type::number, "s", "How long it takes.").above(0).standard(1),
              parameter("steps", Type::integer, "", "Steps, all equally long.").from(1).to(1e6).standard(100),
              components("deformation_gradient", "",
                         "components of F at the end of each step; the others stay as they are", matrix),
              components("velocity_gradient", "1/s",
                         "components of the velocity gradient in the middle of each step; the others are zero", matrix),
              components("stress", "Pa",
                         "components of the Cauchy stress at the end of each step, in place of those of the motion",
                         stress),
          }};
}

}  // namespace mpm::drive

// The tables of what an experiment records beside the totals.
#include "experiment/records.hpp"

namespace mpm {
namespace {

using Type = ParameterType;

ParameterSpec point(std::string name, std::string doc) {
  return parameter(std::move(name), Type::vector, "m", std::move(doc)).needed();
}

ParameterSpec name_of(const std::string& what) {
  return parameter("name", Type::string, "",
                   "Unique name of the " + what + ", of letters, digits and _: its columns bear it.")
      .needed();
}

ParameterSpec body_of(std::string doc) {
  return parameter("body", Type::string, "", std::move(doc));
}

}  // namespace

std::vector<ParameterSpec> record_parameters() {
  const auto defined = [](const char* name, const char* doc, const char* definition) {
    return parameter(name, Type::nested, "", doc).defined_as(definition);
  };
  return {defined("bodies", "true, or a list of bodies: their numbers have columns of their own", "recorded_bodies"),
          defined("groups", "a list of groups of particles, whose numbers have columns of their own", "groups"),
          defined("probes", "a list of probes: values at a particle, a place, along a line, over a section", "probes"),
          parameter("contact_pairs", Type::boolean, "",
                    "Contact has columns for each pair of velocity fields, and for each rigid body its gap.")
              .standard(false),
          parameter(
              "normal_error", Type::boolean, "",
              "The pairs of contact_pairs have columns for what is known from the surfaces of the bodies: the angle of "
              "their normals to these, the gap between them, and the force before it closes.")
              .standard(false),
          parameter("contact_nodes", Type::boolean, "",
                    "Each frame shows the nodes where bodies meet, and a table beside it lists them.")
              .standard(false)};
}

Section group_section() {
  return {"group",
          "a group of particles",
          {name_of("group"), body_of("Body that the particles belong to; default: any."),
           parameter("where", Type::nested, "", "Region in which they begin.").defined_as("geometry").needed()}};
}

Section probe_section(const ReadOptions& options) {
  const ParameterSpec along =
      parameter("line", Type::nested, "", "a line, whose profiles are written to files of their own")
          .made_of({"line",
                    "a line",
                    {point("from", "Where it begins."), point("to", "Where it ends."),
                     parameter("count", Type::integer, "", "Points along it, its ends included.")
                         .from(2)
                         .to(100000)
                         .standard(101),
                     parameter("profiles", Type::integer, "", "Profiles over the run, first and last included.")
                         .from(1)
                         .to(100000)
                         .standard(2)}});
  const ParameterSpec cut =
      parameter("section", Type::nested, "", "a section through the bodies")
          .made_of({"section",
                    "a section",
                    {point("point", "A point of its plane, about which moments are taken."),
                     parameter("normal", Type::vector, "", "Any length but zero: points to what pulls.").needed()}});
  return {"probe",
          "a probe",
          {name_of("probe"),
           parameter("quantities", Type::names, "", "What is recorded there; a section may do without.")
               .of(options.colour_quantities)
               .standard(OrderedJson::array()),
           body_of("Body that is looked at; default: all."),
           parameter("nearest", Type::vector, "m", "The particle that begins nearest to this point, followed."),
           parameter("place", Type::vector, "m", "A place that does not move."), along, cut}};
}

Section column_figure_section() {
  return {"columns",
          "a figure of columns",
          {parameter("name", Type::string, "", "Name of its files, of letters, digits and _.").needed(),
           parameter("columns", Type::names, "", "Columns of metrics.csv, without their units.").needed(),
           parameter("title", Type::string, "", "Title; default: its name."),
           parameter("log_y", Type::boolean, "", "Logarithmic axis.").standard(false)},
          true};
}

}  // namespace mpm

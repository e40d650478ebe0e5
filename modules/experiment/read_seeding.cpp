// How the particles of a body are placed, and in which state they begin.
#include <algorithm>
#include <cmath>

#include "experiment/read_files.hpp"
#include "experiment/reader.hpp"
#include "support/files.hpp"

namespace mpm {

OrderedJson ExperimentReader::read_seeding(const Node* node, BodySpecification& body) {
  OrderedJson resolved;
  resolved["type"] = "fitted";
  if (!node || node->type == Node::Type::null) return resolved;
  const std::vector<Section> kinds = seeding_kinds();
  const Section* const kind = choose_kind(*node, kinds, "seeding", true, context_);
  if (!kind) return resolved;
  const Fields fields(node->type == Node::Type::object ? node : nullptr, *kind, context_);
  resolved = fields.resolved;
  resolved["type"] = kind->name;
  body.seeding.kind = static_cast<SeedingKind>(kind - kinds.data());  // in the order of the table
  if (kind->name == "partial") body.seeding.smallest_share = fields.number("smallest_share");
  if (kind->name == "blue_noise") body.seeding.relaxations = fields.integer("relaxations");
  if (kind->name == "points") {
    if (node->type != Node::Type::object)
      problem(*node, "points come from a file: {\"type\": \"points\", \"file\": \"….csv\"}");
    else
      read_points(fields, body, resolved);
  }
  return resolved;
}

void ExperimentReader::read_points(const Fields& fields, BodySpecification& body, OrderedJson& resolved) {
  const auto path = input_file(fields, context_, resolved);
  if (!path || !grid_good_ || experiment_.materials.empty()) return;
  try {
    const double density = experiment_.materials[body.material].component.parameter("density");
    body.seeding.points = std::make_shared<const std::vector<SeededPoint>>(
        read_seeded_points(*path, context_.dimension, experiment_.grid, density, body.seeding.points_have_volumes));
    const double half = experiment_.grid.cell_size / body.particles_per_cell_axis / 2;
    Vector3 lower = body.seeding.points->front().place, upper = lower;
    for (const SeededPoint& point : *body.seeding.points)
      for (int c = 0; c < 3; ++c)
        lower[c] = std::min(lower[c], point.place[c]), upper[c] = std::max(upper[c], point.place[c]);
    for (int c = 0; c < context_.dimension; ++c) {  // the box of the points, as far as the domain goes
      lower[c] = std::max(lower[c] - half, experiment_.grid.lower[c]);
      upper[c] = std::min(upper[c] + half, experiment_.grid.upper[c]);
    }
    body.geometry = make_box(context_.dimension, lower, upper);
  } catch (const std::runtime_error& error) {  // a bad row, or a disk that cannot be read
    problem(*fields.node("file"), error.what());
  } catch (const std::out_of_range&) {  // a material without density: reported already
  }
}

void ExperimentReader::read_initial_state(const Fields& fields, BodySpecification& body, OrderedJson& resolved) {
  const auto given = [&](const char* key) {
    const Node* const node = fields.node(key);
    return node && node->type != Node::Type::null;
  };
  const auto component = [&](const char* key, const Fields& tensor, const std::string& name) {
    const bool plane = context_.dimension == 2;
    const bool out = plane && name.find('z') != std::string::npos && name != "zz";
    const bool around = plane && name == "zz" && experiment_.grid.symmetry == Symmetry::plane_strain;
    if (tensor.given(name) && (out || around))
      problem(*tensor.node(name), out ? "in 2-D nothing is sheared out of the plane; remove " + in_quotes(name)
                                      : std::string("in plane strain ") +
                                            (std::string_view(key) == "initial_stress"
                                                 ? "the stress out of the plane follows from the others"
                                                 : "nothing is stretched out of the plane") +
                                            "; remove \"zz\"");
    if (out || around) resolved[key].erase(name);  // so that what is resolved can be read again
    return tensor.scalar_expression(name);
  };
  if (given("initial_displacement")) body.displacement = fields.expression("initial_displacement");
  if (given("initial_deformation_gradient")) {
    const Fields tensor = fields.nested("initial_deformation_gradient");
    resolved["initial_deformation_gradient"] = tensor.resolved;
    auto& F = body.deformation_gradient.emplace();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        F[3 * i + j] = component("initial_deformation_gradient", tensor, {"xyz"[i], "xyz"[j]});
  }
  if (!given("initial_stress")) return;
  const Fields tensor = fields.nested("initial_stress");
  resolved["initial_stress"] = tensor.resolved;
  auto& stress = body.stress.emplace();
  const char* const names[] = {"xx", "yy", "zz", "yz", "xz", "xy"};
  for (int k = 0; k < 6; ++k) stress[k] = component("initial_stress", tensor, names[k]);
  for (const char* other : {"initial_displacement", "initial_deformation_gradient"})
    if (given(other))
      problem(*fields.node("initial_stress"),
              std::string("the stress follows from ") + in_quotes(other) + "; give one of them");
}

}  // namespace mpm

// What axisymmetric scenes and frozen bodies cannot have, each refused by name.
#include <cmath>

#include "experiment/reader.hpp"

namespace mpm {
namespace {

bool starts_with(const std::string& text, const char* start) {
  return text.rfind(start, 0) == 0;
}

}  // namespace

void ExperimentReader::check_axisymmetric() {
  if (!experiment_.axisymmetric()) return;
  if (context_.dimension == 3)
    return problem(nearest_node(root_, "/grid/symmetry"),
                   "axisymmetric scenes are 2-D (x the radius, y the axis); set \"dimension\" to 2");
  check_axis();
  if (experiment_.has_gravity(0))
    problem(nearest_node(root_, "/gravity"),
            "gravity cannot pull along the radius (x) of an axisymmetric scene: " + gravity_along_axis());
  for (const MaterialSpecification& material : experiment_.materials) {
    const Plugin* const plugin = material.component.plugin;
    if (plugin && !(plugin->material().traits & MPM_STRAINS_AROUND_AXIS))
      problem(nearest_node(root_, material.component.pointer + "/type"),
              "material " + in_quotes(plugin->id()) +
                  " does not read the strain around the axis (velocity_gradient_zz), which axisymmetric scenes need");
  }
  if (experiment_.exact && experiment_.exact->type != "free_fall")
    problem(nearest_node(root_, "/compare/exact"), "exact solution " + in_quotes(experiment_.exact->type) +
                                                       " is one of plane strain, not of an axisymmetric scene");
  for (const Expectation& expectation : experiment_.expectations) {
    const std::string& metric = expectation.metric;
    const bool radial = metric.size() > 2 && metric.substr(metric.size() - 2) == ".x" &&
                        (starts_with(metric, "momentum.linear") || starts_with(metric, "centre_of_mass"));
    if (radial || starts_with(metric, "momentum.angular"))
      problem(nearest_node(root_, "/compare/expect"),
              "an axisymmetric body has no " + in_quotes(metric) +
                  ": over whole rings it is zero by symmetry and is not recorded");
  }
}

/// What to write in place of gravity along the radius.
std::string ExperimentReader::gravity_along_axis() const {
  const std::string beside =
      "; a pull along x wants a plane scene (remove /grid/symmetry) or one of \"dimension\" 3, and what "
      "spins about the axis a /body_force, [\"w^2*x\", 0]";
  if (experiment_.gravity_changes[0] || experiment_.gravity_changes[1])
    return "write [0, \"...\"], the formula as its second component, which acts along the axis (y)" + beside;
  const double axial = experiment_.gravity[1] != 0 ? experiment_.gravity[1] : experiment_.gravity[0];
  return "write [0, " + number_text(axial) + "], which acts along the axis (y)" + beside;
}

/// Checks that nothing lies at r < 0, and that nothing passes the axis.
void ExperimentReader::check_axis() {
  const GridSpecification& grid = experiment_.grid;
  const FaceCondition &inner = experiment_.faces[0][0], &outer = experiment_.faces[0][1];
  const auto face = [&](const char* name) -> const Node& {
    return nearest_node(root_, std::string("/grid/boundaries/") + name);
  };
  if (grid_good_ && grid.lower[0] < 0)
    problem(nearest_node(root_, "/grid/domain"), "an axisymmetric domain has no radius below 0, but x begins at " +
                                                     number_text(grid.lower[0]) + " m; begin at 0 or above");
  if (inner.type == ConditionType::periodic || outer.type == ConditionType::periodic)
    return problem(face(inner.type == ConditionType::periodic ? "x_min" : "x_max"),
                   "an axisymmetric scene is not periodic along its radius; y, the axis, may be");
  if (grid.lower[0] == 0 && inner.type != ConditionType::slip)
    problem(face("x_min"), "x_min is the axis r = 0, where v_r = 0 and v_z is free: its condition is \"slip\"");
}

void ExperimentReader::check_frozen() {
  for (std::size_t i = 0; i < experiment_.bodies.size(); ++i) {
    if (!experiment_.bodies[i].frozen) continue;
    const Node& place = nearest_node(root_, experiment_.bodies[i].pointer + "/frozen");
    const std::string name = "body " + in_quotes(experiment_.bodies[i].name) + " is frozen: ";
    if (experiment_.gravity != Vector3{} || experiment_.changing_gravity)
      problem(place,
              name + "gravity would do work without a way, so that no energy balance closes; remove one of them");
    if (experiment_.meets())
      problem(place, name +
                         "it neither comes near another body nor leaves it, which contact decides by; remove one of "
                         "them");
    for (const Load& load : experiment_.loads)
      if (load.type == LoadType::spring && load.body == static_cast<int>(i))
        problem(place, name + "its springs never stretch; remove one of them");
    if (experiment_.exact)
      problem(place, name + "its particles stay where exact solution " + in_quotes(experiment_.exact->type) +
                         " moves them; remove one of them");
  }
}

}  // namespace mpm

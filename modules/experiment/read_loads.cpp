// Loads: what they act on, and whether there is anything to act on.
#include <algorithm>
#include <cmath>

#include "experiment/axis_names.hpp"
#include "experiment/reader.hpp"

namespace mpm {
namespace {

LoadType load_type(const std::string& name) {
  const std::vector<Section> kinds = load_kinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const Section& kind) { return kind.name == name; });
  return static_cast<LoadType>(found - kinds.begin());
}

}  // namespace

void ExperimentReader::read_loads(const Node* node) {
  if (!node || !is_list(*node, "loads", true)) return;
  OrderedJson& resolved = resolved_["loads"] = OrderedJson::array();
  for (const Node& item : node->items) resolved.push_back(read_load(item));
}

OrderedJson ExperimentReader::read_load(const Node& node) {
  static const std::vector<Section> kinds = load_kinds();
  const Section* kind = choose_kind(node, kinds, "load", false, context_);
  if (!kind) return {};
  const Fields fields(&node, *kind, context_);
  OrderedJson resolved = fields.resolved;
  Load load;
  load.type = load_type(kind->name);
  load.pointer = node.pointer;
  const bool body = find_loaded_body(fields, load);
  bool good = body;
  if (load.on_surface()) {
    load.where = fields.node("where") ? read_geometry(*fields.node("where"), context_, resolved["where"]) : nullptr;
    good = good && load.where;
  }
  switch (load.type) {
    case LoadType::traction:
      load.value = fields.expression("traction");
      break;
    case LoadType::pressure:
      load.value = fields.expression("pressure");
      load.follower = fields.boolean("follower");
      break;
    case LoadType::force:
      load.value = fields.expression("force");
      load.from = load.to = fields.vector("at");
      break;
    case LoadType::line_force:
      load.value = fields.expression("force");
      load.from = fields.vector("from"), load.to = fields.vector("to");
      if (fields.valid("from") && fields.valid("to") && load.from == load.to)
        problem(fields.place("to"), "the line has no length; a load at a point is of type \"force\"");
      break;
    case LoadType::body_force:
      load.value = fields.expression("acceleration");
      break;
    case LoadType::spring:
      read_spring(fields, node, load);
      break;
  }
  if (body && load.at_points()) good = may_be_loaded_at_points(load, fields) && good;
  if (good && grid_good_ && load.on_surface()) check_loaded_surface(load, *fields.node("where"));
  if (good && grid_good_ && load.gives(ExternalForce::point_load)) check_loaded_points(load, fields);
  if (experiment_.axisymmetric() && load.type == LoadType::force && load.from[0] == 0 && fields.valid("at") &&
      fields.valid("force") && (!load.value.is_constant() || load.value({}, {}, 0)[0] != 0))
    problem(fields.place("force"), "a force on the axis has no radial component");
  if (good) experiment_.loads.push_back(std::move(load));
  return resolved;
}

bool ExperimentReader::find_loaded_body(const Fields& fields, Load& load) {
  if (!fields.valid("body")) return false;
  std::vector<std::string> names;
  for (const BodySpecification& body : experiment_.bodies) names.push_back(body.name);
  const std::string& name = fields.text("body");
  const auto found = std::find(names.begin(), names.end(), name);
  load.body = static_cast<int>(found - names.begin());
  if (found != names.end()) return experiment_.bodies[load.body].geometry != nullptr;
  const std::string list = "bodies: " + (names.empty() ? "none" : quoted_list(names));
  problem(fields.place("body"), "there is no body " + in_quotes(name) + suggestion(name, names, list));
  return false;
}

bool ExperimentReader::may_be_loaded_at_points(const Load& load, const Fields& fields) {
  const BodySpecification& body = experiment_.bodies[load.body];
  std::string reason;
  if (body.seeding.kind == SeedingKind::points && load.on_surface())
    reason = "has particles out of a file, and nobody knows where its boundary is";
  else if (body.deformed())
    reason = "begins displaced, deformed or stressed, and loads are placed on bodies as they are drawn";
  if (reason.empty()) return true;
  problem(fields.place("body"), "body " + in_quotes(body.name) + " " + reason +
                                    "; take a load of type \"body_force\", or a body that begins as it is drawn");
  return false;
}

void ExperimentReader::read_spring(const Fields& fields, const Node& node, Load& load) {
  const Vector3 &stiffness = fields.vector("stiffness"), &damping = fields.vector("damping");
  bool any = false;
  for (int axis = 0; axis < context_.dimension; ++axis) {
    for (const char* key : {"stiffness", "damping"})
      if (fields.valid(key) && fields.vector(key)[axis] < 0)
        problem(fields.place(key), std::string("expected at least 0 along ") + axis_names[axis] + ", got " +
                                       number_text(fields.vector(key)[axis]));
    load.stiffness[axis] = stiffness[axis], load.damping[axis] = damping[axis];
    any = any || stiffness[axis] != 0 || damping[axis] != 0;
    if (stiffness[axis] != 0 && experiment_.faces[axis][0].type == ConditionType::periodic)
      problem(fields.place("stiffness"), std::string("a spring cannot pull along the periodic axis ") +
                                             axis_names[axis] +
                                             ": a point that comes in again at the other side has no displacement");
  }
  if (!any && fields.valid("stiffness") && fields.valid("damping"))
    problem(node, "does nothing: give \"stiffness\" or \"damping\"");
}

/// Checks that points of a line, ends included, lie in the body; on its surface to a small part of a particle's spacing.
void ExperimentReader::check_loaded_points(const Load& load, const Fields& fields) {
  constexpr int points = 16;
  const BodySpecification& body = experiment_.bodies[load.body];
  const double beside = 1e-6 * experiment_.grid.cell_size;
  const auto holds = [&](const Vector3& point) {
    bool inside = body.geometry->contains(point);
    for (int corner = 0; corner < 8 && !inside; ++corner) {
      Vector3 near = point;
      for (int axis = 0; axis < context_.dimension; ++axis) near[axis] += (corner >> axis & 1 ? 1 : -1) * beside;
      inside = body.geometry->contains(near);
    }
    return inside;
  };
  for (int k = 0; k <= points; ++k) {
    Vector3 point{};
    for (int axis = 0; axis < context_.dimension; ++axis)
      point[axis] = load.from[axis] + (load.to[axis] - load.from[axis]) * k / points;
    if (holds(point)) continue;
    std::string text = number_text(point[0]);
    for (int axis = 1; axis < context_.dimension; ++axis) text += ", " + number_text(point[axis]);
    return problem(
        fields.place(load.type == LoadType::force ? "at"
                     : k < points                 ? "from"
                                                  : "to"),
        "the point (" + text + ") is not in body " + in_quotes(body.name) + ", which would have to carry the load");
  }
}

/// Looks for the surface with pieces half a particle's spacing long, which is finer than a region has to be to be loaded.
void ExperimentReader::check_loaded_surface(const Load& load, const Node& where) {
  const BodySpecification& body = experiment_.bodies[load.body];
  const GridSpecification& grid = experiment_.grid;
  const double spacing = grid.cell_size / std::max(1, body.particles_per_cell_axis);
  const Surface loaded = loaded_surface(load, *body.geometry, {grid.lower, grid.upper}, spacing / 2);
  const auto on_axis = [&](const SurfacePiece& piece) { return piece.point[0] < 1e-9 * spacing; };
  if (experiment_.axisymmetric() && !loaded.empty() && std::all_of(loaded.begin(), loaded.end(), on_axis))
    return problem(
        where, "of the surface of body " + in_quotes(body.name) +
                   " this region holds the axis alone, where rings have no area, so that the load has nothing to act "
                   "on; take a region that holds surface at x > 0, or a load of type \"force\" along the axis");
  if (!loaded.empty()) return;
  problem(where, "none of the surface of body " + in_quotes(body.name) +
                     " lies in this region, so that the load has nothing to act on; a region that holds a face may "
                     "end on it, e.g. {\"type\": \"half_space\", \"point\": a point of the face, \"normal\": into the "
                     "body}");
}

}  // namespace mpm

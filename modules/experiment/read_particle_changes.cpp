// Emitters, sinks and changes of material: whom they act on, and which scenes they cannot act in.
#include <algorithm>
#include <cmath>

#include "experiment/places.hpp"
#include "experiment/reader.hpp"

namespace mpm {
namespace {

/// The names of a list of objects under a key, where they are texts.
std::vector<std::string> texts_under(const Node* list, const char* key) {
  std::vector<std::string> texts;
  if (!list || list->type != Node::Type::array) return texts;
  for (const Node& item : list->items)
    if (const Node* text = item.type == Node::Type::object ? item.find(key) : nullptr;
        text && text->type == Node::Type::string)
      texts.push_back(text->text);
  return texts;
}

std::string name_of(const Fields& fields, const char* kind, std::size_t place) {
  return fields.given("name") && fields.valid("name") ? fields.text("name") : kind + std::to_string(place);
}

double length_of(const Vector3& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

}  // namespace

/// Whether an emitter or another body gives this one particles, so that it needs none at the start.
bool ExperimentReader::may_start_empty(const std::string& body) const {
  std::vector<std::string> names = texts_under(root_.find("emitters"), "body");
  if (const Node* bodies = root_.find("bodies"); bodies && bodies->type == Node::Type::array)
    for (const Node& item : bodies->items)
      if (const Node* becomes = item.type == Node::Type::object ? item.find("becomes") : nullptr;
          becomes && becomes->type == Node::Type::object)
        if (const Node* to = becomes->find("body"); to && to->type == Node::Type::string) names.push_back(to->text);
  return std::find(names.begin(), names.end(), body) != names.end();
}

void ExperimentReader::read_emitters(const Node* node) {
  if (!node || !is_list(*node, "emitters", true)) return;
  OrderedJson& resolved = resolved_["emitters"] = OrderedJson::array();
  for (const Node& item : node->items) resolved.push_back(read_emitter(item));
}

/// The body that an emitter or a sink names; -1 with a problem recorded. A rigid body has no particles.
int ExperimentReader::changed_body(const Fields& fields) {
  if (!fields.valid("body")) return -1;
  for (const RigidBodySpecification& rigid : experiment_.rigid_bodies)
    if (rigid.name == fields.text("body"))
      return problem(fields.place("body"),
                     in_quotes(rigid.name) + " is a rigid body, which has no particles; name a body out of bodies"),
             -1;
  return body_index(fields);
}

OrderedJson ExperimentReader::read_emitter(const Node& node) {
  const Fields fields(&node, emitter_section(), context_);
  OrderedJson resolved = fields.resolved;
  Emitter emitter;
  emitter.pointer = node.pointer;
  emitter.name = name_of(fields, "emitter_", experiment_.emitters.size());
  emitter.body = changed_body(fields);
  emitter.velocity = fields.vector("velocity");
  emitter.from = fields.number("from");
  emitter.until = fields.given("until") ? fields.number("until") : std::numeric_limits<double>::infinity();
  emitter.max_particles = static_cast<long>(fields.number("max_particles"));
  if (const Node* geometry = fields.node("geometry"))
    emitter.geometry = read_geometry(*geometry, context_, resolved["geometry"]);
  if (fields.valid("from") && fields.valid("until") && emitter.until <= emitter.from)
    problem(fields.place("until"), "the emitter ends at " + number_text(emitter.until) + " s, before it begins at " +
                                       number_text(emitter.from) + " s");
  if (!fields.valid("velocity") || !emitter.geometry || emitter.body < 0) return resolved;
  if (length_of(emitter.velocity) == 0) {
    problem(fields.place("velocity"),
            "the velocity is zero: nothing would flow, and the region would never be filled again; give a velocity, or "
            "a body that lies there at the start");
    return resolved;
  }
  if (experiment_.axisymmetric() && emitter.velocity[0] != 0)
    problem(fields.place("velocity"),
            "in an axisymmetric scene particles that are emitted along the radius (x) would lie on rings of other "
            "lengths than those that were filled; emit along the axis, [0, ...]");
  place_emitter(fields, emitter);
  if (grid_good_ && emitter.period > 0) experiment_.emitters.push_back(std::move(emitter));
  return resolved;
}

/// Finds how long the region is along the flow, and refuses regions that cannot be filled.
void ExperimentReader::place_emitter(const Fields& fields, Emitter& emitter) {
  const Node& place = *fields.node("geometry");
  const GridSpecification& grid = experiment_.grid;
  const BodySpecification& body = experiment_.bodies[static_cast<std::size_t>(emitter.body)];
  Vector3 direction = emitter.velocity;
  for (double& component : direction) component /= length_of(emitter.velocity);
  const auto [first, last] = emitter.geometry->extent(direction);
  if (!std::isfinite(first) || !std::isfinite(last))
    return problem(place,
                   "the region has no end along the velocity, so that nobody knows when it has to be filled "
                   "again; take a box, or an intersection with one");
  if (!grid_good_) return;
  const auto [lower, upper] = emitter.geometry->bounds();
  for (int axis = 0; axis < context_.dimension; ++axis) {
    const std::string name(1, "xyz"[axis]);
    const double slack = 1e-9 * (grid.upper[axis] - grid.lower[axis]);
    if (lower[axis] < grid.lower[axis] - slack || upper[axis] > grid.upper[axis] + slack)
      return problem(place, "the emitter reaches outside the domain: " + name + " from " + number_text(lower[axis]) +
                                " to " + number_text(upper[axis]) + " m, where the domain spans " +
                                number_text(grid.lower[axis]) + " to " + number_text(grid.upper[axis]) + " m");
    // Batches stand up to a step's way in front of the region.
    const double v = emitter.velocity[axis];
    const double room = v > 0 ? grid.upper[axis] - upper[axis] : lower[axis] - grid.lower[axis];
    const bool periodic = experiment_.faces[static_cast<std::size_t>(axis)][0].type == ConditionType::periodic;
    if (v != 0 && !periodic && room < grid.cell_size * (1 - 1e-9))
      return problem(place, "the emitter flows out of the domain along " + name + ": leave a cell of " +
                                number_text(grid.cell_size) + " m in front of it, or turn its velocity");
    if (v != 0 && periodic && room < grid.cell_size * (1 - 1e-9))
      return problem(place, "the emitter flows over the periodic end of the domain along " + name +
                                ": leave a cell of " + number_text(grid.cell_size) + " m in front of it");
  }
  BodySpecification filled = body;
  filled.geometry = emitter.geometry;
  if (body.seeding.kind != SeedingKind::points && !holds_a_particle(filled))
    return problem(place, "no particle lies in the emitter: it is empty, or thinner than the particle spacing of " +
                              number_text(grid.cell_size / body.particles_per_cell_axis) + " m");
  emitter.period = (last - first) / length_of(emitter.velocity);
}

void ExperimentReader::read_sinks(const Node* node) {
  if (!node || !is_list(*node, "sinks", true)) return;
  OrderedJson& resolved = resolved_["sinks"] = OrderedJson::array();
  for (const Node& item : node->items) resolved.push_back(read_sink(item));
}

OrderedJson ExperimentReader::read_sink(const Node& node) {
  const Fields fields(&node, sink_section(), context_);
  OrderedJson resolved = fields.resolved;
  Sink sink;
  sink.pointer = node.pointer;
  sink.name = name_of(fields, "sink_", experiment_.sinks.size());
  bool good = true;
  if (fields.given("body")) sink.body = changed_body(fields), good = sink.body >= 0;
  sink.from = fields.number("from");
  if (fields.given("until")) sink.until = fields.number("until");
  sink.every_steps = static_cast<long>(fields.number("every_steps"));
  if (const Node* geometry = fields.node("geometry"))
    sink.geometry = read_geometry(*geometry, context_, resolved["geometry"]);
  if (fields.valid("from") && fields.valid("until") && sink.until <= sink.from)
    problem(fields.place("until"),
            "the sink ends at " + number_text(sink.until) + " s, before it begins at " + number_text(sink.from) + " s");
  if (good && sink.geometry && sink.every_steps > 0) experiment_.sinks.push_back(std::move(sink));
  return resolved;
}

void ExperimentReader::read_becoming(const Fields& fields, BodySpecification& body, OrderedJson& resolved) {
  becoming_.emplace_back();
  const Node* const node = fields.node("becomes");
  if (!node || node->type == Node::Type::null) return;
  const Fields becomes = fields.nested("becomes");
  resolved["becomes"] = becomes.resolved;
  const Fields when = becomes.nested("when");
  resolved["becomes"]["when"] = when.resolved;
  Becoming becoming;
  becoming.pointer = node->pointer;
  becoming.quantity = when.text("quantity");
  becoming.every_steps = static_cast<long>(becomes.number("every_steps"));
  if (when.given("above")) becoming.above = when.number("above");
  if (when.given("below")) becoming.below = when.number("below");
  const Node* const condition = becomes.node("when");
  if (condition && condition->type != Node::Type::object)
    problem(*condition, "expected an object such as {\"quantity\": \"speed\", \"above\": 1}");
  else if (condition && !becoming.above && !becoming.below)
    problem(*condition, "the condition has no bound: give \"above\" or \"below\"");
  if (becoming.above && becoming.below && *becoming.below > *becoming.above)
    problem(*becomes.node("when"), "every value is above " + number_text(*becoming.above) + " or below " +
                                       number_text(*becoming.below) + ": all particles would go over at once");
  const std::vector<std::string>& known = options_.colour_quantities;
  if (when.valid("quantity") && !known.empty() &&
      std::find(known.begin(), known.end(), becoming.quantity) == known.end())
    problem(when.place("quantity"), "there is no quantity " + in_quotes(becoming.quantity) +
                                        suggestion(becoming.quantity, known, "quantities are those of colour_by"));
  if (!becomes.valid("body") || !becomes.valid("every_steps") || !when.valid("quantity")) return;
  becoming_.back() = becomes.text("body");
  body.becomes = std::move(becoming);
}

/// Finds the bodies that particles go over to, which may stand behind those that they come from.
void ExperimentReader::find_becoming_bodies() {
  std::vector<std::string> names;
  for (const BodySpecification& body : experiment_.bodies) names.push_back(body.name);
  for (std::size_t k = 0; k < experiment_.bodies.size(); ++k) {
    BodySpecification& body = experiment_.bodies[k];
    if (!body.becomes) continue;
    const Node& place = nearest_node(root_, body.becomes->pointer + "/body");
    const auto found = std::find(names.begin(), names.end(), becoming_[k]);
    if (found == names.end())
      problem(place, "there is no body " + in_quotes(becoming_[k]) +
                         suggestion(becoming_[k], names, "bodies: " + quoted_list(names)));
    else if (static_cast<std::size_t>(found - names.begin()) == k)
      problem(place, "the body's particles would become what they are; name another body");
    if (found == names.end() || static_cast<std::size_t>(found - names.begin()) == k) {
      body.becomes.reset();
      continue;
    }
    body.becomes->body = static_cast<int>(found - names.begin());
    check_becoming(k);
  }
}

/// Checks that a particle can be one of the other body with its mass and its volume.
void ExperimentReader::check_becoming(std::size_t number) {
  const BodySpecification& body = experiment_.bodies[number];
  const BodySpecification& other = experiment_.bodies[static_cast<std::size_t>(body.becomes->body)];
  const Node& place = nearest_node(root_, body.becomes->pointer + "/body");
  if (body.particles_per_cell_axis != other.particles_per_cell_axis)
    problem(place, "bodies " + in_quotes(body.name) + " and " + in_quotes(other.name) +
                       " have different particles_per_cell_axis, and a particle keeps its size; give both the same");
  if (other.deformed())
    problem(place,
            "body " + in_quotes(other.name) +
                " begins displaced, deformed or stressed, and what goes over to it does not; remove one of them");
  const Component* const from = &experiment_.materials[static_cast<std::size_t>(body.material)].component;
  const Component* const to = &experiment_.materials[static_cast<std::size_t>(other.material)].component;
  if (!from->plugin || !to->plugin) return;
  try {
    const double before = from->parameter("density"), after = to->parameter("density");
    if (before != after)
      problem(place, "a particle keeps its mass and its volume, and so its density, but the materials of " +
                         in_quotes(body.name) + " and " + in_quotes(other.name) + " have " + number_text(before) +
                         " and " + number_text(after) + " kg/m^3; give both the same");
  } catch (const std::out_of_range&) {  // a material without density: reported already
  }
}

/// Refuses what counts on particles that stay: each by name and with the reason.
void ExperimentReader::check_particle_changes() {
  if (experiment_.changer_of_particles().empty()) return;
  bool any_at_start = false;
  for (int body = 0; body < static_cast<int>(experiment_.bodies.size()); ++body) {
    BodySpecification& specification = experiment_.bodies[static_cast<std::size_t>(body)];
    specification.takes_particles_in = experiment_.gains_particles(body);
    any_at_start = any_at_start || !specification.starts_empty;
    if (!experiment_.changer_of_particles(body).empty()) refuse_with_changes(body, specification.name);
  }
  for (const Emitter& emitter : experiment_.emitters) any_at_start = any_at_start || emitter.batches_until(0) > 0;
  const Node* const emitters = root_.find("emitters");
  const bool all_read = !emitters || emitters->items.size() == experiment_.emitters.size();
  if (!any_at_start && all_read)
    problem(nearest_node(root_, "/bodies"),
            "the scene begins without a particle; let an emitter begin \"from\" 0, or give a body a geometry");
  const std::string gone = " are those of a step, and " + experiment_.changer_of_particles() +
                           " may change the particles after it, when nobody has looked yet; ";
  if (experiment_.output.contact_nodes)
    problem(nearest_node(root_, "/output/contact_nodes"), "the nodes of contact" + gone + "remove one of them");
  if (experiment_.output.normal_error)
    problem(nearest_node(root_, "/output/normal_error"), "the normals of contact" + gone + "remove one of them");
  if (experiment_.particle_output && experiment_.particle_output->asks("contact_traction"))
    problem(nearest_node(root_, "/output/particles"),
            "tractions of contact" + gone + "name \"fields\" without contact_traction");
  if (experiment_.exact)
    problem(nearest_node(root_, "/compare/exact"), "exact solutions follow each particle from the start, and " +
                                                       experiment_.changer_of_particles() +
                                                       " changes which there are; remove one of them");
}

/// Refuses what acts on, or asks for, particles of a body by their number or by where they were at the start.
void ExperimentReader::refuse_with_changes(int body, const std::string& name) {
  const BodySpecification& specification = experiment_.bodies[static_cast<std::size_t>(body)];
  const std::string changer = experiment_.changer_of_particles(body);
  const std::string why = "the particles of body " + in_quotes(name) + " do not stay the same (" + changer + "); ";
  if (specification.frozen)
    problem(nearest_node(root_, specification.pointer + "/frozen"),
            why + "a frozen body keeps its particles where they are; remove one of them");
  if (experiment_.gains_particles(body) && specification.seeding.kind == SeedingKind::points)
    problem(nearest_node(root_, specification.pointer + "/seeding"),
            why + "points of a file say nothing of how to fill a region; take another seeding");
  const bool emitted = std::any_of(experiment_.emitters.begin(), experiment_.emitters.end(),
                                   [&](const Emitter& emitter) { return emitter.body == body; });
  if (emitted && specification.deformed())
    problem(nearest_node(root_, specification.pointer),
            why + "what is emitted begins undeformed, and this body does not; remove one of them");
  for (const Load& load : experiment_.loads)
    if (load.body == body && load.at_points())
      problem(nearest_node(root_, load.pointer),
              why +
                  "a load at points or on a surface is carried by particles of the start; take a load of type "
                  "\"body_force\"");
  for (const Grip& grip : experiment_.grips)
    if (grip.body == body)
      problem(nearest_node(root_, grip.pointer), why + "a grip holds particles of the start; grip another body");
  const OutputSpecification& output = experiment_.output;
  for (const GroupSpecification& group : output.groups)
    if (group.body < 0 || group.body == body)
      problem(nearest_node(root_, group.pointer),
              why + "a group sums particles of the start; give it another \"body\", or take /output/bodies");
  for (const ProbeSpecification& probe : output.probes)
    if (probe.kind == ProbeKind::nearest && (probe.body < 0 || probe.body == body))
      problem(nearest_node(root_, probe.pointer),
              why + "a probe of this kind follows one particle; take a probe at a place, on a line or a section");
}

}  // namespace mpm

// What acts on the whole scene beside bodies and walls: gravity and damping; and the names of what holds the material.
#include <algorithm>
#include <cmath>

#include "experiment/reader.hpp"

namespace mpm {

void ExperimentReader::read_gravity(const Fields& fields) {
  if (!fields.valid("gravity")) return;
  const VectorExpression& gravity = fields.expression("gravity");
  if (gravity.uses_time()) experiment_.changing_gravity = gravity;
  const ExpressionScope scope{"t", context_.constants};
  const OrderedJson& resolved = fields.resolved["gravity"];
  for (std::size_t axis = 0; axis < resolved.size() && axis < 3; ++axis) {
    const VectorExpression::Term term = resolved[axis].is_string()
                                            ? VectorExpression::Term(resolved[axis].get<std::string>())
                                            : VectorExpression::Term(resolved[axis].get<double>());
    experiment_.gravity_changes[axis] = VectorExpression(std::span(&term, 1), scope).uses_time();
    if (experiment_.gravity_changes[axis]) continue;
    experiment_.gravity[axis] = gravity({}, {}, 0)[axis];
    if (!std::isfinite(experiment_.gravity[axis])) problem(*fields.node("gravity"), "gravity is not a finite number");
  }
}

void ExperimentReader::read_grips(const Node* node) {
  if (!node || !is_list(*node, "grips", true)) return;
  OrderedJson& resolved = resolved_["grips"] = OrderedJson::array();
  for (const Node& item : node->items) resolved.push_back(read_grip(item));
  if (experiment_.grips.size() > most_grips)
    problem(*node, "at most " + std::to_string(most_grips) + " grips, got " + std::to_string(experiment_.grips.size()));
  const Component& shape = experiment_.shape;
  if (!node->items.empty() && shape.plugin && shape.plugin->shape().sample_points[0] > 0)
    problem(*node, "shape " + in_quotes(shape.plugin->id()) +
                       " moves particles to the centroids of their domains, not as a grip says; choose another shape, "
                       "e.g. \"cpdi\"");
}

OrderedJson ExperimentReader::read_grip(const Node& node) {
  const Fields fields(&node, grip_section(), context_);
  OrderedJson resolved = fields.resolved;
  Grip grip;
  grip.pointer = node.pointer;
  grip.name = fields.given("name") && fields.valid("name") ? fields.text("name")
                                                           : "grip_" + std::to_string(experiment_.grips.size());
  check_support_name(grip.name, fields.place("name"));
  grip.body = std::max(0, body_index(fields));  // after a problem any body, so that the rest is read too
  grip.held = fields.held("velocity");
  grip.velocity = fields.expression("velocity");
  refuse_nothing_held(fields, grip.held, "remove the grip");
  if (const Node* region = fields.node("where")) grip.region = read_geometry(*region, context_, resolved["where"]);
  if (static_cast<std::size_t>(grip.body) < experiment_.bodies.size() && experiment_.bodies[grip.body].frozen)
    problem(fields.place("body"), "body " + in_quotes(experiment_.bodies[grip.body].name) +
                                      " is frozen: its particles stay in their places; remove one of them");
  experiment_.grips.push_back(std::move(grip));
  return resolved;
}

/// Refuses a velocity without any component, which would leave the material to itself.
void ExperimentReader::refuse_nothing_held(const Fields& fields, const std::array<bool, 3>& held,
                                           const std::string& remedy) {
  if (fields.valid("velocity") && context_.dimension > 0 &&
      std::none_of(held.begin(), held.begin() + context_.dimension, [](bool h) { return h; }))
    problem(fields.place("velocity"),
            "holds nothing: every component is null; give one a velocity (0 holds it), or " + remedy);
}

int ExperimentReader::body_index(const Fields& fields) {
  return fields.valid("body") ? body_index(fields.place("body"), fields.text("body")) : -1;
}

void ExperimentReader::read_damping(const Node* node) {
  if (!node) return;
  const Fields fields(node, damping_section(), context_);
  experiment_.damping = {fields.number("viscous"), fields.number("local"), node->pointer};
  if (!fields.given("viscous") && !fields.given("local"))
    problem(*node, "damps nothing: give \"viscous\" (1/s) or \"local\" (a share), or remove \"damping\"");
  resolved_["damping"] = fields.resolved;
}

/// Checks that the exact solution is that of a scene in which nothing takes energy and gravity is constant.
void ExperimentReader::check_free_fall() {
  if (!experiment_.exact) return;
  const std::string name = "exact solution " + in_quotes(experiment_.exact->type);
  if (experiment_.damping.acts())
    problem(nearest_node(root_, "/compare/exact"), name + " is one without damping; remove /damping or it");
  if (experiment_.changing_gravity)
    problem(nearest_node(root_, "/compare/exact"),
            name + " is one of constant gravity, but /gravity changes in time; remove one of them");
}

/// The name of a box's reaction, by default its place in the list. It stands in headings and paths of the results.
std::string ExperimentReader::name_of_box(const Fields& fields) {
  const bool may_have_one = fields.section().name != "thermal";  // which holds nothing
  const bool given = may_have_one && fields.given("name") && fields.valid("name");
  const std::string name = given ? fields.text("name") : "box_" + std::to_string(experiment_.boxes.size());
  if (may_have_one) check_support_name(name, fields.place("name"));
  return name;
}

void ExperimentReader::check_support_name(const std::string& name, const Node& place) {
  if (!is_name(name))
    problem(place, in_quotes(name) + " is no name: letters, digits and _, not beginning with a digit");
  for (const Support& other : experiment_.supports())
    if (other.name == name) problem(place, "there is already a support " + in_quotes(name) + "; give another name");
}

void ExperimentReader::read_reactions(const Fields& fields) {
  if (!fields.valid("reactions") || !fields.given("reactions")) return;
  const std::vector<Support> supports = experiment_.supports();
  std::vector<std::string> names;
  for (const Support& support : supports)
    if (support.holds) names.push_back(support.name);
  const std::vector<std::string> asked = fields.boolean("reactions") ? names : fields.names("reactions");
  if (fields.boolean("reactions") && names.empty())
    problem(fields.place("reactions"),
            "nothing holds the material: all walls are free or periodic, and no box of "
            "nodes gives a velocity");
  for (const std::string& name : asked) {
    const auto found = std::find_if(supports.begin(), supports.end(),
                                    [&](const Support& support) { return support.holds && support.name == name; });
    if (found != supports.end()) {
      experiment_.output.reactions.push_back(static_cast<int>(found - supports.begin()));
      continue;
    }
    problem(fields.place("reactions"), "no wall and no box of nodes that holds the material is called " +
                                           in_quotes(name) +
                                           suggestion(name, names, "there are " + quoted_list(names)));
  }
}

}  // namespace mpm

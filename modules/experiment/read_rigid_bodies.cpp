// Rigid bodies that move as they are told, and the laws by which material meets them.
#include "experiment/reader.hpp"

namespace mpm {

void ExperimentReader::read_rigid_bodies(const Node* node) {
  if (!node || !is_list(*node, "rigid bodies", true)) return;
  OrderedJson& resolved = resolved_["rigid_bodies"] = OrderedJson::array();
  for (const Node& item : node->items) resolved.push_back(read_rigid_body(item));
}

OrderedJson ExperimentReader::read_rigid_body(const Node& node) {
  const Fields fields(&node, rigid_body_section(context_.dimension), context_);
  OrderedJson resolved = fields.resolved;
  RigidBodySpecification body;
  body.pointer = node.pointer;
  body.name = fields.given("name") && fields.valid("name")
                  ? fields.text("name")
                  : "rigid_body_" + std::to_string(experiment_.rigid_bodies.size());
  check_support_name(body.name, fields.place("name"));
  body.velocity = fields.expression("velocity");
  body.angular_velocity = fields.expression("angular_velocity");
  if (const Node* geometry = fields.node("geometry"))
    body.geometry = read_geometry(*geometry, context_, resolved["geometry"]);
  if (fields.given("about"))
    body.about = fields.vector("about");
  else if (body.geometry)
    body.about = middle_of(*body.geometry);
  if (const Node* law = fields.node("contact")) {
    Chosen contact = read_component(*law, MPM_CONTACT, rigid_contact_kinds(components_));
    body.contact = std::move(contact.component);
    resolved["contact"] = std::move(contact.resolved);
  }
  check_rigid_about_axis(fields);
  if (body.geometry && body.contact.plugin) experiment_.rigid_bodies.push_back(std::move(body));
  return resolved;
}

/// Refuses motions that a solid of revolution does not have: its points would not stay together around the axis.
void ExperimentReader::check_rigid_about_axis(const Fields& fields) {
  if (!experiment_.axisymmetric() || context_.dimension != 2) return;
  // A resolved experiment has the default, zero: it must be read again, as a study and a resumed run do.
  const VectorExpression& turning = fields.expression("angular_velocity");
  const bool turns = !turning.is_constant() || turning({}, {}, 0) != Vector3{};
  if (fields.valid("angular_velocity") && fields.given("angular_velocity") && turns)
    problem(fields.place("angular_velocity"),
            "in an axisymmetric scene nothing turns in the plane of radius and axis: the body would not stay rigid "
            "around the axis; remove it");
  const Node* const velocity = fields.node("velocity");
  if (!velocity || velocity->items.empty() || !fields.valid("velocity")) return;
  const Node& radial = velocity->items.front();
  if (radial.type != Node::Type::number || radial.number != 0)
    problem(*velocity,
            "in an axisymmetric scene a body that moves along its radius (x) does not stay rigid around the axis; give "
            "it a velocity along the axis alone, [0, ...]");
}

}  // namespace mpm

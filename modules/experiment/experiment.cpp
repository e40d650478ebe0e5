#include "experiment/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "plugin/extension_of.hpp"

namespace mpm {

double Component::parameter(std::string_view name) const {
  if (plugin) {
    for (const mpm_parameter& declared : plugin->parameters()) {
      if (declared.name == name) return parameters.at(declared.offset / sizeof(double));
    }
  }
  throw std::out_of_range((plugin ? std::string(plugin->id()) : "no plugin") + " has no parameter " +
                          std::string(name));
}

double Damping::left_of_velocity(double dt) const {
  return std::exp(-viscous * dt);
}

double Damping::left_of_change(double dt) const {
  return viscous > 0 ? -std::expm1(-viscous * dt) / (viscous * dt) : 1;
}

std::string face_name(int axis, int side) {
  return std::string(1, "xyz"[axis]) + (side == 0 ? "_min" : "_max");
}

std::string Experiment::giver_of(ExternalForce force, int body) const {
  if (force == ExternalForce::body_force && body_force) return body_force_pointer;
  for (const Load& load : loads)
    if ((body < 0 || load.body == body) && load.gives(force)) return load.pointer;
  return "";
}

std::string Experiment::loaded_at_points(int body) const {
  for (const Load& load : loads)
    if ((body < 0 || load.body == body) && load.at_points()) return load.pointer;
  return "";
}

bool Experiment::any_face(ConditionType type) const {
  for (int axis = 0; axis < dimension; ++axis)
    for (const FaceCondition& face : faces[axis])
      if (face.type == type) return true;
  return false;
}

bool Experiment::separates() const {
  return any_face(ConditionType::separate) || std::any_of(boxes.begin(), boxes.end(), [](const BoxCondition& box) {
           return box.type == ConditionType::separate;
         });
}

bool Experiment::reads_initial_position() const {
  return (body_force && body_force->uses_initial_position()) ||
         std::any_of(grips.begin(), grips.end(),
                     [](const Grip& grip) { return grip.velocity.uses_initial_position(); });
}

std::vector<Support> Experiment::supports() const {
  std::vector<Support> all;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const ConditionType type = faces[axis][side].type;
      const bool holds = type != ConditionType::free && type != ConditionType::periodic;
      all.push_back({face_name(axis, side), axis < dimension && holds});
    }
  for (const BoxCondition& box : boxes) all.push_back({box.name, box.type != ConditionType::free});
  for (const Grip& grip : grips) all.push_back({grip.name, true});
  for (const RigidBodySpecification& body : rigid_bodies) all.push_back({body.name, true});
  return all;
}

std::string Experiment::why_it_meets() const {
  const Component& law = contact ? *contact : rigid_bodies.front().contact;
  return law.pointer + " \"" + std::string(law.plugin->id()) + "\"";
}

bool Experiment::measures_traction() const {
  return contact && (contact->plugin->contact().traits & MPM_READS_TRACTION);
}

bool Experiment::has_compliant_contact() const {
  return contact && (contact->plugin->contact().traits & MPM_COMPLIANT);
}

std::span<const mpm_state> Experiment::contact_state() const {
  return contact ? contact->plugin->state() : std::span<const mpm_state>();
}

double Experiment::contact_step_limit() const {
  const auto* table = contact ? extension_of<mpm_contact_step_limit>(*contact->plugin) : nullptr;
  double density = std::numeric_limits<double>::infinity();
  for (const BodySpecification& body : bodies)
    density = std::min(density, materials[body.material].component.parameter("density"));
  return table ? table->limit(contact->parameters.data(), density, grid.cell_size)
               : std::numeric_limits<double>::infinity();
}

Vector3 RigidBodySpecification::spin_at(double time, int dimension) const {
  const Vector3 spin = angular_velocity({}, {}, time);
  return dimension == 2 ? Vector3{0, 0, spin[0]} : spin;
}

bool RigidBodySpecification::moves() const {
  const auto rests = [](const VectorExpression& expression) {
    return expression.is_constant() && expression({}, {}, 0) == Vector3{};
  };
  return !rests(velocity) || !rests(angular_velocity);
}

std::string Experiment::where(std::string_view pointer) const {
  // A default has no place of its own: the nearest part of the file around it has.
  while (true) {
    for (const auto& [known, place] : positions) {
      if (known != pointer) continue;
      if (place.first == 0) return "command line";
      return file.string() + ":" + std::to_string(place.first) + ":" + std::to_string(place.second);
    }
    if (pointer.empty()) return file.string();
    pointer = pointer.substr(0, pointer.find_last_of('/') == pointer.npos ? 0 : pointer.find_last_of('/'));
  }
}

bool OutputSpecification::probes_take(std::string_view beginning) const {
  for (const ProbeSpecification& probe : probes)
    for (const std::string& name : probe.quantities)
      if (name.starts_with(beginning)) return true;
  return false;
}

}  // namespace mpm

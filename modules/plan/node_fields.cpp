// What each component of a scene keeps at nodes.

#include <algorithm>

#include "experiment/thermal.hpp"
#include "operators/edges.hpp"
#include "plan/field_list.hpp"

namespace mpm {

Field& FieldList::of_nodes(const std::string& id, const std::string& unit, int components, const std::string& because,
                           const std::string& beside) {
  Field field;
  field.id = id, field.name = id, field.unit = unit;
  field.owner = Owner::node, field.lifetime = Lifetime::step;
  field.components = components;
  field.beside = beside;
  if (beside.empty()) field.bytes = 4 * scalar_bytes() * experiment.field_count;
  field.because = because;
  plan.fields.push_back(field);
  return plan.fields.back();
}

Field& FieldList::summed(const std::string& id, const std::string& unit, int components, AtWall at_wall, Folded folded,
                         const std::string& because, const std::string& beside) {
  Field& field = of_nodes(id, unit, components, because, beside);
  field.at_wall = at_wall, field.folded = folded, field.cleared = true;
  return field;
}

void FieldList::in_place_of(const std::string& other, Field& field) const {
  if (!needs.shares_memory) return;
  field.in_place_of = other;
  field.bytes = 0;
}

namespace {

bool gathers_increment(const Experiment& experiment) {
  return experiment.transfer.plugin->transfer().traits & MPM_GATHERS_INCREMENT;
}

std::string why_for_ledger(const Plan& plan) {
  const std::string every = std::to_string(plan.ledger_every);
  return "/output/ledger: work of the forces" + (plan.ledger_every > 1 ? ", in one step of " + every : "");
}

void transfer_fields(FieldList& fields) {
  const int D = fields.experiment.dimension;
  const std::string transfer = FieldList::named(fields.experiment.transfer) + ": every transfer";
  fields.summed("momentum", "kg m/s", D, AtWall::momentum, Folded::with_mass, transfer);
  fields.summed("mass", "kg", 1, AtWall::even, Folded::with_mass, transfer, "momentum");
  fields.in_place_of("momentum", fields.of_nodes("velocity", "m/s", D, transfer));
}

void fused_fields(FieldList& fields) {
  if (!fields.plan.fused()) return;
  const std::string fused = "/solver/passes: gather and scatter are one";
  fields.of_nodes("next_momentum", "kg m/s", fields.experiment.dimension, fused);
  fields.of_nodes("next_mass", "kg", 1, fused, "next_momentum");
}

void filter_fields(FieldList& fields) {
  if (!fields.plan.filters()) return;
  const Experiment& experiment = fields.experiment;
  const int D = experiment.dimension;
  const std::string filter = FieldList::named(*experiment.filter);
  fields.of_nodes("increment", "m/s", D, filter);
  if (fields.plan.does(Act::project)) fields.of_nodes("projection", "kg m/s", D, filter);
  const bool constrains_always = experiment.filter_schedule.constrain_always;
  if (fields.plan.does(Act::project) && constrains_always) {
    Field& trial = fields.of_nodes("trial_velocity", "m/s", D, filter + ": before conditions and contact");
    trial.lifetime = Lifetime::pass;
    fields.in_place_of("projection", trial);
  }
  const Operator* keeps = fields.plan.find(Act::keep_velocity);
  if (keeps) fields.of_nodes("unfiltered_velocity", "m/s", D, keeps->because);
  if (!experiment.filter_schedule.takes_back || !(fields.plan.resolves_contact() || experiment.separates())) return;
  const std::string because = filter + ": an increment may take back what a one-sided law gave";
  fields.of_nodes("velocity_of_constraints", "m/s", D, because).name = "velocity that conditions and contact added";
  if (keeps)
    fields.of_nodes("unfiltered_velocity_of_constraints", "m/s", D, because).name =
        "the same of the unfiltered velocity";
}

void increment_fields(FieldList& fields) {
  const bool gathered = gathers_increment(fields.experiment) && fields.plan.does(Act::gather);
  const Damping& damping = fields.experiment.damping;
  if (!gathered && !fields.plan.does(Act::accelerate)) return;
  if (!gathered && !damping.acts() && !fields.plan.has_ledger() && !fields.needs.keeps_all_apart) return;
  Field& before =
      fields.of_nodes("velocity_before", "m/s", fields.experiment.dimension,
                      gathered ? FieldList::named(fields.experiment.transfer) + ": gathers the change of velocity"
                      : damping.acts()           ? damping.pointer + ": acts on the change of velocity"
                      : fields.plan.has_ledger() ? why_for_ledger(fields.plan)
                                                 : fields.why_apart());
  before.cleared = true, before.for_ledger = !gathered && !damping.acts();
}

/// Whether a force from outside is scattered with that of the stress or with the momenta: then only the ledger wants it
/// apart. On a device each has a scatter of its own.
bool joins_force(const FieldList& fields, ExternalForce external) {
  return external == ExternalForce::body_force && !fields.needs.keeps_all_apart && !fields.needs.launches;
}

/// Who beside contact asks for a force that is not merged into the momentum; empty where nobody in the scene does.
std::string why_separate_force_beside_contact(const FieldList& fields) {
  const Experiment& experiment = fields.experiment;
  if (gathers_increment(experiment)) return FieldList::named(experiment.transfer) + ": gathers the change of velocity";
  if (experiment.damping.acts()) return experiment.damping.pointer + ": acts on the change of velocity";
  for (const ExternalForce external : external_forces) {
    const std::string giver = experiment.giver_of(external);
    if (!joins_force(fields, external) && !giver.empty()) return giver + ": work of the forces";
  }
  if (const Operator* const averages = fields.plan.find(Act::average_mean_stress))
    return asker(averages->because) + ": forces of the mean stress after the momenta";
  const Pass* const strain = fields.plan.pass_of(Act::strain);
  const Operator* const scatters = fields.plan.find(Act::scatter_force);
  if (strain && scatters && strain->stage == Stage::before_forces)
    return asker(scatters->because) + ": stress after the momenta";
  if (fields.plan.filters() && fields.plan.pass_of(Act::begin_filter)->stage == Stage::before_forces)
    return FieldList::named(*experiment.filter) + ": filters before the forces";
  if (experiment.separates()) return "/grid/boundaries \"separate\": the wall predicts with the forces";
  if (fields.needs.launches && !fields.plan.divides_with_forces()) return fields.why_apart();
  return "";
}

std::string why_separate_force(const FieldList& fields) {
  const Experiment& experiment = fields.experiment;
  if (fields.plan.resolves_contact() && !gathers_increment(experiment))
    return experiment.why_it_meets() + ": acts before and after the forces";
  return why_separate_force_beside_contact(fields);
}

/// Whether particles that no other body comes near may add their forces to the momenta: contact alone wants them apart.
bool wants_force_where_bodies_meet(const FieldList& fields) {
  const bool for_others = fields.plan.has_ledger() || fields.experiment.notes_reactions() ||
                          fields.needs.keeps_all_apart || fields.needs.launches ||
                          !why_separate_force_beside_contact(fields).empty();
  return fields.plan.resolves_contact() && !for_others;
}

/// Whether gravity's force has a field of its own. On the cpu backend the ledger takes its work from the masses, and
/// without a ledger a device adds it to what else changes the momenta.
bool keeps_weight_apart(const FieldList& fields) {
  if (!fields.needs.launches) return fields.needs.keeps_all_apart;
  return fields.experiment.has_gravity() && fields.plan.has_ledger();
}

void force_fields(FieldList& fields) {
  if (!fields.plan.does(Act::accelerate)) return;
  const Experiment& experiment = fields.experiment;
  const int D = experiment.dimension;
  const std::string why = why_separate_force(fields);
  const bool for_ledger = why.empty() && fields.plan.has_ledger();
  if (!why.empty() || for_ledger || fields.needs.keeps_all_apart) {
    Field& force = fields.summed("force", "N", D, AtWall::vector, Folded::with_force,
                                 !why.empty() ? why
                                 : for_ledger ? why_for_ledger(fields.plan)
                                              : fields.why_apart());
    force.for_ledger = for_ledger, force.for_contact = wants_force_where_bodies_meet(fields);
  }
  for (const ExternalForce external : external_forces) {
    const std::string giver = experiment.giver_of(external);
    const bool ledger_alone = joins_force(fields, external);
    if (giver.empty() || (ledger_alone && !fields.plan.has_ledger())) continue;
    fields
        .summed(field_of(external), "N", D, AtWall::vector, Folded::with_force,
                giver + ": its work is accounted for apart")
        .for_ledger = ledger_alone;
  }
  if (keeps_weight_apart(fields))
    fields.summed("weight", "N", D, AtWall::vector, Folded::with_force, "/gravity: its work is accounted for apart");
}

/// Whether walls or boxes give any node its velocity.
bool holds_velocities(const Experiment& experiment) {
  bool holds = !experiment.boxes.empty() || !experiment.grips.empty();
  for (const auto& faces : experiment.faces)
    for (const FaceCondition& face : faces) holds = holds || folds(static_cast<int>(face.type));
  return holds;
}

/// The impulses of a stage of the step (before the forces, after them, in a filter), which the ledger makes works of;
/// and of what conditions and contact have given in all stages, where a filter's loop may take it back.
void impulse_fields(FieldList& fields) {
  if (!fields.plan.has_ledger() || !fields.plan.does(Act::accelerate)) return;
  const Experiment& experiment = fields.experiment;
  const auto add = [&](const char* id, const std::string& because) {
    Field& field = fields.of_nodes(id, "kg m/s", experiment.dimension, because);
    field.cleared = true, field.for_ledger = true;
  };
  const bool takes_back = fields.plan.node_field("velocity_of_constraints") != nullptr;
  const std::string works = "/output/ledger: work of what it gives";
  const std::string total = "/output/ledger: a filter's loop may take it back";
  if (holds_velocities(experiment)) {
    add("boundary_impulse", works);
    if (takes_back) add("standing_boundary_impulse", total);
  }
  if (fields.plan.resolves_contact()) {
    add("contact_impulse", works);
    if (takes_back) add("standing_contact_impulse", total);
  }
  if (experiment.damping.acts()) add("damping_impulse", works);
  if (fields.plan.filters()) add("filter_impulse", works);
}

void contact_fields(FieldList& fields) {
  if (!fields.plan.resolves_contact()) return;
  const int D = fields.experiment.dimension;
  const Experiment& experiment = fields.experiment;
  const auto summed = [&](const char* id, const char* unit, int components, AtWall at_wall,
                          const std::string& because) {
    fields.summed(id, unit, components, at_wall, Folded::with_mass, because).for_contact = true;
  };
  const std::string meets = experiment.contact ? experiment.contact->pointer : experiment.rigid_bodies.front().pointer;
  std::string area = meets + ": the area that a node stands for";
  std::string place = experiment.rigid_bodies.empty()
                          ? ""
                          : experiment.rigid_bodies.front().pointer + ": where the edge of the material lies";
  unsigned traits = 0;
  if (experiment.contact) {
    const Component& chosen = *experiment.contact_normal;
    const std::string normal = meets + "/normal \"" + std::string(chosen.plugin->id()) + "\"";
    traits = chosen.plugin->normal().traits;
    if (traits & (MPM_READS_VOLUME_GRADIENT | MPM_LOOKS_AT_POINTS)) area = normal;
    const Plugin& detection = *experiment.contact_detection->plugin;
    const bool weld = experiment.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION;
    if (!weld && (detection.detection().traits & (MPM_READS_MEAN_POSITION | MPM_READS_EDGES)))
      place = meets + "/detection \"" + std::string(detection.id()) + "\"";
    if (traits & MPM_READS_MASS_GRADIENT) summed("mass_gradient", "kg/m", D, AtWall::slip, normal);
  }
  summed("volume_gradient", "m^2", D, AtWall::slip, area);
  if (!place.empty()) summed("mass_position", "kg m", D, AtWall::slip, place);
  if (experiment.has_compliant_contact()) summed("mass_displacement", "kg m", D, AtWall::slip, meets + ": its springs");
  if (experiment.contact_state().empty()) return;
  // Nodes keep vectors of the plane, whether a law has one value or two.
  constexpr int states = MPM_CONTACT_STATES;
  const std::string keeps = FieldList::named(*experiment.contact) + ": its state";
  summed("mass_state", "kg", states, AtWall::even, keeps);
  summed("mass_gain", "kg", states, AtWall::even, keeps);
  fields.of_nodes("reached", "", states, keeps).cleared = true;
  fields.of_nodes("met", "", 1, keeps, "reached").cleared = true;
}

/// What nodes get from the particles of each grip: the momentum that these have as they are told at the end of the step,
/// with their mass, and the one that they have now.
void grip_fields(FieldList& fields) {
  const Experiment& experiment = fields.experiment;
  for (std::size_t k = 0; k < experiment.grips.size(); ++k) {
    const std::string id = grip_field(k), because = experiment.grips[k].pointer;
    fields.summed(id, "kg m/s", experiment.dimension, AtWall::vector, Folded::with_mass, because + ": holds nodes");
    fields.summed(id + "_mass", "kg", 1, AtWall::even, Folded::with_mass, because + ": holds nodes", id);
    fields.summed(id + "_before", "kg m/s", experiment.dimension, AtWall::vector, Folded::with_mass,
                  because + ": holds nodes before the forces");
  }
}

/// What a wall that heat comes through asks for.
void heated_wall_fields(FieldList& fields, const std::string& wall) {
  fields.summed("heated_volume", "m^3", 1, AtWall::even, Folded::with_mass,
                wall + ": makes the area of the wall that a node stands for");
  fields.summed("volume_conductivity", "W m^2/K", 1, AtWall::even, Folded::with_mass,
                wall + ": makes the gradient of the temperature at the wall", "heated_volume");
  const Component& transfer = fields.experiment.transfer;
  if ((transfer.plugin->transfer().traits & MPM_SCATTERS_AFFINE) == 0)
    fields.summed("capacity_position", "J m/K", fields.experiment.dimension, AtWall::slip, Folded::with_mass,
                  wall + ": " + FieldList::named(transfer) + " carries no gradient to the mirror image");
}

void temperature_fields(FieldList& fields) {
  const Experiment& experiment = fields.experiment;
  if (!experiment.has_temperature()) return;
  const std::string because = experiment.materials[experiment.bodies[0].material].thermal->pointer;
  fields.summed("heat", "J", 1, AtWall::heat, Folded::with_mass, because);
  fields.summed("heat_capacity", "J/K", 1, AtWall::even, Folded::with_mass, because, "heat");
  fields.in_place_of("heat", fields.of_nodes("temperature", "K", 1, because));
  fields.summed("heat_rate", "W", 1, AtWall::heat_rate, Folded::with_force, because);
  const bool gathered = gathers_increment(experiment);
  if (gathered || fields.needs.keeps_all_apart)
    fields
        .of_nodes("temperature_before", "K", 1,
                  gathered ? FieldList::named(experiment.transfer) + ": gathers the change of temperature"
                           : fields.why_apart())
        .cleared = true;
  for (const auto& faces : experiment.faces)
    for (const FaceCondition& face : faces)
      if (passes_heat(face)) return heated_wall_fields(fields, face.thermal.pointer);
}

/// Sums by volume over the particles around a node, and their mean. A step may strain twice: the scatters themselves clear
/// what they sum, and it is folded as it is divided. Forces have taken the mean stress before the next dilation comes.
void averaged_fields(FieldList& fields) {
  const auto average = [&](Act act, const std::string& sum, const std::string& volume, const std::string& mean,
                           const std::string& unit) {
    const Operator* const averages = fields.plan.find(act);
    if (!averages) return;
    const std::string because = averages->because;
    Field& summed = fields.summed(sum, "m^3 " + unit, 1, AtWall::even, Folded::never, because);
    summed.cleared = false;
    if (sum != "volume_stress" && fields.plan.node_field("volume_stress")) fields.in_place_of("volume_stress", summed);
    fields.summed(volume, "m^3", 1, AtWall::even, Folded::never, because, sum).cleared = false;
    fields.in_place_of(sum, fields.of_nodes(mean, unit, 1, because));
  };
  average(Act::average_mean_stress, "volume_stress", "stressed_volume", "mean_stress", "Pa");
  average(Act::average_dilation, "volume_rate", "strained_volume", "dilation", "1/s");
}

}  // namespace

void declare_node_fields(FieldList& fields) {
  for (const auto declare : {transfer_fields, fused_fields, filter_fields, increment_fields, force_fields,
                             impulse_fields, contact_fields, grip_fields, temperature_fields, averaged_fields})
    declare(fields);
  for (Field& field : fields.plan.fields)
    if (field.name == field.id) std::replace(field.name.begin(), field.name.end(), '_', ' ');
}

}  // namespace mpm

// What each component of a scene keeps with a particle. The order of the components is that of the places in a
// particle's memory: what a gather may replace stands together.

#include "plan/field_list.hpp"

namespace mpm {

Field& FieldList::of_particles(int body, const std::string& id, const std::string& unit, int components, First first,
                               const std::string& because) {
  Field field;
  field.id = id, field.name = id, field.unit = unit;
  field.owner = Owner::particle, field.body = body;
  field.components = components, field.first = first;
  field.bytes = components * scalar_bytes();
  field.because = because;
  plan.fields.push_back(field);
  return plan.fields.back();
}

namespace {

/// The state that a plugin declares.
void state_fields(FieldList& fields, int body, const Component& component, Origin origin) {
  const Experiment& experiment = fields.experiment;
  for (const mpm_state& declared : component.plugin->state()) {
    const int components = state_components(kept_shape(declared, experiment.axisymmetric()), experiment.dimension);
    fields
        .of_particles(body, declared.name, declared.unit, components, FieldList::first_of(declared),
                      FieldList::named(component) + ": " + declared.doc)
        .origin = origin;
  }
}

void body_fields(FieldList& fields, int body) {
  const int D = fields.experiment.dimension;
  const std::string every = fields.experiment.bodies[body].pointer + ": every particle";
  fields.of_particles(body, "position", "m", D, First::seeded, every);
  fields.of_particles(body, "velocity", "m/s", D, First::seeded, every);
}

void transfer_fields(FieldList& fields, int body) {
  const Component& transfer = fields.experiment.transfer;
  state_fields(fields, body, transfer, Origin::transfer);
  if (const int functions = fields.plan.basis_functions; functions > 0)
    fields
        .of_particles(
            body, polynomial_coefficients, "m/s", fields.experiment.dimension * functions, First::zero,
            FieldList::named(transfer) + ": " + std::to_string(functions) + " polynomials beyond the affine ones")
        .origin = Origin::transfer;
}

void material_fields(FieldList& fields, int body) {
  const Experiment& experiment = fields.experiment;
  const BodySpecification& specification = experiment.bodies[body];
  const std::size_t before = fields.plan.fields.size();
  state_fields(fields, body, experiment.materials[specification.material].component, Origin::material);
  for (std::size_t k = before; specification.deformed() && k < fields.plan.fields.size(); ++k)
    fields.plan.fields[k].first = First::seeded;
}

/// What artificial viscosity adds to the stress: the strain finds it, and the next forces, that strain's ledger and the
/// estimate of the step read it.
void viscosity_fields(FieldList& fields, int body) {
  const Experiment& experiment = fields.experiment;
  const auto& viscosity = experiment.materials[experiment.bodies[body].material].artificial_viscosity;
  if (!viscosity) return;
  fields
      .of_particles(body, "artificial_pressure", "Pa", 1, First::zero,
                    viscosity->pointer + ": J times its pressure in the last strain")
      .name = "artificial pressure J q";
}

/// The transfer acts on the temperature as on the first component of a velocity, of a particle whose mass is its heat
/// capacity: of its state a matrix keeps one row, a vector one scalar.
void temperature_fields(FieldList& fields, int body) {
  const Experiment& experiment = fields.experiment;
  const auto& thermal = experiment.materials[experiment.bodies[body].material].thermal;
  if (!thermal) return;
  fields.of_particles(body, "temperature", "K", 1, First::seeded, thermal->pointer);
  for (const mpm_state& declared : experiment.transfer.plugin->state())
    fields.of_particles(body, temperature_state + std::string(declared.name), "K/m",
                        declared.shape == MPM_STATE_MATRIX ? experiment.dimension : 1, First::zero,
                        FieldList::named(experiment.transfer) + ": acts on the temperature too");
  if (thermal->phase_change)
    fields.of_particles(body, "melted_fraction", "", 1, First::seeded, thermal->phase_change->pointer);
}

void backend_fields(FieldList& fields, int body) {
  if (fields.needs.sorts)
    fields
        .of_particles(body, "identity", "", 1, First::seeded,
                      fields.experiment.bodies[body].pointer + ": results keep the order of seeding")
        .bytes = 4;
}

/// The factor of the nominal volume and mass.
void size_fields(FieldList& fields, int body) {
  const BodySpecification& specification = fields.experiment.bodies[body];
  if (fields.experiment.axisymmetric())
    fields.of_particles(body, "size", "m", 1, First::seeded,
                        "/grid/symmetry \"axisymmetric\": a particle is a ring of volume and mass times 2 pi r");
  else if (specification.varies_in_size())
    fields.of_particles(body, "size", "", 1, First::seeded,
                        specification.pointer + "/seeding: particles differ in volume and mass");
}

/// What of the forces on a body depends on where its particles began; empty where nothing does.
std::string forces_by_initial_position(const Experiment& experiment, int body) {
  if (experiment.body_force && experiment.body_force->uses_initial_position())
    return experiment.body_force_pointer + ": the force depends on X";
  for (const Load& load : experiment.loads) {
    if (load.body != body) continue;
    if (load.gives(ExternalForce::spring)) return load.pointer + ": springs pull towards X";
    if (load.value.uses_initial_position()) return load.pointer + ": the load depends on X";
  }
  return "";
}

/// Who asks where the particles of a body began: its forces, what they are to become, or a body that they may go over to.
std::string who_reads_initial_position(const Experiment& experiment, int body) {
  for (std::size_t hops = 0; hops < experiment.bodies.size(); ++hops) {
    if (const std::string asks = forces_by_initial_position(experiment, body); !asks.empty()) return asks;
    const auto& becomes = experiment.bodies[static_cast<std::size_t>(body)].becomes;
    if (!becomes) break;
    if (becomes->quantity.starts_with("displacement")) return becomes->pointer + ": what goes over depends on X";
    body = becomes->body;
  }
  return "";
}

/// What follows a particle's deformation beside its material: loaded points, and surfaces that meet.
void deformation_fields(FieldList& fields, int body) {
  const Experiment& experiment = fields.experiment;
  const std::string loaded = experiment.loaded_at_points(body);
  const bool meets = experiment.contact &&
                     (experiment.contact_detection->plugin->detection().traits & MPM_READS_PARTICLE_SURFACES) &&
                     !(experiment.shape.plugin->descriptor->needs & MPM_NEEDS_DOMAIN);
  const bool springs = experiment.has_compliant_contact();
  if (loaded.empty() && !meets && !springs) return;
  const int D = experiment.dimension;
  fields
      .of_particles(body, "deformation", "", D * D,
                    experiment.bodies[body].deformed() ? First::seeded : First::identity,
                    !loaded.empty() ? loaded + ": loaded points and normals move with the particle"
                    : springs       ? experiment.contact->pointer + ": its springs do not feel a common turn"
                                    : FieldList::named(*experiment.contact_detection) + ": how far a particle extends")
      .name = "deformation gradient";
}

/// What the law of contact keeps, and what a step has added to it, of which the next one tells the law.
void contact_fields(FieldList& fields, int body) {
  const std::span<const mpm_state> state = fields.experiment.contact_state();
  if (state.empty()) return;
  const Component& law = *fields.experiment.contact;
  std::string because = FieldList::named(law) + ": ";
  for (std::size_t k = 0; k < state.size(); ++k) because += (k > 0 ? ", " : "") + std::string(state[k].name);
  const int components = static_cast<int>(state.size());
  fields.of_particles(body, "contact_state", state[0].unit, components, First::zero, because);
  fields.of_particles(body, "contact_gain", state[0].unit, components, First::zero,
                      because + ", as the last step has added");
}

void output_fields(FieldList& fields, int body) {
  const Experiment& experiment = fields.experiment;
  const std::string force_asks = who_reads_initial_position(experiment, body);
  const auto& particles = experiment.particle_output;
  const bool file_asks = particles && (particles->asks("initial_position") || particles->asks("displacement"));
  const bool grip_asks = experiment.reads_initial_position();
  const bool colour_asks = experiment.output.colour_by.starts_with("displacement");
  const bool springs_ask = experiment.has_compliant_contact(), normals_ask = experiment.output.normal_error;
  if (!experiment.exact && force_asks.empty() && !springs_ask && !grip_asks && !file_asks && !colour_asks &&
      !normals_ask && !experiment.output.probes_take("displacement"))
    return;
  const std::string because = experiment.exact      ? experiment.exact->pointer + ": errors are measured at X"
                              : !force_asks.empty() ? force_asks
                              : springs_ask         ? experiment.contact->pointer + ": its springs pull by x - X"
                              : grip_asks           ? "/grips: a velocity depends on X"
                              : file_asks           ? "/output/particles/fields: initial places are written"
                              : normals_ask         ? "/output/normal_error: surfaces follow their particles from X"
                              : colour_asks         ? "/output/colour_by \"" + experiment.output.colour_by + "\""
                                                    : "/output/probes: a probe takes displacements";
  fields.of_particles(body, "initial_position", "m", experiment.dimension, First::seeded, because).lifetime =
      Lifetime::seeded;
}

void grip_fields(FieldList& fields, int body) {
  if (fields.experiment.grips.empty()) return;
  fields.of_particles(body, "grip", "", 1, First::seeded, "/grips: which one moves the particle").name =
      "number of its grip";
}

/// Where a step strains between the gather and the move, what the gather found waits for the move. (A move that stands
/// before the gather waits in vain: check_step refuses it.)
void waiting_field(FieldList& fields, int body, const std::string& id, const std::string& unit, int components,
                   First first, const std::string& what) {
  const Operator* const move = fields.plan.find(Act::move);
  if (!move) return;
  const Pass* const gather = fields.plan.pass_of(Act::gather);
  const bool waits = !gather || !gather->has(Act::move);
  const bool apart = fields.needs.keeps_all_apart || (fields.needs.launches && fields.plan.advance != Advance::at_once);
  if (!waits && !apart) return;
  fields
      .of_particles(body, id, unit, components, first,
                    waits ? asker(move->because) + ": " + what + " wait for the remapped strain" : fields.why_apart())
      .lifetime = Lifetime::step;
}

void move_fields(FieldList& fields, int body) {
  waiting_field(fields, body, "advection_velocity", "m/s", fields.experiment.dimension, First::zero, "positions");
}

void shape_fields(FieldList& fields, int body) {
  const Experiment& experiment = fields.experiment;
  const int D = experiment.dimension, corners = D * fields.plan.sample_points;
  const std::string shape = FieldList::named(experiment.shape);
  const bool seeded = experiment.bodies[body].seeds_domains();
  if (corners > 0) {
    fields.of_particles(body, "corners", "cells", corners, seeded ? First::seeded : First::half_size_corners,
                        shape + ": corners of the domain");
    waiting_field(fields, body, "moved_corners", "cells", corners, First::half_size_corners, "corners");
  }
  if ((experiment.shape.plugin->descriptor->needs & MPM_NEEDS_DOMAIN) == 0) return;
  fields.of_particles(body, "domain", "cells", D * D, seeded ? First::seeded : First::half_size_diagonal,
                      shape + ": semi-side vectors of the particle's domain");
  // The reference backend keeps the stencils of a step; the others evaluate them anew in every pass.
  const Pass* const strain = fields.plan.pass_of(Act::strain);
  if (!strain || !fields.plan.does(Act::move)) return;
  if (!fields.needs.forgets_stencils || strain->remap() || strain->has(Act::gather)) return;
  const bool by_order = strain->stage == Stage::before_forces || !experiment.filter;
  fields
      .of_particles(body, "strained_domain", "cells", D * D, First::half_size_diagonal,
                    (by_order ? asker(strain->operators.front().because) : FieldList::named(*experiment.filter)) +
                        ": the weights of a step stay those before its strain")
      .lifetime = Lifetime::step;
}

}  // namespace

void declare_particle_fields(FieldList& fields) {
  for (int body = 0; body < static_cast<int>(fields.experiment.bodies.size()); ++body)
    for (const auto declare :
         {body_fields, transfer_fields, material_fields, temperature_fields, viscosity_fields, backend_fields,
          size_fields, grip_fields, deformation_fields, contact_fields, output_fields, move_fields, shape_fields})
      declare(fields, body);
}

}  // namespace mpm

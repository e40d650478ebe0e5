#include "solvers/explicit/explicit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "experiment/sections.hpp"
#include "plugin/extension_of.hpp"

namespace mpm {

namespace {

/// The step that heat allows: courant h^2 / (2 D alpha) for the largest diffusivity of any phase, and that for
/// convection at a wall, whose node has the heat capacity of half a cell. Densities are as seeded.
StepLimit thermal_limit(const Experiment& experiment) {
  StepLimit limit{std::numeric_limits<double>::infinity(), "diffusion"};
  const double h = experiment.grid.cell_size, courant = experiment.solver.courant;
  const auto take = [&](double seconds, std::string_view reason) {
    if (seconds < limit.seconds) limit = {seconds, reason};
  };
  const auto phase = [&](const ThermalProperties& properties, double density) {
    const double capacity = density * properties.heat_capacity;
    take(courant * h * h * capacity / (2 * experiment.dimension * properties.conductivity), "diffusion");
    for (const auto& faces : experiment.faces)
      for (const FaceCondition& face : faces)
        if (face.thermal.coefficient > 0) take(courant * h * capacity / (2 * face.thermal.coefficient), "convection");
  };
  for (const BodySpecification& body : experiment.bodies) {
    const MaterialSpecification& material = experiment.materials[body.material];
    if (!material.thermal) continue;
    const double density = material.component.parameter("density");
    phase(material.thermal->solid, density);
    if (material.thermal->phase_change) phase(material.thermal->phase_change->melted, density);
  }
  return limit;
}

/// The step that springs and dashpots to the ground allow: courant times what a row of particles on them stands, 2 / w
/// with w^2 the stiffness over the mass of an area, and 2 over the damping a mass.
StepLimit spring_limit(const Experiment& experiment) {
  StepLimit limit{std::numeric_limits<double>::infinity(), "spring"};
  for (std::size_t body = 0; body < experiment.bodies.size(); ++body) {
    const BodySpecification& specification = experiment.bodies[body];
    const double row = experiment.grid.cell_size / specification.particles_per_cell_axis *
                       experiment.materials[specification.material].component.parameter("density");
    for (int axis = 0; axis < experiment.dimension; ++axis) {
      double stiffness = 0, damping = 0;
      for (const Load& load : experiment.loads)
        if (load.body == static_cast<int>(body)) stiffness += load.stiffness[axis], damping += load.damping[axis];
      const auto take = [&](double seconds, std::string_view reason) {
        if (seconds < limit.seconds) limit = {seconds, reason};
      };
      if (stiffness > 0) take(experiment.solver.courant * 2 * std::sqrt(row / stiffness), "spring");
      if (damping > 0) take(experiment.solver.courant * 2 * row / damping, "dashpot");
    }
  }
  return limit;
}

/// USF with velocities that particles keep gains energy in proportion to the step: two colliding discs 1 % at the first of
/// these Courant numbers, two balls at the second, whatever the shape (docs/studies/extremes.md, "How long a step").
constexpr double kept_first_limit[2] = {0.2, 0.12};
/// The same of balls by USF with a filter that replaces velocities; FMPM divides it by the root of its order.
constexpr double filtered_first_limit = 0.4;

/// The largest Courant number that a combination stands, and what sets it.
struct CourantLimit {
  double number = std::numeric_limits<double>::infinity();
  std::string_view reason;
};

CourantLimit courant_limit(const Experiment& experiment) {
  const StressUpdate update = experiment.solver.stress_update;
  const std::uint32_t transfer = experiment.transfer.plugin->transfer().traits;
  const bool hands_on = experiment.filter && (experiment.filter->plugin->filter().traits & MPM_FILTERS_BEFORE_FORCES);
  const bool keeps = (transfer & MPM_GATHERS_INCREMENT) || hands_on;
  // An affine velocity carries the gradient of the grid's into the next step, whatever the order.
  const bool carries_gradient = (transfer & MPM_SCATTERS_AFFINE) && !(transfer & MPM_KEEPS_SPIN_ONLY);
  const bool by_carried = (update == StressUpdate::first || update == StressUpdate::modified_last) && !carries_gradient;
  CourantLimit limit;
  if (const auto* shape = extension_of<mpm_shape_courant_limit>(*experiment.shape.plugin)) {
    const mpm_strain_velocity strains = by_carried                              ? MPM_CARRIED_VELOCITY
                                        : keeps && update == StressUpdate::last ? MPM_KEPT_VELOCITY
                                                                                : MPM_GRID_VELOCITY;
    limit = {shape->limit[experiment.dimension - 2][strains], "shape"};
  }
  const auto hold_to = [&](double number) {
    if (update == StressUpdate::first && number < limit.number) limit = {number, "stress update"};
  };
  if (keeps)
    hold_to(kept_first_limit[experiment.dimension - 2]);
  else if (experiment.filter && experiment.dimension == 3)
    hold_to(filtered_first_limit);
  return limit;
}

}  // namespace

std::vector<ParameterSpec> explicit_parameters() {
  using Type = ParameterType;
  return {
      parameter("stress_update", Type::choice, "",
                "When a step updates stress: first (USF), last (USL), last from mapped-back velocities (MUSL), or half "
                "first and half last (averaged, USAVG).")
          .of({"first", "last", "modified_last", "averaged"})
          .standard("last"),
      parameter("time_step", Type::number, "s", "Fixed time step, or \"auto\" by the wave speed.")
          .above(0)
          .or_word("auto")
          .standard("auto"),
      parameter("courant", Type::number, "",
                "Automatic step as a fraction of cell size over fastest speed; never more than shape, transfer and "
                "stress update stand.")
          .above(0)
          .to(2)
          .standard(0.3),
      end_time_parameter(),
      parameter("dilation", Type::choice, "",
                "Dilation that strains a particle, and mean stress of its force: its own, or averages by the nodes "
                "around it, which keep nearly incompressible materials from locking.")
          .of({"own", "averaged"})
          .standard("own"),
      parameter("passes", Type::choice, "",
                "Whether a gather also scatters for the next step: auto fuses them where that is legal.")
          .of({"auto", "separate", "fused"})
          .standard("auto"),
      max_steps_parameter(),
  };
}

void read_explicit(const Fields& fields, SolverSpecification& solver) {
  solver.stress_update = static_cast<StressUpdate>(fields.choice("stress_update"));
  if (fields.text("time_step").empty()) solver.time_step = fields.number("time_step");
  solver.courant = fields.number("courant");
  solver.averages_dilation = fields.choice("dilation") == 1;
  solver.passes = static_cast<PassChoice>(fields.choice("passes"));
}

void explicit_step(StepBuilder& step) {
  const Experiment& scene = step.experiment();
  const StressUpdate update = scene.solver.stress_update;
  const bool averaged = update == StressUpdate::averaged, remaps = update == StressUpdate::modified_last;
  const bool stress_first = update == StressUpdate::first || averaged;
  const bool stress_last = update == StressUpdate::last || averaged;
  const double share = averaged ? 0.5 : 1;
  const std::string order = "/solver/stress_update", transfer = StepBuilder::named(scene.transfer);
  const std::string first = order + (averaged ? " \"averaged\"" : " \"first\""), again = order + " \"modified_last\"";
  const std::string contact = scene.meets() ? scene.why_it_meets() : "";
  const bool heats = scene.has_temperature();
  const std::string thermal = heats ? scene.materials[scene.bodies[0].material].thermal->pointer : "";
  FilterParts filter(step);
  const auto melts = [&] {
    for (const MaterialSpecification& material : scene.materials)
      if (material.thermal && material.thermal->phase_change)
        return (void)step.perform(Act::change_phase, material.thermal->phase_change->pointer, Stage::after_forces);
  };

  const bool averages = scene.solver.averages_dilation;
  const std::string mean = "/solver/dilation \"averaged\"";
  const auto average_dilation = [&](Stage stage) {
    if (!averages) return;
    step.perform(Act::scatter_dilation, mean, stage).share = share;
    step.perform(Act::average_dilation, mean, stage);
  };

  step.perform(Act::clear, transfer);
  step.perform(Act::scatter_momentum, transfer);
  if (!stress_first && !averages) step.perform(Act::scatter_force, transfer);
  if (scene.meets()) step.perform(Act::scatter_contact, contact);
  if (heats) step.perform(Act::scatter_heat, thermal);
  step.perform(Act::divide, scene.meets() ? contact + " before the forces; boundaries" : "boundaries");

  if (heats) {
    step.perform(Act::divide_heat, thermal);
    step.perform(Act::conduct, thermal);
    step.perform(Act::heat, thermal, Stage::after_forces);
  }
  filter.before_forces(stress_first);
  if (stress_first) {
    average_dilation(Stage::before_forces);
    step.perform(Act::strain, first).share = share;
  }
  if (averages) {
    step.perform(Act::scatter_mean_stress, mean);
    step.perform(Act::average_mean_stress, mean);
  }
  if (stress_first || averages)
    step.perform(Act::scatter_force, stress_first ? first + ": stress at the new strain" : mean);
  filter.unfilter_for_forces(stress_first);

  step.perform(Act::accelerate, scene.meets() ? contact + " after the forces; boundaries" : "boundaries",
               Stage::after_forces);
  filter.after_forces();

  if (stress_last) average_dilation(Stage::after_forces);
  if (filter.for_particles_only() && stress_last)
    step.perform(Act::strain, order + ": by the unfiltered velocity", Stage::after_forces).share = share;
  filter.before_gather();
  if (!scene.contact_state().empty()) step.perform(Act::keep_contact_state, contact, Stage::after_forces);
  step.perform(Act::gather, transfer, Stage::after_forces);
  if (heats) step.perform(Act::gather_heat, thermal, Stage::after_forces);
  if (!filter.for_particles_only() && stress_last)
    step.perform(Act::strain, transfer, Stage::after_forces).share = share;
  if (!remaps) step.perform(Act::move, transfer, Stage::after_forces);
  if (!remaps) return melts();

  step.perform(Act::scatter_momentum, again + ": updated velocities, old positions", Stage::remapped);
  step.perform(Act::divide, again, Stage::remapped);
  filter.remapped();
  average_dilation(Stage::remapped);
  step.perform(Act::strain, again, Stage::remapped);
  step.perform(Act::move, again + ": positions by the velocity gathered before", Stage::remapped);
  melts();
}

StepLimit explicit_limit(const Experiment& experiment, const TimeStepSpeeds& speeds) {
  const CourantLimit stands = courant_limit(experiment);
  const double wanted = experiment.solver.courant;
  StepLimit limit{std::min(wanted, stands.number) * experiment.grid.cell_size / speeds.speed,
                  wanted <= stands.number ? "wave" : stands.reason, true};
  if (experiment.filter)
    if (const auto* filtered = extension_of<mpm_filter_step_limit>(*experiment.filter->plugin))
      if (const double seconds = filtered->limit(experiment.filter->parameters.data(), limit.seconds);
          seconds < limit.seconds)
        limit = {seconds, "filter order", true};
  const StepLimit contact{experiment.contact_step_limit(), "contact"};
  for (const StepLimit& other : {thermal_limit(experiment), spring_limit(experiment), contact})
    if (other.seconds < limit.seconds) limit = other;
  return limit;
}

}  // namespace mpm

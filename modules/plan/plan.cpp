#include "plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <numeric>
#include <sstream>

#include "experiment/diagnostics.hpp"
#include "experiment/thermal.hpp"
#include "kernel/polynomial_basis.hpp"
#include "plan/compatibility.hpp"
#include "plan/step_builder.hpp"

namespace mpm {
namespace {

/// Gathers the plan of one experiment; every entry says which line asked for it.
class Planner {
 public:
  explicit Planner(const Experiment& experiment)
      : experiment_(experiment),
        transfer_(experiment.transfer.plugin->transfer()),
        shape_(experiment.shape.plugin->shape()),
        needs_(backend_needs(experiment.backend)) {}

  Plan make(const std::function<void(StepBuilder&)>& solver_step) {
    refuse_impossible_combinations();
    refuse_temperature();
    StepBuilder builder(experiment_);
    solver_step(builder);
    plan_.step = builder.take();
    join_visits(plan_.step);
    decide();
    surround_step();
    if (plan_.fused) fuse(plan_.step);
    particle_fields();
    node_fields();
    estimate();
    name_lines();
    describe_operators(plan_, experiment_);
    check_step(plan_);
    return std::move(plan_);
  }

 private:
  static std::string named(const Component& component) { return StepBuilder::named(component); }

  [[noreturn]] void refuse(const std::string& pointer, const std::string& message) const {
    Problem problem{experiment_.file.string(), 0, 0, pointer, message};
    for (const auto& [known, position] : experiment_.positions)
      if (known == pointer) problem.line = position.first, problem.column = position.second;
    throw InputError({problem});
  }

  void refuse_impossible_combinations() const {
    const FilterSchedule& schedule = experiment_.filter_schedule;
    Mix mix{experiment_.shape.plugin,
            experiment_.transfer.plugin,
            nullptr,
            nullptr,
            experiment_.solver.stress_update,
            schedule.every_steps == 1 && schedule.every_time == 0 && schedule.every_courant == 0,
            basis_order_of(experiment_.transfer)};
    if (experiment_.filter) mix.filter = experiment_.filter->plugin;
    if (experiment_.contact) mix.contact = experiment_.contact->plugin;
    const auto refusal = refusal_of(mix);
    if (!refusal) return refuse_common_schedules();
    const Component& at = refusal->at == MPM_SHAPE      ? experiment_.shape
                          : refusal->at == MPM_TRANSFER ? experiment_.transfer
                          : refusal->at == MPM_FILTER   ? *experiment_.filter
                                                        : *experiment_.contact;
    refuse(at.pointer, refusal->reason);
  }

  void refuse_temperature() const {
    if (!experiment_.has_temperature()) return;
    const Component& transfer = experiment_.transfer;
    if (const auto refusal = refusal_of_temperature(*transfer.plugin, basis_order_of(transfer)))
      refuse(transfer.pointer, *refusal);
  }

  /// A filter and a ledger that skip steps meet always, or never, where their numbers have a common divisor.
  void refuse_common_schedules() const {
    const FilterSchedule& schedule = experiment_.filter_schedule;
    const int every = experiment_.output.ledger_every;
    if (!experiment_.filter || schedule.every_time > 0 || schedule.every_courant > 0) return;
    if (const int common = std::gcd(every, schedule.every_steps); common > 1)
      refuse(
          "/output/ledger_every",
          std::to_string(every) + " and " + experiment_.filter->pointer + "/every_steps " +
              std::to_string(schedule.every_steps) + " have the divisor " + std::to_string(common) +
              " in common: the ledger would count the filter in too many steps or in none; take numbers without one, "
              "or 1");
  }

  /// Puts the line of the file before each reason, which starts with a JSON pointer; a default has no line.
  void name_lines() {
    const auto name = [&](std::string& because) {
      const std::string pointer = because.substr(0, because.find_first_of(" :"));
      for (const auto& [known, position] : experiment_.positions)
        if (known == pointer && position.first > 0) because = "line " + std::to_string(position.first) + ": " + because;
    };
    for (Field& field : plan_.fields) name(field.because);
    const std::function<void(Step&)> name_steps = [&](Step& step) {
      name(step.because);
      for (Operator& operation : step.pass.operators) name(operation.because);
      for (Step& child : step.children) name_steps(child);
    };
    name_steps(plan_.step);
  }

  void decide() {
    const bool moment_is_gradient = shape_.second_moment_kind == MPM_MOMENT_IS_GRADIENT;
    plan_.velocity_fields = experiment_.field_count;
    plan_.contact = experiment_.contact.has_value();
    plan_.ledger = experiment_.output.ledger;
    plan_.heat_ledger = plan_.ledger && experiment_.has_temperature();
    plan_.ledger_every = experiment_.output.ledger_every;
    plan_.velocity_increment = transfer_.traits & MPM_GATHERS_INCREMENT;
    plan_.affine_moment = transfer_.traits & (MPM_GATHERS_AFFINE | MPM_STRAIN_BY_AFFINE | MPM_STRESS_BY_AFFINE);
    plan_.velocity_gradient_moment = transfer_.traits & MPM_GATHERS_GRADIENT;
    plan_.weight_gradients = !(transfer_.traits & MPM_STRESS_BY_AFFINE) || !(transfer_.traits & MPM_STRAIN_BY_AFFINE) ||
                             plan_.contact || plan_.velocity_gradient_moment ||
                             (plan_.affine_moment && moment_is_gradient);
    plan_.particle_domain = experiment_.shape.plugin->descriptor->needs & MPM_NEEDS_DOMAIN;
    plan_.sample_points = static_cast<int>(shape_.sample_points[experiment_.dimension - 2]);
    plan_.second_moment = shape_.second_moment_kind == MPM_MOMENT_PER_PARTICLE &&
                          (plan_.affine_moment || (transfer_.traits & MPM_AFFINE_CARRIES_ENERGY));
    if (const int order = basis_order_of(experiment_.transfer); order > 0) {
      plan_.basis_order = std::min(order, static_cast<int>(shape_.width) - 1);
      plan_.basis_functions = basis_functions(experiment_.dimension, plan_.basis_order);
    }
    plan_.filter = experiment_.filter.has_value();
    // The reference backend keeps the stencils of a step; the others evaluate them anew in every pass.
    const bool strains_before_gather =
        strains_before_forces() || (plan_.filter && filters_before_forces() && strains_after_forces());
    plan_.strained_domain = plan_.particle_domain && strains_before_gather && needs_.forgets_stencils;
    plan_.kept_velocity = plan_.filter && (filters_before_forces() || strains_before_forces());
    plan_.constrained_velocity =
        plan_.filter && experiment_.filter_schedule.constrain_always && (plan_.contact || separates());
    decide_fusion();
    // A separating box decides twice, before and after the forces, so these may not come merged with the momentum.
    plan_.separate_force = plan_.velocity_increment || plan_.contact || experiment_.body_force.has_value() ||
                           separates() || strains_before_forces() || (plan_.filter && filters_before_forces());
    plan_.force_for_ledger = plan_.ledger && !plan_.separate_force;
    plan_.divides_with_forces = !plan_.filter && !plan_.separate_force && forces_follow_division(plan_.step);
    plan_.separate_force = plan_.separate_force || plan_.ledger || needs_.keeps_all_apart;
    plan_.kept_advection = experiment_.solver.stress_update == StressUpdate::modified_last;
    plan_.initial_position = experiment_.exact.has_value() || experiment_.output.colour_by == "displacement" ||
                             (experiment_.body_force && experiment_.body_force->uses_initial_position());
  }

  /// By the gradient of v-: USF, and half of USAVG.
  bool strains_before_forces() const {
    const StressUpdate update = experiment_.solver.stress_update;
    return update == StressUpdate::first || update == StressUpdate::averaged;
  }
  /// By the gradient of v+ as it stands after the forces: USL, and half of USAVG.
  bool strains_after_forces() const {
    const StressUpdate update = experiment_.solver.stress_update;
    return update == StressUpdate::last || update == StressUpdate::averaged;
  }
  /// The order as the file says it.
  std::string named_order() const {
    return std::string("/solver/stress_update ") +
           (experiment_.solver.stress_update == StressUpdate::averaged ? "\"averaged\"" : "\"first\"");
  }

  bool filters_before_forces() const { return experiment_.filter->plugin->filter().traits & MPM_FILTERS_BEFORE_FORCES; }

  void decide_fusion() {
    const PassChoice choice = experiment_.solver.passes;
    std::string& why = plan_.why_not_fused;
    why = why_not_fused(plan_.step, experiment_);
    // Separate passes sort where fused ones do, so that both add up in the same order. Images of a periodic axis may be
    // missing on the other side until a scatter has found them.
    plan_.sorts_before_gather = why.empty() && !any_face(ConditionType::periodic);
    if (choice == PassChoice::separate) why = "/solver/passes \"separate\"";
    plan_.fused = why.empty();
    if (choice == PassChoice::fused && !plan_.fused) refuse("/solver/passes", "passes cannot be fused: " + why);
  }

  /// A wall or box that material may leave.
  bool separates() const {
    return any_face(ConditionType::separate) ||
           std::any_of(experiment_.boxes.begin(), experiment_.boxes.end(),
                       [](const BoxCondition& box) { return box.type == ConditionType::separate; });
  }

  bool any_face(ConditionType type) const {
    for (int axis = 0; axis < experiment_.dimension; ++axis)
      for (const FaceCondition& face : experiment_.faces[axis])
        if (face.type == type) return true;
    return false;
  }

  std::uint64_t scalar_bytes() const { return experiment_.precision == Precision::single ? 4 : 8; }

  // ---- fields ----------------------------------------------------------------------------------------------------

  Field& particle_field(int body, const std::string& id, const std::string& unit, int components, First first,
                        const std::string& because) {
    Field field;
    field.id = id, field.name = id, field.unit = unit;
    field.owner = Owner::particle, field.body = body;
    field.components = components, field.first = first;
    field.bytes = components * scalar_bytes();
    field.because = because;
    plan_.fields.push_back(field);
    return plan_.fields.back();
  }

  /// The state that a plugin declares.
  void state(int body, const Component& component, Origin origin) {
    for (const mpm_state& declared : component.plugin->state()) {
      const First first = declared.initial == MPM_INITIAL_ZERO    ? First::zero
                          : declared.initial == MPM_INITIAL_ONE   ? First::one
                          : declared.shape == MPM_STATE_SYMMETRIC ? First::symmetric_identity
                                                                  : First::identity;
      particle_field(body, declared.name, declared.unit,
                     state_components(kept_shape(declared, experiment_.axisymmetric()), experiment_.dimension), first,
                     named(component) + ": " + declared.doc)
          .origin = origin;
    }
  }

  /// The transfer acts on the temperature as on the first component of a velocity, of a particle whose mass is its heat
  /// capacity: of its state a matrix keeps one row, a vector one scalar.
  void temperature_fields(int body) {
    const auto& thermal = experiment_.materials[experiment_.bodies[body].material].thermal;
    if (!thermal) return;
    particle_field(body, "temperature", "K", 1, First::seeded, thermal->pointer);
    for (const mpm_state& declared : experiment_.transfer.plugin->state())
      particle_field(body, temperature_state + std::string(declared.name), "K/m",
                     declared.shape == MPM_STATE_MATRIX ? experiment_.dimension : 1, First::zero,
                     named(experiment_.transfer) + ": acts on the temperature too");
    if (thermal->phase_change)
      particle_field(body, "melted_fraction", "", 1, First::seeded, thermal->phase_change->pointer);
  }

  /// The order is that of the places in a particle's memory: what a gather may replace stands together.
  void particle_fields() {
    const int D = experiment_.dimension;
    for (int body = 0; body < static_cast<int>(experiment_.bodies.size()); ++body) {
      const BodySpecification& specification = experiment_.bodies[body];
      const auto seeded = [&](const std::string& id, const std::string& unit, int components,
                              const std::string& because) -> Field& {
        return particle_field(body, id, unit, components, First::seeded, because);
      };
      seeded("position", "m", D, specification.pointer + ": every particle");
      seeded("velocity", "m/s", D, specification.pointer + ": every particle");
      state(body, experiment_.transfer, Origin::transfer);
      if (plan_.basis_functions > 0)
        particle_field(body, polynomial_coefficients, "m/s", D * plan_.basis_functions, First::zero,
                       named(experiment_.transfer) + ": " + std::to_string(plan_.basis_functions) +
                           " polynomials beyond the affine ones")
            .origin = Origin::transfer;
      state(body, experiment_.materials[specification.material].component, Origin::material);
      temperature_fields(body);
      if (needs_.sorts)
        seeded("identity", "", 1, specification.pointer + ": results keep the order of seeding").bytes = 4;
      if (experiment_.axisymmetric())
        seeded("circumference", "m", 1,
               "/grid/symmetry \"axisymmetric\": a particle is a ring of volume and mass times 2 pi r");
      if (plan_.initial_position)
        seeded("initial_position", "m", D,
               experiment_.exact        ? experiment_.exact->pointer + ": errors are measured at X"
               : experiment_.body_force ? experiment_.body_force_pointer + ": the force depends on X"
                                        : "/output/colour_by \"displacement\"")
            .lifetime = Lifetime::seeded;
      if (plan_.kept_advection || needs_.keeps_all_apart)
        particle_field(body, "advection_velocity", "m/s", D, First::zero,
                       plan_.kept_advection
                           ? "/solver/stress_update \"modified_last\": positions wait for the remapped strain"
                           : why_apart())
            .lifetime = Lifetime::step;
      if (plan_.sample_points > 0) {
        particle_field(body, "corners", "cells", D * plan_.sample_points, First::half_size_corners,
                       named(experiment_.shape) + ": corners of the domain");
        if (plan_.kept_advection || needs_.keeps_all_apart)
          particle_field(body, "moved_corners", "cells", D * plan_.sample_points, First::half_size_corners,
                         plan_.kept_advection
                             ? "/solver/stress_update \"modified_last\": corners wait for the remapped strain"
                             : why_apart())
              .lifetime = Lifetime::step;
      }
      if (plan_.particle_domain)
        particle_field(body, "domain", "cells", D * D, First::half_size_diagonal,
                       named(experiment_.shape) + ": semi-side vectors of the particle's domain");
      if (plan_.strained_domain)
        particle_field(body, "strained_domain", "cells", D * D, First::half_size_diagonal,
                       strains_before_forces()
                           ? named_order() + ": the weights of a step stay those before its strain"
                           : named(*experiment_.filter) + ": the weights of a step stay those before its strain")
            .lifetime = Lifetime::step;
    }
  }

  /// Nodes hold groups of four scalars, the width of a vector register's lane group; a scalar may stand in its vector's.
  Field& node_field(const std::string& id, const std::string& unit, int components, const std::string& because,
                    const std::string& beside = "") {
    Field field;
    field.id = id, field.name = id, field.unit = unit;
    field.owner = Owner::node, field.lifetime = Lifetime::step;
    field.components = components;
    field.beside = beside;
    if (beside.empty()) field.bytes = 4 * scalar_bytes() * experiment_.field_count;
    field.because = because;
    plan_.fields.push_back(field);
    return plan_.fields.back();
  }

  /// Where the backend works in place, the field takes the memory of one that nobody reads any more.
  void in_place_of(const std::string& other, Field& field) const {
    if (needs_.keeps_all_apart) return;
    field.in_place_of = other;
    field.bytes = 0;
  }

  std::string why_apart() const { return "/backend \"" + experiment_.backend + "\" keeps all values apart"; }

  /// A field that particles are summed into.
  Field& summed_field(const std::string& id, const std::string& unit, int components, AtWall at_wall, Folded folded,
                      const std::string& because, const std::string& beside = "") {
    Field& field = node_field(id, unit, components, because, beside);
    field.at_wall = at_wall, field.folded = folded, field.cleared = true;
    return field;
  }

  void node_fields() {
    const int D = experiment_.dimension;
    const std::string transfer = named(experiment_.transfer) + ": every transfer";
    summed_field("momentum", "kg m/s", D, AtWall::momentum, Folded::with_mass, transfer);
    summed_field("mass", "kg", 1, AtWall::even, Folded::with_mass, transfer, "momentum");
    in_place_of("momentum", node_field("velocity", "m/s", D, transfer));
    if (plan_.fused) {
      const std::string fused = "/solver/passes: gather and scatter are one";
      node_field("next_momentum", "kg m/s", D, fused);
      node_field("next_mass", "kg", 1, fused, "next_momentum");
    }
    if (plan_.filter) {
      node_field("increment", "m/s", D, named(*experiment_.filter));
      const bool loops = experiment_.filter->plugin->filter().iterations(experiment_.filter->parameters.data()) > 0;
      if (loops) node_field("projection", "kg m/s", D, named(*experiment_.filter));
      if (loops && experiment_.filter_schedule.constrain_always) {
        Field& trial =
            node_field("trial_velocity", "m/s", D, named(*experiment_.filter) + ": before conditions and contact");
        trial.lifetime = Lifetime::pass;
        in_place_of("projection", trial);
      }
    }
    if (plan_.kept_velocity)
      node_field(
          "unfiltered_velocity", "m/s", D,
          named(*experiment_.filter) + (filters_before_forces() ? ": strains; then the correction of the particles"
                                                                : ": the strain comes before the forces"));
    if (plan_.constrained_velocity) {
      const std::string because = named(*experiment_.filter) + ": an increment may take back what a one-sided law gave";
      node_field("velocity_of_constraints", "m/s", D, because).name = "velocity that conditions and contact added";
      if (plan_.kept_velocity)
        node_field("unfiltered_velocity_of_constraints", "m/s", D, because).name =
            "the same of the unfiltered velocity";
    }
    if (plan_.velocity_increment || plan_.ledger || needs_.keeps_all_apart) {
      Field& before =
          node_field("velocity_before", "m/s", D,
                     plan_.velocity_increment ? named(experiment_.transfer) + ": gathers the change of velocity"
                     : plan_.ledger           ? why_for_ledger()
                                              : why_apart());
      before.cleared = true, before.for_ledger = !plan_.velocity_increment;
    }
    if (plan_.separate_force)
      summed_field("force", "N", D, AtWall::vector, Folded::with_force, why_separate_force()).for_ledger =
          plan_.force_for_ledger;
    if (experiment_.body_force)
      summed_field("body_force", "N", D, AtWall::vector, Folded::with_force,
                   experiment_.body_force_pointer + ": its work is accounted for apart");
    if (needs_.keeps_weight_apart)
      summed_field("weight", "N", D, AtWall::vector, Folded::with_force, "/gravity: its work is accounted for apart");
    if (plan_.contact) {
      const std::string normal = experiment_.contact->pointer + "/normal \"average_volume_gradient\"";
      summed_field("volume_gradient", "m^2", D, AtWall::slip, Folded::with_mass, normal);
      summed_field("volume", "m^3", 1, AtWall::even, Folded::with_mass, normal, "volume_gradient");
      summed_field("mass_position", "kg m", D, AtWall::slip, Folded::with_mass,
                   experiment_.contact->pointer + "/detection \"approach_and_position\"");
    }
    if (experiment_.has_temperature()) temperature_fields_of_nodes();
    for (Field& field : plan_.fields)
      if (field.name == field.id) std::replace(field.name.begin(), field.name.end(), '_', ' ');
  }

  void temperature_fields_of_nodes() {
    const std::string because = experiment_.materials[experiment_.bodies[0].material].thermal->pointer;
    summed_field("heat", "J", 1, AtWall::heat, Folded::with_mass, because);
    summed_field("heat_capacity", "J/K", 1, AtWall::even, Folded::with_mass, because, "heat");
    in_place_of("heat", node_field("temperature", "K", 1, because));
    summed_field("heat_rate", "W", 1, AtWall::heat_rate, Folded::with_force, because);
    if (plan_.velocity_increment || needs_.keeps_all_apart)
      node_field(
          "temperature_before", "K", 1,
          plan_.velocity_increment ? named(experiment_.transfer) + ": gathers the change of temperature" : why_apart())
          .cleared = true;
    for (const auto& faces : experiment_.faces)
      for (const FaceCondition& face : faces) {
        if (!passes_heat(face) || plan_.node_field("heated_volume")) continue;
        const std::string& wall = face.thermal.pointer;
        summed_field("heated_volume", "m^3", 1, AtWall::even, Folded::with_mass,
                     wall + ": makes the area of the wall that a node stands for");
        summed_field("volume_conductivity", "W m^2/K", 1, AtWall::even, Folded::with_mass,
                     wall + ": makes the gradient of the temperature at the wall", "heated_volume");
        if ((experiment_.transfer.plugin->transfer().traits & MPM_SCATTERS_AFFINE) == 0)
          summed_field("capacity_position", "J m/K", experiment_.dimension, AtWall::slip, Folded::with_mass,
                       wall + ": " + named(experiment_.transfer) + " carries no gradient to the mirror image");
      }
  }

  std::string why_for_ledger() const {
    const std::string every = std::to_string(plan_.ledger_every);
    return "/output/ledger: work of the forces" + (plan_.ledger_every > 1 ? ", in one step of " + every : "");
  }

  std::string why_separate_force() const {
    if (plan_.velocity_increment) return named(experiment_.transfer) + ": gathers the change of velocity";
    if (plan_.contact) return named(*experiment_.contact) + ": acts before and after the forces";
    if (plan_.force_for_ledger) return why_for_ledger();
    if (experiment_.body_force) return experiment_.body_force_pointer + ": work of the forces";
    if (strains_before_forces()) return named_order() + ": stress after the momenta";
    if (plan_.filter && filters_before_forces()) return named(*experiment_.filter) + ": filters before the forces";
    if (needs_.keeps_all_apart && !separates()) return why_apart();
    return "/grid/boundaries \"separate\": the wall predicts with the forces";
  }

  // ---- the step ------------------------------------------------------------------------------------------------------

  /// What the backend and the automatic time step add to the solver's step.
  void surround_step() {
    std::vector<Step>& steps = plan_.step.children;
    const auto pass = [](Act act, const std::string& because, int every_steps = 1) {
      Step step;
      step.kind = Step::Kind::pass;
      step.pass.every_steps = every_steps;
      Operator operation;
      operation.act = act;
      operation.because = because;
      step.pass.add(std::move(operation));
      return step;
    };
    if (plan_.sorts_before_gather) {
      const auto gather = std::find_if(steps.begin(), steps.end(), [](const Step& step) {
        return step.kind == Step::Kind::pass && step.pass.has(Act::gather);
      });
      steps.insert(gather, pass(Act::sort_ahead,
                                "/backend \"cpu\": particles that are about to leave the nodes around their block"));
    }
    if (needs_.sorts)
      steps.insert(steps.begin(), pass(Act::sort, "/backend \"cpu\": particles stay in their blocks of cells"));
    const bool by_courant = plan_.filter && experiment_.filter_schedule.every_courant > 0;
    if (!experiment_.solver.time_step || by_courant)
      steps.insert(steps.begin(),
                   pass(Act::estimate_time_step,
                        by_courant && experiment_.solver.time_step ? experiment_.filter->pointer + "/every_courant"
                                                                   : "/solver/time_step \"auto\"",
                        8));
  }

  // ---- memory, before anything is allocated ----------------------------------------------------------------------

  /// Share of a body's bounding box that it fills, from a fixed low-discrepancy sample.
  static double filled_share(const Geometry& geometry, const Vector3& lower, const Vector3& upper) {
    constexpr int samples = 4096;
    int inside = 0;
    for (int k = 0; k < samples; ++k) {
      const double u[3] = {std::fmod(0.5 + k * 0.8191725133961645, 1.0), std::fmod(0.5 + k * 0.6710436067037893, 1.0),
                           std::fmod(0.5 + k * 0.5497004779019703, 1.0)};
      Vector3 x{};
      for (int c = 0; c < 3; ++c) x[c] = lower[c] + u[c] * (upper[c] - lower[c]);
      inside += geometry.contains(x);
    }
    return std::max(inside, 1) / static_cast<double>(samples);
  }

  double estimated_particles(const BodySpecification& body) const {
    auto [lower, upper] = body.geometry->bounds();
    double count = 1;
    for (int c = 0; c < experiment_.dimension; ++c) {
      lower[c] = std::max(lower[c], experiment_.grid.lower[c]);
      upper[c] = std::min(upper[c], experiment_.grid.upper[c]);
      count *= std::max(0.0, (upper[c] - lower[c]) / experiment_.grid.cell_size * body.particles_per_cell_axis);
    }
    return count * filled_share(*body.geometry, lower, upper);
  }

  void estimate() {
    const int D = experiment_.dimension;
    const double padding = shape_.form == MPM_NODE_LIST ? 8 : 3;  // nodes beyond a wall: grid_padding_of(shape)
    double particles = 0, particle_bytes = 0, occupied_cells = 0, domain_nodes = 1;
    for (std::size_t b = 0; b < experiment_.bodies.size(); ++b) {
      const double count = estimated_particles(experiment_.bodies[b]);
      particles += count;
      particle_bytes += count * static_cast<double>(plan_.bytes_per_particle(static_cast<int>(b)));
      occupied_cells += count / std::pow(experiment_.bodies[b].particles_per_cell_axis, D);
    }
    for (int c = 0; c < D; ++c) domain_nodes *= experiment_.grid.cells[c] + 1 + 2 * padding;
    // The cpu backend keeps blocks around particles only: a body's cells and a rim of about one block on every side.
    const double rim = 12 * D * std::pow(occupied_cells, (D - 1.0) / D) * (D == 2 ? 8 : 4) / 4 + 4096;
    const double nodes =
        experiment_.backend == "cpu" ? std::min(domain_nodes * 2, 1.3 * occupied_cells + rim) : domain_nodes;
    if (experiment_.backend == "cpu")
      particle_bytes += particle_bytes * 3 / 10;  // of batches that are not full, and of those that a sort is moving
    // The reference backend keeps stencils and all moments of a particle, and every value of a node side by side.
    const bool list = shape_.form == MPM_NODE_LIST;
    const double stencil = (list ? shape_.capacity[D - 2] * (100.0 + 12 * D) : std::pow(shape_.width, D) * 88.0) + 700;
    if (experiment_.backend == "reference") particle_bytes += particles * stencil;
    const double grid_bytes =
        nodes * (experiment_.backend == "reference" ? 290.0 * experiment_.field_count
                                                    : static_cast<double>(plan_.bytes_per_node()));
    refuse_too_large(particles, particle_bytes, grid_bytes);
    plan_.particles = static_cast<std::uint64_t>(particles);
    plan_.nodes = static_cast<std::uint64_t>(nodes);
    plan_.particle_bytes = static_cast<std::uint64_t>(particle_bytes);
    plan_.grid_bytes = static_cast<std::uint64_t>(grid_bytes);
  }

  /// Free memory of the machine, or what its control group leaves.
  static double available_bytes() {
    double available = 8e9;
    std::ifstream file("/proc/meminfo");
    for (std::string line; std::getline(file, line);)
      if (unsigned long long kilobytes = 0; std::sscanf(line.c_str(), "MemAvailable: %llu kB", &kilobytes) == 1)
        available = static_cast<double>(kilobytes) * 1024.0;
    double limit = 0, used = 0;
    if (std::ifstream("/sys/fs/cgroup/memory.max") >> limit && std::ifstream("/sys/fs/cgroup/memory.current") >> used)
      available = std::min(available, limit - used);
    return available;
  }

  void refuse_too_large(double particles, double particle_bytes, double grid_bytes) const {
    const double needed = particle_bytes + grid_bytes, available = available_bytes();
    if (particles < 2e9 && needed < 0.9 * available) return;
    std::ostringstream message;
    message.precision(3);
    message << "the scene needs about " << needed / 1e9 << " GB (" << particles << " particles, "
            << particle_bytes / 1e9 << " GB of state, " << grid_bytes / 1e9 << " GB of grid), and " << available / 1e9
            << " GB are free; use larger cells, fewer particles a cell or smaller bodies";
    refuse("/grid/cell_size", message.str());
  }

  const Experiment& experiment_;
  const mpm_transfer& transfer_;
  const mpm_shape& shape_;
  BackendNeeds needs_;
  Plan plan_;
};

}  // namespace

BackendNeeds backend_needs(std::string_view backend) {
  BackendNeeds needs;
  needs.sorts = needs.fuses = backend == "cpu";
  needs.forgets_stencils = backend != "reference";
  needs.keeps_all_apart = needs.keeps_weight_apart = backend != "cpu";
  return needs;
}

Plan assemble_plan(const Experiment& experiment, const std::function<void(StepBuilder&)>& solver_step) {
  return Planner(experiment).make(solver_step);
}

}  // namespace mpm

#include "plan/plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "experiment/thermal.hpp"
#include "kernel/polynomial_basis.hpp"
#include "plan/compatibility.hpp"
#include "plan/field_list.hpp"
#include "plan/memory.hpp"
#include "plan/step_builder.hpp"

namespace mpm {
namespace {

void refuse_impossible_combinations(const Experiment& experiment) {
  const FilterSchedule& schedule = experiment.filter_schedule;
  Mix mix{experiment.shape.plugin,
          experiment.transfer.plugin,
          nullptr,
          nullptr,
          experiment.solver.stress_update,
          schedule.every_steps == 1 && schedule.every_time == 0 && schedule.every_courant == 0,
          basis_order_of(experiment.transfer)};
  if (experiment.filter) mix.filter = experiment.filter->plugin;
  if (experiment.contact) mix.contact = experiment.contact->plugin;
  const auto refusal = refusal_of(mix);
  if (!refusal) return;
  const Component& at = refusal->at == MPM_SHAPE      ? experiment.shape
                        : refusal->at == MPM_TRANSFER ? experiment.transfer
                        : refusal->at == MPM_FILTER   ? *experiment.filter
                                                      : *experiment.contact;
  refuse(experiment, at.pointer, refusal->reason);
}

void refuse_temperature(const Experiment& experiment) {
  if (!experiment.has_temperature()) return;
  const Component& transfer = experiment.transfer;
  if (const auto refusal = refusal_of_temperature(*transfer.plugin, basis_order_of(transfer)))
    refuse(experiment, transfer.pointer, *refusal);
  if (const auto refusal = refusal_of_gradients(experiment)) refuse(experiment, experiment.shape.pointer, *refusal);
}

/// A normal of each body's own makes two impulses of one, which not everybody can take.
void refuse_normal(const Experiment& experiment) {
  if (!experiment.contact_normal) return;
  const Component& normal = *experiment.contact_normal;
  const mpm_normal& functions = normal.plugin->normal();
  const std::string name = "contact normal \"" + std::string(normal.plugin->id()) + "\"";
  if (functions.traits & MPM_OWN_NORMALS) {
    const std::string why = name + " gives each body an impulse of its own, and ";
    if (experiment.filter)
      refuse(experiment, normal.pointer, why + "a filter hands on one for both; take another normal, or no filter");
    const Plugin& detection = *experiment.contact_detection->plugin;
    if (detection.detection().traits & MPM_READS_PARTICLE_SURFACES)
      refuse(experiment, normal.pointer,
             why + "\"" + std::string(detection.id()) +
                 "\" measures the gap along a normal that both share; take another normal, or a detection by means, as "
                 "\"approach_and_position\"");
  }
  if (functions.traits != 0) return;
  // What reads nothing of the scene is known before it runs.
  std::array<double, 3 * MPM_LANES> found_normal{};
  std::array<std::int32_t, MPM_LANES> found{};
  mpm_normal_batch batch{};
  batch.count = batch.stride = MPM_LANES, batch.dimension = static_cast<std::uint32_t>(experiment.dimension);
  batch.normal = found_normal.data(), batch.found = found.data();
  functions.from_sums[MPM_SCALAR_DOUBLE][experiment.dimension - 2](normal.parameters.data(), &batch);
  if (!found[0]) refuse(experiment, normal.pointer, name + " gives no direction: its components are all zero");
}

/// Refuses a fixed step in which a law would not act as its parameters say.
void refuse_long_step(const Experiment& experiment) {
  const double most = experiment.contact_step_limit();
  if (!experiment.solver.time_step || *experiment.solver.time_step <= most) return;
  const double unit =
      std::pow(10, std::floor(std::log10(most)) - 5);  // a number that is rounded up would be refused again
  std::ostringstream message;
  message << "contact \"" << experiment.contact->plugin->id() << "\" stands steps of at most "
          << std::floor(most / unit) * unit
          << " s between these bodies on these cells; take that or a shorter step, \"auto\", or a softer law";
  refuse(experiment, "/solver/time_step", message.str());
}

/// A law that holds bodies together as far as they are near needs to know how far apart they are.
void refuse_detection(const Experiment& experiment) {
  if (!experiment.contact) return;
  const Plugin &law = *experiment.contact->plugin, &detection = *experiment.contact_detection->plugin;
  const bool holds_at_a_distance = (law.contact().traits & MPM_READS_TRACTION) || !law.state().empty();
  if (detection.detection().traits == 0 && holds_at_a_distance)
    refuse(experiment, experiment.contact_detection->pointer,
           "contact \"" + std::string(law.id()) + "\" holds bodies that are near one another, and detection \"" +
               std::string(detection.id()) + "\" takes no gap for open; take \"approach_and_position\"");
}

/// What a law that acts over time, by springs or by a state, cannot be combined with.
void refuse_laws(const Experiment& experiment) {
  const auto name_of = [](const Component& law) { return "contact \"" + std::string(law.plugin->id()) + "\""; };
  const auto refuse_in_filter = [&](const Component& law) {
    if (experiment.filter && !experiment.filter_schedule.takes_back &&
        (law.plugin->contact().traits & MPM_ACTS_OVER_TIME))
      refuse(experiment, law.pointer,
             name_of(law) +
                 " gives an impulse that grows with the step, and a filter that does not take back what contact "
                 "gave would add it again; take \"constraints\": \"every_increment\" in the filter");
  };
  refuse_detection(experiment);
  for (const RigidBodySpecification& body : experiment.rigid_bodies) {
    refuse_in_filter(body.contact);
    if (body.contact.plugin->contact().traits & MPM_COMPLIANT)
      refuse(experiment, body.contact.pointer,
             name_of(body.contact) +
                 " joins particles by springs, and a rigid body has none; let a body that grips "
                 "hold be the partner, or take another law");
    if (body.contact.plugin->contact().traits & MPM_READS_TRACTION)
      refuse(
          experiment, body.contact.pointer,
          name_of(body.contact) +
              " asks for the traction around a node, which is measured between bodies of particles alone; let a body "
              "that grips hold be the partner, or take another law");
    if (!body.contact.plugin->state().empty())
      refuse(experiment, body.contact.pointer,
             name_of(body.contact) +
                 " keeps a state on the particles of both bodies, and a rigid body has none; let a body that grips "
                 "hold be the partner, or take another law");
  }
  if (!experiment.contact) return;
  refuse_in_filter(*experiment.contact);
  if (const std::string changer = experiment.changer_of_particles();
      !changer.empty() && (!experiment.contact_state().empty() || experiment.has_compliant_contact()))
    refuse(experiment, experiment.contact->pointer,
           name_of(*experiment.contact) + " holds particles by what became of them since the start, and " + changer +
               " changes which there are; take another law, or remove it");
  refuse_long_step(experiment);
  if (!experiment.contact_state().empty() && experiment.field_count > 2)
    refuse(experiment, experiment.contact->pointer,
           name_of(*experiment.contact) +
               " keeps a state on particles, which does not say towards which body, and here there are " +
               std::to_string(experiment.field_count) +
               " velocity fields; give bodies one \"field\", so that two are left, or take another law");
  if (!experiment.contact_state().empty() && experiment.any_face(ConditionType::periodic))
    refuse(experiment, experiment.contact->pointer,
           name_of(*experiment.contact) +
               " keeps a state on particles, which take it from nodes whose images beyond a periodic face know nothing "
               "of it; close the periodic axis, or take another law");
  if (experiment.has_compliant_contact() && experiment.any_face(ConditionType::periodic))
    refuse(experiment, experiment.contact->pointer,
           name_of(*experiment.contact) +
               " pulls by how far particles have moved, which jumps where they come in again "
               "at the other side; close the periodic axis, or take another law");
  if (experiment.measures_traction() && experiment.any_face(ConditionType::periodic))
    refuse(experiment, experiment.contact->pointer,
           name_of(*experiment.contact) +
               " asks for the traction around a node, whose neighbours end at a periodic face; close the periodic "
               "axis, or take another law");
}

/// A filter and a ledger that skip steps meet always, or never, where their numbers have a common divisor.
void refuse_common_schedules(const Experiment& experiment) {
  const FilterSchedule& schedule = experiment.filter_schedule;
  const int every = experiment.output.ledger_every;
  if (!experiment.filter || schedule.every_time > 0 || schedule.every_courant > 0) return;
  if (const int common = std::gcd(every, schedule.every_steps); common > 1)
    refuse(experiment, "/output/ledger_every",
           std::to_string(every) + " and " + experiment.filter->pointer + "/every_steps " +
               std::to_string(schedule.every_steps) + " have the divisor " + std::to_string(common) +
               " in common: the ledger would count the filter in too many steps or in none; take numbers without one, "
               "or 1");
}

/// The numbers that the components' own descriptions give.
void take_numbers(Plan& plan, const Experiment& experiment) {
  const mpm_transfer& transfer = experiment.transfer.plugin->transfer();
  const mpm_shape& shape = experiment.shape.plugin->shape();
  plan.velocity_fields = experiment.field_count;
  plan.ledger_every = experiment.output.ledger ? experiment.output.ledger_every : 0;
  plan.sample_points = static_cast<int>(shape.sample_points[experiment.dimension - 2]);
  plan.basis_order = basis_order_of(experiment.transfer, *experiment.shape.plugin);
  plan.basis_functions = basis_functions(experiment.dimension, plan.basis_order);
  const bool moment_is_gradient = shape.second_moment_kind == MPM_MOMENT_IS_GRADIENT;
  const bool affine = transfer.traits & (MPM_GATHERS_AFFINE | MPM_STRAIN_BY_AFFINE | MPM_STRESS_BY_AFFINE);
  const bool both_by_affine = (transfer.traits & MPM_STRESS_BY_AFFINE) && (transfer.traits & MPM_STRAIN_BY_AFFINE);
  plan.stencil.affine_moment = affine;
  plan.stencil.gradients = !both_by_affine || plan.resolves_contact() || (transfer.traits & MPM_GATHERS_GRADIENT) ||
                           (affine && moment_is_gradient) || !experiment.loaded_at_points().empty();
  plan.stencil.second_moment =
      shape.second_moment_kind == MPM_MOMENT_PER_PARTICLE && (affine || (transfer.traits & MPM_AFFINE_CARRIES_ENERGY));
}

/// Throws std::logic_error where a solver performs what only a component can ask for and the scene has none.
void refuse_work_for_nobody(const Step& step, const Experiment& experiment) {
  const auto missing = [&](Act act) -> const char* {
    switch (act) {
      case Act::begin_filter:
      case Act::keep_velocity:
      case Act::project:
      case Act::update_filter:
      case Act::end_filter:
      case Act::restore_velocity:
      case Act::keep_correction:
      case Act::add_correction:
        return experiment.filter ? nullptr : "filter";
      case Act::scatter_contact:
        return experiment.meets() ? nullptr : "contact";
      case Act::keep_contact_state:
        return experiment.contact_state().empty() ? "contact law with a state" : nullptr;
      case Act::scatter_heat:
      case Act::divide_heat:
      case Act::conduct:
      case Act::heat:
      case Act::gather_heat:
      case Act::change_phase:
        return experiment.has_temperature() ? nullptr : "temperature";
      case Act::scatter_mean_stress:
      case Act::average_mean_stress:
      case Act::scatter_dilation:
      case Act::average_dilation:
        return experiment.solver.averages_dilation ? nullptr : "average of the dilation";
      default:
        return nullptr;
    }
  };
  for_each_pass(step, [&](const Pass& pass) {
    for (const Operator& operation : pass.operators)
      if (const char* component = missing(operation.act))
        throw std::logic_error(std::string("the step does what the scene has no ") + component + " for: operator \"" +
                               single(operation.act, "").pass.name() + "\" (" + operation.because + ")");
  });
}

/// Decides on fusion, and adds what the backend and the automatic time step need to the solver's step.
void surround_step(Plan& plan, const Experiment& experiment) {
  std::vector<Step>& steps = plan.step.children;
  plan.why_not_fused = why_not_fused(plan.step, experiment);
  // Separate passes sort where fused ones do, so that both add up in the same order. Images of a periodic axis may be
  // missing on the other side until a scatter has found them.
  if (plan.fused() && !experiment.any_face(ConditionType::periodic)) {
    const auto gather = std::find_if(steps.begin(), steps.end(), [](const Step& step) {
      return step.kind == Step::Kind::pass && step.pass.has(Act::gather);
    });
    steps.insert(gather, single(Act::sort_ahead,
                                "/backend \"cpu\": particles that are about to leave the nodes around their block"));
  }
  if (experiment.solver.passes == PassChoice::separate) plan.why_not_fused = "/solver/passes \"separate\"";
  if (experiment.solver.passes == PassChoice::fused && !plan.fused())
    refuse(experiment, "/solver/passes", "passes cannot be fused: " + plan.why_not_fused);
  if (backend_needs(experiment.backend).sorts)
    steps.insert(steps.begin(), single(Act::sort, "/backend \"cpu\": particles stay in their blocks of cells"));
  const bool by_courant = experiment.filter && experiment.filter_schedule.every_courant > 0;
  if (!experiment.solver.time_step || by_courant)
    steps.insert(steps.begin(),
                 single(Act::estimate_time_step,
                        by_courant && experiment.solver.time_step ? experiment.filter->pointer + "/every_courant"
                                                                  : "/solver/time_step \"auto\"",
                        8));
  if (plan.fused()) fuse(plan.step);
}

std::uint32_t acts_of(const Step& step) {
  std::uint32_t acts = 0;
  for_each_pass(step, [&](const Pass& pass) { acts |= pass.acts; });
  return acts;
}

/// Puts the line of the file before each reason, which starts with a JSON pointer; a default has no line.
void name_lines(Plan& plan, const Experiment& experiment) {
  const auto name = [&](std::string& because) {
    const std::string pointer = because.substr(0, because.find_first_of(" :"));
    for (const auto& [known, position] : experiment.positions)
      if (known == pointer && position.first > 0) because = "line " + std::to_string(position.first) + ": " + because;
  };
  for (Field& field : plan.fields) name(field.because);
  const std::function<void(Step&)> name_steps = [&](Step& step) {
    name(step.because);
    for (Operator& operation : step.pass.operators) name(operation.because);
    for (Step& child : step.children) name_steps(child);
  };
  name_steps(plan.step);
}

}  // namespace

BackendNeeds backend_needs(std::string_view backend) {
  BackendNeeds needs;
  needs.sorts = needs.fuses = backend == "cpu";
  needs.forgets_stencils = backend != "reference";
  needs.keeps_all_apart = backend == "reference";
  needs.shares_memory = backend == "cpu";
  needs.launches = backend == "cuda";
  return needs;
}

Plan assemble_plan(const Experiment& experiment, const std::function<void(StepBuilder&)>& solver_step) {
  refuse_impossible_combinations(experiment);
  refuse_normal(experiment);
  refuse_laws(experiment);
  refuse_common_schedules(experiment);
  refuse_temperature(experiment);
  Plan plan;
  StepBuilder builder(experiment);
  solver_step(builder);
  plan.step = builder.take();
  refuse_work_for_nobody(plan.step, experiment);
  join_visits(plan.step);
  surround_step(plan, experiment);
  plan.acts = acts_of(plan.step);
  take_numbers(plan, experiment);
  plan.advance = advance_of(plan, experiment);
  FieldList fields(plan, experiment);
  declare_particle_fields(fields);
  declare_node_fields(fields);
  estimate_memory(plan, experiment);
  name_lines(plan, experiment);
  describe_operators(plan, experiment);
  check_step(plan);
  return plan;
}

}  // namespace mpm

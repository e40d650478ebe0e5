// Which operators one visit of a particle or node does. A visit may go on with the next operator where that reads
// nothing that other particles or nodes have still to give; backends have these visits: what is scattered together, what
// is gathered together, a filter's beginning and end, and (fused) a gather with the scatter of the next step.

#include <algorithm>

#include "plan/step_builder.hpp"

namespace mpm {
namespace {

constexpr bool scatters(Act act) {
  return act == Act::scatter_momentum || act == Act::scatter_force || act == Act::scatter_contact ||
         act == Act::scatter_heat;
}

/// Whether the visit `before` may go on with the first operator of `after`.
bool joins(const Pass& before, const Pass& after) {
  if (before.every_steps != after.every_steps || before.stage != after.stage) return false;
  const Act last = before.operators.back().act, next = after.operators.front().act;
  if (scatters(last)) return scatters(next);
  if (before.has(Act::gather))
    return next == Act::gather_heat || next == Act::strain || next == Act::move || next == Act::change_phase;
  return (last == Act::begin_filter && next == Act::keep_velocity) ||
         (last == Act::restore_velocity && next == Act::keep_correction);
}

bool is_pass(const Step& step, Act act) {
  return step.kind == Step::Kind::pass && step.pass.has(act);
}

const Pass* find_pass(const Step& step, Act act) {
  const Pass* found = nullptr;
  for_each_pass(step, [&](const Pass& pass) {
    if (!found && pass.has(act)) found = &pass;
  });
  return found;
}

}  // namespace

Pass Pass::before_next_step() const {
  Pass own = *this;
  own.operators.clear();
  own.acts = 0;
  for (const Operator& operation : operators) {
    if (operation.act == Act::clear) break;
    own.add(operation);
  }
  return own;
}

void join_visits(Step& step) {
  std::vector<Step> joined;
  for (Step& child : step.children) {
    join_visits(child);
    Step* const last = joined.empty() ? nullptr : &joined.back();
    if (last && last->kind == Step::Kind::pass && child.kind == Step::Kind::pass && joins(last->pass, child.pass)) {
      last->pass.share = std::min(last->pass.share, child.pass.share);
      for (Operator& operation : child.pass.operators) last->pass.add(std::move(operation));
    } else {
      joined.push_back(std::move(child));
    }
  }
  step.children = std::move(joined);
}

bool Plan::divides_with_forces() const {
  const Field* force = node_field("force");
  if (filters() || (force && !force->for_ledger)) return false;
  const auto divides = std::find_if(step.children.begin(), step.children.end(),
                                    [](const Step& child) { return is_pass(child, Act::divide); });
  return step.children.end() - divides > 1 && is_pass(divides[1], Act::accelerate);
}

namespace {

/// Why the passes of a solver are not of the shape that fusion knows: a scatter and a division of all sums, and at the
/// end one visit that gathers, strains and moves.
std::string why_of_another_shape(const Step& step, const Experiment& experiment) {
  const Pass* const gather = find_pass(step, Act::gather);
  if (!gather) return "/solver/type \"" + experiment.solver.type + "\": no gather ends its step";
  if (!gather->has(Act::strain) || gather->share < 1 || !gather->has(Act::move)) {
    const Pass* const strain = find_pass(step, Act::strain);
    const Pass& apart = strain && strain != gather ? *strain : *gather;
    return asker(apart.operators.front().because) + ": strain and move do not share the visit of the gather";
  }
  const Step& last = step.children.back();
  if (!is_pass(last, Act::gather))
    return asker(last.kind == Step::Kind::pass ? last.pass.operators.front().because : last.because) +
           ": the step goes on after its gather";
  const auto divides = std::find_if(step.children.begin(), step.children.end(),
                                    [](const Step& child) { return is_pass(child, Act::divide); });
  const bool scatters = std::any_of(step.children.begin(), divides, [](const Step& child) {
    return is_pass(child, Act::scatter_momentum) && child.pass.has(Act::scatter_force);
  });
  if (divides == step.children.end() || !scatters)
    return asker(gather->operators.front().because) + ": momentum and force are not scattered in one visit";
  return "";
}

}  // namespace

std::string why_not_fused(const Step& step, const Experiment& experiment) {
  if (const Pass* averages = find_pass(step, Act::scatter_dilation))
    return asker(averages->operators.front().because) + ": nodes average before the forces and before the gather";
  const std::string of_another_shape = why_of_another_shape(step, experiment);
  if (experiment.solver.stress_update != StressUpdate::last)
    return "/solver/stress_update: only USL strains and scatters at the same particle state";
  if (find_pass(step, Act::begin_filter) && (find_pass(step, Act::project) || !of_another_shape.empty()))
    return experiment.filter->pointer + ": the filter reads the grid between gather and scatter";
  if (!of_another_shape.empty()) return of_another_shape;
  if (!experiment.grips.empty()) return "/grips: nodes are held as their particles are told for each step";
  if (const Pass* conducts = find_pass(step, Act::conduct))
    return conducts->operators.front().because + ": temperature takes two passes";
  if (experiment.shape.plugin->shape().form == MPM_NODE_LIST)
    return experiment.shape.pointer + ": a list of nodes takes two passes";
  if (!backend_needs(experiment.backend).fuses)
    return "/backend \"" + experiment.backend + "\" keeps passes apart, as the textbook does";
  return "";
}

// What looks at particles between their gather, strain and move keeps these apart: nodes that average, heat, grips, and
// corners that the grid's velocity moves. Stress is that of the next step's scatter, which nothing may change before it.
Advance advance_of(const Plan& plan, const Experiment& experiment) {
  const bool keeps_apart = !backend_needs(experiment.backend).launches ||
                           experiment.solver.passes == PassChoice::separate ||
                           experiment.solver.stress_update != StressUpdate::last || plan.does(Act::scatter_dilation) ||
                           experiment.has_temperature() || !experiment.grips.empty() || plan.sample_points > 0 ||
                           !why_of_another_shape(plan.step, experiment).empty();
  return keeps_apart ? Advance::apart : plan.has_ledger() ? Advance::unless_accounted : Advance::at_once;
}

/// What stands before the first pass over nodes that are filled becomes conditional; the last pass takes its operators
/// on, for the next step. What is executed in some steps only stays first: it may change the next step's dt.
void fuse(Step& step) {
  std::vector<Step>& steps = step.children;
  const auto is_cadenced = [](const Step& child) {
    return child.kind == Step::Kind::pass && child.pass.every_steps > 1;
  };
  const auto begin = std::find_if_not(steps.begin(), steps.end(), is_cadenced);
  const auto end = std::find_if(begin, steps.end(), [](const Step& child) { return is_pass(child, Act::divide); });
  Step scattering;
  scattering.kind = Step::Kind::when;
  scattering.condition = Condition::unless_scattered;
  scattering.because = "/solver/passes: the step before has scattered already, as a rule";
  scattering.children.assign(std::make_move_iterator(begin), std::make_move_iterator(end));

  Step gathering;
  gathering.kind = Step::Kind::when;
  gathering.condition = Condition::may_scatter_ahead;
  gathering.because = "/solver/passes: gather and scatter are one";
  Step ahead = steps.back();
  for (const Step& child : scattering.children)
    if (is_pass(child, Act::clear) || is_pass(child, Act::scatter_momentum))
      for (const Operator& operation : child.pass.operators) ahead.pass.add(operation);  // in before_next_step's order
  gathering.children = {std::move(ahead), std::move(steps.back())};
  steps.back() = std::move(gathering);

  const auto place = steps.erase(begin, end);
  steps.insert(place, std::move(scattering));
}

}  // namespace mpm

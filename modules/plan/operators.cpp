// What each operator reads, writes and adds to, said once; and the check that every step passes.

#include <set>
#include <stdexcept>

#include "plan/step_builder.hpp"

namespace mpm {
namespace {

/// Collects the uses of one operator: of what the plan holds, the rest is left out.
class Uses {
 public:
  Uses(Operator& operation, const Plan& plan) : operation_(operation), plan_(plan) {}

  Uses& reads(std::initializer_list<const char*> names) { return take(operation_.reads, names); }
  Uses& writes(std::initializer_list<const char*> names) { return take(operation_.writes, names); }
  Uses& adds(std::initializer_list<const char*> names) { return take(operation_.adds, names); }

 private:
  Uses& take(FieldNames& list, std::initializer_list<const char*> names) {
    for (const std::string name : names)
      if (held(name)) list.push_back(name);
    return *this;
  }
  /// "particles/transfer" and "particles/material" stand for all state of the plugin's table.
  bool held(const std::string& name) const {
    const std::size_t slash = name.find('/');
    const std::string owner = name.substr(0, slash), id = name.substr(slash + 1);
    for (const Field& field : plan_.fields) {
      if ((field.owner == Owner::node) != (owner == "nodes")) continue;
      if (field.id == id && field.origin == Origin::host) return true;
      if (field.origin == Origin::transfer && id == "transfer") return true;
      if (field.origin == Origin::material && id == "material") return true;
    }
    return owner == "step";
  }

  Operator& operation_;
  const Plan& plan_;
};

// Where a particle is and which nodes it reaches.
#define MPM_STENCIL "particles/position", "particles/domain", "particles/corners"
// What contact and one-sided walls look at.
#define MPM_PAIRS "nodes/volume", "nodes/volume_gradient", "nodes/mass_position"
// What walls that heat comes through look at.
#define MPM_HEATED_WALL "nodes/heated_volume", "nodes/volume_conductivity", "nodes/capacity_position"

/// The transfer's state for the temperature, field by field.
void use_temperature_state(FieldNames& names, const Plan& plan) {
  for (const Field& field : plan.fields)
    if (field.of_particles_of(0) && field.id.rfind(temperature_state, 0) == 0) names.push_back("particles/" + field.id);
}

void describe(Operator& operation, const Pass& pass, const Plan& plan, const Experiment& experiment) {
  operation.reads.clear(), operation.writes.clear(), operation.adds.clear();
  operation.where = Where::nodes;
  Uses uses(operation, plan);
  switch (operation.act) {
    case Act::estimate_time_step:
      operation.where = Where::particles;
      uses.reads({"particles/velocity", "particles/material"}).writes({"step/dt"});
      break;
    case Act::sort:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL}).writes({"step/order"});
      break;
    case Act::sort_ahead:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "nodes/velocity"}).writes({"step/order"});
      break;
    case Act::clear:
      for (const Field& field : plan.fields)
        if (field.owner == Owner::node && field.cleared && !(pass.fused() && field.id == "momentum"))
          operation.writes.push_back("nodes/" + field.id);
      break;
    case Act::scatter_momentum:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "particles/velocity", "particles/transfer", "particles/circumference"});
      if (pass.remap()) uses.writes({"nodes/momentum", "nodes/mass"});
      pass.fused() ? uses.adds({"nodes/next_momentum", "nodes/next_mass"})
                   : uses.adds({"nodes/momentum", "nodes/mass"});
      if (!pass.remap()) uses.adds({"nodes/weight"});
      break;
    case Act::scatter_force:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "particles/material", "particles/circumference"});
      if (experiment.body_force) uses.reads({"particles/initial_position"});
      plan.node_field("force") ? uses.adds({"nodes/force"})
      : pass.fused()           ? uses.adds({"nodes/next_momentum"})
                               : uses.adds({"nodes/momentum"});
      uses.adds({"nodes/body_force"});
      break;
    case Act::scatter_contact:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "particles/material", "particles/circumference"}).adds({MPM_PAIRS});
      break;
    case Act::divide:
      uses.reads({"nodes/momentum", "nodes/mass", "nodes/next_momentum", "nodes/next_mass", MPM_PAIRS})
          .writes({"nodes/velocity", "nodes/velocity_of_constraints"});
      if (!pass.remap()) uses.writes({"nodes/velocity_before"});
      break;
    case Act::scatter_heat:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "particles/temperature", "particles/melted_fraction", "particles/circumference"})
          .adds({"nodes/heat", "nodes/heat_capacity", MPM_HEATED_WALL});
      if (plan.node_field("heated_volume")) uses.reads({"particles/material"});
      use_temperature_state(operation.reads, plan);
      break;
    case Act::divide_heat:
      uses.reads({"nodes/heat", "nodes/heat_capacity", MPM_HEATED_WALL})
          .writes({"nodes/temperature", "nodes/temperature_before"});
      break;
    case Act::conduct:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "nodes/temperature", "particles/material", "particles/melted_fraction",
                  "particles/circumference"})
          .adds({"nodes/heat_rate"});
      break;
    case Act::heat:
      uses.reads({"nodes/temperature", "nodes/temperature_before", "nodes/heat_capacity", "nodes/heat_rate",
                  MPM_HEATED_WALL, "nodes/mass"})
          .writes({"nodes/temperature"});
      break;
    case Act::gather_heat:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "particles/temperature", "nodes/temperature"});
      if (experiment.transfer.plugin->transfer().traits & MPM_GATHERS_INCREMENT)
        uses.reads({"nodes/temperature_before"});
      uses.writes({"particles/temperature"});
      use_temperature_state(operation.writes, plan);
      break;
    case Act::change_phase:
      operation.where = Where::particles;
      uses.reads({"particles/temperature", "particles/melted_fraction"})
          .writes({"particles/temperature", "particles/melted_fraction"});
      break;
    case Act::accelerate:
      uses.reads({"nodes/velocity", "nodes/mass", "nodes/force", "nodes/body_force", "nodes/weight",
                  "nodes/velocity_before", "nodes/velocity_of_constraints", MPM_PAIRS})
          .writes({"nodes/velocity", "nodes/velocity_before", "nodes/velocity_of_constraints"});
      break;
    case Act::begin_filter:
      uses.reads({"nodes/velocity"}).writes({"nodes/increment"});
      break;
    case Act::keep_velocity:
      uses.reads({"nodes/velocity", "nodes/velocity_of_constraints"})
          .writes({"nodes/unfiltered_velocity", "nodes/unfiltered_velocity_of_constraints"});
      break;
    case Act::project:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "nodes/increment", "nodes/mass"}).adds({"nodes/projection"});
      break;
    case Act::update_filter:
      uses.reads({"nodes/projection", "nodes/increment", "nodes/velocity", "nodes/velocity_of_constraints", MPM_PAIRS})
          .writes({"nodes/velocity", "nodes/trial_velocity", "nodes/increment", "nodes/velocity_of_constraints"});
      break;
    case Act::end_filter:
      uses.reads({"nodes/velocity", "nodes/increment", "nodes/velocity_of_constraints", MPM_PAIRS})
          .writes({"nodes/velocity", "nodes/velocity_of_constraints"});
      break;
    case Act::restore_velocity:
      uses.reads({"nodes/unfiltered_velocity", "nodes/unfiltered_velocity_of_constraints"})
          .writes({"nodes/velocity", "nodes/velocity_of_constraints"});
      break;
    case Act::keep_correction:
      uses.reads({"nodes/velocity", "nodes/velocity_of_constraints"})
          .writes({"nodes/unfiltered_velocity", "nodes/unfiltered_velocity_of_constraints"});
      break;
    case Act::add_correction:
      uses.reads({"nodes/velocity", "nodes/unfiltered_velocity", "nodes/velocity_of_constraints",
                  "nodes/unfiltered_velocity_of_constraints", MPM_PAIRS})
          .writes({"nodes/velocity", "nodes/velocity_of_constraints"});
      break;
    case Act::gather:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "particles/velocity", "particles/transfer", "nodes/velocity"});
      if (experiment.transfer.plugin->transfer().traits & MPM_GATHERS_INCREMENT) uses.reads({"nodes/velocity_before"});
      uses.writes(
          {"particles/velocity", "particles/transfer", "particles/advection_velocity", "particles/moved_corners"});
      break;
    case Act::strain:
      operation.where = Where::particles;
      uses.reads({MPM_STENCIL, "nodes/velocity", "particles/material"}).writes({"particles/material"});
      plan.particle_field(0, "strained_domain") ? uses.writes({"particles/strained_domain"})
                                                : uses.writes({"particles/domain"});
      break;
    case Act::move:
      operation.where = Where::particles;
      uses.reads({"particles/position", "particles/advection_velocity", "particles/moved_corners",
                  "particles/strained_domain"})
          .writes({"particles/position", "particles/corners", "particles/domain"});
      break;
  }
}
#undef MPM_STENCIL
#undef MPM_PAIRS

/// Walks a step as it is executed with the filter on or off.
class Walk {
 public:
  Walk(bool filtered, std::set<std::string>& ever_read) : filtered_(filtered), ever_read_(ever_read) {}

  void go(const Step& step) {
    if (step.kind == Step::Kind::pass) {
      for (const Operator& operation : step.pass.operators) use(operation, step.pass);
      return;
    }
    if (step.kind == Step::Kind::when && step.condition == Condition::when_filtered && !filtered_) return;
    if (step.kind == Step::Kind::when && step.condition == Condition::may_scatter_ahead)
      return go(step.children.front());  // the other child does a part of the same
    for (const Step& child : step.children) go(child);
  }

 private:
  void use(const Operator& operation, const Pass& pass) {
    for (const std::string& name : operation.reads) {
      ever_read_.insert(name);
      const bool lasts = name.rfind("particles/", 0) == 0 || name.rfind("nodes/next_", 0) == 0;
      if (!lasts && written_.count(name) == 0)
        throw std::logic_error("the step reads what nothing has written: operator \"" + pass.name() + "\" (" +
                               operation.because + ") reads " + name);
    }
    written_.insert(operation.writes.begin(), operation.writes.end());
    written_.insert(operation.adds.begin(), operation.adds.end());
  }

  bool filtered_;
  std::set<std::string>& ever_read_;
  std::set<std::string> written_;
};

}  // namespace

void describe_operators(Plan& plan, const Experiment& experiment) {
  for_each_pass(plan.step, [&](Pass& pass) {
    for (Operator& operation : pass.operators) describe(operation, pass, plan, experiment);
  });
}

void check_step(const Plan& plan) {
  std::set<std::string> read;
  for (const bool filtered : {false, true}) Walk(filtered, read).go(plan.step);
  for (const Field& field : plan.fields) {
    const bool of_host = field.origin == Origin::host;
    if (!of_host || field.id == "identity" || field.lifetime == Lifetime::seeded) continue;  // results read these
    if (field.lifetime == Lifetime::pass) continue;  // its own operator reads it
    if (read.count((field.owner == Owner::node ? "nodes/" : "particles/") + field.id) == 0)
      throw std::logic_error("the plan holds what no operator reads: " + field.id + " (" + field.because + ")");
  }
}

}  // namespace mpm

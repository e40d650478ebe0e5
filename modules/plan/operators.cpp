// What each operator reads, writes and adds to, said once; and the check that every step passes.

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>

#include "plan/step_builder.hpp"
#include "plugin/extension_of.hpp"

namespace mpm {
namespace {

/// Collects the uses of one operator: of what the plan holds, the rest is left out.
class Uses {
 public:
  Uses(Operator& operation, const Plan& plan) : operation_(operation), plan_(plan) {}

  Uses& reads(const FieldNames& names) { return take(operation_.reads, names); }
  Uses& writes(const FieldNames& names) { return take(operation_.writes, names); }
  Uses& adds(const FieldNames& names) { return take(operation_.adds, names); }

 private:
  /// "particles/transfer", "particles/material" and "particles/temperature_state" stand for all state of the plugin's
  /// table, and for the transfer's state for the temperature, which is named field by field.
  Uses& take(FieldNames& list, const FieldNames& names) {
    for (const std::string& name : names) {
      if (name == "particles/temperature_state") {
        for (const Field& field : plan_.fields)
          if (field.of_particles_of(0) && field.id.rfind(temperature_state, 0) == 0)
            list.push_back("particles/" + field.id);
      } else if (held(name)) {
        list.push_back(name);
      }
    }
    return *this;
  }
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
#define MPM_PAIRS                                                                                   \
  "nodes/volume_gradient", "nodes/mass_gradient", "nodes/mass_position", "nodes/mass_displacement", \
      "nodes/mass_state", "nodes/mass_gain"
// What a law of contact with a state says of it.
#define MPM_REACHED "nodes/reached", "nodes/met"
// What walls that heat comes through look at.
#define MPM_HEATED_WALL "nodes/heated_volume", "nodes/volume_conductivity", "nodes/capacity_position"

// What loads give.
#define MPM_EXTERNAL_FORCES \
  "nodes/body_force", "nodes/surface_load", "nodes/point_load", "nodes/spring", "nodes/dashpot"

// What the ledger makes works of.
#define MPM_IMPULSES                                                                                  \
  "nodes/boundary_impulse", "nodes/contact_impulse", "nodes/filter_impulse", "nodes/damping_impulse", \
      "nodes/standing_boundary_impulse", "nodes/standing_contact_impulse"

// A velocity that conditions and contact have changed, and the one that a filter keeps aside.
#define MPM_CONSTRAINED "nodes/velocity", "nodes/velocity_of_constraints"
#define MPM_KEPT "nodes/unfiltered_velocity", "nodes/unfiltered_velocity_of_constraints"

/// What an operator says of itself: where it runs, and the values that it uses of those that a scene has.
struct Declaration {
  Act act;
  Where where;
  FieldNames reads, writes, adds;
};

const Declaration declarations[] = {
    {Act::estimate_time_step,
     Where::particles,
     {"particles/velocity", "particles/material", "particles/artificial_pressure"},
     {"step/dt"},
     {}},
    {Act::sort, Where::particles, {MPM_STENCIL}, {"step/order"}, {}},
    {Act::sort_ahead, Where::particles, {MPM_STENCIL, "nodes/velocity"}, {"step/order"}, {}},
    {Act::clear, Where::nodes, {}, {}, {}},
    {Act::scatter_momentum,
     Where::particles,
     {MPM_STENCIL, "particles/velocity", "particles/transfer", "particles/size"},
     {},
     {}},
    {Act::scatter_force,
     Where::particles,
     {MPM_STENCIL, "particles/material", "particles/artificial_pressure", "particles/size", "particles/deformation",
      "nodes/mean_stress"},
     {},
     {MPM_EXTERNAL_FORCES}},
    {Act::scatter_contact,
     Where::particles,
     {MPM_STENCIL, "particles/material", "particles/size", "particles/contact_state", "particles/contact_gain"},
     {},
     {MPM_PAIRS}},
    {Act::scatter_heat,
     Where::particles,
     {MPM_STENCIL, "particles/temperature", "particles/melted_fraction", "particles/size",
      "particles/temperature_state"},
     {},
     {"nodes/heat", "nodes/heat_capacity", MPM_HEATED_WALL}},
    {Act::divide,
     Where::nodes,
     {"nodes/momentum", "nodes/mass", "nodes/next_momentum", "nodes/next_mass", MPM_PAIRS, MPM_IMPULSES},
     {MPM_CONSTRAINED, MPM_IMPULSES},
     {}},
    {Act::accelerate,
     Where::nodes,
     {MPM_CONSTRAINED, "nodes/mass", "nodes/force", MPM_EXTERNAL_FORCES, "nodes/weight", "nodes/velocity_before",
      MPM_PAIRS, MPM_IMPULSES},
     {MPM_CONSTRAINED, "nodes/velocity_before", MPM_IMPULSES, MPM_REACHED},
     {}},
    {Act::divide_heat,
     Where::nodes,
     {"nodes/heat", "nodes/heat_capacity", MPM_HEATED_WALL},
     {"nodes/temperature", "nodes/temperature_before"},
     {}},
    {Act::conduct,
     Where::particles,
     {MPM_STENCIL, "nodes/temperature", "particles/material", "particles/melted_fraction", "particles/size"},
     {},
     {"nodes/heat_rate"}},
    {Act::heat,
     Where::nodes,
     {"nodes/temperature", "nodes/temperature_before", "nodes/heat_capacity", "nodes/heat_rate", MPM_HEATED_WALL,
      "nodes/mass"},
     {"nodes/temperature"},
     {}},
    {Act::begin_filter, Where::nodes, {"nodes/velocity"}, {"nodes/increment", MPM_IMPULSES}, {}},
    {Act::keep_velocity, Where::nodes, {MPM_CONSTRAINED}, {MPM_KEPT}, {}},
    {Act::project, Where::particles, {MPM_STENCIL, "nodes/increment", "nodes/mass"}, {}, {"nodes/projection"}},
    {Act::update_filter,
     Where::nodes,
     {"nodes/projection", "nodes/increment", MPM_CONSTRAINED, MPM_PAIRS, MPM_IMPULSES},
     {MPM_CONSTRAINED, "nodes/trial_velocity", "nodes/increment", MPM_IMPULSES},
     {}},
    {Act::end_filter,
     Where::nodes,
     {MPM_CONSTRAINED, "nodes/increment", MPM_PAIRS, MPM_IMPULSES},
     {MPM_CONSTRAINED, MPM_IMPULSES},
     {}},
    {Act::restore_velocity, Where::nodes, {MPM_KEPT}, {MPM_CONSTRAINED}, {}},
    {Act::keep_correction, Where::nodes, {MPM_CONSTRAINED}, {MPM_KEPT}, {}},
    {Act::add_correction,
     Where::nodes,
     {MPM_CONSTRAINED, MPM_KEPT, MPM_PAIRS, MPM_IMPULSES},
     {MPM_CONSTRAINED, MPM_IMPULSES},
     {}},
    {Act::keep_contact_state,
     Where::particles,
     {MPM_STENCIL, MPM_REACHED, "particles/contact_state"},
     {"particles/contact_state", "particles/contact_gain"},
     {}},
    {Act::gather,
     Where::particles,
     {MPM_STENCIL, "particles/velocity", "particles/transfer", "nodes/velocity"},
     {"particles/velocity", "particles/transfer", "particles/advection_velocity", "particles/moved_corners"},
     {}},
    {Act::gather_heat,
     Where::particles,
     {MPM_STENCIL, "particles/temperature", "nodes/temperature"},
     {"particles/temperature", "particles/temperature_state"},
     {}},
    {Act::scatter_mean_stress,
     Where::particles,
     {MPM_STENCIL, "particles/material", "particles/artificial_pressure", "particles/size"},
     {},
     {"nodes/volume_stress", "nodes/stressed_volume"}},
    {Act::average_mean_stress,
     Where::nodes,
     {"nodes/volume_stress", "nodes/stressed_volume"},
     {"nodes/mean_stress"},
     {}},
    {Act::scatter_dilation,
     Where::particles,
     {MPM_STENCIL, "nodes/velocity", "particles/material", "particles/size"},
     {},
     {"nodes/volume_rate", "nodes/strained_volume"}},
    {Act::average_dilation, Where::nodes, {"nodes/volume_rate", "nodes/strained_volume"}, {"nodes/dilation"}, {}},
    {Act::strain,
     Where::particles,
     {MPM_STENCIL, "nodes/velocity", "nodes/dilation", "particles/material", "particles/artificial_pressure",
      "particles/deformation"},
     {"particles/material", "particles/artificial_pressure", "particles/deformation"},
     {}},
    {Act::move,
     Where::particles,
     {"particles/position", "particles/advection_velocity", "particles/moved_corners", "particles/strained_domain"},
     {"particles/position", "particles/corners", "particles/domain"},
     {}},
    {Act::change_phase,
     Where::particles,
     {"particles/temperature", "particles/melted_fraction", "particles/material"},
     {"particles/temperature", "particles/melted_fraction"},
     {}},
};
static_assert(std::size(declarations) == act_count);

/// Whether a share of what a material dissipates warms its particles.
bool warms_by_dissipation(const Experiment& experiment) {
  return std::any_of(experiment.materials.begin(), experiment.materials.end(), [](const auto& material) {
    return material.thermal && material.thermal->dissipation_to_heat > 0;
  });
}

/// Whether a material asks for its particles' temperature.
bool reads_temperature(const Experiment& experiment) {
  return std::any_of(experiment.materials.begin(), experiment.materials.end(), [](const auto& material) {
    return extension_of<mpm_material_temperature>(*material.component.plugin);
  });
}

/// What depends on the pass that an operator stands in, and on the scene.
void add_what_depends(Uses& uses, Act act, const Pass& pass, const Plan& plan, const Experiment& experiment) {
  const bool gathers_increment = experiment.transfer.plugin->transfer().traits & MPM_GATHERS_INCREMENT;
  switch (act) {
    case Act::clear:
      for (const Field& field : plan.fields)
        if (field.owner == Owner::node && field.cleared && !(pass.fused() && field.id == "momentum"))
          uses.writes({"nodes/" + field.id});
      break;
    case Act::scatter_momentum:
      if (pass.remap()) uses.writes({"nodes/momentum", "nodes/mass"});
      pass.fused() ? uses.adds({"nodes/next_momentum", "nodes/next_mass"})
                   : uses.adds({"nodes/momentum", "nodes/mass"});
      if (!pass.remap()) uses.adds({"nodes/weight"});
      for (std::size_t k = 0; k < experiment.grips.size(); ++k)
        uses.reads({"particles/grip", "particles/initial_position"})
            .adds({"nodes/" + grip_field(k), "nodes/" + grip_field(k) + "_mass", "nodes/" + grip_field(k) + "_before"});
      break;
    case Act::scatter_force:
      for (const ExternalForce external : external_forces)
        if (!experiment.giver_of(external).empty()) uses.reads({"particles/initial_position"});
      if (plan.node_field(field_of(ExternalForce::dashpot))) uses.reads({"particles/velocity"});
      plan.node_field("force") ? uses.adds({"nodes/force"})
      : pass.fused()           ? uses.adds({"nodes/next_momentum"})
                               : uses.adds({"nodes/momentum"});
      break;
    case Act::divide:
      if (!pass.remap()) uses.writes({"nodes/velocity_before"});
      for (std::size_t k = 0; k < experiment.grips.size(); ++k)
        uses.reads(
            {"nodes/" + grip_field(k), "nodes/" + grip_field(k) + "_mass", "nodes/" + grip_field(k) + "_before"});
      break;
    case Act::scatter_contact:
      if (plan.node_field("mass_displacement")) uses.reads({"particles/initial_position", "particles/deformation"});
      break;
    case Act::scatter_heat:
      if (plan.node_field("heated_volume")) uses.reads({"particles/material"});
      break;
    case Act::gather:
      if (gathers_increment) uses.reads({"nodes/velocity_before"});
      if (!experiment.grips.empty()) uses.reads({"particles/grip", "particles/initial_position"});
      break;
    case Act::gather_heat:
      if (gathers_increment) uses.reads({"nodes/temperature_before"});
      break;
    case Act::strain:
      uses.writes({plan.particle_field(0, "strained_domain") ? "particles/strained_domain" : "particles/domain"});
      if (warms_by_dissipation(experiment)) uses.reads({"particles/temperature"}).writes({"particles/temperature"});
      break;
    default:
      break;
  }
}

void describe(Operator& operation, const Pass& pass, const Plan& plan, const Experiment& experiment) {
  const auto& declared = *std::find_if(std::begin(declarations), std::end(declarations),
                                       [&](const Declaration& entry) { return entry.act == operation.act; });
  operation.where = declared.where;
  operation.reads.clear(), operation.writes.clear(), operation.adds.clear();
  Uses uses(operation, plan);
  uses.reads(declared.reads).writes(declared.writes).adds(declared.adds);
  add_what_depends(uses, operation.act, pass, plan, experiment);
  const auto reads = [&](const char* name) {
    return std::find(operation.reads.begin(), operation.reads.end(), name) != operation.reads.end();
  };
  if (!reads("particles/material")) return;
  // Whoever asks a material takes the parameters of the particle's phase, and hands it the temperature as it is then.
  if (!reads("particles/melted_fraction")) uses.reads({"particles/melted_fraction"});
  if (!reads("particles/temperature") && reads_temperature(experiment)) uses.reads({"particles/temperature"});
}
#undef MPM_IMPULSES
#undef MPM_CONSTRAINED
#undef MPM_KEPT
#undef MPM_STENCIL
#undef MPM_EXTERNAL_FORCES
#undef MPM_PAIRS
#undef MPM_REACHED
#undef MPM_HEATED_WALL

/// Walks a step as it is executed with the filter on or off.
class Walk {
 public:
  Walk(bool filtered, const Plan& plan, std::set<std::string>& ever_read) : filtered_(filtered), ever_read_(ever_read) {
    for (const Field& field : plan.fields)
      if (field.owner == Owner::particle && (field.lifetime == Lifetime::step || field.lifetime == Lifetime::pass))
        of_one_step_.insert("particles/" + field.id);
  }

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
      const bool of_particles = name.rfind("particles/", 0) == 0;
      const bool lasts = of_particles ? of_one_step_.count(name) == 0 : name.rfind("nodes/next_", 0) == 0;
      if (!lasts && written_.count(name) == 0)
        throw std::logic_error("the step reads what nothing has written: operator \"" + pass.name() + "\" (" +
                               operation.because + ") reads " + name);
    }
    written_.insert(operation.writes.begin(), operation.writes.end());
    written_.insert(operation.adds.begin(), operation.adds.end());
  }

  bool filtered_;
  std::set<std::string>& ever_read_;
  std::set<std::string> of_one_step_;  ///< particle fields that hold nothing when a step begins
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
  for (const bool filtered : {false, true}) Walk(filtered, plan, read).go(plan.step);
  for (const Field& field : plan.fields) {
    const bool of_host = field.origin == Origin::host;
    if (!of_host || field.id == "identity" || field.lifetime == Lifetime::seeded) continue;  // results read these
    if (field.lifetime == Lifetime::pass) continue;  // its own operator reads it
    if (read.count((field.owner == Owner::node ? "nodes/" : "particles/") + field.id) == 0)
      throw std::logic_error("the plan holds what no operator reads: " + field.id + " (" + field.because + ")");
  }
}

}  // namespace mpm

#pragma once
// The backend of a device executes the passes of a plan as launches of a composition's phases, through a driver's table:
// libcuda's, or the host's. Particles and nodes stay on the device. Once a step the host takes what phases have
// summed; it evaluates walls and boxes.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backends/device/conditions.hpp"
#include "backends/device/contact_edges.hpp"
#include "backends/device/contact_notes.hpp"
#include "backends/device/contact_sight.hpp"
#include "backends/device/device.hpp"
#include "backends/device/device_arrays.hpp"
#include "backends/device/formula_numbers.hpp"
#include "backends/device/heat_conditions.hpp"
#include "backends/device/make_device_backend.hpp"
#include "backends/device/memory.hpp"
#include "backends/device/results.hpp"
#include "backends/device/rigid_nodes.hpp"
#include "backends/device/step_graphs.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/loads.hpp"
#include "simulation/offers_totals.hpp"
#include "simulation/reaction_impulse.hpp"

namespace mpm::device {

/// Settings of phases over the grid beside the scene.
struct Manner {
  bool remap = false, after_forces = false, walls_at_rest = false;
};

/// The reasons for which a phase reports particles.
enum class Checks { stencil, force, load, grip, temperature, deformation, position };

/// The part of contact that goes to the ledger and to the record.
enum class Recorded { nothing, before_forces, after_forces, filter };

/// Sums that phases make, which are known only when the host looks at the results of the step.
template <std::size_t count>
using Tally = std::shared_ptr<std::array<double, count>>;

/// Its methods are defined by physics, one file each beside this one.
template <class T>
class DeviceBackend final : public Backend, public OffersTotals {
 public:
  DeviceBackend(const Experiment& experiment, const Plan& plan, const std::vector<SeededBody>& seeded,
                const DeviceSetup& setup);

  std::string_view name() const override { return "cuda"; }
  void execute(const Pass& pass, const StepInfo& step) override;

  TimeStepLimit time_step_limit() const override { return limit_; }
  const Ledger& ledger() const override { return ledger_; }
  HeatLedger heat_ledger() const override { return heat_ledger_; }
  const ContactRecord& contact_record() const override { return contact_; }
  const std::vector<PairRecord>& contact_pairs() const override { return contact_impulse_.pairs(); }
  const std::vector<ContactNode>& contact_nodes() const override { return contact_impulse_.nodes(); }
  const FilterRecord& filter_record() const override { return filter_; }
  const std::vector<Reaction>& reactions() const override { return reactions_.reactions(); }
  const std::vector<RigidState>& rigid_bodies() const override { return rigid_.bodies().states(); }
  bool scattered() const override { return false; }
  void measure_phases(bool on) override { device_->measure(on); }
  std::map<std::string, double> phase_seconds() const override { return device_->seconds(); }

  std::uint64_t particle_bytes() const override;
  std::uint64_t grid_bytes() const override;

  // ---- checkpoint.cpp
  void save(ArchiveWriter& archive) const override;
  void restore(ArchiveReader& archive) override;
  BodyState body_state(int index) const override;

  // ---- totals.cpp
  std::optional<Totals> totals_of(int body) const override;

 private:
  // ---- steps.cpp
  /// A pass that waits for the end of its step.
  struct WaitingPass {
    const Pass* pass;
    StepInfo step;
  };
  void perform(const Pass& pass, const StepInfo& step);
  void perform(const std::vector<WaitingPass>& passes);
  /// Whether a step begins with a grid that no particle has reached.
  bool forgets_grid(long step) const { return step % steps_to_forget_ == 0; }
  /// Makes the grid ready for the step's scatter.
  void clear(const StepInfo& step);
  /// Does what waits, by a graph where there is one, and looks at what the step has left.
  void end_step();
  StepKind kind_of(const std::vector<WaitingPass>& passes) const;
  /// Collects the launches of a step in a graph.
  void capture(KnownStep& known, const std::vector<WaitingPass>& passes);

  // ---- launches.cpp
  Arguments<T> arguments_of(const VelocityField<T>& field, const Manner& manner) const;
  Arguments<T> arguments_of(const Body<T>& body) const;
  void point_to(Arguments<T>& a, const VelocityField<T>& field) const;
  void launch(const std::string& phase, const Arguments<T>& a, int indices);
  void launch_teams(const std::string& phase, Arguments<T> a, int teams);
  /// Runs one phase over `indices` of every field's grid.
  void for_each_field(const std::string& phase, int indices, const Manner& manner = {});
  /// Runs one phase of folds along the lines of every one of these axes.
  void for_each_axis(const std::string& phase, const std::vector<int>& axes, const Manner& manner = {});
  /// The axes in the order of folding: periodic images come before walls. Ghosts are filled in the reverse order.
  std::vector<int> folded_axes() const;
  std::vector<int> filled_axes() const;
  /// Takes a place for so many values of this step's results.
  std::size_t place(std::size_t count);
  /// Runs a phase that makes `count` values in teams, the last of them largest ones, and a phase that joins the teams.
  void join(const std::string& phase, Arguments<T> a, int indices, std::size_t count, std::size_t place, int maxima = 0,
            const std::string& joining = "add_teams");
  Tally<1> sum_over_nodes(const std::string& phase);
  void sum_over_particles(const std::string& phase, const Body<T>& body, const Tally<1>& to);
  /// Runs a phase over a body's particles, or over its blocks, which may report a particle.
  void run(const std::string& phase, const Arguments<T>& a, const Body<T>& body, Checks checks);
  /// Keeps in mind that the last launch, or a part of it, may report a particle.
  void watch(const Body<T>& body, Checks checks, int part = 0);
  void run_blocks(const std::string& phase, const Arguments<T>& a, const Body<T>& body,
                  Checks checks = Checks::stencil);
  void launch_blocks(const std::string& phase, Arguments<T> a, const Body<T>& body);
  /// Waits for the device. Stops the run where a phase has reported a particle; else does what waited for results.
  void look();
  /// Does something once the results of what was launched so far are known.
  void later(std::function<void()> use) {
    results_.later([use = std::move(use)](const double*) { use(); });
  }
  void run_material(const std::string& phase, const Body<T>& body);
  void run_material(const std::string& phase, const Arguments<T>& a, const Body<T>& body);
  void run_strain(const Pass& pass, Body<T>& body);

  // ---- failures.cpp: a phase reports only the particle; what is wrong with it stands in its arrays
  Failure failure_of(Cause cause, const Body<T>& body, int p) const;
  std::optional<Failure> position_not_a_number(const Body<T>& body, int p) const;
  Failure failed_temperature(const Body<T>& body, int p) const;
  Failure failed_deformation(const Body<T>& body, int p) const;
  Failure failed_stencil(const Body<T>& body, int p) const;
  /// Reports the first of the axes beyond which the particle is; the test is that of the phase "move".
  Failure failed_position(const Body<T>& body, int p) const;

  // ---- particles.cpp: passes over particles
  void estimate_time_step();
  /// Puts a body's particles into their blocks, where any has left its own.
  void sort(const Body<T>& body);
  void find_blocks(const Body<T>& body) { launch("find_blocks", arguments_of(body), body.count); }
  void scatter(const Pass& pass, const StepInfo& step);
  void gather(const Pass& pass, const StepInfo& step);
  /// Takes all particles to the next scatter, in one launch a body.
  void advance(const StepInfo& step);
  void strain(const Pass& pass);
  void move();

  // ---- loads.cpp: loads and grips
  /// Tells gripped particles what they are to do at the end of the step, and lets nodes know of them.
  void scatter_grips(const Body<T>& body);
  /// Throws ImposedValueFailure for the velocity of a gripped particle, of which a kernel has found that it is not finite.
  [[noreturn]] void refuse_told(const Body<T>& body, int p) const;
  /// Sums what grips gave a body's particles in the gather, and its energy, J.
  void note_gripped(const Body<T>& body, const StepInfo& step, const Tally<1>& energy);
  /// Scatters each kind of load of a body into its own field.
  void scatter_loads(const Body<T>& body, Arguments<T> a);
  const BodyLoads& loads_of(const Body<T>& body) const { return loads_[static_cast<std::size_t>(body.number_of_body)]; }
  /// Returns the first of all loads of a body that is not finite, after a kernel has found that the force by mass on a
  /// particle is not. Loads at points are looked at too: they are scattered after those by mass.
  Failure failed_force(const Body<T>& body, int p) const;
  /// Returns the first load at points of a body that is not finite, after a kernel has found that one of a particle's is not.
  Failure failed_load(const Body<T>& body, int p) const;
  void note_loads(const Body<T>& body, FirstFailure& failures) const;

  // ---- conditions.cpp: from momenta to velocities, and what supports give
  void momentum_to_velocity(const Pass& pass, const StepInfo& step);
  void apply_forces(const StepInfo& step);
  /// Folds along an axis, and sums what its walls give by it where reactions are noted.
  void fold(const std::string& phase, int axis, const Manner& manner, GivenBySupport given);
  /// Runs a phase along the lines of an axis that sums what its walls give.
  void note_walls(const std::string& phase, const Arguments<T>& a, GivenBySupport given);
  void take_support(const double* sums, GivenBySupport given, int support);
  /// Sums what particles gather from ghosts (kernels/reactions.hpp).
  void note_beyond(int beyond, GivenBySupport given);
  void fold_momenta(const Manner& manner);
  void fold_forces();
  void fold_projection(bool at_rest);
  void impose_conditions(const Manner& manner);
  /// Records what particles take from the supports when they gather the velocity as it is now.
  void record_reactions(const StepInfo& step);
  void damp(const StepInfo& step);

  // ---- ledger.cpp: whoever gives a node an impulse notes it; works are booked when a stage of the step ends
  void account_for_impulses();
  void begin_stage(bool records);
  /// Books a work on the nodes.
  void book(double Ledger::*row, double work);
  /// Books what folding at walls gave the nodes, and the work of walls on what lies beyond them.
  void book_folds();
  void book_impulses();
  /// Books the works of a filter's loop, and what they do not explain of the kinetic energy.
  void book_filter();
  /// The works of the stresses' forces and of gravity at the velocity of now, J.
  Tally<2> power_of_forces();
  /// Books what strain by the velocity of now stores less than by v+ before any filter.
  void book_strain(double Ledger::*row, double share);
  void book_material(Body<T>& body);
  /// The kinetic energy of all particles, J.
  Tally<1> energy_of_particles();

  // ---- heat.cpp
  /// Finds temperatures before the step's heat, those of ghosts too.
  void heat_to_temperature();
  /// Imposes what walls and boxes hold, as evaluated last; returns the heat that each gives by it.
  Tally<2> impose_temperature();
  /// Fills ghosts; returns the heat by which they exceed their mirrors, at walls held at a temperature and at others.
  Tally<2> fill_temperature();
  void sum_over_lines(const char* phase, VelocityField<T>& field, int axis, const Tally<2>& to);
  void conduct();
  /// Finds temperatures after the step's heat.
  void warm(const StepInfo& step);
  void warm_box(int box, double dt);
  void change_phase();

  // ---- dilation.cpp
  void scatter_mean_stress();
  void scatter_dilation(const Pass& pass);
  void average(const std::string& what);

  // ---- contact.cpp
  void keep_contact_state();
  /// Applies the law to every pair of fields, and then those of rigid bodies, whose velocities are those of a time, s.
  void resolve_contact(const StepInfo& step, Recorded recorded, Stage stage, double time);
  /// Lets the nodes at which fields meet look at particles, where contact asks for it.
  void look_at_particles();
  Arguments<T> pair_arguments(std::size_t a, std::size_t b, Stage stage, bool notes) const;
  /// Lets all fields meet rigid bodies one after another, and adds what these give.
  void meet_rigid_bodies(double time, const std::shared_ptr<ContactGiven>& all, Stage stage, bool record);
  /// Adds what contact did to a pair, as its phase has summed it, to what all pairs were given, and to the record.
  void take_pair(const double* sums, ContactGiven& given, bool record);
  /// Records the force that particles take when they gather the velocity as it is now.
  void record_force(const StepInfo& step);

  // ---- filter.cpp
  /// Takes the mass norm of the increment, kg^1/2 m/s, to `use`: with a tolerance at once, as it decides whether another pass
  /// follows, else when the host looks.
  void measure_increment(const std::function<void(double)>& use);
  void keep_unfiltered();
  void begin_filter(const Pass& pass);
  /// The first increment is a velocity, which a moving wall mirrors about its own; later ones are differences.
  void project(const Pass& pass, const StepInfo& step);
  void update_filter(const Pass& pass, const StepInfo& step);
  void keep_free_velocity(const Manner& manner);
  void measure_constraints();
  /// Applies conditions, contact and conditions again to the grid's velocity without what they have added so far; of
  /// ledger and records the contact force alone changes.
  void constrain_velocity(const Pass& pass, const StepInfo& step);
  void restore_velocity(const Pass& pass);
  void end_filter(const Pass& pass, const StepInfo& step);
  void add_correction(const Pass& pass, const StepInfo& step);

  // ---- checkpoint.cpp
  /// What `prepared_` is about, body by body; empty where it is false.
  std::vector<char> prepared_values() const;
  void take_prepared_values(const std::vector<char>& bytes);
  /// The second moments of a body's particles, which are made where they are asked for, m^2. A particle without a
  /// stencil has none: the next pass that needs it says so.
  std::vector<double> second_moments(const Body<T>& body) const;

  // ---- totals.cpp
  /// Runs a phase that makes sums and largest values of a body's particles, and leaves them at a place of `totals_`.
  void sum_particles(const std::string& phase, const Body<T>& body, int count, int maxima, int place) const;

  // ---- small helpers
  bool periodic(int axis) const { return scene_.walls[axis][0] == wall_periodic; }
  int nodes() const { return scene_.node_count; }
  int vectors() const { return experiment_.dimension * scene_.node_count; }
  int lines_along(int axis) const { return nodes() / scene_.extent[axis]; }
  /// Makes sums that begin with zero.
  template <std::size_t count>
  Tally<count> tally() {
    auto made = std::make_shared<std::array<double, count>>();
    later([made] { *made = {}; });
    return made;
  }
  /// Runs a phase that makes this many sums and adds them, times a factor, to others.
  template <std::size_t count>
  void sum(const std::string& phase, const Arguments<T>& a, int indices, const Tally<count>& to, double factor = 1) {
    const std::size_t at = place(count);
    join(phase, a, indices, count, at);
    results_.later([to, at, factor](const double* sums) {
      for (std::size_t k = 0; k < count; ++k) (*to)[k] += factor * sums[at + k];
    });
  }
  template <std::size_t count>
  Tally<count> sum(const std::string& phase, const Arguments<T>& a, int indices) {
    const Tally<count> made = tally<count>();
    sum<count>(phase, a, indices, made);
    return made;
  }
  /// Calls visit(field, number) for the fields that last from one step to the next, in order.
  template <class Visit>
  static void for_each_saved(const Body<T>& body, Visit visit) {
    for (int number = 0; number < static_cast<int>(body.arrays.fields().size()); ++number) {
      const Field& field = body.arrays.fields()[static_cast<std::size_t>(number)];
      if (field.lifetime == Lifetime::saved) visit(field, number);
    }
  }
  /// The time of the walls' velocity: that of v- before the forces, of v+ after them.
  static double time_of(const Pass& pass, const StepInfo& step) {
    return pass.stage == Stage::after_forces ? step.time + step.dt : step.time;
  }

  const Experiment& experiment_;
  const Plan& plan_;
  Arguments<T> scene_;              ///< what all launches share; its pointers are the device's
  std::vector<BodyLoads> loads_;    ///< of each body
  std::unique_ptr<Device> device_;  ///< outlives the arrays on it
  int lanes_, teams_;               ///< of a team, and at work on blocks at once
  DeviceArray<double> shape_parameters_, transfer_parameters_, filter_parameters_, contact_parameters_,
      normal_parameters_, detection_parameters_;
  DeviceArray<double> partial_sums_;
  DeviceArray<double> totals_;  ///< of one body (kernels/totals_list.hpp)
  bool deterministic_;          ///< particles are summed to the same bits in any order of lanes
  DeviceArray<int> exponents_;  ///< see kernels/exact_sums.hpp
  DeviceArray<unsigned long long> exact_sums_;
  Results results_;
  int launches_ = 0;  ///< since the host has looked
  std::vector<Watched> watched_;
  FormulaNumbers<T> formulas_;
  double time_ = 0, end_ = 0;  ///< at which the step under way begins and ends, s
  Conditions<T> conditions_;
  std::optional<HeatConditions<T>> heat_conditions_;  ///< empty in scenes without temperature
  std::vector<Body<T>> bodies_;
  DeviceArray<LoadLaw<T>> load_laws_;
  std::vector<VelocityField<T>> fields_;
  std::vector<int> images_, walls_;  ///< axes with periodic images, and those with walls
  bool merges_;                      ///< momenta are scattered with what forces add to them in the step
  bool folds_forces_ = false;        ///< nodes have sums that are folded with the forces
  ContactEdges edges_;
  std::optional<ContactSight<T>> contact_sight_;  ///< where contact looks at particles
  std::optional<ContactNotes<T>> contact_notes_;  ///< where single nodes are recorded
  std::vector<DeviceArray<double>> welds_;        ///< [pair_index] where the law reads the traction
  TimeStepLimit limit_;
  Ledger ledger_;
  HeatLedger heat_ledger_;
  bool accounted_ = false;  ///< the ledger takes its entries from the step under way
  ContactRecord contact_;
  ContactImpulse contact_impulse_;
  ReactionImpulse reactions_;
  RigidNodes<T> rigid_;
  bool notes_reactions_ = false;  ///< the pass under way notes what supports give
  FilterRecord filter_;
  int filter_pass_ = 0;    ///< how many passes of the filter's loop are launched in the step
  bool prepared_ = false;  ///< stress, volume ratio and block of each particle are those of its place and state
  bool uses_graphs_;
  long steps_to_forget_;
  StepGraphs graphs_;
  std::vector<WaitingPass> waiting_;
  std::string last_pass_;                 ///< name of the pass that ends every step
  double scattered_energy_ = 0;           ///< kinetic energy of the grid as scattered, images summed, J
  double energy_after_ = 0;               ///< kinetic energy of the grid when particles gather from it, J
  double works_ = 0;                      ///< works on the grid since the scatter, J
  std::array<double, 2> lumped_power_{};  ///< works of the stresses' forces and of gravity at v+ before any filter, J
  double early_share_ = 0;                ///< share of the step's strain that came before the forces
  double energy_before_move_ = 0;         ///< kinetic energy of the particles after the gather, J
  double scattered_heat_ = 0;             ///< heat of the particles that the step's scatter began with, J
  double heat_of_images_ = 0;       ///< heat that folding has given the grid at walls that do something with heat, J
  std::array<double, 2> beyond_{};  ///< see fill_temperature, before the step's heat
  double heat_after_ = 0;           ///< heat of the grid when particles gather from it, J
};

}  // namespace mpm::device

#pragma once
// A run, which executes the plan's passes step by step on one backend.

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

struct Solver;
class ParticleChanges;

class Simulation {
 public:
  /// Plans, seeds and builds the backend. `experiment` must outlive the simulation. Throws InputError.
  Simulation(const Experiment& experiment, const BackendFactory& make_backend);
  Simulation(const Simulation&) = delete;  // the backend refers to the plan
  ~Simulation();

  bool finished() const;
  /// Takes one time step: chooses dt and executes every pass of the plan. Throws RunFailure, which leaves the state as
  /// it was when the step failed.
  void step();
  /// Says by wanted(time in s, number of steps) which steps will be looked at; at first all are. It is asked as a step
  /// begins, and of a step that was not wanted then once more before its particles move. After steps that are not wanted
  /// there are no nodes of contact, and velocities and the transfer's state may be missing (see `observed`); all else is
  /// the same.
  void observe_when(std::function<bool(double, long)> wanted) { wanted_ = std::move(wanted); }
  /// Whether the state after the last step may be read and saved.
  bool observed() const { return observed_; }

  double time() const { return time_; }          ///< s
  double last_time_step() const { return dt_; }  ///< s
  double smallest_time_step() const { return smallest_; }
  double largest_time_step() const { return largest_; }
  long steps() const { return steps_; }
  std::size_t particle_count() const { return particles_; }
  std::size_t particle_count(int body) const { return body_particles_[static_cast<std::size_t>(body)]; }
  /// The sum over all steps of the number of particles.
  double particle_steps() const { return particle_steps_; }
  /// What emitters, sinks and changes of material did; null where the scene has none.
  const ParticleChanges* particle_changes() const { return changes_.get(); }
  /// The number of passes of the filter's loop so far, over all steps.
  long filter_passes() const { return filter_passes_; }

  /// The sums over all steps so far: the entries of the first step once, and those of each other step that the ledger
  /// took ledger_every times, as it stands for the steps around it. What particles bring and take is counted each time.
  Ledger ledger() const;
  HeatLedger heat_ledger() const;

  /// The place of the particle that stopped the last step.
  FailurePlace place_of(const Failure& failure) const;

  /// Saves everything that later steps depend on. `restore` on a simulation of the same experiment goes on bit for bit,
  /// whatever the number of threads; it throws ArchiveError.
  void save(ArchiveWriter& archive) const;
  void restore(ArchiveReader& archive);

  const Experiment& experiment() const { return experiment_; }
  const Plan& plan() const { return plan_; }
  Backend& backend() { return *backend_; }
  const Backend& backend() const { return *backend_; }

  /// Why the last estimate of the automatic time step is not larger, as the solver says it ("wave", "diffusion"); and
  /// why the smallest step was not, which may be "end of the run". Both are empty when dt is fixed.
  const std::string& limited_by() const { return limited_by_; }
  const std::string& smallest_limited_by() const { return smallest_limited_by_; }
  /// The particle whose speed limits the automatic time step: "particle 12 of disc (wave 3.1 m/s + speed 0.4 m/s)";
  /// empty when dt is fixed, or limited by something else than speeds.
  std::string limiting_particle() const;
  /// The seconds spent in each pass so far, by name.
  const std::map<std::string, double>& seconds_by_pass() const { return seconds_; }

 private:
  bool ends_at(double time) const;
  double time_step_from(double time) const;
  double end_of_step() const;
  void execute(const Step& step, StepInfo& info);
  void execute(const Pass& pass, StepInfo& info);
  void gather(const Step& step, StepInfo& info);
  void begin(StepInfo& info);
  void take_limit();
  bool ends_with_step() const;  ///< whether the step that is under way is the run's last one
  bool may_scatter_ahead() const;
  bool filter_due();
  bool changes_at(double time, long steps) const;
  void count_particles();
  void change_particles();

  const Experiment& experiment_;
  Plan plan_;
  const Solver& solver_;
  const BackendFactory make_backend_;
  const bool imposes_by_time_;  ///< whether a formula of walls, boxes or gravity has to be looked at in each step
  bool limited_by_speed_ = false, observed_ = true;
  bool chosen_ = false;         ///< dt of this step is known
  bool scattered_ = false;      ///< the grid holds this step's scatter already
  bool must_estimate_ = false;  ///< the particles are others than those of the last estimate
  std::unique_ptr<ParticleChanges> changes_;
  std::unique_ptr<Backend> backend_;
  double time_ = 0, dt_ = 0, estimate_ = 0, smallest_ = 0, largest_ = 0;
  std::string limited_by_, smallest_limited_by_;
  double estimated_speed_ = 0;                              ///< speed of the last estimate, m/s
  long estimate_every_ = std::numeric_limits<long>::max();  ///< steps from one estimate to the next
  double filter_clock_ = 0;                                 ///< time or cells since the filter last acted
  std::function<bool(double, long)> wanted_;
  Ledger first_entries_;  ///< entries of the first step
  long steps_ = 0;
  long filter_passes_ = 0;
  std::size_t particles_ = 0;
  std::vector<std::size_t> body_particles_;
  double particle_steps_ = 0;
  std::map<std::string, double> seconds_;
};

}  // namespace mpm

#pragma once
// Steps of one kind launch the same phases with the same arguments: after the first ones they are collected in a graph,
// which the device runs as a whole. What a step needs of the host, beside what it does with results, keeps it out.

#include <algorithm>
#include <array>
#include <deque>
#include <vector>

#include "backends/device/device.hpp"
#include "backends/device/results.hpp"
#include "plan/step.hpp"
#include "simulation/backend.hpp"

namespace mpm::device {

/// All that the launches of two steps may differ by.
struct StepKind {
  std::vector<const Pass*> passes;
  double dt = 0;
  bool filtered = false, accounted = false, notes_contact = false;
  bool first_of_state = false;  ///< the first step, of which a law of contact with a state is told
  bool prepared = false;        ///< the step before has found what the scatter asks of particles
  bool forgets = false;         ///< it begins with a grid that no particle has reached
  Vector3 gravity{};

  bool operator==(const StepKind&) const = default;
};

/// A launch that may report a particle of a body: its number in the step, the body, and why the phase reports.
struct Watched {
  int launch;
  int body;
  int checks;
};

/// What is known of one kind of steps.
struct KnownStep {
  StepKind kind;
  bool alone = false;               ///< the device last did it without the host
  GraphExecHandle graph = nullptr;  ///< null until it is made
  std::vector<Results::Use> uses;   ///< what the host does after it
  std::size_t used = 0;             ///< room of its results
  std::vector<Watched> watched;
  bool prepares = false;  ///< it finds that for the next one
};

/// The kinds of steps that came last.
class StepGraphs {
 public:
  explicit StepGraphs(Device& device) : device_(device) {}
  ~StepGraphs() {
    for (const KnownStep& step : known_) forget(step);
  }
  StepGraphs(const StepGraphs&) = delete;
  StepGraphs& operator=(const StepGraphs&) = delete;

  KnownStep& of(const StepKind& kind) {
    const auto found =
        std::find_if(known_.begin(), known_.end(), [&](const KnownStep& step) { return step.kind == kind; });
    if (found != known_.end()) return *found;
    if (known_.size() == most) forget(known_.front()), known_.pop_front();
    return known_.emplace_back(KnownStep{kind, false, nullptr, {}, 0, {}});
  }

 private:
  static constexpr std::size_t most = 16;

  void forget(const KnownStep& step) {
    if (step.graph) device_.free(step.graph);
  }

  Device& device_;
  std::deque<KnownStep> known_;
};

}  // namespace mpm::device

#pragma once
// The yardstick of `mpm bench`: MLS-MPM as a short plain program writes it, one structure a particle, one dense grid,
// no lanes, no tiles, no sorting, one thread. Its algorithm and flags are written down in docs/benchmarks and are
// frozen: ratios to it can be compared from year to year.

#include <memory>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm::bench {

class Baseline {
 public:
  virtual ~Baseline() = default;
  virtual void step() = 0;
  virtual std::size_t particle_count() const = 0;
  /// Positions of the particles, m, particle-major, in the order of seeding.
  virtual std::vector<double> positions() const = 0;
  /// Velocities of the particles, m/s, in the same layout.
  virtual std::vector<double> velocities() const = 0;
};

/// Why the baseline cannot run an experiment; empty when it can. It knows one body, quadratic B-splines, MLS, coupled
/// logarithmic Neo-Hookean, slip walls and a fixed step.
std::string baseline_refusal(const Experiment& experiment);

/// Makes the baseline in the experiment's dimension and precision, with the very particles that the sandbox seeds.
/// Throws std::invalid_argument with baseline_refusal.
std::unique_ptr<Baseline> make_baseline(const Experiment& experiment);

}  // namespace mpm::bench

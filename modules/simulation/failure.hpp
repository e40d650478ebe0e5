#pragma once
// Why a run cannot go on: a record, which backends fill in. Its words are made of it once, for whoever reads them.

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "experiment/experiment.hpp"
#include "simulation/value_row.hpp"

namespace mpm {

enum class Cause {
  domain_outgrew_stencil,    ///< the particle's box is longer than the nodes of its shape hold
  domain_inside_out,         ///< its corners have passed one another
  domain_beyond_grid,        ///< its list has nodes beyond the padding of the domain
  deformation_not_a_number,  ///< some of the material's state is not
  inverted,                  ///< J <= 0
  position_not_a_number,
  reached_axis,  ///< r <= 0 of an axisymmetric scene
  left_domain,
  speed_not_a_number  ///< the largest of the waves and particles, from which the time step follows
};
std::span<const Cause> all_causes();

/// In two or three words, as summary.json and study.json have it: "left the domain". Causes that one remedy helps
/// against may share them.
const char* name_of(Cause cause);

struct Failure {
  Cause cause;
  int body = 0;
  std::size_t particle = 0;  ///< index in the order of seeding
  int axis = -1;             ///< of positions and stencils; -1 for causes without one
  /// Position along the axis, m; J; speed, m/s. NaN where that is what is wrong, or where there is none.
  double value = std::numeric_limits<double>::quiet_NaN();
};

/// Whether `a` is reported of two failures of one pass. A pass looks at domains first, then at deformations, then at
/// positions; of the particles that fail alike the lowest body, index and axis count.
bool comes_before(const Failure& a, const Failure& b);

/// A run that cannot go on. Maps to exit code 3. what() is the cause's name.
class RunFailure : public std::runtime_error {
 public:
  explicit RunFailure(const Failure& failure) : std::runtime_error(name_of(failure.cause)), failure(failure) {}
  Failure failure;
};

/// What a pass reports of all that it comes upon. Threads take turns.
class FirstFailure {
 public:
  void note(const Failure& failure) {
    if (!first_ || comes_before(failure, *first_)) first_ = failure;
  }
  bool any() const { return first_.has_value(); }
  /// Throws RunFailure where anything was noted, and forgets it.
  void raise() {
    if (const std::optional<Failure> first = std::exchange(first_, std::nullopt)) throw RunFailure(*first);
  }

 private:
  std::optional<Failure> first_;
};

// ---- words ----------------------------------------------------------------------------------------------------------

/// Where a particle was when its run stopped.
struct FailurePlace {
  long step = 0;                 ///< the one that was not finished, from 1
  double time = 0;               ///< s, at its start
  std::vector<double> position;  ///< m, dimension
};

/// "left the domain at x = 2 m"
std::string cause_text(const Failure& failure, const Experiment& experiment);
/// "(0.1, 0.2) m"
std::string point_text(std::span<const double> position);
/// "step 3, t = 0.1 s: particle 4 of body "b" at (2, 0) m"
std::string place_text(const Failure& failure, const FailurePlace& place, const Experiment& experiment);
/// What to change in the experiment: "a larger /grid/domain, or …".
std::string remedy_for(const Failure& failure);
/// What was found and what bounds it.
std::vector<ValueRow> values_of(const Failure& failure, const Experiment& experiment);

}  // namespace mpm

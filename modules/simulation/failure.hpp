#pragma once
// A record of why a run cannot go on, which backends fill in. Words are made from it once, for all who read them.

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
  force_not_a_number,        ///< an expression of the force on it has no finite value
  temperature_not_a_number,  ///< the temperature that the grid gives it
  deformation_not_a_number,  ///< part of the material's state is not a number
  inverted,                  ///< J <= 0
  position_not_a_number,
  reached_axis,  ///< r <= 0 in an axisymmetric scene
  left_domain,
  speed_not_a_number,  ///< largest speed of waves and particles, from which the time step follows
  too_many_particles,  ///< an emitter would give its body more than it may
  no_particle_left     ///< sinks have taken all of the scene
};
std::span<const Cause> all_causes();

/// The name of a cause in two or three words, as in summary.json and study.json: "left the domain". Causes that one
/// remedy helps against may share a name.
const char* name_of(Cause cause);

/// Whether one particle fails; else the scene does, between steps.
constexpr bool is_of_a_particle(Cause cause) {
  return cause != Cause::too_many_particles && cause != Cause::no_particle_left;
}

struct Failure {
  Cause cause;
  int body = 0;
  std::size_t particle = 0;  ///< index in the order of seeding
  int axis = -1;             ///< axis of a position or stencil; -1 for causes without one
  /// The position along the axis, m, or J, or the speed, m/s, or the temperature, K, or a number of particles. It is NaN
  /// where that is the failure or none applies.
  double value = std::numeric_limits<double>::quiet_NaN();
  /// Of a force: its expression, with its place in the file, and what is wrong with it. Of too many particles: what the
  /// memory lacks.
  std::string formula{};
  std::string name{}, unit{};  ///< of a force: those of `value`
};

/// Whether a value is a number within the range of a precision.
bool represents(Precision precision, double value);
/// Whether a formula gives such numbers at a place x that began at X (m), also with its operations done in the scene's
/// precision.
bool gives_numbers(const Experiment& experiment, const VectorExpression& formula, const Vector3& x, const Vector3& X,
                   double time);

/// The failure of a particle where a load, or without one /body_force, has no finite value at the place x that it acts on,
/// which began at X (m), or none that the scene's precision holds: whose operations a backend may have done in it, so that
/// double precision finds a number there.
Failure force_failure(const Experiment& experiment, const Load* load, int body, std::size_t particle, const Vector3& x,
                      const Vector3& X, double time);

/// Whether `a` is the one of two failures of a pass that is reported. A pass checks domains first, then forces,
/// temperatures, deformations and positions; of particles that fail alike the one with the lowest body, index and axis is reported.
bool comes_before(const Failure& a, const Failure& b);

/// Thrown when a run cannot go on. It maps to exit code 3, and what() is the cause's name.
class RunFailure : public std::runtime_error {
 public:
  explicit RunFailure(const Failure& failure) : std::runtime_error(name_of(failure.cause)), failure(failure) {}
  Failure failure;
};

/// Keeps the failure that a pass reports of all that it finds. Threads that note failures have to take turns.
class FirstFailure {
 public:
  void note(const Failure& failure) {
    if (!first_ || comes_before(failure, *first_)) first_ = failure;
  }
  void note(const FirstFailure& other) {
    if (other.first_) note(*other.first_);
  }
  bool any() const { return first_.has_value(); }
  const std::optional<Failure>& first() const { return first_; }
  /// Throws RunFailure where a failure was noted, and forgets it.
  void raise() {
    if (const std::optional<Failure> first = std::exchange(first_, std::nullopt)) throw RunFailure(*first);
  }

 private:
  std::optional<Failure> first_;
};

// ---- words ----------------------------------------------------------------------------------------------------------

/// The place and time of a particle when its run stopped.
struct FailurePlace {
  long step = 0;                 ///< number of the unfinished step, from 1
  double time = 0;               ///< time at the start of that step, s
  std::vector<double> position;  ///< m, dimension
};

/// The cause in words: "left the domain at x = 2 m".
std::string cause_text(const Failure& failure, const Experiment& experiment);
/// A point in words: "(0.1, 0.2) m".
std::string point_text(std::span<const double> position);
/// The place in words: "step 3, t = 0.1 s: particle 4 of body "b" at (2, 0) m".
std::string place_text(const Failure& failure, const FailurePlace& place, const Experiment& experiment);
/// Advice on what to change in the experiment: "a larger /grid/domain, or …".
std::string remedy_for(const Failure& failure, const Experiment& experiment);
/// The value that was measured and its bound, as rows.
std::vector<ValueRow> values_of(const Failure& failure, const Experiment& experiment);

}  // namespace mpm

#pragma once
// Looks at what formulas impose: walls and boxes may give a number that no velocity, temperature, flux or power can be,
// gravity one that is not finite. All backends evaluate the same formulas, so they are looked at here, on the nodes of the domain.

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/diagnostics.hpp"
#include "experiment/experiment.hpp"

namespace mpm {

/// What a formula imposes and nothing can have: a value that is not finite, or a temperature below 0 K.
struct ImposedValue {
  std::string pointer;  ///< of the formula, with its component where it is one of a list
  std::string name, unit;
  double value = 0;
  double time = 0;                 ///< s
  std::vector<double> position{};  ///< m, dimension; empty where it is the same everywhere
  std::string why{};               ///< the operation that gives no finite number, with its numbers
};

/// The times for which a step evaluates formulas, s: gravity at its start, supports and heat at its end too.
struct StepTimes {
  double start = 0, end = 0;
};

/// The first such value in a step: of gravity, and of the velocity and the heat on a wall's or in a box's nodes within the
/// domain, wherever bodies are; only of formulas that change in time where `changing`.
std::optional<ImposedValue> impossible_value(const Experiment& experiment, const StepTimes& times, bool changing);
/// Whether any of these formulas changes in time.
bool imposes_by_time(const Experiment& experiment);

/// The velocity that a formula gives at a point where one of its components is not finite. `held` says which count.
std::optional<ImposedValue> impossible_velocity(const Experiment& experiment, const VectorExpression& velocity,
                                                const std::string& pointer, const std::array<bool, 3>& held,
                                                const Vector3& x, const Vector3& X, double time);

/// The value in words, with its place in the file: "FILE:5:18: /grid/boundaries/x_min/temperature: is -467 K, below 0 K,
/// at t = 0.0767 s, (0, 0.1) m".
Problem problem_of(const Experiment& experiment, const ImposedValue& imposed);
inline constexpr const char* impossible_value_cause = "impossible value imposed";
inline constexpr const char* impossible_value_remedy =
    "check that expression: everywhere that it is evaluated, and up to /solver/end_time, it has to give finite "
    "numbers, and temperatures of at least 0 K; max(0, ...) bounds one";

/// Thrown when a run cannot go on for such a value. It maps to exit code 3, and what() is the text of its problem.
class ImposedValueFailure : public std::runtime_error {
 public:
  ImposedValueFailure(const Experiment& experiment, ImposedValue found)
      : std::runtime_error(problem_of(experiment, found).text()), imposed(std::move(found)) {}
  ImposedValue imposed;
};

/// Throws ImposedValueFailure where a formula of time gives such a value in a step.
void stop_at_impossible_value(const Experiment& experiment, const StepTimes& times);

}  // namespace mpm

#pragma once
// Looks at what formulas impose: walls and boxes may give a number that no temperature, flux or power can be, gravity
// one that is not finite. All backends evaluate the same formulas, so they are looked at here, on the nodes of the domain.

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// What a formula imposes and nothing can have: a value that is not finite, or a temperature below 0 K.
struct ImposedValue {
  std::string pointer;  ///< of the formula
  std::string name, unit;
  double value = 0;
  double time = 0;                 ///< s
  std::vector<double> position{};  ///< m, dimension; empty where it is the same everywhere
};

/// The times for which a step evaluates formulas, s: gravity at its start, supports and heat at its end too.
struct StepTimes {
  double start = 0, end = 0;
};

/// The first such value in a step: of gravity, and of heat on a wall's or in a box's nodes within the domain, wherever
/// bodies are; of formulas of time alone where `changing`.
std::optional<ImposedValue> impossible_value(const Experiment& experiment, const StepTimes& times, bool changing);

/// The value in words: "is -467 K, below 0 K, at t = 0.0767 s, (0, 0.1) m".
std::string text_of(const ImposedValue& imposed);
inline constexpr const char* impossible_value_cause = "impossible value imposed";
inline constexpr const char* impossible_value_remedy =
    "check that expression: everywhere that it is evaluated, and up to /solver/end_time, it has to give finite "
    "numbers, "
    "and temperatures of at least 0 K; max(0, ...) bounds one";

/// Thrown when a run cannot go on for such a value. It maps to exit code 3, and what() is text_of it.
class ImposedValueFailure : public std::runtime_error {
 public:
  explicit ImposedValueFailure(ImposedValue found) : std::runtime_error(text_of(found)), imposed(std::move(found)) {}
  ImposedValue imposed;
};

/// Throws ImposedValueFailure where a formula of time gives such a value in a step.
void stop_at_impossible_value(const Experiment& experiment, const StepTimes& times);

}  // namespace mpm

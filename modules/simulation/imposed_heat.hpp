#pragma once
// Looks at what walls and boxes do with heat: a formula may give a number that no temperature, flux or power can be.
// All backends evaluate the same formulas, so they are looked at here, on the nodes of the domain.

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// What a wall or a box imposes and nothing can have: a value that is not finite, or a temperature below 0 K.
struct ImposedHeat {
  std::string pointer;  ///< of the formula
  std::string name, unit;
  double value = 0;
  double time = 0;                 ///< s
  std::vector<double> position{};  ///< m, dimension
};

/// The first such value at a time, s, on a wall's or in a box's nodes within the domain, wherever bodies are; of
/// formulas of time alone where `changing`.
std::optional<ImposedHeat> impossible_heat(const Experiment& experiment, double time, bool changing);

/// The value in words: "is -467 K, below 0 K, at t = 0.0767 s, (0, 0.1) m".
std::string text_of(const ImposedHeat& imposed);
inline constexpr const char* impossible_heat_cause = "impossible value imposed";
inline constexpr const char* impossible_heat_remedy =
    "check that expression: on the whole wall or box, and up to /solver/end_time, it has to give finite numbers, and "
    "temperatures of at least 0 K; max(0, ...) bounds one";

/// Thrown when a run cannot go on for such a value. It maps to exit code 3, and what() is text_of it.
class ImposedHeatFailure : public std::runtime_error {
 public:
  explicit ImposedHeatFailure(ImposedHeat found) : std::runtime_error(text_of(found)), imposed(std::move(found)) {}
  ImposedHeat imposed;
};

/// Throws ImposedHeatFailure where a formula of time gives such a value at the end of a step, s.
void stop_at_impossible_heat(const Experiment& experiment, double end);

}  // namespace mpm

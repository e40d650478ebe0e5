#pragma once
// What the study of largest steps says of a run on tents: no limit of the step is sure for them.

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "experiment/experiment.hpp"

namespace mpm::app {

/// A scheme with the stress last that stood less on the shape "linear" than that shape's limit of the step
/// (figures/studies/largest_step.csv and largest_step_3d.csv, which tests/unit/tent_steps.cpp compares).
struct TentStep {
  int dimension;
  std::string_view transfer, filter;  ///< ids; filter "" where there is none
  double largest;                     ///< Courant number that it stood; 0: not the smallest that was tried
};
std::span<const TentStep> tent_steps();

/// A scheme that on the shape "linear" failed in three or more of five collisions at one of these steps
/// (figures/studies/tent_steps_1.csv to tent_steps_4.csv, and tent_steps_3d_1.csv to tent_steps_3d_4.csv, which
/// tests/unit/tent_steps.cpp compares).
struct TentCollisions {
  static constexpr std::array steps{0.0125, 0.025, 0.05, 0.1};  ///< Courant numbers
  int dimension;
  StressUpdate update;
  std::string_view transfer, filter;  ///< ids; filter "" where there is none
  std::array<int, 4> bounded;         ///< of five collisions, at each of the steps
};
std::span<const TentCollisions> tent_collisions();

/// What to say of a run on tents whose automatic step is longer than what its scheme stood in the study,
/// or was bounded at in fewer than half of the collisions; "" of all others.
std::string warning_of_tent_steps(const Experiment& experiment);

}  // namespace mpm::app

#pragma once
// What becomes of a material that is crushed, torn, drawn out, turned inside out, or shaken by many small cycles.

#include <functional>
#include <string>
#include <vector>

#include "drive/material_point.hpp"

namespace mpm::drive {

enum class Outcome {
  right,           ///< J is that of the path, all numbers are finite and the energy is not negative
  refused,         ///< the plugin takes the particle no further, so that a run would stop and name it
  wrong_volume,    ///< J is off by more than a millionth
  not_finite,      ///< a number is infinite or none, and the plugin says nothing
  negative_energy  ///< the stored energy is below that at rest
};
const char* name_of(Outcome outcome);

/// What a path goes through: volume ratios, stretches at J = 1, or shears.
enum class ExtremeKind { volume, stretch, shear };

struct Extreme {
  std::string name;
  ExtremeKind kind = ExtremeKind::volume;
  int steps = 0;  ///< of the path; 0: cycles, and no path
  Outcome outcome = Outcome::right;
  bool must_be_refused = false;  ///< a state that no body can have
  Response end;                  ///< the last state that was taken
  double stiffness = 0;          ///< density times the square of the wave speed at rest, Pa
  /// Of paths of many steps: each state that was taken, with the volume ratio, the stretch or the shear that it has.
  std::vector<std::pair<double, Response>> course;
  /// Of the cycles: the change of the stress over stiffness at rest, cycles and rounding, 2^-52.
  double drift = 0;
  std::vector<std::string> clamps;  ///< those of the material that acted: where each begins, and what it does
  /// The outcome in words.
  std::string outcome_text() const;
  bool holds() const { return must_be_refused ? outcome == Outcome::refused : outcome <= Outcome::refused; }
};

struct ExtremeSize {
  double smallest_ratio = 1e-6;  ///< of volumes; the largest is its inverse
  double stretch = 1e4;          ///< along x at J = 1, and the shear
  double duration = 1;           ///< s, of each path
  int steps = 1000;              ///< of each path
  long cycles = 100000;
};

/// Follows every extreme in double precision. `stop` is asked between two of them.
std::vector<Extreme> extremes(const Component& material, int dimension, const ExtremeSize& size,
                              const std::function<bool()>& stop);

}  // namespace mpm::drive

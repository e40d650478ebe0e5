// A shock in a solid in strain along one axis, by the jump conditions of mass and momentum and the solid's stored energy.
#pragma once

#include <cmath>

namespace mpm::test {

/// A coupled Neo-Hookean solid with the logarithmic volumetric energy that comes to rest from a speed, m/s: the stretch behind
/// the shock by bisection of -P (1 - s) = density u^2, with P = (mu (s^2 - 1) + lambda ln s) / s.
struct SolidShock {
  double stretch = 0;     ///< s
  double speed = 0;       ///< m/s, through the material as it was
  double pressure = 0;    ///< Pa
  double dissipated = 0;  ///< J/m^3 of the material as it was: density u^2 / 2 less what is stored

  SolidShock(double youngs_modulus, double poisson_ratio, double density, double u) {
    const double mu = youngs_modulus / (2 * (1 + poisson_ratio)),
                 lambda = youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
    double below = 0.5, above = 1 - 1e-4;
    for (int k = 0; k < 100; ++k) {
      const double s = (below + above) / 2;
      (-(mu * (s * s - 1) + lambda * std::log(s)) / s * (1 - s) > density * u * u ? below : above) = s;
    }
    stretch = below, speed = u / (1 - stretch);
    const double squared = stretch * stretch, l = std::log(stretch);
    pressure = -(mu * (squared - 1) + 3 * lambda * l) / 3 / stretch;
    dissipated = density * u * u / 2 - (mu / 2 * (squared - 1 - 2 * l) + lambda / 2 * l * l);
  }
};

}  // namespace mpm::test

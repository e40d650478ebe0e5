#pragma once
// Exact solutions of gas dynamics with g = 1.4: the shock before a piston, and a shock tube.

#include <cmath>

namespace mpm::test::gas {

inline constexpr double g = 1.4;  ///< ratio of heat capacities

/// What a shock makes of gas at rest with density and pressure 1 that a piston of speed u meets: Rankine and Hugoniot.
struct PistonShock {
  explicit PistonShock(double u) {
    const double sound = std::sqrt(g), m = (g + 1) / 4 * u / sound, mach = m + std::sqrt(1 + m * m);
    speed = mach * sound;
    pressure = 1 + 2 * g / (g + 1) * (mach * mach - 1);
    density = (g + 1) * mach * mach / ((g - 1) * mach * mach + 2);
  }
  double speed, pressure, density;
};

struct State {
  double density, velocity, pressure;
};

/// The Riemann problem of two gases at rest whose solution is a rarefaction on the left and a shock on the right (E. F. Toro,
/// Riemann Solvers and Numerical Methods for Fluid Dynamics, ch. 4).
struct ShockTube {
  State left, right;
  double pressure = 0, velocity = 0;           ///< between the waves
  double left_density = 0, right_density = 0;  ///< on both sides of the contact
  double head = 0, tail = 0, shock = 0;        ///< speeds

  ShockTube(const State& l, const State& r) : left(l), right(r) {
    const double a = sound(left), b = sound(right);
    const auto by_left = [&](double p) {
      return 2 * a / (g - 1) * (1 - std::pow(p / left.pressure, (g - 1) / (2 * g)));
    };
    const auto by_right = [&](double p) {
      return (p - right.pressure) * std::sqrt(2 / (g + 1) / right.density / (p + (g - 1) / (g + 1) * right.pressure));
    };
    double low = right.pressure, high = left.pressure;
    for (int k = 0; k < 100; ++k) {
      pressure = 0.5 * (low + high);
      (by_left(pressure) > by_right(pressure) ? low : high) = pressure;
    }
    velocity = by_left(pressure);
    const double q = pressure / right.pressure, r1 = (g - 1) / (g + 1);
    left_density = left.density * std::pow(pressure / left.pressure, 1 / g);
    right_density = right.density * (q + r1) / (r1 * q + 1);
    head = -a, tail = velocity - std::sqrt(g * pressure / left_density);
    shock = b * std::sqrt((g + 1) / (2 * g) * q + (g - 1) / (2 * g));
  }
  static double sound(const State& s) { return std::sqrt(g * s.pressure / s.density); }

  /// The state on the ray x/t.
  State at(double ray) const {
    if (ray < head) return left;
    if (ray < tail) {
      const double u = 2 / (g + 1) * (sound(left) + ray), ratio = 1 - (g - 1) / 2 * u / sound(left);
      return {left.density * std::pow(ratio, 2 / (g - 1)), u, left.pressure * std::pow(ratio, 2 * g / (g - 1))};
    }
    if (ray < velocity) return {left_density, velocity, pressure};
    if (ray < shock) return {right_density, velocity, pressure};
    return right;
  }
};

}  // namespace mpm::test::gas

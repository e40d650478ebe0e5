#pragma once
// Exact solutions of conduction that scenes with temperature are held against: slabs with each kind of end, Stefan's
// problem with one phase and with two (Neumann), plastic work in simple shear. Nothing here comes from the program.

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

namespace mpm::test {

/// One phase of a material: k, W/(m K), and c, J/(kg K); with the density that both phases share, kg/m^3.
struct ConductingPhase {
  double conductivity, heat_capacity, density;
  double diffusivity() const { return conductivity / (density * heat_capacity); }  ///< m^2/s
};

/// The root of a function that is positive at `low` and falls through zero once in (low, high], to the last bit.
inline double falling_root(double low, double high, const std::function<double(double)>& function) {
  if (!(function(high) <= 0)) throw std::invalid_argument("no root is bracketed");
  while (true) {
    const double middle = low + 0.5 * (high - low);
    if (middle <= low || middle >= high) return high;
    (function(middle) > 0 ? low : high) = middle;
  }
}

/// A half-space x > 0 of one temperature whose wall is set to another, beyond its melting temperature, at t = 0.
/// Neumann's solution of Stefan's problem, equal densities: Carslaw & Jaeger (1959), Conduction of Heat in Solids,
/// sec. 11.2, eqs. (20) to (24). A start at the melting temperature makes it the problem of one phase.
class StefanProblem {
 public:
  ConductingPhase at_wall, beyond;  ///< phase between wall and front, and the one that it replaces
  double latent_heat;               ///< J/kg
  double wall, melting, start;      ///< K

  /// Stefan number c |T_m - T_w| / L of the phase at the wall.
  double stefan_number() const { return at_wall.heat_capacity * std::abs(melting - wall) / latent_heat; }

  /// The number lambda: the front is at 2 lambda sqrt(alpha t), alpha of the phase at the wall.
  double lambda() const {
    const double root = std::sqrt(at_wall.diffusivity() / beyond.diffusivity());
    const double ratio = beyond.conductivity / at_wall.conductivity * root * (start - melting) / (melting - wall);
    const auto balance = [&](double x) {
      double gradient = std::exp(-x * x) / std::erf(x);
      if (ratio != 0) gradient -= ratio * std::exp(-root * root * x * x) / std::erfc(root * x);
      return stefan_number() * gradient - std::sqrt(std::numbers::pi) * x;
    };
    double high = 1e-6;
    while (balance(high) > 0) high *= 2;
    return falling_root(0.5 * high, high, balance);
  }

  /// Distance of the front from the wall at time t, m.
  double front(double t) const { return 2 * lambda() * std::sqrt(at_wall.diffusivity() * t); }

  double temperature(double x, double t) const {
    const double front_number = lambda(), root = std::sqrt(at_wall.diffusivity() / beyond.diffusivity());
    const double eta = x / (2 * std::sqrt(at_wall.diffusivity() * t));
    if (eta < front_number) return wall + (melting - wall) * std::erf(eta) / std::erf(front_number);
    return start + (melting - start) * std::erfc(root * eta) / std::erfc(root * front_number);
  }
};

/// A slab 0 < x < length whose ends are held at `left` and `right`, with a sine of `amplitude` on the straight line
/// between them at the start. Each part solves the heat equation by itself.
struct SlabOfFixedEnds {
  ConductingPhase material;
  double length, left, right, amplitude;  ///< m, K
  int waves = 1;                          ///< half waves in the slab

  double temperature(double x, double t) const {
    const double b = waves * std::numbers::pi / length;
    return left + (right - left) * x / length +
           amplitude * std::sin(b * x) * std::exp(-material.diffusivity() * b * b * t);
  }
};

/// A slab that takes a constant flux (W/m^2) at x = 0 and none at x = length; it begins with the parabola that then
/// rises evenly, and a cosine that decays.
struct SlabOfFlux {
  ConductingPhase material;
  double length, flux, base, amplitude;  ///< m, W/m^2, K
  int waves = 1;

  double temperature(double x, double t) const {
    const double a = material.diffusivity(), b = waves * std::numbers::pi / length;
    const double rising = flux / (material.conductivity * length) * (0.5 * (length - x) * (length - x) + a * t);
    return base + rising + amplitude * std::cos(b * x) * std::exp(-a * b * b * t);
  }
};

/// A slab that exchanges heat at x = 0 with surroundings by a coefficient (W/(m^2 K)), insulated at x = length: the
/// slowest of its modes.
struct SlabOfConvection {
  ConductingPhase material;
  double length, coefficient, surroundings, amplitude;  ///< m, W/(m^2 K), K

  /// b length, the first root of x tan x = Bi = coefficient length / k.
  double root() const {
    const double biot = coefficient * length / material.conductivity;
    return falling_root(0, 0.5 * std::numbers::pi, [&](double x) { return biot * std::cos(x) - x * std::sin(x); });
  }
  double temperature(double x, double t) const {
    const double b = root() / length;
    return surroundings + amplitude * std::cos(b * (length - x)) * std::exp(-material.diffusivity() * b * b * t);
  }
};

/// Energy that a J2 material with linear hardening has dissipated in a simple shear, J/m^3, where elastic strains are
/// small. It is elastic up to a shear of yield_stress / (sqrt(3) mu); of the rest, plastic flow takes what the growing
/// yield stress leaves it.
inline double plastic_work_in_shear(double shear, double shear_modulus, double yield_stress, double hardening) {
  const double elastic = yield_stress / (std::sqrt(3.0) * shear_modulus);
  if (shear <= elastic) return 0;
  const double plastic = (shear - elastic) / std::sqrt(3.0) / (1 + hardening / (3 * shear_modulus));
  return yield_stress * plastic + 0.5 * hardening * plastic * plastic;
}

}  // namespace mpm::test

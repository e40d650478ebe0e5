#pragma once
// Two elastic cylinders pressed together (Hertz 1882; Johnson, Contact Mechanics, 1985, chapter 4).

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "metrics/particle_quantities.hpp"
#include "support/scene.hpp"

namespace mpm::test::hertz {

constexpr double pi = std::numbers::pi;

/// Two cylinders of R = 8 m, E = 200 Pa, nu = 0.3; half of each, cut off at six half-widths of the contact. Walls press them
/// together from above and below, by `close` m each.
inline const char* cylinders = R"J({
  "dimension": 2, "constants": {"close": 0.18},
  "grid": {"cell_size": 0.136, "domain": [[0, -4.08], [4.76, 4.08]],
           "boundaries": {"x_min": "slip", "x_max": "free",
                          "y_min": {"type": "prescribed", "velocity": [0, "close*pi/10*sin(pi*t/5)"]},
                          "y_max": {"type": "prescribed", "velocity": [0, "-close*pi/10*sin(pi*t/5)"]}}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "contact": {"type": "coulomb", "friction": 0},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 200, "poisson_ratio": 0.3, "density": 1}},
  "bodies": [
    {"name": "lower", "material": "m", "particles_per_cell_axis": 4, "geometry": {"type": "intersection", "of": [
      {"type": "ball", "centre": [0, -8], "radius": 8}, {"type": "box", "lower": [0, -4.08], "upper": [4.08, 4.08]}]}},
    {"name": "upper", "material": "m", "particles_per_cell_axis": 4, "geometry": {"type": "intersection", "of": [
      {"type": "ball", "centre": [0, 8], "radius": 8}, {"type": "box", "lower": [0, -4.08], "upper": [4.08, 4.08]}]}}],
  "solver": {"end_time": 5}, "output": {"ledger": false}})J";

constexpr double modulus = 200 / (2 * (1 - 0.3 * 0.3));  ///< Pa, of the contact of two alike

struct LineContact {
  double force = 0;  ///< N/m
  double half_width() const { return std::sqrt(4 * force * 4 / (pi * modulus)); }
  double pressure() const { return 2 * force / (pi * half_width()); }
};

struct PointContact {
  double force = 0;  ///< N
  double half_width() const { return std::cbrt(3 * force * 4 / (4 * modulus)); }
  double pressure() const { return 1.5 * force / (pi * std::pow(half_width(), 2)); }
};

/// The stress across the surface over the largest pressure, under a line of contact of half-width b at x beside the middle
/// and z below the surface (McEwen), ...
inline double line_stress(double b, double x, double z) {
  const double s = b * b - x * x + z * z, root = std::sqrt(s * s + 4 * x * x * z * z);
  const double m = std::sqrt(0.5 * (root + s)), n = std::sqrt(std::max(0.0, 0.5 * (root - s)));
  return -m / b * (1 - (z * z + n * n) / (m * m + n * n));
}
/// ... and under a circle of contact of radius a at r beside its axis (Huber 1904; Johnson, eq. 3.45).
inline double circle_stress(double a, double r, double z) {
  const double s = r * r + z * z - a * a, root = std::sqrt(s * s + 4 * a * a * z * z);
  const double u = s > 0 ? 0.5 * (s + root) : 2 * a * a * z * z / (root - s);
  return -std::pow(z / std::sqrt(u), 3) * a * a * u / (u * u + a * a * z * z);
}

/// Pressed from rest to rest: the force at the end, mean over the last tenth of the time, and the errors of the stress
/// across the surface up to two half-widths from the middle against that of Hertz for this force.
struct Pressed {
  double force = 0;                     ///< N/m, or N around an axis
  double half_width = 0, pressure = 0;  ///< by Hertz, of this force
  double rms = 0;                       ///< over the largest pressure
  double scale = 0;                     ///< what the exact stress is multiplied with to fit best
  double fitted_width = 0,
         fitted_pressure = 0;  ///< of the field of Hertz that fits the stresses best, whatever the force, over those
};

inline Pressed press(const std::vector<std::string>& settings, bool around_axis = false) {
  Scene scene(cylinders, settings);
  double force = 0, count = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.time() < 4.5) continue;
    force += std::abs(scene.simulation.backend().contact_record().force[1]), count += 1;
  }
  force *= (around_axis ? 1 : 2) / count;  // half of each cylinder is there
  const LineContact line{force};
  const PointContact point{force};
  Pressed found{force, around_axis ? point.half_width() : line.half_width(),
                around_axis ? point.pressure() : line.pressure()};
  struct Place {
    double x, z, stress;
  };
  std::vector<Place> places;
  for (const int body : {0, 1}) {
    const BodyState state = scene.body(body);
    const MaterialQuantities of = material_quantities(scene.experiment, body, state);
    for (std::size_t p = 0; p < of.volume_ratio.size(); ++p) {
      const double x = state.position[2 * p], z = std::abs(state.position[2 * p + 1]);
      if (x <= 2 * found.half_width && z <= 2 * found.half_width)
        places.push_back({x, z, of.stress[4 * p + 1] / of.volume_ratio[p]});
    }
  }
  /// The largest pressure that fits best with a half-width, and the mean square of what is left.
  const auto fit = [&](double width) {
    double product = 0, exact_squares = 0, squares = 0;
    for (const auto& [x, z, stress] : places) {
      const double exact = around_axis ? circle_stress(width, x, z) : line_stress(width, x, z);
      product += stress * exact, exact_squares += exact * exact, squares += stress * stress;
    }
    return std::pair{product / exact_squares,
                     (squares - product * product / exact_squares) / static_cast<double>(places.size())};
  };
  found.scale = fit(found.half_width).first / found.pressure;
  double squares = 0;
  for (const auto& [x, z, stress] : places) {
    const double exact =
        found.pressure * (around_axis ? circle_stress(found.half_width, x, z) : line_stress(found.half_width, x, z));
    squares += (stress - exact) * (stress - exact);
  }
  found.rms = std::sqrt(squares / static_cast<double>(places.size())) / found.pressure;
  double best = INFINITY;
  for (double share = 0.5; share < 2; share += 0.002)
    if (const auto [pressure, left] = fit(share * found.half_width); left < best)
      best = left, found.fitted_width = share, found.fitted_pressure = pressure / found.pressure;
  std::printf(
      "  force %.3f, b %.4f m, p0 %.3f Pa: stress off by %.4f of p0 (rms), %.4f as large; the field that fits best has "
      "%.3f b and %.3f p0\n",
      found.force, found.half_width, found.pressure, found.rms, found.scale, found.fitted_width, found.fitted_pressure);
  return found;
}

}  // namespace mpm::test::hertz

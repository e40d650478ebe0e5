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
  /// Stress across the surface at x beside the middle and z below the surface (McEwen), Pa.
  double stress(double x, double z) const {
    const double b = half_width(), s = b * b - x * x + z * z, root = std::sqrt(s * s + 4 * x * x * z * z);
    const double m = std::sqrt(0.5 * (root + s)), n = std::sqrt(std::max(0.0, 0.5 * (root - s)));
    return -pressure() / b * m * (1 - (z * z + n * n) / (m * m + n * n));
  }
};

/// Pressed from rest to rest: the force (N/m) at the end, mean over the last tenth of the time, and the errors of the stress
/// across the surface up to two half-widths from the middle against that of Hertz for this force.
struct Pressed {
  LineContact contact;
  double rms = 0;    ///< over the largest pressure
  double scale = 0;  ///< what the exact stress is multiplied with to fit best
};

inline Pressed press(const std::vector<std::string>& settings) {
  Scene scene(cylinders, settings);
  double force = 0, count = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.time() < 4.5) continue;
    force += std::abs(scene.simulation.backend().contact_record().force[1]), count += 1;
  }
  Pressed found{{2 * force / count}};  // half of each cylinder is there
  const double b = found.contact.half_width();
  double squares = 0, product = 0, exact_squares = 0;
  count = 0;
  for (const int body : {0, 1}) {
    const BodyState state = scene.body(body);
    const MaterialQuantities of = material_quantities(scene.experiment, body, state);
    for (std::size_t p = 0; p < of.volume_ratio.size(); ++p) {
      const double x = state.position[2 * p], z = std::abs(state.position[2 * p + 1]);
      if (x > 2 * b || z > 2 * b) continue;
      const double exact = found.contact.stress(x, z), stress = of.stress[4 * p + 1] / of.volume_ratio[p];
      squares += (stress - exact) * (stress - exact), count += 1;
      product += stress * exact, exact_squares += exact * exact;
    }
  }
  found.rms = std::sqrt(squares / count) / found.contact.pressure(), found.scale = product / exact_squares;
  std::printf("  F' %.3f N/m, b %.4f m, p0 %.3f Pa: stress off by %.4f of p0 (rms), %.4f as large\n",
              found.contact.force, b, found.contact.pressure(), found.rms, found.scale);
  return found;
}

}  // namespace mpm::test::hertz

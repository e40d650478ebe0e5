#pragma once
// The bar of lesson 5 without the program.

#include <cmath>
#include <vector>

namespace mpm::test {

/// The bar of lesson 5 by finite differences along its own particles: no grid, no shape functions, nothing shared with
/// the program. Returns the mean position at `times`, m.
inline std::vector<double> bar_by_finite_differences(double speed, double modulus, double density,
                                                     const std::vector<double>& times) {
  constexpr int cells = 400;
  const double dx = 1.0 / cells, dt = 0.1 * dx / std::sqrt(modulus / density);
  std::vector<double> x(cells + 1), v(cells + 1), stress(cells), means;
  for (int i = 0; i <= cells; ++i) x[i] = i * dx, v[i] = speed * x[i];
  double time = 0;
  for (const double wanted : times) {
    for (; time < wanted; time += dt) {
      for (int i = 0; i < cells; ++i) {
        const double stretch = (x[i + 1] - x[i]) / dx;
        stress[i] = 0.5 * modulus * (stretch - 1 / stretch);  // neo-Hookean stress without Poisson's effect
      }
      for (int i = 1; i < cells; ++i) v[i] += dt * (stress[i] - stress[i - 1]) / (density * dx);
      v[cells] -= dt * stress[cells - 1] / (0.5 * density * dx);
      for (int i = 1; i <= cells; ++i) x[i] += dt * v[i];
    }
    double sum = 0.5 * (x[0] + x[cells]);
    for (int i = 1; i < cells; ++i) sum += x[i];
    means.push_back(sum * dx);
  }
  return means;
}

}  // namespace mpm::test

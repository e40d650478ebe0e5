#pragma once
// Copper of Mie-Gruneisen's equation of state that a shock has passed and that is then released to no pressure: the jump
// conditions, and the isentrope from there. Meyers (1994), Dynamic Behavior of Materials, ch. 4 and 5.

#include <algorithm>
#include <cmath>

namespace mpm::test {

/// 8930 kg/m^3, shocks of 3940 m/s + 1.489 u_p, Gruneisen's parameter 1.99, of constant quotient with the volume where it is
/// compressed and constant where it is not.
struct ReleasedCopper {
  static constexpr double density = 8930, sound = 3940, slope = 1.489, gruneisen = 1.99, K = density * sound * sound;

  /// What a shock has left whose jump of velocity is `u`, m/s, and what follows by the integrals of dE = -p dJ and du =
  /// sqrt(-dp/dJ / density) dJ, by Runge and Kutta's method in 1 - J and in J.
  explicit ReleasedCopper(double u)
      : shocked_energy(density * u * u / 2), energy(shocked_energy), ratio(1 - u / (sound + slope * u)), velocity(0) {
    constexpr int steps = 4000;
    const double d = (1 - ratio) / steps;
    for (int k = 0; k < steps; ++k) advance(d);
    const double fine = 1e-6;
    while (pressure(ratio + fine, energy) > 0) advance(fine);
    for (int k = 0; k < 40; ++k) advance(-pressure(ratio, energy) / slope_of_pressure(ratio, energy));
  }
  double shocked_energy, energy;  ///< per initial volume, J/m^3
  double ratio;                   ///< J
  double velocity;                ///< of what is released against what is shocked, m/s

 private:
  static double pressure(double J, double E) {
    const double x = 1 - J;
    if (J > 1) return K * (1 / J - 1) + gruneisen * E / J;
    return K * x / std::pow(1 - slope * x, 2) * (1 - gruneisen * x / 2) + gruneisen * E;
  }
  /// dp/dJ at constant entropy.
  static double slope_of_pressure(double J, double E) {
    const double d = 1e-6, p = pressure(J, E);
    return (pressure(J + d, E - p * d) - pressure(J - d, E + p * d)) / (2 * d);
  }
  void advance(double d) {
    const auto energy_at = [](double J, double E) { return -pressure(J, E); };
    const double a = energy_at(ratio, energy), b = energy_at(ratio + d / 2, energy + d / 2 * a),
                 c = energy_at(ratio + d / 2, energy + d / 2 * b), e = energy_at(ratio + d, energy + d * c);
    const double middle = energy + d * (5 * a + 2 * (b + c) * 2 - e) / 24;
    velocity += d * std::sqrt(-slope_of_pressure(ratio + d / 2, middle) / density);
    energy += d * (a + 2 * b + 2 * c + e) / 6, ratio += d;
  }
};

}  // namespace mpm::test

#pragma once
// Finite-strain J2 plasticity whose flow stress depends on plastic strain, its rate and temperature. Johnson & Cook, Proc.
// 7th Int. Symp. on Ballistics (1983) 541; the return is that of kernel/j2_plasticity.hpp.

#include "kernel/j2_plasticity.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct JohnsonCook : J2Plasticity {
  static constexpr double reference_temperature = 293.15;  ///< K, in scenes without temperatures

  struct Parameters {
    double youngs_modulus, poisson_ratio, density, yield_stress, hardening_coefficient, hardening_exponent,
        rate_coefficient, reference_rate, melting_temperature, thermal_exponent, room_temperature, volumetric_energy;
  };
  template <class T>
  struct Constants : J2Constants<T, JohnsonCookHardening<T>> {
    MPM_HD explicit Constants(const Parameters& p)
        : J2Constants<T, JohnsonCookHardening<T>>(
              p, {T(p.yield_stress), T(p.hardening_coefficient), T(p.hardening_exponent), T(p.rate_coefficient),
                  T(p.reference_rate), T(p.room_temperature), T(1 / (p.melting_temperature - p.room_temperature)),
                  T(p.thermal_exponent)}) {}
  };
  template <int D, class S>
  using State = WarmJ2State<D, S>;
  template <class S>
  using AxisymmetricState = WarmJ2State<2, S>;

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_PLASTIC_WORK;
  static constexpr mpm_state state[] = {MPM_J2_STATE};
  static constexpr mpm_clamp clamps[] = {
      {"above T =", " K", "T* stays at 1: the metal has melted, and flows without any strength"},
      {"below T =", " K", "T* stays at 0: cold makes the metal no stronger than at room_temperature"},
  };
  static void clamp_bounds(const Parameters& p, double* bound) {
    bound[0] = p.melting_temperature, bound[1] = p.room_temperature;
  }
  /// A metal at either temperature is not beyond it for what rounding, also of single precision, makes of it.
  template <class AnyState>
  static unsigned acting_clamps(const double* bound, const AnyState& state) {
    const double margin = 1e-3 * (bound[0] - bound[1]);
    return (state.temperature > bound[0] + margin ? 1u : 0u) | (state.temperature < bound[1] - margin ? 2u : 0u);
  }
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(yield_stress, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "A: yield stress at room temperature and the reference rate (Kirchhoff)"),
      MPM_NUMBER_PARAMETER(hardening_coefficient, "Pa", required, 0.0, unbounded, 0, "B of the hardening B alpha^n"),
      MPM_NUMBER_PARAMETER(hardening_exponent, "", required, 0.0, 2.0, MPM_ABOVE_MINIMUM, "n of the hardening"),
      MPM_NUMBER_PARAMETER(rate_coefficient, "", required, 0.0, 1.0, 0,
                           "C: what the rate's logarithm adds; 0 leaves the rate out"),
      MPM_NUMBER_PARAMETER(reference_rate, "1/s", 1.0, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "rate_0 of plastic strain; slower flow counts as this rate"),
      MPM_NUMBER_PARAMETER(melting_temperature, "K", required, 400.0, 5000.0, MPM_ABOVE_MINIMUM,
                           "T_melt, where no strength is left"),
      MPM_NUMBER_PARAMETER(thermal_exponent, "", 1.0, 0.0, 3.0, MPM_ABOVE_MINIMUM, "m of the softening T*^m"),
      MPM_NUMBER_PARAMETER(room_temperature, "K", 293.15, 0.0, 320.0, 0, "T_room, up to which there is no softening"),
      MPM_CHOICE_PARAMETER(volumetric_energy, "logarithmic|quadratic|simo", 2, "u(J), see neo_hookean"),
  };
#endif
};

}  // namespace mpm

#pragma once
// Finite-strain J2 plasticity with hardening that saturates, sigma = sigma_0 + Q (1 - exp(-alpha/eps_s)) + H alpha. Voce, J.
// Inst. Metals 74 (1948) 537; the return is that of kernel/j2_plasticity.hpp.

#include "kernel/j2_plasticity.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct VonMisesVoce : J2Plasticity {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, yield_stress, saturation_hardening, saturation_strain,
        hardening_modulus, volumetric_energy;
  };
  template <class T>
  struct Constants : J2Constants<T, VoceHardening<T>> {
    MPM_HD explicit Constants(const Parameters& p)
        : J2Constants<T, VoceHardening<T>>(
              p, {T(p.yield_stress), T(p.saturation_hardening), T(1 / p.saturation_strain), T(p.hardening_modulus)}) {}
  };
  template <int D, class S>
  using State = J2State<D, S>;
  template <class S>
  using AxisymmetricState = J2State<2, S>;

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_PLASTIC_WORK;
  static constexpr mpm_state state[] = {MPM_J2_STATE};
  static constexpr bool projects = true;  ///< an update without strain returns what is beyond the yield surface
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(yield_stress, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "initial uniaxial yield stress sigma_0 (Kirchhoff)"),
      MPM_NUMBER_PARAMETER(saturation_hardening, "Pa", required, 0.0, unbounded, 0,
                           "Q: what saturation adds to the yield stress in the end"),
      MPM_NUMBER_PARAMETER(saturation_strain, "", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "eps_s: plastic strain after which 1 - 1/e of Q is there"),
      MPM_NUMBER_PARAMETER(hardening_modulus, "Pa", 0.0, 0.0, unbounded, 0, "slope H that is left when Q is there"),
      MPM_CHOICE_PARAMETER(volumetric_energy, "logarithmic|quadratic|simo", 2, "u(J), see neo_hookean"),
  };
#endif
};

}  // namespace mpm

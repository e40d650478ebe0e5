#pragma once
// Finite-strain J2 plasticity with linear isotropic hardening in closed form. Simo & Hughes (1998), Computational
// Inelasticity, box 9.1; the return is that of kernel/j2_plasticity.hpp.

#include "kernel/j2_plasticity.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct VonMises : J2Plasticity {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, yield_stress, hardening_modulus, volumetric_energy;
  };
  template <class T>
  struct Constants : J2Constants<T, LinearHardening<T>> {
    MPM_HD explicit Constants(const Parameters& p)
        : J2Constants<T, LinearHardening<T>>(p, {T(p.yield_stress), T(p.hardening_modulus)}) {}
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
                           "initial uniaxial yield stress (Kirchhoff)"),
      MPM_NUMBER_PARAMETER(hardening_modulus, "Pa", 0.0, 0.0, unbounded, 0,
                           "slope H of yield stress against equivalent plastic strain"),
      MPM_CHOICE_PARAMETER(volumetric_energy, "logarithmic|quadratic|simo", 2, "u(J), see neo_hookean"),
  };
#endif
};

}  // namespace mpm

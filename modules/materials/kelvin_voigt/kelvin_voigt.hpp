#pragma once
// Kelvin-Voigt solid: a Neo-Hookean spring beside a Newtonian dashpot. Split energy as in Simo & Hughes (1998), eq.
// 9.2.3, viscous Cauchy stress of a compressible Newtonian fluid:
//   tau = mu dev(J^-2/3 b) + K J u' I + J (2 eta dev d + zeta tr(d) I)
// The rate of deformation d of a step is found from f = I + dt L so that rigid turns have none (kernel/viscosity.hpp).

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#include "kernel/viscosity.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct KelvinVoigt {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, viscosity, bulk_viscosity, volumetric_energy;
    double cell_size;
  };
  template <class T>
  struct Constants {
    T mu, bulk, shear_viscosity, bulk_viscosity, inverse_density, inverse_cell_size;
    VolumetricEnergy volumetric;
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          bulk(T(bulk_modulus(p.youngs_modulus, p.poisson_ratio))),
          shear_viscosity(T(p.viscosity)),
          bulk_viscosity(T(p.bulk_viscosity)),
          inverse_density(T(1 / p.density)),
          inverse_cell_size(T(1 / p.cell_size)),
          volumetric(static_cast<VolumetricEnergy>(static_cast<int>(p.volumetric_energy))) {}
  };

  /// The state: `Gradient` is a Mat, or in axisymmetric scenes a Deformation.
  template <class Gradient>
  struct VoigtState {
    Gradient deformation_gradient;
    Sym<Gradient::dimension, typename Gradient::Scalar> viscous_stress;  ///< Kirchhoff, Pa, of the last step
  };
  template <int D, class S>
  using State = VoigtState<Mat<D, S>>;
  template <class S>
  using AxisymmetricState = VoigtState<Deformation<2, S>>;

  /// Returns the energy dissipated, J/m^3: the work of the viscous stress on d, which is never negative.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, VoigtState<G>& state) {
    constexpr int D = G::dimension;
    state.deformation_gradient = advanced(state.deformation_gradient, L, dt);
    const S J = determinant(state.deformation_gradient);
    const Sym<D, S> d = rate_of_deformation(strain_rate(L, dt), dt);
    state.viscous_stress = kirchhoff_of(newtonian_stress(c.shear_viscosity, c.bulk_viscosity, d), J);
    return dt * contraction(state.viscous_stress, d);
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const VoigtState<G>& state) {
    constexpr int D = G::dimension;
    const S J = determinant(state.deformation_gradient);
    Sym<D, S> tau = deviator(isochoric(left_cauchy_green(state.deformation_gradient), J));
    const S pressure = c.bulk * volumetric_stress(c.volumetric, J);
    for (int k = 0; k < Sym<D, S>::size; ++k) tau.s[k] = c.mu * tau.s[k] + state.viscous_stress.s[k];
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] + pressure;
    return tau;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const VoigtState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    const S stretched = trace(isochoric(left_cauchy_green(state.deformation_gradient), J)) - real<S>(3);
    return real<S>(0.5) * c.mu * stretched + c.bulk * volumetric_energy(c.volumetric, J);
  }

  /// The elastic wave's speed, raised so that a step by it stands the viscous stress too.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const VoigtState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    const Sym<G::dimension, S> b = isochoric(left_cauchy_green(state.deformation_gradient), J);
    const S squared = c.inverse_density * split_tangent(c.volumetric, c.mu, c.bulk, b, J);
    const scalar_of<S> longitudinal = real<S>(4.0 / 3.0) * c.shear_viscosity + c.bulk_viscosity;
    return damped_wave_speed(squared, c.inverse_density * longitudinal * J, c.inverse_cell_size);
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S volume_ratio(const VoigtState<G>& state) {
    return determinant(state.deformation_gradient);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_VISCOUS_FLOW;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(viscosity, "Pa s", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "shear viscosity eta"),
      MPM_NUMBER_PARAMETER(bulk_viscosity, "Pa s", 0.0, 0.0, unbounded, 0,
                           "bulk viscosity zeta, against changes of volume"),
      MPM_CHOICE_PARAMETER(volumetric_energy, "logarithmic|quadratic|simo", 2, "u(J), see neo_hookean"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
      {"viscous_stress", "Pa", "viscous part of the Kirchhoff stress, of the last step", MPM_STATE_SYMMETRIC,
       MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm

#pragma once
// Compressible Mooney-Rivlin rubber, split into an isochoric part and one of the volume (kernel/elasticity.hpp):
//   psi = C10 (I1 - 3) + C01 (I2 - 3) + K u(J),   I1 = tr b_iso,   I2 = tr b_iso^-1,   b_iso = J^-2/3 b
//   tau = dev(2 C10 b_iso - 2 C01 b_iso^-1) + K J u' I
// Mooney (1940), J. Appl. Phys. 11:582; Rivlin (1948), Phil. Trans. R. Soc. A 241:379; the split as in Simo & Hughes
// (1998), sec. 9.2. b_iso^-1 is the matrix of cofactors, as det b_iso = 1.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MooneyRivlin : ElasticSolid {
  struct Parameters {
    double c10, c01, bulk_modulus, density, volumetric_energy;
  };
  template <class T>
  struct Constants {
    T c10, c01, bulk, inverse_density;
    VolumetricEnergy volumetric;
    MPM_HD explicit Constants(const Parameters& p)
        : c10(T(p.c10)),
          c01(T(p.c01)),
          bulk(T(p.bulk_modulus)),
          inverse_density(T(1 / p.density)),
          volumetric(static_cast<VolumetricEnergy>(static_cast<int>(p.volumetric_energy))) {}
  };

  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    constexpr int D = G::dimension;
    const S J = determinant(state.deformation_gradient);
    const Sym<D, S> b = isochoric(left_cauchy_green(state.deformation_gradient), J), inverse = cofactors(b);
    Sym<D, S> tau;
    for (int k = 0; k < Sym<D, S>::size; ++k) tau.s[k] = real<S>(2) * (c.c10 * b.s[k] - c.c01 * inverse.s[k]);
    tau = deviator(tau);
    const S pressure = c.bulk * volumetric_stress(c.volumetric, J);
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] + pressure;
    return tau;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    const Sym<G::dimension, S> b = isochoric(left_cauchy_green(state.deformation_gradient), J);
    return c.c10 * (trace(b) - real<S>(3)) + c.c01 * (trace(cofactors(b)) - real<S>(3)) +
           c.bulk * volumetric_energy(c.volumetric, J);
  }

  /// Along F + s a (x) F^T n, a and n unit vectors and p = a.n, d2 I2/ds2 = 2 (a.i.a + 2/3 p n.i.a - p^2/9 I2) with i =
  /// b_iso^-1. It is largest at a = n, where it is 2 (5/3 n.i.n - I2/9), and so C01 adds 2 C01 (5/3 i_max - I2/9) at
  /// most to what the split Neo-Hookean solid has.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    const Sym<G::dimension, S> b = isochoric(left_cauchy_green(state.deformation_gradient), J), inverse = cofactors(b);
    const S second = real<S>(2) * c.c01 *
                     (real<S>(5.0 / 3.0) * largest_eigenvalue_bound(inverse) - real<S>(1.0 / 9.0) * trace(inverse));
    return sqrt(c.inverse_density * (split_tangent(c.volumetric, real<S>(2) * c.c10, c.bulk, b, J) + second));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(c10, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "C10, of the first invariant; the shear modulus is 2 (C10 + C01)"),
      MPM_NUMBER_PARAMETER(c01, "Pa", required, 0.0, unbounded, 0, "C01, of the second invariant; 0 is Neo-Hookean"),
      MPM_NUMBER_PARAMETER(bulk_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "bulk modulus K at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_CHOICE_PARAMETER(volumetric_energy, "logarithmic|quadratic|simo", 2, "u(J), see neo_hookean"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
  };
#endif
};

}  // namespace mpm

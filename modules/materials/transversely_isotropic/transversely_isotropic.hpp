#pragma once
// St. Venant-Kirchhoff solid with one stiff or soft direction, isotropic across it: wood, fibres in a matrix, layered rock.
// Spencer (1984), Constitutive theory for strongly anisotropic solids, in: Continuum Theory of the Mechanics of
// Fibre-Reinforced Composites, CISM 282; Bonet & Burton, Comput. Methods Appl. Mech. Engrg. 162 (1998) 151.
// With E = (F^T F - I)/2, the unit vector a along the axis of the undeformed solid and A = a (x) a:
//   psi = lambda/2 tr(E)^2 + mu tr(E^2) + alpha (a.E.a) tr(E) + 2 (G - mu) a.E^2.a + beta/2 (a.E.a)^2
//   S = (lambda tr(E) + alpha a.E.a) I + 2 mu E + (alpha tr(E) + beta a.E.a) A + 2 (G - mu) (A E + E A),   tau = F S F^T
// mu is the shear modulus across the axis and G along it.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include <cmath>

#include "plugin/tables.hpp"
#endif

namespace mpm {

struct TransverselyIsotropic : ElasticSolid {
  struct Parameters {
    double youngs_modulus_axial, youngs_modulus_transverse, poisson_ratio_axial, poisson_ratio_transverse,
        shear_modulus_axial, density, axis_x, axis_y, axis_z;
  };

  /// Entries of the stiffness for small strains, Pa; 3 is the axis (Lekhnitskii 1963).
  struct Stiffness {
    double c11, c12, c13, c33, c44, c66;
    MPM_HD explicit Stiffness(const Parameters& p) {
      const double Et = p.youngs_modulus_transverse, nu = p.poisson_ratio_transverse,
                   coupling = Et / p.youngs_modulus_axial * p.poisson_ratio_axial * p.poisson_ratio_axial;
      const double left = 1 - nu - 2 * coupling;  // positive where the stiffness is positive definite
      c11 = Et * (1 - coupling) / ((1 + nu) * left);
      c12 = Et * (nu + coupling) / ((1 + nu) * left);
      c13 = Et * p.poisson_ratio_axial / left;
      c33 = p.youngs_modulus_axial * (1 - nu) / left;
      c44 = p.shear_modulus_axial;
      c66 = Et / (2 * (1 + nu));
    }
    /// rho c^2 of the fastest wave at rest in any direction, Pa. The waves in a plane through the axis, at an angle of
    /// which u is the squared sine, have rho c^2 <= m + c44 where (m - x u) (m - z (1 - u)) >= d^2 u (1 - u), x = c11 -
    /// c44, z = c33 - c44, d = c13 + c44. Over u this is a parabola, whose least value is at an end, or inside where |d|
    /// exceeds x and z; so it does where c44 is the largest of all, which therefore is no end to compare with. A negative d
    /// does not, as |c13| is below the larger of c11 and c33.
    MPM_HD double fastest() const {
      const double x = c11 - c44, z = c33 - c44, d = c13 + c44;
      const double ends = max(max(c11, c33), c66);
      return d > max(x, z) ? max(ends, c44 + (d * d - x * z) / (2 * d - x - z)) : ends;
    }
  };

  template <class T>
  struct Constants {
    T lambda, mu, alpha, beta, along, fastest, inverse_density;  ///< `along` is 2 (G - mu)
    Vec<3, T> axis;
    MPM_HD explicit Constants(const Parameters& p) : inverse_density(T(1 / p.density)) {
      const Stiffness c(p);
      lambda = T(c.c12), mu = T(c.c66), alpha = T(c.c13 - c.c12), along = T(2 * (c.c44 - c.c66));
      beta = T(c.c11 + c.c33 - 2 * c.c13 - 4 * c.c44);
      fastest = T(c.fastest());
      const double length = sqrt(p.axis_x * p.axis_x + p.axis_y * p.axis_y + p.axis_z * p.axis_z);
      axis = {{T(p.axis_x / length), T(p.axis_y / length), T(p.axis_z / length)}};
    }
  };

  /// E from the displacement gradient F - I, so that little is lost where it is small.
  template <int D, class S>
  MPM_HD static Sym<D, S> green_strain(const Mat<D, S>& F) {
    Mat<D, S> H = F;
    for (int i = 0; i < D; ++i) H(i, i) = H(i, i) - real<S>(1);
    Sym<D, S> E;
    E.s[2] = S(real<S>(0));  // zz in plane strain; written over below in 3-D
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) {
        S t = H(i, j) + H(j, i);
        for (int k = 0; k < D; ++k) t = t + H(k, i) * H(k, j);
        E(i, j) = real<S>(0.5) * t;
      }
    return E;
  }
  template <class S>
  MPM_HD static Sym<2, S> green_strain(const Deformation<2, S>& F) {
    Sym<2, S> E = green_strain(F.plane);
    const S h = F.zz - real<S>(1);
    E.s[2] = h + real<S>(0.5) * (h * h);
    return E;
  }

  /// E a; in 2-D the axis lies in the plane or across it, and z couples with nothing.
  template <class S>
  MPM_HD static Vec<3, S> along_axis(const Sym<2, S>& E, const Vec<3, scalar_of<S>>& a) {
    return {{E(0, 0) * a[0] + E(0, 1) * a[1], E(0, 1) * a[0] + E(1, 1) * a[1], E.s[2] * a[2]}};
  }
  template <class S>
  MPM_HD static Vec<3, S> along_axis(const Sym<3, S>& E, const Vec<3, scalar_of<S>>& a) {
    Vec<3, S> r;
    for (int i = 0; i < 3; ++i) r[i] = E(i, 0) * a[0] + E(i, 1) * a[1] + E(i, 2) * a[2];
    return r;
  }

  /// Second Piola-Kirchhoff stress, Pa.
  template <int D, class S>
  MPM_HD static Sym<D, S> material_stress(const Constants<scalar_of<S>>& c, const Sym<D, S>& E) {
    const Vec<3, S> Ea = along_axis(E, c.axis);
    const S stretch = Ea[0] * c.axis[0] + Ea[1] * c.axis[1] + Ea[2] * c.axis[2], sum = trace(E);
    const S all = c.lambda * sum + c.alpha * stretch, along = c.alpha * sum + c.beta * stretch;
    Sym<D, S> stress;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) {
        if (D == 2 && i != j && j == 2) continue;
        stress(i, j) = real<S>(2) * c.mu * E(i, j) + along * (c.axis[i] * c.axis[j]) +
                       c.along * (Ea[i] * c.axis[j] + Ea[j] * c.axis[i]);
        if (i == j) stress(i, j) = stress(i, j) + all;
      }
    return stress;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    constexpr int D = G::dimension;
    const G& gradient = state.deformation_gradient;
    const Mat<D, S>& F = in_plane(gradient);
    const Sym<D, S> stress = material_stress(c, green_strain(gradient));
    Sym<D, S> tau = stress;
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) {
        S t = S(real<S>(0));
        for (int k = 0; k < D; ++k)
          for (int l = 0; l < D; ++l) t = t + F(i, k) * stress(k, l) * F(j, l);
        tau(i, j) = t;
      }
    if constexpr (has_zz<G>) tau.s[2] = gradient.zz * gradient.zz * stress.s[2];
    return tau;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const Sym<G::dimension, S> E = green_strain(state.deformation_gradient), stress = material_stress(c, E);
    S twice = stress.s[0] * E.s[0] + stress.s[1] * E.s[1] + stress.s[2] * E.s[2];
    for (int k = 3; k < Sym<G::dimension, S>::size; ++k) twice = twice + real<S>(2) * stress.s[k] * E.s[k];
    return real<S>(0.5) * twice;
  }

  /// Along F + s w (x) F^T n the second derivative of psi is that of the strain sym(F^T w (x) F^T n), at most the largest
  /// modulus at rest times the fourth power of the largest stretch, and n.tau.n.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S squared = largest_in_space(left_cauchy_green(state.deformation_gradient));
    const S pull = max(largest_in_space(kirchhoff_stress(c, state)), S(real<S>(0)));
    return sqrt(c.inverse_density * (c.fastest * (squared * squared) + pull));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE;

  /// Refuses constants whose strains would release energy, an axis without a length, and in 2-D one that lies askew of the
  /// plane: it would shear the plane out of itself, and in axisymmetric scenes twist it.
  static mpm_refusal refusal(const Parameters& p, const mpm_refusal_case& of) {
    const double largest =
        std::sqrt(p.youngs_modulus_axial / p.youngs_modulus_transverse * (1 - p.poisson_ratio_transverse) / 2);
    if (!(std::abs(p.poisson_ratio_axial) < largest))
      return {"poisson_ratio_axial",
              "the stiffness is positive definite where its square is below (1 - poisson_ratio_transverse)/2 times "
              "youngs_modulus_axial/youngs_modulus_transverse",
              p.poisson_ratio_axial < 0 ? -largest : largest};
    const double in_plane = std::hypot(p.axis_x, p.axis_y), across = std::abs(p.axis_z);
    if (!(in_plane + across > 0)) return {"axis_x", "the axis has no length", std::nan("")};
    if (of.dimension == 2 && in_plane > 1e-9 * across && across > 1e-9 * in_plane)
      return {"axis_z", "in 2-D the axis lies in the plane (axis_z = 0) or across it (axis_x = axis_y = 0)", 0};
    return {nullptr, nullptr, 0};
  }

  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus_axial, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus E_a along the axis, at small strain"),
      MPM_NUMBER_PARAMETER(youngs_modulus_transverse, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus E_t across the axis"),
      MPM_NUMBER_PARAMETER(poisson_ratio_axial, "", required, -10.0, 10.0, 0,
                           "nu_a: how much the sides shrink where it is pulled along the axis"),
      MPM_NUMBER_PARAMETER(poisson_ratio_transverse, "", required, -1.0, 1.0, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "nu_t: Poisson's ratio within the plane across the axis"),
      MPM_NUMBER_PARAMETER(shear_modulus_axial, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "G_a: shear modulus of planes that hold the axis"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(axis_x, "", 1.0, -1e6, 1e6, 0,
                           "component of the axis in the undeformed solid, of any length"),
      MPM_NUMBER_PARAMETER(axis_y, "", 0.0, -1e6, 1e6, 0, "component of the axis"),
      MPM_NUMBER_PARAMETER(axis_z, "", 0.0, -1e6, 1e6, 0, "component of the axis; in 2-D across the plane"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
  };
#endif
};

}  // namespace mpm

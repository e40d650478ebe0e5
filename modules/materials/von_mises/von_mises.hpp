#pragma once
// Finite-strain J2 plasticity without a spectral decomposition: split Neo-Hookean elasticity, radial return on the
// deviatoric Kirchhoff stress, linear isotropic hardening in closed form. Simo & Hughes (1998), Computational
// Inelasticity, box 9.1, with one change: after the return tr(b_e) is chosen so that det(b_e) = 1 (box 9.1 keeps the
// trial trace, which would store energy that was dissipated).

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct VonMises {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, yield_stress, hardening_modulus, volumetric_energy;
  };
  template <class T>
  struct Constants {
    T mu, bulk, yield_stress, hardening, inverse_density;
    VolumetricEnergy volumetric;
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          bulk(T(bulk_modulus(p.youngs_modulus, p.poisson_ratio))),
          yield_stress(T(p.yield_stress)),
          hardening(T(p.hardening_modulus)),
          inverse_density(T(1 / p.density)),
          volumetric(static_cast<VolumetricEnergy>(static_cast<int>(p.volumetric_energy))) {}
  };
  template <int D, class S>
  struct State {
    Sym<D, S> elastic_left_cauchy_green;  ///< isochoric, det = 1
    S volume_ratio;                       ///< total J
    S equivalent_plastic_strain;
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// The mean of tr(b)/3 that makes det(d + t I) = 1 for a deviatoric d: largest root of t^3 - (d:d/2) t + det d - 1.
  /// Newton from a start at or above the root is monotone, the cubic being convex there.
  template <int D, class S>
  MPM_HD static S unimodular_mean(const Sym<D, S>& d, S start) {
    const S half_norm = real<S>(0.5) * squared_norm(d), offset = determinant(d) - real<S>(1);
    S t = start;
    for (int iteration = 0; iteration < 8; ++iteration)
      t = t - (t * (t * t - half_norm) + offset) / (real<S>(3) * t * t - half_norm);
    return t;
  }

  /// Returns the energy dissipated by plastic flow, J/m^3: the plastic multiplier times its work-conjugate stress at
  /// the end of the step, which is |s| for small elastic strains. (The stored energy that the return removes from the
  /// trial state is E de^2/2 a step more, which no force has supplied.)
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    using T = scalar_of<S>;
    const G f = advanced(G::identity(), L, dt);
    state.volume_ratio = state.volume_ratio * determinant(f);
    const Sym<D, S> b = unimodular(pushed(f, state.elastic_left_cauchy_green));

    const S mean = trace(b) * real<S>(1.0 / 3.0);
    Sym<D, S> d = deviator(b);
    const S stress_norm = c.mu * sqrt(squared_norm(d));
    const T root_two_thirds = real<S>(0.816496580927726);
    const S overstress =
        stress_norm - root_two_thirds * (c.yield_stress + c.hardening * state.equivalent_plastic_strain);
    const auto yields = overstress > real<S>(0);
    if (!any(yields)) {
      state.elastic_left_cauchy_green = b;
      return S(real<S>(0));
    }
    const S two_mu_bar = real<S>(2) * c.mu * mean;
    const S multiplier = select(yields, overstress / (two_mu_bar + real<S>(2.0 / 3.0) * c.hardening), S(real<S>(0)));
    const S shrink = real<S>(1) - two_mu_bar * multiplier / max(stress_norm, S(real<S>(1e-30)));
    for (int k = 0; k < Sym<D, S>::size; ++k) d.s[k] = shrink * d.s[k];
    const S new_mean = select(yields, unimodular_mean(d, mean), mean);
    const S conjugate = mean * conjugate_factor(d, new_mean);
    for (int i = 0; i < 3; ++i) d.s[i] = d.s[i] + new_mean;
    // d + mean rounds: a particle that does not yield keeps b itself, whichever particles share its pack.
    for (int k = 0; k < Sym<D, S>::size; ++k) state.elastic_left_cauchy_green.s[k] = select(yields, d.s[k], b.s[k]);
    state.equivalent_plastic_strain = state.equivalent_plastic_strain + root_two_thirds * multiplier;
    return select(yields, shrink * stress_norm * multiplier * conjugate, S(real<S>(0)));
  }

  /// The factor -(3 mu / 2) dt / d(shrink of d), over mu |d|^2 / 2, by which the stress that does plastic work differs
  /// from |s|. t(d) follows from det(d + t I) = 1, and the factor is 1 + O(elastic strain).
  template <int D, class S>
  MPM_HD static S conjugate_factor(const Sym<D, S>& d, S t) {
    const S norm = max(squared_norm(d), S(real<S>(1e-30)));
    return (t - real<S>(3) * determinant(d) / norm) / (t * t - real<S>(1.0 / 6.0) * norm);
  }

  /// f b f^T; in plane strain f_zz = 1.
  template <int D, class S>
  MPM_HD static Sym<D, S> pushed(const Mat<D, S>& f, const Sym<D, S>& b) {
    Sym<D, S> r = b;
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) {
        S t = S(real<S>(0));
        for (int k = 0; k < D; ++k)
          for (int l = 0; l < D; ++l) t = t + f(i, k) * b(k, l) * f(j, l);
        r(i, j) = t;
      }
    return r;
  }
  template <class S>
  MPM_HD static Sym<2, S> pushed(const Deformation<2, S>& f, const Sym<2, S>& b) {
    Sym<2, S> r = pushed(f.plane, b);
    r.s[2] = f.zz * f.zz * b.s[2];
    return r;
  }

  /// The tensor det(b)^-1/3 b. It is divided by b's own determinant, not by that of the increments, so that rounding
  /// does not pile up over many steps.
  template <int D, class S>
  MPM_HD static Sym<D, S> unimodular(Sym<D, S> b) {
    const S scale = exp(real<S>(-1.0 / 3.0) * log(determinant(b)));
    for (int k = 0; k < Sym<D, S>::size; ++k) b.s[k] = scale * b.s[k];
    return b;
  }

  /// tau = mu dev(b_e) + K J u' I.
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> tau = deviator(state.elastic_left_cauchy_green);
    const S pressure = c.bulk * volumetric_stress(c.volumetric, state.volume_ratio);
    for (int k = 0; k < Sym<D, S>::size; ++k) tau.s[k] = c.mu * tau.s[k];
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] + pressure;
    return tau;
  }

  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return real<S>(0.5) * c.mu * (trace(state.elastic_left_cauchy_green) - real<S>(3)) +
           c.bulk * volumetric_energy(c.volumetric, state.volume_ratio);
  }

  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return sqrt(c.inverse_density *
                split_tangent(c.volumetric, c.mu, c.bulk, state.elastic_left_cauchy_green, state.volume_ratio));
  }

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return state.volume_ratio;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
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
  static constexpr mpm_state state[] = {
      {"elastic_left_cauchy_green", "", "isochoric elastic left Cauchy-Green tensor, det = 1", MPM_STATE_SYMMETRIC,
       MPM_INITIAL_IDENTITY},
      {"volume_ratio", "", "total J = det F", MPM_STATE_SCALAR, MPM_INITIAL_ONE},
      {"equivalent_plastic_strain", "", "accumulated equivalent plastic strain", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm

#pragma once
// Hencky's elasticity in principal strains, which soils share: tau = 2 mu eps + lambda tr(eps) I with eps the logarithms
// of the singular values of F_e (Simo, Comput. Methods Appl. Mech. Engrg. 99 (1992) 61; de Souza Neto, Peric & Owen
// (2008), Computational Methods for Plasticity, ch. 14). A return map works on three strains and three stresses as in
// small strain. In 2-D the third of both is that of z, and F_e keeps its zz.

#include "kernel/elasticity.hpp"
#include "kernel/svd.hpp"

namespace mpm {

/// Base of functors whose state has an `elastic_deformation_gradient` (a Deformation) and whose Constants have `mu`,
/// `lambda`, `inverse_density` and `longitudinal`.
struct HenckySolid {
  /// Sine of an angle in [0, pi/2] by its series, to rounding: the device pass has no sine.
  MPM_HD static double sin_of(double angle) {
    double sum = 0, term = angle;
    for (int k = 1; k < 26; k += 2) sum = sum + term, term = -term * angle * angle / ((k + 1) * (k + 2));
    return sum;
  }

  /// (I + dt L) F_e: the elastic trial.
  template <class G, int D, class S>
  MPM_HD static Deformation<D, S> trial_of(const Deformation<D, S>& F, const G& L, scalar_of<S> dt) {
    Deformation<D, S> trial = F;
    trial.plane = advanced(trial.plane, in_plane(L), dt);
    if constexpr (has_zz<G>) trial.zz = trial.zz + dt * (L.zz * trial.zz);
    return trial;
  }

  /// Elastic Hencky strains along the principal directions; in 2-D the last is that of z.
  template <class S>
  MPM_HD static Vec<3, S> strains(const Deformation<2, S>& F, SingularValues<2, S>& parts) {
    parts = singular_value_decomposition(F.plane);
    return {{log(parts.values[0]), log(parts.values[1]), log(F.zz)}};
  }
  template <class S>
  MPM_HD static Vec<3, S> strains(const Deformation<3, S>& F, SingularValues<3, S>& parts) {
    parts = singular_value_decomposition(F.plane);
    return {{log(parts.values[0]), log(parts.values[1]), log(parts.values[2])}};
  }

  /// U diag(exp(strains)) V^T.
  template <class S>
  MPM_HD static Deformation<2, S> stretched(const SingularValues<2, S>& parts, const Vec<3, S>& strain) {
    const Vec<2, S> stretch{{exp(strain[0]), exp(strain[1])}};
    return {composed(parts.U, stretch, parts.V), exp(strain[2])};
  }
  template <class S>
  MPM_HD static Deformation<3, S> stretched(const SingularValues<3, S>& parts, const Vec<3, S>& strain) {
    const Vec<3, S> stretch{{exp(strain[0]), exp(strain[1]), exp(strain[2])}};
    return {composed(parts.U, stretch, parts.V)};
  }

  /// Stores `a` where the mask holds, else `b`: a particle that does not yield keeps F_e as advanced, to the last bit.
  template <class Mask, class S>
  MPM_HD static void store(const Mask& first, const Deformation<2, S>& a, const Deformation<2, S>& b,
                           Deformation<2, S>& out) {
    for (int k = 0; k < 4; ++k) out.plane.m[k] = select(first, a.plane.m[k], b.plane.m[k]);
    out.zz = select(first, a.zz, b.zz);
  }
  template <class Mask, class S>
  MPM_HD static void store(const Mask& first, const Deformation<3, S>& a, const Deformation<3, S>& b,
                           Deformation<3, S>& out) {
    for (int k = 0; k < 9; ++k) out.plane.m[k] = select(first, a.plane.m[k], b.plane.m[k]);
  }

  template <class S>
  MPM_HD static S sum(const Vec<3, S>& a) {
    return a[0] + a[1] + a[2];
  }
  template <class S>
  MPM_HD static S dot(const Vec<3, S>& a, const Vec<3, S>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  /// Principal Kirchhoff stresses, Pa.
  template <class C, class S>
  MPM_HD static Vec<3, S> stresses(const C& c, const Vec<3, S>& strain) {
    const S mean = c.lambda * sum(strain);
    Vec<3, S> tau;
    for (int i = 0; i < 3; ++i) tau[i] = real<S>(2) * c.mu * strain[i] + mean;
    return tau;
  }

  /// Principal directions of F_e F_e^T and elastic Hencky strains along them: what stress, energy and wave speed share.
  template <int D, class S>
  struct Principal {
    Mat<D, S> directions;
    Vec<3, S> strain;
  };

  template <class S>
  MPM_HD static Principal<2, S> principal(const Deformation<2, S>& F) {
    const LeftStretches<2, S> parts = left_stretches(F.plane);
    return {parts.U, {{log(parts.stretch[0]), log(parts.stretch[1]), log(F.zz)}}};
  }
  template <class S>
  MPM_HD static Principal<3, S> principal(const Deformation<3, S>& F) {
    const LeftStretches<3, S> parts = left_stretches(F.plane);
    return {parts.U, {{log(parts.stretch[0]), log(parts.stretch[1]), log(parts.stretch[2])}}};
  }
  template <class State>
  MPM_HD static auto prepared(const State& state) {
    return principal(state.elastic_deformation_gradient);
  }

  /// tau = U diag(principal stresses) U^T, Pa.
  template <class C, int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const C& c, const Principal<D, S>& p) {
    return from_principal(p.directions, stresses(c, p.strain));
  }

  /// mu eps:eps + lambda/2 tr(eps)^2, J/m^3.
  template <class C, int D, class S>
  MPM_HD static S stored_energy(const C& c, const Principal<D, S>& p) {
    const S trace = sum(p.strain);
    return c.mu * dot(p.strain, p.strain) + real<S>(0.5) * c.lambda * trace * trace;
  }

  /// The fastest wave along the principal axes, m/s. Longitudinal waves have rho0 c^2 = lambda + 2 mu - (least principal
  /// stress, where it presses), and `longitudinal` is lambda + 2 mu with the most that yielding adds. Shear waves between
  /// principal stretches e^a and e^b have 2 mu x/(1 - e^-2x) <= mu (1 + 2 x) with x = |a - b|. Waves askew of the axes are
  /// faster, by `askew` at most, which is left out: of waves tried none is where x is 1, and by 1 % where x is 2.
  template <class C, int D, class S>
  MPM_HD static S wave_speed(const C& c, const Principal<D, S>& p) {
    const Vec<3, S>& e = p.strain;
    const S least = min(min(e[0], e[1]), e[2]), spread = max(max(e[0], e[1]), e[2]) - least;
    const S pressing = min(real<S>(2) * c.mu * least + c.lambda * sum(e), S(real<S>(0)));
    return sqrt(c.inverse_density * max(c.longitudinal - pressing, c.mu * (real<S>(1) + spread + spread)));
  }

  /// By how much waves askew of the axes are faster where principal strains differ by x, over mu: x^2/2/(1 + x) at most.
  /// No proof is known; no wave of those that tests try is faster.
  template <class S>
  MPM_HD static S askew(const S& x) {
    return real<S>(0.5) * (x * x / (real<S>(1) + x));
  }

  /// Stress, energy and wave speed of a state whose principal strains are not known yet.
  template <class C, class State>
  MPM_HD static auto kirchhoff_stress(const C& c, const State& state) {
    return kirchhoff_stress(c, prepared(state));
  }
  template <class C, class State>
  MPM_HD static auto stored_energy(const C& c, const State& state) {
    return stored_energy(c, prepared(state));
  }
  template <class C, class State>
  MPM_HD static auto wave_speed(const C& c, const State& state) {
    return wave_speed(c, prepared(state));
  }
};

/// State of soils that keep the elastic part of F, and the total J beside it.
template <int D, class S>
struct HenckyState {
  Deformation<D, S> elastic_deformation_gradient;
  S volume_ratio;  ///< total J
};

}  // namespace mpm

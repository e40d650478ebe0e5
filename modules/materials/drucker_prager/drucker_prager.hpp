#pragma once
// Sand: Hencky elasticity and a Drucker-Prager cone with cohesion, flow at constant elastic volume, and a correction of
// the volume that sand gains when it parts. Klar, Gast, Pradhana, Fu, Schroeder, Jiang & Teran, ACM Trans. Graph. 35
// (2016) 103, sec. 4 and 7.3; volume correction: Tampubolon et al., ACM Trans. Graph. 36 (2017) 105, sec. 4.3.4, here
// from the total J instead of an accumulated increment. The cone is always that of three-dimensional space.
//
// tau = 2 mu eps + lambda tr(eps) I with the elastic Hencky strain eps = ln(singular values of F_e);
//   |dev eps| <= k (t - tr eps),   k = alpha (3 lambda + 2 mu)/(2 mu),   alpha = sqrt(2/3) 2 sin phi/(3 - sin phi),
// where t = c cot(phi)/K is the volumetric strain of the tip.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#include "kernel/svd.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct DruckerPrager {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, friction_angle, cohesion, volume_correction;
  };
  template <class T>
  struct Constants {
    T mu, lambda, inverse_density;
    T slope, tip;    ///< k and t
    T longitudinal;  ///< lambda + 2 mu with the most that yielding adds, see wave_speed
    bool corrects_volume;
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          inverse_density(T(1 / p.density)),
          corrects_volume(p.volume_correction != 0) {
      const double sine = sin_of(p.friction_angle);
      const double bulk = bulk_modulus(p.youngs_modulus, p.poisson_ratio);
      const double alpha = 0.816496580927726 * 2 * sine / (3 - sine);
      const double shear = shear_modulus(p.youngs_modulus, p.poisson_ratio), k = alpha * 3 * bulk / (2 * shear);
      slope = T(k);
      const double u = k < 2 * 0.816496580927726 ? k / 2 : 0.816496580927726;
      longitudinal = T(bulk + 4 * shear / 3 + 2 * shear * u * (k - u));
      tip = T(p.cohesion * sqrt(1 - sine * sine) / sine / bulk);
    }
  };
  template <int D, class S>
  struct State {
    Deformation<D, S> elastic_deformation_gradient;
    S volume_ratio;  ///< total J
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// Sine of an angle in [0, pi/2] by its series, to rounding: the device pass has no sine.
  MPM_HD static double sin_of(double angle) {
    double sum = 0, term = angle;
    for (int k = 1; k < 26; k += 2) sum = sum + term, term = -term * angle * angle / ((k + 1) * (k + 2));
    return sum;
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

  template <class S>
  MPM_HD static S sum(const Vec<3, S>& strain) {
    return strain[0] + strain[1] + strain[2];
  }

  /// Principal Kirchhoff stresses.
  template <class S>
  MPM_HD static Vec<3, S> stresses(const Constants<scalar_of<S>>& c, const Vec<3, S>& strain) {
    const S mean = c.lambda * sum(strain);
    Vec<3, S> tau;
    for (int i = 0; i < 3; ++i) tau[i] = real<S>(2) * c.mu * strain[i] + mean;
    return tau;
  }

  /// Returns the energy dissipated, J/m^3: tau at the end of the step times the change of elastic strain by the return.
  /// A particle that neither yields nor closes a gap keeps F_e as advanced, to the last bit.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    const S before = state.volume_ratio, zero = S(real<S>(0));
    state.volume_ratio = before * determinant(advanced(G::identity(), L, dt));
    Deformation<D, S> trial = state.elastic_deformation_gradient;
    trial.plane = advanced(trial.plane, in_plane(L), dt);
    if constexpr (has_zz<G>) trial.zz = trial.zz + dt * (L.zz * trial.zz);
    SingularValues<D, S> parts;
    const Vec<3, S> strain = strains(trial, parts);

    // A gap exists only where J was above 1. Compression is felt from the total J on, when that is below 1 again.
    const S advanced_trace = sum(strain), felt = min(log(state.volume_ratio), zero);
    const S missing = select(before > real<S>(1), max(felt - advanced_trace, zero), zero);
    const S trace = advanced_trace + (c.corrects_volume ? missing : zero);

    Vec<3, S> deviator;
    S norm = zero;
    for (int i = 0; i < 3; ++i) {
      deviator[i] = strain[i] - advanced_trace * real<S>(1.0 / 3.0);
      norm = norm + deviator[i] * deviator[i];
    }
    norm = sqrt(norm);
    const S limit = c.slope * (c.tip - trace);  // negative beyond the tip
    const auto yields = norm > limit;
    const S kept = select(yields, max(limit, zero) / max(norm, S(svd::tiny<S>())), S(real<S>(1)));
    const S mean = min(trace, S(c.tip)) * real<S>(1.0 / 3.0);
    Vec<3, S> returned;
    for (int i = 0; i < 3; ++i) returned[i] = kept * deviator[i] + mean;

    const S changes = select(yields, S(real<S>(1)), select(trace > advanced_trace, S(real<S>(1)), zero));
    const Vec<3, S> tau = stresses(c, returned);
    S heat = zero;
    for (int i = 0; i < 3; ++i) heat = heat + tau[i] * (strain[i] - returned[i]);
    const Deformation<D, S> after = stretched(parts, returned);
    store(changes > real<S>(0), after, trial, state.elastic_deformation_gradient);
    return select(changes > real<S>(0), heat, zero);
  }

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

  /// Principal directions of F_e F_e^T and elastic Hencky strains along them: what stress, energy and wave speed share.
  template <int D, class S>
  struct Principal {
    Mat<D, S> directions;
    Vec<3, S> strain;
  };

  template <class S>
  MPM_HD static Principal<2, S> prepared(const State<2, S>& state) {
    const LeftStretches<2, S> parts = left_stretches(state.elastic_deformation_gradient.plane);
    const S zz = state.elastic_deformation_gradient.zz;
    return {parts.U, {{log(parts.stretch[0]), log(parts.stretch[1]), log(zz)}}};
  }
  template <class S>
  MPM_HD static Principal<3, S> prepared(const State<3, S>& state) {
    const LeftStretches<3, S> parts = left_stretches(state.elastic_deformation_gradient.plane);
    return {parts.U, {{log(parts.stretch[0]), log(parts.stretch[1]), log(parts.stretch[2])}}};
  }

  /// tau = U diag(principal stresses) U^T.
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const Principal<D, S>& p) {
    return from_principal(p.directions, stresses(c, p.strain));
  }

  /// mu eps:eps + lambda/2 tr(eps)^2.
  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const Principal<D, S>& p) {
    const Vec<3, S>& e = p.strain;
    const S trace = sum(e);
    return c.mu * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + real<S>(0.5) * c.lambda * trace * trace;
  }

  /// The fastest wave. Longitudinal waves have rho0 c^2 = lambda + 2 mu - (least principal stress, where it presses).
  /// On the cone a wave that takes pressure off takes strength off too, as the flow is not associated: rho0 c^2 then is
  /// larger by 2 mu u (k - u), where -u = n.N.n is the component of the unit deviator N; this is largest at u = k/2 or
  /// at the limit sqrt(2/3) of u. Shear waves between principal stretches e^a and e^b have 2 mu x/(1 - e^-2x) <= mu (1
  /// + 2 x) with x = |a - b|.
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const Principal<D, S>& p) {
    const Vec<3, S>& e = p.strain;
    const S least = min(min(e[0], e[1]), e[2]), spread = max(max(e[0], e[1]), e[2]) - least;
    const S pressing = min(real<S>(2) * c.mu * least + c.lambda * sum(e), S(real<S>(0)));
    return sqrt(c.inverse_density * max(c.longitudinal - pressing, c.mu * (real<S>(1) + spread + spread)));
  }

  /// Stress, energy and wave speed of a state whose principal strains are not known yet.
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return kirchhoff_stress(c, prepared(state));
  }
  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return stored_energy(c, prepared(state));
  }
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return wave_speed(c, prepared(state));
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
                           "Young's modulus of the grains' packing at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(friction_angle, "rad", required, 0.0, 1.5707963267948966,
                           MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "angle of internal friction in triaxial compression; write degrees as \"30 deg\""),
      MPM_NUMBER_PARAMETER(cohesion, "Pa", 0.0, 0.0, unbounded, 0, "cohesion c of Mohr-Coulomb; 0 is dry sand"),
      MPM_BOOLEAN_PARAMETER(
          volume_correction, 1,
          "1: a gap opened in tension must close before pressure returns; 0: pressure returns at once"),
  };
  static constexpr mpm_state state[] = {
      {"elastic_deformation_gradient", "", "elastic part F_e of the deformation gradient, zz included in 2-D",
       MPM_STATE_DEFORMATION, MPM_INITIAL_IDENTITY},
      {"volume_ratio", "", "total J = det F", MPM_STATE_SCALAR, MPM_INITIAL_ONE},
  };
#endif
};

}  // namespace mpm

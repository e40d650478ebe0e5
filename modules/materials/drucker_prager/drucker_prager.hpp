#pragma once
// Sand: Hencky elasticity and a Drucker-Prager cone with cohesion, flow at constant elastic volume, and a correction of
// the volume that sand gains when it parts. Klar, Gast, Pradhana, Fu, Schroeder, Jiang & Teran, ACM Trans. Graph. 35
// (2016) 103, sec. 4 and 7.3; volume correction: Tampubolon et al., ACM Trans. Graph. 36 (2017) 105, sec. 4.3.4, here
// from the total J instead of an accumulated increment. The cone is always that of three-dimensional space.
//
// tau = 2 mu eps + lambda tr(eps) I with the elastic Hencky strain eps = ln(singular values of F_e);
//   |dev eps| <= k (t - tr eps),   k = alpha (3 lambda + 2 mu)/(2 mu),   alpha = sqrt(2/3) 2 sin phi/(3 - sin phi),
// where t = c cot(phi)/K is the volumetric strain of the tip.

#include "kernel/functor.hpp"
#include "kernel/hencky.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct DruckerPrager : HenckySolid {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, friction_angle, cohesion, volume_correction;
  };
  template <class T>
  struct Constants {
    T mu, lambda, inverse_density;
    T slope, tip;    ///< k and t
    T longitudinal;  ///< lambda + 2 mu with the most that yielding adds, see below
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
      // On the cone a wave that takes pressure off takes strength off too, as the flow is not associated: rho0 c^2 then
      // is larger by 2 mu u (k - u), where -u = n.N.n is the component of the unit deviator N; this is largest at u =
      // k/2 or at the limit sqrt(2/3) of u.
      const double u = k < 2 * 0.816496580927726 ? k / 2 : 0.816496580927726;
      longitudinal = T(bulk + 4 * shear / 3 + 2 * shear * u * (k - u));
      tip = T(p.cohesion * sqrt(1 - sine * sine) / sine / bulk);
    }
  };
  template <int D, class S>
  using State = HenckyState<D, S>;
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// Returns the energy dissipated, J/m^3: tau at the end of the step times the change of elastic strain by the return.
  /// A particle that neither yields nor closes a gap keeps F_e as advanced, to the last bit.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    const S before = state.volume_ratio, zero = S(real<S>(0));
    state.volume_ratio = before * determinant(advanced(G::identity(), L, dt));
    const Deformation<D, S> trial = trial_of(state.elastic_deformation_gradient, L, dt);
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

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return state.volume_ratio;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_PLASTIC_WORK;
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

#pragma once
// Dry grains that flow: Hencky elasticity and the mu(I) rheology, in which friction grows with the shear rate. Law: Jop,
// Forterre & Pouliquen, Nature 441 (2006) 727. Its place in an elastic-viscoplastic solid, the return in closed
// form, and no stress below the critical density: Dunatunga & Kamrin, J. Fluid Mech. 779 (2015) 483; here
// with Hencky strains in place of a rate of stress, so that what is stored is known.
//
//   s = sqrt(dev tau : dev tau/2) = mu(I) p,   mu(I) = mu_s + (mu_2 - mu_s)/(I_0/I + 1),   I = g d sqrt(rho_s/p)
// with g the plastic shear rate (that of simple shear), and no plastic flow where s <= mu_s p. Flow keeps the volume, so
// that the elastic volume is J over the critical one, J_c = density/critical_density: p = -K ln(J/J_c) below J_c, and no
// stress at all above. With the elastic trial s', s = s' - G dt g, and s is the smaller root of
//   s^2 - (mu_2 p + s' + b) s + mu_2 p s' + b mu_s p = 0,   b = G dt I_0 sqrt(p/rho_s)/d.

#include "kernel/functor.hpp"
#include "kernel/hencky.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MuI : HenckySolid {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, grain_diameter, grain_density, static_friction, limit_friction,
        inertial_number, critical_density;
  };
  template <class T>
  struct Constants {
    T mu, lambda, inverse_density;
    T bulk;                    ///< K/(2 mu)
    T static_friction, limit;  ///< mu_s and mu_2
    T rate;                    ///< I_0 sqrt(2 mu/rho_s)/(2 d), so that b/(2 mu) = dt rate sqrt(p/(2 mu))
    T critical;                ///< ln J_c
    T longitudinal;            ///< lambda + 2 mu with the most that yielding adds, see below
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          inverse_density(T(1 / p.density)),
          static_friction(T(p.static_friction)),
          limit(T(p.limit_friction > p.static_friction ? p.limit_friction : p.static_friction)),
          critical(T(p.critical_density > p.density ? log(p.density / p.critical_density) : 0.0)) {
      const double shear = shear_modulus(p.youngs_modulus, p.poisson_ratio);
      const double modulus = bulk_modulus(p.youngs_modulus, p.poisson_ratio);
      bulk = T(modulus / (2 * shear));
      rate = T(p.inertial_number * sqrt(2 * shear / p.grain_density) / (2 * p.grain_diameter));
      // As on the cone of drucker_prager, |dev eps| <= k (-tr eps) with k = mu_2 K/(sqrt(2) mu): a wave that takes
      // pressure off takes strength off too, which adds 2 mu u (k - u) with u = k/2, or sqrt(2/3) where that is less.
      const double most = 0.816496580927726, friction = max(p.limit_friction, p.static_friction);
      const double k = friction * modulus / (1.4142135623730951 * shear), u = min(0.5 * k, most);
      longitudinal = T(modulus + 4 * shear / 3 + 2 * shear * u * (k - u));
    }
  };
  template <int D, class S>
  using State = HenckyState<D, S>;
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// The shear stress s after a step of dt from the trial's s', at the pressure p; all in units of 2 mu.
  template <class S>
  MPM_HD static S flowing_stress(const Constants<scalar_of<S>>& c, S trial, S pressure, scalar_of<S> dt) {
    const S root = sqrt(pressure), viscous = (dt * c.rate) * root;
    const S least = c.static_friction * pressure, most = c.limit * pressure;
    // The discriminant (sum)^2 - 4 product as a sum of terms that are not negative.
    const S sum = most + trial + viscous, product = most * trial + viscous * least, apart = trial + viscous - most;
    const S discriminant = apart * apart + real<S>(4) * (viscous * (most - least));
    return real<S>(2) * product / max(sum + sqrt(discriminant), S(svd::tiny<S>()));
  }

  /// Returns the energy dissipated, J/m^3: tau at the end of the step times the change of elastic strain by the return,
  /// which is s g dt where grains flow. A particle in contact that does not yield keeps F_e as advanced, to the last bit.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    const S zero = S(real<S>(0));
    const S before = log(state.volume_ratio) - c.critical;
    state.volume_ratio = state.volume_ratio * determinant(advanced(G::identity(), L, dt));
    const Deformation<D, S> trial = trial_of(state.elastic_deformation_gradient, L, dt);
    SingularValues<D, S> parts;
    const Vec<3, S> strain = strains(trial, parts);
    const S trace = sum(strain), mean = trace * real<S>(1.0 / 3.0);
    // Grains that were apart touch where J falls below the critical volume. They are never in tension.
    const S now = log(state.volume_ratio) - c.critical, felt = min(now, zero);

    Vec<3, S> deviator;
    for (int i = 0; i < 3; ++i) deviator[i] = strain[i] - mean;
    const S sheared = real<S>(0.70710678118654752) * sqrt(dot(deviator, deviator)), pressure = -(c.bulk * felt);
    const auto yields = sheared > c.static_friction * pressure;
    const S apart = select(max(before, now) > zero, S(real<S>(1)), zero);
    const auto changes = select(yields, S(real<S>(1)), apart) > zero;
    if (!any(changes)) {
      state.elastic_deformation_gradient = trial;
      return zero;
    }
    const S flowing = min(flowing_stress(c, sheared, pressure, dt), sheared);
    const S kept = select(yields, flowing / max(sheared, S(svd::tiny<S>())), S(real<S>(1)));
    Vec<3, S> after;
    S heat = pressure * (felt - trace);  // what a step that closes a gap has pressed too far
    for (int i = 0; i < 3; ++i) {
      after[i] = kept * deviator[i] + felt * real<S>(1.0 / 3.0);
      heat = heat + kept * (real<S>(1) - kept) * (deviator[i] * deviator[i]);
    }
    // Grains that are apart get the identity itself, as U V^T would leave a stress of rounding.
    Deformation<D, S> end = stretched(parts, after);
    const Mat<D, S> identity = Mat<D, S>::identity();
    for (int k = 0; k < D * D; ++k) end.plane.m[k] = select(felt < zero, end.plane.m[k], identity.m[k]);
    store(changes, end, trial, state.elastic_deformation_gradient);
    return select(changes, real<S>(2) * c.mu * heat, zero);
  }

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return state.volume_ratio;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_PLASTIC_WORK;
  static constexpr mpm_clamp clamps[] = {
      {"below mu_2 =", "", "limit_friction counts as static_friction, so that friction does not depend on the rate"},
      {"below", " kg/m^3", "critical_density counts as density, so that the packing begins in contact"},
  };
  static void clamp_bounds(const Parameters& p, double* bound) {
    bound[0] = p.limit_friction < p.static_friction ? p.static_friction : no_bound;
    bound[1] = p.critical_density > 0 && p.critical_density < p.density ? p.density : no_bound;
  }
  template <class AnyState>
  static unsigned acting_clamps(const double* bound, const AnyState&) {
    return (bound[0] == bound[0] ? 1u : 0u) | (bound[1] == bound[1] ? 2u : 0u);
  }
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus of the grains' packing at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "initial density of the packing, pores included"),
      MPM_NUMBER_PARAMETER(grain_diameter, "m", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "d: diameter of a grain"),
      MPM_NUMBER_PARAMETER(grain_density, "kg/m^3", 2450, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "rho_s: density of a grain; glass 2450"),
      MPM_NUMBER_PARAMETER(static_friction, "", 0.38, 0.0, unbounded, 0,
                           "mu_s: friction below which grains do not flow; glass beads 0.38"),
      MPM_NUMBER_PARAMETER(limit_friction, "", 0.64, 0.0, unbounded, 0,
                           "mu_2: friction at large I; below static_friction it counts as that; glass beads 0.64"),
      MPM_NUMBER_PARAMETER(inertial_number, "", 0.279, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "I_0, where friction is half way from mu_s to mu_2; glass beads 0.279"),
      MPM_NUMBER_PARAMETER(critical_density, "kg/m^3", 0.0, 0.0, unbounded, 0,
                           "density below which grains are apart; below the initial one it counts as that"),
  };
  static constexpr mpm_state state[] = {
      {"elastic_deformation_gradient", "", "elastic part F_e of the deformation gradient, zz included in 2-D",
       MPM_STATE_DEFORMATION, MPM_INITIAL_IDENTITY},
      {"volume_ratio", "", "total J = det F", MPM_STATE_SCALAR, MPM_INITIAL_ONE},
  };
#endif
};

}  // namespace mpm

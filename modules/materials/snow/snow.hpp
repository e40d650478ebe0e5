#pragma once
// Snow: fixed corotated elasticity whose moduli grow as snow is compacted, and plastic flow that keeps the singular
// values of F_E in [1 - theta_c, 1 + theta_s]. Stomakhin, Schroeder, Chai, Teran & Selle, ACM Trans. Graph. 32 (2013)
// 102, sec. 5 and 7.
//
//   psi = h (mu |F_E - R_E|^2 + lambda/2 (J_E - 1)^2),   h = exp(xi (1 - J_P)),   F = F_E F_P
//   tau_i = h (2 mu (s_i - 1) s_i + lambda (J_E - 1) J_E) along the principal directions of F_E, s_i its stretches
//
// Of F_P only J_P = det F_P matters, and so only that is kept. In plane strain F_E zz stays 1.
//
// Dissipation. Let d_i be the plastic rates of stretch along the principal directions, so that dJ_P/dt = J_P sum d_i,
// and psi0 = psi/h, tau0_i = tau_i/h. Of the work of stress tau : l what is not stored is
//   D = tau : l - dpsi/dt = sum tau_i d_i - psi0 dh/dt = h sum (tau0_i + xi J_P psi0) d_i.
// The second law asks for D >= 0. The paper takes each stretch back to its bound by itself and asks for nothing of the
// kind, so that the sign of d_i is that of the bound and the sign of D that of tau0_i + xi J_P psi0:
//   compaction, d_i < 0: D < 0 where xi J_P psi0 > -tau0_i. Hardening then stores more than the work. All axes at
//     1 - theta_c have psi0 = -3/2 theta_c tau0 for small strains, so that this is where xi J_P theta_c > 2/3.
//   parting, d_i > 0: D < 0 where tau0_i < -xi J_P psi0. The other axes press through lambda, and the axis that parts
//     is in compression itself. With both at 1 - theta_c and the paper's numbers this is where J_P < 0.624.
// There the law makes energy. `advance` returns D with its sign, so that work = stored + dissipated holds everywhere.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#include "kernel/svd.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Snow {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, critical_compression, critical_stretch, hardening, largest_hardening;
  };
  template <class T>
  struct Constants {
    T mu, lambda, inverse_density;
    T least, largest;       ///< 1 - theta_c and 1 + theta_s
    T hardening, exponent;  ///< xi, and the most that |xi (1 - J_P)| counts
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          inverse_density(T(1 / p.density)),
          least(T(1 - p.critical_compression)),
          largest(T(1 + p.critical_stretch)),
          hardening(T(p.hardening)),
          exponent(T(log(p.largest_hardening))) {}
  };

  /// The state: `Gradient` is a Mat, or in axisymmetric scenes a Deformation.
  template <class Gradient>
  struct SnowState {
    Gradient elastic_deformation_gradient;
    typename Gradient::Scalar plastic_volume_ratio;  ///< J_P
  };
  template <int D, class S>
  using State = SnowState<Mat<D, S>>;
  template <class S>
  using AxisymmetricState = SnowState<Deformation<2, S>>;

  /// The factor h of the moduli.
  template <class S>
  MPM_HD static S factor(const Constants<scalar_of<S>>& c, S plastic_volume_ratio) {
    const S wanted = c.hardening * (real<S>(1) - plastic_volume_ratio);
    return exp(min(max(wanted, S(-c.exponent)), S(c.exponent)));
  }

  /// mu sum (s_i - 1)^2 + lambda/2 (J_E - 1)^2: the energy psi0 of snow that has not hardened.
  template <class S>
  MPM_HD static S unhardened_energy(const Constants<scalar_of<S>>& c, const Vec<3, S>& stretch) {
    S squared = S(real<S>(0));
    for (int i = 0; i < 3; ++i) squared = squared + (stretch[i] - real<S>(1)) * (stretch[i] - real<S>(1));
    const S change = product(stretch) - real<S>(1);
    return c.mu * squared + real<S>(0.5) * c.lambda * (change * change);
  }

  /// Principal Kirchhoff stresses tau0 of snow that has not hardened.
  template <class S>
  MPM_HD static Vec<3, S> unhardened_stresses(const Constants<scalar_of<S>>& c, const Vec<3, S>& stretch) {
    const S J = product(stretch), pressure = c.lambda * ((J - real<S>(1)) * J);
    Vec<3, S> tau;
    for (int i = 0; i < 3; ++i) tau[i] = real<S>(2) * c.mu * ((stretch[i] - real<S>(1)) * stretch[i]) + pressure;
    return tau;
  }

  template <class S>
  MPM_HD static S product(const Vec<3, S>& a) {
    return a[0] * a[1] * a[2];
  }

  /// The stretch along z, which is 1 in plane strain.
  template <class S>
  MPM_HD static S out_of_plane(const Mat<2, S>&) {
    return S(real<S>(1));
  }
  template <class S>
  MPM_HD static S out_of_plane(const Deformation<2, S>& F) {
    return F.zz;
  }

  /// The three stretches of F from those along the axes of the grid.
  template <class G, class S>
  MPM_HD static Vec<3, S> all_stretches(const G& F, const Vec<2, S>& plane) {
    return {{plane[0], plane[1], out_of_plane(F)}};
  }
  template <class G, class S>
  MPM_HD static Vec<3, S> all_stretches(const G&, const Vec<3, S>& space) {
    return space;
  }

  /// Returns the energy dissipated, J/m^3: the work of tau on the plastic strain less what hardening adds to the stored
  /// energy; negative where the law makes energy, see above. The stretches are those after the return, h the mean of
  /// the step, as an impact changes it by much in one. A particle that does not yield keeps F_E as advanced, and J_P,
  /// to the last bit.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, SnowState<G>& state) {
    constexpr int D = G::dimension;
    const S zero = S(real<S>(0));
    const G trial = advanced(state.elastic_deformation_gradient, L, dt);
    const SingularValues<D, S> parts = singular_value_decomposition(in_plane(trial));
    const Vec<3, S> stretch = all_stretches(trial, parts.values);
    Vec<3, S> kept;
    S beyond = zero;
    for (int i = 0; i < 3; ++i) {
      kept[i] = min(max(stretch[i], S(c.least)), S(c.largest));
      beyond = beyond + abs(stretch[i] - kept[i]);
    }
    const auto yields = !(beyond <= zero);  // NaN included
    if (!any(yields)) {
      state.elastic_deformation_gradient = trial;
      return zero;
    }
    Vec<D, S> along_grid;
    for (int i = 0; i < D; ++i) along_grid[i] = kept[i];
    const Mat<D, S> returned = composed(parts.U, along_grid, parts.V);
    G& F = state.elastic_deformation_gradient;
    F = trial;
    keep_if(yields, returned, kept, F);
    // The determinants of what is stored: their rounding does not pile up in J.
    const S before = state.plastic_volume_ratio, after = before * (determinant(trial) / determinant(F));
    state.plastic_volume_ratio = select(yields, after, before);

    const S h_before = factor(c, before), h = factor(c, state.plastic_volume_ratio);
    const Vec<3, S> tau = unhardened_stresses(c, kept);
    S work = zero;
    for (int i = 0; i < 3; ++i) work = work + tau[i] * log(max(stretch[i], S(svd::tiny<S>())) / kept[i]);
    const S heat = real<S>(0.5) * (h_before + h) * work - (h - h_before) * unhardened_energy(c, kept);
    return select(yields, heat, zero);
  }

  /// F <- the returned matrix and stretch along z, where the mask holds.
  template <class Mask, int D, class S>
  MPM_HD static void keep_if(const Mask& yields, const Mat<D, S>& returned, const Vec<3, S>&, Mat<D, S>& F) {
    for (int k = 0; k < D * D; ++k) F.m[k] = select(yields, returned.m[k], F.m[k]);
  }
  template <class Mask, class S>
  MPM_HD static void keep_if(const Mask& yields, const Mat<2, S>& returned, const Vec<3, S>& kept,
                             Deformation<2, S>& F) {
    keep_if(yields, returned, kept, F.plane);
    F.zz = select(yields, kept[2], F.zz);
  }

  /// Principal directions and stretches of F_E, and J_P: what stress, energy and wave speed share.
  template <int D, class S>
  struct Principal {
    Mat<D, S> directions;
    Vec<3, S> stretch;
    S plastic_volume_ratio;
  };

  template <class G, class S = typename G::Scalar>
  MPM_HD static Principal<G::dimension, S> prepared(const SnowState<G>& state) {
    const G& F = state.elastic_deformation_gradient;
    const LeftStretches<G::dimension, S> parts = left_stretches(in_plane(F));
    return {parts.U, all_stretches(F, parts.stretch), state.plastic_volume_ratio};
  }

  /// tau = U diag(principal stresses) U^T.
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const Principal<D, S>& p) {
    const S h = factor(c, p.plastic_volume_ratio);
    Vec<3, S> principal = unhardened_stresses(c, p.stretch);
    for (int i = 0; i < 3; ++i) principal[i] = h * principal[i];
    return from_principal(p.directions, principal);
  }

  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const Principal<D, S>& p) {
    return factor(c, p.plastic_volume_ratio) * unhardened_energy(c, p.stretch);
  }

  /// The fastest wave. Elastic ones have rho0 c^2 = h (2 mu s^2 + lambda J_E^2) at most, s the largest stretch along
  /// the grid (see fixed_corotated), without lambda where that is negative. A wave that compacts hardens as well: of a
  /// unit a (x) n the plastic part has a trace of 1 at most and stress does work of max |tau_i| at most, so that
  /// hardening adds xi J_P max |tau_i|. Where F_E cannot follow, the stress that is carried along with the material
  /// adds max |tau_i| once more.
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const Principal<D, S>& p) {
    const S one = S(real<S>(1)), zero = S(real<S>(0)), J = product(p.stretch);
    const Vec<3, S> tau = unhardened_stresses(c, p.stretch);
    const S strongest = max(max(abs(tau[0]), abs(tau[1])), abs(tau[2]));
    S s = max(p.stretch[0], p.stretch[1]);
    if constexpr (D == 3) s = max(s, p.stretch[2]);
    const S wanted = c.hardening * (one - p.plastic_volume_ratio);
    const S rate = select(abs(wanted) <= c.exponent, c.hardening * p.plastic_volume_ratio, zero);
    const S modulus = real<S>(2) * c.mu * (s * s) + max(c.lambda * (J * J), zero) + (one + rate) * strongest;
    return sqrt(c.inverse_density * (factor(c, p.plastic_volume_ratio) * modulus));
  }

  /// Stress, energy and wave speed of a state whose stretches are not known yet.
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const SnowState<G>& state) {
    return kirchhoff_stress(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const SnowState<G>& state) {
    return stored_energy(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const SnowState<G>& state) {
    return wave_speed(c, prepared(state));
  }

  /// The total J = J_E J_P.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S volume_ratio(const SnowState<G>& state) {
    return determinant(state.elastic_deformation_gradient) * state.plastic_volume_ratio;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_PLASTIC_WORK;
  static constexpr const char* makes_energy =
      "where snow parts under pressure from its sides, and where xi J_P theta_c is large: each stretch returns to its "
      "bound by itself, whatever the stress along it, and hardening scales the stored energy";
  static constexpr mpm_clamp clamps[] = {
      {"below J_P =", "", "the moduli of snow that is compacted stay at largest_hardening times those at rest"},
      {"above J_P =", "", "the moduli of snow that has come loose stay at those at rest over largest_hardening"},
  };
  static void clamp_bounds(const Parameters& p, double* bound) {
    const double reach = p.hardening > 0 ? log(p.largest_hardening) / p.hardening : no_bound;
    bound[0] = reach < 1 ? 1 - reach : no_bound, bound[1] = 1 + reach;
  }
  template <class AnyState>
  static unsigned acting_clamps(const double* bound, const AnyState& state) {
    return (state.plastic_volume_ratio < bound[0] ? 1u : 0u) | (state.plastic_volume_ratio > bound[1] ? 2u : 0u);
  }
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus at small strain before hardening; 140 kPa in the paper"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain; 0.2 in the paper"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "initial density; 400 kg/m^3 in the paper"),
      MPM_NUMBER_PARAMETER(critical_compression, "", 2.5e-2, 0.0, 1.0, MPM_BELOW_MAXIMUM,
                           "theta_c: F_E has no singular value below 1 - theta_c"),
      MPM_NUMBER_PARAMETER(critical_stretch, "", 7.5e-3, 0.0, unbounded, 0,
                           "theta_s: F_E has no singular value above 1 + theta_s"),
      MPM_NUMBER_PARAMETER(hardening, "", 10.0, 0.0, unbounded, 0, "xi: moduli grow as exp(xi (1 - J_P))"),
      MPM_NUMBER_PARAMETER(largest_hardening, "", 100.0, 1.0, unbounded, 0,
                           "the factor of the moduli stays between the inverse of this and this"),
  };
  static constexpr mpm_state state[] = {
      {"elastic_deformation_gradient", "", "elastic part F_E of the deformation gradient", MPM_STATE_PLANE_DEFORMATION,
       MPM_INITIAL_IDENTITY},
      {"plastic_volume_ratio", "", "J_P, by which the volume has changed for good", MPM_STATE_SCALAR, MPM_INITIAL_ONE},
  };
#endif
};

}  // namespace mpm

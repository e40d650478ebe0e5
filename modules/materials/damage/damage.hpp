#pragma once
// Elastic solid with scalar damage of its tensile energy, and softening that is scaled by the cell size so that a crack
// dissipates its fracture energy whatever the grid. Damage by the energy as its norm: Simo & Ju, Int. J. Solids Struct. 23
// (1987) 821; the crack band: Bazant & Oh, Mater. Struct. 16 (1983) 155; the split, by the solid that bears no tension:
// Freddi & Royer-Carfagni, J. Mech. Phys. Solids 58 (2010) 1154, here on Hencky's strain.
//
// With the principal strains e of Hencky's law, r >= 0 is the strain that cracks would take if they were free of stress: of
// all that are not negative, the one that leaves the least energy psi(e - r). What is left, p = e - r, has no tension,
// and because it is a projection on a cone psi(e) = psi(p) + psi(r). So
//   psi = psi(p) + (1 - d) psi(r),   tau = d psi/d e = C (e - d r),   y = max sqrt(2 psi(r)/M),   d = d(y)
// and what is dissipated is the integral of psi(r) dd, never negative. M = lambda + 2 mu. kernel/softening.hpp chooses d(y) so
// that uniaxial tension has the stress sigma(ln s) of its law, exactly.

#include "kernel/functor.hpp"
#include "kernel/hencky.hpp"
#include "kernel/softening.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

/// State: F, how far it was strained, and the share of the tensile energy that is lost.
template <class Gradient>
struct DamageState {
  Gradient deformation_gradient;
  typename Gradient::Scalar equivalent_strain, damage;
};

struct Damage {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, tensile_strength, fracture_energy, softening, band_cells;
    double opening_1, share_1, opening_2, share_2, opening_3, share_3, opening_4, share_4;
    double cell_size;  ///< m, of the grid
  };
  MPM_HD static SofteningTable table_of(const Parameters& p) {
    return {{p.opening_1, p.opening_2, p.opening_3, p.opening_4}, {p.share_1, p.share_2, p.share_3, p.share_4}};
  }
  template <class T>
  struct Constants {
    T mu, lambda, inverse_density, rest_modulus;  ///< `rest_modulus` is M = lambda + 2 mu
    T inverse_modulus;                            ///< 1/M, 1/Pa
    T lateral;  ///< nu: strain across a stress along one direction, over the strain along it
    T across;   ///< nu/(1 - nu): strain across stresses in a plane, over the sum of the strains in it
    BandSoftening<T> softening;
    MPM_HD static double confined(const Parameters& p) {
      return lame_lambda(p.youngs_modulus, p.poisson_ratio) + 2 * shear_modulus(p.youngs_modulus, p.poisson_ratio);
    }
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          inverse_density(T(1 / p.density)),
          rest_modulus(T(confined(p))),
          inverse_modulus(T(1 / confined(p))),
          lateral(T(p.poisson_ratio)),
          across(T(p.poisson_ratio / (1 - p.poisson_ratio))),
          softening(static_cast<SofteningLaw>(static_cast<int>(p.softening)), p.youngs_modulus, p.tensile_strength,
                    p.fracture_energy, p.band_cells * p.cell_size, 1 - p.youngs_modulus / confined(p), table_of(p)) {}
  };

  template <int D, class S>
  using State = DamageState<Mat<D, S>>;
  template <class S>
  using AxisymmetricState = DamageState<Deformation<2, S>>;

  /// Principal directions and strains of F, and the damage.
  template <int D, class S>
  struct Prepared {
    HenckySolid::Principal<D, S> principal;
    S damage;
  };

  template <class S>
  MPM_HD static S strain_of_z(const Mat<2, S>&) {
    return S(real<S>(0));
  }
  template <class S>
  MPM_HD static S strain_of_z(const Deformation<2, S>& F) {
    return log(F.zz);
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static HenckySolid::Principal<G::dimension, S> principal(const G& F) {
    constexpr int D = G::dimension;
    const LeftStretches<D, S> parts = left_stretches(in_plane(F));
    HenckySolid::Principal<D, S> p;
    p.directions = parts.U;
    for (int i = 0; i < D; ++i) p.strain[i] = log(parts.stretch[i]);
    if constexpr (D == 2) p.strain[2] = strain_of_z(F);
    return p;
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static Prepared<G::dimension, S> prepared(const DamageState<G>& state) {
    return {principal(state.deformation_gradient), state.damage};
  }

  /// p, the part of the principal strains that damage leaves: from the least strain to the largest each is what it is, or as
  /// much as the pressures found before it stretch it, free of stress.
  template <class S>
  MPM_HD static Vec<3, S> pressed(const Constants<scalar_of<S>>& c, const Vec<3, S>& e) {
    const S zero = S(real<S>(0));
    const S top = max(max(e[0], e[1]), e[2]), low = min(min(e[0], e[1]), e[2]);
    const S middle = max(min(max(e[0], e[1]), e[2]), min(e[0], e[1]));
    const S third = min(low, zero), second = min(middle, -(c.lateral * third)),
            first = min(top, -(c.across * (second + third)));
    Vec<3, S> p;
    for (int i = 0; i < 3; ++i) p[i] = select(e[i] < top, select(e[i] > low, second, third), first);
    return p;
  }
  template <class S>
  MPM_HD static Vec<3, S> difference(const Vec<3, S>& a, const Vec<3, S>& b) {
    return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
  }

  template <class S>
  MPM_HD static S energy(const Constants<scalar_of<S>>& c, const Vec<3, S>& e) {
    const S trace = HenckySolid::sum(e);
    return c.mu * HenckySolid::dot(e, e) + real<S>(0.5) * c.lambda * trace * trace;
  }

  /// Returns the energy dissipated, J/m^3.
  template <class G, class L, class S = typename G::Scalar>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const L& gradient, scalar_of<S> dt, DamageState<G>& state) {
    state.deformation_gradient = advanced(state.deformation_gradient, gradient, dt);
    const Vec<3, S> e = principal(state.deformation_gradient).strain, r = difference(e, pressed(c, e));
    const S first = S(c.softening.first_measure()), onset = S(c.softening.onset);
    const S measure = sqrt(max(real<S>(2) * c.inverse_modulus * energy(c, r), first * first));
    const S before = max(state.equivalent_strain, onset), now = c.softening.strain_of(measure);
    state.equivalent_strain = max(before, now);
    state.damage = max(state.damage, c.softening.damage(state.equivalent_strain));
    return c.softening.dissipated(before, state.equivalent_strain);
  }

  /// tau = C (e - d r).
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const Prepared<D, S>& p) {
    const Vec<3, S>& e = p.principal.strain;
    const Vec<3, S> kept = pressed(c, e);
    Vec<3, S> left;
    for (int i = 0; i < 3; ++i) left[i] = e[i] - p.damage * (e[i] - kept[i]);
    return from_principal(p.principal.directions, HenckySolid::stresses(c, left));
  }

  /// psi(p) + (1 - d) psi(r).
  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const Prepared<D, S>& p) {
    const Vec<3, S>& e = p.principal.strain;
    const Vec<3, S> kept = pressed(c, e);
    return energy(c, kept) + (real<S>(1) - p.damage) * energy(c, difference(e, kept));
  }

  /// The fastest wave of the undamaged solid, or of the share of it that is left where nothing is pressed; never slower
  /// than at rest, as cracks that close are stiff at once. Softening takes from the tangent a product of the lost stress
  /// with itself, which makes no wave faster.
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const Prepared<D, S>& p) {
    const Vec<3, S>& e = p.principal.strain;
    const Vec<3, S> kept = pressed(c, e), of_all = HenckySolid::stresses(c, e),
                    of_kept = HenckySolid::stresses(c, kept);
    S least = min(of_all[0], of_kept[0]);
    for (int i = 1; i < 3; ++i) least = min(least, min(of_all[i], of_kept[i]));
    const S one = S(real<S>(1)), x = max(max(e[0], e[1]), e[2]) - min(min(e[0], e[1]), e[2]);
    const S solid = max(c.rest_modulus - least, c.mu * (x + sqrt(x * x + one))) + c.mu * HenckySolid::askew(x);
    const S share = select(min(min(kept[0], kept[1]), kept[2]) < real<S>(0), one, one - p.damage);
    return sqrt(c.inverse_density * max(S(c.rest_modulus), share * solid));
  }

  /// Stress, energy and wave speed of a state whose principal strains are not known yet.
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const DamageState<G>& state) {
    return kirchhoff_stress(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const DamageState<G>& state) {
    return stored_energy(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const DamageState<G>& state) {
    return wave_speed(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S volume_ratio(const DamageState<G>& state) {
    return determinant(state.deformation_gradient);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_DAMAGE;

  /// Refuses a table that is none, and cells on which a band would snap back; the largest usable one is `limit`.
  static mpm_refusal refusal(const Parameters& p, const mpm_refusal_case&) {
    const auto law = static_cast<SofteningLaw>(static_cast<int>(p.softening));
    const SofteningTable table = table_of(p);
    constexpr const char* openings[] = {"", "opening_1", "opening_2", "opening_3", "opening_4"};
    constexpr const char* shares[] = {"", "share_1", "share_2", "share_3", "share_4"};
    const int points = law == SofteningLaw::table ? table.lines - 1 : 0;
    for (int k = points; k > 0; --k)  // from the last point, which 1 bounds, each bounds the one before it
      if (!(table.opening[k] < table.opening[k + 1]))
        return {openings[k], "the openings of a table grow from point to point, from 0 to 1", table.opening[k + 1]};
    for (int k = 1; k <= points; ++k)
      if (!(table.share[k] <= table.share[k - 1]))
        return {shares[k], "a crack does not become stronger as it opens: the shares of a table do not grow",
                table.share[k - 1]};
    const double further[][2] = {
        {p.opening_1, p.share_1}, {p.opening_2, p.share_2}, {p.opening_3, p.share_3}, {p.opening_4, p.share_4}};
    for (int k = points; k < SofteningTable::points; ++k)
      if (further[k][0] != 0 || further[k][1] != 0)
        return {further[k][0] != 0 ? openings[k + 1] : shares[k + 1],
                law == SofteningLaw::table
                    ? "the points of a table are given one after the other, each with an opening above 0"
                    : "points belong to \"softening\": \"table\"",
                0};
    const double widest = widest_band(law, p.youngs_modulus, p.tensile_strength, p.fracture_energy, table);
    const double largest = widest / p.band_cells;
    if (p.cell_size < largest) return {nullptr, nullptr, 0};
    return {
        "cell_size",
        "at its strength a band this wide holds more elastic energy than its crack dissipates, so that it would snap "
        "back; take smaller cells or a larger fracture_energy",
        largest};
  }

#define MPM_SOFTENING_POINT(k)                                                                                         \
  MPM_NUMBER_PARAMETER(opening_##k, "", 0.0, 0.0, 1.0, MPM_BELOW_MAXIMUM,                                              \
                       "of `table`: opening of point " #k " over that of a crack without strength; 0: no such point"), \
      MPM_NUMBER_PARAMETER(share_##k, "", 0.0, 0.0, 1.0, 0, "of `table`: share of ft that is left at point " #k)
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus E, of the logarithmic strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio nu, of the logarithmic strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(tensile_strength, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "ft: uniaxial tensile stress (Kirchhoff) at which damage begins"),
      MPM_NUMBER_PARAMETER(fracture_energy, "J/m^2", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Gc: energy that a crack of unit area dissipates"),
      MPM_CHOICE_PARAMETER(softening, "linear|exponential|bilinear|table", 0, "how stress falls as a crack opens"),
      MPM_NUMBER_PARAMETER(band_cells, "", 1.0, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "width of the band in which a crack localises, in cells"),
      MPM_SOFTENING_POINT(1),
      MPM_SOFTENING_POINT(2),
      MPM_SOFTENING_POINT(3),
      MPM_SOFTENING_POINT(4),
  };
#undef MPM_SOFTENING_POINT
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
      {"equivalent_strain", "", "largest equivalent strain so far, ft/E where it was less", MPM_STATE_SCALAR,
       MPM_INITIAL_ZERO},
      {"damage", "", "share of the energy of tension that is lost, 0 to 1", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm

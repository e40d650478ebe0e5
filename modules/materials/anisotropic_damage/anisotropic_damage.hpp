#pragma once
// Elastic solid that cracks on one plane, with a softening law for the opening of the plane and one for its sliding,
// both scaled by the cell size: Nairn, Hammerquist & Aimene, Int. J. Numer. Methods Eng. 112 (2017) 1848, here with
// Hencky's strain and with a stored energy. The crack band: Bazant & Oh, Mater. Struct. 16 (1983) 155. What one law has
// lost weakens the other as in Park, Paulino & Roesler, J. Mech. Phys. Solids 57 (2009) 891.
//
// n0 is the normal of the plane in the undeformed body, n = R n0 with F = V R, E = ln V, M = lambda + 2 mu. With
//   x = n.E n + nu/(1 - nu) (tr E - n.E n)   (the normal stress of the whole solid over M),   gamma = E n - (n.E n) n,
//   psi = E:C:E/2 - d_n M <x>^2/2 - d_s 2 mu |gamma|^2
// As psi is a function of ln U and of n0, tau = R (g o dpsi/d ln U) R^T: in the principal axes of U the components off
// the diagonal are taken z/sinh(z) times, z the difference of their two principal strains. Where nothing has cracked
// dpsi/d ln U has none, and tau is that of Hencky's solid. Dissipated is M <x>^2/2 dd_n + 2 mu |gamma|^2 dd_s, never
// negative.

#include "kernel/functor.hpp"
#include "kernel/hencky.hpp"
#include "kernel/softening.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

/// State: F, the plane of the crack, how far it was strained across and along itself, and what it lost.
template <class Gradient>
struct AnisotropicDamageState {
  using Scalar = typename Gradient::Scalar;
  Gradient deformation_gradient;
  Vec<Gradient::dimension, Scalar> crack_normal;
  Scalar opening_strain, sliding_strain, damage, shear_damage;
};

struct AnisotropicDamage {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, tensile_strength, fracture_energy, softening, shear_strength,
        shear_fracture_energy, shear_softening, band_cells;
    double cell_size;  ///< m, of the grid
  };
  MPM_HD static SofteningLaw law_of(double choice) { return static_cast<SofteningLaw>(static_cast<int>(choice)); }

  template <class T>
  struct Constants {
    T mu, lambda, inverse_density, rest_modulus;  ///< `rest_modulus` is M = lambda + 2 mu
    T across;                                     ///< nu/(1 - nu) = lambda/M
    BandSoftening<T> opening, sliding;
    MPM_HD static double confined(const Parameters& p) {
      return lame_lambda(p.youngs_modulus, p.poisson_ratio) + 2 * shear_modulus(p.youngs_modulus, p.poisson_ratio);
    }
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          inverse_density(T(1 / p.density)),
          rest_modulus(T(confined(p))),
          across(T(p.poisson_ratio / (1 - p.poisson_ratio))),
          opening(law_of(p.softening), p.youngs_modulus, p.tensile_strength, p.fracture_energy,
                  p.band_cells * p.cell_size, 1 - p.youngs_modulus / confined(p)),
          sliding(law_of(p.shear_softening), shear_modulus(p.youngs_modulus, p.poisson_ratio), p.shear_strength,
                  p.shear_fracture_energy, p.band_cells * p.cell_size, 0) {}
  };

  template <int D, class S>
  using State = AnisotropicDamageState<Mat<D, S>>;
  template <class S>
  using AxisymmetricState = AnisotropicDamageState<Deformation<2, S>>;

  /// Principal directions of V and strains along them, and the directions in the undeformed body that became them.
  template <int D, class S>
  struct Axes {
    Mat<D, S> directions, undeformed;
    Vec<3, S> strain;
  };
  /// What stress, energy and wave speed share. The normal has its components along the principal directions.
  template <int D, class S>
  struct Prepared {
    Mat<D, S> directions;
    Vec<3, S> strain, normal;
    S damage, shear_damage;
  };
  /// The strain as the crack's plane meets it.
  template <class S>
  struct AcrossPlane {
    S stretching;       ///< n.E n
    S beside;           ///< tr E - n.E n
    S opening;          ///< x: the normal stress of the whole solid over M
    Vec<3, S> sliding;  ///< gamma
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
  MPM_HD static Axes<G::dimension, S> axes(const G& gradient) {
    constexpr int D = G::dimension;
    const Mat<D, S>& F = in_plane(gradient);
    const LeftStretches<D, S> parts = left_stretches(F);
    Axes<D, S> a;
    a.directions = parts.U;
    for (int i = 0; i < D; ++i) {
      a.strain[i] = log(parts.stretch[i]);
      for (int k = 0; k < D; ++k) {
        S t = F(0, k) * parts.U(0, i);
        for (int j = 1; j < D; ++j) t = t + F(j, k) * parts.U(j, i);
        a.undeformed(k, i) = t / parts.stretch[i];
      }
    }
    if constexpr (D == 2) a.strain[2] = strain_of_z(gradient);
    return a;
  }

  /// The crack's normal n along the principal directions. In 2-D a crack without a normal in the plane has that of z.
  /// Where nothing has cracked it is the first direction, along which nothing slides.
  template <class G, int D, class S>
  MPM_HD static Vec<3, S> normal(const Axes<D, S>& a, const AnisotropicDamageState<G>& state) {
    const S zero = S(real<S>(0)), one = S(real<S>(1));
    const auto cracked = state.opening_strain > real<S>(0);
    Vec<3, S> n{{zero, zero, zero}};
    S in_space = zero;
    for (int i = 0; i < D; ++i) {
      for (int k = 0; k < D; ++k) n[i] = n[i] + a.undeformed(k, i) * state.crack_normal[k];
      in_space = in_space + state.crack_normal[i] * state.crack_normal[i];
    }
    if constexpr (D == 2) n[2] = select(in_space < real<S>(0.5), one, zero);
    for (int i = 0; i < 3; ++i) n[i] = select(cracked, n[i], i == 0 ? one : zero);
    return n;
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static Prepared<G::dimension, S> prepared(const AnisotropicDamageState<G>& state) {
    const Axes<G::dimension, S> a = axes(state.deformation_gradient);
    return {a.directions, a.strain, normal(a, state), state.damage, state.shear_damage};
  }

  template <class S>
  MPM_HD static AcrossPlane<S> across_plane(const Constants<scalar_of<S>>& c, const Vec<3, S>& e, const Vec<3, S>& n) {
    AcrossPlane<S> r;
    r.stretching = e[0] * (n[0] * n[0]) + e[1] * (n[1] * n[1]) + e[2] * (n[2] * n[2]);
    r.beside = HenckySolid::sum(e) - r.stretching;
    r.opening = r.stretching + c.across * r.beside;
    for (int i = 0; i < 3; ++i) r.sliding[i] = (e[i] - r.stretching) * n[i];
    return r;
  }

  /// The share of its strength that a law has left, 1 up to the onset.
  template <class T, class S>
  MPM_HD static S share_left(const BandSoftening<T>& law, const S& kappa) {
    return select(kappa > law.onset, law.stress(kappa) / law.strength, S(real<S>(1)));
  }

  /// Where no crack is and the largest principal stress of the whole solid exceeds the strength, one begins across it.
  /// Of equal stresses the one around the axis, or of z, comes last.
  template <class G, int D, class S>
  MPM_HD static void begin_crack(const Constants<scalar_of<S>>& c, const Axes<D, S>& a,
                                 AnisotropicDamageState<G>& state) {
    const S zero = S(real<S>(0)), one = S(real<S>(1)), onset = S(c.opening.onset);
    const Vec<3, S>& e = a.strain;
    const S top = max(max(e[0], e[1]), e[2]), opening = top + c.across * (HenckySolid::sum(e) - top);
    const S breaks = select(opening > c.opening.first_measure(), one, zero);
    const S begins = select(state.opening_strain > real<S>(0), zero, breaks);
    Vec<D, S> direction;
    for (int k = 0; k < D; ++k) direction[k] = zero;
    for (int i = D - 1; i >= 0; --i)
      for (int k = 0; k < D; ++k) direction[k] = select(e[i] < top, direction[k], a.undeformed(k, i));
    for (int k = 0; k < D; ++k)
      state.crack_normal[k] = select(begins > real<S>(0.5), direction[k], state.crack_normal[k]);
    state.opening_strain = select(begins > real<S>(0.5), onset, state.opening_strain);
  }

  /// Returns the energy dissipated, J/m^3. Each law dissipates along its own curve, as much of it as the other has
  /// left; what the other loses takes its share from what is stored now.
  template <class G, class L, class S = typename G::Scalar>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const L& gradient, scalar_of<S> dt,
                          AnisotropicDamageState<G>& state) {
    const S zero = S(real<S>(0)), one = S(real<S>(1));
    state.deformation_gradient = advanced(state.deformation_gradient, gradient, dt);
    const Axes<G::dimension, S> a = axes(state.deformation_gradient);
    begin_crack(c, a, state);
    const AcrossPlane<S> strain = across_plane(c, a.strain, normal(a, state));
    const S open = max(strain.opening, zero), squared = HenckySolid::dot(strain.sliding, strain.sliding);

    const S opened = max(state.opening_strain, S(c.opening.onset)),
            slid = max(state.sliding_strain, S(c.sliding.onset));
    const S opens = max(opened, c.opening.strain_of(open)), slides = max(slid, real<S>(2) * sqrt(squared));
    const S normal_share = share_left(c.opening, opened), normal_left = share_left(c.opening, opens);
    const S shear_share = share_left(c.sliding, slid), shear_left = share_left(c.sliding, slides);
    const S normal_stiffness = one - c.opening.damage(opens), shear_stiffness = one - c.sliding.damage(slides);
    const S normal_energy = real<S>(0.5) * c.rest_modulus * (open * open), shear_energy = real<S>(2) * c.mu * squared;

    state.opening_strain = select(state.opening_strain > real<S>(0), opens, zero);
    state.sliding_strain = select(slides > slid, slides, state.sliding_strain);
    state.damage = max(state.damage, one - shear_left * normal_stiffness);
    state.shear_damage = max(state.shear_damage, one - normal_left * shear_stiffness);
    return shear_share * c.opening.dissipated(opened, opens) +
           normal_stiffness * normal_energy * (shear_share - shear_left) +
           normal_share * c.sliding.dissipated(slid, slides) +
           shear_stiffness * shear_energy * (normal_share - normal_left);
  }

  /// z/sinh(z): how a component of dpsi/d ln U between two principal directions is carried over to tau, where their
  /// strains differ by z.
  template <class S>
  MPM_HD static S carried(const S& z) {
    const S size = abs(z), change = exponential_change(size);
    const S twice = change + change / (real<S>(1) + change);
    const auto differ = twice > real<S>(0);
    return select(differ, real<S>(2) * size / select(differ, twice, S(real<S>(1))), S(real<S>(1)));
  }

  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const Prepared<D, S>& p) {
    const AcrossPlane<S> strain = across_plane(c, p.strain, p.normal);
    const Vec<3, S>&n = p.normal, whole = HenckySolid::stresses(c, p.strain);
    const S lost = p.damage * (c.rest_modulus * max(strain.opening, S(real<S>(0))));
    const S along = lost * (real<S>(1) - c.across), shear = real<S>(2) * c.mu * p.shear_damage;
    Mat<D, S> T;
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) {
        const S relief = along * (n[i] * n[j]) + shear * (strain.sliding[i] * n[j] + n[i] * strain.sliding[j]);
        T(i, j) = i == j ? whole[i] - c.across * lost - relief : -(carried(p.strain[i] - p.strain[j]) * relief);
        T(j, i) = T(i, j);
      }
    const Mat<D, S> turned = p.directions * T;
    Sym<D, S> tau;
    tau.s[2] = whole[2] - c.across * lost - along * (n[2] * n[2]);  // zz in 2-D; written over below in 3-D
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) {
        S t = turned(i, 0) * p.directions(j, 0);
        for (int k = 1; k < D; ++k) t = t + turned(i, k) * p.directions(j, k);
        tau(i, j) = t;
      }
    return tau;
  }

  /// The energy of the strain within the plane, free of stress across it, and of opening and of sliding: none is
  /// negative.
  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const Prepared<D, S>& p) {
    const AcrossPlane<S> strain = across_plane(c, p.strain, p.normal);
    const Vec<3, S>&n = p.normal, &slide = strain.sliding;
    const S zero = S(real<S>(0)), one = S(real<S>(1));
    S within = zero;  // the squared strain within the plane
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) {
        const S across = strain.stretching * (n[i] * n[j]) + (slide[i] * n[j] + n[i] * slide[j]);
        const S left = i == j ? p.strain[i] - across : across;
        within = within + (i == j ? real<S>(1) : real<S>(2)) * (left * left);
      }
    const S open = max(strain.opening, zero), closed = min(strain.opening, zero);
    return c.mu * (within + c.across * (strain.beside * strain.beside)) +
           real<S>(0.5) * c.rest_modulus * ((one - p.damage) * (open * open) + closed * closed) +
           real<S>(2) * c.mu * ((one - p.shear_damage) * HenckySolid::dot(slide, slide));
  }

  /// The fastest wave of the whole solid: of each strain the crack takes stiffness and adds none. What a wave has of
  /// the stresses differs. Those along the plane press by more, or pull more with nu < 0, where the crack no longer
  /// pulls across them, and they hold a wave along the plane as a string does, which an equal tension across it would
  /// not let be faster.
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const Prepared<D, S>& p) {
    const AcrossPlane<S> strain = across_plane(c, p.strain, p.normal);
    const Vec<3, S>& e = p.strain;
    const Vec<3, S> whole = HenckySolid::stresses(c, e);
    const S zero = S(real<S>(0)), one = S(real<S>(1)), pull = c.rest_modulus * strain.opening;
    const S aside = c.across * max(pull, zero);
    const S shear =
        (one - p.shear_damage) * (real<S>(2) * c.mu * sqrt(HenckySolid::dot(strain.sliding, strain.sliding)));
    const S low = min(min(whole[0], whole[1]), whole[2]), high = max(max(whole[0], whole[1]), whole[2]);
    const S high_along = min(high, HenckySolid::sum(whole) - pull - low);  // of the plane's two, none is below `low`
    const S least = low + p.damage * (min(low - aside, zero) - shear - low);
    const S most = high + p.damage * (max(high_along - aside, zero) + shear - high);
    const S x = max(max(e[0], e[1]), e[2]) - min(min(e[0], e[1]), e[2]);
    const S string = select(p.damage > real<S>(0), c.mu + (most - least), zero);
    const S solid =
        max(max(c.rest_modulus - least, string), c.mu * (x + sqrt(x * x + one))) + c.mu * HenckySolid::askew(x);
    return sqrt(c.inverse_density * max(S(c.rest_modulus), solid));
  }

  /// Stress, energy and wave speed of a state whose principal strains are not known yet.
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c,
                                                      const AnisotropicDamageState<G>& state) {
    return kirchhoff_stress(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const AnisotropicDamageState<G>& state) {
    return stored_energy(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const AnisotropicDamageState<G>& state) {
    return wave_speed(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S volume_ratio(const AnisotropicDamageState<G>& state) {
    return determinant(state.deformation_gradient);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_DAMAGE;

  /// Refuses cells on which a band would snap back, pulled or sheared; the largest usable one is `limit`.
  static mpm_refusal refusal(const Parameters& p, const mpm_refusal_case&) {
    const double shear = shear_modulus(p.youngs_modulus, p.poisson_ratio);
    const double pulled = widest_band(law_of(p.softening), p.youngs_modulus, p.tensile_strength, p.fracture_energy),
                 sheared = widest_band(law_of(p.shear_softening), shear, p.shear_strength, p.shear_fracture_energy);
    const double largest = min(pulled, sheared) / p.band_cells;
    if (p.cell_size < largest) return {nullptr, nullptr, 0};
    return {"cell_size",
            pulled < sheared ? "at its tensile strength a band this wide holds more elastic energy than its crack "
                               "dissipates, so that it would snap back; take smaller cells or a larger fracture_energy"
                             : "at its shear strength a band this wide holds more elastic energy than its crack "
                               "dissipates as it slides, so that it would snap back; take smaller cells or a larger "
                               "shear_fracture_energy",
            largest};
  }

  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus E, of the logarithmic strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio nu, of the logarithmic strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(tensile_strength, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "ft: largest principal stress (Kirchhoff) at which the crack begins, across it"),
      MPM_NUMBER_PARAMETER(fracture_energy, "J/m^2", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Gc: energy that a crack of unit area dissipates as it opens"),
      MPM_CHOICE_PARAMETER(softening, "linear|exponential|bilinear", 0, "how the tension falls as the crack opens"),
      MPM_NUMBER_PARAMETER(shear_strength, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "ts: shear stress along the crack's plane from which on it slides"),
      MPM_NUMBER_PARAMETER(shear_fracture_energy, "J/m^2", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Gs: energy that a crack of unit area dissipates as it slides"),
      MPM_CHOICE_PARAMETER(shear_softening, "linear|exponential|bilinear", 0,
                           "how the shear stress falls as the crack slides"),
      MPM_NUMBER_PARAMETER(band_cells, "", 1.0, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "width of the band in which a crack localises, in cells"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
      {"crack_normal", "",
       "unit normal of the crack in the undeformed body; zero without one, and in 2-D of one along z", MPM_STATE_VECTOR,
       MPM_INITIAL_ZERO},
      {"opening_strain", "", "largest strain across the crack so far, as of uniaxial tension; 0 where there is none",
       MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
      {"sliding_strain", "", "largest shear strain along the crack so far; 0 below the onset", MPM_STATE_SCALAR,
       MPM_INITIAL_ZERO},
      {"damage", "", "share of the stiffness across the crack that is lost, 0 to 1", MPM_STATE_SCALAR,
       MPM_INITIAL_ZERO},
      {"shear_damage", "", "share of the stiffness along the crack that is lost, 0 to 1", MPM_STATE_SCALAR,
       MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm

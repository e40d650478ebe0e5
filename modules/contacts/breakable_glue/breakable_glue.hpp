#pragma once
// A layer of glue without thickness: springs as of an imperfect interface that let go for good within an ellipse of
// strengths. Springs: Nairn, CMES 92 (2013) 271-299; the ellipse with brittle release: the same paper on adhesion.

#include "kernel/springs.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct BreakableGlue {
  struct Parameters {
    double tension_stiffness;      ///< traction per opening, Pa/m
    double compression_stiffness;  ///< pressure per closing, Pa/m
    double shear_stiffness;        ///< traction per slip, Pa/m
    double normal_strength;        ///< tension that alone breaks it, Pa
    double shear_strength;         ///< shear traction that alone breaks it, Pa
    double friction;               ///< kinetic and static coefficient once it is broken
    double reach;                  ///< separation at the start up to which bodies are glued, cells
  };
  /// Places of what particles keep.
  static constexpr int glued = 0, broken = 1;

  /// How far the pair has moved from where it was glued, and what that loads and stores.
  template <int D, class S>
  struct Loading {
    S opening;         ///< m
    S squared;         ///< square of the traction over the strength in its direction: 1 is where the glue breaks
    S energy;          ///< of tension and shear, J
    S closing_energy;  ///< of compression, J

    MPM_HD Loading(const Parameters& p, const ContactPair<D, S>& pair) : opening(real<S>(0)) {
      const scalar_of<S> zero = 0, half = real<S>(0.5);
      for (int i = 0; i < D; ++i) opening = opening + pair.displacement[i] * pair.normal[i];
      const S apart = max(opening, S(zero)), into = min(opening, S(zero));
      const S tension = real<S>(p.tension_stiffness / p.normal_strength) * apart;
      squared = tension * tension;
      energy = real<S>(p.tension_stiffness) * apart * apart;
      for (int i = 0; i < D; ++i) {
        const S slip = pair.displacement[i] - opening * pair.normal[i];
        const S shear = real<S>(p.shear_stiffness / p.shear_strength) * slip;
        squared = squared + shear * shear;
        energy = energy + real<S>(p.shear_stiffness) * slip * slip;
      }
      energy = half * pair.area * energy;
      closing_energy = half * pair.area * real<S>(p.compression_stiffness) * into * into;
    }
  };

  /// Glue holds where both bodies were glued at the start and less than half of that has broken around the node, which rows
  /// of nodes that open unlike decide together; a node alone lets go at twice its strength. Elsewhere the pair meets as with
  /// friction. What the step before has broken is given up now, as the energy at which glue breaks in this direction.
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const scalar_of<S> zero = 0, one = 1, half = real<S>(0.5), tiny = real<S>(1e-12);
    const RelativeMotion<D, S> motion(pair);
    const Loading<D, S> loading(p, pair);
    const S near = select(pair.separation <= real<S>(p.reach) * pair.cell_size, S(one), S(zero));
    const S kept = min(pair.state_a[glued], pair.state_b[glued]);
    const S bonded = pair.first_step ? near : select(kept < half, S(zero), S(one));
    const S lost = min(pair.state_a[broken], pair.state_b[broken]);
    const S whole = select(lost < half, bonded, S(zero));
    const auto holds = select(loading.squared < real<S>(4), whole, S(zero)) > half;

    ContactResult<D, S> free;
    const scalar_of<S> friction = real<S>(p.friction);
    const S speed = sqrt(motion.slide_squared);
    const auto sticks = speed <= friction * motion.approach;
    const S share = select(sticks, S(one), friction * motion.approach / max(speed, S(real<S>(1e-30))));
    strike(pair, motion, presses(pair, motion), share, sticks, free);

    const S halfway = loading.opening - half * pair.dt * motion.approach;
    const S normal_stiffness =
        select(halfway > zero, S(real<S>(p.tension_stiffness)), S(real<S>(p.compression_stiffness)));
    pull(pair, motion, normal_stiffness, S(real<S>(p.shear_stiffness)), result);

    const S lost_before =
        min(pair.state_a[broken] - pair.gained_a[broken], pair.state_b[broken] - pair.gained_b[broken]);
    const S gained = pair.after_forces ? max(lost - lost_before, S(zero)) : S(zero);
    const S at_breaking = select(loading.squared > tiny, loading.energy / max(loading.squared, S(tiny)), S(zero)) +
                          loading.closing_energy;
    const S released = bonded * gained * at_breaking;
    for (int i = 0; i < D; ++i) result.impulse[i] = select(holds, result.impulse[i], free.impulse[i]);
    result.status = select(holds, result.status, free.status);
    result.stored = select(holds, result.stored, S(zero)) - released;
    result.dissipated = select(holds, S(zero), free.dissipated) + released;
    result.reached[glued] = pair.first_step ? near : S(zero);
    result.reached[broken] = select(loading.squared < one, S(zero), bonded);
  }

#if MPM_HOST
  /// At twelve over the density and the cell size, the area over the reduced mass is that of a node more than a cell from
  /// the face, where it has a thirtieth of the area: with k dt^2 times that below 1 no spring gives way to a weld, which
  /// would hold whatever its strength.
  static double step_limit(const Parameters& p, double density, double cell_size) {
    const double stiffest = max(p.tension_stiffness, max(p.compression_stiffness, p.shear_stiffness));
    return sqrt(density * cell_size / (12 * stiffest));
  }

  static constexpr unsigned traits = MPM_PULLS | MPM_COMPLIANT | MPM_ACTS_OVER_TIME;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(tension_stiffness, "Pa/m", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "traction per distance by which the bodies have moved apart"),
      MPM_NUMBER_PARAMETER(compression_stiffness, "Pa/m", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "pressure per distance by which they have moved into one another"),
      MPM_NUMBER_PARAMETER(shear_stiffness, "Pa/m", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "traction across the normal per distance by which one has slid along the other"),
      MPM_NUMBER_PARAMETER(normal_strength, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "tension that alone breaks the glue"),
      MPM_NUMBER_PARAMETER(shear_strength, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "shear traction that alone breaks the glue"),
      MPM_NUMBER_PARAMETER(friction, "", 0.0, 0.0, unbounded, 0, "coefficient of friction once it is broken"),
      MPM_NUMBER_PARAMETER(reach, "", 0.5, 0.0, 1.0, 0, "separation at the start up to which bodies are glued, cells"),
  };
  static constexpr mpm_state state[] = {
      {"glued", "", "share of a particle's surroundings that were glued at the start", MPM_STATE_SCALAR,
       MPM_INITIAL_ZERO},
      {"broken", "", "share of a particle's glue that has broken", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm

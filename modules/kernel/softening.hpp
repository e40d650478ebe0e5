#pragma once
// How a crack loses its strength as it opens: the softening laws that materials with scalar damage share, and
// their scaling by the width of the band in which strain localises (Bazant & Oh, Mater. Struct. 16 (1983) 155), so that the
// energy of a crack of unit area is the fracture energy Gc whatever that width.
//
// A law is the stress f(w) of a crack that has opened by w, with the area Gc below it. A band of width b holds the strain
// kappa = sigma/E + w/b under the stress sigma = f(w) of uniaxial tension.
//
// Materials measure y = kappa - k sigma/E instead of kappa, and their stress is sigma = E kappa (1 - d)/(1 - k d). Where all
// energy is degraded k is 0. Where d acts on the part of the strain that cracks alone, k = 1 - E/M, M the modulus of
// confined strain: across the crack sides pull with Poisson's ratio against what is not degraded.

#include "kernel/equation_of_state.hpp"
#include "kernel/hardening.hpp"

namespace mpm {

enum class SofteningLaw {
  linear = 0,       ///< f = ft (1 - w/wf), wf = 2 Gc/ft
  exponential = 1,  ///< sigma = ft exp(-(kappa - ft/E)/eps_s), eps_s = Gc/(b ft) - ft/(2 E)
  bilinear = 2,     ///< through (0, ft), (0.8 Gc/ft, ft/3) and (3.6 Gc/ft, 0), of concrete: Petersson (1981)
  table = 3         ///< lines through the points of a SofteningTable
};

/// f(w)/ft over w/wf along straight lines from (0, 1) to (1, 0), w/wf growing and f/ft not. wf is what makes the area Gc: Gc/ft
/// over the area below the lines.
struct SofteningTable {
  static constexpr int points = 4;  ///< between the first and the last
  double opening[points + 2] = {0, 1}, share[points + 2] = {1, 0};
  int lines = 1;

  MPM_HD SofteningTable() {}
  /// Points follow until an opening is 0.
  MPM_HD SofteningTable(const double (&openings)[points], const double (&shares)[points]) {
    int k = 0;
    for (; k < points && openings[k] > 0; ++k) opening[k + 1] = openings[k], share[k + 1] = shares[k];
    opening[k + 1] = 1, share[k + 1] = 0, lines = k + 1;
  }
  MPM_HD double area() const {
    double sum = 0;
    for (int k = 0; k < lines; ++k) sum += 0.5 * (share[k] + share[k + 1]) * (opening[k + 1] - opening[k]);
    return sum;
  }
  /// The least way over loss of a line: how gently the steepest one falls.
  MPM_HD double steepest() const {
    double least = 1;
    for (int k = 0; k < lines; ++k)
      if (share[k] > share[k + 1]) least = min(least, (opening[k + 1] - opening[k]) / (share[k] - share[k + 1]));
    return least;
  }
};

/// The largest band width, m, that a law spans without snapping back: a wider one holds more elastic energy at its strength
/// than its crack dissipates (or, for the first line of `bilinear` and each of a table, than it dissipates at that slope).
MPM_HD double widest_band(SofteningLaw law, double youngs_modulus, double strength, double fracture_energy,
                          const SofteningTable& table = {}) {
  const double factor = law == SofteningLaw::bilinear ? 1.2
                        : law == SofteningLaw::table  ? table.steepest() / table.area()
                                                      : 2;
  return factor * youngs_modulus * fracture_energy / (strength * strength);
}

/// A law on a band of one width, in precision T: strains and moduli, no lengths.
template <class T>
struct BandSoftening {
  T young, strength, onset;     ///< E and ft, Pa; ft/E
  T coupling;                   ///< k
  T first_slope, second_slope;  ///< -dsigma/dkappa of the two lines, Pa; both the same for `linear`
  T second_start;               ///< stress of the second line, continued to kappa = 0, Pa
  T decay;                      ///< eps_s of `exponential`
  bool is_exponential, is_table;
  static constexpr int most_lines = SofteningTable::points + 1;
  TableHardening<T, most_lines> curve;         ///< of a table: sigma over kappa
  TableHardening<T, most_lines + 1> inverted;  ///< and kappa over y, the last line without an end

  MPM_HD BandSoftening(SofteningLaw law, double E, double ft, double Gc, double width, double k,
                       const SofteningTable& table = {})
      : young(T(E)),
        strength(T(ft)),
        onset(T(ft / E)),
        coupling(T(k)),
        first_slope(T(0)),
        second_slope(T(0)),
        second_start(T(0)),
        decay(T(1)),
        is_exponential(law == SofteningLaw::exponential),
        is_table(law == SofteningLaw::table),
        curve{},
        inverted{} {
    const double opening = Gc / (ft * width);  // a strain
    if (is_table) {
      draw(table, E, ft, opening / table.area(), k);
    } else if (is_exponential) {
      decay = T(opening - 0.5 * ft / E);
    } else if (law == SofteningLaw::linear) {
      first_slope = second_slope = T(ft / (2 * opening - ft / E));
      second_start = T(ft * 2 * opening / (2 * opening - ft / E));
    } else {
      const double kink = ft / (3 * E) + 0.8 * opening, end = 3.6 * opening;
      first_slope = T(2 * ft / 3 / (kink - ft / E));
      second_slope = T(ft / 3 / (end - kink));
      second_start = T(ft / 3 * end / (end - kink));
    }
  }

  /// The lines of a table in sigma and kappa, where a crack that is open all the way has the strain `end`.
  MPM_HD void draw(const SofteningTable& table, double E, double ft, double end, double k) {
    double strain[most_lines + 2], stress[most_lines + 2], measure[most_lines + 2];
    for (int i = 0; i <= table.lines; ++i) {
      stress[i] = ft * table.share[i];
      strain[i] = stress[i] / E + end * table.opening[i];
      measure[i] = strain[i] - k * stress[i] / E;
    }
    curve = lines_through<T, most_lines>(strain, stress, table.lines);
    const double far = 1e6 * (1 + end);  // no strain is larger
    strain[table.lines + 1] = strain[table.lines] + far, measure[table.lines + 1] = measure[table.lines] + far;
    inverted = lines_through<T, most_lines + 1>(measure, strain, table.lines + 1);
  }

  /// Stress of the first line, continued to kappa = 0, Pa.
  MPM_HD T first_start() const { return strength + first_slope * onset; }

  /// sigma(kappa) for kappa from the onset on, Pa.
  template <class S>
  MPM_HD S stress(const S& kappa) const {
    if (is_exponential) return strength * exp((onset - kappa) / decay);
    if (is_table) return max(curve.yield_stress(kappa), S(real<S>(0)));
    const S first = first_start() - first_slope * kappa, second = second_start - second_slope * kappa;
    return max(max(first, second), S(real<S>(0)));
  }

  /// y at the onset.
  MPM_HD T first_measure() const { return (T(1) - coupling) * onset; }

  /// kappa of y: the onset up to there, so that nothing is damaged by rounding. Lines have an inverse. The exponential needs Newton's method: y(kappa) grows and bends
  /// downwards, so that from kappa = y, which is too little, no step goes too far.
  template <class S>
  MPM_HD S strain_of(const S& measure) const {
    return select(measure > first_measure(), max(inverse(measure), S(onset)), S(onset));
  }
  template <class S>
  MPM_HD S inverse(const S& measure) const {
    const T share = coupling / young;
    if (is_table) return inverted.yield_stress(measure);
    if (is_exponential) {
      constexpr int iterations = 12;
      S kappa = max(measure, S(onset));
      for (int k = 0; k < iterations; ++k) {
        const S held = share * stress(kappa);
        kappa = kappa + (measure + held - kappa) / (real<S>(1) + held / decay);
      }
      return kappa;
    }
    const S first = (measure + share * first_start()) / (T(1) + share * first_slope),
            second = (measure + share * second_start) / (T(1) + share * second_slope);
    return max(max(first, second), measure);
  }

  /// d, with (1 - d)/(1 - k d) = sigma/(E kappa): 0 up to the onset, 1 where nothing is left.
  template <class S>
  MPM_HD S damage(const S& kappa) const {
    const S above = max(kappa, S(onset)), left = stress(above) / (young * above);
    return select(kappa > onset, max((real<S>(1) - left) / (real<S>(1) - coupling * left), S(real<S>(0))),
                  S(real<S>(0)));
  }

  /// The energy dissipated, J/m^3, while kappa grows from `before` to `after`, both from the onset on: what the area
  /// below sigma(kappa) gains beyond sigma kappa/2, which comes back. It has a closed form, so that it is exact however long the steps are: half of a line's
  /// start times the growth along it, and of sigma exponential -(eps_s sigma + sigma kappa/2).
  template <class S>
  MPM_HD S dissipated(const S& before, const S& after) const {
    const S half = S(real<S>(0.5)), zero = S(real<S>(0));
    if (is_exponential) {
      const S start = stress(before), growth = after - before;
      const S lost = -exponential_change(-growth / decay);  // of sigma, as a share
      return max(start * (lost * (S(decay) + half * after) - half * growth), zero);
    }
    if (is_table) {
      S sum = zero, height = S(strength);  // of the stress at the start of each line
      for (int k = 0; k < most_lines; ++k) {
        const S start = S(curve.start[k]), end = S(curve.start[k] + curve.width[k]);
        sum = sum + (height - curve.modulus[k] * start) * max(min(after, end) - max(before, start), zero);
        height = height + curve.modulus[k] * curve.width[k];
      }
      return half * sum;
    }
    // Where the lines meet and where the second ends; one line alone has its kink at its end.
    const T end = second_start / second_slope;
    const T difference = first_slope - second_slope;
    const T kink = difference > T(0) ? (first_start() - second_start) / difference : end;
    const S along_first = max(min(after, S(kink)) - min(before, S(kink)), zero);
    const S along_second = max(min(max(after, S(kink)), S(end)) - min(max(before, S(kink)), S(end)), zero);
    return half * (first_start() * along_first + second_start * along_second);
  }
};

}  // namespace mpm

#pragma once
// Clay: Hencky elasticity and the ellipse of modified Cam-Clay, whose size follows the plastic volume. Finite strain and
// hardening: Borja & Tamagnini, Comput. Methods Appl. Mech. Engrg. 155 (1998) 73, but with constant elastic
// moduli, so that clay at rest carries no stress. Ellipse with cohesion: Gaume, Gast, Teran, van Herwijnen & Jiang, Nat.
// Commun. 9 (2018) 3047.
//
//   a q^2 + M^2 (p + beta p_c)(p - p_c) <= 0,   a = 1 + 2 beta,   p pressure, q = sqrt(3/2)|dev tau|
//   p_c = p_c0 exp(xi e),   e = -ln J_p,   with the slope dp_c/de held below the steepest that `Hardening` explains
// Flow is associated. One step from a trial (p', q') and plastic compaction e' compacts by x:
//   p = p' - K x,   p_c = p_c(e' + x),   q = q' N/(N + 6 mu a x/K),   N = M^2 (2 p - (1 - beta) p_c)/K
// so that x is the only unknown, and the ellipse its equation. All below is in units of K.

#include "kernel/functor.hpp"
#include "kernel/hencky.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct CamClay : HenckySolid {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, preconsolidation_pressure, critical_state_slope, hardening,
        cohesion_ratio;
  };

  /// p_c/K by the plastic compaction e: exponential up to `from`, straight beyond. Softening along a steeper slope than
  /// elastic unloading can follow would make the stress jump (the plastic multiplier's denominator vanishes). On the dry
  /// side, with u = -(2 p - (1 - beta) p_c)/((1 + beta) p_c) from 0 at the critical state to 1 in tension, that slope is
  ///   h(u) = 2 (Y + (X - Y) u^2)/(M^2 u (1 + beta - (1 - beta) u)),   X = M^2,   Y = 3 mu a/K,
  /// and half the least of it is the steepest that is taken.
  template <class T>
  struct Hardening {
    T rate;      ///< xi
    T steepest;  ///< dp_c/de beyond `from`
    T at, from;  ///< p_c and e where the straight part begins
    MPM_HD Hardening(double initial, double xi, double M, double beta, double shear) {
      const double X = M * M, Y = 3 * shear * (1 + 2 * beta), sum = 1 + beta, difference = 1 - beta;
      const double root = difference * difference * Y * Y + (X - Y) * Y * sum * sum;
      const double divisor = root > 0 ? difference * Y + sqrt(root) : 0.0;
      const double u = divisor > Y * sum ? Y * sum / divisor : 1.0;
      const double slope = (Y + (X - Y) * u * u) / (X * u * (sum - difference * u));
      const bool hardens = xi > 0;
      const double limit = hardens ? slope / xi : initial;
      rate = T(xi), steepest = T(hardens ? slope : 0.0), at = T(limit);
      from = T(!hardens ? 0.0 : initial < limit ? log(limit / initial) / xi : (limit - initial) / slope);
    }

    /// The p_c at e; `slope` receives its derivative.
    template <class S>
    MPM_HD S operator()(S e, S& slope) const {
      const S past = e - from, power = at * exp(rate * min(past, S(real<S>(0))));
      slope = select(past > real<S>(0), S(steepest), rate * power);
      return power + steepest * max(past, S(real<S>(0)));
    }
  };

  template <class T>
  struct Constants {
    T mu, lambda, inverse_density, longitudinal;
    T bulk, shear;      ///< K, and mu/K
    T square, beta, a;  ///< M^2, beta, 1 + 2 beta
    T slope, root;      ///< M, sqrt(a)
    Hardening<T> hardening;
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          inverse_density(T(1 / p.density)),
          longitudinal(
              T(lame_lambda(p.youngs_modulus, p.poisson_ratio) + 2 * shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          bulk(T(bulk_modulus(p.youngs_modulus, p.poisson_ratio))),
          shear(T(ratio_of(p))),
          square(T(p.critical_state_slope * p.critical_state_slope)),
          beta(T(p.cohesion_ratio)),
          a(T(1 + 2 * p.cohesion_ratio)),
          slope(T(p.critical_state_slope)),
          root(T(sqrt(1 + 2 * p.cohesion_ratio))),
          hardening(p.preconsolidation_pressure / bulk_modulus(p.youngs_modulus, p.poisson_ratio), p.hardening,
                    p.critical_state_slope, p.cohesion_ratio, ratio_of(p)) {}
    MPM_HD static double ratio_of(const Parameters& p) {
      return shear_modulus(p.youngs_modulus, p.poisson_ratio) / bulk_modulus(p.youngs_modulus, p.poisson_ratio);
    }
  };
  template <int D, class S>
  struct State {
    Deformation<D, S> elastic_deformation_gradient;
    S plastic_volume_ratio;  ///< J_p
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// The trial of a step, in units of K. `side` is 1 where the step compacts and -1 where it dilates.
  template <class S>
  struct Trial {
    S pressure, shear, compaction, side;
  };
  /// What holds after the step has compacted (side 1) or dilated (side -1) by X >= 0.
  template <class S>
  struct Point {
    S pressure, size;  ///< p and p_c
    S flow;            ///< side N: the step still flows to its side where this is positive
    S shear;           ///< q
    S value, slope;    ///< a function of X that is positive outside of the ellipse, and its derivative
  };

  /// Evaluates the step. About the critical state q is taken from the ellipse, as N and x vanish together there, and the
  /// value compares N's; about the tips it is the flow's, as the ellipse's q has no derivative there, and the value is
  /// the distance from the centre beyond the ellipse's.
  template <class S>
  MPM_HD static Point<S> at(const Constants<scalar_of<S>>& c, const Trial<S>& t, S X) {
    using T = scalar_of<S>;
    const T one = real<S>(1), two = real<S>(2);
    const S zero = S(real<S>(0));
    Point<S> r;
    S hardening;
    r.pressure = t.pressure - t.side * X;
    r.size = c.hardening(t.compaction + t.side * X, hardening);
    r.flow = t.side * (c.square * (two * r.pressure - (one - c.beta) * r.size));
    const S flow_slope = -(c.square * (two + (one - c.beta) * hardening));
    const T resistance = real<S>(6) * c.shear * c.a;
    const S along = r.flow + resistance * X, along_slope = flow_slope + resistance;
    const S inside = (r.pressure + c.beta * r.size) * (r.size - r.pressure);
    const S inside_slope = t.side * ((r.pressure + c.beta * r.size) * (hardening + one) +
                                     (c.beta * hardening - one) * (r.size - r.pressure));

    const auto central = r.flow < real<S>(0.5) * c.square * ((one + c.beta) * r.size);
    const S height = sqrt(max(inside, zero));
    const S height_slope = inside_slope / max(two * height, S(svd::smallest_square<S>()));
    const S divisor = select(along > zero, along, S(one)), share = r.flow / divisor, flown = t.shear * share;
    const S flown_slope = t.shear * (flow_slope - share * along_slope) / divisor;
    // The distance from the centre, scaled to (1 + beta) p_c on the ellipse.
    const S wide = t.side * r.flow / c.square, wide_slope = t.side * flow_slope / c.square;
    const T stretch = real<S>(4) * c.a / c.square;
    const S distance = sqrt(stretch * flown * flown + wide * wide);
    const S distance_slope = (stretch * flown * flown_slope + wide * wide_slope) / max(distance, S(svd::tiny<S>()));
    r.shear = select(central, (c.slope / c.root) * height, flown);
    r.value = select(central, c.root * t.shear * r.flow - c.slope * height * along, distance - (one + c.beta) * r.size);
    r.slope = select(central, c.root * t.shear * flow_slope - c.slope * (height_slope * along + height * along_slope),
                     distance_slope - t.side * (one + c.beta) * hardening);
    return r;
  }

  /// X - value/slope.
  template <class S>
  MPM_HD static S newton(const Point<S>& point, S X) {
    const auto flat = abs(point.slope) <= S(svd::tiny<S>());
    return X - select(flat, S(real<S>(0)), point.value / select(flat, S(real<S>(1)), point.slope));
  }

  /// How far a step that leaves the ellipse compacts or dilates. The ellipse's centre at the start of the step bounds
  /// it; Newton's method goes on where it stays between the bounds, else they are halved, and thrice in any case. The
  /// last step of Newton is for dual numbers, which take their derivative from it.
  template <class S>
  MPM_HD static S solved(const Constants<scalar_of<S>>& c, const Trial<S>& t, S farthest) {
    constexpr int most = 30;
    const S zero = S(real<S>(0)),
            tolerance = (sizeof(scalar_of<S>) == 4 ? real<S>(1.2e-7) : real<S>(2.2e-16)) * farthest;
    S low = zero, high = farthest, X = zero;
    for (int iteration = 0; iteration < most; ++iteration) {
      const Point<S> point = at(c, t, X);
      const S value = select(point.flow > zero, point.value, S(real<S>(-1)));
      low = select(value > zero, X, low);
      high = select(value > zero, high, X);
      const S halved = real<S>(0.5) * (low + high);
      const S wanted = select(point.flow > zero, newton(point, X), halved);
      const S between = select(wanted > low, select(wanted < high, wanted, halved), halved);
      const S next = iteration % 6 == 5 && iteration < 18 ? halved : between;
      const S change = select(abs(wanted - X) <= tolerance, zero, next - X);
      X = X + change;
      if (!any(abs(change) > zero)) break;
    }
    return min(max(newton(at(c, t, X), X), zero), farthest);
  }

  /// Returns the energy dissipated, J/m^3: tau at the end of the step times the change of elastic strain by the return.
  /// Hardening stores nothing. A particle that does not yield keeps F_e as advanced, and J_p, to the last bit.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    const S zero = S(real<S>(0)), one = S(real<S>(1));
    const Deformation<D, S> trial = trial_of(state.elastic_deformation_gradient, L, dt);
    SingularValues<D, S> parts;
    const Vec<3, S> strain = strains(trial, parts);
    const S trace = sum(strain), mean = trace * real<S>(1.0 / 3.0);
    Vec<3, S> deviator;
    for (int i = 0; i < 3; ++i) deviator[i] = strain[i] - mean;
    Trial<S> t;
    t.pressure = -trace;
    t.shear = (real<S>(2.4494897427831781) * c.shear) * sqrt(dot(deviator, deviator));  // sqrt(3/2) 2 mu/K |dev eps|
    t.compaction = -log(state.plastic_volume_ratio);
    S slope;
    const S size = c.hardening(t.compaction, slope);
    const auto yields =
        c.a * t.shear * t.shear + c.square * ((t.pressure + c.beta * size) * (t.pressure - size)) > real<S>(0);
    if (!any(yields)) {
      state.elastic_deformation_gradient = trial;
      return zero;
    }
    const S centre = real<S>(0.5) * ((real<S>(1) - c.beta) * size), off = t.pressure - centre;
    t.side = select(off < zero, -one, one);
    const S X = solved(c, t, select(yields, abs(off), zero));
    const Point<S> end = at(c, t, X);

    const S shear = max(min(end.shear, t.shear), zero), kept = shear / max(t.shear, S(svd::tiny<S>()));
    // Clay that has lost its strength has an ellipse smaller than rounding: there the pressure is held in it.
    const S pressure = min(max(end.pressure, -(c.beta * end.size)), end.size);
    const S compacted = t.pressure - pressure, after_mean = mean + compacted * real<S>(1.0 / 3.0);
    Vec<3, S> after;
    for (int i = 0; i < 3; ++i) after[i] = kept * deviator[i] + after_mean;
    store(yields, stretched(parts, after), trial, state.elastic_deformation_gradient);
    // exp(-compacted), by the volumes themselves, so that J is kept whatever the rounding of the return.
    const S lost = determinant_of(trial) / determinant_of(state.elastic_deformation_gradient);
    state.plastic_volume_ratio = select(yields, state.plastic_volume_ratio * lost, state.plastic_volume_ratio);
    const S heat = shear * (t.shear - shear) / (real<S>(3) * c.shear) + pressure * compacted;
    return select(yields, c.bulk * heat, zero);
  }

  /// The total J = J_e J_p.
  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return determinant_of(state.elastic_deformation_gradient) * state.plastic_volume_ratio;
  }
  template <class S>
  MPM_HD static S determinant_of(const Deformation<2, S>& F) {
    return determinant(F);
  }
  template <class S>
  MPM_HD static S determinant_of(const Deformation<3, S>& F) {
    return determinant(F.plane);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_PLASTIC_WORK;
  static constexpr bool projects = true;  ///< an update without strain returns what is beyond the yield surface
  static constexpr mpm_clamp clamps[] = {
      {"below J_p =", "",
       "p_c grows along a straight line and no longer exponentially, so that clay that softens does not jump; take a "
       "smaller hardening, or a larger Young's modulus"},
  };
  static void clamp_bounds(const Parameters& p, double* bound) {
    bound[0] = p.hardening > 0 ? exp(-Constants<double>(p).hardening.from) : no_bound;
  }
  template <class AnyState>
  static unsigned acting_clamps(const double* bound, const AnyState& state) {
    return state.plastic_volume_ratio < bound[0] ? 1 : 0;
  }
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(preconsolidation_pressure, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "p_c0: pressure (Kirchhoff) at which the clay yields when it is pressed from all sides"),
      MPM_NUMBER_PARAMETER(critical_state_slope, "", 1.2, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "M: q/p at the critical state without cohesion; 6 sin phi/(3 - sin phi), 1.2 at 30 degrees"),
      MPM_NUMBER_PARAMETER(hardening, "", 10.0, 0.0, unbounded, 0,
                           "xi: p_c grows as exp(xi e) with the plastic compaction e = -ln J_p; 0 does not harden"),
      MPM_NUMBER_PARAMETER(cohesion_ratio, "", 0.0, 0.0, 1.0, 0,
                           "beta: tension strength over p_c; 0 is clay without cohesion"),
  };
  static constexpr mpm_state state[] = {
      {"elastic_deformation_gradient", "", "elastic part F_e of the deformation gradient, zz included in 2-D",
       MPM_STATE_DEFORMATION, MPM_INITIAL_IDENTITY},
      {"plastic_volume_ratio", "", "J_p, by which the volume has changed for good", MPM_STATE_SCALAR, MPM_INITIAL_ONE},
  };
#endif
};

}  // namespace mpm

#pragma once
// Soil and rock: Hencky elasticity and the perfectly plastic Mohr-Coulomb pyramid, with a dilation angle of its own. The
// return to a face, an edge or the apex is exact and has no iteration: de Souza Neto, Peric & Owen (2008), Computational
// Methods for Plasticity, sec. 8.2 (faces and their flow); Clausen, Damkilde & Andersen, Int. J. Numer. Methods Engrg. 66
// (2006) 1795 (the return to a line), here with regions told apart by the order of the returned stresses.
//
// Principal stresses t1 >= t2 >= t3 (tension is positive), in units of 2 mu:
//   f = n.t - 2 k,  n = (1 + sin phi, 0, -(1 - sin phi)),  k = c cos(phi)/(2 mu);
// flow along m, which is n with the dilation angle psi in place of phi. With C = I + r 1 1^T, r = lambda/(2 mu), and the
// elastic trial t = C e:
//   face   t - (f/(n.C m)) C m
//   edge   p + (g.(e - C^-1 p)/(g.C^-1 l)) l, as g.m = 0 for both faces that meet there. Where t2 = t3:
//          p = (k, -k, -k), l = (1 - sin phi, 1 + sin phi, 1 + sin phi), g = l of psi. Where t1 = t2: p = (k, k, -k),
//          l = (1 - sin phi, 1 - sin phi, 1 + sin phi).
//   apex   k/sin phi, all three: where both edges are left behind, which is where t1 < t3 on them.

#include "kernel/functor.hpp"
#include "kernel/hencky.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MohrCoulomb : HenckySolid {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, friction_angle, cohesion, dilation_angle;
  };
  /// The line of stresses on which two principal ones are equal.
  template <class T>
  struct Edge {
    Vec<3, T> point, direction;  ///< p and l
    Vec<3, T> measure;           ///< g/(g.C^-1 l)
    T offset;                    ///< measure.C^-1 p
  };
  template <class T>
  struct Constants {
    T mu, lambda, inverse_density;
    T ratio, compliance;   ///< lambda/(2 mu), and nu/(1 + nu): C^-1 = I - compliance 1 1^T
    T tension, pressure;   ///< 1 + sin phi, 1 - sin phi
    T strength;            ///< 2 k
    T apex;                ///< k/sin phi; without friction there is none, and 0 stands there
    Vec<3, T> flow;        ///< C m/(n.C m)
    Edge<T> lower, upper;  ///< t2 = t3, t1 = t2
    T longitudinal;        ///< lambda + 2 mu with the most that yielding adds, see below
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          inverse_density(T(1 / p.density)),
          ratio(T(p.poisson_ratio / (1 - 2 * p.poisson_ratio))),
          compliance(T(p.poisson_ratio / (1 + p.poisson_ratio))) {
      const double sine = sin_of(p.friction_angle),
                   dilation = p.dilation_angle < p.friction_angle ? sin_of(p.dilation_angle) : sine;
      const double two_mu = 2 * shear_modulus(p.youngs_modulus, p.poisson_ratio);
      const double k = p.cohesion * sqrt(1 - sine * sine) / two_mu;
      const double r = p.poisson_ratio / (1 - 2 * p.poisson_ratio);
      tension = T(1 + sine), pressure = T(1 - sine), strength = T(2 * k);
      apex = T(sine > 0 ? k / sine : 0);
      const Vec<3, double> C_m{{1 + dilation + 2 * r * dilation, 2 * r * dilation, 2 * r * dilation - 1 + dilation}};
      const Vec<3, double> C_n{{1 + sine + 2 * r * sine, 2 * r * sine, 2 * r * sine - 1 + sine}};
      const double resistance = (1 + sine) * C_m[0] - (1 - sine) * C_m[2];
      for (int i = 0; i < 3; ++i) flow[i] = T(C_m[i] / resistance);
      // Where the flow is not associated a wave may be faster than the elastic one. With x_i = a_i n_i along the
      // principal axes for a wave along n with polarisation a, a face changes a n : C : a n by -(x.C m)(x.C n)/(n.C m),
      // which is (|C m||C n| - C m.C n)/(2 n.C m) at most.
      const double face = 0.5 * (sqrt(dot(C_m, C_m) * dot(C_n, C_n)) - dot(C_m, C_n)) / resistance;
      const double on_lower = set(lower, -1.0, k, sine, dilation, r), on_upper = set(upper, 1.0, k, sine, dilation, r);
      const double fastest = 1 + r + max(face, max(on_lower, on_upper));
      longitudinal = T(two_mu * fastest);
    }

    /// Fills in an edge, whose middle stress is that of the side `middle` (1 or -1). Returns the most that its tangent
    /// E = l g/(g.C^-1 l) of normal strains has over C: the largest eigenvalue of the symmetric part of E - C, or 0.
    MPM_HD static double set(Edge<T>& edge, double middle, double k, double sine, double dilation, double r) {
      const Vec<3, double> p{{k, middle * k, -k}}, l{{1 - sine, 1 - middle * sine, 1 + sine}};
      const Vec<3, double> g{{1 - dilation, 1 - middle * dilation, 1 + dilation}};
      const double s = r / (1 + 3 * r), inverse = 1 / (dot(g, l) - s * sum(g) * sum(l));
      edge.offset = T(inverse * (dot(g, p) - s * sum(g) * sum(p)));
      for (int i = 0; i < 3; ++i)
        edge.point[i] = T(p[i]), edge.direction[i] = T(l[i]), edge.measure[i] = T(inverse * g[i]);
      // All vectors lie in the plane of the axis of the single stress and the diagonal of the two equal ones.
      const int single = middle < 0 ? 0 : 2;
      const double root = 1.4142135623730951, l_1 = l[single], l_2 = root * l[1], g_1 = g[single], g_2 = root * g[1];
      const double a = inverse * l_1 * g_1 - r - 1, b = inverse * l_2 * g_2 - 2 * r - 1;
      const double both = 0.5 * inverse * (l_1 * g_2 + l_2 * g_1) - root * r;
      return max(0.5 * (a + b) + sqrt(0.25 * (a - b) * (a - b) + both * both), 0.0);
    }
  };
  template <int D, class S>
  using State = HenckyState<D, S>;
  template <class S>
  using AxisymmetricState = State<2, S>;

  template <class Mask, class S>
  MPM_HD static void swap_if(const Mask& swap, S& a, S& b) {
    const S kept = a;
    a = select(swap, b, a);
    b = select(swap, kept, b);
  }

  /// The stress on an edge to which a trial strain returns.
  template <class T, class S>
  MPM_HD static Vec<3, S> on_edge(const Edge<T>& edge, const Vec<3, S>& e) {
    const S along = edge.measure[0] * e[0] + edge.measure[1] * e[1] + edge.measure[2] * e[2] - edge.offset;
    return {{edge.point[0] + along * edge.direction[0], edge.point[1] + along * edge.direction[1],
             edge.point[2] + along * edge.direction[2]}};
  }

  /// The stress in units of 2 mu to which the trial returns; `e` are its strains, `t` its stresses, both descending.
  template <class S>
  MPM_HD static Vec<3, S> returned_stresses(const Constants<scalar_of<S>>& c, const Vec<3, S>& e, const Vec<3, S>& t,
                                            S overstress) {
    const Vec<3, S> lower = on_edge(c.lower, e), upper = on_edge(c.upper, e);
    const S apex = S(c.apex);
    Vec<3, S> face, r;
    for (int i = 0; i < 3; ++i) face[i] = t[i] - overstress * c.flow[i];
    for (int i = 0; i < 3; ++i) {
      const S ordered = select(face[2] > face[1], lower[i], face[i]);
      const S edge = select(face[1] > face[0], upper[i], ordered);
      r[i] = select(lower[0] < lower[2], select(upper[0] < upper[2], apex, edge), edge);
    }
    return r;
  }

  /// Returns the energy dissipated, J/m^3: tau at the end of the step times the change of elastic strain by the return.
  /// A particle that does not yield keeps F_e as advanced, to the last bit.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    const S zero = S(real<S>(0));
    state.volume_ratio = state.volume_ratio * determinant(advanced(G::identity(), L, dt));
    const Deformation<D, S> trial = trial_of(state.elastic_deformation_gradient, L, dt);
    SingularValues<D, S> parts;
    Vec<3, S> e = strains(trial, parts);
    const auto first = e[0] < e[1];
    swap_if(first, e[0], e[1]);
    const auto second = e[1] < e[2];
    swap_if(second, e[1], e[2]);
    const auto third = e[0] < e[1];
    swap_if(third, e[0], e[1]);

    Vec<3, S> t;
    const S mean = c.ratio * sum(e);
    for (int i = 0; i < 3; ++i) t[i] = e[i] + mean;
    const S overstress = c.tension * t[0] - c.pressure * t[2] - c.strength;
    const auto yields = overstress > real<S>(0);
    if (!any(yields)) {
      state.elastic_deformation_gradient = trial;
      return zero;
    }
    const Vec<3, S> r = returned_stresses(c, e, t, overstress);
    const S shrink = c.compliance * sum(r);
    Vec<3, S> after;
    S heat = zero;
    for (int i = 0; i < 3; ++i) {
      after[i] = r[i] - shrink;
      heat = heat + r[i] * (e[i] - after[i]);
    }
    swap_if(third, after[0], after[1]);
    swap_if(second, after[1], after[2]);
    swap_if(first, after[0], after[1]);
    store(yields, stretched(parts, after), trial, state.elastic_deformation_gradient);
    return select(yields, real<S>(2) * c.mu * heat, zero);
  }

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return state.volume_ratio;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_PLASTIC_WORK;
  static constexpr bool projects = true;  ///< an update without strain returns what is beyond the yield surface
  static constexpr mpm_clamp clamps[] = {
      {"above psi =", " rad", "dilation_angle counts as friction_angle, since the law would make energy"},
  };
  static void clamp_bounds(const Parameters& p, double* bound) {
    bound[0] = p.dilation_angle > p.friction_angle ? p.friction_angle : no_bound;
  }
  template <class AnyState>
  static unsigned acting_clamps(const double* bound, const AnyState&) {
    return bound[0] == bound[0] ? 1 : 0;
  }
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(friction_angle, "rad", required, 0.0, 1.5707963267948966, MPM_BELOW_MAXIMUM,
                           "angle of internal friction phi; 0 is Tresca's law; write degrees as \"30 deg\""),
      MPM_NUMBER_PARAMETER(cohesion, "Pa", 0.0, 0.0, unbounded, 0,
                           "cohesion c (Kirchhoff): shear strength at no normal stress"),
      MPM_NUMBER_PARAMETER(
          dilation_angle, "rad", 0.0, 0.0, 1.5707963267948966, MPM_BELOW_MAXIMUM,
          "angle of dilation psi; 0 shears at constant volume; above friction_angle it counts as that"),
  };
  static constexpr mpm_state state[] = {
      {"elastic_deformation_gradient", "", "elastic part F_e of the deformation gradient, zz included in 2-D",
       MPM_STATE_DEFORMATION, MPM_INITIAL_IDENTITY},
      {"volume_ratio", "", "total J = det F", MPM_STATE_SCALAR, MPM_INITIAL_ONE},
  };
#endif
};

}  // namespace mpm

#pragma once
// The normal of the plane across which a logistic curve fits the labels -1 and +1 of two bodies' particles near a node
// best. Nairn, Hammerquist & Smith, Comput. Methods Appl. Mech. Engrg. 362 (2020) 112859.

#include "kernel/direction.hpp"
#include "kernel/linear_system.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct LogisticRegression {
  struct Parameters {
    double penalty;  ///< cells^2, beside the weights of the particles
  };

  /// A plane: slope along the axes, 1/cell, then the offset.
  template <int D>
  using Plane = Vec<D + 1, double>;
  MPM_HD static constexpr int first_of_row(int row) { return 1 + row * (row + 3) / 2; }
  /// The sums of one plane: what is minimized, then for each row half its negative gradient and half the second derivative up
  /// to the diagonal.
  template <int D>
  struct Sums {
    static constexpr int rows = D + 1, count = first_of_row(rows);
    double values[count] = {};

    MPM_HD double cost() const { return values[0]; }
    MPM_HD void add_penalty(double penalty, const Plane<D>& plane) {
      for (int i = 0; i < D; ++i) {
        values[0] += penalty * plane[i] * plane[i];
        values[first_of_row(i)] -= penalty * plane[i];
        values[first_of_row(i) + 1 + i] += penalty;
      }
    }
    /// Finds Newton's step; false where the matrix is not positive definite.
    MPM_HD bool find_step(double (&step)[rows]) const {
      double m[rows][rows];
      for (int i = 0; i < rows; ++i) {
        step[i] = values[first_of_row(i)];
        for (int j = 0; j < rows; ++j) m[i][j] = values[j <= i ? first_of_row(i) + 1 + j : first_of_row(j) + 1 + i];
      }
      return solve_symmetric(m, step);
    }
  };
  /// What a matrix has of the curvature f'' = -f f': all of it, as Newton's has, or of each particle what is not negative,
  /// with which every step goes down. Of particles on their own body's side that is all as well.
  enum class Curvature { whole, not_negative };

  /// What a particle adds to the sums: w (c - f)^2 with f = 2 / (1 + exp(-z)) - 1, z = b + s . x.
  template <int D>
  struct Terms {
    Plane<D> plane;
    double label;
    Curvature curvature;

    template <class S>
    MPM_HD void operator()(const Vec<3, S>& place, const S& weight, S* values) const {
      S z = S(plane[D]);
      for (int i = 0; i < D; ++i) z = z + plane[i] * place[i];
      const S f = 2.0 / (1.0 + exp(-z)) - 1.0, slope = 0.5 * (1.0 - f * f), error = label - f;
      const S bend = error * f * slope, kept = curvature == Curvature::whole ? bend : max(bend, S(0.0));
      const S pull = weight * error * slope, second = weight * (slope * slope + kept);
      values[0] = weight * error * error;
      for (int i = 0; i <= D; ++i) {
        S* const row = values + first_of_row(i);
        const S along = i < D ? second * place[i] : second;
        row[0] = i < D ? pull * place[i] : pull;
        for (int j = 0; j <= i; ++j) row[1 + j] = j < D ? along * place[j] : along;
      }
    }
  };
  template <int D, class Points>
  MPM_HD static Sums<D> sums_of(double penalty, const Points& points, const Plane<D>& plane, Curvature curvature) {
    Sums<D> sums;
    points.a.add(Terms<D>{plane, -1, curvature}, sums.values);
    points.b.add(Terms<D>{plane, 1, curvature}, sums.values);
    sums.add_penalty(penalty, plane);
    return sums;
  }

  template <int D>
  MPM_HD static Plane<D> moved(Plane<D> plane, const double (&by)[D + 1], double share) {
    for (int i = 0; i <= D; ++i) plane[i] += share * by[i];
    return plane;
  }
  /// Whether a step leads to no larger a sum, to rounding.
  MPM_HD static bool goes_down(double to, double from) {
    constexpr double rounding = 1e-12;
    return to <= from * (1 + rounding);
  }
  template <int D>
  MPM_HD static Vec<D, double> slope_of(const Plane<D>& plane) {
    Vec<D, double> slope;
    for (int i = 0; i < D; ++i) slope[i] = plane[i];
    return slope;
  }

  /// Newton's steps, each halved until it goes down, until it hardly goes down and the normal hardly turns. The first, from
  /// the plane z = 0, where f has the slope 1/2, is linear regression. Where a plane parts the bodies the slope has a long
  /// way to grow, and all but the particles next to the plane have their whole error behind them: the penalty begins high
  /// and falls with each step, so that a step finds the plane next to the one before; it falls faster where the normal does
  /// not turn. Returns false where one body has no weight.
  template <int D, class Points>
  MPM_HD static bool fit(const Parameters& p, const Points& points, Plane<D>& plane) {
    constexpr int most_sums = 200;
    constexpr double little = 1e-5, least_share = 1e-6, first_penalty = 1, kept = 0.4, kept_at_rest = 0.01;
    plane = {};
    double penalty = max(first_penalty, p.penalty), share = 1, step[D + 1];
    Sums<D> sums = sums_of<D>(penalty, points, plane, Curvature::not_negative);
    Vec<D, double> direction{};
    // At the plane z = 0 these are the sums of w c and of w: they are as large where one body has no weight.
    const bool has_both = 2 * abs(sums.values[first_of_row(D)]) < sums.cost();
    if (!has_both) return false;
    if (!sums.find_step(step)) return true;
    for (int count = 1; count < most_sums && share > least_share; ++count) {
      const Plane<D> next = moved<D>(plane, step, share);
      const Sums<D> there = sums_of<D>(penalty, points, next, Curvature::not_negative);
      if (!goes_down(there.cost(), sums.cost())) {
        share *= 0.5;
        continue;
      }
      const bool is_flat = there.cost() > 0.999 * sums.cost();
      plane = next, sums = there;
      Vec<D, double> turned = slope_of<D>(plane);
      make_unit(turned);
      double change = 0;
      for (int i = 0; i < D; ++i) change = max(change, abs(turned[i] - direction[i]));
      direction = turned;
      if (penalty == p.penalty && share == 1 && change < little && is_flat) break;
      const double less = max((change < little ? kept_at_rest : kept) * penalty, p.penalty);
      sums.add_penalty(less - penalty, plane);
      penalty = less, share = 1;
      if (!sums.find_step(step)) break;
    }
    return true;
  }

  /// The plane that is fitted, and a few steps with all of the curvature where that is positive, which come to the minimum
  /// to rounding where a plane parts the bodies. There is no normal where one body's particles have no weight, or the
  /// plane's slope is what rounding makes of labels that follow no direction.
  template <int D, class Points>
  MPM_HD static bool find(const Parameters& p, const Points& points, double* normal) {
    constexpr int steps = 4;
    constexpr double least_slope = 1e-9;
    Plane<D> plane;
    if (!fit<D>(p, points, plane)) return false;
    Sums<D> sums = sums_of<D>(p.penalty, points, plane, Curvature::whole);
    double step[D + 1];
    for (int count = 0; count < steps; ++count) {
      if (!sums.find_step(step) && !sums_of<D>(p.penalty, points, plane, Curvature::not_negative).find_step(step))
        break;
      const Plane<D> next = moved<D>(plane, step, 1);
      const Sums<D> there = sums_of<D>(p.penalty, points, next, Curvature::whole);
      if (!goes_down(there.cost(), sums.cost())) break;
      plane = next, sums = there;
    }
    Vec<D, double> direction = slope_of<D>(plane);
    double square = 0;
    for (int i = 0; i < D; ++i) square += direction[i] * direction[i];
    if (!(square > least_slope * least_slope) || !(make_unit(direction) > 0)) return false;
    for (int i = 0; i < D; ++i) normal[i] = direction[i];
    return true;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_LOOKS_AT_POINTS;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(penalty, "", 1e-6, 1e-12, 1.0, 0,
                           "penalty on the squared slope, cells^2: it ends the growth of the slope where a plane "
                           "parts the bodies"),
  };
#endif
};

}  // namespace mpm

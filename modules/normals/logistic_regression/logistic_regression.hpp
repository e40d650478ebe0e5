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
  /// The sums of one plane: what is minimized, half its negative gradient and the matrix of a step.
  template <int D>
  struct Sums {
    double cost = 0, rhs[D + 1] = {}, m[D + 1][D + 1] = {};
  };

  /// What a matrix has of the curvature f'' = -f f': all of it, as Newton's has, or of each particle what is not negative,
  /// with which every step goes down. Of particles on their own body's side that is all as well.
  enum class Curvature { whole, not_negative };

  /// Adds one body's particles: w (c - f)^2 with f = 2 / (1 + exp(-z)) - 1, z = b + s . x. The matrix is half the second
  /// derivative.
  template <int D, class Cloud>
  MPM_HD static void add(const Cloud& cloud, double label, const Plane<D>& plane, Curvature curvature, Sums<D>& sums) {
    cloud.for_each([&](const Vec<3, double>& place, double weight) {
      double row[D + 1], z = plane[D];
      for (int i = 0; i < D; ++i) row[i] = place[i], z += plane[i] * row[i];
      row[D] = 1;
      const double f = 2 / (1 + exp(-z)) - 1, slope = 0.5 * (1 - f * f), error = label - f, bend = error * f * slope;
      const double second = slope * slope + (curvature == Curvature::whole ? bend : max(bend, 0.0));
      sums.cost += weight * error * error;
      for (int i = 0; i <= D; ++i) {
        sums.rhs[i] += weight * error * slope * row[i];
        for (int j = 0; j <= i; ++j) sums.m[i][j] += weight * second * row[i] * row[j];
      }
    });
  }
  template <int D, class Points>
  MPM_HD static Sums<D> sums_of(double penalty, const Points& points, const Plane<D>& plane, Curvature curvature) {
    Sums<D> sums;
    add<D>(points.a, -1, plane, curvature, sums);
    add<D>(points.b, 1, plane, curvature, sums);
    for (int i = 0; i <= D; ++i)
      for (int j = 0; j < i; ++j) sums.m[j][i] = sums.m[i][j];
    add_penalty<D>(penalty, plane, sums);
    return sums;
  }
  template <int D>
  MPM_HD static void add_penalty(double penalty, const Plane<D>& plane, Sums<D>& sums) {
    for (int i = 0; i < D; ++i) {
      sums.cost += penalty * plane[i] * plane[i];
      sums.rhs[i] -= penalty * plane[i], sums.m[i][i] += penalty;
    }
  }

  template <int D>
  MPM_HD static Plane<D> moved(Plane<D> plane, const double (&by)[D + 1]) {
    for (int i = 0; i <= D; ++i) plane[i] += by[i];
    return plane;
  }
  template <int D>
  MPM_HD static Vec<D, double> slope_of(const Plane<D>& plane) {
    Vec<D, double> slope;
    for (int i = 0; i < D; ++i) slope[i] = plane[i];
    return slope;
  }

  /// Newton's steps, damped as Levenberg does, until the normal hardly turns. The first, from the plane z = 0, where f has
  /// the slope 1/2, is linear regression. Where a plane parts the bodies the slope has a long way to grow, and all but the
  /// particles next to the plane have their whole error behind them: the penalty begins high and falls with each step, so
  /// that a step finds the plane next to the one before; it falls faster where the normal does not turn.
  template <int D, class Points>
  MPM_HD static Plane<D> fitted(const Parameters& p, const Points& points) {
    constexpr int most_rounds = 200;
    constexpr double little = 1e-5, first_damping = 1e-12, most_damping = 1e12;
    constexpr double first_penalty = 1, kept = 0.4, kept_at_rest = 0.01;
    Plane<D> plane{};
    double penalty = max(first_penalty, p.penalty);
    Sums<D> sums = sums_of<D>(penalty, points, plane, Curvature::not_negative);
    Vec<D, double> direction{};
    double damping = 0, scale = 0;
    for (int i = 0; i <= D; ++i) scale += sums.m[i][i];
    for (int round = 0; round < most_rounds && damping < most_damping; ++round) {
      Sums<D> system = sums;
      for (int i = 0; i <= D; ++i) system.m[i][i] += damping * scale;
      const bool solved = solve_symmetric(system.m, system.rhs);
      const Plane<D> next = solved ? moved<D>(plane, system.rhs) : plane;
      const Sums<D> there = sums_of<D>(penalty, points, next, Curvature::not_negative);
      if (!(there.cost < sums.cost)) {
        damping = max(10 * damping, first_damping);
        continue;
      }
      plane = next, sums = there, damping *= 0.1;
      Vec<D, double> turned = slope_of<D>(plane);
      make_unit(turned);
      double change = 0;
      for (int i = 0; i < D; ++i) change = max(change, abs(turned[i] - direction[i]));
      direction = turned;
      if (penalty == p.penalty && change < little) break;
      const double less = max((change < little ? kept_at_rest : kept) * penalty, p.penalty);
      add_penalty<D>(less - penalty, plane, sums);
      penalty = less;
    }
    return plane;
  }

  /// The plane that is fitted, and a few steps with all of the curvature, which leave nothing of how it was come to.
  template <int D, class Points>
  MPM_HD static bool find(const Parameters& p, const Points& points, double* normal) {
    constexpr int steps = 4;
    constexpr double rounding = 1e-12;
    Plane<D> plane = fitted<D>(p, points);
    Sums<D> sums = sums_of<D>(p.penalty, points, plane, Curvature::whole);
    for (int step = 0; step < steps; ++step) {
      Sums<D> system = sums;
      if (!solve_symmetric(system.m, system.rhs)) break;  // no minimum is near
      const Plane<D> next = moved<D>(plane, system.rhs);
      const Sums<D> there = sums_of<D>(p.penalty, points, next, Curvature::whole);
      if (!(there.cost <= sums.cost * (1 + rounding))) break;
      plane = next, sums = there;
    }
    Vec<D, double> direction = slope_of<D>(plane);
    if (!(make_unit(direction) > 0)) return false;
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

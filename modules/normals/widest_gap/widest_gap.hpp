#pragma once
// The normal across the widest gap between two bodies' particles near a node: it joins the nearest points of their convex
// hulls, which a body's edge does not tilt as it tilts a gradient. The nearest points by Gilbert, Johnson & Keerthi, IEEE
// J. Robot. Autom. 4 (1988) 193-203; that no plane has a wider gap by Cortes & Vapnik, Mach. Learn. 20 (1995) 273-297.

#include "kernel/linear_system.hpp"
#include "kernel/tensor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct WidestGap {
  struct Parameters {};

  using Place = Vec<3, double>;

  MPM_HD static double dot(const Place& u, const Place& v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }
  MPM_HD static Place difference(const Place& u, const Place& v) { return {u[0] - v[0], u[1] - v[1], u[2] - v[2]}; }
  MPM_HD static bool same(const Place& u, const Place& v) { return u[0] == v[0] && u[1] == v[1] && u[2] == v[2]; }

  static constexpr int most_corners = 4;  // of a simplex in three dimensions

  /// A few differences of places whose convex hull holds the shortest one found so far.
  struct Simplex {
    Place corners[most_corners] = {};
    int size = 0;

    MPM_HD void add(const Place& corner) { corners[size++] = corner; }
    MPM_HD bool has(const Place& corner) const {
      for (int i = 0; i < size; ++i)
        if (same(corners[i], corner)) return true;
      return false;
    }
  };

  /// The point nearest to the origin of the affine hull of some corners, if it lies in their convex hull.
  struct Nearest {
    Place point{};
    double squared = 0;
    bool found = false;
  };
  template <int N>
  MPM_HD static Nearest nearest_of(const Place* corners) {
    Nearest nearest{corners[0], 0, false};
    if constexpr (N > 1) {
      Place edges[N - 1];
      double gram[N - 1][N - 1], share[N - 1], first = 1;
      for (int i = 0; i < N - 1; ++i) edges[i] = difference(corners[i + 1], corners[0]);
      for (int i = 0; i < N - 1; ++i) {
        share[i] = -dot(edges[i], corners[0]);
        for (int j = 0; j < N - 1; ++j) gram[i][j] = dot(edges[i], edges[j]);
      }
      if (!solve_symmetric(gram, share)) return nearest;
      for (int i = 0; i < N - 1; ++i) {
        if (share[i] < 0) return nearest;
        first -= share[i];
        for (int c = 0; c < 3; ++c) nearest.point[c] += share[i] * edges[i][c];
      }
      if (first < 0) return nearest;
    }
    nearest.squared = dot(nearest.point, nearest.point);
    nearest.found = true;
    return nearest;
  }
  MPM_HD static Nearest nearest_of(const Simplex& simplex) {
    if (simplex.size == 1) return nearest_of<1>(simplex.corners);
    if (simplex.size == 2) return nearest_of<2>(simplex.corners);
    return simplex.size == 3 ? nearest_of<3>(simplex.corners) : nearest_of<4>(simplex.corners);
  }

  /// The point of a simplex nearest to the origin; the simplex keeps the corners that it lies between.
  MPM_HD static Nearest reduce(Simplex& simplex) {
    Nearest best;
    Simplex kept;
    for (int chosen = 1; chosen < 1 << simplex.size; ++chosen) {
      Simplex some;
      for (int i = 0; i < simplex.size; ++i)
        if (chosen >> i & 1) some.add(simplex.corners[i]);
      const Nearest nearest = nearest_of(some);
      if (nearest.found && (!best.found || nearest.squared < best.squared)) best = nearest, kept = some;
    }
    simplex = kept;
    return best;
  }

  template <int D, class Points>
  MPM_HD static bool find(const Parameters&, const Points& points, double* normal) {
    constexpr int most_rounds = 100;
    constexpr double rounding = 1e-12;  // of the squared distance
    const auto farthest_apart = [&](const Place& along) {
      return difference(points.b.farthest(difference({}, along)), points.a.farthest(along));
    };
    Simplex simplex;
    simplex.add(farthest_apart(difference(points.b.middle(), points.a.middle())));
    Nearest nearest{simplex.corners[0], dot(simplex.corners[0], simplex.corners[0]), true};
    double scale = nearest.squared;
    for (int round = 0; round < most_rounds; ++round) {
      const Place next = farthest_apart(nearest.point);
      const double size = dot(next, next);
      scale = scale > size ? scale : size;
      if (nearest.squared <= rounding * scale) return false;  // the hulls meet
      if (nearest.squared - dot(nearest.point, next) <= rounding * nearest.squared || simplex.has(next)) break;
      if (simplex.size > D) return false;  // a full simplex holds the origin
      simplex.add(next);
      nearest = reduce(simplex);
      if (!nearest.found) return false;
    }
    const double gap = sqrt(nearest.squared);
    for (int c = 0; c < D; ++c) normal[c] = nearest.point[c] / gap;
    return true;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_LOOKS_AT_POINTS;
#endif
};

}  // namespace mpm

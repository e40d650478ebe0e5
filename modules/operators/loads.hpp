#pragma once
// Formulas for loads at points: what a particle that carries them gives its nodes. simulation/loads.hpp derives them.
// Vectors and tensors have the dimension D of the scene, tensors row by row.

#include "kernel/tensor.hpp"

namespace mpm {

/// What a particle carries of one load: integrals over the pieces of the surface, or of the line, that are nearest to
/// it, as the body is seeded; r0 leads from the particle there. In axisymmetric scenes they are over the whole ring, but
/// those of the normals of a follower over its section.
template <class T>
struct LoadShare {
  int load;          ///< number in Experiment::loads
  T measure;         ///< area, length or, of a point, 1
  T first[3];        ///< of r0 over the measure
  T area[3];         ///< of the normal N over the area, of pressures
  T area_moment[9];  ///< of N (x) r0 over the area
};

/// Where the middle of a share is now and where it began, m, and the integral of r = F r0 over its measure.
template <int D, class T>
struct SharePlace {
  Vec<D, T> x, X, way;

  MPM_HD SharePlace(const LoadShare<T>& share, const Vec<D, T>& particle, const Vec<D, T>& start, const Mat<D, T>& F)
      : x(particle), X(start), way{} {
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) way[i] += F(i, j) * share.first[j];
    for (int c = 0; c < D; ++c) x[c] += way[c] / share.measure, X[c] += share.first[c] / share.measure;
  }
};

/// The force of springs to the ground on the middle of a share, for each of its measure: as far as it has moved, which is
/// found from differences, so that little is lost far from the origin.
template <int D, class T>
MPM_HD Vec<D, T> spring_force(const T* stiffness, const LoadShare<T>& share, const SharePlace<D, T>& place,
                              const Vec<D, T>& particle, const Vec<D, T>& start) {
  Vec<D, T> force;
  for (int c = 0; c < D; ++c)
    force[c] = -stiffness[c] * ((particle[c] - start[c]) + (place.way[c] - share.first[c]) / share.measure);
  return force;
}
/// The same of dashpots on a particle that moves.
template <int D, class T>
MPM_HD Vec<D, T> dashpot_force(const T* damping, const Vec<D, T>& velocity) {
  Vec<D, T> force;
  for (int c = 0; c < D; ++c) force[c] = -damping[c] * velocity[c];
  return force;
}

/// What a particle gives a node: w b + S grad w.
template <int D, class T>
struct GivenByLoads {
  Vec<D, T> b{};  ///< N
  Mat<D, T> S{};  ///< N m
};

/// Adds a force over the measure of a share, which acts at all its points alike.
template <int D, class T>
MPM_HD void add_force(const LoadShare<T>& share, const SharePlace<D, T>& place, const Vec<D, T>& value,
                      GivenByLoads<D, T>& sum) {
  for (int c = 0; c < D; ++c) {
    sum.b[c] += share.measure * value[c];
    for (int j = 0; j < D; ++j) sum.S(c, j) += value[c] * place.way[j];
  }
}

/// The cofactor matrix of F: what it makes of an area vector is that of the deformed body (Nanson).
template <class T>
MPM_HD Mat<2, T> cofactor_matrix(const Mat<2, T>& F) {
  return {{F(1, 1), -F(1, 0), -F(0, 1), F(0, 0)}};
}
template <class T>
MPM_HD Mat<3, T> cofactor_matrix(const Mat<3, T>& F) {
  Mat<3, T> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      C(i, j) = F(a, c) * F(b, d) - F(a, d) * F(b, c);
    }
  return C;
}

/// Adds -p times the integrals of n and of n (x) r, over the area as it began or, of a follower, as it is now. `ring` tells
/// that the share is a follower's about an axis: a ring's area grows as its radius does, so that the integrals are over
/// the section, and each point has its own radius.
template <int D, class T>
MPM_HD void add_pressure(const LoadShare<T>& share, const SharePlace<D, T>& place, const Vec<D, T>& particle,
                         const Mat<D, T>& F, T pressure, bool follower, bool ring, GivenByLoads<D, T>& sum) {
  Vec<D, T> area{};
  Mat<D, T> turned{}, moment{};
  const Mat<D, T> C = follower ? cofactor_matrix(F) : Mat<D, T>::identity();
  for (int i = 0; i < D; ++i)
    for (int k = 0; k < D; ++k) {
      area[i] += C(i, k) * share.area[k];
      for (int j = 0; j < D; ++j) turned(i, j) += C(i, k) * share.area_moment[D * k + j];
    }
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      for (int k = 0; k < D; ++k) moment(i, j) += turned(i, k) * F(j, k);
  const T full_turn = T(6.283185307179586);
  for (int i = 0; i < D; ++i) {
    sum.b[i] -= pressure * (ring ? full_turn * (particle[0] * area[i] + moment(i, 0)) : area[i]);
    for (int j = 0; j < D; ++j) sum.S(i, j) -= pressure * (ring ? full_turn * place.x[0] : T(1)) * moment(i, j);
  }
}

}  // namespace mpm

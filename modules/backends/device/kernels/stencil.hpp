#pragma once
// A stencil has the nodes of one particle, from a shape of either form, under one interface.

#include "backends/device/kernels/arrays.hpp"

namespace mpm::device {

template <int D, class T>
struct StencilNode {
  int node[D];
  T weight;
  Vec<D, T> gradient;  ///< grad w, 1/m
  Vec<D, T> distance;  ///< d = node - particle, m
  Vec<D, T> affine;    ///< w D^-1 d, 1/m; only where Scene::affine is set
};

template <class S>
MPM_HD Mat<2, S> inverse(const Mat<2, S>& a) {
  const S d = S(1) / determinant(a);
  return {{d * a(1, 1), -d * a(0, 1), -d * a(1, 0), d * a(0, 0)}};
}
template <class S>
MPM_HD Mat<3, S> inverse(const Mat<3, S>& a) {
  const S d = S(1) / determinant(a);
  Mat<3, S> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {  // cofactors by cyclic indices
      const int i1 = (j + 1) % 3, i2 = (j + 2) % 3, j1 = (i + 1) % 3, j2 = (i + 2) % 3;
      r(i, j) = d * (a(i1, j1) * a(i2, j2) - a(i1, j2) * a(i2, j1));
    }
  return r;
}

template <int D, class T>
MPM_HD Vec<D, T> product(const Mat<D, T>& a, const Vec<D, T>& x) {
  Vec<D, T> r;
  for (int i = 0; i < D; ++i) {
    r[i] = a(i, 0) * x[0];
    for (int j = 1; j < D; ++j) r[i] = r[i] + a(i, j) * x[j];
  }
  return r;
}

/// The particle's position in cells.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD Vec<Scene::dimension, T> position_in_cells(const Arguments<T>& a, int p) {
  Vec<Scene::dimension, T> x =
      load<Scene::dimension>(a.particles.field[Scene::Particle::position], a.particles.stride, p);
  for (int c = 0; c < Scene::dimension; ++c) x[c] = (x[c] - a.lower[c]) * a.inverse_cell_size;
  return x;
}

template <class Scene, bool List>
class StencilOf;

/// A stencil that is a tensor product of weights along the axes.
template <class Scene>
class StencilOf<Scene, false> {
  using T = typename Scene::Scalar;
  using Shape = typename Scene::Shape;
  static constexpr int D = Scene::dimension, width = Scene::width;

 public:
  MPM_HD StencilOf(const Arguments<T>& a, int p) : inside_(true) {
    const auto parameters = parameters_of<Shape>(a.shape_parameters);
    const Vec<D, T> x = position_in_cells<Scene>(a, p);
    Vec<D, T> half_length{};
    if constexpr (Scene::deformed)
      half_length = Shape::template half_lengths<D, T>(
          parameters, load_matrix<D>(a.particles.field[Scene::Particle::domain], a.particles.stride, p));
    for (int c = 0; c < D; ++c) {
      T first;
      if constexpr (Scene::deformed)
        Shape::evaluate(parameters, x[c], half_length[c], first, weight_[c], gradient_[c]);
      else if constexpr (Scene::sized)
        Shape::evaluate(parameters, x[c], a.particles.half_size, first, weight_[c], gradient_[c]);
      else
        Shape::evaluate(parameters, x[c], first, weight_[c], gradient_[c]);
      // The test is false for NaN too; only then is the cast to int safe.
      const bool inside = first >= T(-a.padding[c]) && first <= T(a.cells[c] + a.padding[c] - (width - 1));
      inside_ = inside_ && inside;
      if constexpr (Scene::deformed) {  // without weight the domain has outgrown the stencil
        T sum = 0;
        for (int k = 0; k < width; ++k) sum += weight_[c][k];
        inside_ = inside_ && sum > T(0.5);
      }
      base_[c] = inside ? static_cast<int>(first) : 0;
      offset_[c] = x[c] - first;
      if constexpr (Scene::moment_per_particle) {
        T moment = 0;
        for (int k = 0; k < width; ++k) moment += weight_[c][k] * (T(k) - offset_[c]) * (T(k) - offset_[c]);
        inverse_moment_[c] = T(1) / moment;
      } else {
        inverse_moment_[c] = T(Scene::inverse_second_moment);
      }
    }
  }

  MPM_HD int base(int axis) const { return base_[axis]; }
  MPM_HD T offset(int axis) const { return offset_[axis]; }
  MPM_HD const T* weights(int axis) const { return weight_[axis]; }

  /// Whether all nodes are in the grid, the position is a number, and the stencil holds the domain.
  MPM_HD bool inside() const { return inside_; }

  /// The moment D = sum w d d^T, cells^2, which is diagonal, since sum w d = 0 along each axis.
  MPM_HD Mat<D, T> second_moment() const {
    Mat<D, T> moment{};
    for (int c = 0; c < D; ++c)
      for (int k = 0; k < width; ++k) moment(c, c) += weight_[c][k] * (T(k) - offset_[c]) * (T(k) - offset_[c]);
    return moment;
  }

  template <class Body>
  MPM_HD void for_each_node(const Arguments<T>& a, Body body) const {
    constexpr int count = D == 2 ? width * width : width * width * width;
    for (int k = 0; k < count; ++k) {
      const int at[3] = {k % width, k / width % width, k / (width * width)};
      StencilNode<D, T> s;
      s.weight = 1;
      for (int c = 0; c < D; ++c) {
        s.node[c] = base_[c] + at[c];
        s.weight *= weight_[c][at[c]];
        s.distance[c] = a.cell_size * (T(at[c]) - offset_[c]);
        s.gradient[c] = gradient_[c][at[c]] * a.inverse_cell_size;
        for (int e = 0; e < D; ++e)
          if (e != c) s.gradient[c] *= weight_[e][at[e]];
      }
      if constexpr (Scene::affine)
        for (int c = 0; c < D; ++c)
          s.affine[c] = Scene::moment_is_gradient ? s.gradient[c]
                                                  : s.weight * s.distance[c] * inverse_moment_[c] *
                                                        (a.inverse_cell_size * a.inverse_cell_size);
      body(s);
    }
  }

 private:
  bool inside_;
  int base_[D];
  T offset_[D], weight_[D][width], gradient_[D][width], inverse_moment_[D];
};

/// A stencil that is a list of nodes, made from the particle's domain.
template <class Scene>
class StencilOf<Scene, true> {
  using T = typename Scene::Scalar;
  using Shape = typename Scene::Shape;
  static constexpr int D = Scene::dimension;

 public:
  MPM_HD StencilOf(const Arguments<T>& a, int p) : inside_(true), position_(position_in_cells<Scene>(a, p)) {
    for (int c = 0; c < D; ++c)  // the test is false for NaN
      inside_ = inside_ && position_[c] >= T(-a.padding[c]) && position_[c] <= T(a.cells[c] + a.padding[c]);
    list_.count = 0;
    if (!inside_) return;
    const auto parameters = parameters_of<Shape>(a.shape_parameters);
    if constexpr (Scene::sampled) {
      Vec<D, T> corners[1 << D];
      load_corners<D>(a.particles.field[Scene::Particle::corners], a.particles.stride, p, corners);
      Shape::evaluate(parameters, position_, corners, list_);
      inside_ = list_.count > 0;
    } else {
      const Mat<D, T> domain = load_matrix<D>(a.particles.field[Scene::Particle::domain], a.particles.stride, p);
      Shape::evaluate(parameters, position_, domain, list_);
    }
    for (int k = 0; k < list_.count; ++k)
      for (int i = 0; i < D; ++i) {
        const int node = list_.node[k][i];
        inside_ = inside_ && node >= -a.padding[i] && node <= a.cells[i] + a.padding[i];
      }
    if constexpr (Scene::affine) inverse_moment_ = inverse(second_moment());
  }

  MPM_HD bool inside() const { return inside_; }

  MPM_HD Mat<D, T> second_moment() const {
    Mat<D, T> moment{};
    for (int k = 0; k < list_.count; ++k)
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j)
          moment(i, j) += list_.weight[k] * (T(list_.node[k][i]) - position_[i]) * (T(list_.node[k][j]) - position_[j]);
    return moment;
  }

  template <class Body>
  MPM_HD void for_each_node(const Arguments<T>& a, Body body) const {
    for (int k = 0; k < list_.count; ++k) {
      StencilNode<D, T> s;
      Vec<D, T> cells;
      s.weight = list_.weight[k];
      for (int c = 0; c < D; ++c) {
        s.node[c] = list_.node[k][c];
        cells[c] = T(s.node[c]) - position_[c];
        s.distance[c] = a.cell_size * cells[c];
        s.gradient[c] = list_.gradient[k][c] * a.inverse_cell_size;
      }
      if constexpr (Scene::affine) {
        s.affine = product(inverse_moment_, cells);
        for (int c = 0; c < D; ++c) s.affine[c] *= s.weight * a.inverse_cell_size;
      }
      body(s);
    }
  }

 private:
  bool inside_;
  Vec<D, T> position_;  ///< cells
  NodeList<D, T, Scene::list_capacity> list_;
  Mat<D, T> inverse_moment_;  ///< cells^-2
};

template <class Scene>
using Stencil = StencilOf<Scene, Scene::list>;

}  // namespace mpm::device

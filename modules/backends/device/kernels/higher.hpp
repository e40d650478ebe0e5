#pragma once
// Polynomials beyond affine of one particle (kernel/polynomial_basis.hpp), of shapes that are tensor products.

#include "backends/device/kernels/stencil.hpp"
#include "kernel/polynomial_basis.hpp"

namespace mpm::device {

/// Coefficients and, at each node of the stencil, the values of the polynomials. A scene without them has no use for
/// it.
template <class Scene>
class Higher {
  using T = typename Scene::Scalar;
  static constexpr int D = Scene::dimension, K = Scene::width;

 public:
  static constexpr int scalars = Scene::basis_functions * D;
  T coefficient[scalars > 0 ? scalars : 1];  ///< [function][D], m/s

  MPM_HD explicit Higher(const Stencil<Scene>& stencil) : stencil_(stencil) {
    for (int c = 0; c < D; ++c)
      make_axis_basis<K>(stencil.weights(c), 1, stencil.offset(c), Scene::basis_order, axis_[c]);
    for (int k = 0; k < scalars; ++k) coefficient[k] = T(0);
  }

  /// sum w c P at a node, component i.
  MPM_HD T given(const int* node, int i) const {
    T sum = 0;
    for_each_product<D>(Scene::basis_order, [&](int function, const int* power) {
      T value = coefficient[function * D + i];
      for (int c = 0; c < D; ++c) value *= axis_[c].given[power[c]][node[c] - stencil_.base(c)];
      sum += value;
    });
    return sum;
  }

  MPM_HD void gather(const Arguments<T>& a, const T* velocity) {
    stencil_.for_each_node(a, [&](const StencilNode<D, T>& s) {
      const int node = node_index<D>(a, s.node);
      for_each_product<D>(Scene::basis_order, [&](int function, const int* power) {
        T value = 1;
        for (int c = 0; c < D; ++c) value *= axis_[c].taken[power[c]][s.node[c] - stencil_.base(c)];
        for (int i = 0; i < D; ++i) coefficient[function * D + i] += value * velocity[i * a.node_count + node];
      });
    });
  }

  /// They lie behind the declared fields of the transfer's state.
  MPM_HD void load(const T* state, int stride, int particle) {
    for (int k = 0; k < scalars; ++k) coefficient[k] = state[(first + k) * stride + particle];
  }
  MPM_HD void store(T* state, int stride, int particle) const {
    for (int k = 0; k < scalars; ++k) state[(first + k) * stride + particle] = coefficient[k];
  }

 private:
  static constexpr int first = scalars_of<typename Scene::Transfer::template State<D, T>, T>;
  const Stencil<Scene>& stencil_;
  AxisBasis<K, T> axis_[D];
};

}  // namespace mpm::device

#pragma once
// Polynomials beyond affine of one particle (kernel/polynomial_basis.hpp), for shapes that are tensor products.

#include "backends/device/kernels/stencil.hpp"
#include "kernel/polynomial_basis.hpp"

namespace mpm::device {

/// The coefficients and, at each node of the stencil, the values of the polynomials. A scene without them has no use
/// for it.
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

  /// The sum of w c P at a node, component i.
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

  /// The sum over the polynomials of |c|^2 sum w P^2, which they add to the particle's v^2.
  MPM_HD T squares() const {
    T sum = 0;
    for_each_product<D>(Scene::basis_order, [&](int function, const int* power) {
      T norm = 1;
      for (int c = 0; c < D; ++c) norm *= axis_[c].norm[power[c]];
      for (int i = 0; i < D; ++i) sum += norm * coefficient[function * D + i] * coefficient[function * D + i];
    });
    return sum;
  }

  MPM_HD void load(const ParticleArrays<T>& particles, int p) {
    for (int k = 0; k < scalars; ++k)
      coefficient[k] = particles.field[Scene::Particle::polynomial_coefficients][k * particles.stride + p];
  }
  MPM_HD void store(const ParticleArrays<T>& particles, int p) const {
    for (int k = 0; k < scalars; ++k)
      particles.field[Scene::Particle::polynomial_coefficients][k * particles.stride + p] = coefficient[k];
  }

 private:
  const Stencil<Scene>& stencil_;
  AxisBasis<K, T> axis_[D];
};

/// Makes the particle's polynomials beyond affine where the scene has them.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD auto higher_of(const Arguments<T>& a, const Stencil<Scene>& stencil, int p) {
  if constexpr (Scene::basis_functions > 0) {
    Higher<Scene> higher(stencil);
    higher.load(a.particles, p);
    return higher;
  } else {
    return 0;
  }
}

}  // namespace mpm::device

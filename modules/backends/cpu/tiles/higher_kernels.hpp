#pragma once
// These kernels scatter and gather polynomials beyond affine (kernel/polynomial_basis.hpp) between one chunk and the
// tile of its block, axis by axis: a product's sums over a stencil are K^D + R K^2 + R^2 K terms and not R^D K^D. They
// stand beside the kernels of tile.hpp, in the same tiles, so that scenes without such polynomials run as they did.

#include "backends/cpu/tiles/tile.hpp"
#include "kernel/polynomial_basis.hpp"

namespace mpm::cpu {

/// Coefficients are [function][D][chunk_size]. `offset` is [D][chunk_size], from the stencils' first nodes.
template <int D, class T>
struct HigherKernels {
  /// Adds the coefficients times the particles' masses to the tile of a scatter.
  using Scatter = void (*)(T* tile, const Stencils<T>&, const T* offset, const T* coefficients, const T* mass,
                           int count);
  using Gather = void (*)(const T* tile, const Stencils<T>&, const T* offset, T* coefficients, int count);
  /// Sums |c|^2 sum w P^2 over all particles, each times its size where it has one.
  using Squares = double (*)(const Stencils<T>&, const T* offset, const T* coefficients, const T* size, int count);
  Scatter scatter = nullptr;
  Gather gather = nullptr;
  Squares squares = nullptr;
};

/// Makes kernels for stencils of `width` nodes an axis (2 to 4) and powers up to `order` < width; order 0 has none.
template <int D, class T>
HigherKernels<D, T> higher_kernels(int width, int order);

// ---- implementation ----------------------------------------------------------------------------------------------

template <int D, int K, class T>
struct ParticleBasis {
  AxisBasis<K, T> axis[D];
  ParticleBasis(const Stencils<T>& stencils, const T* offset, int particle, int order) {
    for (int a = 0; a < D; ++a)
      make_axis_basis<K>(stencils.weight + a * K * chunk_size<T> + particle, chunk_size<T>,
                         offset[a * chunk_size<T> + particle], order, axis[a]);
  }
};

/// The coefficients of a particle as quads by powers, zero where b and A have the power; a 2-D one has one plane.
template <int D, int R, class T>
struct PowerQuads {
  static constexpr int powers_z = D == 3 ? R : 1;
  Quad<T> of[R][R][powers_z] = {};
};

template <int D, class T, int K, int R>
void scatter_higher(T* tile, const Stencils<T>& stencils, const T* offset, const T* coefficients, const T* mass,
                    int count) {
  using Q = Quad<T>;
  using W = Row<T, K>;
  constexpr int line = first_nodes_of_tile<D> * W::scalars, Z = PowerQuads<D, R, T>::powers_z;
  for (int p = 0; p < count; ++p) {
    const ParticleBasis<D, K, T> basis(stencils, offset, p, R - 1);
    PowerQuads<D, R, T> c;
    for_each_product<D>(R - 1, [&](int function, const int* power) {
      Q& q = c.of[power[0]][power[1]][power[2]];
      for (int a = 0; a < D; ++a) q[a] = mass[p] * coefficients[(function * D + a) * chunk_size<T> + p];
    });
    T* const corner = tile + std::size_t(stencils.first[p]) * W::scalars;
    for (int i = 0; i < K; ++i) {
      Q plane[R][Z] = {};
      for (int x = 0; x < R; ++x)
        for (int y = 0; y < R; ++y)
          for (int z = 0; z < Z; ++z) plane[y][z] += basis.axis[0].given[x][i] * c.of[x][y][z];
      for (int j = 0; j < (D == 3 ? K : 1); ++j) {
        Q row[R] = {};  // it goes by powers along the last axis
        for (int y = 0; y < R; ++y)
          for (int z = 0; z < Z; ++z) {
            if constexpr (D == 3)
              row[z] += basis.axis[1].given[y][j] * plane[y][z];
            else
              row[y] = plane[y][z];
          }
        Q* const nodes = reinterpret_cast<Q*>(corner + (D == 3 ? (i * tile_side<D, K> + j) * line : i * line));
        for (int k = 0; k < K; ++k)
          for (int r = 0; r < R; ++r) nodes[k] += basis.axis[D - 1].given[r][k] * row[r];
      }
    }
  }
}

template <int D, class T, int K, int R>
void gather_higher(const T* tile, const Stencils<T>& stencils, const T* offset, T* coefficients, int count) {
  using Q = Quad<T>;
  using W = Row<T, K>;
  constexpr int line = first_nodes_of_tile<D> * W::scalars, Z = PowerQuads<D, R, T>::powers_z;
  for (int p = 0; p < count; ++p) {
    const ParticleBasis<D, K, T> basis(stencils, offset, p, R - 1);
    PowerQuads<D, R, T> c;
    const T* const corner = tile + std::size_t(stencils.first[p]) * W::scalars;
    for (int i = 0; i < K; ++i) {
      Q plane[R][Z] = {};
      for (int j = 0; j < (D == 3 ? K : 1); ++j) {
        const T* const row_of_nodes = corner + (D == 3 ? (i * tile_side<D, K> + j) * line : i * line);
        const Q* const nodes = reinterpret_cast<const Q*>(row_of_nodes);
        Q row[R] = {};
        for (int k = 0; k < K; ++k)
          for (int r = 0; r < R; ++r) row[r] += basis.axis[D - 1].taken[r][k] * nodes[k];
        for (int y = 0; y < R; ++y)
          for (int z = 0; z < Z; ++z) {
            if constexpr (D == 3)
              plane[y][z] += basis.axis[1].taken[y][j] * row[z];
            else
              plane[y][z] = row[y];
          }
      }
      for (int x = 0; x < R; ++x)
        for (int y = 0; y < R; ++y)
          for (int z = 0; z < Z; ++z) c.of[x][y][z] += basis.axis[0].taken[x][i] * plane[y][z];
    }
    for_each_product<D>(R - 1, [&](int function, const int* power) {
      for (int a = 0; a < D; ++a)
        coefficients[(function * D + a) * chunk_size<T> + p] = c.of[power[0]][power[1]][power[2]][a];
    });
  }
}

template <int D, class T, int K, int R>
double squares_of_higher(const Stencils<T>& stencils, const T* offset, const T* coefficients, const T* size,
                         int count) {
  double sum = 0;
  for (int p = 0; p < count; ++p) {
    const ParticleBasis<D, K, T> basis(stencils, offset, p, R - 1);
    for_each_product<D>(R - 1, [&](int function, const int* power) {
      T norm = T(1), squares = T(0);
      for (int a = 0; a < D; ++a) {
        const T c = coefficients[(function * D + a) * chunk_size<T> + p];
        norm *= basis.axis[a].norm[power[a]], squares += c * c;
      }
      sum += static_cast<double>(norm * squares * (size ? size[p] : T(1)));
    });
  }
  return sum;
}

template <int D, class T, int K, int R>
HigherKernels<D, T> higher_kernels_of() {
  return {&scatter_higher<D, T, K, R>, &gather_higher<D, T, K, R>, &squares_of_higher<D, T, K, R>};
}

template <int D, class T>
HigherKernels<D, T> choose_higher_kernels(int width, int order) {
  if (order == 0) return {};
  if (width == 2) return higher_kernels_of<D, T, 2, 2>();
  if (width == 3) return order == 1 ? higher_kernels_of<D, T, 3, 2>() : higher_kernels_of<D, T, 3, 3>();
  if (order == 1) return higher_kernels_of<D, T, 4, 2>();
  return order == 2 ? higher_kernels_of<D, T, 4, 3>() : higher_kernels_of<D, T, 4, 4>();
}

}  // namespace mpm::cpu

/// What instantiation.cpp.in makes of this header for every dimension and scalar.
#define MPM_INSTANTIATE_HIGHER(D, T)                               \
  template <>                                                      \
  HigherKernels<D, T> higher_kernels<D, T>(int width, int order) { \
    return choose_higher_kernels<D, T>(width, order);              \
  }

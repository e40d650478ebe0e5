#pragma once
// Rigid particle-in-cell: a particle keeps only the spin of the affine velocity field around it, the part that holds
// its angular momentum. Jiang, Schroeder, Selle, Teran & Stomakhin, ACM Trans. Graph. 34 (2015) 51, section 5.2: L =
// sum w d x m v, K = m sum w (d . d I - d d^T), omega = K^-1 L.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Rpic {
  struct Parameters {};
  template <int D, class S>
  struct State {
    Mat<D, S> spin;  ///< antisymmetric, spin d = omega x d, 1/s
  };

  /// w (b + A d) with b = m v and A = m spin, d = node - particle.
  template <int D, class S>
  MPM_HD static void scatter(const Parameters&, S mass, const Vec<D, S>& v, const State<D, S>& state, Vec<D, S>& b,
                             Mat<D, S>& A) {
    for (int i = 0; i < D; ++i) b[i] = mass * v[i];
    for (int k = 0; k < D * D; ++k) A.m[k] = mass * state.spin.m[k];
  }

  /// v <- sum w v+; the spin W has the angular momentum of the gathered field about the particle: W M + M W = C M -
  /// (C M)^T with M the second moment. Where M is a multiple of the identity, W = (C - C^T) / 2.
  template <int D, class S>
  MPM_HD static void gather(const Parameters&, const GatheredMoments<D, S>& moments, scalar_of<S>, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    v = moments.velocity;
    advection = moments.velocity;
    Mat<D, S> product;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) {
        S sum = moments.affine(i, 0) * moments.second_moment(0, j);
        for (int k = 1; k < D; ++k) sum = sum + moments.affine(i, k) * moments.second_moment(k, j);
        product(i, j) = sum;
      }
    set_spin(product, moments.second_moment, state.spin);
  }

  /// Shares of a cell's square that keep a particle on a node, whose second moment vanishes there, without a spin.
  template <class T>
  static constexpr T smallest_moment = sizeof(T) == 4 ? T(1e-12) : T(1e-30);

  template <class S>
  MPM_HD static void set_spin(const Mat<2, S>& product, const Mat<2, S>& moment, Mat<2, S>& spin) {
    const S inertia = moment(0, 0) + moment(1, 1) + smallest_moment<scalar_of<S>>;
    const S w = (product(1, 0) - product(0, 1)) / inertia;
    spin(0, 0) = spin(1, 1) = S(scalar_of<S>(0));
    spin(1, 0) = w, spin(0, 1) = -w;
  }

  /// omega = (tr(M) I - M)^-1 l, by the adjugate of a symmetric matrix.
  template <class S>
  MPM_HD static void set_spin(const Mat<3, S>& product, const Mat<3, S>& moment, Mat<3, S>& spin) {
    const S least = S(smallest_moment<scalar_of<S>>);
    const S xx = moment(1, 1) + moment(2, 2) + least, yy = moment(0, 0) + moment(2, 2) + least,
            zz = moment(0, 0) + moment(1, 1) + least;
    const S xy = -moment(0, 1), xz = -moment(0, 2), yz = -moment(1, 2);
    const S l[3] = {product(2, 1) - product(1, 2), product(0, 2) - product(2, 0), product(1, 0) - product(0, 1)};
    const S a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    const S d = xx * zz - xz * xz, e = xy * xz - xx * yz, f = xx * yy - xy * xy;
    const S inverse = scalar_of<S>(1) / (xx * a + xy * b + xz * c);
    const S x = inverse * (a * l[0] + b * l[1] + c * l[2]), y = inverse * (b * l[0] + d * l[1] + e * l[2]),
            z = inverse * (c * l[0] + e * l[1] + f * l[2]);
    for (int i = 0; i < 3; ++i) spin(i, i) = S(scalar_of<S>(0));
    spin(2, 1) = x, spin(1, 2) = -x;
    spin(0, 2) = y, spin(2, 0) = -y;
    spin(1, 0) = z, spin(0, 1) = -z;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_SCATTERS_AFFINE | MPM_GATHERS_AFFINE | MPM_AFFINE_CARRIES_ENERGY |
                                     MPM_READS_SECOND_MOMENT | MPM_KEEPS_SPIN_ONLY | MPM_REPLACES_MOTION;
  static constexpr mpm_state state[] = {
      {"spin", "1/s", "spin about the particle: the antisymmetric matrix of omega x", MPM_STATE_MATRIX,
       MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm

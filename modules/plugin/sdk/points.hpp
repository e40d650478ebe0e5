#pragma once
// The particles that a host hands over to a normal (mpm_normal_points), as clouds.

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "kernel/lanes.hpp"
#include "kernel/points.hpp"
#include "plugin/tables.hpp"

namespace mpm::sdk {

/// The particles of one body in rows of lanes.
struct CloudInLanes {
  const double *values, *weights;  ///< [3][stride], cells from the node; [stride]
  std::uint32_t count, stride;

  Vec<3, double> operator[](std::uint32_t i) const { return {values[i], values[stride + i], values[2 * stride + i]}; }

  template <class Visit>
  void for_each(Visit visit) const {
    for (std::uint32_t i = 0; i < count; ++i) visit((*this)[i], weights[i]);
  }
  template <int N, class Term>
  void add(Term term, double (&sums)[N]) const {
    using Pack = Lanes<double>;
    static_assert(MPM_LANES % Pack::width == 0);
    Pack all[N];
    for (Pack& sum : all) sum = Pack(0.0);
    for (std::uint32_t i = 0; i < stride; i += Pack::width) {
      const Vec<3, Pack> place{pack_at(values + i), pack_at(values + stride + i), pack_at(values + 2 * stride + i)};
      Pack of_these[N];
      term(place, pack_at(weights + i), of_these);
      for (int n = 0; n < N; ++n) all[n] = all[n] + of_these[n];
    }
    for (int n = 0; n < N; ++n)
      for (int lane = 0; lane < Pack::width; ++lane) sums[n] += all[n][lane];
  }
  Vec<3, double> middle() const {
    Vec<3, double> sum{};
    for (int c = 0; c < 3; ++c) {
      for (std::uint32_t i = 0; i < count; ++i) sum[c] += values[static_cast<std::size_t>(c) * stride + i];
      sum[c] /= count;
    }
    return sum;
  }
  /// Looks at all particles in lanes.
  Vec<3, double> farthest(const Vec<3, double>& along) const {
    constexpr std::uint32_t lanes = 8;
    double most[lanes], at[lanes];
    for (std::uint32_t k = 0; k < lanes; ++k) most[k] = -unbounded, at[k] = 0;
    const double *const x = values, *const y = x + stride, *const z = y + stride;
    for (std::uint32_t i = 0; i < stride; i += lanes)
      for (std::uint32_t k = 0; k < lanes; ++k) {
        const double place = along[0] * x[i + k] + along[1] * y[i + k] + along[2] * z[i + k];
        const bool farther = place > most[k];
        most[k] = farther ? place : most[k], at[k] = farther ? static_cast<double>(i + k) : at[k];
      }
    std::uint32_t best = 0;
    for (std::uint32_t k = 1; k < lanes; ++k)
      if (most[k] > most[best] || (most[k] == most[best] && at[k] < at[best])) best = k;
    return (*this)[static_cast<std::uint32_t>(at[best])];
  }

 private:
  /// The values of several particles, which need not lie as a vector does.
  static Lanes<double> pack_at(const double* of) {
    Lanes<double> pack;
    std::memcpy(&pack.v, of, sizeof pack.v);
    return pack;
  }
};

inline PointsOfPair<CloudInLanes> clouds_of(const mpm_normal_points& points) {
  return {{points.position_a, points.weight_a, points.count_a, points.stride_a},
          {points.position_b, points.weight_b, points.count_b, points.stride_b}};
}

}  // namespace mpm::sdk

#pragma once
// Scatters whose sums are the same bits in any order of lanes and teams: sums of whole numbers. A scatter has three phases.
// The first one finds the largest value that a particle gives in each channel; the second adds what particles give as
// multiples of two steps, 2^-40 and 2^-80 of the power of two above that value; the third one adds the sums to the grid.
// A value below 2^-27 of the largest one in double precision, or 2^-56 in float, loses digits; 2^23 values may meet.

#include "backends/device/kernels/active_nodes.hpp"
#include "backends/device/kernels/arrays.hpp"
#include "kernel/math.hpp"

namespace mpm::device {

/// The phases of a scatter (Arguments::exact_phase).
enum : int { exact_measure = 0, exact_add, exact_take };

/// The bits of each of the two whole numbers that one value is written in.
inline constexpr int exact_bits = 40;

/// What stands in Arguments::exponents where a channel is given nothing: any larger number.
inline constexpr int no_exponent = 1 << 20;

/// The least exponent of a channel, so that its fine step is a normal number.
inline constexpr int least_exponent = -900;

/// The coarse step of a channel: the power of two above its largest value, over 2^40.
MPM_HD double coarse_step(int negative_exponent) {
  return MPM_MATH(ldexp)(1.0, 1 - negative_exponent - exact_bits);
}

/// Lowers exponents[k] to minus the exponent of the largest value that the particles of a block give in channel k.
template <int Channels, class T, class Contribute>
MPM_HD void measure_block(const Team& team, const Arguments<T>& a, int block, T* const* channel,
                          Contribute& contribute) {
  team.for_each_lane([&](int lane) {
    double largest[Channels] = {};
    const int end = a.blocks.begin[block + 1];
    for (int i = a.blocks.begin[block] + lane; i < end; i += team.lanes())
      contribute(a.blocks.order[i], [&](const int*, const T* values) {
        for (int k = 0; k < Channels; ++k) {
          const double size = abs(double(values[k]));
          if (channel[k] && is_number(size)) largest[k] = max(largest[k], size);
        }
      });
    for (int k = 0; k < Channels; ++k) {
      if (!(largest[k] > 0)) continue;
      const int exponent = MPM_MATH(ilogb)(largest[k]);
      Team::lower(a.exponents + k, exponent < least_exponent ? -least_exponent : -exponent);
    }
  });
}

/// Adds what the particles of a block give. What is no number goes to the grid itself, where it stays none.
template <int D, int Channels, class T, class Contribute>
MPM_HD void add_block_exactly(const Team& team, const Arguments<T>& a, int block, T* const* channel,
                              Contribute& contribute) {
  team.for_each_lane([&](int lane) {
    const int end = a.blocks.begin[block + 1];
    for (int i = a.blocks.begin[block] + lane; i < end; i += team.lanes())
      contribute(a.blocks.order[i], [&](const int* at, const T* values) {
        const int node = node_index<D>(a, at);
        note_active(a.grid, node);
        for (int k = 0; k < Channels; ++k) {
          const double value = values[k];
          if (!channel[k] || value == 0) continue;
          if (!is_number(value)) {
            Team::add(channel[k] + node, values[k]);
            continue;
          }
          if (a.exponents[k] > no_exponent) continue;  // a compiler may have rounded it to zero when it was measured
          const double step = coarse_step(a.exponents[k]), fine = step * MPM_MATH(ldexp)(1.0, -exact_bits);
          const auto many = static_cast<long long>(value / step);
          const auto rest = static_cast<long long>((value - static_cast<double>(many) * step) / fine);
          unsigned long long* const sums = a.exact_sums + 2 * (static_cast<long long>(k) * a.node_count + node);
          Team::add(sums, static_cast<unsigned long long>(many));
          Team::add(sums + 1, static_cast<unsigned long long>(rest));
        }
      });
  });
}

/// Adds the sums to the grid, and clears them for the next scatter.
template <int Channels, class T>
MPM_HD void take_exact_sums(const Team& team, const Arguments<T>& a, T* const* channel) {
  for_each_node(team, a, [&](int node) {
    for (int k = 0; k < Channels; ++k) {
      if (!channel[k] || a.exponents[k] > no_exponent) continue;
      unsigned long long* const sums = a.exact_sums + 2 * (static_cast<long long>(k) * a.node_count + node);
      const double step = coarse_step(a.exponents[k]), fine = step * MPM_MATH(ldexp)(1.0, -exact_bits);
      channel[k][node] += static_cast<T>(static_cast<double>(static_cast<long long>(sums[0])) * step +
                                         static_cast<double>(static_cast<long long>(sums[1])) * fine);
      sums[0] = sums[1] = 0;
    }
  });
}

}  // namespace mpm::device

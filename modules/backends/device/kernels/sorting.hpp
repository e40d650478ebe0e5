#pragma once
// Sorts the indices of a body's particles into blocks of cells; the particles themselves stay where they are. It is a
// counting sort over the table of all blocks that the grid has, after which each block's particles are put in the order
// of their indices: the outcome follows from the positions alone, whatever the order of lanes. All phases after the first
// have nothing to do while every particle is in the block of the sort before.

#include "backends/device/kernels/stencil.hpp"
#include "backends/device/kernels/sums.hpp"

namespace mpm::device {

/// The blocks of the table that one team numbers.
inline constexpr int chunk_of_blocks = 1024;

/// The room in shared memory for the two sums of each lane.
template <class Scene>
inline constexpr int scan_scalars = sum_scalars<Scene, 1>;

/// The number in the table of the block of a position in cells. Whatever lies beyond the table, or is no number, goes to
/// a block at its edge, and the scatter reports it.
template <int D, class T>
MPM_HD int block_of(const BlockArrays& blocks, const Vec<D, T>& cells) {
  int number = 0;
  for (int c = D - 1; c >= 0; --c) {
    const T at = floor(cells[c] / T(block_cells)) - T(blocks.lower[c]), last = T(blocks.extent[c] - 1);
    const int index = at >= T(0) ? static_cast<int>(at < last ? at : last) : 0;  // NaN is not at least 0
    number = number * blocks.extent[c] + index;
  }
  return number;
}

/// Finds the block of a particle, and whether it has left the one that it was in.
template <class Scene>
MPM_HD void find_block(const Arguments<typename Scene::Scalar>& a, int p) {
  const int now = block_of(a.blocks, position_in_cells<Scene>(a, p));
  if (now == a.blocks.block[p]) return;
  a.blocks.block[p] = now;
  Team::lower(a.blocks.in_order, 0);
}
template <class Scene>
MPM_HD void find_blocks(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_index(team, a.particles.count, [&](int p) { find_block<Scene>(a, p); });
}

/// Whether all phases of the sort may be left out.
MPM_HD bool is_in_order(const BlockArrays& blocks) {
  return *blocks.in_order != 0;
}

template <class Scene>
MPM_HD void clear_counts(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  if (is_in_order(a.blocks)) return;
  for_each_index(team, a.blocks.table, [&](int block) { a.blocks.count[block] = 0; });
}

template <class Scene>
MPM_HD void count_particles(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  if (is_in_order(a.blocks)) return;
  for_each_index(team, a.particles.count, [&](int p) { Team::add(a.blocks.count + a.blocks.block[p], 1); });
}

/// Visits the indices first .. last - 1, each lane a share of them: share(index, sums) adds an index to the two sums, and
/// use(index, before) is told the sums of all indices before it, which start from `start`, or zero where that is null.
template <class Share, class Use>
MPM_HD void scan_over_lanes(const Team& team, int first, int last, const int* start, Share share, Use use) {
  int* const sums = team.template shared<int>();  // [lane][2]
  const int lanes = team.lanes(), each = (last - first + lanes - 1) / lanes;
  const auto begin_of = [=](int lane) { return first + lane * each < last ? first + lane * each : last; };
  team.for_each_lane([&](int lane) {
    int of_lane[2] = {0, 0};
    for (int index = begin_of(lane); index < begin_of(lane + 1); ++index) share(index, of_lane);
    for (int k = 0; k < 2; ++k) sums[2 * lane + k] = of_lane[k];
  });
  team.for_each_lane([&](int lane) {
    if (lane > 0) return;
    int total[2] = {start ? start[0] : 0, start ? start[1] : 0};
    for (int other = 0; other < lanes; ++other)
      for (int k = 0; k < 2; ++k) {
        const int own = sums[2 * other + k];
        sums[2 * other + k] = total[k];
        total[k] += own;
      }
  });
  team.for_each_lane([&](int lane) {
    int before[2] = {sums[2 * lane], sums[2 * lane + 1]};
    for (int index = begin_of(lane); index < begin_of(lane + 1); ++index) {
      use(index, before);
      share(index, before);
    }
  });
}

/// Adds a block of the table to (particles, blocks with any).
MPM_HD void add_block(const BlockArrays& blocks, int block, int* sums) {
  sums[0] += blocks.count[block];
  sums[1] += blocks.count[block] > 0 ? 1 : 0;
}

/// Sums the particles, and the blocks with any, of a chunk of the table.
template <class Scene>
MPM_HD void sum_chunks(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  if (is_in_order(a.blocks)) return;
  const int first = team.block() * chunk_of_blocks, end = first + chunk_of_blocks;
  const int last = end < a.blocks.table ? end : a.blocks.table;
  int* const sums = team.template shared<int>();
  team.for_each_lane([&](int lane) {
    int of_lane[2] = {0, 0};
    for (int block = first + lane; block < last; block += team.lanes()) add_block(a.blocks, block, of_lane);
    for (int k = 0; k < 2; ++k) sums[2 * lane + k] = of_lane[k];
  });
  team.for_each_lane([&](int lane) {
    for (int k = lane; k < 2; k += team.lanes()) {
      int total = 0;
      for (int other = 0; other < team.lanes(); ++other) total += sums[2 * other + k];
      a.blocks.chunk[2 * team.block() + k] = total;
    }
  });
}

/// Makes the sums of the chunks those of all chunks before, in one team; notes how many blocks have particles, and where
/// the last of these ends.
template <class Scene>
MPM_HD void scan_chunks(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  if (is_in_order(a.blocks)) return;
  const BlockArrays& blocks = a.blocks;
  const int chunks = (blocks.table + chunk_of_blocks - 1) / chunk_of_blocks;
  scan_over_lanes(
      team, 0, chunks, nullptr,
      [&](int chunk, int* sums) { sums[0] += blocks.chunk[2 * chunk], sums[1] += blocks.chunk[2 * chunk + 1]; },
      [&](int chunk, const int* before) {
        blocks.before_chunk[2 * chunk] = before[0], blocks.before_chunk[2 * chunk + 1] = before[1];
        if (chunk < chunks - 1) return;
        *blocks.active = before[1] + blocks.chunk[2 * chunk + 1];
        blocks.begin[*blocks.active] = a.particles.count;
      });
}

/// Numbers the blocks with particles and finds where the particles of each begin.
template <class Scene>
MPM_HD void number_blocks(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  if (is_in_order(a.blocks)) return;
  const BlockArrays& blocks = a.blocks;
  const int first = team.block() * chunk_of_blocks, end = first + chunk_of_blocks;
  scan_over_lanes(
      team, first, end < blocks.table ? end : blocks.table, blocks.before_chunk + 2 * team.block(),
      [&](int block, int* sums) { add_block(blocks, block, sums); },
      [&](int block, const int* before) {
        blocks.next[block] = before[0];
        if (blocks.count[block] == 0) return;
        blocks.begin[before[1]] = before[0];
        int* const cell = blocks.cell + 3 * before[1];
        for (int c = 0, rest = block; c < Scene::dimension; rest /= blocks.extent[c], ++c)
          cell[c] = (blocks.lower[c] + rest % blocks.extent[c]) * block_cells;
      });
}

/// Puts particles into their blocks, in any order.
template <class Scene>
MPM_HD void place_particles(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  if (is_in_order(a.blocks)) return;
  for_each_index(team, a.particles.count,
                 [&](int p) { a.blocks.order[Team::take_number(a.blocks.next + a.blocks.block[p])] = p; });
}

/// Puts the particles of each block in the order of their indices, by a bitonic network of a team.
template <class Scene>
MPM_HD void order_blocks(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  if (is_in_order(a.blocks)) return;
  for_each_block(team, a, [&](int block) {
    int* const order = a.blocks.order + a.blocks.begin[block];
    const int count = a.blocks.begin[block + 1] - a.blocks.begin[block];
    // What lies beyond `count` counts as larger than everything, so that it never moves.
    const auto compare = [&](int mask, int stride) {
      team.for_each_lane([&](int lane) {
        for (int low = lane; low < count; low += team.lanes()) {
          const int high = low ^ mask;
          if ((low & stride) != 0 || high >= count || order[low] <= order[high]) continue;
          const int kept = order[low];
          order[low] = order[high], order[high] = kept;
        }
      });
    };
    for (int length = 2; length / 2 < count; length *= 2) {
      compare(length - 1, length / 2);
      for (int stride = length / 4; stride > 0; stride /= 2) compare(stride, stride);
    }
  });
}

/// Says that all particles are in order.
template <class Scene>
MPM_HD void end_sort(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_index(team, 1, [&](int) { *a.blocks.in_order = 1; });
}

}  // namespace mpm::device

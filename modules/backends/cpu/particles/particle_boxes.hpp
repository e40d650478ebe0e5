#pragma once
// This part of ParticleStep works on boxes of nodes: particles whose nodes lie in a box within the tile of their block
// take it; the others keep their lists.

#include "backends/cpu/particles/particle_chunks.hpp"
#include "kernel/lanes.hpp"

namespace mpm::cpu {

/// Evaluates the boxes of a chunk, and the lists of its particles that have none, as evaluate_lists does.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::evaluate_boxes(const Chunk& chunk, Work& work, bool gradients) {
  BoxWork<D, T>& boxes = work.boxes;
  const mpm_box_batch batch{static_cast<std::uint32_t>(chunk.end),
                            chunk_size<T>,
                            D,
                            0,
                            chunk.at(Particles<D, T>::position),
                            scene_.half_size ? chunk.particles.half_size.data() : nullptr,
                            chunk.particles.domain < 0 ? nullptr : chunk.at(chunk.particles.domain),
                            boxes.base,
                            boxes.width,
                            work.offset,
                            boxes.weight.data(),
                            gradients ? boxes.gradient.data() : nullptr,
                            scene_.plan.stencil.second_moment ? work.second_moment : nullptr};
  scene_.evaluate_box(scene_.shape_parameters, &batch);
  work.lists.clear();
  if (!place_boxes(chunk, work)) {
    int entry = 0;
    for (int first = 0; first < chunk.end; first += ListWork<D, T>::lanes)
      entry = evaluate_lists_between_boxes(chunk, work, first, entry, gradients);
  }
  if (scene_.plan.stencil.second_moment) invert_moments(chunk, work);
}

/// Sets widths that kernels have, places in the tile and the boxes' reach; false when a particle has no box there. A box
/// has four nodes an axis at most, around a particle inside the domain: it never reaches too far beyond that.
template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::place_boxes(const Chunk& chunk, Work& work) const {
  BoxWork<D, T>& boxes = work.boxes;
  int lists = 0;
  std::int32_t* const widths = boxes.width;
  const int end = chunk.end, side = kernels_.side;
#pragma omp simd reduction(+ : lists)
  for (int p = 0; p < end; ++p) {
    const int width = widths[p] > 3 ? box_width : 3;
    int fits = widths[p] > 0 ? 1 : 0, node = 0;
    for (int a = 0; a < D; ++a) {
      const int base = boxes.base[a * chunk_size<T> + p];
      fits &= (base >= -1 ? 1 : 0) & (base <= side - 1 - width ? 1 : 0);
      node = node * side + base + 1;
    }
    widths[p] = fits ? width : 0;
    boxes.tile_node[p] = fits ? node : 0;
    lists += 1 - fits;
  }
  ListWork<D, T>& reach = work.lists;
  for (int a = 0; a < D; ++a) {
    int low = reach.lowest[a], high = reach.highest[a];
    const std::int32_t* const base = boxes.base + a * chunk_size<T>;
#pragma omp simd reduction(min : low) reduction(max : high)
    for (int p = 0; p < end; ++p) {
      low = std::min(low, widths[p] ? base[p] : low);
      high = std::max(high, widths[p] ? base[p] + widths[p] - 1 : high);
    }
    reach.lowest[a] = low, reach.highest[a] = high;
  }
  return lists == 0;
}

/// Evaluates the lists of those of one batch's particles that have no box; returns the next free entry.
template <int D, class T, class Components>
int ParticleStep<D, T, Components>::evaluate_lists_between_boxes(const Chunk& chunk, Work& work, int first_lane,
                                                                 int entry, bool gradients) {
  constexpr int lanes = ListWork<D, T>::lanes;
  ListWork<D, T>& lists = work.lists;
  const std::int32_t* const width = work.boxes.width + first_lane;
  lists.any = true;
  for (int p = first_lane; p < first_lane + lanes; ++p) lists.first[p] = lists.near_end[p] = lists.far_end[p] = entry;
  if (std::find(width, width + lanes, 0) == width + lanes) return entry;
  evaluate_list_batch(chunk, work, first_lane, gradients);
  for (int lane = 0; lane < lanes; ++lane) {
    if (width[lane]) continue;
    const int p = first_lane + lane;
    for (int a = 0; a < D; ++a) work.offset[a * chunk_size<T> + p] = T(0);  // lists count from the particle itself
    keep_moment(work, first_lane, lane);
    entry = keep_list(chunk, work, first_lane, lane, entry, gradients);
  }
  return entry;
}

/// Multiplies C <- C D^-1, both full matrices.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::multiply_by_inverse_moments(const Chunk& chunk, Work& work) const {
  using L = Lanes<T>;
  for (int p = 0; p < chunk.end; p += L::width) {
    L inverse[D * D];
    for (int k = 0; k < D * D; ++k) inverse[k] = L::load(work.inverse_moment + k * chunk_size<T> + p);
    for (int c = 0; c < D; ++c) {
      T* const row = work.affine + c * D * chunk_size<T> + p;
      L from[D];
      for (int a = 0; a < D; ++a) from[a] = L::load(row + a * chunk_size<T>);
      for (int a = 0; a < D; ++a) {
        L sum = from[0] * inverse[a];
        for (int b = 1; b < D; ++b) sum = sum + from[b] * inverse[b * D + a];
        sum.store(row + a * chunk_size<T>);
      }
    }
  }
}

}  // namespace mpm::cpu

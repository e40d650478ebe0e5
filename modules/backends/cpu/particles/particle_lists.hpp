#pragma once
// This part of ParticleStep works on lists of nodes. A list whose nodes lie in the tile of its block goes through the
// tile; the others, of far stretched particles, go to the grid itself, one after another.

#include "backends/cpu/particles/particle_chunks.hpp"
#include "kernel/corner_domain.hpp"
#include "kernel/lanes.hpp"

namespace mpm::cpu {

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::evaluate_list_batch(const Chunk& chunk, Work& work, int first_lane,
                                                         bool gradients) const {
  ListWork<D, T>& lists = work.lists;
  constexpr int lanes = ListWork<D, T>::lanes;
  const auto copy = [&](const T* from, int components, T* to) {
    for (int c = 0; c < components; ++c) std::copy_n(from + c * chunk_size<T> + first_lane, lanes, to + c * lanes);
  };
  const bool domain = chunk.particles.domain >= 0;
  copy(chunk.at(Particles<D, T>::position), D, lists.position);
  if (domain) copy(chunk.at(chunk.particles.domain), D * D, lists.domain);
  const bool corners = chunk.particles.corners >= 0;
  if (corners) copy(chunk.at(chunk.particles.corners), (1 << D) * D, lists.corners);
  if (scene_.half_size) copy(chunk.particles.half_size.data(), D, lists.half_size);
  const bool moments = scene_.plan.stencil.second_moment;
  const mpm_list_batch batch{lanes,
                             lanes,
                             D,
                             static_cast<std::uint32_t>(scene_.capacity),
                             lists.position,
                             scene_.half_size ? lists.half_size : nullptr,
                             domain ? lists.domain : nullptr,
                             lists.count,
                             lists.coordinates.data(),
                             lists.weight.data(),
                             gradients ? lists.gradient.data() : nullptr,
                             moments ? lists.second_moment : nullptr,
                             corners ? lists.corners : nullptr};
  scene_.evaluate_list(scene_.shape_parameters, &batch);
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::keep_moment(Work& work, int first_lane, int lane) const {
  if (!scene_.plan.stencil.second_moment) return;
  for (int c = 0; c < D * D; ++c)
    work.second_moment[c * chunk_size<T> + first_lane + lane] =
        work.lists.second_moment[c * ListWork<D, T>::lanes + lane];
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::evaluate_lists(const Chunk& chunk, Work& work, bool gradients) {
  ListWork<D, T>& lists = work.lists;
  lists.clear();
  lists.any = true;
  int entry = 0;
  for (int first = 0; first < chunk.end; first += ListWork<D, T>::lanes) {
    evaluate_list_batch(chunk, work, first, gradients);
    for (int lane = 0; lane < ListWork<D, T>::lanes; ++lane) {
      keep_moment(work, first, lane);
      entry = keep_list(chunk, work, first, lane, entry, gradients);
    }
  }
  if (scene_.plan.stencil.second_moment) invert_moments(chunk, work);
}

/// The grid's multilinear velocity at a corner. The particle's list has made sure of the nodes there.
template <int D, class T, class Components>
Vec<D, T> ParticleStep<D, T, Components>::velocity_at_corner(const Chunk& chunk, const Work& work, int particle,
                                                             const Vec<D, T>& corner) const {
  Vec<D, T> x, velocity{};
  for (int a = 0; a < D; ++a) x[a] = chunk.at(Particles<D, T>::position + a)[particle];
  const TentCell<D, T> cell(x, corner);
  const bool near = work.lists.near_end[particle] > work.lists.first[particle];
  const T* const nodes = near ? work.velocity_tile.data() : grid_.channel(motion, chunk.body.field);
  for (int which = 0; which < 1 << D; ++which) {
    const T weight = cell.weight(which);
    if (weight == T(0)) continue;
    std::array<int, 3> node{};
    int at = 0;
    for (int a = 0; a < D; ++a) {
      node[a] = cell.node(which, a);
      at = at * kernels_.side + node[a] + 1;
      node[a] += chunk.block.at[a] * block_side<D>;
    }
    if (!near) at = grid_.find(node);
    for (int a = 0; a < D; ++a) velocity[a] += weight * nodes[std::size_t(at) * 4 + a];
  }
  return velocity;
}

/// Finds where the corners go, from the particles as they are yet: with the grid, and with what moves the particle
/// beyond the gathered velocity.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::gather_corners(const Chunk& chunk, Work& work, const T* advection, double dt,
                                                    T* moved) const {
  const T scale = static_cast<T>(dt / scene_.domain.cell_size);
  for (int p = 0; p < chunk.end; ++p) {
    if (work.lists.near_end[p] == work.lists.first[p] && work.lists.far_end[p] == work.lists.first[p]) continue;
    for (int k = 0; k < 1 << D; ++k) {
      Vec<D, T> corner;
      for (int a = 0; a < D; ++a) corner[a] = chunk.at(chunk.particles.corners + k * D + a)[p];
      const Vec<D, T> v = velocity_at_corner(chunk, work, p, corner);
      for (int a = 0; a < D; ++a) {
        const T own = advection[a * chunk_size<T> + p] - work.velocity[a * chunk_size<T> + p];
        moved[(k * D + a) * chunk_size<T> + p] = corner[a] + scale * (v[a] + own);
      }
    }
  }
}

/// Moves corners and particles to where the corners go; returns the largest displacement in cells.
template <int D, class T, class Components>
auto ParticleStep<D, T, Components>::move_with_corners(const Chunk& chunk, Work& work, const T* moved) -> Moved {
  if (chunk.body.frozen) return {};
  for (int p = 0; p < chunk.end; ++p) {
    Vec<D, T> corner[1 << D];
    for (int k = 0; k < 1 << D; ++k)
      for (int a = 0; a < D; ++a) corner[k][a] = moved[(k * D + a) * chunk_size<T> + p];
    const CornerDomain<D, T> domain = corner_domain<D, T>(corner);
    const Vec<D, T> centre = centroid(domain, corner);
    for (int a = 0; a < D; ++a) work.advection[a * chunk_size<T> + p] = centre[a];
    for (int k = 0; k < 1 << D; ++k)
      for (int a = 0; a < D; ++a) chunk.at(chunk.particles.corners + k * D + a)[p] = corner[k][a] - centre[a];
    if (domain.upright || p >= chunk.count || !std::isfinite(domain.volume)) continue;
    note(Cause::domain_inside_out, chunk, p);
  }
  return advance_position(chunk, work.advection, T(1));
}

/// Appends one particle's list to those of the chunk; returns the next free entry.
template <int D, class T, class Components>
int ParticleStep<D, T, Components>::keep_list(const Chunk& chunk, Work& work, int first_lane, int lane, int entry,
                                              bool gradients) {
  ListWork<D, T>& lists = work.lists;
  constexpr int lanes = ListWork<D, T>::lanes;
  const int p = first_lane + lane, count = lists.count[lane];
  const auto shape = [&] { return "shape \"" + std::string(scene_.experiment.shape.plugin->id()) + "\" "; };
  if (count == 0 && chunk.particles.corners >= 0) {
    lists.first[p] = lists.near_end[p] = lists.far_end[p] = entry;
    note(Cause::domain_inside_out, chunk, p);
    return entry;
  }
  if (count < 1 || count > scene_.capacity)
    throw std::logic_error(shape() + "gave a list of " + std::to_string(count) + " nodes");
  const std::int32_t* const nodes = lists.coordinates.data() + lane;
  int low[3]{}, high[3]{};
  for (int a = 0; a < D; ++a) {
    low[a] = high[a] = nodes[a * lanes];
    for (int k = 1; k < count; ++k) {
      const int node = nodes[(k * D + a) * lanes];
      low[a] = std::min(low[a], node), high[a] = std::max(high[a], node);
    }
  }
  lists.first[p] = lists.near_end[p] = lists.far_end[p] = entry;
  if (reaches_too_far(chunk, p, low, high)) return entry;
  bool near = true;
  for (int a = 0; a < D; ++a) near = near && low[a] >= -1 && high[a] < kernels_.side - 1;

  for (int k = 0; k < count; ++k) {
    T* const values = lists.values.data() + std::size_t(entry + k) * 8;
    std::array<int, 3> node{};
    int tile_node = 0;
    for (int a = 0; a < D; ++a) {
      node[a] = nodes[(k * D + a) * lanes];
      tile_node = tile_node * kernels_.side + node[a] + 1;
      values[a] = static_cast<T>(node[a]) - lists.position[a * lanes + lane];
      if (gradients) values[4 + a] = lists.gradient[(k * D + a) * lanes + lane];
    }
    values[3] = lists.weight[k * lanes + lane];
    if (!near) {
      for (int a = 0; a < D; ++a) node[a] += chunk.block.at[a] * block_side<D>;
      tile_node = grid_.find(node);
      if (tile_node < 0) throw std::logic_error(shape() + "gave a node beyond its declared reach");
    }
    lists.node[entry + k] = tile_node;
  }
  if (near) {
    for (int a = 0; a < D; ++a) {
      lists.lowest[a] = std::min(lists.lowest[a], low[a]);
      lists.highest[a] = std::max(lists.highest[a], high[a]);
    }
    lists.near_end[p] = entry + count;
  } else {
    lists.far_end[p] = entry + count;
    ++lists.far;
    lists.far_of_chunk += p < chunk.count;
  }
  return entry + count;
}

/// Whether a list has nodes beyond the padding of the domain; the run then ends after this pass.
template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::reaches_too_far(const Chunk& chunk, int p, const int* low, const int* high) {
  bool beyond = false;
  for (int a = 0; a < D; ++a) {
    int origin = chunk.block.at[a] * block_side<D>;
    const int cells = scene_.domain.cells[a];
    if (scene_.domain.periodic(a)) {
      const double x = origin + static_cast<double>(chunk.at(Particles<D, T>::position + a)[p]);
      origin -= cells * static_cast<int>(std::floor(x / cells));
    }
    beyond = beyond || origin + low[a] < -scene_.padding || origin + high[a] > cells + scene_.padding;
  }
  if (!beyond) return false;
  note(Cause::domain_beyond_grid, chunk, p);
  return true;
}

/// Does what place_to_scatter does; what the lists in the tile reach counts as first nodes of the tile's stencils.
template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::place_lists(const Chunk& chunk, const Work& work, bool extend_reach) const {
  if (!extend_reach) return true;
  Reach& reach = chunk.block.reach;
  for (int a = 0; a < D; ++a) {
    reach.lowest[a] = std::min(reach.lowest[a], work.lists.lowest[a] + 1);
    reach.highest[a] = std::max(reach.highest[a], work.lists.highest[a] + 2 - list_width);
  }
  return true;
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::extend_bounds(const Chunk& chunk) const {
  using L = Lanes<T>;
  const int domain = chunk.particles.domain;
  ListBounds& bounds = chunk.block.bounds;
  for (int a = 0; a < D; ++a) {
    L low(std::numeric_limits<T>::max()), high(std::numeric_limits<T>::lowest());
    for (int p = 0; p < chunk.end; p += L::width) {
      L extent(static_cast<T>(scene_.list_reach));
      for (int k = 0; domain >= 0 && k < D; ++k) extent = extent + abs(L::load(chunk.at(domain + a * D + k) + p));
      L farthest(T(0));
      for (int k = 0; k < scene_.plan.sample_points; ++k)
        farthest = max(farthest, abs(L::load(chunk.at(chunk.particles.corners + k * D + a) + p)));
      extent = extent + farthest;
      const L x = L::load(chunk.at(Particles<D, T>::position + a) + p);
      low = min(low, x - extent), high = max(high, x + extent);
    }
    for (int i = 0; i < L::width; ++i) {
      bounds.low[a] = std::min(bounds.low[a], static_cast<double>(low[i]));
      bounds.high[a] = std::max(bounds.high[a], static_cast<double>(high[i]));
    }
  }
}

template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::widen_active_blocks() {
  std::atomic<bool> grew{false};
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, false, [&](Block<D>& block, Work&) {
      if (!block.bounds.known) {
        block.bounds.clear();
        for_each_chunk_of(body, block, [&](const Chunk& chunk) { extend_bounds(chunk); });
      }
      block.bounds.known = false;
      const double *const low = block.bounds.low, *const high = block.bounds.high;
      for (int a = 0; a < D; ++a) {
        // reaches_too_far refuses what lies beyond, and also what is not a number.
        const double origin = block.at[a] * block_side<D>, least = -scene_.padding - 2 - origin,
                     most = scene_.domain.cells[a] + scene_.padding + 2 - origin;
        const int first = static_cast<int>(low[a] > least ? std::floor(low[a]) : least) >> block_bits<D>;
        const int last = static_cast<int>(high[a] < most ? std::ceil(high[a]) : most) >> block_bits<D>;
        if (first >= block.first_active[a] && last <= block.last_active[a]) continue;
        block.first_active[a] = std::min(block.first_active[a], first);
        block.last_active[a] = std::max(block.last_active[a], last);
        grew = true;
      }
    });
  return grew;
}

/// Evaluates the shape for what its moments are. The places of the nodes do not matter, so none is refused.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::evaluate_moments(const Chunk& chunk, Work& work) {
  if (!scene_.list) return evaluate_shape(chunk, work, false);
  for (int first = 0; first < chunk.end; first += ListWork<D, T>::lanes) {
    evaluate_list_batch(chunk, work, first, false);
    for (int lane = 0; lane < ListWork<D, T>::lanes; ++lane) keep_moment(work, first, lane);
  }
}

template <int D, class T, class Components>
std::vector<double> ParticleStep<D, T, Components>::second_moments(int body) {
  std::size_t n = 0;
  for (const Block<D>& block : particles_[body].blocks) n += block.count;
  std::vector<double> moments(n * D * D, 0.0);
  const double square = scene_.domain.cell_size * scene_.domain.cell_size;
  Work& work = *work_[0];
  for (Block<D>& block : particles_[body].blocks)
    for_each_chunk_of(body, block, [&](const Chunk& chunk) {
      evaluate_moments(chunk, work);
      for (int p = 0; p < chunk.count; ++p)
        for (int a = 0; a < D; ++a)
          for (int b = 0; b < D; ++b) {
            if (!scene_.list && a != b) continue;
            moments[(std::size_t(chunk.ids[p]) * D + a) * D + b] =
                square * work.second_moment[(scene_.list ? a * D + b : a) * chunk_size<T> + p];
          }
    });
  return moments;
}

}  // namespace mpm::cpu

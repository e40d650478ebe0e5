#pragma once
// The particles of one body: chunks of 64, [component][64] contiguous in each, sorted by cell within blocks of cells.
// Positions are in cells from the first node of the particle's block, which keeps them exact in float.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "aligned_array.hpp"
#include "scene.hpp"
#include "tile.hpp"

namespace mpm::cpu {

/// How far the lists of a block's particles may reach, in cells from its first node.
struct ListBounds {
  bool known = false;
  double low[3], high[3];
  void clear() {
    std::fill(low, low + 3, std::numeric_limits<double>::max());
    std::fill(high, high + 3, std::numeric_limits<double>::lowest());
  }
};

template <int D>
struct Block {
  BlockCoordinates at{};
  std::uint32_t first_chunk = 0, count = 0;
  Reach reach;                                                ///< of this step's stencils
  std::array<std::int32_t, neighbour_count<D>> neighbours{};  ///< slots of the grid
  /// Blocks of the grid, from this one, that its particles' lists may reach: always the neighbours.
  std::array<std::int32_t, 3> first_active{-1, -1, -1}, last_active{1, 1, 1};
  ListBounds bounds;                          ///< of the particles as the last gather moved them
  std::uint32_t far = 0;                      ///< particles whose lists leave the tile
  double kinetic_energy = 0, dissipated = 0;  ///< partial sums of the ledger, J
  double scattered_energy = 0;                ///< the same of the particles when they scatter, J
};

/// Blocks of one unit lie side by side; units of one colour touch no common node.
struct Unit {
  std::uint32_t first = 0, last = 0;
};
template <int D>
inline constexpr int colour_count = D == 3 ? 4 : 2;

/// One field of state: its first component within a chunk and its declaration.
struct StateField {
  std::string name;
  int first = 0, components = 1;
};

template <int D, class T>
struct Particles {
  // components of a chunk
  static constexpr int position = 0, velocity = D;
  int advection = -1;    ///< kept for the move pass of MUSL
  int domain = -1;       ///< semi-side vectors in cells, row-major, columns are vectors
  int next_domain = -1;  ///< where a step strains before its last use of the weights (Plan::strained_domain)
  int components = 2 * D;
  AlignedArray<T> half_size;  ///< [D][chunk_size] cells, of shapes that read it
  std::vector<StateField> transfer_state, material_state;

  AlignedArray<T> data;
  AlignedArray<std::int32_t> id;  ///< index in the order of seeding
  std::vector<Block<D>> blocks;
  std::array<std::vector<Unit>, colour_count<D>> units;
  std::uint32_t chunks = 0;

  T* chunk(std::uint32_t i) { return data.data() + std::size_t(i) * components * chunk_size; }
  const T* chunk(std::uint32_t i) const { return data.data() + std::size_t(i) * components * chunk_size; }
  std::int32_t* ids(std::uint32_t i) { return id.data() + std::size_t(i) * chunk_size; }
  const std::int32_t* ids(std::uint32_t i) const { return id.data() + std::size_t(i) * chunk_size; }

  void require_chunks(std::uint32_t count) {
    data.require(std::size_t(count) * components * chunk_size);
    id.require(std::size_t(count) * chunk_size);
  }
};

constexpr int padded(int count) {
  return (count + int(MPM_LANES) - 1) / int(MPM_LANES) * int(MPM_LANES);
}

/// Calls run(chunk number, particles in it) over a block.
template <int D, class Run>
inline void for_each_chunk(const Block<D>& block, Run&& run) {
  for (std::uint32_t first = 0; first < block.count; first += chunk_size)
    run(block.first_chunk + first / chunk_size,
        static_cast<int>(std::min<std::uint32_t>(chunk_size, block.count - first)));
}

/// Fills the lanes after the last particle of every block with copies of it.
template <int D, class T>
void fill_tails(Particles<D, T>& particles) {
  for (const Block<D>& block : particles.blocks) {
    const int used = (block.count - 1) % chunk_size + 1;
    const std::uint32_t last = block.first_chunk + (block.count - 1) / chunk_size;
    T* const values = particles.chunk(last);
    for (int lane = used; lane < padded(used); ++lane) {
      for (int c = 0; c < particles.components; ++c) values[c * chunk_size + lane] = values[c * chunk_size + used - 1];
      particles.ids(last)[lane] = particles.ids(last)[used - 1];
    }
  }
}

/// Position of a particle in cells from the domain's lower corner, wrapped on periodic axes.
template <int D, class T>
inline double cells_from_corner(const Domain& domain, const Block<D>& block, int axis, T relative) {
  double x = block.at[axis] * block_side<D> + static_cast<double>(relative);
  if (domain.periodic(axis)) {
    const double period = domain.cells[axis];
    x -= period * std::floor(x / period);
    if (x >= period) x = 0;
  }
  return x;
}

/// Places seeded particles into chunks of provisional blocks; sort_particles then makes the real ones.
template <int D, class T>
void seed_particles(Particles<D, T>& particles, const SeededBody& seeds, const Domain& domain);

/// Sorts stably by block and cell of the stencil's first node (of a list: of the position less half a cell). `spare` is
/// the other buffer and is swapped in.
template <int D, class T>
void sort_particles(Particles<D, T>& particles, Particles<D, T>& spare, const Scene<D, T>& scene);

}  // namespace mpm::cpu

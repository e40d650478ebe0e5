#pragma once
// The particles of one body lie in chunks of 64, [component][64] contiguous in each, sorted into blocks of cells. Their
// positions are in cells from the first node of their block, which keeps them exact in float.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "backends/cpu/aligned_array.hpp"
#include "backends/cpu/particles/chunk_pool.hpp"
#include "backends/cpu/particles/unit_order.hpp"
#include "backends/cpu/scene.hpp"
#include "backends/cpu/tiles/tile.hpp"

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
  Reach reach;                                                  ///< reach of this step's stencils
  std::array<std::int32_t, neighbour_count<D>> neighbours{-1};  ///< slots of the grid, see has_neighbours
  /// The blocks of the grid, from this one, that its particles' lists may reach: always the neighbours.
  std::array<std::int32_t, 3> first_active{-1, -1, -1}, last_active{1, 1, 1};
  bool may_meet = true;                        ///< false: none of its particles reaches a node where contact may act
  ListBounds bounds;                           ///< bounds of the particles as the last gather moved them
  std::uint32_t far = 0;                       ///< number of particles whose lists leave the tile
  double kinetic_energy = 0;                   ///< partial sums of the ledger, J
  StrainEnergies strained;                     ///< the same, of the last strain
  double phase_change = 0;                     ///< the same: stored energy that went with a phase, J
  double scattered_energy = 0;                 ///< kinetic energy of the particles when they scatter, J
  double scattered_mass = 0;                   ///< their mass, kg
  std::array<double, D> scattered_momentum{};  ///< their momentum, kg m/s
  double heat = 0, heat_of_dissipation = 0;    ///< heat of the particles when they last scattered or gathered, J

  /// Whether the grid has been built around it.
  bool has_neighbours() const { return neighbours[0] >= 0; }
};

/// The sums over the particles that have been scattered, for the ledger.
struct Scattered {
  double kinetic_energy = 0;  ///< J
  double mass = 0;            ///< kg
  Vector3 momentum{};         ///< kg m/s
};

/// A field of the plan and its first component within a chunk.
struct StoredField {
  const Field* field = nullptr;
  int first = 0;
};

template <int D, class T>
struct Particles {
  // These are first components of fields in a chunk; -1 where the plan has none.
  static constexpr int position = 0, velocity = D;
  int advection = -1;      ///< kept for the move pass of MUSL
  int domain = -1;         ///< semi-side vectors in cells, row-major, columns are vectors
  int next_domain = -1;    ///< domain that a step strains before its last use of the weights (Plan::strained_domain)
  int size = -1;           ///< a factor of the body's mass and volume
  int corners = -1;        ///< corners of a domain that the grid's velocity moves: [corner][D] cells, from the particle
  int moved_corners = -1;  ///< where they go in this step, kept for the move pass of MUSL
  int deformation = -1;    ///< deformation gradient, for loads, row-major
  int temperature = -1, melted_fraction = -1;
  int artificial_pressure = -1;               ///< J q of the last strain, Pa
  int contact_state = -1, contact_gain = -1;  ///< what a law of contact keeps, and what the last step has added
  int grip = -1;                              ///< number of the grip that moves a particle, from 1; 0: none
  int components = 0;
  int motion_components = 0;        ///< components of velocity and the transfer's state, from `velocity` on
  AlignedArray<T> half_size;        ///< [D][chunk_size] cells, for shapes that read it
  std::vector<StoredField> fields;  ///< fields that a chunk holds beside the indices of seeding, in its order
  std::vector<StoredField> transfer_state, material_state;
  std::vector<StoredField> temperature_state;  ///< in the order of transfer_state

  ChunkPool pool;
  std::vector<std::byte*> places;  ///< places of chunks: [components][chunk_size] values, then indices of seeding
  std::vector<Block<D>> blocks;
  ColouredUnits<D> units;
  UnitOrder order;  ///< order of these units
  std::uint32_t chunks = 0;

  std::size_t value_bytes() const { return std::size_t(components) * chunk_size<T> * sizeof(T); }
  std::size_t chunk_bytes() const { return value_bytes() + chunk_size<T> * sizeof(std::int32_t); }
  T* values_at(std::byte* place) const { return reinterpret_cast<T*>(place); }
  std::int32_t* ids_at(std::byte* place) const { return reinterpret_cast<std::int32_t*>(place + value_bytes()); }

  T* chunk(std::uint32_t i) { return values_at(places[i]); }
  const T* chunk(std::uint32_t i) const { return values_at(places[i]); }
  /// The indices of a chunk's particles in the order of seeding.
  std::int32_t* ids(std::uint32_t i) { return ids_at(places[i]); }
  const std::int32_t* ids(std::uint32_t i) const { return ids_at(places[i]); }

  /// Gives the plan's fields of a body their places, in its order: what a gather may replace stands together.
  void lay_out(const Plan& plan, int body);
};

template <int D, class T>
void Particles<D, T>::lay_out(const Plan& plan, int body) {
  const Field* const identity = plan.particle_field(body, "identity");  // its values are the indices of seeding
  const auto place = [&](std::string_view id) {
    const Field* const field = plan.particle_field(body, id);
    for (const StoredField& stored : fields)
      if (stored.field == field) return stored.first;
    return -1;
  };
  motion_components = D;
  for (const Field& field : plan.fields) {
    if (!field.of_particles_of(body) || field.lifetime == Lifetime::seeded || &field == identity) continue;
    fields.push_back({&field, components});
    if (field.origin == Origin::transfer) transfer_state.push_back(fields.back());
    if (field.origin == Origin::transfer) motion_components += field.components;
    if (field.origin == Origin::material) material_state.push_back(fields.back());
    components += field.components;
  }
  const int last_of_motion = transfer_state.empty() ? velocity : transfer_state.back().first;
  if (place("position") != position || place("velocity") != velocity || last_of_motion >= velocity + motion_components)
    throw std::logic_error("the plan does not begin with position, velocity and the transfer's state");
  advection = place("advection_velocity");
  domain = place("domain");
  next_domain = place("strained_domain");
  size = place("size");
  corners = place("corners");
  moved_corners = place("moved_corners");
  deformation = place("deformation");
  temperature = place("temperature");
  melted_fraction = place("melted_fraction");
  artificial_pressure = place("artificial_pressure");
  contact_state = place("contact_state");
  contact_gain = place("contact_gain");
  grip = place("grip");
  for (const StoredField& state : transfer_state)
    for (const StoredField& stored : fields)
      if (stored.field->id == temperature_state_of(state.field->id)) temperature_state.push_back(stored);
}

constexpr int padded(int count) {
  return (count + int(MPM_LANES) - 1) / int(MPM_LANES) * int(MPM_LANES);
}

/// Calls run(chunk number, particles in it) over a block.
template <class T, int D, class Run>
inline void for_each_chunk(const Block<D>& block, Run&& run) {
  for (std::uint32_t first = 0; first < block.count; first += chunk_size<T>)
    run(block.first_chunk + first / chunk_size<T>,
        static_cast<int>(std::min<std::uint32_t>(chunk_size<T>, block.count - first)));
}

/// Fills the lanes after the last of a block's `count` particles with copies of it.
template <int D, class T>
void fill_tail(const Particles<D, T>& particles, std::uint32_t count, std::byte* last_chunk) {
  const int used = static_cast<int>((count - 1) % chunk_size<T>) + 1;
  T* const values = particles.values_at(last_chunk);
  std::int32_t* const ids = particles.ids_at(last_chunk);
  for (int lane = used; lane < padded(used); ++lane) {
    for (int c = 0; c < particles.components; ++c)
      values[c * chunk_size<T> + lane] = values[c * chunk_size<T> + used - 1];
    ids[lane] = ids[used - 1];
  }
}

/// The position of a particle in cells from the domain's lower corner, wrapped on periodic axes.
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

/// The work space of a sort, kept from one to the next so that its pages are touched once.
struct SortSpace {
  std::vector<std::uint16_t> key;                ///< where a particle goes among the blocks around, and its cell there
  std::vector<std::uint64_t> leaving;            ///< for a chunk: bit k where particle k leaves its block
  std::array<AlignedArray<std::byte>, 3> rows;   ///< particles on their way to another block, of three layers of blocks
  std::vector<std::byte> far_rows;               ///< rows of those that go farther than to a neighbour
  std::vector<std::vector<std::byte*>> unused;   ///< chunks at hand for each thread
  std::vector<AlignedArray<std::byte>> nowhere;  ///< a chunk for each thread that nobody reads
  std::uint64_t bytes() const {
    std::uint64_t total =
        key.capacity() * sizeof(key[0]) + leaving.capacity() * sizeof(leaving[0]) + far_rows.capacity();
    for (const auto& layer : rows) total += layer.bytes();
    return total;
  }
};

/// Places seeded particles into chunks of provisional blocks; sort_particles then makes the real ones.
template <int D, class T>
void seed_particles(Particles<D, T>& particles, const SeededBody& seeds, const Domain& domain);

/// How far ahead particles are sorted: by where the velocity of their nearest node leads, so that they are in the
/// middle of their way while they belong to a block.
template <class T>
struct Foresight {
  const T* velocities = nullptr;  ///< quads of the body's field; null where particles are sorted as they lie
  T cells_a_velocity = 0;         ///< s/m of cells
  T farthest = 0;                 ///< cells along any axis, below 1: particles stay within the tile of their block
};

/// Sorts into the blocks of stencils' first nodes (of lists: of positions less half a cell), at first and where it will
/// last by cells within a block too; the same for any number of threads. A particle that stays in its block stays in
/// its place, unless the block is put in order. Returns whether the list of blocks has changed. Unless `with_motion`,
/// velocities and the transfer's state stay behind: they hold anything afterwards.
template <int D, class T>
bool sort_particles(Particles<D, T>& particles, SortSpace& space, const Scene<D, T>& scene, bool with_motion,
                    const Foresight<T>& foresight = {});

}  // namespace mpm::cpu

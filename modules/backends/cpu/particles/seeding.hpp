#pragma once
// Places particles into chunks of provisional blocks: those that are seeded, and those of a state that another backend
// has saved. sort_particles then makes the real ones.

#include <algorithm>
#include <cmath>
#include <vector>

#include "backends/cpu/particles/particles.hpp"

namespace mpm::cpu {

/// Gives all lanes of a chunk what their fields start with.
template <int D, class T>
void begin_values(const Particles<D, T>& particles, std::byte* chunk) {
  for (const StoredField& stored : particles.fields)
    for (int k = 0; k < stored.field->components; ++k)
      std::fill_n(particles.values_at(chunk) + (stored.first + k) * chunk_size<T>, chunk_size<T>,
                  static_cast<T>(first_value(*stored.field, k, D, particles.half_size[0])));
}

/// Puts particles, as they come, each into the last chunk of its block.
template <int D, class T>
class ProvisionalBlocks {
 public:
  /// There will be so many particles; it keeps the reference, and starts from an empty list of blocks.
  ProvisionalBlocks(Particles<D, T>& particles, std::size_t count) : particles_(particles) {
    particles.pool.set_chunk_bytes(particles.chunk_bytes());
    particles.pool.reserve((count + chunk_size<T> - 1) / chunk_size<T>);
  }

  /// Makes room for a particle at `cells` from the domain's lower corner, with the index of seeding `id`. Returns its
  /// lane, whose fields but the position have what they start with where nobody seeds them.
  T* add(const double (&cells)[D], std::int32_t id) {
    BlockCoordinates at{};
    for (int a = 0; a < D; ++a) at[a] = static_cast<int>(std::floor(cells[a] / block_side<D>));
    if (known_ < 0 || found_[known_].at != at) known_ = table_.insert(at, static_cast<int>(found_.size()));
    if (known_ == static_cast<int>(found_.size())) found_.emplace_back().at = at;
    Found& block = found_[known_];
    const int lane = static_cast<int>(block.count++ % chunk_size<T>);
    if (lane == 0) begin_values(particles_, block.chunks.emplace_back(particles_.pool.take()));
    T* const values = particles_.values_at(block.chunks.back()) + lane;
    particles_.ids_at(block.chunks.back())[lane] = id;
    for (int a = 0; a < D; ++a)
      values[(Particles<D, T>::position + a) * chunk_size<T>] = static_cast<T>(cells[a] - at[a] * block_side<D>);
    return values;
  }

  /// Makes the list of blocks, in their order.
  void finish() {
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.at < b.at; });
    for (const Found& found : found_) {
      Block<D>& block = particles_.blocks.emplace_back();
      block.at = found.at;
      block.first_chunk = particles_.chunks;
      block.count = found.count;
      fill_tail(particles_, found.count, found.chunks.back());
      particles_.chunks += static_cast<std::uint32_t>(found.chunks.size());
      particles_.places.insert(particles_.places.end(), found.chunks.begin(), found.chunks.end());
    }
  }

 private:
  struct Found {
    BlockCoordinates at{};
    std::uint32_t count = 0;
    std::vector<std::byte*> chunks;
  };

  Particles<D, T>& particles_;
  std::vector<Found> found_;
  BlockTable table_;
  int known_ = -1;  ///< block of the last particle
};

template <int D, class T>
void seed_particles(Particles<D, T>& particles, const SeededBody& seeds, const Domain& domain) {
  ProvisionalBlocks<D, T> blocks(particles, seeds.count());
  const int affine = seeds.with_gradient ? particles.transfer_state[0].first : -1;
  seeds.for_each_batch([&](const SeedBatch& batch) {
    std::vector<std::pair<StoredField, const double*>> seeded;  // seeded fields beside the position
    for (const StoredField& stored : particles.fields)
      if (stored.field->first == First::seeded && stored.first != Particles<D, T>::position)
        if (const double* const values = batch.values(*stored.field)) seeded.push_back({stored, values});
    for (std::size_t i = 0; i < batch.count; ++i) {
      double cells[D];
      for (int a = 0; a < D; ++a) cells[a] = (batch.position[i * D + a] - domain.lower[a]) / domain.cell_size;
      T* const values = blocks.add(cells, static_cast<std::int32_t>(batch.first + i));
      for (const auto& [stored, first] : seeded)
        for (int k = 0, n = stored.field->components; k < n; ++k)
          values[(stored.first + k) * chunk_size<T>] = static_cast<T>(first[i * n + k]);
      for (int c = 0; affine >= 0 && c < D * D; ++c)
        values[(affine + c) * chunk_size<T>] = static_cast<T>(batch.velocity_gradient[i * D * D + c]);
    }
  });
  blocks.finish();
}

}  // namespace mpm::cpu

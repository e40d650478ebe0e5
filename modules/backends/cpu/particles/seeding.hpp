#pragma once
// Places seeded particles into chunks of provisional blocks.

#include <algorithm>
#include <cmath>
#include <vector>

#include "backends/cpu/particles/particles.hpp"

namespace mpm::cpu {

/// Puts particles, as they come, each into the last chunk of its block.
template <int D, class T>
void seed_particles(Particles<D, T>& particles, const SeededBody& seeds, const Domain& domain) {
  struct Seeded {
    BlockCoordinates at{};
    std::uint32_t count = 0;
    std::vector<std::byte*> chunks;
  };
  std::vector<Seeded> found;
  BlockTable table;
  particles.pool.set_chunk_bytes(particles.chunk_bytes());
  particles.pool.reserve((seeds.count() + chunk_size<T> - 1) / chunk_size<T>);
  int known = -1;
  const int affine = seeds.with_gradient ? particles.transfer_state[0].first : -1;
  seeds.for_each_batch([&](const SeedBatch& batch) {
    std::vector<std::pair<StoredField, const double*>> seeded;  // seeded fields beside the position
    for (const StoredField& stored : particles.fields)
      if (stored.field->first == First::seeded && stored.first != Particles<D, T>::position)
        if (const double* const values = batch.values(*stored.field)) seeded.push_back({stored, values});
    for (std::size_t i = 0; i < batch.count; ++i) {
      double cells[D];
      BlockCoordinates at{};
      for (int a = 0; a < D; ++a) {
        cells[a] = (batch.position[i * D + a] - domain.lower[a]) / domain.cell_size;
        at[a] = static_cast<int>(std::floor(cells[a] / block_side<D>));
      }
      if (known < 0 || found[known].at != at) known = table.insert(at, static_cast<int>(found.size()));
      if (known == static_cast<int>(found.size())) found.emplace_back().at = at;
      Seeded& block = found[known];
      const int lane = static_cast<int>(block.count++ % chunk_size<T>);
      if (lane == 0) {
        block.chunks.push_back(particles.pool.take());
        for (const StoredField& stored : particles.fields)
          for (int k = 0; k < stored.field->components; ++k)
            std::fill_n(particles.values_at(block.chunks.back()) + (stored.first + k) * chunk_size<T>, chunk_size<T>,
                        static_cast<T>(first_value(*stored.field, k, D, particles.half_size[0])));
      }
      T* const values = particles.values_at(block.chunks.back()) + lane;
      particles.ids_at(block.chunks.back())[lane] = static_cast<std::int32_t>(batch.first + i);
      for (int a = 0; a < D; ++a)
        values[(Particles<D, T>::position + a) * chunk_size<T>] = static_cast<T>(cells[a] - at[a] * block_side<D>);
      for (const auto& [stored, first] : seeded)
        for (int k = 0, n = stored.field->components; k < n; ++k)
          values[(stored.first + k) * chunk_size<T>] = static_cast<T>(first[i * n + k]);
      for (int c = 0; affine >= 0 && c < D * D; ++c)
        values[(affine + c) * chunk_size<T>] = static_cast<T>(batch.velocity_gradient[i * D * D + c]);
    }
  });
  std::sort(found.begin(), found.end(), [](const Seeded& a, const Seeded& b) { return a.at < b.at; });
  for (const Seeded& seeded : found) {
    Block<D>& block = particles.blocks.emplace_back();
    block.at = seeded.at;
    block.first_chunk = particles.chunks;
    block.count = seeded.count;
    fill_tail(particles, seeded.count, seeded.chunks.back());
    particles.chunks += static_cast<std::uint32_t>(seeded.chunks.size());
    particles.places.insert(particles.places.end(), seeded.chunks.begin(), seeded.chunks.end());
  }
}

}  // namespace mpm::cpu

#pragma once
// The state of the cpu backend's particles, given as doubles, saved and restored. Included by cpu_backend.hpp alone.

#include "backends/cpu/cpu_backend.hpp"
#include "backends/cpu/particles/seeding.hpp"
#include "simulation/saved_state.hpp"

namespace mpm::cpu {

/// Calls visit(block, values of its lane, index of seeding) for every particle of a body.
template <int D, class T, class Components>
template <class Visit>
void CpuBackend<D, T, Components>::for_each_particle(int body, Visit visit) const {
  const Particles<D, T>& particles = particles_[body];
  for (const Block<D>& block : particles.blocks)
    for_each_chunk<T>(block, [&](std::uint32_t chunk, int count) {
      for (int p = 0; p < count; ++p)
        visit(block, particles.chunk(chunk) + p, static_cast<std::size_t>(particles.ids(chunk)[p]));
    });
}

template <int D, class T, class Components>
std::size_t CpuBackend<D, T, Components>::count(int body) const {
  std::size_t n = 0;
  for (const Block<D>& block : particles_[body].blocks) n += block.count;
  return n;
}

/// The positions of a body's particles in the order of seeding, m.
template <int D, class T, class Components>
std::vector<double> CpuBackend<D, T, Components>::positions(int body) const {
  std::vector<double> position(count(body) * D);
  for_each_particle(body, [&](const Block<D>& block, const T* values, std::size_t id) {
    for (int a = 0; a < D; ++a)
      position[id * D + a] =
          scene_.domain.lower[a] +
          scene_.domain.cell_size * cells_from_corner(scene_.domain, block, a, values[a * chunk_size<T>]);
  });
  return position;
}

template <int D, class T, class Components>
BodyState CpuBackend<D, T, Components>::body_state(int index) const {
  const Particles<D, T>& particles = particles_[index];
  const Body<D, T>& body = particle_step_->bodies()[index];
  const std::size_t n = count(index);
  BodyState state;
  state.volume = body.volume;
  state.mass = body.mass;
  for (const StoredField& stored : particles.fields) {
    if (stored.field->lifetime != Lifetime::saved || stored.first == Particles<D, T>::position) continue;
    const int place = stored.first - Particles<D, T>::velocity, components = stored.field->components;
    if (place < particles.motion_components && !motion_kept_) continue;
    const double unit = stored.field->unit == "cells" ? scene_.domain.cell_size : 1.0;
    std::vector<double>& out = state.of(*stored.field);
    out.resize(n * components);
    for_each_particle(index, [&](const Block<D>&, const T* values, std::size_t id) {
      for (int c = 0; c < components; ++c) out[id * components + c] = unit * values[(stored.first + c) * chunk_size<T>];
    });
  }
  for (const Field& field : scene_.plan.fields)
    if (field.of_particles_of(index) && field.lifetime == Lifetime::seeded) state.of(field) = body.seeded.at(field.id);
  state.position = positions(index);
  if (scene_.plan.stencil.second_moment) state.second_moment = particle_step_->second_moments(index);
  return state;
}

// ---- checkpoints ---------------------------------------------------------------------------------------------------

/// The blocks of one scalar have other sizes than those of another, and what is saved of them is of no use there.
template <int D, class T, class Components>
std::string CpuBackend<D, T, Components>::name_of_arrangement() const {
  return "cpu, " + std::to_string(D) + "-D of " + std::to_string(sizeof(T)) + " bytes, chunks of " +
         std::to_string(chunk_size<T>);
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::save(ArchiveWriter& archive) const {
  save_records(archive, *this);
  save_arrangement(archive, name_of_arrangement(), arrangement());
  for (int body = 0; body < static_cast<int>(particles_.size()); ++body)
    save_particles(archive, scene_.plan, body, positions(body), [&](const Field& field) {
      const auto& fields = particles_[body].fields;
      const auto stored = std::find_if(fields.begin(), fields.end(), [&](const auto& s) { return s.field == &field; });
      const std::size_t components = static_cast<std::size_t>(field.components);
      std::vector<T> all(count(body) * components);
      for_each_particle(body, [&, first = stored->first](const Block<D>&, const T* values, std::size_t id) {
        for (std::size_t c = 0; c < components; ++c) all[id * components + c] = values[(first + c) * chunk_size<T>];
      });
      return all;
    });
}

/// Blocks, who lies where in them, and places in them to the last bit.
template <int D, class T, class Components>
std::vector<char> CpuBackend<D, T, Components>::arrangement() const {
  ArchiveWriter archive;
  archive.put("drift", particle_step_->drift());
  archive.put("last_drift", particle_step_->last_drift());
  for (const Particles<D, T>& particles : particles_) {
    std::vector<std::int32_t> blocks;
    for (const Block<D>& block : particles.blocks) {
      for (const auto& triple : {block.at, block.first_active, block.last_active})
        blocks.insert(blocks.end(), triple.begin(), triple.end());
      blocks.push_back(static_cast<std::int32_t>(block.first_chunk));
      blocks.push_back(static_cast<std::int32_t>(block.count));
    }
    archive.put("chunks", particles.chunks);
    archive.put("blocks", blocks);
    for (const auto& units : particles.units) archive.put("units", units);
    for (std::uint32_t i = 0; i < particles.chunks; ++i) {
      archive.put("identities", particles.ids(i), chunk_size<T>);
      archive.put("places", particles.chunk(i), std::size_t(D) * chunk_size<T>);
    }
  }
  return archive.bytes();
}

/// Restores all but the grid. Where the cpu backend has saved the state, the grid is built for the same blocks in the
/// same order, so that its sums are the same.
template <int D, class T, class Components>
void CpuBackend<D, T, Components>::restore(ArchiveReader& archive) {
  SavedRecords records = restore_records(archive, *this);
  const std::vector<char> bytes = restore_arrangement(archive, name_of_arrangement());
  ArchiveReader arrangement(bytes);
  double drift = 0, last_drift = 0;
  if (!bytes.empty()) arrangement.get("drift", drift), arrangement.get("last_drift", last_drift);
  ledger_ = records.ledger, heat_ledger_ = records.heat_ledger;
  contact_ = records.contact, grid_step_->contact_pairs() = std::move(records.contact_pairs);
  filter_ = records.filter, limit_ = records.limit;
  reactions_.resume(std::move(records.reactions));
  grid_step_->rigid_bodies().resume(std::move(records.rigid_bodies));
  for (int body = 0; body < static_cast<int>(particles_.size()); ++body)
    restore_body(archive, body, bytes.empty() ? nullptr : &arrangement);
  if (!arrangement.at_end()) throw ArchiveError("value \"arrangement\" is not of these particles");
  scattered_ = false;
  motion_kept_ = true;
  particle_step_->forget_failed_forces();
  if (bytes.empty()) {
    grid_built_ = false;  // for provisional blocks, which know no neighbours
    return sort_all();
  }
  grid_.rebuild(particles_, field_of_body_);
  particle_step_->set_drift(drift, last_drift);
}

/// Restores the particles of one body: in the arrangement that was saved, or in provisional blocks where there is none.
template <int D, class T, class Components>
void CpuBackend<D, T, Components>::restore_body(ArchiveReader& archive, int body, ArchiveReader* arrangement) {
  Particles<D, T>& particles = particles_[body];
  const std::size_t n = count(body);
  std::vector<T*> lanes;
  const auto place = [&](const std::vector<double>& position) {
    for (std::byte* const chunk : particles.places) particles.pool.give(chunk);
    particles.places.clear(), particles.blocks.clear(), particles.chunks = 0;
    for (auto& units : particles.units) units.clear();
    if (arrangement)
      take_arrangement(*arrangement, particles, n);
    else
      arrange_anew(particles, position);
    lanes = lanes_by_seeding(particles, n);
  };
  const auto take = [&](const Field& field, const std::vector<T>& values) {
    const int components = field.components;
    for (const StoredField& stored : particles.fields) {
      // A step strains its domains further from where the last one left them.
      const bool strained = stored.first == particles.next_domain && field.id == "domain";
      if (stored.field != &field && !strained) continue;
      for (std::size_t id = 0; id < n; ++id)
        for (int c = 0; c < components; ++c)
          lanes[id][(stored.first + c) * chunk_size<T>] = values[id * components + c];
    }
  };
  restore_particles<T>(archive, scene_.plan, body, n, std::size_t(D), place, take);
  for (const Block<D>& block : particles.blocks)
    fill_tail(particles, block.count, particles.places[block.first_chunk + (block.count - 1) / chunk_size<T>]);
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::arrange_anew(Particles<D, T>& particles, const std::vector<double>& position) {
  ProvisionalBlocks<D, T> blocks(particles, position.size() / D);
  for (std::size_t id = 0; id < position.size() / D; ++id) {
    double cells[D];
    for (int a = 0; a < D; ++a) cells[a] = (position[id * D + a] - scene_.domain.lower[a]) / scene_.domain.cell_size;
    blocks.add(cells, static_cast<std::int32_t>(id));
  }
  blocks.finish();
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::take_arrangement(ArchiveReader& archive, Particles<D, T>& particles,
                                                    std::size_t count) {
  std::size_t found = 0;
  std::vector<std::int32_t> numbers;
  archive.get("chunks", particles.chunks);
  archive.get("blocks", numbers);
  constexpr std::size_t of_block = 11;
  if (numbers.size() % of_block != 0) throw ArchiveError("value \"blocks\" has another length");
  for (std::size_t i = 0; i < numbers.size(); i += of_block) {
    Block<D> block;
    const std::int32_t* next = numbers.data() + i;
    for (auto* const triple : {&block.at, &block.first_active, &block.last_active})
      for (auto& value : *triple) value = *next++;
    block.first_chunk = static_cast<std::uint32_t>(next[0]);
    block.count = static_cast<std::uint32_t>(next[1]);
    const std::uint64_t chunks = (std::uint64_t(block.count) + chunk_size<T> - 1) / chunk_size<T>;
    if (block.count == 0 || block.first_chunk + chunks > particles.chunks)
      throw ArchiveError("value \"blocks\" is not of these particles");
    found += block.count;
    particles.blocks.push_back(block);
  }
  if (found != count || particles.chunks > count) throw ArchiveError("it holds another number of particles");
  for (auto& units : particles.units) {
    archive.get("units", units);
    for (const Unit& unit : units)
      if (unit.first > unit.last || unit.last > particles.blocks.size())
        throw ArchiveError("value \"units\" is not of these particles");
  }
  particles.order = ordered_units<D>(particles.units, particles.blocks, scene_.threads);
  particles.pool.reserve(particles.chunks);
  for (std::uint32_t i = 0; i < particles.chunks; ++i) {
    particles.places.push_back(particles.pool.take());
    begin_values(particles, particles.places[i]);
    archive.get("identities", particles.ids(i), chunk_size<T>);
    archive.get("places", particles.chunk(i), std::size_t(D) * chunk_size<T>);
  }
}

/// The lanes of particles by their index of seeding. Throws ArchiveError where one is not there.
template <int D, class T, class Components>
std::vector<T*> CpuBackend<D, T, Components>::lanes_by_seeding(Particles<D, T>& particles, std::size_t count) {
  std::vector<T*> lanes(count, nullptr);
  for (const Block<D>& block : particles.blocks)
    for_each_chunk<T>(block, [&](std::uint32_t chunk, int used) {
      for (int lane = 0; lane < used; ++lane) {
        const std::int32_t id = particles.ids(chunk)[lane];
        if (id >= 0 && std::size_t(id) < count) lanes[static_cast<std::size_t>(id)] = particles.chunk(chunk) + lane;
      }
    });
  if (std::find(lanes.begin(), lanes.end(), nullptr) != lanes.end())
    throw ArchiveError("value \"identities\" is not of these particles");
  return lanes;
}

}  // namespace mpm::cpu

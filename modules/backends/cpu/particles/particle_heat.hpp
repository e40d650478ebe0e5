#pragma once
// This part of ParticleStep treats temperature, which the transfer carries as the first component of the velocity of a
// particle whose mass is its heat capacity: conduction, heat of dissipation and phases.

#include "backends/cpu/particles/particle_gather.hpp"
#include "operators/heat.hpp"

namespace mpm::cpu {

template <int D, class T>
bool Body<D, T>::may_melt() const {
  return thermal && thermal->phase_change;
}

template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::melted(const Chunk& chunk, int p) const {
  return chunk.body.may_melt() && is_melted(chunk.at(chunk.particles.melted_fraction)[p]);
}

/// The value of the phase that a particle is in.
template <int D, class T, class Components>
T ParticleStep<D, T, Components>::of_phase(const Chunk& chunk, int p, double ThermalProperties::*value) const {
  const Thermal& thermal = *chunk.body.thermal;
  return static_cast<T>((melted(chunk, p) ? thermal.phase_change->melted : thermal.solid).*value);
}

/// Fills the place of the masses with m c, J/K.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::fill_heat_capacities(const Chunk& chunk, Work& work) const {
  fill_masses(chunk, work);
  for (int p = 0; p < chunk.end; ++p) work.mass[p] *= of_phase(chunk, p, &ThermalProperties::heat_capacity);
}

/// Sums m c T, once the capacities have been filled.
template <int D, class T, class Components>
double ParticleStep<D, T, Components>::heat_of(const Chunk& chunk, const Work& work) const {
  const T* const temperature = chunk.at(chunk.particles.temperature);
  double sum = 0;
  for (int p = 0; p < chunk.count; ++p) sum += static_cast<double>(work.mass[p]) * temperature[p];
  return sum;
}

/// Gives the temperature and what the transfer keeps of it as the velocity and state of a particle that it knows.
template <int D, class T, class Components>
auto ParticleStep<D, T, Components>::temperature_as_motion(const Chunk& chunk, Work& work) const -> States {
  T* const velocity = work.scratch_velocity.data();
  std::fill_n(velocity, D * chunk_size<T>, T(0));
  std::copy_n(chunk.at(chunk.particles.temperature), chunk.end, velocity);
  States state{};
  T* next = work.scratch_state.data();
  for (std::size_t f = 0; f < chunk.particles.transfer_state.size(); ++f) {
    const StoredField& kept = chunk.particles.temperature_state[f];
    state.fields[f] = next;
    std::fill_n(next, chunk.particles.transfer_state[f].field->components * chunk_size<T>, T(0));
    for (int c = 0; c < kept.field->components; ++c)
      std::copy_n(chunk.at(kept.first + c), chunk.end, next + c * chunk_size<T>);
    next += chunk.particles.transfer_state[f].field->components * chunk_size<T>;
  }
  return state;
}

/// Scatters heat on stencils that were placed to scatter.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_heat(const Chunk& chunk, Work& work) {
  fill_heat_capacities(chunk, work);
  const States state = temperature_as_motion(chunk, work);
  const bool affine = scene_.has(MPM_SCATTERS_AFFINE);
  const mpm_scatter_batch batch{static_cast<std::uint32_t>(chunk.end),
                                chunk_size<T>,
                                D,
                                0,
                                work.mass,
                                work.scratch_velocity.data(),
                                state.fields,
                                work.b,
                                affine ? work.A : nullptr};
  Components::scatter(scene_, batch);
  add_to_tile(chunk, work, heat, work.mass, true, affine, false);
  if (grid_.has(heated_volume)) scatter_heated_volume(chunk, work);
}

/// Scatters what walls that heat comes through read: volumes (of the section of a ring) with the conductivity beside
/// them, and the places of the capacities from the nodes.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_heated_volume(const Chunk& chunk, Work& work) {
  if (grid_.has(capacity_position)) {
    std::fill(work.A, work.A + D * D * chunk_size<T>, T(0));
    for (int c = 0; c < D; ++c)
      for (int p = 0; p < chunk.end; ++p) work.A[(c * D + c) * chunk_size<T> + p] = -work.mass[p];
    add_to_tile(chunk, work, capacity_position, nullptr, false, true, false);
  }
  const T volume = static_cast<T>(chunk.body.volume);  // it goes into the first row of b, the only one that is read
  for (int p = 0; p < chunk.end; ++p) work.b[p] = volume * work.volume_ratio[p];
  if (const T* const size = sizes(chunk))
    for (int p = 0; p < chunk.end; p += Lanes<T>::width)
      section(chunk, Lanes<T>::load(work.b + p) * Lanes<T>::load(size + p), p).store(work.b + p);
  for (int p = 0; p < chunk.end; ++p) work.scalar[p] = work.b[p] * of_phase(chunk, p, &ThermalProperties::conductivity);
  add_to_tile(chunk, work, heated_volume, work.scalar, true, false, false);
}

/// Gathers the gradient of the temperature and scatters the flux that it drives in one visit.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::conduct() {
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    for_each_block(body, true, [&](Block<D>& block, Work& work) {
      kernels_.load(work.velocity_tile.data(), grid_.channel(heat, bodies_[body].field), block.neighbours.data(),
                    block.reach);
      for_each_chunk_of(body, block, [&](const Chunk& chunk) { conduct_chunk(chunk, work); });
      flush(body, block, work, heat_rate);
    });
    scatter_far(body, [&](const Chunk& chunk, Work& work) { conduct_chunk(chunk, work); });
  }
  failure_.raise();
}

/// Computes -V k grad T for the gradients of the weights, whatever way the transfer takes stress.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::conduct_chunk(const Chunk& chunk, Work& work) {
  evaluate_shape(chunk, work, true);
  place_to_gather(chunk, work);
  gather_moments(chunk, work, work.velocity_tile.data(), heat, false, true);
  unpack_moments(work, false, true, chunk.end);
  mpm_material_batch request{};
  request.volume_ratio = work.volume_ratio;
  update_material(chunk, request);
  const T volume = static_cast<T>(-chunk.body.volume);
  const T* const size = sizes(chunk);
  for (int p = 0; p < chunk.end; ++p)
    work.scalar[p] =
        volume * work.volume_ratio[p] * (size ? size[p] : T(1)) * of_phase(chunk, p, &ThermalProperties::conductivity);
  for (int a = 0; a < D; ++a)  // S takes the place of the gradient; its other rows are never read
    for (int p = 0; p < chunk.end; ++p) work.S[a * chunk_size<T> + p] *= work.scalar[p];
  if (!scene_.list) place_to_scatter(chunk, work, false);
  add_to_tile(chunk, work, heat_rate, nullptr, false, false, true);
}

/// Gathers heat before the same visit gathers velocities and moves.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::gather_heat(int body, Block<D>& block, Work& work, const StepInfo& step) {
  const int field = bodies_[body].field;
  kernels_.load(work.velocity_tile.data(), grid_.channel(heat, field), block.neighbours.data(), block.reach);
  if (scene_.has(MPM_GATHERS_INCREMENT))
    kernels_.load(work.increment_tile.data(), grid_.channel(temperature_before, field), block.neighbours.data(),
                  block.reach);
  block.heat = 0;
  for_each_chunk_of(body, block, [&](const Chunk& chunk) { gather_heat(chunk, work, step); });
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::gather_heat(const Chunk& chunk, Work& work, const StepInfo& step) {
  gather_chunk(chunk, work, {true, false, heat, temperature_before});
  const States state = temperature_as_motion(chunk, work);
  const mpm_gather_batch batch{static_cast<std::uint32_t>(chunk.end),
                               chunk_size<T>,
                               D,
                               0,
                               step.dt,
                               work.velocity,
                               scene_.has(MPM_GATHERS_INCREMENT) ? work.increment : nullptr,
                               scene_.has(MPM_GATHERS_AFFINE) ? work.affine : nullptr,
                               scene_.has(MPM_GATHERS_GRADIENT) ? work.gradient_of_velocity : nullptr,
                               work.scratch_velocity.data(),
                               state.fields,
                               work.advection,
                               moments_for_transfer(chunk, work)};
  Components::gather(scene_, batch);
  std::copy_n(work.scratch_velocity.data(), chunk.end, chunk.at(chunk.particles.temperature));
  for (std::size_t f = 0; f < chunk.particles.temperature_state.size(); ++f) {
    const StoredField& kept = chunk.particles.temperature_state[f];
    for (int c = 0; c < kept.field->components; ++c)
      std::copy_n(static_cast<const T*>(state.fields[f]) + c * chunk_size<T>, chunk.end, chunk.at(kept.first + c));
  }
  fill_heat_capacities(chunk, work);
  const double heat = heat_of(chunk, work);
  chunk.block.heat += heat;
  if (!std::isfinite(heat)) note_temperatures(chunk);
}

/// Notes the particles of a chunk whose temperature is not finite.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::note_temperatures(const Chunk& chunk) {
  const T* const temperature = chunk.at(chunk.particles.temperature);
  for (int p = 0; p < chunk.count; ++p)
    if (!std::isfinite(temperature[p])) note(Cause::temperature_not_a_number, chunk, p, -1, temperature[p]);
}

/// Warms the particles by the share of the dissipated energy (J/m^3, in the work space) that becomes heat.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::warm_by_dissipation(const Chunk& chunk, Work& work) const {
  const T share = static_cast<T>(chunk.body.thermal->dissipation_to_heat * chunk.body.volume / chunk.body.mass);
  T* const temperature = chunk.at(chunk.particles.temperature);
  fill_masses(chunk, work);
  for (int p = 0; p < chunk.end; ++p) {
    const T heat_of_mass = share * work.scalar[p];  // J/kg
    temperature[p] += heat_of_mass / of_phase(chunk, p, &ThermalProperties::heat_capacity);
    if (p < chunk.count)
      chunk.block.heat_of_dissipation += static_cast<double>(work.mass[p]) * static_cast<double>(heat_of_mass);
  }
}

/// Changes phases. Stored energy changes with the parameters where a particle takes those of the other phase: the
/// ledger calls it dissipated.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::change_phases(const Chunk& chunk, Work& work) {
  const Thermal& thermal = *chunk.body.thermal;
  const PhaseChange& change = *thermal.phase_change;
  T *const temperature = chunk.at(chunk.particles.temperature), *const fraction =
                                                                    chunk.at(chunk.particles.melted_fraction);
  mpm_material_batch request{};
  request.stored_energy = work.scalar;
  if (accounted_) update_material(chunk, request);
  T* const before = work.mass;
  if (accounted_) std::copy_n(work.scalar, chunk.end, before);
  alignas(64) T kept[chunk_size<T>];
  std::copy_n(temperature, chunk.end, kept);
  bool changed = false;
  for (int p = 0; p < chunk.end; ++p) {
    const bool was = is_melted(fraction[p]);
    change_phase(temperature[p], fraction[p], static_cast<T>(change.temperature), static_cast<T>(change.latent_heat),
                 static_cast<T>(thermal.solid.heat_capacity), static_cast<T>(change.melted.heat_capacity));
    changed = changed || was != is_melted(fraction[p]);
  }
  if (!accounted_ || !changed) return;
  std::swap_ranges(kept, kept + chunk.end, temperature);  // both energies at one temperature
  update_material(chunk, request);
  std::swap_ranges(kept, kept + chunk.end, temperature);
  const T* const size = sizes(chunk);
  for (int p = 0; p < chunk.count; ++p) {
    chunk.block.phase_change += chunk.body.volume * (size ? size[p] : T(1)) *
                                (static_cast<double>(before[p]) - static_cast<double>(work.scalar[p]));
  }
}

/// Changes phases in a pass of its own, where particles move after all else.
template <int D, class T, class Components>
double ParticleStep<D, T, Components>::change_phases(const StepInfo& step) {
  account_for(step);
  double sum = 0;
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    if (!bodies_[body].may_melt()) continue;
    for_each_block(body, false, [&](Block<D>& block, Work& work) {
      block.phase_change = 0;
      for_each_chunk_of(body, block, [&](const Chunk& chunk) { change_phases(chunk, work); });
    });
    for (const Block<D>& block : particles_[body].blocks) sum += block.phase_change;
  }
  return accounted_ ? sum : 0;
}

/// Updates the material with the parameters of each particle's phase: where a chunk holds both, either phase is
/// evaluated and each particle keeps its own.
template <int D, class T, class Components>
std::int32_t ParticleStep<D, T, Components>::update_by_phase(const Chunk& chunk, const mpm_material_batch& request) {
  const auto evaluate = [&](bool as_melted, const mpm_material_batch& batch) {
    const auto& parameters =
        as_melted ? chunk.body.thermal->phase_change->melted_parameters : chunk.body.material->parameters;
    return chunk.body.update_material(parameters.data(), &batch);
  };
  int count = 0;
  for (int p = 0; p < chunk.end; ++p) count += melted(chunk, p);
  if (count == 0 || count == chunk.end) return evaluate(count > 0, request);

  constexpr int most = 6 + 4;
  alignas(64) T outputs[most * chunk_size<T>];
  AlignedArray<T> states;
  states.require(std::size_t(chunk.particles.components) * chunk_size<T>);
  mpm_material_batch other = request;
  States copies{};
  T* next = states.data();
  std::vector<std::pair<T*, T*>> rows;  ///< rows of a melted particle, and of one that is not
  const auto add_rows = [&](void* melted_values, int components, T* solid_values) {
    for (int c = 0; c < components; ++c)
      rows.emplace_back(static_cast<T*>(melted_values) + c * chunk_size<T>, solid_values + c * chunk_size<T>);
  };
  for (std::size_t f = 0; f < chunk.particles.material_state.size(); ++f) {
    const int components = chunk.particles.material_state[f].field->components;
    std::copy_n(static_cast<T*>(request.state[f]), components * chunk_size<T>, next);
    add_rows(request.state[f], components, next);
    copies.fields[f] = next;
    next += components * chunk_size<T>;
  }
  other.state = copies.fields;
  T* place = outputs;
  for (auto [member, components] :
       {std::pair{&mpm_material_batch::kirchhoff_stress, int(Sym<D, T>::size)},
        std::pair{&mpm_material_batch::stored_energy, 1}, std::pair{&mpm_material_batch::dissipated_energy, 1},
        std::pair{&mpm_material_batch::wave_speed, 1}, std::pair{&mpm_material_batch::volume_ratio, 1}}) {
    if (!(request.*member)) continue;
    other.*member = place;
    add_rows(request.*member, components, place);
    place += components * chunk_size<T>;
  }
  const std::int32_t of_solid = evaluate(false, other), of_melted = evaluate(true, request);
  for (const auto& [mine, solid] : rows)
    for (int p = 0; p < chunk.end; ++p)
      if (!melted(chunk, p)) mine[p] = solid[p];
  return std::max(of_solid, of_melted);
}

}  // namespace mpm::cpu

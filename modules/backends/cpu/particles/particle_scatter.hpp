#pragma once
// This part of ParticleStep takes the particles to the grid. Coefficients of a chunk are made as component arrays, then
// as quads for the tile kernels: what a node gets is w (b + A d) + S grad w, d = node - particle.

#include <numbers>

#include "backends/cpu/particles/particle_boxes.hpp"
#include "backends/cpu/particles/particle_grips.hpp"
#include "backends/cpu/particles/particle_lists.hpp"
#include "operators/contact_geometry.hpp"

namespace mpm::cpu {

/// The channels that the operators of a pass add to.
template <int D, class T, class Components>
const std::vector<Channel>& ParticleStep<D, T, Components>::scattered_channels(const Pass& pass) {
  const std::uint64_t key = std::uint64_t(pass.acts) << 1 | (grid_.ledger_rests() ? 1 : 0);
  for (const auto& [known, channels] : scattered_channels_)
    if (known == key) return channels;
  std::vector<Channel>& channels = scattered_channels_.emplace_back(key, std::vector<Channel>{}).second;
  for (const Operator& operation : pass.operators)
    for (const Channel c : adds_[pass.fused()][static_cast<int>(operation.act)])
      if (grid_.has(c) && std::find(channels.begin(), channels.end(), c) == channels.end()) channels.push_back(c);
  return channels;
}

/// Calls visit(chunk, work) for the chunks of blocks with particles that no tile holds, in order and on one thread, so
/// that sums on the grid are the same for any number of threads. What is scattered meanwhile is theirs alone.
template <int D, class T, class Components>
template <class Visit>
void ParticleStep<D, T, Components>::scatter_far(int body, Visit&& visit) {
  if (!scene_.list || failure_.any()) return;
  Work& work = *work_[0];
  work.far_only = true;
  for (Block<D>& block : particles_[body].blocks)
    if (block.far > 0) for_each_chunk_of(body, block, [&](const Chunk& chunk) { visit(chunk, work); });
  work.far_only = false;
}

template <int D, class T, class Components>
Scattered ParticleStep<D, T, Components>::scatter(const Pass& pass, const StepInfo& step) {
  const std::vector<Channel>& channels = scattered_channels(pass);
  const bool energies = scene_.plan.accounts_at(step.step) && pass.has(Act::scatter_momentum) && !pass.remap();
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    for_each_block(body, true, [&](Block<D>& block, Work& work) {
      const bool extends = pass.has(Act::scatter_momentum) && !pass.remap();
      if (extends) begin_reach(block, work);
      block.scattered_energy = block.scattered_mass = 0, block.scattered_momentum = {};
      if (pass.has(Act::scatter_heat)) block.heat = 0;
      block.far = 0;
      if (pass.has(Act::scatter_force)) load_mean(body, block, work, mean_stress);
      for_each_chunk_of(body, block, [&](const Chunk& chunk) {
        if (!scatter_chunk(pass, step, chunk, work, motion, false)) {
          if (stencils_hold(chunk, work)) throw std::logic_error("a particle left the tile of its block");
          return note_too_long(chunk, work);
        }
        if (energies) block.scattered_energy += kinetic_energy(chunk, work), add_scattered(chunk);
        if (pass.has(Act::scatter_heat)) block.heat += heat_of(chunk, work);
        if (scene_.list) block.far += static_cast<std::uint32_t>(work.lists.far_of_chunk);
      });
      if (extends) end_reach(block, work);
      flush(body, block, work, channels);
    });
    scatter_far(body, [&](const Chunk& chunk, Work& work) { scatter_chunk(pass, step, chunk, work, motion, false); });
  }
  failure_.note(std::exchange(failed_forces_, {}));
  failure_.raise();
  return energies ? sum_scattered() : Scattered();
}

/// Adds mass and momentum of a chunk's particles to its block's sums.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::add_scattered(const Chunk& chunk) const {
  const T* const size = sizes(chunk);
  for (int p = 0; p < chunk.count; ++p) {
    const double mass = chunk.body.mass * (size ? double(size[p]) : 1.0);
    chunk.block.scattered_mass += mass;
    for (int c = 0; c < D; ++c) chunk.block.scattered_momentum[c] += mass * chunk.motion[c * chunk_size<T> + p];
  }
}

template <int D, class T, class Components>
Scattered ParticleStep<D, T, Components>::sum_scattered() const {
  Scattered sum;
  for (const auto& particles : particles_)
    for (const Block<D>& block : particles.blocks) {
      sum.kinetic_energy += block.scattered_energy;
      sum.mass += block.scattered_mass;
      for (int c = 0; c < D; ++c) sum.momentum[c] += block.scattered_momentum[c];
    }
  return sum;
}

template <int D, class T, class Components>
double ParticleStep<D, T, Components>::scattered_heat() const {
  double sum = 0;
  for (const auto& particles : particles_)
    for (const Block<D>& block : particles.blocks) sum += block.heat;
  return sum;
}

/// Whether what contact looks at is scattered: by the blocks alone that may come to a node where it acts.
template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::scatters_contact(const Pass& pass, const Block<D>& block) {
  return block.may_meet && pass.has(Act::scatter_contact);
}

/// Whether current volumes are scattered.
template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::wants_volume(const Pass& pass, const Block<D>& block) const {
  return scatters_contact(pass, block) || (pass.has(Act::scatter_heat) && grid_.has(heated_volume)) ||
         (pass.has(Act::scatter_force) && mean_stress >= 0);
}

/// Asks the material for what a pass that scatters wants of it.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::want_of_material(const Pass& pass, const Block<D>& block, Work& work,
                                                      mpm_material_batch& request) const {
  if (pass.has(Act::scatter_force)) request.kirchhoff_stress = work.stress;
  if (wants_volume(pass, block)) request.volume_ratio = work.volume_ratio;
}

/// Scatters a chunk to its tiles; returns false, and scatters nothing, when a particle is outside of them or of its
/// stencil. With `evaluated` what is wanted of the material is at hand. The scatter and the fused pass, which must
/// agree to the last bit, both call it, so it is compiled once.
template <int D, class T, class Components>
[[gnu::noinline]] bool ParticleStep<D, T, Components>::scatter_chunk(const Pass& pass, const StepInfo& step,
                                                                     const Chunk& chunk, Work& work, Channel momentum,
                                                                     bool evaluated) {
  const bool separate = grid_.has(force) && (chunk.block.may_meet || !grid_.field(force).for_contact);
  const bool merged = pass.has(Act::scatter_force) && !separate;
  if (pass.has(Act::scatter_force)) fetch_initial_positions(chunk);
  const bool by_gradient = pass.has(Act::scatter_force) && !scene_.stress_by_affine;
  const bool loads_by_gradient = pass.has(Act::scatter_force) && chunk.body.loads && chunk.body.loads->at_points();
  const bool for_contact = scatters_contact(pass, chunk.block);
  evaluate_shape(chunk, work, by_gradient || loads_by_gradient || for_contact);
  if (!stencils_hold(chunk, work)) return false;
  if (!place_to_scatter(chunk, work, pass.has(Act::scatter_momentum) && !pass.remap() && !work.far_only)) return false;
  work.clock.lap(Phase::weights);
  if (!evaluated && (pass.has(Act::scatter_force) || wants_volume(pass, chunk.block))) {
    mpm_material_batch request{};
    want_of_material(pass, chunk.block, work, request);
    update_material(chunk, request);
    if (request.kirchhoff_stress && chunk.particles.artificial_pressure >= 0) add_artificial_pressure(chunk, work);
    work.clock.lap(Phase::material);
  }
  if (pass.has(Act::scatter_force) && mean_stress >= 0) {
    gather_mean(chunk, work, mean_stress);
    take_mean_stress(chunk, work);
  }
  if (chunk.particles.size >= 0 && pass.has(Act::scatter_force)) weigh_stress(chunk, work);
  if (pass.has(Act::scatter_momentum)) {
    momentum_coefficients(chunk, work);
    const bool adds_to_A = scene_.stress_by_affine && scene_.has(MPM_SCATTERS_AFFINE);
    const bool in_packing = merged && adds_to_A && !scene_.moment_of_particle;
    if (merged) {
      if (!in_packing) stress_coefficients(chunk, work, step.dt, adds_to_A);
      if (scene_.axisymmetric) add_hoop_force(chunk, work, step.dt);
      if (is_pulled(chunk)) add_body_force(chunk, work, step.time, step.dt);
    }
    const bool affine = scene_.has(MPM_SCATTERS_AFFINE) || (merged && scene_.stress_by_affine);
    const T stress = in_packing ? stress_scale(chunk, step.dt) : T(0);
    add_to_tile(chunk, work, momentum, work.mass, true, affine, merged && by_gradient, stress);
    if (higher_kernels_.scatter) add_higher_to_tile(chunk, work, momentum, chunk.higher());
  }
  if (pass.has(Act::scatter_force) && separate) {
    scatter_forces(chunk, work, step.time);
    if (chunk.body.loads) scatter_loads(chunk, work, step.time);
  }
  if (for_contact) scatter_contact_fields(chunk, work);
  if (pass.has(Act::scatter_heat)) scatter_heat(chunk, work);
  if (chunk.particles.grip >= 0 && pass.has(Act::scatter_momentum) && !pass.remap())
    scatter_grips(chunk, work, step.time + step.dt);
  return true;
}

/// The factors of the body's mass and volume, 2 pi r in axisymmetric scenes; null where all particles are equal.
template <int D, class T, class Components>
const T* ParticleStep<D, T, Components>::sizes(const Chunk& chunk) const {
  return chunk.particles.size < 0 ? nullptr : chunk.at(chunk.particles.size);
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::fill_masses(const Chunk& chunk, Work& work) const {
  const T mass = static_cast<T>(chunk.body.mass);
  std::fill(work.mass, work.mass + chunk.end, mass);
  if (const T* const size = sizes(chunk))
    for (int p = 0; p < chunk.end; ++p) work.mass[p] = mass * size[p];
}

/// The distance of a block's first node from the axis, cells; positions count from that node.
template <int D, class T, class Components>
T ParticleStep<D, T, Components>::cells_from_axis(const Scene<D, T>& scene, const Block<D>& block) {
  return static_cast<T>(block.at[0] * block_side<D> + scene.domain.lower[0] / scene.domain.cell_size);
}

/// The distance of a pack of particles from the axis, m.
template <int D, class T, class Components>
Lanes<T> ParticleStep<D, T, Components>::radius(const Chunk& chunk, int p) const {
  const Lanes<T> x = Lanes<T>::load(chunk.at(Particles<D, T>::position) + p);
  return static_cast<T>(scene_.domain.cell_size) * (x + Lanes<T>(cells_from_axis(scene_, chunk.block)));
}

/// The place of a particle along an axis, m.
template <int D, class T, class Components>
double ParticleStep<D, T, Components>::place_of(const Chunk& chunk, int p, int axis) const {
  const T x = chunk.at(Particles<D, T>::position + axis)[p];
  return scene_.domain.lower[axis] + scene_.domain.cell_size * cells_from_corner(scene_.domain, chunk.block, axis, x);
}

/// The section of a pack of particles of these volumes: that of rings, else the volume.
template <int D, class T, class Components>
Lanes<T> ParticleStep<D, T, Components>::section(const Chunk& chunk, const Lanes<T>& volume, int p) const {
  if (!scene_.axisymmetric) return volume;
  return volume / (static_cast<T>(2 * std::numbers::pi) * radius(chunk, p));
}

/// Multiplies the stress by the sizes, so that forces are those of the particles' volumes.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::weigh_stress(const Chunk& chunk, Work& work) const {
  const T* const size = sizes(chunk);
  for (int k = 0; k < Sym<D, T>::size; ++k)
    for (int p = 0; p < chunk.end; ++p) work.stress[k * chunk_size<T> + p] *= size[p];
}

/// Adds b += -factor V0 tau_zz / r along the radius; the stress has been weighed.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::add_hoop_force(const Chunk& chunk, Work& work, double factor) const {
  using L = Lanes<T>;
  const T scale = static_cast<T>(-factor * chunk.body.volume);
  for (int p = 0; p < chunk.end; p += L::width) {
    const L tau = L::load(work.stress + 2 * chunk_size<T> + p);
    (L::load(work.b + p) + scale * tau / radius(chunk, p)).store(work.b + p);
  }
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::momentum_coefficients(const Chunk& chunk, Work& work) {
  fill_masses(chunk, work);
  const States state = transfer_states(chunk);
  const mpm_scatter_batch batch{static_cast<std::uint32_t>(chunk.end),
                                chunk_size<T>,
                                D,
                                0,
                                work.mass,
                                chunk.motion,
                                state.fields,
                                work.b,
                                scene_.has(MPM_SCATTERS_AFFINE) ? work.A : nullptr};
  Components::scatter(scene_, batch);
}

/// The factor by which the stress enters A or S: -factor V0, with D^-1 where that is one for all particles.
template <int D, class T, class Components>
T ParticleStep<D, T, Components>::stress_scale(const Chunk& chunk, double factor) const {
  const bool of_all = scene_.stress_by_affine && !scene_.moment_of_particle;
  return static_cast<T>(-factor * chunk.body.volume * (of_all ? scene_.inverse_moment : 1.0));
}

/// Puts -factor V0 tau D^-1 into A (added where a particle has a D of its own, or set), or -factor V0 tau into S.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::stress_coefficients(const Chunk& chunk, Work& work, double factor, bool add) {
  const bool by_affine = scene_.stress_by_affine, of_particle = by_affine && scene_.moment_of_particle;
  const T scale = stress_scale(chunk, factor);
  T* const out = by_affine ? work.A : work.S;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      T* const target = out + (i * D + j) * chunk_size<T>;
      if (of_particle) {
        if (!add) std::fill(target, target + chunk.end, T(0));
        for (int k = scene_.list ? 0 : j; k < (scene_.list ? D : j + 1); ++k) {
          const T* const tau = work.stress + Sym<D, T>::index(i, k) * chunk_size<T>;
          const T* const inverse = work.inverse_moment + (scene_.list ? k * D + j : j) * chunk_size<T>;
          for (int p = 0; p < chunk.end; ++p) target[p] += scale * tau[p] * inverse[p];
        }
        continue;
      }
      const T* const tau = work.stress + Sym<D, T>::index(i, j) * chunk_size<T>;
      for (int p = 0; p < chunk.end; ++p) target[p] = scale * tau[p];
    }
}

/// Makes quads of b (when `constant`), A + `stress` tau and S, with `last` as the fourth scalar of the constant one: in
/// cells, and about the stencil's first node instead of the particle.
template <int D, class T, class Components>
template <bool Affine, bool Gradient, bool Stress>
void ParticleStep<D, T, Components>::pack_coefficients(Work& work, const T* last, bool constant, int count, T stress) {
  using L = Lanes<T>;
  const T h = static_cast<T>(scene_.domain.cell_size), inverse_h = T(1) / h;
  constexpr int groups = quad_groups(D, Affine, Gradient), first_s = 1 + (Affine ? D : 0);
  const L zero(T(0));
  for (int p = 0; p < count; p += L::width) {
    L q[groups][4];
#pragma GCC unroll 7
    for (int g = 0; g < groups; ++g) q[g][2] = q[g][3] = zero;
    if (last) q[0][3] = L::load(last + p);
    for (int c = 0; c < D; ++c) q[0][c] = constant ? L::load(work.b + c * chunk_size<T> + p) : zero;
#pragma GCC unroll 3
    for (int a = 0; Affine && a < D; ++a) {
      const L f = L::load(work.offset + a * chunk_size<T> + p);
      for (int c = 0; c < D; ++c) {
        L A = L::load(work.A + (c * D + a) * chunk_size<T> + p);
        if constexpr (Stress) A = A + stress * L::load(work.stress + Sym<D, T>::index(c, a) * chunk_size<T> + p);
        q[1 + a][c] = h * A;
        q[0][c] = q[0][c] - q[1 + a][c] * f;
      }
    }
#pragma GCC unroll 3
    for (int a = 0; Gradient && a < D; ++a)
      for (int c = 0; c < D; ++c) q[first_s + a][c] = inverse_h * L::load(work.S + (c * D + a) * chunk_size<T> + p);
    for (int g = 0; g < groups; ++g) store_quads<T>(work.quads + quad_place<T>(p, groups) + g * quad_group<T>, q[g]);
  }
}
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::pack_coefficients(Work& work, const T* last, bool constant, bool affine,
                                                       bool gradient, int count, T stress) {
  if (stress != T(0)) return pack_coefficients<true, false, true>(work, last, constant, count, stress);
  if (affine)
    return gradient ? pack_coefficients<true, true, false>(work, last, constant, count, stress)
                    : pack_coefficients<true, false, false>(work, last, constant, count, stress);
  return gradient ? pack_coefficients<false, true, false>(work, last, constant, count, stress)
                  : pack_coefficients<false, false, false>(work, last, constant, count, stress);
}

/// Scatters the coefficients of a chunk into the tile of a channel. A comes with `stress` times its stress, which has
/// no gradient beside it.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::add_to_tile(const Chunk& chunk, Work& work, Channel channel, const T* last,
                                                 bool constant, bool affine, bool gradient, T stress) {
  pack_coefficients(work, last, constant, affine, gradient, chunk.end, stress);
  work.clock.lap(Phase::coefficients);
  if (scene_.list) {
    T* const tile = work.tile[channel].data();
    const auto kernel = list_kernels_.scatter_lists[affine][gradient];
    if (scene_.evaluate_box && !work.far_only)
      list_kernels_.scatter_boxes[affine][gradient](tile, work.boxes.boxes(), work.quads, chunk.count);
    if (work.lists.any && !work.far_only) kernel(tile, work.lists.near_lists(), work.quads, chunk.count);
    if (work.lists.any && work.far_only)
      kernel(grid_.channel(channel, chunk.body.field), work.lists.far_lists(), work.quads, chunk.count);
    return;
  }
  const Stencils<T> stencils{work.first, work.shared_stencils, work.weight, work.gradient, chunk.ahead(false)};
  kernels_.scatter[affine][gradient](work.tile[channel].data(), stencils, work.quads, chunk.count);
  work.clock.lap(Phase::scatter);
}

/// Scatters momenta of the polynomials beyond affine on stencils that were placed to scatter.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::add_higher_to_tile(const Chunk& chunk, Work& work, Channel channel,
                                                        const T* coefficients) {
  const Stencils<T> stencils{work.first, false, work.weight, work.gradient, {}};
  higher_kernels_.scatter(work.tile[channel].data(), stencils, work.offset, coefficients, work.mass, chunk.count);
  work.clock.lap(Phase::scatter);
}

/// Whether forces per mass act on a chunk.
template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::is_pulled(const Chunk& chunk) const {
  return chunk.body.loads && chunk.body.loads->gives(ExternalForce::body_force);
}

/// Scatters the forces of the stress, and with them forces per mass where these have no channel of their own.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_forces(const Chunk& chunk, Work& work, double time) {
  stress_coefficients(chunk, work, 1.0, false);
  const bool pulled = is_pulled(chunk) && !grid_.has(body_force), constant = scene_.axisymmetric || pulled;
  if (constant) std::fill(work.b, work.b + D * chunk_size<T>, T(0));
  if (scene_.axisymmetric) add_hoop_force(chunk, work, 1.0);
  if (pulled) add_body_force(chunk, work, time, 1.0);
  add_to_tile(chunk, work, force, nullptr, constant, scene_.stress_by_affine, !scene_.stress_by_affine);
}

/// Asks for what add_body_force reads of the particles' first places, which lie far apart, while other work is done.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::fetch_initial_positions(const Chunk& chunk) const {
  if (!is_pulled(chunk) || !chunk.body.loads->accelerations_use_initial_position()) return;
  for (int p = 0; p < chunk.count; ++p) __builtin_prefetch(chunk.body.initial_position + std::size_t(chunk.ids[p]) * D);
}

/// Adds `factor` m a(x, X, t) of the forces per mass to the coefficients b.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::add_body_force(const Chunk& chunk, Work& work, double time, double factor) {
  const BodyLoads& loads = *chunk.body.loads;
  const bool asks_x = loads.accelerations_use_position(), asks_X = loads.accelerations_use_initial_position();
  T x[D][chunk_size<T>], X[D][chunk_size<T>], f[D][chunk_size<T>];
  PointArrays<T> places;
  std::array<T*, 3> forces{};
  for (int a = 0; a < D; ++a) {
    forces[a] = f[a];
    if (asks_x) places.x[a] = x[a];
    if (asks_X) places.X[a] = X[a];
    for (int p = 0; asks_x && p < chunk.count; ++p) x[a][p] = static_cast<T>(place_of(chunk, p, a));
    for (int p = 0; asks_X && p < chunk.count; ++p)
      X[a][p] = static_cast<T>(chunk.body.initial_position[std::size_t(chunk.ids[p]) * D + a]);
  }
  FirstFailure failures;
  loads.accelerations(static_cast<std::size_t>(chunk.count), chunk.ids, places, time, forces, failures);
  note_forces(failures);
  const T mass = static_cast<T>(factor * chunk.body.mass);
  const T* const size = sizes(chunk);
  for (int c = 0; c < D; ++c) {
    T* const b = work.b + c * chunk_size<T>;
    if (size)
      for (int p = 0; p < chunk.count; ++p) b[p] += mass * size[p] * f[c][p];
    else
      for (int p = 0; p < chunk.count; ++p) b[p] += mass * f[c][p];
  }
}

/// Adds what loads give, w b + S grad w, each kind into its own channel.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_loads(const Chunk& chunk, Work& work, double time) {
  const BodyLoads& loads = *chunk.body.loads;
  const auto read = [&](int p, LoadedParticle& particle) {
    for (int a = 0; a < D; ++a) {
      particle.x[a] = particle.X[a] = place_of(chunk, p, a);
      particle.v[a] = chunk.motion[a * chunk_size<T> + p];
      if (chunk.body.initial_position) particle.X[a] = chunk.body.initial_position[std::size_t(chunk.ids[p]) * D + a];
    }
    const T* const deformation = chunk.at(chunk.particles.deformation);
    for (int k = 0; k < D * D; ++k) particle.F[k] = deformation[k * chunk_size<T> + p];
  };
  const auto give = [&](int p, const LoadCoefficients& given) {
    for (int c = 0; c < D; ++c) work.b[c * chunk_size<T> + p] = static_cast<T>(given.b[c]);
    for (int k = 0; k < D * D; ++k) work.S[k * chunk_size<T> + p] = static_cast<T>(given.S[k]);
  };
  FirstFailure failures;
  for (const ExternalChannel& load : external) {
    if (!loads.gives(load.kind) || !grid_.has(load.channel)) continue;
    std::fill(work.b, work.b + D * chunk_size<T>, T(0));
    if (load.kind == ExternalForce::body_force) {
      add_body_force(chunk, work, time, 1.0);
      add_to_tile(chunk, work, load.channel, nullptr, true, false, false);
      continue;
    }
    std::fill(work.S, work.S + D * D * chunk_size<T>, T(0));
    if (loads.evaluate(load.kind, chunk.count, chunk.ids, time, read, give, failures))
      add_to_tile(chunk, work, load.channel, nullptr, true, false, true);
  }
  note_forces(failures);
}

/// Scatters w m (x_p - X_p + (I - F^-1) d), which springs between bodies pull by.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_displacements(const Chunk& chunk, Work& work) {
  std::fill(work.b, work.b + D * chunk_size<T>, T(0));
  for (int p = 0; p < chunk.count; ++p) {
    const double* const start = chunk.body.initial_position + std::size_t(chunk.ids[p]) * D;
    for (int c = 0; c < D; ++c)
      work.b[c * chunk_size<T> + p] = work.mass[p] * static_cast<T>(place_of(chunk, p, c) - start[c]);
  }
  using L = Lanes<T>;
  const T* const deformation = chunk.at(chunk.particles.deformation);
  for (int p = 0; p < chunk.end; p += L::width) {
    Mat<D, L> F;
    for (int k = 0; k < D * D; ++k) F.m[k] = L::load(deformation + k * chunk_size<T> + p);
    const Mat<D, L> gradient = displacement_gradient(F);
    for (int k = 0; k < D * D; ++k) (L::load(work.mass + p) * gradient.m[k]).store(work.A + k * chunk_size<T> + p);
  }
  add_to_tile(chunk, work, mass_displacement, nullptr, true, true, false);
}

/// Scatters w m times values of a law of contact.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_contact_state(const Chunk& chunk, Work& work, int values,
                                                           Channel channel) {
  const int states = static_cast<int>(scene_.experiment.contact_state().size());
  std::fill(work.b, work.b + D * chunk_size<T>, T(0));
  for (int k = 0; k < states; ++k)
    for (int p = 0; p < chunk.end; ++p) work.b[k * chunk_size<T> + p] = work.mass[p] * chunk.at(values + k)[p];
  add_to_tile(chunk, work, channel, nullptr, true, false, false);
}

/// Scatters V grad w, V = J V0, m grad w where the normal reads it, and w m (x_p - x_node). A ring has the gradients of its
/// section, as its volume and mass grow away from the axis.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_contact_fields(const Chunk& chunk, Work& work) {
  const T volume = static_cast<T>(chunk.body.volume);
  fill_masses(chunk, work);
  for (int p = 0; p < chunk.end; ++p) work.scalar[p] = volume * work.volume_ratio[p];
  std::fill(work.S, work.S + D * D * chunk_size<T>, T(0));
  std::fill(work.A, work.A + D * D * chunk_size<T>, T(0));
  for (int c = 0; c < D; ++c)
    for (int p = 0; p < chunk.end; ++p) {
      work.S[(c * D + c) * chunk_size<T> + p] = work.scalar[p];
      work.A[(c * D + c) * chunk_size<T> + p] = -work.mass[p];
    }
  if (const T* const size = sizes(chunk))
    for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
      const Lanes<T> whole = Lanes<T>::load(work.scalar + p) * Lanes<T>::load(size + p);
      const Lanes<T> cut = section(chunk, whole, p);
      for (int c = 0; c < D; ++c) cut.store(work.S + (c * D + c) * chunk_size<T> + p);
    }
  add_to_tile(chunk, work, volume_gradient, nullptr, false, false, true);
  if (mass_position >= 0) add_to_tile(chunk, work, mass_position, nullptr, false, true, false);
  if (mass_displacement >= 0) scatter_displacements(chunk, work);
  if (mass_state >= 0) {
    scatter_contact_state(chunk, work, chunk.particles.contact_state, mass_state);
    scatter_contact_state(chunk, work, chunk.particles.contact_gain, mass_gain);
  }
  if (mass_gradient < 0) return;
  for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
    const Lanes<T> cut = section(chunk, Lanes<T>::load(work.mass + p), p);
    for (int c = 0; c < D; ++c) cut.store(work.S + (c * D + c) * chunk_size<T> + p);
  }
  add_to_tile(chunk, work, mass_gradient, nullptr, false, false, true);
}

}  // namespace mpm::cpu

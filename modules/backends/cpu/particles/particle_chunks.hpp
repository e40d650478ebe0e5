#pragma once
// This part of ParticleStep loops over blocks and chunks, and holds what scatter and gather share.

#include <cmath>
#include <tuple>

#include "backends/cpu/flush_denormals.hpp"
#include "backends/cpu/particles/particle_step.hpp"

namespace mpm::cpu {

template <int D, class T, class Components>
ParticleStep<D, T, Components>::ParticleStep(const Scene<D, T>& scene, Grid<D, T>& grid,
                                             std::vector<Particles<D, T>>& particles, std::vector<Body<D, T>> bodies)
    : NamedChannels{scene.plan},
      scene_(scene),
      grid_(grid),
      particles_(particles),
      bodies_(std::move(bodies)),
      kernels_(scene.list ? tile_kernels_of_lists<D, T>() : tile_kernels<D, T>(scene.width)),
      list_kernels_(list_kernels<D, T>()),
      higher_kernels_(higher_kernels<D, T>(scene.width, scene.plan.basis_order)) {
  for_each_pass(scene.plan.step, [&](const Pass& pass) {
    for (const Operator& operation : pass.operators)
      adds_[pass.fused()][static_cast<int>(operation.act)] = channels_of(scene.plan, operation.adds);
  });
  for (std::size_t k = 0; k < scene.experiment.grips.size(); ++k)
    grips_.push_back({channel_of(scene.plan, grip_field(k)), channel_of(scene.plan, grip_field(k) + "_before")});
  int motion_components = 0;
  for (const Particles<D, T>& body : particles) motion_components = std::max(motion_components, body.motion_components);
  for (int thread = 0; thread < scene.threads; ++thread) {
    work_.push_back(std::make_unique<Work>());
    Work& work = *work_.back();
    work.tile.resize(grid.channels());
    for (const auto& acts : adds_)
      for (const auto& channels : acts)
        for (const Channel c : channels) work.tile[c].require(kernels_.scalars);
    work.velocity_tile.require(kernels_.scalars);
    if (scene.has(MPM_GATHERS_INCREMENT)) work.increment_tile.require(kernels_.scalars);
    if (mean_stress >= 0 || reached >= 0) work.mean_tile.require(kernels_.scalars);
    if (scene.list) {
      work.lists.require(scene.capacity);
      if (scene.evaluate_box) work.boxes.require();
      if (const int points = scene.plan.sample_points; points > 0)
        work.moved_corners.require(std::size_t(points) * D * chunk_size<T>);
      std::fill(work.offset, work.offset + D * chunk_size<T>, T(0));  // lists count from the particle itself
    }
    if (scene.plan.basis_functions > 0)
      work.higher.require(std::size_t(scene.plan.basis_functions) * D * chunk_size<T>);
    if (scene.plan.fused() && scene.has(MPM_REPLACES_MOTION))
      work.passing_motion.require(std::size_t(motion_components) * chunk_size<T>);
    if (!scene.plan.filters() && !scene.experiment.has_temperature()) continue;
    work.scratch_velocity.require(std::size_t(D) * chunk_size<T>);
    work.scratch_state.require(std::size_t(motion_components) * chunk_size<T>);
  }
  measures_drift_ = !scene.list && !scene.plan.particle_field(0, "domain");
  for (int axis = 0; axis < D; ++axis) measures_drift_ = measures_drift_ && !scene.domain.periodic(axis);
  if (measures_drift_) find_first_places();
}

/// Finds first places from the shape itself, to a part of a cell; see drift.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::find_first_places() {
  Work& work = *work_[0];
  alignas(64) T position[D * chunk_size<T>];
  for (int k = 0; k < D * chunk_size<T>; ++k) position[k] = 2 + T(k % chunk_size<T>) / chunk_size<T>;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    const mpm_shape_batch batch{chunk_size<T>,
                                chunk_size<T>,
                                D,
                                0,
                                position,
                                scene_.half_size ? particles_[body].half_size.data() : nullptr,
                                nullptr,
                                work.base,
                                work.offset,
                                work.weight,
                                nullptr,
                                scene_.plan.stencil.second_moment ? work.second_moment : nullptr};
    Components::evaluate_shape(scene_, batch);
    for (int axis = 0; axis < D; ++axis) {
      const std::int32_t* const base = work.base + axis * chunk_size<T>;
      const auto next = std::find(base, base + chunk_size<T>, base[0] + 1) - base;
      bodies_[body].first_place[axis] = 1 + T(next) / chunk_size<T> - base[0];
    }
  }
}

/// Calls visit(block, work) for every block of a body. Where `coloured`, no two blocks in work at once share a node,
/// and the order of those that do is always the same.
template <int D, class T, class Components>
template <class Visit>
void ParticleStep<D, T, Components>::for_each_block(int body, bool coloured, Visit&& visit) {
  Particles<D, T>& particles = particles_[body];
  const auto guarded = [&](std::uint32_t first, std::uint32_t last, Work& work) {
    try {
      for (std::uint32_t b = first; b < last; ++b) {
        work.clock.start();
        visit(particles.blocks[b], work);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!exception_) exception_ = std::current_exception();
    }
  };
  if (coloured) {
    UnitPass pass(particles.order, units_, scene_.team->spin());
    const auto part = [&](int thread) {
      const FlushDenormals flush;
      pass.run(thread, [&](const Unit& unit) { guarded(unit.first, unit.last, *work_[thread]); });
    };
    if (particles.order.of_thread.size() > 1)
      scene_.team->share(part);
    else
      part(0);
  } else {
    scene_.team->for_each_piece(particles.blocks.size(), 8, [&](std::size_t first, std::size_t last, int thread) {
      const FlushDenormals flush;
      guarded(first, last, *work_[thread]);
    });
  }
  if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
}

/// Brings a share of the nodes that the next block meets first into the cache, with chunk number `share` of this one:
/// blocks are in order along the last axis, so these lie ahead on it.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::fetch_nodes_of_next(int body, const Block<D>& block, int share) {
  const std::vector<Block<D>>& blocks = particles_[body].blocks;
  const std::size_t next = static_cast<std::size_t>(&block - blocks.data()) + 1;
  if (next >= blocks.size() || grid_.slots() == 0) return;
  constexpr int columns = neighbour_count<D> / 3, bytes = block_nodes * 4 * static_cast<int>(sizeof(T));
  const int chunks = static_cast<int>((block.count + chunk_size<T> - 1) / chunk_size<T>);
  for (int column = columns * share / chunks; column < columns * (share + 1) / chunks; ++column) {
    const std::size_t first = std::size_t(blocks[next].neighbours[3 * column + 2]) * block_nodes * 4;
    for (const Channel c : {motion, next_motion})
      if (grid_.has(c)) {
        const char* const nodes = reinterpret_cast<const char*>(grid_.channel(c, bodies_[body].field) + first);
        for (int byte = 0; byte < bytes; byte += 64) __builtin_prefetch(nodes + byte, 1, 2);
      }
  }
}

template <int D, class T, class Components>
template <class Visit>
void ParticleStep<D, T, Components>::for_each_chunk_of(int body, Block<D>& block, Visit&& visit, T* motion) {
  Particles<D, T>& particles = particles_[body];
  for_each_chunk<T>(block, [&](std::uint32_t i, int count) {
    const char* const next = reinterpret_cast<const char*>(particles.chunk(std::min(i + 1, particles.chunks - 1)));
    fetch_nodes_of_next(body, block, static_cast<int>(i - block.first_chunk));
    T* const values = particles.chunk(i);
    T* const kept = values + Particles<D, T>::velocity * chunk_size<T>;
    visit(Chunk{particles, bodies_[body], block, values, motion ? motion : kept, particles.ids(i), count, padded(count),
                next});
  });
}

template <int D, class T, class Components>
typename ParticleStep<D, T, Components>::States ParticleStep<D, T, Components>::material_states(
    const Chunk& chunk) const {
  States result{};
  const std::vector<StoredField>& fields = chunk.particles.material_state;
  for (std::size_t f = 0; f < fields.size(); ++f) result.fields[f] = chunk.at(fields[f].first);
  return result;
}
template <int D, class T, class Components>
typename ParticleStep<D, T, Components>::States ParticleStep<D, T, Components>::transfer_states(
    const Chunk& chunk) const {
  States result{};
  const std::vector<StoredField>& fields = chunk.particles.transfer_state;
  for (std::size_t f = 0; f < fields.size(); ++f) result.fields[f] = chunk.motion_at(fields[f].first);
  return result;
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::measure_phases(bool on) {
  for (auto& work : work_) work->clock.measure(on);
  measured_from_ = PhaseClock::now();
  measured_since_ = std::chrono::steady_clock::now();
}

/// Adds up the seconds of all threads; the length of a tick follows from the time since measuring began.
template <int D, class T, class Components>
std::map<std::string, double> ParticleStep<D, T, Components>::phase_seconds() const {
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - measured_since_;
  const double second = static_cast<double>(PhaseClock::now() - measured_from_) / elapsed.count();
  std::map<std::string, double> seconds;
  for (std::size_t phase = 0; phase < phase_names.size(); ++phase) {
    PhaseClock::Ticks ticks = 0;
    for (const auto& work : work_) ticks += work->clock.ticks[phase];
    if (ticks > 0) seconds[phase_names[phase]] = static_cast<double>(ticks) / second;
  }
  return seconds;
}

/// Notes a failure of particle p of a chunk.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::note(Cause cause, const Chunk& chunk, int p, int axis, double value) {
  const std::lock_guard lock(mutex_);
  failure_.note({cause, chunk.body.index, static_cast<std::size_t>(chunk.ids[p]), axis, value});
}

/// Notes the forces on a chunk that are not finite.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::note_forces(const FirstFailure& found) {
  if (!found.any()) return;
  const std::lock_guard lock(mutex_);
  failed_forces_.note(found);
}

/// Evaluates the weights of a chunk (and gradients, and what the second moment needs). Several passes that must agree
/// to the last bit call it, so it is compiled once.
template <int D, class T, class Components>
[[gnu::noinline]] void ParticleStep<D, T, Components>::evaluate_shape(const Chunk& chunk, Work& work, bool gradients) {
  if (scene_.evaluate_box) return evaluate_boxes(chunk, work, gradients);
  if (scene_.list) return evaluate_lists(chunk, work, gradients);
  const bool moments = scene_.plan.stencil.second_moment;
  const mpm_shape_batch batch{static_cast<std::uint32_t>(chunk.end),
                              chunk_size<T>,
                              D,
                              0,
                              chunk.at(Particles<D, T>::position),
                              scene_.half_size ? chunk.particles.half_size.data() : nullptr,
                              chunk.particles.domain < 0 ? nullptr : chunk.at(chunk.particles.domain),
                              work.base,
                              work.offset,
                              work.weight,
                              gradients ? work.gradient : nullptr,
                              moments ? work.second_moment : nullptr};
  Components::evaluate_shape(scene_, batch);
  if (moments) invert_moments(chunk, work);
}

template <int D, class T, class Components>
T ParticleStep<D, T, Components>::weight_along(const Work& work, int width, int axis, int particle) {
  T sum = 0;
  for (int k = 0; k < width; ++k) sum += work.weight[(axis * width + k) * chunk_size<T> + particle];
  return sum;
}

/// Returns false when a domain has outgrown its stencil, which then has no weight (mpm_shape_batch); only domains grow.
template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::stencils_hold(const Chunk& chunk, const Work& work) const {
  if (scene_.list || chunk.particles.domain < 0) return true;
  int beyond = 0;
  for (int axis = 0; axis < D; ++axis)
    for (int p = 0; p < chunk.end; ++p) beyond |= !(weight_along(work, scene_.width, axis, p) > T(0.5));
  return beyond == 0;
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::note_too_long(const Chunk& chunk, const Work& work) {
  for (int p = 0; p < chunk.count; ++p)
    for (int axis = 0; axis < D; ++axis)
      if (!(weight_along(work, scene_.width, axis, p) > T(0.5))) note(Cause::domain_outgrew_stencil, chunk, p);
}

/// Finds where stencils begin in the tile to scatter to; the work space gathers what part of it they reach. Returns
/// false when one lies outside.
template <int D, class T, class Components>
bool ParticleStep<D, T, Components>::place_to_scatter(const Chunk& chunk, Work& work, bool extend_reach) const {
  if (scene_.list) return place_lists(chunk, work, extend_reach);
  if (extend_reach) {
    for (int axis = 0; axis < D; ++axis) {
      const std::int32_t* const base = work.base + axis * chunk_size<T>;
      typename Work::Integers low = work.lowest[axis], high = work.highest[axis];
      for (int p = 0; p < chunk.end; p += Work::integers) {
        const auto node = *reinterpret_cast<const typename Work::Integers*>(base + p);
        low = node < low ? node : low, high = node > high ? node : high;
      }
      if (any_lane<float>((low < -1) | (high > block_side<D>))) return false;
      work.lowest[axis] = low, work.highest[axis] = high;
    }
  }
  number_stencils(work, chunk.end);
  return true;
}

/// Prepares the work space before the first chunk of a block extends its reach.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::begin_reach(Block<D>& block, Work& work) const {
  block.reach = {};
  for (int axis = 0; axis < D; ++axis) {
    work.lowest[axis] = block.reach.lowest[axis] - typename Work::Integers{};
    work.highest[axis] = block.reach.highest[axis] - typename Work::Integers{};
  }
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::reach_own_cells(bool ahead) {
  const int beside = ahead ? 1 : 0;
  for (auto& particles : particles_)
    for (Block<D>& block : particles.blocks)
      for (int axis = 0; axis < D; ++axis)
        block.reach.lowest[axis] = 1 - beside, block.reach.highest[axis] = block_side<D> + beside;
}

/// Completes the reach after the last chunk; that of lists is complete already.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::end_reach(Block<D>& block, const Work& work) const {
  for (int axis = 0; !scene_.list && axis < D; ++axis)
    for (int lane = 0; lane < Work::integers; ++lane) {
      block.reach.lowest[axis] = std::min(block.reach.lowest[axis], work.lowest[axis][lane] + 1);
      block.reach.highest[axis] = std::max(block.reach.highest[axis], work.highest[axis][lane] + 1);
    }
}

/// Finds where stencils begin in the tile to gather from.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::place_to_gather(const Chunk& chunk, Work& work) const {
  if (!scene_.list) number_stencils(work, chunk.end);
}

/// Finds the row of each stencil in a tile, and whether neighbours mostly share one. Neighbours are compared in
/// registers: a load of what was just stored, one place off, would wait for both stores.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::number_stencils(Work& work, int count) const {
  using Integers = typename Work::Integers;
  constexpr auto all = std::make_index_sequence<Work::integers>();
  Integers previous = Integers{} - 1, same{};
  for (int p = 0; p < count; p += Work::integers) {
    const auto base = [&](int axis) {
      return *reinterpret_cast<const Integers*>(work.base + axis * chunk_size<T> + p);
    };
    Integers node = base(0) + 1;
    for (int axis = 1; axis < D; ++axis)
      node = node * (axis == D - 1 ? kernels_.first_nodes : kernels_.side) + (base(axis) + 1);
    *reinterpret_cast<Integers*>(work.first + p) = node;
    same += shuffled<[](int lane) { return lane + Work::integers - 1; }>(previous, node, all) == node;
    previous = node;
  }
  int shared = 0;
  for (int lane = 0; lane < Work::integers; ++lane) shared -= same[lane];
  work.shared_stencils = 4 * (count - 1 - shared) <= count;
}

/// Inverts D of each particle: a diagonal, or a symmetric matrix by its adjugate.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::invert_moments(const Chunk& chunk, Work& work) const {
  const T scale = static_cast<T>(1 / (scene_.domain.cell_size * scene_.domain.cell_size));
  const T* const m = work.second_moment;
  T* const inverse = work.inverse_moment;
  const int n = chunk.end;
  if (!scene_.list) {
    for (int a = 0; a < D; ++a)
      for (int p = 0; p < n; ++p) inverse[a * chunk_size<T> + p] = scale / m[a * chunk_size<T> + p];
    return;
  }
  const auto at = [](int i, int j) { return (i * D + j) * chunk_size<T>; };
  if constexpr (D == 2) {
    for (int p = 0; p < n; ++p) {
      const T xx = m[at(0, 0) + p], xy = m[at(0, 1) + p], yy = m[at(1, 1) + p], f = scale / (xx * yy - xy * xy);
      inverse[at(0, 0) + p] = f * yy, inverse[at(1, 1) + p] = f * xx;
      inverse[at(0, 1) + p] = inverse[at(1, 0) + p] = -f * xy;
    }
  } else {
    for (int p = 0; p < n; ++p) {
      const T xx = m[at(0, 0) + p], xy = m[at(0, 1) + p], xz = m[at(0, D - 1) + p], yy = m[at(1, 1) + p],
              yz = m[at(1, D - 1) + p], zz = m[at(D - 1, D - 1) + p];
      const T a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
      const T f = scale / (xx * a + xy * b + xz * c);
      inverse[at(0, 0) + p] = f * a, inverse[at(1, 1) + p] = f * (xx * zz - xz * xz);
      inverse[at(D - 1, D - 1) + p] = f * (xx * yy - xy * xy);
      inverse[at(0, 1) + p] = inverse[at(1, 0) + p] = f * b;
      inverse[at(0, D - 1) + p] = inverse[at(D - 1, 0) + p] = f * c;
      inverse[at(1, D - 1) + p] = inverse[at(D - 1, 1) + p] = f * (xy * xz - xx * yz);
    }
  }
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::update_material(const Chunk& chunk, mpm_material_batch request) {
  States state = material_states(chunk);
  if (chunk.body.reads_temperature) request.temperature = chunk.at(chunk.particles.temperature);
  request.count = static_cast<std::uint32_t>(chunk.end);
  request.stride = chunk_size<T>;
  request.dimension = D;
  request.state = state.fields;
  if (scene_.axisymmetric && !request.velocity_gradient) request.velocity_gradient_zz = chunk.values;  // it is not read
  const std::int32_t inverted =
      chunk.body.may_melt() ? update_by_phase(chunk, request) : Components::update_material(chunk.body, request);
  if (inverted >= 0) note_inverted(chunk);
}

/// Finds the lowest index among the inadmissible particles of a chunk.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::note_inverted(const Chunk& chunk) {
  alignas(64) T ratio[chunk_size<T>];
  States state = material_states(chunk);
  mpm_material_batch request{};
  request.count = static_cast<std::uint32_t>(chunk.end);
  request.stride = chunk_size<T>;
  request.dimension = D;
  request.state = state.fields;
  request.volume_ratio = ratio;
  if (chunk.body.reads_temperature) request.temperature = chunk.at(chunk.particles.temperature);
  if (scene_.axisymmetric) request.velocity_gradient_zz = chunk.values;  // it is not read
  Components::update_material(chunk.body, request);
  for (int p = 0; p < chunk.count; ++p)
    if (!(ratio[p] > 0))
      note(std::isnan(ratio[p]) ? Cause::deformation_not_a_number : Cause::inverted, chunk, p, -1, ratio[p]);
}

/// Sums in doubles over a chunk's particles what value_of(first particle) gives for a pack of them. Lanes beyond the
/// last particle may hold anything.
template <class T, class Value>
inline double sum_of_particles(int count, Value&& value_of) {
  using L = Lanes<T>;
  using Sums = typename Lanes<double>::Vector;
  Sums sums{};
  const auto add = [&](typename L::Vector values) {
    if constexpr (sizeof(T) == sizeof(double)) {
      sums += values;
    } else if constexpr (L::width == 16) {
      sums += __builtin_convertvector(__builtin_shufflevector(values, values, 0, 1, 2, 3, 4, 5, 6, 7), Sums);
      sums += __builtin_convertvector(__builtin_shufflevector(values, values, 8, 9, 10, 11, 12, 13, 14, 15), Sums);
    } else {
      sums += __builtin_convertvector(__builtin_shufflevector(values, values, 0, 1, 2, 3), Sums);
      sums += __builtin_convertvector(__builtin_shufflevector(values, values, 4, 5, 6, 7), Sums);
    }
  };
  int p = 0;
  for (; p + L::width <= count; p += L::width) add(value_of(p).v);
  if (p < count) {
    typename L::Mask lane{};
    for (int i = 0; i < L::width; ++i) lane[i] = p + i;
    add(lane < count ? value_of(p).v : typename L::Vector{});
  }
  double sum = 0;
  for (int i = 0; i < Lanes<double>::width; ++i) sum += sums[i];
  return sum;
}

/// Includes the affine part where the transfer carries it; offsets and moments are those of the last shape evaluation.
/// What a particle's own energy loses to rounding in T is the same where it is gathered and where it is scattered next.
template <int D, class T, class Components>
double ParticleStep<D, T, Components>::kinetic_energy(const Chunk& chunk, const Work& work) const {
  using L = Lanes<T>;
  const auto load = [](const T* first, int component, int p) { return L::load(first + component * chunk_size<T> + p); };
  const auto energy_with = [&](auto&& affine_squares) {
    const T* const v = chunk.motion;
    const auto squares_of = [&](int p) {
      L squares = affine_squares(p);
      for (int c = 0; c < D; ++c) squares = squares + load(v, c, p) * load(v, c, p);
      return squares;
    };
    const T* const size = sizes(chunk);
    const double sum = size ? sum_of_particles<T>(chunk.count, [&](int p) { return squares_of(p) * L::load(size + p); })
                            : sum_of_particles<T>(chunk.count, squares_of);
    if (!higher_kernels_.squares) return 0.5 * chunk.body.mass * sum;
    const Stencils<T> stencils{work.first, false, work.weight, work.gradient, {}};
    const double higher = higher_kernels_.squares(stencils, work.offset, chunk.higher(), size, chunk.count);
    return 0.5 * chunk.body.mass * (sum + higher);
  };
  if (!scene_.has(MPM_AFFINE_CARRIES_ENERGY)) return energy_with([](int) { return L(T(0)); });

  const T* const C = chunk.motion_at(chunk.particles.transfer_state[0].first);
  const T cell_area = static_cast<T>(scene_.domain.cell_size * scene_.domain.cell_size);
  const auto column = [&](int a, int p) {  // sums the squares of one column of C
    L squares = load(C, a, p) * load(C, a, p);
    for (int c = 1; c < D; ++c) squares = squares + load(C, c * D + a, p) * load(C, c * D + a, p);
    return squares;
  };
  const auto energy_of_columns = [&](T factor, auto&& moment) {
    return energy_with([&](int p) {
      L squares = moment(0, p) * column(0, p);
      for (int a = 1; a < D; ++a) squares = squares + moment(a, p) * column(a, p);
      return factor * squares;
    });
  };
  if (scene_.moment_of_particle && scene_.list)  // tr(C D C^T) with a full matrix
    return energy_with([&](int p) {
      L squares(T(0));
      for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b)
          for (int c = 0; c < D; ++c)
            squares = squares + load(work.second_moment, a * D + b, p) * load(C, c * D + a, p) * load(C, c * D + b, p);
      return cell_area * squares;
    });
  if (scene_.moment_of_particle)
    return energy_of_columns(cell_area, [&](int a, int p) { return load(work.second_moment, a, p); });
  if (scene_.moment_is_gradient)
    return energy_of_columns(cell_area, [&](int a, int p) {
      const L offset = load(work.offset, a, p);
      return offset * (T(1) - offset);
    });
  return energy_of_columns(static_cast<T>(1 / scene_.inverse_moment), [](int, int) { return T(1); });
}

}  // namespace mpm::cpu

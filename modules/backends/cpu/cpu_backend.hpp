#pragma once
// The cpu backend keeps particles in chunks and blocks, nodes in a sparse grid, and executes the passes over both.

#include <chrono>
#include <deque>
#include <memory>
#include <numbers>
#include <utility>

#include "backends/cpu/grid/grid_step.hpp"
#include "backends/cpu/particles/particle_step.hpp"
#include "plugin/extension_of.hpp"
#include "support/pace.hpp"

namespace mpm::cpu {

template <int D, class T, class Components = LoadedComponents<D, T>>
class CpuBackend final : public Backend, NamedChannels {
  using Step = ParticleStep<D, T, Components>;

 public:
  /// Uses exactly `threads` threads, or with `find_number` as many of them as are fastest.
  CpuBackend(const Experiment& experiment, const Plan& plan, std::vector<SeededBody> seeds, int threads,
             bool find_number = false);

  std::string_view name() const override { return "cpu"; }
  void execute(const Pass& pass, const StepInfo& step) override {
    if (!pace_) return execute_pass(pass, step);
    const auto start = std::chrono::steady_clock::now();
    if (step.step != paced_step_) keep_pace(step.step);
    execute_pass(pass, step);
    seconds_of_step_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  TimeStepLimit time_step_limit() const override { return limit_; }
  BodyState body_state(int body) const override;
  const Ledger& ledger() const override { return ledger_; }
  HeatLedger heat_ledger() const override { return heat_ledger_; }
  const ContactRecord& contact_record() const override { return contact_; }
  const std::vector<PairRecord>& contact_pairs() const override { return grid_step_->contact_pairs(); }
  const std::vector<ContactNode>& contact_nodes() const override { return grid_step_->contact_nodes(); }
  const FilterRecord& filter_record() const override { return filter_; }
  const std::vector<Reaction>& reactions() const override { return reactions_.reactions(); }
  const std::vector<RigidState>& rigid_bodies() const override { return grid_step_->rigid_bodies().states(); }
  bool scattered() const override { return scattered_; }
  void save(ArchiveWriter& archive) const override;
  void restore(ArchiveReader& archive) override;
  void measure_phases(bool on) override { particle_step_->measure_phases(on); }
  std::map<std::string, double> phase_seconds() const override { return particle_step_->phase_seconds(); }
  std::uint64_t particle_bytes() const override;
  std::uint64_t grid_bytes() const override { return grid_.bytes(); }

 private:
  /// This many particles keep a thread busy for long enough that one more is worth its while on a quiet machine.
  static constexpr std::size_t particles_for_a_thread = 20000;

  void execute_pass(const Pass& pass, const StepInfo& step);
  /// Decides at the end of a step how many threads the next one has.
  void keep_pace(long next_step) {
    if (seconds_of_step_ > 0) pace_->step_took(std::exchange(seconds_of_step_, 0.0));
    scene_.team->use(pace_->threads(), !pace_->disturbed());
    paced_step_ = next_step;
  }
  std::vector<Body<D, T>> make_bodies(std::vector<SeededBody>& seeds);
  void measure_rings(Particles<D, T>& particles) const;
  void show_particles(ContactPoints& points) const;
  void sort_all();
  void sort_when_moved();
  void sort_between(const StepInfo& step);
  void scatter(const Pass& pass, const StepInfo& step);
  void gather(const Pass& pass, const StepInfo& step);
  void gather_scatter(const Pass& pass, const StepInfo& step);
  bool may_pass_motion(const StepInfo& step) const;
  void account_for_gather(const Pass& pass, const typename Step::Gathered& gathered);
  void account_for_strain(const typename Step::Gathered& gathered);
  void account_for_move();
  void wake_for_ledger(long step);

  // ---- cpu_state.hpp
  template <class Visit>
  void for_each_particle(int body, Visit visit) const;
  std::vector<double> positions(int body) const;
  std::size_t count(int body) const;
  std::string name_of_arrangement() const;
  std::vector<char> arrangement() const;
  void restore_body(ArchiveReader& archive, int body, ArchiveReader* arrangement);
  void take_arrangement(ArchiveReader& arrangement, Particles<D, T>& particles, std::size_t count);
  void arrange_anew(Particles<D, T>& particles, const std::vector<double>& position);
  static std::vector<T*> lanes_by_seeding(Particles<D, T>& particles, std::size_t count);

  Scene<D, T> scene_;
  Grid<D, T> grid_;
  std::vector<Particles<D, T>> particles_;
  SortSpace sort_space_;
  bool grid_built_ = false;
  long looked_at_step_ = -1;  ///< step for which it is known whether the ledger takes entries
  bool accounted_ = false;    ///< whether it does
  std::vector<int> field_of_body_;
  std::deque<BodyLoads> loads_;  ///< of bodies that have some
  Ledger ledger_;
  HeatLedger heat_ledger_;
  ContactRecord contact_;
  FilterRecord filter_;
  ReactionImpulse reactions_;
  TimeStepLimit limit_;
  std::unique_ptr<support::Pace> pace_;  ///< null where there is one thread
  long paced_step_ = -1;
  double seconds_of_step_ = 0;
  bool scattered_ = false;      ///< the last gather_scatter left the next step's grid
  Pass gather_alone_;           ///< a fused pass without its acts for the next step; empty until it was needed
  double gathered_energy_ = 0;  ///< kinetic energy of the particles after the last gather, J
  bool carries_domains_;        ///< particles have domains, which may outgrow a tile
  bool motion_kept_ = true;     ///< particles have the velocity and the transfer's state of the last step
  std::unique_ptr<Step> particle_step_;
  std::unique_ptr<GridStep<D, T>> grid_step_;
};

// ---- implementation ----------------------------------------------------------------------------------------------

template <int D, class T, class Components>
CpuBackend<D, T, Components>::CpuBackend(const Experiment& experiment, const Plan& plan, std::vector<SeededBody> seeds,
                                         int threads, bool find_number)
    : NamedChannels{plan},
      scene_(experiment, plan, threads),
      grid_(scene_),
      particles_(seeds.size()),
      reactions_(experiment),
      carries_domains_(plan.particle_field(0, "domain") != nullptr) {
  if (scene_.threads > 1) {
    std::size_t count = 0;
    for (const SeededBody& body : seeds) count += body.count();
    const int first = static_cast<int>(std::min<std::size_t>(count / particles_for_a_thread, 1 << 20));
    pace_ = std::make_unique<support::Pace>(find_number ? 1 : scene_.threads, scene_.threads, first);
    scene_.team->use(pace_->threads());
  }
  std::vector<Body<D, T>> bodies = make_bodies(seeds);
  particle_step_ = std::make_unique<Step>(scene_, grid_, particles_, std::move(bodies));
  grid_step_ = std::make_unique<GridStep<D, T>>(scene_, grid_, ledger_, heat_ledger_, contact_, filter_, reactions_);
  grid_step_->show_particles_by([this](ContactPoints& points) { show_particles(points); });
  sort_all();
}

/// Adds the particles of blocks near nodes where bodies meet.
template <int D, class T, class Components>
void CpuBackend<D, T, Components>::show_particles(ContactPoints& points) const {
  constexpr double drift = 1;  // cells: particles are sorted before they are farther from their block
  for (std::size_t body = 0; body < particles_.size(); ++body) {
    const Particles<D, T>& particles = particles_[body];
    const bool by_domain = particles.domain >= 0;
    const int sides = by_domain ? particles.domain : particles.deformation;
    for (const Block<D>& block : particles.blocks) {
      Vector3 low{}, high{};
      for (int axis = 0; axis < D; ++axis)
        low[axis] = cells_from_corner(scene_.domain, block, axis, 0.0) - drift,
        high[axis] = low[axis] + block_side<D> + 2 * drift;
      if (!points.look_around(low, high)) continue;
      for_each_chunk<T>(block, [&](std::uint32_t chunk, int count) {
        const T* const values = particles.chunk(chunk);
        for (int p = 0; p < count; ++p) {
          Vector3 x{};
          for (int axis = 0; axis < D; ++axis)
            x[axis] = cells_from_corner(scene_.domain, block, axis, values[axis * chunk_size<T> + p]);
          if (sides < 0) {
            points.add(field_of_body_[body], x, static_cast<const T*>(nullptr), 0, 0);
            continue;
          }
          const double size =
              particles.size < 0 || scene_.axisymmetric ? 1.0 : values[particles.size * chunk_size<T> + p];
          points.add(field_of_body_[body], x, values + sides * chunk_size<T> + p, chunk_size<T>,
                     by_domain ? 1.0 : points.half_side(particle_step_->bodies()[body].volume * size));
        }
      });
    }
  }
}

template <int D, class T, class Components>
std::vector<Body<D, T>> CpuBackend<D, T, Components>::make_bodies(std::vector<SeededBody>& seeds) {
  const Experiment& experiment = scene_.experiment;
  std::vector<Body<D, T>> bodies(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    Body<D, T>& body = bodies[i];
    body.index = static_cast<int>(i);
    body.field = experiment.bodies[i].field;
    body.mass = seeds[i].mass;
    body.volume = seeds[i].volume;
    body.frozen = experiment.bodies[i].frozen;
    body.material = &experiment.materials[experiment.bodies[i].material].component;
    const mpm_material& material = body.material->plugin->material();
    body.update_material = material.update[lane_precision<T>][D - 2];
    const auto& viscosity = experiment.materials[experiment.bodies[i].material].artificial_viscosity;
    body.dissipation = dissipation_of(*body.material->plugin);
    body.dissipates = (material.traits & MPM_DISSIPATES) != 0 || viscosity;
    if (viscosity) {
      const double h = scene_.domain.cell_size;
      body.viscosity = {static_cast<T>(body.material->parameter("density")), static_cast<T>(viscosity->linear * h),
                        static_cast<T>(viscosity->quadratic * h * h)};
    }
    const auto& thermal = experiment.materials[experiment.bodies[i].material].thermal;
    body.thermal = thermal ? &*thermal : nullptr;
    body.warms_itself = body.dissipates && thermal && thermal->dissipation_to_heat > 0;
    body.reads_temperature = thermal && extension_of<mpm_material_temperature>(*body.material->plugin);
    field_of_body_.push_back(body.field);
    particles_[i].lay_out(scene_.plan, body.index);
    if (std::max(particles_[i].transfer_state.size(), particles_[i].material_state.size()) > Step::max_state_fields)
      throw std::invalid_argument("the cpu backend takes at most 16 state fields a plugin");
    const T half = static_cast<T>(0.5 / experiment.bodies[i].particles_per_cell_axis);
    particles_[i].half_size.require(std::size_t(D) * chunk_size<T>);
    std::fill_n(particles_[i].half_size.data(), D * chunk_size<T>, half);
    if (BodyLoads loads(experiment, body.index, seeds[i]); loads.any())
      body.loads = &loads_.emplace_back(std::move(loads));
    seed_particles(particles_[i], seeds[i], scene_.domain);
    if (particles_[i].size >= 0 && !seeds[i].with_size) measure_rings(particles_[i]);
    for (const Field& field : scene_.plan.fields)
      if (field.of_particles_of(body.index) && field.lifetime == Lifetime::seeded)
        body.seeded[field.id] = seeds[i].values(field);
    if (const auto found = body.seeded.find("initial_position"); found != body.seeded.end())
      body.initial_position = found->second.data();
    seeds[i] = {};
  }
  return bodies;
}

/// Computes 2 pi r of each particle where it was seeded, its size where the seeds name none.
template <int D, class T, class Components>
void CpuBackend<D, T, Components>::measure_rings(Particles<D, T>& particles) const {
  for (const Block<D>& block : particles.blocks)
    for_each_chunk<T>(block, [&](std::uint32_t chunk, int count) {
      const T* const x = particles.chunk(chunk) + Particles<D, T>::position * chunk_size<T>;
      T* const ring = particles.chunk(chunk) + particles.size * chunk_size<T>;
      for (int p = 0; p < padded(count); ++p)
        ring[p] = static_cast<T>(
            2 * std::numbers::pi *
            (scene_.domain.lower[0] + scene_.domain.cell_size * cells_from_corner(scene_.domain, block, 0, x[p])));
    });
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::sort_all() {
  bool changed = !grid_built_ || scene_.list;
  if (!motion_kept_) throw std::logic_error("particles must be sorted, but their velocities were not kept");
  for (auto& particles : particles_) changed |= sort_particles(particles, sort_space_, scene_, true);
  if (scene_.list) {
    for (auto& particles : particles_)
      for (Block<D>& block : particles.blocks) {
        block.first_active = Block<D>{}.first_active;
        block.last_active = Block<D>{}.last_active;
      }
    particle_step_->widen_active_blocks();
  }
  if (changed) grid_.rebuild(particles_, field_of_body_);
  grid_built_ = true;
  particle_step_->set_drift(0);
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::sort_when_moved() {
  if (particle_step_->must_sort()) sort_all();
}

/// Sorts between scatter and gather when the next move, if it is like the last, would lead out of the tiles. What the
/// gather replaces does not travel. Particles are sorted by where they will be in the middle of their way, which makes
/// the way to the next sort longer.
template <int D, class T, class Components>
void CpuBackend<D, T, Components>::sort_between(const StepInfo& step) {
  if (particle_step_->drift() == 0 || !particle_step_->must_sort_soon()) return;
  bool changed = false;
  motion_kept_ = !scene_.has(MPM_REPLACES_MOTION);
  const double ahead = particle_step_->foresight();
  Foresight<T> foresight;
  if (ahead > 0)
    foresight = {nullptr, static_cast<T>(ahead / particle_step_->last_drift() * step.dt / scene_.domain.cell_size),
                 static_cast<T>(ahead)};
  for (std::size_t body = 0; body < particles_.size(); ++body) {
    if (ahead > 0) foresight.velocities = grid_.channel(motion, field_of_body_[body]);
    changed |= sort_particles(particles_[body], sort_space_, scene_, motion_kept_, foresight);
  }
  if (changed) grid_.rebuild(particles_, field_of_body_, true);
  particle_step_->reach_own_cells(ahead > 0);
  particle_step_->set_drift(ahead);
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::scatter(const Pass& pass, const StepInfo& step) {
  if (pass.remap()) grid_.clear(motion);
  const Scattered particles = particle_step_->scatter(pass, step);
  if (pass.has(Act::scatter_momentum) && !pass.remap()) grid_step_->set_scattered(particles);
  if (pass.has(Act::scatter_heat)) grid_step_->set_particle_heat(particle_step_->scattered_heat());
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::gather(const Pass& pass, const StepInfo& step) {
  motion_kept_ = true;
  if (accounted_ && step.filtered) {
    if (pass.has(Act::strain)) grid_step_->book_strain(&Ledger::filtered_strain, pass.share, step.dt);
    grid_step_->book_filtered_gravity(step.dt);
  }
  account_for_gather(pass, particle_step_->gather(pass, step));
  for (std::size_t grip = 0; grip < scene_.experiment.grips.size(); ++grip) {
    const GivenToGripped given = particle_step_->given_to_gripped(grip);
    reactions_.give_particles(scene_.experiment.support_of_grip(grip), given, step.dt);
    if (accounted_) ledger_.gather -= given.energy, ledger_.boundary += given.energy;
  }
  if (pass.has(Act::move)) account_for_move();
}

/// Whether a fused pass may leave velocities and the transfer's state behind: nobody reads them, and no particle can
/// leave its tile, since none moves faster than the fastest node (a domain may outgrow its stencil, though).
template <int D, class T, class Components>
bool CpuBackend<D, T, Components>::may_pass_motion(const StepInfo& step) const {
  return !step.observed && scene_.has(MPM_REPLACES_MOTION) && !carries_domains_ &&
         particle_step_->stays_within_tiles(step.dt * grid_step_->largest_component() / scene_.domain.cell_size);
}

/// Gathers, and scatters for the next step into a second motion channel, as that of this step is still read.
template <int D, class T, class Components>
void CpuBackend<D, T, Components>::gather_scatter(const Pass& pass, const StepInfo& step) {
  scattered_ = false;
  if (particle_step_->must_sort_soon()) {
    if (gather_alone_.operators.empty()) gather_alone_ = pass.before_next_step();
    return gather(gather_alone_, step);
  }
  StepInfo now = step;
  now.observed = !may_pass_motion(step);
  wake_for_ledger(step.step + 1);
  const StepInfo next{step.next_dt, step.next_time, step.step + 1};
  motion_kept_ = now.observed;
  const auto fused = particle_step_->gather_scatter(pass, now, next);
  account_for_gather(pass, fused.gathered);
  if (accounted_ && particle_step_->energy_moves())
    ledger_.second_moment += fused.particles.kinetic_energy - gathered_energy_;
  scattered_ = fused.scattered;
  if (!scattered_) return;
  grid_.swap(motion, next_motion);
  grid_step_->set_scattered(fused.particles);
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::account_for_gather(const Pass& pass, const typename Step::Gathered& gathered) {
  if (pass.has(Act::gather_heat)) heat_ledger_.gather += gathered.heat - grid_step_->heat_after();
  heat_ledger_.dissipation += gathered.heat_of_dissipation;
  if (!accounted_) return;
  grid_step_->book_gather(gathered.kinetic_energy);
  gathered_energy_ = gathered.kinetic_energy;
  ledger_ = ledger_.plus(gathered.strained);
}

/// Books what the kinetic energy of the particles changes by as their places in the cells do.
template <int D, class T, class Components>
void CpuBackend<D, T, Components>::account_for_move() {
  if (!accounted_ || !particle_step_->energy_moves()) return;
  ledger_.second_moment += particle_step_->kinetic_energy_now() - gathered_energy_;
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::account_for_strain(const typename Step::Gathered& gathered) {
  if (accounted_) ledger_ = ledger_.plus(gathered.strained);
  heat_ledger_.dissipation += gathered.heat_of_dissipation;
}

/// Prepares the scatter of a step: what only the ledger reads rests in the steps that the ledger leaves out.
template <int D, class T, class Components>
void CpuBackend<D, T, Components>::wake_for_ledger(long step) {
  grid_.let_ledger_rest(scene_.plan.has_ledger() && !scene_.plan.accounts_at(step));
}

template <int D, class T, class Components>
void CpuBackend<D, T, Components>::execute_pass(const Pass& pass, const StepInfo& step) {
  if (step.step != looked_at_step_) {
    looked_at_step_ = step.step;
    accounted_ = scene_.plan.accounts_at(step.step);
    grid_step_->set_accounted(accounted_);
  }
  switch (pass.operators.front().act) {
    case Act::estimate_time_step:
      limit_ = particle_step_->time_step_limit();
      return;
    case Act::sort:
      return sort_when_moved();
    case Act::sort_ahead:
      return sort_between(step);
    case Act::clear:
      wake_for_ledger(step.step);
      sort_when_moved();  // for plans without a sort pass
      if (scene_.list && particle_step_->widen_active_blocks()) grid_.rebuild(particles_, field_of_body_);
      return grid_.clear();
    case Act::scatter_momentum:
    case Act::scatter_force:
      return scatter(pass, step);
    case Act::divide:
      return grid_step_->momentum_to_velocity(pass.remap(), step);
    case Act::accelerate:
      return grid_step_->apply_forces(step);
    case Act::gather:
      return pass.fused() ? gather_scatter(pass, step) : gather(pass, step);
    case Act::strain:
      if (pass.remap() && accounted_) grid_step_->book_strain(&Ledger::remapped_strain, pass.share, step.dt);
      return account_for_strain(particle_step_->strain(pass, step));
    case Act::divide_heat:
      return grid_step_->heat_to_temperature(step);
    case Act::conduct:
      return particle_step_->conduct();
    case Act::heat:
      return grid_step_->apply_heat(step);
    case Act::scatter_mean_stress:
      return particle_step_->scatter_mean_stress();
    case Act::average_mean_stress:
      return grid_step_->average(mean_stress);
    case Act::scatter_dilation:
      return particle_step_->scatter_dilation(pass, step);
    case Act::average_dilation:
      return grid_step_->average(dilation);
    case Act::keep_contact_state:
      return particle_step_->keep_contact_state();
    case Act::change_phase:
      return ledger_.enter_phase_change(particle_step_->change_phases(step));
    case Act::move:
      particle_step_->move(step);
      return account_for_move();
    case Act::begin_filter:
      return grid_step_->begin_filter(pass);
    case Act::project:
      grid_.clear(filter_projection);
      particle_step_->project(step);
      return grid_step_->project_increment(pass, step);
    case Act::update_filter:
      return grid_step_->update_filter(pass, step);
    case Act::end_filter:
      return grid_step_->end_filter(pass, step);
    case Act::restore_velocity:
      return grid_step_->restore_velocity(pass, step);
    case Act::add_correction:
      return grid_step_->add_correction(pass, step);
    default:  // the other acts share a visit with one of these
      throw std::logic_error("the cpu backend does not execute pass \"" + pass.name() + "\"");
  }
}

template <int D, class T, class Components>
std::uint64_t CpuBackend<D, T, Components>::particle_bytes() const {
  std::uint64_t total = sort_space_.bytes();
  for (const auto& particles : particles_)
    total += particles.pool.bytes() + particles.places.capacity() * sizeof(std::byte*) +
             particles.blocks.capacity() * sizeof(Block<D>);
  for (const auto& body : particle_step_->bodies())
    for (const auto& [id, values] : body.seeded) total += values.size() * sizeof(double);
  return total;
}

}  // namespace mpm::cpu

#include "backends/cpu/cpu_state.hpp"  // IWYU pragma: keep

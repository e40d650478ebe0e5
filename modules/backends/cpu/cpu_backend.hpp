#pragma once
// The cpu backend: particles in chunks and blocks, a sparse grid, and the passes over both.

#include "grid_step.hpp"
#include "particle_step.hpp"

namespace mpm::cpu {

template <int D, class T>
class CpuBackend final : public Backend {
 public:
  CpuBackend(const Experiment& experiment, const Plan& plan, std::vector<SeededBody> seeds, int threads);

  std::string_view name() const override { return "cpu"; }
  void execute(const Pass& pass, const StepInfo& step) override;
  TimeStepLimit time_step_limit() const override { return limit_; }
  BodyState body_state(int body) const override;
  const Ledger& ledger() const override { return ledger_; }
  const ContactRecord& contact_record() const override { return contact_; }
  const FilterRecord& filter_record() const override { return filter_; }
  bool scattered() const override { return false; }
  void save(ArchiveWriter&) const override { throw std::logic_error("not yet"); }
  void restore(ArchiveReader&) override { throw std::logic_error("not yet"); }
  std::uint64_t particle_bytes() const override;
  std::uint64_t grid_bytes() const override { return grid_.bytes(); }

 private:
  void plan_channels();
  std::vector<Body<D, T>> make_bodies(std::vector<SeededBody>& seeds);
  void lay_out_state(Particles<D, T>& particles, const Component& material) const;
  void initialise_state(Particles<D, T>& particles, const Component& material,
                        const std::vector<double>& velocity_gradient) const;
  void sort_all();
  void sort_when_moved();
  void scatter(const Pass& pass, const StepInfo& step);
  void gather(const Pass& pass, const StepInfo& step);

  Scene<D, T> scene_;
  Grid<D, T> grid_;
  std::vector<Particles<D, T>> particles_;
  Particles<D, T> spare_;  ///< the other buffer of a sort
  std::vector<int> field_of_body_;
  Ledger ledger_;
  ContactRecord contact_;
  FilterRecord filter_;
  TimeStepLimit limit_;
  std::unique_ptr<ParticleStep<D, T>> particle_step_;
  std::unique_ptr<GridStep<D, T>> grid_step_;
};

// ---- implementation ----------------------------------------------------------------------------------------------

template <int D, class T>
CpuBackend<D, T>::CpuBackend(const Experiment& experiment, const Plan& plan, std::vector<SeededBody> seeds, int threads)
    : scene_(experiment, plan, threads), grid_(scene_), particles_(seeds.size()) {
  plan_channels();
  std::vector<std::vector<double>> gradients;
  for (SeededBody& seed : seeds) gradients.push_back(std::move(seed.velocity_gradient));
  std::vector<Body<D, T>> bodies = make_bodies(seeds);
  particle_step_ = std::make_unique<ParticleStep<D, T>>(scene_, grid_, particles_, std::move(bodies));
  grid_step_ = std::make_unique<GridStep<D, T>>(scene_, grid_, ledger_, contact_);
  sort_all();
  for (std::size_t body = 0; body < particles_.size(); ++body)
    initialise_state(particles_[body], *particle_step_->bodies()[body].material, gradients[body]);
}

template <int D, class T>
void CpuBackend<D, T>::plan_channels() {
  const Experiment& experiment = scene_.experiment;
  const Plan& plan = scene_.plan;
  // A separating box decides twice, before and after the forces, so these may not come merged with the momentum.
  bool separate = plan.separate_force || plan.ledger || plan.velocity_increment || plan.contact;
  for (const BoxCondition& box : experiment.boxes) separate = separate || box.type == ConditionType::separate;
  grid_.plan_channel(motion);
  if (separate) grid_.plan_channel(force);
  if (separate && experiment.body_force) grid_.plan_channel(body_force);
  if (plan.velocity_increment || plan.ledger) grid_.plan_channel(velocity_before);
  if (plan.contact) {
    grid_.plan_channel(volume_gradient);
    grid_.plan_channel(mass_position);
  }
}

template <int D, class T>
std::vector<Body<D, T>> CpuBackend<D, T>::make_bodies(std::vector<SeededBody>& seeds) {
  const Experiment& experiment = scene_.experiment;
  std::vector<Body<D, T>> bodies(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    Body<D, T>& body = bodies[i];
    body.index = static_cast<int>(i);
    body.field = experiment.bodies[i].field;
    body.mass = seeds[i].mass;
    body.volume = seeds[i].volume;
    body.material = &experiment.materials[experiment.bodies[i].material].component;
    const mpm_material& material = body.material->plugin->material();
    body.update_material = material.update[lane_precision<T>][D - 2];
    body.dissipates = (material.traits & MPM_DISSIPATES) != 0;
    field_of_body_.push_back(body.field);
    lay_out_state(particles_[i], *body.material);
    seed_particles(particles_[i], seeds[i], scene_.domain);
    if (scene_.plan.initial_position) body.initial_position = std::move(seeds[i].position);
    seeds[i] = {};
  }
  return bodies;
}

template <int D, class T>
void CpuBackend<D, T>::lay_out_state(Particles<D, T>& particles, const Component& material) const {
  const auto add = [&](std::vector<StateField>& fields, const Plugin& plugin) {
    for (const mpm_state& field : plugin.state()) {
      const int components = state_components(static_cast<mpm_state_shape>(field.shape), D);
      fields.push_back({field.name, particles.components, components});
      particles.components += components;
    }
    if (fields.size() > ParticleStep<D, T>::max_state_fields)
      throw std::invalid_argument("the cpu backend takes at most 16 state fields a plugin");
  };
  add(particles.transfer_state, *scene_.experiment.transfer.plugin);
  add(particles.material_state, *material.plugin);
  if (scene_.plan.kept_advection) {
    particles.advection = particles.components;
    particles.components += D;
  }
}

template <int D, class T>
void CpuBackend<D, T>::initialise_state(Particles<D, T>& particles, const Component& material,
                                        const std::vector<double>& velocity_gradient) const {
  const auto set = [&](const StateField& field, const mpm_state& declared) {
    const bool symmetric = declared.shape == MPM_STATE_SYMMETRIC;
    for (int c = 0; c < field.components; ++c) {
      const bool diagonal = symmetric ? c < 3 : c % (D + 1) == 0;
      const bool one = declared.initial == MPM_INITIAL_ONE || (declared.initial == MPM_INITIAL_IDENTITY && diagonal);
      for (std::uint32_t i = 0; i < particles.chunks; ++i)
        std::fill_n(particles.chunk(i) + (field.first + c) * chunk_size, chunk_size, one ? T(1) : T(0));
    }
  };
  for (std::size_t f = 0; f < particles.transfer_state.size(); ++f)
    set(particles.transfer_state[f], scene_.experiment.transfer.plugin->state()[f]);
  for (std::size_t f = 0; f < particles.material_state.size(); ++f)
    set(particles.material_state[f], material.plugin->state()[f]);
  if (velocity_gradient.empty()) return;
  const StateField& affine = particles.transfer_state[0];
  for (const Block<D>& block : particles.blocks)
    for_each_chunk(block, [&](std::uint32_t chunk, int count) {
      for (int p = 0; p < count; ++p)
        for (int c = 0; c < D * D; ++c)
          particles.chunk(chunk)[(affine.first + c) * chunk_size + p] =
              static_cast<T>(velocity_gradient[std::size_t(particles.ids(chunk)[p]) * D * D + c]);
    });
}

template <int D, class T>
void CpuBackend<D, T>::sort_all() {
  for (auto& particles : particles_) sort_particles(particles, spare_, scene_);
  grid_.rebuild(particles_, field_of_body_);
  particle_step_->reset_drift();
}

/// A tile has a margin of one cell for particles that moved since they were sorted.
template <int D, class T>
void CpuBackend<D, T>::sort_when_moved() {
  if (particle_step_->drift() > 0.99) sort_all();
}

template <int D, class T>
void CpuBackend<D, T>::scatter(const Pass& pass, const StepInfo& step) {
  if (pass.remap) grid_.clear(motion);
  const double energy = particle_step_->scatter(pass, step);
  if (pass.momentum && !pass.remap) grid_step_->set_particle_kinetic_energy(energy);
}

template <int D, class T>
void CpuBackend<D, T>::gather(const Pass& pass, const StepInfo& step) {
  const auto gathered = particle_step_->gather(pass, step);
  if (!scene_.plan.ledger) return;
  ledger_.gather += gathered.kinetic_energy - grid_step_->kinetic_energy_after();
  ledger_.material += gathered.dissipated;
}

template <int D, class T>
void CpuBackend<D, T>::execute(const Pass& pass, const StepInfo& step) {
  switch (pass.kind) {
    case PassKind::estimate_time_step:
      limit_ = particle_step_->time_step_limit();
      return;
    case PassKind::sort:
      return sort_when_moved();
    case PassKind::reset_grid:
      sort_when_moved();  // a plan without a sort pass
      return grid_.clear();
    case PassKind::scatter:
      return scatter(pass, step);
    case PassKind::momentum_to_velocity:
      return grid_step_->momentum_to_velocity(pass.remap, step);
    case PassKind::apply_forces:
      return grid_step_->apply_forces(step);
    case PassKind::gather:
      return gather(pass, step);
    case PassKind::strain:
      ledger_.material += particle_step_->strain(step);
      return;
    case PassKind::move:
      return particle_step_->move(step);
    default:
      throw std::logic_error("the cpu backend does not execute pass \"" + pass.name() + "\"");
  }
}

template <int D, class T>
BodyState CpuBackend<D, T>::body_state(int index) const {
  const Particles<D, T>& particles = particles_[index];
  const Body<D, T>& body = particle_step_->bodies()[index];
  std::size_t n = 0;
  for (const Block<D>& block : particles.blocks) n += block.count;
  BodyState state;
  state.volume = body.volume;
  state.mass = body.mass;
  state.initial_position = body.initial_position;
  // Visits every particle: visit(block, values of its lane, index of seeding).
  const auto each = [&](auto&& visit) {
    for (const Block<D>& block : particles.blocks)
      for_each_chunk(block, [&](std::uint32_t chunk, int count) {
        for (int p = 0; p < count; ++p)
          visit(block, particles.chunk(chunk) + p, static_cast<std::size_t>(particles.ids(chunk)[p]));
      });
  };
  const auto copy = [&](int first, int components) {
    std::vector<double> out(n * components);
    each([&](const Block<D>&, const T* values, std::size_t id) {
      for (int c = 0; c < components; ++c) out[id * components + c] = values[(first + c) * chunk_size];
    });
    return out;
  };
  state.position.resize(n * D);
  each([&](const Block<D>& block, const T* values, std::size_t id) {
    for (int a = 0; a < D; ++a)
      state.position[id * D + a] =
          scene_.domain.lower[a] +
          scene_.domain.cell_size * cells_from_corner(scene_.domain, block, a, values[a * chunk_size]);
  });
  state.velocity = copy(Particles<D, T>::velocity, D);
  for (const StateField& field : particles.transfer_state)
    state.transfer_state[field.name] = copy(field.first, field.components);
  for (const StateField& field : particles.material_state)
    state.material_state[field.name] = copy(field.first, field.components);
  return state;
}

template <int D, class T>
std::uint64_t CpuBackend<D, T>::particle_bytes() const {
  std::uint64_t total = spare_.data.bytes() + spare_.id.bytes();
  for (const auto& particles : particles_) total += particles.data.bytes() + particles.id.bytes();
  for (const auto& body : particle_step_->bodies()) total += body.initial_position.size() * sizeof(double);
  return total;
}

}  // namespace mpm::cpu

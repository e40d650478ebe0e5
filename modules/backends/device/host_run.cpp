#include "backends/device/host_run.hpp"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <map>
#include <numbers>

#include "backends/device/kernels/filter.hpp"  // largest_team
#include "simulation/boundary.hpp"
#include "simulation/contact_pair.hpp"

namespace mpm::device {
namespace {

/// Whether component k of a declared field is one at the start.
bool starts_as_one(const mpm_state& field, int k, int dimension, bool axisymmetric) {
  if (field.initial == MPM_INITIAL_ZERO) return false;
  if (field.initial == MPM_INITIAL_ONE) return true;
  if (field.shape == MPM_STATE_SYMMETRIC) return k < 3;
  const bool deformation = kept_shape(field, axisymmetric) == MPM_STATE_DEFORMATION;
  return k % (dimension + 1) == 0 || (deformation && k == dimension * dimension);
}

template <class T>
struct Body {
  const Component *transfer, *material;
  int field = 0, material_number = 0, count = 0, dimension = 2, basis_functions = 0;
  bool axisymmetric = false, frozen = false;
  T mass = 0, volume = 0, half_size = 0;
  std::vector<T> position, velocity, advection, domain, corners, moved_corners, stencil_domain, transfer_state,
      material_state, stress, volume_ratio, velocity_gradient, wave_speed, circumference, hoop_rate;
  std::vector<int> block_cell, block_begin, order;

  Body(const Experiment& experiment, const Plan& plan, int index, const SeededBody& seeded)
      : transfer(&experiment.transfer), dimension(experiment.dimension), axisymmetric(experiment.axisymmetric()) {
    const BodySpecification& body = experiment.bodies[index];
    frozen = body.frozen;
    material = &experiment.materials[body.material].component;
    const int D = dimension;
    field = body.field, material_number = body.material, count = static_cast<int>(seeded.count());
    mass = static_cast<T>(seeded.mass), volume = static_cast<T>(seeded.volume);
    half_size = static_cast<T>(0.5 / body.particles_per_cell_axis);
    const SeedArrays seeds = seeded.arrays();
    position = columns(seeds.position, D), velocity = columns(seeds.velocity, D);
    advection.resize(velocity.size());
    basis_functions = plan.basis_functions;
    transfer_state = initial_state(*transfer->plugin);
    transfer_state.resize(transfer_state.size() + static_cast<std::size_t>(basis_functions) * D * count, T(0));
    material_state = initial_state(*material->plugin);
    const std::vector<T> gradient = columns(seeds.velocity_gradient, D * D);
    std::copy(gradient.begin(), gradient.end(), transfer_state.begin());  // the affine velocity is the first field
    if (plan.particle_domain) {
      domain.resize(static_cast<std::size_t>(D) * D * count);
      for (int c = 0; c < D; ++c)
        std::fill_n(domain.begin() + static_cast<long>(c * (D + 1)) * count, count, half_size);
    }
    for (int k = 0; k < plan.sample_points * D; ++k)
      corners.insert(corners.end(), count, k / D >> k % D & 1 ? half_size : -half_size);
    moved_corners = corners;
    stress.resize(static_cast<std::size_t>(D == 2 ? 4 : 6) * count), volume_ratio.resize(count);
    velocity_gradient.resize(static_cast<std::size_t>(D) * D * count), wave_speed.resize(count);
    if (!axisymmetric) return;
    hoop_rate.resize(count), circumference.resize(count);
    for (int p = 0; p < count; ++p)
      circumference[p] = static_cast<T>(2 * std::numbers::pi * seeds.position[static_cast<std::size_t>(p) * D]);
  }

  /// [particle][component] to [component][particle].
  std::vector<T> columns(const std::vector<double>& values, int components) const {
    std::vector<T> result(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      result[i % components * count + i / components] = static_cast<T>(values[i]);
    return result;
  }
  std::vector<double> particle_major(const T* array, int components, double unit = 1) const {
    std::vector<double> result(static_cast<std::size_t>(components) * count);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = unit * array[i % components * count + i / components];
    return result;
  }

  std::vector<T> initial_state(const Plugin& plugin) const {
    std::vector<T> state;
    for (const mpm_state& declared : plugin.state())
      for (int k = 0; k < state_components(kept_shape(declared, axisymmetric), dimension); ++k)
        state.insert(state.end(), count, starts_as_one(declared, k, dimension, axisymmetric) ? T(1) : T(0));
    return state;
  }
  std::map<std::string, std::vector<double>> fields(const std::vector<T>& state, const Plugin& plugin) const {
    std::map<std::string, std::vector<double>> result;
    const T* at = state.data();
    for (const mpm_state& declared : plugin.state()) {
      const int components = state_components(kept_shape(declared, axisymmetric), dimension);
      result[declared.name] = particle_major(at, components);
      at += static_cast<long>(components) * count;
    }
    return result;
  }

  ParticleArrays<T> arrays() {
    return {count,
            count,
            mass,
            volume,
            half_size,
            position.data(),
            velocity.data(),
            advection.data(),
            domain.empty() ? nullptr : domain.data(),
            corners.empty() ? nullptr : corners.data(),
            corners.empty() ? nullptr : moved_corners.data(),
            stencil_domain.empty() ? nullptr : stencil_domain.data(),
            transfer_state.data(),
            material_state.data(),
            stress.data(),
            volume_ratio.data(),
            velocity_gradient.data(),
            wave_speed.data(),
            axisymmetric ? circumference.data() : nullptr,
            axisymmetric ? hoop_rate.data() : nullptr,
            frozen ? 1 : 0};
  }

  /// Particles into blocks of cells, blocks in order of their cells. A position that is no number goes to block 0,
  /// where the scatter reports it.
  void sort(const Arguments<T>& a) {
    std::map<std::array<int, 3>, std::vector<int>> blocks;
    for (int p = 0; p < count; ++p) {
      std::array<int, 3> cell{};
      for (int c = 0; c < dimension; ++c) {
        const T x = (position[static_cast<std::size_t>(c) * count + p] - a.lower[c]) * a.inverse_cell_size;
        if (std::abs(x) < T(1e9)) cell[c] = static_cast<int>(std::floor(x / block_cells)) * block_cells;
      }
      blocks[cell].push_back(p);
    }
    block_cell.clear(), order.clear(), block_begin = {0};
    for (const auto& [cell, particles] : blocks) {
      block_cell.insert(block_cell.end(), cell.begin(), cell.end());
      order.insert(order.end(), particles.begin(), particles.end());
      block_begin.push_back(static_cast<int>(order.size()));
    }
  }
  int blocks() const { return static_cast<int>(block_begin.size()) - 1; }
};

template <class T>
struct Field {
  std::vector<T> mass, momentum, force, velocity_before, velocity, volume, volume_gradient, mass_position, increment,
      projected, trial_velocity, kept_velocity, constrained, kept_constrained;
  std::vector<int> folded;

  Field(const Plan& plan, std::size_t nodes, int D) : mass(nodes), folded(nodes) {
    for (auto* channel : {&momentum, &force, &velocity_before, &velocity}) channel->resize(D * nodes);
    if (plan.contact) volume.resize(nodes), volume_gradient.resize(D * nodes), mass_position.resize(D * nodes);
    if (plan.filter)
      for (auto* channel : {&increment, &projected, &trial_velocity, &kept_velocity}) channel->resize(D * nodes);
    if (plan.constrained_velocity) constrained.resize(D * nodes), kept_constrained.resize(D * nodes);
  }
  GridArrays<T> arrays() {
    const auto pointer = [](std::vector<T>& channel) { return channel.empty() ? nullptr : channel.data(); };
    return {pointer(mass),
            pointer(momentum),
            pointer(force),
            pointer(velocity_before),
            pointer(velocity),
            pointer(volume),
            pointer(volume_gradient),
            pointer(mass_position),
            pointer(increment),
            pointer(projected),
            pointer(trial_velocity),
            pointer(kept_velocity),
            pointer(constrained),
            pointer(kept_constrained),
            folded.data()};
  }
};

template <class T>
class HostRun final : public Backend {
 public:
  HostRun(const Experiment& experiment, const Plan& plan, const std::vector<SeededBody>& seeded, HostDevice device,
          const TeamShape& team)
      : experiment_(experiment), plan_(plan), device_(std::move(device)), team_(team) {
    refuse_what_kernels_lack();
    describe_scene();
    for (std::size_t body = 0; body < seeded.size(); ++body)
      bodies_.emplace_back(experiment, plan, static_cast<int>(body), seeded[body]);
    const std::size_t nodes = scene_.node_count, D = experiment.dimension;
    for (int field = 0; field < experiment.field_count; ++field)
      fields_.emplace_back(plan, nodes, experiment.dimension);
    for (int axis = 0; axis < experiment.dimension; ++axis) (periodic(axis) ? images_ : walls_).push_back(axis);
    if (!plan.contact) return;
    for (int field = 0; field < experiment.field_count; ++field)
      edges_.emplace_back(experiment.shape, rows_per_cell(field));
    active_.resize(nodes), status_.resize(nodes);
    normal_.resize(D * nodes), impulse_.resize(D * nodes);
    separation_.resize(nodes), area_.resize(nodes), dissipated_.resize(nodes);
  }

  std::string_view name() const override { return "host-run device"; }

  void execute(const Pass& pass, const StepInfo& step) override {
    scene_.dt = static_cast<T>(step.dt);
    switch (pass.operators.front().act) {
      case Act::estimate_time_step:
        return estimate_time_step();
      case Act::sort:
      case Act::sort_ahead:
        return;  // the scatter sorts
      case Act::clear:
        return for_each_field("clear", nodes());
      case Act::scatter_momentum:
      case Act::scatter_force:
        return scatter(pass);
      case Act::divide:
        return momentum_to_velocity(pass);
      case Act::accelerate:
        return apply_forces(step);
      case Act::gather:
        return gather(pass, step);
      case Act::strain:
        return strain(pass);
      case Act::move:
        return move();
      case Act::begin_filter:
        return begin_filter();
      case Act::project:
        return project();
      case Act::update_filter:
        return update_filter();
      case Act::end_filter:
        return end_filter(pass);
      case Act::restore_velocity:
        for_each_field(pass.has(Act::keep_correction) ? "keep_correction" : "restore_velocity", vectors());
        return for_each_field("velocity_to_momentum", vectors());
      case Act::add_correction:
        return add_correction();
      default:
        throw std::logic_error("the host-run device does not execute pass \"" + pass.name() + "\"");
    }
  }

  TimeStepLimit time_step_limit() const override { return limit_; }
  const Ledger& ledger() const override { return ledger_; }
  const ContactRecord& contact_record() const override { return contact_; }
  const FilterRecord& filter_record() const override { return filter_; }
  bool scattered() const override { return false; }
  void save(ArchiveWriter&) const override { throw std::logic_error("the host-run device saves no checkpoints"); }
  void restore(ArchiveReader&) override { throw std::logic_error("the host-run device reads no checkpoints"); }
  std::uint64_t particle_bytes() const override {
    std::uint64_t scalars = 0;
    for (const Body<T>& body : bodies_)
      scalars += body.position.size() + body.velocity.size() + 2 * body.corners.size() + body.advection.size() +
                 body.domain.size() + body.stencil_domain.size() + body.transfer_state.size() +
                 body.material_state.size() + body.stress.size() + body.volume_ratio.size() +
                 body.velocity_gradient.size() + body.wave_speed.size();
    return scalars * sizeof(T);
  }
  std::uint64_t grid_bytes() const override {
    const std::uint64_t D = experiment_.dimension;
    return fields_.size() * scene_.node_count *
           ((1 + 4 * D + (plan_.contact ? 1 + 2 * D : 0) + (plan_.filter ? 4 * D : 0)) * sizeof(T) + sizeof(int));
  }

  BodyState body_state(int index) const override {
    const Body<T>& body = bodies_[index];
    const int D = experiment_.dimension;
    BodyState state;
    state.position = body.particle_major(body.position.data(), D);
    state.velocity = body.particle_major(body.velocity.data(), D);
    state.transfer_state = body.fields(body.transfer_state, *body.transfer->plugin);
    if (const int scalars = body.basis_functions * D; scalars > 0)
      state.transfer_state[polynomial_coefficients] = body.particle_major(
          body.transfer_state.data() + body.transfer_state.size() - static_cast<std::size_t>(scalars) * body.count,
          scalars);
    state.material_state = body.fields(body.material_state, *body.material->plugin);
    state.mass = body.mass, state.volume = body.volume;
    if (body.axisymmetric) state.circumference = body.particle_major(body.circumference.data(), 1);
    if (!body.corners.empty())
      state.corners = body.particle_major(body.corners.data(), plan_.sample_points * D, experiment_.grid.cell_size);
    if (!body.domain.empty()) state.domain = body.particle_major(body.domain.data(), D * D, experiment_.grid.cell_size);
    return state;
  }

 private:
  // ---- the scene ---------------------------------------------------------------------------------------------------

  void refuse_what_kernels_lack() const {
    const auto refuse = [](const std::string& what) {
      throw std::invalid_argument("the device kernels do not do " + what + " yet; use the backend \"cpu\"");
    };
    for (int axis = 0; axis < experiment_.dimension; ++axis)
      for (const FaceCondition& face : experiment_.faces[axis])
        if (face.type == ConditionType::prescribed || face.velocity) refuse("walls of a given velocity");
    if (!experiment_.boxes.empty()) refuse("boxes of conditions");
    if (experiment_.body_force) refuse("body forces");
    if (plan_.ledger) refuse("the energy ledger (\"/output/ledger\": false turns it off)");
    if (team_.lanes < 1 || team_.lanes > largest_team)
      throw std::invalid_argument("a team has 1 to " + std::to_string(largest_team) + " lanes");
  }

  void describe_scene() {
    const GridSpecification& grid = experiment_.grid;
    scene_ = {};
    scene_.cell_size = static_cast<T>(grid.cell_size);
    scene_.inverse_cell_size = static_cast<T>(1 / grid.cell_size);
    scene_.node_count = 1;
    for (int c = 0; c < 3; ++c) {
      const bool used = c < experiment_.dimension;
      scene_.lower[c] = static_cast<T>(grid.lower[c]);
      scene_.gravity[c] = static_cast<T>(experiment_.gravity[c]);
      scene_.cells[c] = used ? grid.cells[c] : 0;
      scene_.padding[c] = used ? grid_padding_of(experiment_.shape.plugin->shape()) : 0;
      scene_.extent[c] = scene_.cells[c] + 1 + 2 * scene_.padding[c];
      scene_.node_count *= scene_.extent[c];
      for (int side = 0; side < 2; ++side)
        scene_.walls[c][side] = used ? static_cast<int>(experiment_.faces[c][side].type) : wall_free;
    }
    const auto block = [](const std::optional<Component>& component) {
      return component ? component->parameters.data() : nullptr;
    };
    scene_.shape_parameters = experiment_.shape.parameters.data();
    scene_.transfer_parameters = experiment_.transfer.parameters.data();
    scene_.filter_parameters = block(experiment_.filter), scene_.contact_parameters = block(experiment_.contact);
    scene_.first_failed = &first_failed_;
  }

  bool periodic(int axis) const { return scene_.walls[axis][0] == wall_periodic; }
  int nodes() const { return scene_.node_count; }
  int vectors() const { return experiment_.dimension * scene_.node_count; }
  int rows_per_cell(int field) const {
    int rows = 8;
    for (const BodySpecification& body : experiment_.bodies)
      if (body.field == field) rows = std::min(rows, body.particles_per_cell_axis);
    return rows;
  }

  // ---- launching ---------------------------------------------------------------------------------------------------

  int teams(int indices) const { return (indices + team_.lanes - 1) / team_.lanes; }

  /// One phase over `indices` of every field's grid.
  void for_each_field(const std::string& phase, int indices, bool remap = false) {
    for (Field<T>& field : fields_) {
      Arguments<T> a = scene_;
      a.grid = field.arrays(), a.remap = remap, a.iteration = static_cast<int>(filter_.iterations + 1);
      device_.run(phase, a, teams(indices), team_);
    }
  }

  /// One phase of folds along the lines of every one of these axes.
  void for_each_axis(const std::string& phase, const std::vector<int>& axes, bool remap = false) {
    for (const int axis : axes)
      for (Field<T>& field : fields_) {
        Arguments<T> a = scene_;
        a.grid = field.arrays(), a.axis = axis, a.remap = remap;
        device_.run(phase, a, teams(nodes() / scene_.extent[axis]), team_);
      }
  }
  /// Periodic images first, then walls; ghosts are filled in the reverse order.
  std::vector<int> folded_axes() const {
    std::vector<int> axes = images_;
    axes.insert(axes.end(), walls_.begin(), walls_.end());
    return axes;
  }
  std::vector<int> filled_axes() const {
    std::vector<int> axes = folded_axes();
    std::reverse(axes.begin(), axes.end());
    return axes;
  }

  Arguments<T> arguments_of(Body<T>& body) {
    Arguments<T> a = scene_;
    a.particles = body.arrays();
    a.grid = fields_[body.field].arrays();
    a.material_parameters = body.material->parameters.data();
    a.blocks = {body.block_cell.data(), body.block_begin.data(), body.order.data()};
    return a;
  }

  /// Runs a phase and stops the run where it reports a particle.
  void run(const std::string& phase, const Arguments<T>& a, int teams, const Body<T>& body, const char* cause) {
    first_failed_ = INT_MAX;
    device_.run(phase, a, teams, team_);
    if (first_failed_ != INT_MAX)
      throw RunFailure(cause, static_cast<int>(&body - bodies_.data()), static_cast<std::size_t>(first_failed_));
  }
  void run_material(const std::string& phase, Body<T>& body) { run_material(phase, arguments_of(body), body); }
  void run_material(const std::string& phase, const Arguments<T>& a, Body<T>& body) {
    run(phase + "_" + std::to_string(body.material_number), a, teams(body.count), body,
        "inverted: its volume ratio J is not positive");
  }
  void run_strain(const Pass& pass, Body<T>& body) {
    Arguments<T> a = arguments_of(body);
    a.dt *= static_cast<T>(pass.share);
    run_material("strain", a, body);
  }
  static constexpr const char* outside_grid =
      "its stencil reaches beyond the grid or does not hold its domain, or its position is not a number";

  // ---- passes ------------------------------------------------------------------------------------------------------

  void estimate_time_step() {
    limit_ = {};
    for (std::size_t index = 0; index < bodies_.size(); ++index) {
      Body<T>& body = bodies_[index];
      run_material("wave_speed", body);
      for (int p = 0; p < body.count; ++p) {
        double square = 0;
        for (int c = 0; c < experiment_.dimension; ++c) {
          const double v = body.velocity[static_cast<std::size_t>(c) * body.count + p];
          square += v * v;
        }
        const double speed = body.wave_speed[p] + std::sqrt(square);
        if (speed > limit_.speed)
          limit_ = {speed, body.wave_speed[p], static_cast<int>(index), static_cast<std::size_t>(p)};
      }
    }
  }

  void scatter(const Pass& pass) {
    if (pass.remap()) for_each_field("clear", nodes(), true);
    for (Body<T>& body : bodies_) {
      if (pass.has(Act::scatter_momentum) && !pass.remap()) {
        body.stencil_domain = body.domain;
        body.sort(scene_);
      }
      if (pass.has(Act::scatter_force) || pass.has(Act::scatter_contact)) run_material("stress", body);
      Arguments<T> a = arguments_of(body);
      a.momentum = pass.has(Act::scatter_momentum), a.force = pass.has(Act::scatter_force),
      a.contact_fields = pass.has(Act::scatter_contact), a.remap = pass.remap();
      run("scatter", a, body.blocks(), body, outside_grid);
    }
    if (!pass.has(Act::scatter_momentum)) return;
    for_each_axis("fold_masses", images_, pass.remap());
    if (!pass.remap()) for_each_axis("fold_forces", images_);
  }

  void momentum_to_velocity(const Pass& pass) {
    for_each_axis("fold_masses", walls_, pass.remap());
    if (!pass.remap()) for_each_axis("fold_forces", folded_axes());
    if (plan_.constrained_velocity) for_each_field("keep_free_velocity", vectors());
    for_each_field("impose_walls", nodes());
    if (plan_.contact) resolve_contact(nullptr);
    for_each_field("momentum_to_velocity", nodes(), pass.remap());
    if (plan_.constrained_velocity) for_each_field("measure_constraints", vectors());
    for_each_axis("fill_velocities", filled_axes());
  }

  void apply_forces(const StepInfo& step) {
    for_each_axis("fold_forces", folded_axes());  // what USF scattered after the momenta were folded
    for_each_field("accelerate", vectors());
    if (plan_.constrained_velocity) for_each_field("keep_free_velocity", vectors());
    for_each_field("impose_walls", nodes());
    if (plan_.contact) resolve_contact(&step);
    for_each_field("update_velocity", nodes());
    if (plan_.constrained_velocity) for_each_field("measure_constraints", vectors());
    for_each_axis("fill_velocities", filled_axes());
  }

  void gather(const Pass& pass, const StepInfo& step) {
    for (Body<T>& body : bodies_) {
      Arguments<T> a = arguments_of(body);
      a.update_particles = true, a.filtered = step.filtered;
      run("gather", a, teams(body.count), body, outside_grid);
      if (pass.has(Act::strain)) run_strain(pass, body);
    }
    if (pass.has(Act::move)) move();
  }

  void strain(const Pass& pass) {
    for (Body<T>& body : bodies_) {
      run("gather", arguments_of(body), teams(body.count), body, outside_grid);
      run_strain(pass, body);
    }
  }

  const char* move_failure() const {
    return plan_.sample_points > 0 ? "left the domain, or its corners have turned its own domain inside out"
                                   : "left the domain";
  }
  void move() {
    for (Body<T>& body : bodies_) run("move", arguments_of(body), teams(body.count), body, move_failure());
  }

  // ---- contact -----------------------------------------------------------------------------------------------------

  /// The law on every pair of fields, then walls again. With a step the pair's force goes to the record.
  void resolve_contact(const StepInfo* step) {
    if (step) contact_ = {};
    for (std::size_t a = 0; a < fields_.size(); ++a)
      for (std::size_t b = a + 1; b < fields_.size(); ++b) {
        find_pairs(a, b);
        Arguments<T> arguments = scene_;
        arguments.grid = fields_[a].arrays(), arguments.other = fields_[b].arrays();
        arguments.contact = {active_.data(),  normal_.data(),     separation_.data(), area_.data(),
                             impulse_.data(), dissipated_.data(), status_.data()};
        device_.run("contact", arguments, teams(nodes()), team_);
        if (step) record_pairs(step->dt);
      }
    for_each_field("impose_walls", nodes());
  }

  /// Normal, separation and area at every node that two fields share (simulation/contact_pair.hpp).
  void find_pairs(std::size_t a, std::size_t b) {
    const bool weld = experiment_.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION;
    const int D = experiment_.dimension, n = nodes();
    for (int node = 0; node < n; ++node) {
      const ContactFieldNode of_a = contact_view(fields_[a], node), of_b = contact_view(fields_[b], node);
      active_[node] = 0;
      if (of_a.mass <= 0 || of_b.mass <= 0) continue;
      if (!weld && std::min(of_a.mass, of_b.mass) < contact_prescreen * (of_a.mass + of_b.mass)) continue;
      const ContactGeometry geometry =
          contact_geometry(of_a, of_b, edges_[a], edges_[b], experiment_.grid.cell_size, D);
      if (!geometry.valid && !weld) continue;
      active_[node] = 1;
      for (int c = 0; c < D; ++c) normal_[static_cast<std::size_t>(c) * n + node] = static_cast<T>(geometry.normal[c]);
      separation_[node] = static_cast<T>(geometry.separation), area_[node] = static_cast<T>(geometry.area);
    }
  }
  ContactFieldNode contact_view(const Field<T>& field, int node) const {
    ContactFieldNode view{field.mass[node], field.volume[node], {}, {}};
    for (int c = 0; c < experiment_.dimension; ++c) {
      const std::size_t at = static_cast<std::size_t>(c) * nodes() + node;
      view.volume_gradient[c] = field.volume_gradient[at], view.mass_position[c] = field.mass_position[at];
    }
    return view;
  }
  void record_pairs(double dt) {
    for (int node = 0; node < nodes(); ++node) {
      if (!active_[node] || status_[node] == MPM_APART) continue;
      for (int c = 0; c < experiment_.dimension; ++c)
        contact_.force[c] += impulse_[static_cast<std::size_t>(c) * nodes() + node] / dt;
      ++contact_.nodes;
      ++(status_[node] == MPM_STICKS ? contact_.sticking : contact_.slipping);
      contact_.largest_penetration = std::max(contact_.largest_penetration, -static_cast<double>(separation_[node]));
    }
  }

  // ---- filter ------------------------------------------------------------------------------------------------------

  /// sqrt(sum m v*.v*), the teams' sums added on the host.
  double increment_norm() {
    double sum = 0;
    std::vector<T> partial(teams(nodes()));
    for (Field<T>& field : fields_) {
      Arguments<T> a = scene_;
      a.grid = field.arrays(), a.partial_sums = partial.data();
      device_.run("increment_norm", a, teams(nodes()), team_);
      for (const T part : partial) sum += part;
    }
    return std::sqrt(sum);
  }

  void begin_filter() {
    for_each_field("begin_filter", vectors());
    filter_.iterations = 0;
    filter_.first_norm = filter_.last_norm = increment_norm();
  }

  void project() {
    for_each_field("clear_projection", vectors());
    for (Body<T>& body : bodies_) run("project", arguments_of(body), body.blocks(), body, outside_grid);
    for_each_axis("fold_projection", folded_axes());
  }

  void update_filter() {
    for_each_field("update_filter", nodes());
    if (experiment_.filter_schedule.constrain_always) {
      constrain_velocity();
      for_each_field("correct_increment", vectors());
    }
    filter_.take_norm(increment_norm());
    for_each_axis("fill_increments", filled_axes());
  }

  /// Walls, contact and walls again on the grid's velocity without what they have added so far.
  void constrain_velocity() {
    if (plan_.constrained_velocity) for_each_field("take_free_velocity", vectors());
    for_each_field("velocity_to_momentum", vectors());
    for_each_field("impose_walls", nodes());
    if (plan_.contact) resolve_contact(nullptr);
    for_each_field("update_velocity", nodes());
    if (plan_.constrained_velocity) for_each_field("measure_constraints", vectors());
  }

  void end_filter(const Pass& pass) {
    if (!experiment_.filter_schedule.constrain_always) constrain_velocity();
    for_each_axis("fill_velocities", filled_axes());
    if (pass.stage == Stage::before_forces) return;
    for_each_field("velocity_to_momentum", vectors());
  }

  void add_correction() {
    for_each_field("add_correction", vectors());
    constrain_velocity();
    for_each_axis("fill_velocities", filled_axes());
    for_each_field("velocity_to_momentum", vectors());
  }

  const Experiment& experiment_;
  const Plan& plan_;
  HostDevice device_;
  TeamShape team_;
  Arguments<T> scene_;
  std::vector<Body<T>> bodies_;
  std::vector<Field<T>> fields_;
  std::vector<int> images_, walls_;  ///< axes
  std::vector<EdgeModel> edges_;
  std::vector<int> active_, status_;
  std::vector<T> normal_, separation_, area_, impulse_, dissipated_;
  int first_failed_ = INT_MAX;
  TimeStepLimit limit_;
  Ledger ledger_;  ///< stays empty: refused where it is asked for
  ContactRecord contact_;
  FilterRecord filter_;
};

}  // namespace

std::unique_ptr<Backend> make_host_run(const Experiment& experiment, const Plan& plan,
                                       const std::vector<SeededBody>& seeded, const HostDevice& device,
                                       const TeamShape& team) {
  if (experiment.precision == Precision::single)
    return std::make_unique<HostRun<float>>(experiment, plan, seeded, device, team);
  return std::make_unique<HostRun<double>>(experiment, plan, seeded, device, team);
}

}  // namespace mpm::device

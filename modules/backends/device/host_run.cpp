#include "backends/device/host_run.hpp"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>

#include "backends/device/conditions.hpp"
#include "backends/device/field_arrays.hpp"
#include "backends/device/heat_conditions.hpp"
#include "backends/device/host_arrays.hpp"
#include "backends/device/kernels/sums.hpp"  // largest_team
#include "backends/device/noted_reactions.hpp"
#include "simulation/boundary.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/contact_pair.hpp"
#include "simulation/loads.hpp"

namespace mpm::device {
namespace {

template <class T>
class HostRun final : public Backend {
 public:
  HostRun(const Experiment& experiment, const Plan& plan, const std::vector<SeededBody>& seeded, HostDevice device,
          const TeamShape& team)
      : experiment_(experiment),
        plan_(plan),
        device_(std::move(device)),
        team_(team),
        scene_(described(experiment)),
        conditions_(experiment, scene_),
        edges_(edge_models(experiment)),
        contact_impulse_(experiment),
        reactions_(experiment),
        noted_(experiment, scene_, reactions_, experiment.field_count) {
    if (team.lanes < 1 || team.lanes > largest_team)
      throw std::invalid_argument("a team has 1 to " + std::to_string(largest_team) + " lanes");
    scene_.first_failed = &first_failed_;
    if (experiment.has_temperature()) heat_conditions_.emplace(experiment, scene_);
    for (std::size_t body = 0; body < seeded.size(); ++body) {
      bodies_.emplace_back(experiment, plan, static_cast<int>(body), seeded[body]);
      loads_.emplace_back(experiment, static_cast<int>(body), seeded[body]);
    }
    const std::size_t nodes = scene_.node_count, D = experiment.dimension;
    for (int field = 0; field < experiment.field_count; ++field) fields_.emplace_back(experiment, plan, nodes);
    for (int axis = 0; axis < experiment.dimension; ++axis) (periodic(axis) ? images_ : walls_).push_back(axis);
    for (VelocityField<T>& field : fields_) grips_.push_back(grip_arrays(experiment, field));
    if (!plan.resolves_contact()) return;
    active_.resize(nodes), status_.resize(nodes);
    normal_.resize(D * nodes), impulse_.resize(D * nodes), unbalanced_.resize(D * nodes);
    separation_.resize(nodes), area_.resize(nodes), dissipated_.resize(nodes);
  }

  std::string_view name() const override { return "host-run device"; }

  void execute(const Pass& pass, const StepInfo& step) override {
    scene_.dt = static_cast<T>(step.dt);
    accounted_ = plan_.accounts_at(step.step);
    notes_reactions_ = reactions_.asked() && !pass.remap();
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
        return scatter(pass, step);
      case Act::divide:
        return momentum_to_velocity(pass, step);
      case Act::accelerate:
        return apply_forces(step);
      case Act::gather:
        return gather(pass, step);
      case Act::strain:
        return strain(pass);
      case Act::move:
        return move();
      case Act::begin_filter:
        return begin_filter(pass);
      case Act::project:
        return project(pass, step);
      case Act::update_filter:
        return update_filter(pass, step);
      case Act::end_filter:
        return end_filter(pass, step);
      case Act::divide_heat:
        return heat_to_temperature();
      case Act::conduct:
        return conduct();
      case Act::heat:
        return warm(step);
      case Act::change_phase:
        return change_phase();
      case Act::restore_velocity:
        if (accounted_ && !pass.has(Act::keep_correction)) ledger_.filtered_strain -= early_share_ * power_of_filter();
        contact_impulse_.restore(pass.has(Act::keep_correction));
        reactions_.restore(pass.has(Act::keep_correction));
        return for_each_field(pass.has(Act::keep_correction) ? "keep_correction" : "restore_velocity", vectors());
      case Act::add_correction:
        return add_correction(pass, step);
      default:  // the other acts share a visit with one of these
        throw std::logic_error("the host-run device does not execute pass \"" + pass.name() + "\"");
    }
  }

  TimeStepLimit time_step_limit() const override { return limit_; }
  const Ledger& ledger() const override { return ledger_; }
  HeatLedger heat_ledger() const override { return heat_ledger_; }
  const ContactRecord& contact_record() const override { return contact_; }
  const std::vector<PairRecord>& contact_pairs() const override { return contact_impulse_.pairs(); }
  const FilterRecord& filter_record() const override { return filter_; }
  const std::vector<Reaction>& reactions() const override { return reactions_.reactions(); }
  bool scattered() const override { return false; }

  std::uint64_t particle_bytes() const override {
    std::uint64_t sum = 0;
    for (const Body<T>& body : bodies_) sum += body.arrays.bytes();
    return sum;
  }
  std::uint64_t grid_bytes() const override {
    std::uint64_t sum = 0;
    for (const VelocityField<T>& field : fields_) sum += field.bytes();
    return sum;
  }

  void save(ArchiveWriter& archive) const override {
    for (const Body<T>& body : bodies_)
      for_each_saved(body, [&](const Field& field, int number) {
        archive.put(field.id, body.arrays.of(number), body.arrays.size(number));
      });
    archive.put("ledger", ledger_);
    if (plan_.has_heat_ledger()) archive.put("heat ledger", heat_ledger_);
    archive.put("contact", contact_);
    archive.put("contact_pairs", contact_impulse_.pairs());
    archive.put("filter", filter_);
    reactions_.save(archive);
    archive.put("limit speeds", std::array{limit_.speed, limit_.wave_speed});
    archive.put("limit particle",
                std::array<std::uint64_t, 2>{static_cast<std::uint64_t>(limit_.body), limit_.particle});
  }
  void restore(ArchiveReader& archive) override {
    for (Body<T>& body : bodies_) {
      for_each_saved(body, [&](const Field& field, int number) {
        archive.get(field.id, body.arrays.of(number), body.arrays.size(number));
      });
      // A step strains its domains further from where the last one left them.
      if (T* const strained = body.arrays.of("strained_domain"))
        std::copy_n(body.arrays.of("domain"), body.arrays.size(body.number("domain")), strained);
    }
    archive.get("ledger", ledger_);
    if (plan_.has_heat_ledger()) archive.get("heat ledger", heat_ledger_);
    archive.get("contact", contact_);
    archive.get("contact_pairs", contact_impulse_.pairs());
    archive.get("filter", filter_);
    reactions_.restore(archive);
    std::array<double, 2> speeds{};
    std::array<std::uint64_t, 2> particle{};
    archive.get("limit speeds", speeds);
    archive.get("limit particle", particle);
    limit_ = {speeds[0], speeds[1], static_cast<int>(particle[0]), particle[1]};
  }

  BodyState body_state(int index) const override {
    Body<T> body = bodies_[index];  // this copy takes the second moments
    if (plan_.stencil.second_moment) {
      // A particle without a stencil has no second moment; the next pass that needs it says so.
      const int moments = body.number("second_moment");
      std::fill_n(body.arrays.of(moments), body.arrays.size(moments), std::numeric_limits<T>::quiet_NaN());
      int failed = INT_MAX;
      Arguments<T> a = scene_;
      a.particles = body.table(), a.first_failed = &failed;
      device_.run("second_moments", a, teams(body.count), team_);
    }
    const double h = experiment_.grid.cell_size;
    BodyState state;
    for_each_saved(body, [&](const Field& field, int number) {
      state.of(field) = body.arrays.index_major(number, field.unit == "cells" ? h : 1);
    });
    state.initial_position = body.initial_position;
    state.mass = body.mass, state.volume = body.volume;
    if (plan_.stencil.second_moment) state.second_moment = body.arrays.index_major(body.number("second_moment"), h * h);
    return state;
  }

 private:
  // ---- the scene ---------------------------------------------------------------------------------------------------

  static Arguments<T> described(const Experiment& experiment) {
    const GridSpecification& grid = experiment.grid;
    Arguments<T> scene{};
    scene.cell_size = static_cast<T>(grid.cell_size);
    scene.inverse_cell_size = static_cast<T>(1 / grid.cell_size);
    scene.node_count = 1;
    for (int c = 0; c < 3; ++c) {
      const bool used = c < experiment.dimension;
      scene.lower[c] = static_cast<T>(grid.lower[c]);
      scene.gravity_has_potential[c] = experiment.gravity_has_potential(c);
      scene.cells[c] = used ? grid.cells[c] : 0;
      scene.padding[c] = used ? grid_padding_of(experiment.shape.plugin->shape()) : 0;
      scene.extent[c] = scene.cells[c] + 1 + 2 * scene.padding[c];
      scene.node_count *= scene.extent[c];
      for (int side = 0; side < 2; ++side)
        scene.walls[c][side] = used ? static_cast<int>(experiment.faces[c][side].type) : wall_free;
    }
    const auto block = [](const std::optional<Component>& component) {
      return component ? component->parameters.data() : nullptr;
    };
    scene.shape_parameters = experiment.shape.parameters.data();
    scene.transfer_parameters = experiment.transfer.parameters.data();
    scene.filter_parameters = block(experiment.filter), scene.contact_parameters = block(experiment.contact);
    return scene;
  }

  bool periodic(int axis) const { return scene_.walls[axis][0] == wall_periodic; }
  int nodes() const { return scene_.node_count; }
  int vectors() const { return experiment_.dimension * scene_.node_count; }

  /// Calls visit(field, number) for what a checkpoint holds, in order.
  template <class AnyBody, class Visit>
  static void for_each_saved(AnyBody& body, Visit visit) {
    for (int number = 0; number < static_cast<int>(body.arrays.fields().size()); ++number)
      if (body.arrays.fields()[number].lifetime == Lifetime::saved) visit(body.arrays.fields()[number], number);
  }

  // ---- launching ---------------------------------------------------------------------------------------------------

  int teams(int indices) const { return (indices + team_.lanes - 1) / team_.lanes; }

  /// Settings of phases over the grid beside the scene.
  struct Manner {
    bool remap = false, after_forces = false, walls_at_rest = false;
  };
  Arguments<T> arguments_of(VelocityField<T>& field, const Manner& manner) {
    Arguments<T> a = scene_;
    take_grips(a, &field - fields_.data());
    a.grid = field.table(), a.iteration = static_cast<int>(filter_.iterations + 1);
    a.remap = manner.remap, a.after_forces = manner.after_forces, a.walls_at_rest = manner.walls_at_rest;
    return a;
  }

  static std::vector<GripArrays<T>> grip_arrays(const Experiment& experiment, VelocityField<T>& field) {
    std::vector<GripArrays<T>> arrays;
    for (std::size_t k = 0; k < experiment.grips.size(); ++k) {
      const std::string id = grip_field(k);
      int given = 0;
      for (int c = 0; c < experiment.dimension; ++c) given |= int(experiment.grips[k].held[c]) << c;
      arrays.push_back({field.arrays.of(id + "_mass"), field.arrays.of(id), field.arrays.of(id + "_before"), given});
    }
    return arrays;
  }
  void take_grips(Arguments<T>& a, std::ptrdiff_t field) const {
    const std::vector<GripArrays<T>>& grips = grips_[static_cast<std::size_t>(field)];
    a.grips = grips.data(), a.grip_count = static_cast<int>(grips.size());
  }

  /// Runs one phase over `indices` of every field's grid.
  void for_each_field(const std::string& phase, int indices, const Manner& manner = {}) {
    for (VelocityField<T>& field : fields_) device_.run(phase, arguments_of(field, manner), teams(indices), team_);
  }

  /// Runs one phase of folds along the lines of every one of these axes.
  void for_each_axis(const std::string& phase, const std::vector<int>& axes, const Manner& manner = {}) {
    for (const int axis : axes)
      for (VelocityField<T>& field : fields_) {
        Arguments<T> a = arguments_of(field, manner);
        a.axis = axis;
        device_.run(phase, a, teams(nodes() / scene_.extent[axis]), team_);
      }
  }
  /// The axes in the order of folding: periodic images come before walls. Ghosts are filled in the reverse order.
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
    a.particles = body.table();
    a.grid = fields_[body.field].table();
    take_grips(a, body.field);
    a.material_parameters = body.material->parameters.data();
    a.melted_parameters = body.melted_parameters();
    a.blocks = {body.block_cell.data(), body.block_begin.data(), body.order.data()};
    return a;
  }

  /// Runs a phase that sums in teams, and adds up in order what the teams have summed.
  template <std::size_t count = 1>
  std::array<double, count> sum(const std::string& phase, Arguments<T> a, int indices) {
    std::vector<double> partial(count * static_cast<std::size_t>(teams(indices)));
    a.partial_sums = partial.data();
    device_.run(phase, a, teams(indices), team_);
    std::array<double, count> sums{};
    for (std::size_t k = 0; k < partial.size(); ++k) sums[k % count] += partial[k];
    return sums;
  }
  double sum_over_nodes(const std::string& phase) {
    double total = 0;
    for (VelocityField<T>& field : fields_) total += sum(phase, arguments_of(field, {}), nodes())[0];
    return total;
  }
  double sum_over_particles(const std::string& phase, Body<T>& body) {
    return sum(phase, arguments_of(body), body.count)[0];
  }

  /// The reasons for which a phase reports particles.
  enum class Checks { stencil, temperature, deformation, position };

  /// Runs a phase and stops the run where it reports a particle.
  void run(const std::string& phase, const Arguments<T>& a, int teams, const Body<T>& body, Checks checks) {
    first_failed_ = INT_MAX;
    device_.run(phase, a, teams, team_);
    if (first_failed_ == INT_MAX) return;
    const Failure failure = checks == Checks::temperature   ? failed_temperature(body, first_failed_)
                            : checks == Checks::deformation ? failed_deformation(body, first_failed_)
                            : checks == Checks::position    ? failed_position(body, first_failed_)
                                                            : failed_stencil(body, first_failed_);
    throw RunFailure(failure);
  }

  // A phase reports only the particle: what is wrong with it stands in its arrays.

  Failure failure_of(Cause cause, const Body<T>& body, int p) const {
    return {cause, static_cast<int>(&body - bodies_.data()), static_cast<std::size_t>(p)};
  }
  std::optional<Failure> position_not_a_number(const Body<T>& body, int p) const {
    const Vector3 x = body.vector(body.arrays.of("position"), p);
    for (int c = 0; c < experiment_.dimension; ++c)
      if (!std::isfinite(x[c])) {
        Failure failure = failure_of(Cause::position_not_a_number, body, p);
        failure.axis = c, failure.value = x[c];
        return failure;
      }
    return std::nullopt;
  }
  Failure failed_temperature(const Body<T>& body, int p) const {
    const T temperature = body.arrays.of("temperature")[p];
    if (std::isfinite(temperature)) return failed_stencil(body, p);
    Failure failure = failure_of(Cause::temperature_not_a_number, body, p);
    failure.value = temperature;
    return failure;
  }
  Failure failed_deformation(const Body<T>& body, int p) const {
    const T J = body.arrays.of("volume_ratio")[p];
    Failure failure = failure_of(std::isnan(J) ? Cause::deformation_not_a_number : Cause::inverted, body, p);
    failure.value = J;
    return failure;
  }
  Failure failed_stencil(const Body<T>& body, int p) const {
    if (const auto failure = position_not_a_number(body, p)) return *failure;
    if (body.turned_inside_out("corners", p)) return failure_of(Cause::domain_inside_out, body, p);
    const bool list = experiment_.shape.plugin->shape().form == MPM_NODE_LIST;
    return failure_of(list ? Cause::domain_beyond_grid : Cause::domain_outgrew_stencil, body, p);
  }
  /// Reports the first of the axes beyond which the particle is; the test is that of the phase "move".
  Failure failed_position(const Body<T>& body, int p) const {
    if (const auto failure = position_not_a_number(body, p)) return *failure;
    if (body.turned_inside_out("moved_corners", p)) return failure_of(Cause::domain_inside_out, body, p);
    Failure failure = failure_of(Cause::left_domain, body, p);
    T farthest = -std::numeric_limits<T>::infinity();
    for (int c = 0; c < experiment_.dimension; ++c) {
      const T x = body.arrays.of("position")[static_cast<std::size_t>(c) * body.count + p];
      if (c == 0 && experiment_.axisymmetric() && !(x > T(0))) {
        failure.cause = Cause::reached_axis, failure.axis = c, failure.value = x;
        return failure;
      }
      if (periodic(c)) continue;
      const T size = T(scene_.cells[c]) * scene_.cell_size, at = x - scene_.lower[c];
      const auto margin = [&](int side) {
        return scene_.walls[c][side] == wall_separate ? T(0.5) * scene_.cell_size : position_tolerance<T> * size;
      };
      const T beyond = std::max(-at - margin(0), at - size - margin(1));
      if (beyond > farthest) farthest = beyond, failure.axis = c, failure.value = x;
      if (beyond > T(0)) break;
    }
    return failure;
  }
  void run_material(const std::string& phase, Body<T>& body) { run_material(phase, arguments_of(body), body); }
  void run_material(const std::string& phase, const Arguments<T>& a, Body<T>& body) {
    run(phase + "_" + std::to_string(body.material_number), a, teams(body.count), body, Checks::deformation);
  }
  void run_strain(const Pass& pass, Body<T>& body) {
    Arguments<T> a = arguments_of(body);
    a.dt *= static_cast<T>(pass.share);
    run_material("strain", a, body);
    if (accounted_) book_material(body);
    if (plan_.has_heat_ledger() && body.heat.warming > 0)
      heat_ledger_.dissipation += sum_over_particles("heat_of_dissipation", body);
  }

  // ---- passes ------------------------------------------------------------------------------------------------------

  void estimate_time_step() {
    limit_ = {};
    for (std::size_t index = 0; index < bodies_.size(); ++index) {
      Body<T>& body = bodies_[index];
      run_material("wave_speed", body);
      for (int p = 0; p < body.count; ++p) {
        double square = 0;
        for (const double v : body.vector(body.arrays.of("velocity"), p)) square += v * v;
        const double wave = body.arrays.of("wave_speed")[p], speed = wave + std::sqrt(square);
        if (speed > limit_.speed) limit_ = {speed, wave, static_cast<int>(index), static_cast<std::size_t>(p)};
      }
    }
  }

  void scatter(const Pass& pass, const StepInfo& step) {
    const bool enters = pass.has(Act::scatter_momentum) && !pass.remap();  // the step begins
    const bool force = pass.has(Act::scatter_force);
    if (pass.remap()) for_each_field("clear", nodes(), {true});
    const bool heat = pass.has(Act::scatter_heat);
    double energy = 0;
    std::array<double, 4> unbalanced{};  // momentum and mass
    if (heat) scattered_heat_ = 0;
    for (Body<T>& body : bodies_) {
      if (enters) body.sort(scene_);
      if (force || heat || pass.has(Act::scatter_contact)) run_material("stress", body);  // with the volume ratio
      Arguments<T> a = arguments_of(body);
      a.momentum = pass.has(Act::scatter_momentum), a.force = force;
      a.contact_fields = pass.has(Act::scatter_contact), a.remap = pass.remap();
      run("scatter", a, body.blocks(), body, Checks::stencil);
      if (force) scatter_loads(body, a, step.time);
      if (heat) run("scatter_heat", a, body.blocks(), body, Checks::stencil);
      if (enters && !experiment_.grips.empty()) scatter_grips(body, step.time + step.dt);
      if (heat && plan_.has_heat_ledger()) scattered_heat_ += sum_over_particles("heat_of_particles", body);
      if (accounted_ && enters) energy += sum_over_particles("energy_of_particles", body);
      if (accounted_ && enters) add(unbalanced, 1, sum<4>("momentum_of_particles", arguments_of(body), body.count));
    }
    if (!pass.has(Act::scatter_momentum)) return;
    for (VelocityField<T>& field : fields_)
      if (accounted_ && enters) add(unbalanced, -1, sum<4>("momentum_of_nodes", arguments_of(field, {}), nodes()));
    const Vector3 gravity = experiment_.gravity_at(step.time);
    for (std::size_t c = 0; c < 3; ++c) scene_.gravity[c] = static_cast<T>(gravity[c]);
    if (enters) for_each_field("weigh", nodes());
    for_each_axis("fold_masses", images_, {pass.remap()});
    if (!enters) return;
    for_each_axis("fold_forces", images_);
    if (!accounted_) return;
    scattered_energy_ = sum_over_nodes("energy_of_momenta");
    ledger_.scatter += scattered_energy_ - energy;
    ledger_.mass_book += unbalanced[3];
    ledger_.momentum_book += std::hypot(unbalanced[0], unbalanced[1], unbalanced[2]);
    works_ = 0;
  }
  static void add(std::array<double, 4>& sum, double sign, const std::array<double, 4>& values) {
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += sign * values[k];
  }

  /// Evaluates what gripped particles are told for the end of the step, and lets nodes know of them.
  void scatter_grips(Body<T>& body, double end) {
    const std::size_t D = experiment_.dimension;
    const T *const position = body.arrays.of("position"), *const numbers = body.arrays.of("grip");
    T* const told = body.arrays.of("told_velocity");
    for (int p = 0; p < body.count; ++p) {
      if (!(numbers[p] > T(0))) continue;
      const Vector3 x = body.vector(position, p);
      Vector3 X = x;
      for (std::size_t c = 0; c < D && !body.initial_position.empty(); ++c) X[c] = body.initial_position[p * D + c];
      const Vector3 velocity =
          velocity_of(experiment_, experiment_.grips[static_cast<std::size_t>(numbers[p]) - 1], x, X, end);
      for (std::size_t c = 0; c < D; ++c) told[c * body.count + p] = static_cast<T>(velocity[c]);
    }
    for (std::size_t k = 0; k < experiment_.grips.size(); ++k) {
      Arguments<T> a = arguments_of(body);
      a.grip = static_cast<int>(k);
      run("scatter_grip", a, body.blocks(), body, Checks::stencil);
    }
  }

  /// Sums what grips gave a body's particles in the gather; returns the energy of it, J.
  double note_gripped(const Body<T>& body, const StepInfo& step) {
    std::vector<GivenToGripped> given(experiment_.grips.size());
    const T *const numbers = body.arrays.of("grip"), *const ring = body.arrays.of("size");
    for (int p = 0; p < body.count; ++p)
      if (numbers[p] > T(0))
        given[static_cast<std::size_t>(numbers[p]) - 1].add(
            double(body.mass) * (ring ? double(ring[p]) : 1.0), body.vector(body.arrays.of("position"), p),
            body.vector(body.arrays.of("gathered_velocity"), p), body.vector(body.arrays.of("velocity"), p));
    double energy = 0;
    for (std::size_t k = 0; k < given.size(); ++k) {
      reactions_.give_particles(experiment_.support_of_grip(k), given[k], step.dt);
      energy += given[k].energy;
    }
    return energy;
  }

  /// Evaluates the loads of a body at its particles, and scatters each kind into its own field. Throws RunFailure where
  /// one is not finite.
  void scatter_loads(Body<T>& body, Arguments<T> a, double time) {
    const BodyLoads& loads = loads_[static_cast<std::size_t>(&body - bodies_.data())];
    const std::size_t D = experiment_.dimension, n = static_cast<std::size_t>(body.count);
    T *const force = body.arrays.of("load_force"), *const moment = body.arrays.of("load_moment");
    FirstFailure failures;
    for (const ExternalForce kind : external_forces) {
      if (!loads.gives(kind)) continue;
      std::fill_n(force, D * n, T(0));
      if (moment) std::fill_n(moment, D * D * n, T(0));
      kind == ExternalForce::body_force ? evaluate_body_force(body, loads, time, failures)
                                        : evaluate_loads(body, loads, kind, time, failures);
      a.load_field = number_of(fields_[body.field].arrays.fields(), field_of(kind));
      run("scatter_load", a, body.blocks(), body, Checks::stencil);
    }
    failures.raise();
  }

  void evaluate_body_force(Body<T>& body, const BodyLoads& loads, double time, FirstFailure& failures) {
    const std::size_t D = experiment_.dimension, n = static_cast<std::size_t>(body.count);
    std::vector<double> x(D * n), X(D * n), values(D * n);
    PointArrays at;
    std::array<double*, 3> result{};
    for (std::size_t c = 0; c < D; ++c) {
      for (std::size_t p = 0; p < n; ++p) {
        x[c * n + p] = body.component(body.arrays.of("position"), static_cast<int>(p), static_cast<int>(c));
        X[c * n + p] = body.initial_position.empty() ? x[c * n + p] : body.initial_position[p * D + c];
      }
      at.x[c] = x.data() + c * n, at.X[c] = X.data() + c * n, result[c] = values.data() + c * n;
    }
    loads.accelerations(n, nullptr, at, time, result, failures);
    T* const force = body.arrays.of("load_force");
    const T* const around = body.arrays.of("size");
    for (std::size_t k = 0; k < D * n; ++k)
      force[k] = static_cast<T>(double(body.mass) * (around ? double(around[k % n]) : 1.0) * values[k]);
  }

  void evaluate_loads(Body<T>& body, const BodyLoads& loads, ExternalForce kind, double time, FirstFailure& failures) {
    const std::size_t D = experiment_.dimension, n = static_cast<std::size_t>(body.count);
    const T* const deformation = body.arrays.of("deformation");
    T *const force = body.arrays.of("load_force"), *const moment = body.arrays.of("load_moment");
    const auto read = [&](int p, LoadedParticle& particle) {
      particle.x = particle.X = body.vector(body.arrays.of("position"), p);
      particle.v = body.vector(body.arrays.of("velocity"), p);
      for (std::size_t c = 0; c < D && !body.initial_position.empty(); ++c)
        particle.X[c] = body.initial_position[p * D + c];
      for (std::size_t k = 0; k < D * D; ++k) particle.F[k] = deformation[k * n + p];
    };
    const auto give = [&](int p, const LoadCoefficients& given) {
      for (std::size_t c = 0; c < D; ++c) force[c * n + p] = static_cast<T>(given.b[c]);
      for (std::size_t k = 0; k < D * D; ++k) moment[k * n + p] = static_cast<T>(given.S[k]);
    };
    loads.evaluate(kind, body.count, nullptr, time, read, give, failures);
  }

  void momentum_to_velocity(const Pass& pass, const StepInfo& step) {
    begin_stage(accounted_ && !pass.remap());
    conditions_.evaluate(step.time, scene_);
    if (heat_conditions_) heat_conditions_->evaluate(step.time, scene_);
    const bool records_heat = plan_.has_heat_ledger() && !pass.remap() && heat_conditions_->walls_act();
    const double heat = records_heat ? sum_over_nodes("heat_of_nodes") : 0.0;
    if (notes_reactions_) reactions_.begin_step();
    fold_momenta({pass.remap()});
    if (!pass.remap()) heat_of_images_ = records_heat ? sum_over_nodes("heat_of_nodes") - heat : 0.0;
    if (!pass.remap()) fold_forces();
    for_each_field("divide", vectors());
    scene_.grips_at_end = pass.remap();
    keep_free_velocity({});
    impose_conditions({});
    if (plan_.resolves_contact()) {
      resolve_contact(step, pass.remap() ? Recorded::nothing : Recorded::before_forces);
      impose_conditions({});
    }
    measure_constraints();
    if (notes_reactions_) reactions_.keep_before();
    if (scene_.records) book_folds(), book_impulses();
    if (!pass.remap()) for_each_field("keep_velocity", vectors());
    for_each_axis("fill_velocities", filled_axes());
  }

  void apply_forces(const StepInfo& step) {
    const Manner after{false, true};
    scene_.grips_at_end = true;
    conditions_.evaluate(step.time + step.dt, scene_);
    scene_.records = accounted_;
    fold_forces();  // folds what USF scattered after the momenta were folded
    if (accounted_) book_folds();
    for_each_field("accelerate", nodes());
    begin_stage(accounted_);
    keep_free_velocity(after);
    impose_conditions(after);
    if (plan_.resolves_contact()) {
      resolve_contact(step, Recorded::after_forces);
      impose_conditions(after);
    }
    measure_constraints();
    if (experiment_.damping.acts()) damp(step);
    if (accounted_) account_for_impulses();
    for_each_axis("fill_velocities", filled_axes());
    if (notes_reactions_) reactions_.apply_forces(step.dt);
    record_reactions(step);
  }

  // ---- reactions: copies of what phases change are enough to tell what walls and boxes give by them -----------------

  /// Copies a field of nodes.
  static std::vector<T> copy_of(const VelocityField<T>& field, const char* id) {
    const int number = number_of(field.arrays.fields(), id);
    return {field.arrays.of(number), field.arrays.of(number) + field.arrays.size(number)};
  }
  static std::vector<T> sum_of_forces(const VelocityField<T>& field) {
    std::vector<T> sum;
    for (int number = 0; number < static_cast<int>(field.arrays.fields().size()); ++number) {
      const Field& force = field.arrays.fields()[number];
      if (force.folded != Folded::with_force || force.at_wall != AtWall::vector) continue;
      sum.resize(field.arrays.size(number));
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += field.arrays.of(number)[k];
    }
    return sum;
  }

  void fold_momenta(const Manner& manner) {
    for (const int axis : walls_) {
      std::vector<std::vector<T>> momenta, masses;
      for (std::size_t k = 0; notes_reactions_ && k < fields_.size(); ++k)
        momenta.push_back(copy_of(fields_[k], "momentum")), masses.push_back(copy_of(fields_[k], "mass"));
      for_each_axis("fold_masses", {axis}, manner);
      for (std::size_t k = 0; k < momenta.size(); ++k)
        noted_.fold_momenta(static_cast<int>(k), fields_[k], axis, std::move(momenta[k]), std::move(masses[k]));
    }
  }
  void fold_forces() {
    for (const int axis : folded_axes()) {
      std::vector<std::vector<T>> forces;
      for (std::size_t k = 0; notes_reactions_ && !periodic(axis) && k < fields_.size(); ++k)
        forces.push_back(sum_of_forces(fields_[k]));
      for_each_axis("fold_forces", {axis});
      for (std::size_t k = 0; k < forces.size(); ++k) noted_.fold_forces(fields_[k], axis, std::move(forces[k]));
    }
  }
  void fold_projection(bool at_rest) {
    for (const int axis : folded_axes()) {
      std::vector<std::vector<T>> projections;
      for (std::size_t k = 0; notes_reactions_ && !periodic(axis) && k < fields_.size(); ++k)
        projections.push_back(copy_of(fields_[k], "projection"));
      for_each_axis("fold_projection", {axis}, {false, false, at_rest});
      for (std::size_t k = 0; k < projections.size(); ++k)
        noted_.fold_projection(static_cast<int>(k), fields_[k], axis, std::move(projections[k]), at_rest);
    }
  }
  void impose_conditions(const Manner& manner) {
    for (std::size_t k = 0; notes_reactions_ && k < fields_.size(); ++k)
      noted_.hold(fields_[k], conditions_.supports(), grips_[k], scene_.grips_at_end);
    for_each_field("impose_conditions", nodes(), manner);
  }
  void note_gathered_increment() {
    if (!notes_reactions_) return;
    reactions_.begin_projection();
    for (const int axis : walls_)
      for (std::size_t k = 0; k < fields_.size(); ++k) noted_.gather_increment(static_cast<int>(k), fields_[k], axis);
  }
  /// Records what particles take from the supports when they gather the velocity as it is now.
  void record_reactions(const StepInfo& step) {
    if (!notes_reactions_) return;
    reactions_.begin_gather();
    for (const int axis : walls_)
      for (std::size_t k = 0; k < fields_.size(); ++k) noted_.gather(static_cast<int>(k), fields_[k], axis);
    reactions_.record(step);
  }

  void damp(const StepInfo& step) {
    const Damping& damping = experiment_.damping;
    const Manner after{false, true};
    scene_.local_damping = static_cast<T>(damping.local);
    scene_.left_of_velocity = static_cast<T>(damping.left_of_velocity(step.dt));
    scene_.left_of_change = static_cast<T>(damping.left_of_change(step.dt));
    for_each_field("damp", vectors());
    keep_free_velocity(after);
    impose_conditions(after);
    measure_constraints();
  }

  void account_for_impulses() {
    for (VelocityField<T>& field : fields_) {
      const auto work = sum<11>("work_of_forces", arguments_of(field, {}), nodes());
      book(&Ledger::internal_force, work[0]), book(&Ledger::body_force, work[1]), book(&Ledger::gravity, work[2]);
      for (const ExternalForce kind : external_forces)
        if (kind != ExternalForce::body_force) book(row_of(kind), work[5 + static_cast<std::size_t>(kind)]);
      book(&Ledger::boundary, work[3]), book(&Ledger::contact, work[4]),
          book(&Ledger::gravity_without_potential, work[5]);
      book(&Ledger::damping, work[10]);
    }
    energy_after_ = sum_over_nodes("energy_of_velocities");
    lumped_power_ = power_of_forces();
  }

  // ---- the ledger: whoever gives a node an impulse notes it; works are booked when a stage of the step ends ---------

  void begin_stage(bool records) {
    scene_.records = records;
    if (records) for_each_field("clear_impulses", vectors());
  }
  /// Books a work on the nodes.
  void book(double Ledger::*row, double work) {
    ledger_.*row += work;
    works_ += work;
  }
  /// Books what folding at walls gave the nodes, and the work of walls on what lies beyond them.
  void book_folds() {
    for (VelocityField<T>& field : fields_) {
      const auto work = sum<2>("work_of_folds", arguments_of(field, {}), nodes());
      book(&Ledger::boundary, work[0]);
      ledger_.boundary += work[1];
    }
    for_each_field("clear_work_of_folds", nodes());
  }
  void book_impulses() {
    for (VelocityField<T>& field : fields_) {
      const auto work = sum<3>("work_of_impulses", arguments_of(field, {}), nodes());
      book(&Ledger::boundary, work[0]), book(&Ledger::contact, work[1]), book(&Ledger::filter, work[2]);
    }
  }
  /// Books the works of a filter's loop, and what they do not explain of the kinetic energy.
  void book_filter() {
    const double works = works_, before = energy_after_;
    book_impulses();
    energy_after_ = sum_over_nodes("energy_of_velocities");
    ledger_.filter_book += energy_after_ - before - (works_ - works);
    works_ = works + energy_after_ - before;
  }
  /// The works of the stresses' forces and of gravity at the velocity of now, J.
  std::array<double, 2> power_of_forces() {
    std::array<double, 2> power{};
    for (VelocityField<T>& field : fields_) {
      const auto of_field = sum<2>("power_of_forces", arguments_of(field, {}), nodes());
      for (std::size_t k = 0; k < power.size(); ++k) power[k] += of_field[k];
    }
    return power;
  }
  /// Books what strain by the velocity of now stores less than by v+ before any filter.
  void book_strain(double Ledger::*row, double share) {
    ledger_.*row -= share * (power_of_forces()[0] - lumped_power_[0]);
  }
  double power_of_filter() { return sum_over_nodes("power_of_filter"); }
  void book_material(Body<T>& body) {
    const auto [dissipated, power, stored] = sum<3>("energy_dissipated", arguments_of(body), body.count);
    ledger_.material += dissipated, ledger_.stress_power += power, ledger_.stored += stored;
    ledger_.material_book += power - stored - dissipated;
  }
  double energy_of_particles() {
    double energy = 0;
    for (Body<T>& body : bodies_) energy += sum_over_particles("energy_of_particles", body);
    return energy;
  }

  void gather(const Pass& pass, const StepInfo& step) {
    double energy = 0, heat = 0, gripped = 0;
    if (accounted_ && step.filtered) {
      if (pass.has(Act::strain)) book_strain(&Ledger::filtered_strain, pass.share);
      ledger_.filtered_gravity -= power_of_forces()[1] - lumped_power_[1];
    }
    scene_.records = accounted_;
    for (Body<T>& body : bodies_) {
      Arguments<T> a = arguments_of(body);
      a.update_particles = true, a.filtered = step.filtered;
      a.moves_by_mean = experiment_.filter_schedule.moves_by_mean;
      run("gather", a, teams(body.count), body, Checks::stencil);
      if (!experiment_.grips.empty()) gripped += note_gripped(body, step);
      if (pass.has(Act::gather_heat)) run("gather_heat", a, teams(body.count), body, Checks::temperature);
      if (pass.has(Act::gather_heat) && plan_.has_heat_ledger()) heat += sum_over_particles("heat_of_particles", body);
      if (accounted_) energy += sum_over_particles("energy_of_particles", body);  // weights are still those of the step
      if (pass.has(Act::strain)) run_strain(pass, body);
    }
    if (accounted_) {
      ledger_.gather += energy - energy_after_ - gripped;
      ledger_.boundary += gripped;
      ledger_.grid_book += energy_after_ - scattered_energy_ - works_;
      energy_before_move_ = energy;
    }
    if (pass.has(Act::gather_heat) && plan_.has_heat_ledger()) heat_ledger_.gather += heat - heat_after_;
    if (pass.has(Act::move)) move();
    if (pass.has(Act::change_phase)) change_phase();
  }

  void strain(const Pass& pass) {
    if (accounted_ && pass.remap()) book_strain(&Ledger::remapped_strain, pass.share);
    if (pass.stage == Stage::before_forces) early_share_ = pass.share;
    scene_.records = accounted_;
    for (Body<T>& body : bodies_) {
      run("gather", arguments_of(body), teams(body.count), body, Checks::stencil);
      run_strain(pass, body);
    }
  }

  void move() {
    for (Body<T>& body : bodies_) run("move", arguments_of(body), teams(body.count), body, Checks::position);
    if (accounted_) ledger_.second_moment += energy_of_particles() - energy_before_move_;
  }

  // ---- heat --------------------------------------------------------------------------------------------------------

  /// The heat that a pair of rows of the ledger takes, J.
  using HeatOfTwo = std::array<double, 2>;

  /// Finds temperatures before the step's heat, those of ghosts too.
  void heat_to_temperature() {
    for_each_field("divide_heat", nodes());
    if (plan_.has_heat_ledger())
      heat_ledger_.scatter += sum_over_nodes("heat_of_temperatures") - heat_of_images_ - scattered_heat_;
    const HeatOfTwo held = impose_temperature();
    beyond_ = fill_temperature();
    if (plan_.has_heat_ledger()) heat_ledger_.images += heat_of_images_ + held[0] + held[1] + beyond_[0] + beyond_[1];
    for_each_field("keep_temperature", nodes());
  }

  /// Imposes what walls and boxes hold, as evaluated last; returns the heat that each gives by it.
  HeatOfTwo impose_temperature() {
    HeatOfTwo given{};
    for (VelocityField<T>& field : fields_) {
      const HeatOfTwo of_field = sum<2>("impose_temperature", arguments_of(field, {}), nodes());
      given[0] += of_field[0], given[1] += of_field[1];
    }
    return given;
  }

  /// Fills ghosts; returns the heat by which they exceed their mirrors, at walls held at a temperature and at others.
  HeatOfTwo fill_temperature() {
    HeatOfTwo beyond{};
    for (const int axis : filled_axes())
      for (VelocityField<T>& field : fields_) {
        const HeatOfTwo of_field = sum_over_lines("fill_temperature", field, axis);
        beyond[0] += of_field[0], beyond[1] += of_field[1];
      }
    return beyond;
  }
  HeatOfTwo sum_over_lines(const char* phase, VelocityField<T>& field, int axis) {
    Arguments<T> a = arguments_of(field, {});
    a.axis = axis;
    return sum<2>(phase, a, nodes() / scene_.extent[axis]);
  }

  void conduct() {
    for (Body<T>& body : bodies_) run("conduct", arguments_of(body), body.blocks(), body, Checks::stencil);
  }

  /// Finds temperatures after the step's heat.
  void warm(const StepInfo& step) {
    const bool records_folds = plan_.has_heat_ledger() && heat_conditions_->walls_act();
    const double rate = records_folds ? sum_over_nodes("heat_rate_of_nodes") : 0.0;
    for_each_axis("fold_forces", folded_axes());
    if (records_folds) heat_ledger_.walls += step.dt * (sum_over_nodes("heat_rate_of_nodes") - rate);
    for (const int axis : heat_conditions_->exchanging_axes())
      for (VelocityField<T>& field : fields_) {
        const HeatOfTwo rates = sum_over_lines("exchange_at_walls", field, axis);
        if (plan_.has_heat_ledger())
          heat_ledger_.flux += step.dt * rates[0], heat_ledger_.convection += step.dt * rates[1];
      }
    for (const int box : heat_conditions_->warmed_boxes()) warm_box(box, step.dt);
    for_each_field("warm", nodes());
    heat_conditions_->evaluate(step.time + step.dt, scene_);
    const HeatOfTwo held = impose_temperature(), beyond = fill_temperature();
    if (!plan_.has_heat_ledger()) return;
    heat_ledger_.walls += held[0] + beyond[0] - beyond_[0];
    heat_ledger_.boxes += held[1];
    heat_ledger_.images += beyond[1] - beyond_[1];
    heat_after_ = sum_over_nodes("heat_of_temperatures") + beyond[0] + beyond[1];
  }

  void warm_box(int box, double dt) {
    double mass = 0;
    const auto over_fields = [&](const char* phase) {
      double total = 0;
      for (VelocityField<T>& field : fields_) {
        Arguments<T> a = arguments_of(field, {});
        a.heat_box = box, a.mass_of_box = static_cast<T>(mass);
        total += sum(phase, a, nodes())[0];
      }
      return total;
    };
    mass = over_fields("mass_of_box");
    if (!(mass > 0)) return;
    const double power = over_fields("warm_box");
    if (plan_.has_heat_ledger()) heat_ledger_.boxes += dt * power;
  }

  void change_phase() {
    for (Body<T>& body : bodies_) {
      if (!body.melts()) continue;
      run_material("change_phase", body);
      if (!accounted_) continue;
      const double lost = sum<3>("energy_dissipated", arguments_of(body), body.count)[0];
      ledger_.material += lost, ledger_.stored -= lost;
    }
  }

  // ---- contact -----------------------------------------------------------------------------------------------------

  /// The part of contact that goes to the ledger and to the record.
  enum class Recorded { nothing, before_forces, after_forces, filter };

  /// Applies the law to every pair of fields.
  void resolve_contact(const StepInfo& step, Recorded recorded) {
    if (recorded == Recorded::after_forces) contact_ = {};
    Vector3 unbalanced{};
    ContactGiven given;
    given.pairs.reserve(contact_impulse_.pairs().size());
    for (std::size_t a = 0; a < fields_.size(); ++a)
      for (std::size_t b = a + 1; b < fields_.size(); ++b) {
        find_pairs(a, b);
        Arguments<T> arguments = scene_;
        arguments.grid = fields_[a].table(), arguments.other = fields_[b].table();
        arguments.contact = {active_.data(),  normal_.data(),     separation_.data(), area_.data(),
                             impulse_.data(), unbalanced_.data(), dissipated_.data(), status_.data()};
        device_.run("contact", arguments, teams(nodes()), team_);
        if (recorded == Recorded::after_forces) record_pairs(unbalanced);
        add_given(given);
      }
    Ledger* const ledger = scene_.records ? &ledger_ : nullptr;
    if (recorded == Recorded::before_forces) contact_impulse_.before_forces(given, step.filtered, ledger);
    if (recorded == Recorded::filter)
      contact_impulse_.in_filter(given, plan_.node_field("velocity_of_constraints") != nullptr, ledger);
    if (recorded != Recorded::after_forces) return;
    contact_impulse_.after_forces(given, ledger);
    contact_impulse_.record_counts(given);
    record_force(step);
    contact_.momentum_residual = std::hypot(unbalanced[0], unbalanced[1], unbalanced[2]);
  }
  void add_given(ContactGiven& sum) const {
    if (!contact_impulse_.pairs().empty()) add_pair(sum.pairs.emplace_back());
    for (int node = 0; node < nodes(); ++node) {
      if (!active_[node]) continue;
      sum.dissipated += dissipated_[node];
      for (int c = 0; c < experiment_.dimension; ++c)
        sum.impulse[c] += impulse_[static_cast<std::size_t>(c) * nodes() + node];
    }
  }
  /// Adds what the law did to the pair that it was asked about last.
  void add_pair(PairGiven& pair) const {
    for (int node = 0; node < nodes(); ++node) {
      if (!active_[node]) continue;
      for (int c = 0; c < experiment_.dimension; ++c)
        pair.impulse[c] += impulse_[static_cast<std::size_t>(c) * nodes() + node];
      pair.count(status_[node], separation_[node], true);
    }
  }
  /// Records the force that particles take when they gather the velocity as it is now.
  void record_force(const StepInfo& step) {
    const Vector3 impulse = contact_impulse_.handed_over(step.filtered);
    for (std::size_t c = 0; c < 3; ++c) contact_.force[c] = impulse[c] / step.dt;
    contact_impulse_.record_forces(step.filtered, step.dt);
  }

  /// Finds normal, separation and area at every node that two fields share (simulation/contact_pair.hpp).
  void find_pairs(std::size_t a, std::size_t b) {
    const bool weld = experiment_.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION;
    const int D = experiment_.dimension, n = nodes();
    const ContactFields fields_of_a(fields_[a]), fields_of_b(fields_[b]);
    for (int node = 0; node < n; ++node) {
      const ContactFieldNode of_a = fields_of_a.at(node, D, n), of_b = fields_of_b.at(node, D, n);
      active_[node] = 0;
      if (!meet(of_a.mass, of_b.mass, weld)) continue;
      const ContactGeometry geometry =
          contact_geometry(of_a, of_b, edges_[a], edges_[b], experiment_.grid.cell_size, D);
      if (!geometry.valid && !weld) continue;
      active_[node] = 1;
      for (int c = 0; c < D; ++c) normal_[static_cast<std::size_t>(c) * n + node] = static_cast<T>(geometry.normal[c]);
      separation_[node] = static_cast<T>(geometry.separation), area_[node] = static_cast<T>(geometry.area);
    }
  }
  /// The fields of one velocity field that detection reads.
  struct ContactFields {
    const T *mass, *volume, *volume_gradient, *mass_position;
    explicit ContactFields(const VelocityField<T>& field)
        : mass(field.arrays.of("mass")),
          volume(field.arrays.of("volume")),
          volume_gradient(field.arrays.of("volume_gradient")),
          mass_position(field.arrays.of("mass_position")) {}
    ContactFieldNode at(int node, int dimension, int nodes) const {
      ContactFieldNode view{mass[node], volume[node], {}, {}};
      for (int c = 0; c < dimension; ++c) {
        const std::size_t at = static_cast<std::size_t>(c) * nodes + node;
        view.volume_gradient[c] = volume_gradient[at], view.mass_position[c] = mass_position[at];
      }
      return view;
    }
  };
  void record_pairs(Vector3& unbalanced) {
    for (int node = 0; node < nodes(); ++node) {
      if (!active_[node]) continue;
      for (int c = 0; c < experiment_.dimension; ++c)
        unbalanced[c] += unbalanced_[static_cast<std::size_t>(c) * nodes() + node];
      if (status_[node] == MPM_APART) continue;
      ++contact_.nodes;
      ++(status_[node] == MPM_STICKS ? contact_.sticking : contact_.slipping);
      contact_.largest_penetration = std::max(contact_.largest_penetration, -static_cast<double>(separation_[node]));
    }
  }

  // ---- filter ------------------------------------------------------------------------------------------------------

  /// The time of the walls' velocity: that of v- before the forces, of v+ after them.
  static double time_of(const Pass& pass, const StepInfo& step) {
    return pass.stage == Stage::after_forces ? step.time + step.dt : step.time;
  }

  double increment_norm() { return std::sqrt(sum_over_nodes("increment_norm")); }

  void keep_unfiltered() {
    for_each_field("keep_unfiltered", vectors());
    contact_impulse_.keep();
    reactions_.keep();
  }

  void begin_filter(const Pass& pass) {
    for_each_field("begin_filter", vectors());
    if (pass.has(Act::keep_velocity)) keep_unfiltered();
    filter_.iterations = 0;
    filter_.first_norm = filter_.last_norm = increment_norm();
    begin_stage(accounted_ && pass.stage == Stage::after_forces);
  }

  /// The first increment is a velocity, which a moving wall mirrors about its own; later ones are differences.
  void project(const Pass& pass, const StepInfo& step) {
    conditions_.evaluate(time_of(pass, step), scene_);
    for_each_field("clear_projection", vectors());
    for (Body<T>& body : bodies_) run("project", arguments_of(body), body.blocks(), body, Checks::stencil);
    note_gathered_increment();
    fold_projection(filter_.iterations > 0);
  }

  void update_filter(const Pass& pass, const StepInfo& step) {
    for_each_field("update_filter", nodes());
    if (notes_reactions_) reactions_.take_projection(static_cast<int>(filter_.iterations + 1));
    if (experiment_.filter_schedule.constrain_always) {
      constrain_velocity(pass, step);
      for_each_field("correct_increment", vectors());
    }
    filter_.take_norm(increment_norm(), 4500.0 * static_cast<double>(std::numeric_limits<T>::epsilon()));
    for_each_axis("fill_increments", filled_axes());
  }

  void keep_free_velocity(const Manner& manner) {
    if (plan_.node_field("velocity_of_constraints")) for_each_field("keep_free_velocity", vectors(), manner);
  }
  void measure_constraints() {
    if (plan_.node_field("velocity_of_constraints")) for_each_field("measure_constraints", vectors());
  }

  /// Applies conditions, contact and conditions again to the grid's velocity without what they have added so far; of
  /// ledger and records the contact force alone changes.
  void constrain_velocity(const Pass& pass, const StepInfo& step) {
    conditions_.evaluate(time_of(pass, step), scene_);
    scene_.grips_at_end = pass.stage != Stage::before_forces;
    if (plan_.node_field("velocity_of_constraints")) {
      for_each_field("take_free_velocity", vectors());
      if (notes_reactions_) reactions_.take_back();
    }
    impose_conditions({});
    if (plan_.resolves_contact()) {
      resolve_contact(step, pass.remap() ? Recorded::nothing : Recorded::filter);
      if (pass.stage == Stage::after_forces) record_force(step);
      impose_conditions({});
    }
    measure_constraints();
  }

  void end_filter(const Pass& pass, const StepInfo& step) {
    conditions_.evaluate(time_of(pass, step), scene_);
    if (!experiment_.filter_schedule.constrain_always) constrain_velocity(pass, step);
    for_each_axis("fill_velocities", filled_axes());
    if (scene_.records) book_filter();
    if (pass.stage == Stage::after_forces) record_reactions(step);
  }

  void add_correction(const Pass& pass, const StepInfo& step) {
    begin_stage(accounted_);
    for_each_field("add_correction", vectors());
    contact_impulse_.add_correction();
    reactions_.add_correction();
    constrain_velocity(pass, step);
    for_each_axis("fill_velocities", filled_axes());
    if (accounted_) book_filter();
    record_reactions(step);
  }

  const Experiment& experiment_;
  const Plan& plan_;
  HostDevice device_;
  TeamShape team_;
  Arguments<T> scene_;
  Conditions<T> conditions_;
  std::optional<HeatConditions<T>> heat_conditions_;  ///< empty in scenes without temperature
  std::vector<Body<T>> bodies_;
  std::vector<BodyLoads> loads_;  ///< of each body
  std::vector<VelocityField<T>> fields_;
  std::vector<std::vector<GripArrays<T>>> grips_;  ///< [velocity field][grip]
  std::vector<int> images_, walls_;                ///< axes with periodic images, and those with walls
  std::vector<EdgeModel> edges_;
  std::vector<int> active_, status_;
  std::vector<T> normal_, separation_, area_, impulse_, unbalanced_, dissipated_;
  int first_failed_ = INT_MAX;
  TimeStepLimit limit_;
  Ledger ledger_;
  HeatLedger heat_ledger_;
  bool accounted_ = false;  ///< the ledger takes its entries from the step under way
  ContactRecord contact_;
  ContactImpulse contact_impulse_;
  ReactionImpulse reactions_;
  NotedReactions<T> noted_;
  bool notes_reactions_ = false;  ///< the pass under way notes what supports give
  FilterRecord filter_;
  double scattered_energy_ = 0;           ///< kinetic energy of the grid as scattered, images summed, J
  double energy_after_ = 0;               ///< kinetic energy of the grid when particles gather from it, J
  double works_ = 0;                      ///< works on the grid since the scatter, J
  std::array<double, 2> lumped_power_{};  ///< works of the stresses' forces and of gravity at v+ before any filter, J
  double early_share_ = 0;                ///< share of the step's strain that came before the forces
  double energy_before_move_ = 0;         ///< kinetic energy of the particles after the gather, J
  double scattered_heat_ = 0;             ///< heat of the particles that the step's scatter began with, J
  double heat_of_images_ = 0;  ///< heat that folding has given the grid at walls that do something with heat, J
  HeatOfTwo beyond_{};         ///< see fill_temperature, before the step's heat
  double heat_after_ = 0;      ///< heat of the grid when particles gather from it, J
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

// The textbook: the material point method in plain double precision, one pass after another, every particle and node
// spelled out. Slow on purpose; every faster backend is tested against it.

#include <array>
#include <cmath>
#include <sstream>

#include "backends/reference/particles.hpp"
#include "simulation/contact_pair.hpp"

namespace mpm {
namespace reference {
namespace {

class ReferenceBackend final : public Backend {
 public:
  ReferenceBackend(const Experiment& experiment, const Plan& plan, const std::vector<SeededBody>& seeded)
      : experiment_(experiment), plan_(plan), grid_(experiment) {
    for (std::size_t body = 0; body < seeded.size(); ++body)
      bodies_.emplace_back(experiment, plan, static_cast<int>(body), seeded[body]);
    if (plan.contact)
      for (int field = 0; field < experiment.field_count; ++field)
        edges_.emplace_back(experiment.shape, rows_per_cell(field));
  }

  std::string_view name() const override { return "reference"; }

  void execute(const Pass& pass, const StepInfo& step) override {
    switch (pass.kind) {
      case PassKind::estimate_time_step:
        return estimate_time_step();
      case PassKind::sort:
        return;  // particles stay in the order of seeding
      case PassKind::reset_grid:
        return grid_.reset();
      case PassKind::scatter:
        return scatter(pass, step);
      case PassKind::momentum_to_velocity:
        return momentum_to_velocity(pass, step);
      case PassKind::apply_forces:
        return apply_forces(step);
      case PassKind::gather:
        return gather(pass, step);
      case PassKind::strain:
        return strain(step);
      case PassKind::move:
        return move(step);
      default:
        throw std::logic_error("the reference backend does not execute pass \"" + pass.name() + "\"");
    }
  }

  TimeStepLimit time_step_limit() const override { return limit_; }
  BodyState body_state(int body) const override { return bodies_[body].state(); }
  const Ledger& ledger() const override { return ledger_; }
  const ContactRecord& contact_record() const override { return contact_; }
  const FilterRecord& filter_record() const override { return filter_; }
  bool scattered() const override { return false; }
  void save(ArchiveWriter&) const override { throw std::logic_error("not yet"); }
  void restore(ArchiveReader&) override { throw std::logic_error("not yet"); }
  std::uint64_t grid_bytes() const override { return grid_.bytes(); }
  std::uint64_t particle_bytes() const override {
    std::uint64_t sum = 0;
    for (const Particles& body : bodies_) sum += body.bytes();
    return sum;
  }

 private:
  /// Rows of particles a cell of the coarsest body in a field: its surface lags the most.
  int rows_per_cell(int field) const {
    int rows = 8;
    for (const BodySpecification& body : experiment_.bodies)
      if (body.field == field) rows = std::min(rows, body.particles_per_cell_axis);
    return rows;
  }

  double particle_kinetic_energy() const {
    double sum = 0;
    for (const Particles& body : bodies_) sum += body.kinetic_energy();
    return sum;
  }

  void estimate_time_step() {
    limit_ = {};
    for (Particles& body : bodies_) {
      const TimeStepLimit candidate = body.time_step_limit();
      if (candidate.speed > limit_.speed) limit_ = candidate;
    }
  }

  void scatter(const Pass& pass, const StepInfo& step) {
    if (pass.remap) grid_.reset_momentum();
    for (Particles& body : bodies_) {
      if (!pass.remap && pass.momentum) body.find_stencils(grid_);
      if (pass.momentum) scatter_momentum(body, pass.remap);
      if (pass.force || pass.contact_fields) body.evaluate_stress();
      if (pass.force) scatter_force(body, step.time);
      if (pass.contact_fields) scatter_contact_fields(body);
    }
    if (!pass.momentum) return;
    grid_.sum_images(pass.remap);
    if (plan_.ledger && !pass.remap) ledger_.scatter += grid_.kinetic_energy() - particle_kinetic_energy();
  }

  /// Node by node: w m, and w (b + A d).
  void scatter_momentum(Particles& body, bool remap) {
    const bool affine = experiment_.transfer.plugin->transfer().traits & MPM_SCATTERS_AFFINE;
    const Vector gravity = to_eigen(experiment_.gravity);
    body.scatter_coefficients();
    for (std::size_t p = 0; p < body.count(); ++p) {
      const Vector b = body.column(body.b, p);
      const Matrix A = affine ? body.matrix(body.A, p) : Matrix(Matrix::Zero());
      for (const StencilNode& s : body.stencil(p)) {
        Node& node = grid_.node(body.field(), s.index);
        node.mass += s.weight * body.mass();
        node.momentum += s.weight * (b + A * s.distance);
        if (!remap) node.gravity_force += s.weight * body.mass() * gravity;
      }
    }
  }

  /// f = -V0 tau grad w, or -V0 tau (w D^-1 d) when the transfer takes stress by the affine term; body forces w m b(x,
  /// X, t).
  void scatter_force(Particles& body, double time) {
    const bool by_affine = experiment_.transfer.plugin->transfer().traits & MPM_STRESS_BY_AFFINE;
    for (std::size_t p = 0; p < body.count(); ++p) {
      const Matrix tau = body.symmetric(body.stress, p);
      Vector force = Vector::Zero();
      if (experiment_.body_force) {
        const Vector x = body.column(body.position, p);
        const Vector X = plan_.initial_position ? body.column(body.initial_position, p) : x;
        force = body.mass() * to_eigen((*experiment_.body_force)({x[0], x[1], x[2]}, {X[0], X[1], X[2]}, time));
      }
      for (const StencilNode& s : body.stencil(p)) {
        Node& node = grid_.node(body.field(), s.index);
        node.internal_force -= body.volume() * (tau * (by_affine ? s.affine : s.gradient));
        node.body_force += s.weight * force;
      }
    }
  }

  void scatter_contact_fields(Particles& body) {
    for (std::size_t p = 0; p < body.count(); ++p) {
      const double volume = body.volume() * body.volume_ratio(0, p);
      for (const StencilNode& s : body.stencil(p)) {
        Node& node = grid_.node(body.field(), s.index);
        node.volume += s.weight * volume;
        node.volume_gradient += volume * s.gradient;
        node.mass_position -= s.weight * body.mass() * s.distance;
      }
    }
  }

  void momentum_to_velocity(const Pass& pass, const StepInfo& step) {
    const double before = plan_.ledger ? grid_.kinetic_energy() : 0.0;
    grid_.fold_walls(step.time, pass.remap ? 0.0 : step.dt, pass.remap);
    if (!pass.remap) grid_.fold_forces();
    impose_conditions(step.time);
    if (plan_.ledger && !pass.remap) ledger_.boundary += grid_.kinetic_energy() - before;
    if (plan_.contact) resolve_contact(step, false, pass.remap);
    for (int field = 0; field < grid_.field_count(); ++field)
      for (std::size_t i = 0; i < grid_.node_count(); ++i) {
        Node& node = grid_.node(field, i);
        node.velocity = node.mass > 0 ? Vector(node.momentum / node.mass) : Vector(Vector::Zero());
        if (!pass.remap) node.velocity_before = node.velocity;
      }
    grid_.fill_ghosts(step.time);
  }

  /// Sets the momenta that conditions give.
  void impose_conditions(double time) {
    for (int field = 0; field < grid_.field_count(); ++field)
      for (std::size_t i = 0; i < grid_.node_count(); ++i) {
        Node& node = grid_.node(field, i);
        if (node.mass <= 0) continue;
        const Held held = grid_.held(i, node.momentum / node.mass, time);
        for (int c = 0; c < 3; ++c) {
          node.held[c] = node.held[c] || held.component[c];
          if (held.component[c]) node.momentum[c] = node.mass * held.velocity[c];
        }
      }
  }

  void apply_forces(const StepInfo& step) {
    grid_.fold_forces();  // forces that USF scattered after the momenta were folded; nothing is left of the others
    for (int field = 0; field < grid_.field_count(); ++field)
      for (std::size_t i = 0; i < grid_.node_count(); ++i) accelerate(grid_.node(field, i), step.dt);
    impose_conditions(step.time + step.dt);
    if (plan_.contact) resolve_contact(step, true);
    for (int field = 0; field < grid_.field_count(); ++field)
      for (std::size_t i = 0; i < grid_.node_count(); ++i) {
        Node& node = grid_.node(field, i);
        node.velocity = node.mass > 0 ? Vector(node.momentum / node.mass) : Vector(Vector::Zero());
        if (plan_.ledger && node.mass > 0) account_for_impulses(node, step.dt);
      }
    kinetic_energy_after_ = plan_.ledger ? grid_.kinetic_energy() : 0.0;
    grid_.fill_ghosts(step.time + step.dt);
  }

  static void accelerate(Node& node, double dt) {
    node.momentum += dt * node.force();
    std::fill(node.held, node.held + 3, false);  // conditions after the forces decide whose the reaction is
  }

  /// Work of every impulse between v- and v+ at their mean. What the forces do not explain is the reaction of a
  /// condition on held components and of contact on the others.
  void account_for_impulses(const Node& node, double dt) {
    const Vector mean = 0.5 * (node.velocity_before + node.velocity);
    const Vector reaction = node.mass * (node.velocity - node.velocity_before) - dt * node.force();
    ledger_.internal_force += dt * node.internal_force.dot(mean);
    ledger_.body_force += dt * node.body_force.dot(mean);
    ledger_.gravity += dt * node.gravity_force.dot(mean);
    for (int c = 0; c < 3; ++c) (node.held[c] ? ledger_.boundary : ledger_.contact) += reaction[c] * mean[c];
  }

  void resolve_contact(const StepInfo& step, bool after_forces, bool remap = false);

  void gather(const Pass& pass, const StepInfo& step) {
    for (Particles& body : bodies_) {
      gather_moments(body);
      body.gather(step.dt);
      if (pass.strain) ledger_.material += body.strain(step.dt);
    }
    if (plan_.ledger) ledger_.gather += particle_kinetic_energy() - kinetic_energy_after_;
    if (pass.move) move(step);
  }

  /// sum w v+, sum w (v+ - v-), C = sum v+ (x) w D^-1 d and L = sum v+ (x) grad w.
  void gather_moments(Particles& body) {
    const bool strain_by_affine = experiment_.transfer.plugin->transfer().traits & MPM_STRAIN_BY_AFFINE;
    for (std::size_t p = 0; p < body.count(); ++p) {
      Vector velocity = Vector::Zero(), increment = Vector::Zero();
      Matrix affine = Matrix::Zero(), gradient = Matrix::Zero();
      for (const StencilNode& s : body.stencil(p)) {
        const Node& node = grid_.node(body.field(), s.index);
        velocity += s.weight * node.velocity;
        increment += s.weight * (node.velocity - node.velocity_before);
        affine += node.velocity * s.affine.transpose();
        gradient += node.velocity * s.gradient.transpose();
      }
      body.set(body.gathered_velocity, p, velocity);
      body.set(body.gathered_increment, p, increment);
      body.set(body.gathered_affine, p, affine);
      body.set(body.velocity_gradient, p, strain_by_affine ? affine : gradient);
    }
  }

  void strain(const StepInfo& step) {
    for (Particles& body : bodies_) {
      gather_moments(body);
      ledger_.material += body.strain(step.dt);
    }
  }

  void move(const StepInfo& step) {
    for (std::size_t index = 0; index < bodies_.size(); ++index) {
      Particles& body = bodies_[index];
      for (std::size_t p = 0; p < body.count(); ++p) {
        Vector x = body.column(body.position, p) + step.dt * body.column(body.advection, p);
        keep_inside(x, static_cast<int>(index), p);
        body.set(body.position, p, x);
      }
      body.pad(body.position);
    }
  }

  /// Wraps periodic axes; throws RunFailure where a particle is not a number or beyond a wall.
  void keep_inside(Vector& x, int body, std::size_t p) const {
    const GridSpecification& grid = experiment_.grid;
    for (int c = 0; c < experiment_.dimension; ++c) {
      const double size = grid.upper[c] - grid.lower[c];
      if (!std::isfinite(x[c])) throw RunFailure("not a number: its position is no longer finite", body, p);
      if (experiment_.faces[c][0].type == ConditionType::periodic) {
        x[c] -= size * std::floor((x[c] - grid.lower[c]) / size);
        continue;
      }
      for (int side = 0; side < 2; ++side) {
        // A separating wall lets the stencil's edge through: half a cell.
        const double margin =
            experiment_.faces[c][side].type == ConditionType::separate ? 0.5 * grid.cell_size : 1e-9 * size;
        if (side == 0 ? x[c] >= grid.lower[c] - margin : x[c] <= grid.upper[c] + margin) continue;
        std::ostringstream cause;
        cause << "left the domain at "
              << "xyz"[c] << " = " << x[c] << " m";
        throw RunFailure(cause.str(), body, p);
      }
    }
  }

  const Experiment& experiment_;
  const Plan& plan_;
  Grid grid_;
  std::vector<Particles> bodies_;
  std::vector<EdgeModel> edges_;
  TimeStepLimit limit_;
  Ledger ledger_;
  ContactRecord contact_;
  FilterRecord filter_;
  double kinetic_energy_after_ = 0;
};

/// All pairs of fields, in order; conditions are imposed again and win.
void ReferenceBackend::resolve_contact(const StepInfo& step, bool after_forces, bool remap) {
  const Component& law = *experiment_.contact;
  const bool weld = law.plugin->contact().traits & MPM_BYPASSES_DETECTION;
  const int D = experiment_.dimension;
  if (after_forces) contact_ = {};
  Vector total_force = Vector::Zero(), total_change = Vector::Zero();
  for (int a = 0; a < grid_.field_count(); ++a)
    for (int b = a + 1; b < grid_.field_count(); ++b)
      for (std::size_t i = 0; i < grid_.node_count(); ++i) {
        Node& node_a = grid_.node(a, i);
        Node& node_b = grid_.node(b, i);
        if (node_a.mass <= 0 || node_b.mass <= 0) continue;
        if (!weld && std::min(node_a.mass, node_b.mass) < contact_prescreen * (node_a.mass + node_b.mass)) continue;
        const auto view = [](const Node& n) {
          ContactFieldNode f{n.mass, n.volume, {}, {}};
          for (int c = 0; c < 3; ++c)
            f.volume_gradient[c] = n.volume_gradient[c], f.mass_position[c] = n.mass_position[c];
          return f;
        };
        const ContactGeometry geometry =
            contact_geometry(view(node_a), view(node_b), edges_[a], edges_[b], experiment_.grid.cell_size, D);
        if (!geometry.valid && !weld) continue;

        // One pair, repeated over a full lane so that the plugin may compute whole lanes.
        constexpr int n = MPM_LANES;
        std::array<double, n> mass_a, mass_b, separation, area, dissipated{};
        std::array<double, 3 * n> momentum_a, momentum_b, normal, impulse{};
        std::array<std::int32_t, n> status{};
        mass_a.fill(node_a.mass), mass_b.fill(node_b.mass), separation.fill(geometry.separation),
            area.fill(geometry.area);
        for (int c = 0; c < D; ++c)
          for (int lane = 0; lane < n; ++lane) {
            momentum_a[c * n + lane] = node_a.momentum[c];
            momentum_b[c * n + lane] = node_b.momentum[c];
            normal[c * n + lane] = geometry.normal[c];
          }
        const mpm_contact_batch batch{n,
                                      n,
                                      static_cast<std::uint32_t>(D),
                                      0,
                                      step.dt,
                                      mass_a.data(),
                                      mass_b.data(),
                                      momentum_a.data(),
                                      momentum_b.data(),
                                      normal.data(),
                                      separation.data(),
                                      area.data(),
                                      impulse.data(),
                                      dissipated.data(),
                                      status.data()};
        law.plugin->contact().apply[MPM_SCALAR_DOUBLE][D - 2](law.parameters.data(), &batch);

        Vector J = Vector::Zero();
        for (int c = 0; c < D; ++c) J[c] = impulse[c * n];
        // Before the forces v- itself changes, at once; after them the impulse counts between v- and v+
        // (account_for_impulses).
        if (!after_forces && !remap)
          ledger_.contact +=
              J.dot(node_a.momentum + 0.5 * J) / node_a.mass - J.dot(node_b.momentum - 0.5 * J) / node_b.mass;
        if (!remap) ledger_.friction += dissipated[0];
        const Vector sum = node_a.momentum + node_b.momentum;
        node_a.momentum += J;
        node_b.momentum -= J;
        total_change += node_a.momentum + node_b.momentum - sum;
        if (!after_forces || status[0] == MPM_APART) continue;
        total_force += J / step.dt;
        ++contact_.nodes;
        ++(status[0] == MPM_STICKS ? contact_.sticking : contact_.slipping);
        if (geometry.valid) contact_.largest_penetration = std::max(contact_.largest_penetration, -geometry.separation);
      }
  if (after_forces) {
    for (int c = 0; c < 3; ++c) contact_.force[c] = total_force[c];
    contact_.momentum_residual = total_change.norm();
  }
  const double before = plan_.ledger ? grid_.kinetic_energy() : 0.0;
  impose_conditions(after_forces ? step.time + step.dt : step.time);
  if (plan_.ledger && !after_forces && !remap) ledger_.boundary += grid_.kinetic_energy() - before;
}

}  // namespace
}  // namespace reference

std::unique_ptr<Backend> make_reference_backend(
    const Experiment& experiment, const Plan& plan,
    std::vector<SeededBody> seeded) {  // NOLINT(performance-unnecessary-value-param): one signature for all backends
  return std::make_unique<reference::ReferenceBackend>(experiment, plan, seeded);
}

}  // namespace mpm

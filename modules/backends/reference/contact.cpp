// Applies the contact law to every pair of fields that meet at a node.

#include <algorithm>
#include <array>
#include <limits>

#include "backends/reference/reference_backend.hpp"
#include "experiment/contact_settings.hpp"

namespace mpm::reference {

ContactFieldNode ReferenceBackend::contact_view(std::size_t i) const {
  ContactFieldNode view;
  view.mass = mass_[i];
  for (int c = 0; c < 3; ++c) {
    view.volume_gradient[c] = volume_gradient_[i][c];
    if (sums_mass_positions_) view.mass_position[c] = mass_position_[i][c];
    if (sums_mass_gradients_) view.mass_gradient[c] = mass_gradient_[i][c];
    if (sums_displacements_) view.mass_displacement[c] = mass_displacement_[i][c];
  }
  return view;
}

std::optional<MetPair> ReferenceBackend::meet_pair(std::size_t a, std::size_t b) const {
  const bool weld = experiment_.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION;
  if (!meet(mass_[a], mass_[b], weld)) return {};
  const Eigen::Vector3i& at = grid_.coordinates(a % grid_.node_count());
  MetPair met{{at[0], at[1], at[2]}, contact_view(a), contact_view(b), {}};
  pair_geometry_.find(contact_points_, grid_.velocity_field_of(a), grid_.velocity_field_of(b), {&met, 1});
  if (!met.geometry.valid && !weld) return {};
  return met;
}

/// In a weld a grip holds a node where its particles are half of what both bodies have there, as it would with one field.
bool ReferenceBackend::held_in_pair(std::size_t i, std::size_t other) const {
  const bool weld = experiment_.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION;
  const std::array<bool, 3> held = grid_.gripped(i, weld ? mass_[i] + mass_[other] : mass_[i]);
  return std::all_of(held.begin(), held.begin() + experiment_.dimension, [](bool component) { return component; });
}

ReferenceBackend::SeenPair ReferenceBackend::seen_pair(std::size_t a, std::size_t b, const Vector& momentum_a,
                                                       const Vector& momentum_b) const {
  const bool holds_a = held_in_pair(a, b), holds_b = held_in_pair(b, a);
  if (holds_a == holds_b) return {mass_[a], mass_[b], momentum_a, momentum_b};
  const double free = holds_a ? mass_[b] : mass_[a];
  const Vector jump = momentum_b / mass_[b] - momentum_a / mass_[a];
  return {free, std::numeric_limits<double>::infinity(), -free * jump, Vector::Zero()};
}

/// Sums up, for each pair of fields, what a weld would give at every node where they meet.
template <class MomentumOf>
void ReferenceBackend::measure_welds(MomentumOf momentum) {
  welds_.clear();
  if (!experiment_.measures_traction()) return;
  for_each_pair([&](std::size_t a, std::size_t b) {
    const auto met = meet_pair(a, b);
    if (!met) return;
    Weld& weld = welds_[{grid_.velocity_field_of(a), grid_.velocity_field_of(b)}][met->node];
    const SeenPair seen = seen_pair(a, b, momentum(a), momentum(b));
    const Vector of_b = seen.momentum_b / seen.mass_b, of_a = seen.momentum_a / seen.mass_a;
    weld.impulse = seen.mass_a / (1 + seen.mass_a / seen.mass_b) * (of_b - of_a);
    weld.area = met->geometry.area;
  });
}

/// The traction that would hold a pair together through the step, Pa, on a.
Vector ReferenceBackend::traction_at(std::size_t a, std::size_t b, double dt) const {
  Weld sum;
  const Eigen::Vector3i& at = grid_.coordinates(a % grid_.node_count());
  for (const auto& [node, weld] : welds_.at({grid_.velocity_field_of(a), grid_.velocity_field_of(b)})) {
    const int away = std::max({std::abs(node[0] - at[0]), std::abs(node[1] - at[1]), std::abs(node[2] - at[2])});
    if (away > traction_reach) continue;
    sum.impulse += weld.impulse, sum.area += weld.area;
  }
  return sum.area > 0 ? Vector(sum.impulse / (sum.area * dt)) : Vector(Vector::Zero());
}

std::optional<ReferenceBackend::PairResult> ReferenceBackend::resolve_pair(std::size_t a, std::size_t b,
                                                                           const Vector& momentum_a,
                                                                           const Vector& momentum_b,
                                                                           const StepInfo& step) const {
  const Component& law = *experiment_.contact;
  const auto met = meet_pair(a, b);
  if (!met) return {};
  const ContactGeometry& geometry = met->geometry;
  const bool own = experiment_.contact_normal->plugin->normal().traits & MPM_OWN_NORMALS;
  Vector displacement = Vector::Zero();
  for (int c = 0; c < experiment_.dimension && sums_displacements_; ++c)
    displacement[c] = displacement_of_pair(met->a, met->b, c);
  const Vector traction = experiment_.measures_traction() ? traction_at(a, b, step.dt) : Vector(Vector::Zero());
  const SeenPair seen = seen_pair(a, b, momentum_a, momentum_b);
  const auto apply = [&](const double* normal) {
    return apply_law(law, {seen.mass_a, seen.mass_b, seen.momentum_a, seen.momentum_b, geometry, normal, step.dt,
                           displacement, traction, kept_at(a), kept_at(b), step.step == 0});
  };
  if (!own) return capped(apply(geometry.normal), seen, step.dt);
  PairResult result = apply(geometry.own_a);
  const PairResult of_b = apply(geometry.own_b);
  result.returned = of_b.impulse;
  result.dissipated = 0.5 * (result.dissipated + of_b.dissipated);
  result.stored = 0.5 * (result.stored + of_b.stored);
  result.status = std::max(result.status, of_b.status);
  result.reached = result.reached.cwiseMax(of_b.reached);
  return result;
}

/// Weakens what a law does to a pair until neither body's velocity changes by more than a cell's strain cap allows.
ReferenceBackend::PairResult ReferenceBackend::capped(PairResult result, const SeenPair& seen, double dt) const {
  const double cap = strain_cap_of(experiment_);
  if (cap == 0) return result;
  const double change = result.impulse.norm() / std::min(seen.mass_a, seen.mass_b);
  const double share = cap * experiment_.grid.cell_size / dt / change;
  if (!(share < 1)) return result;
  Vector normal = Vector::Zero();
  for (int c = 0; c < experiment_.dimension; ++c) normal[c] = result.geometry.normal[c];
  const Vector along = result.impulse - result.impulse.dot(normal) * normal;
  const Vector velocity = seen.momentum_a / seen.mass_a - seen.momentum_b / seen.mass_b;
  // The energy of sliding that an impulse J takes is -J.(u + J / 2m), with the reduced mass m.
  const auto taken = [&](const Vector& J) { return -J.dot(velocity + 0.5 * J * (1 / seen.mass_a + 1 / seen.mass_b)); };
  result.dissipated = std::max(0.0, result.dissipated + taken(share * along) - taken(along));
  result.impulse *= share, result.returned *= share;
  return result;
}

ReferenceBackend::KeptAtNode ReferenceBackend::kept_at(std::size_t i) const {
  KeptAtNode kept;
  if (contact_states_ > 0) kept.state = mass_state_[i] / mass_[i], kept.gained = mass_gain_[i] / mass_[i];
  return kept;
}

void ReferenceBackend::note_reached(std::size_t i, const Vector& reached) {
  if (contact_states_ == 0) return;
  reached_[i] = reached_[i].cwiseMax(reached);
  met_[i] = 1;
}

/// Gives particles what the nodes around them say, as the mean over those where their body met another, if it is more than
/// they have.
void ReferenceBackend::keep_contact_state() {
  for (Particles& body : bodies_) {
    Array &state = body.values("contact_state"), &gain = body.values("contact_gain");
    gain.setZero();
    for (std::size_t p = 0; p < body.count(); ++p) {
      Vector sum = Vector::Zero();
      double weight = 0;
      for (const StencilNode& s : body.stencil(p)) {
        const std::size_t i = grid_.at(body.field(), s.index);
        sum += s.weight * met_[i] * reached_[i];
        weight += s.weight * met_[i];
      }
      for (int k = 0; weight > 0 && k < contact_states_; ++k) {
        gain(k, p) = std::max(sum[k] / weight - state(k, p), 0.0);
        state(k, p) += gain(k, p);
      }
    }
  }
}

/// The pair is repeated over a full lane so that the plugin may compute whole lanes.
ReferenceBackend::PairResult ReferenceBackend::apply_law(const Component& law, const LawInput& input) const {
  const int D = experiment_.dimension;
  constexpr int n = MPM_LANES;
  std::array<double, n> mass_a, mass_b, separation, area, dissipated{}, stored{};
  std::array<double, 3 * n> p_a, p_b, normal, displacement, traction, impulse{};
  std::array<double, MPM_CONTACT_STATES * n> state_a, state_b, gained_a, gained_b, reached{};
  std::array<std::int32_t, n> status{};
  mass_a.fill(input.mass_a), mass_b.fill(input.mass_b);
  separation.fill(input.geometry.separation), area.fill(input.geometry.area);
  for (int c = 0; c < D; ++c)
    for (int lane = 0; lane < n; ++lane) {
      p_a[c * n + lane] = input.momentum_a[c];
      p_b[c * n + lane] = input.momentum_b[c];
      normal[c * n + lane] = input.normal[c];
      displacement[c * n + lane] = input.displacement[c];
      traction[c * n + lane] = input.traction[c];
    }
  const int states = static_cast<int>(law.plugin->state().size());
  for (int k = 0; k < states; ++k)
    for (int lane = 0; lane < n; ++lane) {
      state_a[k * n + lane] = input.kept_a.state[k], gained_a[k * n + lane] = input.kept_a.gained[k];
      state_b[k * n + lane] = input.kept_b.state[k], gained_b[k * n + lane] = input.kept_b.gained[k];
    }
  const bool compliant = law.plugin->contact().traits & MPM_COMPLIANT;
  const mpm_contact_batch batch{n,
                                n,
                                static_cast<std::uint32_t>(D),
                                law_stage_,
                                input.dt,
                                mass_a.data(),
                                mass_b.data(),
                                p_a.data(),
                                p_b.data(),
                                normal.data(),
                                separation.data(),
                                area.data(),
                                impulse.data(),
                                dissipated.data(),
                                status.data(),
                                compliant ? displacement.data() : nullptr,
                                compliant ? stored.data() : nullptr,
                                law.plugin->contact().traits & MPM_READS_TRACTION ? traction.data() : nullptr,
                                experiment_.grid.cell_size,
                                states > 0 ? state_a.data() : nullptr,
                                states > 0 ? state_b.data() : nullptr,
                                states > 0 ? gained_a.data() : nullptr,
                                states > 0 ? gained_b.data() : nullptr,
                                states > 0 ? reached.data() : nullptr,
                                input.first_step,
                                0};
  law.plugin->contact().apply[MPM_SCALAR_DOUBLE][D - 2](law.parameters.data(), &batch);
  PairResult result{Vector::Zero(), Vector::Zero(), dissipated[0], stored[0],
                    status[0],      input.geometry, Vector::Zero()};
  for (int c = 0; c < D; ++c) result.impulse[c] = result.returned[c] = impulse[c * n];
  for (int k = 0; k < states; ++k) result.reached[k] = reached[k * n];
  return result;
}

/// The law sees a body of infinite mass at rest, and the material as it moves beside that.
template <class VelocityOf, class Give>
void ReferenceBackend::meet_rigid_bodies(double time, double dt, VelocityOf velocity, Give give, ContactGiven& all,
                                         ContactRecord* record) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (std::size_t body = 0; body < rigid_.count(); ++body) {
    const RigidMotion motion = rigid_.motion(body, time);
    RigidGiven given;
    for (const RigidNode& node : rigid_.nodes(body))
      for (int field = 0; field < grid_.velocity_fields(); ++field) {
        const std::size_t i = grid_.at(field, grid_.index({node.at[0], node.at[1], node.at[2]}));
        if (!(mass_[i] > 0)) continue;
        const Vector3 of_body = motion.velocity_at(node.arm);
        const ContactGeometry geometry =
            rigid_contact_geometry(contact_view(i), edges_[static_cast<std::size_t>(field)].table(), node.surface,
                                   rigid_.around(node), experiment_.grid.cell_size, experiment_.dimension);
        const PairResult pair =
            apply_law(rigid_.law(body), {mass_[i], infinite, mass_[i] * (velocity(i) - to_eigen(of_body)),
                                         Vector::Zero(), geometry, geometry.normal, dt});
        give(i, pair.impulse);
        given.give(rigid_.place(node), as_array(pair.impulse), of_body);
        given.count(pair.status, pair.geometry.separation, pair.dissipated);
      }
    all.dissipated += given.dissipated, all.driven += given.driven;
    if (notes_reactions_)
      reactions_.add(GivenBySupport::held, experiment_.support_of_rigid_body(body), given.impulse, given.moment);
    if (record) given.add_to(*record);
  }
}

/// Shows the particles to all nodes where fields meet.
void ReferenceBackend::find_contact_points() {
  contact_points_.begin();
  for_each_pair([&](std::size_t a, std::size_t b) {
    const Eigen::Vector3i& at = grid_.coordinates(a);
    if (mass_[a] > 0 && mass_[b] > 0) contact_points_.open({at[0], at[1], at[2]});
  });
  const int D = experiment_.dimension;
  for (Particles& body : bodies_) {
    const char* const sides = plan_.particle_field(body.number(), "domain")        ? "domain"
                              : plan_.particle_field(body.number(), "deformation") ? "deformation"
                                                                                   : nullptr;
    for (std::size_t p = 0; p < body.count(); ++p) {
      Vector3 x = as_array(body.column(body.position, p));
      for (int axis = 0; axis < D; ++axis)
        x[axis] = (x[axis] - experiment_.grid.lower[axis]) / experiment_.grid.cell_size;
      const Matrix matrix = sides ? body.matrix(body.values(sides), p) : Matrix(Matrix::Zero());
      std::array<double, 9> values{};
      for (int i = 0; i < D; ++i)
        for (int k = 0; k < D; ++k) values[D * i + k] = matrix(i, k);
      const bool domain = sides && sides == std::string_view("domain");
      if (!contact_points_.look_around(x, x)) continue;
      contact_points_.add(body.field(), x, sides ? values.data() : nullptr, 1,
                          domain ? 1.0 : contact_points_.half_side(body.volume_of_section(p)));
    }
  }
  contact_points_.find(0, contact_points_.node_count());
}

void ReferenceBackend::resolve_contact(const StepInfo& step, bool after_forces, bool remap) {
  if (contact_points_.needed() && !after_forces && !remap) find_contact_points();
  if (after_forces) contact_ = {};
  law_stage_ = after_forces ? MPM_AFTER_FORCES : MPM_BEFORE_FORCES;
  const double time = after_forces ? step.time + step.dt : step.time;
  ContactGiven given = nothing_given();
  const Vector total_change = resolve_pairs(step, after_forces, given);
  meet_rigid_bodies(
      time, step.dt, [&](std::size_t i) { return Vector(momentum_[i] / mass_[i]); },
      [&](std::size_t i, const Vector& impulse) {
        record(contact_impulse_, standing_contact_impulse_, i, impulse);
        momentum_[i] += impulse;
      },
      given, after_forces ? &contact_ : nullptr);
  if (after_forces) {
    impulse_.after_forces(given, ledger_to_book());
    impulse_.record_counts(given);
    record_force(step);
    contact_.momentum_residual = total_change.norm();
  } else if (!remap) {
    impulse_.before_forces(given, step.filtered, ledger_to_book());
  }
  impose_conditions(time);
}

/// Applies the law to all pairs of fields; returns the change of their momenta, zero to rounding.
Vector ReferenceBackend::resolve_pairs(const StepInfo& step, bool after_forces, ContactGiven& given) {
  Vector total_change = Vector::Zero();
  const bool notes_nodes = records_nodes(experiment_, step);
  measure_welds([&](std::size_t i) { return Vector(momentum_[i]); });
  for_each_pair([&](std::size_t a, std::size_t b) {
    const auto pair = resolve_pair(a, b, momentum_[a], momentum_[b], step);
    if (!pair) return;
    if (after_forces) note_reached(a, pair->reached), note_reached(b, pair->reached);
    const Vector &J = pair->impulse, &returned = pair->returned;
    record(contact_impulse_, standing_contact_impulse_, a, J);
    record(contact_impulse_, standing_contact_impulse_, b, -returned);
    const Vector sum = momentum_[a] + momentum_[b];
    momentum_[a] += J;
    momentum_[b] -= returned;
    total_change += momentum_[a] + momentum_[b] - sum;
    count(*pair, a, b, notes_nodes, given);
    if (!after_forces || pair->status == MPM_APART) return;
    ++contact_.nodes;
    ++(pair->status == MPM_STICKS ? contact_.sticking : contact_.slipping);
    const ContactGeometry& geometry = pair->geometry;
    if (geometry.valid) contact_.largest_penetration = std::max(contact_.largest_penetration, -geometry.separation);
  });
  return total_change;
}

/// The same in a filter's loop, where velocities are at hand and nothing is recorded but what is given.
ContactGiven ReferenceBackend::resolve_contact_of_velocity(double time, const StepInfo& step) {
  ContactGiven given = nothing_given();
  const bool notes_nodes = records_nodes(experiment_, step);
  measure_welds([&](std::size_t i) { return Vector(mass_[i] * velocity_[i]); });
  for_each_pair([&](std::size_t a, std::size_t b) {
    const auto pair = resolve_pair(a, b, mass_[a] * velocity_[a], mass_[b] * velocity_[b], step);
    if (!pair) return;
    velocity_[a] += pair->impulse / mass_[a];
    velocity_[b] -= pair->returned / mass_[b];
    record(contact_impulse_, standing_contact_impulse_, a, pair->impulse);
    record(contact_impulse_, standing_contact_impulse_, b, -pair->returned);
    count(*pair, a, b, notes_nodes, given);
  });
  meet_rigid_bodies(
      time, step.dt, [&](std::size_t i) { return velocity_[i]; },
      [&](std::size_t i, const Vector& impulse) {
        record(contact_impulse_, standing_contact_impulse_, i, impulse);
        velocity_[i] += impulse / mass_[i];
      },
      given, nullptr);
  return given;
}

void ReferenceBackend::record_force(const StepInfo& step) {
  const Vector3 impulse = impulse_.handed_over(step.filtered);
  for (std::size_t c = 0; c < 3; ++c) contact_.force[c] = impulse[c] / step.dt;
  impulse_.record_forces(step.filtered, step.dt);
}

ContactGiven ReferenceBackend::nothing_given() const {
  ContactGiven given;
  given.pairs.resize(impulse_.pairs().size());
  return given;
}

void ReferenceBackend::count(const PairResult& result, std::size_t a, std::size_t b, bool notes_node,
                             ContactGiven& given) const {
  for (int c = 0; c < 3; ++c) given.impulse[static_cast<std::size_t>(c)] += result.impulse[c];
  given.dissipated += result.dissipated, given.stored += result.stored;
  const ContactGeometry& geometry = result.geometry;
  const bool own = experiment_.contact_normal->plugin->normal().traits & MPM_OWN_NORMALS;
  const Vector normal = geometry.valid ? Vector(Eigen::Map<const Vector>(own ? geometry.own_a : geometry.normal))
                                       : Vector(Vector::Zero());
  if (notes_node) {
    const Eigen::Vector3i& at = grid_.coordinates(a % grid_.node_count());
    given.nodes.push_back({{{at[0], at[1], at[2]},
                            grid_.velocity_field_of(a),
                            grid_.velocity_field_of(b),
                            as_array(normal),
                            geometry.separation,
                            geometry.area,
                            result.status,
                            {}},
                           as_array(result.impulse)});
  }
  if (given.pairs.empty()) return;
  PairGiven& pair =
      given.pairs[pair_index(grid_.velocity_field_of(a), grid_.velocity_field_of(b), grid_.velocity_fields())];
  for (int c = 0; c < 3; ++c) {
    pair.impulse[static_cast<std::size_t>(c)] += result.impulse[c];
    pair.unbalanced[static_cast<std::size_t>(c)] += result.impulse[c] - result.returned[c];
  }
  const double pull = result.impulse.dot(normal);
  for (int c = 0; c < 3; ++c) pair.along[static_cast<std::size_t>(c)] += pull * normal[c];
  pair.pressing -= pull;
  pair.count(result.status, geometry.separation, geometry.area, geometry.valid);
}

}  // namespace mpm::reference

// Velocity filters. With S+ the gather (grid to particles to grid: S+ S, mass-weighted) a filter applies a truncated
// series in I - S+ S to the grid's velocity (Hammerquist & Nairn 2017, CMAME 318:724, XPIC; Nairn & Hammerquist 2021,
// CPM 8:1205, FMPM). The loop is incremental: v* <- what is left, v <- v + what the plugin takes of it, and conditions
// and contact correct v, whose net change becomes v*. One-sided laws (contact, separating walls) are given the sum of
// all increments before they acted, so an impulse that a later increment no longer needs is taken back (Nairn 2026,
// arXiv 2604.07307).

#include <algorithm>
#include <cmath>

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {
namespace {

/// Time of the wall's velocity: that of v- before the forces, of v+ after them.
double time_of(const Pass& pass, const StepInfo& step) {
  return pass.stage == Stage::after_forces ? step.time + step.dt : step.time;
}

}  // namespace

void ReferenceBackend::begin_filter(const Pass& pass) {
  for_each_node([&](Node& node) {
    node.increment = node.velocity;
    if (pass.stage == Stage::before_forces)
      node.kept_velocity = node.velocity, node.kept_constrained = node.constrained;
  });
  filter_.iterations = 0;
  filter_.first_norm = filter_.last_norm = grid_.mass_norm(&Node::increment);
  kinetic_energy_unfiltered_ = accounted_ ? grid_.kinetic_energy() : 0.0;
}

/// projected <- S+ S v*, by the transfer's own gather and scatter of particles that were at rest.
void ReferenceBackend::project(const Pass& pass, const StepInfo& step) {
  for_each_node([](Node& node) { node.projected = Vector::Zero(); });
  for (Particles& body : bodies_) {
    gather_moments(body, &Node::increment);
    body.project_coefficients(step.dt);
    scatter_projection(body);
  }
  // The first increment is a velocity, which a moving wall mirrors about its own; later ones are differences.
  const bool difference = filter_.iterations > 0;
  grid_.fold_projection(difference ? std::nullopt : std::optional(time_of(pass, step)));
}

/// Node by node w (b + A d).
void ReferenceBackend::scatter_projection(Particles& body) {
  const bool affine = experiment_.transfer.plugin->transfer().traits & MPM_SCATTERS_AFFINE;
  for (std::size_t p = 0; p < body.count(); ++p) {
    const Vector b = body.column(body.b, p);
    const Matrix A = affine ? body.matrix(body.A, p) : Matrix(Matrix::Zero());
    for (const StencilNode& s : body.stencil(p))
      grid_.node(body.field(), s.index).projected += s.weight * (b + A * s.distance);
    add_higher(body, p, &Node::projected);
  }
}

void ReferenceBackend::update_filter(const Pass& pass, const StepInfo& step) {
  for (int field = 0; field < grid_.field_count(); ++field) call_filter(field);
  if (experiment_.filter_schedule.constrain_always) {
    std::vector<Vector> tried;
    for_each_node([&](Node& node) { tried.push_back(node.velocity); });
    constrain_free_velocity(pass, step);
    // What conditions and contact changed is a part of this pass's change of v.
    auto try_of = tried.begin();
    for_each_node([&](Node& node) { node.increment += node.velocity - *try_of++; });
  }
  filter_.take_norm(grid_.mass_norm(&Node::increment));
  grid_.fill_increment_ghosts();
}

/// The plugin's update at all nodes of a field that hold mass.
void ReferenceBackend::call_filter(int field) {
  std::vector<std::size_t> nodes;
  for (std::size_t i = 0; i < grid_.node_count(); ++i)
    if (grid_.node(field, i).mass > 0) nodes.push_back(i);
  if (nodes.empty()) return;
  const int D = experiment_.dimension;
  const std::size_t n = (nodes.size() + MPM_LANES - 1) / MPM_LANES * MPM_LANES;
  Array projected = Array::Zero(D, static_cast<Eigen::Index>(n)), increment = projected, velocity = projected;
  for (std::size_t k = 0; k < n; ++k) {
    const Node& node = grid_.node(field, nodes[std::min(k, nodes.size() - 1)]);  // the last one pads
    for (int c = 0; c < D; ++c)
      projected(c, k) = node.projected[c], increment(c, k) = node.increment[c], velocity(c, k) = node.velocity[c];
  }
  const mpm_filter_batch batch{static_cast<std::uint32_t>(n),
                               static_cast<std::uint32_t>(n),
                               static_cast<std::uint32_t>(D),
                               static_cast<std::uint32_t>(filter_.iterations + 1),
                               projected.data(),
                               increment.data(),
                               velocity.data()};
  const Component& filter = *experiment_.filter;
  filter.plugin->filter().update[MPM_SCALAR_DOUBLE][D - 2](filter.parameters.data(), &batch);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (int c = 0; c < D; ++c) {
      grid_.node(field, nodes[k]).increment[c] = increment(c, k);
      grid_.node(field, nodes[k]).velocity[c] = velocity(c, k);
    }
}

void ReferenceBackend::end_filter(const Pass& pass, const StepInfo& step) {
  if (!experiment_.filter_schedule.constrain_always) constrain_free_velocity(pass, step);
  grid_.fill_ghosts(time_of(pass, step));
  if (pass.stage == Stage::before_forces) return;  // the momentum stays that of the velocity kept aside
  for_each_node([](Node& node) { node.momentum = node.mass * node.velocity; });
  if (pass.remap()) return;
  const double filtered = accounted_ ? grid_.kinetic_energy() : 0.0;
  ledger_.filter += filtered - kinetic_energy_unfiltered_;
  kinetic_energy_after_ = filtered;
}

void ReferenceBackend::restore_velocity(const Pass& pass) {
  for_each_node([&](Node& node) {
    std::swap(node.velocity, node.kept_velocity);
    std::swap(node.constrained, node.kept_constrained);
    if (!pass.has(Act::keep_correction)) return;
    node.kept_velocity -= node.velocity;
    node.kept_constrained -= node.constrained;
  });
}

/// v+ <- v+ + (filtered v- minus v-), under the conditions and contact of v+.
void ReferenceBackend::add_correction(const Pass& pass, const StepInfo& step) {
  const double unfiltered = accounted_ ? grid_.kinetic_energy() : 0.0;
  for_each_node([](Node& node) {
    node.velocity += node.kept_velocity;
    node.constrained += node.kept_constrained;
  });
  constrain_free_velocity(pass, step);
  grid_.fill_ghosts(time_of(pass, step));
  for_each_node([](Node& node) { node.momentum = node.mass * node.velocity; });
  if (!accounted_) return;
  kinetic_energy_after_ = grid_.kinetic_energy();
  ledger_.filter += kinetic_energy_after_ - unfiltered;
}

/// Conditions and contact on the velocity without what they have added so far.
void ReferenceBackend::constrain_free_velocity(const Pass& pass, const StepInfo& step) {
  if (!plan_.constrained_velocity) return constrain_velocity(pass, step);
  for_each_node([](Node& node) {
    if (node.mass > 0) node.constrained = node.velocity -= node.constrained;  // free, until they have acted
  });
  constrain_velocity(pass, step);
  for_each_node([](Node& node) {
    if (node.mass > 0) node.constrained = node.velocity - node.constrained;
  });
}

/// Conditions, contact and conditions again, as after the forces, but on velocities and on no one's record.
void ReferenceBackend::constrain_velocity(const Pass& pass, const StepInfo& step) {
  const double time = time_of(pass, step);
  impose_on_velocity(time);
  if (!plan_.contact) return;
  resolve_contact_of_velocity(step.dt);
  impose_on_velocity(time);
}

void ReferenceBackend::impose_on_velocity(double time) {
  for (int field = 0; field < grid_.field_count(); ++field)
    for (std::size_t i = 0; i < grid_.node_count(); ++i) {
      Node& node = grid_.node(field, i);
      if (node.mass <= 0) continue;
      const Held held = grid_.held(i, node.velocity, time);
      for (int c = 0; c < 3; ++c)
        if (held.component[c]) node.velocity[c] = held.velocity[c];
    }
}

void ReferenceBackend::resolve_contact_of_velocity(double dt) {
  for (int a = 0; a < grid_.field_count(); ++a)
    for (int b = a + 1; b < grid_.field_count(); ++b)
      for (std::size_t i = 0; i < grid_.node_count(); ++i) {
        Node &node_a = grid_.node(a, i), &node_b = grid_.node(b, i);
        const auto pair = resolve_pair(a, b, i, node_a.mass * node_a.velocity, node_b.mass * node_b.velocity, dt);
        if (!pair) continue;
        node_a.velocity += pair->impulse / node_a.mass;
        node_b.velocity -= pair->impulse / node_b.mass;
      }
}

}  // namespace mpm::reference

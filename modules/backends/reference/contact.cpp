// Contact: the law on every pair of fields that meet at a node.

#include <algorithm>
#include <array>

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {
namespace {

ContactFieldNode contact_view(const Node& node) {
  ContactFieldNode view{node.mass, node.volume, {}, {}};
  for (int c = 0; c < 3; ++c)
    view.volume_gradient[c] = node.volume_gradient[c], view.mass_position[c] = node.mass_position[c];
  return view;
}

}  // namespace

std::optional<ReferenceBackend::PairResult> ReferenceBackend::resolve_pair(int a, int b, std::size_t node,
                                                                           const Vector& momentum_a,
                                                                           const Vector& momentum_b, double dt) const {
  const Component& law = *experiment_.contact;
  const bool weld = law.plugin->contact().traits & MPM_BYPASSES_DETECTION;
  const int D = experiment_.dimension;
  const Node &node_a = grid_.node(a, node), &node_b = grid_.node(b, node);
  if (node_a.mass <= 0 || node_b.mass <= 0) return {};
  if (!weld && std::min(node_a.mass, node_b.mass) < contact_prescreen * (node_a.mass + node_b.mass)) return {};
  const ContactGeometry geometry =
      contact_geometry(contact_view(node_a), contact_view(node_b), edges_[a], edges_[b], experiment_.grid.cell_size, D);
  if (!geometry.valid && !weld) return {};

  // One pair, repeated over a full lane so that the plugin may compute whole lanes.
  constexpr int n = MPM_LANES;
  std::array<double, n> mass_a, mass_b, separation, area, dissipated{};
  std::array<double, 3 * n> p_a, p_b, normal, impulse{};
  std::array<std::int32_t, n> status{};
  mass_a.fill(node_a.mass), mass_b.fill(node_b.mass), separation.fill(geometry.separation), area.fill(geometry.area);
  for (int c = 0; c < D; ++c)
    for (int lane = 0; lane < n; ++lane) {
      p_a[c * n + lane] = momentum_a[c];
      p_b[c * n + lane] = momentum_b[c];
      normal[c * n + lane] = geometry.normal[c];
    }
  const mpm_contact_batch batch{n,
                                n,
                                static_cast<std::uint32_t>(D),
                                0,
                                dt,
                                mass_a.data(),
                                mass_b.data(),
                                p_a.data(),
                                p_b.data(),
                                normal.data(),
                                separation.data(),
                                area.data(),
                                impulse.data(),
                                dissipated.data(),
                                status.data()};
  law.plugin->contact().apply[MPM_SCALAR_DOUBLE][D - 2](law.parameters.data(), &batch);
  PairResult result{Vector::Zero(), dissipated[0], status[0], geometry.separation, geometry.valid};
  for (int c = 0; c < D; ++c) result.impulse[c] = impulse[c * n];
  return result;
}

void ReferenceBackend::resolve_contact(const StepInfo& step, bool after_forces, bool remap) {
  if (after_forces) contact_ = {};
  Vector total_force = Vector::Zero(), total_change = Vector::Zero();
  for (int a = 0; a < grid_.field_count(); ++a)
    for (int b = a + 1; b < grid_.field_count(); ++b)
      for (std::size_t i = 0; i < grid_.node_count(); ++i) {
        Node &node_a = grid_.node(a, i), &node_b = grid_.node(b, i);
        const auto pair = resolve_pair(a, b, i, node_a.momentum, node_b.momentum, step.dt);
        if (!pair) continue;
        const Vector& J = pair->impulse;
        // Before the forces v- itself changes, at once; after them the impulse counts between v- and v+
        // (account_for_impulses).
        if (accounted_ && !after_forces && !remap)
          ledger_.contact +=
              J.dot(node_a.momentum + 0.5 * J) / node_a.mass - J.dot(node_b.momentum - 0.5 * J) / node_b.mass;
        if (accounted_ && !remap) ledger_.friction += pair->dissipated;
        const Vector sum = node_a.momentum + node_b.momentum;
        node_a.momentum += J;
        node_b.momentum -= J;
        total_change += node_a.momentum + node_b.momentum - sum;
        if (!after_forces || pair->status == MPM_APART) continue;
        total_force += J / step.dt;
        ++contact_.nodes;
        ++(pair->status == MPM_STICKS ? contact_.sticking : contact_.slipping);
        if (pair->has_normal) contact_.largest_penetration = std::max(contact_.largest_penetration, -pair->separation);
      }
  if (after_forces) {
    for (int c = 0; c < 3; ++c) contact_.force[c] = total_force[c];
    contact_.momentum_residual = total_change.norm();
  }
  const double before = accounted_ ? grid_.kinetic_energy() : 0.0;
  impose_conditions(after_forces ? step.time + step.dt : step.time);
  if (accounted_ && !after_forces && !remap) ledger_.boundary += grid_.kinetic_energy() - before;
}

}  // namespace mpm::reference

// Applies the contact law to every pair of fields that meet at a node.

#include <algorithm>
#include <array>

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {

ContactFieldNode ReferenceBackend::contact_view(std::size_t i) const {
  ContactFieldNode view{mass_[i], {}, {}};
  for (int c = 0; c < 3; ++c)
    view.volume_gradient[c] = volume_gradient_[i][c], view.mass_position[c] = mass_position_[i][c];
  return view;
}

std::optional<ReferenceBackend::PairResult> ReferenceBackend::resolve_pair(std::size_t a, std::size_t b,
                                                                           const Vector& momentum_a,
                                                                           const Vector& momentum_b, double dt) const {
  const Component& law = *experiment_.contact;
  const bool weld = law.plugin->contact().traits & MPM_BYPASSES_DETECTION;
  const int D = experiment_.dimension;
  if (!meet(mass_[a], mass_[b], weld)) return {};
  const std::size_t node = a % grid_.node_count();
  const Eigen::Vector3i& at = grid_.coordinates(node);
  const ContactGeometry geometry = pair_geometry_(contact_points_, {at[0], at[1], at[2]}, grid_.velocity_field_of(a),
                                                  grid_.velocity_field_of(b), contact_view(a), contact_view(b));
  if (!geometry.valid && !weld) return {};

  // The pair is repeated over a full lane so that the plugin may compute whole lanes.
  constexpr int n = MPM_LANES;
  std::array<double, n> mass_a, mass_b, separation, area, dissipated{};
  std::array<double, 3 * n> p_a, p_b, normal, impulse{};
  std::array<std::int32_t, n> status{};
  mass_a.fill(mass_[a]), mass_b.fill(mass_[b]), separation.fill(geometry.separation), area.fill(geometry.area);
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
  PairResult result{Vector::Zero(), dissipated[0], status[0], geometry};
  for (int c = 0; c < D; ++c) result.impulse[c] = impulse[c * n];
  return result;
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
  Vector total_change = Vector::Zero();
  ContactGiven given = nothing_given();
  const bool notes_nodes = records_nodes(experiment_, step);
  for_each_pair([&](std::size_t a, std::size_t b) {
    const auto pair = resolve_pair(a, b, momentum_[a], momentum_[b], step.dt);
    if (!pair) return;
    const Vector& J = pair->impulse;
    record(contact_impulse_, standing_contact_impulse_, a, J);
    record(contact_impulse_, standing_contact_impulse_, b, -J);
    const Vector sum = momentum_[a] + momentum_[b];
    momentum_[a] += J;
    momentum_[b] -= J;
    total_change += momentum_[a] + momentum_[b] - sum;
    count(*pair, a, b, notes_nodes, given);
    if (!after_forces || pair->status == MPM_APART) return;
    ++contact_.nodes;
    ++(pair->status == MPM_STICKS ? contact_.sticking : contact_.slipping);
    const ContactGeometry& geometry = pair->geometry;
    if (geometry.valid) contact_.largest_penetration = std::max(contact_.largest_penetration, -geometry.separation);
  });
  if (after_forces) {
    impulse_.after_forces(given, ledger_to_book());
    impulse_.record_counts(given);
    record_force(step);
    contact_.momentum_residual = total_change.norm();
  } else if (!remap) {
    impulse_.before_forces(given, step.filtered, ledger_to_book());
  }
  impose_conditions(after_forces ? step.time + step.dt : step.time);
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
  given.dissipated += result.dissipated;
  if (notes_node) {
    const ContactGeometry& geometry = result.geometry;
    const Eigen::Vector3i& at = grid_.coordinates(a % grid_.node_count());
    const Eigen::Map<const Vector> normal(geometry.normal);
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
  for (int c = 0; c < 3; ++c) pair.impulse[static_cast<std::size_t>(c)] += result.impulse[c];
  if (result.geometry.valid) {
    const Vector normal = Eigen::Map<const Vector>(result.geometry.normal);
    const double pull = result.impulse.dot(normal);
    for (int c = 0; c < 3; ++c) pair.along[static_cast<std::size_t>(c)] += pull * normal[c];
    pair.pressing -= pull;
  }
  pair.count(result.status, result.geometry.separation, result.geometry.area, result.geometry.valid);
}

}  // namespace mpm::reference

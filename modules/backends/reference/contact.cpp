// Applies the contact law to every pair of fields that meet at a node.

#include <algorithm>
#include <array>

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {

ContactFieldNode ReferenceBackend::contact_view(std::size_t i) const {
  ContactFieldNode view;
  view.mass = mass_[i], view.volume = volume_[i];
  for (int c = 0; c < 3; ++c) {
    if (sums_volume_gradients_) view.volume_gradient[c] = volume_gradient_[i][c];
    if (sums_mass_gradients_) view.mass_gradient[c] = mass_gradient_[i][c];
    view.mass_position[c] = mass_position_[i][c];
  }
  return view;
}

std::optional<ReferenceBackend::PairResult> ReferenceBackend::resolve_pair(std::size_t a, std::size_t b,
                                                                           const Vector& momentum_a,
                                                                           const Vector& momentum_b, double dt) const {
  const bool weld = experiment_.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION;
  if (!meet(mass_[a], mass_[b], weld)) return {};
  const Eigen::Vector3i& at = grid_.coordinates(a % grid_.node_count());
  MetPair met{{at[0], at[1], at[2]}, contact_view(a), contact_view(b), {}};
  pair_geometry_.find(contact_points_, grid_.velocity_field_of(a), grid_.velocity_field_of(b), {&met, 1});
  const ContactGeometry& geometry = met.geometry;
  if (!geometry.valid && !weld) return {};
  const bool own = experiment_.contact_normal->plugin->normal().traits & MPM_OWN_NORMALS;
  const auto apply = [&](const double* normal) {
    return apply_law(a, b, momentum_a, momentum_b, geometry, normal, dt);
  };
  if (!own) return apply(geometry.normal);
  PairResult result = apply(geometry.own_a);
  const PairResult of_b = apply(geometry.own_b);
  result.returned = of_b.impulse;
  result.dissipated = 0.5 * (result.dissipated + of_b.dissipated);
  result.status = std::max(result.status, of_b.status);
  return result;
}

ReferenceBackend::PairResult ReferenceBackend::apply_law(std::size_t a, std::size_t b, const Vector& momentum_a,
                                                         const Vector& momentum_b, const ContactGeometry& geometry,
                                                         const double* normal_of_pair, double dt) const {
  const Component& law = *experiment_.contact;
  const int D = experiment_.dimension;
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
      normal[c * n + lane] = normal_of_pair[c];
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
  PairResult result{Vector::Zero(), Vector::Zero(), dissipated[0], status[0], geometry.separation, geometry.valid};
  for (int c = 0; c < D; ++c) result.impulse[c] = result.returned[c] = impulse[c * n];
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
  Vector total_impulse = Vector::Zero(), total_change = Vector::Zero();
  double dissipated = 0;
  std::vector<PairGiven> pairs(impulse_.pairs().size());
  for_each_pair([&](std::size_t a, std::size_t b) {
    const auto pair = resolve_pair(a, b, momentum_[a], momentum_[b], step.dt);
    if (!pair) return;
    const Vector &J = pair->impulse, &returned = pair->returned;
    record(contact_impulse_, standing_contact_impulse_, a, J);
    record(contact_impulse_, standing_contact_impulse_, b, -returned);
    dissipated += pair->dissipated;
    const Vector sum = momentum_[a] + momentum_[b];
    momentum_[a] += J;
    momentum_[b] -= returned;
    total_change += momentum_[a] + momentum_[b] - sum;
    total_impulse += J;
    count(*pair, a, b, pairs);
    if (!after_forces || pair->status == MPM_APART) return;
    ++contact_.nodes;
    ++(pair->status == MPM_STICKS ? contact_.sticking : contact_.slipping);
    if (pair->has_normal) contact_.largest_penetration = std::max(contact_.largest_penetration, -pair->separation);
  });
  if (after_forces) {
    const ContactGiven given{as_array(total_impulse), dissipated, std::move(pairs)};
    impulse_.after_forces(given, ledger_to_book());
    impulse_.record_counts(given);
    record_force(step);
    contact_.momentum_residual = total_change.norm();
  } else if (!remap) {
    impulse_.before_forces({as_array(total_impulse), dissipated, std::move(pairs)}, step.filtered, ledger_to_book());
  }
  impose_conditions(after_forces ? step.time + step.dt : step.time);
}

void ReferenceBackend::record_force(const StepInfo& step) {
  const Vector3 impulse = impulse_.handed_over(step.filtered);
  for (std::size_t c = 0; c < 3; ++c) contact_.force[c] = impulse[c] / step.dt;
  impulse_.record_forces(step.filtered, step.dt);
}

void ReferenceBackend::count(const PairResult& result, std::size_t a, std::size_t b,
                             std::vector<PairGiven>& pairs) const {
  if (pairs.empty()) return;
  PairGiven& pair = pairs[pair_index(grid_.velocity_field_of(a), grid_.velocity_field_of(b), grid_.velocity_fields())];
  for (int c = 0; c < 3; ++c) pair.impulse[static_cast<std::size_t>(c)] += result.impulse[c];
  pair.count(result.status, result.separation, result.has_normal);
}

}  // namespace mpm::reference

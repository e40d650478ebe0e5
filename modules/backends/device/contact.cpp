#include "backends/device/device_backend.hpp"

#include <cmath>

namespace mpm::device {

/// Shows the particles to all nodes where fields meet. The host does so, on copies.
template <class T>
void DeviceBackend<T>::find_contact_points(const std::vector<ContactFields<T>>& found) {
  ContactPoints& points = pairs_.points();
  points.begin();
  for (std::size_t node = 0; node < static_cast<std::size_t>(nodes()); ++node) {
    int present = 0;
    for (const ContactFields<T>& field : found) present += field.mass[node] > 0;
    if (present > 1) points.open(pairs_.coordinates(node, scene_));
  }
  const bool by_domain = plan_.particle_field(0, "domain") != nullptr;
  const bool by_deformation = plan_.particle_field(0, "deformation") != nullptr && points.gives_separation();
  for (const Body<T>& body : bodies_) {
    const std::vector<T> position = body.arrays.read("position"), size = body.arrays.read("size"),
                         sides = by_domain        ? body.arrays.read("domain")
                                 : by_deformation ? body.arrays.read("deformation")
                                                  : std::vector<T>();
    const auto n = static_cast<std::size_t>(body.count);
    for (std::size_t p = 0; p < n; ++p) {
      Vector3 x = body.vector(position, p);
      for (int c = 0; c < experiment_.dimension; ++c)
        x[c] = (x[c] - experiment_.grid.lower[c]) / experiment_.grid.cell_size;
      if (!points.look_around(x, x)) continue;
      const double volume = double(body.volume) * (size.empty() || experiment_.axisymmetric() ? 1.0 : double(size[p]));
      points.add(body.field, x, sides.empty() ? nullptr : sides.data() + p, n,
                 by_domain ? 1.0 : points.half_side(volume));
    }
  }
  points.find(0, points.node_count());
}

template <class T>
void DeviceBackend<T>::resolve_contact(const StepInfo& step, Recorded recorded) {
  if (recorded == Recorded::after_forces) contact_ = {};
  Vector3 unbalanced{};
  ContactGiven given;
  given.pairs.reserve(contact_impulse_.pairs().size());
  const std::vector<ContactFields<T>> found(fields_.begin(), fields_.end());
  if (pairs_.points().needed() && recorded == Recorded::before_forces) find_contact_points(found);
  for (std::size_t a = 0; a < fields_.size(); ++a)
    for (std::size_t b = a + 1; b < fields_.size(); ++b) {
      pairs_.find(found[a], a, found[b], b, scene_);
      Arguments<T> arguments = scene_;
      arguments.grid = fields_[a].table(), arguments.other = fields_[b].table();
      arguments.contact = pairs_.table();
      launch("contact", arguments, nodes());
      pairs_.read();
      if (recorded == Recorded::after_forces) pairs_.add_to(contact_, unbalanced);
      pairs_.add_to(given, !contact_impulse_.pairs().empty());
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

template <class T>
void DeviceBackend<T>::record_force(const StepInfo& step) {
  const Vector3 impulse = contact_impulse_.handed_over(step.filtered);
  for (std::size_t c = 0; c < 3; ++c) contact_.force[c] = impulse[c] / step.dt;
  contact_impulse_.record_forces(step.filtered, step.dt);
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device

#include "backends/device/device_backend.hpp"

#include <algorithm>

namespace mpm::device {

template <class T>
Arguments<T> DeviceBackend<T>::arguments_of(const VelocityField<T>& field, const Manner& manner) const {
  Arguments<T> a = scene_;
  point_to(a, field);
  a.iteration = static_cast<int>(filter_.iterations + 1);
  a.remap = manner.remap, a.after_forces = manner.after_forces, a.walls_at_rest = manner.walls_at_rest;
  return a;
}

template <class T>
Arguments<T> DeviceBackend<T>::arguments_of(const Body<T>& body) const {
  Arguments<T> a = scene_;
  a.particles = body.table();
  point_to(a, fields_[static_cast<std::size_t>(body.field)]);
  a.material_parameters = body.parameters.data(), a.melted_parameters = body.of_melted();
  a.blocks = body.blocks.table();
  return a;
}

template <class T>
void DeviceBackend<T>::point_to(Arguments<T>& a, const VelocityField<T>& field) const {
  a.grid = field.table();
  a.grips = field.grips.data(), a.grip_count = static_cast<int>(field.grips.count());
}

template <class T>
void DeviceBackend<T>::launch(const std::string& phase, const Arguments<T>& a, int indices) {
  launch_teams(phase, a, (indices + lanes_ - 1) / lanes_);
}

template <class T>
void DeviceBackend<T>::launch_teams(const std::string& phase, const Arguments<T>& a, int teams) {
  device_->launch(phase, a, teams, lanes_);
}

template <class T>
void DeviceBackend<T>::for_each_field(const std::string& phase, int indices, const Manner& manner) {
  for (const VelocityField<T>& field : fields_) launch(phase, arguments_of(field, manner), indices);
}

template <class T>
void DeviceBackend<T>::for_each_axis(const std::string& phase, const std::vector<int>& axes, const Manner& manner) {
  for (const int axis : axes)
    for (const VelocityField<T>& field : fields_) {
      Arguments<T> a = arguments_of(field, manner);
      a.axis = axis;
      launch(phase, a, lines_along(axis));
    }
}

template <class T>
std::vector<int> DeviceBackend<T>::folded_axes() const {
  std::vector<int> axes = images_;
  axes.insert(axes.end(), walls_.begin(), walls_.end());
  return axes;
}

template <class T>
std::vector<int> DeviceBackend<T>::filled_axes() const {
  std::vector<int> axes = folded_axes();
  std::reverse(axes.begin(), axes.end());
  return axes;
}

template <class T>
std::vector<double> DeviceBackend<T>::sums(const std::string& phase, Arguments<T> a, int indices, std::size_t count) {
  const int teams = (indices + lanes_ - 1) / lanes_;
  partial_sums_.resize(count * static_cast<std::size_t>(teams));
  a.partial_sums = partial_sums_.data();
  launch_teams(phase, a, teams);
  const std::vector<double> partial = partial_sums_.download();
  std::vector<double> sums(count);
  for (std::size_t k = 0; k < partial.size(); ++k) sums[k % count] += partial[k];
  return sums;
}

template <class T>
double DeviceBackend<T>::sum_over_nodes(const std::string& phase) {
  double total = 0;
  for (const VelocityField<T>& field : fields_) total += sum(phase, arguments_of(field, {}), nodes())[0];
  return total;
}

template <class T>
double DeviceBackend<T>::sum_over_particles(const std::string& phase, const Body<T>& body) {
  return sum(phase, arguments_of(body), body.count)[0];
}

template <class T>
void DeviceBackend<T>::run(const std::string& phase, const Arguments<T>& a, const Body<T>& body, Checks checks) {
  launch(phase, a, body.count);
  stop_where_failed(body, checks);
}

template <class T>
void DeviceBackend<T>::run_blocks(const std::string& phase, const Arguments<T>& a, const Body<T>& body) {
  launch_blocks(phase, a, body);
  stop_where_failed(body, Checks::stencil);
}

template <class T>
void DeviceBackend<T>::launch_blocks(const std::string& phase, Arguments<T> a, const Body<T>& body) {
  a.teams = std::min(teams_, body.blocks.most(body.arrays.count()));
  launch_teams(phase, a, a.teams);
}

template <class T>
void DeviceBackend<T>::stop_where_failed(const Body<T>& body, Checks checks) {
  const int particle = first_failed_.download()[0];
  if (particle == INT_MAX) return;
  first_failed_.upload({INT_MAX});
  throw RunFailure(checks == Checks::temperature   ? failed_temperature(body, particle)
                   : checks == Checks::deformation ? failed_deformation(body, particle)
                   : checks == Checks::position    ? failed_position(body, particle)
                                                   : failed_stencil(body, particle));
}

template <class T>
void DeviceBackend<T>::run_material(const std::string& phase, const Body<T>& body) {
  run_material(phase, arguments_of(body), body);
}

template <class T>
void DeviceBackend<T>::run_material(const std::string& phase, const Arguments<T>& a, const Body<T>& body) {
  run(phase + "_" + std::to_string(body.material_number), a, body, Checks::deformation);
}

template <class T>
void DeviceBackend<T>::run_strain(const Pass& pass, Body<T>& body) {
  Arguments<T> a = arguments_of(body);
  a.dt *= static_cast<T>(pass.share);
  run_material("strain", a, body);
  if (accounted_) book_material(body);
  if (plan_.has_heat_ledger() && body.heat.warming > 0)
    heat_ledger_.dissipation += sum_over_particles("heat_of_dissipation", body);
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device

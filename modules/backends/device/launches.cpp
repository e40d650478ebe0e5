#include "backends/device/device_backend.hpp"

#include <algorithm>
#include <stdexcept>

#include "backends/device/kernels/exact_sums.hpp"

namespace mpm::device {

template <class T>
Arguments<T> DeviceBackend<T>::arguments_of(const VelocityField<T>& field, const Manner& manner) const {
  Arguments<T> a = scene_;
  point_to(a, field);
  a.iteration = filter_pass_ + 1;
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
void DeviceBackend<T>::launch_teams(const std::string& phase, Arguments<T> a, int teams) {
  a.launch = ++launches_;
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
std::size_t DeviceBackend<T>::place(std::size_t count) {
  if (!results_.has_room_for(count)) look();
  return results_.place(count);
}

template <class T>
void DeviceBackend<T>::join(const std::string& phase, Arguments<T> a, int indices, std::size_t count, std::size_t place,
                            int maxima, const std::string& joining) {
  a.sum_teams = (indices + lanes_ - 1) / lanes_, a.sum_count = static_cast<int>(count), a.sum_maxima = maxima;
  a.sums = results_.at(place);
  launch_teams(phase, a, a.sum_teams);
  launch_teams(joining, a, 1);
}

template <class T>
Tally<1> DeviceBackend<T>::sum_over_nodes(const std::string& phase) {
  const Tally<1> total = tally<1>();
  for (const VelocityField<T>& field : fields_) sum<1>(phase, arguments_of(field, {}), nodes(), total);
  return total;
}

template <class T>
void DeviceBackend<T>::sum_over_particles(const std::string& phase, const Body<T>& body, const Tally<1>& to) {
  sum<1>(phase, arguments_of(body), body.count, to);
}

template <class T>
void DeviceBackend<T>::run(const std::string& phase, const Arguments<T>& a, const Body<T>& body, Checks checks) {
  launch(phase, a, body.count);
  watch(body, checks);
}

template <class T>
void DeviceBackend<T>::run_blocks(const std::string& phase, const Arguments<T>& a, const Body<T>& body, Checks checks) {
  if (!deterministic_) {
    launch_blocks(phase, a, body);
    return watch(body, checks);
  }
  exponents_.fill(0x7f);  // none
  Arguments<T> b = a;
  for (b.exact_phase = exact_measure; b.exact_phase < exact_take; ++b.exact_phase) {
    launch_blocks(phase, b, body);
    watch(body, checks);
  }
  launch(phase, b, nodes());
}

template <class T>
void DeviceBackend<T>::watch(const Body<T>& body, Checks checks, int part) {
  watched_.push_back({launches_ + part, static_cast<int>(&body - bodies_.data()), static_cast<int>(checks)});
}

template <class T>
void DeviceBackend<T>::launch_blocks(const std::string& phase, Arguments<T> a, const Body<T>& body) {
  a.teams = std::min(teams_, body.blocks.most());
  launch_teams(phase, a, a.teams);
}

template <class T>
void DeviceBackend<T>::look() {
  std::vector<Watched> watched;
  watched.swap(watched_);
  launches_ = 0;
  const Stopped stopped = results_.look();
  if (stopped == nothing_stopped) return;
  const int particle = particle_of(stopped);
  const auto found = std::find_if(watched.begin(), watched.end(),
                                  [&](const Watched& launch) { return launch.launch == launch_of(stopped); });
  if (found == watched.end()) throw std::logic_error("a phase that nobody watches has reported a particle");
  const Body<T>& body = bodies_[static_cast<std::size_t>(found->body)];
  const auto checks = static_cast<Checks>(found->checks);
  if (checks == Checks::grip) refuse_told(body, particle);
  throw RunFailure(checks == Checks::temperature   ? failed_temperature(body, particle)
                   : checks == Checks::deformation ? failed_deformation(body, particle)
                   : checks == Checks::position    ? failed_position(body, particle)
                   : checks == Checks::force       ? failed_force(body, particle)
                   : checks == Checks::load        ? failed_load(body, particle)
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
  if (plan_.does(Act::average_dilation)) run("gather_dilation", a, body, Checks::stencil);
  run_material("strain", a, body);
  if (accounted_) book_material(body);
  if (!plan_.has_heat_ledger() || !(body.heat.warming > 0)) return;
  const Tally<1> heat = tally<1>();
  sum_over_particles("heat_of_dissipation", body, heat);
  later([this, heat] { heat_ledger_.dissipation += (*heat)[0]; });
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device

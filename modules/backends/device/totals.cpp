#include "backends/device/device_backend.hpp"
#include "backends/device/kernels/totals_list.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::sum_particles(const std::string& phase, const Body<T>& body, int count, int maxima,
                                     int place) const {
  Arguments<T> a = arguments_of(body);
  a.sum_teams = (body.count + lanes_ - 1) / lanes_, a.sum_count = count, a.sum_maxima = maxima;
  a.sums = totals_.data() + place;
  device_->launch(phase, a, a.sum_teams, lanes_);
  device_->launch("add_particles", a, 1, lanes_);
}

template <class T>
std::optional<Totals> DeviceBackend<T>::totals_of(int index) const {
  const Body<T>& body = bodies_[static_cast<std::size_t>(index)];
  if (body.count == 0) return std::nullopt;
  constexpr int states = motion_sums, heats = states + state_sums;
  sum_particles("totals_of_motion", body, motion_sums, 1, 0);
  sum_particles("totals_of_state_" + std::to_string(body.material_number), body, state_sums, 2, states);
  if (experiment_.has_temperature()) sum_particles("totals_of_heat", body, heat_sums, 2, heats);
  const std::vector<double> found = totals_.download();
  const double *const motion = found.data(), *const state = motion + states, *const heat = motion + heats;
  Totals totals;
  totals.mass = motion[motion_mass], totals.kinetic = motion[motion_kinetic];
  for (int c = 0; c < static_cast<int>(totals.momentum.size()); ++c) {
    totals.momentum[c] = motion[motion_momentum + c];
    totals.angular_momentum[c] = motion[motion_angular_momentum + c];
    totals.centre_of_mass[c] = motion[motion_place + c];
    if (experiment_.gravity_has_potential(c)) totals.gravitational -= experiment_.gravity[c] * motion[motion_place + c];
  }
  totals.momentum_scale = motion[motion_momentum_scale];
  totals.angular_momentum_scale = motion[motion_angular_momentum_scale];
  totals.largest_speed = motion[motion_largest_speed];
  totals.strain = state[state_strain_energy];
  totals.smallest_volume_ratio = -state[state_smallest_volume_ratio];
  totals.largest_volume_ratio = state[state_largest_volume_ratio];
  if (!experiment_.has_temperature()) return totals;
  totals.heat_content = heat[heat_content], totals.latent_heat = heat[heat_latent];
  totals.lowest_temperature = -heat[heat_lowest], totals.highest_temperature = heat[heat_highest];
  return totals;
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device

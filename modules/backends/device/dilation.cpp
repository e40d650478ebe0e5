#include "backends/device/device_backend.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::scatter_mean_stress() {
  for_each_field("clear_mean_stress", nodes());
  for (Body<T>& body : bodies_) {
    run_material("stress", body);
    run_blocks("scatter_mean_stress", arguments_of(body), body);
  }
}

/// The volumes are those of the last stress or strain: a step that strains first has had neither.
template <class T>
void DeviceBackend<T>::scatter_dilation(const Pass& pass) {
  for_each_field("clear_dilation", nodes());
  for (Body<T>& body : bodies_) {
    if (pass.stage == Stage::before_forces) run_material("stress", body);
    Arguments<T> a = arguments_of(body);
    a.dt *= static_cast<T>(pass.share);
    run_blocks("scatter_dilation", a, body);
  }
}

template <class T>
void DeviceBackend<T>::average(const std::string& what) {
  for_each_axis("fold_" + what, folded_axes());
  for_each_field("divide_" + what, nodes());
  for_each_axis("fill_" + what, filled_axes());
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device

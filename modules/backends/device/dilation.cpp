#include "backends/device/device_backend.hpp"

namespace mpm::device {

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
void DeviceBackend<T>::average_dilation() {
  for_each_axis("fold_dilation", folded_axes());
  for_each_field("divide_dilation", nodes());
  for_each_axis("fill_dilation", filled_axes());
}

template <class T>
void DeviceBackend<T>::book_averaging(Body<T>& body) {
  const Tally<1> work = tally<1>();
  sum_over_particles("work_of_averaging", body, work);
  later([this, work] { ledger_.averaged_strain += (*work)[0]; });
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device

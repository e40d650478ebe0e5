#include "backends/device/device_backend.hpp"

#include <cmath>
#include <limits>

namespace mpm::device {

template <class T>
Failure DeviceBackend<T>::failure_of(Cause cause, const Body<T>& body, int p) const {
  return {cause, static_cast<int>(&body - bodies_.data()), static_cast<std::size_t>(p)};
}

template <class T>
std::optional<Failure> DeviceBackend<T>::position_not_a_number(const Body<T>& body, int p) const {
  const Vector3 x = body.vector(body.arrays.read("position"), static_cast<std::size_t>(p));
  for (int c = 0; c < experiment_.dimension; ++c)
    if (!std::isfinite(x[c])) {
      Failure failure = failure_of(Cause::position_not_a_number, body, p);
      failure.axis = c, failure.value = x[c];
      return failure;
    }
  return std::nullopt;
}

template <class T>
Failure DeviceBackend<T>::failed_temperature(const Body<T>& body, int p) const {
  const T temperature = body.arrays.read("temperature")[static_cast<std::size_t>(p)];
  if (std::isfinite(temperature)) return failed_stencil(body, p);
  Failure failure = failure_of(Cause::temperature_not_a_number, body, p);
  failure.value = temperature;
  return failure;
}

template <class T>
Failure DeviceBackend<T>::failed_deformation(const Body<T>& body, int p) const {
  const T J = body.arrays.read("volume_ratio")[static_cast<std::size_t>(p)];
  Failure failure = failure_of(std::isnan(J) ? Cause::deformation_not_a_number : Cause::inverted, body, p);
  failure.value = J;
  return failure;
}

template <class T>
Failure DeviceBackend<T>::failed_stencil(const Body<T>& body, int p) const {
  if (const auto failure = position_not_a_number(body, p)) return *failure;
  if (body.turned_inside_out("corners", p)) return failure_of(Cause::domain_inside_out, body, p);
  const bool list = experiment_.shape.plugin->shape().form == MPM_NODE_LIST;
  return failure_of(list ? Cause::domain_beyond_grid : Cause::domain_outgrew_stencil, body, p);
}

template <class T>
Failure DeviceBackend<T>::failed_position(const Body<T>& body, int p) const {
  if (const auto failure = position_not_a_number(body, p)) return *failure;
  if (body.turned_inside_out("moved_corners", p)) return failure_of(Cause::domain_inside_out, body, p);
  Failure failure = failure_of(Cause::left_domain, body, p);
  const Vector3 position = body.vector(body.arrays.read("position"), static_cast<std::size_t>(p));
  T farthest = -std::numeric_limits<T>::infinity();
  for (int c = 0; c < experiment_.dimension; ++c) {
    const T x = static_cast<T>(position[c]);
    if (c == 0 && experiment_.axisymmetric() && !(x > T(0))) {
      failure.cause = Cause::reached_axis, failure.axis = c, failure.value = x;
      return failure;
    }
    if (periodic(c)) continue;
    const T size = T(scene_.cells[c]) * scene_.cell_size, at = x - scene_.lower[c];
    const auto margin = [&](int side) {
      return scene_.walls[c][side] == wall_separate ? T(0.5) * scene_.cell_size : position_tolerance<T> * size;
    };
    const T beyond = std::max(-at - margin(0), at - size - margin(1));
    if (beyond > farthest) farthest = beyond, failure.axis = c, failure.value = x;
    if (beyond > T(0)) break;
  }
  return failure;
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device

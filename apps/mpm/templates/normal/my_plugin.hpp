#pragma once
// A normal between that of the averaged volume gradients (exponent 1) and that of the larger one alone (a high exponent),
// after the normals that Nairn (2013), CMES - Comput. Model. Eng. Sci. 92:271-299, compares: with g = sum V grad w of each
// body at the node, pointing out of it,
//   n = (|g_a|^(p-1) g_a - |g_b|^(p-1) g_b) / |...|

#include "kernel/direction.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MyPlugin {
  struct Parameters {
    double exponent;
  };

  /// The normal is a unit vector from body a to b, and `found` 1, or 0 where there is none.
  template <int D, class S>
  MPM_HD static void find(const Parameters& p, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    const scalar_of<S> zero = 0, one = 1, half_power = real<S>(0.5 * (p.exponent - 1));
    S squared_a(zero), squared_b(zero);
    for (int i = 0; i < D; ++i) {
      squared_a = squared_a + pair.volume_gradient_a[i] * pair.volume_gradient_a[i];
      squared_b = squared_b + pair.volume_gradient_b[i] * pair.volume_gradient_b[i];
    }
    // Weights are shares of the larger gradient: no power of a small number leaves the range of a float.
    const S larger = max(squared_a, squared_b), safe = select(larger > zero, larger, S(one));
    const S weight_a = weight(squared_a / safe, half_power), weight_b = weight(squared_b / safe, half_power);
    for (int i = 0; i < D; ++i)
      result.normal[i] = weight_a * pair.volume_gradient_a[i] - weight_b * pair.volume_gradient_b[i];
    result.found = make_unit(result.normal);
  }

  template <class S>
  MPM_HD static S weight(S share, scalar_of<S> half_power) {
    const scalar_of<S> least = real<S>(1e-30);
    return exp(half_power * log(max(share, S(least))));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_READS_VOLUME_GRADIENT;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(exponent, "", 2.0, 1.0, 8.0, 0, "power p with which the larger gradient counts more"),
  };
#endif
};

}  // namespace mpm

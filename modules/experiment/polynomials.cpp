#include "experiment/polynomials.hpp"

#include <algorithm>

#include "kernel/polynomial_basis.hpp"
#include "plugin/extension_of.hpp"

namespace mpm {

int basis_order_of(const Component& transfer) {
  const auto* polynomials = extension_of<mpm_transfer_polynomials>(*transfer.plugin);
  return polynomials ? polynomials->order(transfer.parameters.data()) : 0;
}

int basis_order_of(const Component& transfer, const Plugin& shape) {
  const int order = basis_order_of(transfer);
  return order > 0 ? std::min(order, static_cast<int>(shape.shape().width) - 1) : 0;
}

std::vector<std::string> polynomial_names(const Experiment& experiment) {
  std::vector<std::string> names;
  const int order = basis_order_of(experiment.transfer, *experiment.shape.plugin);
  if (order == 0) return names;
  const auto add = [&](int, const int* powers) {
    std::string& name = names.emplace_back("polynomial_");
    for (int axis = 0; axis < experiment.dimension; ++axis) name += std::to_string(powers[axis]);
  };
  if (experiment.dimension == 2)
    for_each_product<2>(order, add);
  else
    for_each_product<3>(order, add);
  return names;
}

}  // namespace mpm

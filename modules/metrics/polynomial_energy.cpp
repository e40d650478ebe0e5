#include "metrics/polynomial_energy.hpp"

#include <algorithm>

#include "kernel/polynomial_basis.hpp"

namespace mpm {
namespace {

/// Weights of a tensor-product shape at all particles, [D][width][n], and their places in the stencils, [D][n].
struct Weights {
  std::size_t n = 0;
  std::vector<double> weight, offset;
};

Weights weights_at(const Experiment& experiment, int body, const BodyState& state) {
  const std::size_t D = experiment.dimension, count = state.position.size() / D;
  const mpm_shape& shape = experiment.shape.plugin->shape();
  const std::uint32_t needs = experiment.shape.plugin->descriptor->needs;
  const double h = experiment.grid.cell_size;
  Weights result;
  const std::size_t n = result.n = (count + MPM_LANES - 1) / MPM_LANES * MPM_LANES;
  std::vector<double> position(D * n), half_size(D * n, 0.5 / experiment.bodies[body].particles_per_cell_axis),
      domain(D * D * n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t p = std::min(k, count - 1);  // the last one pads
    for (std::size_t c = 0; c < D; ++c)
      position[c * n + k] = (state.position[p * D + c] - experiment.grid.lower[c]) / h;
    for (std::size_t c = 0; c < D * D && !state.domain.empty(); ++c)
      domain[c * n + k] = state.domain[p * D * D + c] / h;
  }
  std::vector<std::int32_t> base(D * n);
  result.weight.resize(D * shape.width * n), result.offset.resize(D * n);
  mpm_shape_batch batch{};
  batch.count = batch.stride = static_cast<std::uint32_t>(n);
  batch.dimension = static_cast<std::uint32_t>(D);
  batch.position = position.data();
  if (needs & MPM_NEEDS_HALF_SIZE) batch.half_size = half_size.data();
  if (needs & MPM_NEEDS_DOMAIN) batch.domain = domain.data();
  batch.base = base.data(), batch.offset = result.offset.data(), batch.weight = result.weight.data();
  shape.evaluate[MPM_SCALAR_DOUBLE](experiment.shape.parameters.data(), &batch);
  return result;
}

template <int D, int K>
std::vector<double> energies(const Plan& plan, const Weights& weights, const std::vector<double>& coefficients) {
  const std::size_t scalars = static_cast<std::size_t>(plan.basis_functions) * D;
  std::vector<double> energy(coefficients.size() / scalars);
  for (std::size_t p = 0; p < energy.size(); ++p) {
    AxisBasis<K, double> axis[D];
    for (std::size_t c = 0; c < D; ++c)
      make_axis_basis<K>(&weights.weight[c * K * weights.n + p], static_cast<int>(weights.n),
                         weights.offset[c * weights.n + p], plan.basis_order, axis[c]);
    for_each_product<D>(plan.basis_order, [&](int function, const int* power) {
      double norm = 1, squares = 0;
      for (int c = 0; c < D; ++c) {
        const double x = coefficients[p * scalars + static_cast<std::size_t>(function) * D + c];
        norm *= axis[c].norm[power[c]], squares += x * x;
      }
      energy[p] += 0.5 * norm * squares;
    });
  }
  return energy;
}

template <int D>
std::vector<double> energies(int width, const Plan& plan, const Weights& weights,
                             const std::vector<double>& coefficients) {
  if (width == 2) return energies<D, 2>(plan, weights, coefficients);
  return width == 3 ? energies<D, 3>(plan, weights, coefficients) : energies<D, 4>(plan, weights, coefficients);
}

}  // namespace

std::vector<double> polynomial_energy(const Experiment& experiment, const Plan& plan, int body,
                                      const BodyState& state) {
  if (plan.basis_functions == 0 || state.position.empty()) return {};
  const Weights weights = weights_at(experiment, body, state);
  const std::vector<double>& coefficients = state.transfer_state.at(polynomial_coefficients);
  const int width = static_cast<int>(experiment.shape.plugin->shape().width);
  return experiment.dimension == 2 ? energies<2>(width, plan, weights, coefficients)
                                   : energies<3>(width, plan, weights, coefficients);
}

}  // namespace mpm

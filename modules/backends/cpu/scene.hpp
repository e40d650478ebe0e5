#pragma once
// What stays the same over a run: entry points, units, and which moments the chosen plugins need.

#include <cmath>
#include <stdexcept>

#include "blocks.hpp"
#include "experiment/plan.hpp"
#include "simulation/backend.hpp"
#include "simulation/boundary.hpp"

namespace mpm::cpu {

template <class T>
inline constexpr int lane_precision = sizeof(T) == 4 ? MPM_LANES_FLOAT : MPM_LANES_DOUBLE;

/// Domain in cells.
struct Domain {
  Vector3 lower{};       ///< m
  double cell_size = 0;  ///< m
  std::array<int, 3> cells{1, 1, 1};
  std::array<std::array<ConditionType, 2>, 3> faces{};

  bool periodic(int axis) const { return faces[axis][0] == ConditionType::periodic; }
  Vector3 node_position(const std::array<int, 3>& node, int dimension) const {
    Vector3 x{};
    for (int a = 0; a < dimension; ++a) x[a] = lower[a] + cell_size * node[a];
    return x;
  }
};

template <int D, class T>
struct Scene {
  Scene(const Experiment& e, const Plan& p, int thread_count)
      : experiment(e), plan(p), threads(std::max(1, thread_count)) {
    domain.lower = e.grid.lower;
    domain.cell_size = e.grid.cell_size;
    domain.cells = e.grid.cells;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) domain.faces[axis][side] = e.faces[axis][side].type;
    const mpm_shape& shape = e.shape.plugin->shape();
    if (shape.form != MPM_TENSOR_PRODUCT || shape.second_moment_kind == MPM_MOMENT_PER_PARTICLE)
      throw std::invalid_argument(
          "the cpu backend takes tensor-product shapes with a constant second moment or the linear one's");
    width = static_cast<int>(shape.width);
    evaluate_shape = shape.evaluate[lane_precision<T>];
    shape_parameters = e.shape.parameters.data();
    moment_is_gradient = shape.second_moment_kind == MPM_MOMENT_IS_GRADIENT;
    if (!moment_is_gradient) inverse_moment = 1 / (shape.second_moment * domain.cell_size * domain.cell_size);

    const mpm_transfer& transfer = e.transfer.plugin->transfer();
    traits = transfer.traits;
    transfer_scatter = transfer.scatter[lane_precision<T>][D - 2];
    transfer_gather = transfer.gather[lane_precision<T>][D - 2];
    transfer_parameters = e.transfer.parameters.data();
    stress_by_affine = has(MPM_STRESS_BY_AFFINE) && !moment_is_gradient;
  }
  bool has(unsigned trait) const { return (traits & trait) != 0; }
  /// D_a of one axis (m^2) for a particle at `offset` cells from its stencil's first node.
  double second_moment(double offset) const {
    return moment_is_gradient ? offset * (1 - offset) * domain.cell_size * domain.cell_size : 1 / inverse_moment;
  }

  const Experiment& experiment;
  const Plan& plan;
  int threads = 1;
  Domain domain;

  int width = 3;
  void (*evaluate_shape)(const void*, const mpm_shape_batch*) = nullptr;
  const void* shape_parameters = nullptr;
  bool moment_is_gradient = false;
  double inverse_moment = 0;  ///< 1 / (second_moment h^2), 1/m^2

  unsigned traits = 0;
  bool stress_by_affine = false;
  void (*transfer_scatter)(const void*, const mpm_scatter_batch*) = nullptr;
  void (*transfer_gather)(const void*, const mpm_gather_batch*) = nullptr;
  const void* transfer_parameters = nullptr;
};

}  // namespace mpm::cpu

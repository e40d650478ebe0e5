#pragma once
// A scene holds what stays the same over a run: entry points, units, and which moments the chosen plugins need.

#include <cmath>
#include <memory>
#include <stdexcept>

#include "backends/cpu/grid/blocks.hpp"
#include "plan/plan.hpp"
#include "plugin/extension_of.hpp"
#include "simulation/backend.hpp"
#include "simulation/boundary.hpp"
#include "support/team.hpp"

namespace mpm::cpu {

template <class T>
inline constexpr int lane_precision = sizeof(T) == 4 ? MPM_LANES_FLOAT : MPM_LANES_DOUBLE;

/// The width of the tile that lists of nodes are scattered to, which is the widest.
inline constexpr int list_width = MPM_BOX_WIDTH;

/// The domain in cells.
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
      : experiment(e), plan(p), team(std::make_unique<support::Team>(thread_count)), threads(team->size()) {
    domain.lower = e.grid.lower;
    domain.cell_size = e.grid.cell_size;
    domain.cells = e.grid.cells;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) domain.faces[axis][side] = e.faces[axis][side].type;
    const mpm_shape& shape = e.shape.plugin->shape();
    list = shape.form == MPM_NODE_LIST;
    width = list ? list_width : static_cast<int>(shape.width);
    if (list) {
      capacity = static_cast<int>(shape.capacity[D - 2]);
      list_reach = shape.reach;
      evaluate_list = shape.evaluate_list[lane_precision<T>][D - 2];
      if (const auto* boxes = extension_of<mpm_shape_boxes>(*e.shape.plugin))
        evaluate_box = boxes->evaluate[lane_precision<T>][D - 2];
    } else {
      evaluate_shape = shape.evaluate[lane_precision<T>];
    }
    padding = grid_padding_of(shape);
    axisymmetric = D == 2 && e.axisymmetric();
    shape_parameters = e.shape.parameters.data();
    half_size = e.shape.plugin->descriptor->needs & MPM_NEEDS_HALF_SIZE;
    moment_is_gradient = shape.second_moment_kind == MPM_MOMENT_IS_GRADIENT;
    moment_of_particle = shape.second_moment_kind == MPM_MOMENT_PER_PARTICLE;
    if (shape.second_moment_kind == MPM_MOMENT_CONSTANT)
      inverse_moment = 1 / (shape.second_moment * domain.cell_size * domain.cell_size);

    const mpm_transfer& transfer = e.transfer.plugin->transfer();
    traits = transfer.traits;
    transfer_scatter = transfer.scatter[lane_precision<T>][D - 2];
    transfer_gather = transfer.gather[lane_precision<T>][D - 2];
    transfer_parameters = e.transfer.parameters.data();
    stress_by_affine = has(MPM_STRESS_BY_AFFINE) && !moment_is_gradient;
  }
  bool has(unsigned trait) const { return (traits & trait) != 0; }

  const Experiment& experiment;
  const Plan& plan;
  std::unique_ptr<support::Team> team;  ///< threads that share the loops
  int threads;                          ///< number of threads of the team
  Domain domain;
  bool axisymmetric = false;  ///< x is the radius

  int width = 3;  ///< nodes an axis of a stencil, which make the tile of a block
  void (*evaluate_shape)(const void*, const mpm_shape_batch*) = nullptr;
  const void* shape_parameters = nullptr;
  bool list = false;  ///< the shape gives lists of nodes
  void (*evaluate_list)(const void*, const mpm_list_batch*) = nullptr;
  void (*evaluate_box)(const void*, const mpm_box_batch*) = nullptr;  ///< null where the shape gives only lists
  int capacity = 0;                                                   ///< most nodes of a list
  double list_reach = 0;                                              ///< reach beyond the particle's domain, cells
  int padding = grid_padding;
  bool half_size = false;  ///< the shape reads half_size
  bool moment_is_gradient = false, moment_of_particle = false;
  double inverse_moment = 0;  ///< 1 / (second_moment h^2), 1/m^2, where that is constant

  unsigned traits = 0;
  bool stress_by_affine = false;
  void (*transfer_scatter)(const void*, const mpm_scatter_batch*) = nullptr;
  void (*transfer_gather)(const void*, const mpm_gather_batch*) = nullptr;
  const void* transfer_parameters = nullptr;
};

}  // namespace mpm::cpu

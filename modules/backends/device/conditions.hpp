#pragma once
// These tables tell kernels what the walls and boxes of an experiment give. The host evaluates formulas at their nodes.

#include <optional>
#include <vector>

#include "backends/device/device.hpp"
#include "experiment/experiment.hpp"

namespace mpm::device {

/// The nodes between two corners, both included.
struct NodeRange {
  int lower[3], upper[3];

  /// The positions of the nodes, x first.
  std::vector<Vector3> positions(const Experiment& experiment) const {
    std::vector<Vector3> all;
    for (int k = lower[2]; k <= upper[2]; ++k)
      for (int j = lower[1]; j <= upper[1]; ++j)
        for (int i = lower[0]; i <= upper[0]; ++i) {
          const int node[3] = {i, j, k};
          Vector3 x{};
          for (int c = 0; c < experiment.dimension; ++c) x[c] = coordinate(experiment, c, node[c]);
          all.push_back(x);
        }
    return all;
  }
  static double coordinate(const Experiment& experiment, int axis, int node) {
    return experiment.grid.lower[axis] + experiment.grid.cell_size * node;
  }
};

/// All nodes in the plane of a wall, ghosts too, in the order in which the lines of the axis are numbered.
template <class T>
NodeRange nodes_of_wall(const Arguments<T>& scene, int axis, int side) {
  NodeRange range{};
  for (int c = 0; c < 3; ++c) range.lower[c] = -scene.padding[c], range.upper[c] = scene.cells[c] + scene.padding[c];
  range.lower[axis] = range.upper[axis] = side == 0 ? 0 : scene.cells[axis];
  return range;
}

/// The nodes under a condition, if there are any.
template <class T>
std::optional<NodeRange> nodes_of_box(const Experiment& experiment, const Arguments<T>& scene,
                                      const BoxCondition& condition) {
  NodeRange range{};
  const double tolerance = 1e-9 * experiment.grid.cell_size;
  for (int c = 0; c < experiment.dimension; ++c) {
    int &first = range.lower[c] = -scene.padding[c], &last = range.upper[c] = scene.cells[c] + scene.padding[c];
    while (first <= last && NodeRange::coordinate(experiment, c, first) < condition.lower[c] - tolerance) ++first;
    while (first <= last && NodeRange::coordinate(experiment, c, last) > condition.upper[c] + tolerance) --last;
    if (first > last) return {};
  }
  return range;
}

template <class T>
class Conditions {
 public:
  /// `scene` holds cells, extent, padding and the number of nodes.
  Conditions(Device& device, const Experiment& experiment, const Arguments<T>& scene)
      : experiment_(experiment), device_boxes_(device, "the conditions") {
    for (int axis = 0; axis < experiment.dimension; ++axis)
      for (int side = 0; side < 2; ++side) {
        const FaceCondition& face = experiment.faces[axis][side];
        if (!face.velocity) continue;
        moving_.push_back({&*face.velocity, nodes_of_wall(scene, axis, side), {device, "the conditions"}});
        walls_.push_back({axis, side, moving_.size() - 1});
      }
    for (std::size_t k = 0; k < experiment.boxes.size(); ++k) {
      const BoxCondition& condition = experiment.boxes[k];
      const std::optional<NodeRange> nodes = nodes_of_box(experiment, scene, condition);
      if (!nodes) continue;
      Box<T> box{};
      box.type = static_cast<int>(condition.type), box.axis = condition.axis, box.side = condition.side;
      for (int c = 0; c < 3; ++c) {
        box.lower[c] = nodes->lower[c], box.upper[c] = nodes->upper[c];
        box.given |= condition.held[c] << c;
      }
      box.support = support_of_box(static_cast<int>(k));
      boxes_.push_back(box);
      moving_of_box_.push_back(condition.velocity ? moving_.size() : none);
      if (condition.velocity) moving_.push_back({&*condition.velocity, *nodes, {device, "the conditions"}});
    }
  }

  /// Evaluates velocities at a time, s, and points the scene to them.
  void evaluate(double time, Arguments<T>& scene) {
    for (Moving& moving : moving_) evaluate(moving, time);
    time_ = time;
    for (const auto& [axis, side, number] : walls_) scene.wall_velocity[axis][side] = moving_[number].velocity.data();
    if (device_boxes_.count() != boxes_.size()) {  // what moves has its place from its first evaluation on
      for (std::size_t k = 0; k < boxes_.size(); ++k)
        boxes_[k].velocity = moving_of_box_[k] == none ? nullptr : moving_[moving_of_box_[k]].velocity.data();
      device_boxes_.upload(boxes_);
    }
    scene.boxes = device_boxes_.data(), scene.box_count = static_cast<int>(boxes_.size());
  }

 private:
  /// The nodes, x first, with the velocities that a formula gives them.
  struct Moving {
    const VectorExpression* formula;
    NodeRange nodes;
    DeviceArray<T> velocity;
  };
  struct MovingWall {
    int axis, side;
    std::size_t number;
  };
  static constexpr std::size_t none = ~std::size_t{0};

  void evaluate(Moving& moving, double time) {
    if (moving.velocity.count() > 0 && (!moving.formula->uses_time() || time == time_)) return;
    const int D = experiment_.dimension;
    const std::vector<Vector3> positions = moving.nodes.positions(experiment_);
    std::vector<Vector3> values(positions.size());
    moving.formula->evaluate(positions, positions, time, values);
    std::vector<T> velocity;
    for (int c = 0; c < D; ++c)
      for (const Vector3& value : values) velocity.push_back(static_cast<T>(value[c]));
    moving.velocity.upload(velocity);
  }

  const Experiment& experiment_;
  double time_ = 0;
  std::vector<Moving> moving_;
  std::vector<MovingWall> walls_;
  std::vector<Box<T>> boxes_;
  DeviceArray<Box<T>> device_boxes_;
  std::vector<std::size_t> moving_of_box_;
};

}  // namespace mpm::device

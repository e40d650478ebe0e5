#pragma once
// These tables tell kernels what walls and boxes do with heat. The host evaluates formulas at their nodes.

#include "backends/device/conditions.hpp"
#include "simulation/boundary.hpp"
#include "simulation/wall_heat.hpp"

namespace mpm::device {

template <class T>
class HeatConditions {
 public:
  /// `scene` holds cells, extent, padding and the number of nodes.
  HeatConditions(Device& device, const Experiment& experiment, const Arguments<T>& scene)
      : experiment_(experiment), shares_(device, "the walls' shares of heat"), device_boxes_(device, "the conditions") {
    for (int axis = 0; axis < experiment.dimension; ++axis)
      for (int side = 0; side < 2; ++side) {
        const FaceCondition& face = experiment.faces[axis][side];
        if (holds_temperature(face) || passes_heat(face))
          walls_.push_back({axis, side, {&face.thermal, nodes_of_wall(scene, axis, side), {device, "the conditions"}}});
      }
    if (!exchanging_axes().empty()) {
      const WallWeights weights = wall_weights(experiment);
      shares_.upload(std::vector<T>(weights.shares.begin(), weights.shares.end()));
      beyond_ = static_cast<T>(experiment.grid.cell_size * weights.beyond);
    }
    for (const BoxCondition& condition : experiment.boxes) {
      const std::optional<NodeRange> nodes = nodes_of_box(experiment, scene, condition);
      if (!nodes || condition.thermal.exchange == HeatExchange::none) continue;
      HeatBox<T> box{};
      for (int c = 0; c < 3; ++c) box.lower[c] = nodes->lower[c], box.upper[c] = nodes->upper[c];
      boxes_.push_back(box);
      values_of_box_.push_back({&condition.thermal, *nodes, {device, "the conditions"}});
    }
  }

  /// Evaluates temperatures, fluxes and powers at a time, s, and points the scene to them.
  void evaluate(double time, Arguments<T>& scene) {
    scene.wall_shares = shares_.data(), scene.wall_share_count = static_cast<int>(shares_.count());
    scene.wall_beyond = beyond_;
    for (Wall& wall : walls_) {
      const T* const values = wall.at.evaluate(experiment_, time);
      if (wall.at.holds())
        scene.wall_temperature[wall.axis][wall.side] = values;
      else
        scene.wall_heat[wall.axis][wall.side] = {values, static_cast<T>(wall.at.condition->coefficient)};
    }
    for (std::size_t k = 0; k < boxes_.size(); ++k)
      (values_of_box_[k].holds() ? boxes_[k].temperature : boxes_[k].power) =
          values_of_box_[k].evaluate(experiment_, time);
    if (device_boxes_.count() != boxes_.size()) device_boxes_.upload(boxes_);  // values keep their place
    scene.heat_boxes = device_boxes_.data(), scene.heat_box_count = static_cast<int>(boxes_.size());
  }

  /// Whether a wall's mirror images change the heat of the nodes.
  bool walls_act() const { return !walls_.empty(); }

  /// The numbers of the boxes that are warmed.
  std::vector<int> warmed_boxes() const {
    std::vector<int> numbers;
    for (std::size_t k = 0; k < boxes_.size(); ++k)
      if (!values_of_box_[k].holds()) numbers.push_back(static_cast<int>(k));
    return numbers;
  }
  /// The axes with a wall through which heat comes.
  std::vector<int> exchanging_axes() const {
    std::vector<int> axes;
    for (const Wall& wall : walls_)
      if (!wall.at.holds() && (axes.empty() || axes.back() != wall.axis)) axes.push_back(wall.axis);
    return axes;
  }

 private:
  /// The nodes with the values that a formula gives them.
  struct Values {
    const ThermalCondition* condition;
    NodeRange nodes;
    DeviceArray<T> values;
    double time = 0;

    bool holds() const { return condition->exchange == HeatExchange::fixed_temperature; }
    const T* evaluate(const Experiment& experiment, double now) {
      if (values.count() > 0 && (now == time || !condition->value.uses_time())) return values.data();
      time = now;
      const std::vector<Vector3> positions = nodes.positions(experiment);
      std::vector<double> found(positions.size());
      condition->value.evaluate(positions, now, found.data());
      values.upload(std::vector<T>(found.begin(), found.end()));
      return values.data();
    }
  };
  struct Wall {
    int axis, side;
    Values at;
  };

  const Experiment& experiment_;
  DeviceArray<T> shares_;
  T beyond_ = 0;
  std::vector<Wall> walls_;
  std::vector<HeatBox<T>> boxes_;
  DeviceArray<HeatBox<T>> device_boxes_;
  std::vector<Values> values_of_box_;
};

}  // namespace mpm::device

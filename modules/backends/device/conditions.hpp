#pragma once
// What the walls and boxes of an experiment give, as tables of the kernels. Formulas are the host's: it evaluates them
// at their nodes.

#include <optional>
#include <vector>

#include "backends/device/kernels/arguments.hpp"
#include "experiment/experiment.hpp"

namespace mpm::device {

template <class T>
class Conditions {
 public:
  /// `scene` holds cells, extent, padding and the number of nodes.
  Conditions(const Experiment& experiment, const Arguments<T>& scene) : experiment_(experiment) {
    for (int axis = 0; axis < experiment.dimension; ++axis)
      for (int side = 0; side < 2; ++side) {
        const FaceCondition& face = experiment.faces[axis][side];
        if (!face.velocity) continue;
        Box<T> wall{};
        for (int c = 0; c < 3; ++c)
          wall.lower[c] = -scene.padding[c], wall.upper[c] = scene.cells[c] + scene.padding[c];
        wall.lower[axis] = wall.upper[axis] = side == 0 ? 0 : scene.cells[axis];
        moving_.push_back({&*face.velocity, wall, {}});
        walls_.push_back({axis, side, moving_.size() - 1});
      }
    for (const BoxCondition& condition : experiment.boxes) {
      const std::optional<Box<T>> box = nodes_in(condition, scene);
      if (!box) continue;
      boxes_.push_back(*box);
      moving_of_box_.push_back(condition.velocity ? moving_.size() : none);
      if (condition.velocity) moving_.push_back({&*condition.velocity, *box, {}});
    }
  }

  /// Velocities at a time, s, and where they are.
  void evaluate(double time, Arguments<T>& scene) {
    for (Moving& moving : moving_) evaluate(moving, time);
    time_ = time;
    for (const auto& [axis, side, number] : walls_) scene.wall_velocity[axis][side] = moving_[number].velocity.data();
    for (std::size_t k = 0; k < boxes_.size(); ++k)
      boxes_[k].velocity = moving_of_box_[k] == none ? nullptr : moving_[moving_of_box_[k]].velocity.data();
    scene.boxes = boxes_.data(), scene.box_count = static_cast<int>(boxes_.size());
  }

 private:
  /// Nodes, x first, with the velocities that a formula gives them.
  struct Moving {
    const VectorExpression* formula;
    Box<T> nodes;
    std::vector<T> velocity;
  };
  struct MovingWall {
    int axis, side;
    std::size_t number;
  };
  static constexpr std::size_t none = ~std::size_t{0};

  double coordinate(int axis, int node) const {
    return experiment_.grid.lower[axis] + experiment_.grid.cell_size * node;
  }

  std::optional<Box<T>> nodes_in(const BoxCondition& condition, const Arguments<T>& scene) const {
    Box<T> box{};
    box.type = static_cast<int>(condition.type), box.axis = condition.axis, box.side = condition.side;
    const double tolerance = 1e-9 * experiment_.grid.cell_size;
    for (int c = 0; c < 3; ++c) box.given |= condition.held[c] << c;
    for (int c = 0; c < experiment_.dimension; ++c) {
      int &first = box.lower[c] = -scene.padding[c], &last = box.upper[c] = scene.cells[c] + scene.padding[c];
      while (first <= last && coordinate(c, first) < condition.lower[c] - tolerance) ++first;
      while (first <= last && coordinate(c, last) > condition.upper[c] + tolerance) --last;
      if (first > last) return {};
    }
    return box;
  }

  void evaluate(Moving& moving, double time) {
    if (!moving.velocity.empty() && (!moving.formula->uses_time() || time == time_)) return;
    const int D = experiment_.dimension;
    const Box<T>& box = moving.nodes;
    std::vector<Vector3> values;
    for (int k = box.lower[2]; k <= box.upper[2]; ++k)
      for (int j = box.lower[1]; j <= box.upper[1]; ++j)
        for (int i = box.lower[0]; i <= box.upper[0]; ++i) {
          const Vector3 x{coordinate(0, i), coordinate(1, j), D == 3 ? coordinate(2, k) : 0.0};
          values.push_back((*moving.formula)(x, x, time));
        }
    moving.velocity.resize(values.size() * static_cast<std::size_t>(D));
    for (int c = 0; c < D; ++c)
      for (std::size_t n = 0; n < values.size(); ++n)
        moving.velocity[static_cast<std::size_t>(c) * values.size() + n] = static_cast<T>(values[n][c]);
  }

  const Experiment& experiment_;
  double time_ = 0;
  std::vector<Moving> moving_;
  std::vector<MovingWall> walls_;
  std::vector<Box<T>> boxes_;
  std::vector<std::size_t> moving_of_box_;
};

}  // namespace mpm::device

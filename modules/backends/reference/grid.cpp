#include "backends/reference/grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mpm::reference {

Grid::Grid(const Experiment& experiment) : experiment_(experiment) {
  padding_ = Eigen::Vector3i::Zero();
  extent_ = Eigen::Vector3i::Ones();
  for (int axis = 0; axis < experiment.dimension; ++axis) {
    padding_[axis] = grid_padding_of(experiment.shape.plugin->shape());
    extent_[axis] = experiment.grid.cells[axis] + 1 + 2 * padding_[axis];
  }
  for (int k = 0; k < extent_[2]; ++k)
    for (int j = 0; j < extent_[1]; ++j)
      for (int i = 0; i < extent_[0]; ++i) coordinates_.push_back(Eigen::Vector3i(i, j, k) - padding_);
  fields_.assign(experiment.field_count, std::vector<Node>(coordinates_.size()));
  // In a domain of few cells a ghost's mirror is a ghost of the other wall: it is folded on after what it receives.
  for (int axis = 0; axis < experiment.dimension; ++axis) {
    auto& order = outermost_first_[axis];
    order.resize(coordinates_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto beyond = [&](std::size_t index) {
      const int i = coordinates_[index][axis];
      return std::max({-i, i - experiment.grid.cells[axis], 0});
    };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return beyond(a) > beyond(b); });
  }
}

void Grid::reset() {
  for (auto& field : fields_) std::fill(field.begin(), field.end(), Node{});
  folds_.clear();
}

void Grid::reset_momentum() {
  for (auto& field : fields_)
    for (Node& node : field) {
      node.mass = 0;
      node.momentum = node.velocity = Vector::Zero();
    }
  folds_.clear();
}

std::size_t Grid::index(const Eigen::Vector3i& coordinates) const {
  const Eigen::Vector3i c = coordinates + padding_;
  return (static_cast<std::size_t>(c[2]) * extent_[1] + c[1]) * extent_[0] + c[0];
}

bool Grid::contains(const Eigen::Vector3i& coordinates) const {
  const Eigen::Vector3i c = coordinates + padding_;
  return (c.array() >= 0).all() && (c.array() < extent_.array()).all();
}

Vector Grid::position(const Eigen::Vector3i& coordinates) const {
  return to_eigen(experiment_.grid.lower) + experiment_.grid.cell_size * coordinates.cast<double>();
}

double Grid::kinetic_energy() const {
  double sum = 0;
  for (const auto& field : fields_)
    for (const Node& node : field) sum += node.kinetic_energy();
  return sum;
}

double Grid::mass_norm(Vector Node::*velocity) const {
  double sum = 0;
  for (const auto& field : fields_)
    for (const Node& node : field)
      if (node.mass > 0) sum += node.mass * (node.*velocity).squaredNorm();
  return std::sqrt(sum);
}

Vector Grid::wall_velocity(const Fold& fold, double time) const {
  const FaceCondition& face = experiment_.faces[fold.axis][fold.side];
  if (!face.velocity) return Vector::Zero();
  Eigen::Vector3i foot = coordinates_[fold.ghost];
  foot[fold.axis] = fold.side == 0 ? 0 : experiment_.grid.cells[fold.axis];
  const Vector x = position(foot);
  return to_eigen((*face.velocity)({x[0], x[1], x[2]}, {x[0], x[1], x[2]}, time));
}

ConditionType Grid::type_of(const Fold& fold) const {
  return fold.side < 0 ? ConditionType::periodic : experiment_.faces[fold.axis][fold.side].type;
}

Vector Grid::mirrored(const Vector& v, const Fold& fold, ConditionType as) {
  if (fold.side < 0) return v;
  Vector r = v;
  for (int c = 0; c < 3; ++c) r[c] *= mirror_sign(as, fold.axis, c);
  return r;
}

bool Grid::approaches_wall(const Fold& fold, double dt) const {
  const double inward = fold.side == 0 ? 1 : -1;
  double speed = 0;
  for (const std::size_t index : {fold.ghost, fold.mirror}) {
    const Node& node = fields_[fold.field][index];
    if (node.mass > 0) speed += inward * (node.momentum + dt * node.force())[fold.axis] / node.mass;
  }
  return speed < 0;
}

void Grid::sum_images(bool remap) {
  for (int axis = 0; axis < experiment_.dimension; ++axis)
    if (experiment_.faces[axis][0].type == ConditionType::periodic) fold_axis(axis, 0, 0, remap);
  if (!remap) fold_forces();
}

void Grid::fold_walls(double time, double dt, bool remap) {
  for (int axis = 0; axis < experiment_.dimension; ++axis)
    if (experiment_.faces[axis][0].type != ConditionType::periodic) fold_axis(axis, time, dt, remap);
}

void Grid::fold_axis(int axis, double time, double dt, bool remap) {
  const int cells = experiment_.grid.cells[axis];
  for (int field = 0; field < field_count(); ++field)
    for (const std::size_t index : outermost_first_[axis]) {
      Eigen::Vector3i target = coordinates_[index];
      const int i = target[axis];
      const ConditionType type = experiment_.faces[axis][i <= 0 ? 0 : 1].type;
      Fold fold{field, index, index, axis, i <= 0 ? 0 : 1, 0};
      if (type == ConditionType::periodic) {
        if (i >= 0 && i < cells) continue;
        target[axis] = ((i % cells) + cells) % cells;
        fold.side = -1;
      } else if (folds(type) && (i <= 0 || i >= cells)) {
        target[axis] = i <= 0 ? -i : 2 * cells - i;
      } else {
        continue;
      }
      if (fields_[field][index].mass <= 0) continue;
      fold.mirror = this->index(target);
      if (type == ConditionType::separate && !approaches_wall(fold, dt)) continue;
      if (fold.mirror != index)
        fold_node(fold, time, remap);
      else if (!remap)
        fold_onto_itself(fields_[field][index], axis);
    }
}

void Grid::fold_node(Fold fold, double time, bool remap) {
  Node& ghost = fields_[fold.field][fold.ghost];
  fold.mass = ghost.mass;
  Node& node = fields_[fold.field][fold.mirror];
  const Vector wall = fold.side < 0 ? Vector(Vector::Zero()) : Vector(ghost.mass * wall_velocity(fold, time));
  node.mass += ghost.mass;
  node.momentum += wall + mirrored(ghost.momentum - wall, fold, type_of(fold));
  ghost.mass = 0;
  ghost.momentum = Vector::Zero();
  if (!remap) {
    node.volume += ghost.volume;
    node.volume_gradient += mirrored(ghost.volume_gradient, fold, ConditionType::slip);
    node.mass_position += mirrored(ghost.mass_position, fold, ConditionType::slip);
  }
  folds_.push_back(fold);
}

/// On the wall itself: the mirror image takes away what of the contact channels points across it.
void Grid::fold_onto_itself(Node& node, int axis) {
  node.volume_gradient[axis] = 0;
  node.mass_position[axis] = 0;
}

void Grid::fold_projection(std::optional<double> time) {
  for (const Fold& fold : folds_) {
    Vector& ghost = fields_[fold.field][fold.ghost].projected;
    const bool wall_moves = time && fold.side >= 0;
    const Vector wall = wall_moves ? Vector(fold.mass * wall_velocity(fold, *time)) : Vector(Vector::Zero());
    fields_[fold.field][fold.mirror].projected += wall + mirrored(ghost - wall, fold, type_of(fold));
    ghost = Vector::Zero();
  }
  for (auto& field : fields_)
    for (Node& node : field)
      node.projected = node.mass > 0 ? Vector(node.projected / node.mass) : Vector(Vector::Zero());
}

void Grid::fill_increment_ghosts() {
  for (auto fold = folds_.rbegin(); fold != folds_.rend(); ++fold)
    fields_[fold->field][fold->ghost].increment =
        mirrored(fields_[fold->field][fold->mirror].increment, *fold, type_of(*fold));
}

void Grid::fold_forces() {
  for (const Fold& fold : folds_) {
    Node& ghost = fields_[fold.field][fold.ghost];
    Node& node = fields_[fold.field][fold.mirror];
    for (Vector Node::*force : {&Node::internal_force, &Node::body_force, &Node::gravity_force}) {
      node.*force += mirrored(ghost.*force, fold, type_of(fold));
      ghost.*force = Vector::Zero();
    }
  }
}

void Grid::fill_ghosts(double time) {
  for (auto fold = folds_.rbegin(); fold != folds_.rend(); ++fold) {
    Node& ghost = fields_[fold->field][fold->ghost];
    const Node& node = fields_[fold->field][fold->mirror];
    const ConditionType type = type_of(*fold);
    const Vector wall = fold->side < 0 ? Vector(Vector::Zero()) : wall_velocity(*fold, time);
    ghost.velocity = wall + mirrored(node.velocity - wall, *fold, type);
    ghost.velocity_before = ghost.velocity - mirrored(node.velocity - node.velocity_before, *fold, type);
  }
}

Held Grid::held(std::size_t index, const Vector& predicted, double time) const {
  Held held;
  const Eigen::Vector3i& at = coordinates_[index];
  const Vector x = position(at);
  const auto evaluate = [&](const std::optional<VectorExpression>& velocity) {
    return velocity ? to_eigen((*velocity)({x[0], x[1], x[2]}, {x[0], x[1], x[2]}, time)) : Vector(Vector::Zero());
  };
  const auto hold = [&](int component, const Vector& velocity) {
    held.component[component] = true;
    held.velocity[component] = velocity[component];
  };
  for (int axis = 0; axis < experiment_.dimension; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const FaceCondition& face = experiment_.faces[axis][side];
      if (at[axis] != (side == 0 ? 0 : experiment_.grid.cells[axis])) continue;
      // A separating wall holds what moves into it, at every imposition: contact may have turned the velocity.
      if (face.type == ConditionType::separate && (side == 0 ? predicted[axis] >= 0 : predicted[axis] <= 0)) continue;
      const Vector velocity = evaluate(face.velocity);
      for (int c = 0; c < experiment_.dimension; ++c)
        if (holds(face.type, axis, c)) hold(c, velocity);
    }
  }
  const double tolerance = 1e-9 * experiment_.grid.cell_size;
  for (const BoxCondition& box : experiment_.boxes) {
    bool inside = true;
    for (int c = 0; c < experiment_.dimension; ++c)
      inside = inside && x[c] >= box.lower[c] - tolerance && x[c] <= box.upper[c] + tolerance;
    if (!inside) continue;
    const Vector velocity = evaluate(box.velocity);
    for (int c = 0; c < experiment_.dimension; ++c) {
      const bool holds = box.type == ConditionType::stick || (box.type == ConditionType::slip && c == box.axis) ||
                         (box.type == ConditionType::separate && c == box.axis && box.side * predicted[c] < 0) ||
                         (box.type == ConditionType::prescribed && box.held[c]);
      if (holds) hold(c, velocity);
    }
  }
  return held;
}

}  // namespace mpm::reference

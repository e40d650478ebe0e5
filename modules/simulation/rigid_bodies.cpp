#include "simulation/rigid_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "operators/supports.hpp"
#include "simulation/boundary.hpp"
#include "simulation/rigid_place.hpp"

namespace mpm {
namespace {

constexpr double deepest = 4;        // cells: what lies deeper in a rigid body has gone through it
constexpr int block_side = 8;        // nodes of a block that is looked at as a whole
constexpr double difference = 1e-4;  // cells, over which the normal is found

Vector3 minus(const Vector3& u, const Vector3& v) {
  return {u[0] - v[0], u[1] - v[1], u[2] - v[2]};
}
Vector3 cross(const Vector3& u, const Vector3& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}
double dot(const Vector3& u, const Vector3& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}
using Rotation = std::array<Vector3, 3>;
Vector3 turned(const Rotation& rotation, const Vector3& x) {
  return {dot(rotation[0], x), dot(rotation[1], x), dot(rotation[2], x)};
}
Vector3 turned_back(const Rotation& rotation, const Vector3& x) {
  Vector3 result{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t c = 0; c < 3; ++c) result[c] += rotation[row][c] * x[row];
  return result;
}
/// The rotation `first` followed by `then`.
Rotation product(const Rotation& then, const Rotation& first) {
  Rotation result{};
  for (std::size_t row = 0; row < 3; ++row) result[row] = turned_back(first, then[row]);
  return result;
}

}  // namespace

Vector3 RigidState::force_on(const Reaction& reaction) const {
  return {-reaction.force[0], -reaction.force[1], -reaction.force[2]};
}

Vector3 RigidState::torque_on(const Reaction& reaction) const {
  return minus(cross(acted_at, reaction.force), reaction.moment);
}

Vector3 RigidMotion::velocity_at(const Vector3& arm) const {
  const Vector3 turning = cross(spin, arm);
  return {velocity[0] + turning[0], velocity[1] + turning[1], velocity[2] + turning[2]};
}

void RigidGiven::give(const Vector3& x, const Vector3& given, const Vector3& velocity) {
  add_impulse(impulse.data(), moment.data(), x.data(), given.data(), 1);
  driven += dot(given, velocity);
}

void RigidGiven::count(std::int32_t status, double separation, double heat) {
  dissipated += heat;
  sticking += status == MPM_STICKS;
  slipping += status == MPM_SLIPS;
  if (status != MPM_APART) largest_penetration = std::max(largest_penetration, -separation);
}

void RigidGiven::add(const RigidGiven& other) {
  for (std::size_t c = 0; c < 3; ++c) impulse[c] += other.impulse[c], moment[c] += other.moment[c];
  dissipated += other.dissipated, driven += other.driven;
  sticking += other.sticking, slipping += other.slipping;
  largest_penetration = std::max(largest_penetration, other.largest_penetration);
}

void RigidGiven::add_to(ContactRecord& record) const {
  record.nodes += sticking + slipping;
  record.sticking += sticking, record.slipping += slipping;
  record.largest_penetration = std::max(record.largest_penetration, largest_penetration);
}

RigidBodies::RigidBodies(const Experiment& experiment)
    : experiment_(experiment),
      states_(experiment.rigid_bodies.size()),
      nodes_(states_.size()),
      has_moved_(states_.size()) {
  for (std::size_t k = 0; k < states_.size(); ++k)
    states_[k].place = states_[k].acted_at = experiment.rigid_bodies[k].about;
}

void RigidBodies::resume(std::vector<RigidState> states) {
  states_ = std::move(states);
  found_ = false;
}

Vector3 RigidBodies::place_of(const std::array<int, 3>& node) const {
  Vector3 x{};
  for (int c = 0; c < experiment_.dimension; ++c)
    x[c] = experiment_.grid.lower[c] + experiment_.grid.cell_size * node[static_cast<std::size_t>(c)];
  return x;
}

Vector3 place_at_start(const RigidBodySpecification& body, const RigidState& state, const Vector3& x) {
  Vector3 X = turned_back(state.rotation, minus(x, state.place));
  for (std::size_t c = 0; c < 3; ++c) X[c] += body.about[c];
  return X;
}

Vector3 RigidBodies::at_start(std::size_t body, const Vector3& x) const {
  return place_at_start(experiment_.rigid_bodies[body], states_[body], x);
}

double RigidBodies::distance(std::size_t body, const Vector3& x) const {
  return experiment_.rigid_bodies[body].geometry->distance(at_start(body, x));
}

void RigidBodies::begin_step() {
  for (std::size_t k = 0; k < states_.size(); ++k) {
    states_[k].acted_at = states_[k].place;
    has_moved_[k] = !found_ || experiment_.rigid_bodies[k].moves();
    if (has_moved_[k]) find_nodes(k);
  }
  found_ = true;
}

/// Blocks whose middle is farther from the surface than any of their nodes could make up for are passed over: a distance is
/// never more than how far the surface is.
void RigidBodies::find_nodes(std::size_t body) {
  nodes_[body].clear();
  const int D = experiment_.dimension, padding = grid_padding_of(experiment_.shape.plugin->shape());
  const double h = experiment_.grid.cell_size, half_diagonal = 0.5 * h * (block_side - 1) * std::sqrt(D);
  std::array<int, 3> blocks{1, 1, 1}, block{};
  for (int c = 0; c < D; ++c) blocks[c] = (experiment_.grid.cells[c] + 2 * padding) / block_side + 1;
  const auto for_each = [&](auto&& visit) {
    for (block[2] = 0; block[2] < blocks[2]; ++block[2])
      for (block[1] = 0; block[1] < blocks[1]; ++block[1])
        for (block[0] = 0; block[0] < blocks[0]; ++block[0]) visit();
  };
  for_each([&] {
    std::array<int, 3> first{}, end{1, 1, 1};
    for (int c = 0; c < D; ++c) {
      first[c] = block[c] * block_side - padding;
      end[c] = std::min(first[c] + block_side, experiment_.grid.cells[c] + padding + 1);
    }
    Vector3 middle = place_of(first);
    for (int c = 0; c < D; ++c) middle[c] += 0.5 * h * (block_side - 1);
    const double from_surface = distance(body, middle);
    if (from_surface > rigid_reach * h + half_diagonal || from_surface < -deepest * h - half_diagonal) return;
    std::array<int, 3> node{};
    for (node[2] = first[2]; node[2] < end[2]; ++node[2])
      for (node[1] = first[1]; node[1] < end[1]; ++node[1])
        for (node[0] = first[0]; node[0] < end[0]; ++node[0]) look_at(body, node);
  });
}

/// Lists a node that is near enough. Where the distance has no slope, in the middle of a body, there is no normal.
void RigidBodies::look_at(std::size_t body, const std::array<int, 3>& node) {
  const double h = experiment_.grid.cell_size, e = difference * h;
  const Vector3 x = place_of(node), X = at_start(body, x);
  const Geometry& geometry = *experiment_.rigid_bodies[body].geometry;
  RigidNode found{node, {geometry.distance(X), {}}, minus(x, states_[body].place)};
  if (found.surface.distance > rigid_reach * h || found.surface.distance < -deepest * h) return;
  Vector3 slope{};
  for (int c = 0; c < experiment_.dimension; ++c) {
    Vector3 above = X, below = X;
    above[c] += e, below[c] -= e;
    slope[c] = (geometry.distance(above) - geometry.distance(below)) / (2 * e);
  }
  const double size = std::sqrt(dot(slope, slope));
  if (size < 0.1) return;
  const Vector3 outward = turned(states_[body].rotation, slope);
  for (std::size_t c = 0; c < 3; ++c) found.surface.normal[c] = -outward[c] / size;
  nodes_[body].push_back(found);
}

RigidMotion RigidBodies::motion(std::size_t body, double time) const {
  const RigidBodySpecification& specification = experiment_.rigid_bodies[body];
  return {specification.velocity({}, {}, time), specification.spin_at(time, experiment_.dimension)};
}

double RigidBodies::around(const RigidNode& node) const {
  return experiment_.axisymmetric() ? around_axis(place(node)[0]) : 1.0;
}

void RigidBodies::end_step(const StepInfo& step) {
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const RigidMotion now = motion(k, step.time + step.dt);
    RigidState& state = states_[k];
    for (std::size_t c = 0; c < 3; ++c) state.place[c] += step.dt * now.velocity[c];
    const double rate = std::sqrt(dot(now.spin, now.spin));
    if (rate > 0) state.rotation = product(rotation_about(now.spin, rate * step.dt), state.rotation);
  }
}

}  // namespace mpm

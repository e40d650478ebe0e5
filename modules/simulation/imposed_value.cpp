#include "simulation/imposed_value.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "experiment/diagnostics.hpp"
#include "simulation/failure.hpp"
#include "simulation/formula_problem.hpp"

namespace mpm {
namespace {

/// The nodes of the domain between two corners, both included.
struct Nodes {
  std::array<int, 3> first{}, last{};
};

/// The value of a condition that is none, with the name of its quantity.
ImposedValue named(const ThermalCondition& condition) {
  switch (condition.exchange) {
    case HeatExchange::flux:
      return {condition.pointer, "heat flux", "W/m^2"};
    case HeatExchange::heating:
      return {condition.pointer, "heating", "W"};
    case HeatExchange::convection:
      return {condition.pointer + "/temperature", "temperature", "K"};
    default:
      return {condition.pointer, "temperature", "K"};
  }
}

/// Calls look(row) with the nodes of each row along x until it finds something. On axes along which the formula does not
/// vary one node stands for all.
template <class Varies, class Look>
std::optional<ImposedValue> look_in_rows(const Experiment& experiment, Nodes nodes, Varies varies, Look look) {
  const GridSpecification& grid = experiment.grid;
  for (int c = 0; c < 3; ++c)
    if (!varies(c)) nodes.last[c] = nodes.first[c];
  std::vector<Vector3> row(static_cast<std::size_t>(nodes.last[0] - nodes.first[0] + 1));
  for (int k = nodes.first[2]; k <= nodes.last[2]; ++k)
    for (int j = nodes.first[1]; j <= nodes.last[1]; ++j) {
      for (std::size_t n = 0; n < row.size(); ++n) {
        const std::array node{nodes.first[0] + static_cast<int>(n), j, k};
        for (int c = 0; c < experiment.dimension; ++c) row[n][c] = grid.lower[c] + grid.cell_size * node[c];
      }
      if (auto found = look(std::span<const Vector3>(row))) return found;
    }
  return std::nullopt;
}

std::vector<double> place_of(const Experiment& experiment, const Vector3& x) {
  return {x.begin(), x.begin() + experiment.dimension};
}

std::optional<ImposedValue> look(const Experiment& experiment, const ThermalCondition& condition, const Nodes& nodes,
                                 double time) {
  const bool warms = condition.exchange == HeatExchange::flux || condition.exchange == HeatExchange::heating;
  std::vector<double> values;
  const auto in_row = [&](std::span<const Vector3> row) -> std::optional<ImposedValue> {
    values.resize(row.size());
    condition.value.evaluate(row, time, values.data());
    for (std::size_t n = 0; n < row.size(); ++n) {
      if (std::isfinite(values[n]) && (warms || values[n] >= 0)) continue;
      ImposedValue found = named(condition);
      found.value = values[n], found.time = time, found.position = place_of(experiment, row[n]);
      if (const auto wrong = condition.value.not_finite(row[n], row[n], time)) found.why = wrong->why;
      return found;
    }
    return std::nullopt;
  };
  return look_in_rows(
      experiment, nodes, [&](int axis) { return condition.value.varies(axis); }, in_row);
}

/// A velocity that the file gives walls or boxes.
struct ImposedVelocity {
  const VectorExpression& value;
  std::string pointer;
  const std::array<bool, 3>& held;
};

std::optional<ImposedValue> look(const Experiment& experiment, const ImposedVelocity& velocity, const Nodes& nodes,
                                 double time) {
  std::vector<Vector3> values;
  const auto in_row = [&](std::span<const Vector3> row) -> std::optional<ImposedValue> {
    values.resize(row.size());
    for (std::size_t n = velocity.value.evaluate(row, row, time, values); n < row.size(); ++n)
      if (auto found =
              impossible_velocity(experiment, velocity.value, velocity.pointer, velocity.held, row[n], row[n], time))
        return found;
    return std::nullopt;
  };
  const auto varies = [&](int axis) {
    return velocity.value.varies(0, axis) || velocity.value.varies(1, axis) || velocity.value.varies(2, axis);
  };
  return look_in_rows(experiment, nodes, varies, in_row);
}

Nodes nodes_of_wall(const Experiment& experiment, int axis, int side) {
  Nodes nodes;
  for (int c = 0; c < experiment.dimension; ++c) nodes.last[c] = experiment.grid.cells[c];
  nodes.first[axis] = nodes.last[axis] = side == 0 ? 0 : experiment.grid.cells[axis];
  return nodes;
}

/// The nodes of the domain in a box; along an axis without one the last comes before the first.
Nodes nodes_of_box(const Experiment& experiment, const BoxCondition& box) {
  const GridSpecification& grid = experiment.grid;
  Nodes nodes;
  for (int c = 0; c < experiment.dimension; ++c) {
    const auto cells_to = [&](double x) {
      return std::clamp((x - grid.lower[c]) / grid.cell_size, -1.0, grid.cells[c] + 1.0);
    };
    nodes.first[c] = std::max(0, static_cast<int>(std::ceil(cells_to(box.lower[c]) - 1e-9)));
    nodes.last[c] = std::min(grid.cells[c], static_cast<int>(std::floor(cells_to(box.upper[c]) + 1e-9)));
  }
  return nodes;
}

std::optional<ImposedValue> impossible_gravity(const Experiment& experiment, double time) {
  const Vector3 gravity = experiment.gravity_at(time);
  for (int c = 0; c < experiment.dimension; ++c) {
    if (std::isfinite(gravity[c])) continue;
    ImposedValue found{pointer_of("/gravity", true, c), "gravity", "m/s^2", gravity[c], time};
    if (const auto wrong = experiment.changing_gravity->not_finite({}, {}, time)) found.why = wrong->why;
    return found;
  }
  return std::nullopt;
}

/// A velocity of a rigid body that is not finite.
std::optional<ImposedValue> impossible_motion(const Experiment& experiment, double time, bool changing) {
  static constexpr std::array<bool, 3> all{true, true, true};
  for (const RigidBodySpecification& body : experiment.rigid_bodies)
    for (const bool turns : {false, true}) {
      const VectorExpression& value = turns ? body.angular_velocity : body.velocity;
      const std::string pointer = body.pointer + (turns ? "/angular_velocity" : "/velocity");
      if (changing && !value.uses_time()) continue;
      auto found = impossible_velocity(experiment, value, pointer, all, {}, {}, time);
      if (!found) continue;
      found->position.clear();  // it is the same everywhere
      if (turns) found->name = "angular velocity", found->unit = "rad/s";
      if (turns && experiment.dimension == 2) found->pointer = pointer;  // a number is no list
      return found;
    }
  return std::nullopt;
}

/// The first value of the conditions of walls and boxes that nothing can have: check(condition, nodes) looks at one.
template <class Check>
std::optional<ImposedValue> first_of_conditions(const Experiment& experiment, Check check) {
  for (int axis = 0; axis < experiment.dimension; ++axis)
    for (int side = 0; side < 2; ++side)
      if (auto found = check(experiment.faces[axis][side], nodes_of_wall(experiment, axis, side))) return found;
  for (const BoxCondition& box : experiment.boxes) {
    const Nodes nodes = nodes_of_box(experiment, box);
    bool any = true;
    for (int c = 0; c < experiment.dimension; ++c) any = any && nodes.first[c] <= nodes.last[c];
    if (!any) continue;
    if (auto found = check(box, nodes)) return found;
  }
  return std::nullopt;
}

/// Which components a condition's velocity holds.
const std::array<bool, 3>& held_by(const FaceCondition&) {
  static constexpr std::array<bool, 3> all{true, true, true};
  return all;
}
const std::array<bool, 3>& held_by(const BoxCondition& box) {
  return box.held;
}

std::optional<ImposedValue> impossible_condition(const Experiment& experiment, double time, bool changing) {
  return first_of_conditions(experiment, [&](const auto& condition, const Nodes& nodes) -> std::optional<ImposedValue> {
    const ThermalCondition& thermal = condition.thermal;
    if (condition.velocity && (!changing || condition.velocity->uses_time())) {
      const ImposedVelocity velocity{*condition.velocity, condition.pointer + "/velocity", held_by(condition)};
      if (auto found = look(experiment, velocity, nodes, time)) return found;
    }
    if (thermal.exchange != HeatExchange::none && (!changing || thermal.value.uses_time()))
      return look(experiment, thermal, nodes, time);
    return std::nullopt;
  });
}

}  // namespace

std::optional<ImposedValue> impossible_value(const Experiment& experiment, const StepTimes& times, bool changing) {
  if (!changing || experiment.changing_gravity)
    if (auto found = impossible_gravity(experiment, times.start)) return found;
  if (auto found = impossible_motion(experiment, times.end, changing)) return found;
  return impossible_condition(experiment, times.end, changing);
}

bool imposes_by_time(const Experiment& experiment) {
  const auto by_time = [](const auto& condition) {
    return (condition.velocity && condition.velocity->uses_time()) ||
           (condition.thermal.exchange != HeatExchange::none && condition.thermal.value.uses_time());
  };
  for (const auto& sides : experiment.faces)
    if (std::any_of(sides.begin(), sides.end(), by_time)) return true;
  for (const RigidBodySpecification& body : experiment.rigid_bodies)
    if (body.velocity.uses_time() || body.angular_velocity.uses_time()) return true;
  return experiment.changing_gravity || std::any_of(experiment.boxes.begin(), experiment.boxes.end(), by_time);
}

std::optional<ImposedValue> impossible_velocity(const Experiment& experiment, const VectorExpression& velocity,
                                                const std::string& pointer, const std::array<bool, 3>& held,
                                                const Vector3& x, const Vector3& X, double time) {
  const Vector3 value = velocity(x, X, time);
  for (int c = 0; c < experiment.dimension; ++c) {
    if (!held[c] || std::isfinite(value[c])) continue;
    ImposedValue found{pointer_of(pointer, true, c), std::string("velocity along ") + "xyz"[c], "m/s", value[c], time,
                       place_of(experiment, x)};
    if (const auto wrong = velocity.not_finite(x, X, time)) found.why = wrong->why;
    return found;
  }
  return std::nullopt;
}

Problem problem_of(const Experiment& experiment, const ImposedValue& imposed) {
  const std::string at =
      "t = " + number_text(imposed.time) + " s" + (imposed.position.empty() ? "" : ", " + point_text(imposed.position));
  return problem_at(experiment, imposed.pointer,
                    std::isfinite(imposed.value) ? "is " + number_text(imposed.value) + " " + imposed.unit +
                                                       ", below 0 " + imposed.unit + ", at " + at
                                                 : not_finite_text(at, imposed.why));
}

void stop_at_impossible_value(const Experiment& experiment, const StepTimes& times) {
  if (auto found = impossible_value(experiment, times, true)) throw ImposedValueFailure(experiment, std::move(*found));
}

}  // namespace mpm

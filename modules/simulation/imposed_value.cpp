#include "simulation/imposed_value.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/diagnostics.hpp"
#include "simulation/failure.hpp"

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

/// Looks along the axes that the formula names; on the others one node stands for all.
std::optional<ImposedValue> look(const Experiment& experiment, const ThermalCondition& condition, Nodes nodes,
                                 double time) {
  const GridSpecification& grid = experiment.grid;
  const bool warms = condition.exchange == HeatExchange::flux || condition.exchange == HeatExchange::heating;
  for (int c = 0; c < 3; ++c)
    if (!condition.value.varies(c)) nodes.last[c] = nodes.first[c];
  std::vector<Vector3> row(static_cast<std::size_t>(nodes.last[0] - nodes.first[0] + 1));
  std::vector<double> values(row.size());
  for (int k = nodes.first[2]; k <= nodes.last[2]; ++k)
    for (int j = nodes.first[1]; j <= nodes.last[1]; ++j) {
      for (std::size_t n = 0; n < row.size(); ++n) {
        const std::array node{nodes.first[0] + static_cast<int>(n), j, k};
        for (int c = 0; c < experiment.dimension; ++c) row[n][c] = grid.lower[c] + grid.cell_size * node[c];
      }
      condition.value.evaluate(row, time, values.data());
      for (std::size_t n = 0; n < row.size(); ++n) {
        if (std::isfinite(values[n]) && (warms || values[n] >= 0)) continue;
        ImposedValue found = named(condition);
        found.value = values[n], found.time = time;
        found.position.assign(row[n].begin(), row[n].begin() + experiment.dimension);
        return found;
      }
    }
  return std::nullopt;
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
  for (int c = 0; c < experiment.dimension; ++c)
    if (!std::isfinite(gravity[c])) return ImposedValue{"/gravity", "gravity", "m/s^2", gravity[c], time};
  return std::nullopt;
}

std::optional<ImposedValue> impossible_heat(const Experiment& experiment, double time, bool changing) {
  const auto counts = [&](const ThermalCondition& condition) {
    return condition.exchange != HeatExchange::none && (!changing || condition.value.uses_time());
  };
  for (int axis = 0; axis < experiment.dimension; ++axis)
    for (int side = 0; side < 2; ++side)
      if (const ThermalCondition& wall = experiment.faces[axis][side].thermal; counts(wall))
        if (auto found = look(experiment, wall, nodes_of_wall(experiment, axis, side), time)) return found;
  for (const BoxCondition& box : experiment.boxes) {
    if (!counts(box.thermal)) continue;
    const Nodes nodes = nodes_of_box(experiment, box);
    bool any = true;
    for (int c = 0; c < experiment.dimension; ++c) any = any && nodes.first[c] <= nodes.last[c];
    if (!any) continue;
    if (auto found = look(experiment, box.thermal, nodes, time)) return found;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ImposedValue> impossible_value(const Experiment& experiment, const StepTimes& times, bool changing) {
  if (!changing || experiment.changing_gravity)
    if (auto found = impossible_gravity(experiment, times.start)) return found;
  if (experiment.has_temperature()) return impossible_heat(experiment, times.end, changing);
  return std::nullopt;
}

std::string text_of(const ImposedValue& imposed) {
  const std::string wrong = std::isfinite(imposed.value) ? "is " + number_text(imposed.value) + " " + imposed.unit +
                                                               ", below 0 " + imposed.unit + ","
                                                         : "is not a finite number";
  return wrong + " at t = " + number_text(imposed.time) + " s" +
         (imposed.position.empty() ? "" : ", " + point_text(imposed.position));
}

void stop_at_impossible_value(const Experiment& experiment, const StepTimes& times) {
  if (auto found = impossible_value(experiment, times, true)) throw ImposedValueFailure(std::move(*found));
}

}  // namespace mpm

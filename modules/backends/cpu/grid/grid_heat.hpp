#pragma once
// GridStep with temperature: heat to temperature, rates of conduction, walls and boxes, and the heat's ledger. Heat and
// its capacity lie in the first and the last scalar of a node's group, where the temperature takes the heat's place.

#include <numbers>

#include "backends/cpu/grid/grid_step.hpp"
#include "operators/heat.hpp"

namespace mpm::cpu {

/// Nothing but a wall that is held at a temperature has one of its own.
template <int D, class T>
Quad<T> GridStep<D, T>::wall_temperature(const FaceCondition& face, const Vector3& x, double time) const {
  Q result{};
  if (holds_temperature(face)) result[0] = static_cast<T>(face.thermal.value(x, x, time));
  return result;
}

/// Sum of the nodes' heat in doubles; each T becomes change(T, heat capacity, number of the node among all fields').
template <int D, class T>
template <class Change>
double GridStep<D, T>::for_each_temperature(Change&& change) {
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    Q* const nodes = &grid_.quad(heat, field, first);
    for (int k = 0; k < block_nodes; ++k) {
      const T capacity = nodes[k][3];
      if (capacity > T(0)) nodes[k][0] = change(nodes[k][0], capacity, field, first + static_cast<std::uint32_t>(k));
      partial[0] += static_cast<double>(capacity) * nodes[k][0];
    }
  });
  return sum_partials(0);
}

template <int D, class T>
void GridStep<D, T>::heat_to_temperature(const StepInfo& step) {
  const double sum =
      for_each_temperature([](T of_node, T capacity, int, std::uint32_t) { return temperature_of(of_node, capacity); });
  heat_ledger_.scatter += sum - heat_of_folds_ - particle_heat_;
  heat_ledger_.walls += heat_of_folds_;
  impose_temperatures(step.time);
  fill_temperature_ghosts(step.time);
  if (grid_.has(temperature_before)) copy_velocity(heat, temperature_before);
}

/// Rates of conduction have come from the particles; those of walls and boxes join them.
template <int D, class T>
void GridStep<D, T>::apply_heat(const StepInfo& step) {
  const double end = step.time + step.dt;
  rate_of_folds_ = 0;
  for (const bool periodic : {true, false}) fold_forces(periodic);
  heat_ledger_.walls += step.dt * rate_of_folds_;
  for (const FaceNodes& face : grid_.faces())
    if (passes_heat(*face.condition)) heat_through(face, end, step.dt);
  for (const BoxNodes& box : grid_.boxes())
    if (box.condition->thermal.exchange == HeatExchange::heating) heat_box(box, end, step.dt);
  const T dt = static_cast<T>(step.dt);
  for_each_temperature([&](T temperature, T capacity, int field, std::uint32_t node) {
    return warmed(temperature, grid_.quad(heat_rate, field, node)[0], capacity, dt);
  });
  impose_temperatures(end);
  heat_after_ = for_each_temperature([](T temperature, T, int, std::uint32_t) { return temperature; });
  fill_temperature_ghosts(end);
  if (!grid_.has(temperature_before)) return;
  for_each_block([&](int field, std::uint32_t first, double*) {
    const Q* const after = &grid_.quad(heat, field, first);
    Q* const before = &grid_.quad(temperature_before, field, first);
    for (int k = 0; k < block_nodes; ++k) before[k][0] = after[k][0] - before[k][0];
  });
}

/// A flux, or what convection makes of the temperature at the wall, through the area that each node on it stands for.
template <int D, class T>
void GridStep<D, T>::heat_through(const FaceNodes& face, double time, double dt) {
  const ThermalCondition& condition = face.condition->thermal;
  const bool convects = condition.exchange == HeatExchange::convection;
  double& entry = convects ? heat_ledger_.convection : heat_ledger_.flux;
  std::vector<std::uint32_t> inward(wall_shares_.size());
  for (std::size_t i = 0; i < face.wall.size(); ++i) {
    const Vector3& x = face.wall_position[i];
    const double circumference = scene_.axisymmetric ? 2 * std::numbers::pi * x[0] : 1.0;
    std::array<int, 3> node{};
    for (int a = 0; a < D; ++a)
      node[a] = static_cast<int>(std::lround((x[a] - scene_.domain.lower[a]) / scene_.domain.cell_size));
    for (std::uint32_t& number : inward) {
      number = static_cast<std::uint32_t>(grid_.find(node));
      node[face.axis] += face.side == 0 ? 1 : -1;
    }
    const double given = condition.value(x, x, time);
    for (int field = 0; field < grid_.fields(); ++field) {
      const double volume = grid_.quad(heated_volume, field, face.wall[i])[0];
      const double area = area_of_wall_node(volume, scene_.domain.cell_size, circumference);
      const auto share = [&](std::size_t k) {
        return static_cast<std::int32_t>(inward[k]) >= 0 && grid_.quad(heat, field, inward[k])[3] > T(0)
                   ? wall_shares_[k]
                   : 0.0;
      };
      double flux = given;
      if (convects) {
        double at_wall = 0;
        for (std::size_t k = 0; k < inward.size(); ++k)
          if (share(k) > 0) at_wall += share(k) * grid_.quad(heat, field, inward[k])[0];
        flux = condition.coefficient * (given - at_wall);
      }
      for (std::size_t k = 0; k < inward.size(); ++k) {
        if (!(share(k) > 0)) continue;
        grid_.quad(heat_rate, field, inward[k])[0] += static_cast<T>(flux * area * share(k));
        entry += dt * flux * area * share(k);
      }
    }
  }
}

/// The nodes share the power by their mass.
template <int D, class T>
void GridStep<D, T>::heat_box(const BoxNodes& box, double time, double dt) {
  double mass = 0;
  for (int field = 0; field < grid_.fields(); ++field)
    for (const std::uint32_t node : box.nodes) mass += motion_at(field, node)[3];
  if (!(mass > 0)) return;
  for (int field = 0; field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < box.nodes.size(); ++i) {
      const double of_node = motion_at(field, box.nodes[i])[3];
      if (!(of_node > 0)) continue;
      const double rate = box.condition->thermal.value(box.position[i], box.position[i], time) * of_node / mass;
      grid_.quad(heat_rate, field, box.nodes[i])[0] += static_cast<T>(rate);
      heat_ledger_.boxes += dt * rate;
    }
}

template <int D, class T>
void GridStep<D, T>::impose_temperatures(double time) {
  const auto hold_at = [&](std::uint32_t node, const Vector3& x, const ThermalCondition& condition, double& entry) {
    const T held = static_cast<T>(condition.value(x, x, time));
    for (int field = 0; field < grid_.fields(); ++field) {
      Q& of_node = grid_.quad(heat, field, node);
      if (!(of_node[3] > T(0))) continue;
      entry += static_cast<double>(of_node[3]) * (static_cast<double>(held) - of_node[0]);
      of_node[0] = held;
    }
  };
  for (const FaceNodes& face : grid_.faces())
    for (std::size_t i = 0; holds_temperature(*face.condition) && i < face.wall.size(); ++i)
      hold_at(face.wall[i], face.wall_position[i], face.condition->thermal, heat_ledger_.walls);
  for (const BoxNodes& box : grid_.boxes())
    for (std::size_t i = 0; box.condition->thermal.exchange == HeatExchange::fixed_temperature && i < box.nodes.size();
         ++i)
      hold_at(box.nodes[i], box.position[i], box.condition->thermal, heat_ledger_.boxes);
}

template <int D, class T>
void GridStep<D, T>::fill_temperature_ghosts(double time) {
  auto& faces = grid_.faces();
  for (auto face = faces.rbegin(); face != faces.rend(); ++face) {
    const T sign = mirror_signs(*face, AtWall::heat)[0];
    for_each_folded(*face, [&](int field, const MirrorPair& pair) {
      const T of_wall = wall_temperature(*face->condition, pair.foot, time)[0];
      grid_.quad(heat, field, pair.ghost)[0] = mirrored(grid_.quad(heat, field, pair.mirror)[0], sign, of_wall);
    });
  }
}

}  // namespace mpm::cpu

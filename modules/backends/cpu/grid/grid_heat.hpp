#pragma once
// This part of GridStep treats temperature: heat, rates of conduction, walls and boxes, and the heat's ledger. Heat and
// its capacity lie in the first and the last scalar of a node's group, where the temperature takes the heat's place.

#include <numbers>

#include "backends/cpu/grid/grid_step.hpp"
#include "operators/heat.hpp"

namespace mpm::cpu {

/// The number of the node at a place, or of one that lies `cells` farther along an axis; ~0 where no block is.
template <int D, class T>
std::uint32_t GridStep<D, T>::node_at_place(const Vector3& x, int axis, int cells) const {
  std::array<int, 3> node{};
  for (int a = 0; a < D; ++a)
    node[a] = static_cast<int>(std::lround((x[a] - scene_.domain.lower[a]) / scene_.domain.cell_size));
  node[axis] += cells;
  return static_cast<std::uint32_t>(grid_.find(node));
}

/// The flux into a body at a node of the wall which it reaches, W/m^2. Convection goes by the temperature there, which is
/// that of nodes whose heat is `divided`, or what it will be when this has been folded and divided.
template <int D, class T>
double GridStep<D, T>::flux_through(const FaceNodes& face, int field, const Vector3& x, double time, bool divided) {
  const ThermalCondition& condition = face.condition->thermal;
  const double given = condition.value(x, x, time);
  if (condition.exchange == HeatExchange::flux) return given;
  const Q volume = grid_.quad(heated_volume, field, node_at_place(x, face.axis, 0));
  const double conductivity = static_cast<double>(volume[3]) / volume[0], h = scene_.domain.cell_size;
  double at_wall = 0, beyond = wall_weights_.beyond * h;
  for (std::size_t k = 0; k < wall_weights_.shares.size(); ++k) {
    const int inward = face.side == 0 ? static_cast<int>(k) : -static_cast<int>(k);
    const std::uint32_t next = node_at_place(x, face.axis, inward), ghost = node_at_place(x, face.axis, -inward);
    if (next == ~0u) continue;
    const Q of_next = grid_.quad(heat, field, next);
    if (divided) {
      at_wall += wall_weights_.shares[k] * of_next[0];
      continue;
    }
    // Folding adds the ghost's heat, and what a gradient makes of its image; the wall's node has half of its own.
    double sum = of_next[0], capacity = of_next[3], image = 0;
    if (k == 0) {
      image = 0.5 * heat_beyond_wall(1.0, 0.0, 0.0, capacity_inward(face, field, next));
    } else if (ghost != ~0u) {
      const Q of_ghost = grid_.quad(heat, field, ghost);
      sum += of_ghost[0], capacity += of_ghost[3];
      image = heat_beyond_wall(1.0, static_cast<double>(k) * h, static_cast<double>(of_ghost[3]),
                               capacity_inward(face, field, ghost));
    }
    if (!(capacity > 0)) continue;
    at_wall += wall_weights_.shares[k] * sum / capacity;
    beyond -= wall_weights_.shares[k] * image / capacity;
  }
  return convected_flux(condition.coefficient, given, at_wall, beyond, conductivity);
}

/// The gradient inward at a node of a wall that heat comes through, K/m; else zero.
template <int D, class T>
double GridStep<D, T>::gradient_at(const FaceNodes& face, int field, const Vector3& x, double time, bool divided) {
  if (!passes_heat(*face.condition)) return 0;
  const std::uint32_t node = node_at_place(x, face.axis, 0);
  if (node == ~0u) return 0;
  const Q volume = grid_.quad(heated_volume, field, node);
  if (!(volume[0] > T(0))) return 0;
  return -flux_through(face, field, x, time, divided) * volume[0] / volume[3];
}

/// Finds the gradients at the walls of an axis that heat comes through before anything is folded along it.
template <int D, class T>
void GridStep<D, T>::find_gradients(int axis, double time) {
  gradients_.assign(static_cast<std::size_t>(grid_.fields()), {});
  for (const FaceNodes& face : grid_.faces())
    for (int field = 0; face.axis == axis && passes_heat(*face.condition) && field < grid_.fields(); ++field)
      for (std::size_t i = 0; i < face.wall.size(); ++i)
        gradients_[field][face.wall[i]] = gradient_at(face, field, face.wall_position[i], time, false);
}

template <int D, class T>
double GridStep<D, T>::gradient_before_folds(const FaceNodes& face, int field, const Vector3& x) const {
  const auto found = gradients_[field].find(node_at_place(x, face.axis, 0));
  return found == gradients_[field].end() ? 0.0 : found->second;
}

template <int D, class T>
double GridStep<D, T>::capacity_inward(const FaceNodes& face, int field, std::uint32_t node) {
  if (!grid_.has(capacity_position)) return 0;
  const double along = grid_.quad(capacity_position, field, node)[face.axis];
  return face.side == 0 ? along : -along;
}

/// Folds heat with the capacity beside it: relative to what the wall's temperature makes of that, where it has one.
template <int D, class T>
void GridStep<D, T>::fold_heat(FaceNodes& face, std::size_t index, int field, double time) {
  const MirrorPair& pair = face.pairs[index];
  Q &ghost = grid_.quad(heat, field, pair.ghost), &mirror = grid_.quad(heat, field, pair.mirror);
  const T of_wall = holds_temperature(*face.condition)
                        ? static_cast<T>(face.condition->thermal.value(pair.foot, pair.foot, time))
                        : T(0);
  T folded = mirrored(ghost[0], mirror_signs(face, AtWall::heat)[0], ghost[3] * of_wall);
  if (passes_heat(*face.condition))
    folded += static_cast<T>(heat_beyond_wall(gradient_before_folds(face, field, pair.foot), pair.distance,
                                              static_cast<double>(ghost[3]), capacity_inward(face, field, pair.ghost)));
  const double change = static_cast<double>(folded) - ghost[0];
  heat_of_folds_ += change;
  mirror[0] += folded, mirror[3] += ghost[3];
  face.folded_capacity[field * face.pairs.size() + index] = ghost[3];
  ghost = Q{};
}

/// Folds heat on the wall itself, which is its own mirror and gets half of the image's share.
template <int D, class T>
void GridStep<D, T>::fold_heat_onto_itself(const FaceNodes& face, int field) {
  for (std::size_t i = 0; i < face.wall.size(); ++i) {
    Q& of_node = grid_.quad(heat, field, face.wall[i]);
    if (!(of_node[3] > T(0))) continue;
    const double change = 0.5 * heat_beyond_wall(gradient_before_folds(face, field, face.wall_position[i]), 0.0, 0.0,
                                                 capacity_inward(face, field, face.wall[i]));
    of_node[0] += static_cast<T>(change);
    heat_of_folds_ += change;
  }
}

/// Sums the nodes' heat in doubles; each T becomes change(T, heat capacity, number of the node among all fields').
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
  heat_ledger_.images += heat_of_folds_;
  double held = 0;
  impose_temperatures(step.time, held, held);
  heat_ledger_.images += held;
  beyond_ = fill_temperature_ghosts(step.time);
  heat_ledger_.images += beyond_.held + beyond_.others;
  if (grid_.has(temperature_before)) copy_velocity(heat, temperature_before);
}

/// Adds the rates of walls and boxes to those of conduction, which have come from the particles.
template <int D, class T>
void GridStep<D, T>::apply_heat(const StepInfo& step) {
  const double end = step.time + step.dt;
  rate_of_folds_ = 0;
  for (const bool periodic : {true, false}) fold_forces(periodic, step.time, step.dt);
  heat_ledger_.walls += step.dt * rate_of_folds_;
  for (const FaceNodes& face : grid_.faces())
    if (passes_heat(*face.condition)) heat_through(face, step.time, step.dt);
  for (const BoxNodes& box : grid_.boxes())
    if (box.condition->thermal.exchange == HeatExchange::heating) heat_box(box, step.time, step.dt);
  const T dt = static_cast<T>(step.dt);
  for_each_temperature([&](T temperature, T capacity, int field, std::uint32_t node) {
    return warmed(temperature, grid_.quad(heat_rate, field, node)[0], capacity, dt);
  });
  impose_temperatures(end, heat_ledger_.walls, heat_ledger_.boxes);
  heat_after_ = for_each_temperature([](T temperature, T, int, std::uint32_t) { return temperature; });
  const Beyond after = fill_temperature_ghosts(end);
  heat_ledger_.walls += after.held - beyond_.held;
  heat_ledger_.images += after.others - beyond_.others;
  heat_after_ += after.held + after.others;
  if (!grid_.has(temperature_before)) return;
  for_each_block([&](int field, std::uint32_t first, double*) {
    const Q* const after = &grid_.quad(heat, field, first);
    Q* const before = &grid_.quad(temperature_before, field, first);
    for (int k = 0; k < block_nodes; ++k) before[k][0] = after[k][0] - before[k][0];
  });
}

/// Lets heat through the area that each node on the wall stands for.
template <int D, class T>
void GridStep<D, T>::heat_through(const FaceNodes& face, double time, double dt) {
  double& entry = face.condition->thermal.exchange == HeatExchange::flux ? heat_ledger_.flux : heat_ledger_.convection;
  for (std::size_t i = 0; i < face.wall.size(); ++i) {
    const Vector3& x = face.wall_position[i];
    const double circumference = scene_.axisymmetric ? 2 * std::numbers::pi * x[0] : 1.0;
    for (int field = 0; field < grid_.fields(); ++field) {
      const double volume = grid_.quad(heated_volume, field, face.wall[i])[0];
      if (!(volume > 0)) continue;
      const double heat_of_node =
          flux_through(face, field, x, time, true) * area_of_wall_node(volume, scene_.domain.cell_size, circumference);
      for (std::size_t k = 0; k < wall_weights_.shares.size(); ++k) {
        const int inward = face.side == 0 ? static_cast<int>(k) : -static_cast<int>(k);
        const std::uint32_t node = node_at_place(x, face.axis, inward);
        if (node == ~0u || !(grid_.quad(heat, field, node)[3] > T(0))) continue;
        const T rate = static_cast<T>(heat_of_node * wall_weights_.shares[k]);
        grid_.quad(heat_rate, field, node)[0] += rate;
        entry += dt * rate;
      }
    }
  }
}

/// Heats a box, whose nodes share the power by their mass.
template <int D, class T>
void GridStep<D, T>::heat_box(const BoxNodes& box, double time, double dt) {
  double mass = 0;
  for (int field = 0; field < grid_.fields(); ++field)
    for (const std::uint32_t node : box.nodes) mass += motion_at(field, node)[3];
  if (!(mass > 0)) return;
  std::vector<double> heating(box.nodes.size());
  box.condition->thermal.value.evaluate(box.position, time, heating.data());
  for (int field = 0; field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < box.nodes.size(); ++i) {
      const double of_node = motion_at(field, box.nodes[i])[3];
      if (!(of_node > 0)) continue;
      const double rate = heating[i] * of_node / mass;
      grid_.quad(heat_rate, field, box.nodes[i])[0] += static_cast<T>(rate);
      heat_ledger_.boxes += dt * rate;
    }
}

template <int D, class T>
void GridStep<D, T>::impose_temperatures(double time, double& from_walls, double& from_boxes) {
  std::vector<double> held;
  const auto hold_at = [&](std::span<const std::uint32_t> nodes, std::span<const Vector3> x,
                           const ThermalCondition& condition, double& entry) {
    held.resize(nodes.size());
    condition.value.evaluate(x, time, held.data());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (int field = 0; field < grid_.fields(); ++field) {
        Q& of_node = grid_.quad(heat, field, nodes[i]);
        if (!(of_node[3] > T(0))) continue;
        const T value = static_cast<T>(held[i]);
        entry += static_cast<double>(of_node[3]) * (static_cast<double>(value) - of_node[0]);
        of_node[0] = value;
      }
  };
  for (const FaceNodes& face : grid_.faces())
    if (holds_temperature(*face.condition)) hold_at(face.wall, face.wall_position, face.condition->thermal, from_walls);
  for (const BoxNodes& box : grid_.boxes())
    if (box.condition->thermal.exchange == HeatExchange::fixed_temperature)
      hold_at(box.nodes, box.position, box.condition->thermal, from_boxes);
}

/// Gives ghosts mirrored temperatures. What was folded belongs to the particles as it was, beyond the wall: returns how
/// much more heat that is there than at the mirrors, at walls that are held at a temperature and at others.
template <int D, class T>
auto GridStep<D, T>::fill_temperature_ghosts(double time) -> Beyond {
  Beyond beyond;
  auto& faces = grid_.faces();
  for (auto face = faces.rbegin(); face != faces.rend(); ++face) {
    const T sign = mirror_signs(*face, AtWall::heat)[0];
    for (int field = 0; field < grid_.fields(); ++field)
      for (std::size_t i = 0; i < face->pairs.size(); ++i) {
        const std::size_t place = field * face->pairs.size() + i;
        if (!face->pair_folds[place]) continue;
        const MirrorPair& pair = face->pairs[i];
        const T of_mirror = grid_.quad(heat, field, pair.mirror)[0];
        const T of_wall = holds_temperature(*face->condition)
                              ? static_cast<T>(face->condition->thermal.value(pair.foot, pair.foot, time))
                              : T(0);
        T ghost = mirrored(of_mirror, sign, of_wall);
        if (passes_heat(*face->condition))
          ghost = temperature_beyond_wall(ghost, static_cast<T>(gradient_at(*face, field, pair.foot, time, true)),
                                          static_cast<T>(pair.distance));
        grid_.quad(heat, field, pair.ghost)[0] = ghost;
        const double more = face->folded_capacity[place] * (static_cast<double>(ghost) - of_mirror);
        (holds_temperature(*face->condition) ? beyond.held : beyond.others) += more;
      }
  }
  return beyond;
}

}  // namespace mpm::cpu

#include "backends/reference/grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <type_traits>

namespace mpm::reference {

Grid::Grid(const Experiment& experiment, const Plan& plan)
    : experiment_(experiment),
      wall_weights_(plan.node_field("heated_volume") ? wall_weights(experiment) : WallWeights()) {
  padding_ = Eigen::Vector3i::Zero();
  extent_ = Eigen::Vector3i::Ones();
  for (int axis = 0; axis < experiment.dimension; ++axis) {
    padding_[axis] = grid_padding_of(experiment.shape.plugin->shape());
    extent_[axis] = experiment.grid.cells[axis] + 1 + 2 * padding_[axis];
  }
  for (int k = 0; k < extent_[2]; ++k)
    for (int j = 0; j < extent_[1]; ++j)
      for (int i = 0; i < extent_[0]; ++i) coordinates_.push_back(Eigen::Vector3i(i, j, k) - padding_);
  for (const Field& field : plan.fields)
    if (field.owner == Owner::node && field.components == 1)
      scalar(field.id).allocate(field, size()), bytes_ += size() * sizeof(double);
    else if (field.owner == Owner::node)
      vector(field.id).allocate(field, size()), bytes_ += size() * sizeof(Vector);
  for (const ExternalForce kind : external_forces)
    if (plan.node_field(field_of(kind))) external_forces_.push_back(&vector(field_of(kind)));
  // In a domain of few cells a ghost's mirror is a ghost of the other wall: it is folded on after all that it receives.
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
  for_each_field([](auto& field) { field.start(); });
  folds_.clear();
}

void Grid::reset(const std::vector<std::string>& ids) {
  for_each_field([&](auto& field) {
    if (std::find(ids.begin(), ids.end(), field.id_) != ids.end()) field.start();
  });
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
  for (std::size_t i = 0; i < size(); ++i) sum += mass_[i] > 0 ? 0.5 * momentum_[i].squaredNorm() / mass_[i] : 0.0;
  return sum;
}

double Grid::mass_norm(const VectorField& velocity) const {
  double sum = 0;
  for (std::size_t i = 0; i < size(); ++i)
    if (mass_[i] > 0) sum += mass_[i] * velocity[i].squaredNorm();
  return std::sqrt(sum);
}

Vector Grid::force(std::size_t i) const {
  Vector sum = internal_force_[i];
  for (const VectorField* external : external_forces_) sum += (*external)[i];
  return sum + weight_[i];
}

Eigen::Vector3i Grid::foot_node(const Fold& fold) const {
  Eigen::Vector3i foot = coordinates(fold.ghost);
  foot[fold.axis] = fold.side == 0 ? 0 : experiment_.grid.cells[fold.axis];
  return foot;
}

Vector Grid::foot(const Fold& fold) const {
  return position(foot_node(fold));
}

Vector Grid::wall_velocity(const Fold& fold, double time) const {
  if (fold.side < 0 || !experiment_.faces[fold.axis][fold.side].velocity) return Vector::Zero();
  const Vector x = foot(fold);
  return to_eigen((*experiment_.faces[fold.axis][fold.side].velocity)({x[0], x[1], x[2]}, {x[0], x[1], x[2]}, time));
}

double Grid::wall_temperature(const Fold& fold, double time) const {
  if (fold.side < 0 || !holds_temperature(experiment_.faces[fold.axis][fold.side])) return 0;
  const Vector x = foot(fold);
  return experiment_.faces[fold.axis][fold.side].thermal.value({x[0], x[1], x[2]}, {x[0], x[1], x[2]}, time);
}

/// Follows Fourier's law from the flux through the wall and the conductivity of the bodies that reach the node there.
double Grid::gradient_from_flux(std::size_t i, int axis, int side, double time, bool heat_is_divided) const {
  if (!passes_heat(experiment_.faces[axis][side]) || heated_volume_[i] <= 0) return 0;
  return -flux_through_wall(i, axis, side, time, heat_is_divided) * heated_volume_[i] / volume_conductivity_[i];
}

double Grid::gradient_at_wall(const Fold& fold, double time) const {
  if (fold.side < 0) return 0;
  const std::size_t i = at(velocity_field_of(fold.ghost), index(foot_node(fold)));
  return gradient_from_flux(i, fold.axis, fold.side, time, true);
}

double Grid::gradient_before_folds(const Fold& fold) const {
  if (fold.side < 0 || !passes_heat(experiment_.faces[fold.axis][fold.side])) return 0;
  return gradient_before_folds_[at(velocity_field_of(fold.ghost), index(foot_node(fold)))];
}

void Grid::find_gradients_before_folds(int axis, double time) {
  gradient_before_folds_.assign(size(), 0.0);
  for (std::size_t i = 0; i < size(); ++i)
    for (const int side : {0, 1})
      if (coordinates(i)[axis] == (side == 0 ? 0 : experiment_.grid.cells[axis]) && mass_[i] > 0)
        gradient_before_folds_[i] = gradient_from_flux(i, axis, side, time, false);
}

double Grid::flux_through_wall(std::size_t i, int axis, int side, double time, bool heat_is_divided) const {
  const ThermalCondition& wall = experiment_.faces[axis][side].thermal;
  const Vector x = position(coordinates(i));
  const double given = wall.value({x[0], x[1], x[2]}, {x[0], x[1], x[2]}, time);
  if (wall.exchange == HeatExchange::flux) return given;
  // The shares mirror the temperature beyond the wall, but the flux q bends it: the wall has at_wall + q colder / k.
  const double h = experiment_.grid.cell_size, conductivity = volume_conductivity_[i] / heated_volume_[i];
  double at_wall = 0, colder = wall_weights_.beyond * h;
  for (std::size_t k = 0; k < wall_weights_.shares.size(); ++k) {
    Eigen::Vector3i inward = coordinates(i), beyond = coordinates(i);
    inward[axis] += (side == 0 ? 1 : -1) * static_cast<int>(k);
    beyond[axis] -= (side == 0 ? 1 : -1) * static_cast<int>(k);
    const std::size_t node = at(velocity_field_of(i), index(inward)), ghost = at(velocity_field_of(i), index(beyond));
    if (heat_is_divided) {
      at_wall += wall_weights_.shares[k] * temperature_[node];
      continue;
    }
    // Folding adds the ghost's heat, and what its image is colder by at a unit gradient; the wall's node has half of that.
    const Fold fold{ghost, node, axis, side};
    double heat = heat_[node], capacity = heat_capacity_[node], image = -capacity_inward(node, fold);
    if (k > 0) {
      heat += heat_[ghost], capacity += heat_capacity_[ghost];
      image = 2 * (static_cast<double>(k) * h * heat_capacity_[ghost] - capacity_inward(ghost, fold));
    }
    if (capacity <= 0) continue;
    at_wall += wall_weights_.shares[k] * heat / capacity;
    colder -= wall_weights_.shares[k] * image / capacity;
  }
  return (given - at_wall) / (1 / wall.coefficient + colder / conductivity);
}

double Grid::distance(const Fold& fold) const {
  return experiment_.grid.cell_size * std::abs((coordinates(fold.ghost) - foot_node(fold))[fold.axis]);
}

double Grid::capacity_inward(std::size_t i, const Fold& fold) const {
  if (!capacity_position_.declared_) return 0;
  return capacity_position_[i][fold.axis] * (fold.side == 0 ? 1 : -1);
}

double Grid::mirrored(double v, const Fold& fold, AtWall rule) const {
  return fold.side < 0 ? v : v * mirror_sign(rule, experiment_.faces[fold.axis][fold.side], fold.axis, 0);
}

Vector Grid::mirrored(Vector v, const Fold& fold, AtWall rule) const {
  if (fold.side < 0) return v;
  const FaceCondition& face = experiment_.faces[fold.axis][fold.side];
  for (int c = 0; c < 3; ++c) v[c] *= mirror_sign(rule, face, fold.axis, c);
  return v;
}

void Grid::add_to_mirror(ScalarField& field, const Fold& fold, AtWall rule, const OfWall& wall) const {
  if (rule == AtWall::heat)
    field[fold.mirror] += wall.heat + mirrored(field[fold.ghost] - wall.heat, fold, rule) + wall.heat_beyond;
  else
    field[fold.mirror] += mirrored(field[fold.ghost], fold, rule);
}

Vector Grid::image(const Vector& ghost, const Fold& fold, AtWall rule, const OfWall& wall) const {
  if (rule == AtWall::momentum) return wall.momentum + mirrored(ghost - wall.momentum, fold, rule);
  return mirrored(ghost, fold, rule);
}

void Grid::add_to_mirror(VectorField& field, const Fold& fold, AtWall rule, const OfWall& wall) const {
  field[fold.mirror] += image(field[fold.ghost], fold, rule, wall);
}

// ---- reactions ---------------------------------------------------------------------------------------------------

MirroredPlaces Grid::places(const Fold& fold) const {
  return {support_of_wall(fold.axis, fold.side), as_array(position(coordinates(fold.ghost))),
          as_array(position(coordinates(fold.mirror)))};
}

/// Notes that a wall takes a ghost's projection or force and gives its image to the mirror.
void Grid::note_fold(const Fold& fold, AtWall rule, const OfWall& wall, const Vector& ghost) const {
  if (!reactions_ || fold.side < 0) return;
  const Vector3 given = as_array(image(ghost, fold, rule, wall));
  if (rule == AtWall::momentum)
    reactions_->mirror_projection(places(fold), as_array(ghost), given);
  else
    reactions_->mirror_force(places(fold), as_array(ghost), given);
}

void Grid::note_gather_of(const VectorField& increment) const {
  if (!reactions_) return;
  reactions_->begin_projection();
  for (const Fold& fold : folds_)
    if (fold.side >= 0)
      reactions_->beyond_projection(places(fold), as_array(fold.mass * increment[fold.mirror]),
                                    as_array(fold.mass * increment[fold.ghost]));
}

void Grid::note_gather() const {
  if (!reactions_) return;
  reactions_->begin_gather();
  for (const Fold& fold : folds_) {
    if (fold.side < 0) continue;
    const auto momentum = [&](std::size_t i) { return as_array(fold.mass * velocity_[i]); };
    const auto change = [&](std::size_t i) { return as_array(fold.mass * (velocity_[i] - velocity_before_[i])); };
    reactions_->beyond(places(fold), momentum(fold.mirror), momentum(fold.ghost));
    reactions_->beyond_increment(places(fold), change(fold.mirror), change(fold.ghost));
  }
}

bool Grid::approaches_wall(const Fold& fold, double dt) const {
  const double inward = fold.side == 0 ? 1 : -1;
  double speed = 0;
  for (const std::size_t i : {fold.ghost, fold.mirror})
    if (mass_[i] > 0) speed += inward * (momentum_[i] + dt * force(i))[fold.axis] / mass_[i];
  return speed < 0;
}

void Grid::sum_images() {
  for (int axis = 0; axis < experiment_.dimension; ++axis)
    if (experiment_.faces[axis][0].type == ConditionType::periodic) fold_axis(axis, 0, 0);
  fold_forces(0);
}

double Grid::fold_walls(double time, double dt) {
  work_of_folds_ = 0;
  for (int axis = 0; axis < experiment_.dimension; ++axis)
    if (experiment_.faces[axis][0].type != ConditionType::periodic) fold_axis(axis, time, dt);
  for_each_field([](auto& field) { field.waits_ = false; });
  return work_of_folds_;
}

void Grid::fold_axis(int axis, double time, double dt) {
  const int cells = experiment_.grid.cells[axis];
  if (heated_volume_.declared_ && heat_capacity_.waits_) find_gradients_before_folds(axis, time);
  for (int velocity_field = 0; velocity_field < velocity_fields(); ++velocity_field)
    for (const std::size_t node : outermost_first_[axis]) {
      Eigen::Vector3i target = coordinates_[node];
      const int k = target[axis], side = k <= 0 ? 0 : 1;
      const ConditionType type = experiment_.faces[axis][side].type;
      const bool periodic = type == ConditionType::periodic;
      if (!has_images(type) || (periodic ? k >= 0 && k < cells : k > 0 && k < cells)) continue;
      target[axis] = image_of(k, cells, periodic);
      const Fold fold{at(velocity_field, node), at(velocity_field, index(target)), axis, periodic ? -1 : side};
      if (mass_[fold.ghost] <= 0) continue;
      if (type == ConditionType::separate && !approaches_wall(fold, dt)) continue;
      if (fold.mirror != fold.ghost)
        fold_node(fold, time);
      else
        fold_onto_itself(fold);
    }
}

void Grid::fold_node(Fold fold, double time) {
  fold.mass = mass_[fold.ghost];
  OfWall wall{fold.mass * wall_velocity(fold, time)};
  if (heat_capacity_.declared_ && heat_capacity_.waits_) {
    fold.heat_capacity = heat_capacity_[fold.ghost];
    wall.heat = fold.heat_capacity * wall_temperature(fold, time);
    // Particles at x_p from the wall have images at -x_p that are colder by 2 x_p times the gradient.
    wall.heat_beyond =
        2 * gradient_before_folds(fold) * (distance(fold) * fold.heat_capacity - capacity_inward(fold.ghost, fold));
  }
  work_of_folds_ += work_of_fold(fold, wall);
  if (reactions_ && fold.side >= 0)
    reactions_->mirror(places(fold), as_array(momentum_[fold.ghost]),
                       as_array(image(momentum_[fold.ghost], fold, AtWall::momentum, wall)));
  for_each_field([&](auto& field) {
    if (field.waits_) add_to_mirror(field, fold, field.declared_->at_wall, wall);
  });
  mass_[fold.ghost] = 0;  // other values of a node without mass are not read, but for contact after MUSL's remap
  momentum_[fold.ghost] = Vector::Zero();
  if (heat_capacity_.declared_) heat_[fold.ghost] = heat_capacity_[fold.ghost] = 0;
  folds_.push_back(fold);
}

/// Returns what the image of a ghost's momentum gains of energy, and what is lost as its mass joins the mirror's: that
/// of their relative velocity, with the reduced mass.
double Grid::work_of_fold(const Fold& fold, const OfWall& wall) const {
  const Vector before = momentum_[fold.ghost],
               image = wall.momentum + mirrored(before - wall.momentum, fold, AtWall::momentum);
  const double own = fold.mass, mirror = mass_[fold.mirror];
  const double gained = (image - before).dot(image + before) / (2 * own);
  if (mirror <= 0) return gained;
  return gained - own * mirror / (2 * (own + mirror)) * (image / own - momentum_[fold.mirror] / mirror).squaredNorm();
}

/// Folds a node of the wall, which is its own mirror: the image takes away what points across the wall.
void Grid::fold_onto_itself(const Fold& fold) {
  const std::size_t i = fold.ghost;
  const int axis = fold.axis;
  if (heat_capacity_.declared_ && heat_capacity_.waits_)
    heat_[i] -= gradient_before_folds(fold) * capacity_inward(i, fold);
  for (auto& [id, field] : vectors_)
    if (field.waits_ && field.declared_->at_wall == AtWall::slip) field[i][axis] = 0;
}

/// The power that walls which move have on the ghosts of a field of forces, which is folded on the way as it will be.
double Grid::power_beyond_walls(VectorField force, double time) const {
  double power = 0;
  for (const Fold& fold : folds_) {
    const Vector wall = wall_velocity(fold, time), beside_mirror = wall - mirrored(wall, fold, AtWall::vector);
    for (int c = 0; c < 3; ++c)
      if (&force.declared_->id != &weight_.declared_->id || experiment_.gravity_has_potential(c))
        power -= force[fold.ghost][c] * beside_mirror[c];
    add_to_mirror(force, fold, AtWall::vector, {});
    set_zero(force[fold.ghost]);
  }
  return power;
}

double Grid::fold_forces(double time) {
  const double power = power_beyond_walls(internal_force_, time) + power_beyond_walls(weight_, time);
  for_each_field([&](auto& field) {
    if (field.folded(Folded::with_force)) fold_as(field, field.declared_->at_wall, {});
  });
  return power;
}

template <class Value>
void Grid::fold_as(NodeField<Value>& field, AtWall rule, std::optional<double> time) {
  for (const Fold& fold : folds_) {
    OfWall wall;
    if (time) wall.momentum = fold.mass * wall_velocity(fold, *time);
    if constexpr (std::is_same_v<Value, Vector>) note_fold(fold, rule, wall, field[fold.ghost]);
    add_to_mirror(field, fold, rule, wall);
    set_zero(field[fold.ghost]);
  }
}
template void Grid::fold_as(ScalarField&, AtWall, std::optional<double>);
template void Grid::fold_as(VectorField&, AtWall, std::optional<double>);

void Grid::fill_velocity_ghosts(double time) {
  for (auto fold = folds_.rbegin(); fold != folds_.rend(); ++fold) {
    const std::size_t ghost = fold->ghost, mirror = fold->mirror;
    const Vector wall = wall_velocity(*fold, time), change = velocity_[mirror] - velocity_before_[mirror];
    velocity_[ghost] = wall + mirrored(velocity_[mirror] - wall, *fold, AtWall::vector);
    velocity_before_[ghost] = velocity_[ghost] - mirrored(change, *fold, AtWall::vector);
  }
}

void Grid::fill_temperature_ghosts(double time) {
  for (auto fold = folds_.rbegin(); fold != folds_.rend(); ++fold) {
    const double wall = wall_temperature(*fold, time);
    temperature_[fold->ghost] = wall + mirrored(temperature_[fold->mirror] - wall, *fold, AtWall::heat);
    temperature_[fold->ghost] -= 2 * distance(*fold) * gradient_at_wall(*fold, time);
  }
}

double Grid::heat_beyond_walls(bool held) const {
  double sum = 0;
  for (const Fold& fold : folds_)
    if (held == (fold.side >= 0 && holds_temperature(experiment_.faces[fold.axis][fold.side])))
      sum += fold.heat_capacity * (temperature_[fold.ghost] - temperature_[fold.mirror]);
  return sum;
}

template <class Value>
void Grid::fill_ghosts(NodeField<Value>& field, AtWall rule) {
  for (auto fold = folds_.rbegin(); fold != folds_.rend(); ++fold)
    field[fold->ghost] = mirrored(field[fold->mirror], *fold, rule);
}
template void Grid::fill_ghosts(ScalarField&, AtWall);
template void Grid::fill_ghosts(VectorField&, AtWall);

std::vector<Held> Grid::held(std::size_t i, const Vector& predicted, double time) const {
  std::vector<Held> held;
  const Eigen::Vector3i& node = coordinates(i);
  const Vector x = position(node);
  const auto evaluate = [&](const std::optional<VectorExpression>& velocity) {
    return velocity ? to_eigen((*velocity)({x[0], x[1], x[2]}, {x[0], x[1], x[2]}, time)) : Vector(Vector::Zero());
  };
  for (int axis = 0; axis < experiment_.dimension; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const FaceCondition& face = experiment_.faces[axis][side];
      if (node[axis] != (side == 0 ? 0 : experiment_.grid.cells[axis])) continue;
      // A separating wall holds what moves into it, at every imposition: contact may have turned the velocity.
      if (face.type == ConditionType::separate && (side == 0 ? predicted[axis] >= 0 : predicted[axis] <= 0)) continue;
      const Vector velocity = evaluate(face.velocity);
      for (int c = 0; c < experiment_.dimension; ++c)
        if (holds(face.type, axis, c)) held.push_back({support_of_wall(axis, side), c, velocity[c]});
    }
  }
  for (std::size_t k = 0; k < experiment_.boxes.size(); ++k) {
    const BoxCondition& box = experiment_.boxes[k];
    if (!inside(box, i)) continue;
    const Vector velocity = evaluate(box.velocity);
    for (int c = 0; c < experiment_.dimension; ++c) {
      const bool holds = box.type == ConditionType::stick || (box.type == ConditionType::slip && c == box.axis) ||
                         (box.type == ConditionType::separate && c == box.axis && box.side * predicted[c] < 0) ||
                         (box.type == ConditionType::prescribed && box.held[c]);
      if (holds) held.push_back({support_of_box(static_cast<int>(k)), c, velocity[c]});
    }
  }
  hold_by_grips(i, held);
  return held;
}

/// Whether particles of a grip give the node half of a mass or more, but for rounding.
bool Grid::is_gripped(std::size_t i, std::size_t grip, double mass) const {
  const double of_grip = scalar(grip_field(grip) + "_mass")[i];
  return of_grip > 0 && of_grip - mass / 2 >= -0.5e-5 * mass;
}

std::array<bool, 3> Grid::gripped(std::size_t i, double mass) const {
  std::array<bool, 3> held{};
  for (std::size_t k = 0; k < experiment_.grips.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) held[c] = held[c] || (experiment_.grips[k].held[c] && is_gripped(i, k, mass));
  return held;
}

/// Adds what grips hold, whose particles give the node half of its mass or more: their mean velocity by mass.
void Grid::hold_by_grips(std::size_t i, std::vector<Held>& held) const {
  for (std::size_t k = 0; k < experiment_.grips.size(); ++k) {
    if (!is_gripped(i, k, mass_[i])) continue;
    const double mass = scalar(grip_field(k) + "_mass")[i];
    const Vector momentum = vector(grip_field(k) + (grips_at_end_ ? "" : "_before"))[i];
    for (int c = 0; c < experiment_.dimension; ++c)
      if (experiment_.grips[k].held[c]) held.push_back({experiment_.support_of_grip(k), c, momentum[c] / mass});
  }
}

bool Grid::inside(const BoxCondition& box, std::size_t i) const {
  const Vector x = position(coordinates(i));
  const double tolerance = 1e-9 * experiment_.grid.cell_size;
  for (int c = 0; c < experiment_.dimension; ++c)
    if (x[c] < box.lower[c] - tolerance || x[c] > box.upper[c] + tolerance) return false;
  return true;
}

}  // namespace mpm::reference

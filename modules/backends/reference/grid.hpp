#pragma once
// The grid of the reference backend holds every node of the domain and its padding, and the plan's fields of the nodes.

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "simulation/backend.hpp"
#include "simulation/boundary.hpp"
#include "simulation/reaction_impulse.hpp"
#include "simulation/wall_heat.hpp"

namespace mpm::reference {

using Vector = Eigen::Vector3d;  ///< z = 0 in 2-D
using Matrix = Eigen::Matrix3d;

inline Vector to_eigen(const Vector3& v) {
  return {v[0], v[1], v[2]};
}

inline Vector3 as_array(const Vector& v) {
  return {v[0], v[1], v[2]};
}

inline void set_zero(double& value) {
  value = 0;
}
inline void set_zero(Vector& value) {
  value.setZero();
}

/// A field of the nodes, read and written as momentum[i] with the i of Grid::at. A field that the plan does not have
/// may be named, but using it throws std::logic_error.
template <class Value>
class NodeField {
 public:
  explicit NodeField(std::string id) : id_(std::move(id)) {}
  Value& operator[](std::size_t i) { return refuse_unplanned(), values_[i]; }
  const Value& operator[](std::size_t i) const { return refuse_unplanned(), values_[i]; }

 private:
  friend class Grid;
  void refuse_unplanned() const {
    if (!declared_) throw std::logic_error("the plan has no field \"" + id_ + "\" of the nodes");
  }
  void allocate(const Field& declared, std::size_t size) {
    declared_ = &declared;
    values_.resize(size);
    start();
  }
  void start() {
    for (Value& value : values_) set_zero(value);
    waits_ = folded(Folded::with_mass);
  }
  bool folded(Folded when) const { return declared_ && declared_->folded == when; }

  std::string id_;
  const Field* declared_ = nullptr;
  std::vector<Value> values_;
  bool waits_ = false;  ///< true until its ghosts are folded with the mass
};
using ScalarField = NodeField<double>;
using VectorField = NodeField<Vector>;

/// A component of a node's velocity that a support gives.
struct Held {
  int support, component;
  double velocity;
};

class Grid {
 public:
  Grid(const Experiment& experiment, const Plan& plan);
  Grid(const Grid&) = delete;  // others refer to its fields

  /// The plan's field of nodes with this id; it stays where it is.
  ScalarField& scalar(const std::string& id) { return scalars_.try_emplace(id, id).first->second; }
  VectorField& vector(const std::string& id) { return vectors_.try_emplace(id, id).first->second; }
  const ScalarField& scalar(const std::string& id) const { return scalars_.at(id); }
  const VectorField& vector(const std::string& id) const { return vectors_.at(id); }

  /// Sets all fields to zero.
  void reset();
  /// Sets these fields to zero, before particles are summed into them once more in a step (the remap of MUSL).
  void reset(const std::vector<std::string>& ids);

  /// The index of a node from its coordinates (periodic axes are not wrapped: images are folded).
  std::size_t index(const Eigen::Vector3i& coordinates) const;
  bool contains(const Eigen::Vector3i& coordinates) const;
  int padding() const { return padding_[0]; }  ///< number of nodes beyond a wall
  Vector position(const Eigen::Vector3i& coordinates) const;
  const Eigen::Vector3i& coordinates(std::size_t i) const { return coordinates_[i % node_count()]; }
  int velocity_fields() const { return experiment_.field_count; }
  std::size_t node_count() const { return coordinates_.size(); }
  /// The index at which a field keeps a node's value for a velocity field, and the number of values that a field keeps.
  std::size_t at(int velocity_field, std::size_t node) const { return velocity_field * node_count() + node; }
  int velocity_field_of(std::size_t i) const { return static_cast<int>(i / node_count()); }
  std::size_t size() const { return velocity_fields() * node_count(); }
  std::uint64_t bytes() const { return bytes_; }

  double kinetic_energy() const;
  /// The mass norm sqrt(sum m v.v), kg^1/2 m/s, over all nodes that hold mass, which folded ghosts do not.
  double mass_norm(const VectorField& velocity) const;
  Vector force(std::size_t i) const;  ///< N

  /// Sums periodic images of all fields. As images are one node, this comes before anything is measured.
  void sum_images();
  /// Adds what was summed with the masses into ghosts beyond walls to their mirrors (boundary.hpp). A separating wall
  /// decides by p + dt f. Returns the energy that this gives the nodes, J.
  double fold_walls(double time, double dt);
  /// Does the same for forces, which USF scatters later. Returns the power, W, of walls that move by what lies beyond
  /// them: a ghost's velocity is its mirror's and (1 - sign) times the wall's, and particles are strained and lifted by
  /// that too.
  double fold_forces(double time);
  /// Folds a field by a rule as momenta and masses were folded in this step. `time` is that of the walls' velocity; it
  /// is absent when the walls are at rest (what is folded is a difference).
  template <class Value>
  void fold_as(NodeField<Value>& field, AtWall rule, std::optional<double> time);
  /// Notes what particles take from ghosts of the increment that a filter projects, before the projection is folded.
  void note_gather_of(const VectorField& increment) const;
  /// Gives ghosts the mirrored velocities. `time` is that of the wall's velocity.
  void fill_velocity_ghosts(double time);
  /// Gives ghosts the temperature mirrored about that of walls that have one, at `time`, and bent by the flux through
  /// others.
  void fill_temperature_ghosts(double time);
  /// The heat, J, that the ghosts' own capacities hold more at their temperature than at their mirrors', at walls that
  /// are held at a temperature or at all others.
  double heat_beyond_walls(bool held) const;
  /// The flux into the body at a node of a wall that heat comes through, W/m^2. Convection goes by the temperature
  /// there, which is that of the nodes' `heat_is_divided`, or what it will be when this has been folded and divided.
  double flux_through_wall(std::size_t i, int axis, int side, double time, bool heat_is_divided) const;
  /// Gives ghosts the values mirrored by a rule at walls at rest.
  template <class Value>
  void fill_ghosts(NodeField<Value>& field, AtWall rule);
  /// What conditions hold at a node whose velocity would be `predicted` without them, in the order in which they do:
  /// of those that hold the same component the last counts.
  std::vector<Held> held(std::size_t i, const Vector& predicted, double time) const;
  /// Which components of a node grips hold whose particles are half of a mass, kg, or more.
  std::array<bool, 3> gripped(std::size_t i, double mass) const;
  /// Lets grips hold nodes as their particles are told for the end of the step, or as they were at its start.
  void hold_grips_at_end(bool at_end) { grips_at_end_ = at_end; }
  /// Notes what folding gives and takes, where supports are asked for their reactions; null where nobody asks.
  void note_in(ReactionImpulse* reactions) { reactions_ = reactions; }
  /// Notes what particles take from ghosts more than they would from their mirrors.
  void note_gather() const;
  /// Whether a node lies in the box of a condition, its faces included.
  bool inside(const BoxCondition& box, std::size_t i) const;

 private:
  struct Fold {
    std::size_t ghost, mirror;
    int axis, side;            ///< side < 0 for a periodic image
    double mass = 0;           ///< mass of the ghost when it was folded, kg
    double heat_capacity = 0;  ///< heat capacity of the ghost then, J/K
  };
  /// The momentum and heat of a ghost that moves with the wall and has the wall's temperature.
  struct OfWall {
    Vector momentum = Vector::Zero();
    double heat = 0;
    double heat_beyond = 0;  ///< heat that the image has more, as the temperature goes on beyond a wall with a flux
  };
  template <class Visit>
  void for_each_field(Visit visit) {
    for (auto& [id, field] : scalars_) visit(field);
    for (auto& [id, field] : vectors_) visit(field);
  }
  void fold_axis(int axis, double time, double dt);
  void fold_node(Fold fold, double time);
  double work_of_fold(const Fold& fold, const OfWall& wall) const;
  double power_beyond_walls(VectorField force, double time) const;
  void fold_onto_itself(const Fold& fold);
  bool approaches_wall(const Fold& fold, double dt) const;
  /// The point of the wall where a ghost's line to its mirror crosses it.
  Vector foot(const Fold& fold) const;
  Eigen::Vector3i foot_node(const Fold& fold) const;
  double distance(const Fold& fold) const;  ///< distance of the ghost from the wall, m
  /// The rise of the temperature inward at the wall, K/m, where heat comes through it.
  /// The gradient inward at the foot of a fold, K/m: of what is divided at `time`, or what it was before the first fold
  /// along this axis.
  double gradient_at_wall(const Fold& fold, double time) const;
  double gradient_before_folds(const Fold& fold) const;
  void find_gradients_before_folds(int axis, double time);
  double gradient_from_flux(std::size_t i, int axis, int side, double time, bool heat_is_divided) const;
  /// The sum of w C (x_p - x_i) along the inward normal, J m/K, where the transfer scatters no particle gradients.
  double capacity_inward(std::size_t i, const Fold& fold) const;
  Vector wall_velocity(const Fold& fold, double time) const;
  double wall_temperature(const Fold& fold, double time) const;
  bool is_gripped(std::size_t i, std::size_t grip, double mass) const;
  void hold_by_grips(std::size_t i, std::vector<Held>& held) const;
  Vector image(const Vector& ghost, const Fold& fold, AtWall rule, const OfWall& wall) const;
  MirroredPlaces places(const Fold& fold) const;
  void note_fold(const Fold& fold, AtWall rule, const OfWall& wall, const Vector& ghost) const;
  void add_to_mirror(ScalarField& field, const Fold& fold, AtWall rule, const OfWall& wall) const;
  void add_to_mirror(VectorField& field, const Fold& fold, AtWall rule, const OfWall& wall) const;
  double mirrored(double v, const Fold& fold, AtWall rule) const;
  Vector mirrored(Vector v, const Fold& fold, AtWall rule) const;

  const Experiment& experiment_;
  const WallWeights wall_weights_;
  Eigen::Vector3i extent_, padding_;
  std::vector<Eigen::Vector3i> coordinates_;
  std::array<std::vector<std::size_t>, 3> outermost_first_;  ///< nodes by distance beyond the walls of an axis
  std::map<std::string, ScalarField> scalars_;
  std::map<std::string, VectorField> vectors_;
  ScalarField &mass_ = scalar("mass"), &heat_ = scalar("heat"), &heat_capacity_ = scalar("heat_capacity"),
              &temperature_ = scalar("temperature"), &heated_volume_ = scalar("heated_volume"),
              &volume_conductivity_ = scalar("volume_conductivity");
  VectorField &momentum_ = vector("momentum"), &velocity_ = vector("velocity"),
              &velocity_before_ = vector("velocity_before"), &internal_force_ = vector("force"),
              &weight_ = vector("weight"), &capacity_position_ = vector("capacity_position");
  std::vector<VectorField*> external_forces_;  ///< of loads, as far as there are any
  ReactionImpulse* reactions_ = nullptr;
  bool grips_at_end_ = false;
  std::vector<Fold> folds_;
  double work_of_folds_ = 0;                   ///< J, of this step
  std::vector<double> gradient_before_folds_;  ///< K/m, of nodes on walls that heat comes through, for one axis
  std::uint64_t bytes_ = 0;
};

}  // namespace mpm::reference

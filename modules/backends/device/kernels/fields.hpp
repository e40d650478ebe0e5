#pragma once
// These names stand for fields in kernels. The composer writes Scene::Node, Scene::Particle and
// Scene::for_each_node_field from the scene's list of fields; what a scene lacks costs nothing.

#include "kernel/config.hpp"

namespace mpm::device {

/// The time at which a field is folded, in the order of Folded (compose.cpp checks it).
enum FoldTime : int { never_folded = 0, folded_with_mass, folded_with_force };

/// Numbers of the fields of nodes that kernels know by name, -1 where a scene has none; Scene::Node hides those that it
/// has. Other fields are cleared and folded all the same.
struct NoNodeFields {
  static constexpr int mass = -1, momentum = -1, velocity = -1, velocity_before = -1;
  static constexpr int force = -1, weight = -1;
  static constexpr int body_force = -1, surface_load = -1, point_load = -1, spring = -1, dashpot = -1;
  static constexpr int volume_gradient = -1, mass_gradient = -1, mass_position = -1, mass_displacement = -1;
  static constexpr int mass_state = -1, mass_gain = -1, reached = -1, met = -1;  ///< where the law has a state
  static constexpr int increment = -1, projection = -1, trial_velocity = -1, folded_mass = -1;
  static constexpr int unfiltered_velocity = -1;
  static constexpr int velocity_of_constraints = -1, unfiltered_velocity_of_constraints = -1;
  static constexpr int boundary_impulse = -1, contact_impulse = -1, filter_impulse = -1, damping_impulse = -1;
  static constexpr int standing_boundary_impulse = -1, standing_contact_impulse = -1;
  static constexpr int work_beyond_walls = -1;  ///< work of walls that move on a ghost beyond them
  static constexpr int work_of_folds = -1;      ///< energy that folding a ghost at walls gives the nodes
  static constexpr int heat = -1, heat_capacity = -1, heat_rate = -1, folded_capacity = -1;
  static constexpr int heated_volume = -1, volume_conductivity = -1, capacity_position = -1;
  static constexpr int temperature = -1, temperature_before = -1;
  static constexpr int volume_rate = -1, strained_volume = -1, dilation = -1;
  static constexpr int volume_stress = -1, stressed_volume = -1, mean_stress = -1;
};

/// The same numbers for particles. A plugin's state goes by the number of its first field.
struct NoParticleFields {
  static constexpr int position = -1, velocity = -1, advection_velocity = -1;
  static constexpr int transfer_state = -1, polynomial_coefficients = -1, material_state = -1;
  static constexpr int size = -1, corners = -1, moved_corners = -1;
  static constexpr int domain = -1;           ///< domain that weights are made of
  static constexpr int strained_domain = -1;  ///< domain strained in the rest of a step; absent where no weights follow
  static constexpr int stress = -1, volume_ratio = -1, wave_speed = -1, velocity_gradient = -1, hoop_rate = -1;
  static constexpr int dissipated = -1;  ///< energy dissipated by the last strain
  static constexpr int stress_power = -1,
                       stored = -1;               ///< work of the stress, and change of the energy, of that strain
  static constexpr int artificial_pressure = -1;  ///< J q of artificial viscosity in the last strain
  static constexpr int artificial_work = -1;      ///< what that dissipated in it
  static constexpr int mean_dilation = -1;        ///< as the nodes average it
  static constexpr int deformation = -1;          ///< deformation gradient, for loads
  static constexpr int second_moment = -1;        ///< what `second_moments` makes
  static constexpr int temperature = -1, melted_fraction = -1;
  static constexpr int initial_position = -1;   ///< kept where the law of contact has springs or a formula asks
  static constexpr int contact_state = -1;      ///< what the law of contact keeps
  static constexpr int contact_gain = -1;       ///< what the last step has added to it
  static constexpr int grip = -1;               ///< number of the grip that moves the particle, from 1; 0: none
  static constexpr int told_velocity = -1;      ///< velocity that its grip gives it
  static constexpr int gathered_velocity = -1;  ///< velocity that it would have without it
};

/// A field of particles that is a transfer's state for the temperature: its values stand in the State of a velocity
/// from `scalar` on. The rest of that State is zero.
template <int Number, int Components, int Scalar>
struct TemperatureState {
  static constexpr int number = Number, components = Components, scalar = Scalar;
};

/// A field of nodes with its properties as constants; at_wall is a Rule. `place` is that of its first component among
/// the values that a particle gives to a node in a scatter, -1 where it gives none.
template <int Number, int Components, int AtWall, int Folded, bool Cleared, int Place>
struct NodeField {
  static constexpr int number = Number, components = Components, at_wall = AtWall, folded = Folded, place = Place;
  static constexpr bool cleared = Cleared;
};

}  // namespace mpm::device

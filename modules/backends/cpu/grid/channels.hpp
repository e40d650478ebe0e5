#pragma once
// Channels are the plan's fields of nodes as the grid keeps them, each a group of four scalars a node.

#include <algorithm>
#include <string_view>
#include <vector>

#include "plan/plan.hpp"

namespace mpm::cpu {

/// The number of a field of nodes among those with a group of their own; -1 where the scene has none. A scalar beside a
/// vector is the fourth of its group, and a field in place of another has the other's.
using Channel = int;

inline std::vector<const Field*> channel_fields(const Plan& plan) {
  std::vector<const Field*> fields;
  for (const Field& field : plan.fields)
    if (field.owner == Owner::node && field.beside.empty() && field.in_place_of.empty()) fields.push_back(&field);
  return fields;
}

inline Channel channel_of(const Plan& plan, std::string_view id) {
  const Field* const field = plan.node_field(id);
  if (!field) return -1;
  if (!field->beside.empty()) return channel_of(plan, field->beside);
  if (!field->in_place_of.empty()) return channel_of(plan, field->in_place_of);
  const std::vector<const Field*> fields = channel_fields(plan);
  return static_cast<Channel>(std::find(fields.begin(), fields.end(), field) - fields.begin());
}

/// The channels of what an operator uses, as "nodes/momentum".
inline std::vector<Channel> channels_of(const Plan& plan, const FieldNames& names) {
  constexpr std::string_view nodes = "nodes/";
  std::vector<Channel> channels;
  for (const std::string_view name : names)
    if (name.starts_with(nodes)) channels.push_back(channel_of(plan, name.substr(nodes.size())));
  return channels;
}

/// A kind of force from outside that the scene has, and its channel.
struct ExternalChannel {
  ExternalForce kind;
  Channel channel;
};
inline std::vector<ExternalChannel> external_channels(const Plan& plan) {
  std::vector<ExternalChannel> channels;
  for (const ExternalForce kind : external_forces)
    if (plan.node_field(field_of(kind))) channels.push_back({kind, channel_of(plan, field_of(kind))});
  return channels;
}

/// The channels that passes work on by name, resolved once a scene.
struct NamedChannels {
  const Plan& plan_;
  /// Holds scattered momentum and mass; velocity and mass once the momentum has been divided.
  const Channel motion = channel_of(plan_, "momentum");
  /// Holds the same of the following step, scattered by the fused pass.
  const Channel next_motion = channel_of(plan_, "next_momentum");
  /// Holds v-, later the increment v+ - v-.
  const Channel velocity_before = channel_of(plan_, "velocity_before");
  const Channel force = channel_of(plan_, "force");
  const Channel body_force = channel_of(plan_, "body_force");
  const std::vector<ExternalChannel> external = external_channels(plan_);
  const Channel volume_gradient = channel_of(plan_, "volume_gradient"),
                mass_gradient = channel_of(plan_, "mass_gradient");
  const Channel mass_position = channel_of(plan_, "mass_position");
  const Channel mass_displacement = channel_of(plan_, "mass_displacement");  ///< where a law has springs
  const Channel mass_state = channel_of(plan_, "mass_state"), mass_gain = channel_of(plan_, "mass_gain");
  /// Holds what a law of contact says of its state, beside 1 where the field has met another.
  const Channel reached = channel_of(plan_, "reached");
  /// Holds heat and its capacity; temperature and capacity once the heat has been divided.
  const Channel heat = channel_of(plan_, "heat"), heat_rate = channel_of(plan_, "heat_rate");
  const Channel temperature_before = channel_of(plan_, "temperature_before");  ///< later the increment
  const Channel heated_volume = channel_of(plan_, "heated_volume");            ///< with volume times conductivity
  const Channel capacity_position = channel_of(plan_, "capacity_position");
  /// Hold volume times dilation, or times mean stress, with the volume; the average with it once that has been divided.
  const Channel dilation = channel_of(plan_, "dilation"), mean_stress = channel_of(plan_, "mean_stress");
  const Channel filter_increment = channel_of(plan_, "increment");  ///< v* of the filter's loop
  /// Holds the momentum S+ S v* and mass while scattered, then velocity; then the velocity before conditions.
  const Channel filter_projection = channel_of(plan_, "projection");
  /// Holds the velocity of the grid before the filter, with the mass.
  const Channel kept_velocity = channel_of(plan_, "unfiltered_velocity");
  /// Holds the velocity that conditions and contact have added in the step; while they act, the one without it.
  const Channel constrained = channel_of(plan_, "velocity_of_constraints");
  const Channel kept_constrained = channel_of(plan_, "unfiltered_velocity_of_constraints");  ///< for kept_velocity
  // Impulses of the stage under way, and of all stages where a filter's loop may take them back; the ledger's.
  const Channel boundary_impulse = channel_of(plan_, "boundary_impulse");
  const Channel contact_impulse = channel_of(plan_, "contact_impulse");
  const Channel filter_impulse = channel_of(plan_, "filter_impulse");
  const Channel damping_impulse = channel_of(plan_, "damping_impulse");
  const Channel standing_boundary = channel_of(plan_, "standing_boundary_impulse");
  const Channel standing_contact = channel_of(plan_, "standing_contact_impulse");
};

}  // namespace mpm::cpu

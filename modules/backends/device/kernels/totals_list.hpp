#pragma once
// The places of sums over particles (totals.hpp), for kernels and for the host that reads them. Extremes come last; the smallest
// of values is minus the largest of minus them.

namespace mpm::device {

/// Those of mass and motion.
enum : int {
  motion_particles,
  motion_mass,
  motion_kinetic,
  motion_momentum,
  motion_angular_momentum = motion_momentum + 3,  ///< about the origin
  motion_place = motion_angular_momentum + 3,     ///< of m x
  motion_momentum_scale = motion_place + 3,
  motion_angular_momentum_scale,
  motion_largest_speed,
  motion_sums
};
/// Those of what materials keep.
enum : int {
  state_particles,
  state_strain_energy,
  state_smallest_volume_ratio,
  state_largest_volume_ratio,
  state_sums
};
/// Those of heat.
enum : int { heat_particles, heat_content, heat_latent, heat_lowest, heat_highest, heat_sums };

}  // namespace mpm::device

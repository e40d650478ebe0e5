#pragma once
// Sums and extremes over particles at one time.

#include <array>

namespace mpm {

/// In plane strain energies, momenta and forces are per metre of depth; in axisymmetric scenes they are of whole rings.
struct Totals {
  double time = 0, time_step = 0;
  long step = 0;
  double mass = 0;
  double kinetic = 0, strain = 0, gravitational = 0;  ///< J; the kinetic energy includes the affine part
  std::array<double, 3> momentum{};                   ///< kg m/s
  std::array<double, 3> angular_momentum{};           ///< kg m^2/s about the centre of mass, affine part included
  std::array<double, 3> centre_of_mass{};             ///< m
  /// The sums of m |v| and of m |x| |v|: sizes of the terms that the momenta are sums of, against which those may be
  /// rounding.
  double momentum_scale = 0, angular_momentum_scale = 0;
  double smallest_volume_ratio = 0, largest_volume_ratio = 0;
  double largest_speed = 0;                               ///< m/s
  double position_error_rms = 0, position_error_max = 0;  ///< m, against the exact solution
  double velocity_error_rms = 0, velocity_error_max = 0;  ///< m/s
  /// Heat in J, where particles have a temperature: `heat_content` is sum m c T, with T from the melting temperature
  /// where a material has one; `latent_heat` is sum m L phi.
  double heat_content = 0, latent_heat = 0;
  double lowest_temperature = 0, highest_temperature = 0;  ///< K

  double total_energy() const { return kinetic + strain + gravitational; }
};

}  // namespace mpm

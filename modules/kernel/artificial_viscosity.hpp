#pragma once
// Artificial viscosity: a pressure against fast compression that spreads a shock over some cells, so that the grid carries
// it without ringing. von Neumann & Richtmyer, J. Appl. Phys. 21 (1950) 232 (its quadratic part); Landshoff, LA-1930
// (1955) (its linear part); Wilkins, J. Comput. Phys. 36 (1980) 281 (both, for solids).

#include "kernel/equation_of_state.hpp"
#include "kernel/viscosity.hpp"

namespace mpm {

/// A pressure q = density h r (linear c + quadratic h r) of a material that is compressed at the rate r, with the cell
/// size h and the speed c of its fastest wave.
template <class T>
struct ArtificialViscosity {
  T density;    ///< at rest, kg/m^3
  T linear;     ///< linear coefficient times the cell size, m
  T quadratic;  ///< quadratic coefficient times the square of the cell size, m^2

  /// J q, Pa: the density is that at rest.
  template <class S>
  MPM_HD S pressure(const S& rate, const S& speed) const {
    return density * rate * (quadratic * rate + linear * speed);
  }
  /// The kinematic viscosity of a small change of the rate, m^2/s, which is the slope of q over the rate, and which J q
  /// itself gives.
  template <class S>
  MPM_HD S kinematic(const S& squared_speed, const S& pressure) const {
    return sqrt(linear * linear * squared_speed + real<S>(4) * quadratic * pressure / density);
  }
  /// The speed by which a step stands both waves of speed c and this viscosity, m/s (damped_wave_speed).
  template <class S>
  MPM_HD S damped_speed(const S& squared_speed, const S& pressure, scalar_of<S> inverse_cell_size) const {
    return damped_wave_speed(squared_speed, kinematic(squared_speed, pressure), inverse_cell_size);
  }
};

/// The rate r at which a step that changes ln J by `change` = ln det(I + dt L) compresses, 1/s; zero where it expands, and
/// in a rigid turn or a simple shear, however large.
template <class S>
MPM_HD S compression_rate(const S& change, scalar_of<S> dt) {
  return max(-change / S(dt), S(real<S>(0)));
}

}  // namespace mpm

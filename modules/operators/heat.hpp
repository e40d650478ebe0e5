#pragma once
// Formulas for the temperature of a node and of a particle, in kelvin, joule and watt. Types are as in motion.hpp.

#include "kernel/config.hpp"

namespace mpm {

template <class S>
MPM_HD S temperature_of(S heat, S capacity) {
  return heat / capacity;
}

/// The temperature after heat has come at `rate`, W, for a time dt.
template <class S>
MPM_HD S warmed(S temperature, S rate, S capacity, S dt) {
  return temperature + dt * (rate / capacity);
}

/// The area of the wall that a node on it stands for. The node's cell ends at the wall, so half of it is the body's.
/// `volume` is what the particles have given the node, m^3 (in axisymmetric scenes m^2 of section, and the node's
/// circumference comes with it).
template <class S>
MPM_HD S area_of_wall_node(S volume, S cell_size, S circumference) {
  return S(2) * volume / cell_size * circumference;
}

/// The heat that the mirror image gives to the mirror beyond the ghost's own, where the temperature goes on beyond the
/// wall by its gradient there (K/m, inward) instead of bending back. `distance` is the ghost's from the wall;
/// `capacity_inward` is the inward component of the ghost's capacity times the place of its particles from it, and zero
/// where the transfer scatters the particles' own gradients.
template <class S>
MPM_HD S heat_beyond_wall(S gradient, S distance, S capacity, S capacity_inward) {
  return S(2) * gradient * (distance * capacity - capacity_inward);
}

/// The ghost's temperature where the temperature goes on beyond the wall by its gradient.
template <class S>
MPM_HD S temperature_beyond_wall(S mirrored_temperature, S gradient, S distance) {
  return mirrored_temperature - S(2) * gradient * distance;
}

/// The flux that convection drives into the wall, W/m^2. `at_wall` is the temperature there by the folded weights of
/// the nodes; the flux itself changes it by `beyond` (WallWeights), m, over the conductivity, times the flux.
template <class S>
MPM_HD S convected_flux(S coefficient, S outside, S at_wall, S beyond, S conductivity) {
  return coefficient * (outside - at_wall) / (S(1) + coefficient * beyond / conductivity);
}

/// Whether a particle has the melted phase's parameters.
template <class S>
MPM_HD bool is_melted(S melted_fraction) {
  return melted_fraction >= S(0.5);
}

/// The enthalpy, sensible and latent, of a unit of mass above that of the solid at the melting temperature, J/kg.
template <class S>
MPM_HD S enthalpy(S temperature, S melted_fraction, S melting_temperature, S heat_capacity, S latent_heat) {
  return heat_capacity * (temperature - melting_temperature) + latent_heat * melted_fraction;
}

/// Melts by the heat beyond the melting temperature, and freezes by the heat that lacks. The enthalpy is kept, and a
/// particle neither solid nor liquid has the melting temperature (Voller & Cross 1981, Int. J. Heat Mass Transf. 24).
template <class S>
MPM_HD void change_phase(S& temperature, S& melted_fraction, S melting_temperature, S latent_heat, S solid_capacity,
                         S melted_capacity) {
  const S capacity = is_melted(melted_fraction) ? melted_capacity : solid_capacity;
  const S heat = enthalpy(temperature, melted_fraction, melting_temperature, capacity, latent_heat);
  const S fraction = heat / latent_heat;
  melted_fraction = fraction < S(0) ? S(0) : fraction > S(1) ? S(1) : fraction;
  const S rest = heat - latent_heat * melted_fraction;
  const bool between = fraction > S(0) && fraction < S(1);
  temperature =
      melting_temperature + (between ? S(0) : rest / (is_melted(melted_fraction) ? melted_capacity : solid_capacity));
}

}  // namespace mpm

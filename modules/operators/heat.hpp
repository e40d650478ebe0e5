#pragma once
// What happens to the temperature of a node and of a particle. Types as in motion.hpp; kelvin, joule, watt.

#include "kernel/config.hpp"

namespace mpm {

template <class S>
MPM_HD S temperature_of(S heat, S capacity) {
  return heat / capacity;
}

/// The temperature after a time dt of gaining heat at a rate, W.
template <class S>
MPM_HD S warmed(S temperature, S rate, S capacity, S dt) {
  return temperature + dt * (rate / capacity);
}

/// Area of a wall that a node on it stands for: its cell ends at the wall, so half of it is the body's. `volume` is what
/// the particles have given the node, m^3 (in axisymmetric scenes m^2 of section, and the node's circumference comes
/// with it).
template <class S>
MPM_HD S area_of_wall_node(S volume, S cell_size, S circumference) {
  return S(2) * volume / cell_size * circumference;
}

/// Whether a particle has the melted phase's parameters.
template <class S>
MPM_HD bool is_melted(S melted_fraction) {
  return melted_fraction >= S(0.5);
}

/// Heat of a unit of mass beyond that of the solid at the melting temperature, J/kg: sensible and latent.
template <class S>
MPM_HD S enthalpy(S temperature, S melted_fraction, S melting_temperature, S heat_capacity, S latent_heat) {
  return heat_capacity * (temperature - melting_temperature) + latent_heat * melted_fraction;
}

/// Lets heat beyond the melting temperature melt, and lacking heat freeze: the enthalpy stays what it is, and a particle
/// that is neither solid nor liquid has the melting temperature (Voller & Cross 1981, Int. J. Heat Mass Transf. 24).
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

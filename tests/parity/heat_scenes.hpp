// Scenes whose bodies hold temperatures, for comparisons of backends.
#pragma once

#include "experiment/thermal.hpp"
#include "parity/parity.hpp"

namespace mpm::test {

inline const std::vector<std::string> orders{"last", "first", "modified_last", "averaged"};
// The diffusivity of all solids here is 0.05 m^2/s: heat crosses half a cell in 14 steps.
inline const std::string conducts = R"("conductivity": 500, "heat_capacity": 10)";
inline const std::string elastic =
    R"("type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000)";
inline const std::string plastic =
    R"("type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 60)";
/// Latent heat is that of 1 K, so that particles melt and freeze in 14 steps.
inline const std::string melts = R"(, "phase_change": {"temperature": 22, "latent_heat": 10,
    "melted": {"conductivity": 200, "heat_capacity": 15, "youngs_modulus": 600)";

inline std::string material(const std::string& plugin, const std::string& more = "") {
  return "{" + plugin + R"(, "thermal": {)" + conducts + more + "}}";
}

/// The bodies of a mix with temperatures between 10 K and 40 K that change from place to place.
inline Mix warm(Mix mix) {
  if (mix.material == Mix{}.material) mix.material = material(elastic);
  mix.overrides.push_back(set("/bodies/0/temperature", "\"20+30*(x-0.3)-20*(y-0.4)\""));
  mix.overrides.push_back(set("/bodies/1/temperature", "\"25+10*sin(9*x)*cos(7*y)\""));
  return mix;
}
inline Mix warm_and_close(int dimension) {
  Mix mix;
  mix.dimension = dimension, mix.close = true;
  return warm(mix);
}
/// Walls of every kind: held at a temperature, a flux, convection; the others let no heat through.
inline std::string boundaries(int dimension, const std::string& type) {
  std::string text = R"({"all": ")" + type + R"(", "x_min": {"type": ")" + type +
                     R"(", "temperature": "30+10*y-20*t"}, "x_max": {"type": ")" + type +
                     R"(", "heat_flux": "9000+2000*y+9000*t"}, "y_min": {"type": ")" + type +
                     R"(", "convection": {"coefficient": 900, "temperature": "60+9*x-99*t"}})";
  if (dimension == 3)
    text += R"(, "z_min": {"type": ")" + type + R"(", "temperature": "35-x"}, "z_max": {"type": ")" + type +
            R"(", "convection": {"coefficient": 500, "temperature": "5"}})";
  return text + "}";
}
inline std::string transfer_named(const std::string& id) {
  return "{\"type\": \"" + id + "\"}";
}

/// Whether the program takes the mix.
inline bool is_accepted(const Mix& mix) {
  try {
    const Experiment experiment = experiment_from(mix.text(), on_reference(mix));
    const Plan plan = make_plan(experiment);
    return !refusal_of_temperature(*experiment.transfer.plugin, plan.basis_order);
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace mpm::test

#pragma once
// A slab that conducts along x: a strip a few cells wide in 2-D or a bar in 3-D, insulated at its sides, of particles
// that keep their places.

#include "support/heat_solutions.hpp"
#include "support/scene.hpp"

namespace mpm::test {

/// Backends that execute temperature.
inline std::vector<std::string> heat_backends() {
  return {"reference", "cpu"};
}

struct Slab {
  std::string backend = "reference", shape = "bspline_quadratic", transfer = "\"apic\"", start = "0";
  std::string x_min = R"("slip")", x_max = R"("slip")";  ///< conditions as JSON
  std::string phase_change;                              ///< JSON of the key, or nothing
  ConductingPhase material{1, 1, 1};
  int dimension = 2, cells = 16, particles = 2;  ///< `particles` counts along an axis of a cell
  double length = 1;                             ///< m
  double fourier = 0.1;                          ///< alpha dt / h^2
  double end = 0.05;                             ///< s

  double cell() const { return length / cells; }
  std::string text() const {
    const auto number = [](double value) { return digits(value); };
    const double h = cell(), side = 3 * h;
    const std::string upper = number(length) + ", " + number(side) + (dimension == 3 ? ", " + number(side) : "");
    const std::string lower = dimension == 3 ? "0, 0, 0" : "0, 0";
    return R"({"dimension": )" + std::to_string(dimension) + R"(, "backend": ")" + backend +
           R"(", "grid": {"cell_size": )" + number(h) + R"(, "domain": [[)" + lower + "], [" + upper +
           R"(]], "boundaries": {"all": "slip", "x_min": )" + x_min + R"(, "x_max": )" + x_max +
           R"(}}, "shape": {"type": ")" + shape + R"("}, "transfer": {"type": )" + transfer +
           R"(}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0, "density": )" +
           number(material.density) + R"(, "thermal": {"conductivity": )" + number(material.conductivity) +
           R"(, "heat_capacity": )" + number(material.heat_capacity) + phase_change +
           R"(}}}, "bodies": [{"name": "slab", "material": "m", "frozen": true, "particles_per_cell_axis": )" +
           std::to_string(particles) + R"(, "temperature": ")" + start +
           R"(", "geometry": {"type": "box", "lower": [)" + lower + R"(], "upper": [)" + upper +
           R"(]}}], "solver": {"time_step": )" + number(fourier * h * h / material.diffusivity()) +
           R"(, "end_time": )" + number(end) + "}}";
  }
};

/// The length of the slab that is melted, m.
inline double melted_length(const BodyState& state, const Slab& slab) {
  double volume = 0;
  for (const double fraction : state.host_state.at("melted_fraction")) volume += fraction * state.volume;
  return volume / std::pow(3 * slab.cell(), slab.dimension - 1);
}

/// The heat that no row of the ledger explains, over the heat that the particles hold.
inline double relative_heat_residual(const Scene& scene, const Totals& now) {
  return std::abs(scene.metrics.heat_residual(now)) / (std::abs(now.heat_content) + std::abs(now.latent_heat));
}

/// The root mean square, over the particles of the first body, of what their temperature differs by from f(x), K.
inline double temperature_error(const BodyState& state, int dimension, const std::function<double(double)>& exact) {
  const std::vector<double>& T = state.host_state.at("temperature");
  double sum = 0;
  for (std::size_t p = 0; p < T.size(); ++p)
    sum += std::pow(T[p] - exact(state.position[p * static_cast<std::size_t>(dimension)]), 2);
  return std::sqrt(sum / static_cast<double>(T.size()));
}

}  // namespace mpm::test

#pragma once
// Any law of matter that is installed, as a scene names it, at any stiffness.

#include <cmath>
#include <string>

#include "drive/material_point.hpp"
#include "experiment/units.hpp"
#include "mpm/bench_suite.hpp"
#include "support/scene.hpp"

namespace mpm::test {

/// A law with the parameters of the benchmarks where it has no defaults, and its fastest wave at rest.
struct AnyLaw {
  std::string id;
  Component material;
  double speed = 0;    ///< m/s
  double density = 0;  ///< kg/m^3

  /// Its text in a scene. Stiffer by `ratio` at the same density and size, it is the same law in which everything takes
  /// 1/sqrt(ratio) of the time: a parameter in kg^a m^b s^c is larger by ratio^(-c/2), so moduli and strengths by `ratio`.
  std::string text(double ratio = 1) const {
    std::string all = R"({"type": ")" + id + '"';
    for (const mpm_parameter& parameter : material.plugin->parameters()) {
      if (parameter.type != MPM_NUMBER && parameter.type != MPM_INTEGER) continue;
      const int seconds = parse_unit(parameter.unit).dimension.exponent[2];
      const double value = material.parameters.at(parameter.offset / sizeof(double));
      all += std::string(", \"") + parameter.name + "\": " + digits(value * std::pow(ratio, -0.5 * seconds));
    }
    return all + "}";
  }
};

/// Every law that is installed, those of third parties too. One whose required parameters have no value yet in
/// experiments/benchmarks/standard.json is named in `left_out`.
inline std::vector<AnyLaw> every_law(int dimension, std::string& left_out) {
  static const app::BenchSuite suite(plugins(), true);
  std::vector<AnyLaw> laws;
  for (const Plugin* plugin : plugins().of_kind(MPM_MATERIAL)) {
    if (const std::string unknown = suite.unknown_parameter(*plugin); !unknown.empty()) {
      left_out +=
          std::string(plugin->id()) + " wants a value for " + unknown + " in experiments/benchmarks/standard.json; ";
      continue;
    }
    AnyLaw law{std::string(plugin->id()), suite.material(*plugin)};
    for (const mpm_parameter& parameter : plugin->parameters())
      if (std::string(parameter.name) == "density")
        law.density = law.material.parameters.at(parameter.offset / sizeof(double));
    law.speed = drive::MaterialPoint(law.material, dimension).look().wave_speed;
    laws.push_back(std::move(law));
  }
  return laws;
}

}  // namespace mpm::test

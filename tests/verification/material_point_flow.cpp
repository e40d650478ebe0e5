// One particle of a material that relaxes, of a fluid and of a gas along imposed paths, through the driver, against closed
// forms and tables of published equations.

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "drive/results.hpp"
#include "driven_path.hpp"

using namespace mpm;
using namespace mpm::drive;
using namespace mpm::driven_path;

namespace {

constexpr double at_once = 1e-12;  ///< s
constexpr double printed = 5e-7;   ///< half a unit of the last of seven digits

Json relaxing(double spring, std::array<double, 2> moduli, std::array<double, 2> times) {
  return {{"type", "prony"},
          {"shear_modulus", spring},
          {"bulk_modulus", 50},
          {"density", 1},
          {"branch_modulus_1", moduli[0]},
          {"relaxation_time_1", times[0]},
          {"branch_modulus_2", moduli[1]},
          {"relaxation_time_2", times[1]}};
}

Json lasting(double duration, int steps, const Json& rest) {
  Json stage = rest;
  stage["duration"] = duration, stage["steps"] = steps;
  return stage;
}

Json fluid(const std::string& equation, double bulk, double density) {
  return {{"type", "newtonian_fluid"},
          {"equation_of_state", equation},
          {"bulk_modulus", bulk},
          {"density", density},
          {"viscosity", 0}};
}

/// Compressed to the volume ratio J along one axis, or by as much along each.
Course compressed(const Json& material, double J, int steps, bool along_all = false) {
  Json F;
  for (const char* axis : {"xx", "yy", "zz"})
    if (along_all || F.empty()) F[axis] = "1 + (" + Json((along_all ? std::cbrt(J) : J) - 1).dump() + ")*t";
  const std::optional<double> cell_size =
      material["type"] == "inviscid_fluid" ? std::optional<double>() : std::optional<double>(0.1);
  return follow(path_of(material, Json::array({stage(F, steps)}), 3, cell_size));
}

}  // namespace

TEST_CASE("material point: after a step of shear a Prony series relaxes by itself") {
  // mu = 1, G = 4 and 2, t = 0.1 and 1: E(t) = 1 + 4 exp(-t/0.1) + 2 exp(-t)
  const double rows[][2] = {{0, 7}, {0.1, 4.2811926}, {0.5, 2.24001311}, {1, 1.73594048}, {5, 1.01347589}};
  for (const double strain : {1e-3, 0.6})
    for (const int steps : {1, 7})
      for (const auto& [time, modulus] : rows) {
        CAPTURE(strain, steps, time);
        Json stages = Json::array({lasting(at_once, 1, {{"deformation_gradient", {{"xy", strain}}}})});
        if (time > 0) stages.push_back(lasting(time, steps, {{"deformation_gradient", {{"xy", strain}}}}));
        const Course course = driven(relaxing(1, {4, 2}, {0.1, 1}), stages);
        CHECK(end_of(course).response.cauchy(0, 1) / strain == Approx(modulus).epsilon(1e-8));
      }
}

TEST_CASE(
    "material point: a standard linear solid creeps under its load by its compliance, to second order in the step") {
  // J(t) = [1 - 4/5 exp(-t/(0.5 * 5))] of mu = 1, G = 4, t = 0.5
  const double load = 0.2, rows[][2] = {{0.5, .3450154}, {2, .64053683}, {10, .98534749}};
  const Json held{{"deformation_gradient", Json::object()}, {"stress", {{"xy", load}}}};
  for (const auto& [time, compliance] : rows) {
    double off[2];
    for (int k = 0; k < 2; ++k) {
      const int steps = static_cast<int>(std::lround(time * (k == 0 ? 20 : 80)));
      const Course course =
          driven(relaxing(1, {4, 0}, {0.5, 1}), Json::array({lasting(at_once, 1, held), lasting(time, steps, held)}));
      CHECK(course.rows[1].F(0, 1) / load == Approx(0.2).epsilon(1e-10));
      off[k] = std::abs(end_of(course).F(0, 1) / load / compliance - 1);
    }
    CAPTURE(time, off[0], off[1]);
    CHECK(off[0] < 2e-4);
    CHECK(off[1] < off[0] / 14 + 1e-8);  // the table has eight digits
  }
}

TEST_CASE("material point: at a constant rate of shear a Maxwell element has its stress in steps of any length") {
  const double rate = 0.7, modulus = 4, time = 0.1;
  for (const double duration : {0.02, 0.3, 5.0})
    for (const int steps : {1, 3, 40}) {
      CAPTURE(duration, steps);
      const Course course = driven(relaxing(0, {modulus, 0}, {time, 1}),
                                   Json::array({lasting(duration, steps, {{"velocity_gradient", {{"xy", rate}}}})}));
      CHECK(end_of(course).response.cauchy(0, 1) ==
            Approx(modulus * time * rate * -std::expm1(-duration / time)).epsilon(1e-10));
    }
}

TEST_CASE("material point: the pressures of water by three equations of state") {
  struct OfVolume {
    double ratio, power, linear, tait;
  };
  const double bulk = 2.2e9;
  for (const OfVolume& row : {OfVolume{1.02, -4.068109e7, -4.313725e7, -3.942568e7},
                              {0.99, 2.290707e7, 2.222222e7, 2.327761e7},
                              {0.9, 3.428076e8, 2.444444e8, 4.052531e8},
                              {0.8, 1.184345e9, 5.5e8, 1.645518e9},
                              {0.5, 3.991429e10, 2.2e9, 5.261139e10}})
    for (const int steps : {1, 25})
      for (const bool along_all : {false, true}) {
        CAPTURE(row.ratio, steps, along_all);
        const auto found = [&](const Json& material) {
          return pressure(end_of(compressed(material, row.ratio, steps, along_all)).response);
        };
        CHECK(found(fluid("power", bulk, 1000)) == Approx(row.power).epsilon(printed));
        CHECK(found(fluid("linear", bulk, 1000)) == Approx(row.linear).epsilon(printed));
        CHECK(found(fluid("tait", bulk, 1000)) == Approx(row.tait).epsilon(printed));
        const Json inviscid{{"type", "inviscid_fluid"}, {"bulk_modulus", bulk}, {"density", 1000}};
        CHECK(found(inviscid) == Approx(row.linear).epsilon(printed));
      }
}

TEST_CASE(
    "material point: a liquid whose sound is chosen: its pressure at 1 % of compression, and the speed of sound") {
  const double speed = 20, exponent = 7;
  const Row& row = end_of(compressed(fluid("power", 1000 * speed * speed, 1000), 1 / 1.01, 10));
  CHECK(pressure(row.response) == Approx(4122.0201).epsilon(1e-8));
  CHECK(row.response.wave_speed == Approx(speed * std::pow(1.01, (exponent - 1) / 2)).epsilon(1e-10));
}

TEST_CASE("material point: copper on its Hugoniot, whose states a shock at U = c + s u leaves behind") {
  struct Behind {
    double ratio, pressure, particle_speed, shock_speed;
  };
  const double density = 8930, sound = 3940, slope = 1.489;
  for (const Behind& row : {Behind{0.95, 8.091222e9, 212.8464, 4256.928},
                            {0.9, 1.913739e10, 462.9303, 4629.303},
                            {0.8, 5.622795e10, 1122.1874, 5610.937},
                            {0.7, 1.358450e11, 2136.2733, 7120.911}}) {
    CAPTURE(row.ratio);
    const double found =
        pressure(end_of(compressed(fluid("mie_gruneisen", density * sound * sound, density), row.ratio, 20)).response);
    CHECK(found == Approx(row.pressure).epsilon(printed));
    CHECK(found == Approx(density * row.shock_speed * row.particle_speed).epsilon(printed));
    CHECK(std::sqrt(found * (1 - row.ratio) / density) == Approx(row.particle_speed).epsilon(printed));
    CHECK(sound + slope * std::sqrt(found * (1 - row.ratio) / density) == Approx(row.shock_speed).epsilon(printed));
  }
}

TEST_CASE("material point: an ideal gas on its adiabat and at one temperature") {
  struct OfVolume {
    double ratio, pressure, temperature, at_one_temperature;
  };
  const double rest = 101325, ratio_of_heats = 1.4, density = 1.2;
  Json gas{{"type", "ideal_gas"}, {"pressure", rest}, {"density", density}, {"heat_capacity_ratio", ratio_of_heats}};
  gas["linear_viscosity"] = gas["quadratic_viscosity"] = 0;
  for (const OfVolume& row :
       {OfVolume{0.5, 2.63901582, 1.31950791, 2}, {0.25, 6.96440451, 1.74110113, 4}, {2, .37892914, .75785828, .5}}) {
    CAPTURE(row.ratio);
    double unexplained[2];
    for (int k = 0; k < 2; ++k) {
      const Course course = compressed(gas, row.ratio, k == 0 ? 10 : 40);
      const Row& end = end_of(course);
      CHECK(1 + pressure(end.response) / rest == Approx(row.pressure).epsilon(1e-8));
      // The internal energy is p0 T/T0 / (g - 1), of which the stored energy is the rise and what p0 outside takes.
      const double rise = end.response.stored - rest * (row.ratio - 1);
      CHECK(1 + rise * (ratio_of_heats - 1) / rest == Approx(row.temperature).epsilon(1e-8));
      CHECK(end.dissipated == 0);
      unexplained[k] = std::abs(residual(course, end)) / turnover(course);
    }
    CAPTURE(unexplained[0], unexplained[1]);
    CHECK(unexplained[0] < 1e-6);
    CHECK(unexplained[1] < unexplained[0] / 16 + 1e-12);  // the work has three Gauss points a step
    const Row& cold = end_of(compressed(fluid("linear", rest, density), row.ratio, 10));
    CHECK(1 + pressure(cold.response) / rest == Approx(row.at_one_temperature).epsilon(1e-12));
  }
}

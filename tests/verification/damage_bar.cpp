// A bar that is pulled until it cracks in one cell, which is weaker than the others, by `damage` and by
// `anisotropic_damage`, which on this way are the same. The force falls along a line to zero at
// the opening 2 Gc/ft, and the crack dissipates Gc a unit of area, on every grid (Bazant & Oh, Mater. Struct. 16 (1983) 155).
// On grids that are not told of, the dissipated energy is that of one cell's volume.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double young = 1000, strength = 0.9, toughness = 1e-3, area = 0.2, pull = 1.2e-4;  // m/s of both grips
constexpr double in_waves = 1000 * 1 * pull / 2 * area;  ///< rho c v A, N: the force of a wave that a grip sends out

const std::string isotropic = R"J("type": "damage")J";
const std::string on_a_plane =
    R"J("type": "anisotropic_damage", "shear_strength": 0.5, "shear_fracture_energy": 1e-3)J";

/// A bar along x from 0 to 1.4 m, 0.2 m high and periodic there, whose ends of 0.2 m part; its cell from 0.6 m on is weak.
std::string bar(const std::string& law, double cell_size, double band_cells = 1) {
  const auto body = [&](const std::string& name, const std::string& material, double from, double to) {
    return R"J({"name": ")J" + name + R"J(", "material": ")J" + material +
           R"J(", "velocity": ["6e-5*(x-0.7)/0.7", 0], "geometry": {"type": "box", "lower": [)J" + digits(from) +
           R"J(, 0], "upper": [)J" + digits(to) + R"J(, 0.2]}})J";
  };
  const auto material = [&](double tensile) {
    return "{" + law + R"J(, "youngs_modulus": 1000, "poisson_ratio": 0, "density": 1000, "fracture_energy": 1e-3,
      "tensile_strength": )J" +
           digits(tensile) + R"J(, "band_cells": )J" + digits(band_cells) + "}";
  };
  return R"J({"dimension": 2, "grid": {"cell_size": )J" + digits(cell_size) +
         R"J(, "domain": [[-0.4, 0], [1.8, 0.2]], "boundaries": {
      "x_min": "free", "x_max": "free", "y_min": "periodic", "y_max": "periodic"}},
    "shape": {"type": "linear"}, "transfer": {"type": "apic"},
    "materials": {"whole": )J" +
         material(1) + R"J(, "weak": )J" + material(strength) + R"J(}, "bodies": [)J" + body("left", "whole", 0, 0.6) +
         ", " + body("middle", "weak", 0.6, 0.6 + cell_size) + ", " + body("right", "whole", 0.6 + cell_size, 1.4) +
         R"J(],
    "grips": [{"name": "left", "body": "left", "where": {"type": "box", "lower": [0, 0], "upper": [0.2, 0.2]},
               "velocity": [-6e-5, 0]},
              {"name": "right", "body": "right", "where": {"type": "box", "lower": [1.2, 0], "upper": [1.4, 0.2]},
               "velocity": [6e-5, 0]}],
    "output": {"reactions": ["left", "right"]}, "solver": {"courant": 0.5, "end_time": 24}})J";
}

/// The force of the right grip, N a metre of depth: its mean within 1.4 s, a period of the bar, about each time.
std::vector<double> forces_at(Scene& scene, const std::vector<double>& times) {
  constexpr double half = 1.4;
  std::vector<double> from(times.size()), to(times.size()), begin(times.size()), end(times.size());
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    const double t = scene.simulation.time(), impulse = scene.simulation.backend().reactions().back().impulse[0];
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (t <= times[k] - half) begin[k] = t, from[k] = impulse;
      if (t <= times[k] + half) end[k] = t, to[k] = impulse;
    }
  }
  std::vector<double> forces;
  for (std::size_t k = 0; k < times.size(); ++k) forces.push_back((to[k] - from[k]) / (end[k] - begin[k]));
  return forces;
}

void check_bar(const std::string& law, const std::string& backend, double cell_size) {
  INFO(law << ", " << backend << ", cells of " << cell_size << " m");
  Scene scene(bar(law, cell_size), {set("/backend", backend)});
  const std::vector<double> times{4, 14, 15, 16, 17, 22};
  const std::vector<double> forces = forces_at(scene, times);
  // The grips hold the nodes beyond the cells beside them: one cell at either end strains as the bar does.
  const double free_length = 1 + 2 * cell_size, open = 2 * toughness / strength;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double elongation = pull * times[k], elastic = young * elongation / free_length;
    const double stress = elastic < strength ? elastic : (open - elongation) / (open / strength - free_length / young);
    INFO("at " << times[k] << " s");
    CHECK(std::abs(forces[k] - area * std::max(stress, 0.0)) < in_waves);
  }
  const Totals end = scene.metrics.measure();
  CHECK(scene.simulation.ledger().material == Approx(toughness * area).epsilon(1e-6));
  for (const int body : {0, 1, 2}) {
    const BodyState state = scene.body(body);
    for (const double damage : state.material_state.at("damage")) CHECK(damage == (body == 1 ? 1 : 0));
  }
  // Work of the stress by steps, less what is stored and dissipated, vanishes with the step.
  CHECK(std::abs(scene.metrics.ledger_residual(end)) < 0.01 * toughness * area);
}

}  // namespace

TEST_CASE("a bar cracks along one curve of force and opening, and dissipates Gc, on grids of three sizes", "[damage]") {
  for (const std::string& law : {isotropic, on_a_plane}) {
    check_bar(law, "reference", 0.2);
    check_bar(law, "cpu", 0.2);
    check_bar(law, "cpu", 0.1);
    check_bar(law, "cpu", 0.05);
  }
  // A band that is told to be 0.1 m wide on cells of half of that dissipates half of Gc.
  for (const std::string& law : {isotropic, on_a_plane}) {
    Scene scene(bar(law, 0.05, 2));
    scene.run();
    CHECK(scene.simulation.ledger().material == Approx(toughness * area / 2).epsilon(1e-6));
  }
}

TEST_CASE("with quadratic B-splines a crack is two cells wide, and dissipates Gc within 5 %", "[damage][slow]") {
  for (const auto& [law, cell_size] : {std::pair(isotropic, 0.1), std::pair(isotropic, 0.05),
                                       std::pair(on_a_plane, 0.1), std::pair(on_a_plane, 0.05)}) {
    INFO(law << ", cells of " << cell_size << " m");
    Scene scene(bar(law, cell_size, 2), {"/shape/type=bspline_quadratic", "/solver/end_time=40"});
    scene.run();
    CHECK(scene.simulation.ledger().material == Approx(toughness * area).epsilon(0.05));
  }
}

#pragma once
// Two discs that collide (Sulsky, Chen & Schreyer 1994; 40 x 40 cells, 2 x 2 particles a cell, dt = 0.001 s), and what a
// transfer keeps of their energy.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/scene.hpp"

namespace mpm::test::colliding_discs {

inline const char* discs = R"J({
  "dimension": 2,
  "grid": {"cell_size": 0.025, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "separate"}},
  "shape": {"type": "gimp"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "lower", "material": "m", "geometry": {"type": "ball", "centre": [0.2, 0.2], "radius": 0.2}, "velocity": [0.1, 0.1]},
    {"name": "upper", "material": "m", "geometry": {"type": "ball", "centre": [0.8, 0.8], "radius": 0.2}, "velocity": [-0.1, -0.1]}],
  "solver": {"time_step": 0.001, "end_time": 3.5}, "output": {"ledger": false}})J";

inline std::vector<std::string> operator+(std::vector<std::string> list, const std::string& one) {
  list.push_back(one);
  return list;
}

constexpr double mass = 125.6637, kinetic = 2.51327412, touch = 1.58578644, cell = 0.025, approach = 0.2828427125;

struct Collision {
  double first = 0, clear = 0;   ///< s at which strain energy is above 1e-6 and 1e-2 of the kinetic
  double kept = 0, kinetic = 0;  ///< total and kinetic energy at the end, over the initial
  double largest = 0;            ///< largest total energy over the initial
  double transfers = 0;          ///< loss over the initial in scatter and gather, by the ledger
  double steps = 0;              ///< loss over the initial by time integration, likewise
  double drift = 0;              ///< kg m/s, momentum at the end
  double mass = 0;
};

inline Collision collide(const std::vector<std::string>& settings) {
  Scene scene(discs, settings);
  const Totals start = scene.metrics.initial();
  Collision found{.mass = start.mass};
  Totals now;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.steps() % 10 != 0 && !scene.simulation.finished()) continue;
    now = scene.metrics.measure();
    if (found.first == 0 && now.strain > 1e-6 * start.kinetic) found.first = now.time;
    if (found.clear == 0 && now.strain > 1e-2 * start.kinetic) found.clear = now.time;
    found.largest = larger(found.largest, now.total_energy() / start.total_energy());
  }
  found.kept = now.total_energy() / start.total_energy(), found.kinetic = now.kinetic / start.kinetic;
  found.drift = std::hypot(now.momentum[0], now.momentum[1]);
  const Ledger& ledger = scene.simulation.backend().ledger();
  found.transfers = -(ledger.scatter + ledger.gather) / start.total_energy();
  found.steps = -scene.metrics.ledger_residual(now) / start.total_energy();
  return found;
}

inline void check_collision(const std::string& name, const Collision& found) {
  std::printf("  %-34s %.3f %.3f %.4f %.4f %.4f", name.c_str(), found.first, found.clear, found.kept, found.kinetic,
              found.largest);
  if (found.transfers != 0) std::printf(" | %7.4f %7.4f", found.transfers, found.steps);
  std::printf("\n");
  INFO(name);
  CHECK(found.largest <= 1.01);
  CHECK(found.drift < 1e-10 * found.mass * 0.14);
  CHECK(found.kinetic < found.kept);  // the rest is vibration
  CHECK(found.kept < 1.0001);
}

inline void print_heads() {
  std::printf(
      "Discs: touch at %.8f s; strain energy above 1e-6 and 1e-2 of the kinetic (s); total and kinetic energy kept at "
      "3.5 "
      "s, largest total | with a ledger: lost by transfers, by time integration\n",
      touch);
}

inline std::vector<std::string> scheme(const std::string& shape, const std::string& transfer,
                                       const std::string& update = "last") {
  return {set("/shape/type", shape), set("/transfer/type", transfer), set("/solver/stress_update", update)};
}

}  // namespace mpm::test::colliding_discs

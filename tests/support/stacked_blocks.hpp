#pragma once
// Three blocks on one another in a shaft: the force of each pair by the second law of the block above it.

#include <map>

#include "support/catch.hpp"
#include "support/scene.hpp"

namespace mpm::test {

using Numbers = std::map<std::string, double>;

/// The chosen numbers as they are now, by the names of their columns.
inline Numbers chosen(const Metrics& metrics) {
  Numbers numbers;
  for (const ChosenRow& row : metrics.chosen().rows()) numbers[row.row.name] = row.row.value;
  return numbers;
}

/// Transfers and filters, as keys of an experiment: velocities that replace those of particles, and increments.
inline std::vector<std::pair<std::string, std::string>> stacked_schemes() {
  return {{R"({"type": "pic"})", ""},
          {R"({"type": "flip"})", ""},
          {R"({"type": "pic"})", R"(, "filter": {"type": "fmpm", "order": 2, "every_steps": 3})"}};
}

/// Three blocks of 0.25 m on one another in a shaft of 0.5 m.
inline std::string stacked_blocks(const std::string& backend, const std::string& transfer, const std::string& filter,
                                  const std::string& velocity_of_top = "[0, 0]") {
  std::string bodies;
  for (int k = 0; k < 3; ++k)
    bodies += std::string(k ? "," : "") + R"({"name": "b)" + std::to_string(k + 1) +
              R"(", "material": "m", "geometry": {"type": "box", "lower": [0, )" + digits(0.25 * k) +
              R"(], "upper": [0.5, )" + digits(0.25 * (k + 1)) + "]}" +
              (k == 2 ? R"(, "velocity": )" + velocity_of_top : "") + "}";
  return R"({"dimension": 2, "backend": ")" + backend + R"(", "grid": {"cell_size": 0.05, "domain": [[0, 0], [0.5, 1]],
      "boundaries": {"all": "slip"}}, "shape": {"type": "bspline_quadratic"}, "transfer": )" +
         transfer + filter + R"(, "contact": {"type": "coulomb", "friction": 0.2},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [)" +
         bodies + R"(], "gravity": [0, -10], "solver": {"time_step": 3e-4, "end_time": 1},
      "output": {"ledger": false, "bodies": true, "contact_pairs": true}})";
}

constexpr double block_weight = 1000 * 0.5 * 0.25 * 10;

/// What the momenta of the blocks and the forces of the pairs say of one another, step by step.
inline void check_newton(Simulation& simulation, int steps, double bound) {
  const Metrics metrics(simulation);
  double before = chosen(metrics)["body b3 momentum y"], worst = 0, largest = 0;
  for (int k = 0; k < steps; ++k) {
    simulation.step();
    Numbers now = chosen(metrics);
    // The force on the second block is minus that on the third, which has its weight beside it.
    const double force = (now["body b3 momentum y"] - before) / simulation.last_time_step() + block_weight;
    worst = larger(worst, std::abs(force + now["pair b2 b3 force y"]));
    largest = larger(largest, std::abs(force));
    before = now["body b3 momentum y"];
    double sum = 0;
    for (const char* pair : {"pair b1 b2 ", "pair b1 b3 ", "pair b2 b3 "}) {
      sum += now[std::string(pair) + "force y"];
      CHECK(now[std::string(pair) + "nodes"] ==
            now[std::string(pair) + "sticking nodes"] + now[std::string(pair) + "slipping nodes"]);
    }
    CHECK(sum == Approx(simulation.backend().contact_record().force[1]).epsilon(1e-6).margin(1e-6 * block_weight));
    CHECK(now["pair b1 b3 force y"] == 0);
    CHECK(now["pair b1 b2 nodes"] + now["pair b2 b3 nodes"] ==
          static_cast<double>(simulation.backend().contact_record().nodes));
  }
  INFO(worst << " N of " << largest);
  CHECK(largest > 0.02 * block_weight);
  CHECK(worst < bound * block_weight);
}

}  // namespace mpm::test

#pragma once
// Discs that meet under a filter with contact, and the energy that they gain.

#include <algorithm>
#include <string>
#include <vector>

#include "support/files.hpp"
#include "support/larger.hpp"
#include "support/scene.hpp"

namespace mpm::test::filtered_impact {

inline std::string set_filter(const std::string& type, int order) {
  return set("/filter", R"({"type":")" + type + R"(","order":)" + std::to_string(order) + "}");
}

/// The discs are those of experiments/studies/disc_impact.json on cells of 2 mm, nearer to each other.
inline const char* discs_near_each_other = R"J({
  "title": "two discs", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": "2 mm", "domain": [[0, 0], ["48 mm", "28 mm"]], "boundaries": {"all": "free"}},
  "shape": {"type": "cpdi"}, "transfer": {"type": "pic"},
  "contact": {"type": "coulomb", "friction": 0},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": "1000 MPa", "poisson_ratio": 0.33, "density": 1500}},
  "bodies": [
    {"name": "left", "material": "m", "velocity": [9.94, 0],
     "geometry": {"type": "ball", "centre": ["13 mm", "14 mm"], "radius": "10 mm"}},
    {"name": "right", "material": "m", "velocity": [-9.94, 0],
     "geometry": {"type": "ball", "centre": ["35 mm", "14 mm"], "radius": "10 mm"}}],
  "solver": {"time_step": 4e-7, "end_time": 2.5e-4}, "output": {"ledger": false}})J";

struct Energies {
  double largest, last;  ///< over the first energy
};
inline Energies collide(const std::vector<std::string>& settings) {
  Scene scene(discs_near_each_other, settings);
  const double first = scene.metrics.initial().total_energy();
  Energies found{0, 0};
  while (!scene.simulation.finished()) {
    found.last = scene.run_steps(5).total_energy() / first;
    found.largest = larger(found.largest, found.last);
  }
  return found;
}

/// The largest gain of energy over the steps of experiments/studies/impacting_discs.json with PIC, contact without friction
/// and FMPM of this order, %.
inline double gain_of_discs(int order, std::vector<std::string> settings) {
  settings.insert(settings.begin(), {set("/transfer/type", "pic"), set_filter("fmpm", order),
                                     R"(/contact={"type": "coulomb", "friction": 0})"});
  Scene scene(mpm::support::read_file(MPM_SOURCE_DIR "/experiments/studies/impacting_discs.json"), settings);
  const double first = scene.metrics.initial().total_energy();
  double largest = first;
  while (!scene.simulation.finished()) largest = larger(largest, scene.run_steps(1).total_energy());
  return 100 * (largest / first - 1);
}

/// The discs of the study on ten cells each.
inline const std::vector<std::string> ten_cells{set("/grid/cell_size", "0.002"), set("/solver/time_step", "4e-7")};

}  // namespace mpm::test::filtered_impact

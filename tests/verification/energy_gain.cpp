// An isolated elastic body never gains energy. A free block that vibrates in its lowest waves, at 0.3 of the largest
// stable step (critical_step.cpp); no particle leaves its cell. `ctest -V` shows the table.

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "lattice.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// With a wave speed of 1 m/s a wave crosses the block in 1 s, and a period lasts 2 s.
const char* block = R"J({
  "title": "free block", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [1.6, 1.2]], "boundaries": {"all": "free"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0, "density": 1000}},
  "bodies": [{"name": "block", "material": "m", "geometry": {"type": "box", "lower": [0.3, 0.3], "upper": [1.3, 0.9]},
              "velocity": ["-0.01*cos(pi*(x-0.3))", "0.005*cos(2*pi*(y-0.3)/0.6)"]}],
  "solver": {"time_step": 0.02, "end_time": 10}})J";

struct Energies {
  double largest, last;    ///< over the first energy
  double lasting_rise;     ///< relative rise of the mean over a period, kept up for two
  double largest_kinetic;  ///< over the first energy
};

/// Velocities belong to the middle of steps, strains to their ends (USF: to their starts): kinetic energies on both
/// sides of a strain are averaged. Added up as they come they would swing by omega dt / 2, 3 % and 10 % of these waves.
/// With USAVG both belong to the ends.
Energies energies_of(Scene& scene, const std::string& update) {
  constexpr int steps_a_period = 100, periods = 5;
  std::vector<double> kinetic, strain;
  for (int k = 0; k <= periods * steps_a_period + 1; ++k) {
    const Totals now = k == 0 ? scene.metrics.initial() : scene.run_steps(1);
    kinetic.push_back(now.kinetic);
    strain.push_back(now.strain);
  }
  const std::size_t back = update == "first" ? 1 : 0, on = update == "last" || update == "modified_last" ? 1 : 0;
  Energies found{0, 0, 0, *std::max_element(kinetic.begin(), kinetic.end()) / kinetic.front()};
  double before = 0, mean = 0, first = 0, rise_before = -1;
  for (std::size_t k = 1; k <= periods * steps_a_period; ++k) {
    const double total = 0.5 * (kinetic[k - back] + kinetic[k + on]) + strain[k];
    if (k == 1) first = total;
    found.last = total / first;
    found.largest = std::max(found.largest, found.last);
    mean += total / steps_a_period;
    if (k % steps_a_period != 0) continue;
    const double rise = before > 0 ? mean / before - 1 : -1;
    found.lasting_rise = std::max(found.lasting_rise, std::min(rise, rise_before));
    rise_before = rise;
    before = std::exchange(mean, 0);
  }
  return found;
}

}  // namespace

TEST_CASE("a free elastic block gains no energy", "[energy_gain]") {
  std::printf("Energy gain: largest and last energy over the first, rise a period that lasts\n");
  for (const auto& [shape, transfer] :
       pairs_of(shapes_present({"linear", "bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp",
                                "cpdi", "cpdi2"}),
                {"pic", "flip", "apic", "mls", "tpic", "rpic", "aflip", "asflip", "polypic"})) {
    std::map<std::string, double> kept;
    for (const std::string update : {"last", "first", "modified_last", "averaged"}) {
      Scene scene(block,
                  {set("/shape/type", shape), set("/transfer/type", transfer), set("/solver/stress_update", update)});
      const Energies e = energies_of(scene, update);
      std::printf("  %-17s %-7s %-13s %.4f %.4f %.5f\n", shape.c_str(), transfer.c_str(), update.c_str(), e.largest,
                  e.last, e.lasting_rise);
      INFO(shape << " " << transfer << " " << update << ": largest " << e.largest << ", last " << e.last << ", rise "
                 << e.lasting_rise);
      // What AFLIP gives the grid is not what it takes back, and energies swing (below): at zero strain they do not
      // rise.
      const bool swings = transfer == "aflip" || transfer == "asflip";
      CHECK((swings ? e.largest_kinetic : e.largest) <= 1.01);
      CHECK(e.lasting_rise <= 1e-3);
      if (transfer == "pic") CHECK(e.last < 0.01);
      kept[update] = e.last;
    }
    if (transfer != "flip") continue;
    // USL takes energy out of the short wave, USF and MUSL leave it.
    INFO(shape);
    CHECK(kept["last"] < 0.8);
    CHECK(kept["modified_last"] > 0.95);
    CHECK(kept["first"] > 0.99);
  }
}

// A cap on what contact may strain a cell by in one correction: no body changes its velocity by more, both by one factor, and an
// impact that turns a light body inside out in one step ends bounded.

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string file = MPM_SOURCE_DIR "/experiments/studies/impact_on_heavy_block.json";
constexpr double cell = 0.1;  // m

std::vector<std::string> with(const std::string& transfer, double courant, double cap) {
  return {set("/transfer/type", '"' + transfer + '"'), set("/solver/courant", digits(courant)),
          set("/contact/strain_cap", digits(cap)), set("/materials/light/youngs_modulus", "0.01")};
}

}  // namespace

TEST_CASE("a strain cap bounds the first change of velocity in an impact, and keeps momentum", "[contact]") {
  for (const std::string backend : {"cpu", "reference"})
    for (const double cap : {0.4, 0.1}) {
      INFO(backend << ", cap " << cap);
      std::vector<std::string> overrides = with("flip", 0.9, cap);
      overrides.push_back(set("/backend", '"' + backend + '"'));
      Scene scene(mpm::support::read_file(file), overrides);
      double slowest = 1;
      Simulation& simulation = scene.simulation;
      while (slowest > 1 - 1e-9) {
        simulation.step();
        const std::vector<double> velocity = scene.body(0).velocity;
        for (std::size_t p = 0; p < velocity.size(); p += 2) slowest = smaller(slowest, velocity[p]);
      }
      // The block bears no force yet. Contact acts on v- and on v+, and particles at the face take nearly what nodes do: of
      // FLIP's the change from v- to v+.
      const double most = cap * cell / simulation.last_time_step();
      CHECK(1 - slowest <= most * (1 + 1e-12));
      CHECK(1 - slowest > 0.9 * most);
      const Totals now = scene.metrics.measure();
      CHECK(std::abs(now.momentum[0] - scene.metrics.initial().momentum[0]) < 1e-12 * 1e4);
    }
}

TEST_CASE("an impact that turns a light body inside out in a step ends bounded under a strain cap", "[contact]") {
  for (const std::string transfer : {"flip", "apic"}) {
    INFO(transfer);
    const auto run = [&](double cap) { Scene(mpm::support::read_file(file), with(transfer, 0.9, cap)).run(); };
    CHECK_THROWS_WITH(run(10), ContainsSubstring("inverted"));
    CHECK_NOTHROW(run(0.2));
  }
}

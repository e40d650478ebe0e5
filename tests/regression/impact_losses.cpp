// What discs and bars lose in an impact, and to which cause of the ledger: the numbers of docs/contact.md. They are the
// program's own, and show what has changed.

#include <cmath>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/page.hpp"
#include "support/scene.hpp"
#include "verification/two_bars.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("what two discs lose in an impact goes in the transfers, as the page on contact says",
          "[impact][ledger][docs]") {
  const Page page("docs/contact.md");
  const auto lost = page.read(
      "with APIC lose # % of their energy on 10 cells a diameter, # % on 20 and # % on 40. The ledger's rows scatter "
      "and gather "
      "have");
  const auto shares = page.read("The ledger's rows scatter and gather have #, # and # % of that");
  const std::string scene_text = mpm::support::read_file(MPM_SOURCE_DIR "/experiments/studies/impacting_discs.json");
  std::printf("Discs in impact, APIC: cells a diameter, energy lost; scatter and gather, contact, residual (%%)\n");
  for (std::size_t k = 0; k < 3; ++k) {
    const double cell = 2e-3 / std::pow(2, static_cast<double>(k));
    Scene scene(scene_text, {set("/grid/cell_size", digits(cell)), set("/shape/type", "bspline_quadratic"),
                             set("/transfer/type", "apic"), R"(/contact={"type": "coulomb", "friction": 0})",
                             set("/solver/time_step", "auto"), set("/output/ledger", "true")});
    const double start = scene.metrics.initial().total_energy();
    const Totals end = scene.run();
    const Ledger& ledger = scene.simulation.ledger();
    const double loss = start - end.total_energy(), transfers = -(ledger.scatter + ledger.gather);
    std::printf("  %.0f  %.2f; %.2f %.2f %.2f\n", 0.02 / cell, 100 * loss / start, 100 * transfers / start,
                -100 * ledger.contact / start, -100 * scene.metrics.ledger_residual(end) / start);
    CHECK(100 * loss / start == lost[k].rounded());
    CHECK(100 * transfers / loss == shares[k].rounded());
  }
}

namespace {

/// The shares of the causes in what is lost, and the loss in the start's energy, %.
struct Losses {
  double lost, transfers, contact, integration;
};
Losses losses(const std::string& courant) {
  Scene scene(mpm::support::read_file(MPM_SOURCE_DIR "/experiments/studies/impacting_discs.json"),
              {set("/grid/cell_size", "0.001"), set("/shape/type", "bspline_quadratic"), set("/transfer/type", "apic"),
               R"(/contact={"type": "coulomb", "friction": 0})", set("/solver/time_step", "auto"),
               set("/solver/courant", courant), set("/output/ledger", "true")});
  const double start = scene.metrics.initial().total_energy();
  const Totals end = scene.run();
  const Ledger& ledger = scene.simulation.ledger();
  const double loss = start - end.total_energy();
  return {100 * loss / start, -100 * (ledger.scatter + ledger.gather) / loss, -100 * ledger.contact / loss,
          -100 * scene.metrics.ledger_residual(end) / loss};
}

}  // namespace

// The law takes no energy, and the residual is that of time integration: both vanish with the step, and the transfers,
// which damp once a step, have all of the loss.
TEST_CASE("the shorter the step the more two discs lose in an impact, all of it in the transfers",
          "[impact][ledger][docs]") {
  const Page page("docs/contact.md");
  std::vector<Losses> found;
  for (const std::string courant : {"0.3", "0.1", "0.03"}) {
    INFO(courant);
    const auto row = page.read("| " + courant + " | # | # | # | # |");
    found.push_back(losses(courant));
    CHECK(found.back().lost == row[0].rounded());
    CHECK(found.back().transfers == row[1].rounded());
    CHECK(found.back().contact == row[2].rounded());
    CHECK(found.back().integration == row[3].rounded());
  }
  for (std::size_t k = 1; k < found.size(); ++k) {
    CHECK(found[k].lost > found[k - 1].lost);
    CHECK(std::abs(found[k].contact) < 0.5 * std::abs(found[k - 1].contact));
    CHECK(found[k].integration < 0.6 * found[k - 1].integration);
  }
}

// FLIP keeps what the transfer would damp, but USL damps short waves in every step, and contact makes more of these.
TEST_CASE("what FLIP loses in an impact of bars is the damping of stress updated last", "[impact][docs]") {
  const auto lost = [](bool two, const std::string& update, const std::string& courant) {
    std::vector<std::string> settings{set("/shape/type", "bspline_quadratic"),
                                      "/solver/time_step=auto",
                                      "/solver/end_time=0.02",
                                      set("/grid/boundaries/y_min", "periodic"),
                                      set("/grid/boundaries/y_max", "periodic"),
                                      set("/solver/stress_update", update),
                                      set("/solver/courant", courant)};
    if (!two) settings.emplace_back("/contact=null");
    Scene scene(two_bars, settings);
    const double start = scene.metrics.initial().total_energy();
    return 100 * (1 - scene.run().total_energy() / start);
  };
  const Page page("docs/contact.md");
  const auto coarse =
                 page.read("on 100 cells a bar # % as two bodies and # % as one at `courant` 0.3, # and # % at 0.03"),
             by_musl = page.read("by MUSL it is # and # % at `courant` 0.3");
  CHECK(lost(true, "last", "0.3") == coarse[0].rounded());
  CHECK(lost(false, "last", "0.3") == coarse[1].rounded());
  CHECK(lost(true, "last", "0.03") == coarse[2].rounded());
  CHECK(lost(false, "last", "0.03") == coarse[3].rounded());
  CHECK(lost(true, "modified_last", "0.3") == by_musl[0].rounded());
  CHECK(lost(false, "modified_last", "0.3") == by_musl[1].rounded());
}

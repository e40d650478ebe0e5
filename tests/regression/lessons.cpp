// What lessons 1 and 2 of docs/lessons and the pages of the quickstart claim, on the very files the pages name. The
// numbers are read from the pages. They are the program's own: they show what has changed, and are no verification.

#include <cmath>
#include <string>

#include "support/catch.hpp"
#include "support/lesson.hpp"
#include "support/page.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

double kept_spin(const Lesson& lesson, const Totals& end) {
  return end.angular_momentum[2] / lesson.metrics.initial().angular_momentum[2];
}

/// The share of the wave's energy that is left: the flight of the whole bar does not count.
double kept_wave(const Lesson& lesson, const Totals& end, double drift) {
  const Totals& start = lesson.metrics.initial();
  const double flight = 0.5 * start.mass * drift * drift;
  return (end.total_energy() - flight) / (start.total_energy() - flight);
}

Page first("docs/lessons/1_transfers.md");
const Claim half_gone(first, "half of the spin is gone after # s, a twenty-fifth of a turn"),
    flip_spin(first, "**FLIP**: # % of the spin is left after two turns"),
    apic_spin(first, "less than # of it is lost"), energies(first, "FLIP keeps # % of the energy and APIC # %"),
    affine_energy(first, "APIC's curve begins # % higher"),
    velocity_errors(first, "error of the velocity is # m/s in FLIP and # m/s in APIC, of # m/s"),
    position_error(first, "but # m away after an arc of about # m"),
    stretch(first, "Spinning stretches it by up to # %"),
    a_bit_of_pic(first, "One per cent a step, # steps: # % of the spin is left"),
    inverted(first, "the run stops after # s (exit code 3)"),
    linear_spin(first, "Up to then # % of the spin is lost too");

Page second("docs/lessons/2_cell_crossing.md");
const Claim wave_energy(second, "between zero and # J/m, twice a period"),
    left_of_wave(second, "in flight: # % of the wave's energy is left, # % at rest with linear shapes"),
    left_in_flight(second, "With linear shapes in flight only # % is left"),
    stretches(second, "B-splines reach #, linear shapes at rest #, in flight #:"),
    gain_at_rest(second, "the total energy rose by # %,");

}  // namespace

TEST_CASE("lessons 1 and 2: every number of the pages is read by a test or given by the scene", "[lesson][docs]") {
  second.add_given(
      {"start with 0.5 m/s plus a standing wave of 0.5 m/s. The wave speed is 10 m/s, so the wave strains the",
       "bar by 5 % and has a period of 0.1 s. The wave alone moves a particle by 8 mm; the nearest cell face",
       "is 12.5 mm away", "every particle crosses a face every 0.1 s", "jumps from +1/h to −1/h",
       "stretched to 1.05 at most", ", and then 5. Slow flight"});
  // Quantities in words: what the scenes set, and what follows from it.
  first.add_given({"*worse*: twice as many averages"});
  second.add_given({"The third run stops the flight", "after five periods and a quarter",
                    "more than one per cent out of nothing", "Cells half as large are crossed twice as often",
                    "Each kick is half as large"});
  for (const Page* page : {&first, &second}) {
    CHECK(page->numbers_of_nobody() == std::vector<std::string>{});
    CHECK(page->words_of_nobody() == std::vector<std::string>{});
  }
}

TEST_CASE("lesson 1: PIC stops the disc, FLIP keeps most of its spin, APIC all", "[lesson]") {
  {
    Lesson lesson("spinning_disc_pic");
    double half = -1;
    while (half < 0 && !lesson.simulation.finished()) {
      lesson.simulation.step();
      const Totals now = lesson.metrics.measure();
      if (kept_spin(lesson, now) < 0.5) half = now.time;
    }
    CHECK(half == half_gone[0]);
    CHECK(std::abs(kept_spin(lesson, lesson.run())) < 0.001);
  }
  Lesson flip("spinning_disc_flip"), apic("spinning_disc_apic");
  const Totals flip_end = flip.run(), apic_end = apic.run();
  CHECK(100 * kept_spin(flip, flip_end) == flip_spin[0]);
  CHECK(100 * kept_energy(flip, flip_end) == energies[0]);
  CHECK(flip_end.velocity_error_rms == velocity_errors[0]);

  CHECK(std::abs(kept_spin(apic, apic_end) - 1) < apic_spin.number(0));
  CHECK(100 * kept_energy(apic, apic_end) == energies[1]);
  CHECK(apic_end.velocity_error_rms == velocity_errors[1]);
  CHECK(apic_end.position_error_rms == position_error[0]);
  CHECK(100 * (apic.metrics.initial().total_energy() / flip.metrics.initial().total_energy() - 1) == affine_energy[0]);
  CHECK(100 * (apic.largest_volume_ratio - 1) == stretch[0]);

  // A point of a turning disc of radius R has R / sqrt(2) times the angular speed, root mean square over the area.
  const double pi = std::acos(-1.0), mean_radius = 0.5 / std::sqrt(2.0);
  CHECK(2 * pi * mean_radius == velocity_errors[2]);
  CHECK(2 * 2 * pi * mean_radius == position_error[1]);
}

TEST_CASE("lesson 1: a little PIC in FLIP, and linear shapes in APIC", "[lesson]") {
  Lesson mixed("spinning_disc_flip", {"/transfer/pic_fraction=0.01"});
  CHECK(100 * kept_spin(mixed, mixed.run()) == a_bit_of_pic[1]);
  CHECK(static_cast<double>(mixed.simulation.steps()) == a_bit_of_pic[0]);

  Lesson linear("spinning_disc_apic", {"/shape/type=linear"});
  Totals last = linear.metrics.initial();
  CHECK_THROWS_AS(
      [&] {
        for (;;) last = linear.step();
      }(),
      RunFailure);
  CHECK(last.time == inverted[0]);
  CHECK(100 * (1 - kept_spin(linear, last)) == linear_spin[0]);
}

TEST_CASE("lesson 2: crossing cells makes noise with linear shapes and none with B-splines", "[lesson]") {
  Lesson linear("cell_crossing_linear"), spline("cell_crossing_bspline"),
      resting("cell_crossing_linear", {"/constants/drift=0"});
  const Totals linear_end = linear.run(), spline_end = spline.run(), resting_end = resting.run();
  CHECK(resting.metrics.initial().total_energy() == wave_energy[0]);

  CHECK(100 * kept_wave(spline, spline_end, 0.5) == left_of_wave[0]);
  CHECK(100 * kept_wave(resting, resting_end, 0) == left_of_wave[1]);
  CHECK(100 * kept_wave(linear, linear_end, 0.5) == left_in_flight[0]);
  CHECK(spline.largest_volume_ratio == stretches[0]);
  CHECK(resting.largest_volume_ratio == stretches[1]);
  CHECK(linear.largest_volume_ratio == stretches[2]);
  CHECK(100 * (resting.largest_energy / resting.metrics.initial().total_energy() - 1) == gain_at_rest[0]);
}

TEST_CASE("quickstart: the energies that README, getting started and the method name", "[lesson][docs]") {
  const Page method("docs/method.md"), start("docs/getting_started.md");
  Lesson apic("../quickstart"), pic("../quickstart", {"/transfer/type=pic"});
  const Totals end = apic.run();
  const std::string readme = mpm::support::read_file(MPM_SOURCE_DIR "/README.md");
  const std::regex ratio("quickstart (0\\.[0-9]+)");  // in a row of each release that was tried
  const std::sregex_iterator first_row(readme.begin(), readme.end(), ratio), none;
  CHECK(first_row != none);
  for (auto row = first_row; row != none; ++row) CHECK(kept_energy(apic, end) == printed_number((*row)[1]).rounded());

  const auto printed =
      method.read("the residual ends at # J/m of # J/m, beside # for scatter, # for gather and # for contact");
  const Ledger& ledger = apic.simulation.backend().ledger();
  CHECK(apic.metrics.ledger_residual(end) == printed[0].rounded());
  CHECK(apic.metrics.initial().total_energy() == printed[1].rounded());
  CHECK(ledger.scatter == printed[2].rounded());
  CHECK(ledger.gather == printed[3].rounded());
  CHECK(ledger.contact == printed[4].rounded());

  const auto of_steps =
      method.read("of the quickstart's energy it is # % with steps of 4 ms and # % with steps of 1 ms");
  for (const auto& [step, share] : {std::pair{"0.004", of_steps[0]}, std::pair{"0.001", of_steps[1]}}) {
    INFO("steps of " << step << " s");
    Lesson fixed("../quickstart", {"/solver/time_step=" + std::string(step)});
    const double residual = fixed.metrics.ledger_residual(fixed.run());
    CHECK(100 * std::abs(residual) / fixed.metrics.initial().total_energy() == share.rounded());
  }

  // "With PIC half of the energy is gone at the end", of which the file expects a share to be left.
  const double kept = kept_energy(pic, pic.run());
  CHECK(kept == Approx(0.5).margin(0.05));
  CHECK(100 * kept > start.read("expects at least # % to be left").front().value);
}

// What lessons 1 and 2 of docs/lessons claim, on the very files the pages name. Most numbers are the
// program's own, as printed there: they show what has changed, and are no verification.

#include <cmath>
#include <string>

#include "support/catch.hpp"
#include "support/lesson.hpp"

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

}  // namespace

TEST_CASE("lesson 1: PIC stops the disc, FLIP keeps 98 % of its spin, APIC all", "[lesson]") {
  {
    Lesson lesson("spinning_disc_pic");
    double half = -1;
    while (half < 0 && !lesson.simulation.finished()) {
      lesson.simulation.step();
      const Totals now = lesson.metrics.measure();
      if (kept_spin(lesson, now) < 0.5) half = now.time;
    }
    CHECK(half == Approx(0.04).margin(0.005));  // "half of the spin is gone after 0.04 s"
    CHECK(std::abs(kept_spin(lesson, lesson.run())) < 0.001);
  }
  {
    Lesson lesson("spinning_disc_flip");
    const Totals end = lesson.run();
    CHECK(kept_spin(lesson, end) == Approx(0.98).margin(0.005));
    CHECK(kept_energy(lesson, end) == Approx(0.96).margin(0.005));
    CHECK(end.velocity_error_rms == Approx(0.70).margin(0.05));
  }
  {
    Lesson lesson("spinning_disc_apic");
    const Totals end = lesson.run();
    CHECK(std::abs(kept_spin(lesson, end) - 1) < 1e-10);
    CHECK(kept_energy(lesson, end) == Approx(0.999).margin(0.001));
    CHECK(end.velocity_error_rms == Approx(0.16).margin(0.02));
    CHECK(end.position_error_rms == Approx(0.0145).margin(0.002));
  }
}

TEST_CASE("lesson 2: crossing cells makes noise with linear shapes and none with B-splines", "[lesson]") {
  {
    Lesson lesson("cell_crossing_linear");
    const Totals end = lesson.run();
    CHECK(kept_wave(lesson, end, 0.5) == Approx(0.67).margin(0.02));
    CHECK(lesson.largest_volume_ratio == Approx(1.074).margin(0.003));
  }
  {
    Lesson lesson("cell_crossing_bspline");
    const Totals end = lesson.run();
    CHECK(kept_wave(lesson, end, 0.5) == Approx(0.98).margin(0.005));
    CHECK(lesson.largest_volume_ratio == Approx(1.051).margin(0.002));
  }
  {
    Lesson lesson("cell_crossing_linear", {set("/constants/drift", "0")});
    const Totals end = lesson.run();
    CHECK(kept_wave(lesson, end, 0) == Approx(0.985).margin(0.005));
    CHECK(lesson.largest_volume_ratio == Approx(1.055).margin(0.003));
  }
}

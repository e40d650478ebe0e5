// Which numbers stand on an axis, and how they are written.
#include "render/numbers.hpp"

#include <cmath>
#include <set>
#include <string>

#include "render/chart.hpp"
#include "support/catch.hpp"

using namespace mpm::render;

TEST_CASE("linear ticks are multiples of 1, 2 or 5 times a power of ten", "[figures]") {
  const double lo = GENERATE(-3.7, 0.0, 1e-7, 12345.0);
  const double span = GENERATE(1e-9, 0.03, 1.0, 7.3, 41000.0, 6e12);
  const int count = GENERATE(2, 5, 8);
  const Ticks ticks = linear_ticks(lo, lo + span, count);
  REQUIRE(ticks.major.size() >= 1);
  REQUIRE(ticks.major.size() <= static_cast<std::size_t>(2 * count + 1));
  REQUIRE(ticks.labels.size() == ticks.major.size());
  CHECK(std::set<std::string>(ticks.labels.begin(), ticks.labels.end()).size() == ticks.labels.size());
  if (ticks.major.size() < 2) return;
  const double step = ticks.major[1] - ticks.major[0];
  const double lead = step / std::pow(10.0, std::floor(std::log10(step) + 1e-4));
  const double nearest = lead < 1.5 ? 1 : lead < 3.5 ? 2 : 5;
  // The difference of two large ticks carries their rounding.
  CHECK(lead == Approx(nearest).epsilon(1e-3));
  for (const double value : ticks.major) {
    CHECK(value >= lo - 1e-5 * span);
    CHECK(value <= lo + span + 1e-5 * span);
  }
}

TEST_CASE("a common factor keeps axis numbers short", "[figures]") {
  const Ticks pressure = linear_ticks(0, 42000, 5);
  CHECK(pressure.exponent == 3);
  CHECK(pressure.labels == std::vector<std::string>{"0", "10", "20", "30", "40"});
  CHECK(linear_ticks(0, 0.004, 4).exponent == -3);
  CHECK(linear_ticks(0, 2.5, 5).exponent == 0);
  CHECK(with_factor("stress σ (Pa)", 3) == "stress σ (10³ Pa)");
  CHECK(with_factor("relative error e (–)", -6) == "relative error e (10⁻⁶)");
  CHECK(with_factor("count", 3) == "count (10³)");
  CHECK(with_factor("stress σ (Pa)", 0) == "stress σ (Pa)");
}

TEST_CASE("zero is written without a sign, negatives with a true minus", "[figures]") {
  const Ticks ticks = linear_ticks(-1, 1, 4);
  CHECK(ticks.labels == std::vector<std::string>{"−1.0", "−0.5", "0.0", "0.5", "1.0"});
  CHECK(fixed(-0.0001, 2) == "0.00");
}

TEST_CASE("logarithmic axes mark decades and what lies between", "[figures]") {
  const Ticks wide = log_ticks(1e-9, 1e-2, 8);
  CHECK(wide.labels.front() == "10⁻⁹");
  CHECK(wide.labels.size() == 8);
  CHECK(wide.minor.size() == 7 * 8);
  const Ticks narrow = log_ticks(0.01, 0.1, 8);
  CHECK(narrow.labels == std::vector<std::string>{"0.01", "0.02", "0.05", "0.1"});
  const Ticks huge = log_ticks(1e-30, 1e30, 6);
  CHECK(huge.labels.size() <= 8);
  const Ticks within_one = log_ticks(2.1, 4.4, 5);
  CHECK(within_one.labels.size() >= 2);
}

TEST_CASE("an axis of both signs marks zero and the decades on either side of it", "[figures]") {
  const Ticks ticks = signed_log_ticks(-300, 2e4, 1, 8);
  CHECK(ticks.labels == std::vector<std::string>{"−10²", "−10¹", "−1", "0", "1", "10¹", "10²", "10³", "10⁴"});
  REQUIRE(ticks.major.size() == ticks.labels.size());
  CHECK(ticks.major.front() == -100);
  CHECK(ticks.major.back() == 1e4);
  CHECK(signed_log_ticks(-1e9, 1e9, 1e-3, 6).labels.size() <= 9);
  CHECK(signed_log_ticks(0.5, 3e3, 0.1, 9).labels.front() == "1");
  CHECK(signed_log_ticks(-5e5, 1e3, 1e9, 8).labels.size() >= 3);  // no decade is in the range
  const Axis axis = make_signed_log_axis({-100, 1e4}, 1, 0, 8);
  CHECK(axis.fraction(-100) == Approx(0).margin(1e-12));
  CHECK(axis.fraction(1e4) == Approx(1));
  CHECK(axis.fraction(0) == Approx(std::log(101.0) / (std::log(101.0) + std::log(10001.0))));
  CHECK(axis.fraction(0) - axis.fraction(-0.01) == Approx(axis.fraction(0.01) - axis.fraction(0)));
}

TEST_CASE("numbers are plain or a power of ten, never 1e+05", "[figures]") {
  CHECK(compact(0) == "0");
  CHECK(compact(1.7250) == "1.725");
  CHECK(compact(12345) == "12\u2009345");
  CHECK(compact(1e5) == "10⁵");
  CHECK(compact(-2.5e-7) == "−2.5×10⁻⁷");
  CHECK(compact(0.001) == "0.001");
  CHECK(fixed(1234567, 0) == "1\u2009234\u2009567");
  CHECK(fixed(1234, 0) == "1234");
  CHECK(power_of_ten(-12) == "10⁻¹²");
  for (double v = 1e-20; v < 1e20; v *= 3.7) CHECK(compact(v).find('e') == std::string::npos);
}

TEST_CASE("the scale bar's length is a nice number not above the room", "[figures]") {
  CHECK(nice_below(0.25) == Approx(0.2));
  CHECK(nice_below(1.0) == Approx(1.0));
  CHECK(nice_below(0.99) == Approx(0.5));
  CHECK(nice_below(73) == Approx(50));
}

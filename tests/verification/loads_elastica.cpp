// A cantilever under a dead load at its tip against the elastica, for which theta'' = -k cos(theta), k = P L^2 / EI, with
// theta(0) = 0 and theta'(1) = 0 (Bisshopp & Drucker 1945, Quart. Appl. Math. 3:272).

#include <array>
#include <cmath>
#include <numbers>

#include "beam_tip.hpp"
#include "shipped.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

struct Tip {
  double x = 0, y = 0, angle = 0;  ///< over the length, y along the load; rad
};

/// Integrates from the free end, where theta' is zero and theta a guess, back to the clamp by Runge-Kutta of fourth
/// order, and shoots for theta(0) = 0.
Tip elastica(double k) {
  using State = std::array<double, 4>;  // theta, theta', x, y over s from the tip
  const auto from_tip = [&](double angle) {
    constexpr int n = 4000;
    constexpr double d = 1.0 / n;
    State at{angle, 0, 0, 0};
    const auto slope = [&](const State& s) { return State{s[1], -k * std::cos(s[0]), std::cos(s[0]), std::sin(s[0])}; };
    const auto along = [](State from, double by, const State& way) {
      for (int i = 0; i < 4; ++i) from[i] += by * way[i];
      return from;
    };
    for (int step = 0; step < n; ++step) {
      const State k1 = slope(at), k2 = slope(along(at, d / 2, k1)), k3 = slope(along(at, d / 2, k2)),
                  k4 = slope(along(at, d, k3));
      for (int i = 0; i < 4; ++i) at[i] += d / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    return at;  // x and y are those of the clamp seen from the tip, against the beam's direction
  };
  double low = 0, high = std::numbers::pi / 2;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (from_tip(middle)[0] < 0 ? low : high) = middle;
  }
  const State clamp = from_tip(low);
  return {clamp[2], clamp[3], low};
}

Tip tip_of(const std::vector<double>& X, const std::vector<double>& x) {
  const auto [tip, way] = end_of_beam(X, x, 1);
  return {tip[0], -tip[1], -std::atan2(way[1], way[0])};
}

Tip bend(const std::vector<std::string>& overrides) {
  ShippedScene scene("loads/tip_load.json", overrides);
  const std::vector<double> X = scene.simulation.backend().body_state(0).position;
  const Totals end = scene.run();
  REQUIRE(scene.failure.empty());
  CHECK(end.largest_speed < 2e-3);
  return tip_of(X, scene.simulation.backend().body_state(0).position);
}

void check(const std::string& name, const Tip& found, const Tip& exact, double bound) {
  std::printf("  %-28s %.5f %.5f %.4f | %.5f %.5f %.4f\n", name.c_str(), found.x, found.y, found.angle, exact.x,
              exact.y, exact.angle);
  INFO(name);
  CHECK(std::hypot(found.x - exact.x, found.y - exact.y) < bound);
  CHECK(std::abs(found.angle - exact.angle) < 2 * bound);
}

}  // namespace

TEST_CASE("loads: the elastica agrees with its published values", "[loads][elastica]") {
  // Bisshopp & Drucker; Mattiasson 1981, Int. J. Numer. Meth. Engng 17:145, table I: w / L and u / L at P L^2 / EI.
  for (const auto& [k, w, u] : {std::array{1., 0.30172, 0.05643}, std::array{2., 0.49346, 0.16064},
                                std::array{5., 0.71379, 0.38763}, std::array{10., 0.81061, 0.55500}}) {
    const Tip tip = elastica(k);
    CHECK(tip.y == Approx(w).margin(6e-6));
    CHECK(1 - tip.x == Approx(u).margin(6e-6));
  }
}

TEST_CASE("loads: a cantilever under a load at its tip is the elastica", "[loads][elastica]") {
  std::printf("Tip load: tip x, y over L and angle | the elastica's\n");
  check("traction, k = 1", bend({}), elastica(1), 0.01);
}

TEST_CASE("loads: cantilevers on finer cells and at higher loads", "[loads][elastica][slow]") {
  std::printf("Tip load: tip x, y over L and angle | the elastica's\n");
  const std::vector<std::string> fine{set("/grid/cell_size", "0.0125"), set("/shape/type", "cpdi2")};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), fine.begin(), fine.end());
    return bend(more);
  };
  check("traction, k = 1, h = 12.5 mm", with({}), elastica(1), 0.005);
  check("traction, k = 2, h = 12.5 mm", with({set("/constants/P", digits(2 * 11.446886446886447))}), elastica(2),
        0.005);
  check("force at the tip, k = 1",
        with({R"(/loads/0={"type": "force", "body": "beam", "at": [1, 0], "force": [0, "-P"]})"}), elastica(1), 0.005);
}

// Case C8: large deflection of a cantilever under its own weight, against the inextensible elastica. PIC damps the beam
// to rest (a balance of forces does not depend on the transfer); `ctest -V` shows the tables.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shipped.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double length = 1, thickness = 0.05, modulus = 1e6, poisson = 0.3, density = 1000;
constexpr double stiffness = modulus * thickness * thickness * thickness / (12 * (1 - poisson * poisson));

// H / L = 1 / 20, held at x = 0.
const char* beam = R"J({
  "dimension": 2,
  "grid": {"cell_size": 0.0125, "domain": [[0, -1], [1.1, 0.1]], "boundaries": {"all": "free", "x_min": "stick"}},
  "shape": {"type": "cpdi"}, "transfer": {"type": "pic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "beam", "material": "m", "geometry": {"type": "box", "lower": [0, -0.025], "upper": [1, 0.025]}}],
  "gravity": [0, -1],
  "solver": {"time_step": "auto", "courant": 0.4, "end_time": 1}, "output": {"ledger": false}})J";

/// Tip of the elastica under kappa = q L^3 / EI, by shooting: theta'' = -kappa (1 - s) cos(theta), theta(0) = 0,
/// theta'(1) = 0; Runge-Kutta of fourth order. @returns x, y (downwards) over L.
std::pair<double, double> elastica(double kappa) {
  const auto shoot = [kappa](double slope, double& x, double& y) {
    constexpr int n = 2000;
    constexpr double d = 1.0 / n;
    double s = 0, theta = 0;
    x = y = 0;
    const auto bend = [kappa](double at, double angle) { return -kappa * (1 - at) * std::cos(angle); };
    for (int k = 0; k < n; ++k) {
      const double k1 = slope, l1 = bend(s, theta), k2 = slope + d / 2 * l1, l2 = bend(s + d / 2, theta + d / 2 * k1),
                   k3 = slope + d / 2 * l2, l3 = bend(s + d / 2, theta + d / 2 * k2), k4 = slope + d * l3,
                   l4 = bend(s + d, theta + d * k3);
      const double next = theta + d / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      // Simpson with the middle from Hermite's cubic.
      const double middle = 0.5 * (theta + next) + d / 8 * (slope - (slope + d / 6 * (l1 + 2 * l2 + 2 * l3 + l4)));
      x += d / 6 * (std::cos(theta) + 4 * std::cos(middle) + std::cos(next));
      y += d / 6 * (std::sin(theta) + 4 * std::sin(middle) + std::sin(next));
      slope += d / 6 * (l1 + 2 * l2 + 2 * l3 + l4), theta = next, s += d;
    }
    return slope;
  };
  double low = 0, high = kappa, x = 0, y = 0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (shoot(middle, x, y) < 0 ? low : high) = middle;
  }
  return {x, y};
}

struct Rest {
  double x = 0, y = 0;  ///< of the tip, over L
  double speed = 0;     ///< m/s, largest
};

Rest settle(double kappa, const std::vector<std::string>& more = {}) {
  const double q = kappa * stiffness / (length * length * length), gravity = q / (density * thickness);
  std::vector<std::string> settings{set("/gravity", "[0, " + digits(-gravity) + "]")};
  settings.insert(settings.end(), more.begin(), more.end());
  Scene scene(beam, settings);
  const std::vector<double> X = scene.body().position;
  const Totals end = scene.run();
  const std::vector<double> x = scene.body().position;
  // The end of the middle line, from the four particles beside it in the last two columns.
  Rest rest{.speed = end.largest_speed};
  double last = 0, next = 0;
  for (std::size_t p = 0; p < X.size(); p += 2) last = std::max(last, X[p]);
  for (std::size_t p = 0; p < X.size(); p += 2)
    if (X[p] < last - 1e-9) next = std::max(next, X[p]);
  double sum[2][2] = {}, count[2] = {};
  for (std::size_t p = 0; p < X.size(); p += 2) {
    const int column = X[p] > last - 1e-9 ? 0 : X[p] > next - 1e-9 ? 1 : 2;
    if (column == 2) continue;
    sum[column][0] += x[p], sum[column][1] += x[p + 1], count[column] += 1;
  }
  const double far = (length - last) / (last - next);
  double tip[2];
  for (int c = 0; c < 2; ++c) tip[c] = (1 + far) * sum[0][c] / count[0] - far * sum[1][c] / count[1];
  rest.x = tip[0] / length, rest.y = -tip[1] / length;
  return rest;
}

}  // namespace

TEST_CASE("C8 the elastica's tip", "[C][C8]") {
  struct Row {
    double kappa, x, y, margin;
  };
  for (const Row& row : {Row{.8, .994358026888, .099211214558, 1e-10}, Row{2, .966892947, .238506583, 5.1e-10},
                         Row{6, .803725299, .553923869, 5.1e-10}, Row{10, .656353761, .700199716, 5.1e-10},
                         Row{20, .445232052, .829881443, 5.1e-10}}) {
    const auto [x, y] = elastica(row.kappa);
    INFO(row.kappa << ": " << digits(x) << " " << digits(y));
    CHECK(std::abs(x - row.x) < row.margin);
    CHECK(std::abs(y - row.y) < row.margin);
  }
}

namespace {

void check_rest(const std::string& shape, double cell, double end, const std::vector<double>& kappas, double bound) {
  for (const double kappa : kappas) {
    const auto [x, y] = elastica(kappa);
    const Rest rest = settle(
        kappa, {set("/shape/type", shape), set("/grid/cell_size", digits(cell)), set("/solver/end_time", digits(end))});
    std::printf("  %-18s %.4f %4.1f | %.5f %.5f | %.5f %.5f | %.2e\n", shape.c_str(), cell, kappa, rest.x, rest.y, x, y,
                rest.speed);
    INFO(shape << " h = " << cell << " kappa = " << kappa << ": " << rest.x << " " << rest.y);
    CHECK(std::hypot(rest.x - x, rest.y - y) < bound);
    CHECK(rest.speed < 0.01);
  }
}

}  // namespace

TEST_CASE("C8 a beam at rest under its own weight", "[C][C8]") {
  std::printf("C8: shape, cell (m), kappa | tip x, y over L | exact | largest speed (m/s)\n");
  check_rest("cpdi", 0.025, 8, {.8, 6}, 0.03);
}

TEST_CASE("C8 beams at rest, every load and finer cells", "[C][C8][slow]") {
  std::printf("C8: shape, cell (m), kappa | tip x, y over L | exact | largest speed (m/s)\n");
  check_rest("cpdi", 0.025, 12, {.8, 2, 6, 10, 20}, 0.03);
  check_rest("cpdi", 0.0125, 12, {.8, 2, 6}, 0.01);
  // The elastica neither shears nor stretches. At H / L = 1 / 20 shear adds kappa (H / L)^2 / (10 (1 - nu)) = 3.6e-4
  // kappa and stretch kappa (H / L)^2 / 24 = 1.0e-4 kappa: under large loads about half of the difference.
  check_rest("cpdi", 0.0125, 12, {10, 20}, 0.025);
}

// A thick tube under inner pressure against Lame's solution in plane strain, as rings and as a quarter of its section:
//   u(r) = (1 + nu) / E p a^2 / (b^2 - a^2) ((1 - 2 nu) r + b^2 / r).

#include <cmath>
#include <map>

#include "shipped.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double a = 0.1, b = 0.2, modulus = 1e6, nu = 0.3, pressure = 100;

double lame(double r) {
  return (1 + nu) / modulus * pressure * a * a / (b * b - a * a) * ((1 - 2 * nu) * r + b * b / r);
}

/// The displacement at the inner radius over Lame's, less 1. The field is fitted as A r + B / r, which it is, to the
/// particles of the wall, by least squares; `misfit` is what is left, rms over u(a).
struct Found {
  double error = 0, misfit = 0;
};

Found inner_displacement(const std::string& file, int cells, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides{set("/grid/cell_size", digits(0.1 / cells)), set("/output/ledger", "false")};
  if (file == "loads/tube.json")  // one row of cells
    overrides.insert(overrides.end(), {"/grid/domain=[[0.05, 0], [0.25, " + digits(0.1 / cells) + "]]",
                                       "/bodies/0/geometry/upper=[0.2, " + digits(0.1 / cells) + "]"});
  overrides.insert(overrides.end(), more.begin(), more.end());
  ShippedScene scene(file, overrides);
  const std::vector<double> X = scene.simulation.backend().body_state(0).position;
  scene.run();
  REQUIRE(scene.failure.empty());
  const std::vector<double> x = scene.simulation.backend().body_state(0).position;
  const bool rings = scene.experiment.axisymmetric();
  double normal[2][2] = {}, right[2] = {};
  const auto each = [&](const auto& visit) {
    for (std::size_t p = 0; p < X.size(); p += 2) {
      const double r = rings ? X[p] : std::hypot(X[p], X[p + 1]);
      const double u = rings ? x[p] - X[p] : ((x[p] - X[p]) * X[p] + (x[p + 1] - X[p + 1]) * X[p + 1]) / r;
      visit(r, u);
    }
  };
  each([&](double r, double u) {
    const double of[2] = {r, 1 / r};
    for (int i = 0; i < 2; ++i) {
      right[i] += of[i] * u;
      for (int j = 0; j < 2; ++j) normal[i][j] += of[i] * of[j];
    }
  });
  const double determinant = normal[0][0] * normal[1][1] - normal[0][1] * normal[1][0];
  const double A = (right[0] * normal[1][1] - right[1] * normal[0][1]) / determinant,
               B = (right[1] * normal[0][0] - right[0] * normal[1][0]) / determinant;
  double sum = 0, count = 0;
  each([&](double r, double u) { sum += std::pow(u - A * r - B / r, 2), count += 1; });
  return {(A * a + B / a) / lame(a) - 1, std::sqrt(sum / count) / lame(a)};
}

}  // namespace

TEST_CASE("loads: rings under inner pressure widen as Lame says", "[loads][tube]") {
  CHECK(lame(a) == Approx(1.9066666667e-5).epsilon(1e-9));
  std::printf("Tube, rings: cells of wall, error of u(a), misfit of A r + B / r\n");
  std::vector<double> errors;
  for (const int cells : {4, 8, 16}) {
    const Found found = inner_displacement("loads/tube.json", cells);
    std::printf("  %2d %+.5f %.5f\n", cells, found.error, found.misfit);
    errors.push_back(std::abs(found.error));
  }
  CHECK(errors[0] < 0.01);
  CHECK(errors[1] < 0.005);
  CHECK(errors[2] < 0.0025);
}

TEST_CASE("loads: a quarter of a tube under inner pressure widens as Lame says", "[loads][tube]") {
  std::printf("Tube, quarter: cells of wall, error of u(a), misfit of A r + B / r\n");
  std::vector<double> errors;
  for (const int cells : {4, 8}) {
    const Found found = inner_displacement("loads/quarter_tube.json", cells);
    std::printf("  %2d %+.5f %.5f\n", cells, found.error, found.misfit);
    errors.push_back(std::abs(found.error));
  }
  CHECK(errors[1] < 0.005);
}

TEST_CASE("loads: a quarter of a tube on finer cells", "[loads][tube][slow]") {
  const Found found = inner_displacement("loads/quarter_tube.json", 16);
  std::printf("Tube, quarter: 16 cells of wall, error of u(a) %+.5f, misfit %.5f\n", found.error, found.misfit);
  CHECK(std::abs(found.error) < 0.005);
}

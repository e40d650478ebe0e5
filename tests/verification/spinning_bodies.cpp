// Spinning bodies: mass moments, energy, what each transfer keeps of the spin, the stress of a disc that spins
// steadily, and the turned stress of laws that conformance/turned_strain.cpp leaves out. `ctest -V` shows the tables.
//
// Ten turns, and what FLIP and XPIC lose and why: spin_lost.cpp.

#include <cmath>
#include <numbers>

#include "materials/fixed_corotated/fixed_corotated.hpp"
#include "spinning_disc.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double pi = std::numbers::pi, omega = 2 * pi;

const std::string square = R"(/bodies/0/geometry={"type": "box", "lower": [-0.5, -0.5], "upper": [0.5, 0.5]})";

}  // namespace

TEST_CASE("moments and energies of disc and square", "[spin]") {
  std::printf("Spin: spin (kg m^2/s) and kinetic energy (J/m) at the start, 20, 40, 80 cells; exact\n");
  struct Row {
    const char* name;
    std::string geometry;
    double moment;
  };
  for (const Row& row : {Row{"disc", "", 98.17477}, Row{"square", square, 1000.0 / 6}}) {
    std::printf("  %-8s", row.name);
    double error = 0, before = 0;
    for (const int n : {20, 40, 80}) {
      std::vector<std::string> list{set("/grid/cell_size", digits(1.0 / n)), set("/transfer/type", "flip")};
      if (!row.geometry.empty()) list.push_back(row.geometry);
      const Totals start = Scene(spinning_disc, list).metrics.initial();
      std::printf(" %10.4f %10.4f", start.angular_momentum[2], start.kinetic);
      error = std::abs(start.angular_momentum[2] / (row.moment * omega) - 1);
      CHECK(start.kinetic == Approx(0.5 * omega * start.angular_momentum[2]).epsilon(1e-12));
      // A lattice of n^2 points has the moment of the square less the points' own: 1 - 1 / (2 n)^2.
      if (!row.geometry.empty()) {
        CHECK(error == Approx(0.25 / (n * n)).epsilon(1e-6));
        if (before > 0) CHECK(error == Approx(before / 4).epsilon(1e-6));
      }
      before = error;
    }
    std::printf(" | %10.4f %10.4f\n", row.moment * omega, 0.5 * row.moment * omega * omega);
    CHECK(error < 0.005);
  }
}

// What TPIC, AFLIP, ASFLIP, FLIP and PIC keep, and PIC with filters, has no closed form: tests/regression/spinning_bodies.cpp.
TEST_CASE("spinning disc: one turn of the transfers that keep spin", "[spin]") {
  std::printf("Spin, one turn of the disc: share kept of spin and kinetic energy, rms error (m)\n");
  for (const std::string transfer : {"apic", "mls", "rpic"})
    CHECK(turn(transfer, {set("/transfer/type", transfer)}) == Approx(1).epsilon(1e-10));
  // The round trip of a filter on APIC keeps rotations.
  CHECK(turn("apic, xpic 4", soft_turn({R"(/filter={"type": "xpic", "order": 4})"})) == Approx(1).epsilon(1e-10));
}

// Where every particle flies straight on, x = X + t v(X) and F = I + w t (turn by a right angle): the symmetric part of F -
// I is zero, and so is the stress of linear elasticity. Such a disc is not held together: it grows by J = 1 + (w t)^2, which
// makes false stress of every other turn. Neo-Hookean keeps the volume to what spinning stretches it by.
TEST_CASE("a disc of linear elasticity flies apart in straight lines, a neo-Hookean one turns", "[spin]") {
  for (const bool is_linear : {true, false}) {
    Scene scene(spinning_disc, {set("/materials/m/type", is_linear ? "linear_elastic" : "neo_hookean"),
                                set("/solver/end_time", "0.04")});
    const Totals start = scene.metrics.initial(), end = scene.run();
    const double angle = 2 * pi * end.time, J = is_linear ? 1 + angle * angle : 1;
    std::printf("Spin, %s: J from %.6f to %.6f, exact %.6f; strain energy over kinetic %.1e\n",
                is_linear ? "linear elasticity" : "neo-Hookean", end.smallest_volume_ratio, end.largest_volume_ratio, J,
                end.strain / start.kinetic);
    INFO((is_linear ? "linear elasticity: " : "neo-Hookean: ") << end.smallest_volume_ratio << " " << J);
    CHECK(end.time == Approx(0.04));
    CHECK(end.smallest_volume_ratio == Approx(J).margin(5e-4));
    CHECK(end.largest_volume_ratio == Approx(J).margin(5e-4));
    CHECK(end.strain < 1e-3 * start.kinetic);
  }
}

TEST_CASE("the stress of a steadily spinning disc", "[spin]") {
  // A disc that is set spinning without strain breathes about the steady state of plane strain, in linear elasticity
  // with
  //   s_r = K1 rho w^2 (R^2 - r^2), s_t = rho w^2 (K1 R^2 - K2 r^2),
  //   K1 = (3 - 2 nu)/(8 (1 - nu)), K2 = (1 + 2 nu)/(8 (1 - nu)):
  // means over many breaths are the steady stresses. Here density (w R)^2 / E = 1e-4.
  constexpr double radius = 0.5, spin = 10, nu = 0.3, K1 = (3 - 2 * nu) / (8 * (1 - nu)),
                   K2 = (1 + 2 * nu) / (8 * (1 - nu)), scale = 1000 * spin * spin, modulus = 2.5e8;
  CHECK(K1 * scale * radius * radius == Approx(10714.2857).epsilon(1e-8));
  const double lambda = modulus * nu / ((1 + nu) * (1 - 2 * nu)), mu = modulus / (2 * (1 + nu));
  std::printf("Spin, steady disc: cells a diameter; mean stress in the middle and s_r, s_t at r = 0.25 (Pa)\n");
  for (const int n : {20, 40}) {
    Scene scene(spinning_disc, {set("/constants/w", "10"), set("/compare", "null"),
                                set("/materials/m/youngs_modulus", digits(modulus)),
                                set("/grid/cell_size", digits(1.0 / n)), set("/solver/end_time", "0.06")});
    std::vector<double> radial, hoop;
    long samples = 0;
    while (!scene.simulation.finished()) {
      scene.simulation.step();
      if (scene.simulation.steps() % 4 != 0) continue;
      const BodyState state = scene.body();
      const auto& F = state.material_state.at("deformation_gradient");
      const std::size_t count = state.position.size() / 2;
      radial.resize(count), hoop.resize(count);
      ++samples;
      for (std::size_t p = 0; p < count; ++p) {
        const double* f = &F[4 * p];
        const double J = f[0] * f[3] - f[1] * f[2], pressure = lambda * std::log(J) - mu;
        // The exact stress is tau = mu b + (lambda ln J - mu) I along the radius and across it.
        const double x = state.position[2 * p], y = state.position[2 * p + 1], r = std::hypot(x, y);
        const double rx = x / r, ry = y / r;
        const double a = f[0] * rx + f[2] * ry, b = f[1] * rx + f[3] * ry, c = -f[0] * ry + f[2] * rx,
                     d = -f[1] * ry + f[3] * rx;
        radial[p] += (mu * (a * a + b * b) + pressure) / J;
        hoop[p] += (mu * (c * c + d * d) + pressure) / J;
      }
    }
    const std::vector<double> place = scene.body().position;
    double middle = 0, middles = 0, half_r = 0, half_t = 0, halves = 0;
    for (std::size_t p = 0; p < radial.size(); ++p) {
      const double r = std::hypot(place[2 * p], place[2 * p + 1]), s_r = radial[p] / static_cast<double>(samples),
                   s_t = hoop[p] / static_cast<double>(samples);
      if (r < 0.1) middle += 0.5 * (s_r + s_t) + scale * 0.25 * (K1 + K2) * 2 * r * r, middles += 1;
      if (std::abs(r - 0.25) < 0.025)
        half_r += s_r + scale * K1 * (r * r - 0.0625), half_t += s_t + scale * K2 * (r * r - 0.0625), halves += 1;
    }
    middle /= middles, half_r /= halves, half_t /= halves;
    const double exact_r = scale * K1 * (0.25 - 0.0625), exact_t = scale * (K1 * 0.25 - K2 * 0.0625);
    std::printf("  %d: %.1f %.1f %.1f | exact 10714.3 %.1f %.1f\n", n, middle, half_r, half_t, exact_r, exact_t);
    INFO(n << " cells");
    CHECK(middle == Approx(10714.2857).epsilon(0.02));
    CHECK(half_r == Approx(exact_r).epsilon(0.03));
    CHECK(half_t == Approx(exact_t).epsilon(0.03));
  }
}

namespace {

/// The means of a square's Cauchy stress over a while, along its own axes.
struct SquareStress {
  double whole[3] = {};   ///< mean of the whole square: xx, yy, xy
  double middle[2] = {};  ///< halfway from the centre to the middles of its edges: along the edge, across
  long samples = 0;
};

void add_sample(const Scene& scene, const std::vector<double>& X, double lambda, double mu, SquareStress& sum) {
  const double angle = omega * scene.simulation.time(), c = std::cos(angle), s = std::sin(angle);
  const BodyState state = scene.body();
  const auto& F = state.material_state.at("deformation_gradient");
  double edge[2] = {}, whole[3] = {}, edges = 0;
  const std::size_t particles = X.size() / 2;
  for (std::size_t p = 0; p < particles; ++p) {
    const double* f = &F[4 * p];
    const double J = f[0] * f[3] - f[1] * f[2], pressure = (lambda * std::log(J) - mu) / J;
    // The deformation is turned back: Q^T F.
    const double g[4] = {c * f[0] + s * f[2], c * f[1] + s * f[3], c * f[2] - s * f[0], c * f[3] - s * f[1]};
    const double xx = mu * (g[0] * g[0] + g[1] * g[1]) / J + pressure,
                 yy = mu * (g[2] * g[2] + g[3] * g[3]) / J + pressure;
    whole[0] += xx, whole[1] += yy, whole[2] += mu * (g[0] * g[2] + g[1] * g[3]) / J;
    const double x = std::abs(X[2 * p]), y = std::abs(X[2 * p + 1]);
    if (std::max(x, y) < 0.2 || std::max(x, y) > 0.3 || std::min(x, y) > 0.1) continue;
    edge[0] += x > y ? yy : xx, edge[1] += x > y ? xx : yy, edges += 1;
  }
  for (double& part : whole) part /= static_cast<double>(particles);
  for (int k = 0; k < 3; ++k) sum.whole[k] += whole[k];
  for (int k = 0; k < 2; ++k) sum.middle[k] += edge[k] / edges;
  ++sum.samples;
}

}  // namespace

TEST_CASE("the stress of a spinning square turns with it", "[spin]") {
  // Without tractions int sigma dV = int density v x v dV - d/dt int density x x v dV: over many breaths the mean
  // stress is density w^2 side^2 / 12 along both axes. Halfway to an edge the stress along the edge is the larger one:
  // after an eighth of a turn as at the start, and after a whole one.
  constexpr double nu = 0.3, modulus = 9.869604401e7, exact = 1000 * omega * omega / 12;
  const double lambda = modulus * nu / ((1 + nu) * (1 - 2 * nu)), mu = modulus / (2 * (1 + nu));
  Scene scene(spinning_disc, {square, set("/solver/end_time", "1.04")});
  const std::vector<double> X = scene.body().position;
  const Totals start = scene.metrics.initial();
  constexpr double middles[] = {0.04, 0.125, 1};  // middles of the times sampled, s
  SquareStress sums[3];
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.steps() % 4 != 0) continue;
    for (int k = 0; k < 3; ++k)
      if (std::abs(scene.simulation.time() - middles[k]) < 0.04) add_sample(scene, X, lambda, mu, sums[k]);
  }
  std::printf(
      "Spin, square: turns; mean stress xx, yy, xy of its own axes, along and across an edge (Pa); exact mean %.2f\n",
      exact);
  for (int k = 0; k < 3; ++k) {
    const SquareStress& sum = sums[k];
    const double n = static_cast<double>(sum.samples);
    std::printf("  %.3f: %8.2f %8.2f %8.2f | %8.2f %8.2f\n", middles[k], sum.whole[0] / n, sum.whole[1] / n,
                sum.whole[2] / n, sum.middle[0] / n, sum.middle[1] / n);
    INFO(middles[k] << " turns");
    for (int c = 0; c < 2; ++c) CHECK(sum.whole[c] / n == Approx(exact).epsilon(0.01));
    CHECK(std::abs(sum.whole[2] / n) < 0.01 * exact);
    // The first while holds the shock of starting to turn without strain.
    const SquareStress& other = sums[k == 1 ? 0 : 1];
    for (int c = 0; c < 2; ++c)
      CHECK(sum.middle[c] / n ==
            Approx(other.middle[c] / static_cast<double>(other.samples)).epsilon(k == 2 ? 0.01 : 0.04));
    CHECK(sum.middle[0] > sum.middle[1]);
  }
  const Totals end = scene.metrics.measure();
  CHECK(end.angular_momentum[2] == Approx(start.angular_momentum[2]).epsilon(1e-10));
  CHECK(end.kinetic == Approx(start.kinetic).epsilon(1e-3));
  CHECK(end.position_error_rms < 1e-3);  // m
}

TEST_CASE("the stress of a fixed corotated solid turns with it", "[spin]") {
  using Matrix = Mat<2, double>;
  const FixedCorotated::Constants<double> constants({1000, 0.3, 1000});
  FixedCorotated::State<2, double> state{Matrix::identity()};
  FixedCorotated::advance(constants, Matrix{{0.3, 0, 0, -0.2}}, 1.0, state);  // F = diag(1.3, 0.8)
  const auto start = FixedCorotated::kirchhoff_stress(constants, state);
  const double angle = 2 * pi / 7, c = std::cos(angle), s = std::sin(angle);
  for (int k = 1; k <= 7; ++k) {
    FixedCorotated::advance(constants, Matrix{{c - 1, -s, s, c - 1}}, 1.0, state);
    const auto tau = FixedCorotated::kirchhoff_stress(constants, state);
    const double C = std::cos(k * angle), S = std::sin(k * angle);
    CHECK(std::abs(tau.s[0] - (C * C * start.s[0] + S * S * start.s[1])) < 1e-12 * 1000);
    CHECK(std::abs(tau.s[1] - (S * S * start.s[0] + C * C * start.s[1])) < 1e-12 * 1000);
    CHECK(std::abs(tau.s[3] - C * S * (start.s[0] - start.s[1])) < 1e-12 * 1000);
  }
}

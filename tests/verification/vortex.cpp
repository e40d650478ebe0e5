// The generalised vortex, a manufactured solution of shear and rotation at constant volume on a ring. `ctest -V` shows
// the tables.
//
// The body force is that of experiments/studies/generalised_vortex.json. A published implementation of it has + r (g'
// h)^2 sin(alpha) in its tangential term; the sign is minus (it follows from x = Q(alpha) X: the centripetal
// acceleration -R alpha_t^2 e_r turned back by alpha). With the plus the force is that of another motion wherever g' !=
// 0; the case below that differentiates the stress shows it.
//
// The literature has uGIMP and linear functions fail at a twist of G = 1 and B-splines converge; and so it is here.
// CPDI, said to stall, holds longer than splines at two particles a cell and axis. To the end of G = 1, t = T, nothing
// keeps second order: see tests/regression/vortex.cpp.
//
// The body is wider than the case's ring by an eighth of a metre of material at rest on both sides: lattice particles
// leave a ragged edge, and the exact edge carries the largest force (61 N/kg).

#include <array>
#include <cmath>
#include <cstdio>

#include "support/catch.hpp"
#include "verification/vortex.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::generalised_vortex;

namespace {

constexpr double mu = 1000 / 2.6, lambda = 0.3 * 1000 / (1.3 * 0.4), density = 1000;

/// The first Piola stress of the Neo-Hookean law, from differences of the motion, row by row.
std::array<double, 4> piola(double X, double Y, double t) {
  constexpr double d = 1e-4;
  std::array<double, 4> F{};
  const auto difference = [&](double sx, double sy, int c) {
    // The differences are of fourth order.
    return (8 * (place(X + sx * d, Y + sy * d, t)[c] - place(X - sx * d, Y - sy * d, t)[c]) -
            (place(X + 2 * sx * d, Y + 2 * sy * d, t)[c] - place(X - 2 * sx * d, Y - 2 * sy * d, t)[c])) /
           (12 * d);
  };
  for (int c = 0; c < 2; ++c) F[2 * c] = difference(1, 0, c), F[2 * c + 1] = difference(0, 1, c);
  const double J = F[0] * F[3] - F[1] * F[2], pressure = (lambda * std::log(J) - mu) / J;
  return {mu * F[0] + pressure * F[3], mu * F[1] - pressure * F[2], mu * F[2] - pressure * F[1],
          mu * F[3] + pressure * F[0]};
}

/// The force x_tt - div P / density by differences.
Vec2 force_by_differences(double X, double Y, double t) {
  constexpr double d = 1e-3, dt = 1e-3;
  Vec2 b;
  for (int c = 0; c < 2; ++c) {
    const auto x = [&](double s) { return place(X, Y, t + s * dt)[c]; };
    const double acceleration = (16 * (x(1) + x(-1)) - (x(2) + x(-2)) - 30 * x(0)) / (12 * dt * dt);
    const auto slope = [&](double sx, double sy, int k) {
      const auto P = [&](double s) { return piola(X + s * sx * d, Y + s * sy * d, t)[2 * c + k]; };
      return (8 * (P(1) - P(-1)) - (P(2) - P(-2))) / (12 * d);
    };
    b[c] = acceleration - (slope(1, 0, 0) + slope(0, 1, 1)) / density;
  }
  return b;
}

}  // namespace

TEST_CASE("vortex: the shipped body force is the solution's, and balances the motion", "[vortex]") {
  const Experiment experiment = shipped(vortex);
  struct Row {
    double R, angle, t, bx, by;
  };
  // The case's last digit of bx in the second row is 4; both the formula and differences give 6.
  for (const Row& row : {Row{.9, .7, .31, 2.2969001, 5.0005457}, Row{1.1, 2.1, .83, -3.4034476, -5.5138305},
                         Row{.8, -1, .5, -14.4886619, -20.7585043}}) {
    const Vector3 X{row.R * std::cos(row.angle), row.R * std::sin(row.angle), 0};
    const Vector3 b = (*experiment.body_force)(X, X, row.t);
    INFO(row.R << " " << row.angle << " " << row.t << ": " << digits(b[0]) << " " << digits(b[1]));
    CHECK(std::abs(b[0] - row.bx) < 5.1e-8);
    CHECK(std::abs(b[1] - row.by) < 5.1e-8);
    const Vec2 found = force_by_differences(X[0], X[1], row.t);
    INFO("by differences " << digits(found[0]) << " " << digits(found[1]));
    CHECK(std::abs(b[0] - found[0]) < 1e-6 * std::hypot(b[0], b[1]));
    CHECK(std::abs(b[1] - found[1]) < 1e-6 * std::hypot(b[0], b[1]));
  }
  // Beyond the edges nothing acts.
  for (const double R : {0.74, 1.26})
    for (const double component : (*experiment.body_force)({R, 0, 0}, {R, 0, 0}, 0.3)) CHECK(component == 0);
}

TEST_CASE("vortex: the published force with the other sign is that of another motion", "[vortex]") {
  const Experiment experiment = shipped(vortex);
  for (const double t : {0.31, 0.5, 0.83}) {
    const Vector3 X{0.9 * std::cos(0.7), 0.9 * std::sin(0.7), 0};
    const Vector3 b = (*experiment.body_force)(X, X, t);
    const double w = 1 - 16 * 0.01, rate = pi * std::cos(pi * t) * w * w, alpha = std::sin(pi * t) * w * w;
    // The published force has + R (g' h)^2 sin(alpha) for - R (g' h)^2 sin(alpha), along the circle at the initial
    // angle.
    const Vec2 published{b[0] - 2 * rate * rate * std::sin(alpha) * X[1],
                         b[1] + 2 * rate * rate * std::sin(alpha) * X[0]};
    const Vec2 found = force_by_differences(X[0], X[1], t);
    const double distance = std::hypot(published[0] - found[0], published[1] - found[1]);
    std::printf("Vortex, t = %.2f: the published force is off by %.3g N/kg of %.3g\n", t, distance,
                std::hypot(b[0], b[1]));
    CHECK((distance < 1e-5) == (t == 0.5));  // there g' = 0
    CHECK((distance > 1) == (t != 0.5));
  }
}

TEST_CASE("vortex: the exact solution that experiments name is this motion", "[vortex]") {
  const Experiment experiment = shipped(vortex);
  const auto exact = make_exact_solution(experiment, 0);
  for (const double R : {0.7, 0.8, 1.0, 1.2, 1.3})
    for (const double t : {0.0, 0.3, 0.5, 1.0}) {
      const Vector3 X{R * std::cos(0.4), R * std::sin(0.4), 0};
      const Vector3 x = exact->position(X, {}, t), v = exact->velocity(X, {}, t);
      const bool moves = R > 0.75 && R < 1.25;
      const Vec2 expected = moves ? place(X[0], X[1], t) : Vec2{X[0], X[1]};
      for (int c = 0; c < 2; ++c) {
        CHECK(std::abs(x[c] - expected[c]) < 1e-14);
        const double rate = moves ? (place(X[0], X[1], t + 1e-5)[c] - place(X[0], X[1], t - 1e-5)[c]) / 2e-5 : 0;
        CHECK(std::abs(v[c] - rate) < 1e-8);
      }
    }
  // The particles' velocities at the start are those of the motion.
  CHECK(ShippedScene(vortex).metrics.initial().velocity_error_max < 1e-13);
}

// The shear of a circle that turns by a(R) is R da/dR; of simple shear it is sqrt(F : F - 2).
TEST_CASE("vortex: the shears that the page tells are those of the motion", "[vortex]") {
  const auto largest_shear = [](double t) {
    double largest = 0;
    for (int k = 1; k < 1000; ++k) {
      const double R = 0.75 + 0.5 * k / 1000, d = 1e-5;
      double sum = -2;
      for (const auto& [sx, sy] : {std::pair{1, 0}, std::pair{0, 1}})
        for (int c = 0; c < 2; ++c)
          sum += std::pow((place(R + sx * d, sy * d, t)[c] - place(R - sx * d, -sy * d, t)[c]) / (2 * d), 2);
      largest =
          larger(largest, std::sqrt(std::max(sum, 0.0)));  // where nothing is sheared it is below zero by rounding
    }
    return largest;
  };
  const double whole = largest_shear(0.5);
  check_page("a twist of G = 0.1 rad shears reach #", {0.1 * whole});  // the angle, and with it the shear, goes with G
  check_page("shears of # by t = T/5", {largest_shear(0.2)});
  check_page("By t = 2T/5 shears are #.", {largest_shear(0.4)});
  check_page("(t = T, shears of up to #)", {whole});
}

// J is 1. The rms of J - 1 converges; its largest value, at the ring's edges where the force jumps, falls more slowly.
TEST_CASE("vortex: a small twist: splines, boxes and domains converge, linear functions do not", "[vortex]") {
  std::printf("Vortex, G = 0.1, t = T / 2: rms error on 8, 16, 32 cells a metre (m), orders\n");
  for (const std::string shape : {"gimp", "bspline_cubic", "cpdi2"}) {
    const Errors e = errors({8, 16, 32}, shape, "apic", 0.1, 0.5);
    INFO(shape);
    CHECK(order(e.place) > 1.5);
    CHECK(order(e.volume) > (shape == "bspline_cubic" ? 1.2 : 0.75));
    check_falls(e.largest_volume);
  }
  const Errors e = errors({8, 16, 32}, "linear", "apic", 0.1, 0.5);
  CHECK(order(e.place) < 0);  // the error grows
  CHECK(order(e.volume) < 0.3);
  CHECK(e.largest_volume[2] > e.largest_volume[1]);
}

TEST_CASE("vortex: a full twist: GIMP and linear functions fail, splines and CPDI hold", "[vortex]") {
  std::printf("Vortex, G = 1, t = 0.2: rms error on 8, 16, 32 cells a metre (m), orders\n");
  for (const std::string shape : {"bspline_cubic", "cpdi", "cpdi2"}) {
    const Errors e = errors({8, 16, 32}, shape, "apic", 1, 0.2);
    INFO(shape);
    CHECK(order(e.place) > 1.8);
    if (shape == "bspline_cubic") continue;  // see the next case
    CHECK(order(e.volume) > 0.9);
    check_falls(e.largest_volume);
  }
  for (const std::string shape : {"gimp", "linear"}) {
    const Errors failing = errors({8, 16, 32}, shape, "apic", 1, 0.2);
    INFO(shape);
    // At the step that they stand, a tenth, the places of linear functions converge, but in less than the second order.
    CHECK(order(failing.place) < (shape == "gimp" ? 1 : 1.5));
    CHECK(order(failing.volume) < 0);  // the error grows
  }
}

TEST_CASE("vortex: a full twist: the volume of splines converges with three particles a cell and axis",
          "[vortex][slow]") {
  // Two particles, which the shear has drawn 1.8 cells apart, leave J where it was on the finest grid.
  std::printf("Vortex, G = 1, t = 0.2, 3 x 3 particles a cell: rms error on 8, 16, 32 cells a metre (m), orders\n");
  const Errors e = errors({8, 16, 32}, "bspline_cubic", "apic", 1, 0.2, 3);
  CHECK(order(e.place) > 1.8);
  CHECK(order(e.volume) > 1.6);
  check_falls(e.largest_volume);
}

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
// keeps second order: see the last case.
//
// The body is wider than the case's ring by an eighth of a metre of material at rest on both sides: lattice particles
// leave a ragged edge, and the exact edge carries the largest force (61 N/kg).

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "shipped.hpp"
#include "support/catch.hpp"
#include "support/page.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double pi = std::numbers::pi, mu = 1000 / 2.6, lambda = 0.3 * 1000 / (1.3 * 0.4), density = 1000;
const char* vortex = "studies/generalised_vortex.json";

using Vec2 = std::array<double, 2>;

/// The place of a particle at angle and radius, G = T = 1.
Vec2 place(double X, double Y, double t) {
  const double q = std::hypot(X, Y) - 1, w = 1 - 16 * q * q, a = std::sin(pi * t) * w * w;
  return {X * std::cos(a) - Y * std::sin(a), X * std::sin(a) + Y * std::cos(a)};
}

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

std::vector<std::string> settings(int cells, const std::string& shape, const std::string& transfer, double twist,
                                  double end) {
  return {set("/grid/cell_size", digits(1.0 / cells)), set("/shape/type", shape), set("/transfer/type", transfer),
          set("/constants/G", digits(twist)), set("/compare/exact/amplitude", digits(twist)),
          set("/solver/end_time", digits(end)),
          // The Courant number is that of experiments/studies/vortex.json.
          set("/solver/courant", twist < 1 ? "0.3" : "0.5")};
}

struct Errors {
  std::vector<double> place, volume, largest_volume;  ///< m, rms; J - 1, exactly zero: rms, and largest of a particle
};

/// The errors on grids of `cells` a metre; NaN where a run stops.
Errors errors(const std::vector<int>& cells, const std::string& shape, const std::string& transfer, double twist,
              double end, int particles_per_cell_axis = 2) {
  Errors found;
  std::vector<double> sizes;
  for (const int n : cells) {
    auto words = settings(n, shape, transfer, twist, end);
    words.push_back(set("/bodies/0/particles_per_cell_axis", std::to_string(particles_per_cell_axis)));
    ShippedScene scene(vortex, words);
    const Totals last = scene.run();
    const std::vector<double> F = scene.simulation.backend().body_state(0).material_state.at("deformation_gradient");
    double sum = 0;
    for (std::size_t k = 0; k < F.size(); k += 4) sum += std::pow(F[k] * F[k + 3] - F[k + 1] * F[k + 2] - 1, 2);
    const bool ended = scene.failure.empty();
    found.place.push_back(ended ? last.position_error_rms : NAN);
    found.volume.push_back(ended ? std::sqrt(4 * sum / static_cast<double>(F.size())) : NAN);
    found.largest_volume.push_back(ended ? std::max(1 - last.smallest_volume_ratio, last.largest_volume_ratio - 1)
                                         : NAN);
    sizes.push_back(1.0 / n);
  }
  print_orders(shape + " " + transfer, sizes, found.place);
  print_orders("  rms J - 1", sizes, found.volume);
  print_orders("  max |J - 1|", sizes, found.largest_volume);
  return found;
}

double order(const std::vector<double>& e) {
  return std::log2(e[e.size() - 2] / e.back());
}

/// Whether the page of convergence prints these values at the # of its sentence.
void check_page(const std::string& sentence, const std::vector<double>& values) {
  INFO(sentence);
  const auto printed = Page("docs/studies/convergence.md").read(sentence);
  REQUIRE(printed.size() == values.size());
  for (std::size_t k = 0; k < values.size(); ++k) CHECK(values[k] == printed[k].rounded());
}

/// Whether an error falls on every finer grid.
bool falls(const std::vector<double>& e) {
  for (std::size_t k = 1; k < e.size(); ++k)
    if (!(e[k] < e[k - 1])) return false;
  return true;
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
      largest = std::max(largest, std::sqrt(sum));
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
  std::map<std::string, Errors> all;
  for (const std::string shape : {"gimp", "bspline_cubic", "cpdi2"}) {
    const Errors e = all[shape] = errors({8, 16, 32}, shape, "apic", 0.1, 0.5);
    INFO(shape);
    CHECK(order(e.place) > 1.5);
    CHECK(order(e.volume) > (shape == "bspline_cubic" ? 1.2 : 0.75));
    CHECK(falls(e.largest_volume));
  }
  const auto percent = [](const std::vector<double>& of_spline, const std::vector<double>& of_domain) {
    return std::vector{100 * of_spline[1], 100 * of_spline[2], 100 * of_domain[1], 100 * of_domain[2]};
  };
  const Errors &spline = all.at("bspline_cubic"), &domain = all.at("cpdi2");
  check_page("(cubic splines # % and # % on 16 and 32 cells a metre, CPDI2 # % and # %)",
             percent(spline.volume, domain.volume));
  check_page("falls more slowly: # % and # %, # % and # %", percent(spline.largest_volume, domain.largest_volume));
  const Errors e = errors({8, 16, 32}, "linear", "apic", 0.1, 0.5);
  CHECK(order(e.place) < 0);  // the error grows
  CHECK(order(e.volume) < 0.3);
  CHECK_FALSE(falls(e.largest_volume));
}

TEST_CASE("vortex: a full twist: GIMP and linear functions fail, splines and CPDI hold", "[vortex]") {
  std::printf("Vortex, G = 1, t = 0.2: rms error on 8, 16, 32 cells a metre (m), orders\n");
  for (const std::string shape : {"bspline_cubic", "cpdi", "cpdi2"}) {
    const Errors e = errors({8, 16, 32}, shape, "apic", 1, 0.2);
    INFO(shape);
    CHECK(order(e.place) > 1.8);
    if (shape == "bspline_cubic") continue;  // see the next case
    CHECK(order(e.volume) > 0.9);
    CHECK(falls(e.largest_volume));
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
  CHECK(falls(e.largest_volume));
}

TEST_CASE("vortex: a full twist at a shear of 6.7", "[vortex][slow]") {
  std::printf("Vortex, G = 1, t = 0.4: rms error on 16, 32 cells a metre (m), order\n");
  const std::vector<double> of_domains = errors({16, 32}, "cpdi", "apic", 1, 0.4).place;
  const double domains = of_domains.back();
  REQUIRE(domains < 0.006);
  check_page("CPDI still converges (# m and # m on 16 and 32 cells a metre, order #)",
             {of_domains[0], domains, order(of_domains)});
  std::vector<double> of_splines;
  for (const std::string shape : {"bspline_quadratic", "bspline_cubic"}) {
    const std::vector<double> both = errors({16, 32}, shape, "apic", 1, 0.4).place;
    of_splines.insert(of_splines.begin(), both.begin(), both.end());
    const double points = both.back();
    INFO(shape << ": " << points << ", cpdi " << domains);
    CHECK(points > 3 * domains);  // a run that stops is no comparison: NaN fails
  }
  check_page("cubic splines stall (# m, # m) and quadratic ones get worse (# m, # m)", of_splines);
}

TEST_CASE("vortex: a full twist there and back", "[vortex][slow]") {
  // Shears have been 7, and second order is lost: what went wrong on the way stays, since the ring as a whole is hardly
  // turned back in that time (its slowest swing in radius lasts 6 s). MLS-MPM comes through on every grid; with APIC,
  // FLIP, AFLIP and PolyPIC the ring leaves the domain or inverts on the finest.
  std::printf(
      "Vortex, G = 1, t = T: rms error on 8, 16, 32 or 16, 32 cells a metre (m), orders; NaN: the run stopped\n");
  const Errors splines = errors({8, 16, 32}, "bspline_cubic", "mls", 1, 1, 4);
  CHECK(order(splines.place) > 0.5);
  CHECK(splines.place.back() < 0.045);
  check_page("4 × 4 particles a cell: #, # and # m, order # at last",
             {splines.place[0], splines.place[1], splines.place[2], order(splines.place)});
  CHECK(falls(splines.volume));
  const Errors domains = errors({16, 32}, "cpdi", "mls", 1, 1);
  CHECK(order(domains.place) > 0.5);
  CHECK(domains.place.back() < 0.04);
  check_page("the two finer grids give # m and # m", domains.place);
  CHECK(falls(domains.volume));
  // APIC does not come through: on the finest grid a particle inverts, after the time to which it was held above.
  ShippedScene apic(vortex, settings(32, "cpdi", "apic", 1, 1));
  apic.run();
  INFO("APIC: " << apic.failure << " after t = " << apic.simulation.time());
  CHECK(apic.failure.starts_with("inverted: "));
  check_page("CPDI stops on 32 cells a metre at t = # s", {apic.simulation.time()});
}

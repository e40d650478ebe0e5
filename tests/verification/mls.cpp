// MLS-MPM beside standard MPM. MLS takes D^-1 w d where standard MPM takes grad w, for the stress and for the strain.
// Both are exact on linear fields, so along an axis they can only differ by a multiple of the next difference of the
// nodes:
//   quadratic splines   s (1 - 4 s^2) / (2 h) times (1, -2, 1),       s = the place beside the middle node, cells
//   cubic splines      -f^2 (1 - f)^2 / (2 h) times (-1, 3, -3, 1),   f = the place between two nodes
// since sum w d^3 = s (1/4 - s^2) of quadratic splines, and sum w d^4 = 1/3 - f^2 (1 - f)^2 of cubic ones, whose third
// moment vanishes. Hence: exact on fields linear (quadratic) along each axis, first (second) order beyond.
// `ctest -V` shows the tables.

#include <array>
#include <cmath>
#include <cstdio>

#include "lattice.hpp"
#include "materials/neo_hookean/neo_hookean.hpp"
#include "shapes/bspline_cubic/bspline_cubic.hpp"
#include "shapes/bspline_quadratic/bspline_quadratic.hpp"
#include "shapes/linear/linear.hpp"
#include "support/catch.hpp"
#include "support/differences.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double pi = std::numbers::pi;

/// The multiple of the next difference by which D^-1 w d exceeds the gradient, times h; x in cells.
double excess(const std::string& shape, double x) {
  if (shape == "bspline_quadratic") {
    const double s = x - std::round(x);
    return s * (1 - 4 * s * s) / 2;
  }
  const double f = x - std::floor(x);
  return -f * f * (1 - f) * (1 - f) / 2;
}

/// Sums over the nodes of one axis of the gradient and of D^-1 w d, times d^power.
struct Moments {
  double gradient[5]{}, fit[5]{};
};

template <class Shape>
Moments moments_at(double x, double second_moment) {
  double base, w[Shape::width], g[Shape::width];
  Shape::evaluate({}, x, base, w, g);
  Moments sums;
  for (int k = 0; k < Shape::width; ++k) {
    const double d = base + k - x;
    for (int power = 0; power < 5; ++power) {
      sums.gradient[power] += g[k] * std::pow(d, power);
      sums.fit[power] += w[k] * d / second_moment * std::pow(d, power);
    }
  }
  return sums;
}

/// Checks node by node D^-1 w d - grad w against the multiple of the difference.
template <class Shape>
double largest_mismatch(double x, double second_moment, double multiple, const std::array<double, 4>& difference) {
  double base, w[Shape::width], g[Shape::width], largest = 0;
  Shape::evaluate({}, x, base, w, g);
  for (int k = 0; k < Shape::width; ++k)
    largest = larger(largest, std::abs(w[k] * (base + k - x) / second_moment - g[k] - multiple * difference[k]));
  return largest;
}

}  // namespace

TEST_CASE("the gradient of MLS differs from the spline's by a known difference of the nodes", "[kernel][mls]") {
  for (int k = 0; k <= 400; ++k) {
    const double x = 7 + k / 200.0, f = x - std::floor(x);
    INFO("at " << x);
    CHECK(largest_mismatch<BsplineQuadratic>(x, 0.25, excess("bspline_quadratic", x), {1, -2, 1, 0}) < 1e-14);
    CHECK(largest_mismatch<BsplineCubic>(x, 1.0 / 3, excess("bspline_cubic", x), {-1, 3, -3, 1}) < 1e-14);
    if (f > 0.001) CHECK(largest_mismatch<Linear>(x, f * (1 - f), 0, {}) < 1e-12);

    // The sums show what the two do to 1, d, d^2, d^3 about the particle: both are exact on linear fields; the gradient
    // is on quadratic ones.
    const Moments quadratic = moments_at<BsplineQuadratic>(x, 0.25), cubic = moments_at<BsplineCubic>(x, 1.0 / 3);
    for (const Moments& sums : {quadratic, cubic})
      for (const double* of : {sums.gradient, sums.fit}) {
        CHECK(std::abs(of[0]) < 1e-14);
        CHECK(std::abs(of[1] - 1) < 1e-14);
      }
    CHECK(std::abs(quadratic.gradient[2]) < 1e-14);
    CHECK(std::abs(quadratic.fit[2] - 2 * excess("bspline_quadratic", x)) < 1e-14);
    CHECK(std::abs(cubic.gradient[2]) < 1e-14);
    CHECK(std::abs(cubic.fit[2]) < 1e-14);
    CHECK(std::abs(cubic.gradient[3] - 1) < 1e-13);
    CHECK(std::abs(cubic.fit[3] - 1 - 6 * excess("bspline_cubic", x)) < 1e-13);
  }
}

namespace {

/// The body is free, thrown, spinning and rough, at random places in its cells.
const char* rough = R"J({
  "title": "rough", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [3, 3]], "boundaries": {"all": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "mls"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "block", "material": "m", "geometry": {"type": "box", "lower": [1, 1], "upper": [1.6, 1.4]}, "jitter": 0.3,
              "velocity": ["1 - 4*(y-1.2) + 0.5*sin(31*x)", "-2 + 4*(x-1.3) + 0.5*cos(27*y)"]}],
  "solver": {"time_step": 1e-3, "end_time": 1}, "output": {"ledger": false}})J";

/// The moment sum m (v x^T + C D), x being the places that v and C were gathered at: the grid's sum m_i v_i x_i^T
/// before a scatter there and after a gather, to rounding.
Mat<2, double> first_moment(const BodyState& state, const BodyState& place, const std::string& shape) {
  const std::vector<double>& C = state.transfer_state.at("affine_velocity");
  const double constant = 0.01 * (shape == "bspline_quadratic" ? 1.0 / 4 : 1.0 / 3);
  Mat<2, double> sum{};
  for (std::size_t p = 0; p < state.velocity.size() / 2; ++p)
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        double affine = 0;
        for (int k = 0; k < 2; ++k) {
          const double D = place.second_moment.empty() ? (k == j) * constant : place.second_moment[4 * p + 2 * k + j];
          affine += C[4 * p + 2 * i + k] * D;
        }
        sum(i, j) += state.mass * (state.velocity[2 * p + i] * place.position[2 * p + j] + affine);
      }
  return sum;
}

/// The total stress sum V0 tau.
Mat<2, double> total_stress(const BodyState& state) {
  const NeoHookean::Constants<double> constants({1e5, 0.3, 1000, 0, 0});
  const std::vector<double>& F = state.material_state.at("deformation_gradient");
  Mat<2, double> sum{};
  for (std::size_t k = 0; k < F.size(); k += 4) {
    const auto tau = NeoHookean::kirchhoff_stress(
        constants, NeoHookean::State<2, double>{Mat<2, double>{{F[k], F[k + 1], F[k + 2], F[k + 3]}}});
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) sum(i, j) += state.volume * tau(i, j);
  }
  return sum;
}

}  // namespace

TEST_CASE("the forces of MLS do the work of the stress on every affine field, as standard MPM's", "[round_trip][mls]") {
  // The sum of f_i x_i^T is -sum V0 tau, whatever the stress and the places, since sum (D^-1 w d) d^T = I = sum grad w
  // d^T.
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape :
         {"bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp", "cpdi", "cpdi2"})
      for (const std::string transfer : {"mls", "apic"}) {
        Scene scene(rough, {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer)});
        scene.run_steps(20);
        const BodyState before = scene.body();
        scene.run_steps(1);
        const Mat<2, double> start = first_moment(before, before, shape), stress = total_stress(before),
                             end = first_moment(scene.body(), before, shape);
        double size = 0, error = 0;
        for (int k = 0; k < 4; ++k) {
          size = larger(size, std::abs(1e-3 * stress.m[k]));
          error = larger(error, std::abs(end.m[k] - start.m[k] + 1e-3 * stress.m[k]));
        }
        INFO(backend << " " << shape << " " << transfer << ": " << error << " of " << size);
        CHECK(size > 0.01);
        CHECK(error < 1e-11 * size);
      }
}

namespace {

/// A periodic square without stress; one step strains by the gradient of the same grid velocities. The particles are at
/// 1/4 and 3/4 of their cell.
std::string smooth_field(int cells) {
  return R"J({"dimension": 2, "backend": "cpu", "grid": {"cell_size": )J" + digits(1.0 / cells) +
         R"J(, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "periodic"}},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
      "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 1, "poisson_ratio": 0, "density": 1}},
      "bodies": [{"name": "square", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 1]},
                  "velocity": ["sin(2*pi*x)*cos(2*pi*y)", "cos(2*pi*(x+2*y))"]}],
      "solver": {"time_step": 1e-4, "end_time": 1}, "output": {"ledger": false}})J";
}

/// The next derivative (second or third) of component i by x_j of that velocity.
double derivative(int i, int j, int order, double x, double y) {
  const double phase = order * pi / 2, k = i == 0 ? 2 * pi : j == 0 ? 2 * pi : 4 * pi;
  const double value = i == 1   ? std::cos(2 * pi * (x + 2 * y) + phase)
                       : j == 0 ? std::sin(2 * pi * x + phase) * std::cos(2 * pi * y)
                                : std::sin(2 * pi * x) * std::cos(2 * pi * y + phase);
  return std::pow(k, order) * value;
}

struct Difference {
  double largest = 0, unexplained = 0;  ///< differences of the two velocity gradients, 1/s
};

Difference gradients_differ(const std::string& shape, int cells) {
  Scene standard(smooth_field(cells), {set("/shape/type", shape)}),
      fit(smooth_field(cells), {set("/shape/type", shape), set("/transfer/type", "mls")});
  const BodyState start = standard.body();
  standard.run_steps(1), fit.run_steps(1);
  const std::vector<double> F = standard.body().material_state.at("deformation_gradient"),
                            G = fit.body().material_state.at("deformation_gradient");
  const int order = shape == "bspline_quadratic" ? 2 : 3;
  Difference found;
  for (std::size_t k = 0; k < F.size(); ++k) {
    const std::size_t p = k / 4;
    const int i = k % 4 / 2, j = k % 2;
    const double x = start.position[2 * p], y = start.position[2 * p + 1], h = 1.0 / cells;
    const double difference = (G[k] - F[k]) / 1e-4, expected = excess(shape, (j == 0 ? x : y) * cells) *
                                                               std::pow(h, order - 1) * derivative(i, j, order, x, y);
    found.largest = larger(found.largest, std::abs(difference));
    found.unexplained = larger(found.unexplained, std::abs(difference - expected));
  }
  return found;
}

}  // namespace

TEST_CASE("the velocity gradient of MLS is off by h on quadratic splines and by h^2 on cubic ones", "[mls]") {
  std::printf("MLS less standard velocity gradient of a smooth field (1/s): cells, largest, not explained, order\n");
  for (const auto& [shape, order] : {std::pair{"bspline_quadratic", 1}, std::pair{"bspline_cubic", 2}}) {
    std::vector<double> sizes, errors, left;
    for (const int cells : {16, 32, 64, 128}) {
      const Difference found = gradients_differ(shape, cells);
      sizes.push_back(1.0 / cells), errors.push_back(found.largest), left.push_back(found.unexplained);
      std::printf("  %-17s %3d %.3e %.3e", shape, cells, found.largest, found.unexplained);
      if (sizes.size() > 1)
        std::printf("  %.2f, of the rest %.2f", observed_order(sizes, errors), observed_order(sizes, left));
      std::printf("\n");
    }
    INFO(shape);
    CHECK(observed_order(sizes, errors) == Approx(order).margin(0.02));
    CHECK(observed_order(sizes, left) == Approx(order + 1).margin(0.05));  // the multiple above is all of that order
  }
}

namespace {

struct Apart {
  double place = 0, strain = 0;  ///< differences of two runs, over the amplitude of each
};

/// Runs a standing wave for a quarter of its period, with MLS and with the splines' gradients.
Apart vibrate(const std::string& shape, int cells) {
  constexpr double speed = 1e-5, step = 0.25;
  const auto run = [&](const std::string& transfer) {
    LineScene scene(
        Line{.shape = shape, .transfer = transfer, .cells = cells, .particles_per_cell = 2, .time_step = step},
        [&](double x) { return speed * std::sin(2 * pi * x / cells); });
    scene.step(cells);
    return std::pair{scene.places(), scene.strains()};
  };
  const auto standard = run("apic"), fit = run("mls");
  const double strain = speed;  // the wave speed is one
  return {largest_difference(standard.first, fit.first) / (strain * cells / (2 * pi)),
          largest_difference(standard.second, fit.second) / strain};
}

}  // namespace

TEST_CASE("a wave with MLS is in the place of standard MPM to second order", "[mls]") {
  std::printf("A wave after a quarter period, MLS less standard: cells, places and strains over their amplitudes\n");
  for (const std::string shape : {"bspline_quadratic", "bspline_cubic"}) {
    std::vector<double> sizes, places, strains;
    for (const int cells : {16, 32, 64}) {
      const Apart apart = vibrate(shape, cells);
      sizes.push_back(1.0 / cells), places.push_back(apart.place), strains.push_back(apart.strain);
      std::printf("  %-17s %3d %.3e %.3e", shape.c_str(), cells, apart.place, apart.strain);
      if (sizes.size() > 1) std::printf("  %.2f %.2f", observed_order(sizes, places), observed_order(sizes, strains));
      std::printf("\n");
    }
    INFO(shape);
    CHECK(observed_order(sizes, places) > 1.8);
    CHECK(observed_order(sizes, strains) > (shape == "bspline_quadratic" ? 0.8 : 1.8));
  }
}

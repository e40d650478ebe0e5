// Manufactured solution on the unit square (Wallstedt & Guilkey 2008), Neo-Hookean with (ln J)^2. The body force is
// given by expressions of the initial position; observed orders are asserted.

#include <cmath>
#include <map>
#include <numbers>

#include "shipped.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* square = R"J({
  "title": "manufactured wave", "dimension": 2, "precision": "double", "backend": "cpu",
  "constants": {"A": 0.05, "E": 1e7, "nu": 0.3, "rho": 1000, "c": 100, "mu": 3846153.846153846, "lam": 5769230.769230769},
  "grid": {"cell_size": 0.125, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e7, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "square", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 1]}, "particles_per_cell_axis": 2,
              "velocity": ["A*c*pi*sin(pi*x)", "-A*c*pi*sin(pi*y)"]}],
  "body_force": [
    "pi^2*A*sin(pi*X)*sin(c*pi*t)/rho*(lam/(1+pi*A*cos(pi*X)*sin(c*pi*t))^2*(1-log((1+pi*A*cos(pi*X)*sin(c*pi*t))*(1-pi*A*cos(pi*Y)*sin(c*pi*t))))+mu*(1+1/(1+pi*A*cos(pi*X)*sin(c*pi*t))^2)-E)",
    "-pi^2*A*sin(pi*Y)*sin(c*pi*t)/rho*(lam/(1-pi*A*cos(pi*Y)*sin(c*pi*t))^2*(1-log((1+pi*A*cos(pi*X)*sin(c*pi*t))*(1-pi*A*cos(pi*Y)*sin(c*pi*t))))+mu*(1+1/(1-pi*A*cos(pi*Y)*sin(c*pi*t))^2)-E)"],
  "solver": {"stress_update": "last", "time_step": 1e-4, "end_time": 0.005},
  "output": {"ledger": false},
  "compare": {"exact": {"type": "axis_aligned_wave", "amplitude": 0.05, "wave_speed": 100}}})J";

double error(int cells, const std::string& shape, const std::string& transfer, double amplitude, double step) {
  const std::string A = digits(amplitude);
  Scene scene(square,
              {set("/grid/cell_size", digits(1.0 / cells)), set("/shape/type", shape), set("/transfer/type", transfer),
               set("/constants/A", A), set("/compare/exact/amplitude", A), set("/solver/time_step", digits(step))});
  return scene.run().position_error_rms;
}

/// The errors over three grids; the step falls with h^2 so that first order in time is second order in h.
std::vector<double> errors(const std::string& shape, const std::string& transfer, double amplitude) {
  std::vector<double> list;
  for (const int cells : {8, 16, 32})
    list.push_back(error(cells, shape, transfer, amplitude, 1e-4 * 64 / (cells * cells)));
  return list;
}
const std::vector<double> sizes{1.0 / 8, 1.0 / 16, 1.0 / 32};

}  // namespace

TEST_CASE("manufactured wave: second order without crossings, every shape and transfer", "[wave]") {
  for (const std::string shape : {"linear", "bspline_quadratic", "bspline_cubic"})
    for (const std::string transfer : {"flip", "apic", "mls"}) {
      const auto e = errors(shape, transfer, 0.0001);
      INFO(shape << " " << transfer << ": " << e[0] << " " << e[1] << " " << e[2]);
      CHECK(observed_order(sizes, e) > 1.7);
      CHECK(e[2] < 0.01 * 0.0001);
    }
}

TEST_CASE("manufactured wave: large deformation: B-splines converge, linear functions stall", "[wave]") {
  for (const std::string transfer : {"flip", "apic", "mls"}) {
    const auto smooth = errors("bspline_quadratic", transfer, 0.05);
    INFO(transfer << " quadratic: " << smooth[0] << " " << smooth[1] << " " << smooth[2]);
    // Second order gives way to the quadrature of two moving particles a cell, and in FLIP to null-space noise.
    CHECK(observed_order(sizes, smooth) > (transfer == "flip" ? 0.9 : 1.2));
    CHECK(smooth[2] < 0.004 * 0.05);
    const auto tent = errors("linear", transfer, 0.05);
    INFO(transfer << " linear: " << tent[0] << " " << tent[1] << " " << tent[2]);
    CHECK(tent[2] > 3 * smooth[2]);
    CHECK(observed_order(sizes, tent) < observed_order(sizes, smooth) - 0.5);
  }
}

// The wave begins without stress, so velocities are those of the middle of steps, and moving by the new one is of second
// order. The mean with the old one belongs to the beginning of the step: moving by it leaves dt (v(t) - v(0)) / 2 behind.
// At a quarter of a period v = 0, and the rest is v(0) dt / 2 = A c pi sin(pi X) dt / 2 in each of two directions, whose
// root mean square is A c pi dt / 2.
TEST_CASE("filtered particles that move by their new velocity are of second order in time, by the mean of first",
          "[wave]") {
  const double amplitude = 1e-4;
  const auto error_by = [&](const std::string& update, double step) {
    const std::string A = digits(amplitude),
                      filter = R"({"type": "fmpm", "order": 4, "position_update": ")" + update + "\"}";
    Scene scene(square, {set("/grid/cell_size", digits(1.0 / 32)), set("/shape/type", "bspline_cubic"),
                         set("/transfer/type", "pic"), set("/filter", filter), set("/constants/A", A),
                         set("/compare/exact/amplitude", A), set("/solver/time_step", digits(step))});
    return scene.run().position_error_rms;
  };
  const std::vector<double> steps{1e-4, 5e-5};
  std::map<std::string, std::vector<double>> errors_of;
  for (const std::string update : {"new_velocity", "mean_velocity"})
    for (const double step : steps) errors_of[update].push_back(error_by(update, step));
  const std::vector<double>&by_new = errors_of["new_velocity"], &by_mean = errors_of["mean_velocity"];
  INFO("new: " << by_new[0] << " " << by_new[1] << ", mean: " << by_mean[0] << " " << by_mean[1]);
  CHECK(std::abs(observed_order(steps, by_new) - 2) < 0.05);
  CHECK(std::abs(observed_order(steps, by_mean) - 1) < 0.02);
  const double left_behind = amplitude * 100 * std::numbers::pi * steps[1] / 2;
  CHECK(by_mean[1] == Approx(left_behind).epsilon(0.02));
}

// The wave with free faces, its axes along the grid and turned about z by 30 degrees: the same convergence, but for the
// rim, which is stepped where it is turned.
TEST_CASE("a manufactured wave converges along the grid and turned against it, in 2-D and 3-D", "[wave]") {
  const double angle = std::numbers::pi / 6, cosine = std::cos(angle), sine = std::sin(angle);
  const auto half_space = [](const std::string& normal, const std::string& point) {
    return R"({"type": "half_space", "normal": )" + normal + R"(, "point": )" + point + "}";
  };
  const auto turned_body = [&](bool solid) {
    const std::string z = solid ? ",0]" : "]";
    std::string all;
    for (const auto& [x, y] : {std::pair{cosine, sine}, {-cosine, -sine}, {-sine, cosine}, {sine, -cosine}})
      all += (all.empty() ? "" : ",") +
             half_space("[" + digits(x) + "," + digits(y) + z, "[" + digits(x / 2) + "," + digits(y / 2) + z);
    if (solid) all += "," + half_space("[0,0,1]", "[0,0,0.5]") + "," + half_space("[0,0,-1]", "[0,0,-0.5]");
    return R"({"type": "intersection", "of": [)" + all + "]}";
  };
  for (const int dimension : {2, 3})
    for (const bool is_turned : {false, true})
      for (const auto& [shape, transfer] : {std::pair{"bspline_cubic", "apic"}, std::pair{"cpdi", "flip"}}) {
        std::vector<double> sizes, errors;
        for (const int cells : dimension == 2 ? std::vector{16, 32} : std::vector{8, 16}) {
          std::vector<std::string> overrides{set("/grid/cell_size", digits(1.0 / cells)), set("/shape/type", shape),
                                             set("/transfer/type", transfer)};
          if (is_turned)
            overrides.insert(overrides.end(), {set("/compare/exact/angle", digits(angle)),
                                               set("/constants/ca", digits(cosine)), set("/constants/sa", digits(sine)),
                                               set("/bodies/0/geometry", turned_body(dimension == 3))});
          ShippedScene scene(dimension == 2 ? "studies/turned_wave.json" : "studies/turned_wave_3d.json", overrides);
          sizes.push_back(1.0 / cells);
          errors.push_back(scene.run().position_error_rms / 0.05);
          REQUIRE(scene.failure.empty());
        }
        INFO(dimension << "-D " << shape << " " << transfer << (is_turned ? " turned: " : ": ") << errors[0] << " "
                       << errors[1]);
        std::printf("  %d-D %s %s%s: %.3g %.3g, order %.2f\n", dimension, shape, transfer, is_turned ? " turned" : "",
                    errors[0], errors[1], observed_order(sizes, errors));
        CHECK(observed_order(sizes, errors) > 1);
        CHECK(errors.back() < 0.02);
      }
}

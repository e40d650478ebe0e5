// Locking of nearly incompressible materials, and its cure by averages of the nodes (docs/method.md, "Mean dilation"):
//  - a thick tube under inner pressure against Lame's solution, which loads_tube.cpp states, as Poisson's ratio goes to a half, and
//    against Hill's, which thick_cylinder.cpp states, where it flows;
//  - a short cantilever under a load at its tip against finite elements in plane strain, squares of nine nodes, of which 32
//    and 48 over the height sink by 0.97045 and 0.97119 of what Timoshenko & Goodier 1970, Theory of Elasticity, art. 21,
//    have for a clamp that lets the section warp; the clamp's corners leave first order, which gives 0.97267.

#include <cmath>

#include "beam_tip.hpp"
#include "locking_tube.hpp"
#include "shipped.hpp"
#include "support/catch.hpp"

namespace mpm::test::locking_tube {

namespace {

/// What the tip of the cantilever of loads/locking.json sinks too far, over what it should.
double error_of_tip(const std::vector<std::string>& overrides) {
  ShippedScene scene("loads/locking.json", overrides);
  const std::vector<double> X = scene.simulation.backend().body_state(0).position;
  scene.run();
  REQUIRE(scene.failure.empty());
  return end_of_beam(X, scene.simulation.backend().body_state(0).position, 1).tip[1] / -0.001 - 1;
}

}  // namespace

TEST_CASE("the load of the cantilever sinks its tip by a thousandth of its length", "[locking]") {
  const double nu = 0.499, H = 0.2, E = modulus / (1 - nu * nu), n = nu / (1 - nu), I = H * H * H / 12;
  const double P = shipped("loads/locking.json").resolved["constants"]["P"].get<double>();
  CHECK(0.97267 * (P / (3 * E * I) + (4 + 5 * n) * P * H * H / (24 * E * I)) == Approx(0.001).epsilon(1e-5));
}

TEST_CASE("rings that hardly change their volume lock with their own dilation and not with the mean one", "[locking]") {
  std::printf("Rings: shape, transfer, nu, cells, error of u(a) with each particle's own dilation and with the mean\n");
  const auto compare = [&](const std::string& shape, const std::string& transfer, int cells) {
    Tube tube{shape, transfer, 0.499, cells, false};
    const double own = error_of(tube);
    tube.averaged = true;
    const double mean = error_of(tube);
    std::printf("  %-18s %-5s %.3f %d %+.5f %+.5f\n", shape.c_str(), transfer.c_str(), tube.nu, cells, own, mean);
    INFO(shape << " " << transfer << " " << cells << " cells");
    if (shape != "bspline_quadratic") CHECK(own < (cells == 4 ? -0.5 : -0.2));
    CHECK(std::abs(mean) < 0.01);
  };
  for (const std::string shape : {"linear", "gimp", "cpdi", "bspline_quadratic"})
    for (const std::string transfer : {"apic", "flip"}) compare(shape, transfer, 4);
  compare("gimp", "apic", 8);
  // A compressible tube is as good with the mean dilation as with its own.
  for (const std::string shape : {"linear", "gimp"}) CHECK(std::abs(error_of({shape, "apic", 0.3, 4, true})) < 0.01);
}

TEST_CASE("a tube that flows and hardly changes its volume widens as Hill says with the mean dilation", "[locking]") {
  // Radii a and b, nu = 0.499, 150 MPa: it flows up to 0.1278281 m, and outside k c^2 / b^2 is the mean of the stresses.
  constexpr double r = 0.19375, nu = 0.499, E = 1763.867e9, c = 0.1278280914;
  const double mean = 240e6 / std::sqrt(3.0) * c * c / (b * b);
  const double exact = (1 + nu) / E * mean * ((1 - 2 * nu) * r + b * b / r);
  for (const std::string shape : {"linear", "gimp", "cpdi"})
    for (const bool averaged : {false, true}) {
      ShippedScene scene("studies/locking_tube.json",
                         {set("/shape/type", shape), set("/solver/dilation", averaged ? "averaged" : "own")});
      const std::vector<double> X = scene.simulation.backend().body_state(0).position;
      scene.run();
      REQUIRE(scene.failure.empty());
      const std::vector<double> x = scene.simulation.backend().body_state(0).position;
      double moved = 0;
      for (std::size_t p = 0; p < X.size(); p += 2)
        if (std::abs(X[p] - r) < 1e-9) moved = x[p] - X[p];
      std::printf("Flowing tube: %-6s %s %+.4f\n", shape.c_str(), averaged ? "mean" : "own ", moved / exact - 1);
      INFO(shape << (averaged ? ", averaged" : ", own"));
      if (averaged) {  // soft by a little on 4 cells; by the averaged stress alone linear functions and CPDI are stiff
        CHECK(std::abs(moved / exact - 1) < 0.03);
        CHECK(moved > exact);
      } else {
        CHECK(moved < 0.5 * exact);
      }
    }
}

TEST_CASE("a cantilever that hardly changes its volume bends as it should with the mean dilation", "[locking]") {
  const double own = error_of_tip({"/solver/dilation=own"}), mean = error_of_tip({});
  std::printf("Cantilever: error of the tip with each particle's own dilation %+.4f, with the mean %+.4f\n", own, mean);
  CHECK(own < -0.7);
  CHECK(std::abs(mean) < 0.05);  // on 4 cells
}

TEST_CASE("a cantilever that hardly changes its volume, on finer cells and by other shapes", "[locking][slow]") {
  std::printf("Cantilever: shape, cells of the height, error of the tip with the mean dilation\n");
  for (const std::string shape : {"linear", "gimp", "bspline_quadratic", "cpdi"}) {
    const double coarse = error_of_tip({set("/shape/type", shape)}),
                 fine = error_of_tip({set("/shape/type", shape), set("/grid/cell_size", "0.025")});
    std::printf("  %-18s 4 %+.4f, 8 %+.4f\n", shape.c_str(), coarse, fine);
    INFO(shape);
    CHECK(std::abs(coarse) < 0.05);
    CHECK(std::abs(fine) < 0.02);
  }
}

}  // namespace mpm::test::locking_tube

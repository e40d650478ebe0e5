// The null space with steps that have a length: velocities that no node sees move nothing and strain nothing, so FLIP
// keeps them, and the places, for ever; everything else that returns what the grid has seen returns nothing. Orders and
// schedules of filters are in lattice.cpp. `ctest -V` shows the table.

#include <cstdio>

#include "lattice.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("what no node sees does not move", "[null_space]") {
  // The particles are at 1/4 and 3/4 of their cell.
  const auto alternating = [](double x) { return x - std::floor(x) < 0.5 ? 1.0 : -1.0; };
  std::printf("Null space: largest velocity after one step, seeded with 1; FLIP: largest change in 100 steps\n");
  for (const std::string& shape : shapes_present(
           {"linear", "bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp", "cpdi", "cpdi2"}))
    for (const std::string backend : {"reference", "cpu"}) {
      std::printf("  %-17s %-9s", shape.c_str(), backend.c_str());
      Line line{.shape = shape, .backend = backend, .particles_per_cell = 2, .time_step = 0.3};
      INFO(shape << " " << backend);
      for (const auto& [transfer, with_filter] :
           {std::pair{"pic", std::string()}, std::pair{"apic", std::string()}, std::pair{"mls", std::string()},
            std::pair{"tpic", std::string()}, std::pair{"rpic", std::string()}, std::pair{"polypic", std::string()},
            std::pair{"pic", filter("xpic", 5)}, std::pair{"pic", filter("fmpm", 4)}}) {
        if (pairs_of({shape}, {transfer}).empty()) continue;  // such a pair is refused
        line.transfer = transfer;
        line.filter = with_filter;
        LineScene scene(line, alternating);
        scene.step();
        std::printf(" %.0e", scene.largest_speed());
        INFO(transfer << " " << with_filter);
        CHECK(scene.largest_speed() <= 1e-14);
      }
      line.transfer = "flip";
      line.filter = "";
      LineScene scene(line, alternating);
      const std::vector<double> v = scene.velocities(), x = scene.places();
      scene.step(100);
      double change = 0;
      for (std::size_t k = 0; k < v.size(); ++k)
        change = larger(change, larger(std::abs(scene.velocities()[k] - v[k]), std::abs(scene.places()[k] - x[k])));
      std::printf(" %.0e\n", change);
      CHECK(scene.largest_speed() > 0.99);
      CHECK(change <= 1e-12);
    }
}

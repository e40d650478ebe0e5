// The warning of curved bodies in contact whose particles are too far apart.

#include "run/rim_steps.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

std::string warning(const std::vector<std::string>& settings) {
  return app::warning_of_rim_steps(
      experiment_from(support::read_file(MPM_SOURCE_DIR "/experiments/studies/hertz_spheres.json"), settings));
}

std::vector<std::string> with_particles(int first, int second) {
  return {set("/bodies/0/particles_per_cell_axis", std::to_string(first)),
          set("/bodies/1/particles_per_cell_axis", std::to_string(second))};
}

}  // namespace

TEST_CASE("the smallest radius of a region is that of its curved parts", "[geometry]") {
  const auto ball = make_ball(2, {0, 0, 0}, 0.3), box = make_box(2, {0, 0, 0}, {1, 1, 0});
  CHECK(ball->smallest_radius() == 0.3);
  CHECK(make_ring(2, {0, 0, 0}, 0.2, 0.4, 0, 0)->smallest_radius() == 0.2);
  CHECK(make_ring(2, {0, 0, 0}, 0, 0.4, 0, 0)->smallest_radius() == 0.4);
  CHECK(std::isinf(box->smallest_radius()));
  CHECK(std::isinf(make_polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})->smallest_radius()));
  CHECK(make_difference({box, ball})->smallest_radius() == 0.3);
  CHECK(make_union({make_ball(2, {0, 0, 0}, 0.5), ball, box})->smallest_radius() == 0.3);
}

TEST_CASE("curved bodies in contact with coarse rims are warned of", "[contact]") {
  // 20 cells a radius with 2 particles a cell: steps of 25 mm, felt below 2 sqrt(2 R s) = 0.447 m.
  const std::string coarse = warning({});
  INFO(coarse);
  CHECK(coarse.find("body \"lower\" (radius 1 m) is built of steps of 0.025 m") != std::string::npos);
  CHECK(coarse.find("less than 0.447 m wide") != std::string::npos);
  CHECK(coarse.find("take particles 2 times as close") != std::string::npos);
  CHECK(warning(with_particles(4, 2)).find("body \"upper\"") != std::string::npos);
  CHECK(warning(with_particles(4, 4)).empty());
  CHECK(warning({set("/grid/cell_size", "0.025")}).empty());
}

TEST_CASE("flat bodies, bodies of one field and welds have no rim to warn of", "[contact]") {
  CHECK(warning({"/contact=null"}).empty());
  CHECK(warning({R"(/contact={"type": "stick"})"}).empty());
  const std::string box = R"(={"type": "box", "lower": [0, -1], "upper": [1, -0.2]})";
  CHECK(!warning({"/bodies/0/geometry" + box}).empty());
  CHECK(
      warning({"/bodies/0/geometry" + box, R"(/bodies/1/geometry={"type": "box", "lower": [0, 0.2], "upper": [1, 1]})"})
          .empty());
}

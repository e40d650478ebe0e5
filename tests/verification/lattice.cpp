// Waves on a lattice: what one step does to a wave, and what it does to the null space. Both are exact for a periodic
// lattice with one particle a cell. The table of damping factors is in transfer_damping.cpp.

#include "lattice.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The squared symbol |S|^2 of a particle at the middle of a cell (offset 0) or on a node (1/2). The domain of a cpdi
/// or cpdi2 particle on a node straddles it: weights 1/4, 1/2, 1/4.
double symbol_squared(const std::string& shape, double offset, double theta) {
  if (shape == "bspline_cubic" || shape == "b2gimp") {  // both are the same at one particle a cell
    if (offset == 0) return std::pow((23 * std::cos(theta / 2) + std::cos(1.5 * theta)) / 24, 2);
    return std::pow((2 + std::cos(theta)) / 3, 2);
  }
  if (offset == 0) return std::pow(std::cos(theta / 2), 2);
  if (shape.starts_with("cpdi")) return std::pow(std::cos(theta / 2), 4);
  return std::pow(0.75 + std::cos(theta) / 4, 2);
}

constexpr int modes[] = {1, 2, 4, 8};

}  // namespace

TEST_CASE("damping of a mode by PIC, XPIC, FMPM and FLIP is that of the symbol", "[damping]") {
  for (const auto& [shape, offset] :
       {std::pair{"linear", 0.0}, std::pair{"bspline_quadratic", 0.0}, std::pair{"gimp", 0.0}, std::pair{"cpdi", 0.0},
        std::pair{"bspline_quadratic", 0.5}, std::pair{"gimp", 0.5}, std::pair{"cpdi", 0.5},
        std::pair{"bspline_cubic", 0.0}, std::pair{"bspline_cubic", 0.5}, std::pair{"b2gimp", 0.0},
        std::pair{"b2gimp", 0.5}, std::pair{"gimp_contiguous", 0.0}, std::pair{"gimp_contiguous", 0.5},
        std::pair{"cpdi2", 0.0}, std::pair{"cpdi2", 0.5}})
    for (const int mode : modes) {
      const double s2 = symbol_squared(shape, offset, 2 * std::numbers::pi * mode / 32);
      Line line{.shape = shape, .mode = mode, .offset = offset};
      INFO(shape << " offset " << offset << " mode " << mode);
      CHECK(factor(line) == Approx(s2).epsilon(1e-10));
      line.transfer = "flip";
      CHECK(factor(line) == Approx(1.0).epsilon(1e-10));
      line.transfer = "pic";
      for (const int order : {1, 2, 3, 5})
        for (const char* type : {"xpic", "fmpm"}) {
          INFO(type << " " << order);
          line.filter = filter(type, order);
          CHECK(factor(line) == Approx(1 - std::pow(1 - s2, order)).epsilon(1e-10));
        }
    }
}

TEST_CASE("affine transfers damp by the fourth power of the wave number", "[damping]") {
  // The factor is 1 - (3/64) theta^4, against 1 - theta^2 / 4 of PIC; TPIC's gradient is APIC's affine matrix on this
  // lattice.
  const double theta = 2 * std::numbers::pi / 32;
  for (const char* transfer : {"apic", "mls", "tpic", "polypic"}) {
    INFO(transfer);
    const double loss = 1 - factor({.shape = "bspline_quadratic", .transfer = transfer, .offset = 0.5});
    CHECK(loss == Approx(3.0 / 64 * std::pow(theta, 4)).epsilon(0.05));
  }
  // For lists of nodes on a node the second moment is 1/2, the first moment i sin(theta) / 2.
  for (const int mode : modes) {
    const double angle = 2 * std::numbers::pi * mode / 32;
    const double exact = std::pow(std::cos(angle / 2), 4) + 0.5 * std::pow(std::sin(angle), 2);
    for (const char* shape : {"cpdi", "cpdi2"})
      CHECK(factor({.shape = shape, .transfer = "apic", .mode = mode, .offset = 0.5}) == Approx(exact).epsilon(1e-10));
    // A whole basis keeps all that the grid holds.
    for (const char* shape : {"linear", "bspline_quadratic", "bspline_cubic"})
      CHECK(factor({.shape = shape,
                    .transfer = R"({"type": "polypic", "basis": "full"})",
                    .mode = mode,
                    .offset = shape == std::string("linear") ? 0 : 0.5}) == Approx(1.0).epsilon(1e-10));
  }
}

TEST_CASE("the null space: FLIP keeps it, every other transfer and filter order removes it", "[null_space]") {
  // The particles are at 1/4 and 3/4 of their cell, with velocities +1 and -1: no node sees anything.
  const auto alternating = [](double x) { return x - std::floor(x) < 0.5 ? 1.0 : -1.0; };
  for (const char* shape :
       {"linear", "bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp", "cpdi", "cpdi2"}) {
    const auto run = [&](const std::string& transfer, const std::string& with_filter, int steps) {
      auto scene = std::make_unique<LineScene>(
          Line{.shape = shape, .transfer = transfer, .filter = with_filter, .particles_per_cell = 2}, alternating);
      scene->step(steps);
      return scene;
    };
    INFO(shape);
    CHECK(run("flip", "", 100)->velocities().front() == Approx(1.0).epsilon(1e-12));
    CHECK(run("flip", "", 100)->largest_speed() == Approx(1.0).epsilon(1e-12));
    for (const auto& [one, transfer] : pairs_of({shape}, {"pic", "apic", "mls", "tpic", "rpic", "polypic"})) {
      INFO(transfer);
      CHECK(run(transfer, "", 1)->largest_speed() <= 1e-14);
    }
    for (const int order : {2, 5, 20})
      for (const char* type : {"xpic", "fmpm"}) CHECK(run("pic", filter(type, order), 1)->largest_speed() <= 1e-14);
    // Periodic filtering is what removes FLIP's noise. The steps last 1e-13 s; waves and particles together run 2e-13
    // cells a step.
    for (const char* every_third : {"\"every_steps\": 3", "\"every_time\": 3e-13", "\"every_courant\": 5e-13"}) {
      INFO(every_third);
      const std::string periodic = R"({"type": "fmpm", "order": 4, )" + std::string(every_third) + "}";
      CHECK(run("flip", periodic, 2)->largest_speed() == Approx(1.0).epsilon(1e-12));
      CHECK(run("flip", periodic, 3)->largest_speed() <= 1e-14);
    }
  }
  // The waves that the grid does see survive a high order: 1 - (1 - s2)^5 of the published check.
  CHECK(std::abs(factor({.filter = filter("xpic", 5), .mode = 4}) - .99993264) <= 1e-8);
}

// The numbers of two colliding discs (Sulsky, Chen & Schreyer 1994; 40 x 40 cells, 2 x 2 particles a cell, dt = 0.001
// s): masses, kinetic energy, the time they touch, and what every transfer keeps of energy, momentum and angular
// momentum. `ctest -V` shows the tables. Symmetry, and flight before contact, are in discs.cpp.

#include <cmath>

#include "spin_balance.hpp"
#include "support/catch.hpp"
#include "verification/colliding_discs.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::colliding_discs;

namespace {

/// The upper disc is moved by 0.1 across its velocity, both in free space.
const std::vector<std::string> oblique{
    R"(/grid={"cell_size": 0.025, "domain": [[-0.1, -0.1], [1.1, 1.1]], "boundaries": {"all": "free"}})",
    "/bodies/1/geometry/centre=[0.729289322, 0.870710678]", "/solver/end_time=3"};

const std::string friction = R"({"type": "coulomb", "friction": 0.3})";

}  // namespace

TEST_CASE("two discs: masses and kinetic energy tend to the discs'", "[discs]") {
  std::printf("Discs: mass of a disc (kg/m) and kinetic energy (J/m) on 40, 80, 160 cells, of %.4f and %.8f\n", mass,
              kinetic);
  for (const int n : {40, 80, 160}) {
    const Scene scene(discs, {set("/grid/cell_size", digits(1.0 / n))});
    const Totals start = scene.metrics.initial();
    std::printf("  %d: %.4f %.8f\n", n, start.mass / 2, start.kinetic);
    // The error is 0.96 % on 40 cells; the count of lattice points in a circle errs by less than its edge's.
    const double bound = n == 40 ? 0.01 : 0.35 / n;
    CHECK(start.mass == Approx(2 * mass).epsilon(bound));
    CHECK(start.kinetic == Approx(kinetic).epsilon(bound));
    CHECK(start.kinetic == Approx(0.5 * start.mass * 0.02).epsilon(1e-12));
  }
}

TEST_CASE("two discs: time of touch and energy of every transfer", "[discs]") {
  print_heads();
  const auto check = [](const std::string& shape, const std::string& transfer, const std::string& update,
                        double least = 0) {
    const Collision found = collide(scheme(shape, transfer, update));
    check_collision(shape + " " + transfer + " " + update, found);
    CHECK(found.kept > least);
    CHECK(found.first < touch);
    CHECK(found.clear < touch);
    CHECK(found.clear > touch - 2 * cell / approach);
  };
  // The case asks for E_tot within 2 %: FLIP with MUSL keeps it on every shape, as in the literature (linear); on gimp
  // with USL too. What others keep is in tests/regression/colliding_discs.cpp, and what finer cells give below.
  for (const std::string shape : {"linear", "gimp", "bspline_quadratic"}) check(shape, "flip", "modified_last", 0.98);
  check("gimp", "flip", "last", 0.98);
  for (const std::string shape : {"linear", "bspline_quadratic", "cpdi", "bspline_cubic"}) check(shape, "flip", "last");
  for (const std::string transfer : {"aflip", "asflip", "apic", "mls", "tpic", "rpic", "pic"})
    check("gimp", transfer, "last");
}

TEST_CASE("two discs: what is lost goes in the transfers or by the time step", "[discs]") {
  print_heads();
  const auto lost = [](const std::string& name, const std::vector<std::string>& settings) {
    const Collision found = collide(settings + set("/output/ledger", "true"));
    check_collision(name, found);
    return found;
  };
  // FLIP's loss is USL's (its determinant is below 1, stress_update.cpp): half a step leaves half of it, and MUSL less.
  const auto usl = scheme("bspline_quadratic", "flip");
  const double whole = 1 - lost("bspline_quadratic flip", usl).kept;
  CHECK(1 - lost("bspline_quadratic flip, dt/2", usl + set("/solver/time_step", "0.0005")).kept < 0.7 * whole);
  CHECK(std::abs(1 - lost("bspline_quadratic flip MUSL", scheme("bspline_quadratic", "flip", "modified_last")).kept) <
        whole);
}

TEST_CASE("two discs: losses fall with the step or with the cells", "[discs][slow]") {
  print_heads();
  const auto lost = [](const std::string& name, const std::vector<std::string>& settings) {
    const Collision found = collide(settings);
    check_collision(name, found);
    return 1 - found.kept;
  };
  // With USL the loss is of first order in the step, and within 2 % at a quarter of it. On bspline_cubic it is just not, and
  // on linear a smaller step hardly helps: tests/regression/colliding_discs.cpp.
  for (const std::string shape : {"gimp", "bspline_quadratic", "cpdi", "bspline_cubic"}) {
    const auto usl = scheme(shape, "flip");
    const double whole = lost(shape + " flip", usl);
    const double quarter = lost(shape + " flip, dt/4", usl + set("/solver/time_step", "0.00025"));
    CHECK(quarter < 0.45 * whole);
    if (shape != "bspline_cubic") CHECK(quarter < 0.02);
    CHECK(std::abs(lost(shape + " flip MUSL", scheme(shape, "flip", "modified_last"))) < 0.02);
  }
  // AFLIP and ASFLIP reach 2 % on 80 cells.
  for (const std::string transfer : {"aflip", "asflip"})
    CHECK(lost("gimp " + transfer + ", 80 cells", scheme("gimp", transfer) + set("/grid/cell_size", "0.0125")) < 0.02);
}

TEST_CASE("angular momentum of an oblique collision", "[discs]") {
  std::printf(
      "Oblique discs: angular momentum at the start (kg m^2/s), exact %.8f without affine parts; share kept at 3 s\n",
      1.77715318);
  const auto check = [](const std::string& name, const std::string& contact, const std::string& transfer) {
    Scene scene(discs, oblique + set("/contact", contact) + set("/transfer/type", transfer) +
                           set("/shape/type", "bspline_quadratic"));
    const Totals start = scene.metrics.initial(), end = scene.run();
    const double kept = end.angular_momentum[2] / start.angular_momentum[2];
    std::printf("  %-12s %-7s %.8f %.8f\n", name.c_str(), transfer.c_str(), std::abs(start.angular_momentum[2]), kept);
    INFO(name << " " << transfer);
    CHECK(std::abs(start.angular_momentum[2]) == Approx(1.77715318).epsilon(0.02));
    // The lattice does not fit both discs alike: their masses differ by 0.6 %, and the pair drifts.
    CHECK(std::hypot(end.momentum[0] - start.momentum[0], end.momentum[1] - start.momentum[1]) <
          1e-11 * start.mass * 0.14);
    if (transfer == "pic")
      CHECK(std::abs(kept) < 0.9);
    else
      CHECK(kept == Approx(1).epsilon(0.005));
  };
  for (const std::string transfer : {"apic", "mls", "tpic", "rpic", "pic"}) check("one field", "null", transfer);
  // The friction of apic and mls is in discs.cpp.
  for (const std::string transfer : {"tpic", "rpic"}) check("friction 0.3", friction, transfer);
  check("no friction", R"({"type": "coulomb", "friction": 0})", "flip");
}

// On 40 cells FLIP, AFLIP and ASFLIP lose 0.9 to 1.5 % of L, all of it by lumped masses at the discs' free edges
// (spin_balance.hpp). It falls with the cells: on 80 they keep L to 0.5 %.
TEST_CASE("the spin that FLIP, AFLIP and ASFLIP lose in a collision", "[discs]") {
  std::printf("Oblique discs, 40 cells: change of L by lumped masses, motion, filter | sum, the run's | gap\n");
  std::vector<double> coarse, fine;
  const std::vector<std::string> transfers{"flip", "aflip", "asflip"};
  const auto settings = [](const std::string& transfer) {
    return oblique + set("/transfer/type", transfer) + set("/shape/type", "bspline_quadratic");
  };
  for (const std::string& transfer : transfers) {
    // The runs go without the share of PIC that AFLIP and ASFLIP take otherwise.
    Scene scene(discs, settings(transfer) + set("/transfer/pic_fraction", "0"));
    const SpinBalance found = spin_balance(scene, 1000, 0.3);
    check_balance(transfer, found);
    coarse.push_back(std::abs(found.change));
  }
  std::printf("Oblique discs, 80 cells, dt = 0.002 s: share of L kept at 3 s\n");
  for (const std::string& transfer : transfers)
    for (const std::string& contact : {std::string("null"), friction}) {
      Scene scene(discs, settings(transfer) + set("/grid/cell_size", "0.0125") + set("/solver/time_step", "0.002") +
                             set("/contact", contact));
      const double start = scene.metrics.initial().angular_momentum[2], kept = scene.run().angular_momentum[2] / start;
      std::printf("  %-7s %-13s %.8f\n", transfer.c_str(), contact == "null" ? "one field" : "friction 0.3", kept);
      INFO(transfer << " " << contact);
      CHECK(kept == Approx(1).epsilon(0.005));
      if (contact == "null") fine.push_back(std::abs(kept - 1));
    }
  for (std::size_t k = 0; k < fine.size(); ++k) CHECK(fine[k] < 0.5 * coarse[k]);
}

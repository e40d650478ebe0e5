// The numbers of two colliding discs (Sulsky, Chen & Schreyer 1994; 40 x 40 cells, 2 x 2 particles a cell, dt = 0.001
// s): masses, kinetic energy, the time they touch, and what every transfer keeps of energy, momentum and angular
// momentum. `ctest -V` shows the tables. Symmetry, and flight before contact, are in discs.cpp.

#include <cmath>

#include "spin_balance.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* discs = R"J({
  "dimension": 2,
  "grid": {"cell_size": 0.025, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "separate"}},
  "shape": {"type": "gimp"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "lower", "material": "m", "geometry": {"type": "ball", "centre": [0.2, 0.2], "radius": 0.2}, "velocity": [0.1, 0.1]},
    {"name": "upper", "material": "m", "geometry": {"type": "ball", "centre": [0.8, 0.8], "radius": 0.2}, "velocity": [-0.1, -0.1]}],
  "solver": {"time_step": 0.001, "end_time": 3.5}, "output": {"ledger": false}})J";

/// The upper disc is moved by 0.1 across its velocity, both in free space.
const std::vector<std::string> oblique{
    R"(/grid={"cell_size": 0.025, "domain": [[-0.1, -0.1], [1.1, 1.1]], "boundaries": {"all": "free"}})",
    "/bodies/1/geometry/centre=[0.729289322, 0.870710678]", "/solver/end_time=3"};

const std::string friction = R"({"type": "coulomb", "friction": 0.3})";

std::vector<std::string> operator+(std::vector<std::string> list, const std::string& one) {
  list.push_back(one);
  return list;
}

constexpr double mass = 125.6637, kinetic = 2.51327412, touch = 1.58578644, cell = 0.025, approach = 0.2828427125;

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

namespace {

struct Collision {
  double first = 0, clear = 0;   ///< s at which strain energy is above 1e-6 and 1e-2 of the kinetic
  double kept = 0, kinetic = 0;  ///< total and kinetic energy at the end, over the initial
  double largest = 0;            ///< largest total energy over the initial
  double transfers = 0;          ///< loss over the initial in scatter and gather, by the ledger
  double steps = 0;              ///< loss over the initial by time integration, likewise
  double drift = 0;              ///< kg m/s, momentum at the end
  double mass = 0;
};

Collision collide(const std::vector<std::string>& settings) {
  Scene scene(discs, settings);
  const Totals start = scene.metrics.initial();
  Collision found{.mass = start.mass};
  Totals now;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.steps() % 10 != 0 && !scene.simulation.finished()) continue;
    now = scene.metrics.measure();
    if (found.first == 0 && now.strain > 1e-6 * start.kinetic) found.first = now.time;
    if (found.clear == 0 && now.strain > 1e-2 * start.kinetic) found.clear = now.time;
    found.largest = std::max(found.largest, now.total_energy() / start.total_energy());
  }
  found.kept = now.total_energy() / start.total_energy(), found.kinetic = now.kinetic / start.kinetic;
  found.drift = std::hypot(now.momentum[0], now.momentum[1]);
  const Ledger& ledger = scene.simulation.backend().ledger();
  found.transfers = -(ledger.scatter + ledger.gather) / start.total_energy();
  found.steps = -scene.metrics.ledger_residual(now) / start.total_energy();
  return found;
}

void check_collision(const std::string& name, const Collision& found, double least_kept, double most_kept = 1.0001) {
  std::printf("  %-34s %.3f %.3f %.4f %.4f %.4f", name.c_str(), found.first, found.clear, found.kept, found.kinetic,
              found.largest);
  if (found.transfers != 0) std::printf(" | %7.4f %7.4f", found.transfers, found.steps);
  std::printf("\n");
  INFO(name);
  CHECK(found.largest <= 1.01);
  CHECK(found.drift < 1e-10 * found.mass * 0.14);
  CHECK(found.kinetic < found.kept);  // the rest is vibration
  CHECK(found.kept > least_kept);
  CHECK(found.kept < most_kept);
}

void print_heads() {
  std::printf(
      "Discs: touch at %.8f s; strain energy above 1e-6 and 1e-2 of the kinetic (s); total and kinetic energy kept at "
      "3.5 "
      "s, largest total | with a ledger: lost by transfers, by time integration\n",
      touch);
}

std::vector<std::string> scheme(const std::string& shape, const std::string& transfer,
                                const std::string& update = "last") {
  return {set("/shape/type", shape), set("/transfer/type", transfer), set("/solver/stress_update", update)};
}

}  // namespace

TEST_CASE("two discs: time of touch and energy of every transfer", "[discs]") {
  print_heads();
  const auto check = [](const std::string& shape, const std::string& transfer, const std::string& update, double least,
                        double most = 1.0001) {
    const Collision found = collide(scheme(shape, transfer, update));
    check_collision(shape + " " + transfer + " " + update, found, least, most);
    CHECK(found.first < touch);
    CHECK(found.clear < touch);
    CHECK(found.clear > touch - 2 * cell / approach);
  };
  // The case asks for E_tot within 2 %: FLIP with MUSL keeps it on every shape, as in the literature (linear); on gimp
  // with USL too. USL takes 2 % on wider shapes, see below.
  for (const std::string shape : {"linear", "gimp", "bspline_quadratic"}) check(shape, "flip", "modified_last", 0.98);
  check("gimp", "flip", "last", 0.98);
  for (const std::string shape : {"linear", "bspline_quadratic", "cpdi"}) check(shape, "flip", "last", 0.96, 0.98);
  check("bspline_cubic", "flip", "last", 0.93, 0.95);
  // At every step AFLIP and ASFLIP take 1 % of PIC, the others all of it; what finer cells give is below.
  for (const std::string transfer : {"aflip", "asflip"}) check("gimp", transfer, "last", 0.97, 0.98);
  for (const std::string transfer : {"apic", "mls", "tpic"}) check("gimp", transfer, "last", 0.75, 0.82);
  for (const std::string transfer : {"rpic", "pic"}) check("gimp", transfer, "last", 0.1, 0.3);
}

TEST_CASE("two discs: what is lost goes in the transfers or by the time step", "[discs]") {
  print_heads();
  const auto lost = [](const std::string& name, const std::vector<std::string>& settings) {
    const Collision found = collide(settings + set("/output/ledger", "true"));
    check_collision(name, found, 0.75);
    return found;
  };
  // FLIP's loss is USL's (its determinant is below 1, stress_update.cpp): it falls with the step, and MUSL has a tenth
  // of it.
  const auto usl = scheme("bspline_quadratic", "flip");
  const double whole = 1 - lost("bspline_quadratic flip", usl).kept;
  CHECK(1 - lost("bspline_quadratic flip, dt/2", usl + set("/solver/time_step", "0.0005")).kept < 0.7 * whole);
  CHECK(std::abs(1 - lost("bspline_quadratic flip MUSL", scheme("bspline_quadratic", "flip", "modified_last")).kept) <
        0.1 * whole);
  // The loss of APIC is that of its scatter and gather.
  const Collision apic = lost("gimp apic", scheme("gimp", "apic"));
  CHECK(apic.transfers > 0.9 * (1 - apic.kept));
}

TEST_CASE("two discs: losses fall with the step or with the cells", "[discs][slow]") {
  print_heads();
  const auto lost = [](const std::string& name, const std::vector<std::string>& settings) {
    const Collision found = collide(settings);
    check_collision(name, found, 0.1);
    return 1 - found.kept;
  };
  // With USL the loss is within 2 % at a quarter of the step, on bspline_cubic just not. On linear a smaller step
  // hardly helps.
  for (const std::string shape : {"gimp", "bspline_quadratic", "cpdi", "bspline_cubic"}) {
    const auto usl = scheme(shape, "flip");
    const double whole = lost(shape + " flip", usl);
    const double quarter = lost(shape + " flip, dt/4", usl + set("/solver/time_step", "0.00025"));
    CHECK(quarter < 0.45 * whole);
    CHECK(quarter < (shape == "bspline_cubic" ? 0.021 : 0.02));
    CHECK(std::abs(lost(shape + " flip MUSL", scheme(shape, "flip", "modified_last"))) < 0.02);
  }
  CHECK(lost("linear flip, dt/4", scheme("linear", "flip") + set("/solver/time_step", "0.00025")) > 0.025);
  // AFLIP and ASFLIP reach 2 % on 80 cells.
  for (const std::string transfer : {"aflip", "asflip"})
    CHECK(lost("gimp " + transfer + ", 80 cells", scheme("gimp", transfer) + set("/grid/cell_size", "0.0125")) < 0.02);
  // Affine transfers lose with an order of 1.5 at least, and come near 2 % on 160 cells; PIC and RPIC do not.
  for (const std::string transfer : {"apic", "mls", "tpic", "rpic", "pic"}) {
    const double coarse = lost("gimp " + transfer, scheme("gimp", transfer));
    const double fine =
        lost("gimp " + transfer + ", 160 cells", scheme("gimp", transfer) + set("/grid/cell_size", "0.00625"));
    const bool affine = transfer != "rpic" && transfer != "pic";
    INFO(transfer << ", order " << std::log2(coarse / fine) / 2);
    CHECK(std::log2(coarse / fine) / 2 > (affine ? 1.5 : 0.6));
    if (affine) CHECK(fine < 0.025);
  }
  // The higher the order of FMPM on PIC, the less is lost.
  const auto filtered = [&](int order) {
    const std::string number = std::to_string(order);
    return lost("gimp fmpm " + number,
                scheme("gimp", "pic") + (R"(/filter={"type": "fmpm", "order": )" + number + "}"));
  };
  const double order_8 = filtered(8);
  CHECK(filtered(16) < 0.6 * order_8);
  CHECK(order_8 < 0.03);
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

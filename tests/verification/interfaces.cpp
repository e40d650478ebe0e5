// Compliant interfaces and liquids between bodies, against closed forms: two elastic bars joined by a spring swing with
// k L tan(k L) = 2 D L / E, a liquid slows a slab with exp(-eta A t / (b m)).

#include <algorithm>
#include <cmath>
#include <numbers>

#include "interfaces.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

namespace mpm::test::interfaces {

namespace {

/// Across their thickness: one slides to and fro on the other, which a stiff layer along the normal keeps from turning.
Bars sliding(double ratio, double amplitude = 1e-4) {
  const double L = 0.1, G = modulus / 2, k = phase_over_length(ratio) / L;
  Bars bars{L, ratio * G / L, k, k * std::sqrt(G / density), {}};
  const std::string v = number(amplitude), phase = number(k);
  bars.text = R"J({
  "title": "two bars on a shear spring", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.025, "domain": [[-0.2, 0], [1.2, 0.2]], "boundaries": {"all": "free", "y_min": "slip", "y_max": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
  "contact": {"type": "linear_interface", "normal_stiffness": 0, "shear_stiffness": )J" +
              number(bars.stiffness) + R"J(},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 1000}},
  "bodies": [
    {"name": "lower", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 0.1]},
     "velocity": [")J" +
              v + "*cos(" + phase + R"J(*y)", 0]},
    {"name": "upper", "material": "m", "geometry": {"type": "box", "lower": [0, 0.1], "upper": [1, 0.2]},
     "velocity": ["-)J" +
              v + "*cos(" + phase + R"J(*(0.2-y))", 0]}],
  "solver": {"time_step": "auto", "courant": 0.2, "end_time": 1}, "output": {"ledger": true}})J";
  return bars;
}

/// Two blocks of 0.2 m by 0.2 m, one on the other, so stiff that they give a thousandth of what the layer between
/// them gives. Walls keep them from turning. The normal is given: where the default's tilts at the ends of a face, the layer
/// is softer. The upper one is thrown along an axis, and the lower one so that their centre of mass rests.
struct Blocks {
  double period;
  std::string text;
};
Blocks stiff_blocks(double lower_mass, double upper_mass, bool held, std::size_t axis) {
  const double stiffness = 1e4, area = 0.2, fast = 1e-3;  // N/m, m a metre of depth, m/s
  const double inverse = 1 / upper_mass + (held ? 0 : 1 / lower_mass);
  Blocks blocks{2 * std::numbers::pi / std::sqrt(stiffness * inverse), {}};
  const auto along = [axis](double speed) {
    return axis == 0 ? "[" + number(speed) + ", 0]" : "[0, " + number(speed) + "]";
  };
  const auto material = [](double mass) {
    return R"({"type": "neo_hookean", "youngs_modulus": 2e7, "poisson_ratio": 0, "density": )" + number(mass / 0.04) +
           "}";
  };
  blocks.text =
      R"J({
  "title": "stiff blocks on a spring", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.05, "domain": )J" +
      std::string(axis == 0 ? "[[-0.2, -0.2], [0.4, 0.2]]" : "[[0, -0.4], [0.2, 0.4]]") +
      R"J(, "boundaries": {"all": "free", )J" +
      (axis == 0 ? R"("y_min": "slip", "y_max": "slip")" : R"("x_min": "slip", "x_max": "slip")") + R"J(}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "contact": {"type": "linear_interface", "normal_stiffness": )J" +
      number(stiffness / area) + R"J(, "shear_stiffness": )J" + number(stiffness / area) +
      R"J(, "normal": {"type": "given", "x": 0, "y": 1}},
  "materials": {"lower": )J" +
      material(lower_mass) + R"J(, "upper": )J" + material(upper_mass) +
      R"J(},
  "bodies": [
    {"name": "lower", "material": "lower", "geometry": {"type": "box", "lower": [0, -0.2], "upper": [0.2, 0]}, "velocity": )J" +
      along(held ? 0 : -fast * upper_mass / lower_mass) +
      R"J(},
    {"name": "upper", "material": "upper", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.2, 0.2]}, "velocity": )J" +
      along(fast) + "}]," +
      (held ? R"J(
  "grips": [{"name": "held", "body": "lower", "velocity": [0, 0], "where": {"type": "box", "lower": [0, -0.2], "upper": [0.2, 0]}}],)J"
            : "") +
      R"J(
  "solver": {"time_step": "auto", "end_time": 1}, "output": {"ledger": false}})J";
  return blocks;
}

/// The mean velocity of the upper block past the lower one, m/s.
double velocity_past(const Scene& scene, std::size_t axis) {
  double past = 0;
  for (const int body : {0, 1}) {
    const BodyState state = scene.body(body);
    double sum = 0;
    for (std::size_t k = axis; k < state.velocity.size(); k += 2) sum += state.velocity[k];
    past += (body == 0 ? -2 : 2) * sum / static_cast<double>(state.velocity.size());
  }
  return past;
}

/// The period from the first and the fifth time at which that velocity passes through zero, two periods apart, s.
double period_of(const Blocks& blocks, std::size_t axis, std::vector<std::string> settings) {
  settings.push_back(set("/solver/end_time", digits(3 * blocks.period)));
  Scene scene(blocks.text, settings);
  std::vector<double> zeros;
  double before = velocity_past(scene, axis), time = 0;
  while (!scene.simulation.finished() && zeros.size() < 5) {
    scene.simulation.step();
    const double now = velocity_past(scene, axis), at = scene.simulation.time();
    if (now * before < 0) zeros.push_back(time + (at - time) * before / (before - now));
    before = now, time = at;
  }
  REQUIRE(zeros.size() == 5);
  return (zeros[4] - zeros[0]) / 2;
}

/// A slab slides on a frozen bed, pressed by its weight, without ends.
const char* slab = R"J({
  "title": "slab on a liquid film", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.05, "domain": [[0, 0], [0.5, 1]], "boundaries": {"x_min": "periodic", "x_max": "periodic", "y_min": "stick", "y_max": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
  "contact": {"type": "liquid_contact", "viscosity": 2, "slip_length": 1e-3},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e7, "poisson_ratio": 0, "density": 1000}},
  "bodies": [
    {"name": "bed", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.5, 0.2]}},
    {"name": "slab", "material": "m", "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.5, 0.4]}, "velocity": [0.1, 0]}],
  "gravity": [0, "-9.81*min(t/0.1, 1)"],
  "solver": {"time_step": "auto", "courant": 0.3, "end_time": 0.3}, "output": {"ledger": true}})J";

}  // namespace

// The bars' own waves are short of cells: at D L / E = 0.5 they are resolved by 5 and by 10 cells a bar, to first order. An
// opening that is not small beside a cell leaves nodes fewer of the other body, and softens the layer.
TEST_CASE("two bars on a spring swing with their closed form", "[interface]") {
  struct Bound {
    const char* name;
    Bars bars;
    double coarse, fine;
  };
  for (const Bound& now : {Bound{"opening", opening(0.01), 0.001, 0.0005}, Bound{"opening", opening(0.5), 0.037, 0.021},
                           Bound{"sliding", sliding(0.01), 0.006, 0.004}})
    for (const char* transfer : {"pic", "flip", "apic", "mls"}) {
      const double cell = now.name == std::string("opening") ? 0.05 : 0.025;
      for (const double finer : {1.0, 0.5}) {
        const double found =
            slowness(now.bars, {set("/transfer/type", transfer), set("/grid/cell_size", digits(cell * finer))});
        INFO(now.name << " " << transfer << " " << finer);
        CHECK(std::abs(found) < (finer == 1 ? now.coarse : now.fine));
      }
    }
}

TEST_CASE("a layer swings alike wherever its plane lies in a cell, on every backend and shape", "[interface]") {
  const Bars bars = opening(0.01);
  const auto check = [&](const std::string& name, std::vector<std::string> settings) {
    const double found = slowness(bars, std::move(settings));
    INFO(name);
    CHECK(std::abs(found) < 0.002);
  };
  for (const double shift : {0.25, 0.5, 0.75}) {
    const double left = -0.2 - shift * 0.05;
    check("shifted by " + digits(shift),
          {"/bodies/0/seeding=fitted", "/bodies/1/seeding=fitted",
           "/grid/domain=[[" + digits(left) + ", 0], [" + digits(left + 0.9) + ", 0.1]]"});
  }
  check("reference", {set("/backend", "reference")});
  // Each step moves the bars by less than a float resolves, unless they swing wider.
  CHECK(std::abs(slowness(opening(0.01, 5e-3), {set("/precision", "float")})) < 0.005);
  for (const char* shape : {"linear", "bspline_cubic", "gimp", "cpdi"}) check(shape, {set("/shape/type", shape)});
  for (const char* update : {"first", "modified_last", "averaged"})
    check(update, {set("/solver/stress_update", update)});
  check("bilinear", {"/contact={\"type\": \"bilinear_interface\", \"shear_stiffness\": 0, \"tension_stiffness\": " +
                     digits(bars.stiffness) + ", \"compression_stiffness\": " + digits(bars.stiffness) + "}"});
}

// Nearly rigid: T = 2 pi / sqrt(D A (1/m1 + 1/m2)), D A = 1e4 N/m. 1 kg on a block that is held: 0.06283185 s; 1 kg and 3 kg:
// 0.05441398 s.
TEST_CASE("stiff blocks on a spring swing with the period of their masses", "[interface]") {
  for (const bool held : {true, false})
    for (const std::size_t axis : {std::size_t{1}, std::size_t{0}}) {
      const Blocks blocks = held ? stiff_blocks(1, 1, true, axis) : stiff_blocks(1, 3, false, axis);
      const double exact = held ? 0.06283185 : 0.05441398;
      REQUIRE(blocks.period == Approx(exact).epsilon(1e-6));
      for (const char* transfer : {"flip", "apic"})
        for (const double courant : {0.5, 0.1})
          for (const char* cell : {"0.05", "0.025"}) {
            if (courant < 0.5 && cell != std::string("0.05")) continue;
            const double found = period_of(blocks, axis,
                                           {set("/transfer/type", transfer), set("/solver/courant", digits(courant)),
                                            set("/grid/cell_size", cell)});
            INFO((held ? "held" : "both free") << ", along " << (axis == 1 ? "the normal" : "the face") << ", "
                                               << transfer << ", courant " << courant << ", cells of " << cell << " m");
            CHECK(found == Approx(exact).epsilon(0.005));
          }
    }
}

TEST_CASE("bars on a spring keep their swing", "[interface]") {
  const Bars bars = opening(0.01);
  for (const double courant : {0.4, 0.1}) {
    Scene scene(bars.text, {set("/solver/courant", digits(courant)),
                            set("/solver/end_time", digits(4.2 * 2 * std::numbers::pi / bars.frequency))});
    const double start = velocity_along(scene, 0);
    double fastest = 0;
    while (!scene.simulation.finished()) {
      scene.simulation.step();
      if (scene.simulation.time() * bars.frequency > 3.8 * 2 * std::numbers::pi)
        fastest = larger(fastest, velocity_along(scene, 0));
    }
    INFO(courant);
    CHECK(fastest == Approx(start).epsilon(0.002));
  }
}

// Two planks on a layer that lets them slide bend as two beams with partial interaction (Newmark, Siess & Viest 1951): with
// a^2 = K (t^2 / EI + 2 / (E t)), EI that of both planks, and the weight q of a metre the tip of a cantilever sinks by
// (q L^4 / 8 - t A (L^4/4 - L^2/a^2 + 2 L tanh(a L)/a^3 - 2 (1 - 1/cosh(a L))/a^4)) / EI, A = K t q / (2 EI a^2), and by
// Timoshenko's q L^2 / (2 5/6 G 2 t). A layer that felt how planks turn together would be too soft by a quarter.
TEST_CASE("a cantilever of two planks bends by the stiffness of the layer between them", "[interface]") {
  for (const double K : {1e5, 1e7}) {
    INFO(K);
    CHECK(tip_of(lower_plank({set("/contact/shear_stiffness", digits(K)), set("/bodies/0/seeding", "lattice"),
                              set("/bodies/1/seeding", "lattice")})) == Approx(exact_tip(K)).epsilon(0.015));
  }
}

// Each half of two bars is drawn outwards by a force that acts on its outer cells alone and grows over many periods. A layer
// carries what it is drawn by: at rest the middles of the ends are apart by sigma (2 L / E + 1 / D) more than at first, where
// the stress is that of the whole length but for what the drawn cells lack.
TEST_CASE("bars on a spring are longer at rest by sigma (2 L / E + 1 / D)", "[interface]") {
  for (const double ratio : {0.05, 0.5, 5.0}) {
    const Bars bars = opening(ratio, 0);
    const double pull = 2, drawn = 0.05;  // N/kg; m of each bar
    const double stress = density * pull * drawn;
    // The stress falls to zero over the drawn cells, which count half.
    const double exact = stress * (2 * (bars.length - drawn / 2 - drawn / 6) / modulus + 1 / bars.stiffness);
    Scene scene(bars.text, {set("/solver/end_time", "1.5"), set("/damping", R"({"viscous": 20})"),
                            R"J(/body_force=["2*min(1, t/0.5)*((X>0.45)-(X<0.05))", 0])J"});
    scene.run();
    double length = 0;
    for (const int body : {0, 1}) {
      const BodyState state = scene.body(body);
      double sum = 0, count = 0;
      for (std::size_t p = 0; p < state.position.size(); p += 2)
        if (body == 0 ? state.initial_position[p] < 0.05 : state.initial_position[p] > 0.45)
          sum += state.position[p] - state.initial_position[p], count += 1;
      length += (body == 0 ? -1 : 1) * sum / count;
    }
    std::printf("Layer of D L / E = %g: bars longer by %.5e of %.5e m\n", ratio, length, exact);
    INFO(ratio);
    CHECK(length == Approx(exact).epsilon(0.015));
  }
}

// After a quarter of a period the bars rest, and all their energy is in the layer.
TEST_CASE("what contact takes from bars on a spring is in the spring", "[interface][ledger]") {
  for (const auto& [name, bars] : {std::pair{"opening", opening(0.01)}, std::pair{"sliding", sliding(0.01)}}) {
    for (const double courant : {0.2, 0.1}) {
      Scene scene(bars.text, {set("/solver/end_time", digits(0.25 * 2 * std::numbers::pi / bars.frequency)),
                              set("/solver/courant", digits(courant))});
      const Totals start = scene.metrics.initial(), end = scene.run();
      const Ledger& ledger = scene.simulation.ledger();
      INFO(name << " " << courant);
      CHECK(end.kinetic < 2e-4 * start.kinetic);
      CHECK(ledger.friction == 0);
      CHECK(-ledger.contact + end.strain == Approx(start.kinetic).epsilon(1e-3));
      CHECK(std::abs(ledger.contact + ledger.interface) < 2e-4 * start.kinetic);
    }
  }
}

// The weight grows over a tenth of a second, so that the slab does not hop.
TEST_CASE("a liquid slows a slab exponentially", "[interface]") {
  const double rate = 2 / 1e-3 / (1000 * 0.2), mass = 1000 * 0.5 * 0.2;
  for (const char* backend : {"reference", "cpu"})
    for (const char* transfer : {"pic", "flip", "apic"})
      for (const double courant : {0.3, 0.1}) {
        if (backend == std::string("reference") && courant < 0.3) continue;
        Scene scene(
            slab, {set("/backend", backend), set("/transfer/type", transfer), set("/solver/courant", digits(courant))});
        while (scene.simulation.time() < 0.1) scene.simulation.step();
        const double before = scene.simulation.time(), start = velocity_along(scene, 1);
        const double early = scene.simulation.ledger().friction;
        scene.run();
        const double slowed = velocity_along(scene, 1) / start,
                     exact = std::exp(-rate * (scene.simulation.time() - before));
        const double heat = (scene.simulation.ledger().friction - early) / (mass / 2 * start * start);
        INFO(backend << " " << transfer << " " << courant);
        CHECK(slowed == Approx(exact).epsilon(0.09 * courant + 0.002));
        CHECK(heat == Approx(1 - exact * exact).epsilon(0.06 * courant));
      }
}

}  // namespace mpm::test::interfaces

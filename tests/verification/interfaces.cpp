// Compliant interfaces and liquids between bodies, against closed forms: two elastic bars joined by a spring swing with
// k L tan(k L) = 2 D L / E, a liquid slows a slab with exp(-eta A t / (b m)).

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "support/catch.hpp"
#include "support/page.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The root in (0, pi/2) of x tan(x) = 2 r: the phase over a bar's length of the mode in which two equal bars swing
/// against one another on a spring of D L / E = r.
double phase_over_length(double r) {
  double low = 0, high = std::numbers::pi / 2;
  for (int k = 0; k < 80; ++k) {
    const double x = (low + high) / 2;
    (x * std::tan(x) < 2 * r ? low : high) = x;
  }
  return low;
}

constexpr double modulus = 1e6, density = 1000;

/// Two bars in the symmetric mode of their length, 0.25 m, and of their thickness, 0.1 m, with Poisson's ratio 0.
struct Bars {
  double length, stiffness, wave_number, frequency;
  std::string text;
};

std::string number(double value) {
  return digits(value);
}

/// Along the bars: they open and close. D L / E = `ratio`.
Bars opening(double ratio, double amplitude = 1e-4) {
  const double L = 0.25, k = phase_over_length(ratio) / L;
  Bars bars{L, ratio * modulus / L, k, k * std::sqrt(modulus / density), {}};
  const std::string v = number(amplitude), phase = number(k);
  bars.text = R"J({
  "title": "two bars on a spring", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.05, "domain": [[-0.2, 0], [0.7, 0.1]], "boundaries": {"all": "free", "y_min": "slip", "y_max": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
  "contact": {"type": "linear_interface", "normal_stiffness": )J" +
              number(bars.stiffness) + R"J(, "shear_stiffness": 0},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 1000}},
  "bodies": [
    {"name": "left", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.25, 0.1]},
     "velocity": [")J" +
              v + "*cos(" + phase + R"J(*x)", 0]},
    {"name": "right", "material": "m", "geometry": {"type": "box", "lower": [0.25, 0], "upper": [0.5, 0.1]},
     "velocity": ["-)J" +
              v + "*cos(" + phase + R"J(*(0.5-x))", 0]}],
  "solver": {"time_step": "auto", "courant": 0.2, "end_time": 1}, "output": {"ledger": true}})J";
  return bars;
}

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

/// The velocity of a body's middle along x, m/s.
double velocity_along(const Scene& scene, int body) {
  const BodyState state = scene.body(body);
  double sum = 0;
  for (std::size_t p = 0; p < state.velocity.size(); p += 2) sum += state.velocity[p];
  return 2 * sum / static_cast<double>(state.velocity.size());
}

/// The share by which the bars swing too slowly, from the phase in which they are after a period and a quarter.
double slowness(const Bars& bars, std::vector<std::string> settings) {
  const double turns = 1.25;
  settings.push_back(set("/solver/end_time", digits(turns * 2 * std::numbers::pi / bars.frequency)));
  Scene scene(bars.text, settings);
  const double start = velocity_along(scene, 0) - velocity_along(scene, 1);
  scene.run();
  const double end = velocity_along(scene, 0) - velocity_along(scene, 1);
  return std::asin(std::clamp(end / start, -1.0, 1.0)) / (turns * 2 * std::numbers::pi);
}

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

TEST_CASE("an opening that is wide beside a cell softens a layer by what the page on contact says",
          "[interface][docs]") {
  const auto printed = Page("docs/contact.md").read("and the layer softens: by # % in ω at # % of a cell");
  const double frequency = opening(0.01).frequency, opened = printed[1].value / 100 * 0.05;
  // Each bar's face swings by its speed over the frequency.
  const double wide = slowness(opening(0.01, opened * frequency / 2), {}), narrow = slowness(opening(0.01), {});
  std::printf("Layer opened by %g m: slower by %.5f\n", opened, wide - narrow);
  CHECK(100 * (wide - narrow) == printed[0].rounded());
}

// Two planks on a layer that lets them slide bend as two beams with partial interaction (Newmark, Siess & Viest 1951): with
// a^2 = K (t^2 / EI + 2 / (E t)), EI that of both planks, and the weight q of a metre the tip of a cantilever sinks by
// (q L^4 / 8 - t A (L^4/4 - L^2/a^2 + 2 L tanh(a L)/a^3 - 2 (1 - 1/cosh(a L))/a^4)) / EI, A = K t q / (2 EI a^2), and by
// Timoshenko's q L^2 / (2 5/6 G 2 t). A layer that felt how planks turn together would be too soft by a quarter.
namespace {

/// What the tip of the planks should sink by, m, with a layer of the shear stiffness K.
double exact_tip(double K) {
  const double L = 1, t = 0.1, E = 1e6, q = 1000 * 0.05 * 2 * t, EI = 2 * E * t * t * t / 12;
  const double squared = K * (t * t / EI + 2 / (E * t)), a = std::sqrt(squared), A = K * t * q / (2 * EI * squared);
  const double coupled = L * L * L * L / 4 - L * L / squared + 2 * L * std::tanh(a * L) / (a * squared) -
                         2 * (1 - 1 / std::cosh(a * L)) / (squared * squared);
  const double joined = K > 0 ? t * A * coupled : 0;
  return (q * L * L * L * L / 8 - joined) / EI + q * L * L / (2 * 5.0 / 6 * E / 2 * 2 * t);
}

BodyState lower_plank(const std::vector<std::string>& overrides) {
  ReadOptions options;
  options.solvers = solver_descriptions();
  options.overrides = overrides;
  const Experiment planks =
      read_experiment(std::filesystem::path(MPM_SOURCE_DIR) / "experiments/studies/two_planks.json",
                      ComponentLookup(plugins()), options);
  Simulation simulation(planks, backend_factory(1));
  while (!simulation.finished()) simulation.step();
  return simulation.backend().body_state(0);
}

/// How far the particles at the lower plank's end have sunk, m.
double tip_of(const BodyState& lower) {
  double tip = 0, farthest = 0;
  for (std::size_t k = 0; k < lower.position.size(); k += 2) farthest = larger(farthest, lower.initial_position[k]);
  int count = 0;
  for (std::size_t k = 0; k < lower.position.size(); k += 2)
    if (lower.initial_position[k] > farthest - 1e-9)
      tip += lower.initial_position[k + 1] - lower.position[k + 1], ++count;
  return tip / count;
}

/// The same of the particle that the scene's probe follows.
double probed(const BodyState& lower) {
  double nearest = 1, sunk = 0;
  for (std::size_t k = 0; k < lower.position.size(); k += 2) {
    const double away = std::hypot(lower.initial_position[k] - 0.99, lower.initial_position[k + 1] - 0.09);
    if (away < nearest) nearest = away, sunk = lower.initial_position[k + 1] - lower.position[k + 1];
  }
  return sunk;
}

}  // namespace

TEST_CASE("a cantilever of two planks bends by the stiffness of the layer between them", "[interface]") {
  for (const double K : {1e5, 1e7}) {
    INFO(K);
    CHECK(tip_of(lower_plank({set("/contact/shear_stiffness", digits(K)), set("/bodies/0/seeding", "lattice"),
                              set("/bodies/1/seeding", "lattice")})) == Approx(exact_tip(K)).epsilon(0.015));
  }
}

TEST_CASE("with averaged gradients for normals free planks bend too little, by what the page on contact says",
          "[interface][docs]") {
  const double tip =
      probed(lower_plank({set("/contact/shear_stiffness", "0"), set("/contact/normal", "average_volume_gradient")}));
  CHECK(100 * (1 - tip / exact_tip(0)) ==
        Page("docs/contact.md").read("planks bend # % too little on the same cells").front().rounded());
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

// Artificial viscosity of any law (docs/method.md, "Artificial viscosity") against closed forms: its pressure, its work and
// its heat in a body that is moved affinely, and the jump conditions of a shock in an elastic solid. `ctest -V` shows a table.

#include <cmath>
#include <cstdio>
#include <limits>

#include "metrics/particle_quantities.hpp"
#include "shipped.hpp"
#include "support/catch.hpp"
#include "support/energies.hpp"
#include "support/solid_shock.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double linear = 0.7, quadratic = 1.9, h = 0.1, density = 800, dt = 0.0125;

// ---- A body that is moved affinely

struct Law {
  const char *name, *text;
};
constexpr Law laws[] = {
    {"neo_hookean", R"("type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3)"},
    {"newtonian_fluid", R"("type": "newtonian_fluid", "bulk_modulus": 2000, "viscosity": 0)"},
    {"von_mises", R"("type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "yield_stress": 20)"}};

/// A velocity gradient as it is written at the nodes.
struct Motion {
  double xx, xy, yx, yy;
  /// The rate at which the logarithm of a volume falls in a step.
  double rate() const { return -std::log((1 + dt * xx) * (1 + dt * yy) - dt * dt * xy * yx) / dt; }
};
/// I + dt L is a turn by an angle times a stretch along both axes.
Motion turned(double angle, double stretch_x, double stretch_y) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {(c * stretch_x - 1) / dt, -s * stretch_y / dt, s * stretch_x / dt, (c * stretch_y - 1) / dt};
}

/// All nodes have the velocity L x, whatever the stresses are.
std::string moved_scene(const char* law, const Motion& L, const std::string& more = "") {
  const auto along = [](double a, double b) { return "\"" + digits(a) + "*x+" + digits(b) + "*y\""; };
  return R"J({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[-1, -1], [1, 1]], "boundaries": {"all": "free"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"}, "materials": {"m": {)J" +
         std::string(law) + R"J(, "density": 800, "artificial_viscosity": {"linear": 0.7, "quadratic": 1.9})J" + more +
         R"J(}}, "bodies": [{"name": "a", "material": "m", "jitter": 0.3,
      "geometry": {"type": "box", "lower": [-0.25, -0.2], "upper": [0.25, 0.2]}}],
    "node_conditions": [{"type": "prescribed", "lower": [-1, -1], "upper": [1, 1], "velocity": [)J" +
         along(L.xx, L.xy) + ", " + along(L.yx, L.yy) + R"J(]}], "solver": {"time_step": )J" + digits(dt) +
         R"J(, "end_time": 1}})J";
}

struct Run {
  const char *backend, *precision;
  double epsilon() const {
    return std::string(precision) == "float" ? std::numeric_limits<float>::epsilon()
                                             : std::numeric_limits<double>::epsilon();
  }
  std::vector<std::string> settings() const { return {set("/backend", backend), set("/precision", precision)}; }
};
constexpr Run runs[] = {{"reference", "double"}, {"cpu", "double"}, {"cpu", "float"}};

/// Follows a motion and holds q and its work against the closed form; the law says its wave speed.
void check_motion(const Law& law, const Motion& L, const Run& run) {
  INFO(law.name << " on " << run.backend << " in " << run.precision << ", rate " << L.rate());
  Scene scene(moved_scene(law.text, L), run.settings());
  const double rate = std::max(L.rate(), 0.0);
  std::vector<double> before(scene.body().position.size() / 2, 0.0);
  double work = 0;
  for (int step = 1; step <= 4; ++step) {
    scene.run_steps(1);
    const BodyState body = scene.body();
    const std::vector<double>& found = body.host_state.at("artificial_pressure");
    const std::vector<double> speed = material_quantities(scene.experiment, 0, body).wave_speed;
    double worst = 0;
    for (std::size_t p = 0; p < found.size(); ++p) {
      const double expected = density * h * rate * (linear * speed[p] + quadratic * h * rate);
      worst = larger(worst, std::abs(found[p] - expected));
      work += body.volume * body.size_of(p) * 0.5 * (before[p] + expected) * L.rate() * dt;
      before[p] = expected;
    }
    const double scale = density * h / dt * (linear * speed[0] + quadratic * h / dt);  // that of a rate of 1 / dt
    CHECK(worst <= 200 * run.epsilon() * scale);
    CHECK(std::abs(scene.simulation.ledger().artificial_viscosity - work) <=
          2000 * run.epsilon() * scale * body.volume * static_cast<double>(found.size()));
  }
  CHECK((work > 0) == (L.rate() > 1e-9));
}

}  // namespace

TEST_CASE("the pressure and the work of artificial viscosity are the closed form's for any law", "[viscosity]") {
  for (const Law& law : laws)
    for (const Run& run : runs) {
      check_motion(law, {-2, 0, 0, 0}, run);
      check_motion(law, {-1.5, 0.8, -0.6, -2.5}, run);
      check_motion(law, {-3, 0, 0, 2}, run);
    }
}

TEST_CASE("artificial viscosity vanishes in expansion, in shear and in a rigid turn", "[viscosity]") {
  for (const Law& law : laws)
    for (const Run& run : runs) {
      check_motion(law, {2, 0, 0, 0.5}, run);
      check_motion(law, {3, 0, 0, -2}, run);
      check_motion(law, {0, 4, 0, 0}, run);
      check_motion(law, turned(0.2, 1, 1), run);
    }
  Scene expands(moved_scene(laws[0].text, {2, 0, 0, 0.5}), runs[0].settings());
  expands.run_steps(3);
  const BodyState expanded = expands.body();
  for (const double q : expanded.host_state.at("artificial_pressure")) CHECK(q == 0);
}

TEST_CASE("artificial viscosity does not see a turn", "[viscosity]") {
  const auto pressure = [](double angle) {
    Scene scene(moved_scene(laws[0].text, turned(angle, 0.97, 0.99)), runs[0].settings());
    scene.run_steps(1);
    return scene.body().host_state.at("artificial_pressure")[0];
  };
  CHECK(pressure(0) > 1);
  CHECK(pressure(0.3) == Approx(pressure(0)).epsilon(1e-12));
}

// The law stores what its own stress does and dissipates nothing, so that all heat is that of q.
TEST_CASE("the work of artificial viscosity warms", "[viscosity]") {
  const Motion L{-2, 0, 0, -1};
  for (const Run& run : runs) {
    Scene scene(moved_scene(laws[0].text, L,
                            R"J(, "thermal": {"conductivity": 1e-9, "heat_capacity": 3, "dissipation_to_heat": 0.6})J"),
                [&] {
                  std::vector<std::string> all = run.settings();
                  all.emplace_back("/bodies/0/temperature=20");
                  return all;
                }());
    std::vector<double> work(scene.body().position.size() / 2, 0.0), before = work;
    for (int step = 0; step < 3; ++step) {
      scene.run_steps(1);
      const std::vector<double> now = scene.body().host_state.at("artificial_pressure");
      for (std::size_t p = 0; p < now.size(); ++p) work[p] += 0.5 * (before[p] + now[p]) * L.rate() * dt;
      before = now;
    }
    const BodyState body = scene.body();
    for (std::size_t p = 0; p < work.size(); ++p) {
      const double risen = 0.6 * work[p] / (density * 3);
      CHECK(risen > 1e-4);
      CHECK(body.host_state.at("temperature")[p] - 20 == Approx(risen).epsilon(1e-5).margin(100 * run.epsilon() * 20));
    }
    const double heat = 0.6 * scene.simulation.ledger().artificial_viscosity;
    CHECK(scene.simulation.backend().heat_ledger().dissipation == Approx(heat).epsilon(1e3 * run.epsilon()));
  }
}

TEST_CASE("the stress that is recorded is the law's less the pressure of artificial viscosity", "[viscosity]") {
  const Motion L{-2, 0, 0, -1};
  const auto pressure = [&](const std::vector<std::string>& overrides) {
    Scene scene(moved_scene(laws[1].text, L), overrides);
    scene.run_steps(1);
    return quantity(scene.experiment, 0, scene.body(), "pressure")[0];
  };
  const double none =
      pressure({"/materials/m/artificial_viscosity/linear=0", "/materials/m/artificial_viscosity/quadratic=0"});
  const double J = std::exp(-L.rate() * dt), c = std::sqrt(2000 / density);
  const double q = density / J * h * L.rate() * (linear * c + quadratic * h * L.rate());
  CHECK(pressure({}) - none == Approx(q).epsilon(0.02));  // c is that of the compressed fluid
}

// ---- A shock in an elastic solid (experiments/papers/solid_shock.json)

namespace {

const SolidShock jump(1e8, 0.3, 1000, 80);

/// What a shock leaves, each relative to the jump conditions.
struct Shock {
  double overshoot = 0, pressure = 0, speed = 0;
  double lost = 0, artificial = 0;  ///< over the last quarter of the run, when the shock has its shape
  double residual = 0, book = 0;    ///< of the ledger and of its materials, over the energy that there was
};

Shock shock(const std::vector<std::string>& overrides, const char* name) {
  ShippedScene scene("papers/solid_shock.json", overrides);
  const double first = scene.metrics.measure().total_energy();
  double late = 0, late_energy = 0, late_work = 0;
  const Totals end = scene.run([&] {
    if (late > 0 || scene.simulation.time() < 1.125e-3) return;
    late = scene.simulation.time(), late_energy = scene.metrics.measure().total_energy();
    late_work = scene.simulation.ledger().artificial_viscosity;
  });
  CHECK(scene.failure.empty());
  const BodyState body = scene.simulation.backend().body_state(0);
  const std::vector<double> p = quantity(scene.experiment, 0, body, "pressure");
  double momentum = 0, mass = 0, sum = 0, count = 0, largest = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    mass += body.size_of(k), momentum += body.size_of(k) * body.velocity[2 * k];
    largest = larger(largest, p[k]);
    if (const double x = body.position[2 * k]; x > 0.05 && x < 0.3) sum += p[k], ++count;
  }
  const double height = scene.experiment.grid.upper[1];
  const double passed = 1 + momentum / mass / 80, to_lose = jump.speed * (end.time - late) * jump.dissipated * height;
  const Ledger& ledger = scene.simulation.ledger();
  const Shock found{largest / jump.pressure - 1,
                    sum / count / jump.pressure - 1,
                    passed / (jump.speed * end.time) - 1,
                    (late_energy - end.total_energy()) / to_lose,
                    (ledger.artificial_viscosity - late_work) / to_lose,
                    std::abs(end.total_energy() - first - ledger.explained()) / first,
                    std::abs(ledger.material_book) / first};
  std::printf(
      "  %-22s overshoot %6.2f %%, pressure %+.2f %%, speed %+.2f %%; of the exact loss %.3f, %.3f by q; residual "
      "%.1e, book %.1e\n",
      name, 100 * found.overshoot, 100 * found.pressure, 100 * found.speed, found.lost, found.artificial,
      found.residual, found.book);
  return found;
}

std::vector<std::string> cells(const std::string& size) {
  return {"/grid/cell_size=" + size, "/grid/domain=[[0, 0], [1.04, " + size + "]]",
          R"(/bodies/0/geometry={"type": "box", "lower": [0, 0], "upper": [1, )" + size + "]}", "/output/probes=[]"};
}
std::vector<std::string> with(std::vector<std::string> settings, const std::string& one) {
  settings.push_back(one);
  return settings;
}

}  // namespace

TEST_CASE("a shock in a solid rings no more, and loses what the jump conditions say as cells get finer",
          "[viscosity]") {
  CHECK(jump.stretch == Approx(0.80377416).epsilon(1e-8));
  CHECK(jump.speed == Approx(407.69351).epsilon(1e-8));
  CHECK(jump.pressure == Approx(21324291).epsilon(1e-7));
  const Shock none =
                  shock(with(cells("0.01"), R"(/materials/solid/artificial_viscosity={"linear": 0, "quadratic": 0})"),
                        "none, 100 cells"),
              coarse = shock(cells("0.01"), "100 cells"), fine = shock(cells("0.005"), "200 cells");
  CHECK(none.overshoot > 0.5);
  CHECK(none.artificial == 0);
  for (const Shock& found : {coarse, fine}) {
    CHECK(found.overshoot < 0.07);
    CHECK(std::abs(found.pressure) < 0.005);
    CHECK(std::abs(found.speed) < 0.005);
    CHECK(found.artificial == Approx(found.lost).epsilon(0.02));
    CHECK(found.residual < 0.02 * none.residual);
  }
  CHECK(std::abs(fine.lost - 1) < 0.15);
  CHECK(std::abs(fine.lost - 1) < 0.5 * std::abs(coarse.lost - 1));
}

TEST_CASE("a shock in a solid loses what the jump conditions say on 400 cells", "[viscosity][slow]") {
  const Shock found = shock(cells("0.0025"), "400 cells");
  CHECK(found.lost == Approx(1).margin(0.03));
  CHECK(found.artificial == Approx(1).margin(0.03));
}

TEST_CASE("with artificial viscosity the ledger's residual falls with the step, and its book with the square",
          "[viscosity]") {
  const auto of_step = [](const std::string& step) {
    return shock(with(cells("0.02"), "/solver/time_step=" + step), (step + " s").c_str());
  };
  const Shock longest = of_step("2e-6"), middle = of_step("1e-6"), shortest = of_step("5e-7");
  CHECK(middle.book == Approx(longest.book / 4).epsilon(0.05));
  CHECK(shortest.book == Approx(middle.book / 4).epsilon(0.05));
  CHECK(shortest.residual < 0.65 * middle.residual);
}

// ---- The step

// With h k = 2 sqrt(3), the largest wave number of tents, w = k c and the damping rate k^2 nu of a particle's waves.
TEST_CASE("the limit of the step knows artificial viscosity at rest and in compression", "[viscosity]") {
  for (const Run& run : runs) {
    INFO(run.backend << " in " << run.precision);
    const auto expected = [](double c, double q) {
      const double nu = std::sqrt(std::pow(linear * h * c, 2) + 4 * quadratic * h * h * q / density);
      const double damping = std::sqrt(3.0) * nu / h;
      return damping + std::sqrt(c * c + damping * damping);
    };
    Scene automatic(moved_scene(laws[0].text, {-2, 0, 0, -1}),
                    with(run.settings(), set("/solver/time_step", "\"auto\"")));
    automatic.run_steps(1);
    const double at_rest = std::sqrt(1000 * 0.7 / (1.3 * 0.4) / density);  // c of longitudinal waves
    CHECK(automatic.simulation.backend().time_step_limit().wave_speed ==
          Approx(expected(at_rest, 0)).epsilon(10 * run.epsilon()));
    automatic.run_steps(7);
    const BodyState body = automatic.body();
    const double q = body.host_state.at("artificial_pressure")[0],
                 c = material_quantities(automatic.experiment, 0, body).wave_speed[0];
    automatic.run_steps(1);  // it begins with the next estimate
    const double found = automatic.simulation.backend().time_step_limit().wave_speed;
    CHECK(found == Approx(expected(c, q)).epsilon(1e3 * run.epsilon()));
    CHECK(found > 1.05 * expected(c, 0));
  }
}

TEST_CASE("the automatic step stands strong artificial viscosity", "[viscosity]") {
  const auto gain = [](const std::string& transfer, const std::string& update, const std::string& viscosity) {
    ShippedScene scene("lessons/two_discs_one_field.json",
                       {R"(/transfer={"type": ")" + transfer + "\"}", "/grid/cell_size=0.05", "/solver/end_time=2.3",
                        set("/solver/stress_update", update), set("/solver/time_step", "\"auto\""),
                        "/materials/rubber/artificial_viscosity=" + viscosity});
    std::vector<double> kinetic{scene.metrics.initial().kinetic}, strain{scene.metrics.initial().strain};
    scene.run([&] {
      const Totals now = scene.metrics.measure();
      kinetic.push_back(now.kinetic), strain.push_back(now.strain);
    });
    if (!scene.failure.empty()) return std::numeric_limits<double>::infinity();
    double largest = 0;
    for (const double total : energies_at_one_time(kinetic, strain, update)) largest = larger(largest, total);
    return largest / (kinetic[0] + strain[0]) - 1;
  };
  // With the step of waves alone the first of these gains several times the energy that there is.
  const auto check = [&](const std::string& transfer, const std::string& update) {
    for (const std::string viscosity : {R"({"linear": 8, "quadratic": 0})", R"({"linear": 0, "quadratic": 10})"}) {
      INFO(transfer << " " << update << " " << viscosity);
      CHECK(gain(transfer, update, viscosity) <= 0.01);
    }
  };
  for (const std::string update : {"last", "first", "modified_last", "averaged"}) check("flip", update);
  check("apic", "last");
}

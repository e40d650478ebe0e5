// Emitters, sinks and changes of material against closed forms: the mass rho A v t, the flight of what is emitted, the
// force rho A v^2 of a jet on a plate, and balances of mass, momentum and energy.

#include <cmath>
#include <numbers>

#include "metrics/particle_quantities.hpp"
#include "simulation/particle_changes.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double pi = std::numbers::pi;

/// Soft fluid from a box 0.2 m long and 0.3 m wide, at 2 m/s along x (or along the axis), into the open.
std::string stream(const std::string& kind) {
  const bool solid = kind == "3-D", rings = kind == "axisymmetric";
  const std::string box = rings   ? R"("lower": [0, 0.1], "upper": [0.3, 0.3]}, "velocity": [0, 2])"
                          : solid ? R"("lower": [0.1, 0.3, 0.3], "upper": [0.3, 0.6, 0.5]}, "velocity": [2, 0, 0])"
                                  : R"("lower": [0.1, 0.3], "upper": [0.3, 0.6]}, "velocity": [2, 0])";
  return R"J({"title": "stream", "dimension": )J" + std::string(solid ? "3" : "2") + R"J(,
    "grid": {"cell_size": 0.1, "domain": )J" +
         (rings   ? "[[0, 0], [0.6, 3]], \"symmetry\": \"axisymmetric\""
          : solid ? "[[0, 0, 0], [3, 0.9, 0.8]]"
                  : "[[0, 0], [3, 0.9]]") +
         R"J(, "boundaries": )J" + (rings ? R"({"all": "free", "x_min": "slip"})" : R"({"all": "free"})") + R"J(},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "newtonian_fluid", "density": 800, "bulk_modulus": 5000, "viscosity": 0}},
    "bodies": [{"name": "water", "material": "m"}],
    "emitters": [{"body": "water", "geometry": {"type": "box", )J" +
         box + R"J(}],
    "solver": {"time_step": 0.003, "end_time": 1}})J";
}

double area(const std::string& kind) {
  return kind == "3-D" ? 0.3 * 0.2 : kind == "axisymmetric" ? pi * 0.3 * 0.3 : 0.3;
}

/// The mean over all mass of a component of the place, m.
double mean_place(const Totals& totals, int axis) {
  return totals.centre_of_mass[static_cast<std::size_t>(axis)];
}

}  // namespace

TEST_CASE("the mass that is emitted is density times area times speed times time", "[particle_changes]") {
  for (const std::string kind : {"plane", "axisymmetric", "3-D"})
    for (const std::string seeding : {"lattice", "fitted"})
      for (const char* backend : {"reference", "cpu"}) {
        if (kind == "3-D" && std::string(backend) == "reference") continue;  // the same particles, slowly
        INFO(kind << " " << seeding << " " << backend);
        Scene scene(stream(kind), {"/bodies/0/seeding=" + seeding, set("/backend", backend)});
        const double batch = 800 * area(kind) * 0.2, rate = 800 * area(kind) * 2;
        CHECK(scene.metrics.initial().mass == Approx(batch).epsilon(1e-12));
        while (!scene.simulation.finished()) {
          scene.simulation.step();
          if (scene.simulation.steps() % 50 != 0) continue;
          const double t = scene.simulation.time(), mass = scene.metrics.measure().mass;
          CHECK(mass == Approx(batch * (1 + std::floor(t / 0.1 + 1e-9))).epsilon(1e-12));
          CHECK(mass >= rate * t * (1 - 1e-12));
          CHECK(mass <= (rate * t + batch) * (1 + 1e-12));
        }
        CHECK(scene.simulation.particle_changes()->emitted().mass ==
              Approx(scene.metrics.measure().mass - batch).epsilon(1e-12));
      }
}

// A batch stands where it would be had it begun at its due time, so that neither the flow nor its place knows the step.
TEST_CASE("a stream in free flight is where its batches have flown, whatever the step", "[particle_changes]") {
  for (const std::string kind : {"plane", "axisymmetric"})
    for (const double step : {0.0007, 0.003, 0.011, 0.047}) {
      INFO(kind << " " << step);
      const int axis = kind == "plane" ? 0 : 1;
      Scene scene(stream(kind), {set("/solver/time_step", digits(step)), set("/solver/end_time", "0.95"),
                                 "/materials/m/bulk_modulus=50"});
      const Totals end = scene.run();
      double sum = 0;
      for (int k = 0; k < 10; ++k) sum += 0.2 + 2 * (end.time - 0.1 * k);  // the middle of each batch, m
      CHECK(mean_place(end, axis) == Approx(sum / 10).epsilon(1e-11));
      CHECK(end.momentum[static_cast<std::size_t>(axis)] == Approx(2 * end.mass).epsilon(1e-11));
      CHECK(end.largest_speed == Approx(2).epsilon(1e-9));
      CHECK(std::abs(scene.metrics.ledger_residual(end)) < 1e-11 * end.kinetic);
    }
}

// Every particle falls from rest along y since it was emitted: the momentum is the sum of m g t over the batches.
TEST_CASE("a jet in free fall has the momentum of its batches' times, and follows the parabola", "[particle_changes]") {
  const double g = 5;
  Scene scene(stream("plane"), {"/gravity=[0, -5]", "/grid/domain=[[0, -2.5], [2.4, 0.9]]", "/solver/time_step=0.001",
                                "/emitters/0/geometry/lower=[0.1, 0.5]", "/emitters/0/geometry/upper=[0.2, 0.6]",
                                "/grid/cell_size=0.05"});
  const Totals end = scene.run();
  const double batch = 800 * 0.1 * 0.1;
  double momentum = 0;
  for (int k = 0; k < 21; ++k) momentum -= batch * g * std::max(0.0, end.time - 0.05 * k);
  CHECK(end.momentum[0] == Approx(2 * end.mass).epsilon(1e-10));
  CHECK(end.momentum[1] == Approx(momentum).epsilon(1e-9));
  // A step falls by v+ dt and gains (v- + v+) dt g / 2 of work: m g^2 dt t / 2 over a time t, 1.05 J over all batches.
  CHECK(std::abs(scene.metrics.ledger_residual(end)) < 2e-3 * end.kinetic);
  // The way down at the distance d from the middle of the region is g (d/v)^2 / 2. Batches fall from where they begin,
  // half of a batch earlier or later than their middle: the bound is a share of a cell.
  const BodyState body = scene.body();
  for (const double d : {0.5, 1.0, 1.4}) {
    double height = 0, count = 0;
    for (std::size_t p = 0; p < body.position.size() / 2; ++p) {
      if (std::abs(body.position[2 * p] - 0.15 - d) > 0.05) continue;
      height += body.position[2 * p + 1], ++count;
    }
    REQUIRE(count > 10);
    INFO(d);
    CHECK(height / count == Approx(0.55 - g * d * d / 8).margin(0.02));
  }
}

TEST_CASE("a jet presses on a plate with density times area times the square of its speed",
          "[particle_changes][slow]") {
  for (const char* kind : {"plane", "axisymmetric"}) {
    const bool rings = std::string(kind) == "axisymmetric";
    INFO(kind);
    const std::string walls =
        rings ? R"({"all": "free", "x_min": "slip", "y_min": "slip"})" : R"({"all": "free", "y_min": "slip"})";
    const std::string text = R"J({"title": "jet", "dimension": 2,
      "grid": {"cell_size": 0.025, "domain": [[)J" +
                             std::string(rings ? "0" : "-0.8") + R"J(, 0], [0.8, 0.5]], "boundaries": )J" + walls +
                             (rings ? R"(, "symmetry": "axisymmetric")" : "") + R"J(},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
      "materials": {"m": {"type": "newtonian_fluid", "density": 1000, "bulk_modulus": 4e5, "viscosity": 0.001,
                          "equation_of_state": "power", "tension": "none"}},
      "bodies": [{"name": "water", "material": "m"}],
      "emitters": [{"body": "water", "velocity": [0, -1], "geometry": {"type": "box", "lower": [)J" +
                             (rings ? "0" : "-0.1") + R"J(, 0.4], "upper": [0.1, 0.425]}}],
      "sinks": [{"geometry": {"type": "box", "lower": [0.7, 0], "upper": [0.8, 0.5]}},
                {"geometry": {"type": "box", "lower": [-0.8, 0], "upper": [-0.7, 0.5]}}],
      "solver": {"courant": 0.4, "end_time": 1.6}, "output": {"reactions": ["y_min"], "ledger": false}})J";
    Scene scene(text, {"/bodies/0/seeding=fitted"});
    double impulse = 0;
    Vector3 at_begin{};
    while (!scene.simulation.finished()) {
      scene.simulation.step();
      const Reaction& reaction = scene.simulation.backend().reactions()[2];
      if (scene.simulation.time() < 0.8) at_begin = reaction.impulse;
      impulse = reaction.impulse[1] - at_begin[1];
    }
    const double area = rings ? pi * 0.01 : 0.2;
    CHECK(impulse / 0.8 == Approx(1000 * area * 1).epsilon(0.02));
    CHECK(scene.simulation.particle_changes()->removed().mass > 0);
  }
}

// A column that moves down its channel as one: what comes in above goes out below.
TEST_CASE("a column between an emitter and a sink stays as high as it is", "[particle_changes]") {
  const char* text = R"J({"title": "column", "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [0.4, 1.2]],
             "boundaries": {"all": "slip", "y_min": "free", "y_max": "free"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "newtonian_fluid", "density": 1000, "bulk_modulus": 1e4, "viscosity": 0}},
    "bodies": [{"name": "water", "material": "m", "velocity": [0, -0.5],
                "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.4, 0.9]}}],
    "emitters": [{"body": "water", "velocity": [0, -0.5],
                  "geometry": {"type": "box", "lower": [0, 0.9], "upper": [0.4, 1]}}],
    "sinks": [{"every_steps": 5, "geometry": {"type": "half_space", "point": [0, 0.2], "normal": [0, 1]}}],
    "solver": {"time_step": 0.002, "end_time": 3}})J";
  for (const char* precision : {"double", "float"}) {
    INFO(precision);
    Scene scene(text, {set("/precision", precision)});
    const double whole = 1000 * 0.4 * 0.8, row = 1000 * 0.4 * 0.05, batch = 2 * row;
    const double rounding = std::string(precision) == "double" ? 1e-9 : 1e-3;
    while (!scene.simulation.finished()) {
      scene.simulation.step();
      if (scene.simulation.steps() % 25 != 0) continue;
      const Totals now = scene.metrics.measure();
      CHECK(now.mass <= whole + batch * 1.01);
      CHECK(now.mass >= whole - batch * 1.01);
      CHECK(now.momentum[1] == Approx(-0.5 * now.mass).epsilon(rounding));
    }
    const Totals end = scene.metrics.measure();
    const ParticleChanges& changes = *scene.simulation.particle_changes();
    CHECK(changes.emitted().mass == Approx(1000 * 0.4 * 0.5 * 3).epsilon(1e-6));
    CHECK(end.mass == Approx(whole + changes.emitted().mass - changes.removed().mass).epsilon(1e-6));
    CHECK(std::abs(scene.metrics.ledger_residual(end)) < rounding * end.kinetic);
  }
}

namespace {

/// A strained block that spins and sinks, and a body for its particles to go over to.
std::string block(int dimension, const std::string& from, const std::string& to, const std::string& more = "") {
  const bool flat = dimension == 2;
  return R"J({"title": "block", "dimension": )J" + std::to_string(dimension) + R"J(,
    "grid": {"cell_size": 0.1, "domain": )J" +
         (flat ? "[[0, 0], [1, 1]]" : "[[0, 0, 0], [1, 1, 1]]") + R"J(, "boundaries": {"all": "slip"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "gravity": )J" +
         (flat ? "[0, -3]" : "[0, -3, 0]") + R"J(,
    "materials": {"solid": )J" +
         from + R"J(, "other": )J" + to + R"J(},
    "bodies": [{"name": "block", "material": "solid", "velocity": )J" +
         (flat ? R"V(["2*(y-0.5)", "-3*(x-0.5)"])V" : R"V(["2*(y-0.5)", "-3*(x-0.5)", 0.1])V") + R"J(,
                "geometry": {"type": "box", "lower": )J" +
         (flat ? "[0.3, 0.3], \"upper\": [0.7, 0.7]" : "[0.3, 0.3, 0.3], \"upper\": [0.7, 0.7, 0.5]") + R"J(}},
               {"name": "pool", "material": "other"}],
    "solver": {"time_step": 0.002, "end_time": 0.1})J" +
         more + "}";
}
const char* const rubber = R"({"type": "neo_hookean", "youngs_modulus": 1e4, "poisson_ratio": 0.3, "density": 1000})";
const char* const water = R"({"type": "newtonian_fluid", "density": 1000, "bulk_modulus": 1e4, "viscosity": 1})";

}  // namespace

TEST_CASE("particles that change their material keep mass, momentum, place and volume", "[particle_changes]") {
  for (const int dimension : {2, 3})
    for (const char* backend : {"reference", "cpu"}) {
      INFO(dimension << "-D " << backend);
      const std::vector<std::string> overrides{
          set("/backend", backend), "/bodies/0/seeding=fitted",
          "/bodies/0/geometry/upper/0=0.73",  // of 9 rows, not 8.6
          R"(/bodies/0/becomes={"body": "pool", "when": {"quantity": "position_x", "above": 0.5}, "every_steps": 20})"};
      Scene changes(block(dimension, rubber, water), overrides), stays(block(dimension, rubber, water), [&] {
        std::vector<std::string> never = overrides;
        never.push_back("/bodies/0/becomes/when/above=9");
        return never;
      }());
      const Totals after = changes.run_steps(20), before = stays.run_steps(20);
      CHECK(changes.simulation.particle_count(1) > 0);
      CHECK(changes.simulation.particle_count(0) > 0);
      CHECK(after.mass == Approx(before.mass).epsilon(1e-14));
      CHECK(after.kinetic == Approx(before.kinetic).epsilon(1e-12));
      CHECK(after.gravitational == Approx(before.gravitational).epsilon(1e-12));
      for (int c = 0; c < dimension; ++c) {
        CHECK(after.momentum[c] == Approx(before.momentum[c]).margin(1e-12 * before.momentum_scale));
        CHECK(after.angular_momentum[c] ==
              Approx(before.angular_momentum[c]).margin(1e-12 * before.angular_momentum_scale));
      }
      CHECK(after.smallest_volume_ratio == Approx(before.smallest_volume_ratio).epsilon(1e-12));
      CHECK(after.largest_volume_ratio == Approx(before.largest_volume_ratio).epsilon(1e-12));
      CHECK(after.strain < before.strain);  // the energy of the shear is not that of the fluid
      CHECK(changes.simulation.ledger().changed_material == Approx(after.strain - before.strain).epsilon(1e-9));
      CHECK(std::abs(changes.metrics.ledger_residual(after) - stays.metrics.ledger_residual(before)) <
            1e-12 * before.kinetic);
      // A fluid at rest has the pressure of its volume ratio alone: K (1/J - 1) where linear in the density.
      const BodyState pool = changes.body(1);
      const MaterialQuantities fluid = material_quantities(changes.experiment, 1, pool);
      const std::size_t n = fluid.volume_ratio.size(), components = dimension == 2 ? 4 : 6;
      for (std::size_t p = 0; p < n; ++p)
        for (std::size_t c = 3; c < components; ++c) CHECK(std::abs(fluid.stress[p * components + c]) < 1e-9);
    }
}

TEST_CASE("a body that is warm enough goes over with its temperature, and heat and energy balance",
          "[particle_changes]") {
  const std::string heats = R"(, "thermal": {"conductivity": 50, "heat_capacity": )";
  const std::string ice = std::string(rubber).substr(0, std::string(rubber).size() - 1) + heats + "20}}";
  const std::string melt = std::string(water).substr(0, std::string(water).size() - 1) + heats + "35}}";
  for (const char* backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(
        block(2, ice, melt),
        {set("/backend", backend), "/bodies/0/temperature=\"20+30*x\"", "/bodies/1/temperature=0",
         R"(/bodies/0/becomes={"body": "pool", "when": {"quantity": "temperature", "above": 35}, "every_steps": 5})"});
    const Totals start = scene.metrics.initial(), end = scene.run();
    const std::size_t melted = scene.simulation.particle_count(1);
    CHECK(melted > 0);
    CHECK(scene.simulation.particle_count(0) > 0);
    CHECK(end.mass == Approx(start.mass).epsilon(1e-13));
    const BodyState solid = scene.body(0), pool = scene.body(1);
    for (const double T : solid.host_state.at("temperature")) CHECK(T < 35.5);
    for (const double T : pool.host_state.at("temperature")) CHECK(T > 34);
    CHECK(std::abs(scene.metrics.heat_residual(end)) < 1e-11 * end.heat_content);
    // Each went over at T and has 35 - 20 J/(kg K) more from then on; it keeps T but for conduction.
    const double mass = end.mass * static_cast<double>(melted) / static_cast<double>(scene.simulation.particle_count());
    CHECK(scene.simulation.heat_ledger().changed_material > 15 * 35 * mass * 0.99);
    CHECK(scene.simulation.heat_ledger().changed_material < 15 * 42 * mass);
    CHECK(std::abs(scene.metrics.ledger_residual(end)) < 0.01 * end.kinetic);
  }
}

TEST_CASE("a particle that a sink takes does not go over as well", "[particle_changes]") {
  Scene scene(
      block(2, rubber, water),
      {R"(/bodies/0/becomes={"body": "pool", "when": {"quantity": "position_x", "above": 0.4}, "every_steps": 5})",
       R"(/sinks=[{"every_steps": 5, "geometry": {"type": "half_space", "point": [0.5, 0], "normal": [-1, 0]}}])"});
  const Totals start = scene.metrics.initial(), end = scene.run_steps(5);
  const ParticleChanges& changes = *scene.simulation.particle_changes();
  CHECK(changes.removed().particles == 32);  // of 64, those with x above 0.5 m
  CHECK(changes.changed().particles == 16);  // those from 0.4 m to 0.5 m
  CHECK(scene.simulation.particle_count(0) == 16);
  CHECK(scene.simulation.particle_count(1) == 16);
  CHECK(end.mass + changes.removed().mass == Approx(start.mass).epsilon(1e-13));
}

// The step is estimated every eighth time, and anew where particles have come that may be faster: courant h / (c + v). From
// the estimate before on, a batch may not be on its way for more than that share of a cell: courant h / v.
TEST_CASE("the automatic step is that of fast particles from the step in which they come", "[particle_changes]") {
  for (const char* backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(stream("plane"),
                {set("/backend", backend), "/solver/time_step=auto", "/solver/courant=0.3", "/solver/end_time=0.2",
                 R"(/bodies/0/geometry={"type": "box", "lower": [2.2, 0.1], "upper": [2.4, 0.3]})",
                 "/emitters/0/from=0.05", "/emitters/0/velocity=[20, 0]", "/emitters/0/until=0.055"});
    const double wave = std::sqrt(5000.0 / 800), careful = 0.3 * 0.1 / 20, fast = 0.3 * 0.1 / (wave + 20);
    std::size_t before = scene.simulation.particle_count();
    int looked = 0;
    while (!scene.simulation.finished() && looked < 2) {
      scene.simulation.step();
      if (scene.simulation.time() < 0.05) CHECK(scene.simulation.last_time_step() == Approx(careful).epsilon(1e-9));
      if (scene.simulation.particle_count() == before) continue;
      scene.simulation.step();
      CHECK(scene.simulation.last_time_step() == Approx(fast).epsilon(1e-6));
      looked = 2;
    }
    CHECK(looked == 2);
  }
}

TEST_CASE("a run stops by name where an emitter gives too much, and where nothing is left", "[particle_changes]") {
  Scene full(stream("plane"), {"/emitters/0/max_particles=60",
                               R"(/sinks=[{"geometry": {"type": "ball", "centre": [2.9, 0.1], "radius": 0.01}}])"});
  try {
    full.run();
    FAIL("the emitter was not stopped");
  } catch (const RunFailure& stopped) {
    CHECK(stopped.failure.cause == Cause::too_many_particles);
    CHECK(full.simulation.particle_count() == 48);  // two batches of 24
  }
  Scene empty(stream("plane"),
              {"/emitters/0/until=0.05",
               R"(/sinks=[{"geometry": {"type": "half_space", "point": [1, 0], "normal": [-1, 0]}}])"});
  try {
    empty.run();
    FAIL("the scene goes on without particles");
  } catch (const RunFailure& stopped) {
    CHECK(stopped.failure.cause == Cause::no_particle_left);
  }
}

TEST_CASE("an emitter whose flow does not leave warns, and one whose flow does is quiet", "[particle_changes]") {
  Scene free(stream("plane"));
  free.run();
  CHECK(free.simulation.particle_changes()->warnings().empty());
  Scene blocked(stream("plane"), {R"(/grid/boundaries={"all": "slip"})", "/grid/domain=[[0, 0.3], [0.5, 0.6]]"});
  try {
    blocked.run();
  } catch (const RunFailure&) {  // such a scene may burst
  }
  const auto warnings = blocked.simulation.particle_changes()->warnings();
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("emitter \"emitter_0\" filled a region in which particles were left") != std::string::npos);
}

TEST_CASE("laws that hold particles by what became of them since the start are refused", "[particle_changes]") {
  for (const std::string law :
       {R"({"type": "linear_interface", "normal_stiffness": 1e6, "shear_stiffness": 1e6})",
        R"({"type": "breakable_glue", "tension_stiffness": 1e6, "compression_stiffness": 1e6, "shear_stiffness": 1e6,
            "normal_strength": 1e3, "shear_strength": 1e3})"}) {
    const Experiment experiment = experiment_from(
        block(2, rubber, water),
        {R"(/bodies/0/becomes={"body": "pool", "when": {"quantity": "speed", "above": 9}})", "/contact=" + law});
    CHECK_THROWS_WITH(make_plan(experiment),
                      Catch::Contains("holds particles by what became of them since the start, and /bodies/0/becomes"));
  }
}

TEST_CASE("around an axis nothing is emitted along the radius", "[particle_changes]") {
  CHECK_THROWS_WITH(experiment_from(stream("axisymmetric"), {"/emitters/0/velocity=[1, 2]"}),
                    Catch::Contains("would lie on rings of other lengths"));
}

TEST_CASE("grips of bodies whose particles do not stay are refused", "[particle_changes]") {
  const std::string grips = R"(/grips=[{"body": "block", "velocity": [0, 0],
                                 "where": {"type": "ball", "centre": [0.5, 0.5], "radius": 0.1}}])";
  CHECK_THROWS_WITH(
      experiment_from(block(2, rubber, water),
                      {R"(/bodies/0/becomes={"body": "pool", "when": {"quantity": "speed", "above": 9}})", grips}),
      Catch::Contains("a grip holds particles of the start"));
}

TEST_CASE("a change that fails counts nothing and leaves all particles", "[particle_changes]") {
  Scene scene(
      stream("plane"),
      {"/emitters/0/until=0.05",
       R"(/sinks=[{"every_steps": 3, "geometry": {"type": "half_space", "point": [-9, 0], "normal": [-1, 0]}}])"});
  const Totals start = scene.run_steps(2);
  CHECK_THROWS_AS(scene.simulation.step(), RunFailure);
  CHECK(scene.simulation.particle_changes()->removed().particles == 0);
  CHECK(scene.simulation.particle_changes()->removed().mass == 0);
  CHECK(scene.simulation.backend().body_state(0).position.size() / 2 == scene.simulation.particle_count());
  CHECK(scene.metrics.measure().mass == Approx(start.mass).epsilon(1e-14));
}

TEST_CASE("an emitter that fills what is full at the start is warned of, and one that moves too far in a step refused",
          "[particle_changes]") {
  CHECK(Scene(stream("plane"), {}).simulation.particle_changes()->warnings().empty());
  const Scene full(stream("plane"),
                   {R"(/bodies/0/geometry={"type": "box", "lower": [0.1, 0.3], "upper": [0.3, 0.6]})"});
  const std::vector<std::string> warnings = full.simulation.particle_changes()->warnings();
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("from t = 0 s on, up to 100 %") != std::string::npos);
  // 2 m/s in cells of 0.1 m
  CHECK_THROWS_WITH(Scene(stream("plane"), {"/solver/time_step=0.13"}), Catch::Contains("moves by 2.6 cells"));
}

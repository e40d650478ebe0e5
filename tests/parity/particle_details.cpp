// Details of the cpu backend's particle passes that only few scenes come to.

#include "parity/drift.hpp"
#include "parity/heat_scenes.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A block that flies without stress, of this velocity in m/s; a cell is 0.1 m, a step 0.01 s.
std::string detail_flight(const std::string& velocity, const std::string& more, const std::string& body = "") {
  return R"J({"title": "flight", "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [8, 8]], "boundaries": {"all": "free"}},
    "shape": {"type": "gimp"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": [3.5, 3.5], "upper": [4.5, 4.5]})J" +
         body + R"J(, "velocity": )J" + velocity + "}]" + more +
         R"J(, "solver": {"time_step": 0.01, "end_time": 20}})J";
}

std::vector<double> flown(const std::string& text, const std::string& passes, long steps, long observed) {
  CpuRun run(text, {set("/solver/passes", passes)}, 1);
  run.simulation.observe_when([=](double, long step) { return step % observed == 0 || step == steps; });
  run.steps(steps);
  return all_results(run.simulation);
}

/// A box of one block's height whose particles' domains are drawn out along y.
struct LongBox {
  std::string shape = "cpdi", domain = "[[0, 0], [3.2, 4.8]]", lower = "[1.2, 1.7]", upper = "[1.3, 2.4]";
  std::string deformation = R"({"yy": 4})", velocity = R"J(["0.3*(y-2)", -1.2])J", boundaries = R"({"all": "free"})";
  double end = 0.12;

  std::string text() const {
    return R"({"title": "long", "dimension": 2, "grid": {"cell_size": 0.1, "domain": )" + domain +
           R"(, "boundaries": )" + boundaries + R"(}, "shape": {"type": ")" + shape +
           R"("}, "transfer": {"type": "apic"}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-3,
             "poisson_ratio": 0.3, "density": 1000}}, "bodies": [{"name": "a", "material": "m", "geometry":
             {"type": "box", "lower": )" +
           lower + R"(, "upper": )" + upper + R"(}, "initial_deformation_gradient": )" + deformation +
           R"(, "velocity": )" + velocity + R"(}], "solver": {"time_step": 0.01, "end_time": )" + digits(end) + "}}";
  }
};

void check_long(const LongBox& box) {
  const std::string text = box.text();
  INFO(text);
  Scene reference(text, {"/backend=reference"}), cpu(text, {"/backend=cpu", "/precision=double"});
  reference.run();
  cpu.run();
  Tolerance allowed = parity_tolerance;  // domains are many times as long as in other scenes
  allowed.position *= 10, allowed.material *= 100;
  compare_states(reference, cpu, std::numeric_limits<double>::epsilon(), allowed);
}

struct DetailStop {
  Failure failure;
  long step = -1;
};

DetailStop stopped_by(const std::string& text, const std::vector<std::string>& overrides) {
  Scene scene(text, overrides);
  try {
    while (!scene.simulation.finished()) scene.simulation.step();
  } catch (const RunFailure& stopped) {
    return {stopped.failure, scene.simulation.steps()};
  }
  return {};
}

}  // namespace

// The first step takes particles out of their tiles, so that its fused pass gives up; damping then makes them slow.
TEST_CASE("fused passes go on after one that gave up, with the same bits", "[parity]") {
  for (const std::string velocity : {R"J(["17+3*sin(9*y)", "2*sin(7*x)"])J", R"J(["-17+3*sin(9*y)", "2*sin(7*x)"])J",
                                     R"J(["2*sin(9*y)", "17+3*sin(7*x)"])J"}) {
    INFO(velocity);
    const std::string text = detail_flight(velocity, R"(, "damping": {"viscous": 20})");
    const std::vector<double> separate = flown(text, "separate", 40, 1);
    CHECK(different(separate, flown(text, "fused", 40, 1)) == 0);
    CHECK(different(separate, flown(text, "fused", 40, 9)) == 0);
  }
}

// With the tent the moment of a particle is that of its place between the nodes.
TEST_CASE("parity of spins on the tent", "[parity]") {
  Mix mix;
  mix.shape = R"({"type": "linear"})", mix.transfer = R"({"type": "rpic"})";
  check_parity(mix);
}

// Six particles of a cell begin their stencils' next nodes between the places that are tried to find out where.
TEST_CASE("particles that creep out of their block are sorted before they leave its tile", "[parity]") {
  for (const std::string passes : {"separate", "fused"}) {
    const std::vector<std::string> overrides{set("/solver/passes", passes), "/bodies/0/geometry/lower=[3.9, 3.9]",
                                             "/bodies/0/geometry/upper=[4, 4]"};
    CpuRun run(detail_flight("[0.05, 0.05]", "", R"(, "particles_per_cell_axis": 6)"), overrides, 1);
    CHECK_NOTHROW(run.steps(340));
  }
}

// At 0.1 cells a step a block is sorted at most every 15 steps, and at least every 20.
TEST_CASE("separate passes seldom sort a slow block", "[parity]") {
  for (const std::string order : {"last", "modified_last"}) {
    CpuRun run(detail_flight("[1, 0]", ""), {"/solver/passes=separate", "/solver/stress_update=" + order}, 1);
    int sorts = 0;
    double before = 0;
    for (int step = 0; step < 80; ++step) {
      run.steps(1);
      const double now = drift_in_checkpoint(run.simulation);
      sorts += before > now + 0.1;
      before = now;
    }
    INFO(order << ": " << sorts << " sorts");
    CHECK(sorts >= 80 / 20);
    CHECK(sorts <= 80 / 15 + 1);
  }
}

// A particle may leave through two faces at once, or from a block that begins beyond the domain's edge.
TEST_CASE("a particle that leaves at a corner or from beside a lower face ends the run", "[parity][failure]") {
  for (const bool corner : {true, false}) {
    const std::string text = detail_flight(corner ? "[2, 2]" : "[-2, 0]", "", R"(, "particles_per_cell_axis": 2)");
    const std::vector<std::string> place{
        corner ? "/bodies/0/geometry/lower=[7.8, 7.8]" : "/bodies/0/geometry/lower=[0, 3]",
        corner ? "/bodies/0/geometry/upper=[7.9, 7.9]" : "/bodies/0/geometry/upper=[0.1, 3.1]"};
    std::vector<DetailStop> stops;
    for (const std::string backend : {"reference", "cpu"}) {
      std::vector<std::string> overrides = place;
      overrides.push_back("/backend=" + backend);
      if (!corner) overrides.emplace_back("/shape/type=bspline_quadratic");  // a first node beyond the edge
      stops.push_back(stopped_by(text, overrides));
    }
    INFO(corner);
    CHECK(stops[0].failure.cause == Cause::left_domain);
    CHECK(stops[1].failure.cause == Cause::left_domain);
    CHECK(stops[0].step > 0);
    CHECK(stops[0].step == stops[1].step);
    CHECK(stops[0].failure.axis == stops[1].failure.axis);
  }
}

// The fastest of a hill of velocities is in the middle of a block; of equals the first counts.
TEST_CASE("the particle that limits the time step is the same on both backends", "[parity]") {
  for (const std::string velocity :
       {R"J(["1/(1+300*((x-3.88)^2+(y-3.79)^2))", 0])J", R"J(["1/(1+300*((x-4.13)^2+(y-4.38)^2))", 0])J", "[1, 0]"}) {
    const std::string text = detail_flight(velocity, "");
    std::vector<TimeStepLimit> limits;
    for (const std::string backend : {"reference", "cpu"}) {
      Scene scene(text, {"/backend=" + backend, "/solver/time_step=auto"});
      scene.simulation.step();
      limits.push_back(scene.simulation.backend().time_step_limit());
    }
    INFO(velocity);
    CHECK(limits[0].speed == Approx(limits[1].speed).epsilon(1e-12));
    CHECK(limits[0].particle == limits[1].particle);
  }
}

TEST_CASE("the cpu backend's books of mass and momentum close, with sizes too", "[parity][ledger]") {
  for (const bool ring : {false, true}) {
    Mix mix;
    mix.overrides.emplace_back("/precision=double");
    if (ring) mix.overrides.insert(mix.overrides.end(), {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"});
    Scene scene(mix.text(), mix.overrides);
    scene.run();
    const Ledger& ledger = scene.simulation.ledger();
    const double mass = scene.metrics.initial().mass;
    CHECK(std::abs(ledger.mass_book) < 1e-12 * mass);
    CHECK(std::abs(ledger.momentum_book) < 1e-12 * mass);
  }
}

TEST_CASE("parity of corners that kept velocities move", "[parity]") {
  Mix mix;
  mix.shape = R"({"type": "cpdi2"})", mix.transfer = R"({"type": "asflip", "pic_fraction": 0.2})";
  check_parity(mix);
}

// Domains of a whole cell and steps of a cell: corners pass one another before any particle's own J does.
TEST_CASE("a domain with corners that turns inside out ends the run on both backends", "[parity][failure]") {
  LongBox box;
  box.shape = "cpdi2", box.deformation = R"({"yy": 1})", box.end = 0.4;
  box.lower = "[0.5, 0.5]", box.upper = "[1.5, 0.7]", box.velocity = R"J(["3*sin(15*y)*x", "2*sin(15*x)"])J";
  std::vector<DetailStop> stops;
  for (const std::string backend : {"reference", "cpu"})
    stops.push_back(stopped_by(box.text(), {"/backend=" + backend, "/bodies/0/particles_per_cell_axis=1"}));
  CHECK(stops[0].failure.cause == Cause::domain_inside_out);
  CHECK(stops[1].failure.cause == Cause::domain_inside_out);
  CHECK(stops[0].step == stops[1].step);
}

// Reaches of 1, 3.5, 16.5 and 23 cells: boxes at the tile's lower edge, lists at its upper edge, lists that end in blocks
// beyond the neighbours, of some particles alone and beyond the domain's lower edge.
TEST_CASE("parity of lists of every length, on either side of a tile's edge", "[parity]") {
  for (const std::string shape : {"cpdi", "cpdi2"})
    for (const std::string deformation : {R"({"yy": 4})", R"({"yy": 14})", R"({"yy": 66})", R"({"yy": 66, "yx": -25})",
                                          R"({"yy": "27.5*Y"})", R"({"yy": "138-34*Y"})", R"({"yy": 92})"}) {
      LongBox box;
      box.shape = shape, box.deformation = deformation;
      if (deformation.find("4}") != deformation.npos) box.lower = "[1.2, 1.65]";
      check_long(box);
    }
}

TEST_CASE("parity of rings that melt and warm themselves", "[parity][temperature]") {
  Mix mix;
  mix.close = true;
  mix.material = material(plastic, R"(, "dissipation_to_heat": 0.9)" + melts + R"(, "yield_stress": 20}})");
  mix.boundaries = R"({"all": "slip", "x_max": {"type": "slip", "temperature": 60}})";
  mix.overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
  check_parity(warm(mix));
}

// Laws whose bodies spring apart leave a whole matrix behind, and walls that heat comes through ask for a diagonal one.
TEST_CASE("parity of springs between bodies beside walls that heat comes through", "[parity][temperature]") {
  Mix mix;
  mix.close = true, mix.transfer = transfer_named("flip"), mix.boundaries = boundaries(2, "slip");
  mix.contact = R"({"type": "linear_interface", "normal_stiffness": 4000, "shear_stiffness": 2000})";
  check_parity(warm(mix));
}

// Two grips on one body of several blocks, whose velocities differ and follow the second coordinate of where it began.
TEST_CASE("reactions of two grips on a body of several blocks are alike on both backends", "[parity]") {
  Mix mix;
  mix.overrides.emplace_back("/bodies/1/geometry/upper=[1.1, 0.8]");
  mix.more = R"J(, "grips": [
    {"body": "b", "where": {"type": "half_space", "point": [0.6, 0], "normal": [1, 0]}, "velocity": ["1+0.9*Y", "-0.1+X*Y"]},
    {"body": "b", "where": {"type": "half_space", "point": [0.7, 0], "normal": [-1, 0]}, "velocity": ["1.2-Y", 0.2]}])J";
  const std::string told = R"(/output={"reactions": true})";
  Scene reference(mix.text(), {"/backend=reference", told, mix.overrides[0]}),
      cpu(mix.text(), {"/backend=cpu", "/precision=double", told, mix.overrides[0]});
  reference.run();
  cpu.run();
  for (std::size_t grip = 0; grip < 2; ++grip) {
    const auto support = static_cast<std::size_t>(reference.experiment.support_of_grip(grip));
    const Reaction expected = reference.simulation.backend().reactions().at(support),
                   found = cpu.simulation.backend().reactions().at(support);
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(found.force[axis] == Approx(expected.force[axis]).epsilon(1e-9).margin(1e-6));
      CHECK(found.impulse[axis] == Approx(expected.impulse[axis]).epsilon(1e-9).margin(1e-9));
    }
  }
}

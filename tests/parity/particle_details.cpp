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
  std::string material = R"({"type": "neo_hookean", "youngs_modulus": 1e-3, "poisson_ratio": 0.3, "density": 1000})";
  std::string seeding, more;  ///< further keys of the body, and of the experiment
  double end = 0.12;

  std::string text() const {
    return R"({"title": "long", "dimension": 2, "grid": {"cell_size": 0.1, "domain": )" + domain +
           R"(, "boundaries": )" + boundaries + R"(}, "shape": {"type": ")" + shape +
           R"("}, "transfer": {"type": "apic"}, "materials": {"m": )" + material +
           R"(}, "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": )" + lower +
           R"(, "upper": )" + upper + R"(}, "initial_deformation_gradient": )" + deformation + seeding +
           R"(, "velocity": )" + velocity + "}]" + more + R"(, "solver": {"time_step": 0.01, "end_time": )" +
           digits(end) + "}}";
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

// With the tent the moment of a particle is that of its place between the nodes, with B-splines all have the same.
TEST_CASE("parity of spins on the tent and on B-splines", "[parity]") {
  for (const std::string shape : {"linear", "bspline_quadratic"}) {
    Mix mix;
    mix.shape = transfer_named(shape), mix.transfer = R"({"type": "rpic"})";
    check_parity(mix);
  }
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
        corner ? "/bodies/0/geometry/lower=[7.8, 7.8]" : "/bodies/0/geometry/lower=[0, 0.3]",
        corner ? "/bodies/0/geometry/upper=[7.9, 7.9]" : "/bodies/0/geometry/upper=[0.1, 0.4]"};
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

// The fastest of a hill of velocities is in the middle of a block; of two hills the lower one is in a later block, with lower
// numbers along one axis or the other; of equals the first counts.
TEST_CASE("the particle that limits the time step is the same on both backends", "[parity]") {
  for (const std::string velocity :
       {R"J(["1/(1+300*((x-3.88)^2+(y-3.79)^2))", 0])J", R"J(["1/(1+300*((x-4.13)^2+(y-4.38)^2))", 0])J",
        R"J(["1/(1+300*((x-3.63)^2+(y-3.96)^2))+0.5/(1+300*((x-4.28)^2+(y-3.58)^2))", 0])J",
        R"J(["1/(1+300*((x-4.28)^2+(y-3.63)^2))+0.5/(1+300*((x-3.63)^2+(y-4.28)^2))", 0])J", "[1, 0]"}) {
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
// beyond the neighbours, of some particles alone and beyond the domain's lower edge. The last but one are boxes that begin
// below the tile along both axes, and the last ones are lists that end beyond it along both.
TEST_CASE("parity of lists of every length, on either side of a tile's edge", "[parity]") {
  for (const std::string shape : {"cpdi", "cpdi2"})
    for (const std::string deformation :
         {R"({"yy": 4})", R"({"yy": 14})", R"({"yy": 66})", R"({"yy": 66, "yx": -25})", R"({"yy": "27.5*Y"})",
          R"({"yy": "138-34*Y"})", R"({"yy": "Y>2.2?66:4"})", R"({"yy": 92})"}) {
      LongBox box;
      box.shape = shape, box.deformation = deformation;
      if (deformation.find("4}") != deformation.npos) box.lower = "[1.2, 1.65]";
      check_long(box);
    }
  LongBox corner;
  corner.lower = "[0.85, 1.65]", corner.upper = "[0.95, 1.75]", corner.velocity = "[-1.2, -1.2]";
  corner.deformation = R"({"xx": 4.4, "yy": 4.4})";
  check_long(corner);
  corner.lower = "[1.6, 2.4]", corner.upper = "[1.7, 2.5]", corner.velocity = R"J(["0.3*(y-2)", 1.2])J";
  corner.deformation = R"({"xx": 14, "yy": 14})";
  check_long(corner);
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

// Two grips on one body of several blocks, whose velocities differ and follow the second coordinate of where it began; around
// an axis the masses of its particles differ too.
TEST_CASE("reactions of two grips on a body of several blocks are alike on both backends", "[parity]") {
  const bool ring = GENERATE(false, true);
  Mix mix;
  mix.overrides.emplace_back("/bodies/1/geometry/upper=[1.1, 0.8]");
  mix.more = R"J(, "grips": [
    {"body": "b", "where": {"type": "half_space", "point": [0.6, 0], "normal": [1, 0]}, "velocity": ["1+0.9*Y", "-0.1+X*Y"]},
    {"body": "b", "where": {"type": "half_space", "point": [0.7, 0], "normal": [-1, 0]}, "velocity": ["1.2-Y", 0.2]}])J";
  mix.overrides.emplace_back(R"(/output={"reactions": true})");
  if (ring) mix.overrides.insert(mix.overrides.end(), {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"});
  std::vector<std::string> on_cpu{"/backend=cpu", "/precision=double"};
  on_cpu.insert(on_cpu.end(), mix.overrides.begin(), mix.overrides.end());
  Scene reference(mix.text(), on_reference(mix)), cpu(mix.text(), on_cpu);
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

// A single particle, so that its chunk holds no other one that would be looked at beside it.
TEST_CASE("one particle that leaves through any face or corner is noticed and named", "[parity][failure]") {
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0}) {
      if (x == 0 && y == 0) continue;
      const std::string text =
          detail_flight("[" + digits(130 * x) + ", " + digits(130 * y) + "]", "", R"(, "particles_per_cell_axis": 1)");
      std::vector<DetailStop> stops;
      for (const std::string backend : {"reference", "cpu"})
        stops.push_back(stopped_by(text, {"/backend=" + backend, "/precision=double", "/bodies/0/geometry/lower=[4, 4]",
                                          "/bodies/0/geometry/upper=[4.1, 4.1]"}));
      INFO(x << " " << y);
      CHECK(stops[0].failure.cause == Cause::left_domain);
      CHECK(stops[0].step > 1);
      CHECK(stops[1].failure.cause == stops[0].failure.cause);
      CHECK(stops[1].step == stops[0].step);
      CHECK(stops[1].failure.axis == stops[0].failure.axis);
      CHECK(stops[1].failure.value == Approx(stops[0].failure.value).epsilon(1e-12));
    }
}

// The particles beside the separating wall are half a cell from it or nearer, which they may be; those above leave first.
TEST_CASE("only the particle that leaves is named, and none that is near a separating wall", "[parity][failure]") {
  const std::string text = detail_flight("[0, 2]", "", R"(, "particles_per_cell_axis": 2)");
  std::vector<DetailStop> stops;
  for (const std::string backend : {"reference", "cpu"})
    stops.push_back(stopped_by(
        text, {"/backend=" + backend, "/precision=double", R"(/grid/boundaries={"all": "free", "x_min": "separate"})",
               "/bodies/0/geometry/lower=[0, 7.5]", "/bodies/0/geometry/upper=[0.1, 7.9]"}));
  CHECK(stops[0].failure.cause == Cause::left_domain);
  CHECK(stops[0].failure.particle > 0);
  CHECK(stops[1].failure.cause == stops[0].failure.cause);
  CHECK(stops[1].failure.particle == stops[0].failure.particle);
  CHECK(stops[1].step == stops[0].step);
}

// A grip takes the inner column from a quarter of a cell to the axis itself, without rounding, and the outer one away from it,
// so that nothing is turned inside out. Stencils begin at the axis, or one node before it.
TEST_CASE("a particle that comes to lie on the axis itself ends the run", "[parity][axisymmetric][failure]") {
  for (const std::string shape : {"linear", "bspline_quadratic"}) {
    const std::string text =
        R"({"title": "to the axis", "dimension": 2, "grid": {"symmetry": "axisymmetric", "cell_size": 1,
      "domain": [[0, 0], [8, 8]], "boundaries": {"all": "slip"}}, "shape": {"type": ")" +
        shape + R"("}, "transfer": {"type": "apic"}, "materials":
      {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}},
      "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0, 2], "upper": [1, 3]}}],
      "grips": [{"body": "b", "velocity": ["8*X-3", 0], "where": {"type": "half_space", "point": [4, 10], "normal": [0, 1]}}],
      "solver": {"time_step": 0.25, "end_time": 1}})";
    INFO(shape);
    std::vector<DetailStop> stops;
    for (const std::string backend : {"reference", "cpu"})
      stops.push_back(stopped_by(text, {"/backend=" + backend, "/precision=double"}));
    CHECK(stops[0].failure.cause == Cause::reached_axis);
    CHECK(stops[0].failure.value == 0);
    CHECK(stops[1].failure.cause == stops[0].failure.cause);
    CHECK(stops[1].failure.value == stops[0].failure.value);
    CHECK(stops[0].step == 0);
    CHECK(stops[1].step == 0);
  }
}

// Transfers that read gradients want them from gathers that strain nothing, too; with the tent all affine ones do.
TEST_CASE("parity of gathered gradients where the strain has a pass of its own", "[parity]") {
  for (const std::string order : {"first", "modified_last"})
    for (const auto& [shape, transfer] : {std::pair{"gimp", "tpic"}, {"linear", "apic"}}) {
      Mix mix;
      mix.shape = transfer_named(shape), mix.transfer = transfer_named(transfer), mix.stress_update = order;
      check_parity(mix);
    }
}

// Nothing affine is scattered, though the walls ask for the places of the heat.
TEST_CASE("parity of PIC without a ledger between walls that heat comes through", "[parity][temperature]") {
  Mix mix;
  mix.close = true, mix.transfer = transfer_named("pic"), mix.boundaries = boundaries(2, "slip");
  mix.more = R"(, "output": {"ledger": false})";
  mix = warm(mix);
  std::vector<std::string> on_cpu{"/backend=cpu", "/precision=double"};
  on_cpu.insert(on_cpu.end(), mix.overrides.begin(), mix.overrides.end());
  Scene reference(mix.text(), on_reference(mix)), cpu(mix.text(), on_cpu);
  reference.run();
  cpu.run();
  compare_states(reference, cpu, std::numeric_limits<double>::epsilon(), parity_tolerance);
}

TEST_CASE("parity of shocks in bodies of which a part has melted", "[parity][temperature][viscosity]") {
  Mix mix;
  mix.close = true, mix.material = material(elastic, melts + "}}");
  mix.overrides.emplace_back(R"(/materials/m/artificial_viscosity={"linear": 0.5, "quadratic": 3})");
  check_parity(warm(mix));
}

// A ledger of every third step rests in the first step that the resumed run scatters.
TEST_CASE("a run that goes on in a step without a ledger takes the next entries all the same", "[parity][ledger]") {
  for (const std::string passes : {"separate", "fused"})
    for (const long at : {3, 4}) {
      INFO(passes << " at " << at);
      const std::vector<std::string> overrides{"/precision=double", set("/solver/passes", passes),
                                               R"(/output={"ledger_every": 3})"};
      const std::string text = Mix{}.text();
      CpuRun whole(text, overrides, 1), resumed(text, overrides, 1);
      whole.steps(at);
      ArchiveWriter archive;
      whole.simulation.save(archive);
      ArchiveReader reader(archive.bytes());
      resumed.simulation.restore(reader);
      whole.steps(9 - at), resumed.steps(9 - at);
      CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
    }
}

// From 0.05 s on the force is no number, which the fused pass of the sixth step finds out for the seventh.
TEST_CASE("a run that is put back forgets the forces of a step that does not follow", "[parity]") {
  Mix mix;
  mix.shape = transfer_named("gimp"), mix.transfer = transfer_named("flip");
  mix.more = R"J(, "body_force": ["sqrt(0.05-t)", 0])J";
  CpuRun run(mix.text(), {"/precision=double"}, 1);
  run.steps(2);
  ArchiveWriter archive;
  run.simulation.save(archive);
  run.steps(4);
  REQUIRE_FALSE(run.simulation.backend().scattered());
  ArchiveReader reader(archive.bytes());
  run.simulation.restore(reader);
  CHECK_NOTHROW(run.steps(4));
  CHECK_THROWS_AS(run.steps(1), RunFailure);
}

// The particle falls by 0.5, 1 and 1.5 cells. After the first step each of the four corners of its domain lies on a node, which
// is then the only one there: the second node of the list is the rightmost and the last one the topmost, both in blocks beyond
// that of the particle.
TEST_CASE("a list whose nodes lie alone is scattered as far as it reaches", "[parity]") {
  const std::string text =
      R"({"title": "diamond", "dimension": 2, "grid": {"cell_size": 1, "domain": [[0, 0], [24, 24]],
    "boundaries": {"all": "free"}}, "gravity": [0.5, 0.5], "shape": {"type": "cpdi"}, "transfer": {"type": "pic"}, "materials":
    {"m": {"type": "neo_hookean", "youngs_modulus": 1e-30, "poisson_ratio": 0, "density": 1}},
    "bodies": [{"name": "b", "material": "m", "particles_per_cell_axis": 1,
      "initial_deformation_gradient": {"xx": 3, "xy": -3, "yx": 3, "yy": 3},
      "geometry": {"type": "box", "lower": [5, 6], "upper": [6, 7]}}],
    "solver": {"time_step": 1, "end_time": 3}, "output": {"ledger": false}})";
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(text, {"/backend=" + backend, "/precision=double"});
    REQUIRE(scene.simulation.particle_count() == 1);
    scene.run();
    CHECK(difference({8.5, 9.5}, scene.body().position, 1.0) <= 1e-9);
    CHECK(difference({1.5, 1.5}, scene.body().velocity, 1.0) <= 1e-9);
  }
}

// Of a fluid particles keep a ratio of volumes alone, which says little about how far their domains reach.
TEST_CASE("parity of long lists of a fluid, whose particles are drawn out and sheared", "[parity]") {
  for (const std::string shape : {"cpdi", "cpdi2"}) {
    LongBox box;
    box.shape = shape, box.deformation = R"({"xx": 0.02, "yy": 66, "yx": -25})";
    box.material = R"({"type": "inviscid_fluid", "bulk_modulus": 1e-9, "density": 1000})";
    check_long(box);
  }
}

// Nodes take one corner of a rectangle of 4 by 16 cells along, upwards or downwards, until the domain is twice as long on its
// side: that corner alone reaches farther from the particle than the others, which is sorted on the way.
TEST_CASE("parity of a domain of which one corner is drawn far out", "[parity]") {
  for (const bool up : {true, false}) {
    LongBox box;
    box.shape = "cpdi2", box.domain = "[[0, 0], [3.2, 9.6]]", box.lower = "[1.5, 4.8]", box.upper = "[1.6, 4.9]";
    box.deformation = R"({"xx": 4, "yy": 16})", box.seeding = R"(, "particles_per_cell_axis": 1)";
    box.velocity = "[0, 0]", box.end = 0.4;
    box.material = R"({"type": "von_mises", "youngs_modulus": 1e-3, "poisson_ratio": 0.3, "density": 1000,
      "yield_stress": 60})";
    box.more =
        R"J(, "node_conditions": [{"type": "prescribed", "lower": [0, 0], "upper": [3.2, 9.6], "velocity": [0, ")J" +
        std::string(up ? "4.3*(x-1.35)*(y-4.05)" : "4.3*(1.75-x)*(y-5.65)") + R"J("]}])J";
    check_long(box);
  }
}

// The corners part by so much that no number holds what they enclose: the place of the particle says more.
TEST_CASE("a domain without a volume is not called inside out", "[parity][failure]") {
  LongBox box;
  box.shape = "cpdi2", box.deformation = R"({"yy": 1})", box.velocity = "[0, 0]";
  std::vector<DetailStop> stops;
  for (const std::string backend : {"reference", "cpu"})
    stops.push_back(
        stopped_by(box.text(), {"/backend=" + backend, "/precision=double", "/solver/stress_update=first",
                                R"J(/body_force=["1e200*(y-2)", "1e200*(x-2)"])J", R"(/output={"ledger": false})"}));
  CHECK(stops[0].failure.cause == Cause::position_not_a_number);
  CHECK(stops[1].failure.cause == stops[0].failure.cause);
  CHECK(stops[1].failure.particle == stops[0].failure.particle);
}

// The domain's lower end rests 7.9 cells below the upper face, of 14 cells, while its particle moves on through the face: the
// upper end then reaches the tenth node beyond that. Of a particle that moves down through the lower face the ninth node below
// is in a block that is not beside its own. Of 9 cells the last lies in a block that begins beyond the other face.
TEST_CASE("parity of lists that reach farthest beyond a periodic face", "[parity]") {
  LongBox far;
  far.domain = "[[0, 0], [1.6, 1.4]]", far.boundaries = R"({"all": "periodic"})";
  far.lower = "[0.9, 1.35]", far.upper = "[1, 1.4]", far.deformation = R"({"yy": 30.6})";
  far.velocity = R"J([0, "1.52*(y-1.375)+1.2"])J", far.end = 0.09;
  LongBox near;
  near.shape = "cpdi2", near.domain = "[[0, 0], [0.9, 1.6]]", near.boundaries = far.boundaries;
  near.lower = "[0.8, 0.3]", near.upper = "[0.9, 0.4]", near.deformation = R"({"yy": 1})", near.velocity = "[1.2, 0]";
  check_long(far);
  far.lower = "[0.9, 0]", far.upper = "[1, 0.1]", far.deformation = R"({"yy": 14.8})";
  far.seeding = R"(, "particles_per_cell_axis": 1)", far.velocity = R"J([0, "1.6*(y-0.05)-1.2"])J";
  check_long(far);
  check_long(near);
}

// Five cells hold a particle in their first half cell, whose list ends nine nodes on.
TEST_CASE("parity of lists that reach beyond both walls of a narrow domain", "[parity]") {
  for (const bool along_x : {true, false}) {
    LongBox box;
    box.domain = along_x ? "[[0, 0], [0.5, 3.2]]" : "[[0, 0], [3.2, 0.5]]";
    box.lower = along_x ? "[0, 1]" : "[1, 0]", box.upper = along_x ? "[0.05, 1.1]" : "[1.1, 0.05]";
    box.deformation = along_x ? R"({"xx": 32.6})" : R"({"yy": 32.6})", box.velocity = "[0.1, 0.1]", box.end = 0.03;
    check_long(box);
  }
}

// Where particles go when they are sorted, and what a chunk of them is told and counts, in scenes that ask for its details.

#include <chrono>
#include <set>

#include "parity/drift.hpp"
#include "parity/parity.hpp"
#include "plugin/extensions.h"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

struct SortedScene {
  std::string domain = "[[0, 0], [60, 4]]", boundaries = R"({"all": "free"})", shape = "bspline_quadratic";
  std::string lower = "[1, 1]", upper = "[3, 3]", velocity = "[0, 0]", solver, more;
  std::string geometry, seeding;  ///< instead of the box, and further keys of the body
  /// A box without stress among cells of 1 m.
  std::string text() const {
    const std::string box = R"({"type": "box", "lower": )" + lower + R"(, "upper": )" + upper + "}";
    return R"({"title": "sorted", "dimension": 2, "grid": {"cell_size": 1, "domain": )" + domain +
           R"(, "boundaries": )" + boundaries + R"(}, "shape": {"type": ")" + shape +
           R"("}, "transfer": {"type": "apic"}, "materials":
      {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}},
      "bodies": [{"name": "b", "material": "m", "geometry": )" +
           (geometry.empty() ? box : geometry) + seeding + R"(, "velocity": )" + velocity + R"(}], "solver": )" +
           solver + more + R"(, "output": {"ledger": false}})";
  }
};

/// What a run on a backend stops with.
Failure failure_on(const std::string& backend, const std::string& text) {
  Scene scene(text, {set("/backend", backend), "/precision=double"});
  try {
    scene.run();
  } catch (const RunFailure& stopped) {
    return stopped.failure;
  }
  FAIL(backend << " has not stopped");
  return {};
}

std::set<std::uint32_t> dimensions_told;
int batches_without_temperature = 0;
const mpm_material* law_told = nullptr;
const mpm_shape* shape_overdone = nullptr;

std::int32_t note_what_is_told(const void* parameters, const mpm_material_batch* batch) {
  dimensions_told.insert(batch->dimension);
  batches_without_temperature += !batch->temperature;
  return law_told->update[MPM_LANES_DOUBLE][0](parameters, batch);
}
const void* reads_temperature(const char* id) {
  static const mpm_material_temperature table{MPM_MATERIAL_TEMPERATURE_VERSION, 0, 300};
  return id == std::string(MPM_MATERIAL_TEMPERATURE_ID) ? &table : nullptr;
}

void evaluate_too_long_lists(const void* parameters, const mpm_list_batch* batch) {
  shape_overdone->evaluate_list[MPM_LANES_DOUBLE][0](parameters, batch);
  batch->node_count[0] = static_cast<std::int32_t>(batch->capacity) + 1;
}

}  // namespace

// The bodies fly five cells: on either side of the domain that is farther than the grid reaches beyond it.
TEST_CASE("parity of bodies that fly round a periodic domain, along each axis and both ways", "[parity]") {
  for (const std::string sign : {"", "-"}) {
    Mix mix;
    mix.boundaries = R"({"all": "periodic"})";
    mix.overrides = {
        set("/bodies/0/velocity", R"J([")J" + sign + R"J(4.1-0.9*(y-0.43)", ")J" + sign + R"J(3.9+0.9*(x-0.31)"])J"),
        set("/bodies/1/velocity", "[" + sign + "4, " + sign + "4.2]"), "/solver/end_time=0.252"};
    check_parity(mix);
  }
}

// Along y the domain ends in the middle of a block, and the bodies lie in the first cells of theirs along x. One flies
// through the face and hits the other, which waits on the far side.
TEST_CASE("parity of bodies that meet across a periodic face in the middle of a block", "[parity]") {
  for (const bool up : {true, false}) {
    Mix mix;
    mix.boundaries = R"({"all": "periodic"})";
    const std::string high = R"([0.88, 0.85], "upper": [1.05, 1.0]})", low = R"([0.88, 0.25], "upper": [1.05, 0.4]})";
    mix.overrides = {"/grid/domain=[[0, 0], [1.6, 1.2]]",
                     R"(/bodies/0/geometry={"type": "box", "lower": )" + (up ? high : low),
                     up ? R"J(/bodies/0/velocity=["-0.9*(y-0.92)", "3.9+0.9*(x-0.95)"])J"
                        : R"J(/bodies/0/velocity=["-0.9*(y-0.32)", "-3.9+0.9*(x-0.95)"])J",
                     R"(/bodies/1/geometry={"type": "box", "lower": )" + (up ? low : high),
                     "/bodies/1/velocity=[0, 0]",
                     "/solver/end_time=0.18"};
    check_parity(mix);
  }
}

// At 9.3 cells a step a particle passes the blocks beside its own, of 8 cells.
TEST_CASE("particles may pass more than a block of cells in a step", "[parity]") {
  for (const auto& [x, y] : {std::pair{9.3, 0.0}, {-9.3, 0.0}, {0.0, 9.3}, {0.0, -9.3}, {9.3, 9.3}}) {
    SortedScene flight;
    flight.domain = "[[0, 0], [80, 80]]", flight.lower = "[38, 38]", flight.upper = "[42, 42]";
    flight.velocity = "[" + digits(x) + ", " + digits(y) + "]";
    flight.solver = R"({"time_step": 1, "end_time": 3})";
    INFO(flight.velocity);
    Scene scene(flight.text(), {"/backend=cpu", "/precision=double"});
    std::vector<double> expected = scene.body().position;
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += 3 * (i % 2 == 0 ? x : y);
    CHECK_NOTHROW(scene.run());
    CHECK(difference(expected, scene.body().position, 1.0) <= 1e-12);
  }
}

// From 32 blocks on threads share a sort. The bar lies in 40, along which its particles are many or few. Of the rows of the
// second, two of five leave each lower block at once, which then holds a chunk less.
TEST_CASE("bars of many blocks fly alike on any number of threads", "[parity]") {
  SortedScene bar, rows;
  bar.domain = "[[0, 0], [200, 24]]", bar.lower = "[10, 7]", bar.upper = "[165, 9]";
  bar.velocity = R"J(["0.23+0.001*y", "0.15+0.0002*x"])J", bar.solver = R"({"time_step": 1, "end_time": 100})";
  rows = bar;
  rows.lower = "[10, 3]", rows.upper = "[165, 10]", rows.velocity = "[0, 0.15]";
  rows.seeding = R"(, "particles_per_cell_axis": 1)";
  for (const SortedScene& flight : {bar, rows}) {
    CpuRun one(flight.text(), {"/precision=double"}, 1), two(flight.text(), {"/precision=double"}, 2);
    one.steps(20), two.steps(20);
    CHECK(different(all_results(one.simulation), all_results(two.simulation)) == 0);
  }
}

// It is sorted as it lies, and next when it is 0.99 cells out of its block, at a hundredth of a cell a step.
TEST_CASE("a particle may go a cell out of its block, along each axis and both ways, and then has another",
          "[parity]") {
  for (const auto& [x, y] : {std::pair{0.01, 0.0}, {-0.01, 0.0}, {0.0, 0.01}, {0.0, -0.01}}) {
    SortedScene flight;
    flight.domain = "[[0, 0], [40, 40]]", flight.seeding = R"(, "particles_per_cell_axis": 1)";
    flight.lower = x + y > 0 ? "[15, 15]" : "[16, 16]", flight.upper = x + y > 0 ? "[16, 16]" : "[17, 17]";
    flight.velocity = "[" + digits(x) + ", " + digits(y) + "]", flight.solver = R"({"time_step": 1, "end_time": 300})";
    INFO(flight.velocity);
    Scene scene(flight.text(), {"/backend=cpu", "/precision=double"});
    std::vector<double> expected = scene.body().position;
    expected[0] += 300 * x, expected[1] += 300 * y;
    CHECK_NOTHROW(scene.run());
    CHECK(difference(expected, scene.body().position, 1.0) <= 1e-11);
  }
}

// As in fused.cpp, but of few particles: sorted by where they will be in the middle of their way, of 0.1 cells a step, they
// are sorted again after 15 steps; as they lie they would be after 9.
TEST_CASE("a small block that flies is seldom sorted", "[parity]") {
  for (const auto& [x, y] : {std::pair{0.1, 0.0}, {-0.1, 0.0}, {0.0, 0.1}, {0.0, -0.1}}) {
    SortedScene flight;
    flight.domain = "[[0, 0], [80, 80]]", flight.lower = "[35, 35]", flight.upper = "[44, 44]";
    flight.seeding = R"(, "particles_per_cell_axis": 1)";
    flight.velocity = "[" + digits(x) + ", " + digits(y) + "]", flight.solver = R"({"time_step": 1, "end_time": 150})";
    CpuRun run(flight.text(), {"/precision=double", "/solver/passes=fused"}, 1);
    const int sorts = sorts_in(run, 150);
    INFO(flight.velocity << ": " << sorts << " sorts");
    CHECK(sorts >= 150 / 20);
    CHECK(sorts <= 150 / 15 + 1);
  }
}

// The block of 31 comes after that of 64 in the first sort, and before it among the chunks.
TEST_CASE("a block of 31 particles leaves those of the next one as they are", "[parity]") {
  SortedScene flight;
  flight.domain = "[[0, 0], [24, 24]]", flight.seeding = R"(, "particles_per_cell_axis": 1)";
  flight.geometry = R"({"type": "union", "of": [{"type": "box", "lower": [1, 9], "upper": [8, 17]},
    {"type": "box", "lower": [9, 1], "upper": [16, 5]}, {"type": "box", "lower": [9, 5], "upper": [12, 6]}]})";
  flight.velocity = "[0.1, 0.1]", flight.solver = R"({"time_step": 1, "end_time": 10})";
  std::vector<BodyState> ends;
  for (const std::string backend : {"reference", "cpu"}) {
    Scene scene(flight.text(), {set("/backend", backend), "/precision=double"});
    REQUIRE(scene.simulation.particle_count() == 7 * 8 + 31);
    scene.run();
    ends.push_back(scene.body());
  }
  CHECK(difference(ends[0].position, ends[1].position, 1.0) <= 1e-12);
}

// Cells are counted from the block's first node, so that a float holds a part of a cell however far away that is.
TEST_CASE("in float particles lie as exactly far from the corner as near it", "[parity]") {
  SortedScene far;
  far.domain = "[[0, 0], [1000000, 8]]", far.lower = "[999990, 1]", far.upper = "[999993, 3]";
  far.seeding = R"(, "particles_per_cell_axis": 3)", far.solver = R"({"time_step": 1, "end_time": 1})";
  Scene exact(far.text(), {"/backend=cpu", "/precision=double"}),
      scene(far.text(), {"/backend=cpu", "/precision=float"});
  CHECK(difference(exact.body().position, scene.body().position, 1.0) <= 1e-6);
}

// It ends a step 1.8e-15 m before the lower face, from which 40 m later is the upper face to rounding.
TEST_CASE("a particle that is before a periodic face by rounding is at the lower one", "[parity]") {
  SortedScene flight;
  flight.domain = "[[0, 0], [40, 4]]", flight.boundaries = R"({"all": "periodic"})";
  flight.lower = "[0, 1]", flight.upper = "[1, 2]", flight.velocity = "[-1, 0]";
  flight.solver = R"({"time_step": 0.25000000000000178, "end_time": 1})";
  Scene scene(flight.text(), {"/backend=cpu", "/precision=double"});
  REQUIRE(scene.body().position[0] == 0.25);
  scene.run_steps(1);
  CHECK(scene.body().position[0] == 0);
}

// Only what lies beyond 30 m is drawn out, and the particle numbered first does not.
TEST_CASE("the first particle that outgrows its stencil is named, whoever is in its chunk", "[parity][failure]") {
  SortedScene apart;
  apart.shape = "gimp_contiguous", apart.lower = "[28, 1]", apart.upper = "[32, 3]";
  apart.solver = R"({"time_step": 0.1, "end_time": 10})";
  apart.more = R"J(, "node_conditions": [{"lower": [0, 0], "upper": [60, 4], "type": "prescribed",
    "velocity": ["0.99*max(x-30,0)", 0]}])J";
  const Failure expected = failure_on("reference", apart.text()), found = failure_on("cpu", apart.text());
  CHECK(expected.cause == Cause::domain_outgrew_stencil);
  CHECK(expected.particle > 0);
  CHECK(found.cause == expected.cause);
  CHECK(found.particle == expected.particle);
}

// Inside out along the radius alone: around the axis the body is stretched, by another factor at each radius.
TEST_CASE("a ring that is inside out is named with its ratio of volumes", "[parity][failure]") {
  SortedScene ring;
  ring.boundaries = R"({"all": "slip"})", ring.lower = "[2, 1]", ring.upper = "[4, 3]",
  ring.velocity = R"J(["-5*(x-2)", 0])J";
  ring.solver = R"({"time_step": 0.5, "end_time": 10, "stress_update": "first"})";
  std::string text = ring.text();
  text.replace(text.find(R"("cell_size")"), 0, R"("symmetry": "axisymmetric", )");
  const Failure expected = failure_on("reference", text), found = failure_on("cpu", text);
  CHECK(expected.cause == Cause::inverted);
  CHECK(found.cause == expected.cause);
  CHECK(found.particle == expected.particle);
  CHECK(found.value == Approx(expected.value).epsilon(1e-9));
}

TEST_CASE("a material that turns a particle inside out is told dimension and temperature in each batch", "[parity]") {
  const Plugin& law = *plugins().find(MPM_MATERIAL, "neo_hookean");
  law_told = &law.material();
  mpm_material table = *law_told;
  table.update[MPM_LANES_DOUBLE][0] = note_what_is_told;
  mpm_descriptor descriptor = *law.descriptor;
  descriptor.kind_table = &table, descriptor.extension = reads_temperature;
  Plugin noting = law;
  noting.descriptor = &descriptor;
  SortedScene flight;
  flight.velocity = R"J(["-5*x", 0])J", flight.seeding = R"(, "temperature": 20)";
  flight.solver = R"({"time_step": 0.5, "end_time": 10, "stress_update": "first"})";
  std::string text = flight.text();
  const std::string law_of_text = R"("density": 1)";
  text.replace(text.find(law_of_text), law_of_text.size(),
               law_of_text + R"(, "thermal": {"conductivity": 1e-9, "heat_capacity": 1})");
  Experiment experiment = experiment_from(text, {"/backend=cpu", "/precision=double"});
  experiment.materials[0].component.plugin = &noting;
  Simulation simulation(experiment, backend_factory(1));
  dimensions_told.clear(), batches_without_temperature = 0;
  CHECK_THROWS_AS(simulation.step(), RunFailure);
  CHECK(dimensions_told == std::set<std::uint32_t>{2});
  CHECK(batches_without_temperature == 0);
}

TEST_CASE("a shape that gives too long a list ends the run, on any number of threads", "[parity][failure]") {
  const Plugin& shape = *plugins().find(MPM_SHAPE, "cpdi2");
  shape_overdone = &shape.shape();
  mpm_shape table = *shape_overdone;
  table.evaluate_list[MPM_LANES_DOUBLE][0] = evaluate_too_long_lists;
  mpm_descriptor descriptor = *shape.descriptor;
  descriptor.kind_table = &table;
  Plugin overdoing = shape;
  overdoing.descriptor = &descriptor;
  SortedScene flight;
  flight.shape = "cpdi2", flight.upper = "[31, 3]", flight.solver = R"({"time_step": 0.5, "end_time": 10})";
  for (const int threads : {1, 2}) {
    Experiment experiment = experiment_from(flight.text(), {"/backend=cpu", "/precision=double"});
    experiment.shape.plugin = &overdoing;
    Simulation simulation(experiment, [threads](const Experiment& e, const Plan& plan, std::vector<SeededBody> bodies) {
      return make_cpu_backend(e, plan, std::move(bodies), threads);
    });
    CHECK_THROWS_AS(simulation.step(), std::logic_error);
  }
}

// Such a step is nearly all that a tile has room for. Drift is measured to a part of a cell, and must not be longer than what
// was promised when the velocities were left behind.
TEST_CASE("a block that flies by nearly a cell a step goes on where nobody looks", "[parity]") {
  for (const std::string shape : {"bspline_cubic", "bspline_quadratic"})
    for (const double cells : {0.955, 0.97, 0.985}) {
      INFO(shape << " " << cells);
      SortedScene flight;
      flight.domain = "[[0, 0], [20, 200]]", flight.shape = shape, flight.lower = "[4, 4]", flight.upper = "[12, 12]";
      flight.seeding = R"(, "particles_per_cell_axis": 4)", flight.velocity = "[0, " + digits(cells) + "]";
      flight.solver = R"({"time_step": 1, "end_time": 100})";
      for (const std::string precision : {"double", "float"}) {
        CpuRun stored(flight.text(), {"/precision=" + precision}, 1),
            passed(flight.text(), {"/precision=" + precision}, 1);
        passed.simulation.observe_when([](double, long step) { return step == 60; });
        stored.steps(60), passed.steps(60);
        CHECK(different(all_results(stored.simulation), all_results(passed.simulation)) == 0);
      }
    }
}

// A busy machine may take the processor away between two phases: the best of some runs counts.
TEST_CASE("the phases of a thread take no longer together than the run", "[parity]") {
  SortedScene flight;
  flight.upper = "[31, 3]", flight.solver = R"({"time_step": 0.001, "end_time": 10})";
  double largest = 0;
  for (int k = 0; k < 8 && largest < 0.01; ++k) {
    CpuRun run(flight.text(), {"/precision=double"}, 1);
    const auto begin = std::chrono::steady_clock::now();
    run.simulation.backend().measure_phases(true);
    run.steps(50);
    const std::map<std::string, double> phases = run.simulation.backend().phase_seconds();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    double sum = 0;
    for (const auto& [phase, taken] : phases) sum += taken;
    CHECK(phases.size() >= 3);
    CHECK(sum <= 1.01 * seconds);
    largest = std::max(largest, sum / seconds);
  }
  CHECK(largest > 0.01);
}

// Of steps that nobody looks at, what the transfer keeps is never stored: with cubic shapes 32 numbers a particle in 2-D.
TEST_CASE("velocities and all that the transfer keeps pass from step to step as they are stored", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string transfer :
         {R"({"type": "apic"})", R"({"type": "rpic"})", R"({"type": "polypic", "basis": "full"})"}) {
      Mix mix;
      mix.dimension = dimension, mix.transfer = transfer;
      if (dimension == 2) mix.shape = R"({"type": "bspline_cubic"})";
      INFO(mix.name());
      CpuRun stored(mix.text(), {"/precision=double"}, 1), passed(mix.text(), {"/precision=double"}, 1);
      passed.simulation.observe_when([](double, long step) { return step == 14; });
      stored.steps(14), passed.steps(13);
      CHECK(passed.simulation.backend().body_state(0).velocity.empty());
      passed.steps(1);
      CHECK(different(all_results(stored.simulation), all_results(passed.simulation)) == 0);
    }
}

TEST_CASE("parity of domains and corners that wait for the last pass of a step", "[parity]") {
  Mix domains, corners, solids;
  domains.shape = R"({"type": "gimp_contiguous"})", domains.stress_update = "first";
  corners.shape = solids.shape = R"({"type": "cpdi2"})", corners.stress_update = solids.stress_update = "modified_last";
  solids.dimension = 3;
  for (const Mix& mix : {domains, corners, solids}) check_parity(mix);
}

// With cubic shapes a particle has 26 coefficients beyond the affine ones.
TEST_CASE("parity of filtered polynomials of all degrees", "[parity]") {
  Mix mix;
  mix.shape = R"({"type": "bspline_cubic"})", mix.transfer = R"({"type": "polypic", "basis": "full"})";
  mix.filter = R"({"type": "fmpm", "order": 2})";
  check_parity(mix);
}

// Lanes beyond the last particle hold it once more: those of one particle alone, and of two of which the last is too long.
TEST_CASE("one particle flies without others, and of two the one that reaches too far is named", "[parity][failure]") {
  SortedScene flight;
  flight.shape = "cpdi2", flight.upper = "[2, 2]", flight.velocity = "[0.3, 0.1]";
  flight.solver = R"({"time_step": 1, "end_time": 10})";
  flight.seeding = R"(, "particles_per_cell_axis": 1)";
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(flight.text(), {set("/backend", backend), "/precision=double"});
    REQUIRE(scene.simulation.particle_count() == 1);
    CHECK_NOTHROW(scene.run());
    CHECK(difference({4.5, 2.5}, scene.body().position, 1.0) <= 1e-12);
  }

  SortedScene two = flight;
  two.shape = "cpdi", two.solver = R"({"time_step": 0.1, "end_time": 10})";
  two.geometry = R"({"type": "union", "of": [{"type": "box", "lower": [1, 1], "upper": [2, 2]},
                                             {"type": "box", "lower": [5, 1], "upper": [6, 2]}]})";
  two.velocity = R"J([0, "max(min(1e9*(x-4),1),0)*5*(y-1.5)"])J";
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    const Failure found = failure_on(backend, two.text());
    CHECK(found.cause == Cause::domain_beyond_grid);
    CHECK(found.particle == 1);
  }
}

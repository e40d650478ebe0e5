// Where particles go when they are sorted, and what a chunk of them is told and counts, in scenes that ask for its details.

#include <chrono>
#include <set>

#include "backends/cpu/particles/unit_order.hpp"
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
void evaluate_empty_lists(const void* parameters, const mpm_list_batch* batch) {
  shape_overdone->evaluate_list[MPM_LANES_DOUBLE][0](parameters, batch);
  batch->node_count[0] = 0;
}

/// The shape cpdi2 whose lists another function makes.
struct ShapeOfOtherLists {
  explicit ShapeOfOtherLists(decltype(mpm_shape{}.evaluate_list[0][0]) evaluate)
      : plugin(*plugins().find(MPM_SHAPE, "cpdi2")), table(plugin.shape()), descriptor(*plugin.descriptor) {
    shape_overdone = &plugins().find(MPM_SHAPE, "cpdi2")->shape();
    table.evaluate_list[MPM_LANES_DOUBLE][0] = evaluate;
    descriptor.kind_table = &table;
    plugin.descriptor = &descriptor;
  }
  ShapeOfOtherLists(const ShapeOfOtherLists&) = delete;
  ShapeOfOtherLists& operator=(const ShapeOfOtherLists&) = delete;

  Plugin plugin;
  mpm_shape table;
  mpm_descriptor descriptor;
};

/// Keeps to the stencil one node below up to 0.501 cells, where its next node has no weight yet.
void evaluate_with_late_next_nodes(const void* parameters, const mpm_shape_batch* batch) {
  shape_overdone->evaluate[MPM_LANES_DOUBLE](parameters, batch);
  const std::size_t stride = batch->stride;
  for (std::size_t i = 0; i < batch->dimension * stride; ++i) {
    double& offset = static_cast<double*>(batch->offset)[i];
    if (i % stride >= batch->count || offset >= 0.501) continue;
    offset += 1;
    --batch->base[i];
    for (void* const values : {batch->weight, batch->gradient}) {
      if (!values) continue;
      double* const of_node = static_cast<double*>(values) + i / stride * 3 * stride + i % stride;
      of_node[2 * stride] = of_node[stride], of_node[stride] = of_node[0], of_node[0] = 0;
    }
  }
}

const mpm_transfer* transfer_asked = nullptr;
long batches_at_rest = 0, values_left_over = 0, fields_that_overlap = 0;

void look_at_particles_at_rest(const void* parameters, const mpm_gather_batch* batch) {
  const auto values_of = [&](const void* values, std::size_t components) {
    const double* const first = static_cast<const double*>(values);
    return std::count_if(first, first + components * batch->stride, [](double value) { return value != 0; });
  };
  if (values_of(batch->particle_velocity, 2) == 0) {
    ++batches_at_rest;
    values_left_over += values_of(batch->state[0], 4);
    fields_that_overlap +=
        static_cast<const double*>(batch->state[1]) - static_cast<const double*>(batch->state[0]) < 4 * batch->stride;
  }
  transfer_asked->gather[MPM_LANES_DOUBLE][0](parameters, batch);
}

const void* polynomials_of_degree_two(const char* id) {
  static const mpm_transfer_polynomials table{MPM_TRANSFER_POLYNOMIALS_VERSION, 0, [](const void*) { return 2; }};
  return id == std::string(MPM_TRANSFER_POLYNOMIALS_ID) ? &table : nullptr;
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

// Lists of nodes may be given from any block, but a particle far from its own would lose digits. One of two rests where they
// began, the other flies through a hundred blocks.
TEST_CASE("in float lists keep the digits of a particle that flies far", "[parity]") {
  SortedScene flight;
  flight.domain = "[[0, 0], [900, 16]]", flight.shape = "cpdi";
  flight.geometry = R"({"type": "union", "of": [{"type": "box", "lower": [1, 3], "upper": [2, 4]},
                                                {"type": "box", "lower": [6, 3], "upper": [7, 4]}]})";
  flight.seeding = R"(, "particles_per_cell_axis": 1)", flight.velocity = R"J(["x>4?0.9:0", "x>4?0.0001:0"])J";
  flight.solver = R"({"time_step": 1, "end_time": 900})";
  Scene scene(flight.text(), {"/backend=cpu", "/precision=float"});
  REQUIRE(scene.simulation.particle_count() == 2);
  while (!scene.simulation.finished()) scene.simulation.step();
  CHECK(difference({1.5, 3.5, 6.5 + 900 * 0.9, 3.5 + 900 * 0.0001}, scene.body().position, 1.0) <= 2e-3);
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
  const ShapeOfOtherLists overdoing(evaluate_too_long_lists);
  SortedScene flight;
  flight.shape = "cpdi2", flight.upper = "[31, 3]", flight.solver = R"({"time_step": 0.5, "end_time": 10})";
  for (const int threads : {1, 2}) {
    Experiment experiment = experiment_from(flight.text(), {"/backend=cpu", "/precision=double"});
    experiment.shape.plugin = &overdoing.plugin;
    Simulation simulation(experiment, [threads](const Experiment& e, const Plan& plan, std::vector<SeededBody> bodies) {
      return make_cpu_backend(e, plan, std::move(bodies), threads);
    });
    CHECK_THROWS_WITH(simulation.step(), "shape \"cpdi2\" gave a list of 17 nodes");
  }
}

// That is how a shape says that a domain is turned inside out (mpm_list_batch).
TEST_CASE("a list without nodes, of corners, ends the run as a domain that is inside out", "[parity][failure]") {
  const ShapeOfOtherLists empty(evaluate_empty_lists);
  SortedScene flight;
  flight.shape = "cpdi2", flight.solver = R"({"time_step": 0.5, "end_time": 10})";
  Experiment experiment = experiment_from(flight.text(), {"/backend=cpu", "/precision=double"});
  experiment.shape.plugin = &empty.plugin;
  Simulation simulation(experiment, backend_factory(1));
  try {
    simulation.step();
    FAIL("the run has not stopped");
  } catch (const RunFailure& stopped) {
    CHECK(stopped.failure.cause == Cause::domain_inside_out);
    CHECK(stopped.failure.particle == 0);
  }
}

// PolyPIC has degree one, or as many as there are nodes for; a transfer of one's own may have any (mpm_transfer_polynomials).
TEST_CASE("parity of polynomials of degree two on four nodes", "[parity]") {
  Mix mix;
  mix.shape = R"({"type": "bspline_cubic"})", mix.transfer = R"({"type": "polypic", "basis": "full"})";
  const Plugin& transfer = *plugins().find(MPM_TRANSFER, "polypic");
  mpm_descriptor descriptor = *transfer.descriptor;
  descriptor.extension = polynomials_of_degree_two;
  Plugin quadratic = transfer;
  quadratic.descriptor = &descriptor;
  std::vector<std::vector<BodyState>> ends;
  for (const std::string backend : {"reference", "cpu"}) {
    Experiment experiment = experiment_from(mix.text(), {set("/backend", backend), "/precision=double"});
    experiment.transfer.plugin = &quadratic;
    Simulation simulation(experiment, backend_factory(1));
    while (!simulation.finished()) simulation.step();
    ends.push_back({simulation.backend().body_state(0), simulation.backend().body_state(1)});
  }
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  for (std::size_t body = 0; body < 2; ++body) {
    CHECK(ends[0][body].transfer_state.at(polynomial_coefficients).size() == 6 * ends[0][body].velocity.size());
    CHECK(difference(ends[0][body].position, ends[1][body].position, 1.0) <= parity_tolerance.position * epsilon);
    CHECK(difference(ends[0][body].velocity, ends[1][body].velocity, 1.5) <= parity_tolerance.velocity * epsilon);
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
    CHECK((sum <= 1.01 * seconds));
    largest = larger(largest, sum / seconds);
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

TEST_CASE("parity of polynomials in 3-D", "[parity]") {
  Mix mix;
  mix.dimension = 3, mix.transfer = R"({"type": "polypic", "basis": "full"})";
  mix.overrides.emplace_back("/solver/end_time=0.036");
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

// Of 1400 blocks 220 become empty in each step, whose chunks are there to be taken again: two megabytes in the end. Nodes are
// between particles nearly as many to either side, so that these keep their velocities but for some parts in a million.
TEST_CASE("a bar that contracts frees chunks by the hundred", "[parity]") {
  SortedScene bar;
  bar.domain = "[[0, 0], [11300, 4]]", bar.lower = "[10, 1]", bar.upper = "[11210, 2]";
  bar.seeding = R"(, "particles_per_cell_axis": 1)", bar.velocity = R"J(["-0.16*(x-5610)", 0])J";
  bar.solver = R"({"time_step": 1, "end_time": 5})";
  Scene scene(bar.text(), {"/backend=cpu", "/precision=double"});
  const std::vector<double> start = scene.body().position;
  for (int step = 0; step < 5; ++step) scene.simulation.step();
  const std::vector<double> end = scene.body().position;
  double largest = 0;
  for (std::size_t i = 0; i < start.size(); i += 2)
    if (std::abs(start[i] - 5610) < 3000) largest = larger(largest, std::abs(end[i] - 5610 - 0.2 * (start[i] - 5610)));
  CHECK(largest <= 0.01);
}

// Fifteen cells lead two blocks on, along both axes at once. A particle alone in its chunk flies to each cell of a row of the
// next block: in none of them is it at home, whatever the cell's number.
TEST_CASE("particles fly two blocks on, and one alone to each cell of a row", "[parity]") {
  const auto check_flight = [](const SortedScene& flight, double x, double y) {
    INFO(flight.velocity);
    Scene scene(flight.text(), {"/backend=cpu", "/precision=double"});
    std::vector<double> expected = scene.body().position;
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += 2 * (i % 2 == 0 ? x : y);
    CHECK_NOTHROW(scene.run());
    CHECK(difference(expected, scene.body().position, 1.0) <= 1e-12);
  };
  SortedScene flight;
  flight.domain = "[[0, 0], [80, 80]]", flight.solver = R"({"time_step": 1, "end_time": 2})";
  for (const auto& [x, y] : {std::pair{-15.0, -15.0}, {15.0, 15.0}, {-15.0, 15.0}}) {
    flight.lower = "[36, 36]", flight.upper = "[40, 40]";
    flight.velocity = "[" + digits(x) + ", " + digits(y) + "]";
    check_flight(flight, x, y);
  }
  flight.seeding = R"(, "particles_per_cell_axis": 1)", flight.lower = "[36, 36]", flight.upper = "[37, 37]";
  for (int y = -12; y < -4; ++y) {
    flight.velocity = "[-12, " + std::to_string(y) + "]";
    check_flight(flight, -12, y);
  }
}

TEST_CASE("what grips give to a bar of many blocks is the same on any number of threads", "[parity]") {
  SortedScene bar;
  bar.domain = "[[0, 0], [400, 24]]", bar.lower = "[10, 3]", bar.upper = "[365, 10]";
  bar.seeding = R"(, "particles_per_cell_axis": 1)", bar.solver = R"({"time_step": 1, "end_time": 100})";
  bar.more = R"J(, "grips": [{"body": "b", "where": {"type": "half_space", "point": [0, 20], "normal": [0, 1]},
    "velocity": ["0.1+0.0001*Y*X", "sin(X)*0.01*t"]}])J";
  std::vector<std::vector<double>> given;
  for (const int threads : {1, 2}) {
    CpuRun run(bar.text(), {"/precision=double", R"(/output={"reactions": true})"}, threads);
    std::vector<double>& all = given.emplace_back();
    for (int step = 0; step < 16; ++step) {
      run.steps(1);
      for (const Reaction& reaction : run.simulation.backend().reactions())
        all.insert(all.end(), reaction.impulse.begin(), reaction.impulse.end());
    }
  }
  CHECK(different(given[0], given[1]) == 0);
}

// Stencils of this shape begin at the next node from 0.501 cells on, which is found at 17/32. After 20 steps the particle is
// 0.979 cells above the latter, and 1.009 cells above the former: beyond its tile.
TEST_CASE("particles that go up are sorted before they leave their tile, however little of it is left", "[parity]") {
  const Plugin& shape = *plugins().find(MPM_SHAPE, "gimp");
  shape_overdone = &shape.shape();
  mpm_shape table = *shape_overdone;
  table.evaluate[MPM_LANES_DOUBLE] = evaluate_with_late_next_nodes;
  mpm_descriptor descriptor = *shape.descriptor;
  descriptor.kind_table = &table;
  Plugin late = shape;
  late.descriptor = &descriptor;
  for (const bool along_x : {true, false}) {
    SortedScene up;
    up.domain = "[[0, 0], [24, 24]]", up.shape = "gimp", up.seeding = R"(, "particles_per_cell_axis": 6)";
    up.lower = along_x ? "[8.35, 3]" : "[3, 8.35]", up.upper = along_x ? "[8.45, 3.1]" : "[3.1, 8.45]";
    up.velocity = along_x ? "[0.0546667, 0]" : "[0, 0.0546667]";
    up.solver = R"({"time_step": 1, "end_time": 1000, "stress_update": "first"})";
    Experiment experiment = experiment_from(up.text(), {"/backend=cpu", "/precision=double"});
    experiment.shape.plugin = &late;
    Simulation simulation(experiment, backend_factory(1));
    CHECK_NOTHROW([&] {
      for (int step = 0; step < 30; ++step) simulation.step();
    }());
  }
}

// A filter projects a velocity of the grid by the transfer itself, which must not see what the particles hold: what they keep
// is none of its business, each field in a place of its own.
TEST_CASE("a filter asks the transfer for particles at rest, with nothing in their state", "[parity]") {
  const Plugin& transfer = *plugins().find(MPM_TRANSFER, "polypic");
  transfer_asked = &transfer.transfer();
  mpm_transfer table = *transfer_asked;
  table.gather[MPM_LANES_DOUBLE][0] = look_at_particles_at_rest;
  mpm_descriptor descriptor = *transfer.descriptor;
  descriptor.kind_table = &table;
  Plugin looking = transfer;
  looking.descriptor = &descriptor;
  Mix mix;
  mix.transfer = R"({"type": "polypic", "basis": "full"})", mix.filter = R"({"type": "fmpm", "order": 2})";
  Experiment experiment = experiment_from(mix.text(), {"/backend=cpu", "/precision=double"});
  experiment.transfer.plugin = &looking;
  Simulation simulation(experiment, backend_factory(1));
  batches_at_rest = values_left_over = fields_that_overlap = 0;
  for (int step = 0; step < 3; ++step) simulation.step();
  CHECK(batches_at_rest > 0);
  CHECK(values_left_over == 0);
  CHECK(fields_that_overlap == 0);
}

// The system may give a run fewer threads than the body was shared out to, at times the caller's alone.
TEST_CASE("a thread alone takes the units of all others too", "[parity]") {
  struct OneBlock {
    cpu::BlockCoordinates at{};
    std::uint32_t count = 1;
  };
  std::vector<OneBlock> blocks(20);
  cpu::ColouredUnits<2> units;
  for (std::uint32_t b = 0; b < blocks.size(); ++b) {
    blocks[b].at = {2 * static_cast<int>(b), 0, 0};
    units[b % 2].push_back({b, b + 1});
  }
  for (const int parts : {1, 2, 3, 5, 7}) {
    const cpu::UnitOrder order = cpu::ordered_units<2>(units, blocks, parts);
    std::vector<std::atomic<int>> states;
    for (int thread = 0; thread < parts; ++thread) {
      INFO("thread " << thread << " of " << parts);
      std::set<std::uint32_t> visited;
      cpu::UnitPass pass(order, states);
      pass.run(thread, [&](const cpu::Unit& unit) { visited.insert(unit.first); });
      CHECK(visited.size() == blocks.size());
    }
  }
}

// What few scenes come to in the cpu backend: blocks at corners of periodic domains, nodes beyond all blocks,
// records of three bodies, books of the ledger, and how fast a step may be that nobody looks at.

#include "parity/parity.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

struct GridScene {
  std::string bodies, more, boundaries = R"({"all": "free"})", domain = "[[0, 0], [1, 1]]", shape = "bspline_quadratic",
                            transfer = "apic", time_step = "0.005", modulus = "1000";

  std::string text() const {
    return R"({"title": "grid", "dimension": 2, "grid": {"cell_size": 0.1, "domain": )" + domain +
           R"(, "boundaries": )" + boundaries + R"(}, "shape": {"type": ")" + shape + R"("}, "transfer": {"type": ")" +
           transfer + R"("}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": )" + modulus +
           R"(, "poisson_ratio": 0.3, "density": 1000}}, "bodies": [)" + bodies + "]" + more +
           R"(, "solver": {"time_step": )" + time_step + R"(, "end_time": 10}})";
  }
};

/// A body of boxes, each given as its lower and upper corner.
std::string body_of(const std::string& name, const std::vector<std::string>& boxes, const std::string& velocity) {
  std::string geometry;
  for (const std::string& box : boxes) geometry += (geometry.empty() ? "" : ", ") + (R"({"type": "box", )" + box + "}");
  return R"({"name": ")" + name + R"(", "material": "m", "geometry": {"type": "union", "of": [)" + geometry +
         R"(]}, "velocity": )" + velocity + "}";
}
std::string box_of(const std::string& lower, const std::string& upper) {
  return R"("lower": )" + lower + R"(, "upper": )" + upper;
}

/// A scene on both backends, which run step by step.
struct BothBackends {
  Scene reference, cpu;

  explicit BothBackends(const std::string& text)
      : reference(text, {"/backend=reference", "/precision=double"}),
        cpu(text, {"/backend=cpu", "/precision=double"}) {}
  void steps(long count) { reference.run_steps(count), cpu.run_steps(count); }
  void check_alike() const {
    for (int body = 0; body < static_cast<int>(reference.experiment.bodies.size()); ++body) {
      const BodyState expected = reference.body(body);
      BodyState found = cpu.body(body);
      wrap_onto(reference.experiment, expected.position, found.position);
      INFO("body " << body);
      CHECK(difference(expected.position, found.position, 1) < 1e-11);
      CHECK(difference(expected.velocity, found.velocity, 1) < 1e-9);
    }
  }
};

void check_vectors(const Vector3& expected, const Vector3& found, double size) {
  for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(expected[c] - found[c]) <= 1e-8 * size);
}

void check_reactions(const BothBackends& both) {
  const std::vector<Reaction>&expected = both.reference.simulation.backend().reactions(),
        &found = both.cpu.simulation.backend().reactions();
  REQUIRE(expected.size() == found.size());
  double size = 0;
  for (const Reaction& reaction : expected)
    for (const double force : reaction.force) size = std::max(size, std::abs(force));
  CHECK(size > 0);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    check_vectors(expected[k].force, found[k].force, size);
    check_vectors(expected[k].moment, found[k].moment, size);
    check_vectors(expected[k].impulse, found[k].impulse, size);
  }
}

const std::string three_bodies = body_of("a", {box_of("[0.2, 0.2]", "[0.5, 0.5]")}, "[1, 0.1]") + ", " +
                                 body_of("b", {box_of("[0.5, 0.2]", "[0.8, 0.5]")}, "[-1, 0.2]") + ", " +
                                 body_of("c", {box_of("[0.35, 0.5]", "[0.7, 0.8]")}, "[0.3, -2]");

/// Whether a body knows its velocities after each of so many steps, of which every ninth is looked at.
std::vector<bool> knows_velocities(const std::string& text, long steps, long observed,
                                   const std::string& passes = "fused") {
  CpuRun run(text, {set("/solver/passes", passes)}, 1);
  run.simulation.observe_when([=](double, long step) { return step % observed == 0; });
  std::vector<bool> known;
  for (long step = 0; step < steps; ++step) {
    run.simulation.step();
    const BodyState state = run.simulation.backend().body_state(0);
    CHECK_FALSE(state.material_state.empty());
    known.push_back(!state.velocity.empty());
    if (run.simulation.observed()) CHECK(known.back());
  }
  return known;
}

}  // namespace

TEST_CASE("parity of three bodies under a law that reads the traction", "[parity]") {
  GridScene scene;
  scene.bodies = three_bodies;
  scene.more = R"(, "contact": {"type": "adhesion", "normal_strength": 300, "shear_strength": 200, "friction": 0.2})";
  BothBackends both(scene.text());
  both.steps(6), both.check_alike();
}

TEST_CASE("pairs of bodies and nodes in contact are recorded alike", "[parity]") {
  GridScene scene;
  scene.bodies = three_bodies;
  scene.more = R"(, "contact": {"type": "coulomb", "friction": 0.3},
    "output": {"bodies": true, "contact_pairs": true, "contact_nodes": true, "frames": 2})";
  BothBackends both(scene.text());
  both.steps(2), both.check_alike();
  const Backend &reference = both.reference.simulation.backend(), &cpu = both.cpu.simulation.backend();
  REQUIRE(reference.contact_pairs().size() == 3);
  REQUIRE(cpu.contact_pairs().size() == 3);
  double size = 0;
  for (const PairRecord& pair : reference.contact_pairs()) size = std::max(size, std::abs(pair.normal_force));
  CHECK(size > 0);
  for (std::size_t k = 0; k < 3; ++k) {
    const PairRecord &expected = reference.contact_pairs()[k], &found = cpu.contact_pairs()[k];
    INFO("pair " << k);
    CHECK(expected.nodes > 0);
    CHECK(found.nodes == expected.nodes);
    CHECK(found.sticking == expected.sticking);
    CHECK(found.slipping == expected.slipping);
    CHECK(found.area == Approx(expected.area).epsilon(1e-9));
    CHECK(found.largest_penetration == Approx(expected.largest_penetration).epsilon(1e-9));
    CHECK(std::abs(found.normal_force - expected.normal_force) <= 1e-8 * size);
    check_vectors(expected.force, found.force, size);
    check_vectors(expected.tangential_force, found.tangential_force, size);
  }
  std::map<std::array<int, 4>, ContactNode> nodes;
  for (const ContactNode& node : cpu.contact_nodes()) nodes[{node.node[0], node.node[1], node.a, node.b}] = node;
  CHECK(nodes.size() == reference.contact_nodes().size());
  for (const ContactNode& expected : reference.contact_nodes()) {
    const auto at = nodes.find({expected.node[0], expected.node[1], expected.a, expected.b});
    REQUIRE(at != nodes.end());
    const ContactNode& found = at->second;
    CHECK(found.status == expected.status);
    CHECK(std::abs(found.separation - expected.separation) < 1e-9);
    CHECK(std::abs(found.area - expected.area) < 1e-9);
    check_vectors(expected.normal, found.normal, 1);
    check_vectors(expected.force, found.force, size);
  }
}

// One body lies at three corners of the domain, so that blocks beyond its edges are there before the other body's are; only
// an image of an image says that the other comes to the nodes at the corner.
TEST_CASE("parity of bodies that meet across the corner of a periodic domain", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [3.2, 3.2]]", scene.boundaries = R"({"all": "periodic"})";
  scene.bodies =
      body_of("a", {box_of("[0, 0]", "[0.2, 0.2]"), box_of("[0, 3]", "[0.2, 3.2]"), box_of("[3, 0]", "[3.2, 0.2]")},
              "[-0.5, -0.4]") +
      ", " + body_of("b", {box_of("[3, 3]", "[3.2, 3.2]")}, "[1, 1.2]");
  scene.more = R"(, "contact": {"type": "stick"})";
  BothBackends both(scene.text());
  both.steps(6), both.check_alike();
}

// The second body lies in the first block of the grid. Where no block is, no node may be taken for one of its own.
TEST_CASE("parity of rigid bodies that reach beyond all blocks of the grid", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [4, 4]]";
  scene.bodies = body_of("a", {box_of("[2.5, 2.5]", "[2.9, 2.9]")}, "[0, 0]") + ", " +
                 body_of("b", {box_of("[1.5, 1.5]", "[1.9, 2.7]")}, "[0, 0]");
  scene.more = R"(, "rigid_bodies": [{"name": "lid", "velocity": [0, -3], "contact": {"type": "stick"},
    "geometry": {"type": "half_space", "point": [0, 3.6], "normal": [0, -1]}}])";
  BothBackends both(scene.text());
  both.steps(3), both.check_alike();
}

// In a corner the weight of what lies beyond the first wall stays where it was: it decides which nodes leave the second one.
TEST_CASE("parity of separating walls whose nodes all but rest beside their weight", "[parity]") {
  for (const std::string gravity : {"[-1.3, -1.3]", "[-4, -1.3]"})
    for (const double share : {0.99, 0.993}) {
      GridScene scene;
      scene.boundaries = R"({"all": "separate"})";
      scene.bodies = body_of("a", {box_of("[0, 0]", "[0.4, 0.4]")}, "[-0.01, " + digits(share * 0.005 * 1.3) + "]");
      scene.more = R"(, "gravity": )" + gravity;
      INFO(gravity << " " << share);
      BothBackends both(scene.text());
      both.steps(3), both.check_alike();
    }
  GridScene pressed;
  pressed.boundaries = R"({"all": "separate"})";
  pressed.bodies = body_of("a", {box_of("[0, 0]", "[0.4, 0.4]")}, "[0.3, 0.01]");
  pressed.more = R"(, "body_force": [0, -4])";
  BothBackends both(pressed.text());
  both.steps(3), both.check_alike();
}

TEST_CASE("a box holds the last node of a block and the first that rounding alone puts beside its edges", "[parity]") {
  const auto velocity = [](double lower, double upper) {
    GridScene scene;
    scene.domain = "[[0, 0], [3, 3]]";
    scene.bodies = body_of("a", {box_of("[2.1, 2.1]", "[2.6, 2.6]")}, "[1, 1]");
    scene.more = R"(, "node_conditions": [{"type": "stick", "lower": [)" + digits(lower) + ", " + digits(lower) +
                 R"(], "upper": [)" + digits(upper) + ", " + digits(upper) + "]}]";
    Scene run(scene.text(), {"/backend=cpu", "/precision=double"});
    run.run_steps(2);
    return run.body().velocity;
  };
  const double inwards = 0.9e-10, beyond = 1.1e-10;
  CHECK(velocity(2.3 + inwards, 2.35) == velocity(2.299, 2.35));
  CHECK(velocity(2.3 + beyond, 2.35) != velocity(2.299, 2.35));
  CHECK(velocity(2.35, 2.4 - inwards) == velocity(2.35, 2.401));
  CHECK(velocity(2.35, 2.4 - beyond) != velocity(2.35, 2.401));
}

// The first block holds 63 particles, one less than a chunk, and the second more than one chunk.
TEST_CASE("a block that is all but full is restored beside the next one", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [2, 2]]";
  scene.bodies = body_of("a", {box_of("[0.1, 0.4]", "[0.45, 1.6]")}, "[\"0.1*y\", \"0.2*x\"]");
  CpuRun run(scene.text(), {}, 1), resumed(scene.text(), {}, 1);
  run.steps(1);
  ArchiveWriter archive;
  run.simulation.save(archive);
  ArchiveReader reader(archive.bytes());
  resumed.simulation.restore(reader);
  CHECK(different(all_results(run.simulation), all_results(resumed.simulation)) == 0);
  run.steps(3), resumed.steps(3);
  CHECK(different(all_results(run.simulation), all_results(resumed.simulation)) == 0);
}

// The nodes of a thin body are the last of its blocks along x.
TEST_CASE("a thin body that flies more than a cell a step keeps its velocities in each", "[parity]") {
  for (const auto& [ledger, speed] : {std::pair{"true", "12"}, {"false", "12"}, {"false", "-12"}}) {
    GridScene scene;
    scene.domain = "[[0, 0], [2, 6]]", scene.time_step = "0.01", scene.modulus = "1e-9";
    scene.bodies = body_of("rests", {box_of("[0.5, 0.5]", "[0.6, 0.6]")}, "[0, 0]") + ", " +
                   body_of("flies", {box_of("[1.35, 2.8]", "[1.45, 3.2]")}, std::string("[0, ") + speed + "]");
    scene.more = std::string(R"(, "output": {"ledger": )") + ledger + "}";
    const std::vector<bool> known = knows_velocities(scene.text(), 20, 9);
    CHECK(std::count(known.begin(), known.end(), true) == 20);
  }
}

TEST_CASE("a body in a box that moves two cells a step keeps its velocities", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [4, 1]]", scene.time_step = "0.01", scene.modulus = "1e-9";
  scene.bodies = body_of("a", {box_of("[0.5, 0.3]", "[0.9, 0.6]")}, "[0, 0]");
  scene.more = R"(, "output": {"ledger": false}, "node_conditions": [{"type": "prescribed", "velocity": [20, 0],
    "lower": [0.2, 0], "upper": [1.2, 0.4]}])";
  CHECK(knows_velocities(scene.text(), 1, 9).front());
}

// The table of blocks begins with room for 64, and grows.
TEST_CASE("parity of a body over more than a hundred blocks", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [32, 1]]";
  scene.bodies = body_of("a", {box_of("[0.2, 0.4]", "[31.8, 0.5]")}, "[\"0.1*sin(x)\", -1]");
  scene.more = R"(, "rigid_bodies": [{"name": "floor", "velocity": [0, 1], "contact": {"type": "stick"},
    "geometry": {"type": "half_space", "point": [0, 0.38], "normal": [0, 1]}}])";
  BothBackends both(scene.text());
  both.steps(2), both.check_alike();
  const std::uint64_t nodes = both.cpu.simulation.backend().grid_bytes() / (4 * sizeof(double));
  CHECK(nodes > 100 * 64);
  CHECK(nodes < 100 * 100 * 64);
}

TEST_CASE("a body beside a wall that moves two cells a step keeps its velocities", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [4, 1]]", scene.time_step = "0.01", scene.modulus = "1e-9";
  scene.boundaries = R"({"all": "free", "y_min": {"type": "prescribed", "velocity": [20, 0]}})";
  scene.bodies = body_of("a", {box_of("[0.5, 0]", "[0.9, 0.3]")}, "[0, 0]");
  scene.more = R"(, "output": {"ledger": false})";
  CHECK(knows_velocities(scene.text(), 1, 9).front());
}

TEST_CASE("a slow body knows its velocities after the steps that are looked at", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [4, 4]]", scene.time_step = "0.01", scene.modulus = "1e-9";
  scene.bodies = body_of("a", {box_of("[1.5, 1.5]", "[2, 2]")}, "[1, 0.3]");
  const std::vector<bool> known = knows_velocities(scene.text(), 30, 9), all = knows_velocities(scene.text(), 30, 1);
  CHECK(std::count(known.begin(), known.end(), true) < 15);
  CHECK(std::count(all.begin(), all.end(), true) == 30);
  const std::vector<bool> separate = knows_velocities(scene.text(), 30, 9, "separate");
  CHECK(std::count(separate.begin(), separate.end(), true) == 30);
}

// A domain grows beyond the blocks around its own while its particle stays where it is, so that nothing is sorted.
TEST_CASE("parity of a list that grows over blocks while its particle rests", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [8, 1]]", scene.shape = "cpdi", scene.time_step = "0.01", scene.modulus = "1e-9";
  for (const double left : {4.0, 4.1}) {
    scene.bodies = body_of("a", {box_of("[" + digits(left) + ", 0.4]", "[" + digits(left + 0.1) + ", 0.5]")},
                           "[\"30*(x-" + digits(left + 0.05) + ")\", \"0.1*y\"]");
    scene.bodies.insert(scene.bodies.size() - 1, R"(, "particles_per_cell_axis": 1)");
    INFO(left);
    BothBackends both(scene.text());
    both.steps(14), both.check_alike();
  }
}

TEST_CASE("parity of a material that softens as it warms", "[parity]") {
  GridScene scene;
  scene.bodies = body_of("a", {box_of("[0.3, 0.3]", "[0.6, 0.6]")}, "[\"9*(y-0.4)\", \"4*(x-0.4)\"]");
  std::string text = scene.text();
  const std::string heat = R"("thermal": {"conductivity": 1, "heat_capacity": 10}, )", warm = R"("temperature": 400, )";
  const std::string plain = R"("type": "neo_hookean", )";
  text.replace(text.find(plain), plain.size(),
               R"("type": "johnson_cook", "yield_stress": 20, "hardening_coefficient": 50, "hardening_exponent": 0.3,
    "rate_coefficient": 0.01, "melting_temperature": 450, "room_temperature": 250, )" +
                   heat);
  const std::string first = R"("name": "a", )";
  text.replace(text.find(first), first.size(), first + warm);
  BothBackends both(text);
  both.steps(6), both.check_alike();
  text.replace(text.find(heat), heat.size(), ""), text.replace(text.find(warm), warm.size(), "");
  BothBackends cold(text);
  cold.steps(3), cold.check_alike();
}

TEST_CASE("parity of a grip far from all walls", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [6, 6]]", scene.transfer = "flip";
  scene.bodies = body_of("a", {box_of("[2.8, 2.8]", "[3.2, 3.2]")}, "[0.4, 0.1]");
  scene.more = R"(, "grips": [{"body": "a", "velocity": [-1, "0.3*t"],
    "where": {"type": "half_space", "point": [3, 0], "normal": [1, 0]}}])";
  BothBackends both(scene.text());
  both.steps(5), both.check_alike();
  const std::vector<double> expected = ledger_values(both.reference), found = ledger_values(both.cpu);
  CHECK(ledger_difference(expected, found, 1e-3) < 1e-9);
}

TEST_CASE("parity of a box of nodes far from all walls", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [6, 6]]", scene.transfer = "flip";
  scene.bodies = body_of("a", {box_of("[2.8, 2.8]", "[3.2, 3.2]")}, "[0.4, 0.1]");
  scene.more = R"(, "output": {"reactions": true}, "node_conditions": [{"type": "prescribed",
    "velocity": [-1, "0.3*t"], "lower": [3, 2.7], "upper": [3.3, 3.3]}])";
  BothBackends both(scene.text());
  both.steps(5), both.check_alike();
  const std::vector<double> expected = ledger_values(both.reference), found = ledger_values(both.cpu);
  CHECK(ledger_difference(expected, found, 1e-3) < 1e-9);
  check_reactions(both);
}

TEST_CASE("the books of the cpu backend agree in every order and with a filter", "[parity][ledger]") {
  for (const std::string order : {"last", "first", "averaged"})
    for (const std::string filter : {"", R"({"type": "fmpm", "order": 2})"}) {
      Mix mix;
      mix.stress_update = order, mix.filter = filter, mix.close = true;
      mix.contact = R"({"type": "coulomb", "friction": 0.2})";
      mix.material =
          R"({"type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 20})";
      INFO(mix.name());
      Scene scene(mix.text(), {"/backend=cpu", "/precision=double"});
      const Totals start = scene.metrics.initial();
      scene.run_steps(8);
      const Ledger& ledger = scene.simulation.backend().ledger();
      CHECK(std::abs(ledger.mass_book) <= 1e-12 * start.mass);
      CHECK(std::abs(ledger.momentum_book) <= 1e-12 * start.mass * 1.5);
      CHECK(std::abs(ledger.grid_book) <= 1e-12 * start.kinetic);
      CHECK(std::abs(ledger.filter_book) <= 1e-12 * start.kinetic);
      CHECK(std::abs(ledger.stored) > 1e-4 * start.kinetic);
      CHECK(std::abs(ledger.material_book) > 1e-9 * start.kinetic);
      CHECK(ledger.material_book ==
            Approx(ledger.stress_power - ledger.stored - ledger.material).margin(1e-12 * start.kinetic));
    }
}

TEST_CASE("reactions of walls are alike with gravity and a filter", "[parity]") {
  for (const std::string filter : {"", R"({"type": "fmpm", "order": 4})"})
    for (const std::string order : {"last", "first"}) {
      Mix mix;
      mix.shape = R"({"type": "bspline_cubic"})", mix.stress_update = order, mix.filter = filter, mix.close = true;
      mix.more = R"(, "output": {"reactions": true})";
      INFO(mix.name());
      BothBackends both(mix.text());
      both.steps(4), both.check_alike(), check_reactions(both);
      const double growth = both.reference.simulation.backend().filter_record().largest_growth;
      CHECK(both.cpu.simulation.backend().filter_record().largest_growth == Approx(growth).epsilon(1e-9));
    }
}

// Stretched domains give mass to nodes two cells beyond the wall.
TEST_CASE("reactions of walls to wide particles are alike", "[parity]") {
  GridScene scene;
  scene.shape = "cpdi", scene.modulus = "1", scene.boundaries = R"({"all": "slip"})";
  scene.bodies = body_of("a", {box_of("[0, 0.4]", "[0.1, 0.6]")}, "[-1, \"0.5+8*x\"]");
  scene.bodies.insert(scene.bodies.size() - 1, R"(, "initial_deformation_gradient": {"xx": 7})");
  scene.more = R"(, "output": {"reactions": true})";
  BothBackends both(scene.text());
  both.steps(1), both.check_alike(), check_reactions(both);
}

// Faces pair all nodes of a block that is in use, whether or not particles come to them, with their images, whose blocks
// must be there: beyond a periodic face of a domain that is no whole number of blocks, and of lists in 3-D, beyond a wall.
TEST_CASE("parity of images in blocks that hold no particles", "[parity]") {
  for (const char* scene :
       {R"J({"title": "periodic", "dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [3.7, 1]], "boundaries":
           {"all": "free", "x_min": "periodic", "x_max": "periodic"}}, "shape": {"type": "bspline_quadratic"},
           "transfer": {"type": "apic"}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000,
           "poisson_ratio": 0.3, "density": 1000}}, "bodies": [{"name": "a", "material": "m", "geometry":
           {"type": "box", "lower": [2.6, 0.4], "upper": [3, 0.6]}, "velocity": ["0.1-x", 0]}],
           "solver": {"time_step": 0.005, "end_time": 1}})J",
        R"J({"title": "wall", "dimension": 3, "grid": {"cell_size": 1, "domain": [[0, 0, 0], [9, 8, 8]], "boundaries":
           {"all": "free", "x_max": "slip"}}, "shape": {"type": "cpdi"}, "transfer": {"type": "apic"}, "materials":
           {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0, "density": 1}}, "bodies":
           [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": [8.5, 3, 3], "upper": [9, 5, 5]},
           "velocity": [0, "0.1*x", 0]}], "solver": {"time_step": 0.1, "end_time": 1}})J"}) {
    BothBackends both(scene);
    both.steps(4);
    both.check_alike();
  }
}

// The list of a long particle that has crossed a periodic face counts from the block that it was sorted into, as many nodes
// beyond the grid's own padding as it has moved.
TEST_CASE("parity of a long list whose particle has crossed a periodic face since it was sorted", "[parity]") {
  for (const bool down : {true, false}) {
    const std::string cells = down ? "40" : "39", lower = down ? "[0, 4]" : "[38, 4]",
                      upper = down ? "[1, 5]" : "[39, 5]";
    BothBackends both(
        R"({"title": "long", "dimension": 2, "grid": {"cell_size": 1, "domain": [[0, 0], [)" + cells +
        R"(, 8]], "boundaries": {"all": "free", "x_min": "periodic", "x_max": "periodic"}},
        "shape": {"type": "cpdi"}, "transfer": {"type": "apic"}, "materials": {"m": {"type": "neo_hookean",
        "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}}, "bodies": [{"name": "a", "material": "m",
        "geometry": {"type": "box", "lower": )" +
        lower + R"(, "upper": )" + upper +
        R"(}, "particles_per_cell_axis": 1, "initial_deformation_gradient": {"xx": 15.8}, "velocity": [)" +
        (down ? "-0.25" : "0.25") + R"(, 0]}], "solver": {"time_step": 1, "end_time": 9}})");
    both.steps(6);
    both.check_alike();
  }
}

// The one particle's nodes are the corners of a diamond, of which the first alone lies below its block.
TEST_CASE("parity of a list whose first node lies lowest", "[parity]") {
  BothBackends both(R"J({"title": "diamond", "dimension": 2, "grid": {"cell_size": 1, "domain": [[0, 0], [24, 24]],
      "boundaries": {"all": "free"}}, "shape": {"type": "cpdi"}, "transfer": {"type": "apic"}, "materials":
      {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}}, "bodies":
      [{"name": "a", "material": "m", "seeding": "fitted", "geometry": {"type": "box", "lower": [8.5, 8.5],
      "upper": [9.5, 9.5]}, "particles_per_cell_axis": 1, "initial_deformation_gradient":
      {"xx": 2, "xy": -2, "yx": 2, "yy": 2}, "velocity": [0.01, 0.02]}], "solver": {"time_step": 1, "end_time": 9}})J");
  both.steps(3);
  both.check_alike();
  CHECK(std::abs(both.cpu.simulation.ledger().mass_book) < 1e-14);
}

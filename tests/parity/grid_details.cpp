// What few scenes come to in the cpu backend: blocks at corners of periodic domains, nodes beyond all blocks, blocks all of
// whose nodes meet, walls that let go in a step, records of three bodies, books of the ledger, and how fast a step may be
// that nobody looks at.

#include "parity/parity.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

struct GridScene {
  std::string bodies, more, boundaries = R"({"all": "free"})", domain = "[[0, 0], [1, 1]]", shape = "bspline_quadratic",
                            transfer = "apic", time_step = "0.005", modulus = "1000", order = "last";

  std::string text() const {
    return R"({"title": "grid", "dimension": 2, "grid": {"cell_size": 0.1, "domain": )" + domain +
           R"(, "boundaries": )" + boundaries + R"(}, "shape": {"type": ")" + shape + R"("}, "transfer": {"type": ")" +
           transfer + R"("}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": )" + modulus +
           R"(, "poisson_ratio": 0.3, "density": 1000}}, "bodies": [)" + bodies + "]" + more +
           R"(, "solver": {"time_step": )" + time_step + R"(, "end_time": 10, "stress_update": ")" + order + R"("}})";
  }
};

/// A body of boxes, each given as its lower and upper corner.
std::string body_of(const std::string& name, const std::vector<std::string>& boxes, const std::string& velocity) {
  std::string geometry;
  for (const std::string& box : boxes) geometry += (geometry.empty() ? "" : ", ") + (R"({"type": "box", )" + box + "}");
  return R"({"name": ")" + name + R"(", "material": "m", "geometry": {"type": "union", "of": [)" + geometry +
         R"(]}, "velocity": )" + velocity + "}";
}
/// Bodies whose particles lie off the lattice, so that no gap or approach is zero but for rounding.
std::string jittered(std::string bodies) {
  for (std::size_t at = 0; (at = bodies.find(R"("material")", at)) != bodies.npos; at += 20)
    bodies.insert(at, R"("jitter": 0.2, )");
  return bodies;
}
std::string box_of(const std::string& lower, const std::string& upper) {
  return R"("lower": )" + lower + R"(, "upper": )" + upper;
}

/// A text with a material that conducts heat and a first body of a temperature.
std::string warmed(std::string text) {
  const std::string material = R"("density": 1000)", body = R"("name": "a", )";
  text.replace(text.find(material), material.size(),
               material + R"(, "thermal": {"conductivity": 500, "heat_capacity": 10})");
  text.replace(text.find(body), body.size(), body + R"("temperature": "300+400*x-200*y", )");
  return text;
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
      if (reference.experiment.has_temperature())
        CHECK(difference(expected.host_state.at("temperature"), found.host_state.at("temperature"), 300) < 1e-9);
    }
  }
  void check_ledgers() const {
    CHECK(ledger_difference(ledger_values(reference), ledger_values(cpu), 1e-3) < 1e-9);
    CHECK(difference(heat_ledger_values(reference), heat_ledger_values(cpu), 1) < 1e-6);
  }
  /// How many nodes stick and slip, and the deepest penetration, of the last step.
  void check_contact_records() const {
    const ContactRecord &expected = reference.simulation.backend().contact_record(),
                        &found = cpu.simulation.backend().contact_record();
    CHECK(expected.nodes > 0);
    CHECK(found.nodes == expected.nodes);
    CHECK(found.sticking == expected.sticking);
    CHECK(found.slipping == expected.slipping);
    CHECK(found.largest_penetration == Approx(expected.largest_penetration).epsilon(1e-9));
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
    for (const double force : reaction.force) size = larger(size, std::abs(force));
  CHECK(size > 0);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    check_vectors(expected[k].force, found[k].force, size);
    check_vectors(expected[k].moment, found[k].moment, size);
    check_vectors(expected[k].impulse, found[k].impulse, size);
  }
}

/// Runs a plastic collision and checks the books of the ledger.
void check_books(const std::string& backend, const std::string& order, const std::string& filter) {
  Mix mix;
  mix.stress_update = order, mix.filter = filter, mix.close = true;
  mix.contact = R"({"type": "coulomb", "friction": 0.2})";
  mix.material =
      R"({"type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 20})";
  INFO(mix.name());
  Scene scene(mix.text(), {set("/backend", backend), "/precision=double"});
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

const std::string given_normal = R"({"type": "given", "x": 0.6, "y": 0.8})";

const std::string three_bodies = jittered(body_of("a", {box_of("[0.2, 0.2]", "[0.5, 0.5]")}, "[1, 0.1]") + ", " +
                                          body_of("b", {box_of("[0.5, 0.2]", "[0.8, 0.5]")}, "[-1, 0.2]") + ", " +
                                          body_of("c", {box_of("[0.35, 0.5]", "[0.7, 0.8]")}, "[0.3, -2]"));

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
  for (const PairRecord& pair : reference.contact_pairs()) size = larger(size, std::abs(pair.normal_force));
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
    CHECK(found.largest_gap == Approx(expected.largest_gap).epsilon(1e-9).margin(1e-12));
    const double pressed = size * both.reference.simulation.time();
    CHECK(std::abs(found.normal_impulse - expected.normal_impulse) <= 1e-8 * pressed);
    check_vectors(expected.impulse, found.impulse, pressed);
    check_vectors(expected.tangential_impulse, found.tangential_impulse, pressed);
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
    for (const std::string filter : {"", R"({"type": "fmpm", "order": 2})"}) check_books("cpu", order, filter);
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

// ---- contact -------------------------------------------------------------------------------------------------------

// A weld looks at all nodes where both bodies have mass, at the last of which it is told of copies to fill a lane. The
// second body has no mass at the four nodes of one corner of the block of nodes from 8 to 15.
TEST_CASE("parity of sixty nodes of a block in which two bodies lie in one another", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [2.4, 2.4]]";
  const std::string corner =
      body_of("b", {box_of("[0.5, 1.1]", "[1.8, 1.8]"), box_of("[1.1, 0.5]", "[1.8, 1.1]")}, R"(["-0.4*y", "0.8+x"])");
  scene.bodies = body_of("a", {box_of("[0.5, 0.5]", "[1.8, 1.8]")}, R"(["0.3+x", "0.7*y"])") + ", " + corner;
  scene.bodies = jittered(scene.bodies);
  const std::string glue = R"({"type": "breakable_glue", "tension_stiffness": 1e4, "compression_stiffness": 1e4,
      "shear_stiffness": 1e4, "normal_strength": 60, "shear_strength": 90, "reach": 1, "normal": )";
  for (const std::string& contact :
       {std::string(R"({"type": "stick"})"), R"({"type": "coulomb", "friction": 0.2, "normal": )" + given_normal + "}",
        glue + given_normal + "}", std::string(R"({"type": "adhesion", "normal_strength": 300, "shear_strength": 200,
      "normal": )") + given_normal + "}"}) {
    INFO(contact);
    scene.more = R"(, "contact": )" + contact;
    BothBackends both(scene.text());
    both.steps(4), both.check_alike();
  }
}

TEST_CASE("parity of a filter on sixty nodes of a block", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [2.4, 2.4]]";
  scene.bodies = body_of("a", {box_of("[0.5, 1.1]", "[1.8, 1.8]"), box_of("[1.1, 0.5]", "[1.8, 1.1]")},
                         R"J(["0.3+x+0.9*sin(30*y)", "0.7*y+0.9*sin(25*x)"])J");
  scene.more = R"(, "filter": {"type": "fmpm", "order": 3})";
  BothBackends both(scene.text());
  both.steps(2), both.check_alike();
}

TEST_CASE("nodes that stick and slip are counted alike, in a weld and where each body has a normal", "[parity]") {
  for (const std::string contact :
       {R"({"type": "stick"})", R"({"type": "coulomb", "friction": 0.3, "normal": "own_gradient"})"}) {
    INFO(contact);
    GridScene scene;
    scene.bodies = three_bodies;
    scene.more = R"(, "contact": )" + contact + R"(, "output": {"contact_pairs": true, "bodies": true})";
    BothBackends both(scene.text());
    both.steps(2), both.check_alike(), both.check_contact_records();
  }
}

// Both bodies lie in the first blocks of the grid and in others.
TEST_CASE("parity of contact with a second body that a grip holds", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [2, 2]]";
  scene.bodies = body_of("a", {box_of("[0.5, 0.9]", "[1.2, 1.2]")}, "[0.4, -1]") + ", " +
                 body_of("b", {box_of("[0.4, 0.4]", "[1.3, 0.9]")}, "[0, 0]");
  scene.more = R"(, "contact": {"type": "coulomb", "friction": 0.2}, "grips": [{"body": "b", "velocity": [0.1, 0.2],
    "where": {"type": "half_space", "point": [9, 0], "normal": [1, 0]}}])";
  scene.bodies = jittered(scene.bodies);
  BothBackends both(scene.text());
  both.steps(3), both.check_alike();
}

// Where strain comes before the forces, particles have other surfaces after them; the gap is that of before in both stages.
TEST_CASE("the gap between particles is found once a step", "[parity]") {
  for (const std::string order : {"first", "averaged"}) {
    GridScene scene;
    scene.order = order;
    scene.bodies = body_of("a", {box_of("[0.2, 0.2]", "[0.5, 0.5]")}, R"J(["1+30*(x-0.35)", 0.1])J") + ", " +
                   body_of("b", {box_of("[0.5, 0.2]", "[0.8, 0.5]")}, R"J(["-1+30*(x-0.65)", 0.2])J");
    scene.more = R"(, "contact": {"type": "coulomb", "friction": 0.2, "detection": "particle_surfaces"})";
    INFO(order);
    BothBackends both(scene.text());
    both.steps(2), both.check_alike();
    const double deepest = both.reference.simulation.backend().contact_record().largest_penetration;
    CHECK(deepest > 1e-3);
    CHECK(both.cpu.simulation.backend().contact_record().largest_penetration == Approx(deepest).epsilon(1e-9));
  }
}

// Particles are sorted when one has gone a cell out of its block. Those of the first body go through the edge of a block,
// along which the second one waits.
TEST_CASE("a node sees the particles of a block that have left it", "[parity]") {
  for (const std::string shape : {"linear", "bspline_quadratic", "bspline_cubic"})
    for (const bool up : {true, false}) {
      GridScene scene;
      scene.domain = "[[0, 0], [2.4, 2.4]]", scene.shape = shape, scene.transfer = "flip", scene.modulus = "10";
      const std::string sign = up ? "" : "-";
      scene.bodies =
          jittered(body_of("a", {box_of(up ? "[0.5, 0.5]" : "[0.7, 0.5]", up ? "[0.9, 0.85]" : "[1.1, 0.85]")},
                           "[\"" + sign + "6+0.1*y\", 0.3]") +
                   ", " +
                   body_of("b", {box_of(up ? "[0.9, 0.6]" : "[0.5, 0.6]", up ? "[1.1, 1]" : "[0.7, 1]")},
                           "[" + sign + "5, -0.2]"));
      scene.more = R"(, "contact": {"type": "coulomb", "friction": 0.3, "normal": ")" +
                   std::string(shape == "bspline_cubic" ? "widest_gap" : "linear_regression") + "\"}";
      INFO(shape << (up ? " up" : " down"));
      BothBackends both(scene.text());
      for (int step = 0; step < 4; ++step) both.steps(1), both.check_alike();
    }
}

// ---- walls ---------------------------------------------------------------------------------------------------------

// A ghost's gradient goes to its mirror once, though MUSL's second scatter folds the momenta again. Beside a wall of a body
// that ends there and one that is lower, that of a node is not along the wall.
TEST_CASE("parity of contact at a wall in MUSL's remap", "[parity]") {
  for (const std::string wall : {"slip", "separate"})
    for (const std::string normal : {"average_volume_gradient", "mass_gradient"}) {
      GridScene scene;
      scene.order = "modified_last", scene.transfer = "flip", scene.boundaries = R"({"all": ")" + wall + "\"}";
      scene.bodies = body_of("a", {box_of("[0.2, 0]", "[0.5, 0.35]")}, R"J(["1+3*y", "0.06*sin(61*x)*cos(37*y)"])J") +
                     ", " + body_of("b", {box_of("[0.5, 0]", "[0.8, 0.1]")}, R"J(["-1", "0.06*sin(53*x)"])J");
      scene.more =
          R"(, "gravity": [0, -3], "contact": {"type": "coulomb", "friction": 0.2, "normal": ")" + normal + "\"}";
      INFO(wall << " " << normal);
      scene.bodies = jittered(scene.bodies);
      BothBackends both(scene.text());
      for (int step = 0; step < 4; ++step) both.steps(1), both.check_alike();
    }
}

// A body that its grip lifts off the wall at first and presses onto it at the end of the step: nodes on the wall fold onto
// themselves once, by what they do in the step.
TEST_CASE("parity of contact at a separating wall that a gripped body leaves and meets in one step", "[parity]") {
  GridScene scene;
  scene.order = "modified_last", scene.transfer = "flip", scene.boundaries = R"({"all": "separate"})";
  scene.bodies = jittered(body_of("a", {box_of("[0.2, 0]", "[0.5, 0.35]")}, "[0.5, 0.1]") + ", " +
                          body_of("b", {box_of("[0.5, 0]", "[0.8, 0.2]")}, "[-1, 0.3]"));
  scene.more = R"(, "contact": {"type": "coulomb", "friction": 0.2}, "grips": [{"body": "a",
    "velocity": [0.5, "0.1-220*t"], "where": {"type": "half_space", "point": [9, 0], "normal": [1, 0]}}])";
  BothBackends both(scene.text());
  both.steps(2), both.check_alike();
}

TEST_CASE("parity of separating walls whose nodes all but rest, of the second of two bodies", "[parity]") {
  for (const double share : {0.99, 0.993})
    for (const std::string gravity : {"[-1.3, -1.3]", "[4, -1.3]"}) {
      GridScene scene;
      scene.boundaries = R"({"all": "separate"})";
      scene.bodies = body_of("a", {box_of("[0.7, 0.6]", "[0.9, 0.9]")}, "[0, 0]") + ", " +
                     body_of("b", {box_of("[0, 0]", "[0.4, 0.4]")}, "[-0.05, " + digits(share * 0.005 * 1.3) + "]");
      scene.more = R"(, "contact": {"type": "coulomb", "friction": 0.2}, "gravity": )" + gravity;
      INFO(gravity << " " << share);
      BothBackends both(scene.text());
      both.steps(3), both.check_alike();
    }
}

TEST_CASE("reactions of walls that two bodies touch are alike, with a filter too", "[parity]") {
  for (const std::string filter : {"", R"(, "filter": {"type": "fmpm", "order": 3})"}) {
    GridScene scene;
    scene.boundaries = R"({"all": "slip", "y_min": "stick"})";
    scene.bodies = body_of("a", {box_of("[0, 0]", "[0.5, 0.4]")}, R"(["1-y", "-0.5*x"])") + ", " +
                   body_of("b", {box_of("[0.5, 0]", "[1, 0.3]")}, R"(["-1+y", "0.4*x-0.6"])");
    scene.more = R"(, "contact": {"type": "coulomb", "friction": 0.2}, "output": {"reactions": true})" + filter;
    INFO(filter);
    scene.bodies = jittered(scene.bodies);
    BothBackends both(scene.text());
    both.steps(3), both.check_alike(), check_reactions(both);
  }
}

TEST_CASE("a periodic face beside walls gives no reaction", "[parity]") {
  GridScene scene;
  scene.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
  scene.bodies = body_of("a", {box_of("[0, 0]", "[1, 0.3]")}, R"J(["1+sin(2*pi*x)", "-0.5"])J");
  scene.more = R"(, "output": {"reactions": true})";
  BothBackends both(scene.text());
  both.steps(2), both.check_alike(), check_reactions(both);
}

// The wall above is folded last. In the steps between, a ledger of every second step takes nothing.
TEST_CASE("the ledger of every second step takes the work of a moving wall on weight beyond it in these alone",
          "[parity][ledger]") {
  GridScene scene;
  scene.boundaries = R"({"all": "slip", "y_max": {"type": "prescribed", "velocity": [0.3, -0.4]}})";
  scene.bodies = body_of("a", {box_of("[0.2, 0.5]", "[0.8, 1]")}, R"(["0.3*x", -0.4])");
  scene.more = R"(, "gravity": [0.4, -1.3], "output": {"ledger_every": 2})";
  BothBackends both(scene.text());
  both.steps(4), both.check_alike(), both.check_ledgers();
}

// Stretched domains give mass to nodes two cells beyond the wall, which lets heat through.
TEST_CASE("parity of heat through a wall before wide particles", "[parity]") {
  for (const std::string exchange :
       {R"("heat_flux": 5000)", R"("convection": {"coefficient": 900, "temperature": 60})"}) {
    GridScene scene;
    scene.shape = "cpdi", scene.transfer = "flip", scene.modulus = "1";
    scene.boundaries = R"({"all": "slip", "x_min": {"type": "slip", )" + exchange + "}}";
    scene.bodies = body_of("a", {box_of("[0, 0.4]", "[0.1, 0.6]")}, "[0, \"0.5+8*x\"]");
    scene.bodies.insert(scene.bodies.size() - 1, R"(, "initial_deformation_gradient": {"xx": 7})");
    INFO(exchange);
    BothBackends both(warmed(scene.text()));
    both.steps(2), both.check_alike(), both.check_ledgers();
  }
}

// One particle hits the wall and the gripped one above it leaves it, so that what the first gives a node beyond the wall
// is folded onto the node where both have mass, of which it is then more than half; MUSL's second scatter, of a particle
// that leaves the wall, folds nothing, and the grip holds that node.
TEST_CASE("parity of a grip beside a separating wall in MUSL's remap", "[parity]") {
  GridScene scene;
  scene.order = "modified_last", scene.transfer = "pic", scene.boundaries = R"({"all": "free", "y_min": "separate"})";
  scene.bodies = body_of("a", {box_of("[0.54, 0]", "[0.56, 0.02]")}, "[0, -0.5]") + ", " +
                 body_of("b", {box_of("[0.56, 0.18]", "[0.58, 0.2]")}, "[0, 0.5]");
  const std::string shape = R"("material")", count = R"("particles_per_cell_axis": 5, )";
  for (std::size_t at = 0; (at = scene.bodies.find(shape, at)) != scene.bodies.npos; at += 40)
    scene.bodies.insert(at, count);
  scene.more = R"(, "grips": [{"body": "b", "velocity": [0, 1],
    "where": {"type": "half_space", "point": [9, 0], "normal": [1, 0]}}])";
  BothBackends both(scene.text());
  both.steps(3), both.check_alike(), both.check_ledgers();
}

// The particle's corners lie beyond either wall, where it has ghosts three and five cells out, which have one mirror. Each
// decides by what was folded before it whether it folds.
TEST_CASE("parity of a particle that reaches through both of two separating walls", "[parity]") {
  for (const bool left : {true, false}) {
    const std::string domain = R"({"cell_size": 1, "domain": [[0, 0], [8, 9]], "boundaries": {"all": "free",
        "x_min": "separate", "x_max": "separate"}})";
    BothBackends both(R"({"title": "wide", "dimension": 2, "grid": )" + domain + R"(, "shape": {"type": "cpdi"},
        "transfer": {"type": "apic"}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9,
        "poisson_ratio": 0, "density": 1}}, "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box",
        "lower": )" + (left ? "[2.5, 4]" : "[4.5, 4]") +
                      R"(, "upper": )" + (left ? "[3.5, 5]" : "[5.5, 5]") + R"(}, "particles_per_cell_axis": 1,
        "initial_deformation_gradient": {"xx": 15.2}, "velocity": [)" +
                      (left ? R"J("-0.06+0.004*(x-3)")J" : R"J("0.06+0.004*(x-5)")J") +
                      R"(, 0]}], "solver": {"time_step": 1, "end_time": 9}})");
    INFO((left ? "left" : "right"));
    both.steps(2), both.check_alike();
  }
}

// Its block is the one before the domain, whose ghosts have mirrors two blocks away.
TEST_CASE("parity of lists within half a cell of a wall, across from a free face", "[parity]") {
  GridScene scene;
  scene.shape = "cpdi", scene.boundaries = R"({"all": "free", "x_min": "slip"})";
  scene.bodies = body_of("a", {box_of("[0, 0.4]", "[0.05, 0.6]")}, R"([0.3, "0.4*x"])");
  BothBackends both(scene.text());
  both.steps(3), both.check_alike();
}

// The particle is sorted 0.02 cells before the face. A step later it is 0.72 cells beyond it and not sorted again, and its
// domain of 8.41 cells to either side, which that step has stretched, has nodes ten beyond the face: at their images a
// second body waits.
TEST_CASE("parity of a long list that grows as its particle crosses a periodic face", "[parity]") {
  for (const bool down : {true, false}) {
    const std::string corners = down ? R"("lower": [1, 4], "upper": [2, 5])" : R"("lower": [38, 4], "upper": [39, 5])",
                      velocity = down ? "-0.74+0.063*(x-1.5)" : "0.74+0.063*(x-38.5)",
                      met = down ? R"("lower": [29, 4], "upper": [31, 5])" : R"("lower": [9, 4], "upper": [11, 5])";
    BothBackends both(
        R"({"title": "long", "dimension": 2, "grid": {"cell_size": 1, "domain": [[0, 0], [40, 8]], "boundaries":
        {"all": "free", "x_min": "periodic", "x_max": "periodic"}}, "shape": {"type": "cpdi"}, "transfer":
        {"type": "apic"}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0,
        "density": 1}}, "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", )" +
        corners + R"(}, "particles_per_cell_axis": 1, "initial_deformation_gradient": {"xx": 14}, "velocity": [")" +
        velocity + R"(", 0]}, {"name": "b", "material": "m", "geometry": {"type": "box", )" + met +
        R"(}}], "solver": {"time_step": 1, "end_time": 9}})");
    both.steps(4), both.check_alike();
    CHECK(std::abs(both.cpu.simulation.ledger().mass_book) < 1e-14);
  }
}

// ---- rigid bodies, the ledger, and how fast the grid is ----------------------------------------------------------------

// Of the 65 nodes near the ball the last lies in the body above it.
TEST_CASE("parity of a rigid ball with one node more than a chunk of them", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [2, 2]]";
  scene.bodies = body_of("a", {box_of("[0.2, 0.2]", "[1.8, 1.8]")}, R"(["0.3*y", "0.2-x"])");
  scene.more = R"(, "rigid_bodies": [{"name": "ball", "velocity": [0.5, -1], "contact": {"type": "stick"},
    "geometry": {"type": "ball", "centre": [0.903, 0.924], "radius": 0.355}}])";
  BothBackends both(scene.text());
  both.steps(1), both.check_alike(), both.check_contact_records();
  CHECK(both.reference.simulation.backend().contact_record().nodes == 65);
}

TEST_CASE("the ledger takes what contact and rigid bodies give far from all walls", "[parity][ledger]") {
  GridScene scene;
  scene.domain = "[[0, 0], [6, 6]]", scene.transfer = "flip";
  const std::string a = body_of("a", {box_of("[2.8, 2.8]", "[3.2, 3.2]")}, "[0.4, -1]");
  for (const bool rigid : {true, false}) {
    scene.bodies = rigid ? a : a + ", " + body_of("b", {box_of("[3.2, 2.8]", "[3.5, 3.2]")}, "[-0.7, 0]");
    scene.more = rigid ? R"(, "rigid_bodies": [{"name": "lid", "velocity": [0, 0.5], "contact": {"type": "coulomb",
        "friction": 0.2}, "geometry": {"type": "ball", "centre": [3, 2.6], "radius": 0.2}}])"
                       : R"(, "contact": {"type": "coulomb", "friction": 0.2})";
    INFO((rigid ? "rigid" : "bodies"));
    scene.bodies = jittered(scene.bodies);
    BothBackends both(scene.text());
    both.steps(4), both.check_alike(), both.check_ledgers();
    CHECK(std::abs(both.reference.simulation.ledger().contact) > 0.01);
  }
}

// Sums of many numbers in two orders are never the same, and the momenta that they differ by add up to a length.
TEST_CASE("the book of momentum holds rounding", "[parity][ledger]") {
  for (const std::string backend : {"reference", "cpu"}) {
    GridScene scene;
    scene.bodies = three_bodies;
    Scene run(scene.text(), {set("/backend", backend), "/precision=double"});
    run.run_steps(3);
    const double book = run.simulation.ledger().momentum_book, scale = run.metrics.initial().momentum_scale;
    INFO(backend);
    CHECK(book > 0);
    CHECK(book < 1e-13 * scale);
  }
}

// Weight beyond the wall stays where it was, which changes slow components of nodes alone.
TEST_CASE("a body that glides along a wall by two cells a step keeps its velocities", "[parity]") {
  GridScene scene;
  scene.domain = "[[0, 0], [4, 1]]", scene.time_step = "0.01", scene.modulus = "1e-9";
  scene.boundaries = R"({"all": "slip"})";
  scene.bodies = body_of("a", {box_of("[0.5, 0]", "[0.9, 0.3]")}, "[20, 0]");
  scene.more = R"(, "gravity": [0, -1], "output": {"ledger": false})";
  CHECK(knows_velocities(scene.text(), 1, 9).front());
}

// Without a ledger momenta are divided and weight is added in one loop, whose register holds a node's four numbers or two
// nodes'.
TEST_CASE("parity of weight in 3-D where no ledger is kept", "[parity]") {
  BothBackends both(R"({"title": "falls", "dimension": 3, "grid": {"cell_size": 0.1, "domain": [[0, 0, 0], [1, 1, 1]],
      "boundaries": {"all": "free"}}, "shape": {"type": "linear"}, "transfer": {"type": "apic"}, "materials": {"m":
      {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}}, "bodies": [{"name": "a",
      "material": "m", "geometry": {"type": "box", "lower": [0.4, 0.4, 0.4], "upper": [0.6, 0.5, 0.5]},
      "velocity": ["y", 0.2, "0.3*x"]}], "gravity": [0.7, -1.3, 0.4], "output": {"ledger": false},
      "solver": {"time_step": 0.005, "end_time": 1}})");
  both.steps(2), both.check_alike();
}

// Columns of blocks take turns by colours, of which every second pair along y has others than those beside it.
TEST_CASE("parity of a bar in 3-D that crosses columns of blocks of every colour", "[parity]") {
  BothBackends both(
      R"J({"title": "bar", "dimension": 3, "grid": {"cell_size": 0.1, "domain": [[0, 0, 0], [1.2, 4, 0.4]],
      "boundaries": {"all": "free"}}, "shape": {"type": "linear"}, "transfer": {"type": "apic"}, "materials": {"m":
      {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}}, "bodies": [{"name": "a",
      "material": "m", "geometry": {"type": "box", "lower": [0.1, 0.1, 0.1], "upper": [1.1, 3.9, 0.2]},
      "particles_per_cell_axis": 1, "velocity": ["y", "0.3*sin(x)", "0.2*y*x"]}],
      "solver": {"time_step": 0.005, "end_time": 1}})J");
  both.steps(2), both.check_alike();
}

TEST_CASE("parity of a frozen body beside one that moves", "[parity]") {
  GridScene scene;
  scene.bodies = body_of("a", {box_of("[0.2, 0.2]", "[0.5, 0.5]")}, "[0.6, 0.1]") + ", " +
                 body_of("b", {box_of("[0.5, 0.2]", "[0.8, 0.5]")}, "[0.3, 0.2]");
  const std::string first = R"("name": "a", )";
  scene.bodies.replace(scene.bodies.find(first), first.size(), first + R"("frozen": true, )");
  BothBackends both(scene.text());
  both.steps(3), both.check_alike();
}

// The books of the reference are those of the cpu backend's case above.
TEST_CASE("the books of the reference backend agree in every order and with a filter", "[parity][ledger]") {
  for (const std::string order : {"last", "first", "averaged"})
    for (const std::string filter : {"", R"({"type": "fmpm", "order": 2})"}) check_books("reference", order, filter);
}

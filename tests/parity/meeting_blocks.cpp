// Particles that no other body comes near scatter nothing for contact, and add their forces to the momenta where contact
// alone wants these apart: the cpu backend leaves that out block by block (Block::may_meet), the reference nowhere.

#include "parity/parity.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr long steps = 60;

/// Two bars many blocks long, without a ledger, whose near ends press on each other along x from the first step on.
struct Bars {
  int dimension = 2;
  std::string shape = "bspline_quadratic", transfer = R"({"type": "apic"})", order = "last",
              boundaries = R"({"all": "slip"})", contact = R"({"type": "coulomb", "friction": 0.3})";
  /// The bars lie at the ends of the domain and meet there, where it is periodic.
  bool across = false;

  std::string text() const {
    const bool flat = dimension == 2;
    const auto corner = [&](double x, double y) {
      return "[" + digits(x) + ", " + digits(y) + (flat ? "]" : ", " + digits(y) + "]");
    };
    const auto bar = [&](const std::string& name, double from, double to, double speed) {
      return R"({"name": ")" + name + R"(", "material": "m", "jitter": 0.2, "geometry": {"type": "box", "lower": )" +
             corner(from, 0.15) + R"(, "upper": )" + corner(to, 0.45) + R"(}, "velocity": [)" + digits(speed) +
             (flat ? R"J(, "0.5*sin(0.7853981634*x)"]})J" : R"J(, "0.5*sin(0.7853981634*x)", "0.1*y"]})J");
    };
    const double gap = across ? 2 : 0, speed = across ? -1 : 1;
    return R"({"title": "bars", "dimension": )" + std::to_string(dimension) + R"(, "gravity": )" +
           (flat ? "[0, -3]" : "[0, -3, 1]") + R"(, "grid": {"cell_size": 0.1, "domain": [)" + corner(0, 0) + ", " +
           corner(8, 1) + R"(], "boundaries": )" + boundaries + R"(}, "shape": {"type": ")" + shape +
           R"("}, "transfer": )" + transfer + R"(, "contact": )" + contact +
           R"(, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
             "bodies": [)" +
           bar("a", across ? 0 : 0.6, 4 - gap, speed) + ", " + bar("b", 4 + gap, across ? 8 : 7.4, -speed) +
           R"(], "solver": {"time_step": 0.004, "end_time": 10, "stress_update": ")" + order +
           R"("}, "output": {"ledger": false}})";
  }
};

/// Runs so many steps, at whose end the bodies press on each other or no more.
void check_alike(const std::string& text, long steps, bool presses) {
  INFO(text);
  Scene reference(text, {"/backend=reference", "/precision=double"}), cpu(text, {"/backend=cpu", "/precision=double"});
  reference.run_steps(steps), cpu.run_steps(steps);
  const ContactRecord& expected = reference.simulation.backend().contact_record();
  CHECK(cpu.simulation.backend().contact_record().nodes == expected.nodes);
  CHECK((expected.nodes > 0) == presses);
  for (const int body : {0, 1}) {
    const BodyState of_reference = reference.body(body);
    BodyState found = cpu.body(body);
    wrap_onto(reference.experiment, of_reference.position, found.position);
    CHECK(difference(of_reference.position, found.position, 1) < 1e-10);
    CHECK(difference(of_reference.velocity, found.velocity, 1) < 1e-8);
  }
}

void check_alike(const Bars& bars) {
  check_alike(bars.text(), steps, true);
}

const std::vector<std::string> laws = {
    R"({"type": "coulomb", "friction": 0.3})", R"({"type": "frictionless", "normal": {"type": "widest_gap"}})",
    R"({"type": "linear_interface", "normal_stiffness": 2e4, "shear_stiffness": 1e4})"};

}  // namespace

TEST_CASE("parity of long bars whose ends alone meet", "[parity]") {
  for (const std::string& contact : laws)
    for (const std::string transfer : {R"({"type": "apic"})", R"({"type": "flip"})", R"({"type": "mls"})"}) {
      Bars bars;
      bars.contact = contact, bars.transfer = transfer;
      check_alike(bars);
    }
  for (const std::string shape : {"gimp", "cpdi", "linear"}) {
    Bars bars;
    bars.shape = shape;
    check_alike(bars);
  }
  for (const std::string order : {"first", "averaged", "modified_last"}) {
    Bars bars;
    bars.order = order;
    check_alike(bars);
  }
  Bars bars;
  bars.dimension = 3;
  check_alike(bars);
}

// What reaches beyond a periodic face counts at the other end, in blocks that are no neighbours of the particles' own.
TEST_CASE("parity of long bars that meet across a periodic face alone", "[parity]") {
  for (const int dimension : {2, 3}) {
    Bars bars;
    bars.dimension = dimension, bars.across = true;
    bars.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
    check_alike(bars);
  }
}

// A long particle in the first block reaches 7.4 cells beyond the face, into a block whose nodes it has by that alone.
TEST_CASE("parity of a long list that meets a body across a periodic face", "[parity]") {
  check_alike(R"J({"title": "long", "dimension": 2, "grid": {"cell_size": 1, "domain": [[0, 0], [40, 8]], "boundaries":
      {"all": "free", "x_min": "periodic", "x_max": "periodic"}}, "shape": {"type": "cpdi"}, "transfer":
      {"type": "apic"}, "contact": {"type": "frictionless", "detection": "approach"}, "materials": {"m": {"type":
      "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}}, "bodies": [{"name": "a", "material": "m",
      "geometry": {"type": "box", "lower": [0, 4], "upper": [1, 5]}, "particles_per_cell_axis": 1,
      "initial_deformation_gradient": {"xx": 15.8}, "velocity": [-0.2, "0.05*(x-0.5)"]}, {"name": "b", "material": "m",
      "geometry": {"type": "box", "lower": [30, 4], "upper": [32, 5]}, "velocity": [0.2, 0]}],
      "solver": {"time_step": 0.5, "end_time": 9}, "output": {"ledger": false}})J",
              3, false);
}

// What a fold adds to an image of an image, which no particle reaches, is folded on in every step.
TEST_CASE("parity of bodies that meet across the corner of a periodic domain without a ledger", "[parity]") {
  const std::string text =
      R"J({"title": "corner", "dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [4, 4]],
      "boundaries": {"all": "periodic"}}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "contact":
      {"type": "coulomb", "friction": 0.3}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000,
      "poisson_ratio": 0.3, "density": 1000}}, "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box",
      "lower": [0.01, 0], "upper": [0.6, 0.6]}, "velocity": [-0.3, -0.3]}, {"name": "b", "material": "m", "geometry":
      {"type": "box", "lower": [3.4, 3.4], "upper": [4, 4]}, "velocity": [0.3, 0.3]}],
      "solver": {"time_step": 0.004, "end_time": 1}, "output": {"ledger": false}})J";
  for (const long steps : {15, 18, 20}) check_alike(text, steps, true);
}

// Sorts that leave all blocks where they were do not build the grid anew.
TEST_CASE("long bars whose ends meet go on bit for bit from where they are restored", "[parity]") {
  const Bars bars;
  for (const long saved : {45, 500}) {
    CpuRun run(bars.text(), {}, 1), resumed(bars.text(), {}, 1);
    run.steps(saved);
    ArchiveWriter archive;
    run.simulation.save(archive);
    ArchiveReader reader(archive.bytes());
    resumed.simulation.restore(reader);
    run.steps(300), resumed.steps(300);
    CHECK(different(all_results(run.simulation), all_results(resumed.simulation)) == 0);
  }
}

TEST_CASE("fused and separate passes agree where the ends of long bars meet", "[parity]") {
  for (const std::string& contact : laws) {
    Bars bars;
    bars.contact = contact;
    INFO(bars.text());
    const auto results_of = [&](const std::string& passes) {
      CpuRun run(bars.text(), {set("/solver/passes", passes)}, 2);
      long scattered = 0;
      for (long step = 0; step < steps; ++step) {
        run.simulation.step();
        scattered += run.simulation.backend().scattered();
      }
      CHECK((scattered > steps / 2) == (passes == "fused"));
      return all_results(run.simulation);
    };
    CHECK(different(results_of("separate"), results_of("fused")) == 0);
  }
}

TEST_CASE("a plan says that forces are apart where bodies meet alone, unless others want them", "[parity]") {
  const auto merges = [](const Bars& bars, const std::vector<std::string>& overrides) {
    CpuRun run(bars.text(), overrides, 1);
    return run.simulation.plan().node_field("force")->for_contact;
  };
  Bars bars;
  CHECK(merges(bars, {}));
  CHECK_FALSE(merges(bars, {"/output/ledger=true"}));
  bars.transfer = R"({"type": "flip"})";
  CHECK_FALSE(merges(bars, {}));
}

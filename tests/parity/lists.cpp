// Lists of nodes that leave the tile of their block: bodies stretched over many cells.

#include <cstring>
#include <utility>

#include "parity/parity.hpp"
#include "plugin/extension_of.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A small body flies apart, so fast that its particles reach over two cells to each side at the end; a second one
/// stands in its way.
struct Stretch {
  int dimension = 2;
  std::string transfer = "apic", boundaries = R"({"all": "slip"})", stress_update = "last", more;
  double rate = 15;   ///< 1/s
  bool wide = false;  ///< gives the particles room (in 2-D), where nothing keeps them inside

  std::string text() const {
    const bool flat = dimension == 2;
    std::ostringstream out;
    out << R"({"title": "stretch", "dimension": )" << dimension << R"(, "grid": {"cell_size": 0.1, "domain": )"
        << (wide   ? "[[-0.2, 0], [2.2, 1]]"
            : flat ? "[[0, 0], [2, 1]]"
                   : "[[0, 0, 0], [2, 1, 1]]")
        << R"(, "boundaries": )" << boundaries << R"(}, "shape": {"type": "cpdi"}, "transfer": {"type": ")" << transfer
        << R"("},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [{"name": "a", "material": "m", "jitter": 0.1, "geometry": {"type": "box", "lower": )"
        << (flat ? "[0.9, 0.4], \"upper\": [1.1, 0.6]" : "[0.9, 0.4, 0.4], \"upper\": [1.1, 0.6, 0.6]")
        << R"J(}, "velocity": [")J" << rate << R"J(*(x-1)+5*(y-0.5)", ")J" << 0.25 * rate << R"J(*(y-0.5)+2*(x-1)")J"
        << (flat ? "" : ", 0.1")
        << R"(]}, {"name": "b", "material": "m", "jitter": 0.1, "geometry": {"type": "box", "lower": )"
        << (flat ? "[1.3, 0.3], \"upper\": [1.5, 0.5]" : "[1.3, 0.3, 0.4], \"upper\": [1.5, 0.5, 0.6]")
        << R"(}, "velocity": )" << (flat ? "[-0.4, 0.1]" : "[-0.4, 0.1, 0]") << "}]" << more
        << R"(, "solver": {"stress_update": ")" << stress_update << R"(", "time_step": 0.01, "end_time": )"
        << (wide ? 0.42 : 0.5) << "}}";
    return out.str();
  }
};

/// The largest reach of a particle's domain along an axis, in cells.
double largest_reach(const Scene& scene) {
  const int D = scene.experiment.dimension;
  const BodyState state = scene.body();
  double largest = 0;
  for (std::size_t row = 0; row < state.domain.size() / D; ++row) {
    double reach = 0;
    for (int k = 0; k < D; ++k) reach += std::abs(state.domain[row * D + k]);
    largest = larger(largest, reach / scene.experiment.grid.cell_size);
  }
  return largest;
}

/// Checks the scene on the reference and on the cpu, in both precisions and with one worker and two.
void check_stretch(const Stretch& stretch) {
  if (!is_chosen_check()) return;
  const std::string text = stretch.text();
  INFO(text);
  Scene reference(text, {set("/backend", "reference")});
  reference.run();
  CHECK(largest_reach(reference) > 2.2);
  for (const std::string precision : {"double", "float"}) {
    INFO(precision);
    const double epsilon =
        precision == "double" ? std::numeric_limits<double>::epsilon() : std::numeric_limits<float>::epsilon();
    const std::vector<std::string> overrides{set("/backend", "cpu"), set("/precision", precision)};
    Scene cpu(text, overrides);
    cpu.run();
    // The scene has stretches of 10 and velocities of 2 m/s where the other scenes have 1.
    Tolerance allowed = parity_tolerance;
    for (double* factor : {&allowed.position, &allowed.velocity, &allowed.transfer, &allowed.material, &allowed.ledger})
      *factor *= 10;
    compare_states(reference, cpu, epsilon, allowed);
    const double energy = reference.metrics.initial().kinetic;
    CHECK(difference(ledger_values(reference), ledger_values(cpu), energy) <= allowed.ledger * epsilon);
    const std::vector<double> expected = all_results(cpu.simulation);
    for (const int threads : {1, 2}) {
      CpuRun run(text, overrides, threads);
      while (!run.simulation.finished()) run.simulation.step();
      CHECK(different(expected, all_results(run.simulation)) == 0);
    }
  }
}

void (*evaluate_box)(const void*, const mpm_box_batch*) = nullptr;
long boxes_evaluated = 0;
void count_and_evaluate_box(const void* parameters, const mpm_box_batch* batch) {
  ++boxes_evaluated;
  evaluate_box(parameters, batch);
}
/// The shape's extension with boxes that are counted.
mpm_shape_boxes counted_boxes;
const void* with_counted_boxes(const char* id) {
  return id == std::string(MPM_SHAPE_BOXES_ID) ? &counted_boxes : nullptr;
}
const void* without_extensions(const char*) {
  return nullptr;
}

/// Both bodies at the end of a run, by one worker, with a shape that has these extensions.
std::vector<BodyState> run_with(Experiment& experiment, const void* (*extension)(const char*)) {
  mpm_descriptor descriptor = *experiment.shape.plugin->descriptor;
  descriptor.extension = extension;
  const Plugin plugin{&descriptor, "altered"};
  experiment.shape.plugin = &plugin;
  Simulation simulation(experiment, backend_factory(1));
  while (!simulation.finished()) simulation.step();
  return {simulation.backend().body_state(0), simulation.backend().body_state(1)};
}

}  // namespace

TEST_CASE("parity of lists that leave their tile", "[parity]") {
  for (const std::string transfer : {"flip", "apic", "mls", "tpic"})
    for (const std::string more : {"", R"(, "contact": {"type": "coulomb", "friction": 0.2})"}) {
      Stretch stretch;
      stretch.transfer = transfer, stretch.more = more;
      check_stretch(stretch);
    }
  Stretch stretch;
  stretch.dimension = 3;
  for (const std::string transfer : {"flip", "mls"}) {
    stretch.transfer = transfer;
    check_stretch(stretch);
  }
}

TEST_CASE("a plugin without boxes gives the same results by its lists", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string transfer : {"flip", "mls"})
      for (const std::string precision : {"double", "float"}) {
        INFO(dimension << "-D " << transfer << " " << precision);
        Stretch stretch;
        stretch.dimension = dimension, stretch.transfer = transfer;
        const std::vector<std::string> overrides{set("/backend", "cpu"), set("/precision", precision)};
        const int lanes = precision == "double" ? MPM_LANES_DOUBLE : MPM_LANES_FLOAT;

        Experiment with_boxes = experiment_from(stretch.text(), overrides);
        counted_boxes = *extension_of<mpm_shape_boxes>(*with_boxes.shape.plugin);
        evaluate_box = std::exchange(counted_boxes.evaluate[lanes][dimension - 2], count_and_evaluate_box);
        boxes_evaluated = 0;
        const std::vector<BodyState> a = run_with(with_boxes, with_counted_boxes);
        CHECK(boxes_evaluated > 0);

        Experiment without = experiment_from(stretch.text(), overrides);
        const std::vector<BodyState> b = run_with(without, without_extensions);

        const double epsilon =
            precision == "double" ? std::numeric_limits<double>::epsilon() : std::numeric_limits<float>::epsilon();
        for (int body = 0; body < 2; ++body) {
          CHECK(difference(a[body].position, b[body].position, 1.0) <= 10 * parity_tolerance.position * epsilon);
          CHECK(difference(a[body].velocity, b[body].velocity, 1.5) <= 10 * parity_tolerance.velocity * epsilon);
        }
      }
}

TEST_CASE("parity of lists that leave their tile at walls and in every order of a step", "[parity]") {
  for (const std::string order : {"first", "modified_last", "averaged"})
    for (const std::string boundaries : {R"({"all": "slip"})", R"({"all": "periodic"})"}) {
      Stretch stretch;
      stretch.stress_update = order, stretch.boundaries = boundaries;
      check_stretch(stretch);
    }
  for (const std::string boundaries :
       {R"({"all": "stick"})", R"({"all": "separate"})", R"({"all": "free"})", R"({"all": "periodic"})",
        R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})"}) {
    Stretch stretch;
    stretch.boundaries = boundaries;
    stretch.wide = boundaries.find("free") != boundaries.npos;
    check_stretch(stretch);
  }
}

TEST_CASE("parity of filtered lists that leave their tile", "[parity]") {
  for (const std::string filter : {R"({"type": "fmpm", "order": 3})", R"({"type": "xpic", "order": 2})"}) {
    Stretch stretch;
    stretch.more = R"(, "contact": {"type": "stick"}, "filter": )" + filter;
    check_stretch(stretch);
  }
}

TEST_CASE("a domain that reaches too far ends the run at the same particle on both backends", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string boundaries : {R"({"all": "free"})", R"({"all": "slip"})", R"({"all": "periodic"})"}) {
      // A wall of one particle's width is drawn out across itself: its centre stays where it is.
      const bool flat = dimension == 2;
      const std::string text =
          R"({"title": "too far", "dimension": )" + std::to_string(dimension) +
          R"(, "grid": {"cell_size": 0.1, "domain": )" + (flat ? "[[0, 0], [2, 1]]" : "[[0, 0, 0], [2, 1, 1]]") +
          R"(, "boundaries": )" + boundaries +
          R"(}, "shape": {"type": "cpdi"}, "transfer": {"type": "apic"},
            "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0.3, "density": 1000}},
            "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": )" +
          (flat ? "[0.25, 0.3], \"upper\": [0.3, 0.7]" : "[0.25, 0.3, 0.3], \"upper\": [0.3, 0.7, 0.5]") +
          R"J(}, "velocity": ["400*(x-0.275)", "0.1*(y-0.5)")J" + (flat ? "" : ", 0") +
          R"(]}], "solver": {"time_step": 0.001, "end_time": 0.4}})";
      INFO(text);
      std::vector<std::string> causes;
      std::vector<long> steps;
      std::vector<std::pair<int, std::size_t>> particles;
      for (const std::string backend : {"reference", "cpu"}) {
        Scene scene(text, {set("/backend", backend)});
        try {
          scene.run();
        } catch (const RunFailure& stopped) {
          causes.push_back(cause_text(stopped.failure, scene.experiment));
          steps.push_back(scene.simulation.steps());
          particles.push_back({stopped.failure.body, stopped.failure.particle});
        }
      }
      REQUIRE(causes.size() == 2);
      CHECK(causes[0] == "its domain reaches more than 8 cells beyond the domain's edge");
      CHECK(causes[0] == causes[1]);
      CHECK(steps[0] == steps[1]);
      CHECK(particles[0] == particles[1]);
    }
}

// Results have the same bits whatever the number of threads, the cadence of outputs, or the run.

#include "support/catch.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The scene is large enough for several blocks a thread; bodies spin, collide, press on walls and are sorted again.
const char* flat = R"J({
  "title": "determinism", "dimension": 2, "seed": 5, "gravity": [0.3, -1],
  "grid": {"cell_size": 0.025, "domain": [[0, 0], [1.2, 0.8]], "boundaries": {"all": "separate", "x_min": "periodic", "x_max": "periodic"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip", "pic_fraction": 0.05},
  "contact": {"type": "coulomb", "friction": 0.3},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000},
                "p": {"type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 800, "yield_stress": 60}},
  "bodies": [
    {"name": "a", "material": "m", "jitter": 0.2, "geometry": {"type": "ball", "centre": [0.3, 0.22], "radius": 0.2}, "velocity": ["0.8-2*(y-0.22)", "2*(x-0.3)"]},
    {"name": "b", "material": "p", "geometry": {"type": "box", "lower": [0.55, 0.01], "upper": [0.95, 0.4]}, "velocity": [-0.4, 0.1]}],
  "solver": {"time_step": "auto", "end_time": 100}})J";

const char* solid = R"J({
  "title": "determinism", "dimension": 3, "seed": 5, "gravity": [0.3, -1, 0],
  "grid": {"cell_size": 0.05, "domain": [[0, 0, 0], [0.9, 0.6, 0.6]], "boundaries": {"all": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "mls"}, "contact": {"type": "coulomb", "friction": 0.3},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "a", "material": "m", "jitter": 0.2, "geometry": {"type": "ball", "centre": [0.27, 0.27, 0.3], "radius": 0.2}, "velocity": ["0.8-2*(y-0.27)", "2*(x-0.27)", 0.1]},
    {"name": "b", "material": "m", "geometry": {"type": "ball", "centre": [0.66, 0.3, 0.3], "radius": 0.16}, "velocity": [-0.5, 0, 0]}],
  "solver": {"time_step": "auto", "end_time": 100}})J";

constexpr long steps = 60;

std::vector<double> results(const char* text, const std::vector<std::string>& overrides, int threads,
                            int measure_every = 0) {
  Scene scene(text, overrides, threads);
  for (long step = 1; step <= steps; ++step) {
    scene.simulation.step();
    if (measure_every && step % measure_every == 0) scene.metrics.measure();
  }
  return all_results(scene.simulation);
}

}  // namespace

TEST_CASE("results are the same bits for any number of threads", "[stability][determinism]") {
  for (const char* text : {flat, solid})
    for (const std::string precision : {"double", "float"})
      for (const std::string order : {"last", "modified_last"}) {
        const std::vector<std::string> overrides{set("/precision", precision), set("/solver/stress_update", order)};
        const auto one = results(text, overrides, 1);
        for (const int threads : {1, 2, 3, 5}) {  // 1 comes again, for run to run
          INFO(precision << " " << order << " " << threads << " threads" << (text == flat ? ", 2-D" : ", 3-D"));
          CHECK(different(one, results(text, overrides, threads)) == 0);
        }
      }
}

TEST_CASE("filters and lists of nodes give the same bits for any number of threads", "[stability][determinism]") {
  for (const char* text : {flat, solid})
    for (const std::string precision : {"double", "float"})
      for (const std::string shape : {"bspline_cubic", "gimp", "gimp_contiguous", "cpdi"})
        for (const char* filter : {R"({"type": "fmpm", "order": 3, "every_steps": 2})",
                                   R"({"type": "xpic", "order": 2, "every_courant": 0.5, "constraints": "at_end"})"}) {
          const std::vector<std::string> overrides{set("/precision", precision), set("/shape/type", shape),
                                                   set("/filter", filter)};
          const auto one = results(text, overrides, 1);
          for (const int threads : {2, 5}) {
            INFO(precision << " " << shape << " " << filter << " " << threads << " threads"
                           << (text == flat ? ", 2-D" : ", 3-D"));
            CHECK(different(one, results(text, overrides, threads)) == 0);
          }
        }
}

TEST_CASE("results do not depend on the cadence of outputs", "[stability][determinism]") {
  for (const std::string backend : {"cpu", "reference"})
    for (const std::string precision : {"double", "float"}) {
      if (backend == "reference" && precision == "float") continue;
      const std::vector<std::string> plain{set("/backend", backend), set("/precision", precision),
                                           set("/grid/cell_size", "0.05")};
      const auto expected = results(flat, plain, 2);
      for (const int every : {1, 7}) {
        std::vector<std::string> overrides = plain;
        overrides.push_back("/output={\"metrics_every\": " + std::to_string(every) +
                            ", \"frames\": " + std::to_string(2 + 3 * every) + ", \"vtk\": true}");
        INFO(backend << " " << precision << " every " << every);
        CHECK(different(expected, results(flat, overrides, 2)) == 0);
        CHECK(different(expected, results(flat, plain, 2, every)) == 0);
        CHECK(different(expected, results(flat, overrides, 2, every)) == 0);
      }
    }
}

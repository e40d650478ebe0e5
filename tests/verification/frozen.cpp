// Frozen bodies: the damping of a wave with finite velocities on particles that keep their places and domains.

#include "lattice.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A line with velocities of 1 and steps of a tenth of a cell's transit; no stiffness to speak of.
Line finite_line() {
  Line line;
  line.time_step = 0.1, line.youngs_modulus = 1e-30, line.frozen = true;
  return line;
}

}  // namespace

TEST_CASE("damping factors are exact at finite velocities on frozen particles", "[damping][frozen]") {
  struct Row {
    const char *shape, *transfer;
    double offset;
    std::array<double, 4> factors;
  };
  for (const Row& row : {Row{"linear", "pic", 0, {.9903926402, .9619397663, .8535533906, .5}},
                         Row{"bspline_quadratic", "pic", .5, {.9904157155, .9623019116, .8589150429, .5625}},
                         Row{"bspline_cubic", "pic", .5, {.9872312098, .9498968356, .8142696805, .4444444444}},
                         Row{"cpdi", "pic", 0, {.9903926402, .9619397663, .8535533906, .5}},
                         Row{"bspline_quadratic", "apic", .5, {.9999307740, .9989135640, .9839150429, .8125}},
                         Row{"bspline_quadratic", "mls", .5, {.9999307740, .9989135640, .9839150429, .8125}}})
    for (const std::string backend : {"reference", "cpu"})
      for (const std::string update : {"last", "first", "modified_last", "averaged"})
        for (std::size_t k = 0; k < 4; ++k) {
          Line line = finite_line();
          line.shape = row.shape, line.transfer = row.transfer, line.offset = row.offset, line.backend = backend;
          line.stress_update = update, line.mode = 1 << k;
          INFO(row.shape << " " << row.transfer << " " << backend << " " << update << " mode " << line.mode);
          // MUSL maps the velocity to the grid once more, but neither keeps nor moves with what it finds there.
          CHECK(std::abs(factor(line) - row.factors[k]) <= 1e-10);
          line.frozen = false;
          CHECK(std::abs(factor(line) - row.factors[k]) > 1e-6);
        }
}

TEST_CASE("frozen particles keep places and domains while velocity and strain evolve", "[frozen]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape : {"bspline_quadratic", "cpdi"})
      for (const std::string update : {"last", "first", "modified_last", "averaged"}) {
        INFO(backend << " " << shape << " " << update);
        const std::string text = R"J({"dimension": 2, "backend": ")J" + backend + R"J(",
          "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
          "shape": {"type": ")J" +
                                 shape + R"J("}, "transfer": {"type": "apic"},
          "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 10, "poisson_ratio": 0.3, "density": 1}},
          "bodies": [{"name": "b", "material": "m", "frozen": true, "velocity": ["0.1*sin(9*x)", 0.2],
                      "geometry": {"type": "box", "lower": [0.3, 0.3], "upper": [0.7, 0.7]}},
                     {"name": "c", "material": "m", "velocity": [0, 0.2],
                      "geometry": {"type": "box", "lower": [0.7, 0.3], "upper": [0.8, 0.7]}}],
          "solver": {"stress_update": ")J" +
                                 update + R"J(", "time_step": 0.002, "end_time": 0.1}})J";
        Scene scene(text);
        const BodyState start = scene.body(0), other = scene.body(1);
        scene.run();
        const BodyState end = scene.body(0);
        CHECK(end.position == start.position);
        CHECK(end.domain == start.domain);
        CHECK(end.velocity != start.velocity);
        CHECK(end.material_state != start.material_state);
        CHECK(scene.body(1).position != other.position);
      }
}

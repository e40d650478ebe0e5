// Case D4: two bodies of one material joined by a weld reproduce the single-field run; without a contact law bodies
// that share the field weld by themselves.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

// A bar cut in two halves, thrown and vibrating, so that the interface crosses cells and carries stress.
const char* halves = R"J({
  "title": "two halves", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [6, 3]], "boundaries": {"all": "free"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "contact": {"type": "stick"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e4, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "left", "material": "m", "geometry": {"type": "box", "lower": [1, 1], "upper": [2, 1.6]}, "velocity": ["1+0.3*sin(pi*(x-1)/2)", "0.4*x"]},
    {"name": "right", "material": "m", "geometry": {"type": "box", "lower": [2, 1], "upper": [3, 1.6]}, "velocity": ["1+0.3*sin(pi*(x-1)/2)", "0.4*x"]}],
  "solver": {"time_step": 0.005, "end_time": 0.5}})J";

double largest_difference(const Scene& a, const Scene& b) {
  double largest = 0;
  for (int body = 0; body < 2; ++body) {
    const BodyState s = a.body(body), t = b.body(body);
    for (std::size_t k = 0; k < s.velocity.size(); ++k)
      largest = std::max(largest, std::abs(s.velocity[k] - t.velocity[k]));
    for (std::size_t k = 0; k < s.position.size(); ++k)
      largest = std::max(largest, std::abs(s.position[k] - t.position[k]));
  }
  return largest;
}

}  // namespace

TEST_CASE("D4 a welded interface is transparent to rounding", "[D][D4]") {
  for (const std::string shape : {"linear", "bspline_quadratic"})
    for (const std::string transfer : {"pic", "flip", "apic", "mls"})
      for (const std::string order : {"last", "first", "modified_last"})
        for (const std::string backend : {"reference", "cpu"}) {
          if (backend == "reference" && order != "last") continue;
          const std::vector<std::string> common{set("/shape/type", shape), set("/transfer/type", transfer),
                                                set("/solver/stress_update", order), set("/backend", backend)};
          auto single = common;
          single.push_back("/contact=null");
          Scene welded(halves, common), one(halves, single);
          INFO(shape << " " << transfer << " " << order << " " << backend);
          welded.run_steps(1), one.run_steps(1);
          CHECK(largest_difference(welded, one) < 1e-13);
          welded.run_steps(60), one.run_steps(60);
          CHECK(largest_difference(welded, one) < 1e-9);
        }
}

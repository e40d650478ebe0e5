// Section `accuracy`: what float costs in digits, on the standard scenes.

#include <algorithm>
#include <cmath>

#include "mpm/bench_sections.hpp"

namespace mpm::app {
namespace {

struct Difference {
  double largest = 0, rms = 0;
};

/// The difference over all values, divided by `scale`.
Difference difference_of(const std::vector<double>& a, const std::vector<double>& b, double scale) {
  Difference difference;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = std::abs(a[i] - b[i]) / scale;
    difference.largest = std::max(difference.largest, d);
    sum += d * d;
  }
  difference.rms = std::sqrt(sum / static_cast<double>(a.size()));
  return difference;
}

double rms_of(const std::vector<double>& values) {
  return difference_of(values, std::vector<double>(values.size(), 0.0), 1).rms;
}

BodyState state_after(BenchContext& context, const BenchScene& scene, const std::string& motion,
                      const std::string& precision, int steps) {
  Product product(context.suite.experiment(scene, motion, {{"/precision", precision}}), context.threads);
  product.simulation().observe_when({});  // velocities are compared too
  for (int s = 0; s < steps; ++s) product.step();
  return product.simulation().backend().body_state(0);
}

}  // namespace

bench::SectionResult bench_accuracy(BenchContext& context) {
  const int steps = context.options.quick ? 10 : 100;
  bench::Table table{"float_against_double",
                     "Float against double after " + std::to_string(steps) + " steps",
                     {{"scene", "scene"},
                      {"motion", "motion"},
                      {"steps", "steps"},
                      {"position_largest", "largest in position (cells)"},
                      {"position_rms", "rms in position (cells)"},
                      {"velocity_largest", "largest in velocity (of its rms)"},
                      {"velocity_rms", "rms in velocity (of its rms)"}},
                     {}};
  for (const BenchScene& scene : context.suite.scenes())
    for (const std::string motion : {"rest", "deforming"}) {
      context.say("accuracy: " + scene.name + ", " + motion);
      const double cell = context.suite.experiment(scene, motion, {}).grid.cell_size;
      const BodyState exact = state_after(context, scene, motion, "double", steps);
      const BodyState single = state_after(context, scene, motion, "float", steps);
      const Difference x = difference_of(single.position, exact.position, cell);
      const Difference v = difference_of(single.velocity, exact.velocity, rms_of(exact.velocity));
      table.rows.push_back({scene.name, motion, static_cast<double>(steps), x.largest, x.rms, v.largest, v.rms});
    }
  return {"accuracy", {std::move(table)}, {}};
}

}  // namespace mpm::app

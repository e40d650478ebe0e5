// A filter is told the number of its pass, from 1, by every backend. No filter of the build reads it, so this one does:
// the increment of pass k counts 1 / k.

#include "device/changed_plugin.hpp"
#include "plugin/sdk.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

struct FadingFilter {
  struct Parameters {
    double order;
  };
  MPM_HD static int iterations(const Parameters& p) { return static_cast<int>(p.order) - 1; }
  template <int D, class S>
  MPM_HD static void update(const Parameters&, int iteration, const Vec<D, S>& projected, Vec<D, S>& increment,
                            Vec<D, S>& velocity) {
    for (int i = 0; i < D; ++i) {
      increment[i] = increment[i] - projected[i];
      velocity[i] = velocity[i] + increment[i] * real<S>(1.0 / iteration);
    }
  }
  static constexpr unsigned traits = 0;
};

std::vector<double> velocities(Experiment experiment, const Plugin& filter, const BackendFactory& factory) {
  experiment.filter->plugin = &filter;
  Simulation simulation(experiment, factory);
  while (!simulation.finished()) simulation.step();
  return simulation.backend().body_state(0).velocity;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace

TEST_CASE("a filter is told the number of its pass", "[device][filter]") {
  Mix mix;
  mix.filter = R"({"type": "fmpm", "order": 4, "every_steps": 2})";
  const Experiment experiment = device_experiment(mix.text(), "double");
  ChangedPlugin fading(MPM_FILTER, "fmpm");
  fading.set_table(&sdk::filter_table<FadingFilter>);
  fading.replace("const Parameters&, int, const", "const Parameters&, int iteration, const");
  fading.replace("velocity[i] + increment[i]", "velocity[i] + increment[i] * real<S>(1.0 / iteration)");
  const std::vector<double> expected = velocities(experiment, fading.plugin(), make_reference_backend);
  const BackendFactory cpu = [](const Experiment& e, const Plan& plan, std::vector<SeededBody> bodies) {
    return make_cpu_backend(e, plan, std::move(bodies), 1);
  };
  double fastest = 0;
  for (const double v : expected) fastest = std::max(fastest, std::abs(v));
  const double rounding = 1e-11 * fastest;
  CHECK(difference(velocities(experiment, fading.plugin(), cpu), expected) < rounding);
  CHECK(difference(velocities(experiment, fading.plugin(), device_factory()), expected) < rounding);
  // The passes count: FMPM itself leaves another velocity.
  const Plugin& fmpm = *plugins().find(MPM_FILTER, "fmpm");
  CHECK(difference(velocities(experiment, fmpm, make_reference_backend), expected) > 1e-4 * fastest);
}

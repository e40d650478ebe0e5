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

struct Outcome {
  std::vector<double> velocities, reactions;
  double growth;  ///< of the filter's increment from one pass to the next
};
Outcome outcome(Experiment experiment, const Plugin& filter, const BackendFactory& factory) {
  experiment.filter->plugin = &filter;
  Simulation simulation(experiment, factory);
  while (!simulation.finished()) simulation.step();
  Outcome found{simulation.backend().body_state(0).velocity, {}, simulation.backend().filter_record().largest_growth};
  for (const Reaction& reaction : simulation.backend().reactions())
    found.reactions.insert(found.reactions.end(), reaction.impulse.begin(), reaction.impulse.end());
  return found;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = larger(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace

TEST_CASE("a filter is told the number of its pass", "[device][filter]") {
  Mix mix;
  mix.close = true;
  mix.boundaries = R"({"all": "slip", "x_min": "stick"})";
  mix.filter = R"({"type": "fmpm", "order": 4, "every_steps": 2})";
  mix.more = R"(, "output": {"reactions": true})";
  const Experiment experiment = device_experiment(mix.text(), "double");
  ChangedPlugin fading(MPM_FILTER, "fmpm");
  fading.set_table(&sdk::filter_table<FadingFilter>);
  fading.replace("const Parameters&, int, const", "const Parameters&, int iteration, const");
  fading.replace("velocity[i] + increment[i]", "velocity[i] + increment[i] * real<S>(1.0 / iteration)");
  const Outcome expected = outcome(experiment, fading.plugin(), make_reference_backend);
  const BackendFactory cpu = [](const Experiment& e, const Plan& plan, std::vector<SeededBody> bodies) {
    return make_cpu_backend(e, plan, std::move(bodies), 1);
  };
  const auto largest = [](const std::vector<double>& values) {
    double most = 0;
    for (const double value : values) most = larger(most, std::abs(value));
    return most;
  };
  const double fastest = largest(expected.velocities), strongest = largest(expected.reactions);
  for (const BackendFactory& factory : {cpu, device_factory()}) {
    const Outcome found = outcome(experiment, fading.plugin(), factory);
    CHECK(difference(found.velocities, expected.velocities) < 1e-11 * fastest);
    CHECK(difference(found.reactions, expected.reactions) < 1e-9 * strongest);
    CHECK(found.growth == Approx(expected.growth).epsilon(1e-9));
  }
  CHECK((expected.growth > 0.1 && expected.growth < 1));
  // The passes count: FMPM itself leaves other velocities and other impulses of walls.
  const Outcome itself = outcome(experiment, *plugins().find(MPM_FILTER, "fmpm"), make_reference_backend);
  CHECK(difference(itself.velocities, expected.velocities) > 1e-4 * fastest);
  CHECK(difference(itself.reactions, expected.reactions) > 1e-6 * strongest);
}

// Sums of whole numbers: the same bits in any order of lanes and for any number of teams; sums of floating point are not.

#include "backends/device/memory.hpp"
#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// How lanes and teams go about a run.
struct Way {
  TeamShape team;
  int teams;
};
const std::vector<Way> ways{{{32, TeamShape::upwards}, 0},
                            {{32, TeamShape::downwards}, 0},
                            {{32, TeamShape::upwards}, 1},
                            {{32, TeamShape::shuffled(0)}, 3}};

/// Runs a scene on a device; all saved values of all particles in one list, and the ledger.
std::vector<double> values_after(const std::string& text, const std::string& precision, const Way& way,
                                 const std::vector<std::string>& overrides) {
  const Experiment experiment = device_experiment(text, precision, overrides);
  device::DeviceSetup setup = device_setup(way.team);
  setup.teams = way.teams;
  Simulation simulation(experiment, device_factory(setup));
  while (!simulation.finished()) simulation.step();
  std::vector<double> all = values_of(simulation.backend().ledger());
  const auto take = [&](const std::vector<double>& values) { all.insert(all.end(), values.begin(), values.end()); };
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyState state = simulation.backend().body_state(body);
    take(state.position), take(state.velocity), take(state.domain);
    for (const auto* fields : {&state.transfer_state, &state.material_state, &state.host_state})
      for (const auto& [name, values] : *fields) take(values);
  }
  return all;
}

/// How many of the ways give other bits than the first one.
int other_bits(const std::string& text, const std::string& precision, bool deterministic,
               std::vector<std::string> overrides = {}) {
  if (deterministic) overrides.push_back(deterministic_sums);
  const std::vector<double> first = values_after(text, precision, ways.front(), overrides);
  int others = 0;
  for (std::size_t k = 1; k < ways.size(); ++k) others += values_after(text, precision, ways[k], overrides) != first;
  return others;
}

Mix touching(int dimension) {
  Mix mix;
  mix.dimension = dimension, mix.close = true;
  mix.contact = R"({"type": "coulomb", "friction": 0.2})";
  return mix;
}

}  // namespace

TEST_CASE("deterministic sums are the same bits in any order of lanes and for any number of teams, fast ones are not",
          "[device][deterministic]") {
  for (const int dimension : {2, 3})
    for (const std::string precision : {"double", "float"}) {
      INFO(dimension << "-D " << precision);
      const std::string text = touching(dimension).text();
      CHECK(other_bits(text, precision, true) == 0);
      CHECK(other_bits(text, precision, false) > 0);
    }
}

TEST_CASE("deterministic sums of loads, grips, heat, filters and lists of nodes", "[device][deterministic]") {
  Mix filtered = touching(2);
  filtered.filter = R"({"type": "fmpm", "order": 3})";
  Mix warm = touching(2);
  warm.material = R"({"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
    "thermal": {"conductivity": 500, "heat_capacity": 10}})";
  warm.overrides = {set("/bodies/0/temperature", "20"), set("/bodies/1/temperature", "25")};
  Mix pushed = touching(2);
  pushed.more = R"(, "body_force": ["x", "1+y"], "grips": [{"body": "a", "velocity": [0.1, null],
    "where": {"type": "half_space", "point": [0.31, 0], "normal": [1, 0]}}])";
  Mix far = touching(2);
  far.shape = R"({"type": "cpdi"})";
  Mix around = touching(2);
  around.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
  for (const Mix& mix : {filtered, warm, pushed, far, around}) {
    INFO(mix.name());
    CHECK(other_bits(mix.text(), "double", true, mix.overrides) == 0);
  }
}

TEST_CASE("deterministic sums differ from the reference backend by rounding", "[device][deterministic]") {
  for (const std::string shape : {"linear", "bspline_quadratic", "cpdi"}) {
    Mix mix = touching(2);
    mix.shape = "{\"type\": \"" + shape + "\"}", mix.overrides = {deterministic_sums};
    check_on_device(mix);
  }
}

TEST_CASE("the memory of deterministic sums is counted before a run begins", "[device][deterministic]") {
  const auto bytes_of_nodes = [](const std::vector<std::string>& overrides) {
    const Experiment experiment = device_experiment(touching(2).text(), "double", overrides);
    double bytes = 0;
    for (const device::TakenMemory& taken : device::taken_memory(experiment, make_plan(experiment), {{1, 1}, 1000}))
      if (taken.body == device::TakenMemory::of_nodes) bytes += taken.bytes;
    return bytes;
  };
  // A scatter with contact has 9 channels: mass, momentum and force, the gradient of volume, and the position of mass.
  CHECK(bytes_of_nodes({deterministic_sums}) - bytes_of_nodes({}) == 1000 * 9 * 16);
}

// Steps that need nothing of the host run as graphs, with the same bytes; what no graph can hold is refused while one is
// made.

#include "backends/device/device.hpp"
#include "device/device_support.hpp"

using namespace mpm;
using namespace std::string_literals;
using namespace mpm::test;

namespace {

/// What a run leaves, and how often the driver was asked for what.
struct Run {
  std::vector<BodyState> bodies;
  std::vector<double> ledger;
  std::vector<Reaction> reactions;
  std::array<double, 3> contact_force{};
  long steps = 0, launches = 0, graph_launches = 0, synchronisations = 0;
};

Run run(const std::string& text, bool graphs, const std::vector<std::string>& overrides = {}) {
  const Experiment experiment = device_experiment(text, "double", overrides);
  device::DeviceSetup setup = device_setup();
  setup.graphs = graphs, setup.steps_to_forget = 16;  // steps that forget the grid are graphs of their own
  Simulation simulation(experiment, device_factory(setup));
  Run found;
  const auto count = [&](int sign) {
    found.launches += sign * device::calls_on_host("cuLaunchKernel");
    found.graph_launches += sign * device::calls_on_host("cuGraphLaunch");
    found.synchronisations += sign * device::calls_on_host("cuStreamSynchronize");
  };
  count(-1);
  while (!simulation.finished()) simulation.step();
  count(1);
  const Backend& backend = simulation.backend();
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
    found.bodies.push_back(backend.body_state(body));
  found.ledger = values_of(backend.ledger());
  found.reactions = backend.reactions();
  found.contact_force = backend.contact_record().force;
  found.steps = simulation.steps();
  return found;
}

/// Checks that two runs have left the same bits.
void check_same(const Run& expected, const Run& found) {
  REQUIRE(found.bodies.size() == expected.bodies.size());
  for (std::size_t k = 0; k < expected.bodies.size(); ++k) {
    CHECK((found.bodies[k].position == expected.bodies[k].position));
    CHECK((found.bodies[k].velocity == expected.bodies[k].velocity));
    CHECK((found.bodies[k].transfer_state == expected.bodies[k].transfer_state));
    CHECK((found.bodies[k].material_state == expected.bodies[k].material_state));
  }
  CHECK((found.ledger == expected.ledger));
  CHECK((found.contact_force == expected.contact_force));
  REQUIRE(found.reactions.size() == expected.reactions.size());
  for (std::size_t k = 0; k < expected.reactions.size(); ++k) {
    CHECK((found.reactions[k].impulse == expected.reactions[k].impulse));
    CHECK((found.reactions[k].moment == expected.reactions[k].moment));
  }
}

Mix touching() {
  Mix mix;
  mix.contact = R"({"type": "coulomb", "friction": 0.2})", mix.close = true;
  mix.more = R"(, "output": {"reactions": true})";
  return mix;
}

}  // namespace

TEST_CASE("a run with graphs has the bytes of a run without", "[device][graphs]") {
  for (const int dimension : {2, 3})
    for (const std::string every : {"1", "3"}) {
      Mix mix = touching();
      mix.dimension = dimension;
      INFO(dimension << "-D, a ledger every " << every << " steps");
      // Steps that the ledger takes and those around them are three kinds, each of which begins without a graph.
      const std::vector<std::string> overrides{set("/output/ledger_every", every),
                                               set("/solver/end_time", every == "1" ? "0.126" : "0.252")};
      const Run plain = run(mix.text(), false, overrides), found = run(mix.text(), true, overrides);
      check_same(plain, found);
      CHECK(plain.graph_launches == 0);
      CHECK(found.graph_launches >= (every == "1" ? found.steps - 3 : 1));
      CHECK(found.launches < plain.launches / 2);
    }
}

TEST_CASE("the host waits for the device once a step, and not at all within one", "[device][graphs]") {
  const Mix mix = touching();
  for (const bool graphs : {false, true}) {
    const Run found = run(mix.text(), graphs);
    CHECK(found.steps >= 10);
    CHECK(found.synchronisations == found.steps);
  }
}

TEST_CASE("formulas of loads and of grips are evaluated without the host, in graphs too", "[device][graphs]") {
  for (const std::string& setting :
       {set("/body_force", R"(["x", 0])"), set("/body_force", R"J(["0.1*t", "X+sin(9*t*y)"])J"),
        std::string(R"(/loads=[{"type": "body_force", "body": "b", "acceleration": ["0.1*t-X", 0]}])"),
        std::string(R"J(/loads=[{"type": "spring", "body": "b", "where": {"type": "half_space", "point": [0.52, 0],
            "normal": [1, 0]}, "stiffness": [2e3, 1e3]}])J"),
        std::string(R"(/loads=[{"type": "force", "body": "a", "at": [0.31, 0.43], "force": ["5*t", 2]}])"),
        std::string(R"J(/loads=[{"type": "spring", "body": "b", "where": {"type": "half_space", "point": [0.52, 0],
            "normal": [1, 0]}, "stiffness": [2e3, 1e3], "damping": [50, 100]}, {"type": "pressure", "body": "a",
            "where": {"type": "half_space", "point": [0.31, 0], "normal": [1, 0]}, "pressure": "400+sin(9*t)*X"}])J"),
        std::string(R"J(/grips=[{"body": "a", "velocity": ["1.2+t-0.9*(Y-0.4)", null],
            "where": {"type": "half_space", "point": [0.22, 0], "normal": [1, 0]}}])J")}) {
    INFO(setting);
    const Run plain = run(touching().text(), false, {setting}), found = run(touching().text(), true, {setting});
    check_same(plain, found);
    for (const Run* any : {&plain, &found}) CHECK(any->synchronisations == any->steps);
    CHECK(found.graph_launches >= found.steps - 3);
  }
}

TEST_CASE("nodes look at particles without the host, in graphs too", "[device][graphs]") {
  const std::string gap = set("/contact/normal", "\"widest_gap\""),
                    surfaces = set("/contact/detection", "\"particle_surfaces\"");
  const std::vector<std::vector<std::string>> asked{
      {gap},
      {surfaces},
      {gap, surfaces},
      {set("/contact/normal", "\"logistic_regression\""), surfaces, set("/shape/type", "\"cpdi\"")}};
  for (const std::vector<std::string>& settings : asked)
    for (const int dimension : {2, 3}) {
      if (dimension == 3 && settings.size() != 2) continue;
      INFO(dimension << "-D " << settings.front());
      Mix mix = touching();
      mix.dimension = dimension;
      const Run plain = run(mix.text(), false, settings), found = run(mix.text(), true, settings);
      check_same(plain, found);
      for (const Run* any : {&plain, &found}) CHECK(any->synchronisations == any->steps);
      CHECK(found.graph_launches >= found.steps - 3);
      CHECK(found.contact_force != std::array<double, 3>{});
    }
}

TEST_CASE("glue, whose law keeps a state, runs by graphs", "[device][graphs]") {
  Mix mix = touching();
  mix.contact = R"({"type": "breakable_glue", "tension_stiffness": 1e4, "compression_stiffness": 5e4,
    "shear_stiffness": 2e4, "normal_strength": 60, "shear_strength": 90, "friction": 0.2})";
  const Run plain = run(mix.text(), false), found = run(mix.text(), true);
  check_same(plain, found);
  CHECK(found.graph_launches >= found.steps - 4);
}

TEST_CASE("steps that ask the host for something are no graphs", "[device][graphs]") {
  for (const std::string& setting :
       {set("/grid/boundaries/y_min", R"({"type": "prescribed", "velocity": ["0.1*t", 0]})"),
        set("/gravity", R"(["0.1*t", 0])")}) {
    INFO(setting);
    const Run plain = run(touching().text(), false, {setting}), found = run(touching().text(), true, {setting});
    check_same(plain, found);
    CHECK(found.graph_launches == 0);
  }
}

TEST_CASE("nodes of contact are written down in the steps that are asked for them, beside graphs of the others",
          "[device][graphs]") {
  const Experiment experiment =
      device_experiment(touching().text(), "double", {R"(/output={"frames": 2, "contact_nodes": true})"});
  device::DeviceSetup with_graphs = device_setup(), without = device_setup();
  without.graphs = false;
  Simulation plain(experiment, device_factory(without)), found(experiment, device_factory(with_graphs));
  for (Simulation* const simulation : {&plain, &found})
    simulation->observe_when([](double, long step) { return step % 5 == 0; });
  long graph_launches = -device::calls_on_host("cuGraphLaunch");
  for (int k = 1; k <= 10; ++k) {
    plain.step(), found.step();
    if (k % 5 > 0) {
      CHECK((plain.backend().contact_nodes().empty() && found.backend().contact_nodes().empty()));
      continue;
    }
    const std::vector<ContactNode>&expected = plain.backend().contact_nodes(), &nodes = found.backend().contact_nodes();
    REQUIRE(!expected.empty());
    REQUIRE(nodes.size() == expected.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      CHECK(nodes[i].node == expected[i].node);
      CHECK(nodes[i].force == expected[i].force);
    }
  }
  graph_launches += device::calls_on_host("cuGraphLaunch");
  CHECK(graph_launches >= 4);
}

TEST_CASE("steps beside walls that move evenly are graphs", "[device][graphs]") {
  const std::string even = set("/grid/boundaries/y_min", R"({"type": "prescribed", "velocity": ["0.1*x", 0.05]})");
  const Run plain = run(touching().text(), false, {even}), found = run(touching().text(), true, {even});
  check_same(plain, found);
  CHECK(found.graph_launches >= found.steps - 3);
}

TEST_CASE("a step of another length, and one with a filter, run beside graphs", "[device][graphs]") {
  Mix mix = touching();
  mix.filter = R"({"type": "fmpm", "order": 2, "every_steps": 5})";
  const std::vector<std::string> overrides{
      set("/solver/end_time", "0.121")};  // the last step is shorter, and not filtered
  const Run plain = run(mix.text(), false, overrides), found = run(mix.text(), true, overrides);
  check_same(plain, found);
  CHECK(found.graph_launches > 0);
  CHECK(found.graph_launches < found.steps - 3);
}

TEST_CASE("a filter's loop runs by graphs, but with a tolerance, where the host waits for the norm of each pass",
          "[device][graphs]") {
  for (const std::string order : {"last", "modified_last"})
    for (const std::string& filter : {R"({"type": "fmpm", "order": 4)"s, R"({"type": "xpic", "order": 3)"s,
                                      R"({"type": "fmpm", "order": 2, "constraints": "at_end")"s}) {
      INFO(filter << ", " << order);
      Mix mix = touching();
      mix.filter = filter + "}", mix.stress_update = order;
      const Run plain = run(mix.text(), false), found = run(mix.text(), true);
      check_same(plain, found);
      for (const Run* any : {&plain, &found}) CHECK(any->synchronisations == any->steps);
      CHECK(found.graph_launches >= found.steps - 3);
      mix.filter = filter + R"(, "tolerance": 1e-9})";
      const Run waits = run(mix.text(), true);
      CHECK(waits.synchronisations >= 2 * waits.steps);
      CHECK(waits.graph_launches == 0);
    }
}

TEST_CASE("while a graph is made the host driver refuses what no graph can hold", "[device][graphs]") {
  const device::DeviceSetup setup = device_setup();
  const device::Driver& driver = *setup.driver;
  device::Device device(driver, 0);
  device::DeviceArray<int> array(device, "an array", 4);
  array.upload({1, 2, 3, 4});
  const auto pointer = static_cast<device::DevicePointer>(reinterpret_cast<std::uintptr_t>(array.data()));

  // A graph's work is not done while it is made, and at each launch again.
  device.begin_capture();
  device.fill(pointer, 0, 4);
  device.copy(pointer + 8, pointer + 4, 4);
  const device::GraphExecHandle graph = device.end_capture();
  CHECK(array.download() == std::vector<int>{1, 2, 3, 4});
  device.launch(graph);
  CHECK(array.download() == std::vector<int>{0, 2, 2, 4});
  array.upload({5, 6, 7, 8});
  device.launch(graph);
  CHECK(array.download() == std::vector<int>{0, 6, 6, 8});
  device.free(graph);

  const auto refused = [&](auto doing) {
    device.begin_capture();
    CHECK_THROWS_WITH(doing(), ContainsSubstring("CUDA_ERROR_STREAM_CAPTURE_UNSUPPORTED"));
    CHECK_THROWS_WITH(device.end_capture(), ContainsSubstring("CUDA_ERROR_STREAM_CAPTURE_INVALIDATED"));
  };
  int value = 0;
  refused([&] { device.synchronise(); });
  refused([&] { device.read(&value, pointer, 4); });
  refused([&] { device.copy_in(pointer, &value, 4); });
  refused([&] { device.allocate(4, "more"); });
  device.begin_capture();
  CHECK_THROWS_WITH(device.begin_capture(), ContainsSubstring("CUDA_ERROR_ILLEGAL_STATE"));
  device.abandon_capture();
  CHECK_THROWS_WITH(device.end_capture(), ContainsSubstring("CUDA_ERROR_ILLEGAL_STATE"));
  CHECK(array.download() == std::vector<int>{0, 6, 6, 8});
}

TEST_CASE("a particle that cannot go on stops a run with graphs at the same step", "[device][graphs]") {
  Mix mix = touching();
  mix.boundaries = R"({"all": "free"})", mix.transfer = R"({"type": "pic"})", mix.more = "";
  const Experiment experiment = device_experiment(mix.text(), "double", {set("/solver/end_time", "0.9")});
  std::vector<std::pair<long, Failure>> stops;
  for (const bool graphs : {false, true}) {
    device::DeviceSetup setup = device_setup();
    setup.graphs = graphs, setup.steps_to_forget = 16;  // steps that forget the grid are graphs of their own
    Simulation simulation(experiment, device_factory(setup));
    try {
      while (!simulation.finished()) simulation.step();
    } catch (const RunFailure& stopped) {
      stops.emplace_back(simulation.steps(), stopped.failure);
    }
  }
  REQUIRE(stops.size() == 2);
  CHECK(stops[0].first > 5);
  CHECK(stops[0].first == stops[1].first);
  CHECK(stops[0].second.cause == stops[1].second.cause);
  CHECK(stops[0].second.particle == stops[1].second.particle);
  CHECK(stops[0].second.value == stops[1].second.value);
}

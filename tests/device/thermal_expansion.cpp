// A material that reads the temperature, on every backend. A block that fills a channel from its end to an open face
// would expand by alpha (T - T0) on all sides and cannot: all its stresses are -(3 lambda + 2 mu) alpha (T - T0), those
// along z in plane strain included. Along the open face nothing holds it, so that its first step gains the momentum
// pressure x area x dt. Particles stand in the middle of half cells, where the sum over particles of the quadratic
// spline's gradients is its integral.

#include <fstream>
#include <iterator>

#include "device/device_support.hpp"
#include "metrics/particle_quantities.hpp"
#include "plugin/sdk.hpp"
#include "support/results.hpp"
#include "support/thermoelastic.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double bulk = 1000 / (1 - 2 * 0.3);  ///< Pa, 3 lambda + 2 mu = E / (1 - 2 nu)
constexpr double dt = 1e-4, expansion = 1e-3, warmer = 10;
constexpr double pressure = bulk * expansion * warmer;                             ///< Pa
constexpr double energy = 1.5 * bulk * expansion * warmer * (expansion * warmer);  ///< J/m^3, sigma : eps / 2

/// The plugins of the build and the fixture.
const ComponentLookup& components() {
  static const std::string source = [] {
    std::ifstream file(MPM_SOURCE_DIR "/tests/support/thermoelastic.hpp");
    return std::string(std::istreambuf_iterator<char>(file), {});
  }();
  static const mpm_descriptor descriptor = sdk::material<Thermoelastic>(
      {"thermoelastic", "1.0.0", "a fixture", "none", "for tests", "test::Thermoelastic"}, source.c_str());
  static const Plugin fixture{&descriptor, "test"};
  static const ComponentLookup lookup([] {
    std::vector<const Plugin*> all{&fixture};
    for (const Plugin& plugin : plugins().plugins()) all.push_back(&plugin);
    return all;
  }());
  return lookup;
}

struct Machine {
  std::string backend, precision;
  double rounding() const { return precision == "double" ? 1e-12 : 2e-5; }
};
const std::vector<Machine> machines{
    {"reference", "double"}, {"cpu", "double"}, {"cpu", "float"}, {"device", "double"}, {"device", "float"}};

Experiment read(const std::string& text, const Machine& machine, std::vector<std::string> overrides) {
  const bool on_device = machine.backend == "device";
  overrides.push_back("/backend=" + (on_device ? "reference" : machine.backend));
  overrides.push_back("/precision=" + (on_device ? "double" : machine.precision));
  ReadOptions options;
  options.solvers = solver_descriptions();
  options.overrides = overrides;
  Experiment experiment = read_experiment_text(text, "test.json", components(), options);
  if (on_device) {
    experiment.backend = "cuda";
    if (machine.precision == "float") experiment.precision = Precision::single;
  }
  return experiment;
}

class Run {
 public:
  Run(const std::string& text, const Machine& machine, const std::vector<std::string>& overrides = {})
      : experiment(read(text, machine, overrides)), simulation(experiment, factory(machine)), metrics(simulation) {}
  Totals steps(int count) {
    for (int k = 0; k < count; ++k) simulation.step();
    return metrics.measure();
  }
  BodyState body() const { return simulation.backend().body_state(0); }
  /// Temperatures of 300 K at the scales that state_difference has: 30 K, and 1 for what a material keeps.
  BodyState scaled_body() const {
    BodyState state = body();
    for (double& T : state.material_state.at("strained_at")) T /= 300;
    for (auto& [name, values] : state.host_state)
      if (name.starts_with("temperature"))
        for (double& T : values) T /= 10;
    return state;
  }

  const Experiment experiment;
  Simulation simulation;
  Metrics metrics;

 private:
  static BackendFactory factory(const Machine& machine) {
    if (machine.backend != "device") return backend_factory(1);
    return device_factory();
  }
};

/// Without `thermal` the scene has no temperature.
std::string block(int dimension, const std::string& thermal, double alpha = expansion) {
  const std::string more = dimension == 3 ? ", 0.4" : "", zero = dimension == 3 ? "0, 0, 0" : "0, 0";
  const std::string temperature = thermal.empty() ? "" : R"(, "temperature": 310)";
  return R"({"dimension": )" + std::to_string(dimension) + R"(, "grid": {"cell_size": 0.1, "domain": [[)" + zero +
         "], [0.8, 0.4" + more + R"(]], "boundaries": {"all": "slip"}}, "shape": {"type": "bspline_quadratic"},
         "transfer": {"type": "apic"}, "materials": {"m": {"type": "thermoelastic", "youngs_modulus": 1000,
         "poisson_ratio": 0.3, "density": 1000, "heating": 1e9, "expansion": )" +
         digits(alpha) + thermal + R"(}}, "bodies": [{"name": "a", "material": "m")" + temperature +
         R"(, "geometry": {"type": "box", "lower": [)" + zero + "], \"upper\": [0.4, 0.4" + more +
         R"(]}}], "solver": {"time_step": )" + digits(dt) + R"(, "end_time": 1}})";
}
const std::string conducts = R"(, "thermal": {"conductivity": 500, "heat_capacity": 10, "dissipation_to_heat": 1})";

}  // namespace

TEST_CASE("a warm block that cannot expand presses with (3 lambda + 2 mu) alpha (T - T0)", "[device]") {
  for (const Machine& machine : machines)
    for (const int dimension : {2, 3}) {
      INFO(machine.backend << " " << machine.precision << " " << dimension << "-D");
      const double area = dimension == 2 ? 0.4 : 0.16;
      Run run(block(dimension, conducts), machine);
      CHECK(run.metrics.initial().strain == Approx(energy * 0.4 * area).epsilon(machine.rounding()));
      for (const double p : quantity(run.experiment, 0, run.body(), "pressure"))
        REQUIRE(p == Approx(pressure).epsilon(machine.rounding()));
      CHECK(run.steps(1).momentum[0] == Approx(pressure * area * dt).epsilon(machine.rounding()));
    }
}

TEST_CASE("a material is strained at the temperature that its dissipation has not warmed yet", "[device]") {
  // 1e9 W/m^3 over dt warm 1000 kg/m^3 of 10 J/(kg K) by 10 K.
  for (const Machine& machine : machines) {
    INFO(machine.backend << " " << machine.precision);
    Run run(block(2, conducts), machine);
    for (const double strained_at : {310, 320}) {
      run.steps(1);
      const BodyState state = run.body();
      for (const double T : state.material_state.at("strained_at"))
        REQUIRE(T == Approx(strained_at).epsilon(machine.rounding()));
      for (const double T : state.host_state.at("temperature"))
        REQUIRE(T == Approx(strained_at + 10).epsilon(machine.rounding()));
    }
  }
}

TEST_CASE("without a temperature in the scene such a material is at its reference", "[device]") {
  for (const Machine& machine : machines) {
    INFO(machine.backend << " " << machine.precision);
    const std::vector<std::string> moves{"/gravity=[3, -9.81]"};
    Run warm(block(2, ""), machine, moves), rigid(block(2, "", 0), machine, moves);
    const Totals a = warm.steps(20), b = rigid.steps(20);
    CHECK(different(all_results(warm.simulation), all_results(rigid.simulation)) == 0);
    CHECK(a.strain == b.strain);
    CHECK(a.strain > 0);
    const BodyState state = warm.body();
    for (const double T : state.material_state.at("strained_at")) REQUIRE(T == 300);
  }
}

TEST_CASE("backends agree on a material that reads the temperature, melts and moves", "[device]") {
  const std::string melts = R"(, "thermal": {"conductivity": 500, "heat_capacity": 10, "phase_change": {
    "temperature": 312, "latent_heat": 100, "melted": {"heat_capacity": 15, "youngs_modulus": 600, "expansion": 5e-4}}})";
  const std::vector<std::string> moves{
      "/gravity=[3, -9.81]", "/bodies/0/temperature=\"306 + 20*x + 5*sin(20*y)\"", "/materials/m/heating=0",
      R"(/grid/boundaries/x_min={"type": "slip", "temperature": 316})", "/solver/time_step=0.005"};
  Run expected(block(2, melts), machines[0], moves);
  const Totals end = expected.steps(14);
  CHECK(end.latent_heat > expected.metrics.initial().latent_heat);
  CHECK(expected.simulation.ledger().material != 0);
  for (const Machine& machine : machines) {
    INFO(machine.backend << " " << machine.precision);
    Run run(block(2, melts), machine, moves);
    const Totals totals = run.steps(14);
    const double epsilon = epsilon_of(machine.precision);
    CHECK(state_difference(expected.experiment, expected.scaled_body(), run.scaled_body()) < 1e3 * epsilon);
    CHECK(std::abs(run.simulation.ledger().material - expected.simulation.ledger().material) <
          1e3 * epsilon * end.strain);
    CHECK(std::abs(totals.strain - end.strain) < 1e3 * epsilon * end.strain);
  }
}

TEST_CASE("the plan says that a material is handed the temperature, where there is one", "[device]") {
  const auto operators_that_read = [](const std::string& thermal) {
    std::set<std::string> names;
    const Plan plan = make_plan(read(block(2, thermal), machines[0], {"/solver/time_step=auto"}));
    for_each_pass(plan.step, [&](const Pass& pass) {
      for (const Operator& operation : pass.operators)
        if (std::count(operation.reads.begin(), operation.reads.end(), "particles/temperature"))
          names.insert(std::to_string(static_cast<int>(operation.act)));
    });
    return names;
  };
  const auto number = [](Act act) { return std::to_string(static_cast<int>(act)); };
  for (const Act act : {Act::strain, Act::scatter_force, Act::estimate_time_step, Act::gather_heat})
    CHECK(operators_that_read(conducts).count(number(act)) == 1);
  CHECK(operators_that_read("").empty());
}

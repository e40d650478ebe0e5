// The books of the energy ledger in programs with a fault: each fault shows in its own book, on every backend, and in no
// other. Without a fault all books agree.

#include <cmath>
#include <fstream>
#include <iterator>

#include "device/device_support.hpp"
#include "faults/injected.hpp"
#include "faults/lying_metal.hpp"
#include "plugin/sdk.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(MPM_SOURCE_DIR "/" + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The plugins of the build and the lying metal.
const ComponentLookup& components() {
  static const std::string source = [] {
    std::string metal = text_of("tests/faults/lying_metal.hpp");
    const std::size_t include = metal.find("#include");
    metal.erase(include, metal.find('\n', include) - include);
    return text_of("modules/materials/von_mises/von_mises.hpp") + metal;
  }();
  static const mpm_descriptor descriptor = sdk::material<LyingMetal>(
      {"lying_metal", "1.0.0", "a fixture", "none", "for tests", "test::LyingMetal"}, source.c_str());
  static const Plugin fixture{&descriptor, "test"};
  static const ComponentLookup lookup([] {
    std::vector<const Plugin*> all{&fixture};
    for (const Plugin& plugin : plugins().plugins()) all.push_back(&plugin);
    return all;
  }());
  return lookup;
}

/// Two bodies that press against each other and against the walls, where asked for filtered in every step.
std::string scene(const std::string& material, bool filtered) {
  Mix mix;
  mix.transfer = R"({"type": "pic"})";
  if (filtered) mix.filter = R"({"type": "fmpm", "order": 2})";
  mix.contact = R"({"type": "coulomb", "friction": 0.3})";
  mix.material = R"({"type": ")" + material +
                 R"(", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 20})";
  mix.close = true;
  return mix.text();
}

struct Books {
  Ledger ledger;
  Totals start;
  double residual = 0;
};

Books run(const std::string& backend, Fault fault, const std::string& material = "von_mises", bool filtered = true) {
  injected = fault;
  ReadOptions options;
  options.solvers = solver_descriptions();
  const bool on_device = backend == "device";
  options.overrides = {"/backend=" + (on_device ? "reference" : backend), "/precision=double"};
  Experiment experiment = read_experiment_text(scene(material, filtered), "test.json", components(), options);
  if (on_device) experiment.backend = "cuda";
  device::DeviceSetup setup = device_setup();
  setup.compile = [&](const device::Composition& composition, const std::string&) {
    device::HostCompiler compiler;
    compiler.options = {"-O1", "-DMPM_FAULT=" + std::to_string(static_cast<int>(fault))};
    return compiler.compile(composition);
  };
  Simulation simulation(experiment, on_device ? device_factory(setup) : backend_factory(1));
  const Metrics metrics(simulation);
  while (!simulation.finished()) simulation.step();
  injected = Fault::none;
  return {simulation.ledger(), metrics.initial(), metrics.ledger_residual(metrics.measure())};
}

const std::vector<std::string> backends{"reference", "cpu", "device"};
constexpr double rounding = 1e-12, seen = 1e-6;  ///< relative to the kinetic energy, mass or momentum at the start

bool grid_agrees(const Books& books) {
  return std::abs(books.ledger.grid_book) < rounding * books.start.kinetic;
}
bool filter_agrees(const Books& books) {
  return std::abs(books.ledger.filter_book) < rounding * books.start.kinetic;
}
bool scatter_agrees(const Books& books) {
  return std::abs(books.ledger.mass_book) < rounding * books.start.mass &&
         books.ledger.momentum_book < rounding * books.start.momentum_scale;
}

}  // namespace

TEST_CASE("without a fault all books agree", "[ledger][faults]") {
  for (const std::string& backend : backends) {
    INFO(backend);
    const Books books = run(backend, Fault::none);
    CHECK(std::abs(books.ledger.grid_book) < rounding * books.start.kinetic);
    CHECK(std::abs(books.ledger.filter_book) < rounding * books.start.kinetic);
    CHECK(std::abs(books.ledger.mass_book) < rounding * books.start.mass);
    CHECK(books.ledger.momentum_book < rounding * books.start.momentum_scale);
  }
}

TEST_CASE("a condition or a contact that does not give what it records shows in the book of the grid",
          "[ledger][faults]") {
  for (const std::string& backend : backends) {
    const Books right = run(backend, Fault::none, "von_mises", false);
    for (const Fault fault : {Fault::wall, Fault::contact}) {
      INFO(backend << " fault " << static_cast<int>(fault));
      const Books books = run(backend, fault, "von_mises", false);
      CHECK(std::abs(books.ledger.grid_book) > seen * books.start.kinetic);
      CHECK(scatter_agrees(books));
      // The residual of the whole sees it too.
      CHECK(std::abs(books.residual - right.residual) > seen * books.start.kinetic);
    }
  }
}

TEST_CASE("a filter that adds to the velocity shows in the book of the filter", "[ledger][faults]") {
  for (const std::string& backend : backends) {
    INFO(backend);
    const Books books = run(backend, Fault::filter), right = run(backend, Fault::none);
    CHECK(grid_agrees(books));
    CHECK(std::abs(books.ledger.filter_book) > seen * books.start.kinetic);
    CHECK(scatter_agrees(books));
    CHECK(std::abs(books.residual - right.residual) > seen * books.start.kinetic);
  }
}

TEST_CASE("a scatter that loses what it gave shows in the books of mass and momentum", "[ledger][faults]") {
  for (const std::string& backend : backends) {
    INFO(backend);
    const Books books = run(backend, Fault::scatter);
    CHECK(grid_agrees(books));
    CHECK(filter_agrees(books));
    CHECK(std::abs(books.ledger.mass_book) > seen * books.start.mass);
    CHECK(books.ledger.momentum_book > seen * books.start.momentum_scale);
  }
}

TEST_CASE("a material that dissipates less than it says shows in the book of the materials", "[ledger][faults]") {
  for (const std::string& backend : backends) {
    INFO(backend);
    const Books right = run(backend, Fault::none), books = run(backend, Fault::none, "lying_metal");
    CHECK(grid_agrees(books));
    CHECK(filter_agrees(books));
    CHECK(scatter_agrees(books));
    const double dissipated = right.ledger.material;
    CHECK(books.ledger.material == Approx(dissipated / 0.95).epsilon(1e-9));
    CHECK(books.ledger.material_book - right.ledger.material_book ==
          Approx(-(1 / 0.95 - 1) * dissipated).epsilon(1e-6));
    CHECK(books.residual - right.residual == Approx((1 / 0.95 - 1) * dissipated).epsilon(1e-6));
  }
}

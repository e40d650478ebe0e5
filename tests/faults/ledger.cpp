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

/// A backend with one of its scalars and dimensions. The reference backend has no float.
struct Variant {
  std::string backend, precision;
  int dimension;

  std::string name() const { return backend + ", " + std::to_string(dimension) + "-D, " + precision; }
  /// Relative to the kinetic energy, mass or momentum at the start.
  double rounding() const { return precision == "double" ? 1e-12 : 3e-6; }
};
const std::vector<Variant> variants_of_backends{
    {"reference", "double", 2}, {"reference", "double", 3}, {"cpu", "double", 2},    {"cpu", "double", 3},
    {"cpu", "float", 2},        {"cpu", "float", 3},        {"device", "double", 2}, {"device", "double", 3},
    {"device", "float", 2},     {"device", "float", 3}};

/// How far a fault is to show, relative to the same.
constexpr double seen = 2e-5;

enum class Kind { pressed, pressed_and_filtered, apart };

/// Two bodies that press against each other and against the walls, where asked for filtered in every step; or `apart`
/// from all walls.
std::string scene(int dimension, const std::string& material, Kind kind) {
  Mix mix;
  mix.dimension = dimension;
  mix.transfer = R"({"type": "pic"})";
  if (kind == Kind::pressed_and_filtered) mix.filter = R"({"type": "fmpm", "order": 2})";
  mix.contact = R"({"type": "coulomb", "friction": 0.3})";
  mix.material = R"({"type": ")" + material +
                 R"(", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 20})";
  if (kind == Kind::apart)
    mix.boundaries = R"({"all": "free"})";
  else
    mix.close = true;
  return mix.text();
}

struct Books {
  Ledger ledger;
  Totals start, end;
  double residual = 0;
  /// The momentum that gravity does not explain, kg m/s.
  double momentum_lost = 0;

  /// What strain took of the work of the nodes' forces; the rest of it is of the order of the step.
  double strain_gap() const { return ledger.internal_force + ledger.stress_power; }
};

Books run(const Variant& variant, Fault fault, Kind kind = Kind::pressed_and_filtered,
          const std::string& material = "von_mises") {
  injected = fault;
  ReadOptions options;
  options.solvers = solver_descriptions();
  const bool on_device = variant.backend == "device";
  options.overrides = {"/backend=" + (on_device ? "reference" : variant.backend),
                       "/precision=" + (on_device ? "double" : variant.precision)};
  Experiment experiment =
      read_experiment_text(scene(variant.dimension, material, kind), "test.json", components(), options);
  if (on_device) {
    experiment.backend = "cuda";
    if (variant.precision == "float") experiment.precision = Precision::single;
  }
  Simulation simulation(experiment, on_device ? device_factory() : backend_factory(1));
  const Metrics metrics(simulation);
  while (!simulation.finished()) simulation.step();
  injected = Fault::none;
  Books books{simulation.ledger(), metrics.initial(), metrics.measure()};
  books.residual = metrics.ledger_residual(books.end);
  for (int axis = 0; axis < variant.dimension; ++axis)
    books.momentum_lost =
        std::hypot(books.momentum_lost, books.end.momentum[axis] - books.start.momentum[axis] -
                                            books.start.mass * experiment.gravity_at(0)[axis] * simulation.time());
  return books;
}

void check_grid_agrees(const Variant& variant, const Books& books) {
  CHECK(std::abs(books.ledger.grid_book) < variant.rounding() * books.start.kinetic);
}
void check_filter_agrees(const Variant& variant, const Books& books) {
  CHECK(std::abs(books.ledger.filter_book) < variant.rounding() * books.start.kinetic);
}
void check_scatter_agrees(const Variant& variant, const Books& books) {
  CHECK(std::abs(books.ledger.mass_book) < variant.rounding() * books.start.mass);
  CHECK(books.ledger.momentum_book < variant.rounding() * books.start.momentum_scale);
}
/// The residual tells of the fault.
void check_residual(const Books& books, const Books& right) {
  CHECK(std::abs(books.residual - right.residual) > seen * books.start.kinetic);
}
/// The entry of a transfer has the fault, and the residual does not tell of it: an entry is the difference of the energies on
/// both sides, whatever made it. The other motion that follows from the fault has another residual, a quarter of that at most.
void check_entry(const Books& books, const Books& right, double Ledger::*entry) {
  const double in_entry = std::abs(books.ledger.*entry - right.ledger.*entry);
  CHECK(in_entry > seen * books.start.kinetic);
  CHECK(std::abs(books.residual - right.residual) < 0.25 * in_entry);
}

}  // namespace

extern "C" int mpm_fault_now() {
  return static_cast<int>(injected);
}

TEST_CASE("without a fault all books agree", "[ledger][faults]") {
  for (const Variant& variant : variants_of_backends) {
    const Books books = run(variant, Fault::none);
    const double energy = books.start.kinetic;
    INFO(variant.name() << ": grid " << books.ledger.grid_book / energy << ", filter "
                        << books.ledger.filter_book / energy << ", mass " << books.ledger.mass_book / books.start.mass
                        << ", momentum " << books.ledger.momentum_book / books.start.momentum_scale);
    check_grid_agrees(variant, books);
    check_filter_agrees(variant, books);
    check_scatter_agrees(variant, books);
  }
}

TEST_CASE("a condition or a contact that does not give what it records shows in the book of the grid",
          "[ledger][faults]") {
  for (const Variant& variant : variants_of_backends) {
    const Books right = run(variant, Fault::none, Kind::pressed);
    for (const Fault fault : {Fault::wall, Fault::contact}) {
      INFO(variant.name() << ", fault " << static_cast<int>(fault));
      const Books books = run(variant, fault, Kind::pressed);
      CHECK(std::abs(books.ledger.grid_book) > seen * books.start.kinetic);
      check_scatter_agrees(variant, books);
      check_residual(books, right);  // the residual of the whole sees it too
    }
  }
}

TEST_CASE("a condition or a contact that does not give what it records in a filter's loop shows in the filter's book",
          "[ledger][faults]") {
  for (const Variant& variant : variants_of_backends)
    for (const Fault fault : {Fault::wall, Fault::contact}) {
      INFO(variant.name() << ", fault " << static_cast<int>(fault));
      const Books books = run(variant, fault, Kind::pressed_and_filtered);
      CHECK(std::abs(books.ledger.grid_book) > seen * books.start.kinetic);
      // A wall takes little within the loop, so that its book tells of a hundredth of it beyond float's rounding alone.
      if (fault == Fault::contact) CHECK(std::abs(books.ledger.filter_book) > seen * books.start.kinetic);
      if (variant.precision == "double") CHECK(std::abs(books.ledger.filter_book) > 1e-6 * books.start.kinetic);
      check_scatter_agrees(variant, books);
    }
}

TEST_CASE("a filter that adds to the velocity shows in the book of the filter", "[ledger][faults]") {
  for (const Variant& variant : variants_of_backends) {
    INFO(variant.name());
    const Books books = run(variant, Fault::filter), right = run(variant, Fault::none);
    check_grid_agrees(variant, books);
    CHECK(std::abs(books.ledger.filter_book) > seen * books.start.kinetic);
    check_scatter_agrees(variant, books);
    check_residual(books, right);
  }
}

TEST_CASE("a scatter that loses what it gave shows in the books of mass and momentum", "[ledger][faults]") {
  for (const Variant& variant : variants_of_backends) {
    const Books books = run(variant, Fault::scatter), right = run(variant, Fault::none);
    INFO(variant.name() << ": mass " << books.ledger.mass_book / books.start.mass << ", momentum "
                        << books.ledger.momentum_book / books.start.momentum_scale << ", residual "
                        << (books.residual - right.residual) / books.start.kinetic);
    check_grid_agrees(variant, books);
    check_filter_agrees(variant, books);
    CHECK(std::abs(books.ledger.mass_book) > seen * books.start.mass);
    CHECK(books.ledger.momentum_book > seen * books.start.momentum_scale);
    check_entry(books, right, &Ledger::scatter);
  }
}

// All books agree: what is missing is what the particles took of the strain, the difference of the entries "internal
// force" and "stress power", and the residual is larger by it.
TEST_CASE("a gather of too little strain shows between the work of the forces and that of the stresses",
          "[ledger][faults]") {
  for (const Variant& variant : variants_of_backends) {
    const Books books = run(variant, Fault::strain, Kind::pressed), right = run(variant, Fault::none, Kind::pressed);
    const double gap = books.strain_gap() - right.strain_gap();
    INFO(variant.name() << ": gap " << gap / books.start.kinetic << ", residual "
                        << (books.residual - right.residual) / books.start.kinetic);
    check_grid_agrees(variant, books);
    check_scatter_agrees(variant, books);
    CHECK(std::abs(gap) > seen * books.start.kinetic);
    check_residual(books, right);
    CHECK(books.residual - right.residual == Approx(gap).epsilon(0.1));
  }
}

// The energy that a gather of velocities loses is the entry "gather", whatever the reason, so that the residual cannot
// know. Momentum does: the scatter's book agrees, no wall gives any, and particles have less than they had.
TEST_CASE("a gather that loses velocity shows in the entry of the gather and in the momentum", "[ledger][faults]") {
  for (const Variant& variant : variants_of_backends) {
    const Books books = run(variant, Fault::gather, Kind::apart), right = run(variant, Fault::none, Kind::apart);
    INFO(variant.name() << ": momentum lost " << right.momentum_lost / right.start.momentum_scale << ", "
                        << books.momentum_lost / books.start.momentum_scale << "; gather "
                        << right.ledger.gather / right.start.kinetic << ", "
                        << books.ledger.gather / books.start.kinetic << "; residual "
                        << (books.residual - right.residual) / books.start.kinetic);
    CHECK(right.momentum_lost < variant.rounding() * right.start.momentum_scale);
    CHECK(books.momentum_lost > seen * books.start.momentum_scale);
    CHECK(books.ledger.gather < right.ledger.gather);
    check_entry(books, right, &Ledger::gather);
    check_grid_agrees(variant, books);
    check_scatter_agrees(variant, books);
  }
}

TEST_CASE("a material that dissipates less than it says shows in the book of the materials", "[ledger][faults]") {
  for (const Variant& variant : variants_of_backends) {
    INFO(variant.name());
    const Books right = run(variant, Fault::none),
                books = run(variant, Fault::none, Kind::pressed_and_filtered, "lying_metal");
    check_grid_agrees(variant, books);
    check_filter_agrees(variant, books);
    check_scatter_agrees(variant, books);
    const double dissipated = right.ledger.material, exact = variant.precision == "double" ? 1 : 1e3;
    CHECK(books.ledger.material == Approx(dissipated / 0.95).epsilon(exact * 1e-9));
    CHECK(books.ledger.material_book - right.ledger.material_book ==
          Approx(-(1 / 0.95 - 1) * dissipated).epsilon(exact * 1e-6));
    CHECK(books.residual - right.residual == Approx((1 / 0.95 - 1) * dissipated).epsilon(exact * 1e-6));
  }
}

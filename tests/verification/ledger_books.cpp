// The books of the energy ledger: what each part of a step records where it acts must explain what is measured apart
// from it. Kinetic energy of the nodes against works of impulses, stress power against stored and dissipated energy,
// mass and momentum of nodes against those of particles; and the whole, whose residual falls with the step.

#include <algorithm>
#include <cmath>

#include "parity/parity.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Two bodies of the parity scenes with these choices; the walls take part where the domain is close.
struct Case {
  std::string transfer, filter, contact, update, boundaries;
  bool close = false;
};

std::vector<Case> cases() {
  const std::string coulomb = R"({"type": "coulomb", "friction": 0.3})", stick = R"({"type": "stick"})";
  const std::string moving = R"({"x_min": {"type": "prescribed", "velocity": [0.4, 0.1]}, "x_max": "stick",
                                 "y_min": "separate", "y_max": "slip", "z_min": "slip", "z_max": "separate"})";
  std::vector<Case> all;
  for (const std::string update : {"last", "first", "modified_last", "averaged"})
    for (const std::string filter :
         {"", R"({"type": "fmpm", "order": 3})", R"({"type": "fmpm", "order": 3, "constraints": "kept_impulses"})",
          R"({"type": "fmpm", "order": 3, "constraints": "at_end"})",
          R"({"type": "fmpm", "order": 2, "every_steps": 3})", R"({"type": "xpic", "order": 3})"}) {
      all.push_back({"apic", filter, coulomb, update, R"({"all": "slip"})"});
      all.push_back({"flip", filter, coulomb, update, R"({"all": "separate"})", true});
      all.push_back({"pic", filter, stick, update, moving, true});
      all.push_back({"mls", filter, "", update, moving, true});
    }
  return all;
}

Mix mix_of(const Case& now, int dimension) {
  Mix mix;
  mix.dimension = dimension;
  mix.transfer = "{\"type\": \"" + now.transfer + "\"}";
  mix.filter = now.filter, mix.contact = now.contact, mix.stress_update = now.update, mix.boundaries = now.boundaries;
  const std::size_t z = mix.boundaries.find(", \"z_min\""), velocity = mix.boundaries.find("0.1]");
  if (dimension == 2 && z != mix.boundaries.npos) mix.boundaries = mix.boundaries.substr(0, z) + "}";
  if (dimension == 3 && velocity != mix.boundaries.npos) mix.boundaries.insert(velocity + 3, ", 0");
  mix.close = now.close;
  const bool flat = dimension == 2;
  mix.more = std::string(R"(, "node_conditions": [{"type": "prescribed", "lower": )") +
             (flat ? R"([0.2, 0.3], "upper": [0.4, 0.5], "velocity": [1.2, null]}])"
                   : R"([0.2, 0.1, 0.2], "upper": [0.4, 0.3, 0.4], "velocity": [1.2, null, null]}])");
  return mix;
}

}  // namespace

TEST_CASE("the works of recorded impulses explain the kinetic energy of the nodes, and nodes get what particles give",
          "[ledger][ledger_books]") {
  int tried = 0;
  for (const int dimension : {2, 3})
    for (const Case& now : cases()) {
      const Mix mix = mix_of(now, dimension);
      if (is_refused(mix)) continue;
      for (const auto& [backend, precision] :
           {std::pair{"reference", "double"}, std::pair{"cpu", "double"}, std::pair{"cpu", "float"}}) {
        INFO(mix.name() << " on " << backend << " " << precision);
        ++tried;
        if (!is_chosen_check()) continue;
        Scene scene(mix.text(), {set("/backend", backend), set("/precision", precision)});
        const Totals start = scene.metrics.initial(), end = scene.run();
        const Ledger ledger = scene.simulation.ledger();
        const double steps = static_cast<double>(end.step);
        const double rounding = 64 * std::sqrt(steps) *
                                (std::string(precision) == "float" ? std::numeric_limits<float>::epsilon()
                                                                   : std::numeric_limits<double>::epsilon());
        CHECK(std::abs(ledger.grid_book) < rounding * start.kinetic);
        CHECK(std::abs(ledger.filter_book) < rounding * start.kinetic);
        CHECK(std::abs(ledger.mass_book) < rounding * std::sqrt(steps) * start.mass);
        CHECK(ledger.momentum_book < rounding * std::sqrt(steps) * start.momentum_scale);
        CHECK(std::abs(ledger.boundary) + std::abs(ledger.contact) > 1e-4 * start.kinetic);  // there are impulses
      }
    }
  CHECK(tried > 400);
}

namespace {

/// A bar that swings, resolved by 13 cells; hyperelastic, so that stress is the derivative of the stored energy.
const char* bar = R"J({
  "title": "bar", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 2, "domain": [[0, 0], [40, 2]],
           "boundaries": {"x_min": "slip", "x_max": "free", "y_min": "slip", "y_max": "slip"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 100, "poisson_ratio": 0, "density": 1}},
  "bodies": [{"name": "bar", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [26, 2]},
              "velocity": ["0.1*sin(5*pi*x/52)", 0]}],
  "solver": {"time_step": 0.02, "end_time": 4}})J";

/// The largest values in a run, over the energy at its start.
struct Largest {
  double residual = 0, material_book = 0;
};
Largest largest(const std::vector<std::string>& overrides) {
  Scene scene(bar, overrides);
  Largest found;
  while (!scene.simulation.finished()) {
    const Totals now = scene.run_steps(1);
    const double residual = std::abs(scene.metrics.ledger_residual(now)),
                 book = std::abs(scene.simulation.ledger().material_book);
    REQUIRE(std::isfinite(residual + book));
    found.residual = larger(found.residual, residual);
    found.material_book = larger(found.material_book, book);
  }
  found.residual /= scene.metrics.initial().total_energy();
  found.material_book /= scene.metrics.initial().total_energy();
  return found;
}

const std::vector<double> steps{0.02, 0.01, 0.005};

/// Checks that the residual falls at first order or faster, and the book of the material at second.
void check_orders(std::vector<std::string> overrides) {
  if (!is_chosen_check()) return;
  std::vector<double> residuals, books;
  overrides.emplace_back();
  for (const double step : steps) {
    overrides.back() = set("/solver/time_step", digits(step));
    const Largest found = largest(overrides);
    residuals.push_back(found.residual), books.push_back(found.material_book);
  }
  INFO("residuals " << residuals[0] << " " << residuals[1] << " " << residuals[2] << ", of the material " << books[0]
                    << " " << books[1] << " " << books[2]);
  CHECK(observed_order(steps, residuals) > 0.85);
  CHECK(residuals.back() < 0.03);
  CHECK(observed_order(steps, books) > 1.8);
  CHECK(books.back() < 1e-4);
}

}  // namespace

TEST_CASE("the residual of a body that is filtered in every step falls with the step", "[ledger][ledger_books]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string filter : {R"({"type": "fmpm", "order": 2})", R"({"type": "fmpm", "order": 4})",
                                     R"({"type": "fmpm", "order": 8})", R"({"type": "xpic", "order": 3})"})
      for (const std::string update : {"last", "first", "averaged", "modified_last"}) {
        INFO(backend << " " << filter << " " << update);
        check_orders({set("/backend", backend), set("/transfer/type", "pic"), set("/solver/stress_update", update),
                      "/filter=" + filter});
      }
}

TEST_CASE("the residual of every transfer and shape falls with the step", "[ledger][ledger_books]") {
  for (const std::string shape : {"linear", "bspline_quadratic", "gimp", "cpdi"})
    for (const std::string transfer : {"pic", "flip", "apic", "mls", "tpic", "rpic", "aflip", "asflip", "polypic"}) {
      if (transfer == "polypic" && shape == "cpdi") continue;  // refused: its nodes have no axes
      INFO(shape << " " << transfer);
      check_orders({set("/shape/type", shape), set("/transfer/type", transfer)});
    }
}

// A bar without mass to speak of is stretched by a wall that moves at v: the wall's work is the energy that it stores,
// E A e^2 / (2 L). Most of the wall's force comes from what lies beyond it, mirror images of the bar's end.
TEST_CASE("the work of a wall that moves is the energy that it stores", "[ledger][ledger_books]") {
  const char* stretched = R"J({
    "title": "stretched", "dimension": 2, "precision": "double", "backend": "cpu",
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 0.2]],
             "boundaries": {"x_min": "slip", "x_max": {"type": "prescribed", "velocity": [0.05, 0]},
                            "y_min": "slip", "y_max": "slip"}},
    "shape": {"type": "linear"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0, "density": 0.1}},
    "bodies": [{"name": "bar", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 0.2]},
                "velocity": ["0.05*x", 0]}],
    "solver": {"time_step": 0.0002, "end_time": 0.2}})J";
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape : {"linear", "bspline_quadratic", "bspline_cubic"})
      for (const std::string update : {"last", "first"}) {
        INFO(backend << " " << shape << " " << update);
        Scene scene(stretched,
                    {set("/backend", backend), set("/shape/type", shape), set("/solver/stress_update", update)});
        const Totals end = scene.run();
        const double stored = end.total_energy() - scene.metrics.initial().total_energy();
        CHECK(stored == Approx(0.5 * 1000 * 0.2 * 0.01 * 0.01).epsilon(0.02));  // e = v t = 0.01 m of L = 1 m
        CHECK(scene.simulation.ledger().boundary == Approx(stored).epsilon(0.02));
        CHECK(std::abs(scene.metrics.ledger_residual(end)) < 0.02 * stored);
      }
}

// A block that is dropped on a floor, and one that rests on it. The filter's loop meets the floor in every step, so that
// the filtered velocity lifts particles otherwise than the nodes' own: a row of the ledger of its own.
TEST_CASE("the residual of a filtered block that gravity presses on a floor falls with the step",
          "[ledger][ledger_books]") {
  const auto lost = [](const std::string& backend, bool drops, const std::string& transfer, const std::string& filter,
                       double step) {
    Scene scene(R"J({
      "dimension": 2, "precision": "double",
      "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]],
               "boundaries": {"x_min": "slip", "x_max": "free", "y_min": "slip", "y_max": "free"}},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "pic"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e4, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [{"name": "block", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.5, 0.5]}}],
      "gravity": [0, -4], "solver": {"time_step": 1e-3, "end_time": 0.3}})J",
                {set("/backend", backend), set("/transfer/type", transfer), set("/filter", filter),
                 set("/solver/time_step", digits(step)),
                 set("/bodies/0/geometry", drops ? R"({"type": "box", "lower": [0, 0.2], "upper": [0.5, 0.7]})"
                                                 : R"({"type": "box", "lower": [0, 0], "upper": [0.5, 0.5]})")});
    const Totals end = scene.run();
    const double lifted = std::abs(scene.simulation.ledger().filtered_gravity),
                 residual = std::abs(scene.metrics.ledger_residual(end));
    CHECK(lifted > 0.2);  // J; the residual would hold it
    CHECK(residual < 0.3 * lifted);
    return residual;
  };
  for (const auto& [transfer, filter] :
       {std::pair{"pic", R"({"type": "fmpm", "order": 4})"}, std::pair{"pic", R"({"type": "xpic", "order": 3})"},
        std::pair{"flip", R"({"type": "fmpm", "order": 4, "every_steps": 5})"}})
    for (const bool drops : {false, true})
      for (const std::string backend : {"cpu", "reference"}) {
        if (backend == "reference" && (!drops || std::string(transfer) == "flip")) continue;
        const double coarse = lost(backend, drops, transfer, filter, 1e-3),
                     fine = lost(backend, drops, transfer, filter, 2.5e-4);
        INFO(backend << " " << transfer << " " << filter << (drops ? " dropped: " : " resting: ") << coarse << " "
                     << fine);
        std::printf("  %s %s %s %s: %.4g %.4g J\n", backend.c_str(), transfer, filter, drops ? "dropped" : "resting",
                    coarse, fine);
        CHECK(fine < 0.8 * coarse);  // the waves that the floor starts are smooth in much shorter steps alone
      }
}

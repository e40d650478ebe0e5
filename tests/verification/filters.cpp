// Velocity filters. The operator that a filter repeats, S+ S, is one visit of the particles: a step of the transfer
// without time and forces. So FMPM(k) and XPIC(k) of a step are known combinations of the first k steps without a
// filter: the oracle of this file, with every shape, transfer and wall.

#include <cmath>

#include "support/catch.hpp"
#include "support/differences.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::vector<std::string> backends{"reference", "cpu"};
const std::vector<std::string> shapes{
    "linear", "bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp", "cpdi", "cpdi2"};
const std::vector<std::string> filtered_transfers{"pic", "apic", "mls", "tpic", "rpic", "polypic"};

/// Whether a transfer is of the FLIP family, which is filtered every few steps; at every step it is refused.
bool is_flip(const std::string& transfer) {
  return transfer.ends_with("flip");
}
std::vector<std::string> all_transfers() {
  std::vector<std::string> all = filtered_transfers;
  all.insert(all.end(), {"flip", "aflip", "asflip"});
  return all;
}

/// The particles have random places, and velocities that the grid cannot hold.
const char* rough = R"J({
  "title": "rough field", "dimension": 2, "precision": "double", "backend": "reference",
  "constants": {"U": 0, "W": 0},
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [0.8, 0.8]], "boundaries": {"all": "free"}},
  "shape": {"type": "linear"}, "transfer": {"type": "pic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "block", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.6, 0.4]}, "jitter": 0.3,
              "velocity": ["U + sin(37*x) - 2*cos(53*y)", "W + cos(41*x*y) + 3*x"]}],
  "solver": {"time_step": 1e-3, "end_time": 1}, "output": {"ledger": true}})J";

const char* flight = R"J({
  "title": "flight", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [4, 2]], "boundaries": {"all": "free"}},
  "shape": {"type": "linear"}, "transfer": {"type": "pic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e3, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": [0.6, 1], "radius": 0.23}, "velocity": [8, 2]}],
  "gravity": [0, -9.81],
  "solver": {"time_step": 0.002, "end_time": 0.1}, "output": {"ledger": true},
  "compare": {"exact": {"type": "free_fall"}}})J";

std::string filter(const std::string& type, int order, const std::string& more = "") {
  return set("/filter", R"({"type":")" + type + R"(","order":)" + std::to_string(order) + more + "}");
}

std::vector<std::string> operator+(std::vector<std::string> list, const std::string& one) {
  list.push_back(one);
  return list;
}

using mpm::test::largest_difference;

double largest_difference(const Scene& a, const Scene& b) {
  return larger(largest_difference(a.body().velocity, b.body().velocity),
                largest_difference(a.body().position, b.body().position));
}

/// The velocities after `steps` steps of no duration.
std::vector<double> visited(const std::vector<std::string>& overrides, int steps) {
  Scene scene(rough, overrides + set("/solver/time_step", "1e-15"));
  scene.run_steps(steps);
  return scene.body().velocity;
}

/// The sum sum_(j<k) (I - S+S)^j v from v, S+S v, ...: binomials -(-1)^j (k choose j).
std::vector<double> combined(const std::vector<std::string>& overrides, int order) {
  std::vector<double> sum;
  double binomial = 1;
  for (int j = 1; j <= order; ++j) {
    binomial *= static_cast<double>(order - j + 1) / j;
    const std::vector<double> v = visited(overrides, j);
    sum.resize(v.size());
    for (std::size_t k = 0; k < v.size(); ++k) sum[k] += (j % 2 ? 1 : -1) * binomial * v[k];
  }
  return sum;
}

const std::vector<std::pair<std::string, std::string>> walls{
    {"free", R"({"all":"free"})"},
    {"stick", R"({"all":"stick"})"},
    {"slip", R"({"all":"slip"})"},
    {"mixed", R"({"x_min":"slip","x_max":"free","y_min":"stick","y_max":"free"})"},
    {"periodic", R"({"x_min":"periodic","x_max":"periodic","y_min":"slip","y_max":"free"})"}};

}  // namespace

TEST_CASE("order 1 of either filter is PIC", "[filters]") {
  for (const std::string& backend : backends)
    for (const std::string& shape : shapes)
      for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
        const std::vector<std::string> common{set("/backend", backend), set("/shape/type", shape),
                                              set("/solver/stress_update", order), set("/grid/boundaries/all", "slip")};
        Scene pic(rough, common), fmpm(rough, common + filter("fmpm", 1)), xpic(rough, common + filter("xpic", 1));
        for (Scene* scene : {&pic, &fmpm, &xpic}) scene->run_steps(20);
        INFO(backend << " " << shape << " " << order);
        CHECK(largest_difference(pic, fmpm) < 1e-12);
        CHECK(largest_difference(pic, xpic) < 1e-12);
      }
}

TEST_CASE("a filter of order k combines the first k visits of the grid", "[filters]") {
  for (const std::string& backend : backends)
    for (const auto& [shape, transfer] : pairs_of(shapes, filtered_transfers))
      for (const auto& [name, boundaries] : walls) {
        const std::vector<std::string> common{set("/backend", backend), set("/shape/type", shape),
                                              set("/transfer/type", transfer), set("/grid/boundaries", boundaries)};
        for (const int order : {2, 4}) {
          const std::vector<double> expected = combined(common, order);
          INFO(backend << " " << shape << " " << transfer << " " << name << " order " << order);
          for (const std::string type : {"fmpm", "xpic"})
            for (const std::string update : {"last", "first"})
              CHECK(largest_difference(visited(common + filter(type, order) + set("/solver/stress_update", update), 1),
                                       expected) < 1e-10);
        }
      }
}

TEST_CASE("a moving wall is a wall at rest seen from a moving train", "[filters][walls]") {
  // The velocities expected are all those of a stick wall's run plus those of the wall.
  const std::string stick = set("/grid/boundaries", R"({"all":"stick"})");
  const std::string moving = set("/grid/boundaries", R"({"all":{"type":"prescribed","velocity":["2","-3"]}})");
  for (const std::string& backend : backends)
    for (const auto& [shape, transfer] : pairs_of(shapes, filtered_transfers))
      for (const std::string type : {"fmpm", "xpic"})
        for (const std::string constraints : {"every_increment", "at_end"}) {
          const std::vector<std::string> common{set("/backend", backend), set("/shape/type", shape),
                                                set("/transfer/type", transfer),
                                                filter(type, 4, R"(,"constraints":")" + constraints + "\"")};
          std::vector<double> at_rest = visited(common + stick, 1);
          for (std::size_t k = 0; k < at_rest.size(); ++k) at_rest[k] += k % 2 ? -3 : 2;
          INFO(backend << " " << shape << " " << transfer << " " << type << " " << constraints);
          CHECK(largest_difference(visited(common + moving + set("/constants/U", "2") + set("/constants/W", "-3"), 1),
                                   at_rest) < 1e-11);
        }
}

TEST_CASE("a field that moves with its walls is no business of a filter", "[filters][walls]") {
  const std::vector<std::string> uniform{
      set("/bodies/0/velocity", "[2,-3]"), set("/bodies/0/geometry/upper", "[0.8,0.8]"),
      set("/grid/boundaries", R"({"all":{"type":"prescribed","velocity":["2","-3"]}})"),
      set("/solver/time_step", "1e-4")};
  for (const std::string& backend : backends)
    for (const auto& [shape, transfer] : pairs_of(shapes, filtered_transfers))
      for (const std::string type : {"fmpm", "xpic"})
        for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
          Scene scene(rough, uniform + set("/backend", backend) + set("/shape/type", shape) +
                                 set("/transfer/type", transfer) + set("/solver/stress_update", order) +
                                 filter(type, 5));
          const Totals end = scene.run_steps(10);
          INFO(backend << " " << shape << " " << transfer << " " << type << " " << order);
          const BodyState state = scene.body();
          double error = 0;
          for (std::size_t k = 0; k < state.velocity.size(); ++k)
            error = larger(error, std::abs(state.velocity[k] - (k % 2 ? -3 : 2)));
          CHECK(error < 1e-13 * 3 * 10);
          CHECK(std::abs(end.smallest_volume_ratio - 1) < 1e-13);
          CHECK(scene.simulation.backend().filter_record().last_norm <
                1e-13 * scene.simulation.backend().filter_record().first_norm);
        }
}

TEST_CASE("a filter keeps a slip wall the plane of symmetry", "[filters][walls]") {
  // The condition acts on every increment: the wall's own nodes see half of the body, whose normal part would stay.
  const char* whole = R"J({
    "title": "whole", "dimension": 2, "precision": "double", "backend": "reference",
    "grid": {"cell_size": 0.1, "domain": [[-0.8, 0], [0.8, 1]], "boundaries": {"all": "free"}},
    "shape": {"type": "linear"}, "transfer": {"type": "pic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [-0.3, 0.3], "upper": [0.3, 0.7]}, "velocity": ["-x*(3+y)", "2 + cos(40*x)"]}],
    "solver": {"time_step": 1e-3, "end_time": 1}})J";
  for (const std::string& backend : backends)
    for (const auto& [shape, transfer] : pairs_of(shapes, filtered_transfers))
      for (const std::string type : {"fmpm", "xpic"}) {
        const std::vector<std::string> common{set("/backend", backend), set("/shape/type", shape),
                                              set("/transfer/type", transfer), filter(type, 4)};
        Scene full(whole, common), half(whole, common + set("/grid/domain", "[[0,0],[0.8,1]]") +
                                                   set("/grid/boundaries", R"({"all":"free","x_min":"slip"})") +
                                                   set("/bodies/0/geometry/lower", "[0,0.3]"));
        full.run_steps(10), half.run_steps(10);
        const BodyState a = full.body(), b = half.body();
        std::vector<double> right;
        for (std::size_t p = 0; p < a.position.size(); p += 2)
          if (a.position[p] > 0) right.insert(right.end(), {a.velocity[p], a.velocity[p + 1]});
        INFO(backend << " " << shape << " " << transfer << " " << type);
        CHECK(largest_difference(right, b.velocity) < 1e-10);
      }
}

TEST_CASE("filters do not act on free flight", "[filters][free_flight]") {
  for (const std::string& backend : backends)
    for (const auto& [shape, transfer] : pairs_of(shapes, all_transfers()))
      for (const auto& [type, order] : {std::pair{"fmpm", 4}, std::pair{"xpic", 3}})
        for (const std::string update : {"last", "first", "modified_last", "averaged"}) {
          if (update == "first" && transfer != "pic") continue;
          const std::string interval = is_flip(transfer) ? R"(,"every_steps":3)" : "";
          Scene scene(flight, {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer),
                               set("/solver/stress_update", update), filter(type, order, interval)});
          const Totals start = scene.metrics.initial(), end = scene.run();
          INFO(backend << " " << shape << " " << transfer << " " << type << " " << update);
          CHECK(end.position_error_max < 1e-11);
          CHECK(end.velocity_error_max < 1e-11);
          CHECK(std::abs(end.largest_volume_ratio - 1) < 1e-12);
          const Ledger& ledger = scene.simulation.backend().ledger();
          CHECK(std::abs(ledger.filter) < 1e-11 * end.kinetic);
          CHECK(std::abs(ledger.gravity - (end.kinetic - start.kinetic)) < 1e-11 * end.kinetic);
        }
}

TEST_CASE("filters conserve momentum", "[filters][momentum]") {
  for (const std::string& backend : backends)
    for (const auto& [shape, transfer] : pairs_of(shapes, all_transfers()))
      for (const std::string type : {"fmpm", "xpic"})
        for (const std::string update : {"last", "modified_last"}) {
          const std::string interval = is_flip(transfer) ? R"(,"every_steps":2)" : "";
          Scene scene(rough, {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer),
                              set("/grid/domain", "[[-0.5,-0.5],[1.5,1.5]]"), set("/solver/stress_update", update),
                              set("/solver/time_step", "1e-4"), filter(type, 3, interval)});
          const Totals start = scene.metrics.initial(), end = scene.run_steps(20);
          INFO(backend << " " << shape << " " << transfer << " " << type << " " << update);
          for (int c = 0; c < 2; ++c) CHECK(std::abs(end.momentum[c] - start.momentum[c]) < 1e-12 * start.mass * 3);
        }
}

TEST_CASE("no wall breaks the contraction", "[filters][walls]") {
  for (const std::string& backend : backends)
    for (const auto& [shape, transfer] : pairs_of(shapes, filtered_transfers))
      for (const std::string wall : {"stick", "slip", "separate"}) {
        Scene scene(rough,
                    std::vector<std::string>{set("/backend", backend), set("/shape/type", shape),
                                             set("/transfer/type", transfer), filter("fmpm", 12),
                                             set("/grid/boundaries/all", wall), set("/solver/time_step", "1e-4")});
        scene.run_steps(5);
        INFO(backend << " " << shape << " " << transfer << " " << wall);
        // Polynomials that are multilinear are all there are on two nodes an axis: PolyPIC leaves the filter nothing to
        // do.
        if (shape == "linear" && transfer == "polypic")
          CHECK(scene.simulation.backend().filter_record().last_norm <
                1e-12 * scene.simulation.backend().filter_record().first_norm);
        else
          CHECK(scene.simulation.backend().filter_record().largest_growth > 0.1);
        CHECK(scene.simulation.backend().filter_record().largest_growth <= 1 + 1e-12);
      }
}

TEST_CASE("the record takes the largest growth, of rounding none", "[filters]") {
  FilterRecord record;
  record.first_norm = record.last_norm = 2;
  for (const double norm : {1.0, 1.5, 0.75, 1e-13, 1e-12}) record.take_norm(norm);
  CHECK(record.largest_growth == 1.5);
  CHECK(record.last_norm == 1e-12);
  CHECK(record.iterations == 5);
}

TEST_CASE("the loop contracts in the mass norm, and ends at the tolerance", "[filters]") {
  // The operator S+ S of PIC and of the affine transfers is a mean of projections in the mass norm: I - S+S never grows
  // anything.
  for (const std::string& backend : backends)
    for (const auto& [shape, transfer] : pairs_of(shapes, {"pic", "apic", "mls", "rpic", "polypic"})) {
      const std::vector<std::string> common{set("/backend", backend), set("/shape/type", shape),
                                            set("/transfer/type", transfer)};
      INFO(backend << " " << shape << " " << transfer);
      Scene scene(rough, common + filter("fmpm", 12) + set("/solver/time_step", "1e-4"));
      double growth = 0;
      for (int k = 0; k < 20; ++k) {
        scene.simulation.step();
        const FilterRecord& record = scene.simulation.backend().filter_record();
        CHECK(record.iterations == 11);
        CHECK(record.first_norm > 0);
        CHECK(record.last_norm < record.first_norm);
        growth = record.largest_growth;
      }
      CHECK(growth > 0);
      CHECK(growth <= 1 + 1e-12);
      Scene loose(rough, common + filter("fmpm", 200, R"(,"tolerance":0.1)"));
      loose.simulation.step();
      const FilterRecord& record = loose.simulation.backend().filter_record();
      CHECK(record.iterations < 199);
      CHECK(record.last_norm <= 0.1 * record.first_norm);
    }
}

TEST_CASE("higher orders keep more of what the grid can hold", "[filters]") {
  for (const std::string& backend : backends)
    for (const std::string type : {"fmpm", "xpic"}) {
      double previous = 0;
      for (const int order : {1, 2, 4, 8, 16}) {
        Scene scene(rough, {set("/backend", backend), filter(type, order), set("/solver/time_step", "1e-15")});
        const double kept = scene.run_steps(10).kinetic / scene.metrics.initial().kinetic;
        INFO(backend << " " << type << " " << order << ": " << kept);
        CHECK(kept > previous);
        CHECK(kept < 1);
        previous = kept;
      }
    }
}

TEST_CASE("without forces the ledger accounts for the filter to rounding", "[filters][ledger]") {
  // Without forces the transfers and the filter are all there is.
  for (const std::string& backend : backends)
    for (const std::string& shape : shapes)
      for (const std::string type : {"fmpm", "xpic"})
        for (const std::string update : {"last", "first", "modified_last", "averaged"}) {
          Scene scene(rough, {set("/backend", backend), set("/shape/type", shape), filter(type, 4),
                              set("/materials/m/youngs_modulus", "1e-9"), set("/solver/stress_update", update),
                              set("/grid/boundaries/all", "slip")});
          const Totals end = scene.run_steps(10);
          INFO(backend << " " << shape << " " << type << " " << update);
          CHECK(std::abs(scene.simulation.backend().ledger().filter) > 1e-4 * end.kinetic);
          CHECK(std::abs(scene.metrics.ledger_residual(end)) < 1e-12 * scene.metrics.initial().kinetic);
          const auto columns = scene.metrics.columns();
          CHECK(std::count(columns.begin(), columns.end(), "ledger filter (J/m)") == 1);
          CHECK(std::count(columns.begin(), columns.end(), "filter iterations") == 1);
          CHECK(columns.size() == scene.metrics.row(end).size());
        }
  Scene plain(rough);
  for (const std::string& column : plain.metrics.columns()) CHECK(column.find("filter") == std::string::npos);
}

// With forces the residual is what time integration makes of them. The filter acts at fixed times: in each of those
// steps forces have worked at velocities that the filter then changes, an error of dt like all others. So a residual that
// does not shrink with dt has lost energy on the way.
TEST_CASE("the ledger of a stressed body that is filtered at fixed times closes at first order", "[filters][ledger]") {
  const char* bar = R"J({
    "title": "filtered bar", "dimension": 2, "precision": "double", "backend": "cpu",
    "grid": {"cell_size": 2, "domain": [[0, 0], [40, 2]],
             "boundaries": {"x_min": "slip", "x_max": "free", "y_min": "slip", "y_max": "slip"}},
    "shape": {"type": "linear"}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 100, "poisson_ratio": 0, "density": 1}},
    "bodies": [{"name": "bar", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [26, 2]},
                "velocity": ["0.1*sin(5*pi*x/52)", 0]}],
    "solver": {"time_step": 0.02, "end_time": 4}})J";
  const std::vector<double> steps{0.02, 0.01, 0.005};
  for (const std::string& backend : backends)
    for (const std::string shape : {"linear", "bspline_quadratic"})
      for (const std::string type : {"fmpm", "xpic"})
        for (const std::string update : {"last", "modified_last"}) {
          std::vector<double> residuals;
          INFO(backend << " " << shape << " " << type << " " << update);
          for (const double step : steps) {
            Scene scene(bar, {set("/backend", backend), set("/shape/type", shape), set("/solver/stress_update", update),
                              set("/solver/time_step", digits(step)), filter(type, 2, R"(,"every_time":0.5)")});
            const double energy = scene.metrics.initial().total_energy();
            double strain = 0;
            residuals.push_back(0);  // the run's largest: at single times it passes through zero
            while (!scene.simulation.finished()) {
              const Totals now = scene.run_steps(1);
              strain = larger(strain, now.strain);
              residuals.back() = larger(residuals.back(), std::abs(scene.metrics.ledger_residual(now)));
            }
            const double filtered = scene.simulation.backend().ledger().filter;
            CHECK(strain > 0.3 * energy);  // there are forces
            CHECK(std::abs(filtered) > 0.1 * energy);
          }
          INFO(residuals[0] << " " << residuals[1] << " " << residuals[2]);
          CHECK(std::abs(observed_order(steps, residuals) - 1) < 0.1);
        }
}

TEST_CASE("a filter acts when its schedule says so", "[filters]") {
  for (const std::string& backend : backends)
    for (const std::string interval : {R"(,"every_steps":4)", R"(,"every_time":0.004)"}) {
      const std::vector<std::string> common{set("/backend", backend), set("/transfer/type", "flip")};
      Scene plain(rough, common), filtered(rough, common + filter("fmpm", 3, interval));
      plain.run_steps(3), filtered.run_steps(3);
      INFO(backend << " " << interval);
      CHECK(largest_difference(plain, filtered) == 0);
      CHECK(filtered.simulation.backend().filter_record().first_norm == 0);
      plain.run_steps(1), filtered.run_steps(1);
      CHECK(largest_difference(plain, filtered) > 1e-3);
      CHECK(filtered.simulation.backend().filter_record().iterations == 2);
    }
}

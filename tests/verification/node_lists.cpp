// Shapes that need more than a position: GIMP and B2GIMP (the undeformed particle's box), cpGIMP (its box stretched
// along the axes) and CPDI (its deformed domain, a list of nodes), with every transfer. Free flight, conserved momenta,
// affine fields, what the domain becomes.

#include <cmath>

#include "support/catch.hpp"
#include "support/differences.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::vector<std::string> backends{"reference", "cpu"};
const std::vector<std::string> sized_shapes{"gimp", "gimp_contiguous", "b2gimp", "cpdi", "cpdi2"};
const std::vector<std::string> transfers{"pic", "flip", "apic", "mls", "tpic", "rpic", "aflip", "asflip"};

const char* flight = R"J({
  "title": "flight", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [4, 2]], "boundaries": {"all": "free"}},
  "shape": {"type": "gimp"}, "transfer": {"type": "pic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e3, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": [0.6, 1], "radius": 0.23}, "velocity": [8, 2]}],
  "gravity": [0, -9.81],
  "solver": {"time_step": 0.002, "end_time": 0.25}, "output": {"ledger": true},
  "compare": {"exact": {"type": "free_fall"}}})J";

const char* flight_3d = R"J({
  "title": "flight", "dimension": 3, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0, 0], [1.2, 1, 1]], "boundaries": {"all": "free"}},
  "shape": {"type": "gimp"}, "transfer": {"type": "pic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e3, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": [0.4, 0.5, 0.5], "radius": 0.16}, "velocity": [8, 2, -1]}],
  "gravity": [0, -9.81, 1],
  "solver": {"time_step": 0.002, "end_time": 0.06}, "output": {"ledger": true},
  "compare": {"exact": {"type": "free_fall"}}})J";

/// The body is thrown, spinning and vibrating, at random places in its cells.
const char* free_body = R"J({
  "title": "free body", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [3, 3]], "boundaries": {"all": "free"}},
  "shape": {"type": "gimp"}, "transfer": {"type": "apic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "block", "material": "m", "geometry": {"type": "box", "lower": [1, 1], "upper": [1.6, 1.4]}, "jitter": 0.3,
              "velocity": ["1 - 4*(y-1.2) + 0.5*sin(9*x)", "-2 + 4*(x-1.3) + 0.5*cos(7*y)"]}],
  "solver": {"time_step": 1e-3, "end_time": 1}, "output": {"ledger": true}})J";

/// The field turns and stretches: v = (1, 2) + G x, without stress.
const char* affine_field = R"J({
  "title": "affine field", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [3, 3]], "boundaries": {"all": "free"}},
  "shape": {"type": "gimp"}, "transfer": {"type": "apic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-6, "poisson_ratio": 0, "density": 1000}},
  "bodies": [{"name": "disc", "material": "m", "geometry": {"type": "ball", "centre": [1.5, 1.5], "radius": 0.4}, "jitter": 0.4,
              "velocity": ["1 + 0.7*x - 3*y", "2 + 5*x - 0.4*y"]}],
  "solver": {"time_step": 1e-3, "end_time": 1}, "output": {"ledger": true}})J";
constexpr double gradient[4] = {0.7, -3, 5, -0.4};

void check_flight(const char* text, const std::vector<std::string>& overrides) {
  Scene scene(text, overrides);
  const Totals start = scene.metrics.initial(), end = scene.run();
  CHECK(end.position_error_max < 1e-11);
  CHECK(end.velocity_error_max < 1e-11);
  CHECK(std::abs(end.smallest_volume_ratio - 1) < 1e-12);
  CHECK(std::abs(end.largest_volume_ratio - 1) < 1e-12);
  const Ledger& ledger = scene.simulation.backend().ledger();
  CHECK(std::abs(ledger.gravity - (end.kinetic - start.kinetic)) < 1e-11 * end.kinetic);
}

}  // namespace

TEST_CASE("free flight with sized shapes and Taylor transfer", "[free_flight]") {
  for (const std::string& backend : backends)
    for (const std::string shape : {"gimp", "gimp_contiguous", "b2gimp", "cpdi", "cpdi2", "linear"})
      for (const std::string& transfer : transfers)
        for (const std::string order : {"last", "first", "modified_last"}) {
          if (shape == "linear" && transfer != "tpic") continue;  // the others are in free_fall.cpp
          if (order == "first" && transfer != "tpic") continue;
          INFO(backend << " " << shape << " " << transfer << " " << order);
          check_flight(flight, {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer),
                                set("/solver/stress_update", order)});
        }
}

TEST_CASE("free flight with sized shapes in 3-D", "[free_flight]") {
  for (const std::string& backend : backends)
    for (const std::string& shape : sized_shapes)
      for (const std::string transfer : {"flip", "apic", "tpic"}) {
        INFO(backend << " " << shape << " " << transfer);
        check_flight(flight_3d, {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer)});
      }
}

TEST_CASE("sized shapes conserve momentum", "[momentum]") {
  for (const std::string& backend : backends)
    for (const std::string& shape : sized_shapes)
      for (const std::string& transfer : transfers)
        for (const std::string order : {"last", "modified_last"}) {
          Scene scene(free_body, {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer),
                                  set("/solver/stress_update", order)});
          const Totals start = scene.metrics.initial(), end = scene.run_steps(40);
          INFO(backend << " " << shape << " " << transfer << " " << order);
          CHECK(end.strain > 1e-4 * start.kinetic);  // the stresses have acted
          for (int c = 0; c < 2; ++c) CHECK(std::abs(end.momentum[c] - start.momentum[c]) < 1e-12 * start.mass * 2);
        }
}

TEST_CASE("affine transfers on sized shapes keep angular momentum over every transfer", "[round_trip]") {
  // The moment D of a sized shape moves with the particle, and the affine part's spin m D : C with it: what is
  // conserved to rounding is each visit of the grid, not the move. Steps without time are visits alone; the forces have
  // no torque.
  for (const std::string& backend : backends)
    for (const std::string& shape : sized_shapes)
      for (const std::string transfer : {"apic", "mls", "pic"}) {
        Scene scene(free_body, {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer),
                                set("/solver/time_step", "1e-14")});
        const Totals start = scene.metrics.initial(), end = scene.run_steps(20);
        const double kept = end.angular_momentum[2] / start.angular_momentum[2];
        INFO(backend << " " << shape << " " << transfer << " kept " << kept);
        CHECK(std::abs(start.angular_momentum[2]) > 0.1 * start.mass);
        if (transfer == "pic")
          CHECK(kept < 0.9);
        else
          CHECK(std::abs(kept - 1) < 1e-11);
      }
}

TEST_CASE("an affine field comes back exactly", "[round_trip]") {
  // The bound is that of the first affine velocity, a central difference over 2e-4 cells of velocities up to 20 m/s.
  const double seeded = 2.2e-16 * 20 / (1e-4 * 0.1);
  for (const std::string& backend : backends)
    for (const std::string shape :
         {"gimp", "gimp_contiguous", "b2gimp", "cpdi", "cpdi2", "linear", "bspline_quadratic", "bspline_cubic"})
      for (const std::string transfer : {"apic", "mls", "tpic"}) {
        Scene scene(affine_field,
                    {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer)});
        const BodyState before = scene.body();
        const Totals start = scene.metrics.initial();
        scene.run_steps(1);
        const BodyState after = scene.body();
        const double change = largest_difference(before.velocity, after.velocity);
        INFO(backend << " " << shape << " " << transfer << " changes " << change);
        CHECK(change < seeded * 0.2);
        const std::vector<double>& L = after.transfer_state.begin()->second;
        double error = 0;
        for (std::size_t k = 0; k < L.size(); ++k) error = larger(error, std::abs(L[k] - gradient[k % 4]));
        CHECK(error < 4 * seeded);
        // Nothing was lost on the way, with the affine part's energy m/2 tr(C D C^T) counted.
        const Ledger& ledger = scene.simulation.backend().ledger();
        CHECK(std::abs(ledger.scatter) < 1e-12 * start.kinetic);
        CHECK(std::abs(ledger.gather) < 1e-12 * start.kinetic);
      }
}

TEST_CASE("the domain of a CPDI particle follows the velocity gradient", "[cpdi]") {
  for (const std::string& backend : backends)
    for (const std::string order : {"last", "first", "modified_last"}) {
      INFO(backend << " " << order);
      Scene scene(affine_field, {set("/backend", backend), set("/shape/type", "cpdi"), set("/transfer/type", "tpic"),
                                 set("/solver/stress_update", order), set("/bodies/0/particles_per_cell_axis", "3")});
      const double side = 0.1 / 6, dt = 1e-3;
      scene.run_steps(1);
      const std::vector<double> domain = scene.body().domain;
      REQUIRE(domain.size() == 2 * scene.body().position.size());
      double error = 0;
      for (std::size_t k = 0; k < domain.size(); ++k) {
        const double identity = k % 4 == 0 || k % 4 == 3 ? 1 : 0;
        error = larger(error, std::abs(domain[k] - side * (identity + dt * gradient[k % 4])));
      }
      CHECK(error < 1e-13 * side);
    }
}

TEST_CASE("a domain that reaches far beyond the edge stops the run by name", "[cpdi]") {
  // The body is sheared by 80 in one step: the lower row stays, its domains reach 20 cells to either side.
  const char* sheared = R"J({
    "title": "sheared", "dimension": 2, "precision": "double", "backend": "reference",
    "grid": {"cell_size": 1, "domain": [[0, 0], [60, 4]], "boundaries": {"all": "free"}},
    "shape": {"type": "cpdi"}, "transfer": {"type": "tpic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}},
    "bodies": [{"name": "cell", "material": "m", "geometry": {"type": "box", "lower": [1, 1], "upper": [2, 2]}, "velocity": ["80*(y-1.25)", 0]}],
    "solver": {"time_step": 1, "end_time": 10}})J";
  for (const std::string& backend : backends) {
    Scene scene(sheared, {set("/backend", backend)});
    scene.run_steps(1);
    std::string cause;
    try {
      scene.run_steps(1);
    } catch (const RunFailure& stopped) {
      cause = cause_text(stopped.failure, scene.experiment);
      CHECK(stopped.failure.particle == 0);
    }
    INFO(backend << ": " << cause);
    CHECK(cause == "its domain reaches more than 8 cells beyond the domain's edge");
  }
}

TEST_CASE("GIMP with a box of one cell is the quadratic B-spline", "[gimp]") {
  for (const std::string& backend : backends)
    for (const std::string& transfer : transfers) {
      const std::vector<std::string> common{set("/backend", backend), set("/transfer/type", transfer),
                                            set("/bodies/0/particles_per_cell_axis", "1")};
      auto quadratic = common;
      quadratic.push_back(set("/shape/type", "bspline_quadratic"));
      Scene a(free_body, common), b(free_body, quadratic);
      a.run_steps(20), b.run_steps(20);
      INFO(backend << " " << transfer);
      CHECK(largest_difference(a.body().velocity, b.body().velocity) < 1e-10);
      CHECK(largest_difference(a.body().position, b.body().position) < 1e-12);
    }
}

TEST_CASE("B2GIMP with a box of one cell is the cubic B-spline, cpGIMP of a body at rest is GIMP", "[gimp]") {
  for (const std::string& backend : backends)
    for (const std::string& transfer : transfers) {
      const auto end = [&](const std::string& shape, const std::string& velocity, const std::string& particles) {
        Scene scene(free_body,
                    {set("/backend", backend), set("/transfer/type", transfer), set("/shape/type", shape),
                     set("/bodies/0/velocity", velocity), set("/bodies/0/particles_per_cell_axis", particles)});
        scene.run_steps(20);
        return scene.body();
      };
      const std::string vibrating = R"J(["1+0.5*sin(9*x)","-2+0.5*cos(7*y)"])J";
      const BodyState a = end("b2gimp", vibrating, "1"), b = end("bspline_cubic", vibrating, "1");
      const BodyState c = end("gimp_contiguous", "[1,-2]", "2"), d = end("gimp", "[1,-2]", "2");
      INFO(backend << " " << transfer);
      CHECK(largest_difference(a.velocity, b.velocity) < 1e-10);
      CHECK(largest_difference(a.position, b.position) < 1e-12);
      CHECK(largest_difference(c.velocity, d.velocity) < 1e-10);
      CHECK(largest_difference(c.position, d.position) < 1e-12);
    }
}

TEST_CASE("a slip wall is the plane of symmetry of a whole body, also where it is one cell from the other wall",
          "[walls]") {
  const char* whole = R"J({
    "title": "whole", "dimension": 2, "precision": "double", "backend": "reference",
    "grid": {"cell_size": 0.1, "domain": [[-1, 0], [1, 1]], "boundaries": {"all": "free"}},
    "shape": {"type": "gimp"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [-0.3, 0.3], "upper": [0.3, 0.7]}, "velocity": ["-x*(3+y)", "2 + 4*x^2"]}],
    "solver": {"time_step": 1e-3, "end_time": 1}})J";
  for (const std::string& backend : backends)
    for (const std::string& shape : sized_shapes)
      for (const std::string& transfer : transfers) {
        const std::vector<std::string> common{set("/backend", backend), set("/shape/type", shape),
                                              set("/transfer/type", transfer)};
        auto at_wall = common;
        at_wall.insert(at_wall.end(), {set("/grid/domain", "[[0,0],[1,1]]"),
                                       set("/grid/boundaries", R"({"all":"free","x_min":"slip"})"),
                                       set("/bodies/0/geometry/lower", "[0,0.3]")});
        Scene full(whole, common), half(whole, at_wall);
        full.run_steps(20), half.run_steps(20);
        const BodyState a = full.body(), b = half.body();
        INFO(backend << " " << shape << " " << transfer);
        // The particles of the whole body right of the plane come in the order of seeding.
        std::size_t k = 0;
        double error = 0;
        for (std::size_t p = 0; p < a.position.size(); p += 2) {
          if (a.position[p] < 0) continue;
          REQUIRE(k < b.position.size());
          for (int c = 0; c < 2; ++c) {
            error = larger(error, std::abs(a.position[p + c] - b.position[k + c]));
            error = larger(error, std::abs(a.velocity[p + c] - b.velocity[k + c]));
          }
          k += 2;
        }
        CHECK(k == b.position.size());
        CHECK(error < 1e-10);
      }
}

TEST_CASE("a layer one cell thick slides between slip walls unchanged", "[walls]") {
  const char* layer = R"J({
    "title": "layer", "dimension": 2, "precision": "double", "backend": "reference",
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [2, 0.1]], "boundaries": {"x_min": "periodic", "x_max": "periodic", "y_min": "slip", "y_max": "slip"}},
    "shape": {"type": "cpdi"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-6, "poisson_ratio": 0, "density": 1000}},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [2, 0.1]}, "velocity": [3, 0]}],
    "solver": {"time_step": 1e-2, "end_time": 1}})J";
  for (const std::string& backend : backends)
    for (const std::string& shape : sized_shapes)
      for (const std::string& transfer : transfers) {
        Scene scene(layer, {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer)});
        const Totals start = scene.metrics.initial(), end = scene.run_steps(50);
        INFO(backend << " " << shape << " " << transfer);
        CHECK(std::abs(end.momentum[0] - start.momentum[0]) < 1e-12 * start.momentum[0]);
        CHECK(end.kinetic == Approx(start.kinetic).epsilon(1e-12));
        CHECK(std::abs(end.smallest_volume_ratio - 1) < 1e-12);
      }
}

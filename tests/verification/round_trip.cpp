// One visit of the grid by particles at random places, of two masses, without forces: what each transfer keeps of
// momentum, spin, an affine field and any field. Shapes with a size are in node_lists.cpp too.

#include <array>
#include <cstdio>

#include "support/catch.hpp"
#include "support/differences.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The run is a visit alone: the step has no time. Both bodies share one velocity field and one place; their particles
/// are shifted apart at random and weigh 1 to 3.
std::string text(const std::string& vx, const std::string& vy, const std::string& jitter) {
  const auto body = [&](const std::string& name) {
    return R"({"name": ")" + name + R"(", "material": ")" + name + R"(", "jitter": )" + jitter +
           R"(, "geometry": {"type": "box", "lower": [1, 1], "upper": [2, 2]}, "velocity": [")" + vx + "\", \"" + vy +
           "\"]}";
  };
  return R"({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [3, 3]], "boundaries": {"all": "free"}},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
      "materials": {"light": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0, "density": 1000},
                    "heavy": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0, "density": 3000}},
      "bodies": [)" +
         body("light") + ", " + body("heavy") + R"(],
      "solver": {"time_step": 1e-14, "end_time": 1}, "output": {"ledger": false}})";
}

const char *affine_x = "1 + 0.7*x - 3*y", *affine_y = "2 + 5*x - 0.4*y";
const char *any_x = "1 - 4*y + 0.5*sin(90*x)*cos(31*y)", *any_y = "-2 + 4*x + 0.5*cos(70*y)*sin(43*x)";

/// The largest change of a velocity component, of particles at least `inside` from the edge of the block.
double largest_change(const BodyState& before, const BodyState& after, double inside) {
  double largest = 0;
  for (std::size_t k = 0; k < before.velocity.size(); k += 2) {
    const double x = before.position[k], y = before.position[k + 1];
    if (std::min({x - 1, 2 - x, y - 1, 2 - y}) < inside) continue;
    for (std::size_t c = k; c < k + 2; ++c) largest = larger(largest, std::abs(after.velocity[c] - before.velocity[c]));
  }
  return largest;
}

struct Visit {
  double change = 0, spin = 0;  ///< change of a velocity, m/s; relative change of the angular momentum
  double momentum = 0;          ///< change relative to mass times 1 m/s
};

Visit visit(const std::string& text, const std::vector<std::string>& overrides, double inside = 0) {
  Scene scene(text, overrides);
  const std::array before{scene.body(0), scene.body(1)};
  const Totals start = scene.metrics.initial(), end = scene.run_steps(1);
  Visit v;
  for (int b = 0; b < 2; ++b) v.change = larger(v.change, largest_change(before[b], scene.body(b), inside));
  v.spin = end.angular_momentum[2] / start.angular_momentum[2] - 1;
  for (int c = 0; c < 2; ++c)
    v.momentum = larger(v.momentum, std::abs(end.momentum[c] - start.momentum[c]) / start.mass);
  return v;
}

}  // namespace

TEST_CASE("round trip: particles of two masses at random places: momentum, spin, affine fields", "[round_trip]") {
  std::printf("Round trip: change of an affine field (m/s); of momentum and of spin of any field, relative\n");
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape : {"bspline_quadratic", "bspline_cubic"})
      for (const std::string transfer : {"pic", "flip", "apic", "mls", "tpic"}) {
        const std::vector<std::string> choice{set("/backend", backend), set("/shape/type", shape),
                                              set("/transfer/type", transfer)};
        const Visit affine = visit(text(affine_x, affine_y, "0.4"), choice),
                    any = visit(text(any_x, any_y, "0.4"), choice);
        std::printf("  %-9s %-17s %-5s %8.1e %8.1e %9.1e\n", backend.c_str(), shape.c_str(), transfer.c_str(),
                    affine.change, any.momentum, any.spin);
        INFO(backend << " " << shape << " " << transfer << ": change " << affine.change << ", spin " << any.spin);
        CHECK(any.momentum <= 1e-12);
        // The bound is that of the first affine velocity, a central difference over 2e-5 m of velocities up to 10 m/s.
        const double seeded = 2.2e-16 * 10 / 1e-5 * 0.1;
        if (transfer == "pic")
          CHECK(affine.change > 0.1);
        else
          CHECK(affine.change <= (transfer == "flip" ? 1e-12 : seeded));
        if (transfer == "apic" || transfer == "mls") CHECK(std::abs(any.spin) <= 1e-12);
        if (transfer == "pic") CHECK(any.spin < -0.02);
        if (transfer == "flip") CHECK(any.change <= 1e-12);  // the identity is kept for any field
      }
}

TEST_CASE("round trip: particles that carry an affine field itself get it back, velocities and gradients",
          "[round_trip]") {
  // Particles are seeded by the field's own gradient, which in the case above is a difference quotient.
  constexpr double B[4] = {0.7, -3, 5, -0.4};
  std::printf("Round trip: change of an affine field (m/s) and of its gradient (1/s), seeded exactly\n");
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape : {"bspline_quadratic", "bspline_cubic"})
      for (const std::string transfer : {"apic", "mls", "tpic"}) {
        const Experiment experiment =
            experiment_from(text(affine_x, affine_y, "0.4"),
                            {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer)});
        Simulation simulation(experiment, [&](const Experiment& e, const Plan& p, std::vector<SeededBody> bodies) {
          for (SeededBody& body : bodies) {
            SeedArrays seeds = body.arrays();
            REQUIRE(seeds.velocity_gradient.size() == 4 * body.count());
            for (std::size_t k = 0; k < seeds.velocity_gradient.size(); ++k) seeds.velocity_gradient[k] = B[k % 4];
            body.replace(std::move(seeds));
          }
          return backend_factory(1)(e, p, std::move(bodies));
        });
        const std::array before{simulation.backend().body_state(0), simulation.backend().body_state(1)};
        simulation.step();
        double of_velocity = 0, of_gradient = 0;
        for (int b = 0; b < 2; ++b) {
          const BodyState after = simulation.backend().body_state(b);
          of_velocity = larger(of_velocity, largest_difference(before[b].velocity, after.velocity));
          REQUIRE(after.transfer_state.size() == 1);
          of_gradient = larger(of_gradient, largest_difference(before[b].transfer_state.begin()->second,
                                                               after.transfer_state.begin()->second));
        }
        std::printf("  %-9s %-17s %-5s %8.1e %8.1e\n", backend.c_str(), shape.c_str(), transfer.c_str(), of_velocity,
                    of_gradient);
        INFO(backend << " " << shape << " " << transfer);
        CHECK(of_velocity <= 1e-12);
        CHECK(of_gradient <= 1e-12);
      }
}

TEST_CASE("round trip: filters conserve momentum on particles of two masses", "[round_trip]") {
  for (const char* filter : {R"({"type": "xpic", "order": 3})", R"({"type": "fmpm", "order": 4})"})
    for (const std::string backend : {"reference", "cpu"})
      for (const std::string shape : {"linear", "bspline_quadratic", "bspline_cubic"}) {
        INFO(filter << " " << backend << " " << shape);
        CHECK(visit(text(any_x, any_y, "0.4"), {set("/backend", backend), set("/shape/type", shape),
                                                set("/transfer/type", "pic"), set("/filter", filter)})
                  .momentum <= 1e-12);
      }
}

TEST_CASE("round trip: PIC keeps an affine field inside a uniform lattice, and loses spin at its edge",
          "[round_trip]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape : {"linear", "bspline_quadratic", "bspline_cubic"}) {
      const std::vector<std::string> choice{set("/backend", backend), set("/shape/type", shape),
                                            set("/transfer/type", "pic")};
      // The nodes of a particle, and what those see, are one support farther each.
      const double inside_of = shape == "linear" ? 0.2 : shape == "bspline_quadratic" ? 0.3 : 0.4;
      const Visit inside = visit(text(affine_x, affine_y, "0"), choice, inside_of);
      const Visit all = visit(text(affine_x, affine_y, "0"), choice);
      INFO(backend << " " << shape << ": inside " << inside.change << ", at the edge " << all.change);
      CHECK(inside.change <= 1e-12);
      CHECK(all.change > 0.01);
      CHECK(all.spin < -0.01);
    }
}

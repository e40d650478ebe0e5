// What a node does where more than two bodies meet, and where a condition holds it. Bodies in one place that differ in nothing but how fine their particles are have the same mass at every node, as tents sum
// rows within a cell exactly, so that a step of PIC is arithmetic.

#include <array>
#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Bodies of one cell's height on the lower wall, all in the same place and without ends, with a velocity each.
std::string in_one_place(const std::vector<std::string>& velocities, const std::string& contact,
                         const std::string& wall) {
  std::string bodies;
  for (std::size_t k = 0; k < velocities.size(); ++k)
    bodies +=
        std::string(k ? "," : "") + R"({"name": "b)" + std::to_string(k) +
        R"(", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.4, 0.1]}, "particles_per_cell_axis": )" +
        std::to_string(k + 2) + R"(, "velocity": )" + velocities[k] + "}";
  return R"({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [0.4, 0.4]],
      "boundaries": {"x_min": "periodic", "x_max": "periodic", "y_min": ")" +
         wall + R"(", "y_max": "free"}}, "shape": {"type": "linear"}, "transfer": {"type": "pic"}, "contact": )" +
         contact +
         R"(, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-6, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [)" +
         bodies + R"(], "solver": {"time_step": 1e-3, "end_time": 1}, "output": {"ledger": false}})";
}

using Velocity = std::array<double, 2>;

/// Calls see(height, velocity) for each particle of a body: how high it was before the last step, as a share of a cell.
template <class See>
void for_each_particle(const Scene& scene, int body, See see) {
  const BodyState state = scene.body(body);
  REQUIRE(state.velocity.size() > 0);
  for (std::size_t p = 0; p < state.velocity.size(); p += 2)
    see((state.position[p + 1] - 1e-3 * state.velocity[p + 1]) / 0.1,
        Velocity{state.velocity[p], state.velocity[p + 1]});
}

const std::vector<std::string> backends{"reference", "cpu"};

}  // namespace

// Pairs act one after the other, (0, 1), (0, 2), (1, 2), before the forces and after them. Bodies of equal mass take their
// mean in a weld; without friction they do where they approach along the normal.
TEST_CASE("three bodies at a node meet in pairs, one after the other", "[contact][fields]") {
  for (const std::string& backend : backends) {
    INFO(backend);
    const auto pairs = [](std::array<double, 3> v, bool weld) {
      for (int pass = 0; pass < 2; ++pass)
        for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}})
          if (weld || v[static_cast<std::size_t>(a)] > v[static_cast<std::size_t>(b)])
            v[static_cast<std::size_t>(a)] = v[static_cast<std::size_t>(b)] =
                (v[static_cast<std::size_t>(a)] + v[static_cast<std::size_t>(b)]) / 2;
      return v;
    };
    const std::string frictionless =
        R"({"type": "frictionless", "normal": {"type": "given", "x": 1, "y": 0}, "detection": "approach"})";
    for (const bool weld : {true, false}) {
      const std::array<double, 3> start{1, 0, -1};
      Scene scene(in_one_place({"[1, 0]", "[0, 0]", "[-1, 0]"}, weld ? R"({"type": "stick"})" : frictionless, "slip"),
                  {set("/backend", backend)});
      scene.run_steps(1);
      const std::array<double, 3> exact = pairs(start, weld);
      for (int body = 0; body < 3; ++body)
        for_each_particle(scene, body, [&](double, const Velocity& v) {
          INFO((weld ? "weld" : "frictionless") << ", body " << body);
          CHECK(v[0] == Approx(exact[static_cast<std::size_t>(body)]).margin(1e-12));
          CHECK(v[1] == Approx(0).margin(1e-12));
        });
    }
    // In the end a weld has the velocity that momentum demands.
    Scene scene(in_one_place({"[1, 0]", "[0.5, 0]", "[-0.3, 0]"}, R"({"type": "stick"})", "slip"),
                {set("/backend", backend)});
    scene.run_steps(40);
    for (int body = 0; body < 3; ++body)
      for_each_particle(scene, body, [](double, const Velocity& v) { CHECK(v[0] == Approx(0.4).epsilon(1e-9)); });
  }
}

// The wall stops what moves across it; the normal n = (0.6, 0.8) leans, so that contact pushes along it and across it. Of a
// pair with the velocities (1, 0) and (0, 0) contact makes (1, 0) - 0.3 n and 0.3 n. At a node on the wall the condition then
// takes the part across away, and after the forces contact acts once more, on 0.64 along the wall; at a free node the
// bodies no longer approach one another.
TEST_CASE("conditions win over contact at a node", "[contact][conditions]") {
  const std::string contact =
      R"({"type": "frictionless", "normal": {"type": "given", "x": 0.6, "y": 0.8}, "detection": "approach"})";
  for (const std::string& backend : backends) {
    INFO(backend);
    const std::string text = in_one_place({"[1, 0]", "[0, 0]"}, contact, "slip");
    const std::vector<std::string> settings{set("/backend", backend)};
    Scene scene(text, settings);
    scene.run_steps(1);
    const double on_wall = 0.82 - 0.5 * 0.64 * 0.6 * 0.6;
    const std::array<double, 2> wall{on_wall, 1 - on_wall}, free_x{0.82, 0.18}, free_y{-0.24, 0.24};
    for (int body = 0; body < 2; ++body) {
      const auto k = static_cast<std::size_t>(body);
      for_each_particle(scene, body, [&](double height, const Velocity& v) {
        INFO("body " << body << ", " << height << " of a cell above the wall");
        CHECK(v[0] == Approx((1 - height) * wall[k] + height * free_x[k]).margin(1e-12));
        CHECK(v[1] == Approx(height * free_y[k]).margin(1e-12));
      });
    }
  }
}

// The nodes that are listed near a rigid body, its surface as they see it, and how it moves: against closed forms.

#include "simulation/rigid_bodies.hpp"

#include <cmath>
#include <set>

#include "simulation/boundary.hpp"
#include "simulation/contact_detection.hpp"
#include "simulation/rigid_outline.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double h = 0.1;

Experiment beside(int dimension, const std::string& body) {
  const bool flat = dimension == 2;
  return experiment_from(R"({"dimension": )" + std::to_string(dimension) +
                         R"(, "grid": {"cell_size": 0.1, "domain": )" +
                         (flat ? "[[-2, -1], [2, 1.5]]" : "[[-1, -1, -0.5], [1, 1, 1]]") + R"(},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0, "density": 1}},
    "bodies": [{"name": "a", "material": "m", "geometry": {"type": "ball", "centre": )" +
                         (flat ? "[0, 0]" : "[0, 0, 0]") + R"(, "radius": 0.2}}],
    "rigid_bodies": [{"contact": {"type": "frictionless"}, )" +
                         body + R"(}], "solver": {"end_time": 1}})");
}

/// All nodes, ghosts too, that are inside a distance from a cell outside to four cells inside.
template <class Distance>
std::set<std::array<int, 3>> expected(const Experiment& experiment, Distance distance) {
  std::set<std::array<int, 3>> nodes;
  const int D = experiment.dimension;
  std::array<int, 3> first{}, last{};
  for (int c = 0; c < D; ++c) first[c] = -grid_padding, last[c] = experiment.grid.cells[c] + grid_padding;
  std::array<int, 3> at{};
  for (at[0] = first[0]; at[0] <= last[0]; ++at[0])
    for (at[1] = first[1]; at[1] <= last[1]; ++at[1])
      for (at[2] = first[2]; at[2] <= last[2]; ++at[2]) {
        Vector3 x{};
        for (int c = 0; c < D; ++c) x[c] = experiment.grid.lower[c] + h * at[c];
        const double d = distance(x);
        if (d <= h && d >= -4 * h) nodes.insert(at);
      }
  return nodes;
}

std::set<std::array<int, 3>> listed(const RigidBodies& bodies) {
  std::set<std::array<int, 3>> nodes;
  for (const RigidNode& node : bodies.nodes(0)) nodes.insert(node.at);
  CHECK(nodes.size() == bodies.nodes(0).size());
  return nodes;
}

}  // namespace

TEST_CASE("all nodes near a rigid ball are listed, with its distance and normal") {
  for (const int dimension : {2, 3}) {
    const bool flat = dimension == 2;
    const Vector3 centre{0.33, 0.21, flat ? 0 : 0.17};
    const double radius = flat ? 1.2 : 0.7;
    const Experiment experiment = beside(
        dimension, R"("geometry": {"type": "ball", "centre": )" +
                       std::string(flat ? "[0.33, 0.21], \"radius\": 1.2}" : "[0.33, 0.21, 0.17], \"radius\": 0.7}"));
    RigidBodies bodies(experiment);
    bodies.begin_step();
    const auto from_centre = [&](const Vector3& x) {
      return std::sqrt(std::pow(x[0] - centre[0], 2) + std::pow(x[1] - centre[1], 2) + std::pow(x[2] - centre[2], 2));
    };
    CHECK(listed(bodies) == expected(experiment, [&](const Vector3& x) { return from_centre(x) - radius; }));
    double worst = 0;
    for (const RigidNode& node : bodies.nodes(0)) {
      const Vector3 x = bodies.place(node);
      worst = larger(worst, std::abs(node.surface.distance - (from_centre(x) - radius)));
      for (std::size_t c = 0; c < 3; ++c) {
        worst = larger(worst, std::abs(node.surface.normal[c] + (x[c] - centre[c]) / from_centre(x)));
        worst = larger(worst, std::abs(node.arm[c] - (x[c] - centre[c])));
      }
    }
    CHECK(worst < 1e-8);
  }
}

// A plane that starts along x, goes up by 0.3 m/s and turns by 0.5 rad/s about (0.2, 0) for a second in equal steps.
TEST_CASE("a rigid half space moves and turns as it is told") {
  const Experiment experiment =
      beside(2, R"("geometry": {"type": "half_space", "point": [0, -0.4], "normal": [0, 1]}, "about": [0.2, 0],
                   "velocity": [0.1, "0.3"], "angular_velocity": 0.5)");
  RigidBodies bodies(experiment);
  bodies.begin_step();
  const int steps = 50;
  for (int k = 0; k < steps; ++k) bodies.end_step({1.0 / steps, k * 1.0 / steps, k});
  bodies.begin_step();
  const RigidState& state = bodies.states()[0];
  CHECK(state.place[0] == Approx(0.3).epsilon(1e-12));
  CHECK(state.place[1] == Approx(0.3).epsilon(1e-12));
  const Vector3 up{-std::sin(0.5), std::cos(0.5), 0};
  const auto distance = [&](const Vector3& x) { return (x[0] - 0.3) * up[0] + (x[1] - 0.3) * up[1] + 0.4; };
  CHECK(listed(bodies) == expected(experiment, distance));
  for (const RigidNode& node : bodies.nodes(0)) {
    CHECK(std::abs(node.surface.distance - distance(bodies.place(node))) < 1e-12);
    CHECK(std::abs(node.surface.normal[0] + up[0]) < 1e-9);
    CHECK(std::abs(node.surface.normal[1] + up[1]) < 1e-9);
  }
  const Vector3 velocity = bodies.motion(0, 1).velocity_at({0.2, 0.4, 0});
  CHECK(velocity[0] == Approx(0.1 - 0.5 * 0.4));
  CHECK(velocity[1] == Approx(0.3 + 0.5 * 0.2));
  for (const auto& [from, to] : edges_of(experiment, 0, state)) {
    CHECK(std::abs(distance(from)) < 1e-12);
    CHECK(std::abs(distance(to)) < 1e-12);
  }
}

// In 3-D a turn about z and then one about x: rotations do not commute.
TEST_CASE("turns about changing axes follow one another") {
  const Experiment experiment = beside(3, R"("geometry": {"type": "box", "lower": [0, 0, 0], "upper": [0.4, 0.2, 0.1]},
    "about": [0, 0, 0], "angular_velocity": ["t > 0.505 ? pi : 0", 0, "t < 0.505 ? pi : 0"])");
  RigidBodies bodies(experiment);
  for (int k = 0; k < 100; ++k) bodies.end_step({0.01, k * 0.01, k});
  const auto& rotation = bodies.states()[0].rotation;  // x goes to y, and from there to z
  const double z_of_x = rotation[2][0], x_of_y = rotation[0][1], y_of_z = rotation[1][2];
  CHECK(z_of_x == Approx(1).epsilon(1e-12));
  CHECK(x_of_y == Approx(-1).epsilon(1e-12));
  CHECK(y_of_z == Approx(-1).epsilon(1e-12));
}

TEST_CASE("force and torque on a rigid body are the opposite of its reaction, about its point of reference") {
  RigidState state;
  state.acted_at = {1, 2, 0};
  Reaction reaction;
  reaction.force = {3, -4, 5};
  const Vector3 x{1.5, 2.5, 0.25}, arm{0.5, 0.5, 0.25};  // it acts at x: moment x cross force
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
    reaction.moment[c] = x[d] * reaction.force[e] - x[e] * reaction.force[d];
  }
  CHECK(state.force_on(reaction) == Vector3{-3, 4, -5});
  const Vector3 torque = state.torque_on(reaction);
  CHECK(torque[0] == Approx(-(arm[1] * 5 - arm[2] * -4)));
  CHECK(torque[1] == Approx(-(arm[2] * 3 - arm[0] * 5)));
  CHECK(torque[2] == Approx(-(arm[0] * -4 - arm[1] * 3)));
}

// The area is that of the material's own surface, and the edge is that of the material.
TEST_CASE("the gap and the area at a rigid body") {
  const Experiment experiment =
      beside(2, R"("geometry": {"type": "half_space", "point": [0, -0.4], "normal": [0, 1]})");
  const EdgeModel model(experiment.shape, 2);
  for (const double edge : {-0.7, -0.2, 0.0, 0.4}) {
    ContactFieldNode material;
    material.mass = 3, material.volume_gradient[0] = 0.2 * h, material.volume_gradient[1] = -0.7 * h;
    material.mass_position[1] = -3 * h * model.mean_position(edge);  // the body lies below: normals point down
    const ContactGeometry found = rigid_contact_geometry(material, model.table(), {0.05, {0, -1, 0}}, 1.5, h, 2);
    CHECK(found.separation == Approx(0.05 - edge * h).margin(1e-6));
    CHECK(found.area == Approx(1.5 * 0.7 * h));
    CHECK(found.valid);
  }
}

// The traction of contact on particles, from forces at nodes that are given.

#include "metrics/contact_traction.hpp"

#include "plugin/abi.h"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Two bodies that meet on a grid of 10 by 10 cells of 0.1 m, periodic along x.
Experiment two_bodies() {
  const auto body = [](const char* name, const char* lower, const char* upper) {
    return R"({"name": ")" + std::string(name) + R"(", "material": "m", "geometry": {"type": "box", "lower": )" +
           lower + R"(, "upper": )" + upper + "}}";
  };
  return experiment_from(R"({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[-0.5, 0], [0.5, 1]],
      "boundaries": {"all": "slip", "x_min": "periodic", "x_max": "periodic"}},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "contact": {"type": "frictionless"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [)" + body("low", "[-0.5, 0]", "[0.5, 0.5]") +
                         ", " + body("high", "[-0.5, 0.5]", "[0.5, 1]") + R"(], "solver": {"end_time": 1}})");
}

ContactNode node(int i, int j, double area, const Vector3& traction, int status = MPM_SLIPS) {
  ContactNode made;
  made.node = {i, j, 0}, made.a = 0, made.b = 1, made.area = area, made.status = status;
  for (std::size_t c = 0; c < 3; ++c) made.force[c] = area * traction[c];
  made.separation = status == MPM_APART ? 0.011 : -0.001;
  return made;
}

BodyState at(std::vector<double> position) {
  BodyState state;
  state.position = std::move(position);
  return state;
}

}  // namespace

TEST_CASE(
    "an even traction at nodes of any areas is that of the particles beside them, and the other body's is opposite") {
  const Experiment experiment = two_bodies();
  const Vector3 traction{30, -400, 0};
  std::vector<ContactNode> nodes;
  for (int i = 0; i < 10; ++i) nodes.push_back(node(i, 5, 0.02 + 0.01 * i, traction));
  nodes.push_back(node(3, 6, 5, {1e6, 1e6, 0}, MPM_APART));
  // In the row below the nodes, at a node, in the last cell of the periodic axis, and a cell away from all.
  const BodyState low = at({-0.42, 0.47, 0, 0.5, 0.46, 0.44, 0.1, 0.39});
  const std::vector<double> of_low = contact_traction(experiment, 0, low, nodes),
                            of_high = contact_traction(experiment, 1, low, nodes);
  REQUIRE(of_low.size() == 12);
  for (std::size_t p = 0; p < 4; ++p)
    for (std::size_t c = 0; c < 3; ++c) {
      INFO("particle " << p << ", component " << c);
      CHECK(of_low[3 * p + c] == Approx(p < 3 ? traction[c] : 0));
      CHECK(of_high[3 * p + c] == -of_low[3 * p + c]);
    }
  for (const double none : contact_traction(experiment, 0, low, {})) CHECK(none == 0);
}

TEST_CASE("a particle has the mean by area of the nodes up to two cells around") {
  const Experiment experiment = two_bodies();
  std::vector<ContactNode> nodes{node(9, 5, 0.1, {0, -100, 0}), node(0, 5, 0.3, {0, -900, 0}),
                                 node(1, 7, 0.2, {0, -40, 0})};
  // In the last cell of the periodic axis, nearer to node 9: node 0 is the image at the cell's other side, 1 lies two away.
  const BodyState particle = at({0.425, 0.5});
  const double expected = -(0.1 * 100 + 0.3 * 900 + 0.2 * 40) / (0.1 + 0.3 + 0.2);
  CHECK(contact_traction(experiment, 0, particle, nodes)[1] == Approx(expected));
  nodes.push_back(node(2, 5, 7, {0, -1e9, 0}));  // three away
  CHECK(contact_traction(experiment, 0, particle, nodes)[1] == Approx(expected));
  // In the upper half of the cell node 0 is the nearest one, and that node two away.
  CHECK(contact_traction(experiment, 0, at({0.475, 0.5}), nodes)[1] == Approx(-(280 + 8 + 7e9) / 7.6));
}

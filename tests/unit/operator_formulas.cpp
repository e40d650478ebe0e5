// Formulas that backends and plugins share, one at a time, against their definitions.

#include <cmath>

#include "kernel/artificial_viscosity.hpp"
#include "kernel/direction.hpp"
#include "kernel/linear_system.hpp"
#include "operators/contact.hpp"
#include "operators/edges.hpp"
#include "operators/rigid_contact.hpp"
#include "support/catch.hpp"

using namespace mpm;

namespace {

/// A table whose ends are four means; behind them lies what it must never read.
constexpr double edges[] = {0, 2, 3, 10, 1e30, 1e30}, means[] = {0, 1, 3, 4, -1e30, -1e30};
constexpr EdgeTable table{edges, means, 4};

ContactFieldNode with_gradient(double x, double y, double z) {
  ContactFieldNode node{};
  node.mass = 2;
  node.volume_gradient[0] = x, node.volume_gradient[1] = y, node.volume_gradient[2] = z;
  return node;
}

}  // namespace

TEST_CASE("a table of edges is linear between its means and ends where it ends") {
  CHECK(table.edge(-1) == 0);
  CHECK(table.edge(0.25) == Approx(0.5));
  CHECK(table.edge(2) == Approx(2.5));
  CHECK(table.edge(3.5) == Approx(6.5));
  CHECK(table.edge(5) == 10);
}

TEST_CASE("the normal of averaged gradients is the direction of their difference") {
  double normal[3] = {};
  REQUIRE(average_gradient(with_gradient(1, 4, 9), with_gradient(-2, 0, 9), 3, normal));
  CHECK(normal[0] == Approx(0.6));
  CHECK(normal[1] == Approx(0.8));
  CHECK(normal[2] == 0);
  CHECK_FALSE(average_gradient(with_gradient(1, 2, 5), with_gradient(1, 2, 6), 2, normal));
}

TEST_CASE("the area beside a rigid body is that of the material's own surface along the normal") {
  const RigidSurface surface{0.25, {0.6, 0.8, 0}};
  const ContactGeometry flat = rigid_contact_geometry(with_gradient(3, 2, 5), table, surface, 2, 0.5, 2);
  CHECK(flat.area == Approx(2 * (3 * 0.6 + 2 * 0.8)));
  CHECK(flat.separation == Approx(0.25));
  CHECK(flat.valid);
  for (int c = 0; c < 3; ++c) CHECK(flat.normal[c] == surface.normal[c]);
  ContactFieldNode off_its_middle =
      with_gradient(3, 2, 5);  // its material lies half a cell towards the body, its edge a cell
  off_its_middle.mass_position[0] = 0.3, off_its_middle.mass_position[1] = 0.4;
  CHECK(rigid_contact_geometry(off_its_middle, table, surface, 2, 0.5, 2).separation == Approx(0.25 - 0.5));
  const RigidSurface solid{0.25, {0, 0.6, 0.8}};
  CHECK(rigid_contact_geometry(with_gradient(3, 2, 5), table, solid, 1, 0.5, 3).area == Approx(5.2));
  CHECK(rigid_contact_geometry(with_gradient(-3, -2, 0), table, surface, 1, 0.5, 2).area == 0);
}

TEST_CASE("a vector along any axis has a direction, and none has none") {
  for (int axis = 0; axis < 3; ++axis) {
    Vec<3, double> v{};
    v[axis] = -2;
    CHECK(make_unit(v) == 1);
    CHECK(v[axis] == -1);
  }
  for (int axis = 0; axis < 2; ++axis) {
    Vec<2, double> v{};
    v[axis] = -2;
    CHECK(make_unit(v) == 1);
    CHECK(v[axis] == -1);
  }
  Vec<3, double> oblique{{3, 0, -4}}, none{};
  CHECK(make_unit(oblique) == 1);
  CHECK(oblique[2] == Approx(-0.8));
  CHECK(make_unit(none) == 0);
}

TEST_CASE("a system that is singular to rounding has no solution, and numbers may be however small") {
  double singular[2][2] = {{1, 1}, {1, 1 + 4e-16}}, nothing[2] = {1, 2};
  CHECK_FALSE(solve_symmetric(singular, nothing));
  double small[2][2] = {{4e-20, 2e-20}, {2e-20, 3e-20}}, x[2] = {8e-20, 8e-20};
  REQUIRE(solve_symmetric(small, x));
  CHECK(x[0] == Approx(1));
  CHECK(x[1] == Approx(2));
  double large[3][3] = {{4, 2, 1}, {2, 5, 3}, {1, 3, 6}}, y[3] = {4 + 4 + 3, 2 + 10 + 9, 1 + 6 + 18};
  REQUIRE(solve_symmetric(large, y));
  for (int i = 0; i < 3; ++i) CHECK(y[i] == Approx(i + 1));
}

TEST_CASE("walls mirror what is across them with the other sign, and all of what they hold") {
  for (int axis = 0; axis < 3; ++axis)
    for (int c = 0; c < 3; ++c) {
      CHECK(mirror_sign(wall_periodic, axis, c) == 1);
      CHECK(mirror_sign(wall_stick, axis, c) == -1);
      CHECK(mirror_sign(wall_prescribed, axis, c) == -1);
      CHECK(mirror_sign(wall_slip, axis, c) == (c == axis ? -1 : 1));
      for (const bool held : {false, true}) {
        for (const int rule : {rule_none, rule_even, rule_heat, rule_heat_rate, rule_momentum, rule_slip})
          CHECK(mirror_sign(rule, wall_periodic, held, axis, c) == 1);
        CHECK(mirror_sign(rule_none, wall_stick, held, axis, c) == 1);
        CHECK(mirror_sign(rule_even, wall_slip, held, axis, c) == 1);
        CHECK(mirror_sign(rule_heat, wall_slip, held, axis, c) == (held ? -1 : 1));
        CHECK(mirror_sign(rule_heat_rate, wall_stick, held, axis, c) == (held ? -1 : 1));
        CHECK(mirror_sign(rule_momentum, wall_stick, held, axis, c) == -1);
        CHECK(mirror_sign(rule_slip, wall_stick, held, axis, c) == (c == axis ? -1 : 1));
      }
    }
  CHECK((is_relative_to_wall(rule_momentum) && is_relative_to_wall(rule_heat)));
  CHECK_FALSE(
      (is_relative_to_wall(rule_vector) || is_relative_to_wall(rule_heat_rate) || is_relative_to_wall(rule_slip)));
}

TEST_CASE("an impulse under a cap changes the lighter body's velocity by the cap, and sliding takes less") {
  // An impulse of 5 kg m/s on 2 kg and on 8 kg: 2.5 m/s for the lighter one.
  CHECK(share_under_cap(25.0, 2.0, 8.0, 1.0) == 0.4);
  CHECK(share_under_cap(25.0, 8.0, 2.0, 1.0) == 0.4);
  CHECK(share_under_cap(25.0, 2.0, 8.0, 2.6) == 1);
  // They slide at 3 m/s with a reduced mass of 1.6 kg; an impulse of 4.8 stops them: (1/2) 1.6 3^2 = 7.2 J. A half of it leaves
  // 1.5 m/s and takes three quarters.
  CHECK(dissipated_by_share(7.2, 0.5, -3 * 4.8, 4.8 * 4.8, 2.0, 8.0) == Approx(5.4));
  CHECK(dissipated_by_share(7.2, 1.0, -3 * 4.8, 4.8 * 4.8, 2.0, 8.0) == Approx(7.2));
  CHECK(dissipated_by_share(0.0, 0.5, 0.0, 0.0, 2.0, 8.0) == 0);
}

TEST_CASE(
    "a law sees the free body of a pair, whichever the grip holds, by its own mass and its speed beside the other") {
  CHECK(mass_beside_held(true, 2.0, 6.0) == 6);
  CHECK(mass_beside_held(false, 2.0, 6.0) == 2);
  CHECK(momentum_beside(1.0, 4.0, 6.0) == -18);
  CHECK(held_mass(2.0, 6.0, false) == 2);
  CHECK(held_mass(2.0, 6.0, true) == 8);
}

TEST_CASE("bodies meet where both have mass, and the lighter one a share that counts or a weld") {
  CHECK(meet(1.0, 1.0, false));
  CHECK_FALSE(meet(0.0, 1.0, true));
  CHECK_FALSE(meet(1.0, 0.0, true));
  for (const bool weld : {false, true}) {
    CHECK(meet(3.6e-5, 4.0, weld) == weld);
    CHECK(meet(4.0, 3.6e-5, weld) == weld);
    CHECK(meet(4.4e-5, 4.0, weld));
  }
}

TEST_CASE("the gradient of a displacement by the present place is I less the inverse of F") {
  const Mat<2, double> flat = displacement_gradient(Mat<2, double>{{3, 2, 0.5, 1.5}});  // of the determinant 3.5
  const double in_plane[] = {1 - 1.5 / 3.5, 2 / 3.5, 0.5 / 3.5, 1 - 3 / 3.5};
  for (int k = 0; k < 4; ++k) CHECK(flat.m[k] == Approx(in_plane[k]));
  const Mat<3, double> solid = displacement_gradient(Mat<3, double>{{1, 2, 0, 0, 1, 3, 2, 0, 1}});
  const double inverse[] = {1, -2, 6, 6, 1, -3, -2, 4, 1};  // over 13
  for (int k = 0; k < 9; ++k) CHECK(solid.m[k] == Approx((k % 4 == 0 ? 1 : 0) - inverse[k] / 13));
}

TEST_CASE("a pair is measured by the means, edges and areas of both bodies along its normal") {
  ContactFieldNode a = with_gradient(3, 2, 5), b = with_gradient(-2, -1, 6);
  a.mass = 3, b.mass = 4;
  a.mass_position[0] = 0.45, a.mass_position[1] = 0.6, a.mass_position[2] = 9;    // its mean is half a cell along it
  b.mass_position[0] = -1.2, b.mass_position[1] = -1.6, b.mass_position[2] = -9;  // a cell against it
  const double normal[] = {0.6, 0.8, 0.5};
  DetectionPair<double> seen{};
  see_means(seen, a, b, normal, 0.5, 2);
  CHECK(seen.mean_a == Approx(0.5));
  CHECK(seen.mean_b == Approx(-1));
  CHECK((seen.edge_a == 0 && seen.edge_b == 0 && seen.surface_a == 0 && seen.surface_b == 0));
  see_edges(seen, table, table);
  CHECK(seen.edge_a == Approx(1));
  CHECK(seen.edge_b == Approx(-2));
  CHECK(contact_area(a, b, normal, 2, 7) == Approx(7 * (2 * 0.6 + 0.8)));
  CHECK(contact_area(a, with_gradient(-5, -4, 0), normal, 2, 7) == Approx(7 * (3 * 0.6 + 2 * 0.8)));
  CHECK(contact_area(a, b, normal, 3, 7) == 0);  // along the third axis b lies on the same side
  a.mass_displacement[1] = 1.5, b.mass_displacement[1] = 6;
  CHECK(displacement_of_pair(a, b, 1) == 1);
  CHECK(around_axis(2) == Approx(12.566370614359172));
  CHECK(around_axis(-1) == 0);
}

// q = density h r (C1 c + C2 h r). A small change of r sees the slope of q over it, and a step the damped wave.
TEST_CASE("artificial viscosity is a pressure, and its slope a viscosity") {
  const ArtificialViscosity<double> law{2, 3, 5};
  const double pressure = law.pressure(7.0, 11.0);
  CHECK(pressure == Approx(2 * 7 * (5 * 7 + 3 * 11)));
  CHECK(law.kinematic(11.0 * 11, pressure) == Approx(2 * 5 * 7 + 3 * 11));
  CHECK(law.kinematic(4.0, 10.0) == Approx(std::sqrt(9 * 4 + 4 * 5 * 10 / 2.0)));
  const double damping = std::sqrt(3.0) * law.kinematic(4.0, 10.0) / 0.5;
  CHECK(law.damped_speed(4.0, 10.0, 2.0) == Approx(damping + std::sqrt(4 + damping * damping)));
  CHECK(compression_rate(-6.0, 0.5) == 12);
  CHECK(compression_rate(6.0, 0.5) == 0);
}

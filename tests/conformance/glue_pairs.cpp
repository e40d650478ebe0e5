// Single pairs of breakable glue against the laws that it is made of and the closed forms of its ellipse: an area that is
// loaded in the direction phi of the ellipse gives up (N^2 cos^2 phi / k_n + T^2 sin^2 phi / k_s) / 2.

#include <cmath>
#include <limits>

#include "contacts/bilinear_interface/bilinear_interface.hpp"
#include "contacts/breakable_glue/breakable_glue.hpp"
#include "contacts/coulomb/coulomb.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;

constexpr double area = 0.2, dt = 1e-3;
/// Tension, compression and shear stiffness, Pa/m, both strengths, Pa, friction, reach.
constexpr BreakableGlue::Parameters glue{2e4, 5e4, 1e4, 300, 200, 0.3, 0.5};

/// Glue that is loaded by the traction `size` (N cos phi, T sin phi), Pa, whose slip has both directions.
ContactPair<3, double> loaded(double size, double phi) {
  ContactPair<3, double> pair{};
  pair.mass_a = 2, pair.mass_b = 6;
  pair.normal = {{0, 1, 0}};
  pair.momentum_a = {{2 * 1.8, 2 * 4.0, 2 * 2.4}}, pair.momentum_b = {{0, 0, 0}};
  pair.separation = -0.01, pair.area = area, pair.dt = dt, pair.cell_size = 0.1;
  const double slip = size * glue.shear_strength * std::sin(phi) / glue.shear_stiffness;
  pair.displacement = {{0.6 * slip, size * glue.normal_strength * std::cos(phi) / glue.tension_stiffness, 0.8 * slip}};
  pair.state_a = pair.state_b = {{1, 0}};
  return pair;
}

template <class Law>
ContactResult<3, double> result(const typename Law::Parameters& p, const ContactPair<3, double>& pair) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();  // what a law leaves out is no number
  ContactResult<3, double> found{{{nothing, nothing, nothing}}, nothing, 0, 0, {{nothing, nothing}}};
  Law::apply(p, pair, found);
  return found;
}

bool same(const ContactResult<3, double>& a, const ContactResult<3, double>& b) {
  return a.impulse[0] == b.impulse[0] && a.impulse[1] == b.impulse[1] && a.impulse[2] == b.impulse[2] &&
         a.dissipated == b.dissipated && a.stored == b.stored && a.status == b.status;
}

bool holds(const ContactPair<3, double>& pair) {
  const bool springs = same(result<BreakableGlue>(glue, pair), result<BilinearInterface>({2e4, 5e4, 1e4}, pair));
  const bool free = same(result<BreakableGlue>(glue, pair), result<Coulomb>({0.3, 0.3}, pair));
  CHECK(springs != free);  // it is either of them to the last bit
  return springs;
}

}  // namespace

TEST_CASE("glue says that it breaks beyond its ellipse, and lets go by itself at twice that") {
  for (const double phi : {0.0, 0.4, 0.8, 1.2, 1.5707963267948966}) {
    INFO(phi);
    for (const double size : {0.999, 1.001, 1.999}) CHECK(holds(loaded(size, phi)));
    CHECK_FALSE(holds(loaded(2.001, phi)));
    CHECK(result<BreakableGlue>(glue, loaded(0.999, phi)).reached[BreakableGlue::broken] == 0);
    CHECK(result<BreakableGlue>(glue, loaded(1.001, phi)).reached[BreakableGlue::broken] == 1);
  }
  // Compression adds nothing to the loading: the slip alone counts.
  ContactPair<3, double> pressed = loaded(0.999, 1.5707963267948966);
  pressed.displacement[1] = -0.05;
  CHECK(holds(pressed));
  CHECK(result<BreakableGlue>(glue, pressed).reached[BreakableGlue::broken] == 0);
  pressed.displacement[0] *= 1.01, pressed.displacement[2] *= 1.01;
  CHECK(result<BreakableGlue>(glue, pressed).reached[BreakableGlue::broken] == 1);
}

TEST_CASE("glue takes the stiffness of the side on which the pair is halfway through the step") {
  for (const double opening : {0.001, 0.003}) {  // the pair closes by 0.002 until then
    INFO(opening);
    CHECK(holds(loaded(opening * glue.tension_stiffness / glue.normal_strength, 0)));
  }
}

TEST_CASE("glue needs both bodies glued from the start, and holds until half of it has broken") {
  for (const double glued : {0.4, 0.6})
    for (const double broken : {0.4, 0.6}) {
      INFO(glued << " " << broken);
      ContactPair<3, double> pair = loaded(0.5, 0.7);
      pair.state_a = {{glued, broken}};
      CHECK(holds(pair) == (glued > 0.5));  // the other body's share of what has broken is the smaller one
      std::swap(pair.state_a, pair.state_b);
      CHECK(holds(pair) == (glued > 0.5));
      pair.state_a = pair.state_b;
      CHECK(holds(pair) == (glued > 0.5 && broken < 0.5));
    }
  // Neither what was never glued nor what has broken already says so again unless it is loaded.
  ContactPair<3, double> pair = loaded(0.5, 0.7);
  pair.state_a = pair.state_b = {{1, 1}};
  CHECK(result<BreakableGlue>(glue, pair).reached[BreakableGlue::broken] == 0);
  CHECK(result<BreakableGlue>(glue, pair).reached[BreakableGlue::glued] == 0);
  pair = loaded(2, 0.7);
  pair.state_a = pair.state_b = {{0, 0}};
  CHECK(result<BreakableGlue>(glue, pair).reached[BreakableGlue::broken] == 0);
}

TEST_CASE("bodies are glued where they begin within reach of one another") {
  ContactPair<3, double> pair = loaded(0, 0);
  pair.first_step = true, pair.state_a = pair.state_b = {{0, 0}};
  for (const double separation : {-0.2, 0.0, 0.049, 0.051}) {
    INFO(separation);
    pair.separation = separation;
    const bool near = separation < 0.05;  // half a cell
    CHECK(result<BreakableGlue>(glue, pair).reached[BreakableGlue::glued] == (near ? 1 : 0));
    CHECK(holds(pair) == near);
  }
}

TEST_CASE("what breaks gives up the energy of its direction in the ellipse, once and after the forces") {
  for (const double phi : {0.0, 0.4, 0.8, 1.5707963267948966})
    for (const double size : {0.7, 1.0001, 3.0}) {
      INFO(phi << " " << size);
      const double c = std::cos(phi), s = std::sin(phi), n = glue.normal_strength, t = glue.shear_strength;
      const double energy = area / 2 * (n * n * c * c / glue.tension_stiffness + t * t * s * s / glue.shear_stiffness);
      ContactPair<3, double> pair = loaded(size, phi);
      pair.state_a = {{1, 0.6}}, pair.state_b = {{1, 0.7}};
      const ContactResult<3, double> before = result<BreakableGlue>(glue, pair);
      pair.gained_a = {{0, 0.3}}, pair.gained_b = {{0, 0.27}};
      const ContactResult<3, double> found = result<BreakableGlue>(glue, pair);
      const double share = 0.6 - 0.3;  // of the smaller of both shares, now and a step ago
      CHECK(found.dissipated - before.dissipated == Approx(share * energy).epsilon(1e-12));
      CHECK(found.stored - before.stored == Approx(-share * energy).epsilon(1e-10));
      for (int i = 0; i < 3; ++i) CHECK(found.impulse[i] == before.impulse[i]);
      pair.after_forces = false;
      ContactPair<3, double> quiet = pair;
      quiet.gained_a = quiet.gained_b = {};
      CHECK(result<BreakableGlue>(glue, pair).dissipated == result<BreakableGlue>(glue, quiet).dissipated);
      pair.after_forces = true, pair.state_b = {{1, 0.2}}, pair.gained_b = {};  // it breaks for another pair
      quiet = pair, quiet.gained_a = {};
      CHECK(result<BreakableGlue>(glue, pair).dissipated == result<BreakableGlue>(glue, quiet).dissipated);
    }
  // What compression has stored goes whole.
  ContactPair<3, double> pressed = loaded(1.0001, 1.5707963267948966);
  pressed.displacement[1] = -0.002;
  pressed.state_a = pressed.state_b = {{1, 1}}, pressed.gained_a = pressed.gained_b = {{0, 1}};
  const double shear = area * 200 * 200 / (2 * 1e4), compression = area * 5e4 * 0.002 * 0.002 / 2;
  CHECK(result<BreakableGlue>(glue, pressed).stored == Approx(-shear - compression).epsilon(1e-12));
}

// A node of mass m and area A turns by a radian in a step where k A dt^2 = m.
TEST_CASE("the longest step keeps the springs of nodes with twelve times the area of their mass") {
  const double limit = BreakableGlue::step_limit(glue, 1000, 0.1);
  CHECK(5e4 * limit * limit * 12 / (1000 * 0.1) == Approx(1).epsilon(1e-14));
}

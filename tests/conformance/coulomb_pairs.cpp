// Coulomb friction of single pairs, by hand: reduced mass m = m_a m_b/(m_a + m_b), normal impulse m u_n, friction
// min(m u_t, mu m u_n), heat by friction (Bardenhagen, Brackbill & Sulsky 2000): friction times the mean sliding speed.

#include <cmath>

#include "contacts/coulomb/coulomb.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;

/// Body a, 2 kg, hits body b, 6 kg, which rests: m = 1.5 kg. It approaches by 4 m/s and slides by 3 m/s, so that it
/// sticks from a friction of 3/4 on.
ContactPair<3, double> hit(double separation) {
  ContactPair<3, double> pair{};
  pair.mass_a = 2, pair.mass_b = 6;
  pair.normal = {{0, 1, 0}};
  pair.momentum_a = {{2 * 1.8, 2 * 4.0, 2 * 2.4}}, pair.momentum_b = {{0, 0, 0}};
  pair.separation = separation;
  return pair;
}

ContactResult<3, double> result(const Coulomb::Parameters& p, double separation = -0.01) {
  ContactResult<3, double> found{};
  Coulomb::apply(p, hit(separation), found);
  return found;
}

void check_result(const ContactResult<3, double>& found, double normal, double friction, double heat, int status) {
  CHECK(std::abs(found.impulse[0] + 0.6 * friction) <= 1e-14);
  CHECK(std::abs(found.impulse[1] + normal) <= 1e-14);
  CHECK(std::abs(found.impulse[2] + 0.8 * friction) <= 1e-14);
  CHECK(std::abs(found.dissipated - heat) <= 1e-14);
  CHECK(found.status == status);
}

}  // namespace

TEST_CASE("a pair that slides takes the kinetic friction and makes heat of its work") {
  // mu = 1/4: normal 6 N s, friction 1.5 N s, sliding from 3 m/s to 2 m/s: heat 1.5 x 2.5 J.
  check_result(result({0.25, 0}), 6, 1.5, 3.75, 2);
  // mu = 1/2: friction 3 N s, from 3 m/s to 1 m/s: heat 3 x 2 J.
  check_result(result({0.5, 0}), 6, 3, 6, 2);
  check_result(result({0, 0}), 6, 0, 0, 2);
}

TEST_CASE("a pair sticks up to the larger coefficient of friction") {
  check_result(result({0.8, 0}), 6, 4.5, 0, 1);
  check_result(result({0.25, 0.8}), 6, 4.5, 0, 1);
  check_result(result({0.25, 0.7}), 6, 1.5, 3.75, 2);  // it slides with the kinetic one
}

TEST_CASE("a pair that is apart or parts is left alone") {
  check_result(result({0.25, 0}, 0.01), 0, 0, 0, 0);
  check_result(result({0.25, 0}, 0), 6, 1.5, 3.75, 2);
  ContactPair<3, double> parting = hit(-0.01);
  parting.momentum_a[1] = -8;
  ContactResult<3, double> found{};
  Coulomb::apply({0.25, 0}, parting, found);
  check_result(found, 0, 0, 0, 0);
}

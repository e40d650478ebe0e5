// Sand on triaxial paths, in Kirchhoff stresses; and what a gap opened in tension does afterwards.

#include <algorithm>
#include <cmath>
#include <string>

#include "materials/drucker_prager/drucker_prager.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;
using State3 = DruckerPrager::State<3, double>;

constexpr double young = 1e7, poisson = 0.3, bulk = young / (3 * (1 - 2 * poisson));
constexpr double degree = 3.14159265358979323846 / 180;

State3 initial() {
  return {{Mat3::identity()}, 1};
}

/// One particle driven by increments dt L.
struct Particle {
  DruckerPrager::Constants<double> constants;
  State3 state = initial();
  double heat = 0;

  Particle(double friction_angle, double cohesion, bool corrected = true)
      : constants({young, poisson, 1600, friction_angle, cohesion, corrected ? 1.0 : 0.0}) {}

  Sym<3, double> stress() const { return DruckerPrager::kirchhoff_stress(constants, state); }
  double mean_strain() const { return DruckerPrager::sum(DruckerPrager::prepared(state).strain); }
  double advance(const Mat3& increment) {
    const double now = DruckerPrager::advance(constants, increment, 1.0, state);
    heat += now;
    return now;
  }
  double advance(double x, double y, double z) { return advance({{x, 0, 0, 0, y, 0, 0, 0, z}}); }

  /// The deviatoric stress; compression is positive.
  double q() const { return stress()(1, 1) - stress()(0, 0); }
  double p() const { return -trace(stress()) / 3; }

  void press_to(double pressure) {
    const double stretch = std::exp(-pressure / (3 * bulk)) - 1;
    advance(stretch, stretch, stretch);
    REQUIRE(std::abs(p() / pressure - 1) < 1e-9);
  }

  /// Compresses axially while the lateral stress stays: the lateral increment by a secant.
  void squeeze(double axial, double lateral_stress) {
    const Particle before = *this;
    const auto miss = [&](double side) {
      *this = before;
      advance(-axial, side, side);
      return (stress()(1, 1) + lateral_stress) / lateral_stress;
    };
    double a = 0, b = poisson * axial, at_a = miss(a), at_b = miss(b);
    for (int iteration = 0; iteration < 60 && std::abs(at_b) > 1e-13 && at_a != at_b; ++iteration) {
      const double next = b - at_b * (b - a) / (at_b - at_a);
      a = b, at_a = at_b;
      b = next, at_b = miss(b);
    }
    REQUIRE(std::abs(at_b) < 1e-10);
  }
};

}  // namespace

TEST_CASE("sand: triaxial compression fails at q = M p + k") {
  const double lateral = 1e5;
  for (double angle : {20.0, 30.0, 40.0})
    for (double cohesion : {0.0, 1e4, 5e4}) {
      CAPTURE(angle, cohesion);
      const double sine = std::sin(angle * degree), cosine = std::cos(angle * degree);
      const double M = 6 * sine / (3 - sine), k = 6 * cohesion * cosine / (3 - sine);
      const double q_f = (3 * M * lateral + 3 * k) / (3 - M);
      const double mohr_coulomb = lateral * (1 + sine) / (1 - sine) + 2 * cohesion * cosine / (1 - sine);
      CHECK(std::abs((lateral + q_f) / mohr_coulomb - 1) < 1e-12);
      Particle sand(angle * degree, cohesion);
      sand.press_to(lateral);
      double q = sand.q(), p = sand.p();
      int elastic = 0;
      for (int step = 0; step < 100; ++step) {
        sand.squeeze(q_f / young / 40, lateral);
        if (sand.heat == 0) {
          CHECK(std::abs((sand.q() - q) / (sand.p() - p) - 3) < 1e-6);
          ++elastic;
        }
        q = sand.q(), p = sand.p();
      }
      CHECK(elastic > 30);
      CHECK(elastic < 50);
      CHECK(std::abs(q / q_f - 1) < 1e-8);
      CHECK(std::abs(-sand.stress()(0, 0) / mohr_coulomb - 1) < 1e-8);
      CHECK(sand.heat > 0);
    }
}

TEST_CASE("sand: the published numbers at 30 degrees") {
  Particle sand(30 * degree, 0);
  sand.press_to(1e5);
  for (int step = 0; step < 60; ++step) sand.squeeze(1e-3, 1e5);
  CHECK(std::abs(sand.q() / 200e3 - 1) < 1e-8);
  CHECK(std::abs(-sand.stress()(0, 0) / 300e3 - 1) < 1e-8);
  // The cone's slope from the alpha of Klar et al.: k = alpha (3 lambda + 2 mu)/(2 mu).
  const auto& c = sand.constants;
  CHECK(std::abs(c.slope * 2 * c.mu / (3 * c.lambda + 2 * c.mu) - 0.32659863) < 5e-9);
}

TEST_CASE("sand: flow at failure keeps the volume and dissipates q times the plastic strain") {
  Particle sand(30 * degree, 0);
  sand.press_to(1e5);
  for (int step = 0; step < 60; ++step) sand.squeeze(1e-3, 1e5);
  const double volume = sand.state.volume_ratio, heat = sand.heat;
  for (int step = 0; step < 20; ++step) sand.squeeze(1e-4, 1e5);
  CHECK(std::abs(sand.state.volume_ratio - volume) < 1e-9);
  // With axial strain e and lateral -e/2 each, the work is s1 e - s3 e = q e, all of it heat at constant stress.
  CHECK(sand.heat - heat == Approx(200e3 * -20 * std::log(1 - 1e-4)).epsilon(1e-6));
}

TEST_CASE("sand: dry sand carries no tension") {
  for (bool corrected : {true, false}) {
    Particle sand(30 * degree, 0, corrected);
    sand.press_to(1e4);
    sand.advance({{0.02, 0.01, 0, 0, 0.01, 0, -0.02, 0, 0.03}});
    CHECK(std::abs(sand.mean_strain()) < 1e-14);
    for (double component : sand.stress().s) CHECK(std::abs(component) < 1e-14 * young);
    CHECK(DruckerPrager::stored_energy(sand.constants, sand.state) < 1e-20 * young);
  }
}

TEST_CASE("a gap opened in tension must close before pressure returns") {
  Particle sand(30 * degree, 0);
  for (int step = 0; step < 50; ++step) sand.advance(1e-3, 1e-3, 1e-3);
  double least = 0, worst = 0;
  for (int step = 0; step < 80; ++step) {
    sand.advance(-1e-3, -1e-3, -1e-3);
    const double volume = std::log(sand.state.volume_ratio), pressure = sand.p();
    if (volume > 1e-12) worst = larger(worst, std::abs(pressure));
    if (volume < 0) {
      CHECK(std::abs(pressure / (-bulk * volume) - 1) < 1e-10);
      least = smaller(least, volume);
    }
  }
  CHECK(worst < 1e-7);
  CHECK(least < -0.05);
}

TEST_CASE(
    "sand that closes a gap and is pressed without yielding feels the pressure of its volume beside its own shear") {
  Particle sand(40 * degree, 0);
  sand.advance(3e-3, 3e-3, 3e-3);  // parted, free of stress
  CHECK(std::abs(sand.mean_strain()) < 1e-14);
  const double steps[3] = {-0.011, -0.0105, -0.010};
  double strain[3], trace = 0;
  for (int i = 0; i < 3; ++i) trace += strain[i] = std::log1p(steps[i]);
  sand.advance(steps[0], steps[1], steps[2]);
  const double volume = trace + 3 * std::log1p(3e-3), shear = young / (2 * (1 + poisson));
  REQUIRE(volume < 0);
  for (int i = 0; i < 3; ++i)
    CHECK(sand.stress().s[i] == Approx(bulk * volume + 2 * shear * (strain[i] - trace / 3)).epsilon(1e-9));
}

TEST_CASE("without volume correction pressure returns at once") {
  Particle sand(30 * degree, 0, false);
  for (int step = 0; step < 50; ++step) sand.advance(1e-3, 1e-3, 1e-3);
  sand.advance(-1e-3, -1e-3, -1e-3);
  CHECK(sand.state.volume_ratio > 1.1);
  CHECK(sand.p() == Approx(-3 * bulk * std::log(1 - 1e-3)).epsilon(1e-9));
}

TEST_CASE("cohesive sand parts at c cot phi, unloads its tension, and presses again only below J = 1") {
  const double cohesion = 2e4, tension = cohesion / std::tan(30 * degree);
  Particle sand(30 * degree, cohesion);
  for (int step = 0; step < 50; ++step) sand.advance(1e-3, 1e-3, 1e-3);
  CHECK(std::abs(-sand.p() / tension - 1) < 1e-9);
  // What was put in beyond the tip is heat: c cot phi times the volume that opened.
  CHECK(sand.heat == Approx(tension * (std::log(sand.state.volume_ratio) - tension / bulk)).epsilon(1e-9));
  const double heat = sand.heat;
  sand.advance(-1e-4, -1e-4, -1e-4);
  CHECK(-sand.p() == Approx(tension + 3 * bulk * std::log(1 - 1e-4)).epsilon(1e-9));
  double strongest = 0;
  while (std::log(sand.state.volume_ratio) > 3e-3) {
    CHECK(sand.advance(-1e-3, -1e-3, -1e-3) >= 0);
    strongest = larger(strongest, sand.p());
  }
  CHECK(strongest < 1e-7);
  for (int step = 0; step < 10; ++step) CHECK(sand.advance(-1e-3, -1e-3, -1e-3) >= -1e-20 * young);
  CHECK(std::abs(sand.p() / (-bulk * std::log(sand.state.volume_ratio)) - 1) < 1e-10);
  CHECK(sand.heat >= heat);
}

TEST_CASE("shearing to and fro under pressure neither dilates nor compacts") {
  for (double cohesion : {0.0, 1e4}) {
    Particle sand(35 * degree, cohesion);
    sand.press_to(5e4);
    const double pressure = sand.p();
    for (int step = 0; step < 400; ++step) sand.advance({{0, step / 50 % 2 ? 1e-3 : -1e-3, 0, 0, 0, 0, 0, 0, 0}});
    CHECK(std::abs(sand.p() / pressure - 1) < 1e-9);
    CHECK(sand.heat > 0);
  }
}

TEST_CASE("sand that does not yield keeps the elastic deformation gradient to the last bit") {
  Particle sand(30 * degree, 1e4);
  sand.press_to(1e5);
  Mat3 F = sand.state.elastic_deformation_gradient.plane;
  for (int step = 0; step < 10; ++step) {
    const Mat3 L{{1e-6 * step, 3e-7, 0, -2e-7, 1e-6, 1e-7, 4e-7, 0, -1e-6}};
    F = advanced(F, L, 1.0);
    CHECK(sand.advance(L) == 0);
    for (int k = 0; k < 9; ++k) CHECK(sand.state.elastic_deformation_gradient.plane.m[k] == F.m[k]);
  }
}

TEST_CASE("sand: the wave speed at rest is the fastest that yielding on the cone allows") {
  const double shear = young / (2 * (1 + poisson)), most = std::sqrt(2.0 / 3);
  for (double angle : {10.0, 30.0, 44.0, 50.0, 60.0, 75.0}) {  // with k below, between and above 2 sqrt(2/3) and 2
    CAPTURE(angle);
    const double sine = std::sin(angle * degree), k = most * 2 * sine / (3 - sine) * 3 * bulk / (2 * shear);
    double largest = 0;  // of u (k - u) over the components -u of unit deviators
    for (int n = 0; n <= 100000; ++n) largest = larger(largest, n * 1e-5 * most * (k - n * 1e-5 * most));
    const double modulus = bulk + 4 * shear / 3 + 2 * shear * largest;
    const Particle sand(angle * degree, 0);
    const double speed = DruckerPrager::wave_speed(sand.constants, sand.state);
    CHECK(std::abs(1600 * speed * speed / modulus - 1) < 1e-9);
  }
}

TEST_CASE("sand: the sine by its series is the sine") {
  for (int n = 0; n <= 90; ++n) CHECK(std::abs(DruckerPrager::sin_of(n * degree) - std::sin(n * degree)) <= 1e-15);
}

TEST_CASE("sand: shear waves between any two principal stretches are not faster than reported") {
  const double nu = -0.8, shear = young / (2 * (1 + nu));  // a small bulk modulus: shear waves are the fastest
  const DruckerPrager::Constants<double> c({young, nu, 1600, 30 * degree, 0, 1});
  double e[3] = {-0.7, 0.1, 0.5};
  do {
    CAPTURE(e[0], e[1], e[2]);
    const DruckerPrager::Principal<3, double> state{Mat3::identity(), {{e[0], e[1], e[2]}}};
    const double speed = DruckerPrager::wave_speed(c, state), modulus = 1600 * speed * speed, x = 1.2;
    CHECK(modulus >= 2 * shear * x / (1 - std::exp(-2 * x)));  // Hencky's law between stretches apart by exp(x)
    CHECK(std::abs(modulus / (shear * (1 + 2 * x)) - 1) < 1e-12);
  } while (std::next_permutation(e, e + 3));
}

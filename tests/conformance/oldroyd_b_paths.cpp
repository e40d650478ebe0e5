// Oldroyd-B liquid in the flows whose stresses are known in closed form (Bird, Armstrong & Hassager 1987, vol. 1, sec.
// 7.2), and its energy: work = stored + dissipated.

#include <cmath>
#include <random>

#include "kernel/lanes.hpp"
#include "materials/oldroyd_b/oldroyd_b.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;

constexpr double bulk = 5000, density = 1000, polymer = 30, time_constant = 0.5, solvent = 8, cell = 0.1;
constexpr double modulus = polymer / time_constant;

/// One particle.
struct Particle {
  OldroydB::Constants<double> constants;
  OldroydB::State<3, double> state{Sym<3, double>::identity(), {}, 1};
  double heat = 0, work = 0;

  explicit Particle(double solvent_viscosity = solvent)
      : constants({bulk, density, polymer, time_constant, solvent_viscosity, 2, cell}) {}
  Sym<3, double> stress() const { return OldroydB::kirchhoff_stress(constants, state); }
  double energy() const { return OldroydB::stored_energy(constants, state); }
  /// A step with the velocity gradient L. The work is that of the mean of the polymer's stress, and of the solvent's.
  void step(const Mat3& L, double dt) {
    Sym<3, double> before = stress();
    for (int k = 0; k < 6; ++k) before.s[k] -= state.solvent_stress.s[k];
    heat += OldroydB::advance(constants, L, dt, state);
    const Sym<3, double> d = rate_of_deformation(strain_rate(L, dt), dt), after = stress();
    const Mat3 late = behind(L, dt);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double elastic = after(i, j) - state.solvent_stress(i, j);
        work += dt * (0.5 * (before(i, j) * L(i, j) + elastic * late(i, j)) + state.solvent_stress(i, j) * d(i, j));
      }
  }
  /// The velocity gradient seen from the end of the step, L (I + dt L)^-1, to third order.
  static Mat3 behind(const Mat3& L, double dt) {
    const Mat3 second = L * L, third = second * L;
    Mat3 r = L;
    for (int k = 0; k < 9; ++k) r.m[k] += -dt * second.m[k] + dt * dt * third.m[k];
    return r;
  }
};

Mat3 shearing(double rate) {
  return {{0, rate, 0, 0, 0, 0, 0, 0, 0}};
}

}  // namespace

TEST_CASE(
    "Oldroyd-B: steady shear has the viscosity eta_p + eta_s at any rate and N1 = 2 eta_p lambda rate^2, N2 = 0") {
  for (double rate : {0.01, 1.0, 20.0})
    for (double y : {0.02, 0.5, 3.0}) {  // steps over the relaxation time
      CAPTURE(rate, y);
      Particle particle;
      const double dt = y * time_constant;
      const int steps = static_cast<int>(60 / y) + 2;
      for (int k = 0; k < steps; ++k) particle.step(shearing(rate), dt);
      const Sym<3, double> tau = particle.stress();
      Sym<3, double> of_polymer = tau;
      for (int k = 0; k < 6; ++k) of_polymer.s[k] -= particle.state.solvent_stress.s[k];
      CHECK(of_polymer(0, 1) == Approx(polymer * rate).epsilon(1e-11));
      // For steps of y relaxation times N1 is larger by (y/2) coth(y/2), by hand from the recurrence.
      const double discrete = y / 2 / std::tanh(y / 2), normal = 2 * polymer * time_constant * rate * rate;
      CHECK(of_polymer(0, 0) - of_polymer(1, 1) == Approx(normal * discrete).epsilon(1e-9));
      if (y < 0.05) CHECK(of_polymer(0, 0) - of_polymer(1, 1) == Approx(normal).epsilon(1e-4));
      CHECK(std::abs(of_polymer(1, 1) - of_polymer(2, 2)) < 1e-9 * normal);
      if (rate * dt < 1e-2) CHECK(tau(0, 1) == Approx((polymer + solvent) * rate).epsilon(1e-4));
      CHECK(particle.state.volume_ratio == Approx(1).epsilon(1e-12));
    }
}

TEST_CASE("Oldroyd-B: stress grows in start-up as 1 - exp(-t/lambda), N1 as 1 - (1 + t/lambda) exp(-t/lambda)") {
  const double rate = 3, dt = 0.01;
  Particle particle(0);
  double error[2] = {};
  for (int k = 1; k <= 200; ++k) {
    particle.step(shearing(rate), dt);
    const double x = k * dt / time_constant;
    const Sym<3, double> tau = particle.stress();
    CHECK(tau(0, 1) == Approx(polymer * rate * -std::expm1(-x)).epsilon(1e-11));  // for any step
    const double normal = 2 * polymer * time_constant * rate * rate * (1 - (1 + x) * std::exp(-x));
    error[0] = larger(error[0], std::abs(tau(0, 0) - tau(1, 1) - normal));
  }
  Particle finer(0);
  for (int k = 1; k <= 400; ++k) {
    finer.step(shearing(rate), dt / 2);
    const double x = k * dt / 2 / time_constant;
    const double normal = 2 * polymer * time_constant * rate * rate * (1 - (1 + x) * std::exp(-x));
    error[1] = larger(error[1], std::abs(finer.stress()(0, 0) - finer.stress()(1, 1) - normal));
  }
  CHECK(error[0] / (2 * polymer * time_constant * rate * rate) < 1e-3);
  CHECK(std::log2(error[0] / error[1]) == Approx(2).epsilon(0.05));
}

TEST_CASE("Oldroyd-B: after a sudden strain all stress of the polymer falls by exp(-t/lambda), for any step") {
  for (double y : {1e-3, 0.1, 1.0, 5.0}) {
    CAPTURE(y);
    Particle particle(0);
    particle.step({{0.3e9, 1.5e9, 0, 0.2e9, -0.1e9, 0, 0, 0, 0.4e9}}, 1e-9);
    const Sym<3, double> start = particle.state.conformation;
    const int steps = y < 0.01 ? 1000 : 2;
    for (int k = 0; k < steps; ++k) particle.step({}, y * time_constant);
    const double left = std::exp(-steps * y);
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) {
        const double rest = i == j ? 1 : 0;
        CHECK(particle.state.conformation(i, j) - rest ==
              Approx((start(i, j) - rest) * left).epsilon(1e-9).margin(1e-12));
      }
  }
}

TEST_CASE("Oldroyd-B: steady extension below 1/(2 lambda), and chains that grow as exp((2 r - 1/lambda) t) beyond") {
  const double rate = 0.4, dt = 1e-4;  // Weissenberg number 0.2
  Particle slow(0);
  for (int k = 0; k < 60000; ++k) slow.step({{rate, 0, 0, 0, -rate / 2, 0, 0, 0, -rate / 2}}, dt);
  // A = 1/(1 - 2 lambda r) along, 1/(1 + lambda r) across.
  CHECK(slow.state.conformation(0, 0) == Approx(1 / (1 - 2 * time_constant * rate)).epsilon(1e-3));
  CHECK(slow.state.conformation(1, 1) == Approx(1 / (1 + time_constant * rate)).epsilon(1e-4));
  Particle fast(0);
  double before = 0;
  for (int k = 0; k < 20000; ++k) {
    if (k == 10000) before = fast.state.conformation(0, 0);
    fast.step({{4, 0, 0, 0, -2, 0, 0, 0, -2}}, dt);
  }
  CHECK(std::log(fast.state.conformation(0, 0) / before) == Approx((8 - 1 / time_constant) * 1.0).epsilon(1e-3));
}

TEST_CASE("Oldroyd-B: work is stored energy and heat to second order, and all of it heat in steady shear") {
  double miss[2];
  for (int finer : {0, 1}) {
    const int steps = finer ? 800 : 400;
    const double dt = 2.0 / steps;
    Particle particle;
    for (int k = 0; k < steps; ++k) {
      const double t = (k + 0.5) * dt;
      const double heat = particle.heat;
      particle.step({{0.2 * std::cos(3 * t), std::cos(2 * t), 0, -0.3, -0.1, 0.5 * std::sin(t), 0, 0.2, -0.1 * t}}, dt);
      CHECK(particle.heat >= heat);
    }
    miss[finer] = std::abs(particle.work - particle.heat - particle.energy()) / particle.heat;
  }
  CHECK(miss[1] < 1e-4);
  CHECK(std::log2(miss[0] / miss[1]) > 1.8);
  Particle steady;
  for (int k = 0; k < 4000; ++k) steady.step(shearing(2), 0.005);
  const double before = steady.heat;
  for (int k = 0; k < 200; ++k) steady.step(shearing(2), 0.005);
  CHECK(steady.heat - before == Approx((polymer + solvent) * 4).epsilon(1e-4));  // a second of it
}

TEST_CASE("Oldroyd-B: the heat of relaxation is what was stored, whatever the step, for chains little stretched") {
  for (double y : {0.01, 0.5, 20.0}) {
    CAPTURE(y);
    Particle particle(0);
    particle.step(shearing(1e6), 1e-8);
    const double stored = particle.energy(), before = particle.heat;
    for (double t = 0; t < 40; t += y) particle.step({}, y * time_constant);
    CHECK(particle.heat - before == Approx(stored).epsilon(y < 0.1 ? 1e-3 : 0.1));
    CHECK(std::abs(particle.energy()) < 1e-10 * stored + 1e-12);
  }
}

TEST_CASE("Oldroyd-B: A stays positive definite in random steps of any size, and turns with the particle") {
  std::mt19937 numbers(11);
  const auto entry = [&] { return std::ldexp(static_cast<double>(numbers()), -31) - 1; };
  Particle particle;
  for (int k = 0; k < 5000; ++k) {
    Mat3 L;
    for (double& e : L.m) e = 0.5 * entry();
    const double dt = std::pow(10, 2 * entry());
    for (double& e : L.m) e /= dt;
    const double heat = particle.heat;
    particle.step(L, dt);
    const Sym<3, double>& A = particle.state.conformation;
    REQUIRE(A(0, 0) > 0);
    REQUIRE(A(0, 0) * A(1, 1) - A(0, 1) * A(0, 1) > 0);
    REQUIRE(determinant(A) > 0);
    REQUIRE(particle.heat >= heat);
  }
  const double c = std::cos(2.0), s = std::sin(2.0);
  Particle still, turned;
  const Mat3 L{{0.2, 0.5, 0, -0.1, -0.1, 0.3, 0, 0.4, 0}}, Q{{c, -s, 0, s, c, 0, 0, 0, 1}};
  still.step(L, 0.3);
  Mat3 f = Q * advanced(Mat3::identity(), L, 0.3);
  for (int i = 0; i < 3; ++i) f(i, i) -= 1;
  for (double& e : f.m) e /= 0.3;
  turned.step(f, 0.3);
  const Sym<3, double> a = still.stress(), b = turned.stress();
  CHECK(b(0, 0) == Approx(c * c * a(0, 0) - 2 * c * s * a(0, 1) + s * s * a(1, 1)).epsilon(1e-11));
  CHECK(b(1, 2) == Approx(s * a(0, 2) + c * a(1, 2)).epsilon(1e-11));
  CHECK(turned.heat == Approx(still.heat).epsilon(1e-11));
}

TEST_CASE("Oldroyd-B: from J = 1e-6 to 1e6 the pressure is that of u(J) beside the network's, in double and in float") {
  using L = Lanes<float>;
  const OldroydB::Constants<float> single({bulk, density, polymer, time_constant, solvent, 2, cell});
  for (double factor : {0.98, 1.02}) {
    Particle particle;
    OldroydB::State<3, L> lanes{Sym<3, L>::identity(), {}, L(1.0F)};
    const double dt = 1e-6;  // at once: chains follow the volume
    double s = 1;
    while (s > 1e-2 && s < 1e2) {
      Mat3 rate{};
      Mat<3, L> same{};
      for (int i = 0; i < 3; ++i) rate(i, i) = (factor - 1) / dt, same(i, i) = L(static_cast<float>((factor - 1) / dt));
      particle.step(rate, dt);
      OldroydB::advance(single, same, static_cast<float>(dt), lanes);
      s *= factor;
    }
    const double J = s * s * s, exact = bulk / 2 * (J * J - 1) + modulus * (s * s - 1);
    CHECK(particle.state.volume_ratio == Approx(J).epsilon(1e-10));
    CHECK(particle.stress()(0, 0) == Approx(exact).epsilon(1e-2 * modulus / bulk));
    CHECK(OldroydB::kirchhoff_stress(single, lanes)(0, 0)[0] == Approx(exact).epsilon(1e-3));
    CHECK(std::isfinite(particle.energy()));
    CHECK(std::isfinite(particle.heat));
    CHECK(std::isfinite(OldroydB::wave_speed(particle.constants, particle.state)));
  }
}

TEST_CASE("Oldroyd-B: the wave of the instant, K J^2 u'' + G (1 + A), and none that is faster") {
  Particle particle(0);
  const auto reported = [&] {
    const double speed = OldroydB::wave_speed(particle.constants, particle.state);
    return density * speed * speed;
  };
  CHECK(reported() == Approx(bulk + 2 * modulus).epsilon(1e-12));
  particle.step({{0.4e9, 0, 0, 0, 0, 0, 0, 0, 0}}, 1e-9);
  const double A = 1.96, J = 1.4, exact = bulk / 2 * (J * J + 1) + modulus * (1 + A);
  CHECK(reported() == Approx(exact).epsilon(1e-7));
  // rho0 c^2 = d tau/ds - tau along the stretch, by a small step that is as sudden.
  const double before = particle.stress()(0, 0), s = 1e-6;
  particle.step({{s * 1e9, 0, 0, 0, 0, 0, 0, 0, 0}}, 1e-9);
  CHECK((particle.stress()(0, 0) - before) / s - before == Approx(exact).epsilon(1e-4));
}

TEST_CASE(
    "Oldroyd-B: of a swollen particle the solvent's Kirchhoff stress and its share of the step's limit are J times") {
  Particle particle;
  particle.step({{1, 0, 0, 0, 0, 0, 0, 0, 0}}, 1);
  particle.step({{0.3, 0, 0, 0, 0, 0, 0, 0, 0}}, 1e-4);  // a rate of 0.3 / s at J = 2
  CHECK(particle.state.solvent_stress(0, 0) == Approx(2 * 4.0 / 3 * solvent * 0.3).epsilon(1e-4));
  CHECK(particle.state.solvent_stress(1, 1) == Approx(-2 * 2.0 / 3 * solvent * 0.3).epsilon(1e-4));
  // The stiffest mode of cells of size h has the wave number 2 sqrt(3)/h, and its longest step a dt + (w dt)^2/2 = 2.
  const OldroydB::Constants<double> thin({bulk, density, polymer, time_constant, 0, 2, cell});
  const double wave = OldroydB::wave_speed(thin, particle.state), k = 2 * std::sqrt(3.0) / cell;
  const double a = 4.0 / 3 * solvent * particle.state.volume_ratio / density * k * k;
  const double dt = cell / (std::sqrt(3.0) * OldroydB::wave_speed(particle.constants, particle.state));
  CHECK(a * dt + wave * wave * k * k * dt * dt / 2 == Approx(2).epsilon(1e-12));
}

TEST_CASE("Oldroyd-B: plane strain and a strain around the axis are those of 3-D") {
  const OldroydB::Constants<double> c({bulk, density, polymer, time_constant, solvent, 2, cell});
  const Mat<2, double> L{{0.2, 0.3, -0.1, -0.15}};
  for (double zz : {0.0, 0.4}) {
    OldroydB::State<3, double> space{Sym<3, double>::identity(), {}, 1};
    OldroydB::State<2, double> plane{Sym<2, double>::identity(), {}, 1};
    const double heat = OldroydB::advance(c, Mat3{{0.2, 0.3, 0, -0.1, -0.15, 0, 0, 0, zz}}, 0.5, space);
    const double same =
        zz > 0 ? OldroydB::advance(c, Deformation<2, double>{L, zz}, 0.5, plane) : OldroydB::advance(c, L, 0.5, plane);
    const auto expected = OldroydB::kirchhoff_stress(c, space);
    const auto found = OldroydB::kirchhoff_stress(c, plane);
    CHECK(same == Approx(heat).epsilon(1e-12));
    for (int i = 0; i < 3; ++i) CHECK(found.s[i] == Approx(expected.s[i]).epsilon(1e-11));
    CHECK(found(0, 1) == Approx(expected(0, 1)).epsilon(1e-11));
  }
}

TEST_CASE("Maxwell elements: what a step loses and feeds is that of the exponential, from tiny steps to long ones") {
  for (double y : {1e-12, 1e-6, 1e-2, 0.3, 0.4999, 0.5, 0.5001, 2.0, 50.0}) {
    CAPTURE(y);
    const Relaxation<double> relaxation(y);
    const long double lost = -std::expm1(-static_cast<long double>(y));
    CHECK(relaxation.lost == Approx(static_cast<double>(lost)).epsilon(1e-14));
    // y/2 - y^2/3 + y^3/8 where the difference has no digits left.
    const double fed = y < 1e-3 ? y / 2 - y * y / 3 + y * y * y / 8 : static_cast<double>(lost / y - 1 + lost);
    CHECK(relaxation.fed == Approx(fed).epsilon(1e-12));
    const Relaxation<float> single(static_cast<float>(y));
    CHECK(single.lost == Approx(static_cast<double>(lost)).epsilon(1e-6));
    CHECK(single.fed == Approx(fed).epsilon(2e-6));
  }
}

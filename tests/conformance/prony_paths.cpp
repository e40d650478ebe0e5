// Generalised Maxwell solid: the Prony series after a step, exact ramps for any step, sudden and slow limits, and its
// energy. Values of the series 1 + 4 exp(-t/0.1) + 2 exp(-t) are tabulated.

#include <cmath>
#include <random>

#include "kernel/lanes.hpp"
#include "materials/neo_hookean/neo_hookean.hpp"
#include "materials/prony/prony.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using Mat3 = Mat<3, double>;

constexpr double mu = 1, bulk = 30, density = 1000, moduli[] = {4, 2}, times[] = {0.1, 1};
const Prony::Parameters parameters{mu, bulk, density, moduli[0], times[0], moduli[1], times[1], 2};

/// One particle.
struct Particle {
  Prony::Constants<double> constants{parameters};
  Prony::State<3, double> state{Mat3::identity(), {Sym<3, double>::identity(), Sym<3, double>::identity()}};
  double heat = 0, work = 0;

  Sym<3, double> stress() const { return Prony::kirchhoff_stress(constants, state); }
  double energy() const { return Prony::stored_energy(constants, state); }
  /// A step of the deformation I + H in dt, and its work by the trapezoidal rule.
  void step(const Mat3& H, double dt) {
    Mat3 L = H;
    for (double& e : L.m) e /= dt;
    const Sym<3, double> before = stress();
    heat += Prony::advance(constants, L, dt, state);
    const Sym<3, double> after = stress();
    const Mat3 second = H * H, third = second * H;  // H (I + H)^-1 to third order
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        work += 0.5 * (before(i, j) * H(i, j) + after(i, j) * (H(i, j) - second(i, j) + third(i, j)));
  }
};

Mat3 shear(double by) {
  return {{0, by, 0, 0, 0, 0, 0, 0, 0}};
}
Mat3 diagonal(double x, double y, double z) {
  return {{x, 0, 0, 0, y, 0, 0, 0, z}};
}
double series(double t) {
  return mu + moduli[0] * std::exp(-t / times[0]) + moduli[1] * std::exp(-t / times[1]);
}

}  // namespace

TEST_CASE("Prony: after a step of shear the modulus is the series, whatever the size of strain and step") {
  const double rows[][2] = {{0, 7}, {0.1, 4.2811926}, {0.5, 2.24001311}, {1, 1.73594048}, {5, 1.01347589}};
  for (double gamma : {1e-6, 0.3, 4.0})
    for (const auto& [t, expected] : rows)
      for (int steps : {1, 17}) {
        CAPTURE(gamma, t, steps);
        Particle particle;
        particle.step(shear(gamma), 1e-12);
        for (int k = 0; k < steps && t > 0; ++k) particle.step({}, t / steps);
        CHECK(particle.stress()(0, 1) / gamma == Approx(expected).epsilon(1e-8));
        CHECK(series(t) == Approx(expected).epsilon(1e-8));
      }
}

TEST_CASE("Prony: every number of the series counts, none of them 1") {
  const Prony::Constants<double> c({5, bulk, density, 4, 0.1, 2, 3, 2});
  Prony::State<3, double> state{Mat3::identity(), {Sym<3, double>::identity(), Sym<3, double>::identity()}};
  Prony::advance(c, shear(0.3e12), 1e-12, state);
  CHECK(Prony::kirchhoff_stress(c, state)(0, 1) / 0.3 == Approx(11).epsilon(1e-8));
  Prony::advance(c, Mat3{}, 0.2, state);
  const double expected = 5 + 4 * std::exp(-2.0) + 2 * std::exp(-0.2 / 3);
  CHECK(Prony::kirchhoff_stress(c, state)(0, 1) / 0.3 == Approx(expected).epsilon(1e-8));
}

TEST_CASE("Prony: after any sudden strain stress is dev(J^-2/3 b) times the series, and the pressure stays") {
  const Mat3 F{{1.5, 0.3, -0.2, 0.1, 0.7, 0.4, -0.3, 0.2, 1.2}};
  Mat3 H = F;
  for (int i = 0; i < 3; ++i) H(i, i) -= 1;
  const double J = determinant(F);
  const Sym<3, double> b = left_cauchy_green(F);
  const double trace = (b(0, 0) + b(1, 1) + b(2, 2)) / 3;
  Particle particle;
  particle.step(H, 1e-12);
  double time = 0;
  for (double dt : {0.0, 0.03, 0.2, 1.0, 30.0}) {
    if (dt > 0) particle.step({}, dt);
    time += dt;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) {
        const double deviator = std::pow(J, -2.0 / 3) * (b(i, j) - (i == j ? trace : 0));
        const double pressure = i == j ? bulk / 2 * (J * J - 1) : 0;
        CHECK(particle.stress()(i, j) == Approx(series(time) * deviator + pressure).epsilon(1e-9));
      }
  }
}

TEST_CASE("Prony: strain that is piecewise linear in time has the exact stress, for any step") {
  // Shear stress is linear in the strain: of a Maxwell branch under a ramp at the rate r, G t r (1 - exp(-t/time)).
  for (int steps : {1, 3, 50}) {
    CAPTURE(steps);
    Particle particle;
    const double up = 0.4, down = 0.7, rate_up = 0.5, rate_down = -0.9;
    for (int k = 0; k < steps; ++k) particle.step(shear(rate_up * up / steps), up / steps);
    double expected = mu * rate_up * up;
    double branch[2];
    for (int i = 0; i < 2; ++i) expected += branch[i] = moduli[i] * times[i] * rate_up * -std::expm1(-up / times[i]);
    CHECK(particle.stress()(0, 1) == Approx(expected).epsilon(1e-10));
    for (int k = 0; k < steps; ++k) particle.step(shear(rate_down * down / steps), down / steps);
    expected = mu * (rate_up * up + rate_down * down);
    for (int i = 0; i < 2; ++i)
      expected +=
          branch[i] * std::exp(-down / times[i]) + moduli[i] * times[i] * rate_down * -std::expm1(-down / times[i]);
    CHECK(particle.stress()(0, 1) == Approx(expected).epsilon(1e-10));
  }
}

TEST_CASE("Prony: creep of one branch beside the spring, its compliance by hand") {
  // J(t) = (1/mu) [1 - G/(mu + G) exp(-t mu/(t_1 (mu + G)))] of a standard linear solid with mu = 1, G = 4, t_1 = 0.5.
  const double rows[][2] = {{0.5, .3450154}, {2, .64053683}, {10, .98534749}};
  const Prony::Constants<double> c({1, 1e3, density, 4, 0.5, 0, 1, 2});
  const double load = 1e-4;
  Prony::State<3, double> state{Mat3::identity(), {Sym<3, double>::identity(), Sym<3, double>::identity()}};
  const double dt = 1e-3;
  int at = 0;
  double gamma = 0;
  const auto with = [&](double by) {
    Prony::State<3, double> next = state;
    Prony::advance(c, shear(by / dt), dt, next);
    return next;
  };
  for (const auto& [t, expected] : rows) {
    for (; at < std::lround(t / dt); ++at) {  // stress is linear in the increment: one secant holds the load
      const double none = Prony::kirchhoff_stress(c, with(0))(0, 1),
                   some = Prony::kirchhoff_stress(c, with(load))(0, 1);
      const double by = (load - none) / (some - none) * load;
      state = with(by), gamma += by;
    }
    CHECK(gamma / load == Approx(expected).epsilon(1e-3));
  }
}

TEST_CASE("Prony: at once it is the split Neo-Hookean solid with mu + G_1 + G_2, at last that with mu") {
  const Mat3 H{{0.3, 0.2, -0.1, 0.05, -0.2, 0.3, -0.2, 0.1, 0.1}};
  for (bool slow : {false, true}) {
    const double shear_modulus = slow ? mu : mu + moduli[0] + moduli[1];
    const double young = 9 * bulk * shear_modulus / (3 * bulk + shear_modulus),
                 poisson = (3 * bulk - 2 * shear_modulus) / (2 * (3 * bulk + shear_modulus));
    const NeoHookean::Constants<double> limit({young, poisson, density, 1, 2});
    Particle particle;
    particle.step(H, 1e-12);
    if (slow) particle.step({}, 100);
    const NeoHookean::State<3, double> elastic{particle.state.deformation_gradient};
    const Sym<3, double> expected = NeoHookean::kirchhoff_stress(limit, elastic), found = particle.stress();
    for (int k = 0; k < 6; ++k) CHECK(found.s[k] == Approx(expected.s[k]).epsilon(1e-9));
    CHECK(particle.energy() == Approx(NeoHookean::stored_energy(limit, elastic)).epsilon(1e-9));
    CHECK((particle.heat > 0.1 * particle.energy()) == slow);
    if (!slow) {
      const double speed = Prony::wave_speed(particle.constants, particle.state);
      CHECK(speed == Approx(NeoHookean::wave_speed(limit, elastic)).epsilon(1e-9));
    }
  }
  const double speed = Prony::wave_speed(Particle().constants, Particle().state);
  CHECK(density * speed * speed == Approx(bulk + 4.0 / 3 * 7).epsilon(1e-12));
}

TEST_CASE("Prony: over closed cycles the heat is the work, pi G'' gamma^2 each, where G'' is that of the series") {
  const double pi = std::acos(-1.0), amplitude = 1e-3, w = 4;
  double loss = 0;
  for (int i = 0; i < 2; ++i) loss += moduli[i] * w * times[i] / (1 + w * w * times[i] * times[i]);
  double miss[2];
  for (int finer : {0, 1}) {
    Particle particle;
    const int steps = finer ? 400 : 200;
    const double dt = 2 * pi / w / steps;
    double heat = 0, work = 0, stored = 0;
    for (int cycle = 0; cycle < 8; ++cycle) {
      heat = particle.heat, work = particle.work, stored = particle.energy();
      for (int k = 0; k < steps; ++k)
        particle.step(shear(amplitude * (std::sin(2 * pi * (k + 1) / steps) - std::sin(2 * pi * k / steps))), dt);
    }
    const double exact = pi * loss * amplitude * amplitude;
    CHECK(particle.heat - heat == Approx(exact).epsilon(2e-3));
    CHECK(particle.work - work == Approx(exact).epsilon(2e-3));
    CHECK(particle.energy() == Approx(stored).epsilon(1e-3));
    miss[finer] = std::abs(particle.work - work - (particle.heat - heat)) / exact;
  }
  CHECK(miss[1] < 1e-3);
  CHECK(std::log2(miss[0] / miss[1]) > 1.8);
}

TEST_CASE("Prony: work is stored energy and heat along a path of finite strain, to second order") {
  double miss[2];
  for (int finer : {0, 1}) {
    const int steps = finer ? 800 : 400;
    const double dt = 2.0 / steps;
    Particle particle;
    for (int k = 0; k < steps; ++k) {
      const double t = (k + 0.5) * dt, heat = particle.heat;
      Mat3 H{{0.2 * std::cos(3 * t), std::cos(2 * t), 0, -0.3, -0.1, 0.5 * std::sin(t), 0, 0.2, -0.1 * t}};
      for (double& e : H.m) e *= dt;
      particle.step(H, dt);
      CHECK(particle.heat >= heat);
    }
    miss[finer] = std::abs(particle.work - particle.heat - particle.energy()) / particle.heat;
  }
  CHECK(miss[1] < 1e-3);
  CHECK(std::log2(miss[0] / miss[1]) > 1.8);
}

TEST_CASE("Prony: branches turn with the particle, in any step, and stay positive definite") {
  const double c = std::cos(2.5), s = std::sin(2.5);
  Particle particle;
  particle.step({{0.2, 0.5, 0, -0.1, -0.1, 0.3, 0, 0.4, 0}}, 0.1);
  Particle waits = particle;
  waits.step({}, 0.05);
  particle.step({{c - 1, -s, 0, s, c - 1, 0, 0, 0, 0}}, 0.05);
  const Sym<3, double> a = waits.stress(), b = particle.stress();
  CHECK(b(0, 0) == Approx(c * c * a(0, 0) - 2 * c * s * a(0, 1) + s * s * a(1, 1)).epsilon(1e-11));
  CHECK(b(0, 1) == Approx(c * s * (a(0, 0) - a(1, 1)) + (c * c - s * s) * a(0, 1)).epsilon(1e-11));
  CHECK(b(1, 2) == Approx(s * a(0, 2) + c * a(1, 2)).epsilon(1e-11));
  CHECK(particle.heat == Approx(waits.heat).epsilon(1e-11));
  std::mt19937 numbers(11);
  const auto entry = [&] { return std::ldexp(static_cast<double>(numbers()), -31) - 1; };
  for (int k = 0; k < 3000; ++k) {
    Mat3 H;
    for (double& e : H.m) e = 0.4 * entry();
    const double heat = particle.heat;
    particle.step(H, std::pow(10, 2 * entry()));
    REQUIRE(particle.heat >= heat);
    for (const Sym<3, double>& A : particle.state.branch) {
      REQUIRE(A(0, 0) > 0);
      REQUIRE(A(0, 0) * A(1, 1) - A(0, 1) * A(0, 1) > 0);
      REQUIRE(determinant(A) > 0);
    }
  }
}

TEST_CASE("Prony: from J = 1e-6 to 1e6 a change of volume strains no branch, and stretches of 100 keep their stress") {
  using L = Lanes<float>;
  const Prony::Constants<float> single(parameters);
  for (double factor : {0.98, 1.02}) {
    Particle particle;
    Prony::State<3, L> lanes{Mat<3, L>::identity(), {Sym<3, L>::identity(), Sym<3, L>::identity()}};
    double s = 1;
    while (s > 1e-2 && s < 1e2) {
      Mat<3, L> rate{};
      for (int i = 0; i < 3; ++i) rate(i, i) = L(static_cast<float>((factor - 1) / 1e-3));
      particle.step(diagonal(factor - 1, factor - 1, factor - 1), 1e-3);
      Prony::advance(single, rate, 1e-3F, lanes);
      s *= factor;
    }
    const double J = s * s * s;
    CHECK(particle.stress()(0, 0) == Approx(bulk / 2 * (J * J - 1)).epsilon(1e-8));
    CHECK(Prony::kirchhoff_stress(single, lanes)(0, 0)[0] == Approx(bulk / 2 * (J * J - 1)).epsilon(1e-2));
    CHECK(std::abs(particle.state.branch[0](0, 0) - 1) < 1e-10);
    CHECK(std::abs(particle.heat) < 1e-10);
    CHECK(std::isfinite(Prony::wave_speed(particle.constants, particle.state)));
  }
  Particle stretched;
  stretched.step(diagonal(99, -0.9, -0.9), 1e-12);  // diag(100, 1/10, 1/10)
  CHECK(stretched.stress()(0, 0) == Approx(7 * 2.0 / 3 * (1e4 - 0.01)).epsilon(1e-9));
  stretched.step({}, 1);
  CHECK(stretched.stress()(0, 0) == Approx(series(1) * 2.0 / 3 * (1e4 - 0.01)).epsilon(1e-9));
}

TEST_CASE("Prony: plane strain and a strain around the axis are those of 3-D") {
  const Prony::Constants<double> c(parameters);
  const Sym<2, double> rest = Sym<2, double>::identity();
  const Mat<2, double> L{{0.2, 0.3, -0.1, -0.15}};
  Prony::AxisymmetricState<double> ring{Deformation<2, double>::identity(), {rest, rest}};
  Prony::State<2, double> flat{Mat<2, double>::identity(), {rest, rest}};
  for (double zz : {0.0, 0.4}) {
    Prony::State<3, double> space = Particle().state;
    const double heat = Prony::advance(c, Mat3{{0.2, 0.3, 0, -0.1, -0.15, 0, 0, 0, zz}}, 0.5, space);
    const double same =
        zz > 0 ? Prony::advance(c, Deformation<2, double>{L, zz}, 0.5, ring) : Prony::advance(c, L, 0.5, flat);
    const auto expected = Prony::kirchhoff_stress(c, space);
    const auto found = zz > 0 ? Prony::kirchhoff_stress(c, ring) : Prony::kirchhoff_stress(c, flat);
    CHECK(same == Approx(heat).epsilon(1e-12));
    for (int i = 0; i < 3; ++i) CHECK(found.s[i] == Approx(expected.s[i]).epsilon(1e-11));
    CHECK(found(0, 1) == Approx(expected(0, 1)).epsilon(1e-11));
  }
}

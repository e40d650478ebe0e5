// Kelvin-Voigt solid under imposed deformation and imposed stress, in closed form. mu, K from E = 1000, nu = 0.3.

#include <cmath>

#include "kernel/lanes.hpp"
#include "materials/kelvin_voigt/kelvin_voigt.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using Mat3 = Mat<3, double>;

constexpr double young = 1000, poisson = 0.3, density = 1000, eta = 50, zeta = 20, cell = 0.1;
constexpr double mu = young / (2 * (1 + poisson)), bulk = young / (3 * (1 - 2 * poisson));

/// One particle.
struct Particle {
  KelvinVoigt::Constants<double> constants{{young, poisson, density, eta, zeta, 2, cell}};
  KelvinVoigt::State<3, double> state{Mat3::identity(), {}};
  double heat = 0, work = 0;

  Sym<3, double> stress() const { return KelvinVoigt::kirchhoff_stress(constants, state); }
  double energy() const { return KelvinVoigt::stored_energy(constants, state); }
  /// A step of the deformation I + H in dt. The work is that of the stress at its end, exact for the viscous part.
  void step(const Mat3& H, double dt) {
    Mat3 L = H;
    for (double& e : L.m) e /= dt;
    const Sym<3, double> before = stress(), viscous = state.viscous_stress;
    heat += KelvinVoigt::advance(constants, L, dt, state);
    const Sym<3, double> d = rate_of_deformation(strain_rate(L, dt), dt), after = stress();
    for (int k = 0; k < 6; ++k) {
      const double elastic = 0.5 * (before.s[k] - viscous.s[k] + after.s[k] - state.viscous_stress.s[k]);
      work += dt * (k < 3 ? 1 : 2) * (elastic + state.viscous_stress.s[k]) * d.s[k];
    }
  }
};

Mat3 shear(double by) {
  return {{0, by, 0, 0, 0, 0, 0, 0, 0}};
}

}  // namespace

TEST_CASE("Kelvin-Voigt: a steady rate of shear adds eta times it to mu gamma, and stopping takes it off at once") {
  Particle particle;
  const double rate = 0.4, dt = 1e-4;
  for (int k = 1; k <= 5000; ++k) particle.step(shear(rate * dt), dt);
  CHECK(particle.stress()(0, 1) == Approx(mu * 0.2 + eta * rate).epsilon(1e-8));
  CHECK(particle.heat == Approx(eta * rate * rate * 0.5).epsilon(1e-4));
  particle.step({}, dt);
  CHECK(particle.stress()(0, 1) == Approx(mu * 0.2).epsilon(1e-10));
}

TEST_CASE("Kelvin-Voigt: a stretch at the rate r, and a change of volume at 3 r") {
  const double rate = 0.3, dt = 1e-3;
  Particle along, swelling;
  double s = 1;
  for (int k = 0; k < 700; ++k, s *= 1 + rate * dt) {
    along.step({{rate * dt, 0, 0, 0, 0, 0, 0, 0, 0}}, dt);
    swelling.step({{rate * dt, 0, 0, 0, rate * dt, 0, 0, 0, rate * dt}}, dt);
  }
  const double d = std::log1p(rate * dt) / dt, third = std::cbrt(s * s);
  // b' = J^-2/3 diag(s^2, 1, 1), J = s; of the viscous stress 4/3 eta d along and -2/3 eta d across, times J.
  const double spring = 2.0 / 3 * mu * (s * s - 1) / third, pressure = bulk / 2 * (s * s - 1);
  CHECK(along.stress()(0, 0) == Approx(spring + pressure + s * (4.0 / 3 * eta + zeta) * d).epsilon(1e-7));
  CHECK(along.stress()(1, 1) == Approx(-spring / 2 + pressure + s * (-2.0 / 3 * eta + zeta) * d).epsilon(1e-7));
  const double J = s * s * s;
  CHECK(swelling.stress()(0, 0) == Approx(bulk / 2 * (J * J - 1) + J * zeta * 3 * d).epsilon(1e-7));
  CHECK(std::abs(swelling.stress()(0, 1)) < 1e-10);
}

TEST_CASE("Kelvin-Voigt: creep under a shear stress is (tau/mu)(1 - exp(-t mu/eta)), to first order in the step") {
  const double load = 2, time = 0.15;
  double error[2];
  for (int finer : {0, 1}) {
    const int steps = finer ? 2000 : 200;
    const double dt = time / steps;
    Particle particle;
    // The rate that the dashpot allows: what the load leaves over the spring's stress, at the start of the step.
    for (int k = 0; k < steps; ++k) {
      const double spring = particle.stress()(0, 1) - particle.state.viscous_stress(0, 1);
      particle.step(shear((load - spring) / eta * dt), dt);
      CHECK(particle.stress()(0, 1) == Approx(load).epsilon(0.02));
    }
    const double found = particle.state.deformation_gradient(0, 1), exact = load / mu * -std::expm1(-time * mu / eta);
    error[finer] = std::abs(found / exact - 1);
  }
  CHECK(error[1] < 1e-3);
  CHECK(std::log10(error[0] / error[1]) > 0.9);
}

TEST_CASE("Kelvin-Voigt: over a closed cycle the heat is the work, pi eta w gamma^2 of a sine") {
  const double pi = std::acos(-1.0), amplitude = 0.05, w = 7;
  Particle particle;
  const int steps = 4000;
  const double dt = 2 * pi / w / steps;
  for (int k = 0; k < steps; ++k)
    particle.step(shear(amplitude * (std::sin(2 * pi * (k + 1) / steps) - std::sin(2 * pi * k / steps))), dt);
  CHECK(particle.heat == Approx(pi * eta * w * amplitude * amplitude).epsilon(1e-4));
  CHECK(particle.work == Approx(particle.heat).epsilon(1e-4));
  CHECK(std::abs(particle.energy()) < 1e-12 * young);
}

TEST_CASE("Kelvin-Voigt: a turn by any angle in one step makes neither viscous stress nor heat") {
  for (double angle : {1e-3, 0.5, 2.0, 3.0}) {
    CAPTURE(angle);
    Particle particle;
    particle.step({{0.2, 0.1, 0, 0, -0.1, 0.05, 0, 0, 0}}, 1e-2);
    const double heat = particle.heat, c = std::cos(angle), s = std::sin(angle);
    particle.step({}, 1e-2);
    const Sym<3, double> still = particle.stress();
    particle.step({{c - 1, -s, 0, s, c - 1, 0, 0, 0, 0}}, 1e-2);
    CHECK(particle.heat == Approx(heat).epsilon(1e-12));
    for (int k = 0; k < 6; ++k) CHECK(std::abs(particle.state.viscous_stress.s[k]) < 1e-11 * young);
    const Sym<3, double> turned = particle.stress();
    CHECK(turned(0, 0) == Approx(c * c * still(0, 0) - 2 * c * s * still(0, 1) + s * s * still(1, 1)).epsilon(1e-10));
  }
}

TEST_CASE("Kelvin-Voigt: from J = 1e-6 to 1e6 stress stays that of spring and dashpot, and heat is not negative") {
  using L = Lanes<float>;
  const KelvinVoigt::Constants<float> single({young, poisson, density, eta, zeta, 2, cell});
  for (double factor : {0.98, 1.02}) {
    Particle particle;
    KelvinVoigt::State<3, L> lanes{Mat<3, L>::identity(), {}};
    const double dt = 1e-3;
    double s = 1;
    while (s > 1e-2 && s < 1e2) {
      Mat<3, L> rate{};
      for (int i = 0; i < 3; ++i) rate(i, i) = L(static_cast<float>((factor - 1) / dt));
      const double heat = particle.heat;
      particle.step({{factor - 1, 0, 0, 0, factor - 1, 0, 0, 0, factor - 1}}, dt);
      KelvinVoigt::advance(single, rate, static_cast<float>(dt), lanes);
      CHECK(particle.heat > heat);
      s *= factor;
    }
    const double J = s * s * s, exact = bulk / 2 * (J * J - 1) + J * zeta * 3 * std::log(factor) / dt;
    CHECK(particle.stress()(0, 0) == Approx(exact).epsilon(1e-4));
    CHECK(KelvinVoigt::kirchhoff_stress(single, lanes)(0, 0)[0] == Approx(exact).epsilon(1e-3));
    CHECK(std::isfinite(KelvinVoigt::wave_speed(particle.constants, particle.state)));
  }
}

TEST_CASE("Kelvin-Voigt: the reported speed is the elastic wave's without viscosity, and its step is stable with it") {
  const double longitudinal = bulk + 4 * mu / 3;
  for (double viscosity : {1e-9, 5.0, 500.0, 5e4}) {
    CAPTURE(viscosity);
    const KelvinVoigt::Constants<double> c({young, poisson, density, viscosity, 0, 2, cell});
    const double speed = KelvinVoigt::wave_speed(c, KelvinVoigt::State<3, double>{Mat3::identity(), {}});
    if (viscosity < 1e-6) CHECK(density * speed * speed == Approx(longitudinal).epsilon(1e-9));
    // The stiffest mode of cells of size h: v' = -w^2 u - a v with the wave number 2 sqrt(3)/h. The longest step that
    // its recurrence stands satisfies a dt + (w dt)^2/2 = 2, and is h/(sqrt(3) speed).
    const double k = 2 * std::sqrt(3.0) / cell, w2 = longitudinal / density * k * k,
                 a = 4.0 / 3 * viscosity / density * k * k, dt = cell / (std::sqrt(3.0) * speed);
    CHECK(a * dt + w2 * dt * dt / 2 == Approx(2).epsilon(1e-9));
    for (double share : {0.999, 1.001}) {
      double u = 1, v = 0;
      for (int step = 0; step < 40000 && std::abs(u) < 1e9; ++step)
        v -= share * dt * (w2 * u + a * v), u += share * dt * v;
      CHECK((std::abs(u) < 1e6) == (share < 1));
    }
  }
}

TEST_CASE("Kelvin-Voigt: the stored energy is that of the spring, mu/2 (tr b' - 3) + K/2 ((J^2 - 1)/2 - ln J)") {
  for (double s : {0.3, 0.9, 1.0, 1.4, 5.0}) {
    Particle particle;
    particle.state.deformation_gradient(0, 0) = s;
    const double spring = mu / 2 * ((s * s + 2) / std::cbrt(s * s) - 3), volume = (s * s - 1) / 2 - std::log(s);
    CHECK(particle.energy() == Approx(spring + bulk / 2 * volume).epsilon(1e-12).margin(1e-12 * young));
  }
}

TEST_CASE("Kelvin-Voigt: of a swollen particle the viscosity per density at rest is J times as much") {
  Particle particle;
  particle.state.deformation_gradient = {{1.5, 0, 0, 0, 1.5, 0, 0, 0, 1.5}};
  const KelvinVoigt::Constants<double> elastic({young, poisson, density, 0, 0, 2, cell});
  const double wave = KelvinVoigt::wave_speed(elastic, particle.state), J = 1.5 * 1.5 * 1.5;
  const double dt = cell / (std::sqrt(3.0) * KelvinVoigt::wave_speed(particle.constants, particle.state));
  // As at rest: a dt + (w dt)^2/2 = 2 with the rate a that both viscosities damp by.
  const double k = 2 * std::sqrt(3.0) / cell, a = (4.0 / 3 * eta + zeta) * J / density * k * k;
  CHECK(a * dt + wave * wave * k * k * dt * dt / 2 == Approx(2).epsilon(1e-12));
}

TEST_CASE("Kelvin-Voigt: plane strain and a strain around the axis are those of 3-D") {
  const KelvinVoigt::Constants<double> c({young, poisson, density, eta, zeta, 2, cell});
  const Mat<2, double> L{{0.2, 0.3, -0.1, -0.15}};
  KelvinVoigt::AxisymmetricState<double> ring{Deformation<2, double>::identity(), {}};
  KelvinVoigt::State<2, double> flat{Mat<2, double>::identity(), {}};
  for (double zz : {0.0, 0.4}) {
    KelvinVoigt::State<3, double> space{Mat3::identity(), {}};
    const double heat = KelvinVoigt::advance(c, Mat3{{0.2, 0.3, 0, -0.1, -0.15, 0, 0, 0, zz}}, 0.5, space);
    const double same = zz > 0 ? KelvinVoigt::advance(c, Deformation<2, double>{L, zz}, 0.5, ring)
                               : KelvinVoigt::advance(c, L, 0.5, flat);
    const auto expected = KelvinVoigt::kirchhoff_stress(c, space);
    const auto found = zz > 0 ? KelvinVoigt::kirchhoff_stress(c, ring) : KelvinVoigt::kirchhoff_stress(c, flat);
    CHECK(same == Approx(heat).epsilon(1e-12));
    for (int i = 0; i < 3; ++i) CHECK(found.s[i] == Approx(expected.s[i]).epsilon(1e-11));
    CHECK(found(0, 1) == Approx(expected(0, 1)).epsilon(1e-11));
  }
}

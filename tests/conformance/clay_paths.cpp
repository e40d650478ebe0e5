// Modified Cam-Clay from virgin compression to the critical state. Stresses are Kirchhoff's.

#include <algorithm>
#include <cmath>
#include <random>

#include "conformance/soil_particle.hpp"
#include "materials/cam_clay/cam_clay.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::soils;

constexpr double consolidation = 1e5, critical = 1.2, exponent = 20;

Particle<CamClay> clay(double cohesion = 0, double xi = exponent, double M = critical) {
  return Particle<CamClay>({young, poisson, 1600, consolidation, M, xi, cohesion});
}
/// Plastic compaction e.
double compaction(const Particle<CamClay>& particle) {
  return -std::log(particle.state.plastic_volume_ratio);
}
/// p_c by the exponential law.
double size_of(const Particle<CamClay>& particle, double xi = exponent) {
  return consolidation * std::exp(xi * compaction(particle));
}
/// The ellipse's function, over (M p_c)^2.
double off_ellipse(const Particle<CamClay>& particle, double beta, double M = critical, double xi = exponent) {
  const double p = particle.p(), q = particle.q(), size = size_of(particle, xi);
  return ((1 + 2 * beta) * q * q + M * M * (p + beta * size) * (p - size)) / (M * M * size * size);
}

}  // namespace

TEST_CASE("Cam-Clay: virgin compression follows p/K + ln(p/p_c0)/xi, unloading K") {
  for (double volume : {0.05, 0.15, 0.3})
    for (int steps : {1, 7, 400}) {
      CAPTURE(volume, steps);
      Particle<CamClay> particle = clay();
      for (int step = 0; step < steps; ++step)
        particle.strain(-volume / 3 / steps, -volume / 3 / steps, -volume / 3 / steps);
      const double exact = root_of(consolidation, 10 * bulk, [&](double p) {
        return p / bulk + std::log(p / consolidation) / exponent - volume;
      });
      CHECK(particle.p() == Approx(exact).epsilon(1e-9));
      CHECK(size_of(particle) == Approx(exact).epsilon(1e-9));
      CHECK(particle.q() < 1e-9 * exact);
      // The plastic work is the integral of p_c de = (p_c - p_c0)/xi.
      if (steps == 400) CHECK(particle.heat == Approx((exact - consolidation) / exponent).epsilon(5e-3));
      const double heat = particle.heat, plastic = particle.state.plastic_volume_ratio;
      particle.strain(1e-3, 1e-3, 1e-3);
      CHECK(particle.p() == Approx(exact - 3e-3 * bulk).epsilon(1e-9));
      CHECK(particle.heat == heat);
      CHECK(particle.state.plastic_volume_ratio == plastic);
    }
}

TEST_CASE("Cam-Clay: drained triaxial tests end at the critical state q = M p, p_c = 2 p, at constant volume") {
  // With the side at s: compression q = 3 M s/(3 - M), extension q = 3 M s/(3 + M). At M = 1.2 and 100 kPa: 200 kPa,
  // 85.714 kPa.
  for (double preloaded : {1.0, 5.0})  // normally consolidated and overconsolidated
    for (double direction : {-1.0, 1.0}) {
      CAPTURE(preloaded, direction);
      const double side = consolidation / preloaded, q = 3 * critical * side / (3 + direction * critical);
      Particle<CamClay> particle = clay();
      particle.strain(-side / (3 * bulk), -side / (3 * bulk), -side / (3 * bulk));
      double strongest = 0;
      for (int step = 0; step < 1000; ++step) {
        particle.squeeze(direction * 1e-3, side);
        strongest = larger(strongest, particle.q());
      }
      const double volume = particle.state.plastic_volume_ratio, heat = particle.heat;
      CHECK(particle.q() == Approx(q).epsilon(1e-6));
      CHECK(particle.q() / particle.p() == Approx(critical).epsilon(1e-6));
      CHECK(size_of(particle) == Approx(2 * particle.p()).epsilon(1e-6));
      if (preloaded > 1)
        CHECK(strongest > 1.2 * q);  // overconsolidated clay has a peak, and has dilated
      else
        CHECK(strongest < 1.000001 * q);
      CHECK((volume > 1) == (compaction(particle) < 0));
      for (int step = 0; step < 10; ++step) particle.squeeze(direction * 1e-3, side);
      CHECK(particle.state.plastic_volume_ratio == Approx(volume).epsilon(1e-7));
      CHECK(particle.heat - heat == Approx(q * 0.01).epsilon(1e-5));
    }
}

TEST_CASE("Cam-Clay: with 100 kPa at the side and M = 1.2 the strength is 200 kPa") {
  Particle<CamClay> particle = clay();
  particle.strain(-1e5 / (3 * bulk), -1e5 / (3 * bulk), -1e5 / (3 * bulk));
  for (int step = 0; step < 1000; ++step) particle.squeeze(-1e-3, 1e5);
  CHECK(particle.q() == Approx(2e5).epsilon(1e-6));
}

TEST_CASE("Cam-Clay: shearing at constant volume ends where p/K gives what e takes, with cohesion too") {
  for (double beta : {0.0, 0.3, 0.8})
    for (double start : {1.0, 0.1}) {
      CAPTURE(beta, start);
      Particle<CamClay> particle = clay(beta);
      const double pressure = start * consolidation;
      particle.strain(-pressure / (3 * bulk), -pressure / (3 * bulk), -pressure / (3 * bulk));
      for (int step = 0; step < 3000; ++step) particle.strain(-1e-3, 1e-3, 0);
      const double p = root_of(1e-3 * consolidation, consolidation, [&](double at) {
        return (at - pressure) / bulk + std::log(2 * at / ((1 - beta) * consolidation)) / exponent;
      });
      const double size = 2 * p / (1 - beta);
      CHECK(particle.p() == Approx(p).epsilon(1e-8));
      CHECK(size_of(particle) == Approx(size).epsilon(1e-8));
      CHECK(particle.q() == Approx(critical * (1 + beta) * size / (2 * std::sqrt(1 + 2 * beta))).epsilon(1e-8));
    }
}

TEST_CASE("Cam-Clay: overconsolidated clay is elastic up to q^2 = M^2 p (p_c - p)") {
  Particle<CamClay> particle = clay();
  const double side = 2e4;
  particle.strain(-side / (3 * bulk), -side / (3 * bulk), -side / (3 * bulk));
  // On the elastic path p = s + q/3: (1/M^2 + 1/9) q^2 - (p_c - 2 s) q/3 - s (p_c - s) = 0.
  const double a = 1 / (critical * critical) + 1.0 / 9, b = -(consolidation - 2 * side) / 3;
  const double yields = (-b + std::sqrt(b * b + 4 * a * side * (consolidation - side))) / (2 * a);
  double last = 0;
  while (particle.heat == 0 && last < 10 * yields) {
    last = particle.q();
    particle.squeeze(-2e-5, side);
  }
  CHECK(last <= yields * (1 + 1e-4));
  CHECK(last + 2e-5 * young >= yields * (1 - 1e-4));
}

TEST_CASE("Cam-Clay: every return is on the ellipse, along its normal, and loses what the plastic strain takes") {
  std::mt19937 generator(11);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> unit(0, 1);
  int compacts = 0, dilates = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    const double beta = sample % 2 ? 0 : 0.8 * unit(generator), M = 0.5 + 1.5 * unit(generator),
                 xi = 20 * unit(generator);
    Particle<CamClay> particle = clay(beta, xi, M);
    const double p_0 = consolidation * unit(generator), size = 0.1 * unit(generator) * unit(generator);
    particle.strain(-p_0 / (3 * bulk), -p_0 / (3 * bulk), -p_0 / (3 * bulk));
    if (particle.heat > 0) continue;
    const Vec3 e{{size * normal(generator), size * normal(generator), size * normal(generator)}};
    const double trace = e[0] + e[1] + e[2], p_trial = p_0 - bulk * trace;
    double squared = 0;
    for (int i = 0; i < 3; ++i) squared += (e[i] - trace / 3) * (e[i] - trace / 3);
    const double q_trial = std::sqrt(1.5 * squared) * 2 * shear;
    const double heat = particle.strain(e[0], e[1], e[2]);
    if (heat == 0) continue;
    CAPTURE(sample, beta, M, xi, p_trial, q_trial);
    const double p = particle.p(), q = particle.q(), x = compaction(particle), a = 1 + 2 * beta;
    const double p_c = size_of(particle, xi);
    if (p_c < 1e-3 * consolidation) continue;  // rounding of p, of the size of the trial, counts there
    if (xi * p_c > 0.4 * bulk) continue;       // there the slope of hardening is held
    (x > 0 ? compacts : dilates) += 1;
    CHECK(p == Approx(p_trial - bulk * x).margin(1e-9 * young));
    CHECK(std::abs(off_ellipse(particle, beta, M, xi)) < 1e-7);
    // dev : volume of the plastic strain is 2 a q : M^2 (2 p - (1 - beta) p_c) for shear strains (q' - q)/(3 G).
    const double shearing = (q_trial - q) / (3 * shear), flow = M * M * (2 * p - (1 - beta) * p_c);
    CHECK(shearing * flow == Approx(x * 2 * a * q).margin(1e-6 * size * (M * M * p_c + q)));
    CHECK(heat == Approx(q * shearing + p * x).margin(1e-12 * young));
    CHECK(heat >= 0);
  }
  CHECK(std::min(compacts, dilates) > 1000);
}

TEST_CASE("Cam-Clay: tension ends at beta p_c, which parting clay loses, and the gap must close again") {
  const double beta = 0.4;
  Particle<CamClay> particle = clay(beta);
  const double opened = 0.15;
  for (int step = 0; step < 300; ++step) particle.strain(opened / 900, opened / 900, opened / 900);
  // -p = beta p_c0 exp(xi e), and -p/K - e is the volume that opened.
  const double tension = root_of(0, beta * consolidation, [&](double at) {
    return opened - at / bulk + std::log(std::max(at, 1e-300) / (beta * consolidation)) / exponent;
  });
  CHECK(-particle.p() == Approx(tension).epsilon(1e-8));
  CHECK(std::log(CamClay::volume_ratio(particle.state)) == Approx(opened).epsilon(1e-12));
  for (int step = 0; step < 300; ++step) {
    particle.strain(-opened / 900, -opened / 900, -opened / 900);
    CHECK(particle.p() <= size_of(particle) * (1 + 1e-9));
  }
  const double back =
      root_of(1, consolidation, [&](double p) { return p / bulk + std::log(p / consolidation) / exponent; });
  CHECK(particle.p() == Approx(back).epsilon(1e-8));
}

TEST_CASE("Cam-Clay: the slope of hardening is held at half of that at which stress would jump") {
  for (double M : {0.6, 1.2, 2.0})
    for (double beta : {0.0, 0.1, 0.7}) {
      CAPTURE(M, beta);
      // Softening is stable on the ellipse while n.C n > -(dF/dp_c)(dp_c/de)(flow): the least ratio over its dry side,
      // in units of K, F = a q^2 + M^2 (p + beta p_c)(p - p_c) with p_c = 1.
      double least = 1e300;
      for (int k = 1; k <= 200000; ++k) {
        const double p = (1 - beta) / 2 - (1 + beta) / 2 * k / 200000, flow = M * M * (2 * p - (1 - beta));
        const double squared = M * M * (p + beta) * (1 - p) / (1 + 2 * beta), a = 1 + 2 * beta;
        const double stiffness = flow * flow + 12 * shear / bulk * a * a * squared;
        const double falls = -M * M * ((1 - beta) * p + 2 * beta) * flow;
        if (falls > 0) least = smaller(least, stiffness / falls);
      }
      const double xi = 500, straight = 0.5 * least * bulk;
      Particle<CamClay> particle = clay(beta, xi, M);
      particle.strain(-0.2, -0.2, -0.2);
      const double p_1 = particle.p(), e_1 = compaction(particle);
      CHECK(p_1 > straight / xi);
      particle.strain(-0.1, -0.1, -0.1);
      CHECK((particle.p() - p_1) / (compaction(particle) - e_1) == Approx(straight).epsilon(1e-6));
      // The straight part goes on from the exponential one, with its slope.
      const double from = std::log(straight / xi / consolidation) / xi;
      if (straight / xi > consolidation) CHECK(p_1 == Approx(straight / xi + straight * (e_1 - from)).epsilon(1e-6));
    }
}

TEST_CASE(
    "Cam-Clay: clay that is larger than the exponential law reaches hardens along the straight part from the start") {
  for (double M : {0.6, 1.2})
    for (double beta : {0.0, 0.5}) {
      CAPTURE(M, beta);
      const double size = consolidation / bulk, xi = 5000;
      const CamClay::Hardening<double> law(size, xi, M, beta, shear / bulk);
      const CamClay::Hardening<double> gentle(1e-3 * size, 0.5 * xi, M, beta, shear / bulk);
      double slope, gentle_slope;
      CHECK(law(0.0, slope) == Approx(size).epsilon(1e-12));
      CHECK(gentle(1.0, gentle_slope) > 0);
      CHECK(slope == Approx(gentle_slope).epsilon(1e-12));  // the steepest does not depend on where it is reached
      const double at_rest = slope;
      CHECK(law(0.01, slope) == Approx(size + 0.01 * at_rest).epsilon(1e-12));
      CHECK(slope == at_rest);
      // Below p_c = slope/xi it is exponential.
      const double first = (at_rest / xi - size) / at_rest;
      CHECK(law(first - 1e-4, slope) == Approx(at_rest / xi * std::exp(-0.5)).epsilon(1e-9));
      CHECK(slope == Approx(at_rest * std::exp(-0.5)).epsilon(1e-9));
    }
}

TEST_CASE(
    "Cam-Clay: the function that Newton's method solves has the sign of the ellipse's, and its slope the derivative") {
  std::mt19937 generator(17);
  std::uniform_real_distribution<double> unit(0, 1);
  int central = 0, tips = 0;
  for (int sample = 0; sample < 3000; ++sample) {
    const double beta = sample % 3 ? 0.9 * unit(generator) : 0, M = 0.5 + 1.5 * unit(generator),
                 xi = 30 * unit(generator);
    const CamClay::Constants<double> c({young, poisson, 1600, consolidation, M, xi, beta});
    CamClay::Trial<double> t;
    t.compaction = 0.02 * (unit(generator) - 0.5);
    double rate;
    const double size = c.hardening(t.compaction, rate), centre = (1 - beta) * size / 2;
    t.side = sample % 2 ? 1 : -1;
    t.pressure = centre + t.side * 2 * (1 + beta) * size * unit(generator);
    t.shear = 2 * M * size * unit(generator);
    const double farthest = std::abs(t.pressure - centre), X = farthest * (0.02 + 0.96 * unit(generator)),
                 h = 1e-6 * size;
    const CamClay::Point<double> here = CamClay::at(c, t, X), before = CamClay::at(c, t, X - h),
                                 after = CamClay::at(c, t, X + h);
    const double p = t.pressure - t.side * X, p_c = c.hardening(t.compaction + t.side * X, rate), a = 1 + 2 * beta;
    const double N = t.side * M * M * (2 * p - (1 - beta) * p_c), half = 0.5 * M * M * (1 + beta) * p_c;
    if (!(N > 1e-3 * half) || std::abs(N - half) < 1e-3 * half) continue;
    CAPTURE(sample, beta, M, xi, X / farthest, N / half);
    (N < half ? central : tips) += 1;
    const double q = t.shear * N / (N + 6 * shear / bulk * a * X);
    const double off = a * q * q + M * M * (p + beta * p_c) * (p - p_c);
    CHECK(here.pressure == Approx(p).margin(1e-14 * size));
    CHECK(here.size == Approx(p_c).epsilon(1e-13));
    CHECK(here.flow == Approx(N).margin(1e-13 * half));
    if (std::abs(off) > 1e-9 * M * M * p_c * p_c) CHECK((here.value > 0) == (off > 0));
    CHECK(here.slope == Approx((after.value - before.value) / (2 * h)).epsilon(1e-5).margin(1e-5));
  }
  CHECK(std::min(central, tips) > 300);
}

TEST_CASE("Cam-Clay: the return is found to the same share of the ellipse, however small the ellipse is") {
  for (double size : {1e-2, 1e-9, 1e-18})
    for (double beta : {0.0, 0.4}) {
      const CamClay::Constants<double> c({young, poisson, 1600, size * bulk, critical, 5, beta});
      for (double side : {1.0, -1.0}) {
        CAPTURE(size, beta, side);
        const double centre = (1 - beta) * size / 2, farthest = 1.5 * size;
        const CamClay::Trial<double> t{centre + side * farthest, 1.3 * size, 0, side};
        const double X = CamClay::solved(c, t, farthest);
        double rate;
        const double p = t.pressure - side * X, p_c = c.hardening(side * X, rate), M2 = critical * critical;
        const double N = side * M2 * (2 * p - (1 - beta) * p_c),
                     q = t.shear * N / (N + 6 * shear / bulk * (1 + 2 * beta) * X);
        CHECK(N > 0);
        CHECK(std::abs((1 + 2 * beta) * q * q + M2 * (p + beta * p_c) * (p - p_c)) < 1e-11 * size * size);
      }
    }
}

TEST_CASE("Cam-Clay: within the ellipse it closes its loops, beyond work is stored plus dissipated energy") {
  Particle<CamClay> elastic = clay();
  elastic.strain(-2e-3, -2e-3, -2e-3);
  check_elastic_loop(elastic, 1e-4);
  double last = 0;
  for (int steps : {200, 400, 800}) {
    Particle<CamClay> particle = clay(0.1);
    const double legs[4][3] = {{-0.06, -0.02, -0.02}, {0.03, -0.03, 0.01}, {0.05, 0.02, 0.01}, {-0.02, 0.03, 0}};
    double least = 0;
    for (const auto& leg : legs)
      for (int step = 0; step < steps; ++step)
        least = smaller(least, particle.strain(leg[0] / steps, leg[1] / steps, leg[2] / steps));
    CHECK(least >= 0);
    const double miss = std::abs(particle.work - particle.energy() - particle.heat) / particle.work;
    CHECK(miss < 10.0 / steps);
    if (last > 0) CHECK(miss < 0.6 * last);  // of first order
    last = miss;
  }
}

TEST_CASE("Cam-Clay: at rest the fastest wave is the elastic longitudinal one") {
  const Particle<CamClay> particle = clay();
  const double speed = CamClay::wave_speed(particle.constants, particle.state);
  CHECK(1600 * speed * speed == Approx(bulk + 4 * shear / 3).epsilon(1e-12));
}

TEST_CASE("Cam-Clay: J from 1e-6 to 1e6, thin and long particles, and inverted ones") {
  for (double beta : {0.0, 0.5})
    for (double J : {1e-6, 1e-3, 1e3, 1e6}) {
      CAPTURE(J, beta);
      Particle<CamClay> particle = clay(beta);
      const double third = std::cbrt(J) - 1;
      CHECK(particle.advance(diagonal(third, third, third)) >= 0);
      CHECK(CamClay::volume_ratio(particle.state) == Approx(J).epsilon(1e-12));
      CHECK(particle.p() == Approx(bulk * (-std::log(J) - compaction(particle))).margin(1e-10 * bulk));
      if (J > 1) CHECK(-particle.p() <= beta * size_of(particle) + 1e-12 * young);
      if (J < 1) CHECK(particle.p() > 10 * consolidation);
      CHECK(CamClay::wave_speed(particle.constants, particle.state) > 0);
    }
  for (double stretch : {1e-6, 1e-2, 1e2, 1e6}) {
    CAPTURE(stretch);
    Particle<CamClay> particle = clay();
    CHECK(particle.advance(diagonal(stretch - 1, 0, 0)) >= -1e-20 * young);
    CHECK(CamClay::volume_ratio(particle.state) == Approx(1 + (stretch - 1)).epsilon(1e-12));
    CHECK(std::isfinite(particle.q()));
    CHECK(particle.p() > -1e-9 * young);
    const double heat = particle.heat;
    CHECK(particle.strain(0, 0, 0) < 1e-9 * std::max(heat, young));  // the state was on the ellipse
  }
  Particle<CamClay> inverted = clay();
  inverted.advance(diagonal(-2, 0, 0));
  CHECK_FALSE(CamClay::volume_ratio(inverted.state) > 0);
}

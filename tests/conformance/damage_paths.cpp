// Scalar damage with crack-band scaling under imposed deformation, in closed form. In uniaxial tension kappa = ln s, the
// sides shrink by nu sigma/E, and the area below sigma(kappa) is Gc over the band width (Bazant & Oh, Mater. Struct. 16
// (1983) 155).

#include <array>
#include <cmath>
#include <random>

#include "materials/damage/damage.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;

constexpr double linear = 0, exponential = 1, bilinear = 2, tabulated = 3;
/// Concrete: E = 30 GPa, ft = 3 MPa, Gc = 100 J/m^2, which is usable on bands below 2/3 m.
constexpr double young = 30e9, poisson = 0.2, strength = 3e6, toughness = 100;

Damage::Parameters concrete(double width, double softening = linear) {
  return {young, poisson, 2400, strength, toughness, softening, 1, 0, 0, 0, 0, 0, 0, 0, 0, width};
}
/// The same with a table of openings over the last one and of shares of the strength.
struct TablePoint {
  double opening, share;
};
Damage::Parameters tabulated_concrete(double width, std::array<TablePoint, 4> t) {
  return {young,      poisson,      2400,       strength,     toughness,  tabulated,    1,          t[0].opening,
          t[0].share, t[1].opening, t[1].share, t[2].opening, t[2].share, t[3].opening, t[3].share, width};
}

/// A particle whose principal strains are imposed along the axes.
struct Particle {
  Damage::Constants<double> constants;
  Damage::State<3, double> state{Mat3::identity(), 0, 0};
  Vec<3, double> strain{};
  double heat = 0;  ///< dissipated so far, J/m^3

  explicit Particle(const Damage::Parameters& p) : constants(p) {}

  void strain_to(const Vec<3, double>& next, int steps) {
    Mat3 L{};
    for (int i = 0; i < 3; ++i) L(i, i) = std::exp((next[i] - strain[i]) / steps) - 1;
    for (int k = 0; k < steps; ++k) heat += Damage::advance(constants, L, 1.0, state);
    strain = next;
  }
  /// Uniaxial tension: the strain along x is `along`, and the sides are free of stress where that along x is `sigma`.
  void pull_to(double along, double sigma, int steps = 16) {
    const double side = -poisson * sigma / young;
    strain_to({{along, side, side}}, steps);
  }
  Sym<3, double> stress() const { return Damage::kirchhoff_stress(constants, state); }
  double energy() const { return Damage::stored_energy(constants, state); }
};

/// Pulls to a strain in one step and in many: stress sigma along x, none at the sides, and the energy of a straight way back.
void check_curve(const Damage::Parameters& p, double along, double sigma) {
  for (const int steps : {1, 200}) {
    Particle particle(p);
    particle.pull_to(along, sigma, steps);
    CAPTURE(along, steps, sigma, p.poisson_ratio);
    const Sym<3, double> tau = particle.stress();
    CHECK(tau(0, 0) == Approx(sigma).epsilon(1e-9).margin(1e-9 * strength));
    for (int k = 1; k < 6; ++k) CHECK(std::abs(tau.s[k]) < 1e-9 * strength);
    CHECK(particle.state.equivalent_strain == Approx(std::max(along, strength / young)).epsilon(1e-9));
    CHECK(particle.energy() == Approx(sigma * along / 2).epsilon(1e-9).margin(1e-12 * strength));
  }
}

/// Pulls until nothing is left: a crack of unit area dissipates Gc, whatever the band and however long the steps.
void check_fracture_energy(const Damage::Parameters& p, double end) {
  for (const int steps : {1, 3, 1000}) {
    Particle particle(p);
    particle.pull_to(end, 0, steps);
    CAPTURE(p.cell_size, p.softening, steps);
    CHECK(particle.heat * p.band_cells * p.cell_size == Approx(p.fracture_energy).epsilon(1e-9));
    CHECK(std::abs(particle.stress()(0, 0)) < 1e-9 * p.tensile_strength);
    CHECK(particle.energy() < 1e-9 * p.tensile_strength);
    CHECK(particle.state.damage <= 1);
  }
}

double elastic_energy(const Vec<3, double>& e) {
  const double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const double trace = e[0] + e[1] + e[2];
  return mu * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + lambda / 2 * trace * trace;
}

/// psi(p) by trial: the least energy of e - r over all r that are not negative, one component after the other.
double pressed_energy(const Vec<3, double>& e) {
  const double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  Vec<3, double> r{};
  for (int sweep = 0; sweep < 2000; ++sweep)
    for (int i = 0; i < 3; ++i) {
      double others = 0;
      for (int j = 0; j < 3; ++j) others += j == i ? 0 : e[j] - r[j];
      r[i] = std::max(0.0, e[i] + lambda * others / (lambda + 2 * mu));
    }
  return elastic_energy({{e[0] - r[0], e[1] - r[1], e[2] - r[2]}});
}

}  // namespace

TEST_CASE("damage: linear softening of concrete ends at 2 Gc/(ft h) on bands of three widths") {
  const double widths[] = {0.01, 0.02, 0.05}, ends[] = {6.6666667e-3, 3.3333333e-3, 1.3333333e-3}, onset = 1e-4;
  for (int k = 0; k < 3; ++k) {
    const Damage::Parameters p = concrete(widths[k], linear);
    check_curve(p, 0.5 * onset, 0.5 * strength);
    check_curve(p, onset, strength);
    for (const double share : {0.1, 0.5, 0.9})
      check_curve(p, onset + share * (2 * toughness / (strength * widths[k]) - onset), (1 - share) * strength);
    check_curve(p, ends[k] * (1 + 1e-7), 0);
    check_fracture_energy(p, 1.5 * ends[k]);
  }
}

TEST_CASE("damage: exponential softening of concrete decays over Gc/(h ft) - ft/(2 E) on bands of three widths") {
  const double widths[] = {0.01, 0.02, 0.05}, decays[] = {3.2833333e-3, 1.6166667e-3, 6.1666667e-4}, onset = 1e-4;
  for (int k = 0; k < 3; ++k) {
    const Damage::Parameters p = concrete(widths[k], exponential);
    CHECK(toughness / (widths[k] * strength) - onset / 2 == Approx(decays[k]).epsilon(1e-7));
    for (const double lengths : {0.0, 0.2, 1.0, 3.0})
      check_curve(p, onset + lengths * (toughness / (widths[k] * strength) - onset / 2), strength * std::exp(-lengths));
    check_fracture_energy(p, onset + 40 * decays[k]);
  }
}

TEST_CASE("damage: bilinear softening bends at a third of the strength where 0.8 Gc/ft is open") {
  for (const double width : {0.01, 0.02, 0.05}) {
    const Damage::Parameters p = concrete(width, bilinear);
    const double opening = toughness / (strength * width), onset = 1e-4;
    const double kink = onset / 3 + 0.8 * opening, end = 3.6 * opening;
    check_curve(p, kink, strength / 3);
    check_curve(p, (onset + kink) / 2, strength * 2 / 3);
    check_curve(p, (kink + end) / 2, strength / 6);
    check_curve(p, end, 0);
    check_fracture_energy(p, 1.2 * end);
  }
}

TEST_CASE("damage: a table of softening goes through its points and dissipates Gc on bands of three widths") {
  // A plateau, a steep and a gentle line, which no convex law has: the area below it is 0.2 + 0.14 + 0.06 + 0.045 + 0.005.
  const std::array<TablePoint, 4> points{{{0.2, 1}, {0.4, 0.4}, {0.6, 0.2}, {0.9, 0.1}}};
  const double openings[] = {0, 0.2, 0.4, 0.6, 0.9, 1}, shares[] = {1, 1, 0.4, 0.2, 0.1, 0};
  double area = 0;
  for (int k = 0; k < 5; ++k) area += (shares[k] + shares[k + 1]) / 2 * (openings[k + 1] - openings[k]);
  CHECK(area == Approx(0.45).epsilon(1e-12));
  for (const double width : {0.01, 0.02, 0.05}) {
    const Damage::Parameters p = tabulated_concrete(width, points);
    const double end = toughness / (strength * width * area);
    const auto strain = [&](double opening, double share) { return share * strength / young + end * opening; };
    check_curve(p, 0.5 * strength / young, 0.5 * strength);
    for (int k = 0; k < 5; ++k)
      for (const double s : {0.0, 0.3, 0.8, 1.0}) {
        const double share = shares[k] + s * (shares[k + 1] - shares[k]);
        check_curve(p, strain(openings[k] + s * (openings[k + 1] - openings[k]), share), share * strength);
      }
    check_curve(p, 1.5 * end, 0);
    check_fracture_energy(p, 1.2 * end);
  }
}

TEST_CASE("damage: a table without points is linear softening, and one with a point the bilinear law") {
  for (const double width : {0.01, 0.05}) {
    const std::pair<Damage::Parameters, Damage::Parameters> same[] = {
        {tabulated_concrete(width, {}), concrete(width, linear)},
        {tabulated_concrete(width, {{{0.8 / 3.6, 1.0 / 3}}}), concrete(width, bilinear)}};
    for (const auto& [table, law] : same) {
      Particle one(table), other(law);
      for (const double along : {5e-5, 2e-4, 6e-4, 2e-3, 1e-2}) {
        for (Particle* particle : {&one, &other}) particle->strain_to({{along, -0.1 * along, -0.1 * along}}, 7);
        CAPTURE(width, along);
        CHECK(one.state.damage == Approx(other.state.damage).epsilon(1e-9));
        CHECK(one.heat == Approx(other.heat).epsilon(1e-9).margin(1e-9 * strength));
        CHECK(one.stress()(0, 0) == Approx(other.stress()(0, 0)).epsilon(1e-9).margin(1e-9 * strength));
      }
      const auto limit = [](Damage::Parameters p) {
        p.cell_size = 10;
        return Damage::refusal(p, {3, 0}).limit;
      };
      CHECK(limit(table) == Approx(limit(law)).epsilon(1e-12));
    }
  }
}

TEST_CASE("damage: tables whose openings do not grow, or shares do, are refused, and bands that would snap back") {
  const auto refused = [](std::array<TablePoint, 4> points, double width = 0.01) {
    const mpm_refusal refusal = Damage::refusal(tabulated_concrete(width, points), {3, 0});
    return std::string(refusal.parameter ? refusal.parameter : "");
  };
  CHECK(refused({{{0.2, 1}, {0.4, 0.4}}}) == "");
  CHECK(refused({{{0.4, 0.5}, {0.4, 0.4}}}) == "opening_1");
  CHECK(refused({{{0.2, 0.5}, {0.4, 0.3}, {0.5, 0.31}}}) == "share_3");
  CHECK(refused({{{0, 0}, {0.4, 0.4}}}) == "opening_2");
  CHECK(refused({{{0, 0.5}}}) == "share_1");
  Damage::Parameters linear = tabulated_concrete(0.01, {{{0.2, 0.5}}});
  linear.softening = static_cast<double>(SofteningLaw::linear);
  CHECK(std::string(Damage::refusal(linear, {3, 0}).parameter) == "opening_1");
  // The middle line loses 0.9 on a way of 0.1.
  const std::array<TablePoint, 4> steep{{{0.45, 1}, {0.55, 0.1}}};
  const double area = 0.45 + 0.055 + 0.0225, widest = 0.1 / 0.9 / area * young * toughness / (strength * strength);
  CHECK(refused(steep, 0.999 * widest) == "");
  CHECK(refused(steep, 1.001 * widest) == "cell_size");
  CHECK(Damage::refusal(tabulated_concrete(1, steep), {3, 0}).limit == Approx(widest).epsilon(1e-12));
}

TEST_CASE("damage: cells above 2 E Gc/ft^2 would snap back and are refused, with the largest usable size") {
  const auto refusal = [](double E, double ft, double Gc, double softening, double band, double size) {
    return Damage::refusal({E, poisson, 2400, ft, Gc, softening, band, 0, 0, 0, 0, 0, 0, 0, 0, size}, {3, 0});
  };
  for (const double law : {linear, exponential}) {
    CHECK(refusal(10e9, 5e6, 50, law, 1, 0.01).parameter == nullptr);
    CHECK(refusal(10e9, 5e6, 50, law, 1, 0.0399999).parameter == nullptr);
    for (const double size : {0.04, 0.05, 1e3}) {
      const mpm_refusal refused = refusal(10e9, 5e6, 50, law, 1, size);
      REQUIRE(refused.parameter != nullptr);
      CHECK(refused.parameter == std::string("cell_size"));
      CHECK(refused.limit == Approx(0.04).epsilon(1e-12));
    }
    CHECK(refusal(young, strength, toughness, law, 1, 1).limit == Approx(2.0 / 3).epsilon(1e-12));
    CHECK(refusal(10e9, 5e6, 50, law, 2, 0.03).limit == Approx(0.02).epsilon(1e-12));
  }
  CHECK(refusal(10e9, 5e6, 50, bilinear, 1, 0.025).limit == Approx(0.024).epsilon(1e-12));
  // On the band of C11h: eps_f = 2e-3, above ft/E = 5e-4.
  Particle particle({10e9, poisson, 2400, 5e6, 50, linear, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0.01});
  particle.strain_to({{1.25e-3, -poisson * 2.5e-4, -poisson * 2.5e-4}}, 4);
  CHECK(particle.stress()(0, 0) == Approx(2.5e6).epsilon(1e-9));
}

TEST_CASE("damage: unloading goes to the origin, reloading does not damage, and a closed path loses what it says") {
  for (const double law : {linear, exponential, bilinear}) {
    CAPTURE(law);
    Particle particle(concrete(0.02, law));
    const double sigma = particle.constants.softening.stress(1e-3);
    particle.pull_to(1e-3, sigma, 50);
    const double damage = particle.state.damage, heat = particle.heat;
    CHECK(particle.stress()(0, 0) == Approx(sigma).epsilon(1e-9));
    CHECK(damage > 0.5);
    for (const double share : {0.5, 0.0, 0.7, 1.0}) {
      particle.pull_to(share * 1e-3, share * sigma);
      CHECK(particle.stress()(0, 0) == Approx(share * sigma).epsilon(1e-9).margin(1e-9 * strength));
      CHECK(std::abs(particle.stress()(1, 1)) < 1e-9 * strength);
      CHECK(particle.state.damage == Approx(damage).epsilon(1e-9));
      CHECK(particle.heat == Approx(heat).epsilon(1e-9));
    }
    // A path that closes, along x, y and z, by small steps: all work is heat, as no strain and no energy stay.
    Particle loop(concrete(0.02, law));
    double work = 0;
    const int steps = 4000;
    for (int k = 1; k <= 2 * steps; ++k) {
      const Sym<3, double> before = loop.stress();
      const double next = static_cast<double>(k <= steps ? k : 2 * steps - k) / steps;
      const Vec<3, double> last = loop.strain;
      loop.strain_to({{1e-3 * next, 4e-4 * next, -5e-4 * next}}, 1);
      for (int i = 0; i < 3; ++i) work += 0.5 * (before.s[i] + loop.stress().s[i]) * (loop.strain[i] - last[i]);
    }
    CHECK(loop.energy() < 1e-12 * strength);
    CHECK(work == Approx(loop.heat).epsilon(1e-4));
  }
}

TEST_CASE("damage: closed cracks press as if they were whole") {
  const double bulk = young / (3 * (1 - 2 * poisson)), plate = young / (1 - poisson * poisson);
  Particle split(concrete(0.05));
  split.pull_to(2e-3, 0);
  CHECK(split.state.damage == 1);
  CHECK(std::abs(split.stress()(0, 0)) < 1e-9 * strength);
  split.strain_to({{-1e-3, -1e-3, -1e-3}}, 16);
  for (int i = 0; i < 3; ++i) CHECK(split.stress().s[i] == Approx(-3e-3 * bulk).epsilon(1e-9));
  CHECK(split.energy() == Approx(bulk / 2 * 9e-6).epsilon(1e-9));
  split.pull_to(-1e-3, -1e-3 * young);  // pressed with free sides: Young's modulus
  CHECK(split.stress()(0, 0) == Approx(-1e-3 * young).epsilon(1e-9));
  CHECK(std::abs(split.stress()(1, 1)) < 1e-9 * strength);
  // Open along x, pressed along y and held along z: a plate that is free of stress along x.
  split.strain_to({{1e-3, -1e-3, 0}}, 16);
  CHECK(std::abs(split.stress()(0, 0)) < 1e-9 * strength);
  CHECK(split.stress()(1, 1) == Approx(-1e-3 * plate).epsilon(1e-9));
  CHECK(split.stress()(2, 2) == Approx(-1e-3 * plate * poisson).epsilon(1e-9));
}

TEST_CASE("damage: begins where the largest principal stress is the strength, and never under pressure") {
  const double shear = young / (2 * (1 + poisson)), onset = strength / young;
  const double modulus = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson));
  const auto damage = [](double x, double y, double z) {
    Particle particle(concrete(0.05));
    particle.strain_to({{x, y, z}}, 4);
    return particle.state.damage;
  };
  CHECK(damage(-0.1, -0.1, -0.1) == 0);
  CHECK(damage(-0.1, 0, 0) == 0);
  CHECK(damage(-0.1, -0.03, 0) == 0);
  CHECK(damage(-0.1, 0.9999 * poisson * 0.1, 0.9999 * poisson * 0.1) == 0);  // free sides
  const auto begins_at = [&](double x, double y, double z) {
    CAPTURE(x, y, z);
    CHECK(damage(0.9999 * x, 0.9999 * y, 0.9999 * z) == 0);
    CHECK(damage(1.0001 * x, 1.0001 * y, 1.0001 * z) > 0);
  };
  begins_at(onset, -poisson * onset, -poisson * onset);
  begins_at(strength / modulus, 0, 0);                            // confined at the sides
  begins_at(strength / (2 * shear), -strength / (2 * shear), 0);  // pure shear
  const double twice = onset * std::sqrt((1 - poisson) / 2);      // stresses ft/sqrt(2 (1 - nu)) along x and y
  begins_at(twice, twice, -2 * poisson / (1 - poisson) * twice);
}

TEST_CASE("damage: no rounding damages what stays below the strength") {
  for (int k = 0; k < 2000; ++k) {
    const double ft = strength * (0.5 + 1e-3 * k);
    Particle particle({young, poisson, 2400, ft, toughness, k % 3 + 0.0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0.01});
    particle.pull_to(0.999 * ft / young, 0.999 * ft, 1);
    if (particle.state.damage != 0) FAIL("ft = " << ft << ", damage " << particle.state.damage);
    if (particle.heat != 0) FAIL("ft = " << ft << ", heat " << particle.heat);
  }
}

TEST_CASE("damage: what it leaves of a strain is that of a solid without tension, of the least energy") {
  std::mt19937 numbers(3);
  const auto entry = [&] { return std::ldexp(static_cast<double>(numbers()), -31) - 1; };
  const Damage::Constants<double> constants(concrete(0.05));
  const double modulus = constants.rest_modulus;
  int parts[4] = {};
  for (int k = 0; k < 4000; ++k) {
    Vec<3, double> e{{entry(), entry(), entry()}};
    if (k % 5 == 0) e[1] = e[0];
    if (k % 7 == 0) e[2] = e[1];
    const Vec<3, double> p = Damage::pressed(constants, e), stress = HenckySolid::stresses(constants, p);
    CAPTURE(e[0], e[1], e[2], p[0], p[1], p[2]);
    CHECK(elastic_energy(p) == Approx(pressed_energy(e)).epsilon(1e-9).margin(1e-9 * modulus));
    int open = 0;
    for (int i = 0; i < 3; ++i) {
      CHECK(stress[i] <= 1e-12 * modulus);
      CHECK(e[i] - p[i] >= -1e-15);
      CHECK(std::abs(stress[i] * (e[i] - p[i])) < 1e-12 * modulus);  // an open crack bears nothing
      open += e[i] - p[i] > 1e-15;
    }
    ++parts[open];
    CHECK(elastic_energy(e) ==
          Approx(elastic_energy(p) + elastic_energy({{e[0] - p[0], e[1] - p[1], e[2] - p[2]}})).epsilon(1e-12));
  }
  for (const int count : parts) CHECK(count > 100);
}

TEST_CASE("damage: what softening dissipates is the integral of the degraded energy over the damage") {
  const double confined = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson));
  for (const double modulus : {young, confined})  // of what is degraded: all of tension, or strain across a crack alone
    for (const SofteningLaw law : {SofteningLaw::linear, SofteningLaw::exponential, SofteningLaw::bilinear}) {
      const BandSoftening<double> band(law, young, strength, toughness, 0.02, 1 - young / modulus);
      const int steps = 20000;
      double sum = 0, furthest = 0;
      bool grows = true;
      for (int k = 0; k < steps; ++k) {
        const double before = 1e-4 + 7e-3 * k / steps, after = 1e-4 + 7e-3 * (k + 1) / steps;
        const double middle = 0.5 * (before + after);
        const double measure = middle - (1 - young / modulus) * band.stress(middle) / young;
        furthest = larger(furthest, std::abs(band.strain_of(measure) / middle - 1));
        sum += modulus / 2 * measure * measure * (band.damage(after) - band.damage(before));
        grows &= band.damage(after) >= band.damage(before);
      }
      CAPTURE(static_cast<int>(law), modulus);
      CHECK(grows);
      CHECK(furthest < 1e-12);
      CHECK(sum == Approx(band.dissipated(1e-4, 7.1e-3)).epsilon(1e-5));
      CHECK(band.dissipated(1e-4, 3e-3) + band.dissipated(3e-3, 7.1e-3) ==
            Approx(band.dissipated(1e-4, 7.1e-3)).epsilon(1e-12));
      CHECK(band.dissipated(3e-3, 3e-3) == 0);
      for (const double below : {0.0, 0.99e-4, 0.999999e-4}) CHECK(band.damage(below) == 0);
    }
}

TEST_CASE(
    "damage: a turned particle has the turned stress, in the plane and around an axis that of the same stretches") {
  const double c = std::cos(0.7), s = std::sin(0.7), onset = strength / young;
  const Damage::Constants<double> constants(concrete(0.05));
  const double shear = young / (2 * (1 + poisson)), lambda = 2 * shear * poisson / (1 - 2 * poisson);
  for (const double zz : {1.0, std::exp(-0.5 * onset)}) {
    const double e[3] = {0.6 * onset, -0.4 * onset, std::log(zz)};
    double tau[3];
    for (int i = 0; i < 3; ++i) tau[i] = lambda * (e[0] + e[1] + e[2]) + 2 * shear * e[i];
    // R diag(e^e) of a turn R about z.
    const double x = std::exp(e[0]), y = std::exp(e[1]);
    const Mat<2, double> plane{{c * x, -s * y, s * x, c * y}};
    const auto check = [&](const auto& stress) {
      CHECK(stress(0, 0) == Approx(c * c * tau[0] + s * s * tau[1]).epsilon(1e-9));
      CHECK(stress(1, 1) == Approx(s * s * tau[0] + c * c * tau[1]).epsilon(1e-9));
      CHECK(stress(0, 1) == Approx(c * s * (tau[0] - tau[1])).epsilon(1e-9));
      CHECK(stress.s[2] == Approx(tau[2]).epsilon(1e-9).margin(1e-9 * strength));
    };
    const Mat3 space{{c * x, -s * y, 0, s * x, c * y, 0, 0, 0, zz}};
    const Damage::State<3, double> whole{space, 0, 0};
    const Damage::AxisymmetricState<double> ring{{plane, zz}, 0, 0};
    const Damage::State<2, double> flat{plane, 0, 0};
    check(Damage::kirchhoff_stress(constants, whole));
    check(Damage::kirchhoff_stress(constants, ring));
    if (zz == 1) check(Damage::kirchhoff_stress(constants, flat));
    const double energy =
        shear * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + lambda / 2 * std::pow(e[0] + e[1] + e[2], 2);
    CHECK(Damage::stored_energy(constants, whole) == Approx(energy).epsilon(1e-9));
    CHECK(Damage::stored_energy(constants, ring) == Approx(energy).epsilon(1e-9));
    if (zz == 1) CHECK(Damage::stored_energy(constants, flat) == Approx(energy).epsilon(1e-9));
  }
}

TEST_CASE("damage: the fastest wave is that of the whole solid where anything is pressed, else of what is left") {
  // Bounds of kernel/hencky.hpp, where the principal strains differ by x: longitudinal waves have lambda + 2 mu less the least
  // principal stress, shear waves 2 mu x/(1 - e^-2x) <= mu (x + sqrt(x^2 + 1)), and askew of the axes mu x^2/(2 (1 + x)) more.
  const auto modulus = [](double nu, const Vec<3, double>& e, double damage) {
    const Damage::Constants<double> c({young, nu, 2400, strength, toughness, linear, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0.05});
    const Damage::State<3, double> state{
        {{std::exp(e[0]), 0, 0, 0, std::exp(e[1]), 0, 0, 0, std::exp(e[2])}}, 0, damage};
    const double speed = Damage::wave_speed(c, state);
    return 2400 * speed * speed;
  };
  const auto askew = [](double x) { return x * x / (2 * (1 + x)); };
  const double bulk = young / (3 * (1 - 2 * poisson)), shear = young / (2 * (1 + poisson)), rest = bulk + 4 * shear / 3;
  CHECK(modulus(poisson, {{0, 0, 0}}, 0) == Approx(rest).epsilon(1e-12));
  for (const double damage : {0.0, 0.3, 1.0}) {
    CAPTURE(damage);
    CHECK(modulus(poisson, {{-0.1, -0.1, -0.1}}, damage) == Approx(rest + 0.3 * bulk).epsilon(1e-9));
    // All permutations of axes.
    for (int axis = 0; axis < 3; ++axis)
      for (int next = 1; next < 3; ++next) {
        const auto along = [&](double first, double second, double third) {
          Vec<3, double> e{};
          e[axis] = first, e[(axis + next) % 3] = second, e[(axis + 3 - next) % 3] = third;
          return e;
        };
        CAPTURE(axis, next);
        // Pressed with free sides: the least stress is -0.3 E.
        CHECK(modulus(poisson, along(-0.3, 0.06, 0.06), damage) ==
              Approx(rest + 0.3 * young + shear * askew(0.36)).epsilon(1e-9));
        // Open along the first axis, pressed along the others: there -E/(1 - nu) 0.2 without tension from the crack.
        CHECK(modulus(poisson, along(0.5, -0.2, -0.2), damage) ==
              Approx(rest + 0.2 * young / (1 - poisson) + shear * askew(0.7)).epsilon(1e-9));
        // With nu = -0.3 the crack's tension presses on the others: 2 mu (-0.02) + lambda (0.46 - 0.02 - 0.01).
        const double mu = young / 1.4, lambda = 2 * mu * -0.3 / 1.6;
        CHECK(modulus(-0.3, along(0.46, -0.02, -0.01), damage) ==
              Approx(lambda + 2 * mu + 0.04 * mu - 0.43 * lambda + mu * askew(0.48)).epsilon(1e-9));
        // Nothing is pressed, and shear waves between strains that differ by 3 are the fastest.
        const double solid = shear * (3 + std::sqrt(10.0) + askew(3));
        CHECK(modulus(poisson, along(3, 0, 1), damage) == Approx(std::max(rest, (1 - damage) * solid)).epsilon(1e-9));
        CHECK(modulus(poisson, along(3, 0, 1), damage) >= (1 - damage) * shear * 6 / (1 - std::exp(-6.0)));
      }
  }
}

TEST_CASE("damage: the strain of a measure is found where softening is steep and cracks pull hard on what is whole") {
  // k = 1 - E/M at nu = 0.45, on bands up to all but the widest, where sigma falls within a hundredth of the onset.
  const double nu = 0.45, share = 1 - (1 + nu) * (1 - 2 * nu) / (1 - nu), onset = strength / young;
  for (double part : {0.1, 0.5, 0.9, 0.99}) {
    const double width = part * 2 * young * toughness / (strength * strength);
    const BandSoftening<double> band(SofteningLaw::exponential, young, strength, toughness, width, share);
    for (double times : {1.001, 1.1, 2.0, 10.0}) {
      CAPTURE(part, times);
      const double decay = toughness / (width * strength) - onset / 2, kappa = times * onset;
      const double measure = kappa - share * onset * std::exp(-(kappa - onset) / decay);
      CHECK(band.strain_of(measure) == Approx(kappa).epsilon(1e-10));
    }
  }
}

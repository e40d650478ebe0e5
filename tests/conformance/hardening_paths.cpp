// Metals that harden by a power law, by Voce's law, by a table and by Johnson & Cook's: flow curves, rates and temperatures against the
// published formulas, which stand here once more, and the equation of a step against plain Newton. In uniaxial Kirchhoff
// stress tau is the flow stress itself, at any strain.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "kernel/dual.hpp"
#include "kernel/lanes.hpp"
#include "materials/johnson_cook/johnson_cook.hpp"
#include "materials/von_mises/von_mises.hpp"
#include "materials/von_mises_power/von_mises_power.hpp"
#include "materials/von_mises_table/von_mises_table.hpp"
#include "materials/von_mises_voce/von_mises_voce.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;

constexpr double young = 200e3, poisson = 0.3, density = 1000, shear = young / (2 * (1 + poisson));
constexpr double room = 293.15;

/// The laws as functions of plastic strain, its rate and temperature, written from the papers.
using FlowCurve = std::function<double(double strain, double rate, double temperature)>;

constexpr VonMisesPower::Parameters power{young, poisson, density, 100, 0.02, 0.2, 2};
constexpr VonMisesVoce::Parameters voce{young, poisson, density, 100, 60, 0.05, 40, 2};
constexpr VonMisesTable::Parameters table{young, poisson, density, 100, 0.02, 150, 0.1, 180, 0.3,
                                          200,   0,       0,       0,   0,    0,   0,   2};
/// OFHC copper and 4340 steel of the paper, MPa.
constexpr JohnsonCook::Parameters copper{124e3, 0.34, density, 90, 292, 0.31, 0.025, 1, 1356, 1.09, room, 2};
constexpr JohnsonCook::Parameters steel{young, 0.29, density, 792, 510, 0.26, 0.014, 1, 1793, 1.03, room, 2};

double power_curve(double strain, double, double) {
  return 100 * std::pow(1 + strain / 0.02, 0.2);
}
double voce_curve(double strain, double, double) {
  return 100 + 60 * (1 - std::exp(-strain / 0.05)) + 40 * strain;
}
double table_curve(double strain, double, double) {
  return strain < 0.02  ? 100 + 2500 * strain
         : strain < 0.1 ? 150 + 375 * (strain - 0.02)
         : strain < 0.3 ? 180 + 100 * (strain - 0.1)
                        : 200;
}
FlowCurve johnson_cook_curve(const JohnsonCook::Parameters& p) {
  return [p](double strain, double rate, double temperature) {
    const double relative = rate / p.reference_rate,
                 warmth = (temperature - p.room_temperature) / (p.melting_temperature - p.room_temperature);
    return (p.yield_stress + p.hardening_coefficient * std::pow(strain, p.hardening_exponent)) *
           (1 + p.rate_coefficient * (relative > 1 ? std::log(relative) : 0)) *
           (1 - (warmth > 0 ? std::pow(warmth, p.thermal_exponent) : 0));
  };
}

/// One particle of a metal, driven by increments over steps of length dt.
template <class Metal>
struct Particle {
  using State = typename Metal::template State<3, double>;
  typename Metal::template Constants<double> constants;
  State state{};
  double young, poisson, dt = 1;
  double heat = 0, work = 0, strain = 0;  ///< J/m^3, and the logarithmic strain along x

  template <class Parameters>
  explicit Particle(const Parameters& p) : constants(p), young(p.youngs_modulus), poisson(p.poisson_ratio) {
    state.elastic_left_cauchy_green = Sym<3, double>::identity();
    state.volume_ratio = 1;
    warm_to(room);
  }
  void warm_to(double temperature) {
    if constexpr (requires { state.temperature; }) state.temperature = temperature;
  }

  Sym<3, double> stress() const { return Metal::kirchhoff_stress(constants, state); }
  double energy() const { return Metal::stored_energy(constants, state); }
  double plastic() const { return state.equivalent_plastic_strain; }
  /// sqrt(3/2) |dev tau|
  double equivalent_stress() const { return std::sqrt(1.5 * squared_norm(deviator(stress()))); }

  double advance(const Mat3& increment) {
    Mat3 L = increment;
    for (double& entry : L.m) entry /= dt;
    return Metal::advance(constants, L, dt, state);
  }

  /// Adds an axial increment with free sides: the lateral increment is found by Newton on the lateral stress.
  void pull(double axial) {
    const State before = state;
    const double start = stress()(0, 0);
    double side = plastic() > 0 && axial > 0 ? -0.5 * axial : -poisson * axial;
    double released = 0;
    const auto lateral = [&](double s) {
      state = before;
      released = advance({{axial, 0, 0, 0, s, 0, 0, 0, s}});
      return stress()(1, 1);
    };
    for (int iteration = 0; iteration < 30; ++iteration) {
      const double h = 1e-9, value = lateral(side);
      if (std::abs(value) < 1e-9) break;
      side -= value * 2 * h / (lateral(side + h) - lateral(side - h));
    }
    REQUIRE(std::abs(lateral(side)) < 1e-6);
    heat += released;
    strain += std::log1p(axial);
    work += 0.5 * (start + stress()(0, 0)) * std::log1p(axial);
  }
};

/// The plastic strain at which a bar of total strain `strain` has the flow stress that its elastic strain carries.
double plastic_strain(const FlowCurve& curve, double young, double strain) {
  double low = 0, high = strain;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (young * (strain - middle) > curve(middle, 0, room) ? low : high) = middle;
  }
  return low;
}

/// Pulls a bar slowly, and compares its stress with the law's at the plastic strain that the particle has, and the latter with
/// what the bar's strain makes of it, which belongs to small elastic strains: to their order.
template <class Metal, class Parameters>
void check_flow_curve(const Parameters& parameters, const FlowCurve& curve) {
  Particle<Metal> particle(parameters);
  particle.dt = 1e6;  // so slow that rates do not count
  int compared = 0;
  for (int k = 1; k <= 600; ++k) {
    particle.pull(5e-4);
    if (k != 20 && k != 60 && k != 150 && k != 300 && k != 600) continue;
    const double stress = particle.stress()(0, 0), plastic = particle.plastic();
    CAPTURE(k, particle.strain, plastic, stress);
    const double expected = plastic_strain(curve, particle.young, particle.strain);
    CHECK(plastic == Approx(expected).epsilon(1.5 * stress / particle.young));
    CHECK(stress == Approx(curve(plastic, 0, room)).epsilon(1e-10));
    ++compared;
  }
  CHECK(compared == 5);
}

/// Pulls a bar slowly: its heat is the area under the flow curve. Both agree to the order of the elastic strain and of the
/// step, 2e-3; the work of the stress is what is stored and what is heat, to the order of the step.
template <class Metal, class Parameters, class Area>
void check_heat(const Parameters& parameters, const Area& area) {
  Particle<Metal> particle(parameters);
  particle.dt = 1e6;
  for (int k = 0; k < 1000; ++k) particle.pull(2e-4);
  CAPTURE(particle.plastic(), particle.heat, area(particle.plastic()));
  REQUIRE(particle.plastic() > 0.15);
  CHECK(particle.heat == Approx(area(particle.plastic())).epsilon(2e-3));
  for (int k = 0; k < 20; ++k) particle.pull(-2e-4 / 20 * particle.stress()(0, 0) / parameters.yield_stress);
  CHECK(particle.work == Approx(particle.energy() + particle.heat).epsilon(1e-3));
}

/// Random strain increments about `size`, without change of volume on average.
Mat3 random_increment(unsigned& seed, double size) {
  const auto number = [&] { return (seed = seed * 1664525u + 1013904223u) * 0x1p-31 - 1; };
  Mat3 L;
  for (double& entry : L.m) entry = size * number();
  const double third = (L(0, 0) + L(1, 1) + L(2, 2)) / 3;
  for (int i = 0; i < 3; ++i) L(i, i) -= third;
  return L;
}

/// Strains a metal along a random path: the stress is nowhere above the law's, and on it where the metal flows.
template <class Metal, class Parameters>
void check_consistency(const Parameters& parameters, const FlowCurve& curve, double temperature, double dt) {
  Particle<Metal> particle(parameters);
  particle.dt = dt;
  particle.warm_to(temperature);
  unsigned seed = 5;
  int flows = 0;
  double off = 0, above = 0, least_heat = 0;
  for (int k = 0; k < 4000; ++k) {
    const double before = particle.plastic();
    least_heat = smaller(least_heat, particle.advance(random_increment(seed, k % 3 ? 3e-4 : 3e-2)));
    const double flowed = particle.plastic() - before, law = curve(particle.plastic(), flowed / dt, temperature);
    const double excess = particle.equivalent_stress() / law - 1;
    if (flowed > 0 && flowed < 1e-5) continue;  // their rate drowns in the rounding of the difference
    above = larger(above, excess);
    if (flowed > 0) off = larger(off, std::abs(excess)), ++flows;
  }
  CAPTURE(flows, off, above, temperature, dt, particle.plastic());
  CHECK(flows > 500);
  CHECK(off < 1e-10);
  CHECK(above < 1e-10);
  CHECK(least_heat >= 0);
}

/// Strains a metal and one of linear hardening along the same random path: they must be the same metal.
template <class Metal, class Parameters>
void check_is_linear(const Parameters& parameters, double yield, double hardening) {
  Particle<Metal> particle(parameters);
  Particle<VonMises> linear(VonMises::Parameters{young, poisson, density, yield, hardening, 2});
  unsigned seed = 11, same = 11;
  double worst = 0, heat = 0, linear_heat = 0;
  for (int k = 0; k < 500; ++k) {
    heat += particle.advance(random_increment(seed, 3e-3));
    linear_heat += linear.advance(random_increment(same, 3e-3));
    const Sym<3, double> a = particle.stress(), b = linear.stress();
    for (int c = 0; c < 6; ++c) worst = larger(worst, std::abs(a.s[c] - b.s[c]) / yield);
  }
  CAPTURE(linear.plastic(), worst);
  REQUIRE(linear.plastic() > 0.1);
  CHECK(worst < 1e-10);
  CHECK(particle.plastic() == Approx(linear.plastic()).epsilon(1e-11));
  CHECK(heat == Approx(linear_heat).epsilon(1e-11));
  CHECK(particle.energy() == Approx(linear.energy()).epsilon(1e-10));  // hardening stores nothing, as with von_mises
}

/// Newton's method from `x` without a bracket: the last two of 1000 iterates, or what is no number.
template <class Law>
Vec<2, double> plain_newton(const Law& law, double x, double before, double trial, double stiffness) {
  double last = x;
  for (int k = 0; k < 1000; ++k) {
    const FlowStress<double> flow = law.flow(before + x, x);
    last = x;
    x -= (flow.stress + stiffness * x - trial) / (flow.slope + stiffness);
    if (before + x < 0) return {{last, std::nan("")}};  // where the law has no stress
  }
  return {{last, x}};
}

JohnsonCookStep<double, double> copper_step(double dt) {
  return {JohnsonCook::Constants<double>(copper).hardening, room, dt};
}

}  // namespace

TEST_CASE("metals: the flow curves of power law, Voce, a table and Johnson-Cook") {
  check_flow_curve<VonMisesPower>(power, power_curve);
  check_flow_curve<VonMisesVoce>(voce, voce_curve);
  check_flow_curve<VonMisesTable>(table, table_curve);
  check_flow_curve<JohnsonCook>(copper, johnson_cook_curve(copper));
  check_flow_curve<JohnsonCook>(steel, johnson_cook_curve(steel));
}

TEST_CASE("Johnson-Cook: rates from 1e-3 to 1e6 a second, and temperatures") {
  // Each decade above the reference rate adds C ln 10 of the slow strength; slower flow adds nothing.
  for (const double temperature : {room, 400.0, 800.0, 1300.0})
    for (double rate = 1e-3; rate < 2e6; rate *= 10) {
      Particle<JohnsonCook> particle(copper);
      particle.warm_to(temperature);
      particle.dt = 1e-3 / rate;
      for (int k = 0; k < 50; ++k) particle.pull(1e-3);
      const double before = particle.plastic();
      particle.pull(1e-3);
      const double flowed = (particle.plastic() - before) / particle.dt;
      CAPTURE(temperature, rate, flowed);
      CHECK(flowed == Approx(rate).epsilon(0.05));
      CHECK(particle.stress()(0, 0) ==
            Approx(johnson_cook_curve(copper)(particle.plastic(), flowed, temperature)).epsilon(1e-10));
    }
}

TEST_CASE("Johnson-Cook: numbers of copper and 4340 steel, by a calculator") {
  const auto stress = [](const JohnsonCook::Parameters& p, double strain, double rate, double temperature) {
    const JohnsonCookStep<double, double> law(JohnsonCook::Constants<double>(p).hardening, temperature, 1e-3);
    return law.flow(strain, 1e-3 * rate).stress;
  };
  CHECK(stress(copper, 0.3, 1e3, 500) == Approx(283.97898337202827).epsilon(1e-12));
  CHECK(stress(copper, 0.05, 1e5, room) == Approx(264.4702004780207).epsilon(1e-12));
  CHECK(stress(steel, 0.1, 1e3, 600) == Approx(946.5605332552985).epsilon(1e-12));
  CHECK(stress(steel, 0.02, 1e-2, room) == Approx(976.4327215820942).epsilon(1e-12));
}

TEST_CASE("metals: the stress stays on the yield surface to 1e-10") {
  check_consistency<VonMisesPower>(power, power_curve, room, 1e-3);
  check_consistency<VonMisesVoce>(voce, voce_curve, room, 1e-3);
  check_consistency<VonMisesTable>(table, table_curve, room, 1e-3);
  for (const double temperature : {200.0, room, 900.0, 1350.0})
    for (const double dt : {1e-9, 1e-6, 1e-3, 1.0, 1e4})
      check_consistency<JohnsonCook>(copper, johnson_cook_curve(copper), temperature, dt);
}

TEST_CASE("metals: heat is the area under the flow curve, and hardening stores nothing") {
  check_heat<VonMisesPower>(power, [](double a) { return 100 * 0.02 / 1.2 * (std::pow(1 + a / 0.02, 1.2) - 1); });
  check_heat<VonMisesVoce>(voce, [](double a) { return 160 * a - 60 * 0.05 * (1 - std::exp(-a / 0.05)) + 20 * a * a; });
  check_heat<VonMisesTable>(table, [](double a) { return 2.5 + 13.2 + 180 * (a - 0.1) + 50 * (a - 0.1) * (a - 0.1); });
  check_heat<JohnsonCook>(copper, [](double a) { return 90 * a + 292 * std::pow(a, 1.31) / 1.31; });
}

TEST_CASE("metals: where the laws are linear they are von_mises") {
  check_is_linear<VonMisesPower>(VonMisesPower::Parameters{young, poisson, density, 100, 0.1, 1, 2}, 100, 1000);
  check_is_linear<VonMisesPower>(VonMisesPower::Parameters{young, poisson, density, 100, 0.1, 0, 2}, 100, 0);
  check_is_linear<VonMisesVoce>(VonMisesVoce::Parameters{young, poisson, density, 100, 0, 0.1, 700, 2}, 100, 700);
  check_is_linear<VonMisesTable>(
      VonMisesTable::Parameters{young, poisson, density, 100, 5, 3600, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2}, 100, 700);
  check_is_linear<VonMisesTable>(
      VonMisesTable::Parameters{young, poisson, density, 100, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2}, 100, 0);
  JohnsonCook::Parameters plain{young, poisson, density, 100, 500, 1, 0, 1, 1500, 1, room, 2};
  check_is_linear<JohnsonCook>(plain, 100, 500);
  plain.hardening_coefficient = 0;
  check_is_linear<JohnsonCook>(plain, 100, 0);
}

TEST_CASE("Johnson-Cook: where plain Newton cycles, and where it leaves the law, the bracket finds the root") {
  // Overstress below C sigma, in a step whose strain would be twice that of the reference rate: from rest the tangent knows
  // nothing of the rate and leads beyond the turn, and from there back.
  const double before = 0.1, stiffness = 3 * 46e3, dt = 1e-6;
  const double slow = 90 + 292 * std::pow(before, 0.31), trial = slow + 0.3;
  const Vec<2, double> cycle = plain_newton(copper_step(dt), 0, before, trial, stiffness);
  CAPTURE(cycle[0], cycle[1]);
  CHECK(std::abs(cycle[0] - cycle[1]) > 1e-6);  // of the 2e-6 that the step could flow
  // From a metal that has not flowed yet, started where all overstress is gone, Newton leads below no strain at all.
  const double first = 92;
  CHECK(std::isnan(plain_newton(copper_step(1e3), (first - 90) / stiffness, 0, first, stiffness)[1]));

  const auto check_root = [&](double start, double stress, double step) {
    const double x = plastic_increment(copper_step(step), start, stress, stiffness, step, true);
    const double left = johnson_cook_curve(copper)(start + x, x / step, room);
    CAPTURE(start, stress, step, x);
    CHECK(x > 0);
    CHECK(stress - stiffness * x == Approx(left).epsilon(1e-12));
  };
  check_root(before, trial, dt);
  check_root(0, first, 1e3);
  for (double step = 1e-12; step < 1e3; step *= 10)
    for (double excess = 1e-6; excess < 1e3; excess *= 10)
      for (const double start : {1e-6, 1e-2, 1.0, 10.0})
        check_root(start, (90 + 292 * std::pow(start, 0.31)) * (1 + excess), step);
}

TEST_CASE("Johnson-Cook: a step's plastic strain is the same in any units of stress") {
  for (const double unit : {1e-18, 1e-9, 1.0, 1e9}) {
    JohnsonCook::Parameters scaled = copper;
    scaled.yield_stress *= unit, scaled.hardening_coefficient *= unit;
    const double stiffness = 3 * 46e3, dt = 1e-3, before = 0.1, trial = 2 * (90 + 292 * std::pow(before, 0.31));
    const JohnsonCookStep<double, double> law(JohnsonCook::Constants<double>(scaled).hardening, room, dt);
    const double x = plastic_increment(law, before, unit * trial, unit * stiffness, dt, true);
    CAPTURE(unit, x);
    CHECK(trial - stiffness * x == Approx(johnson_cook_curve(copper)(before + x, x / dt, room)).epsilon(1e-12));
  }
  // Of a metal that is soft beside its strength the strain of one step is large.
  const double stiffness = 1, dt = 100, trial = 20 * 90;
  const double x = plastic_increment(copper_step(dt), 0.0, trial, stiffness, dt, true);
  CHECK(x > 100);
  CHECK(trial - stiffness * x == Approx(johnson_cook_curve(copper)(x, x / dt, room)).epsilon(1e-12));
}

TEST_CASE("Johnson-Cook: an overstress of next to nothing flows by what the tangent says") {
  const double before = 0.1, stiffness = 3 * 46e3, slow = 90 + 292 * std::pow(before, 0.31);
  const double tangent = stiffness + 292 * 0.31 * std::pow(before, 0.31 - 1);
  for (const double excess : {1e-11, 1e-9, 1e-7}) {
    const double over = excess * slow, trial = slow + over;
    const double x = plastic_increment(copper_step(1e3), before, trial, stiffness, 1e3, true);
    CHECK(x == Approx((trial - slow) / tangent).epsilon(4e-16 / excess + 1e-4));
  }
}

TEST_CASE(
    "Johnson-Cook: the yield stress is that of the paper at no rate, and the law has numbers where nothing flowed") {
  for (const double strain : {0.0, 1e-9, 0.3, 4.0})
    for (const double temperature : {room, 700.0}) {
      const JohnsonCookStep<double, double> law(JohnsonCook::Constants<double>(copper).hardening, temperature, 1e-3);
      CHECK(law.yield_stress(strain) == Approx(johnson_cook_curve(copper)(strain, 0, temperature)).epsilon(1e-12));
    }
  const JohnsonCookStep<float, float> single(JohnsonCook::Constants<float>(copper).hardening, static_cast<float>(room),
                                             1e-3F);
  const FlowStress<float> untouched = single.flow(0.0F, 0.0F);
  CHECK(untouched.stress == 90.0F);
  CHECK(std::isfinite(untouched.slope));
}

TEST_CASE("Johnson-Cook: a particle flows as it would by itself, whichever particles share its pack") {
  using L = Lanes<double>;
  alignas(lane_bytes) double before[L::width], trial[L::width], temperature[L::width];
  for (int lane = 0; lane < L::width; ++lane) {
    before[lane] = 0.02 * lane;
    temperature[lane] = room + 40 * lane;
    // From a strain of one decade of rates to one of ten.
    trial[lane] = (90 + 292 * std::pow(before[lane], 0.31)) * (lane == 0 ? 0.5 : 1 + std::pow(10, 1.5 * lane - 6));
  }
  const double stiffness = 3 * 46e3, dt = 1e-7;
  const JohnsonCookStep<double, L> law(JohnsonCook::Constants<double>(copper).hardening, L::load(temperature), dt);
  const L start = L::load(before), stress = L::load(trial);
  const L x = plastic_increment(law, start, stress, L(stiffness), dt, stress > law.yield_stress(start));
  for (int lane = 0; lane < L::width; ++lane) {
    CAPTURE(lane);
    const JohnsonCookStep<double, double> own(JohnsonCook::Constants<double>(copper).hardening, temperature[lane], dt);
    const bool yields = trial[lane] > own.yield_stress(before[lane]);
    CHECK((x[lane] > 0) == yields);
    CHECK(x[lane] == Approx(plastic_increment(own, before[lane], trial[lane], stiffness, dt, yields)).epsilon(1e-12));
  }
}

TEST_CASE("Johnson-Cook: dual numbers have the derivative of the root, one over stiffness and slope") {
  using X = Dual<double>;
  const double stiffness = 3 * 46e3;
  for (const double dt : {1e-6, 1e-2, 1e3})
    for (const double before : {0.0, 0.01, 1.0})
      for (const double excess : {1e-4, 0.1, 3.0}) {
        const double trial = (90 + 292 * std::pow(before, 0.31)) * (1 + excess);
        const JohnsonCookStep<double, double> plain = copper_step(dt);
        const JohnsonCookStep<double, X> law(JohnsonCook::Constants<double>(copper).hardening, X(room), dt);
        const double root = plastic_increment(plain, before, trial, stiffness, dt, true);
        const X x = plastic_increment(law, X(before), X(trial, 1), X(stiffness), dt, true);
        CAPTURE(dt, before, excess, root);
        CHECK(x.value == Approx(root).epsilon(1e-12));
        CHECK(x.derivative == Approx(1 / (stiffness + plain.flow(before + root, root).slope)).epsilon(1e-11));
      }
}

/// A law that counts how often it is asked.
struct Counted {
  const JohnsonCookStep<double, double>& law;
  int* asked;

  double yield_stress(double strain) const { return law.yield_stress(strain); }
  FlowStress<double> flow(double strain, double increment) const {
    ++*asked;
    return law.flow(strain, increment);
  }
};

TEST_CASE("Johnson-Cook: the increment is found by Newton's method and not by halving") {
  // Halving a bracket of a decade to rounding takes 50 rounds, Newton's method a handful beyond the decades of the rate.
  const double stiffness = 3 * 46e3;
  int steps = 0, asked = 0, most = 0;
  for (double dt = 1e-9; dt < 1e3; dt *= 10)
    for (double excess = 1e-5; excess < 10; excess *= 10)
      for (const double start : {0.0, 1e-6, 1e-2, 1.0}) {
        const JohnsonCookStep<double, double> law = copper_step(dt);
        int own = 0;
        const double trial = (90 + 292 * std::pow(start, 0.31)) * (1 + excess);
        plastic_increment(Counted{law, &own}, start, trial, stiffness, dt, true);
        asked += own, ++steps, most = larger(most, own);
      }
  CAPTURE(static_cast<double>(asked) / steps, most);
  CHECK(asked < 15 * steps);
  CHECK(most < 40);
}

TEST_CASE("metals: the slope of a law is the derivative of its stress by the plastic strain of the step") {
  // A wrong slope would not change results: it makes the iteration slow.
  const auto check = [](const auto& law) {
    for (const double before : {1e-3, 0.1, 2.0})
      for (const double increment : {1e-5, 1e-3, 0.1}) {
        const double h = 1e-3 * increment;
        const double difference = (law.flow(before + increment + h, increment + h).stress -
                                   law.flow(before + increment - h, increment - h).stress) /
                                  (2 * h);
        CAPTURE(before, increment);
        CHECK(law.flow(before + increment, increment).slope == Approx(difference).epsilon(1e-5));
      }
  };
  check(LinearHardening<double>{100, 30});
  check(VonMisesPower::Constants<double>(power).hardening);
  check(VonMisesVoce::Constants<double>(voce).hardening);
  check(VonMisesTable::Constants<double>(table).hardening);
  for (const double dt : {1e-7, 0.3, 1e5})  // no rate is the reference rate, where the law turns
    for (const double temperature : {room, 700.0})
      check(JohnsonCookStep<double, double>(JohnsonCook::Constants<double>(steel).hardening, temperature, dt));
}

template <class Metal, class Parameters>
void check_return(const Parameters& parameters, const FlowCurve& curve) {
  Particle<Metal> particle(parameters);
  particle.state.elastic_left_cauchy_green = {{1.02, 1 / 1.02, 1, 0, 0, 0}};
  particle.state.equivalent_plastic_strain = 0.03;
  REQUIRE(particle.equivalent_stress() > 1.1 * curve(0.03, 0, room));
  Metal::advance(particle.constants, Mat3{}, 0.0, particle.state);
  CHECK(particle.equivalent_stress() == Approx(curve(particle.plastic(), 0, room)).epsilon(1e-10));
}

TEST_CASE("metals: states beyond the yield surface return to it without strain or time") {
  check_return<VonMisesPower>(power, power_curve);
  check_return<VonMisesVoce>(voce, voce_curve);
  check_return<VonMisesTable>(table, table_curve);
}

/// A huge stretch in one step, volumes far from rest, steps of any length, a metal that has flowed by anything, in precision
/// T: the stress is the law's at the state that comes out, to the rounding of a step.
template <class T, class Metal, class Parameters>
void check_extremes(const Parameters& parameters, const FlowCurve& curve) {
  const typename Metal::template Constants<T> constants(parameters);
  for (const double dt : {1e-12, 1e-3, 1e9})
    for (const double flowed : {0.0, 1e-9, 1.0, 1e6})
      for (const double stretch : {1e-2, 0.9999, 1.5, 1e2})
        for (const double volume : {1e-6, 1.0, 1e6}) {
          typename Metal::template State<3, T> state{};
          state.elastic_left_cauchy_green = Sym<3, T>::identity();
          state.volume_ratio = T(volume), state.equivalent_plastic_strain = T(flowed);
          if constexpr (requires { state.temperature; }) state.temperature = T(room);
          const double side = 1 / std::sqrt(stretch);
          const double axes[3] = {stretch, side, side};
          Mat<3, T> L{};
          for (int i = 0; i < 3; ++i) L(i, i) = T((axes[i] - 1) / dt);
          const T heat = Metal::advance(constants, L, T(dt), state);
          const Sym<3, T> tau = Metal::kirchhoff_stress(constants, state);
          const double equivalent = std::sqrt(1.5 * static_cast<double>(squared_norm(deviator(tau))));
          const double pressure = std::abs(static_cast<double>(trace(tau)));
          const double gained = static_cast<double>(state.equivalent_plastic_strain) - flowed;
          // Strains of 1e6 swallow what one step adds: the rate is then known between none and that of the whole stretch.
          const double least = curve(flowed + gained, 0, room),
                       most = curve(flowed + gained, 2 * std::abs(std::log(stretch)) / dt, room);
          const double rounding = 16 * static_cast<double>(std::numeric_limits<T>::epsilon()),
                       trial = 1.5 * shear * std::max(stretch * stretch, 1 / stretch),
                       noise = rounding * (pressure + trial);  // the return takes the one from the other
          CAPTURE(dt, flowed, stretch, volume, equivalent, gained, least, most);
          CHECK(std::isfinite(static_cast<double>(Metal::stored_energy(constants, state))));
          CHECK(static_cast<double>(Metal::wave_speed(constants, state)) > 0);
          CHECK(static_cast<double>(heat) >= 0);
          CHECK(static_cast<double>(state.volume_ratio) == Approx(volume).epsilon(1e-3));
          CHECK(equivalent < most * (1 + 16 * rounding) + noise);
          if (gained > 0) CHECK(equivalent > least * (1 - 16 * rounding) - noise);
        }
}

TEST_CASE("metals: huge stretches, volumes, strains, and steps of any length") {
  check_extremes<double, VonMisesPower>(power, power_curve);
  check_extremes<float, VonMisesPower>(power, power_curve);
  check_extremes<double, VonMisesVoce>(voce, voce_curve);
  check_extremes<float, VonMisesVoce>(voce, voce_curve);
  check_extremes<double, VonMisesTable>(table, table_curve);
  check_extremes<float, VonMisesTable>(table, table_curve);
  check_extremes<double, JohnsonCook>(copper, johnson_cook_curve(copper));
  check_extremes<float, JohnsonCook>(copper, johnson_cook_curve(copper));
}

TEST_CASE("Johnson-Cook: molten metal has no strength, and cold metal no more than at room temperature") {
  for (const double temperature : {1356.0, 1e4}) {
    Particle<JohnsonCook> particle(copper);
    particle.dt = 1e-6;
    for (int k = 0; k < 50; ++k) particle.pull(1e-3);
    CHECK(particle.equivalent_stress() > 100);
    particle.warm_to(temperature);
    particle.advance({{0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01}});
    CHECK(particle.equivalent_stress() < 1e-9);
    CHECK(particle.stress()(0, 0) > 1000);  // the pressure is that of the volume
  }
  Particle<JohnsonCook> cold(copper), at_room(copper);
  cold.warm_to(4);
  for (int k = 0; k < 50; ++k) cold.pull(1e-3), at_room.pull(1e-3);
  CHECK(cold.stress()(0, 0) == at_room.stress()(0, 0));
}

TEST_CASE("a table of yield stresses passes through its points, and is refused where it turns back or softens") {
  VonMisesTable::Parameters six{young, poisson, density, 100, 0.01, 120, 0.02, 140, 0.05,
                                150,   0.1,     155,     0.2, 155,  0.4, 170,  2};
  const double strains[] = {0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 5},
               stresses[] = {100, 120, 140, 150, 155, 155, 170, 170};
  for (int k = 0; k < 8; ++k)
    CHECK(VonMisesTable::Constants<double>(six).hardening.yield_stress(strains[k]) ==
          Approx(stresses[k]).epsilon(1e-12));
  // Its slopes: 20 in 0.01, as much again, 10 in 0.03, 5 in 0.05, none, 15 in 0.2, and none beyond the last point.
  const double middles[] = {0.005, 0.015, 0.04, 0.07, 0.15, 0.3, 5}, slopes[] = {2000, 2000, 1e3 / 3, 100, 0, 75, 0};
  for (int k = 0; k < 7; ++k)
    CHECK(VonMisesTable::Constants<double>(six).hardening.flow(middles[k], 0.0).slope ==
          Approx(slopes[k]).epsilon(1e-12));
  const auto refused = [](const VonMisesTable::Parameters& p) {
    const mpm_refusal refusal = VonMisesTable::refusal(p, {3, 0});
    return refusal.parameter ? std::string(refusal.parameter) : "";
  };
  CHECK(refused(six).empty());
  CHECK(refused(table).empty());
  six.strain_3 = 0.02;
  CHECK(refused(six) == "strain_3");
  CHECK(VonMisesTable::refusal(six, {3, 0}).limit == 0.02);
  six.strain_3 = 0.015;
  CHECK(refused(six) == "strain_3");
  CHECK(VonMisesTable::refusal(six, {3, 0}).limit == 0.02);  // the strain before it, not its own
  six.strain_3 = 0.05, six.stress_5 = 154;
  CHECK(refused(six) == "stress_5");
  CHECK(VonMisesTable::refusal(six, {3, 0}).limit == 155);
  six.stress_5 = 155, six.stress_1 = 99;
  CHECK(refused(six) == "stress_1");
  six.strain_1 = 0;  // no points at all
  CHECK(refused(six).empty());
}

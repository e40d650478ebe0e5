// Fluids under imposed deformation against closed forms. The numbers of the equations of state are their formulae in 50
// digits, with energies by quadrature of the pressures.

#include <cmath>
#include <random>

#include "kernel/equation_of_state.hpp"
#include "materials/herschel_bulkley/herschel_bulkley.hpp"
#include "materials/inviscid_fluid/inviscid_fluid.hpp"
#include "materials/newtonian_fluid/newtonian_fluid.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using enum EquationOfState;
using Mat3 = Mat<3, double>;

NewtonianFluid::Parameters water(EquationOfState form, double modulus = 2.2e9) {
  NewtonianFluid::Parameters p{};
  p.bulk_modulus = modulus, p.equation_of_state = static_cast<double>(form);
  p.exponent = 7, p.heat_capacity_ratio = 1.4, p.hugoniot_slope = 1.489;
  p.density = 1000, p.cell_size = 0.01;
  return p;
}

/// The pressure at J, Pa.
double pressure_at(const NewtonianFluid::Parameters& p, double J) {
  const Barotropic<double> fluid(p);
  return fluid.kirchhoff_pressure(std::log(J)) / J;
}

struct Row {
  EquationOfState form;
  double J, pressure, energy, tangent;  ///< all three over K; the tangent is -J^2 dp/dJ
};
const Row rows[] = {
    {linear, 1.0e-6, 999999.0, 12.815511558, 1.0},
    {power, 1.0e-6, 1.42857142857e+41, 2.38095238095e+34, 1.0e+36},
    {tait, 1.0e-6, 6444.75997414, 576.072141778, 7.20900377421e-8},
    {mie_gruneisen, 1.0e-6, 812.019590934, 175.579305126, 1.9e-9},
    {ideal_gas, 1.0e-6, 179420458.679, 446.051149198, 251.188643151},
    {linear, 0.001, 999.0, 5.90875527898, 1.0},
    {power, 0.001, 1.42857142857e+20, 2.38095238095e+16, 1.0e+18},
    {tait, 0.001, 6373.14291397, 569.669665909, 0.0712889520578},
    {mie_gruneisen, 0.001, 810.121490934, 174.769045655, 0.0019},
    {ideal_gas, 0.001, 11319.9513747, 25.8023784368, 15.8489319246},
    {linear, 0.5, 1.0, 0.19314718056, 1.0},
    {power, 0.5, 18.1428571429, 1.42857142857, 64.0},
    {tait, 0.5, 23.9142659478, 2.09323537573, 67.1243454916},
    {mie_gruneisen, 0.5, 7.65928439306, 0.698816823942, 26.1479875219},
    {ideal_gas, 0.5, 1.17072558682, 0.213406983523, 1.31950791077},
    {linear, 0.8, 0.25, 0.0231435513142, 1.0},
    {power, 0.8, 0.538338797433, 0.0384451729911, 3.81469726562},
    {tait, 0.8, 0.747962563964, 0.0489878532184, 5.99454184494},
    {mie_gruneisen, 0.8, 0.405609712114, 0.0318244624372, 2.3988620194},
    {ideal_gas, 0.8, 0.261930423164, 0.0238608463273, 1.09336207394},
    {linear, 0.9, 0.111111111111, 0.00536051565783, 1.0},
    {power, 0.9, 0.15582165447, 0.00670658150378, 1.88167642316},
    {tait, 0.9, 0.184205945145, 0.00752801149592, 2.4789800399},
    {mie_gruneisen, 0.9, 0.138050765436, 0.00619019716246, 1.50947344344},
    {ideal_gas, 0.9, 0.113527683739, 0.00543728841184, 1.04304488151},
    {linear, 0.99, 0.010101010101, 5.03358535014e-5, 1.0},
    {power, 0.99, 0.0104123067345, 5.1363944525e-5, 1.06215728567},
    {tait, 0.99, 0.0105807338019, 5.19176018925e-5, 1.09609750782},
    {mie_gruneisen, 0.99, 0.0103045859172, 5.10095633377e-5, 1.04048345663},
    {ideal_gas, 0.99, 0.0101213751233, 5.04034301918e-5, 1.00402822592},
    {linear, 1.02, -0.0196078431373, 0.00019737270382, 1.0},
    {power, 1.02, -0.0184914030552, 0.000189794813957, 0.887971382186},
    {tait, 1.02, -0.0179207615899, 0.000185883913862, 0.831845633578},
    {mie_gruneisen, 1.02, -0.0196078431373, 0.00019737270382, 1.0},
    {ideal_gas, 1.02, -0.0195306457022, 0.000196853459485, 0.992110237937},
    {linear, 2.0, -0.5, 0.30685281944, 1.0},
    {power, 2.0, -0.141741071429, 0.119419642857, 0.015625},
    {tait, 2.0, -0.089398759898, 0.0814077508651, 5.54855481118e-5},
    {mie_gruneisen, 2.0, -0.5, 0.30685281944, 1.0},
    {ideal_gas, 2.0, -0.443622041695, 0.281889791527, 0.757858283255},
    {linear, 1000.0, -0.999, 992.092244721, 1.0},
    {power, 1000.0, -0.142857142857, 142.69047619, 1.0e-18},
    {tait, 1000.0, -0.0894, 89.30260764, 0.0},
    {mie_gruneisen, 1000.0, -0.999, 992.092244721, 1.0},
    {ideal_gas, 1000.0, -0.714240645904, 711.89838524, 0.063095734448},
    {linear, 1.0e+6, -0.999999, 999985.184489, 1.0},
    {power, 1.0e+6, -0.142857142857, 142856.97619, 1.0e-36},
    {tait, 1.0e+6, -0.0894, 89399.9026076, 0.0},
    {mie_gruneisen, 1.0e+6, -0.999999, 999985.184489, 1.0},
    {ideal_gas, 1.0e+6, -0.714285711442, 714283.221395, 0.00398107170553},
};

/// One particle driven by increments dt L.
struct Particle {
  NewtonianFluid::Constants<double> constants;
  NewtonianFluid::State<3, double> state{};
  double heat = 0;

  explicit Particle(const NewtonianFluid::Parameters& p) : constants(p) {}
  void advance(const Mat3& L, double dt) { heat += NewtonianFluid::advance(constants, L, dt, state); }
  Sym<3, double> stress() const { return NewtonianFluid::kirchhoff_stress(constants, state); }
  double energy() const { return NewtonianFluid::stored_energy(constants, state); }
  double J() const { return NewtonianFluid::volume_ratio(state); }
  double speed() const { return NewtonianFluid::wave_speed(constants, state); }
};

constexpr double mud_modulus = 1e4, yield_stress = 30;

HerschelBulkley::Parameters mud(double consistency, double index, double yield = yield_stress) {
  HerschelBulkley::Parameters p{};
  p.bulk_modulus = 1e6, p.equation_of_state = static_cast<double>(power);
  p.exponent = 7, p.heat_capacity_ratio = 1.4, p.hugoniot_slope = 1.489, p.density = 1000;
  p.shear_modulus = mud_modulus, p.yield_stress = yield, p.consistency = consistency, p.flow_index = index;
  return p;
}

/// One particle of mud in simple shear.
struct Mud {
  HerschelBulkley::Constants<double> constants;
  HerschelBulkley::State<3, double> state{Sym<3, double>::identity(), 0};
  double heat = 0, work = 0;

  explicit Mud(const HerschelBulkley::Parameters& p) : constants(p) {}
  double stress() const { return HerschelBulkley::kirchhoff_stress(constants, state)(0, 1); }
  double energy() const { return HerschelBulkley::stored_energy(constants, state); }
  /// Shears by `strain` within `time`, and adds up the work by the trapezoidal rule.
  void shear(double strain, double time, int steps) {
    for (int k = 0; k < steps; ++k) {
      const double before = stress();
      heat += HerschelBulkley::advance(constants, Mat3{{0, strain / time, 0, 0, 0, 0, 0, 0, 0}}, time / steps, state);
      work += 0.5 * (before + stress()) * strain / steps;
    }
  }
};

}  // namespace

TEST_CASE("fluids: pressure, energy and speed of sound are those of the formulae from J = 1e-6 to 1e6") {
  for (const Row& row : rows) {
    CAPTURE(static_cast<int>(row.form), row.J);
    const Barotropic<double> fluid(water(row.form, 1));
    const double l = std::log(row.J);
    CHECK(fluid.kirchhoff_pressure(l) / row.J == Approx(row.pressure).epsilon(1e-10));
    CHECK(fluid.energy(l) == Approx(row.energy).epsilon(1e-10));
    CHECK(fluid.tangent(l) == Approx(row.tangent).epsilon(1e-10));
    CHECK(fluid.wave_modulus(l) == Approx(std::max(row.tangent, 1e-12)).epsilon(1e-10));
  }
}

TEST_CASE("fluids: in single precision too, but for the power law crushed to where J^-n has no single precision") {
  for (const Row& row : rows) {
    CAPTURE(static_cast<int>(row.form), row.J);
    const Barotropic<float> fluid(water(row.form, 1));
    const float l = std::log(static_cast<float>(row.J)), J = std::exp(l);
    if (row.form == power && row.J < 1e-5) {
      CHECK(std::isinf(fluid.kirchhoff_pressure(l)));
      continue;
    }
    const double bound = row.form == power && row.J < 1e-2 ? 1e-4 : 1e-5;
    CHECK(fluid.kirchhoff_pressure(l) / J == Approx(row.pressure).epsilon(bound));
    CHECK(fluid.energy(l) == Approx(row.energy).epsilon(bound));
  }
}

TEST_CASE("fluids: the pressures of water at three compressions (Murnaghan, linear and Tait by hand)") {
  const double table[][4] = {{1.02, -4.068109e7, -4.313725e7, -3.942568e7},
                             {0.99, 2.290707e7, 2.222222e7, 2.327761e7},
                             {0.9, 3.428076e8, 2.444444e8, 4.052531e8},
                             {0.8, 1.184345e9, 5.5e8, 1.645518e9},
                             {0.5, 3.991429e10, 2.2e9, 5.261139e10}};
  for (const auto& [J, murnaghan, in_density, logarithmic] : table) {
    CHECK(pressure_at(water(power), J) == Approx(murnaghan).epsilon(1e-6));
    CHECK(pressure_at(water(linear), J) == Approx(in_density).epsilon(1e-6));
    CHECK(pressure_at(water(tait), J) == Approx(logarithmic).epsilon(1e-6));
  }
}

TEST_CASE("fluids: all have the bulk modulus K at J = 1, and a pressure of next to nothing to full precision") {
  for (EquationOfState form : {linear, power, tait, mie_gruneisen, stiffened_gas, ideal_gas})
    for (double change : {1e-3, 1e-6, 1e-12, -1e-12, -1e-6, -1e-3}) {
      CAPTURE(static_cast<int>(form), change);
      const Barotropic<double> fluid(water(form, 1));
      const Barotropic<float> single(water(form, 1));
      // p = -K (J - 1) (1 - a (J - 1)) with a = 7 at most
      const double l = std::log1p(change), near = 8 * std::abs(change) + 1e-14;
      CHECK(fluid.kirchhoff_pressure(l) == Approx(-change).epsilon(near));
      CHECK(fluid.energy(l) == Approx(0.5 * change * change).epsilon(near));
      CHECK(fluid.tangent(l) == Approx(1).epsilon(2 * near));
      CHECK(single.kirchhoff_pressure(static_cast<float>(l)) == Approx(-change).epsilon(near + 1e-6));
      CHECK(single.energy(static_cast<float>(l)) == Approx(0.5 * change * change).epsilon(near + 1e-6));
    }
}

TEST_CASE("fluids: power law and Tait are alike near J = 1, and Tait is the stiffer one down to J = 0.49") {
  const auto ratio = [](double J) { return pressure_at(water(tait), J) / pressure_at(water(power), J); };
  // To second order p = K (x + a x^2) with x = 1 - J, a = (n + 1)/2 and 1/(2 C).
  for (double x : {1e-3, 1e-4, -1e-3})
    CHECK(ratio(1 - x) - 1 == Approx((1 / (2 * 0.0894) - 4) * x).epsilon(20 * std::abs(x)));
  CHECK(ratio(0.9) > 1.1);
  const auto stiffness = [](EquationOfState form, double J) {
    return Barotropic<double>(water(form)).tangent(std::log(J));
  };
  CHECK(stiffness(tait, 0.5) > stiffness(power, 0.5));
  CHECK(stiffness(tait, 0.48) < stiffness(power, 0.48));
  CHECK(pressure_at(water(tait), 1e-9) == Approx(2.2e9 * 0.0894 * (std::exp(1 / 0.0894) - 1)));
}

TEST_CASE("fluids: the isentropes of gases are the power law of their ratio of heat capacities") {
  NewtonianFluid::Parameters murnaghan = water(power);
  murnaghan.exponent = 1.4;
  for (EquationOfState form : {stiffened_gas, ideal_gas})
    for (double J : {0.1, 0.9, 1.0, 3.0}) CHECK(pressure_at(water(form), J) == pressure_at(murnaghan, J));
  // K = g p0: halved in volume, air at 100 kPa has 2^1.4 times the pressure.
  CHECK(pressure_at(water(ideal_gas, 1.4e5), 0.5) + 1e5 == Approx(2.6390158e5));
}

TEST_CASE("fluids: a plate impact on the Hugoniot of Mie-Gruneisen (copper, c = 3940 m/s, s = 1.489)") {
  const double impacts[][3] = {
      {500, 9.627098e9, 9479.572}, {1000, 2.091629e10, 9997.033}, {2000, 4.848097e10, 10946.256}};
  for (const auto& [speed, pressure, density] : impacts)
    CHECK(pressure_at(water(mie_gruneisen, 8930 * 3940.0 * 3940), 8930 / density) == Approx(pressure).epsilon(1e-6));
}

TEST_CASE("fluids: beyond its largest compression Mie-Gruneisen goes on along its tangent") {
  const Barotropic<double> fluid(water(mie_gruneisen, 1));
  const double last = 0.9 / 1.489;  // 1 - J where 1 - s (1 - J) = 0.1
  const auto pressure = [&](double x) { return fluid.kirchhoff_pressure(std::log(1 - x)) / (1 - x); };
  CHECK(pressure(last) == Approx(last / 0.01).epsilon(1e-9));
  for (double beyond : {1e-6, 1e-3, 0.1, 0.3})
    CHECK(pressure(last + beyond) - pressure(last) == Approx(1.9 / 0.001 * beyond).epsilon(1e-6));
  CHECK(pressure(last) - pressure(last - 1e-6) == Approx(1.9 / 0.001 * 1e-6).epsilon(1e-4));
}

TEST_CASE("fluids: without tension there is neither pressure nor energy where J > 1") {
  for (EquationOfState form : {linear, power, tait, mie_gruneisen, ideal_gas}) {
    NewtonianFluid::Parameters p = water(form, 1);
    const Barotropic<double> whole(p);
    p.tension = 1;
    const Barotropic<double> parted(p);
    for (double J : {1.0, 1.001, 5.0, 1e6}) {
      CHECK(parted.kirchhoff_pressure(std::log(J)) == 0);
      CHECK(parted.energy(std::log(J)) == 0);
      CHECK(parted.wave_modulus(std::log(J)) == 1);
    }
    for (double J : {1e-3, 0.9, 0.999}) {
      CHECK(parted.kirchhoff_pressure(std::log(J)) == whole.kirchhoff_pressure(std::log(J)));
      CHECK(parted.energy(std::log(J)) == whole.energy(std::log(J)));
    }
  }
}

TEST_CASE("fluids: the change of volume of a step is det(I + dt L) - 1, in space, in the plane and around an axis") {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> entry(-1, 1);
  const double dt = 0.3;
  for (int sample = 0; sample < 20; ++sample) {
    Mat3 L;
    for (double& e : L.m) e = entry(random);
    const auto f = [&](int i, int j) { return (i == j ? 1 : 0) + dt * L(i, j); };
    const double plane = f(0, 0) * f(1, 1) - f(0, 1) * f(1, 0);
    const double space = f(0, 0) * (f(1, 1) * f(2, 2) - f(1, 2) * f(2, 1)) -
                         f(0, 1) * (f(1, 0) * f(2, 2) - f(1, 2) * f(2, 0)) +
                         f(0, 2) * (f(1, 0) * f(2, 1) - f(1, 1) * f(2, 0));
    const Mat<2, double> flat{{L(0, 0), L(0, 1), L(1, 0), L(1, 1)}};
    CHECK(volume_change(L, dt) == Approx(space - 1).margin(1e-14));
    CHECK(volume_change(flat, dt) == Approx(plane - 1).margin(1e-14));
    CHECK(volume_change(Deformation<2, double>{flat, L(2, 2)}, dt) == Approx(plane * f(2, 2) - 1).margin(1e-14));
  }
}

TEST_CASE("fluids: exponentials and logarithms of small changes are those of the library to a few roundings") {
  for (int k = -400; k <= 400; ++k) {
    const double x = 0.00123 * k;
    const long double change = std::expm1(static_cast<long double>(x));
    CHECK(exponential_change(x) == Approx(static_cast<double>(change)).epsilon(1e-15));
    CHECK(exponential_excess(x) == Approx(static_cast<double>(change - static_cast<long double>(x))).epsilon(1e-15));
  }
  for (const double x : {-0.9, -1e-3, 1e-9, 0.7, 33.3, 0x1p20 - 0x1p-33})  // of the last the sum with 1 rounds
    CHECK(log_of_change(x) == Approx(std::log1p(x)).epsilon(1e-15));
}

TEST_CASE("newtonian_fluid: in simple shear the stress is mu times the rate, and the heat tau : D") {
  NewtonianFluid::Parameters p = water(linear);
  p.viscosity = 3;
  Particle fluid(p);
  const double rate = 20, dt = 1e-6;
  for (int k = 0; k < 500; ++k) fluid.advance(Mat3{{0, rate, 0, 0, 0, 0, 0, 0, 0}}, dt);
  const Sym<3, double> tau = fluid.stress();
  CHECK(fluid.J() == 1);
  CHECK(tau(0, 1) == Approx(3 * rate).epsilon(1e-12));
  CHECK(std::abs(tau(0, 2)) + std::abs(tau(1, 2)) == 0);
  for (int i = 0; i < 3; ++i) CHECK(std::abs(tau(i, i)) < 2 * rate * dt * 3 * rate);
  CHECK(fluid.heat == Approx(3 * rate * rate * 500 * dt).epsilon(1e-4));
  CHECK(fluid.energy() == 0);
}

TEST_CASE("newtonian_fluid: in any flow the stress is -p J I + 2 mu J dev D + zeta J tr D I") {
  NewtonianFluid::Parameters p = water(power, 1e4);
  p.viscosity = 7, p.bulk_viscosity = 2;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> entry(-1, 1);
  for (int sample = 0; sample < 20; ++sample) {
    Particle fluid(p);
    Mat3 L;
    for (double& e : L.m) e = entry(random);
    const double dt = 1e-7, expansion = L(0, 0) + L(1, 1) + L(2, 2);
    fluid.state.log_volume_ratio = std::log(0.8);
    fluid.advance(L, dt);
    double power = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double D = 0.5 * (L(i, j) + L(j, i)), isotropic = i == j ? 2 * expansion : 0;
        const double viscous = 0.8 * (14 * (D - (i == j ? expansion / 3 : 0)) + isotropic);
        const double pressure = i == j ? 0.8 * 1e4 / 7 * (std::pow(0.8, -7) - 1) : 0;
        CHECK(std::abs(fluid.stress()(i, j) - (viscous - pressure)) < 0.01);  // J and D change by 1e-7 of 1e4 and 1e2
        power += viscous * D;
      }
    CHECK(fluid.heat / dt == Approx(power).epsilon(1e-5));
  }
}

TEST_CASE("newtonian_fluid: a rigid turn in one step strains nothing, and a turned frame turns the stress") {
  NewtonianFluid::Parameters p = water(linear, 1e4);
  p.viscosity = 5, p.bulk_viscosity = 1;
  Particle fluid(p);
  const double c = std::cos(1.0), s = std::sin(1.0);
  fluid.advance(Mat3{{c - 1, -s, 0, s, c - 1, 0, 0, 0, 0}}, 1);
  for (double e : fluid.stress().s) CHECK(std::abs(e) < 1e-11);
  CHECK(std::abs(fluid.heat) < 1e-14);
}

TEST_CASE("newtonian_fluid: the volume that is kept is the product of the steps', to rounding in a million of them") {
  Particle fluid(water(linear));
  for (int k = 0; k < 500000; ++k) {
    fluid.advance(Mat3{{1e-9, 0, 0, 0, 0, 0, 0, 0, 0}}, 1);
    fluid.advance(Mat3{{0, 0, 0, 0, 1e-9, 0, 0, 0, 0}}, 1);
  }
  // Half an ulp of 1e-3 in each of a million sums; of J kept itself it would be a thousand times as much.
  CHECK(fluid.state.log_volume_ratio == Approx(1e6 * std::log1p(1e-9)).epsilon(1.1e-10));
  // Increments that J in single precision would not feel at all.
  const NewtonianFluid::Constants<float> single(water(linear));
  NewtonianFluid::State<2, float> drop{};
  for (int k = 0; k < 10000; ++k) NewtonianFluid::advance(single, Mat<2, float>{{-1e-8f, 0, 0, 0}}, 1.0f, drop);
  CHECK(NewtonianFluid::kirchhoff_stress(single, drop).s[0] == Approx(-2.2e9 * 1e-4).epsilon(1e-3));
}

TEST_CASE("newtonian_fluid: compressed by a closed loop it gives back what it took") {
  for (EquationOfState form : {linear, power, tait, mie_gruneisen, ideal_gas}) {
    Particle fluid(water(form, 1));
    const int steps = 2000;
    double work = 0;
    for (double from : {1.0, 0.3}) {
      const double to = 1.3 - from;
      for (int k = 0; k < steps; ++k) {
        const double a = from + (to - from) * k / steps, b = from + (to - from) * (k + 1) / steps;
        const double before = fluid.stress()(0, 0) / a;
        fluid.advance(Mat3{{b / a - 1, 0, 0, 0, 0, 0, 0, 0, 0}}, 1);
        work += 0.5 * (before + fluid.stress()(0, 0) / b) * (b - a);
      }
      if (to < 1) CHECK(work == Approx(fluid.energy()).epsilon(1e-4));
    }
    CHECK(std::abs(work) < 1e-12);
    CHECK(std::abs(fluid.energy()) < 1e-12);
    CHECK(fluid.heat == 0);
  }
}

TEST_CASE("newtonian_fluid: sound at rest, and the step that viscosity leaves") {
  NewtonianFluid::Parameters p = water(power);
  CHECK(Particle(p).speed() == Approx(std::sqrt(2.2e9 / 1000)).epsilon(1e-12));
  p.viscosity = 1e5, p.bulk_viscosity = 1e4;  // nu = 143.3 m^2/s
  // A wave of w = k c that is damped at the rate nu k^2 of the velocity one step before is at its limit where nu k^2 dt +
  // (w dt)^2/2 = 2. Of waves alone, k = 2 sqrt(3)/h, that is dt = h/(sqrt(3) c).
  const double nu = (4e5 / 3 + 1e4) / 1000, k = 2 * std::sqrt(3.0) / 0.01,
               dt = 0.01 / (std::sqrt(3.0) * Particle(p).speed());
  CHECK(nu * k * k * dt + 2.2e6 * k * k * dt * dt / 2 == Approx(2).epsilon(1e-12));
  // At half the density nu is twice as much, and of the power law K J^(1 - n)/rho0 is the squared speed.
  Particle thin(p);
  thin.state.log_volume_ratio = std::log(2.0);
  const double thin_dt = 0.01 / (std::sqrt(3.0) * thin.speed());
  CHECK(2 * nu * k * k * thin_dt + 2.2e6 / 64 * k * k * thin_dt * thin_dt / 2 == Approx(2).epsilon(1e-12));
  p.cell_size = 1e9;
  CHECK(Particle(p).speed() == Approx(std::sqrt(2.2e9 / 1000)).epsilon(1e-6));
}

TEST_CASE("newtonian_fluid: in plane strain z is held, around an axis it flows") {
  NewtonianFluid::Parameters p = water(linear, 1e4);
  p.viscosity = 6;
  const NewtonianFluid::Constants<double> c(p);
  NewtonianFluid::State<2, double> flat{}, ring{};
  NewtonianFluid::advance(c, Mat<2, double>{{1, 0, 0, 0}}, 1e-9, flat);
  CHECK(flat.viscous_stress.s[0] == Approx(12 * 2.0 / 3));
  CHECK(flat.viscous_stress.s[2] == Approx(-12 / 3.0));
  NewtonianFluid::advance(c, Deformation<2, double>{{{0, 0, 0, 0}}, 1}, 1e-9, ring);
  CHECK(ring.viscous_stress.s[2] == Approx(12 * 2.0 / 3));
  CHECK(ring.viscous_stress.s[0] == Approx(-12 / 3.0));
  CHECK(ring.log_volume_ratio == Approx(1e-9));
}

TEST_CASE("inviscid_fluid: pressure, energy and speed of sound are those of the formulae from J = 1e-6 to 1e6") {
  const InviscidFluid::Constants<double> c({1, 4, 0});
  const InviscidFluid::Constants<float> single({1, 4, 0});
  for (const Row& row : rows) {
    if (row.form != linear) continue;
    CAPTURE(row.J);
    const InviscidFluid::State<3, double> state{row.J - 1};
    const Sym<3, double> tau = InviscidFluid::kirchhoff_stress(c, state);
    for (int i = 0; i < 3; ++i) CHECK(tau(i, i) == Approx(-row.J * row.pressure).epsilon(1e-9));
    CHECK(std::abs(tau(0, 1)) + std::abs(tau(0, 2)) + std::abs(tau(1, 2)) == 0);
    CHECK(InviscidFluid::stored_energy(c, state) == Approx(row.energy).epsilon(1e-9));
    CHECK(InviscidFluid::wave_speed(c, state) == 0.5);
    CHECK(InviscidFluid::volume_ratio(state) == Approx(row.J).epsilon(1e-9));
    // In single precision J - 1 has an error of 3e-8, which is 3 % of J = 1e-6 and of its logarithm 1/500.
    const InviscidFluid::State<2, float> rounded{static_cast<float>(row.J - 1)};
    CHECK(InviscidFluid::kirchhoff_stress(single, rounded).s[0] == Approx(-row.J * row.pressure).epsilon(1e-6));
    CHECK(InviscidFluid::stored_energy(single, rounded) == Approx(row.energy).epsilon(row.J < 0.1 ? 5e-3 : 1e-5));
    CHECK(InviscidFluid::volume_ratio(rounded) == Approx(row.J).epsilon(row.J < 0.1 ? 0.04 : 1e-5));
  }
}

TEST_CASE("inviscid_fluid: the volume that is kept is the product of the steps', and shear meets no resistance") {
  const InviscidFluid::Constants<double> c({2.2e9, 1000, 0});
  InviscidFluid::State<3, double> fluid{};
  double heat = 0;
  for (int k = 0; k < 500000; ++k) {
    heat += InviscidFluid::advance(c, Mat3{{1e-9, 0, 0, 0, 0, 0, 0, 0, 0}}, 1.0, fluid);
    heat += InviscidFluid::advance(c, Mat3{{0, 0, 0, 0, 1e-9, 0, 0, 0, 0}}, 1.0, fluid);
  }
  CHECK(fluid.volume_change == Approx(std::expm1(1e6 * std::log1p(1e-9))).epsilon(1.1e-10));
  CHECK(heat == 0);
  InviscidFluid::State<3, double> sheared{};
  InviscidFluid::advance(c, Mat3{{0, 40, 0, 0, 0, 0, 0, 7, 0}}, 0.5, sheared);
  CHECK(sheared.volume_change == 0);
  // Increments that J in single precision would not feel at all.
  const InviscidFluid::Constants<float> single({2.2e9, 1000, 0});
  InviscidFluid::State<2, float> drop{};
  for (int k = 0; k < 10000; ++k) InviscidFluid::advance(single, Mat<2, float>{{-1e-8f, 0, 0, 0}}, 1.0f, drop);
  CHECK(InviscidFluid::kirchhoff_stress(single, drop).s[0] == Approx(-2.2e9 * 1e-4).epsilon(1e-3));
}

TEST_CASE("inviscid_fluid: compressed by a closed loop it gives back what it took") {
  const InviscidFluid::Constants<double> c({1, 1, 0});
  InviscidFluid::State<3, double> fluid{};
  const int steps = 2000;
  double work = 0;
  for (double from : {1.0, 0.3}) {
    const double to = 1.3 - from;
    for (int k = 0; k < steps; ++k) {
      const double a = from + (to - from) * k / steps, b = from + (to - from) * (k + 1) / steps;
      const double before = InviscidFluid::kirchhoff_stress(c, fluid)(0, 0) / a;
      InviscidFluid::advance(c, Mat3{{b / a - 1, 0, 0, 0, 0, 0, 0, 0, 0}}, 1.0, fluid);
      work += 0.5 * (before + InviscidFluid::kirchhoff_stress(c, fluid)(0, 0) / b) * (b - a);
    }
    if (to < 1) CHECK(work == Approx(0.3 - 1 - std::log(0.3)).epsilon(1e-4));  // minus the integral of p
  }
  CHECK(std::abs(work) < 1e-12);
  CHECK(std::abs(InviscidFluid::stored_energy(c, fluid)) < 1e-12);
}

TEST_CASE("inviscid_fluid: without tension there is neither pressure nor energy where J > 1") {
  const InviscidFluid::Constants<double> whole({3, 1, 0}), parted({3, 1, 1});
  for (double J : {1.0, 1.001, 5.0, 1e6}) {
    const InviscidFluid::State<2, double> state{J - 1};
    CHECK(InviscidFluid::kirchhoff_stress(parted, state).s[0] == 0);
    CHECK(InviscidFluid::stored_energy(parted, state) == 0);
    CHECK(InviscidFluid::kirchhoff_stress(whole, state).s[0] == Approx(3 * (J - 1)));
  }
  const InviscidFluid::State<2, double> pressed{-0.25};
  for (int i = 0; i < 3; ++i) CHECK(InviscidFluid::kirchhoff_stress(parted, pressed).s[i] == -0.75);
}

TEST_CASE("inviscid_fluid: in plane strain z is held, around an axis it flows") {
  const InviscidFluid::Constants<double> c({1, 1, 0});
  InviscidFluid::State<2, double> flat{}, ring{};
  InviscidFluid::advance(c, Mat<2, double>{{0.25, 0, 0, 0}}, 1.0, flat);
  InviscidFluid::advance(c, Deformation<2, double>{{{0.25, 0, 0, 0}}, 1}, 0.5, ring);
  CHECK(flat.volume_change == 0.25);
  CHECK(ring.volume_change == Approx(1.125 * 1.5 - 1));
}

TEST_CASE("herschel_bulkley: the stress of steady shear is tau_y + k rate^n, and all its work is heat") {
  for (double index : {0.1, 0.4, 1.0, 1.7, 2.0})
    for (double rate : {0.01, 1.0, 7.0}) {
      CAPTURE(index, rate);
      Mud flow(mud(5, index));
      // To twenty times the elastic strain, which is stress over G; normal stresses are of its square.
      const double expected = 30 + 5 * std::pow(rate, index), normal = expected / mud_modulus;
      flow.shear(20 * normal, 20 * normal / rate, 2000);
      CHECK(flow.stress() == Approx(expected).epsilon(1e-6 + 2 * normal * normal));
      const double stored = flow.energy(), heat = flow.heat;
      flow.shear(0.01, 0.01 / rate, 100);
      CHECK(flow.heat - heat == Approx(expected * 0.01).epsilon(1e-5 + 3 * normal));
      CHECK(flow.energy() == Approx(stored).epsilon(1e-4));
    }
}

TEST_CASE("herschel_bulkley: up to the yield stress it is an elastic solid that gives back all work, beyond it flows") {
  for (double index : {0.5, 1.0}) {
    Mud paste(mud(5, index));
    const double yields = yield_stress / mud_modulus;
    paste.shear(0.999 * yields, 1, 300);
    CHECK(paste.stress() == Approx(0.999 * yield_stress).epsilon(1e-5));
    CHECK(paste.energy() == Approx(0.5 * mud_modulus * std::pow(0.999 * yields, 2)).epsilon(1e-5));
    paste.shear(0, 1e9, 1);  // nothing creeps in thirty years
    CHECK(paste.stress() == Approx(0.999 * yield_stress).epsilon(1e-5));
    CHECK(paste.heat == 0);
    paste.shear(-0.999 * yields, 1, 300);
    CHECK(std::abs(paste.work) < 1e-9);
    CHECK(std::abs(paste.energy()) < 1e-9);
    paste.shear(1.01 * yields, 1, 300);
    CHECK(paste.heat > 0);
  }
}

TEST_CASE("herschel_bulkley: below the yield stress its deviator is that of the split Neo-Hookean solid") {
  Mud paste(mud(5, 1, 1e9));
  HerschelBulkley::advance(paste.constants, Mat3{{0.1, 0, 0, 0, 0, 0, 0, 0, 0}}, 1.0, paste.state);
  HerschelBulkley::advance(paste.constants, Mat3{{0, 0, 0, 0, 0.2, 0, 0, 0, 0}}, 1.0, paste.state);
  const double factor = mud_modulus * std::pow(1.1 * 1.2, -2.0 / 3);
  const Sym<3, double> tau = HerschelBulkley::kirchhoff_stress(paste.constants, paste.state);
  CHECK(tau(0, 0) - tau(2, 2) == Approx(factor * (1.1 * 1.1 - 1)).epsilon(1e-12));
  CHECK(tau(1, 1) - tau(2, 2) == Approx(factor * (1.2 * 1.2 - 1)).epsilon(1e-12));
  for (int k = 3; k < 6; ++k) CHECK(tau.s[k] == 0);  // pressure acts on the normal ones alone
}

TEST_CASE("herschel_bulkley: a Bingham fluid that is held goes back to its yield stress with the time k/G") {
  Mud paste(mud(200, 1));
  paste.shear(0.01, 1e-9, 1);  // at once: elastic, 100 Pa
  const double before = paste.stress();
  CHECK(before == Approx(100).epsilon(1e-3));
  paste.shear(0, 0.02, 20000);  // k/G = 0.02 s
  CHECK(paste.stress() == Approx(30 + (before - 30) * std::exp(-1)).epsilon(1e-4));
}

TEST_CASE("herschel_bulkley: one implicit step solves k g^n + a g = overstress, from a crawl to a crash") {
  for (double index : {0.1, 0.3, 0.9, 1.0, 1.5, 3.0})
    for (double consistency : {0.0, 1e-6, 1.0, 1e6})
      for (double elastic : {1e-9, 1e-3, 1.0, 1e6})
        for (double overstress : {1e-9, 1.0, 1e6}) {
          CAPTURE(index, consistency, elastic, overstress);
          const HerschelBulkley::Constants<double> c(mud(consistency, index));
          const double rate = HerschelBulkley::flow_rate(c, overstress, elastic);
          CHECK(consistency * std::pow(rate, index) + elastic * rate == Approx(overstress).epsilon(1e-11));
        }
}

// Simo & Hughes (1998), box 9.1: the trial stress t falls by mu tr(b)/3 times the flow, here g dt, and g is the
// overstress over k.
TEST_CASE("herschel_bulkley: one large step of a Bingham fluid ends on its line, with the elastic part of the trial") {
  for (const double strain : {0.5, 2.0}) {
    const double dt = 1e-3, k = 20;
    Mud paste(mud(k, 1));
    paste.shear(strain, dt, 1);
    // b = f f^T of simple shear: dev b : dev b = |b|^2 - (tr b)^2/3.
    const double square = strain * strain, of_trace = 3 + square;
    const double norm = (1 + square) * (1 + square) + 2 * square + 2 - of_trace * of_trace / 3;
    const double trial = mud_modulus * std::sqrt(norm / 2), elastic = mud_modulus * dt * of_trace / 3;
    const double expected = (trial + elastic / k * yield_stress) / (1 + elastic / k);
    const Sym<3, double> tau = HerschelBulkley::kirchhoff_stress(paste.constants, paste.state);
    CHECK(std::sqrt(squared_norm(deviator(tau)) / 2) == Approx(expected).epsilon(1e-12));
    // The heat is 1 - share times the derivative by the share of the elastic energy 3/2 G (t - 1), det(share dev b + t) = 1.
    const double share = expected / trial;
    const auto stored = [&](double scale) {
      double low = 0, high = 10;
      for (int k = 0; k < 60; ++k) {
        const double t = 0.5 * (low + high), xx = scale * (1 + square - of_trace / 3) + t, xy = scale * strain,
                     rest = scale * (1 - of_trace / 3) + t;
        (rest > 0 && (xx * rest - xy * xy) * rest > 1 ? high : low) = t;
      }
      return 1.5 * mud_modulus * (low - 1);
    };
    const double h = 1e-4, slope = (stored(share + h) - stored(share - h)) / (2 * h);
    CHECK(paste.heat == Approx((1 - share) * slope).epsilon(1e-6));
  }
}

// From another start the six steps leave a few parts in 10^12 here.
TEST_CASE("herschel_bulkley: six steps of Newton's method solve the hardest of these equations to rounding") {
  const double rows[][3] = {{1.503439e-3, 1.522998e-8, 6.737947e-3}, {12.18249, 1.522998e-8, 148.4132}};
  for (const auto& [consistency, elastic, overstress] : rows) {
    const HerschelBulkley::Constants<double> c(mud(consistency, 0.1));
    const double rate = HerschelBulkley::flow_rate(c, overstress, elastic);
    CHECK(consistency * std::pow(rate, 0.1) + elastic * rate == Approx(overstress).epsilon(1e-13));
  }
}

TEST_CASE("herschel_bulkley: work is stored energy and heat, to the order of the step") {
  for (double index : {0.4, 1.0, 2.0}) {
    double error[2];
    for (int refined : {0, 1}) {
      Mud paste(mud(50, index));
      paste.shear(0.02, 0.01, refined ? 4000 : 1000);
      error[refined] = std::abs(paste.work - paste.energy() - paste.heat) / paste.work;
    }
    CHECK(error[1] < 2e-3);
    CHECK(error[1] < 0.4 * error[0]);
  }
}

TEST_CASE("herschel_bulkley: the pressure is that of the equation of state, whatever flows") {
  Mud paste(mud(5, 1));
  for (int k = 0; k < 100; ++k)
    HerschelBulkley::advance(paste.constants, Mat3{{-1e-3, 0.02, 0, 0, 0, 0, 0, 0, 0}}, 1.0, paste.state);
  const double J = std::pow(1 - 1e-3, 100);
  CHECK(HerschelBulkley::volume_ratio(paste.state) == Approx(J).epsilon(1e-12));
  CHECK(-trace(HerschelBulkley::kirchhoff_stress(paste.constants, paste.state)) / 3 / J ==
        Approx(1e6 / 7 * (std::pow(J, -7) - 1)).epsilon(1e-9));
}

TEST_CASE("herschel_bulkley: compression alone stores the energy of the equation of state") {
  Mud paste(mud(5, 1));
  paste.state.log_volume_ratio = std::log(0.8);
  // The integral of K/7 (J^-7 - 1).
  CHECK(paste.energy() == Approx(1e6 / 7 * ((std::pow(0.8, -6) - 1) / 6 + 0.8 - 1)).epsilon(1e-12));
}

TEST_CASE("herschel_bulkley: the wave at rest is that of K + 4/3 G, and crushed to J = 1e-6 all is finite") {
  Mud paste(mud(5, 0.5));
  const double speed = HerschelBulkley::wave_speed(paste.constants, paste.state);
  CHECK(speed * speed * 1000 == Approx(1e6 + 4e4 / 3).epsilon(1e-12));
  for (int k = 0; k < 200; ++k) {
    const double f = std::pow(1e-6, 1.0 / 200) - 1;
    paste.heat += HerschelBulkley::advance(paste.constants, Mat3{{f, 0, 0, 0, 0, 0, 0, 0, 0}}, 1.0, paste.state);
  }
  CHECK(HerschelBulkley::volume_ratio(paste.state) == Approx(1e-6).epsilon(1e-11));
  const Sym<3, double> tau = HerschelBulkley::kirchhoff_stress(paste.constants, paste.state);
  for (double e : tau.s) CHECK(std::isfinite(e));
  CHECK((paste.heat > 0 && std::isfinite(paste.heat)));
}

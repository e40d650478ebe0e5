// Linear corotated solid under imposed deformation, in closed form. E = 1000, nu = 0.3.

#include <cmath>
#include <random>

#include "kernel/lanes.hpp"
#include "materials/corotated/corotated.hpp"
#include "materials/fixed_corotated/fixed_corotated.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;

constexpr double young = 1000, poisson = 0.3, density = 1000;
constexpr double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
const Corotated::Constants<double> constants({young, poisson, density});

template <int D>
Sym<D, double> kirchhoff(const Mat<D, double>& F) {
  return Corotated::kirchhoff_stress(constants, Corotated::State<D, double>{F});
}
template <int D>
double energy(const Mat<D, double>& F) {
  return Corotated::stored_energy(constants, Corotated::State<D, double>{F});
}
template <int D>
double wave_modulus(const Mat<D, double>& F) {
  const double speed = Corotated::wave_speed(constants, Corotated::State<D, double>{F});
  return density * speed * speed;
}
Mat3 diagonal(double x, double y, double z) {
  return {{x, 0, 0, 0, y, 0, 0, 0, z}};
}

/// The second derivative d2 psi/ds2 along F + s a (x) F^T n by central differences, which is rho0 c^2.
double second_derivative(const Mat3& F, const Vec<3, double>& a, const Vec<3, double>& n) {
  constexpr double h = 1e-4;
  const auto at = [&](double s) {
    Mat3 f = Mat3::identity();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) f(i, j) += s * a[i] * n[j];
    return energy(f * F);
  };
  return (at(h) - 2 * at(0) + at(-h)) / (h * h);
}

}  // namespace

TEST_CASE("corotated: given stretches have principal first Piola stresses 2 mu (s_i - 1) + lambda sum (s_j - 1)") {
  const double rows[][3] = {{0.5, 1, 1}, {2, 0.5, 1}, {1.5, 0.5, 1}, {3, 4, 0.2}, {0.1, 0.2, 0.3}, {1e-3, 50, 1}};
  for (const auto& s : rows) {
    const double trace = s[0] + s[1] + s[2] - 3;
    const Sym<3, double> tau = kirchhoff(diagonal(s[0], s[1], s[2]));
    double stored = lambda / 2 * trace * trace;
    for (int i = 0; i < 3; ++i) {
      CAPTURE(s[i]);
      CHECK(tau.s[i] == Approx((2 * mu * (s[i] - 1) + lambda * trace) * s[i]).epsilon(1e-11).margin(1e-10));
      CHECK(std::abs(tau.s[3 + i]) < 1e-8);
      stored += mu * (s[i] - 1) * (s[i] - 1);
    }
    CHECK(energy(diagonal(s[0], s[1], s[2])) == Approx(stored).epsilon(1e-11));
  }
  // Stretches of 3/2, 1/2 and 1 lose a quarter of the volume and feel no volumetric stress.
  CHECK(kirchhoff(diagonal(1.5, 0.5, 1))(2, 2) == Approx(0).margin(1e-10));
  CHECK(std::abs(FixedCorotated::kirchhoff_stress(FixedCorotated::Constants<double>({young, poisson, density}),
                                                  FixedCorotated::State<3, double>{diagonal(1.5, 0.5, 1)})(2, 2)) >
        0.1 * lambda);
}

TEST_CASE(
    "corotated: with free sides stress is that of Hooke's law, P = E (s - 1), and the sides s - 1 = -nu (s - 1)") {
  for (double s : {0.2, 0.9, 1.1, 2.0, 3.0}) {
    CAPTURE(s);
    const double side = 1 - poisson * (s - 1);
    const Sym<3, double> tau = kirchhoff(diagonal(side, side, s));
    CHECK(tau(2, 2) == Approx(young * (s - 1) * s).epsilon(1e-11));
    CHECK(std::abs(tau(0, 0)) < 1e-9);
    CHECK(std::abs(tau(1, 1)) < 1e-9);
  }
}

TEST_CASE("corotated: simple shear in closed form, in space and in plane strain") {
  for (double gamma : {1e-3, 0.1, 0.5, 2.0, 10.0}) {
    CAPTURE(gamma);
    // R turns by atan(gamma/2), and the stretches in the plane add up to sqrt(4 + gamma^2).
    const double length = std::sqrt(4 + gamma * gamma), c = 2 / length, s = gamma / length;
    const double pull = lambda * (length - 2);
    const double xx = 2 * mu * (1 + gamma * gamma - c - s * gamma) + pull * (c + s * gamma);
    const double xy = 2 * mu * (gamma - s) + pull * s, yy = 2 * mu * (1 - c) + pull * c;
    const auto close = [&](double value) { return Approx(value).epsilon(1e-10).margin(1e-11 * mu); };
    const Sym<3, double> tau = kirchhoff(Mat3{{1, gamma, 0, 0, 1, 0, 0, 0, 1}});
    CHECK(tau(0, 0) == close(xx));
    CHECK(tau(0, 1) == close(xy));
    CHECK(tau(1, 1) == close(yy));
    CHECK(tau(2, 2) == close(pull));
    const Sym<2, double> plane = kirchhoff(Mat<2, double>{{1, gamma, 0, 1}});
    CHECK(plane(0, 0) == close(xx));
    CHECK(plane(0, 1) == close(xy));
    CHECK(plane(1, 1) == close(yy));
    CHECK(plane.s[2] == close(pull));
  }
}

TEST_CASE("corotated: to first order it is the fixed corotated solid") {
  const FixedCorotated::Constants<double> other({young, poisson, density});
  const Mat3 strain{{0.5, 0.3, -0.4, 0.1, -0.7, 0.2, -0.4, 0.6, 0.6}};
  double difference[2];
  for (int k : {0, 1}) {
    Mat3 F = Mat3::identity();
    for (int i = 0; i < 9; ++i) F.m[i] += (k ? 1e-3 : 1e-2) * strain.m[i];
    const auto a = kirchhoff(F), b = FixedCorotated::kirchhoff_stress(other, FixedCorotated::State<3, double>{F});
    difference[k] = 0;
    for (int i = 0; i < 6; ++i) difference[k] = larger(difference[k], std::abs(a.s[i] - b.s[i]));
  }
  CHECK(difference[0] > 1e-3);
  CHECK(difference[0] / difference[1] == Approx(100).epsilon(0.1));
}

TEST_CASE(
    "corotated: from J = 1e-6 to 1e6 stress and energy are those of the stretches, in double and in lanes of float") {
  using L = Lanes<float>;
  const Corotated::Constants<float> single({young, poisson, density});
  for (double s : {1e-2, 1e-1, 10.0, 100.0}) {
    CAPTURE(s);
    const double expected = (2 * mu + 3 * lambda) * (s - 1) * s;
    CHECK(kirchhoff(diagonal(s, s, s))(1, 1) == Approx(expected).epsilon(1e-12));
    CHECK(energy(diagonal(s, s, s)) == Approx((3 * mu + 4.5 * lambda) * (s - 1) * (s - 1)).epsilon(1e-12));
    CHECK(wave_modulus(diagonal(s, s, s)) >= 2 * mu * s * s);
    Mat<3, L> F{};
    for (int i = 0; i < 3; ++i) F(i, i) = L(static_cast<float>(s));
    CHECK(Corotated::kirchhoff_stress(single, Corotated::State<3, L>{F}).s[0][0] == Approx(expected).epsilon(1e-5));
  }
  // An inverted particle has a finite stress too: the stretches of the nearest rotation are 1, 1 and -1/2.
  const Sym<3, double> tau = kirchhoff(diagonal(-0.5, 1, 1));
  CHECK(tau(0, 0) == Approx((2 * mu * -1.5 + lambda * -1.5) * -0.5).epsilon(1e-12));
  CHECK(tau(1, 1) == Approx(lambda * -1.5).epsilon(1e-12));
  for (const auto& F : {diagonal(0, 0, 0), diagonal(-1, 1, 1), diagonal(0, 0, 2), diagonal(-1, -1, -1)})
    for (const double component : kirchhoff(F).s) CHECK(std::isfinite(component));
}

TEST_CASE("corotated: stress turns with the particle, also around the axis of a ring") {
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Mat3 F{{1.3, 0.2, -0.1, 0.05, 0.8, 0.3, -0.2, 0.1, 1.1}}, Q{{c, -s, 0, s, c, 0, 0, 0, 1}};
  const Sym<3, double> before = kirchhoff(F), after = kirchhoff(Q * F);
  CHECK(after(0, 0) == Approx(c * c * before(0, 0) - 2 * c * s * before(0, 1) + s * s * before(1, 1)).epsilon(1e-11));
  CHECK(after(0, 2) == Approx(c * before(0, 2) - s * before(1, 2)).epsilon(1e-11));
  CHECK(after(2, 2) == Approx(before(2, 2)).epsilon(1e-11));
  const Sym<3, double> space = kirchhoff(Mat3{{1.2, 0.3, 0, -0.1, 0.9, 0, 0, 0, 0.7}});
  const Corotated::AxisymmetricState<double> around{{{{1.2, 0.3, -0.1, 0.9}}, 0.7}};
  CHECK(Corotated::stored_energy(constants, around) ==
        Approx(energy(Mat3{{1.2, 0.3, 0, -0.1, 0.9, 0, 0, 0, 0.7}})).epsilon(1e-12));
  const auto ring = Corotated::kirchhoff_stress(constants, around);
  for (int i = 0; i < 3; ++i) CHECK(ring.s[i] == Approx(space.s[i]).epsilon(1e-11));
  CHECK(ring(0, 1) == Approx(space(0, 1)).epsilon(1e-11));
}

TEST_CASE("corotated: the wave along the largest stretch has the reported speed, and none is faster") {
  CHECK(wave_modulus(Mat3::identity()) == Approx(lambda + 2 * mu).epsilon(1e-14));
  for (double l : {1.0, 1.3, 2.0})
    CHECK(second_derivative(diagonal(1, l, 1), {{0, 1, 0}}, {{0, 1, 0}}) ==
          Approx(wave_modulus(diagonal(1, l, 1))).epsilon(1e-5));
  // Stretched by 8 in all directions the shear wave is the fastest: 2 mu s^2 + (lambda (3 s - 3) - 2 mu) s/2.
  const double s = 8, shear = 2 * mu * s * s + (lambda * (3 * s - 3) - 2 * mu) * s / 2;
  CHECK(second_derivative(diagonal(s, s, s), {{0, 1, 0}}, {{1, 0, 0}}) == Approx(shear).epsilon(1e-5));
  CHECK(shear > (2 * mu + lambda) * s * s);
  CHECK(wave_modulus(diagonal(s, s, s)) >= shear);
  // In the plane the largest stretch is that of the principal axes, however they and the particle are turned.
  const auto turn = [](double angle) {
    return Mat<2, double>{{std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)}};
  };
  CHECK(wave_modulus(turn(0.4) * Mat<2, double>{{1.5, 0, 0, 0.8}} * turn(0.9)) ==
        Approx((lambda + 2 * mu) * 1.5 * 1.5).epsilon(1e-12));
  // The bound 2 mu s^2 + K s is attained where one stretch vanishes beside two of s, and is what is reported where all are s.
  const auto bound = [](double largest, double sum) {
    return 2 * mu * largest * largest + (lambda * (sum - 3) - 2 * mu) * largest;
  };
  CHECK(second_derivative(diagonal(1e-3, 20, 20), {{1, 0, 0}}, {{0, 1, 0}}) == Approx(bound(20, 40)).epsilon(1e-4));
  CHECK(wave_modulus(diagonal(s, s, s)) == Approx(bound(s, 3 * s)).epsilon(1e-12));
  std::mt19937 numbers(5);
  const auto entry = [&] { return std::ldexp(static_cast<double>(numbers()), -31) - 1; };
  double fastest = 0;
  for (int k = 0; k < 20000; ++k) {
    const double size = k % 2 ? 1.5 : 3;
    const Mat3 F = diagonal(std::exp(size * entry()), std::exp(size * entry()), std::exp(size * entry()));
    Vec<3, double> a{{entry(), entry(), entry()}}, n{{entry(), entry(), entry()}};
    if (k % 2) a = n;
    for (Vec<3, double>* v : {&a, &n}) {
      const double length = std::sqrt((*v)[0] * (*v)[0] + (*v)[1] * (*v)[1] + (*v)[2] * (*v)[2]);
      for (int i = 0; i < 3; ++i) (*v)[i] /= length;
    }
    fastest = larger(fastest, second_derivative(F, a, n) / wave_modulus(F));
  }
  CHECK(fastest <= 1 + 1e-4);  // what the differences resolve
}

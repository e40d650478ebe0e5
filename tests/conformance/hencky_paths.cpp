// St. Venant-Kirchhoff solid of the logarithmic strain under imposed deformation, in closed form. E = 1000, nu = 0.3.

#include <cmath>
#include <random>

#include "kernel/lanes.hpp"
#include "materials/hencky/hencky.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;

constexpr double young = 1000, poisson = 0.3, density = 1000;
constexpr double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
const Hencky::Constants<double> constants({young, poisson, density});

template <int D>
Sym<D, double> kirchhoff(const Mat<D, double>& F) {
  return Hencky::kirchhoff_stress(constants, Hencky::State<D, double>{F});
}
template <int D>
double energy(const Mat<D, double>& F) {
  return Hencky::stored_energy(constants, Hencky::State<D, double>{F});
}
double wave_modulus(const Mat3& F) {
  const double speed = Hencky::wave_speed(constants, Hencky::State<3, double>{F});
  return density * speed * speed;
}
Mat3 diagonal(double x, double y, double z) {
  return {{x, 0, 0, 0, y, 0, 0, 0, z}};
}
Mat3 product(const Mat3& a, const Mat3& b) {
  return a * b;
}

/// The second derivative d2 psi/ds2 along F + s a (x) F^T n by central differences, which is rho0 c^2.
double second_derivative(const Mat3& F, const Vec<3, double>& a, const Vec<3, double>& n) {
  constexpr double h = 1e-4;
  const auto at = [&](double s) {
    Mat3 f = Mat3::identity();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) f(i, j) += s * a[i] * n[j];
    return energy(product(f, F));
  };
  return (at(h) - 2 * at(0) + at(-h)) / (h * h);
}

}  // namespace

TEST_CASE("Hencky: stress free at the sides is E ln s, and the sides shrink by s^-nu") {
  for (double s : {1e-3, 0.2, 0.7, 0.999, 1.0, 1.3, 5.0, 1e3}) {
    CAPTURE(s);
    const double side = std::pow(s, -poisson);
    const Sym<3, double> tau = kirchhoff(diagonal(side, s, side));
    CHECK(tau(1, 1) == Approx(young * std::log(s)).epsilon(1e-12).margin(1e-10));
    CHECK(std::abs(tau(0, 0)) < 1e-10 * young);
    CHECK(std::abs(tau(2, 2)) < 1e-10 * young);
    CHECK(energy(diagonal(side, s, side)) ==
          Approx(young / 2 * std::log(s) * std::log(s)).epsilon(1e-12).margin(1e-20));
  }
}

TEST_CASE("Hencky: uniaxial strain, and its Cauchy stress that is largest where ln s = 1") {
  const auto cauchy = [](double s) { return kirchhoff(diagonal(s, 1, 1))(0, 0) / s; };
  for (double s : {0.1, 0.5, 0.9, 1.1, 2.0, 10.0}) {
    const Sym<3, double> tau = kirchhoff(diagonal(s, 1, 1));
    CHECK(tau(0, 0) == Approx((lambda + 2 * mu) * std::log(s)).epsilon(1e-12));
    CHECK(tau(1, 1) == Approx(lambda * std::log(s)).epsilon(1e-12));
    CHECK(tau(2, 2) == Approx(lambda * std::log(s)).epsilon(1e-12));
    const Sym<2, double> plane = kirchhoff(Mat<2, double>{{s, 0, 0, 1}});
    for (int i = 0; i < 3; ++i) CHECK(plane.s[i] == Approx(tau.s[i]).epsilon(1e-12));
  }
  const double e = std::exp(1.0);
  CHECK(cauchy(e) == Approx((lambda + 2 * mu) / e).epsilon(1e-12));
  CHECK(cauchy(e) > cauchy(1.01 * e));
  CHECK(cauchy(e) > cauchy(0.99 * e));
}

TEST_CASE("Hencky: simple shear has the principal strains asinh(gamma/2)") {
  for (double gamma : {-3.0, -0.2, 1e-4, 0.5, 2.0, 50.0}) {
    CAPTURE(gamma);
    // b = [1 + g^2, g; g, 1] has the stretches exp(+-asinh(g/2)), and its deviator is (g^2/2, g) in xx and xy.
    const double size = std::asinh(gamma / 2) / std::sqrt(1 + gamma * gamma / 4);
    const Sym<3, double> tau = kirchhoff(Mat3{{1, gamma, 0, 0, 1, 0, 0, 0, 1}});
    CHECK(tau(0, 1) == Approx(2 * mu * size).epsilon(1e-10));
    CHECK(tau(0, 0) == Approx(mu * gamma * size).epsilon(1e-9).margin(1e-11 * mu));
    CHECK(tau(1, 1) == Approx(-mu * gamma * size).epsilon(1e-9).margin(1e-11 * mu));
    CHECK(std::abs(tau(2, 2)) < 1e-9);
    const Sym<2, double> plane = kirchhoff(Mat<2, double>{{1, gamma, 0, 1}});
    CHECK(plane(0, 1) == Approx(tau(0, 1)).epsilon(1e-10));
    CHECK(plane(0, 0) == Approx(tau(0, 0)).epsilon(1e-9).margin(1e-11 * mu));
    CHECK(energy(Mat3{{1, 0, 0, 0, 1, gamma, 0, 0, 1}}) ==
          Approx(2 * mu * std::pow(std::asinh(gamma / 2), 2)).epsilon(1e-9));
  }
}

TEST_CASE("Hencky: ln J is the volumetric strain, from J = 1e-6 to 1e6, and stress stays that of the logarithms") {
  for (double J : {1e-6, 1e-3, 0.5, 2.0, 1e3, 1e6}) {
    CAPTURE(J);
    const double s = std::cbrt(J), bulk = lambda + 2 * mu / 3;
    const Sym<3, double> tau = kirchhoff(diagonal(s, s, s));
    for (int i = 0; i < 3; ++i) CHECK(tau.s[i] == Approx(bulk * std::log(J)).epsilon(1e-12));
    CHECK(energy(diagonal(s, s, s)) == Approx(bulk / 2 * std::log(J) * std::log(J)).epsilon(1e-12));
    CHECK(std::isfinite(wave_modulus(diagonal(s, s, s))));
    CHECK(wave_modulus(diagonal(s, s, s)) >= mu * (1 - 1e-14));
  }
  // Stretches of 1e5 and 1e-5 beside one another: tau = 2 mu ln s, as the volume stays.
  const Mat3 turned = product(Mat3{{0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1}}, diagonal(1e5, 1e-5, 1));
  const Sym<3, double> tau = kirchhoff(turned);
  const double pull = 2 * mu * std::log(1e5);
  CHECK(tau(0, 0) == Approx(pull * (0.36 - 0.64)).epsilon(1e-9));
  CHECK(tau(0, 1) == Approx(pull * 2 * 0.48).epsilon(1e-9));
  CHECK(tau(1, 1) == Approx(pull * (0.64 - 0.36)).epsilon(1e-9));
  // Lanes of float answer the same: 1e-6 relative is a few of their roundings.
  using L = Lanes<float>;
  const Hencky::Constants<float> single({young, poisson, density});
  for (double s : {1e-2, 1e-1, 10.0, 100.0}) {
    Mat<3, L> F{};
    for (int i = 0; i < 3; ++i) F(i, i) = L(static_cast<float>(s));
    const Sym<3, L> found = Hencky::kirchhoff_stress(single, Hencky::State<3, L>{F});
    for (int i = 0; i < 3; ++i) CHECK(found.s[i][0] == Approx((3 * lambda + 2 * mu) * std::log(s)).epsilon(1e-6));
  }
}

TEST_CASE("Hencky: the stress of strain around the axis and of plane strain is that of 3-D") {
  const Sym<3, double> space = kirchhoff(Mat3{{1.2, 0.3, 0, -0.1, 0.9, 0, 0, 0, 0.7}});
  const auto ring =
      Hencky::kirchhoff_stress(constants, Hencky::AxisymmetricState<double>{{{{1.2, 0.3, -0.1, 0.9}}, 0.7}});
  for (int i = 0; i < 3; ++i) CHECK(ring.s[i] == Approx(space.s[i]).epsilon(1e-11));
  CHECK(ring(0, 1) == Approx(space(0, 1)).epsilon(1e-11));
}

TEST_CASE("Hencky: waves along principal axes in closed form, and none in any direction is faster than reported") {
  CHECK(wave_modulus(Mat3::identity()) == Approx(lambda + 2 * mu).epsilon(1e-14));
  // Where tension leaves shear waves the fastest along the axes, with strains that differ by x: mu x (1 + coth x), and 5 %
  // too much at most; of waves askew there is x^2/2/(1 + x) mu more.
  for (const double x : {0.4, 0.8, 1.5}) {
    const double shear = mu * x * (1 + 1 / std::tanh(x)), askew = mu * x * x / 2 / (1 + x);
    const double reported = wave_modulus(diagonal(std::exp(0.5 + x), std::exp(0.5), std::exp(0.5))) - askew;
    CHECK(reported >= shear);
    CHECK(reported <= 1.05 * shear);
  }
  // Along the pressed axis of F = diag(s, 1, 1): lambda + 2 mu - tau, by hand and as reported but for 1 %.
  for (double s : {0.9, 0.97}) {
    const double exact = (lambda + 2 * mu) * (1 - std::log(s));
    CHECK(second_derivative(diagonal(s, 1, 1), {{1, 0, 0}}, {{1, 0, 0}}) == Approx(exact).epsilon(1e-5));
    CHECK(wave_modulus(diagonal(s, 1, 1)) >= exact * (1 - 1e-12));
    CHECK(wave_modulus(diagonal(s, 1, 1)) <= exact * 1.01);
  }
  // A shear wave along the larger stretch: 2 mu x/(1 - e^-2x), x the difference of the strains.
  const double x = 2 * std::log(1.5);
  CHECK(second_derivative(diagonal(1.5, 1 / 1.5, 1), {{0, 1, 0}}, {{1, 0, 0}}) ==
        Approx(2 * mu * x / (1 - std::exp(-2 * x))).epsilon(1e-5));
  std::mt19937 numbers(5);
  const auto entry = [&] { return std::ldexp(static_cast<double>(numbers()), -31) - 1; };
  double fastest = 0;
  for (int k = 0; k < 20000; ++k) {
    const double size = k % 2 ? 1.5 : 3;
    const Mat3 F = diagonal(std::exp(size * entry()), std::exp(size * entry()), std::exp(size * entry()));
    Vec<3, double> a{{entry(), entry(), entry()}}, n{{entry(), entry(), entry()}};
    if (k % 3 == 0) a = n;
    if (k % 3 == 1) a = {{1, 0, 0}}, n = {{0.05 * entry(), 1, 0.05 * entry()}};
    for (Vec<3, double>* v : {&a, &n}) {
      const double length = std::sqrt((*v)[0] * (*v)[0] + (*v)[1] * (*v)[1] + (*v)[2] * (*v)[2]);
      for (int i = 0; i < 3; ++i) (*v)[i] /= length;
    }
    fastest = larger(fastest, second_derivative(F, a, n) / wave_modulus(F));
  }
  CHECK(fastest <= 1 + 1e-4);  // what the differences resolve
  CHECK(fastest > 0.9);
}

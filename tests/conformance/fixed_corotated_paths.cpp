// Fixed corotated solid under imposed deformation. E = 1000, nu = 0.3. The tables give Cauchy stress; the functor gives
// Kirchhoff stress. The tolerance 1e-7 relative covers their printed digits.

#include <cmath>
#include <random>

#include "kernel/lanes.hpp"
#include "materials/fixed_corotated/fixed_corotated.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;

constexpr double mu = 384.6153846153846, lambda = 576.9230769230769, density = 1000;
const FixedCorotated::Constants<double> constants({1000, 0.3, density});

template <int D>
Sym<D, double> kirchhoff(const Mat<D, double>& F) {
  return FixedCorotated::kirchhoff_stress(constants, FixedCorotated::State<D, double>{F});
}

template <int D>
Sym<D, double> cauchy(const Mat<D, double>& F) {
  Sym<D, double> sigma = kirchhoff(F);
  for (double& component : sigma.s) component /= determinant(F);
  return sigma;
}

template <int D>
double energy(const Mat<D, double>& F) {
  return FixedCorotated::stored_energy(constants, FixedCorotated::State<D, double>{F});
}

template <int D>
double wave_modulus(const Mat<D, double>& F) {
  const double speed = FixedCorotated::wave_speed(constants, FixedCorotated::State<D, double>{F});
  return density * speed * speed;
}

Mat<3, double> diagonal(double a, double b, double c) {
  return {{a, 0, 0, 0, b, 0, 0, 0, c}};
}

Approx near(double value) {
  return Approx(value).epsilon(1e-7).margin(1e-9);
}

/// First Piola-Kirchhoff stress P = tau F^-T = (tau cof F)/J.
Mat<3, double> first_piola(const Mat<3, double>& F) {
  const Sym<3, double> tau = kirchhoff(F);
  const Mat<3, double> cofactor = polar::cofactor(F);
  Mat<3, double> P{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) P(i, j) += tau(i, k) * cofactor(k, j) / determinant(F);
  return P;
}

/// The second derivative d2 psi / ds2 along F + s a (x) F^T n by central differences.
template <int D>
double second_derivative(const Mat<D, double>& F, const Vec<D, double>& a, const Vec<D, double>& n) {
  constexpr double h = 1e-4;
  const auto at = [&](double s) {
    Mat<D, double> moved = F;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j)
        for (int k = 0; k < D; ++k) moved(i, j) += s * a[i] * n[k] * F(k, j);
    return energy(moved);
  };
  return (at(h) - 2 * at(0) + at(-h)) / (h * h);
}

}  // namespace

TEST_CASE("fixed corotated: uniaxial strain") {
  const double rows[][3] = {{0.5, -673.07692, -288.46154}, {2, 1346.15385, 576.92308}};
  for (const auto& row : rows) {
    const Sym<3, double> sigma = cauchy(diagonal(row[0], 1, 1));
    CHECK(sigma(0, 0) == near(row[1]));
    CHECK(sigma(1, 1) == near(row[2]));
    CHECK(sigma(2, 2) == near(row[2]));
    CHECK(std::abs(sigma(0, 1)) < 1e-10);
    const Sym<2, double> plane = cauchy(Mat<2, double>{{row[0], 0, 0, 1}});
    CHECK(plane(0, 0) == near(row[1]));
    CHECK(plane(1, 1) == near(row[2]));
    CHECK(plane.s[2] == near(row[2]));  // zz of plane strain
  }
}

TEST_CASE("fixed corotated: uniaxial strain in closed form") {
  // Uniaxial stretch: sigma_11 = 2 mu (l - 1) + lambda (l - 1), sigma_22 = lambda (l - 1), psi = (mu + lambda/2) (l -
  // 1)^2.
  for (const double l : {0.05, 0.3, 0.9, 1.0, 1.0001, 1.7, 4.0}) {
    const Sym<3, double> sigma = cauchy(diagonal(1, l, 1));
    CHECK(sigma(1, 1) == Approx((2 * mu + lambda) * (l - 1)).epsilon(1e-12).margin(1e-10));
    CHECK(sigma(0, 0) == Approx(lambda * (l - 1)).epsilon(1e-12).margin(1e-10));
    CHECK(energy(diagonal(1, l, 1)) == Approx((mu + lambda / 2) * (l - 1) * (l - 1)).epsilon(1e-11).margin(1e-25));
  }
}

TEST_CASE("fixed corotated: simple shear, the table and the closed form") {
  for (const double gamma : {1e-3, 0.1, 0.5, 2.0, 10.0}) {
    Mat<3, double> F = Mat<3, double>::identity();
    F(0, 1) = gamma;
    const Sym<3, double> sigma = cauchy(F);
    const double length = std::sqrt(4 + gamma * gamma), c = 2 / length, s = gamma / length;  // R turns by atan(gamma/2)
    const auto close = [&](double value) { return Approx(value).epsilon(1e-11).margin(1e-11 * mu); };
    CHECK(sigma(0, 0) == close(2 * mu * (1 + gamma * gamma - c - s * gamma)));
    CHECK(sigma(0, 1) == close(2 * mu * (gamma - s)));
    CHECK(sigma(1, 1) == close(2 * mu * (1 - c)));
    CHECK(std::abs(sigma(2, 2)) < 1e-10);
    const Sym<2, double> plane = cauchy(Mat<2, double>{{1, gamma, 0, 1}});
    for (int i = 0; i < 2; ++i)
      for (int j = i; j < 2; ++j) CHECK(plane(i, j) == close(sigma(i, j)));
    CHECK(std::abs(plane.s[2]) < 1e-10);
    if (gamma != 0.5) continue;
    CHECK(sigma(0, 0) == near(121.99207));
    CHECK(sigma(0, 1) == near(198.04952));
    CHECK(sigma(1, 1) == Approx(22.96731).epsilon(3e-7));
  }
}

TEST_CASE("fixed corotated: an inverted particle has a finite stress") {
  // With singular values 1, 1, -1/2 and R = I the stress is tau = 2 mu (F - I) F + lambda (J - 1) J I.
  const Sym<3, double> tau = kirchhoff(diagonal(-0.5, 1, 1));
  CHECK(tau(0, 0) == Approx(2 * mu * 0.75 + lambda * 0.75).epsilon(1e-12));
  CHECK(tau(1, 1) == Approx(lambda * 0.75).epsilon(1e-12));
  const Sym<2, double> plane = kirchhoff(Mat<2, double>{{-0.5, 0, 0, 1}});
  CHECK(plane(0, 0) == Approx(2 * mu * 0.75 + lambda * 0.75).epsilon(1e-12));
  // Every number is finite where the rotation is not unique either.
  for (const auto& F : {diagonal(0, 0, 0), diagonal(-1, 1, 1), diagonal(0, 0, 2), diagonal(-1, -1, -1)}) {
    for (const double component : kirchhoff(F).s) CHECK(std::isfinite(component));
    CHECK(std::isfinite(energy(F)));
  }
}

TEST_CASE("fixed corotated: P(QF) = Q P(F)") {
  std::mt19937 numbers(3);
  const auto entry = [&] { return std::ldexp(static_cast<double>(numbers()), -31) - 1; };
  double worst = 0;
  for (int k = 0; k < 500; ++k) {
    Mat<3, double> F = Mat<3, double>::identity(), A;
    for (double& e : F.m) e += 0.4 * entry();
    for (double& e : A.m) e = entry();
    if (!(determinant(F) > 0.05)) continue;
    const Mat<3, double> Q = polar_rotation(A), turned = first_piola(Q * F), expected = Q * first_piola(F);
    for (int i = 0; i < 9; ++i) worst = larger(worst, std::abs(turned.m[i] - expected.m[i]) / 1000);
  }
  CHECK(worst > 0);
  CHECK(worst <= 1e-12);
}

TEST_CASE("fixed corotated: the wave along the largest stretch has the reported speed") {
  // The bound is exact in 2-D, and in 3-D where the two smaller stretches are equal.
  for (const double l : {1.0, 1.3, 2.0}) {
    CHECK(second_derivative<3>(diagonal(1, l, 1), {{0, 1, 0}}, {{0, 1, 0}}) ==
          Approx(wave_modulus(diagonal(1, l, 1))).epsilon(1e-6));
    const Mat<2, double> F{{0.8, 0, 0, l}};
    CHECK(second_derivative<2>(F, {{0, 1}}, {{0, 1}}) == Approx(wave_modulus(F)).epsilon(1e-6));
  }
  CHECK(wave_modulus(Mat<3, double>::identity()) == Approx(lambda + 2 * mu).epsilon(1e-14));
}

TEST_CASE("fixed corotated: around an axis the hoop stretch counts as those of the plane do") {
  // In principal stretches l: tau_i = 2 mu (l_i - 1) l_i + lambda (J - 1) J, psi = mu sum (l_i - 1)^2 + lambda/2 (J - 1)^2.
  const double l[3] = {1.2, 0.9, 1.4}, J = l[0] * l[1] * l[2];
  const FixedCorotated::AxisymmetricState<double> ring{{{{l[0], 0, 0, l[1]}}, l[2]}};
  const Sym<2, double> tau = FixedCorotated::kirchhoff_stress(constants, ring);
  double energy = lambda / 2 * (J - 1) * (J - 1);
  for (int i = 0; i < 3; ++i) {
    CHECK(tau.s[i] == Approx(2 * mu * (l[i] - 1) * l[i] + lambda * (J - 1) * J).epsilon(1e-12));
    energy += mu * (l[i] - 1) * (l[i] - 1);
  }
  CHECK(FixedCorotated::stored_energy(constants, ring) == Approx(energy).epsilon(1e-12));
}

TEST_CASE("fixed corotated: in the plane the fastest wave does not depend on how the particle is turned") {
  const double c = std::cos(0.6), s = std::sin(0.6), x = 0.8, y = 1.7;
  const Mat<2, double> turned{{c * x, -s * y, s * x, c * y}};
  CHECK(wave_modulus(turned) == Approx(2 * mu * y * y + lambda * x * x * y * y).epsilon(1e-12));
}

TEST_CASE("fixed corotated: lanes of float keep the digits of small strains") {
  // sigma_11 of a strain of 1e-3 is good to rounding over the strain, whatever the particle's turn.
  using L = Lanes<float>;
  const FixedCorotated::Constants<float> single({1000, 0.3, density});
  for (const double strain : {1e-3, 1e-2}) {
    Mat<3, L> F{};
    for (int i = 0; i < 3; ++i) F(i, i) = L(1.0F);
    F(0, 0) = L(static_cast<float>(1 + strain));
    const Sym<3, L> tau = FixedCorotated::kirchhoff_stress(single, FixedCorotated::State<3, L>{F});
    const double exact = kirchhoff(diagonal(static_cast<double>(F(0, 0)[0]), 1, 1))(0, 0);
    for (int lane = 0; lane < L::width; ++lane) CHECK(std::abs(tau(0, 0)[lane] / exact - 1) < 8 * 0x1p-23 / strain);
  }
}

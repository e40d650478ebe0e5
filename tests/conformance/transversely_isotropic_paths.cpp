// St. Venant-Kirchhoff solid with an axis under imposed deformation. Expected values come from the compliance, which the
// engineering constants are entries of (Lekhnitskii 1963); the program uses the stiffness.

#include <cmath>
#include <random>
#include <string>

#include "materials/transversely_isotropic/transversely_isotropic.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;
using Vec3 = Vec<3, double>;
using Parameters = TransverselyIsotropic::Parameters;

constexpr double density = 500;
/// Spruce, MPa: E_a, E_t, nu_a, nu_t, G_a.
constexpr double axial = 12000, transverse = 700, nu_a = 0.42, nu_t = 0.31, shear = 750;

Parameters spruce(double x, double y, double z) {
  return {axial, transverse, nu_a, nu_t, shear, density, x, y, z};
}

Mat3 transposed(const Mat3& a) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = a(j, i);
  return r;
}
Mat3 product(const Mat3& a, const Mat3& b) {
  return a * b;
}

class Numbers {
 public:
  double operator()() { return std::ldexp(static_cast<double>(engine_()), -31) - 1; }
  Vec3 direction() {
    for (;;) {
      Vec3 v{{(*this)(), (*this)(), (*this)()}};
      const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      if (length < 0.1 || length > 1) continue;
      for (double& x : v.v) x /= length;
      return v;
    }
  }
  /// A rotation: two reflections.
  Mat3 rotation() {
    Mat3 r = Mat3::identity();
    for (int k = 0; k < 2; ++k) {
      const Vec3 n = direction();
      Mat3 mirror = Mat3::identity();
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) mirror(i, j) -= 2 * n[i] * n[j];
      r = product(r, mirror);
    }
    return r;
  }

 private:
  std::mt19937 engine_{7};
};

/// Green's strain under a second Piola-Kirchhoff stress, by the compliance; the axis is z.
Mat3 strain_under(const Mat3& S) {
  Mat3 E;
  const double side = S(0, 0) + S(1, 1), across = (1 + nu_t) / transverse;
  E(2, 2) = (S(2, 2) - nu_a * side) / axial;
  E(0, 0) = (S(0, 0) - nu_t * S(1, 1)) / transverse - nu_a / axial * S(2, 2);
  E(1, 1) = (S(1, 1) - nu_t * S(0, 0)) / transverse - nu_a / axial * S(2, 2);
  E(0, 1) = E(1, 0) = across * S(0, 1);
  E(1, 2) = E(2, 1) = S(1, 2) / (2 * shear);
  E(0, 2) = E(2, 0) = S(0, 2) / (2 * shear);
  return E;
}

/// A deformation gradient with Green's strain E: the transposed factor of Cholesky's decomposition of I + 2 E.
Mat3 deformation_with(const Mat3& E) {
  Mat3 C = Mat3::identity(), U{};
  for (int k = 0; k < 9; ++k) C.m[k] += 2 * E.m[k];
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      double t = C(i, j);
      for (int k = 0; k < i; ++k) t -= U(k, i) * U(k, j);
      U(i, j) = i == j ? std::sqrt(t) : t / U(i, i);
    }
  return U;
}

Sym<3, double> kirchhoff(const Parameters& p, const Mat3& F) {
  return TransverselyIsotropic::kirchhoff_stress(TransverselyIsotropic::Constants<double>(p),
                                                 TransverselyIsotropic::State<3, double>{F});
}
double energy(const Parameters& p, const Mat3& F) {
  return TransverselyIsotropic::stored_energy(TransverselyIsotropic::Constants<double>(p),
                                              TransverselyIsotropic::State<3, double>{F});
}
double wave_modulus(const Parameters& p, const Mat3& F) {
  const double speed = TransverselyIsotropic::wave_speed(TransverselyIsotropic::Constants<double>(p),
                                                         TransverselyIsotropic::State<3, double>{F});
  return density * speed * speed;
}

/// rho0 c^2 = d2 psi/ds2 along F + s a (x) F^T n by central differences; exact for psi of the fourth order but for h^2.
double second_derivative(const Parameters& p, const Mat3& F, const Vec3& a, const Vec3& n, double h = 1e-3) {
  const auto at = [&](double s) {
    Mat3 f = Mat3::identity();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) f(i, j) += s * a[i] * n[j];
    return energy(p, product(f, F));
  };
  return (at(h) - 2 * at(0) + at(-h)) / (h * h);
}

}  // namespace

TEST_CASE("transversely isotropic: stress by the compliance, for any axis and any turn of the body") {
  Numbers number;
  for (int k = 0; k < 200; ++k) {
    Mat3 S{};
    if (k < 6)  // one stress alone
      S(k < 3 ? k : (k + 1) % 3, k < 3 ? k : (k + 2) % 3) = 60;
    else
      for (double& s : S.m) s = 60 * number();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < i; ++j) S(i, j) = S(j, i) = k < 6 ? S(i, j) + S(j, i) : S(i, j);
    const Mat3 Q = number.rotation(), R = number.rotation();
    const Mat3 turned = product(product(Q, S), transposed(Q)), E = product(product(Q, strain_under(S)), transposed(Q));
    const Mat3 F = product(R, deformation_with(E)), tau = product(product(F, turned), transposed(F));
    const Parameters p = spruce(3 * Q(0, 2), 3 * Q(1, 2), 3 * Q(2, 2));  // its length does not matter
    const Sym<3, double> found = kirchhoff(p, F);
    double half = 0;
    for (int i = 0; i < 9; ++i) half += 0.5 * turned.m[i] * E.m[i];
    CAPTURE(k);
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) CHECK(found(i, j) == Approx(tau(i, j)).epsilon(1e-10).margin(1e-9));
    CHECK(energy(p, F) == Approx(half).epsilon(1e-10));
  }
}

TEST_CASE("transversely isotropic: with isotropic constants it is the St. Venant-Kirchhoff solid") {
  const double E = 1000, nu = 0.3, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  Numbers number;
  for (int k = 0; k < 50; ++k) {
    Mat3 F = Mat3::identity(), strain;
    for (double& f : F.m) f += 0.3 * number();
    const Vec3 a = number.direction();
    const Parameters p{E, E, nu, nu, mu, density, a[0], a[1], a[2]};
    double sum = 0;
    const Mat3 C = product(transposed(F), F);
    for (int i = 0; i < 9; ++i) strain.m[i] = 0.5 * (C.m[i] - (i % 4 == 0 ? 1 : 0));
    for (int i = 0; i < 3; ++i) sum += strain(i, i);
    Mat3 S;
    for (int i = 0; i < 9; ++i) S.m[i] = 2 * mu * strain.m[i] + (i % 4 == 0 ? lambda * sum : 0);
    const Mat3 tau = product(product(F, S), transposed(F));
    const Sym<3, double> found = kirchhoff(p, F);
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) CHECK(found(i, j) == Approx(tau(i, j)).epsilon(1e-10).margin(1e-8));
    CHECK(wave_modulus(p, Mat3::identity()) == Approx(lambda + 2 * mu).epsilon(1e-12));
  }
}

TEST_CASE("transversely isotropic: a bar pressed along its length bears most at 1/sqrt(3) of it") {
  // S33 = E_a (s^2 - 1)/2 with free sides; the nominal stress s S33 has its largest value E_a/(3 sqrt(3)) there.
  const auto nominal = [](double s) {
    Mat3 S{};
    S(2, 2) = axial * (s * s - 1) / 2;
    const Mat3 F = deformation_with(strain_under(S));
    const Sym<3, double> tau = kirchhoff(spruce(0, 0, 1), F);
    CHECK(std::abs(tau(0, 0)) < 1e-9 * axial);
    return tau(2, 2) / s;
  };
  const double s = 1 / std::sqrt(3.0);
  CHECK(nominal(s) == Approx(-axial / (3 * std::sqrt(3.0))).epsilon(1e-10));
  CHECK(nominal(1.01 * s) > nominal(s));
  CHECK(nominal(0.99 * s) > nominal(s));
}

TEST_CASE("transversely isotropic: waves along and across the axis at rest, and none is faster than reported") {
  // Moduli of strain that is confined at the sides, from the compliance: 1 - nu_t - 2 nu_a^2 E_t/E_a = 0.6694 divides.
  const double coupling = nu_a * nu_a * transverse / axial, left = 1 - nu_t - 2 * coupling;
  const double c33 = axial * (1 - nu_t) / left, c11 = transverse * (1 - coupling) / ((1 + nu_t) * left);
  const Parameters p = spruce(0, 1, 0);
  const Mat3 rest = Mat3::identity();
  const Vec3 x{{1, 0, 0}}, y{{0, 1, 0}}, z{{0, 0, 1}};
  CHECK(second_derivative(p, rest, y, y) == Approx(c33).epsilon(1e-5));
  CHECK(second_derivative(p, rest, x, y) == Approx(shear).epsilon(1e-5));
  CHECK(second_derivative(p, rest, y, x) == Approx(shear).epsilon(1e-5));
  CHECK(second_derivative(p, rest, x, x) == Approx(c11).epsilon(1e-5));
  CHECK(second_derivative(p, rest, z, x) == Approx(transverse / (2 * (1 + nu_t))).epsilon(1e-5));
  CHECK(wave_modulus(p, rest) == Approx(c33).epsilon(1e-12));

  Numbers number;
  // Of a solid that is stiff in shear along the axis the fastest wave is oblique: 10.75 for c11 = c33 = 1.1, c44 = 10 and
  // c13 = 0.4 at half a right angle, as the waves of [[(c11 + c44)/2, (c13 + c44)/2], [.., (c33 + c44)/2]].
  const double n = 0.4 / 1.5;  // nu of the isotropic solid with c11 = 1.1, c13 = 0.4
  const double E = 1.1 * (1 + n) * (1 - 2 * n) / (1 - n);
  const Parameters oblique{E, E, n, n, 10, density, 0, 1, 0};
  const double h = std::sqrt(0.5);
  CHECK(second_derivative(oblique, rest, {{h, h, 0}}, {{h, h, 0}}) == Approx(10.75).epsilon(1e-5));
  CHECK(wave_modulus(oblique, rest) == Approx(10.75).epsilon(1e-12));

  double fastest = 0, fastest_at_rest = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 axis = number.direction();
    const double ratio = std::exp(3 * number()), stiff = std::exp(2 * number());
    const double largest = std::sqrt(ratio * (1 - 0.2) / 2);
    const Parameters any{ratio, 1, 0.95 * number() * largest, 0.2, stiff, density, axis[0], axis[1], axis[2]};
    Mat3 F = rest;
    if (k % 2)
      for (double& f : F.m) f += 0.3 * number();
    Vec3 a = number.direction();
    const Vec3 b = k % 3 ? a : number.direction();
    if (k % 5 == 0) a = b;
    const double share = second_derivative(any, F, a, b, 1e-4) / wave_modulus(any, F);
    fastest = larger(fastest, share);
    if (k % 2 == 0) fastest_at_rest = larger(fastest_at_rest, share);
  }
  CHECK(fastest <= 1 + 1e-5);
  CHECK(fastest_at_rest > 0.99);
}

TEST_CASE("transversely isotropic: at rest the reported wave is the fastest in any direction, whatever the constants") {
  // Moduli from the compliance, and in a plane through the axis the larger root of Christoffel's matrix.
  const auto check = [](double E_a, double E_t, double nu, double nu_across, double G) {
    CAPTURE(E_a, E_t, nu, nu_across, G);
    const double coupling = nu * nu * E_t / E_a, left = 1 - nu_across - 2 * coupling;
    const double c33 = E_a * (1 - nu_across) / left, c11 = E_t * (1 - coupling) / ((1 + nu_across) * left),
                 c13 = nu * E_t / left;
    double fastest = E_t / (2 * (1 + nu_across));
    for (int k = 0; k <= 3000; ++k) {
      const double u = k / 3000.0;  // the squared sine of the angle from the axis
      const double a = c11 * u + G * (1 - u), b = G * u + c33 * (1 - u), squared = (c13 + G) * (c13 + G) * u * (1 - u);
      fastest = larger(fastest, (a + b) / 2 + std::sqrt((a - b) * (a - b) / 4 + squared));
    }
    CHECK(wave_modulus({E_a, E_t, nu, nu_across, G, density, 0, 0, 1}, Mat3::identity()) ==
          Approx(fastest).epsilon(1e-5));
  };
  Numbers number;
  for (int k = 0; k < 300; ++k) {
    const double ratio = std::exp(3 * number()), nu_across = 0.8 * number();
    const double largest = std::sqrt(ratio * (1 - nu_across) / 2);
    check(ratio, 1, 0.97 * number() * largest, nu_across, std::exp(3 * number()));
  }
  // Where the curve of one plane is all but straight: 4 G = c11 + c33 - 2 c13 and a little more.
  const double coupling = nu_a * nu_a * transverse / axial, left = 1 - nu_t - 2 * coupling;
  const double c33 = axial * (1 - nu_t) / left, c11 = transverse * (1 - coupling) / ((1 + nu_t) * left),
               c13 = nu_a * transverse / left;
  check(axial, transverse, nu_a, nu_t, 1.001 / 4 * (c11 + c33 - 2 * c13));
}

TEST_CASE("transversely isotropic: in 2-D the axis lies in the plane, across it or around the axis of symmetry") {
  const Mat3 F{{1.1, 0.2, 0, -0.1, 0.9, 0, 0, 0, 1}}, ring{{1.1, 0.2, 0, -0.1, 0.9, 0, 0, 0, 1.2}};
  for (const Parameters& p : {spruce(0.6, 0.8, 0), spruce(0, 0, 1), spruce(0, 0, -1)}) {
    const TransverselyIsotropic::Constants<double> c(p);
    const auto flat =
        TransverselyIsotropic::kirchhoff_stress(c, TransverselyIsotropic::State<2, double>{{{1.1, 0.2, -0.1, 0.9}}});
    const auto around = TransverselyIsotropic::kirchhoff_stress(
        c, TransverselyIsotropic::AxisymmetricState<double>{{{{1.1, 0.2, -0.1, 0.9}}, 1.2}});
    const Sym<3, double> of_flat = kirchhoff(p, F), of_ring = kirchhoff(p, ring);
    for (int i = 0; i < 3; ++i) {
      CHECK(flat.s[i] == Approx(of_flat.s[i]).epsilon(1e-12));
      CHECK(around.s[i] == Approx(of_ring.s[i]).epsilon(1e-12));
    }
    CHECK(flat(0, 1) == Approx(of_flat(0, 1)).epsilon(1e-12));
    CHECK(around(0, 1) == Approx(of_ring(0, 1)).epsilon(1e-12));
  }
}

TEST_CASE(
    "transversely isotropic: constants without a positive stiffness, and axes that 2-D does not hold, are refused") {
  const auto refusal = [](const Parameters& p, mpm_refusal_case scene) {
    const mpm_refusal refused = TransverselyIsotropic::refusal(p, scene);
    return refused.parameter ? std::string(refused.parameter) : "";
  };
  CHECK(refusal(spruce(0.1, 0.2, 0.3), {3, 0}).empty());
  CHECK(refusal(spruce(0.1, 0.2, 0.3), {2, 0}) == "axis_z");
  CHECK(refusal(spruce(0.1, 0, -0.3), {2, 1}) == "axis_z");
  for (const std::uint32_t around : {0u, 1u}) {
    CHECK(refusal(spruce(0.1, 0.2, 0), {2, around}).empty());
    CHECK(refusal(spruce(0, 0, -2), {2, around}).empty());
  }
  // The length of an axis does not say where it points.
  CHECK(refusal(spruce(1, 0, 1e12), {2, 0}).empty());
  CHECK(refusal(spruce(1e12, 0, 1), {2, 0}).empty());
  CHECK(refusal(spruce(0, 0, 0), {3, 0}) == "axis_x");
  // nu_a^2 < (1 - 0.31)/2 12000/700 = 5.9142857
  Parameters p = spruce(1, 0, 0);
  for (const double sign : {1.0, -1.0}) {
    p.poisson_ratio_axial = sign * 2.43;
    CHECK(refusal(p, {3, 0}).empty());
    p.poisson_ratio_axial = sign * 2.44;
    CHECK(refusal(p, {3, 0}) == "poisson_ratio_axial");
    CHECK(TransverselyIsotropic::refusal(p, {3, 0}).limit == Approx(sign * 2.43193045).epsilon(1e-8));
  }
}

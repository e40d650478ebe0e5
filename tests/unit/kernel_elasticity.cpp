// Volumetric energies and moduli of isotropic elasticity.

#include "kernel/elasticity.hpp"

#include <cmath>

#include "kernel/dual.hpp"
#include "support/catch.hpp"

using namespace mpm;

TEST_CASE("volumetric energies have their values, and the pressure and the tangent are their derivatives") {
  const double ln2 = std::log(2.0);
  const auto energy = [](VolumetricEnergy form, double J) { return volumetric_energy(form, J); };
  CHECK(energy(VolumetricEnergy::logarithmic, 2) == Approx(ln2 * ln2 / 2));
  CHECK(energy(VolumetricEnergy::quadratic, 2) == Approx(0.5));
  CHECK(energy(VolumetricEnergy::simo, 2) == Approx((1.5 - ln2) / 2));
  for (const VolumetricEnergy form :
       {VolumetricEnergy::logarithmic, VolumetricEnergy::quadratic, VolumetricEnergy::simo})
    for (const double at : {0.4, 1.0, 1.7}) {
      INFO(static_cast<int>(form) << " " << at);
      const Dual<double> J(at, 1);
      const double slope = volumetric_energy(form, J).derivative;
      CHECK(volumetric_stress(form, at) == Approx(at * slope).margin(1e-12));
      const Dual<double> pressure = volumetric_stress(form, J) / J;  // u'
      CHECK(volumetric_tangent(form, at) == Approx(at * at * pressure.derivative));
    }
}

TEST_CASE("moduli of Young's modulus and Poisson's ratio") {
  CHECK(shear_modulus(1000, 0.3) == Approx(384.615384615));
  CHECK(lame_lambda(1000, 0.3) == Approx(576.923076923));
  CHECK(bulk_modulus(1000, 0.3) == Approx(833.333333333));
}

TEST_CASE("the isochoric tensor has determinant 1 and keeps the ratios of its entries") {
  const Mat<3, double> F{{1.3, 0.2, -0.1, 0.05, 0.8, 0.3, -0.2, 0.1, 1.1}};
  const Sym<3, double> b = left_cauchy_green(F), c = isochoric(b, determinant(F));
  CHECK(determinant(c) == Approx(1).epsilon(1e-13));
  for (int k = 1; k < 6; ++k) CHECK(c.s[k] / c.s[0] == Approx(b.s[k] / b.s[0]).epsilon(1e-13));
}

TEST_CASE("cofactors times the tensor are its determinant, in space and in plane strain") {
  const Sym<3, double> a{{2, 3, 5, 0.7, -0.4, 1.1}}, of_a = cofactors(a);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double entry = a(i, 0) * of_a(0, j) + a(i, 1) * of_a(1, j) + a(i, 2) * of_a(2, j);
      CHECK(entry == Approx(i == j ? determinant(a) : 0).margin(1e-13));
    }
  const Sym<2, double> flat{{2, 3, 5, 1.1}}, of_flat = cofactors(flat);
  const Sym<3, double> in_space{{2, 3, 5, 0, 0, 1.1}}, expected = cofactors(in_space);
  for (int i = 0; i < 3; ++i) CHECK(of_flat.s[i] == Approx(expected.s[i]));
  CHECK(of_flat(0, 1) == Approx(expected(0, 1)));
}

TEST_CASE("a tensor put together from its principal values has their invariants, and the third is zz in 2-D") {
  const double c = 0.6, s = 0.8, h = std::sqrt(0.5);
  const Mat<3, double> U{{c, -s * h, s * h, s, c * h, -c * h, 0, h, h}};
  const Vec<3, double> values{{2, -3, 5}};
  const Sym<3, double> a = from_principal(U, values);
  CHECK(trace(a) == Approx(4).epsilon(1e-14));
  CHECK(determinant(a) == Approx(-30).epsilon(1e-14));
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i)
      CHECK(a(i, 0) * U(0, k) + a(i, 1) * U(1, k) + a(i, 2) * U(2, k) == Approx(values[k] * U(i, k)).margin(1e-14));
  const Sym<2, double> flat = from_principal(Mat<2, double>{{c, -s, s, c}}, values);
  CHECK(flat(0, 0) == Approx(2 * c * c - 3 * s * s));
  CHECK(flat(0, 1) == Approx(5 * c * s));
  CHECK(flat.s[2] == 5);
}

TEST_CASE("the fastest wave of a split Neo-Hookean solid") {
  // At rest that of K + 4/3 mu; beyond J = e the logarithmic energy pushes no more, and shear is faster.
  using Sym3 = Sym<3, double>;
  const Sym3 rest = Sym3::identity();
  for (const VolumetricEnergy form :
       {VolumetricEnergy::logarithmic, VolumetricEnergy::quadratic, VolumetricEnergy::simo})
    CHECK(split_tangent<3>(form, 300, 700, rest, 1.0) == Approx(700 + 400));
  CHECK(split_tangent<3>(VolumetricEnergy::logarithmic, 300, 700, rest, 20.0) == Approx(300));
  // Flattened along x by s, isochoric b = (s^2, 1/s, 1/s), where the bounds of the eigenvalues are exact: the fastest wave
  // runs along the smallest one, mu (5/9 tr b - s^2/3).
  Sym3 b = Sym3::identity();
  b.s[0] = 0.25, b.s[1] = b.s[2] = 2;
  CHECK(split_tangent<3>(VolumetricEnergy::quadratic, 300, 700, b, 1.0) ==
        Approx(700 + 300 * (5 * 4.25 / 9 - 0.25 / 3)));
  // Stretched to (4, 1/2, 1/2) the largest eigenvalue is exact, which is that of shear waves, and the bound of the
  // smallest is below zero, so that the longitudinal wave comes out faster than it is.
  b.s[0] = 4, b.s[1] = b.s[2] = 0.5;
  CHECK(split_tangent<3>(VolumetricEnergy::quadratic, 300, 0, b, 1.0) == Approx(300 * 4));
  CHECK(split_tangent<3>(VolumetricEnergy::quadratic, 300, 700, b, 1.0) >= 700 + 300 * (25.0 / 9 - 0.5 / 3));
}

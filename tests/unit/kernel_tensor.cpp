// Small tensors against hand values.

#include <algorithm>
#include <cmath>

#include "kernel/functor.hpp"
#include "kernel/tensor.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat2 = Mat<2, double>;
using Mat3 = Mat<3, double>;
using Sym2 = Sym<2, double>;
using Sym3 = Sym<3, double>;

constexpr Mat3 example{{1, 2, 3, 0, 4, 5, 1, 0, 6}};

/// Largest eigenvalue of a symmetric tensor by the trigonometric formula of its characteristic cubic.
double largest_eigenvalue(const Sym3& a) {
  const Sym3 d = deviator(a);
  const double p = std::sqrt(squared_norm(d) / 6);
  if (p == 0) return trace(a) / 3;
  const double r = std::clamp(determinant(d) / (2 * p * p * p), -1.0, 1.0);
  return trace(a) / 3 + 2 * p * std::cos(std::acos(r) / 3);
}

/// A fixed sequence in [-1, 1].
double number(int k) {
  return std::fmod(12.9898 * (k + 1) * (k + 3), 2.0) - 1;
}

}  // namespace

TEST_CASE("matrix product and determinant") {
  const Mat3 square = example * example;
  const double expected[] = {4, 10, 31, 5, 16, 50, 7, 2, 39};
  for (int k = 0; k < 9; ++k) CHECK(square.m[k] == expected[k]);
  CHECK(determinant(example) == 22);
  CHECK(determinant(square) == 484);
  CHECK(determinant(Mat2{{1, 2, 3, 4}}) == -2);
  CHECK(determinant(Mat3::identity()) == 1);
  CHECK(determinant(Mat2::identity()) == 1);
}

TEST_CASE("symmetric tensors are stored xx yy zz yz xz xy, in 2-D xx yy zz xy") {
  Sym3 a{{1, 2, 3, 4, 5, 6}};
  CHECK(a(1, 2) == 4);
  CHECK(a(2, 0) == 5);
  CHECK(a(1, 0) == 6);
  CHECK(trace(a) == 6);
  CHECK(squared_norm(a) == 14 + 2 * (16 + 25 + 36));
  CHECK(determinant(a) == 6 + 2 * 4 * 5 * 6 - 16 - 2 * 25 - 3 * 36);
  const Sym2 b{{2, 3, 5, 1}};
  CHECK(b(1, 0) == 1);
  CHECK(trace(b) == 10);
  CHECK(squared_norm(b) == 4 + 9 + 25 + 2);
  CHECK(determinant(b) == 25);
  CHECK(std::abs(trace(deviator(a))) < 1e-15);
  CHECK(deviator(a)(0, 1) == 6);
  CHECK(Sym2::identity().s[2] == 1);
  CHECK(Sym2::identity().s[3] == 0);
}

TEST_CASE("left Cauchy-Green tensor and its plane-strain zz") {
  const Sym3 b = left_cauchy_green(example);
  const double expected[] = {14, 41, 37, 30, 19, 23};
  for (int k = 0; k < 6; ++k) CHECK(b.s[k] == expected[k]);
  const Sym2 plane = left_cauchy_green(Mat2{{1, 2, 3, 4}});
  const double expected_plane[] = {5, 25, 1, 11};
  for (int k = 0; k < 4; ++k) CHECK(plane.s[k] == expected_plane[k]);
}

TEST_CASE("a plane deformation has a stretch of its own across the plane") {
  using Plane = Deformation<2, double>;
  const Plane rest = Plane::identity();
  const double expected[] = {1, 0, 0, 1};
  for (int k = 0; k < 4; ++k) CHECK(rest.plane.m[k] == expected[k]);
  CHECK(rest.zz == 1);
  const Sym2 b = left_cauchy_green(Plane{Mat2{{1, 2, 3, 4}}, 3});
  const double expected_b[] = {5, 25, 9, 11};
  for (int k = 0; k < 4; ++k) CHECK(b.s[k] == expected_b[k]);
  // F <- (I + dt L) F, across the plane as within it.
  const Plane next = advanced(Plane{Mat2{{1, 0.5, 0, 2}}, 3}, Plane{Mat2{{0, 1, 2, 0}}, 0.4}, 0.25);
  const double expected_next[] = {1, 1, 0.5, 2.25};
  for (int k = 0; k < 4; ++k) CHECK(next.plane.m[k] == expected_next[k]);
  CHECK(next.zz == Approx(3.3));
  ElasticState<Plane> state{Plane{Mat2{{1, 0.5, 0, 2}}, 3}};  // and a solid that keeps F alone does so
  CHECK(ElasticSolid::advance(0, Plane{Mat2{{0, 1, 2, 0}}, 0.4}, 0.25, state) == 0);
  for (int k = 0; k < 4; ++k) CHECK(state.deformation_gradient.plane.m[k] == expected_next[k]);
}

TEST_CASE("a step advances the deformation gradient by (I + dt L) F") {
  const Mat2 F{{1, 0.5, 0, 2}}, L{{0, 1, 2, 0}};
  const Mat2 r = advanced(F, L, 0.25);
  const double expected[] = {1, 1, 0.5, 2.25};
  for (int k = 0; k < 4; ++k) CHECK(r.m[k] == expected[k]);
}

TEST_CASE("the eigenvalue bound is a bound, and exact for axisymmetric tensors stretched along their axis") {
  double tightest = 2, loosest = 0;
  for (int k = 0; k < 2000; ++k) {
    Mat3 F = Mat3::identity();
    for (int c = 0; c < 9; ++c) F.m[c] += 0.8 * number(9 * k + c);
    const Sym3 b = left_cauchy_green(F);
    const double ratio = largest_eigenvalue_bound(b) / largest_eigenvalue(b);
    tightest = smaller(tightest, ratio);
    loosest = larger(loosest, ratio);
  }
  CAPTURE(tightest, loosest);
  CHECK(tightest >= 1 - 1e-14);
  CHECK(loosest <= 4.0 / 3);  // reached by eigenvalues (a, a, 0)
  // Eigenvalues (4, 1, 1): the deviator is (2, -1, -1), so the bound is 2 + sqrt(2/3) sqrt(6) = 4.
  CHECK(largest_eigenvalue_bound(Sym3{{4, 1, 1, 0, 0, 0}}) == Approx(4).epsilon(1e-15));
  CHECK(largest_eigenvalue_bound(Sym3::identity()) == 1);
}

TEST_CASE(
    "tensors lie in memory as plugins' states do: of a plane a symmetric one has zz too, and so has a deformation") {
  CHECK(sizeof(Sym2) == 4 * sizeof(double));  // xx yy zz xy
  CHECK(sizeof(Sym3) == 6 * sizeof(double));
  CHECK(sizeof(Deformation<2, double>) == 5 * sizeof(double));  // xx xy yx yy zz
  CHECK(sizeof(Deformation<3, double>) == 9 * sizeof(double));
  CHECK(Deformation<2, double>::dimension == 2);
}

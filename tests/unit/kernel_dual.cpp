// Derivatives that dual numbers carry, against those that calculus gives: of elementary functions, of the rotation of a
// polar decomposition, and of functions of singular values where these are equal.

#include "kernel/dual.hpp"

#include <cmath>

#include "kernel/lanes.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

using X = Dual<double>;

X variable(double x) {
  return {x, 1};
}

template <int D>
Mat<D, X> along(const Mat<D, double>& A, const Mat<D, double>& dA) {
  return with_derivatives(A, dA);
}

template <int D>
Mat<D, double> difference(const Mat<D, double>& a, const Mat<D, double>& b) {
  Mat<D, double> r;
  for (int k = 0; k < D * D; ++k) r.m[k] = a.m[k] - b.m[k];
  return r;
}
template <int D>
double largest(const Mat<D, double>& a) {
  double r = 0;
  for (const double entry : a.m) r = larger(r, std::abs(entry));
  return r;
}

/// The logarithm ln V = U diag(ln s) U^T of the left stretch, whose derivative at F = I is the symmetric part of dF.
template <int D, class S>
Mat<D, S> left_hencky_strain(const Mat<D, S>& F) {
  const LeftStretches<D, S> parts = left_stretches(F);
  Mat<D, S> r{};
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      for (int k = 0; k < D; ++k) r(i, j) = r(i, j) + parts.U(i, k) * log(parts.stretch[k]) * parts.U(j, k);
  return r;
}

const Mat<3, double> some{{0.3, -0.7, 0.2, 0.5, 0.1, -0.4, 0.6, 0.9, -0.8}};

}  // namespace

TEST_CASE("derivatives of elementary functions") {
  const X x = variable(0.7);
  CHECK((x * x * x).derivative == Approx(3 * 0.7 * 0.7));
  CHECK((2.0 / x).derivative == Approx(-2 / (0.7 * 0.7)));
  CHECK((x / (x + 1.0)).derivative == Approx(1 / (1.7 * 1.7)));
  CHECK(sqrt(x).derivative == Approx(0.5 / std::sqrt(0.7)));
  CHECK(log(x).derivative == Approx(1 / 0.7));
  CHECK(exp(-x).derivative == Approx(-std::exp(-0.7)));
  CHECK(abs(variable(-0.7)).derivative == -1);
  CHECK(floor(x).derivative == 0);
  CHECK(max(x, 3.0 * x).derivative == 3);
  CHECK(min(x, 3.0 * x).derivative == 1);
  CHECK(select(x > 0.5, x * x, X(1.0)).derivative == Approx(1.4));
  CHECK(sqrt(X(0, 1)).derivative == 0);  // zero by choice: there is no derivative
}

TEST_CASE("every operator has the derivative of calculus, in either order of a number and a constant") {
  const X a(1.3, 0.7), b(2.1, -0.4);
  const auto check = [](const X& found, double value, double derivative) {
    CHECK(found.value == Approx(value));
    CHECK(found.derivative == Approx(derivative));
  };
  check(a + b, 3.4, 0.3);
  check(a - b, -0.8, 1.1);
  check(a * b, 2.73, 0.7 * 2.1 - 1.3 * 0.4);
  check(a / b, 1.3 / 2.1, (0.7 * 2.1 + 1.3 * 0.4) / (2.1 * 2.1));
  check(a + 2.0, 3.3, 0.7);
  check(a - 2.0, -0.7, 0.7);
  check(a * 2.0, 2.6, 1.4);
  check(a / 2.0, 0.65, 0.35);
  check(2.0 + b, 4.1, -0.4);
  check(2.0 - b, -0.1, 0.4);
  check(2.0 * b, 4.2, -0.8);
  check(2.0 / b, 2 / 2.1, 2 * 0.4 / (2.1 * 2.1));
  check(-a, -1.3, -0.7);
  X c = a;
  check(c += b, 3.4, 0.3);
  check(c -= a, 2.1, -0.4);
  check(c *= a, 2.73, 0.7 * 2.1 - 1.3 * 0.4);
  check(c, 2.73, 0.7 * 2.1 - 1.3 * 0.4);
  check(exp(a), std::exp(1.3), 0.7 * std::exp(1.3));
  check(log(a), std::log(1.3), 0.7 / 1.3);
  check(sqrt(b), std::sqrt(2.1), -0.2 / std::sqrt(2.1));
}

TEST_CASE("dual numbers compare by their values") {
  const X low(1, 5), high(2, -5);
  CHECK((low < high && !(high < low) && !(low < low)));
  CHECK((high > low && !(low > high) && !(low > low)));
  CHECK((low <= high && !(high <= low) && low <= low));
  CHECK((high >= low && !(low >= high) && low >= low));
  CHECK((low < 2.0 && !(high < 2.0)));
  CHECK((high > 1.0 && !(low > 1.0)));
  CHECK((low <= 1.0 && !(high <= 1.0)));
  CHECK((high >= 2.0 && !(low >= 2.0)));
}

TEST_CASE("packs carry the derivatives of each lane") {
  using L = Lanes<double>;
  alignas(64) double values[L::width], slopes[L::width];
  for (int i = 0; i < L::width; ++i) values[i] = 0.5 + i, slopes[i] = 1.0 - i;
  const Dual<L> x(L::load(values), L::load(slopes));
  const Dual<L> y = select(x > 1.0, x * log(x), sqrt(x));
  for (int i = 0; i < L::width; ++i) {
    CHECK(y.value[i] == Approx(values[i] > 1 ? values[i] * std::log(values[i]) : std::sqrt(values[i])));
    CHECK(y.derivative[i] ==
          Approx(slopes[i] * (values[i] > 1 ? std::log(values[i]) + 1 : 0.5 / std::sqrt(values[i]))));
  }
}

TEST_CASE("the rotation nearest to the identity turns with the skew part of its change alone") {
  const auto R = nearest_rotation(along(Mat<3, double>::identity(), some));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      CHECK(R(i, j).value == Approx(i == j ? 1 : 0).margin(1e-15));
      CHECK(R(i, j).derivative == Approx(0.5 * (some(i, j) - some(j, i))).margin(1e-15));
    }
  // In the plane the angle of F is atan2(F10 - F01, F00 + F11).
  const Mat<2, double> F{{1.3, -0.4, 0.6, 0.9}}, dF{{0.2, 0.5, -0.3, 0.7}};
  const double s = F(1, 0) - F(0, 1), c = F(0, 0) + F(1, 1), ds = dF(1, 0) - dF(0, 1), dc = dF(0, 0) + dF(1, 1);
  const double rate = (c * ds - s * dc) / (c * c + s * s), length = std::hypot(c, s);
  const auto plane = nearest_rotation(along(F, dF));
  CHECK(plane(1, 0).value == Approx(s / length));
  CHECK(plane(1, 0).derivative == Approx(c / length * rate));
  CHECK(plane(0, 0).derivative == Approx(-s / length * rate));
}

TEST_CASE("the rotation nearest to a matrix changes as differences say, however far its stretches are apart") {
  for (const double stretch : {1.0, 3.0, 400.0}) {  // the last stretch leaves the closed form to singular values
    Mat<3, double> F = some;
    for (int i = 0; i < 3; ++i) F(i, i) += i == 0 ? stretch + 1 : 2;
    const Mat<3, double> dF{{0.1, 0.4, -0.3, 0.2, -0.6, 0.5, -0.1, 0.3, 0.7}};
    Mat<3, double> ahead = F, behind = F;
    const double h = 1e-5;
    for (int k = 0; k < 9; ++k) ahead.m[k] += h * dF.m[k], behind.m[k] -= h * dF.m[k];
    Mat<3, double> rate = difference(nearest_rotation(ahead), nearest_rotation(behind));
    for (double& entry : rate.m) entry /= 2 * h;
    CHECK(largest(difference(derivatives_of(nearest_rotation(along(F, dF))), rate)) < 1e-9);
  }
}

TEST_CASE("the rotation of a matrix in the plane turns as the angle does") {
  // R of F = ((a, b), (c, d)) turns by the angle of (a + d, c - b), and so does its derivative.
  const Mat<2, double> F{{1.3, -0.4, 0.9, 0.7}}, dF{{0.2, 0.5, -0.3, 0.8}};
  const double x = 1.3 + 0.7, y = 0.9 + 0.4, dx = 0.2 + 0.8, dy = -0.3 - 0.5;
  const double length = std::hypot(x, y), rate = (x * dy - y * dx) / (length * length);
  const Mat<2, X> R = nearest_rotation(along(F, dF));
  CHECK(R(0, 0).value == Approx(x / length));
  CHECK(R(1, 0).value == Approx(y / length));
  CHECK(R(0, 0).derivative == Approx(-rate * y / length));
  CHECK(R(0, 1).derivative == Approx(-rate * x / length));
  CHECK(R(1, 0).derivative == Approx(rate * x / length));
  CHECK(R(1, 1).derivative == Approx(-rate * y / length));
}

TEST_CASE("functions of equal singular values have their derivative") {
  // The derivative of ln V at F = a I is dF_sym / a, although the directions of the stretches turn without limit.
  for (const double a : {1.0, 0.4, 1e-6, 1e6}) {  // values that are put apart by a share of themselves
    Mat<3, double> F{};
    for (int i = 0; i < 3; ++i) F(i, i) = a;
    const auto strain = left_hencky_strain(along(F, some));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        CHECK(a * strain(i, j).derivative == Approx(0.5 * (some(i, j) + some(j, i))).margin(1e-7));
  }
  const Mat<2, double> one = Mat<2, double>::identity(), change{{0.2, 0.5, -0.3, 0.7}};
  const auto plane = left_hencky_strain(along(one, change));
  CHECK(plane(0, 1).derivative == Approx(0.1).margin(1e-7));
  CHECK(plane(1, 1).derivative == Approx(0.7).margin(1e-7));
}

TEST_CASE("functions of equal singular values have their derivative in float as well") {
  for (const float a : {1.f, 0.4f, 1e-3f, 1e3f}) {
    Mat<3, float> F{}, change{};
    for (int i = 0; i < 3; ++i) F(i, i) = a;
    for (int k = 0; k < 9; ++k) change.m[k] = static_cast<float>(some.m[k]);
    const auto strain = left_hencky_strain(with_derivatives(F, change));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        CHECK(a * strain(i, j).derivative == Approx(0.5 * (some(i, j) + some(j, i))).margin(2e-3));
  }
}

TEST_CASE("a stretch that turns the matrix inside out is its size, and changes so") {
  Mat<3, double> F{}, change{};
  F(0, 0) = 2, F(1, 1) = 1.5, F(2, 2) = -1;
  change(0, 0) = 0.1, change(1, 1) = -0.2, change(2, 2) = 0.3;
  const auto found = left_stretches(along(F, change));
  double size = 0, growth = 0;
  for (int i = 0; i < 3; ++i) {
    CHECK(found.stretch[i].value > 0);
    size += found.stretch[i].value, growth += found.stretch[i].derivative;
  }
  CHECK(size == Approx(4.5));
  CHECK(growth == Approx(0.1 - 0.2 - 0.3));
}

TEST_CASE("singular values, put together again, change as the matrix does") {
  Mat<3, double> F = some;
  for (int i = 0; i < 3; ++i) F(i, i) += 1.5;
  for (const Mat<3, double>& A : {F, Mat<3, double>::identity()}) {
    const auto parts = singular_value_decomposition(along(A, some));
    CHECK(largest(difference(derivatives_of(composed(parts.U, parts.values, parts.V)), some)) < 1e-7);
  }
}

// Singular value and polar decompositions: over doubles, floats and lanes of both.

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "kernel/lanes.hpp"
#include "kernel/svd.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;

template <class T>
constexpr double epsilon = sizeof(T) == 4 ? 0x1p-23 : 0x1p-52;

template <int D, class T>
Mat<D, T> transposed(const Mat<D, T>& a) {
  Mat<D, T> r;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) r(i, j) = a(j, i);
  return r;
}

template <int D, class T>
double largest(const Mat<D, T>& a) {
  double worst = 0;
  for (T entry : a.m) worst = std::isnan(entry) ? entry : std::max(worst, std::abs(static_cast<double>(entry)));
  return worst;
}

template <int D, class T>
double distance(Mat<D, T> a, const Mat<D, T>& b) {
  for (int k = 0; k < D * D; ++k) a.m[k] = a.m[k] - b.m[k];
  return largest(a);
}

/// All that a decomposition promises, in units of rounding: `error` of the product relative to the largest entry.
template <int D, class T>
struct Judged {
  double product = 0, orthogonal = 0, order = 0;
};

template <int D, class T>
Judged<D, T> judged(const Mat<D, T>& A, const SingularValues<D, T>& r) {
  Judged<D, T> judged;
  const double size = largest(A);
  Vec<D, T> shrunk;  // shrunk, so that the product of a huge or minute matrix stays in range
  for (int i = 0; i < D; ++i) shrunk[i] = size > 0 ? static_cast<T>(r.values[i] / size) : r.values[i];
  Mat<D, T> relative = A;
  for (T& entry : relative.m) entry = size > 0 ? static_cast<T>(entry / size) : entry;
  judged.product = distance(composed(r.U, shrunk, r.V), relative) / epsilon<T>;
  for (const Mat<D, T>& rotation : {r.U, r.V}) {
    const double skew = distance(rotation * transposed(rotation), Mat<D, T>::identity());
    const double stretch = std::abs(static_cast<double>(determinant(rotation)) - 1);
    judged.orthogonal = larger(judged.orthogonal, larger(skew, stretch) / epsilon<T>);
  }
  for (int i = 0; i + 1 < D; ++i) {
    judged.order = larger(judged.order, (std::abs(shrunk[i + 1]) - shrunk[i]) / epsilon<T>);
    judged.order = larger(judged.order, -static_cast<double>(r.values[i]));
  }
  return judged;
}

template <int D, class T>
void check(const Mat<D, T>& A) {
  const Judged<D, T> j = judged(A, singular_value_decomposition(A));
  std::vector<double> entries(A.m, A.m + D * D);
  CAPTURE(D, sizeof(T), entries, j.product, j.orthogonal, j.order);
  // The bound is 1e-14 of the largest entry in double, and the same number of roundings in float.
  CHECK(j.product <= 45);
  CHECK(j.orthogonal <= 45);
  CHECK(j.order <= 16);
}

template <int D, class T>
Mat<D, T> random_matrix(std::mt19937& numbers) {
  Mat<D, T> r;
  for (T& entry : r.m) entry = static_cast<T>(std::ldexp(static_cast<double>(numbers()), -31) - 1);
  return r;
}

template <int D, class T>
Mat<D, T> random_rotation(std::mt19937& numbers) {
  return polar_rotation(random_matrix<D, T>(numbers));
}

template <int D, class T>
Mat<D, T> scaled(Mat<D, T> a, double factor) {
  for (T& entry : a.m) entry = static_cast<T>(entry * factor);
  return a;
}

/// Matrices of every awkward sort.
template <int D, class T>
std::vector<Mat<D, T>> matrices() {
  std::mt19937 numbers(20240611);
  std::vector<Mat<D, T>> all{Mat<D, T>{}, Mat<D, T>::identity(), scaled(Mat<D, T>::identity(), -1)};
  for (int k = 0; k < 2000; ++k) {
    const Mat<D, T> A = random_matrix<D, T>(numbers), Q = random_rotation<D, T>(numbers),
                    R = random_rotation<D, T>(numbers);
    all.push_back(A);
    all.push_back(Q);
    Vec<D, T> values{};
    values[0] = T(1 + k % 7);
    all.push_back(composed(Q, values, R));  // values of rank one
    values[1] = values[0];
    all.push_back(composed(Q, values, R));  // repeated values; singular in 3-D
    values[D - 1] = -values[0];
    all.push_back(composed(Q, values, R));  // a reflection with equal stretches
    values[D - 1] = static_cast<T>(std::ldexp(1.0, -(k % 60)));
    values[1] = static_cast<T>(values[0] * (1 + (k % 5) * epsilon<T>));
    all.push_back(composed(Q, values, R));  // nearly repeated values, badly conditioned
    Mat<D, T> sparse = A;
    for (int i = 0; i < D * D; ++i)
      if (k >> (i % 11) & 1) sparse.m[i] = 0;
    all.push_back(sparse);
    Mat<D, T> graded = A;  // columns of very different size
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) graded(i, j) = static_cast<T>(std::ldexp(graded(i, j), -j * (k % 40)));
    all.push_back(graded);
    all.push_back(transposed(graded));
  }
  return all;
}

template <int D, class T>
void check_lanes() {
  using L = Lanes<T>;
  const std::vector<Mat<D, T>> all = matrices<D, T>();
  double worst = 0, skew = 0;
  for (std::size_t first = 0; first + L::width <= all.size(); first += L::width) {
    Mat<D, L> A{};
    for (int k = 0; k < D * D; ++k)
      for (int lane = 0; lane < L::width; ++lane) A.m[k].v[lane] = all[first + static_cast<std::size_t>(lane)].m[k];
    const SingularValues<D, L> packed = singular_value_decomposition(A);
    for (int lane = 0; lane < L::width; ++lane) {
      SingularValues<D, T> one;
      for (int k = 0; k < D * D; ++k) one.U.m[k] = packed.U.m[k][lane], one.V.m[k] = packed.V.m[k][lane];
      for (int i = 0; i < D; ++i) one.values[i] = packed.values[i][lane];
      const Judged<D, T> j = judged(all[first + static_cast<std::size_t>(lane)], one);
      worst = larger(worst, j.product), skew = larger(skew, j.orthogonal);
    }
  }
  CHECK(worst <= 45);
  CHECK(skew <= 45);
}

}  // namespace

TEMPLATE_TEST_CASE("singular value decomposition: random, singular, repeated, reflected, graded", "", float, double) {
  for (const auto& A : matrices<2, TestType>()) check<2, TestType>(A);
  for (const auto& A : matrices<3, TestType>()) check<3, TestType>(A);
}

TEMPLATE_TEST_CASE("singular value decomposition over lanes", "", float, double) {
  check_lanes<2, TestType>();
  check_lanes<3, TestType>();
}

TEMPLATE_TEST_CASE("left stretches agree with the singular values", "", float, double) {
  double value = 0, product = 0, rotation = 0;
  for (const Mat<3, TestType>& A : matrices<3, TestType>()) {
    const LeftStretches<3, TestType> r = left_stretches(A);
    const SingularValues<3, TestType> s = singular_value_decomposition(A);
    double stretches[] = {r.stretch[0], r.stretch[1], r.stretch[2]};
    std::sort(stretches, stretches + 3, std::greater<>());
    const double size = std::max(1.0, largest(A)), unit = epsilon<TestType>;
    for (int i = 0; i < 3; ++i) value = larger(value, std::abs(stretches[i] - std::abs(s.values[i])) / (size * unit));
    Vec<3, TestType> squared = r.stretch;
    for (TestType& entry : squared.v) entry *= entry;
    product = larger(product, distance(composed(r.U, squared, r.U), A * transposed(A)) / (size * size * unit));
    rotation = larger(rotation, distance(r.U * transposed(r.U), Mat<3, TestType>::identity()) / unit);
  }
  CHECK(value <= 45);
  CHECK(product <= 96);  // a square has twice the error of its root, and the product rounds as well
  CHECK(rotation <= 45);
}

TEST_CASE("singular values do not mind the size of the matrix") {
  std::mt19937 numbers(5);
  for (int k = 0; k < 200; ++k) {
    const Mat<3, double> A = random_matrix<3, double>(numbers);
    const Vec<3, double> unscaled = singular_value_decomposition(A).values;
    for (double size : {1e-200, 1e-30, 1e30, 1e150}) {
      check<3, double>(scaled(A, size));
      check<2, double>({{A.m[0] * size, A.m[1] * size, A.m[2] * size, A.m[3] * size}});
      const Vec<3, double> values = singular_value_decomposition(scaled(A, size)).values;
      for (int i = 0; i < 3; ++i) CHECK(std::abs(values[i] / size - unscaled[i]) <= 1e-14 * unscaled[0]);
    }
    for (double size : {1e-30, 1e30}) check<3, float>(scaled(random_matrix<3, float>(numbers), size));
  }
}

TEST_CASE("the identity and diagonal matrices decompose without rounding") {
  const SingularValues<3, double> one = singular_value_decomposition(Mat<3, double>::identity());
  CHECK(distance(one.U, Mat<3, double>::identity()) == 0);
  CHECK(distance(one.V, Mat<3, double>::identity()) == 0);
  for (double value : one.values.v) CHECK(value == 1);
  const Vec<3, double> sorted = singular_value_decomposition(Mat<3, double>{{-2, 0, 0, 0, 8, 0, 0, 0, 4}}).values;
  CHECK(sorted[0] == 8);
  CHECK(sorted[1] == 4);
  CHECK(sorted[2] == -2);  // the determinant's sign rests on the last
}

TEST_CASE("small singular values of a graded matrix keep their own digits") {
  // Columns 1, 1e-8 and 1e-16: one-sided Jacobi loses nothing to the large ones.
  const Mat<3, double> A{{1, 1e-8, 1e-16, 0, 1e-8, 1e-16, 0, 0, 1e-16}};
  const Vec<3, double> values = singular_value_decomposition(A).values;
  CHECK(std::abs(values[0] * values[1] * values[2] / 1e-24 - 1) <= 1e-14);  // the determinant
  CHECK(std::abs(values[1] / 1e-8 - 1) <= 1e-12);
}

TEMPLATE_TEST_CASE("polar decomposition: A = R P with a rotation and a symmetric factor", "", float, double) {
  std::mt19937 numbers(9);
  double skew = 0, rotation = 0, least = 1;
  for (int k = 0; k < 2000; ++k) {
    Mat<3, TestType> A = random_matrix<3, TestType>(numbers);
    for (int i = 0; i < 3; ++i) A(i, i) += TestType(1.5);
    const Mat<3, TestType> R = polar_rotation(A), P = transposed(R) * A;
    skew = larger(skew, distance(P, transposed(P)) / epsilon<TestType>);
    rotation = larger(rotation, distance(R * transposed(R), Mat<3, TestType>::identity()) / epsilon<TestType>);
    if (determinant(A) > 0) least = smaller(least, static_cast<double>(P(0, 0)));
  }
  CHECK(skew <= 64);
  CHECK(rotation <= 32);
  CHECK(least > 0);
  // A matrix that is a rotation already is its own polar factor.
  const Mat<3, TestType> Q = random_rotation<3, TestType>(numbers);
  CHECK(distance(polar_rotation(Q), Q) <= 16 * epsilon<TestType>);
}

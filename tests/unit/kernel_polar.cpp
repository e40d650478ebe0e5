// The rotation nearest to a matrix: against Eigen's singular values in double and against svd.hpp, over doubles, floats
// and lanes of both.

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "kernel/lanes.hpp"
#include "kernel/polar.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;

template <class T>
constexpr double unit = sizeof(T) == 4 ? 0x1p-23 : 0x1p-52;

template <int D>
using Exact = Eigen::Matrix<double, D, D, Eigen::RowMajor>;

template <int D, class T>
Exact<D> exact(const Mat<D, T>& A) {
  Exact<D> r;
  for (int k = 0; k < D * D; ++k) r.data()[k] = A.m[k];
  return r;
}

template <int D, class T>
Mat<D, T> rounded(const Exact<D>& A) {
  Mat<D, T> r;
  for (int k = 0; k < D * D; ++k) r.m[k] = static_cast<T>(A.data()[k]);
  return r;
}

/// Eigen's answer, and how much a relative change of F is amplified in it: s1 / (s2 + s3), infinite where it is not
/// unique; the last singular value takes the sign of det F.
template <int D>
struct Reference {
  Exact<D> R;
  double condition;
};

template <int D>
Reference<D> reference(const Exact<D>& F) {
  const Eigen::JacobiSVD<Exact<D>> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Exact<D> U = svd.matrixU();
  double last = svd.singularValues()[D - 1];
  if (U.determinant() * svd.matrixV().determinant() < 0) U.col(D - 1) *= -1, last = -last;
  return {U * svd.matrixV().transpose(), svd.singularValues()[0] / (svd.singularValues()[D - 2] + last)};
}

template <int D>
Exact<D> random_matrix(std::mt19937& numbers) {
  Exact<D> r;
  for (int k = 0; k < D * D; ++k) r.data()[k] = std::ldexp(static_cast<double>(numbers()), -31) - 1;
  return r;
}

template <int D>
Exact<D> random_rotation(std::mt19937& numbers) {
  return reference<D>(random_matrix<D>(numbers)).R;
}

/// The product U diag(values) V^T with random rotations.
template <int D>
Exact<D> stretched(std::mt19937& numbers, const double* values) {
  Exact<D> S = Exact<D>::Zero();
  for (int i = 0; i < D; ++i) S(i, i) = values[i];
  return random_rotation<D>(numbers) * S * random_rotation<D>(numbers).transpose();
}

double logarithmic(std::mt19937& numbers, double low, double high) {
  return low * std::pow(high / low, std::ldexp(static_cast<double>(numbers()), -32));
}

/// Worst errors in units of rounding: `turned` of the rotation, over its condition; `skew` of R R^T - I.
struct Errors {
  double turned = 0, skew = 0, of_svd = 0;
  bool proper = true;
};

template <int D, class T>
void judge(const Mat<D, T>& F, const Mat<D, T>& found, Errors& errors) {
  const Exact<D> R = exact(found);
  const double skew = (R * R.transpose() - Exact<D>::Identity()).cwiseAbs().maxCoeff() / unit<T>;
  errors.skew = std::isnan(skew) ? std::numeric_limits<double>::infinity() : std::max(errors.skew, skew);
  errors.proper &= R.determinant() > 0;
  const Reference<D> expected = reference(exact(F));
  const double size = unit<T> * std::max(1.0, expected.condition);
  if (!(size < 0.01)) return;  // the rotation is not known that well
  errors.turned = larger(errors.turned, (R - expected.R).cwiseAbs().maxCoeff() / size);
  errors.of_svd = larger(errors.of_svd, (R - exact(polar_rotation(F))).cwiseAbs().maxCoeff() / size);
}

template <int D, class T>
void check(const std::vector<Mat<D, T>>& all) {
  Errors errors;
  for (const Mat<D, T>& F : all) judge(F, nearest_rotation(F), errors);
  CAPTURE(D, sizeof(T));
  CHECK(errors.turned <= 12);
  CHECK(errors.of_svd <= 45);  // bound of svd.hpp itself
  CHECK(errors.skew <= 32);    // bound of svd.hpp, where it takes over
  CHECK(errors.proper);
}

template <int D, class T>
std::vector<Mat<D, T>> moderate(double strain) {
  std::mt19937 numbers(20250611);
  std::vector<Mat<D, T>> all;
  for (int k = 0; k < 2000; ++k)
    all.push_back(
        rounded<D, T>(random_rotation<D>(numbers) * (Exact<D>::Identity() + strain * random_matrix<D>(numbers))));
  return all;
}

/// Checks stretches from 1e-3 to 1e3, of either sign of the determinant.
template <int D, class T>
std::vector<Mat<D, T>> extreme() {
  std::mt19937 numbers(7);
  std::vector<Mat<D, T>> all;
  for (int k = 0; k < 4000; ++k) {
    double values[3];
    for (double& value : values) value = logarithmic(numbers, 1e-3, 1e3);
    if (k % 4 == 3) values[0] = -values[0];
    all.push_back(rounded<D, T>(stretched<D>(numbers, values)));
  }
  return all;
}

/// Checks matrices that have no unique rotation, or nearly none, and those at the ends of the range.
template <int D, class T>
std::vector<Mat<D, T>> degenerate() {
  std::mt19937 numbers(11);
  std::vector<Mat<D, T>> all{Mat<D, T>{}, rounded<D, T>(-Exact<D>::Identity())};
  for (int k = 0; k < 1000; ++k) {
    const double small = std::ldexp(1.0, -(k % 60)), one = 1 + (k % 3);
    const double rows[][3] = {{one, 0, 0},     {one, one, 0},        {one, small, small},
                              {one, 1, small}, {one, one, -one},     {one, one * (1 - small), -one},
                              {0, 0, 0},       {one, small, -small}, {1e3, small, small * small}};
    for (const double* values : rows) all.push_back(rounded<D, T>(stretched<D>(numbers, values)));
    const double shift = std::pow(10.0, k % 60 - 30);
    all.push_back(rounded<D, T>(shift * random_matrix<D>(numbers)));
  }
  return all;
}

template <int D, class T>
Mat<D, Lanes<T>> packed(const std::vector<Mat<D, T>>& all, std::size_t first, int shift) {
  Mat<D, Lanes<T>> r{};
  for (int lane = 0; lane < Lanes<T>::width; ++lane)
    for (int k = 0; k < D * D; ++k)
      r.m[k].v[lane] = all[first + static_cast<std::size_t>((lane + shift) % Lanes<T>::width)].m[k];
  return r;
}

template <int D, class T>
Mat<D, T> lane_of(const Mat<D, Lanes<T>>& pack, int lane) {
  Mat<D, T> r;
  for (int k = 0; k < D * D; ++k) r.m[k] = pack.m[k][lane];
  return r;
}

/// Checks that each lane is as good as alone, and has the same bits whichever matrices share the pack.
template <int D, class T>
void check_lanes() {
  std::vector<Mat<D, T>> all;
  const std::vector<Mat<D, T>> kinds[] = {moderate<D, T>(0.3), extreme<D, T>(), degenerate<D, T>()};
  for (std::size_t k = 0; k < 1600; ++k) all.push_back(kinds[k % 3][k % kinds[k % 3].size()]);
  Errors errors;
  bool same = true;
  for (std::size_t first = 0; first < all.size(); first += Lanes<T>::width) {
    const Mat<D, Lanes<T>> R = nearest_rotation(packed(all, first, 0)), other = nearest_rotation(packed(all, first, 1));
    for (int lane = 0; lane < Lanes<T>::width; ++lane) {
      judge(all[first + static_cast<std::size_t>(lane)], lane_of(R, lane), errors);
      for (int k = 0; k < D * D; ++k)
        same &= R.m[k][lane] == other.m[k][(lane + Lanes<T>::width - 1) % Lanes<T>::width];
    }
  }
  CAPTURE(D, sizeof(T));
  CHECK(errors.turned <= 12);
  CHECK(errors.skew <= 32);  // bound of svd.hpp, where it takes over
  CHECK(errors.proper);
  CHECK(same);
}

}  // namespace

TEMPLATE_TEST_CASE("nearest rotation at small and moderate strains and any turn", "", float, double) {
  for (const double strain : {0.0, 1e-6, 1e-3, 0.1, 0.3}) {
    check(moderate<2, TestType>(strain));
    check(moderate<3, TestType>(strain));
  }
}

TEMPLATE_TEST_CASE("nearest rotation at stretches of 1e-3 to 1e3, inverted ones too", "", float, double) {
  check(extreme<2, TestType>());
  check(extreme<3, TestType>());
}

TEMPLATE_TEST_CASE("nearest rotation of singular matrices is a rotation", "", float, double) {
  check(degenerate<2, TestType>());
  check(degenerate<3, TestType>());
}

TEMPLATE_TEST_CASE("nearest rotation over lanes", "", float, double) {
  check_lanes<2, TestType>();
  check_lanes<3, TestType>();
}

TEMPLATE_TEST_CASE("the nearest rotation of a turn about an axis is that turn", "", float, double) {
  for (const double angle : {1e-6, 0.1, 1.0, 1.5707963267948966, 3.0, 3.141592653589793}) {
    const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 3).normalized();
    const Exact<3> Q = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    CHECK((exact(nearest_rotation(rounded<3, TestType>(Q))) - Q).cwiseAbs().maxCoeff() <= 6 * unit<TestType>);
    const Exact<2> q = Eigen::Rotation2Dd(angle).toRotationMatrix();
    CHECK((exact(nearest_rotation(rounded<2, TestType>(q))) - q).cwiseAbs().maxCoeff() <= 4 * unit<TestType>);
  }
  CHECK(exact(nearest_rotation(Mat<2, TestType>::identity())) == Exact<2>::Identity());
}

TEST_CASE("a lane without numbers spoils no other") {
  using L = Lanes<double>;
  std::vector<Mat<3, double>> all = moderate<3, double>(0.3);
  const Mat<3, L> clean = nearest_rotation(packed(all, 0, 0));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    all[1](2, 0) = bad;
    const Mat<3, L> spoiled = nearest_rotation(packed(all, 0, 0));
    for (int lane = 0; lane < L::width; ++lane)
      if (lane != 1) CHECK(exact(lane_of(spoiled, lane)) == exact(lane_of(clean, lane)));
  }
}

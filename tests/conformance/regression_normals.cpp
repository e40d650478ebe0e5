// The normal of linear regression against the same least squares solved by QR, with the penalty as rows of their own, and
// that of logistic regression against the same sum of squares minimized by Levenberg and Marquardt's method of MINPACK.

#include <Eigen/Dense>
#include <algorithm>
#include <random>
#include <unsupported/Eigen/NonLinearOptimization>

#include "normals/linear_regression/linear_regression.hpp"
#include "normals/logistic_regression/logistic_regression.hpp"
#include "plugin/sdk/points.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;

/// Particles of one body as a host hands them over: lanes beyond them repeat the first, with no weight.
struct Cloud {
  std::vector<double> position, weight;
  std::uint32_t count, stride;

  explicit Cloud(const std::vector<Vec<3, double>>& places, std::mt19937* random = nullptr)
      : count(static_cast<std::uint32_t>(places.size())), stride((count + MPM_LANES - 1) / MPM_LANES * MPM_LANES) {
    position.resize(std::size_t{3} * stride), weight.resize(stride);
    std::uniform_real_distribution<double> share(0.1, 1);
    for (std::size_t k = 0; k < stride; ++k) {
      const bool is_one = k < places.size();
      for (std::size_t i = 0; i < 3; ++i) position[i * stride + k] = places[is_one ? k : 0][static_cast<int>(i)];
      if (is_one) weight[k] = random ? share(*random) : 0.5;
    }
  }
  double place(int axis, std::uint32_t k) const { return position[static_cast<std::size_t>(axis) * stride + k]; }
};

template <class Regression, int D>
bool regression(double penalty, const Cloud& a, const Cloud& b, double* normal) {
  const mpm_normal_points points{a.count,           a.stride,        b.count,         b.stride, a.position.data(),
                                 b.position.data(), a.weight.data(), b.weight.data(), normal};
  return Regression::template find<D>({penalty}, sdk::clouds_of(points), normal);
}

/// The unit slope that minimizes sum w (c - b - s . x)^2 + penalty s^2.
template <int D>
Eigen::VectorXd least_squares(double penalty, const Cloud& a, const Cloud& b) {
  const Eigen::Index rows = Eigen::Index{a.count} + Eigen::Index{b.count};
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows + D, D + 1);
  Eigen::VectorXd labels = Eigen::VectorXd::Zero(rows + D);
  Eigen::Index row = 0;
  for (const Cloud* cloud : {&a, &b})
    for (std::uint32_t k = 0; k < cloud->count; ++k, ++row) {
      const double root = std::sqrt(cloud->weight[k]);
      for (int i = 0; i < D; ++i) A(row, i) = root * cloud->place(i, k);
      A(row, D) = root;
      labels(row) = cloud == &a ? -root : root;
    }
  for (int i = 0; i < D; ++i) A(rows + i, i) = std::sqrt(penalty);
  return Eigen::VectorXd(A.colPivHouseholderQr().solve(labels)).head(D).normalized();
}

/// What MINPACK is asked: residuals sqrt(w) (c - tanh(z/2)), z = s . x + b, and sqrt(penalty) s with their derivatives.
template <int D>
struct LogisticResiduals {
  using Scalar = double;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;

  double penalty;
  const Cloud &a, &b;

  int inputs() const { return D + 1; }
  int values() const { return static_cast<int>(a.count + b.count) + D; }
  int operator()(const Eigen::VectorXd& plane, Eigen::VectorXd& residuals) const {
    each(plane, [&](int row, double root, double label, double z, const Eigen::VectorXd&) {
      residuals(row) = root * (label - std::tanh(0.5 * z));
    });
    for (int i = 0; i < D; ++i) residuals(values() - D + i) = std::sqrt(penalty) * plane(i);
    return 0;
  }
  int df(const Eigen::VectorXd& plane, Eigen::MatrixXd& jacobian) const {
    jacobian.setZero();
    each(plane, [&](int row, double root, double, double z, const Eigen::VectorXd& x) {
      jacobian.row(row) = -0.5 * root / std::pow(std::cosh(0.5 * z), 2) * x.transpose();
    });
    for (int i = 0; i < D; ++i) jacobian(values() - D + i, i) = std::sqrt(penalty);
    return 0;
  }

 private:
  template <class Visit>
  void each(const Eigen::VectorXd& plane, const Visit& visit) const {
    int row = 0;
    for (const Cloud* cloud : {&a, &b})
      for (std::uint32_t k = 0; k < cloud->count; ++k, ++row) {
        Eigen::VectorXd x = Eigen::VectorXd::Ones(D + 1);
        for (int i = 0; i < D; ++i) x(i) = cloud->place(i, k);
        visit(row, std::sqrt(cloud->weight[k]), cloud == &a ? -1.0 : 1.0, plane.dot(x), x);
      }
  }
};

/// The plane, slope then offset, that minimizes sum w (c - tanh((b + s . x)/2))^2 + penalty s^2, from a first one.
template <int D>
Eigen::VectorXd logistic_plane(double penalty, const Cloud& a, const Cloud& b, Eigen::VectorXd plane) {
  LogisticResiduals<D> residuals{penalty, a, b};
  Eigen::LevenbergMarquardt<LogisticResiduals<D>> method(residuals);
  method.parameters.ftol = method.parameters.xtol = 1e-15, method.parameters.maxfev = 4000;
  method.minimize(plane);
  return plane;
}

/// The unit slope of the plane that is found from the plane 0.
template <int D>
Eigen::VectorXd logistic_fit(double penalty, const Cloud& a, const Cloud& b) {
  const Eigen::VectorXd plane = logistic_plane<D>(penalty, a, b, Eigen::VectorXd::Zero(D + 1));
  return Eigen::VectorXd(plane.head(D)).normalized();
}

/// Two clouds of one to eleven particles that overlap, of one weight or of weights that differ up to e^4 times.
std::pair<Cloud, Cloud> overlapping_clouds(unsigned seed, int D, bool are_even) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Vec<3, double>> places[2];
  std::vector<double> weights[2];
  int counts[2];
  for (int& count : counts) count = 1 + static_cast<int>(5.5 * (1 + number(random)));
  for (int side = 0; side < 2; ++side)
    for (int k = 0; k < counts[side]; ++k) {
      const double x = 1.5 * number(random) + (side == 0 ? -0.3 : 0.3), y = 1.5 * number(random);
      places[side].push_back({{x, y, D == 3 ? 1.5 * number(random) : 0}});
      weights[side].push_back(are_even ? 0.5 : std::exp(2 * number(random)));
    }
  std::pair<Cloud, Cloud> clouds{places[0], places[1]};
  std::copy(weights[0].begin(), weights[0].end(), clouds.first.weight.begin());
  std::copy(weights[1].begin(), weights[1].end(), clouds.second.weight.begin());
  return clouds;
}

/// Holds the normal of overlapping clouds against the plane that MINPACK's method follows while the penalty falls from 1.
template <int D>
void check_falling_penalty(unsigned seed, bool are_even) {
  const auto [a, b] = overlapping_clouds(seed, D, are_even);
  double normal[3] = {};
  CAPTURE(D, seed, are_even, a.count, b.count);
  REQUIRE(regression<LogisticRegression, D>(1e-6, a, b, normal));
  Eigen::VectorXd planes[2];
  for (const int factor : {10, 3}) {
    Eigen::VectorXd& plane = planes[factor == 3];
    plane = Eigen::VectorXd::Zero(D + 1);
    for (double penalty = 1; penalty > 1.01e-6; penalty /= factor) plane = logistic_plane<D>(penalty, a, b, plane);
    plane = logistic_plane<D>(1e-6, a, b, plane);
  }
  const Eigen::VectorXd expected = planes[0].head(D).normalized();
  for (int i = 0; i < D; ++i) {
    REQUIRE(planes[1].head(D).normalized()(i) == Approx(expected(i)).margin(1e-7));  // one minimum is come to
    CHECK(normal[i] == Approx(expected(i)).margin(1e-6));
  }
}

struct Moments {
  template <class S>
  void operator()(const Vec<3, S>& place, const S& weight, S* values) const {
    values[0] = weight, values[1] = weight * place[0] * place[2], values[2] = weight * place[1];
  }
};

/// The quadratic B-spline of a node, x cells from it.
double spline(double x) {
  x = std::abs(x);
  return x < 0.5 ? 0.75 - x * x : x < 1.5 ? 0.5 * (1.5 - x) * (1.5 - x) : 0;
}

template <class Regression, int D, class Fit>
void check_random_clouds(double penalty, const Fit& fit, double bound) {
  std::mt19937 random(29);
  std::uniform_real_distribution<double> along(-1.5, 1.5), across(-1.2, 0.3);
  for (int k = 0; k < 20; ++k) {
    std::vector<Vec<3, double>> first, second;
    for (int i = 0; i < 9; ++i) {
      const double z = D == 3 ? along(random) : 0;
      first.push_back({{across(random), along(random), z}});
      second.push_back({{-across(random) + 0.4 * along(random), along(random), D == 3 ? along(random) : 0}});
    }
    const Cloud a(first, &random), b(second, &random);
    double normal[3] = {};
    REQUIRE(regression<Regression, D>(penalty, a, b, normal));
    const Eigen::VectorXd expected = fit(penalty, a, b);
    for (int i = 0; i < D; ++i) CHECK(normal[i] == Approx(expected(i)).margin(bound));
  }
}

}  // namespace

TEST_CASE("linear regression has the normal of least squares solved by QR") {
  for (const double penalty : {1e-6, 0.5}) {
    check_random_clouds<LinearRegression, 2>(penalty, least_squares<2>, 1e-10);
    check_random_clouds<LinearRegression, 3>(penalty, least_squares<3>, 1e-10);
  }
}

TEST_CASE("logistic regression has the normal of the same squares minimized by MINPACK's method") {
  for (const double penalty : {1e-6, 1e-2, 0.5}) {
    check_random_clouds<LogisticRegression, 2>(penalty, logistic_fit<2>, 1e-7);
    check_random_clouds<LogisticRegression, 3>(penalty, logistic_fit<3>, 1e-7);
  }
}

TEST_CASE("logistic regression has that normal too where weights differ by thousands") {
  // Undamped steps go astray in a tenth of these.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int k = 0; k < 40; ++k) {
    std::vector<Cloud> clouds;
    for (const double side : {-1.0, 1.0}) {
      std::vector<Vec<3, double>> places;
      for (int i = 0; i < 30; ++i)
        places.push_back({{side * 0.6 * (1 + number(random)), 1.5 * number(random), 1.5 * number(random)}});
      clouds.emplace_back(places);
      for (std::uint32_t i = 0; i < clouds.back().count; ++i) clouds.back().weight[i] = std::exp(4 * number(random));
    }
    const double penalty = k % 2 ? 1e-2 : 1e-6;
    double normal[3] = {};
    CAPTURE(k, penalty);
    REQUIRE(regression<LogisticRegression, 3>(penalty, clouds[0], clouds[1], normal));
    const Eigen::VectorXd expected = logistic_fit<3>(penalty, clouds[0], clouds[1]);
    for (int i = 0; i < 3; ++i) CHECK(normal[i] == Approx(expected(i)).margin(1e-7));
  }
}

TEST_CASE("logistic regression has that normal too where a plane parts two lattices, far as the slope then grows") {
  // As nodes see faces that lie anyhow in a grid. The slope comes to some thirty a cell; steps of Gauss and Newton, whose matrix
  // has half of the curvature there, swing about the minimum, and MINPACK's come to it from that of a higher penalty.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int k = 0; k < 40; ++k) {
    std::vector<Vec<3, double>> places[2];
    std::vector<double> weights[2];
    const double angle = 4 * number(random), shift[] = {number(random), number(random)}, face = 0.5 * number(random);
    for (int i = -4; i <= 4; ++i)
      for (int j = -4; j <= 4; ++j) {
        const double x = 0.5 * i + 0.25 * shift[0], y = 0.5 * j + 0.25 * shift[1];
        const double weight = spline(x) * spline(y), d = std::cos(angle) * x + std::sin(angle) * y - face;
        if (weight <= 0 || std::abs(d) < 0.2) continue;
        places[d > 0].push_back({{x, y, 0}}), weights[d > 0].push_back(weight);
      }
    Cloud a(places[0]), b(places[1]);
    std::copy(weights[0].begin(), weights[0].end(), a.weight.begin());
    std::copy(weights[1].begin(), weights[1].end(), b.weight.begin());
    double normal[3] = {};
    CAPTURE(k, a.count, b.count);
    REQUIRE(regression<LogisticRegression, 2>(1e-6, a, b, normal));
    Eigen::VectorXd plane = Eigen::VectorXd::Zero(3);
    for (double penalty = 1; penalty > 0.99e-6; penalty /= 10) plane = logistic_plane<2>(penalty, a, b, plane);
    const Eigen::VectorXd expected = plane.head(2).normalized();
    for (int i = 0; i < 2; ++i) CHECK(normal[i] == Approx(expected(i)).margin(1e-6));
  }
}

TEST_CASE("logistic regression follows the minimum as the penalty falls, where other ways end elsewhere or too soon") {
  // Found among some thousand clouds: each is one where a step without its safeguards comes to another minimum or to none.
  for (const unsigned seed : {7u, 184u, 494u, 952u, 1127u, 2861u}) check_falling_penalty<2>(seed, true);
  for (const unsigned seed : {12u, 267u, 514u}) check_falling_penalty<3>(seed, true);
  check_falling_penalty<2>(1415, false);
  check_falling_penalty<3>(1263, false);
}

TEST_CASE("of equal bodies a tiny way apart, regression has the direction of that way") {
  // Corners of a square or cube have the same moment along all axes, so that the slope of least squares lies along the way;
  // the slope is so small that the logistic curve is a line.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  for (const double way : {1e-6, 1e-7, 3e-8})
    for (int k = 0; k < 20; ++k) {
      const double middle[] = {number(random), number(random), number(random)};
      Eigen::Vector3d along(number(random), number(random), k % 2 ? 0 : number(random));
      along.normalize();
      std::vector<Vec<3, double>> here, there;
      for (int corner = 0; corner < (k % 2 ? 4 : 8); ++corner) {
        Vec<3, double> place{};
        for (int i = 0; i < (k % 2 ? 2 : 3); ++i) place[i] = middle[i] + (corner >> i & 1 ? 0.5 : -0.5);
        here.push_back(place);
        for (int i = 0; i < 3; ++i) place[i] += way * along(i);
        there.push_back(place);
      }
      const Cloud a(here), b(there);
      double of_line[3] = {}, of_curve[3] = {};
      CAPTURE(way, k);
      REQUIRE((k % 2 ? regression<LinearRegression, 2>(1e-6, a, b, of_line)
                     : regression<LinearRegression, 3>(1e-6, a, b, of_line)));
      REQUIRE((k % 2 ? regression<LogisticRegression, 2>(1e-6, a, b, of_curve)
                     : regression<LogisticRegression, 3>(1e-6, a, b, of_curve)));
      for (int i = 0; i < (k % 2 ? 2 : 3); ++i) {
        CHECK(of_line[i] == Approx(along(i)).margin(1e-7));
        CHECK(of_curve[i] == Approx(along(i)).margin(1e-7));
      }
    }
}

TEST_CASE("of equal clouds a tiny way apart the logistic curve is a line, and its normal that of least squares") {
  // Near z = 0 the curve is z / 2: with s' = s / 2 the penalty on s is one of four times its size on s'.
  std::mt19937 random(13);
  std::uniform_real_distribution<double> number(-1, 1);
  for (const double way : {1e-5, 1e-6, 1e-7})
    for (int k = 0; k < 30; ++k) {
      const double step[] = {way * number(random), way * number(random), way * number(random)};
      std::vector<Vec<3, double>> here, there;
      for (int particle = 0; particle < 6; ++particle) {
        here.push_back({{number(random), number(random), number(random)}});
        const Vec<3, double>& from = here.back();
        there.push_back({{from[0] + step[0], from[1] + step[1], from[2] + step[2]}});
      }
      const Cloud a(here), b(there);
      double normal[3] = {};
      CAPTURE(way, k);
      REQUIRE(regression<LogisticRegression, 3>(1e-6, a, b, normal));
      const Eigen::VectorXd expected = least_squares<3>(4e-6, a, b);
      for (int i = 0; i < 3; ++i) CHECK(normal[i] == Approx(expected(i)).margin(1e-6));
    }
}

TEST_CASE("where particles leave a direction open, the penalty of linear regression leaves it out of the normal") {
  // All particles lie on the line y = x / 2: the slope across it is free, and the least one lies along the line.
  const Cloud a({{{-0.8, -0.4, 0}}, {{-0.2, -0.1, 0}}}), b({{{0.4, 0.2, 0}}, {{1, 0.5, 0}}});
  double normal[3] = {};
  REQUIRE(regression<LinearRegression, 2>(1e-6, a, b, normal));
  CHECK(normal[0] == Approx(2 / std::sqrt(5)).epsilon(1e-9));
  CHECK(normal[1] == Approx(1 / std::sqrt(5)).epsilon(1e-9));
}

TEST_CASE("a sum over a cloud in lanes is that of its particles one by one") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> number(-1, 1);
  for (const int particles : {1, 2, 15, 16, 17, 40}) {
    std::vector<Vec<3, double>> places;
    for (int k = 0; k < particles; ++k) places.push_back({{number(random), number(random), number(random)}});
    const Cloud of(places, &random);
    const sdk::CloudInLanes cloud{of.position.data(), of.weight.data(), of.count, of.stride};
    double sums[3] = {1, 2, 3}, expected[3] = {1, 2, 3};
    cloud.add(Moments(), sums);
    cloud.for_each([&](const Vec<3, double>& place, double weight) {
      double values[3];
      Moments()(place, weight, values);
      for (int n = 0; n < 3; ++n) expected[n] += values[n];
    });
    for (int n = 0; n < 3; ++n) CHECK(sums[n] == Approx(expected[n]).epsilon(1e-14).margin(1e-14));
  }
}

TEST_CASE("where no direction tells bodies apart, or one of them has no weight, regression has no normal") {
  const std::vector<Vec<3, double>> places{{{0.5, 0.3, 0.1}}, {{-0.6, 0.4, 0}}, {{1, -0.2, -0.3}}, {{0.2, 0.9, 0.6}}};
  Cloud far({{{-1.7, 0, 0}}, {{-1.6, 0.2, 0}}});
  std::fill(far.weight.begin(), far.weight.end(), 0.0);
  double normal[3] = {};
  for (const double penalty : {1e-12, 1e-9, 1e-6, 1.0})
    for (const auto& [a, b] :
         {std::pair(Cloud(places), Cloud(places)), std::pair(far, Cloud(places)), std::pair(Cloud(places), far)}) {
      CAPTURE(penalty, a.count, b.count);
      CHECK_FALSE(regression<LinearRegression, 2>(penalty, a, b, normal));
      CHECK_FALSE(regression<LinearRegression, 3>(penalty, a, b, normal));
      CHECK_FALSE(regression<LogisticRegression, 2>(penalty, a, b, normal));
      CHECK_FALSE(regression<LogisticRegression, 3>(penalty, a, b, normal));
    }
}

TEST_CASE("beside a body without weight regression has no normal, whatever directions the other one leaves open") {
  // Across the line of these particles the slope is a rounding that a small penalty alone divides.
  std::mt19937 random(23);
  std::uniform_real_distribution<double> number(-1, 1);
  Cloud far({{{-1.7, 0, 0}}, {{-1.6, 0.2, 0}}});
  std::fill(far.weight.begin(), far.weight.end(), 0.0);
  double normal[3] = {};
  for (int k = 0; k < 20; ++k) {
    const double middle[] = {number(random), number(random), number(random)}, angle = 4 * number(random);
    std::vector<Vec<3, double>> places;
    for (int i = 0; i < 3; ++i) {
      const double way = 0.5 * number(random);
      places.push_back({{middle[0] + way * std::cos(angle), middle[1] + way * std::sin(angle), middle[2]}});
    }
    const Cloud line(places, &random);
    CAPTURE(k);
    for (const double penalty : {1e-12, 1e-9})
      for (const auto& [a, b] : {std::pair(far, line), std::pair(line, far)}) {
        CHECK_FALSE(regression<LinearRegression, 2>(penalty, a, b, normal));
        CHECK_FALSE(regression<LinearRegression, 3>(penalty, a, b, normal));
        CHECK_FALSE(regression<LogisticRegression, 2>(penalty, a, b, normal));
        CHECK_FALSE(regression<LogisticRegression, 3>(penalty, a, b, normal));
      }
  }
}

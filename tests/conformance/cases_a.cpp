// Reference case A1: values of the kernels, at a node and elsewhere, and their second moments.

#include <cmath>

#include "shapes/bspline_quadratic/bspline_quadratic.hpp"
#include "shapes/linear/linear.hpp"
#include "support/catch.hpp"

namespace {

/// Weight that a particle at x gives the node at 0.
template <class Shape>
double weight_of_origin(double x) {
  double base, w[Shape::width];
  Shape::evaluate({}, x, base, w, static_cast<double*>(nullptr));
  const int k = static_cast<int>(-base);
  return k >= 0 && k < Shape::width ? w[k] : 0;
}

template <class Shape>
double second_moment(double x) {
  double base, w[Shape::width], moment = 0;
  Shape::evaluate({}, x, base, w, static_cast<double*>(nullptr));
  for (int k = 0; k < Shape::width; ++k) moment += w[k] * (base + k - x) * (base + k - x);
  return moment;
}

double quadratic(double d) {
  d = std::abs(d);
  return d <= 0.5 ? 0.75 - d * d : d <= 1.5 ? (1.5 - d) * (1.5 - d) / 2 : 0;
}

}  // namespace

TEST_CASE("A1: kernels equal their piecewise formulas") {
  for (int k = -250; k <= 250; ++k) {
    const double d = k / 125.0;
    CHECK(std::abs(weight_of_origin<mpm::BsplineQuadratic>(d) - quadratic(d)) <= 1e-15);
    CHECK(std::abs(weight_of_origin<mpm::Linear>(d) - std::max(0.0, 1 - std::abs(d))) <= 1e-15);
  }
}

TEST_CASE("A1: values at a node are exact") {
  CHECK(weight_of_origin<mpm::BsplineQuadratic>(-1) == 1.0 / 8);
  CHECK(weight_of_origin<mpm::BsplineQuadratic>(0) == 3.0 / 4);
  CHECK(weight_of_origin<mpm::BsplineQuadratic>(1) == 1.0 / 8);
  CHECK(weight_of_origin<mpm::BsplineQuadratic>(0.5) == 0.5);
  CHECK(weight_of_origin<mpm::Linear>(0) == 1);
  CHECK(weight_of_origin<mpm::Linear>(0.25) == 0.75);
  CHECK(weight_of_origin<mpm::Linear>(1) == 0);
}

TEST_CASE("A1: second moments are 1/4 for the quadratic spline, f (1 - f) for the tent") {
  for (int k = -40; k < 40; ++k) {
    const double x = k / 7.0, f = x - std::floor(x);
    CHECK(std::abs(second_moment<mpm::BsplineQuadratic>(x) - 0.25) <= 1e-14);
    CHECK(std::abs(second_moment<mpm::Linear>(x) - f * (1 - f)) <= 1e-14);
  }
}

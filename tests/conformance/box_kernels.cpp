// Kernel values of shapes of 4 nodes that average over a box: B2GIMP over the box at the start, cpGIMP over one that
// follows the deformation. The oracle is the mean itself, integrated piece by piece.

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "kernel/lanes.hpp"
#include "shapes/b2gimp/b2gimp.hpp"
#include "shapes/bspline_cubic/bspline_cubic.hpp"
#include "shapes/bspline_quadratic/bspline_quadratic.hpp"
#include "shapes/gimp/gimp.hpp"
#include "shapes/gimp_contiguous/gimp_contiguous.hpp"
#include "shapes/linear/linear.hpp"
#include "support/catch.hpp"

using mpm::B2Gimp;
using mpm::GimpContiguous;

namespace {

/// Weights and slopes of one axis by absolute node.
template <class Shape>
struct Axis {
  double base, w[Shape::width], g[Shape::width];
  Axis(double x, double l) { Shape::evaluate({}, x, l, base, w, g); }
  explicit Axis(double x) { Shape::evaluate({}, x, base, w, g); }
  double weight(int node) const { return inside(node) ? w[node - static_cast<int>(base)] : 0; }
  double slope(int node) const { return inside(node) ? g[node - static_cast<int>(base)] : 0; }
  bool inside(int node) const { return node >= base && node < base + Shape::width; }
};

double tent(double d) {
  return std::max(0.0, 1 - std::abs(d));
}
double quadratic(double d) {
  d = std::abs(d);
  return d <= 0.5 ? 0.75 - d * d : d <= 1.5 ? (1.5 - d) * (1.5 - d) / 2 : 0;
}

/// The mean of f over d - l to d + l: two Gauss points between half-integers, exact for the cubics that lie there.
double box_mean(const std::function<double(double)>& f, double d, double l) {
  double sum = 0, from = d - l;
  while (from < d + l) {
    const double to = std::min(d + l, (std::floor(2 * from) + 1) / 2), half = (to - from) / 2;
    for (const double side : {-1.0, 1.0}) sum += half * f(from + half * (1 + side / std::sqrt(3.0)));
    from = to;
  }
  return sum / (2 * l);
}

/// Checks weights, slopes and the sums of a box mean of `f`, for boxes of half length l.
template <class Shape>
void check_mean(const std::function<double(double)>& f, double l) {
  for (int k = -150; k <= 150; ++k) {
    const double x = k / 50.0;
    const Axis<Shape> axis(x, l);
    double sum = 0, slopes = 0, first = 0, affine = 0;
    INFO("x = " << x << ", l = " << l);
    for (int node = -6; node <= 6; ++node) {
      const double d = x - node;
      CHECK(std::abs(axis.weight(node) - box_mean(f, d, l)) <= 1e-14);
      CHECK(std::abs(axis.slope(node) - (f(d + l) - f(d - l)) / (2 * l)) <= 1e-14 / l);
      sum += axis.weight(node), slopes += axis.slope(node), first += axis.weight(node) * (node - x);
      affine += axis.slope(node) * (node - x);
    }
    CHECK(std::abs(sum - 1) <= 1e-14);
    CHECK(std::abs(slopes) <= 1e-14);
    CHECK(std::abs(first) <= 1e-14);
    CHECK(std::abs(affine - 1) <= 1e-14);
  }
}

template <class Shape>
double second_moment(double x, double l) {
  const Axis<Shape> axis(x, l);
  double moment = 0;
  for (int k = 0; k < Shape::width; ++k) moment += axis.w[k] * std::pow(axis.base + k - x, 2);
  return moment;
}

constexpr GimpContiguous::Parameters by_F{0}, by_U{1};

template <int D>
mpm::Mat<D, double> turned(double angle, const mpm::Mat<D, double>& domain) {
  mpm::Mat<D, double> R = mpm::Mat<D, double>::identity();
  R(0, 0) = R(1, 1) = std::cos(angle), R(1, 0) = std::sin(angle), R(0, 1) = -R(1, 0);
  return R * domain;
}
template <int D>
mpm::Mat<D, double> box(double x, double y) {
  mpm::Mat<D, double> domain{};
  for (int a = 0; a < D; ++a) domain(a, a) = a == 0 ? x : y;
  return domain;
}

}  // namespace

TEST_CASE("B2GIMP is the mean of the quadratic spline over the particle's box") {
  for (const double l : {0.5, 0.25, 1.0 / 6, 0.125, 0.05, 0.01}) check_mean<B2Gimp>(quadratic, l);
}

TEST_CASE("B2GIMP tends to the quadratic spline and is the cubic one at a box one cell wide") {
  for (int k = -200; k <= 200; ++k) {
    const double x = k / 77.0;
    const Axis<mpm::BsplineQuadratic> limit(x);
    const Axis<mpm::BsplineCubic> widest(x);
    const Axis<B2Gimp> wide(x, 0.5);
    for (int node = -5; node <= 5; ++node) {
      CHECK(std::abs(wide.weight(node) - widest.weight(node)) <= 1e-15);
      CHECK(std::abs(wide.slope(node) - widest.slope(node)) <= 1e-15);
      for (const double l : {0.1, 0.01, 1e-4, 1e-8}) {  // bound N'' l^2/6 with |N''| <= 2, reached beside a node
        const Axis<B2Gimp> narrow(x, l);
        CHECK(std::abs(narrow.weight(node) - limit.weight(node)) <= l * l / 3 + 1e-15);
        CHECK(std::abs(narrow.slope(node) - limit.slope(node)) <= l + 1e-15);
      }
    }
  }
}

TEST_CASE("the second moment of B2GIMP is 1/4 + l^2/3 everywhere") {
  for (const double l : {0.5, 0.25, 0.1, 1e-3})
    for (int k = -100; k < 100; ++k) CHECK(std::abs(second_moment<B2Gimp>(k / 17.0, l) - (0.25 + l * l / 3)) <= 1e-14);
}

TEST_CASE("the slope of B2GIMP's slope is continuous, of uGIMP it jumps") {
  constexpr double step = 0x1p-20;
  const auto jump = [](auto&& slope, double x) {  // jump of the second derivative, over two steps
    const double below = (slope(x - step) - slope(x - 2 * step)) / step,
                 above = (slope(x + 2 * step) - slope(x + step)) / step;
    return std::abs(above - below);
  };
  for (const double l : {0.5, 0.25, 0.1})
    for (int node = -2; node <= 2; ++node)
      for (double knot : {0.0, 0.5, 0.5 - l, 0.5 + l, l, 1 - l}) {
        const double curvature = 1 / (2 * l);  // curvature of the slope, at most 3 times this
        CHECK(jump([&](double x) { return Axis<B2Gimp>(x, l).slope(node); }, knot) <= 12 * curvature * 3 * step);
      }
  CHECK(jump([](double x) { return Axis<mpm::Gimp>(x, 0.25).slope(0); }, 0.25) > 1);
}

TEST_CASE("cpGIMP is the mean of the tent over boxes of up to two cells") {
  for (const double l : {1.0, 0.83, 0.7, 0.5, 0.3, 0.25, 0.1, 0.01}) check_mean<GimpContiguous>(tent, l);
}

TEST_CASE("cpGIMP equals uGIMP at F = I, in lanes too") {
  for (const double l : {0.5, 0.25, 1.0 / 6, 0.125, 0.01}) {
    CHECK(GimpContiguous::half_lengths<2>(by_F, box<2>(l, l))[1] == l);
    CHECK(std::abs(GimpContiguous::half_lengths<3>(by_U, box<3>(l, l))[2] - l) <= 4e-16 * l);
    for (int k = -200; k <= 200; ++k) {
      const double x = k / 77.0;
      const Axis<mpm::Gimp> undeformed(x, l);
      const Axis<GimpContiguous> axis(x, l);
      using L = mpm::Lanes<double>;
      L base, w[4], g[4];
      GimpContiguous::evaluate(by_F, L(x), L(l), base, w, g);
      CHECK(base[1] == axis.base);
      for (int node = -5; node <= 5; ++node) {
        CHECK(std::abs(axis.weight(node) - undeformed.weight(node)) <= 1e-14);
        CHECK(std::abs(axis.slope(node) - undeformed.slope(node)) <= 1e-13);
      }
      for (int node = 0; node < 4; ++node) {
        CHECK(std::abs(w[node][1] - axis.w[node]) <= 1e-15);
        CHECK(std::abs(g[node][1] - axis.g[node]) <= 1e-15);
      }
    }
  }
}

TEST_CASE("a stretch along the axes is the same by diag F and by diag U") {
  for (const auto& parameters : {by_F, by_U}) {
    const auto flat = GimpContiguous::half_lengths<2>(parameters, box<2>(0.25 * 3, 0.25 * 0.4));
    const auto solid = GimpContiguous::half_lengths<3>(parameters, box<3>(0.25 * 3, 0.25 * 0.4));
    CHECK(std::abs(flat[0] - 0.75) <= 1e-15);
    CHECK(std::abs(flat[1] - 0.1) <= 1e-15);
    CHECK(std::abs(solid[0] - 0.75) <= 1e-15);
    CHECK(std::abs(solid[2] - 0.1) <= 1e-15);
  }
}

TEST_CASE("a box that was turned inside out has the lengths of its mirror image") {
  for (const auto& parameters : {by_F, by_U}) {
    const auto flat = GimpContiguous::half_lengths<2>(parameters, mpm::Mat<2, double>{{0.75, 0, 0, -0.1}});
    const auto solid =
        GimpContiguous::half_lengths<3>(parameters, mpm::Mat<3, double>{{0.75, 0, 0, 0, 0.5, 0, 0, 0, -0.1}});
    for (const auto& found : {std::array{flat[0], flat[1]}, std::array{solid[0], solid[2]}}) {
      CHECK(std::abs(found[0] - 0.75) <= 1e-15);
      CHECK(std::abs(found[1] - 0.1) <= 1e-15);
    }
  }
}

TEST_CASE("at a turn by 90 degrees diag F has collapsed, diag U has not moved") {
  const double l = 0.25;
  for (const int degrees : {0, 30, 60, 89, 90, 120, 180, 270}) {
    const double angle = degrees * std::numbers::pi / 180;
    INFO(degrees << " degrees");
    for (int axis = 0; axis < 2; ++axis) {
      CHECK(std::abs(GimpContiguous::half_lengths<2>(by_F, turned<2>(angle, box<2>(l, l)))[axis] -
                     l * std::abs(std::cos(angle))) <= 1e-16);
      CHECK(std::abs(GimpContiguous::half_lengths<3>(by_F, turned<3>(angle, box<3>(l, l)))[axis] -
                     l * std::abs(std::cos(angle))) <= 1e-16);
      CHECK(std::abs(GimpContiguous::half_lengths<2>(by_U, turned<2>(angle, box<2>(l, l)))[axis] - l) <= 1e-15);
      CHECK(std::abs(GimpContiguous::half_lengths<3>(by_U, turned<3>(angle, box<3>(l, l)))[axis] - l) <= 1e-15);
    }
  }
  // The collapsed box is a tent, with its jump of the gradient from one side of a node to the other.
  const double quarter = std::numbers::pi / 2;
  const double collapsed = GimpContiguous::half_lengths<2>(by_F, turned<2>(quarter, box<2>(l, l)))[0];
  const double kept = GimpContiguous::half_lengths<2>(by_U, turned<2>(quarter, box<2>(l, l)))[0];
  REQUIRE(collapsed < 1e-16);
  const auto jump_at_node = [](double half_length) {
    return Axis<GimpContiguous>(1e-5, half_length).slope(0) - Axis<GimpContiguous>(-1e-5, half_length).slope(0);
  };
  CHECK(jump_at_node(collapsed) == Approx(-2).epsilon(1e-12));
  CHECK(std::abs(jump_at_node(kept)) < 1e-4);
  for (int k = -40; k <= 40; ++k) {
    const double x = k / 13.0, f = x - std::floor(x);
    const Axis<GimpContiguous> axis(x, collapsed);
    for (int node = -5; node <= 5; ++node) CHECK(std::abs(axis.weight(node) - tent(x - node)) <= 5e-7);
    CHECK(std::abs(second_moment<GimpContiguous>(x, collapsed) - f * (1 - f)) <= 1e-6);
    CHECK(second_moment<GimpContiguous>(x, collapsed) > 0);
  }
  // The tensor U is that of the undeformed frame: a box drawn out along x keeps its long side there when it is turned
  // onto y.
  const auto drawn = GimpContiguous::half_lengths<2>(by_U, turned<2>(quarter, box<2>(3 * l, l)));
  CHECK(std::abs(drawn[0] - 3 * l) <= 1e-15);
  CHECK(std::abs(drawn[1] - l) <= 1e-15);
}

TEST_CASE("cpGIMP gives no weight where four nodes do not hold the box") {
  for (const double l : {1.0 + 1e-12, 2.0, 1e300, std::nan("")})
    for (const double x : {0.0, 0.3, 0.5}) {
      const Axis<GimpContiguous> axis(x, l);
      for (int k = 0; k < 4; ++k) CHECK(axis.w[k] == 0);
      CHECK(axis.base == -1);  // the base follows from the position alone
    }
}

// Values of the kernels, at a node and elsewhere, and their second moments.

#include <array>
#include <cmath>
#include <limits>

#include "kernel/lanes.hpp"
#include "shapes/bspline_cubic/bspline_cubic.hpp"
#include "shapes/bspline_quadratic/bspline_quadratic.hpp"
#include "shapes/cpdi/cpdi.hpp"
#include "shapes/cpdi2/cpdi2.hpp"
#include "shapes/gimp/gimp.hpp"
#include "shapes/linear/linear.hpp"
#include "support/catch.hpp"

namespace {

/// The weight that a particle at x gives the node at 0.
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

double cubic(double d) {
  d = std::abs(d);
  return d <= 1 ? d * d * d / 2 - d * d + 2.0 / 3 : d <= 2 ? (2 - d) * (2 - d) * (2 - d) / 6 : 0;
}

double cubic_slope(double d) {
  const double a = std::abs(d), sign = d < 0 ? -1 : 1;
  return sign * (a <= 1 ? 1.5 * a * a - 2 * a : a <= 2 ? -(2 - a) * (2 - a) / 2 : 0);
}

}  // namespace

TEST_CASE("kernels equal their piecewise formulas") {
  for (int k = -250; k <= 250; ++k) {
    const double d = k / 125.0;
    CHECK(std::abs(weight_of_origin<mpm::BsplineQuadratic>(d) - quadratic(d)) <= 1e-15);
    CHECK(std::abs(weight_of_origin<mpm::BsplineCubic>(d) - cubic(d)) <= 1e-15);
    CHECK(std::abs(weight_of_origin<mpm::Linear>(d) - std::max(0.0, 1 - std::abs(d))) <= 1e-15);
  }
}

TEST_CASE("values at a node are exact") {
  CHECK(weight_of_origin<mpm::BsplineQuadratic>(-1) == 1.0 / 8);
  CHECK(weight_of_origin<mpm::BsplineQuadratic>(0) == 3.0 / 4);
  CHECK(weight_of_origin<mpm::BsplineQuadratic>(1) == 1.0 / 8);
  CHECK(weight_of_origin<mpm::BsplineQuadratic>(0.5) == 0.5);
  CHECK(std::abs(weight_of_origin<mpm::BsplineCubic>(-1) - 1.0 / 6) <= 0x1p-53);  // the value 2/3 - 1/2 rounds once
  CHECK(weight_of_origin<mpm::BsplineCubic>(0) == 2.0 / 3);
  CHECK(weight_of_origin<mpm::BsplineCubic>(1) == 1.0 / 6);
  CHECK(weight_of_origin<mpm::BsplineCubic>(2) == 0);
  CHECK(weight_of_origin<mpm::Linear>(0) == 1);
  CHECK(weight_of_origin<mpm::Linear>(0.25) == 0.75);
  CHECK(weight_of_origin<mpm::Linear>(1) == 0);
}

TEST_CASE("the cubic spline is C2, and its gradient is that of the formula") {
  for (int k = -250; k <= 250; ++k) {
    const double x = k / 77.0;
    double base, w[4], g[4];
    mpm::BsplineCubic::evaluate({}, x, base, w, g);
    for (int node = 0; node < 4; ++node) CHECK(std::abs(g[node] - cubic_slope(x - (base + node))) <= 1e-14);
  }
  // Across a node the stencil moves by one: value, slope and slope of the slope arrive where they left.
  constexpr double step = 0x1p-20;
  const auto near = [&](double x, int node, double(&value)[3]) {
    double base, w[4], g[4], next_g[4];
    mpm::BsplineCubic::evaluate({}, x, base, w, g);
    mpm::BsplineCubic::evaluate({}, x + step / 2, base, w, next_g);  // the place is in the same piece
    const int k = node - static_cast<int>(base);
    const bool inside = k >= 0 && k < 4;
    value[0] = inside ? w[k] : 0, value[1] = inside ? g[k] : 0, value[2] = inside ? (next_g[k] - g[k]) * 2 / step : 0;
  };
  for (int node = -2; node <= 3; ++node) {
    double below[3], above[3];
    near(-step, node, below);
    near(0, node, above);
    for (int order = 0; order < 3; ++order) CHECK(std::abs(below[order] - above[order]) <= 8 * step);
  }
}

TEST_CASE("second moments are 1/4 for the quadratic spline, 1/3 for the cubic, f (1 - f) for the tent") {
  for (int k = -40; k < 40; ++k) {
    const double x = k / 7.0, f = x - std::floor(x);
    CHECK(std::abs(second_moment<mpm::BsplineQuadratic>(x) - 0.25) <= 1e-14);
    CHECK(std::abs(second_moment<mpm::BsplineCubic>(x) - 1.0 / 3) <= 1e-14);
    CHECK(std::abs(second_moment<mpm::Linear>(x) - f * (1 - f)) <= 1e-14);
  }
}

namespace {

/// The weight of uGIMP by its piecewise formula, distance d and half width l in cells.
double gimp(double d, double l) {
  d = std::abs(d);
  if (d < l) return 1 - (d * d + l * l) / (2 * l);
  if (d <= 1 - l) return 1 - d;
  return d < 1 + l ? (1 + l - d) * (1 + l - d) / (4 * l) : 0;
}

double gimp_slope(double d, double l) {
  const double a = std::abs(d), sign = d < 0 ? -1 : 1;
  if (a < l) return -d / l;
  if (a <= 1 - l) return -sign;
  return a < 1 + l ? -sign * (1 + l - a) / (2 * l) : 0;
}

/// Weights and slopes of one axis by absolute node.
struct Axis {
  double base, w[3], g[3];
  Axis(double x, double l) { mpm::Gimp::evaluate({}, x, l, base, w, g); }
  double weight(int node) const { return inside(node) ? w[node - static_cast<int>(base)] : 0; }
  double slope(int node) const { return inside(node) ? g[node - static_cast<int>(base)] : 0; }
  bool inside(int node) const { return node >= base && node <= base + 2; }
};

constexpr double half_sizes[] = {0.5, 0.25, 1.0 / 6, 0.125, 0.05, 0.01};

}  // namespace

TEST_CASE("uGIMP equals its piecewise formula and its derivative") {
  for (double l : half_sizes)
    for (int k = -200; k <= 200; ++k) {
      const double x = k / 100.0;
      const Axis axis(x, l);
      double sum = 0, slopes = 0, first = 0;
      for (int node = -4; node <= 4; ++node) {
        CHECK(std::abs(axis.weight(node) - gimp(x - node, l)) <= 1e-14);
        CHECK(std::abs(axis.slope(node) - gimp_slope(x - node, l)) <= 1e-13);
        sum += axis.weight(node), slopes += axis.slope(node), first += axis.weight(node) * (node - x);
      }
      CHECK(std::abs(sum - 1) <= 1e-14);
      CHECK(std::abs(slopes) <= 1e-14);
      CHECK(std::abs(first) <= 1e-14);
    }
}

TEST_CASE("uGIMP with a box one cell wide is the quadratic spline") {
  for (int k = -250; k <= 250; ++k) {
    const double x = k / 77.0;
    const Axis axis(x, 0.5);
    double base, w[3], g[3];
    mpm::BsplineQuadratic::evaluate({}, x, base, w, g);
    CHECK(axis.base == base);
    for (int node = 0; node < 3; ++node) {
      CHECK(std::abs(axis.w[node] - w[node]) <= 1e-14);
      CHECK(std::abs(axis.g[node] - g[node]) <= 1e-14);
    }
  }
}

TEST_CASE("uGIMP in lanes equals uGIMP in scalars") {
  using L = mpm::Lanes<double>;
  for (int first = 0; first < 400; first += L::width) {
    L x{}, l{}, base, w[3], g[3];
    for (int lane = 0; lane < L::width; ++lane)
      x.v[lane] = (first + lane) / 97.0 - 2, l.v[lane] = half_sizes[(first + lane) % 6];
    mpm::Gimp::evaluate({}, x, l, base, w, g);
    for (int lane = 0; lane < L::width; ++lane) {
      const Axis one(x[lane], l[lane]);
      CHECK(base[lane] == one.base);
      for (int k = 0; k < 3; ++k) {
        CHECK(std::abs(w[k][lane] - one.w[k]) <= 1e-15);
        CHECK(std::abs(g[k][lane] - one.g[k]) <= 1e-15);
      }
    }
  }
}

namespace {

template <int D>
mpm::Cpdi::List<D, double> cpdi(const mpm::Vec<D, double>& x, const mpm::Mat<D, double>& domain) {
  mpm::Cpdi::List<D, double> list;
  mpm::Cpdi::evaluate({}, x, domain, list);
  return list;
}

}  // namespace

TEST_CASE("CPDI equals uGIMP where the box straddles no grid line") {
  for (double l : {0.25, 0.125, 0.01})
    for (int k = 0; k <= 20; ++k)
      for (int m = 0; m <= 20; ++m) {
        const double x = l + (1 - 2 * l) * k / 20, y = l + (1 - 2 * l) * m / 20;
        const auto list = cpdi<2>({{x + 3, y - 5}}, {{l, 0, 0, l}});
        const Axis along_x(x + 3, l), along_y(y - 5, l);
        for (int n = 0; n < list.count; ++n) {
          const int i = list.node[n][0], j = list.node[n][1];
          CHECK(std::abs(list.weight[n] - along_x.weight(i) * along_y.weight(j)) <= 1e-14);
          CHECK(std::abs(list.gradient[n][0] - along_x.slope(i) * along_y.weight(j)) <= 1e-13);
          CHECK(std::abs(list.gradient[n][1] - along_x.weight(i) * along_y.slope(j)) <= 1e-13);
        }
      }
}

TEST_CASE("CPDI differs from uGIMP where the box straddles a grid line in 2-D") {
  // The corners' tents are averaged, not integrated: at a node the box of half length 1/4 gives it 9/16, not (7/8)^2.
  const auto list = cpdi<2>({{0, 0}}, {{0.25, 0, 0, 0.25}});
  double at_origin = 0;
  for (int n = 0; n < list.count; ++n)
    if (list.node[n][0] == 0 && list.node[n][1] == 0) at_origin = list.weight[n];
  CHECK(at_origin == 9.0 / 16);
  CHECK(list.count == 9);
}

TEST_CASE("CPDI takes the mean over the domain of the corners' multilinear field") {
  // One corner lies at a node, the others in cells that do not touch it: weight 1/4 and gradient R^-T s / 4.
  const mpm::Mat<2, double> R{{1.5, 0.25, -0.25, 1.25}};
  const auto list = cpdi<2>({{10 - 1.75, 20 - 1.0}}, R);
  const double det = 1.5 * 1.25 + 0.25 * 0.25;
  bool found = false;
  for (int n = 0; n < list.count; ++n)
    if (list.node[n][0] == 10 && list.node[n][1] == 20) {
      found = true;
      CHECK(std::abs(list.weight[n] - 0.25) <= 1e-15);
      CHECK(std::abs(list.gradient[n][0] - (1.25 + 0.25) / det / 4) <= 1e-15);
      CHECK(std::abs(list.gradient[n][1] - (-0.25 + 1.5) / det / 4) <= 1e-15);
    }
  CHECK(found);
}

TEST_CASE("a collapsed CPDI domain gives the mean of the tents' gradients") {
  const mpm::Mat<3, double> flat{{0.3, 0.3, 0, 0.1, 0.1, 0, 0, 0, 0.25}};
  for (const mpm::Mat<3, double>& R : {mpm::Mat<3, double>{}, flat})
    // On grid lines a node without weight may have a gradient.
    for (const mpm::Vec<3, double>& x :
         {mpm::Vec<3, double>{{4.3, -2.6, 0.45}}, mpm::Vec<3, double>{{4, -2.6, 2}}, mpm::Vec<3, double>{{4, -3, 2}}}) {
      const auto list = cpdi<3>(x, R);
      double sum = 0;
      mpm::Mat<3, double> affine{};
      for (int n = 0; n < list.count; ++n) {
        sum += list.weight[n];
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) affine(i, j) += (list.node[n][i] - x[i]) * list.gradient[n][j];
      }
      CHECK(std::abs(sum - 1) <= 1e-14);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) CHECK(std::abs(affine(i, j) - (i == j)) <= 1e-14);
    }
  const auto point = cpdi<2>({{0.25, 0.5}}, mpm::Mat<2, double>{});  // a point gives the tent itself
  CHECK(point.count == 4);
  CHECK(point.weight[0] == 0.375);
}

namespace {

/// The nodes of a cube of half length l about (0.3, ...), which CPDI and CPDI2 list alike.
template <int D>
std::array<int, 2> counts(double l) {
  mpm::Vec<D, double> x{}, corner[1 << D];
  mpm::Mat<D, double> R{};
  for (int a = 0; a < D; ++a) {
    x[a] = 0.3, R(a, a) = l;
    for (int c = 0; c < 1 << D; ++c) corner[c][a] = c >> a & 1 ? l : -l;
  }
  mpm::NodeList<D, double, mpm::Cpdi2::capacity<D>> list;
  mpm::Cpdi2::evaluate({}, x, corner, list);
  return {cpdi<D>(x, R).count, list.count};
}

/// The farthest node from a corner of a tiny domain, along an axis, cells.
template <class List>
double farthest(const List& list, double x) {
  double most = 0;
  for (int n = 0; n < list.count; ++n) most = mpm::test::larger(most, std::abs(list.node[n][0] - x));
  return most;
}

}  // namespace

TEST_CASE("CPDI and CPDI2 hold as many nodes as corners in cells apart have, and reach as far as tents") {
  const std::array<int, 2> flat{4 * 4, 4 * 4}, solid{8 * 8, 8 * 8};  // corners times the nodes of a cell
  CHECK(counts<2>(1.2) == flat);
  CHECK(counts<3>(1.2) == solid);
  CHECK(mpm::Cpdi::capacity<2> == flat[0]);
  CHECK(mpm::Cpdi2::capacity<2> == flat[0]);
  CHECK(mpm::Cpdi::capacity<3> == solid[0]);
  CHECK(mpm::Cpdi2::capacity<3> == solid[0]);
  // A corner just behind a node reaches the next one, a cell away.
  const double l = 1e-3, x = 2 * l;
  CHECK(mpm::Cpdi::reach - farthest(cpdi<2>({{x, x}}, {{l, 0, 0, l}}), x) <= 2 * l + 1e-15);
  CHECK(mpm::Cpdi2::reach == mpm::Cpdi::reach);
}

namespace {

/// Whether CPDI has a box, with gradients, for a domain with sides of these lengths whose last one lies by an angle of
/// `sine` out of the others. The first lies along axis `first`, the second of three along the next axis.
template <int D, class T>
bool has_box(const double* lengths, int first, double sine) {
  mpm::Mat<D, T> R{};
  for (int side = 0; side < D - 1; ++side) R((first + side) % D, side) = T(lengths[side]);
  R(first, D - 1) = T(lengths[D - 1]);
  R((first + D - 1) % D, D - 1) = T(lengths[D - 1] * sine);
  mpm::Vec<D, T> x{}, base{};
  for (int a = 0; a < D; ++a) x[a] = T(0.3 + 0.2 * a);
  return mpm::Cpdi::box<D, T>({}, x, R, true, base) > 0;
}

template <int D, class T>
void check_collapse() {
  const double epsilon = std::numeric_limits<T>::epsilon();
  for (const auto& lengths :
       {std::array{0.5, 0.5, 0.5}, std::array{0.6, 0.05, 0.3}, std::array{0.03, 0.7, 0.2}, std::array{0.04, 0.02, 0.6}})
    for (int first = 0; first < D; ++first)
      for (const double sign : {1.0, -1.0}) {
        CAPTURE(D, sizeof(T), lengths[0], lengths[1], lengths[2], first, sign);
        CHECK_FALSE(has_box<D, T>(lengths.data(), first, sign * 62 * epsilon));
        CHECK(has_box<D, T>(lengths.data(), first, sign * 66 * epsilon));
      }
}

}  // namespace

TEST_CASE("a CPDI domain has collapsed when its volume is 64 roundings of the product of its sides") {
  check_collapse<2, double>();
  check_collapse<3, double>();
  check_collapse<2, float>();
  check_collapse<3, float>();
}

TEST_CASE("CPDI: a domain is the same in whatever order its sides are counted, and however small it is") {
  const mpm::Mat<2, double> R{{0.7, -0.4, 0.2, 0.9}}, exchanged{{-0.4, 0.7, 0.9, 0.2}};
  const mpm::Vec<2, double> x{{4.3, -2.6}};
  const auto one = cpdi<2>(x, R), other = cpdi<2>(x, exchanged);
  REQUIRE(one.count == other.count);
  for (int n = 0; n < one.count; ++n)
    for (int m = 0; m < other.count; ++m) {
      if (one.node[n][0] != other.node[m][0] || one.node[n][1] != other.node[m][1]) continue;
      CHECK(std::abs(one.weight[n] - other.weight[m]) <= 1e-15);
      for (int a = 0; a < 2; ++a) CHECK(std::abs(one.gradient[n][a] - other.gradient[m][a]) <= 1e-14);
    }
  // Half as far behind a grid line as the domain reaches: its left corners give -l/2 to the node at 3, over 2 l.
  const double l = 0x1p-28;
  const auto tiny = cpdi<2>({{4 + l / 2, 0.25}}, {{l, 0, 0, l}});
  double slope = 0;
  for (int n = 0; n < tiny.count; ++n)
    if (tiny.node[n][0] == 3) slope += tiny.gradient[n][0];
  CHECK(std::abs(slope + 0.25) <= 1e-7);
}

TEST_CASE("CPDI's box begins at the quadratic spline's first node, and at none where there is no box") {
  const mpm::Mat<2, double> small{{0.01, 0, 0, 0.01}};
  mpm::Vec<2, double> base{};
  for (int n = 0; n < 50; ++n) {
    const double x = 6 + (n + 0.5) / 50, y = -2 + (n + 0.5) / 50;
    CAPTURE(x, y);
    CHECK(mpm::Cpdi::box<2, double>({}, {{x, y}}, small, true, base) >= 2);
    CHECK(base[0] == std::floor(x - 0.5));
    CHECK(base[1] == std::floor(y - 0.5));
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [x, l] : {std::array{6.3, 2.5}, std::array{nan, 0.25}, std::array{6.3, nan}}) {
    base = {{1, 1}};
    CHECK(mpm::Cpdi::box<2, double>({}, {{x, 7.1}}, {{l, 0, 0, l}}, true, base) == 0);
    CHECK(base[0] == 0);
    CHECK(base[1] == 0);
  }
}

TEST_CASE("CPDI lists a node whose weight and slopes add up to nothing") {
  // A node that the corner s = (-1, 1) alone reaches has grad w = w R^-T s: w (-2, 1), and w (-1/2, 1/2) of the larger.
  for (const mpm::Mat<2, double>& R : {mpm::Mat<2, double>{{0.5, 0, 0, 1}}, mpm::Mat<2, double>{{2, 0, 0, 2}}}) {
    const auto list = cpdi<2>({{4.3, -2.6}}, R);
    double sum = 0;
    int cancelling = 0;
    for (int n = 0; n < list.count; ++n) {
      const double w = list.weight[n], x = list.gradient[n][0], y = list.gradient[n][1];
      sum += w;
      cancelling += w + x + y == 0 || w - std::abs(x) - std::abs(y) == 0;
    }
    CHECK(std::abs(sum - 1) <= 1e-15);
    CHECK(cancelling > 0);
  }
}

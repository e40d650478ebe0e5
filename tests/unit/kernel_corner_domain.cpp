// The domain between four or eight corners, and the cell in which a corner lies.

#include "kernel/corner_domain.hpp"

#include <cmath>
#include <limits>

#include "support/catch.hpp"

using namespace mpm;

namespace {

/// A box with these sides, lower along x where it is higher by `lean` along the last axis.
template <int D>
void box(const Vec<D, double>& side, double lean, Vec<D, double> (&corner)[1 << D]) {
  for (int c = 0; c < 1 << D; ++c) {
    for (int a = 0; a < D; ++a) corner[c][a] = (c >> a & 1) * side[a];
    corner[c][0] -= lean * corner[c][D - 1];
  }
}

template <int D>
void check_leaning_box() {
  Vec<D, double> side, corner[1 << D];
  double volume = 1;
  for (int a = 0; a < D; ++a) volume *= side[a] = 2 + a;
  box<D>(side, 0.3, corner);
  const CornerDomain<D, double> domain = corner_domain<D, double>(corner);
  CHECK(domain.upright);
  // det J is the volume over that of [-1, 1]^D, and one point of Gauss stands for a volume of one.
  CHECK(domain.volume == Approx(volume));
  const Vec<D, double> centre = centroid(domain, corner);
  CHECK(centre[0] == Approx(side[0] / 2 - 0.3 * side[D - 1] / 2));
  CHECK(centre[D - 1] == Approx(side[D - 1] / 2));
  // A linear field has its own gradient: sum_c grad Q_c (g . x_c) = g.
  Vec<D, double> field, found{};
  for (int a = 0; a < D; ++a) field[a] = 0.7 - a;
  for (int c = 0; c < 1 << D; ++c) {
    double value = 0;
    for (int a = 0; a < D; ++a) value += field[a] * corner[c][a];
    for (int a = 0; a < D; ++a) found[a] += domain.gradient[c][a] * value;
  }
  for (int a = 0; a < D; ++a) CHECK(found[a] == Approx(field[a]));

  // A single corner that is pulled past its neighbours, whichever it is, turns the domain inside out there.
  for (int c = 0; c < 1 << D; ++c) {
    Vec<D, double> pulled[1 << D];
    box<D>(side, 0.3, pulled);
    for (int a = 0; a < D; ++a) pulled[c][a] += (c >> a & 1 ? -0.9 : 0.9) * side[a];
    CHECK_FALSE(corner_domain<D, double>(pulled).upright);
  }
  corner[1][0] = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(corner_domain<D, double>(corner).upright);
}

template <int D>
void check_tents() {
  Vec<D, double> x, from;
  for (int a = 0; a < D; ++a) x[a] = 5.25 + a, from[a] = a == 0 ? -0.5 : 1.125;
  const TentCell<D, double> cell(x, from);
  double sum = 0;
  Vec<D, double> mean{};
  for (int which = 0; which < 1 << D; ++which) {
    sum += cell.weight(which);
    for (int a = 0; a < D; ++a) mean[a] += cell.weight(which) * cell.node(which, a);
  }
  CHECK(sum == Approx(1));
  for (int a = 0; a < D; ++a) CHECK(mean[a] == Approx(x[a] + from[a]));  // tents reproduce a linear field
  CHECK(cell.node(0, 0) == 4);
  CHECK(cell.node(1, 0) == 5);
}

}  // namespace

TEST_CASE("a leaning box between its corners has its volume, its centre and the gradients of linear fields") {
  check_leaning_box<2>();
  check_leaning_box<3>();
}

TEST_CASE("the tents of a corner's cell") {
  check_tents<2>();
  check_tents<3>();
}

TEST_CASE("the derivative of a determinant in the plane is that of its formula") {
  const Mat<2, double> J{{2, 3, 5, 11}}, slope = cofactors(J);
  for (int k = 0; k < 4; ++k) {
    Mat<2, double> more = J;
    more.m[k] += 1;  // a determinant is linear in each entry
    CHECK(slope.m[k] == determinant(more) - determinant(J));
  }
}

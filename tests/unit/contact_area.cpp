// The shares of nodes in the area where two bodies touch, against the length of the face, which is 1.

#include <cmath>
#include <functional>

#include "operators/contact_geometry.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A B-spline and its derivative, lengths in cells (de Boor 1978).
struct Spline {
  std::function<double(double)> weight, slope;
};
Spline linear() {
  return {[](double x) { return std::max(0.0, 1 - std::abs(x)); },
          [](double x) { return std::abs(x) < 1 ? (x > 0 ? -1.0 : 1.0) : 0.0; }};
}
Spline quadratic() {
  return {[](double x) {
            const double r = std::abs(x);
            return r < 0.5 ? 0.75 - r * r : r < 1.5 ? (1.5 - r) * (1.5 - r) / 2 : 0.0;
          },
          [](double x) {
            const double r = std::abs(x);
            return r < 0.5 ? -2 * x : r < 1.5 ? (x > 0 ? r - 1.5 : 1.5 - r) : 0.0;
          }};
}
Spline cubic() {
  return {[](double x) {
            const double r = std::abs(x);
            return r < 1 ? 2.0 / 3 - r * r + r * r * r / 2 : r < 2 ? std::pow(2 - r, 3) / 6 : 0.0;
          },
          [](double x) {
            const double r = std::abs(x), size = r < 1 ? 1.5 * r * r - 2 * r : r < 2 ? -(2 - r) * (2 - r) / 2 : 0.0;
            return x > 0 ? size : -size;
          }};
}

/// What a node at zero sees of a body on one side of a face, with `per_cell` rows of particles a cell, and of its volume.
struct Seen {
  ContactFieldNode node;
  double volume = 0;
};
Seen seen(const Spline& spline, double face, int side, int per_cell) {
  Seen result;
  for (int k = 0; k < 10 * per_cell; ++k) {
    const double x = face + side * (k + 0.5) / per_cell;
    result.node.mass += spline.weight(x) / per_cell;
    result.node.volume_gradient[0] += spline.slope(x) / per_cell;
  }
  result.volume = result.node.mass;
  return result;
}

}  // namespace

TEST_CASE("the shares of nodes in the area of contact add up to the area") {
  const double normal[3] = {1, 0, 0};
  double least = 1, largest = 1;  // of the area by volumes
  for (const Spline& spline : {linear(), quadratic(), cubic()})
    for (const int per_cell : {2, 3, 4})
      for (double face = 0.0031; face < 1; face += 0.01) {
        double sum = 0, by_volumes = 0;
        for (int node = -4; node <= 4; ++node) {
          const Seen a = seen(spline, face - node, -1, per_cell), b = seen(spline, face - node, 1, per_cell);
          if (a.volume <= 0 || b.volume <= 0) continue;
          sum += contact_area(a.node, b.node, normal, 1, 1.0);
          by_volumes += std::sqrt(2 * (a.volume + b.volume) * std::min(a.volume, b.volume));
        }
        CHECK(sum == Approx(1).epsilon(1e-12));
        least = smaller(least, by_volumes), largest = larger(largest, by_volumes);
      }
  // Why the published one is not taken (Nairn 2013, Comput. Model. Eng. Sci. 92:271, eq. 26).
  CHECK(least == Approx(0.71).margin(0.01));
  CHECK(largest == Approx(1.57).margin(0.01));
}

TEST_CASE("the share of a node ends where the first of two bodies ends") {
  const double normal[3] = {0, 1, 0};
  ContactFieldNode a, b;
  a.volume_gradient[1] = 0.3, b.volume_gradient[1] = -0.5;
  CHECK(contact_area(a, b, normal, 2, 1.0) == 0.3);
  CHECK(contact_area(b, a, normal, 2, 1.0) == 0);  // the normal points from b to a
  CHECK(contact_area(a, b, normal, 2, around_axis(2.0)) == Approx(0.3 * 4 * 3.14159265358979));
  CHECK(around_axis(-0.1) == 0);
}

// Isochoric tensors that return to a yield surface, against their definitions.

#include "kernel/unimodular.hpp"

#include <cmath>
#include <limits>

#include "kernel/lanes.hpp"
#include "support/catch.hpp"

using namespace mpm;

namespace {

/// Three stretches whose product is 1, and the deviator of a tensor that has them.
template <class T>
struct Isochoric {
  T stretch[3];

  T mean() const { return (stretch[0] + stretch[1] + stretch[2]) / 3; }
  Sym<3, T> deviator() const { return {{stretch[0] - mean(), stretch[1] - mean(), stretch[2] - mean(), 0, 0, 0}}; }
};

}  // namespace

TEST_CASE("a tensor is pushed forward by an increment from both sides") {
  const Sym<3, double> b{{2, 3, 4, 1, 0, 1}};  // xx, yy, zz, yz, xz, xy
  const Sym<3, double> solid = pushed(Mat<3, double>{{1, 2, 0, 0, 1, 3, 2, 0, 1}}, b);
  const double expected[3][3] = {{18, 13, 10}, {13, 45, 15}, {10, 15, 12}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) CHECK(solid(i, j) == expected[i][j]);
  Deformation<2, double> increment{};
  increment.plane = {{1, 2, 3, 4}}, increment.zz = 2;
  const Sym<2, double> flat = pushed(increment, Sym<2, double>{{5, 7, 3, 6}});
  CHECK(flat(0, 0) == 57);
  CHECK(flat(0, 1) == 131);
  CHECK(flat(1, 1) == 301);
  CHECK(flat.s[2] == 12);
  CHECK(pushed(increment.plane, Sym<2, double>{{5, 7, 3, 6}}).s[2] == 3);  // what lies across plane strain stays
}

TEST_CASE("the unimodular part of a tensor has the determinant 1") {
  const Sym<3, double> solid = unimodular(Sym<3, double>{{16, 1, 0.5, 0, 0, 0}});
  CHECK(solid.s[0] == Approx(8));
  CHECK(solid.s[1] == Approx(0.5));
  CHECK(solid.s[2] == Approx(0.25));
  const Sym<2, double> flat = unimodular(Sym<2, double>{{5, 2, 3, 1}});  // of 27
  const double part[] = {5 / 3.0, 2 / 3.0, 1, 1 / 3.0};
  for (int k = 0; k < 4; ++k) CHECK(flat.s[k] == Approx(part[k]));
}

TEMPLATE_TEST_CASE("the mean beside a deviator is that of the isochoric tensor, wherever its search begins", "", float,
                   double) {
  const TestType eps = std::numeric_limits<TestType>::epsilon();
  for (const Isochoric<TestType>& b : {Isochoric<TestType>{{4, 0.5, 0.5}},
                                       {{0.25, 2, 2}},
                                       {{1, 1, 1}},
                                       {{1.5, 0.8, 1 / TestType(1.2)}},
                                       {{9, 3, 1 / TestType(27)}},
                                       {{16, 8, 1 / TestType(128)}}}) {
    INFO(b.stretch[0] << " " << b.stretch[1]);
    const TestType mean = b.mean();
    for (const TestType start : {TestType(1), TestType(1.001), TestType(1.5), TestType(30)})
      CHECK(std::abs(unimodular_mean(b.deviator(), start * mean) - mean) <= 20 * eps * mean);
  }
}

// Two roots all but meet where one stretch is large: what rounding leaves of the value moves the mean by the share of
// sqrt(epsilon), and to the smaller root below it were it not kept above the turn of the cubic.
TEMPLATE_TEST_CASE("the mean beside a large deviator is found where two roots all but meet", "", float, double) {
  const TestType eps = std::numeric_limits<TestType>::epsilon();
  for (const int power : {1, 2, 3, 4, 6, 8}) {
    const TestType root = std::pow(TestType(10), TestType(-power));
    const Isochoric<TestType> b{{1 / (root * root), root, root}};
    const TestType mean = b.mean();
    INFO(mean);
    for (const TestType start : {TestType(1), TestType(1.5), TestType(10)})
      CHECK(std::abs(unimodular_mean(b.deviator(), start * mean) - mean) <= 4 * std::sqrt(eps) * mean);
  }
}

// Of stretches a, 0.1 and 10/a the root below the largest one lies at half of it. Where rounding leaves no digits between them,
// the mean stays the nearer to the largest, and is not thrown far away by a slope that has vanished.
TEST_CASE("the mean beside a deviator beyond all digits stays at the largest root") {
  for (int k = 0; k < 200; ++k) {
    const double a = std::pow(10, 2 + 0.03 * k);
    const Isochoric<double> b{{a, 0.1, 10 / a}};
    for (const double start : {1.0, 1.5}) {
      INFO(a << " from " << start);
      CHECK(std::abs(unimodular_mean(b.deviator(), start * b.mean()) / b.mean() - 1) < 0.25);
    }
  }
}

TEST_CASE("each lane of a pack has its own mean") {
  using S = Lanes<double>;
  Sym<3, S> d{};
  S start{};
  const Isochoric<double> all[] = {{{4, 0.5, 0.5}}, {{1, 1, 1}}, {{1e4, 1e-2, 1e-2}}, {{0.25, 2, 2}}};
  for (int lane = 0; lane < S::width; ++lane) {
    const Sym<3, double> own = all[lane % 4].deviator();
    for (int k = 0; k < 6; ++k) d.s[k].v[lane] = own.s[k];
    start.v[lane] = 1.3 * all[lane % 4].mean();
  }
  const S mean = unimodular_mean(d, start);
  for (int lane = 0; lane < S::width; ++lane)
    CHECK(std::abs(mean.v[lane] - all[lane % 4].mean()) <= 1e-10 * all[lane % 4].mean());
}

// det(s d + t I) = 1 is t^3 - s^2 (d:d/2) t + s^3 det d = 1, so that dt/ds = (d:d t - 3 det d) / (3 t^2 - d:d/2) at s = 1,
// and the factor is 3/d:d of that: 6/17 where the stretches are 4, 1/2 and 1/2.
TEST_CASE("the stress that does plastic work follows the mean as the deviator shrinks") {
  const Isochoric<double> b{{4, 0.5, 0.5}};
  CHECK(conjugate_factor(b.deviator(), b.mean()) == Approx(6.0 / 17));
  const Isochoric<double> other{{1.5, 0.8, 1 / 1.2}};
  const Sym<3, double> d = other.deviator();
  const double t = other.mean(), norm = squared_norm(d), det = determinant(d);
  CHECK(conjugate_factor(d, t) == Approx(3 / norm * (norm * t - 3 * det) / (3 * t * t - norm / 2)));
  CHECK(conjugate_factor(Sym<3, double>{}, 1.0) == 1);  // of no deviator
}

namespace {

/// The largest root of t^3 - (d:d/2) t + det d - 1 by halving, of the deviator's values as they are.
template <class T>
long double halved_root(const Sym<3, T>& d) {
  const long double x = d.s[0], y = d.s[1], z = d.s[2], half = (x * x + y * y + z * z) / 2, offset = x * y * z - 1;
  long double below = std::sqrt(half / 3), above = 2 * below + 1;
  for (int round = 0; round < 200; ++round) {
    const long double t = (below + above) / 2;
    (t * t * t - half * t + offset > 0 ? above : below) = t;
  }
  return above;
}

}  // namespace

// The share of sqrt(epsilon) is what rounding of the value leaves open where two roots all but meet. The step of Newton's method
// is rounding over a vanishing slope there, and threw the mean a tenth away in float, from stretches of
// forty-five on.
TEMPLATE_TEST_CASE("the mean beside a returned deviator is found however large the trial was", "", float, double) {
  const TestType eps = std::numeric_limits<TestType>::epsilon();
  for (double largest = 10; largest < 1e13; largest *= 1.7)
    for (const double across : {1.0, 0.999, 0.7, 0.3})
      for (const double kept : {1.0, 0.999, 0.5, 1e-3}) {
        const double beside = across / std::sqrt(largest), last = 1 / (largest * beside);
        const double mean = (largest + beside + last) / 3;
        const auto x = static_cast<TestType>(kept * (largest - mean)),
                   y = static_cast<TestType>(kept * (beside - mean));
        const Sym<3, TestType> d{{x, y, -(x + y), 0, 0, 0}};
        const long double root = halved_root(d);
        INFO(largest << " " << across << " " << kept);
        for (const double start : {1.0, 1.5, 30.0}) {
          const auto found =
              unimodular_mean(d, static_cast<TestType>(start * std::max(mean, static_cast<double>(root))));
          CHECK(std::abs(found - root) <= 4 * std::sqrt(eps) * root);
        }
      }
}

// Elementary functions over lanes, against long double, in units in the last place.

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/lanes.hpp"
#include "support/catch.hpp"

namespace {

template <class T>
T log_of(T x) {
  return log(mpm::Lanes<T>(x))[0];
}
template <class T>
T exp_of(T x) {
  return exp(mpm::Lanes<T>(x))[0];
}

template <class T>
double ulps(T value, long double exact) {
  const T rounded = static_cast<T>(exact);
  const T spacing = std::nextafter(std::abs(rounded), std::numeric_limits<T>::infinity()) - std::abs(rounded);
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / spacing);
}

/// The worst error of log over all magnitudes of normal numbers, and close around 1, where the result is small.
template <class T>
double worst_log() {
  double worst = 0;
  const double decades = std::log(static_cast<double>(std::numeric_limits<T>::max()));
  for (int k = -20000; k <= 20000; ++k) {
    for (const T x : {static_cast<T>(std::exp(decades * 0.98 * k / 20000)), static_cast<T>(1 + k * 2e-5),
                      static_cast<T>(1 + k * 1e-9)})
      if (x >= std::numeric_limits<T>::min())
        worst = mpm::test::larger(worst, ulps(log_of(x), std::log(static_cast<long double>(x))));
  }
  return worst;
}

/// The worst error of exp over the range it does not saturate in.
template <class T>
double worst_exp() {
  const double limit = sizeof(T) == 4 ? 86.9 : 707.9;
  double worst = 0;
  for (int k = -20000; k <= 20000; ++k)
    for (const T x : {static_cast<T>(limit * k / 20000), static_cast<T>(k * 1e-4), static_cast<T>(k * 1e-9)})
      worst = mpm::test::larger(worst, ulps(exp_of(x), std::exp(static_cast<long double>(x))));
  return worst;
}

}  // namespace

TEST_CASE("lanes log and exp are accurate to few units in the last place") {
  CAPTURE(worst_log<float>(), worst_log<double>(), worst_exp<float>(), worst_exp<double>());
  CHECK(worst_log<float>() < 2);
  CHECK(worst_log<double>() < 2);
  CHECK(worst_exp<float>() < 2);
  CHECK(worst_exp<double>() < 2);
}

TEMPLATE_TEST_CASE("lanes log at the ends of its range", "", float, double) {
  using Limits = std::numeric_limits<TestType>;
  CHECK(log_of<TestType>(1) == 0);
  CHECK(log_of<TestType>(0) == -Limits::infinity());
  CHECK(log_of<TestType>(Limits::infinity()) == Limits::infinity());
  CHECK(std::isnan(log_of<TestType>(-1)));
  CHECK(std::isnan(log_of<TestType>(-Limits::infinity())));
  CHECK(std::isnan(log_of<TestType>(Limits::quiet_NaN())));
  CHECK(ulps(log_of(Limits::min()), std::log(static_cast<long double>(Limits::min()))) < 2);
  CHECK(ulps(log_of(Limits::max()), std::log(static_cast<long double>(Limits::max()))) < 2);
  // Denormals count as zero, as they do on a processor that flushes them: a J that small is inadmissible anyway.
  CHECK(log_of<TestType>(Limits::denorm_min()) == -Limits::infinity());
}

TEMPLATE_TEST_CASE("lanes exp at the ends of its range", "", float, double) {
  using Limits = std::numeric_limits<TestType>;
  CHECK(exp_of<TestType>(0) == 1);
  CHECK(exp_of<TestType>(Limits::denorm_min()) == 1);
  CHECK(exp_of<TestType>(1000) == Limits::infinity());
  CHECK(exp_of<TestType>(-1000) == 0);
  const TestType most = std::log(Limits::max());
  for (const TestType times : {TestType(1.2), TestType(1.5), TestType(4)}) {  // less than the smallest number as well
    CHECK(exp_of(times * most) == Limits::infinity());
    CHECK(exp_of(-times * most) == 0);
  }
  CHECK(exp_of<TestType>(Limits::infinity()) == Limits::infinity());
  CHECK(exp_of<TestType>(-Limits::infinity()) == 0);
  CHECK(std::isnan(exp_of<TestType>(Limits::quiet_NaN())));
}

TEMPLATE_TEST_CASE("every lane of a pack is computed alone", "", float, double) {
  using Pack = mpm::Lanes<TestType>;
  alignas(64) TestType x[Pack::width], y[Pack::width];
  for (int i = 0; i < Pack::width; ++i) x[i] = static_cast<TestType>(0.3 + 0.7 * i);
  x[1] = std::numeric_limits<TestType>::quiet_NaN();
  const Pack pack = Pack::load(x);
  log(pack).store(y);
  for (int i = 0; i < Pack::width; ++i)
    if (i != 1) CHECK(y[i] == log_of(x[i]));
  exp(pack).store(y);
  for (int i = 0; i < Pack::width; ++i)
    if (i != 1) CHECK(y[i] == exp_of(x[i]));
  (sqrt(pack) + floor(pack)).store(y);
  for (int i = 0; i < Pack::width; ++i)
    if (i != 1) CHECK(y[i] == std::sqrt(x[i]) + std::floor(x[i]));
}

TEMPLATE_TEST_CASE("lanes select, min, max, abs and masks", "", float, double) {
  using Pack = mpm::Lanes<TestType>;
  const Pack minus(TestType(-2)), plus(TestType(3));
  CHECK(min(minus, plus)[0] == -2);
  CHECK(max(minus, plus)[0] == 3);
  CHECK(abs(minus)[0] == 2);
  CHECK(select(minus < plus, minus, plus)[0] == -2);
  CHECK(select(minus > plus, minus, plus)[0] == 3);
  CHECK(mpm::any(minus < plus));
  CHECK_FALSE(mpm::any(minus >= plus));
  alignas(64) TestType x[Pack::width]{};
  x[Pack::width - 1] = 1;
  CHECK(mpm::any(Pack::load(x) > TestType(0)));
}

TEMPLATE_TEST_CASE("lanes compare as their numbers do, with packs and with a number", "", float, double) {
  using Pack = mpm::Lanes<TestType>;
  alignas(64) TestType x[Pack::width];
  for (int i = 0; i < Pack::width; ++i) x[i] = static_cast<TestType>(i % 3);  // below, at and above 1
  const Pack pack = Pack::load(x), ones(TestType(1)), yes(TestType(1)), no(TestType(0));
  for (int i = 0; i < Pack::width; ++i) {
    CHECK((select(pack < ones, yes, no)[i] == 1) == (x[i] < 1));
    CHECK((select(pack > ones, yes, no)[i] == 1) == (x[i] > 1));
    CHECK((select(pack <= ones, yes, no)[i] == 1) == (x[i] <= 1));
    CHECK((select(pack >= ones, yes, no)[i] == 1) == (x[i] >= 1));
    CHECK((select(pack < TestType(1), yes, no)[i] == 1) == (x[i] < 1));
    CHECK((select(pack > TestType(1), yes, no)[i] == 1) == (x[i] > 1));
    CHECK((select(pack <= TestType(1), yes, no)[i] == 1) == (x[i] <= 1));
    CHECK((select(pack >= TestType(1), yes, no)[i] == 1) == (x[i] >= 1));
  }
}

TEMPLATE_TEST_CASE("lanes add, subtract, multiply and divide, with packs and with a number", "", float, double) {
  using Pack = mpm::Lanes<TestType>;
  const TestType two(2);
  const Pack a(TestType(6)), b(TestType(3));
  const auto is = [](const Pack& found, double value) {
    for (int i = 0; i < Pack::width; ++i)
      if (found[i] != static_cast<TestType>(value)) return false;
    return true;
  };
  CHECK(is(a + b, 9));
  CHECK(is(a - b, 3));
  CHECK(is(a * b, 18));
  CHECK(is(a / b, 2));
  CHECK(is(a + two, 8));
  CHECK(is(a - two, 4));
  CHECK(is(a * two, 12));
  CHECK(is(a / two, 3));
  CHECK(is(two + a, 8));
  CHECK(is(two - a, -4));
  CHECK(is(two * a, 12));
  CHECK(is(two / b, 2.0 / 3));
  CHECK(is(-a, -6));
}

TEMPLATE_TEST_CASE("the largest of lanes is found, and whether any holds, wherever in the pack it lies", "", float,
                   double) {
  using Pack = mpm::Lanes<TestType>;
  for (int at = 0; at < Pack::width; ++at) {
    alignas(64) TestType x[Pack::width];
    std::fill_n(x, Pack::width, TestType(-3));
    x[at] = TestType(-2);
    INFO(at);
    CHECK(mpm::largest_lane(Pack::load(x)) == -2);
    CHECK(mpm::any_lane<TestType>(Pack::load(x) > TestType(-3)));
  }
  CHECK_FALSE(mpm::any_lane<TestType>(Pack(TestType(-3)) > TestType(-3)));
}

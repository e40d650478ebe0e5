// Programs of formulas for many points, held against muParser, which evaluates single ones, and the C library.

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <regex>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/formulas.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Units in the last place between two numbers; 0 between two that are both not a number.
double ulps(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b) ? 0 : infinity;
  if (a == b) return std::signbit(a) == std::signbit(b) || a != 0 ? 0 : infinity;
  if (std::isinf(a) || std::isinf(b)) return infinity;
  const double unit = std::nextafter(std::abs(b), infinity) - std::abs(b);
  return std::abs(a - b) / unit;
}

/// A formula of x and y for each function and operator.
std::vector<std::string> texts_of_all_operations() {
  std::vector<std::string> texts{"-x",    "x+y",  "x-y",  "x*y",  "x/y",   "x^y",  "x<y",
                                 "x<=y",  "x>y",  "x>=y", "x==y", "x!=y",  "x&&y", "x||y",
                                 "x?y:7", "x^2",  "x^3",  "x^4",  "x^5",   "x^17", "x^0",
                                 "x^1",   "x^-1", "x^-5", "x^64", "x^2.5", "x^65", "sin(x)+0*cos(x)"};
  for (const std::string& name : expression_functions()) {
    if (name == "if")
      texts.emplace_back("if(x, y, 3)");
    else
      texts.push_back(name + (name == "atan2" || name == "pow" || name == "min" || name == "max" ? "(x, y)" : "(x)"));
  }
  return texts;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

}  // namespace

// ---- functions ------------------------------------------------------------------------------------------------------

TEST_CASE("functions in lanes are within 1 or 1.5 units in the last place", "[expression][formula]") {
  struct Range {
    const char* text;
    double lower, upper;
    long double (*exact)(long double);
    double most;
  };
  const Range ranges[] = {{"sin(x)", -30, 30, sinl, 1.5},
                          {"cos(x)", -30, 30, cosl, 1.5},
                          {"sin(x)", -12000, 12000, sinl, 1.5},
                          {"cos(x)", -12000, 12000, cosl, 1.5},
                          {"sin(x)", -1e6, 1e6, sinl, 1.5},
                          {"exp(x)", -708, 709, expl, 1},
                          {"exp(x)", -1, 1, expl, 1},
                          {"exp(x)", -745, -700, expl, 1},
                          {"log(x)", 1e-300, 1e300, logl, 1},
                          {"log(x)", 0.4, 2.5, logl, 1},
                          {"x^5", -3, 3, [](long double x) { return x * x * x * x * x; }, 1},
                          {"x^3", -3, 3, [](long double x) { return x * x * x; }, 1.5},
                          {"x^(-7)", 0.3, 3, [](long double x) { return 1 / (x * x * x * x * x * x * x); }, 1.5},
                          {"x^20", 0.1, 30, [](long double x) { return powl(x, 20); }, 1}};
  std::mt19937_64 random(3);
  for (const Range& range : ranges) {
    std::vector<Vector3> points(40000);
    for (Vector3& x : points) {
      const double u = static_cast<double>(random() >> 11) / 0x1p53;
      const bool decades = range.upper / range.lower > 1e10;
      x[0] = decades ? std::exp(std::log(range.lower) + u * (std::log(range.upper) - std::log(range.lower)))
                     : range.lower + u * (range.upper - range.lower);
    }
    // The hardest angles are nearest to the multiples of a quarter turn.
    for (int k = 0; k < 2000; ++k) {
      const double near = static_cast<double>(std::numbers::pi_v<long double> / 2 * k);
      if (near <= range.upper && near >= range.lower) points[static_cast<std::size_t>(k)][0] = near;
    }
    const std::vector<double> found = values(formula_of(range.text), points);
    double worst = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const long double exact = range.exact(points[p][0]);
      const double nearest = static_cast<double>(exact);
      const double unit = std::nextafter(std::abs(nearest), infinity) - std::abs(nearest);
      worst = larger(worst, static_cast<double>(std::abs(found[p] - exact)) / unit);
    }
    INFO(range.text << " from " << range.lower << " to " << range.upper << " errs by " << worst << " ulp");
    CHECK(worst <= range.most);
  }
}

TEST_CASE("every function and operator has the values of the C library at special numbers", "[expression][formula]") {
  constexpr double tiny = std::numeric_limits<double>::denorm_min(), least = std::numeric_limits<double>::min(),
                   most = std::numeric_limits<double>::max(), nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> special{0.0,    -0.0,   1,          -1,      0.5,      -0.5,      2,      3,      -3,
                                    tiny,   -tiny,  least,      most,    -most,    1e154,     -1e154, 1e-154, 12000,
                                    -12000, 12001,  1e22,       709,     710,      -708,      -709,   -746,   2.5,
                                    -2.5,   0x1p51, 0x1p52 + 1, -0x1p53, infinity, -infinity, nan};
  std::vector<Vector3> points;
  for (const double a : special)
    for (const double b : special) points.push_back({a, b, 0});
  for (const std::string& text : texts_of_all_operations()) {
    const VectorExpression formula = formula_of(text);
    const std::vector<double> found = values(formula, points);
    for (std::size_t p = 0; p < points.size(); ++p) {
      const double expected = formula(points[p], points[p], 0.5)[0];
      if (ulps(found[p], expected) <= 2) continue;
      if (std::abs(found[p] - expected) < least && text.find('^') != std::string::npos) continue;  // a quotient's end
      INFO(text << " at x = " << points[p][0] << ", y = " << points[p][1]);
      CHECK(ulps(found[p], expected) <= 2);
    }
  }
}

// ---- programs -------------------------------------------------------------------------------------------------------

TEST_CASE("a point has the same bits wherever it stands among others", "[expression][formula]") {
  const VectorExpression formula(
      std::vector<VectorExpression::Term>{"sin(3*X)*exp(-y)+t", "log(1+x^2)/cos(y*30)", "pow(abs(x), 1.7)*cos(3*X)"},
      formula_scope);
  std::vector<Vector3> x(203), X(203), all(203);
  std::mt19937_64 random(9);
  for (std::size_t p = 0; p < x.size(); ++p)
    for (int c = 0; c < 3; ++c) {
      x[p][c] = static_cast<double>(random() >> 11) / 0x1p53;
      X[p][c] = static_cast<double>(random() >> 11) / 0x1p53;
    }
  CHECK(formula.evaluate(x, X, 0.3, all) == x.size());
  bool same = true;
  for (std::size_t first : {0ul, 1ul, 63ul, 64ul, 130ul})
    for (std::size_t count : {1ul, 7ul, 8ul, 9ul, 65ul, 73ul}) {
      std::vector<Vector3> part(count);
      formula.evaluate(std::span(x).subspan(first, count), std::span(X).subspan(first, count), 0.3, part);
      for (std::size_t p = 0; p < count; ++p)
        for (int c = 0; c < 3; ++c) same = same && same_bits(part[p][c], all[first + p][c]);
    }
  CHECK(same);
  // Arrays of coordinates and single components are the same points.
  std::array<std::vector<double>, 6> arrays;
  for (std::size_t p = 0; p < x.size(); ++p)
    for (int c = 0; c < 3; ++c) arrays[c].push_back(x[p][c]), arrays[3 + c].push_back(X[p][c]);
  std::vector<double> y(x.size()), alone(x.size());
  formula.evaluate<double>(
      x.size(),
      {{arrays[0].data(), arrays[1].data(), arrays[2].data()}, {arrays[3].data(), arrays[4].data(), arrays[5].data()}},
      0.3, {nullptr, y.data(), nullptr});
  formula.evaluate(1, x, 0.3, alone.data());
  for (std::size_t p = 0; p < x.size(); ++p)
    same = same && same_bits(y[p], all[p][1]) && same_bits(alone[p], all[p][1]);
  CHECK(same);
}

TEST_CASE("what is constant, of time alone or common is computed as seldom as can be", "[expression][formula]") {
  const auto costs = [](const std::vector<VectorExpression::Term>& terms) {
    const VectorExpression formula(terms, formula_scope);
    return std::pair(formula.operations_at_points(), formula.operations_of_call());
  };
  using Costs = std::pair<std::size_t, std::size_t>;
  CHECK(costs({"2*pi*A*x"}) == Costs(1, 0));
  CHECK(costs({"x^2", "x*x", "x*x+0.5"}) == Costs(2, 0));
  CHECK(costs({"x+y", "y+x", "(x + y)*(y + x)"}) == Costs(2, 0));
  CHECK(costs({"x*sin(n*t)", "y*sin(n*t)"}) == Costs(2, 3));  // t, n t and its sine
  CHECK(costs({"sin(pi*x)", "cos(pi*x)"}) == Costs(2, 0));    // a product, and sine with cosine
  CHECK(costs({"x^4"}) == Costs(2, 0));
  CHECK(costs({"x^9"}) == Costs(1, 0));
  CHECK(costs({"x*1", "x/1", "3"}) == Costs(0, 0));
  CHECK(costs({"1 > 2 ? log(x) : x+1"}) == Costs(1, 0));
}

TEST_CASE("what is not finite is named with its operation and numbers", "[expression][formula]") {
  const auto why = [](const std::string& text, const Vector3& x, double t = 0) {
    const auto found = formula_of(text).not_finite(x, x, t);
    return found ? found->why : "finite";
  };
  CHECK(why("1 + log(x - 2)", {1.5, 0, 0}) == "\"log(x - 2)\" at character 5 is log(-0.5)");
  CHECK(why("3*y/(x-x)", {1, 2, 0}) == "\"3*y/(x-x)\" at character 1 is 6 / 0");
  CHECK(why("x > 0 ? log(x) : 0", {-1, 0, 0}) == "finite");
  CHECK(why("x < 0 ? sqrt(x) : log(y)", {-1, -1, 0}) == "\"sqrt(x)\" at character 9 is sqrt(-1)");
  CHECK(why("x > 0 ? y/(x - x) : log(x)", {1, 2, 0}) == "\"y/(x - x)\" at character 9 is 2 / 0");
  CHECK(why("x + 1/0", {1, 0, 0}) == "\"1/0\" at character 5");
  CHECK(why("exp(t)", {0, 0, 0}, 1000) == "\"exp(t)\" at character 1 is exp(1000)");

  const VectorExpression formula(std::vector<VectorExpression::Term>{"x", "sqrt(y)"}, formula_scope);
  std::vector<Vector3> points(100, Vector3{1, 1, 1}), found(100);
  points[70][1] = points[90][1] = -4;
  CHECK(formula.evaluate(points, points, 0, found) == 70);
  CHECK(std::isnan(found[90][1]));
  CHECK(found[99][1] == 1);
  CHECK(formula.not_finite(points[70], points[70], 0)->component == 1);
}

// ---- float ----------------------------------------------------------------------------------------------------------

namespace {

/// Values of a formula of x and y at points in float.
std::vector<float> float_values(const VectorExpression& formula, const std::vector<float>& x,
                                const std::vector<float>& y) {
  std::vector<float> found(x.size());
  formula.evaluate<float>(x.size(), {{x.data(), y.data(), nullptr}, {}}, 0.5, {found.data(), nullptr, nullptr});
  return found;
}

/// How far a float is from a number, in units of the float nearest to it; 0 where both are beyond the range alike.
double float_ulps(float found, double exact) {
  const auto nearest = static_cast<float>(exact);
  if (std::isnan(found) || std::isnan(exact)) return std::isnan(found) && std::isnan(exact) ? 0 : infinity;
  if (found == nearest) return 0;
  if (std::isinf(found) || std::isinf(nearest)) return infinity;
  const float unit = std::nextafter(std::abs(nearest), std::numeric_limits<float>::infinity()) - std::abs(nearest);
  return std::abs(static_cast<double>(found) - exact) / static_cast<double>(unit);
}

}  // namespace

TEST_CASE("functions in lanes of float are within 1 or 1.5 units in the last place", "[expression][formula]") {
  struct Range {
    const char* text;
    double lower, upper;
    double (*exact)(double);
    double most;
  };
  const Range ranges[] = {{"sin(x)", -30, 30, std::sin, 1.5},
                          {"cos(x)", -30, 30, std::cos, 1.5},
                          {"sin(x)", -800, 800, std::sin, 1.5},
                          {"cos(x)", -800, 800, std::cos, 1.5},
                          {"sin(x)", -1e5, 1e5, std::sin, 1.5},
                          {"exp(x)", -87, 88, std::exp, 1},
                          {"exp(x)", -1, 1, std::exp, 1},
                          {"exp(x)", -104, -86, std::exp, 1},
                          {"log(x)", 1e-37, 1e38, std::log, 1},
                          {"log(x)", 0.4, 2.5, std::log, 1},
                          {"x^5", -3, 3, [](double x) { return x * x * x * x * x; }, 1},
                          {"x^3", -3, 3, [](double x) { return x * x * x; }, 1.5},
                          {"x^(-7)", 0.3, 3, [](double x) { return std::pow(x, -7); }, 1.5},
                          {"x^20", 0.1, 30, [](double x) { return std::pow(x, 20); }, 1}};
  std::mt19937_64 random(3);
  for (const Range& range : ranges) {
    std::vector<float> x(40000);
    for (float& value : x) {
      const double u = static_cast<double>(random() >> 11) / 0x1p53;
      const bool decades = range.upper / range.lower > 1e10;
      value = static_cast<float>(decades ? std::exp(std::log(range.lower) + u * std::log(range.upper / range.lower))
                                         : range.lower + u * (range.upper - range.lower));
    }
    // The hardest angles are nearest to the multiples of a quarter turn.
    for (int k = 0; k < 2000; ++k)
      if (const double near = std::numbers::pi / 2 * k; near <= range.upper && near >= range.lower)
        x[static_cast<std::size_t>(k)] = static_cast<float>(near);
    const std::vector<float> found = float_values(formula_of(range.text), x, x);
    double worst = 0;
    for (std::size_t p = 0; p < x.size(); ++p)
      worst = larger(worst, float_ulps(found[p], range.exact(static_cast<double>(x[p]))));
    INFO(range.text << " from " << range.lower << " to " << range.upper << " errs by " << worst << " ulp");
    CHECK(worst <= range.most);
  }
}

TEST_CASE("every function and operator has the values of the C library at special floats", "[expression][formula]") {
  constexpr float tiny = std::numeric_limits<float>::denorm_min(), least = std::numeric_limits<float>::min(),
                  most = std::numeric_limits<float>::max(), end = std::numeric_limits<float>::infinity();
  const std::vector<float> special{0.0F,
                                   -0.0F,
                                   1.0F,
                                   -1.0F,
                                   0.5F,
                                   -0.5F,
                                   2.0F,
                                   3.0F,
                                   -3.0F,
                                   tiny,
                                   -tiny,
                                   least,
                                   most,
                                   -most,
                                   1e19F,
                                   -1e19F,
                                   1e-19F,
                                   3000.0F,
                                   3001.0F,
                                   88.0F,
                                   89.0F,
                                   -87.0F,
                                   -88.0F,
                                   2.5F,
                                   -2.5F,
                                   0x1p22F,
                                   0x1p23F,
                                   -0x1p24F,
                                   end,
                                   -end,
                                   std::numeric_limits<float>::quiet_NaN()};
  std::vector<float> x, y;
  for (const float a : special)
    for (const float b : special) x.push_back(a), y.push_back(b);
  for (const std::string& text : texts_of_all_operations()) {
    const VectorExpression formula = formula_of(text);
    const std::vector<float> found = float_values(formula, x, y);
    for (std::size_t p = 0; p < x.size(); ++p) {
      const Vector3 point{static_cast<double>(x[p]), static_cast<double>(y[p]), 0};
      const double expected = formula(point, point, 0.5)[0];
      if (float_ulps(found[p], expected) <= 2) continue;
      if (std::abs(expected) < 4 * static_cast<double>(least) && text.find('^') != std::string::npos)
        continue;  // its end
      INFO(text << " at x = " << x[p] << ", y = " << y[p] << " is " << found[p] << ", expected " << expected);
      CHECK(float_ulps(found[p], expected) <= 2);
    }
  }
}

TEST_CASE("formulas in float find what depends on time alone in double, and the first point that fails",
          "[expression][formula]") {
  // A float knows 1e6 t to 1/16 only, so the sine would be wrong in its first digits.
  const VectorExpression formula(std::vector<VectorExpression::Term>{"x*sin(1e6*t)", "sqrt(y)", "1e30*x*x"},
                                 formula_scope);
  std::vector<float> x(100, 2), y(100, 4), first(100), second(100), third(100);
  const double t = 0.7300001;
  CHECK(formula.evaluate<float>(100, {{x.data(), y.data(), nullptr}, {}}, t,
                                {first.data(), second.data(), third.data()}) == 100);
  CHECK(float_ulps(first[99], 2 * std::sin(1e6 * t)) <= 1);
  CHECK(second[0] == 2);
  y[70] = -4, x[63] = 1e10F;  // beyond the largest float, though no double
  CHECK(formula.evaluate<float>(100, {{x.data(), y.data(), nullptr}, {}}, t,
                                {first.data(), second.data(), third.data()}) == 63);
  for (std::size_t count : {1ul, 15ul, 17ul, 65ul}) {  // whatever stands beside a point
    std::vector<float> part(count);
    formula.evaluate<float>(count, {{x.data(), y.data(), nullptr}, {}}, t, {part.data(), nullptr, nullptr});
    CHECK(std::equal(part.begin(), part.end(), first.begin()));
  }
}

// ---- the page -------------------------------------------------------------------------------------------------------

TEST_CASE("the page of the experiment file lists every function, and operators as they bind", "[expression][formula]") {
  const std::string page = support::read_file(MPM_SOURCE_DIR "/docs/experiment_file.md");
  const std::string section = page.substr(page.find("## Expressions"));
  for (const std::string& name : expression_functions()) CHECK_THAT(section, ContainsSubstring("`" + name + "("));

  const std::regex row("\\n\\|[^\\n]*\\| `([^`\\n]+)` \\| `([^`\\n]+)` \\|(?=\\n)");
  std::mt19937_64 random(2);
  std::vector<Vector3> points(50);
  for (Vector3& x : points)
    for (double& c : x) c = static_cast<double>(random() % 5);
  int rows = 0;
  for (std::sregex_iterator match(section.begin(), section.end(), row), end; match != end; ++match, ++rows) {
    const auto plain = [](const std::string& cell) { return std::regex_replace(cell, std::regex("\\\\\\|"), "|"); };
    const std::string written = plain((*match)[1]), meant = plain((*match)[2]);
    INFO(written << " means " << meant);
    const VectorExpression a = formula_of(written), b = formula_of(meant);
    for (const Vector3& x : points) CHECK(ulps(a(x, x, 1)[0], b(x, x, 1)[0]) <= 1);
    const std::vector<double> first = values(a, points), second = values(b, points);
    for (std::size_t p = 0; p < points.size(); ++p) CHECK(ulps(first[p], second[p]) <= 1);
  }
  CHECK(rows == 9);
}

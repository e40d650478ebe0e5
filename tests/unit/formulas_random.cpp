// Random formulas in batches, held against muParser, which reads and evaluates them point by point.

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "support/catch.hpp"
#include "support/formulas.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity(), epsilon = std::numeric_limits<double>::epsilon();

/// A value with a bound of what rounding may have moved it by.
struct Bounded {
  double value, error;
};

/// A formula as text, and as operations of which each may err by `slack` units in the last place.
struct Tree {
  std::string text;
  std::function<Bounded(const Vector3& x, double t)> at;
};

/// Random formulas of smooth functions within their domains.
class Trees {
 public:
  explicit Trees(unsigned seed) : random_(seed) {}

  Tree make(int depth) {
    if (depth == 0) return leaf();
    switch (pick(12)) {
      case 0:
        return joined(
            depth, "+", [](double a, double b) { return a + b; },
            [](Bounded a, Bounded b) { return a.error + b.error; });
      case 1:
        return joined(
            depth, "-", [](double a, double b) { return a - b; },
            [](Bounded a, Bounded b) { return a.error + b.error; });
      case 2:
      case 3:
        return joined(
            depth, "*", [](double a, double b) { return a * b; },
            [](Bounded a, Bounded b) { return std::abs(a.value) * b.error + std::abs(b.value) * a.error; });
      case 4:
        return quotient(depth);
      case 5:
        return power(depth);
      case 6:
        return choice(depth);
      case 7:
        return function(
            "exp(sin(", "))", depth, [](double a) { return std::exp(std::sin(a)); }, [](double) { return 3.0; });
      case 8:
        return function(
            "log(abs(", ")+0.5)", depth, [](double a) { return std::log(std::abs(a) + 0.5); },
            [](double) { return 2.0; });
      case 9:
        return function(
            "sqrt(abs(", ")+1)", depth, [](double a) { return std::sqrt(std::abs(a) + 1); },
            [](double) { return 1.0; });
      case 10:
        return function(
            "atan(", ")", depth, [](double a) { return std::atan(a); }, [](double) { return 1.0; });
      default:
        return pick(2) ? function(
                             "sin(", ")", depth, [](double a) { return std::sin(a); }, [](double) { return 1.0; })
                       : function(
                             "cos(", ")", depth, [](double a) { return std::cos(a); }, [](double) { return 1.0; });
    }
  }

 private:
  static constexpr double slack = 2 * epsilon;

  unsigned pick(unsigned below) { return static_cast<unsigned>(random_() % below); }

  Tree leaf() {
    switch (pick(6)) {
      case 0:
        return {"x", [](const Vector3& x, double) { return Bounded{x[0], 0}; }};
      case 1:
        return {"y", [](const Vector3& x, double) { return Bounded{x[1], 0}; }};
      case 2:
        return {"t", [](const Vector3&, double t) { return Bounded{t, 0}; }};
      case 3:
        return {"A", [](const Vector3&, double) { return Bounded{0.25, 0}; }};
      default: {
        const double number = 0.125 * (1 + pick(30));
        return {std::to_string(number), [number](const Vector3&, double) { return Bounded{number, 0}; }};
      }
    }
  }

  template <class Value, class Error>
  Tree joined(int depth, const std::string& sign, Value value, Error error) {
    const Tree a = make(depth - 1), b = make(depth - 1);
    return {"(" + a.text + ")" + sign + "(" + b.text + ")", [=](const Vector3& x, double t) {
              const Bounded first = a.at(x, t), second = b.at(x, t);
              const double found = value(first.value, second.value);
              return Bounded{found, error(first, second) + slack * std::abs(found)};
            }};
  }

  template <class Value, class Slope>
  Tree function(const std::string& before, const std::string& after, int depth, Value value, Slope slope) {
    const Tree a = make(depth - 1);
    return {before + a.text + after, [=](const Vector3& x, double t) {
              const Bounded of = a.at(x, t);
              const double found = value(of.value);
              // The inner function's slack is moved by the outer one's slope.
              return Bounded{found, slope(of.value) * (of.error + slack) + 2 * slack * std::abs(found)};
            }};
  }

  Tree quotient(int depth) {
    const Tree a = make(depth - 1), b = make(depth - 1);
    return {"(" + a.text + ")/(1+(" + b.text + ")^2)", [=](const Vector3& x, double t) {
              const Bounded above = a.at(x, t), of = b.at(x, t);
              const double below = 1 + of.value * of.value, found = above.value / below;
              const double error = 2 * std::abs(of.value) * of.error + 2 * slack * below;
              return Bounded{found, above.error / below + std::abs(found) * (error / below + slack)};
            }};
  }

  Tree power(int depth) {
    static constexpr double exponents[] = {2, 3, 4, 5, 7, 12, -1, -2, -3, -6, 0.5, 1.5, -2.25};
    const double n = exponents[pick(std::size(exponents))];
    const Tree a = make(depth - 1);
    return {"(1+abs(" + a.text + "))^" + (n < 0 ? "(" + std::to_string(n) + ")" : std::to_string(n)),
            [=](const Vector3& x, double t) {
              const Bounded of = a.at(x, t);
              const double base = 1 + std::abs(of.value), found = std::pow(base, n);
              return Bounded{found, found * (std::abs(n) * (of.error / base + slack) + slack)};
            }};
  }

  Tree choice(int depth) {
    const Tree a = make(depth - 1), b = make(depth - 1), c = make(depth - 1);
    const bool ternary = pick(2);
    return {ternary ? "((" + a.text + ")<(" + b.text + ")?" + c.text + ":-1)"
                    : "if((" + a.text + ")<(" + b.text + ")," + c.text + ",-1)",
            [=](const Vector3& x, double t) {
              const Bounded first = a.at(x, t), second = b.at(x, t);
              if (!(std::abs(first.value - second.value) > first.error + second.error)) return Bounded{0, infinity};
              return first.value < second.value ? c.at(x, t) : Bounded{-1, 0};
            }};
  }

  std::mt19937_64 random_;
};

/// Random formulas of small whole numbers, in which every operation is exact, with few parentheses.
class Grammar {
 public:
  explicit Grammar(unsigned seed) : random_(seed) {}

  std::string make(int length) {
    quotients_ = pick(2);
    return expression(length);
  }

 private:
  unsigned pick(unsigned below) { return static_cast<unsigned>(random_() % below); }

  std::string value(int length) {
    static const char* const leaves[] = {"x", "y", "z", "t", "X", "1", "2", "3", "n"};
    static const char* const binary[] = {"min", "max"};
    if (length > 1 && pick(4) == 0) return "(" + expression(length / 2) + ")";
    if (length > 1 && pick(8) == 0)
      return std::string(binary[pick(2)]) + "(" + expression(length / 3) + "," + expression(length / 3) + ", x)";
    if (length > 1 && pick(8) == 0) return "abs(" + expression(length / 2) + ")";
    return leaves[pick(std::size(leaves))];
  }

  std::string expression(int length) {
    static const char* const operators[] = {"+", "-", "*", "<", ">", "<=", ">=", "==", "!=", "&&", "||", "+", "-", "*"};
    std::string text;
    for (int i = 0; i < std::max(length, 1); ++i) {
      if (i > 0) {
        const unsigned kind = pick(8);
        if (kind == 0)
          text += quotients_ ? "/" + std::string(pick(2) ? "2" : "4") + "*" : "^";
        else
          text += operators[pick(std::size(operators))];
      }
      if (pick(4) == 0) text += pick(4) ? "-" : "+";
      if (pick(6) == 0) text += " ";
      text += value(length);
    }
    if (length > 1 && pick(5) == 0) text += " ? " + expression(length / 2) + " : " + expression(length / 2);
    return text;
  }

  std::mt19937_64 random_;
  bool quotients_ = false;
};

}  // namespace

TEST_CASE("batches read every formula as muParser does", "[expression][formula]") {
  Grammar grammar(7);
  const std::vector<Vector3> points{{1, 2, 3}, {3, 1, 0}, {0, 0, 0}, {-2, 5, 1}, {2, 2, 2}, {1, -1, -3}};
  int compared = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string text = grammar.make(1 + i % 9);
    if (text.size() > 1000) continue;
    VectorExpression formula;
    try {
      formula = formula_of(text);
    } catch (const ExpressionError&) {
      ++refused;  // a sign after a sign, or a constant that is not finite
      continue;
    }
    const std::vector<double> found = values(formula, points, 2);
    for (std::size_t p = 0; p < points.size(); ++p) {
      const double expected = formula(points[p], points[p], 2)[0];
      if (!(std::abs(expected) < 0x1p50)) continue;  // rounded on the way
      ++compared;
      if (found[p] != expected && !(std::abs(found[p] - expected) <= 1e-12 * std::abs(expected))) {
        INFO(text << " at point " << p << ": " << found[p] << " in place of " << expected);
        CHECK(found[p] == expected);
      }
    }
  }
  CHECK(compared > 60000);
  CHECK(refused < 4000);
}

TEST_CASE("batches give what muParser gives, to 2 units in the last place an operation", "[expression][formula]") {
  Trees trees(11);
  std::mt19937_64 random(5);
  std::vector<Vector3> points(20);
  for (Vector3& x : points)
    for (double& c : x) c = 4 * static_cast<double>(random() >> 11) / 0x1p53 - 2;
  int compared = 0;
  for (int i = 0; i < 4000; ++i) {
    const Tree tree = trees.make(1 + i % 5);
    if (tree.text.size() > 1500) continue;
    const VectorExpression formula = formula_of(tree.text);
    const std::vector<double> found = values(formula, points);
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Bounded expected = tree.at(points[p], 0.5);
      if (!(expected.error < 1e-6 * (1 + std::abs(expected.value)))) continue;
      ++compared;
      const double oracle = formula(points[p], points[p], 0.5)[0];
      if (!(std::abs(found[p] - expected.value) <= expected.error) ||
          !(std::abs(found[p] - oracle) <= 2 * expected.error)) {
        INFO(tree.text << ": " << found[p] << ", muParser " << oracle << ", bound " << expected.error);
        CHECK(found[p] == expected.value);
      }
    }
  }
  CHECK(compared > 60000);
}

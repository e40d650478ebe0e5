#include <cmath>
#include <functional>
#include <numbers>
#include <thread>

#include "experiment/expression.hpp"
#include "support/catch.hpp"

using namespace mpm;

namespace {

VectorExpression one(const std::string& text) {
  const VectorExpression::Term term = text;
  return VectorExpression(std::span(&term, 1), {"xyzXYZt", {{"A", 0.25}, {"omega", 3.0}}});
}

std::string error_of(const std::string& text) {
  try {
    one(text);
  } catch (const ExpressionError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("expressions give what C++ gives", "[expression]") {
  struct Case {
    const char* text;
    std::function<double(double, double, double, double)> expected;  // arguments x, y, X, t
  };
  constexpr double pi = std::numbers::pi;
  const Case cases[] = {
      {"A*sin(2*pi*x)*cos(omega*t)",
       [](double x, double, double, double t) { return 0.25 * std::sin(2 * pi * x) * std::cos(3 * t); }},
      {"x^2 - y^3", [](double x, double y, double, double) { return x * x - y * y * y; }},
      {"-x^2", [](double x, double, double, double) { return -x * x; }},
      {"pow(x, 2.5) + sqrt(y) + exp(-t)",
       [](double x, double y, double, double t) { return std::pow(x, 2.5) + std::sqrt(y) + std::exp(-t); }},
      {"log(x) + tan(y) + atan2(y, x)",
       [](double x, double y, double, double) { return std::log(x) + std::tan(y) + std::atan2(y, x); }},
      {"min(x, y, X) + max(x, y) + abs(-X)",
       [](double x, double y, double X, double) {
         return std::min({x, y, X}) + std::max(x, y) + std::abs(X);
       }},
      {"if(x > y, x, y) + (t <= 2 ? 1 : 5)",
       [](double x, double y, double, double t) { return (x > y ? x : y) + (t <= 2 ? 1 : 5); }},
      {"x > 0.1 && y < 3 || t == 1",
       [](double x, double y, double, double t) { return (x > 0.1 && y < 3) || t == 1 ? 1.0 : 0.0; }},
  };
  for (const Case& c : cases) {
    INFO(c.text);
    const VectorExpression expression = one(c.text);
    CHECK_FALSE(expression.is_constant());
    for (const double t : {0.0, 1.0, 2.5}) {
      for (const double x : {0.3, 0.8}) {
        const double y = 0.5, X = 0.4;
        CHECK(expression({x, y, 0}, {X, 0, 0}, t)[0] == Approx(c.expected(x, y, X, t)).epsilon(1e-14));
      }
    }
  }
}

TEST_CASE("an expression knows what it depends on", "[expression]") {
  CHECK(one("2*pi*A").is_constant());
  CHECK(one("2*pi*A")({9, 9, 9}, {9, 9, 9}, 9)[0] == Approx(0.5 * std::numbers::pi));
  CHECK(one("X*2").uses_initial_position());
  CHECK_FALSE(one("X*2").uses_position());
  CHECK(one("t").uses_time());
  CHECK_FALSE(one("x+y").uses_time());
  CHECK(VectorExpression().is_constant());
  CHECK(VectorExpression({1, 2, 3})({}, {}, 0) == Vector3{1, 2, 3});
}

TEST_CASE("components may be numbers and formulas, and copies agree", "[expression]") {
  const std::vector<VectorExpression::Term> terms = {2.0, "x*t", "3*A"};
  const VectorExpression expression(terms, {"xt", {{"A", 2.0}}});
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): copying is what is tested
  const VectorExpression copy = expression;
  CHECK(expression({3, 0, 0}, {}, 5) == Vector3{2, 15, 6});
  CHECK(copy({4, 0, 0}, {}, 5) == Vector3{2, 20, 6});
}

TEST_CASE("a mistake in an expression is quoted with its position", "[expression]") {
  CHECK(error_of("sin(x") == "in the expression \"sin(x\" at character 7: a ')' is missing");
  CHECK(error_of("x + omgea") ==
        "in the expression \"x + omgea\" at character 5: unknown name \"omgea\"; did you mean \"omega\"? "
        "(known: \"sin\", \"cos\", \"tan\", \"asin\", \"acos\", \"atan\", \"sinh\", \"cosh\", \"tanh\", "
        "\"exp\", \"log\", \"sqrt\", \"abs\", \"floor\", \"atan2\", \"pow\", \"if\", \"min\", \"max\", \"pi\", "
        "\"A\", \"omega\", \"x\", \"y\", \"z\", \"X\", \"Y\", \"Z\", \"t\")");
  CHECK(error_of("x = 3") == "in the expression \"x = 3\" at character 3: a formula assigns nothing; == compares");
  CHECK(error_of("1, 2") == "in the expression \"1, 2\": one value is wanted, not 2");
  CHECK(error_of("") == "the expression is empty");
  CHECK(error_of("1/0") == "in the expression \"1/0\": its value is not a finite number");
  CHECK(error_of("x +") != "accepted");
  CHECK(error_of("pow(x)") != "accepted");
  CHECK(error_of(std::string(3000, '(')) != "accepted");
  const VectorExpression::Term time = "t";
  CHECK_THROWS_WITH(VectorExpression(std::span(&time, 1), {"xyz", {}}),
                    "in the expression \"t\" at character 1: \"t\" is not available here; variables are x y z");
}

TEST_CASE("an expression may be evaluated by many threads at once", "[expression]") {
  const VectorExpression expression = one("x*x + sin(t)");
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&, thread] {
      for (int i = 0; i < 2000; ++i) {
        const double x = thread + i * 1e-3;
        wrong[thread] += std::abs(expression({x, 0, 0}, {}, x)[0] - (x * x + std::sin(x))) > 1e-12;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == std::vector<int>(4, 0));
}

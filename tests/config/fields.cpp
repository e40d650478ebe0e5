// Keys of a table by themselves: what no section of the experiment shows on its own.
#include <memory>

#include "config/config_support.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A text read by a table of its own.
struct Table {
  Table(std::vector<ParameterSpec> parameters, const std::string& text)
      : root(parse_located(text, "FILE")), context{"FILE", 2, {{"A", 2.0}}, {}, {}} {
    fields = std::make_unique<Fields>(&root, Section{"test", "a test", std::move(parameters)}, context);
  }
  std::string problems() const {
    std::string all;
    for (const Problem& problem : context.problems) all += problem.text() + "\n";
    return all;
  }

  Node root;
  ReadContext context;
  std::unique_ptr<Fields> fields;
};

ParameterSpec temperature() {
  return parameter("temperature", ParameterType::expression, "K", "How warm it is.").over("xyzt").from(0);
}
std::string problems_of_temperature(const std::string& value) {
  return Table({temperature()}, R"({"temperature": )" + value + "}").problems();
}

}  // namespace

TEST_CASE("a scalar expression is a number, a quantity or a formula", "[config]") {
  const auto value = [](const std::string& text) {
    const Table table({temperature()}, R"({"temperature": )" + text + "}");
    REQUIRE(table.problems() == "");
    return table.fields->scalar_expression("temperature");
  };
  CHECK(value("300")({}, {}, 0) == 300);
  CHECK(value("\"300 K\"")({}, {}, 0) == 300);
  CHECK(value("\"300\"")({}, {}, 0) == 300);
  const ScalarExpression formula = value("\"A*x + 10*t\"");
  CHECK(formula({1.5, 7, 0}, {}, 3) == 33);
  CHECK(formula.uses_time());
  CHECK(formula.varies(0));
  CHECK_FALSE(formula.varies(1));
  CHECK(value("\"A*150\"").is_constant());
  const Vector3 points[] = {{1, 0, 0}, {2, 0, 0}};
  double values[2];
  formula.evaluate(points, 0.5, values);
  CHECK(values[0] == 7);
  CHECK(values[1] == 9);
}

TEST_CASE("a scalar expression that is wrong is located and says what was expected", "[config]") {
  const std::string place = "FILE:1:17: /temperature: ";
  CHECK(problems_of_temperature("[300]") ==
        place + "expected a temperature (K) of at least 0 or an expression, got a list\n");
  CHECK(problems_of_temperature("-10") ==
        place + "out of range: expected a temperature (K) of at least 0 or an expression, got -10\n");
  CHECK(problems_of_temperature("\"A-12\"") ==
        place + "out of range: expected a temperature (K) of at least 0 or an expression, got -10 (A-12)\n");
  CHECK(problems_of_temperature("\"1/0\"") == place + "in the expression \"1/0\": its value is not a finite number\n");
  CHECK(problems_of_temperature("\"300*z\"") ==
        place + "in the expression \"300*z\" at character 5: \"z\" is not available here; variables are x y t\n");
  CHECK(problems_of_temperature("\"20 degC\"") ==
        place + "degrees Celsius have another zero and are no unit here; write kelvin, which are 273.15 more\n");
}

TEST_CASE("a nested key with a table is read by it", "[config]") {
  const auto outer = [] {
    return parameter("air", ParameterType::nested, "", "the air")
        .made_of({"air", "the air", {temperature().needed(), parameter("speed", ParameterType::number, "m/s", "")}});
  };
  Table table({outer()}, R"({"air": {"temperature": "x", "sped": 3}})");
  const Fields inner = table.fields->nested("air");
  CHECK(inner.scalar_expression("temperature")({4, 0, 0}, {}, 0) == 4);
  CHECK_FALSE(inner.given("speed"));
  CHECK(table.problems() ==
        "FILE:1:30: /air/sped: unknown key \"sped\"; did you mean \"speed\"? (valid keys: \"temperature\", "
        "\"speed\")\n");
  Table absent({outer()}, "{}");
  CHECK_FALSE(absent.fields->nested("air").given("temperature"));
  CHECK(absent.problems() == "");
}

TEST_CASE("the node at a pointer, or the nearest around it", "[config]") {
  const Node root = parse_located(R"({"a": {"b/c": [1, {"d": 2}]}})", "FILE");
  CHECK(nearest_node(root, "/a/b~1c/1/d").number == 2);
  CHECK(nearest_node(root, "/a/b~1c/7/d").pointer == "/a/b~1c");
  CHECK(nearest_node(root, "/x").pointer.empty());
}

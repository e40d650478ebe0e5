// Scenes whose formulas at particles hold every operation that formulas have.
#pragma once

#include <cctype>
#include <set>

#include "device/device_support.hpp"

namespace mpm::test {

/// Formulas of places, first places and the time that between them hold every operation, each of them finite and larger
/// than 0.05 at some particle of a Mix.
inline std::vector<std::string> every_operation(int dimension) {
  std::vector<std::string> all{"sin(9*x+t)",
                               "cos(7*y*X)",
                               "tan(x)",
                               "asin(0.5*x)",
                               "acos(0.5*y)",
                               "atan(3*x-y)",
                               "sinh(x)",
                               "cosh(y)",
                               "tanh(2*x)",
                               "exp(x-y)",
                               "log(1+x+y)",
                               "sqrt(1+x+y)",
                               "abs(x-0.75)",
                               "floor(7*X+0.31)",
                               "atan2(y-0.4, x-0.7)",
                               "pow(1.2+x, 1.7+y)",
                               "(0.3+x)^7",
                               "(1.3+y)^-5",
                               "x^3",
                               "min(x, y, 0.4)",
                               "max(x, y-t, -1)",
                               "if(x > 0.5653, y, -x)",
                               "x < y+0.2507",
                               "0.353 > y",
                               "x <= 0.5507",
                               "Y >= 0.311",
                               "floor(9*X) == 4",
                               "floor(9*X) != 4",
                               "(x < 0.5709) && (y > 0.307)",
                               "(x < 0.303) || (y > 0.303)",
                               "-x/(2+y)",
                               "cos(40*t)",
                               "0.7"};
  if (dimension == 3) all.insert(all.end(), {"z*x", "sin(4*Z)"});
  return all;
}

/// Which of the functions and operators of formulas no formula of a list holds.
inline std::set<std::string> operations_without(const std::vector<std::string>& formulas) {
  const std::vector<std::string> functions = expression_functions();
  std::set<std::string> missing;
  for (const std::string& function : functions) missing.insert(function + "(");
  missing.insert({"+", "-", "*", "/", "^", " < ", " > ", "<=", ">=", "==", "!=", "&&", "||"});
  for (const std::string& formula : formulas)
    std::erase_if(missing, [&](const std::string& part) {
      const std::size_t at = formula.find(part);  // tan( is no part of atan(
      return at != formula.npos && (at == 0 || !std::isalpha(part[0]) || !std::isalpha(formula[at - 1]));
    });
  return missing;
}

/// A mix with a force on all bodies, and two more by mass on the second one, that hold every operation once.
inline Mix mix_with_every_operation(int dimension) {
  const std::vector<std::string> formulas = every_operation(dimension);
  // Nine sums of formulas, or six in the plane, with a factor each by which they differ.
  const auto components = static_cast<std::size_t>(dimension);
  std::vector<std::string> sums(3 * components, "0");
  for (std::size_t k = 0; k < formulas.size(); ++k)
    sums[k % sums.size()] += "+" + std::to_string(k % 2 == 0 ? 1.5 : -2.5) + "*(" + formulas[k] + ")";
  const auto vector = [&](std::size_t number) {
    std::string all = "[";
    for (std::size_t c = 0; c < components; ++c) all += (c > 0 ? ", \"" : "\"") + sums[number * components + c] + "\"";
    return all + "]";
  };
  Mix mix;
  mix.dimension = dimension;
  mix.more = ", \"body_force\": " + vector(0);
  mix.more += R"(, "loads": [{"type": "body_force", "body": "b", "acceleration": )" + vector(1) +
              R"(}, {"type": "body_force", "body": "b", "acceleration": )" + vector(2) + "}]";
  return mix;
}

}  // namespace mpm::test

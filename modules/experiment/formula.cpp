#include "experiment/formula.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace mpm::formula {

int operands(Operation operation) {
  if (operation <= Operation::variable) return 0;
  if (operation < Operation::add) return 1;
  return operation < Operation::choose ? 2 : 3;
}

double value_of(Operation operation, double a, double b, double c) {
  switch (operation) {
    case Operation::constant:
    case Operation::variable:
      return a;
    case Operation::negate:
      return -a;
    case Operation::sin:
      return std::sin(a);
    case Operation::cos:
      return std::cos(a);
    case Operation::tan:
      return std::tan(a);
    case Operation::asin:
      return std::asin(a);
    case Operation::acos:
      return std::acos(a);
    case Operation::atan:
      return std::atan(a);
    case Operation::sinh:
      return std::sinh(a);
    case Operation::cosh:
      return std::cosh(a);
    case Operation::tanh:
      return std::tanh(a);
    case Operation::exp:
      return std::exp(a);
    case Operation::log:
      return std::log(a);
    case Operation::sqrt:
      return std::sqrt(a);
    case Operation::abs:
      return std::abs(a);
    case Operation::floor:
      return std::floor(a);
    case Operation::add:
      return a + b;
    case Operation::subtract:
      return a - b;
    case Operation::multiply:
      return a * b;
    case Operation::divide:
      return a / b;
    case Operation::power:
    case Operation::whole_power:
      return std::pow(a, b);
    case Operation::atan2:
      return std::atan2(a, b);
    case Operation::min:
      return b < a ? b : a;
    case Operation::max:
      return a < b ? b : a;
    case Operation::less:
      return a < b ? 1 : 0;
    case Operation::greater:
      return a > b ? 1 : 0;
    case Operation::less_or_equal:
      return a <= b ? 1 : 0;
    case Operation::greater_or_equal:
      return a >= b ? 1 : 0;
    case Operation::equal:
      return a == b ? 1 : 0;
    case Operation::unequal:
      return a != b ? 1 : 0;
    case Operation::both:
      return a != 0 && b != 0 ? 1 : 0;
    case Operation::either:
      return a != 0 || b != 0 ? 1 : 0;
    case Operation::choose:
      return a != 0 ? b : c;
  }
  return 0;
}

const std::vector<Function>& functions() {
  static const std::vector<Function> all = {
      {"sin", Operation::sin, 1, 1},      {"cos", Operation::cos, 1, 1},     {"tan", Operation::tan, 1, 1},
      {"asin", Operation::asin, 1, 1},    {"acos", Operation::acos, 1, 1},   {"atan", Operation::atan, 1, 1},
      {"sinh", Operation::sinh, 1, 1},    {"cosh", Operation::cosh, 1, 1},   {"tanh", Operation::tanh, 1, 1},
      {"exp", Operation::exp, 1, 1},      {"log", Operation::log, 1, 1},     {"sqrt", Operation::sqrt, 1, 1},
      {"abs", Operation::abs, 1, 1},      {"floor", Operation::floor, 1, 1}, {"atan2", Operation::atan2, 2, 2},
      {"pow", Operation::power, 2, 2},    {"if", Operation::choose, 3, 3},   {"min", Operation::min, 1, 1 << 20},
      {"max", Operation::max, 1, 1 << 20}};
  return all;
}

// ---- graph ----------------------------------------------------------------------------------------------------------

int Graph::add(const Term& term) {
  const auto key = std::tuple(term.operation, term.of, std::bit_cast<std::uint64_t>(term.constant), term.variable);
  const auto [place, is_new] = known_.try_emplace(key, static_cast<int>(terms_.size()));
  if (is_new) terms_.push_back(term);
  return place->second;
}

int Graph::constant(double value) {
  Term term;
  term.constant = value;
  return add(term);
}

int Graph::variable(int number) {
  Term term;
  term.operation = Operation::variable, term.variable = number, term.at_points = number != time_variable;
  return add(term);
}

/// The term that an operation gives back to the last bit, or -1.
int Graph::unchanged(Operation operation, const std::array<int, 3>& of) const {
  const auto is = [&](int term, double value) {
    return terms_[term].operation == Operation::constant && terms_[term].constant == value;
  };
  if (operation == Operation::multiply && is(of[0], 1)) return of[1];
  if ((operation == Operation::multiply || operation == Operation::divide) && is(of[1], 1)) return of[0];
  if (operation == Operation::choose && terms_[of[0]].operation == Operation::constant)
    return terms_[of[0]].constant != 0 ? of[1] : of[2];
  return -1;
}

int Graph::apply(Operation operation, int a, int b, int c) {
  if (operation == Operation::power) return power(a, b);
  Term term;
  term.operation = operation, term.of = {a, b, c};
  bool constants = true;
  std::array<double, 3> values{};
  for (int i = 0; i < operands(operation); ++i) {
    const Term& operand = terms_[term.of[i]];
    constants = constants && operand.operation == Operation::constant;
    values[i] = operand.constant;
    term.at_points = term.at_points || operand.at_points;
  }
  if (constants) return constant(value_of(operation, values[0], values[1], values[2]));
  if (const int same = unchanged(operation, term.of); same >= 0) return same;
  if (operation == Operation::add || operation == Operation::multiply)
    std::sort(term.of.begin(), term.of.begin() + 2);  // a sum and a product have the same bits either way round
  return add(term);
}

/// Products in place of small powers, which thus share what they have in common.
int Graph::power(int base, int exponent) {
  const double n = terms_[exponent].constant;
  const bool varies = terms_[base].operation != Operation::constant;
  constexpr double largest = 64;
  if (!varies || terms_[exponent].operation != Operation::constant) {
    Term term;
    term.operation = Operation::power, term.of = {base, exponent, -1};
    term.at_points = terms_[base].at_points || terms_[exponent].at_points;
    if (!varies && terms_[exponent].operation == Operation::constant)
      return constant(std::pow(terms_[base].constant, n));
    return add(term);
  }
  if (n == 0) return constant(1);  // also of what is not a number, as std::pow has it
  if (n == 1) return base;
  if (n == 0.5) return apply(Operation::sqrt, base);
  if (n != std::floor(n) || std::abs(n) > largest) {
    Term term;
    term.operation = Operation::power, term.of = {base, exponent, -1}, term.at_points = terms_[base].at_points;
    return add(term);
  }
  if (n < 0 && n >= -4) return apply(Operation::divide, constant(1), power(base, constant(-n)));
  if (n > 4 || n < 0) return apply(Operation::whole_power, base, exponent);
  const int square = apply(Operation::multiply, base, base);
  if (n == 2) return square;
  return apply(Operation::multiply, square, n == 3 ? base : square);
}

void Graph::written(int term, std::size_t text, std::size_t first, std::size_t end) {
  Term& known = terms_[term];
  if (known.end == 0) known.text = text, known.first = first, known.end = end;
}

}  // namespace mpm::formula

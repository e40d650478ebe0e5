// Reads the grammar of muParser, which has checked the text before.

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "experiment/formula.hpp"

namespace mpm::formula {
namespace {

/// A binary operator; those of a higher level bind more tightly.
struct Operator {
  std::string_view text;
  Operation operation;
  int level;
};
constexpr int level_of_sign = 5, level_of_power = 6;
// Longer texts come before those that they begin with.
constexpr Operator operators[] = {{"||", Operation::either, 1},
                                  {"&&", Operation::both, 2},
                                  {"<=", Operation::less_or_equal, 3},
                                  {">=", Operation::greater_or_equal, 3},
                                  {"==", Operation::equal, 3},
                                  {"!=", Operation::unequal, 3},
                                  {"<", Operation::less, 3},
                                  {">", Operation::greater, 3},
                                  {"+", Operation::add, 4},
                                  {"-", Operation::subtract, 4},
                                  {"*", Operation::multiply, level_of_sign},
                                  {"/", Operation::divide, level_of_sign},
                                  {"^", Operation::power, level_of_power}};

class Parser {
 public:
  Parser(const std::string& text, const std::vector<std::pair<std::string, double>>& constants, std::size_t number,
         Graph& graph)
      : text_(text), constants_(constants), number_(number), graph_(graph) {}

  int whole() {
    const int term = conditional();
    skip_blanks();
    if (at_ != text_.size()) refuse();
    return term;
  }

 private:
  [[noreturn]] void refuse() const { throw std::invalid_argument("no term at character " + std::to_string(at_ + 1)); }

  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }

  bool take(std::string_view token) {
    skip_blanks();
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }

  int apply(std::size_t first, Operation operation, int a, int b = -1, int c = -1) {
    const int term = graph_.apply(operation, a, b, c);
    std::size_t end = at_;  // beyond blanks where another operator was looked for
    while (text_[end - 1] == ' ' || text_[end - 1] == '\t') --end;
    graph_.written(term, number_, first, end);
    return term;
  }

  std::size_t begin() {
    skip_blanks();
    return at_;
  }

  int conditional() {
    const std::size_t first = begin();
    const int condition = binary(1);
    if (!take("?")) return condition;
    const int yes = conditional();
    if (!take(":")) refuse();
    const int no = conditional();
    return apply(first, Operation::choose, condition, yes, no);
  }

  /// The operator that stands here, if it binds at least as tightly as `level`.
  std::optional<Operator> operator_here(int level) {
    skip_blanks();
    for (const Operator& candidate : operators) {
      if (text_.compare(at_, candidate.text.size(), candidate.text) != 0) continue;
      if (candidate.level < level) return std::nullopt;
      at_ += candidate.text.size();
      return candidate;
    }
    return std::nullopt;
  }

  int binary(int level) {
    const std::size_t first = begin();
    int term = signed_value();
    while (const std::optional<Operator> found = operator_here(level)) {
      const int other = binary(found->level == level_of_power ? level_of_power : found->level + 1);
      term = apply(first, found->operation, term, other);
    }
    return term;
  }

  /// A value, or a sign and what binds more tightly than it: a power.
  int signed_value() {
    const std::size_t first = begin();
    if (take("+")) return binary(level_of_power);
    if (take("-")) return apply(first, Operation::negate, binary(level_of_power));
    return value();
  }

  int value() {
    skip_blanks();
    if (at_ >= text_.size()) refuse();
    if (take("(")) {
      const int term = conditional();
      if (!take(")")) refuse();
      return term;
    }
    const auto letter = static_cast<unsigned char>(text_[at_]);
    if (std::isdigit(letter) || letter == '.') return graph_.constant(number());
    return named();
  }

  double number() {
    double value = 0;
    const char* const begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (error == std::errc::invalid_argument) refuse();
    if (error == std::errc::result_out_of_range) value = 0;  // too small; muParser refuses what is too large
    at_ += static_cast<std::size_t>(end - begin);
    return value;
  }

  int named() {
    const std::size_t first = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_')) ++at_;
    const std::string name = text_.substr(first, at_ - first);
    if (name.empty()) refuse();
    for (const auto& [constant, value] : constants_)
      if (constant == name) return graph_.constant(value);
    if (name == "pi") return graph_.constant(std::numbers::pi);
    if (name.size() == 1 && variable_letters.find(name) != std::string_view::npos) {
      const int term = graph_.variable(static_cast<int>(variable_letters.find(name)));
      graph_.written(term, number_, first, at_);
      return term;
    }
    for (const Function& function : functions())
      if (function.name == name) return call(function, first);
    refuse();
  }

  int call(const Function& function, std::size_t first) {
    if (!take("(")) refuse();
    std::vector<int> arguments{conditional()};
    while (take(",")) arguments.push_back(conditional());
    if (!take(")")) refuse();
    const int count = static_cast<int>(arguments.size());
    if (count < function.least || count > function.most) refuse();
    if (function.operation != Operation::min && function.operation != Operation::max)
      return apply(first, function.operation, arguments[0], count > 1 ? arguments[1] : -1,
                   count > 2 ? arguments[2] : -1);
    int term = arguments[0];
    for (int i = 1; i < count; ++i) term = apply(first, function.operation, term, arguments[i]);
    return term;
  }

  const std::string& text_;
  const std::vector<std::pair<std::string, double>>& constants_;
  std::size_t number_, at_ = 0;
  Graph& graph_;
};

}  // namespace

int parse(const std::string& text, const std::vector<std::pair<std::string, double>>& constants,
          std::size_t text_number, Graph& graph) {
  return Parser(text, constants, text_number, graph).whole();
}

}  // namespace mpm::formula

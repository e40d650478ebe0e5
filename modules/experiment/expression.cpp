#include "experiment/expression.hpp"

#include <muParser.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <unordered_map>

#include "experiment/diagnostics.hpp"
#include "experiment/expression_formulas.hpp"

namespace mpm {
namespace {

using formula::variable_letters;
constexpr std::size_t longest = 2000;  ///< characters; beyond this it is no formula a person wrote

double minimum(const double* values, int count) {
  return *std::min_element(values, values + count);
}
double maximum(const double* values, int count) {
  return *std::max_element(values, values + count);
}

struct Function {
  const char* name;
  std::variant<double (*)(double), double (*)(double, double), double (*)(double, double, double),
               double (*)(const double*, int)>
      call;
};

/// All functions are defined here rather than taken from muParser, whose `log` changed its base between versions.
const Function functions[] = {
    {"sin", +[](double a) { return std::sin(a); }},
    {"cos", +[](double a) { return std::cos(a); }},
    {"tan", +[](double a) { return std::tan(a); }},
    {"asin", +[](double a) { return std::asin(a); }},
    {"acos", +[](double a) { return std::acos(a); }},
    {"atan", +[](double a) { return std::atan(a); }},
    {"sinh", +[](double a) { return std::sinh(a); }},
    {"cosh", +[](double a) { return std::cosh(a); }},
    {"tanh", +[](double a) { return std::tanh(a); }},
    {"exp", +[](double a) { return std::exp(a); }},
    {"log", +[](double a) { return std::log(a); }},
    {"sqrt", +[](double a) { return std::sqrt(a); }},
    {"abs", +[](double a) { return std::abs(a); }},
    {"floor", +[](double a) { return std::floor(a); }},
    {"atan2", +[](double a, double b) { return std::atan2(a, b); }},
    {"pow", +[](double a, double b) { return std::pow(a, b); }},
    {"if", +[](double condition, double yes, double no) { return condition != 0 ? yes : no; }},
    {"min", &minimum},
    {"max", &maximum},
};

void prepare(mu::Parser& parser, const ExpressionScope& scope, std::array<double, 7>& values) {
  parser.ClearFun();
  parser.ClearConst();
  for (const Function& function : functions) {
    std::visit([&](auto call) { parser.DefineFun(function.name, call); }, function.call);
  }
  parser.DefineConst("pi", std::numbers::pi);
  for (const auto& [name, value] : scope.constants) parser.DefineConst(name, value);
  for (const char letter : scope.variables) {
    parser.DefineVar(std::string(1, letter), &values[variable_letters.find(letter)]);
  }
}

std::vector<std::string> known_names(const ExpressionScope& scope) {
  std::vector<std::string> names = expression_functions();
  names.push_back("pi");
  for (const auto& [name, value] : scope.constants) names.push_back(name);
  for (const char letter : scope.variables) names.push_back(std::string(1, letter));
  return names;
}

std::string unknown_name(const std::string& token, const ExpressionScope& scope) {
  if (token.size() == 1 && variable_letters.find(token) != std::string::npos) {
    std::string allowed;
    for (const char letter : scope.variables) allowed += (allowed.empty() ? "" : " ") + std::string(1, letter);
    return in_quotes(token) + " is not available here; variables are " + allowed;
  }
  const std::vector<std::string> names = known_names(scope);
  return "unknown name " + in_quotes(token) + suggestion(token, names, "known: " + quoted_list(names));
}

std::string reason(const mu::Parser::exception_type& error, const ExpressionScope& scope) {
  switch (error.GetCode()) {
    case mu::ecUNASSIGNABLE_TOKEN:
      return unknown_name(error.GetToken(), scope);
    case mu::ecUNEXPECTED_EOF:
      return "it ends too early";
    case mu::ecMISSING_PARENS:
      return "a ')' is missing";
    case mu::ecUNEXPECTED_PARENS:
      return "this parenthesis has no partner";
    case mu::ecTOO_MANY_PARAMS:
      return "too many arguments for " + in_quotes(error.GetToken());
    case mu::ecTOO_FEW_PARAMS:
      return "too few arguments for " + in_quotes(error.GetToken());
    case mu::ecUNEXPECTED_OPERATOR:
      return "unexpected operator " + in_quotes(error.GetToken());
    case mu::ecUNEXPECTED_VAL:
      return "unexpected number";
    case mu::ecUNEXPECTED_VAR:
      return "unexpected variable " + in_quotes(error.GetToken());
    case mu::ecUNEXPECTED_FUN:
      return "unexpected function " + in_quotes(error.GetToken());
    case mu::ecUNEXPECTED_ARG_SEP:
      return "unexpected comma";
    default:
      return error.GetMsg();
  }
}

[[noreturn]] void fail(const std::string& text, int position, const std::string& why) {
  const std::string at = position >= 0 ? " at character " + std::to_string(position + 1) : "";
  throw ExpressionError("in the expression " + in_quotes(text) + at + ": " + why);
}

/// Refuses what muParser also has and no formula here means: assignments, lists and strings.
void refuse_extras(const std::string& text) {
  if (text.size() > longest) fail(text, -1, "longer than " + std::to_string(longest) + " characters");
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char before = i > 0 ? text[i - 1] : ' ', after = i + 1 < text.size() ? text[i + 1] : ' ';
    const bool comparison = before == '=' || before == '<' || before == '>' || before == '!' || after == '=';
    if (text[i] == '=' && !comparison) fail(text, static_cast<int>(i), "a formula assigns nothing; == compares");
    const auto byte = static_cast<unsigned char>(text[i]);
    if (text[i] == '"' || byte >= 0x80 || (byte < 0x20 && text[i] != '\t')) {
      fail(text, static_cast<int>(i), "this character has no meaning here");
    }
  }
}

struct Checked {
  std::string used;  ///< letters of the variables it uses
  double value = 0;  ///< value at the origin and time zero
};

Checked check(const std::string& text, const ExpressionScope& scope) {
  refuse_extras(text);
  if (text.find_first_not_of(" \t") == std::string::npos) throw ExpressionError("the expression is empty");
  try {
    std::array<double, 7> values{};
    mu::Parser parser;
    prepare(parser, scope, values);
    parser.SetExpr(text);
    Checked result;
    int count = 0;
    parser.Eval(count);
    if (count != 1) fail(text, -1, "one value is wanted, not " + std::to_string(count));
    result.value = parser.Eval();
    for (const auto& [name, address] : parser.GetUsedVar()) result.used += name;
    return result;
  } catch (const mu::Parser::exception_type& error) {
    fail(text, static_cast<int>(error.GetPos()), reason(error, scope));
  }
}

bool any_of(const std::string& used, std::string_view letters) {
  return used.find_first_of(letters) != std::string::npos;
}

}  // namespace

std::vector<std::string> expression_functions() {
  std::vector<std::string> names;
  for (const Function& function : functions) names.push_back(function.name);
  return names;
}

bool is_free_in_formulas(const std::string& name) {
  const bool is_letter = name.size() == 1 && variable_letters.find(name) != std::string::npos;
  const std::vector<std::string> called = expression_functions();
  return !is_letter && name != "pi" && std::find(called.begin(), called.end(), name) == called.end();
}

void check_expression(const std::string& text, const ExpressionScope& scope) {
  check(text, scope);
}

/// The parsers of one thread for some formulas. They point into `values`, so it must not move.
struct VectorExpression::Instance {
  std::weak_ptr<const Formulas> formulas;
  std::array<double, 7> values{};
  std::array<std::optional<mu::Parser>, 3> parsers;
};

VectorExpression::VectorExpression(std::span<const Term> terms, const ExpressionScope& scope) {
  auto formulas = std::make_shared<Formulas>();
  for (std::size_t i = 0; i < terms.size() && i < 3; ++i) {
    if (const double* value = std::get_if<double>(&terms[i])) {
      constant_[i] = *value;
      continue;
    }
    const std::string& text = std::get<std::string>(terms[i]);
    const Checked checked = check(text, scope);
    if (checked.used.empty()) {
      if (!std::isfinite(checked.value)) fail(text, -1, "its value is not a finite number");
      constant_[i] = checked.value;
      continue;
    }
    formulas->text[i] = text;
    uses_position_ |= any_of(checked.used, "xyz");
    uses_initial_position_ |= any_of(checked.used, "XYZ");
    uses_time_ |= any_of(checked.used, "t");
    for (std::size_t axis = 0; axis < 3; ++axis)
      varies_[i][axis] = any_of(checked.used, variable_letters.substr(axis, 1)) ||
                         any_of(checked.used, variable_letters.substr(3 + axis, 1));
  }
  if (!uses_position_ && !uses_initial_position_ && !uses_time_) return;
  static std::atomic<std::uint64_t> next_id{1};
  formulas->id = next_id.fetch_add(4);
  formulas->scope = scope;
  for (std::size_t i = 0; i < 3; ++i) {
    try {
      formulas->add(formulas->text[i], constant_[i]);
    } catch (const std::invalid_argument& error) {
      fail(formulas->text[i], -1, error.what());
    }
  }
  formulas->compile();
  formulas_ = std::move(formulas);
}

VectorExpression::Instance& VectorExpression::instance_of_this_thread(const std::shared_ptr<const Formulas>& formulas) {
  thread_local std::unordered_map<std::uint64_t, std::unique_ptr<Instance>> instances;
  std::unique_ptr<Instance>& slot = instances[formulas->id];
  if (slot) return *slot;
  slot = std::make_unique<Instance>();
  slot->formulas = formulas;
  for (std::size_t i = 0; i < 3; ++i) {
    if (formulas->text[i].empty()) continue;
    mu::Parser& parser = slot->parsers[i].emplace();
    prepare(parser, formulas->scope, slot->values);
    parser.SetExpr(formulas->text[i]);
  }
  Instance& made = *slot;
  std::erase_if(instances, [](const auto& entry) { return entry.second->formulas.expired(); });
  return made;
}

Vector3 VectorExpression::operator()(const Vector3& x, const Vector3& X, double t) const {
  if (!formulas_) return constant_;
  Instance& instance = instance_of_this_thread(formulas_);
  instance.values = {x[0], x[1], x[2], X[0], X[1], X[2], t};
  Vector3 result = constant_;
  for (std::size_t i = 0; i < 3; ++i) {
    if (instance.parsers[i]) result[i] = instance.parsers[i]->Eval();
  }
  return result;
}

}  // namespace mpm

#include "experiment/parameter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiment/units.hpp"

namespace mpm {
namespace {

const Node empty_object = [] {
  Node node;
  node.type = Node::Type::object;
  return node;
}();

std::string range_text(const ParameterSpec& spec) {
  const bool lower = std::isfinite(spec.minimum), upper = std::isfinite(spec.maximum);
  const std::string least = number_text(spec.minimum), most = number_text(spec.maximum);
  if (lower && upper && !spec.above_minimum && !spec.below_maximum) return " from " + least + " to " + most;
  std::string text;
  if (lower) text = (spec.above_minimum ? " above " : " of at least ") + least;
  if (upper) text += std::string(lower ? " and" : "") + (spec.below_maximum ? " below " : " at most ") + most;
  return text;
}

bool in_range(const ParameterSpec& spec, double value) {
  const bool low = spec.above_minimum ? value <= spec.minimum : value < spec.minimum;
  const bool high = spec.below_maximum ? value >= spec.maximum : value > spec.maximum;
  return !low && !high;
}

std::string counted(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    parts.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

}  // namespace

void ReadContext::problem(const Position& at, std::string pointer, std::string message) {
  problems.push_back(
      {at.option.empty() ? file : std::string(at.option), at.line, at.column, std::move(pointer), std::move(message)});
}

ParameterSpec parameter(std::string name, ParameterType type, std::string unit, std::string doc) {
  ParameterSpec spec;
  spec.name = std::move(name);
  spec.type = type;
  spec.unit = std::move(unit);
  spec.doc = std::move(doc);
  return spec;
}

ParameterSpec& ParameterSpec::made_of(Section section) {
  table = std::make_shared<const Section>(std::move(section));
  return *this;
}

ParameterSpec from_plugin(const mpm_parameter& declared) {
  ParameterSpec spec = parameter(declared.name, static_cast<ParameterType>(declared.type),
                                 declared.unit ? declared.unit : "", declared.doc ? declared.doc : "");
  spec.offset = declared.offset;
  spec.required = (declared.flags & MPM_REQUIRED) != 0;
  spec.minimum = declared.minimum;
  spec.maximum = declared.maximum;
  spec.above_minimum = (declared.flags & MPM_ABOVE_MINIMUM) != 0;
  spec.below_maximum = (declared.flags & MPM_BELOW_MAXIMUM) != 0;
  if (declared.type == MPM_CHOICE) spec.choices = split(declared.choices ? declared.choices : "", '|');
  if (spec.required) return spec;
  const auto index = static_cast<std::size_t>(std::max(0.0, declared.default_value));
  if (declared.type == MPM_BOOLEAN)
    spec.default_value = declared.default_value != 0;
  else if (declared.type == MPM_INTEGER)
    spec.default_value = std::llround(declared.default_value);
  else if (declared.type == MPM_NUMBER)
    spec.default_value = declared.default_value;
  else if (index < spec.choices.size())
    spec.default_value = spec.choices[index];
  return spec;
}

std::string describe_expected(const ParameterSpec& spec) {
  if (spec.may_be_null) {
    ParameterSpec other = spec;
    other.may_be_null = false;
    return describe_expected(other) + " or null";
  }
  const std::string per_axis = spec.components ? std::to_string(spec.components) : "one";
  switch (spec.type) {
    case ParameterType::number: {
      const std::string text = describe_unit(spec.unit) + range_text(spec);
      return spec.word.empty() ? text : text + " or " + in_quotes(spec.word);
    }
    case ParameterType::integer:
      if (spec.maximum == spec.minimum + 1) return number_text(spec.minimum) + " or " + number_text(spec.maximum);
      return "an integer" + range_text(spec);
    case ParameterType::boolean:
      return "true or false";
    case ParameterType::choice:
      if (spec.may_be_boolean) return "true, false or one of " + quoted_list(spec.choices);
      return spec.choices.size() == 1 ? in_quotes(spec.choices[0]) : "one of " + quoted_list(spec.choices);
    case ParameterType::string:
      return "a string";
    case ParameterType::vector:
      return spec.components ? "a list of " + per_axis + " numbers" : "a list of numbers, one an axis";
    case ParameterType::expression:
      return describe_unit(spec.unit) + range_text(spec) + " or an expression";
    case ParameterType::expression_vector:
      return "a list of numbers or expressions, one an axis";
    case ParameterType::points:
      return "a list of points, each a list of numbers";
    case ParameterType::names:
      return spec.may_be_boolean ? "true, false or a list of strings" : "a list of strings";
    case ParameterType::nested:
      return spec.doc;
  }
  return {};
}

Fields::Fields(const Node* object, Section section, ReadContext& context)
    : resolved(OrderedJson::object()),
      object_(object ? object : &empty_object),
      section_(std::move(section)),
      context_(context) {
  const bool absent = object == nullptr || object->type == Node::Type::string;  // a bare string chose the kind
  if (!absent && object->type != Node::Type::object) {
    context_.problem(*object, "expected an object (" + section_.doc + "), got " + describe_value(*object));
  } else if (!absent) {
    check_keys();
  }
  if (section_.tagged) resolved["type"] = section_.name;
  for (const ParameterSpec& spec : section_.parameters) {
    const Node* node = object_->find(spec.name);
    const bool optional_section = spec.type == ParameterType::nested && !spec.required;
    if (node && node->type == Node::Type::null && optional_section)
      node = nullptr;  // null stands for nothing, so that a study can switch it off
    const bool missing = spec.required && !node && object_->type == Node::Type::object && !absent;
    if (missing) {
      context_.problem(object_->at, child_pointer(object_->pointer, spec.name),
                       "missing key; expected " + describe_expected(spec));
    }
    read(spec, node);
  }
}

const Fields::Value& Fields::value(std::string_view name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) throw std::logic_error("section " + section_.name + " has no key " + std::string(name));
  return found->second;
}

Fields Fields::nested(std::string_view name) const {
  const Node* const object = node(name);
  for (const ParameterSpec& spec : section_.parameters)
    if (spec.name == name && spec.table) return {object, *spec.table, context_};
  throw std::logic_error("key " + std::string(name) + " of section " + section_.name + " has no table");
}

void Fields::check_keys() {
  std::vector<std::string> valid, unlisted;
  if (section_.tagged) valid.push_back("type");
  for (const ParameterSpec& spec : section_.parameters) (spec.unlisted ? unlisted : valid).push_back(spec.name);
  const auto among = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const Member& member : object_->members) {
    if (among(valid, member.key) || among(unlisted, member.key)) continue;
    context_.problem(
        member.at, member.value.pointer,
        "unknown key " + in_quotes(member.key) + suggestion(member.key, valid, "valid keys: " + quoted_list(valid)));
  }
}

void Fields::read(const ParameterSpec& spec, const Node* node) {
  Value& value = values_[spec.name];
  value.node = node;
  if (!node) {
    use_default(spec, value);
  } else if (spec.may_be_null && node->type == Node::Type::null) {
    value.valid = value.is_null = true;
  } else {
    value.valid = read_value(spec, *node, value);
  }
  if (value.is_null || (spec.type == ParameterType::nested && node)) {
    resolved[spec.name] = nullptr;  // null is kept, or keeps the place in the order of the table
  } else if (!value.resolved.is_null()) {
    resolved[spec.name] = value.resolved;
  }
}

void Fields::use_default(const ParameterSpec& spec, Value& value) {
  const OrderedJson& standard = spec.default_value;
  value.valid = !spec.required;
  if (standard.is_null()) return;
  value.resolved = standard;
  if (standard.is_number()) value.number = standard.get<double>();
  if (standard.is_number() && spec.type == ParameterType::number) value.resolved = value.number;
  if (standard.is_boolean()) value.number = standard.get<bool>();
  if (standard.is_string()) value.text = standard.get<std::string>();
  const auto chosen = std::find(spec.choices.begin(), spec.choices.end(), value.text);
  if (chosen != spec.choices.end()) value.number = static_cast<double>(chosen - spec.choices.begin());
  if (spec.type == ParameterType::vector || spec.type == ParameterType::expression_vector) {
    const std::size_t count = spec.components ? spec.components : context_.dimension;
    value.resolved = standard.is_array() ? standard : OrderedJson(std::vector<double>(count, value.number));
    for (std::size_t i = 0; i < count; ++i) value.vector[i] = value.resolved[i].get<double>();
    value.expression = VectorExpression(value.vector);
  }
  if (spec.type == ParameterType::expression) value.expression = VectorExpression(Vector3{value.number, 0, 0});
}

bool Fields::wrong_type(const ParameterSpec& spec, const Node& node) {
  context_.problem(node, "expected " + describe_expected(spec) + ", got " + describe_value(node));
  return false;
}

bool Fields::read_value(const ParameterSpec& spec, const Node& node, Value& value) {
  switch (spec.type) {
    case ParameterType::number:
    case ParameterType::integer:
      return read_number(spec, node, value);
    case ParameterType::boolean:
      if (node.type != Node::Type::boolean) return wrong_type(spec, node);
      value.number = node.boolean;
      value.resolved = node.boolean;
      return true;
    case ParameterType::choice:
    case ParameterType::string:
      return read_text(spec, node, value);
    case ParameterType::vector:
      return read_vector(spec, node, value.vector, value.resolved);
    case ParameterType::expression:
      return read_expression(spec, node, value);
    case ParameterType::expression_vector:
      return read_expression_vector(spec, node, value);
    case ParameterType::points:
      return read_points(spec, node, value);
    case ParameterType::names:
      return read_names(spec, node, value);
    case ParameterType::nested:
      return true;
  }
  return false;
}

bool read_si(const Node& node, std::string_view unit, std::string_view expected, double& value, ReadContext& context) {
  if (node.type == Node::Type::number) {
    value = node.number;
    return true;
  }
  if (node.type == Node::Type::string) {
    try {
      value = to_si(node.text, unit);
      return true;
    } catch (const UnitError& error) {
      context.problem(node, error.what());
      return false;
    }
  }
  context.problem(node, "expected " + std::string(expected) + ", got " + describe_value(node));
  return false;
}

bool Fields::read_number(const ParameterSpec& spec, const Node& node, Value& value) {
  const bool integer = spec.type == ParameterType::integer;
  if (!spec.word.empty() && node.type == Node::Type::string && node.text == spec.word) {
    value.text = node.text;
    value.resolved = node.text;
    return true;
  }
  if (integer && (node.type != Node::Type::number || node.number != std::floor(node.number))) {
    return wrong_type(spec, node);
  }
  const std::string expected = describe_expected(spec);
  if (!spec.word.empty() && node.type == Node::Type::string && !looks_like_quantity(node.text)) {
    context_.problem(node, "expected " + expected + ", got " + describe_value(node));
    return false;
  }
  if (!read_si(node, spec.unit, expected, value.number, context_)) return false;
  if (!in_range(spec, value.number)) {
    report_range(spec, node, value.number);
    value.number = 0;
    return false;
  }
  value.resolved = value.number;
  if (integer && std::abs(value.number) < 9e15) value.resolved = std::llround(value.number);
  return true;
}

void Fields::report_range(const ParameterSpec& spec, const Node& node, double value) {
  const std::string written = node.type == Node::Type::string ? " (" + node.text + ")" : "";
  context_.problem(node, "out of range: expected " + describe_expected(spec) + ", got " + number_text(value) + written);
}

bool Fields::read_text(const ParameterSpec& spec, const Node& node, Value& value) {
  if (spec.may_be_boolean && node.type == Node::Type::boolean) {
    value.number = node.boolean;
    value.resolved = node.boolean;
    return true;
  }
  if (node.type != Node::Type::string) return wrong_type(spec, node);
  value.text = node.text;
  value.resolved = node.text;
  if (spec.choices.empty()) return true;
  const auto chosen = std::find(spec.choices.begin(), spec.choices.end(), node.text);
  if (chosen != spec.choices.end()) {
    value.number = static_cast<double>(chosen - spec.choices.begin());
    return true;
  }
  context_.problem(node, "expected " + describe_expected(spec) + ", got " + in_quotes(node.text) +
                             did_you_mean(node.text, spec.choices));
  return false;
}

bool Fields::read_names(const ParameterSpec& spec, const Node& node, Value& value) {
  if (spec.may_be_boolean && node.type == Node::Type::boolean) {
    value.number = node.boolean;
    value.resolved = node.boolean;
    return true;
  }
  if (node.type != Node::Type::array) return wrong_type(spec, node);
  const std::size_t before = context_.problems.size();
  value.resolved = OrderedJson::array();
  for (const Node& item : node.items) {
    const std::string& name = item.text;
    if (spec.table && item.type == Node::Type::object) {
      value.resolved.push_back(nullptr);  // for its reader to put
    } else if (item.type != Node::Type::string) {
      context_.problem(item, "expected a string" + std::string(spec.table ? " or " + spec.table->doc : "") + ", got " +
                                 describe_value(item));
    } else if (!spec.choices.empty() &&
               std::find(spec.choices.begin(), spec.choices.end(), name) == spec.choices.end()) {
      context_.problem(item, "expected one of " + quoted_list(spec.choices) + ", got " + in_quotes(name) +
                                 did_you_mean(name, spec.choices));
    } else if (std::find(value.names.begin(), value.names.end(), name) != value.names.end()) {
      context_.problem(item, in_quotes(name) + " is listed twice");
    } else {
      value.names.push_back(name);
      value.resolved.push_back(name);
    }
  }
  return context_.problems.size() == before;
}

bool Fields::right_length(const ParameterSpec& spec, const Node& node) {
  const std::size_t wanted = spec.components ? spec.components : context_.dimension;
  const std::size_t count = node.items.size();
  if (wanted ? count == wanted : count == 2 || count == 3) return true;
  const std::string number = wanted ? counted(wanted, "component") : "2 or 3 components";
  context_.problem(node, "expected " + number +
                             (spec.components || !wanted ? "" : " in a " + std::to_string(wanted) + "-D experiment") +
                             ", got " + std::to_string(count));
  return false;
}

bool Fields::read_vector(const ParameterSpec& spec, const Node& node, Vector3& vector, OrderedJson& out) {
  if (node.type != Node::Type::array) return wrong_type(spec, node);
  bool good = right_length(spec, node);
  out = OrderedJson::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(node.items.size(), 3); ++i) {
    good &= read_si(node.items[i], spec.unit, describe_unit(spec.unit), vector[i], context_);
    out.push_back(vector[i]);
  }
  return good;
}

bool Fields::read_points(const ParameterSpec& spec, const Node& node, Value& value) {
  if (node.type != Node::Type::array) return wrong_type(spec, node);
  const std::size_t count = node.items.size();
  bool good = count >= spec.least_items && count <= spec.most_items;
  if (!good) {
    const bool exact = spec.least_items == spec.most_items;
    const std::size_t bound = count < spec.least_items ? spec.least_items : spec.most_items;
    const char* relation = exact ? "" : count < spec.least_items ? "at least " : "at most ";
    context_.problem(node,
                     std::string("expected ") + relation + counted(bound, "point") + ", got " + std::to_string(count));
  }
  ParameterSpec each = spec;
  each.type = ParameterType::vector;
  value.resolved = OrderedJson::array();
  for (const Node& item : node.items) {
    OrderedJson out;
    good &= read_vector(each, item, value.points.emplace_back(), out);
    value.resolved.push_back(out);
  }
  return good;
}

ExpressionScope Fields::scope_of(const ParameterSpec& spec) const {
  ExpressionScope scope{spec.variables, context_.constants};
  if (context_.dimension == 2)
    std::erase_if(scope.variables, [](char letter) { return letter == 'z' || letter == 'Z'; });
  return scope;
}

/// Reads one number or formula; `expected` is what a message says there should be.
bool Fields::read_term(const ParameterSpec& spec, const Node& node, const std::string& expected,
                       VectorExpression::Term& term, OrderedJson& out) {
  if (node.type == Node::Type::string && !looks_like_quantity(node.text)) {
    term = node.text;
    out = node.text;
    try {
      VectorExpression(std::span(&term, 1), scope_of(spec));
    } catch (const ExpressionError& error) {
      context_.problem(node, error.what());
      return false;
    }
    return true;
  }
  double number = 0;
  const bool good = read_si(node, spec.unit, expected, number, context_);
  term = number;
  out = number;
  return good;
}

bool Fields::read_expression(const ParameterSpec& spec, const Node& node, Value& value) {
  VectorExpression::Term term;
  if (!read_term(spec, node, describe_expected(spec), term, value.resolved)) return false;
  value.expression = VectorExpression(std::span(&term, 1), scope_of(spec));
  const double constant = value.expression({}, {}, 0)[0];
  if (!value.expression.is_constant() || in_range(spec, constant)) return true;
  report_range(spec, node, constant);
  return false;
}

bool Fields::read_expression_vector(const ParameterSpec& spec, const Node& node, Value& value) {
  if (node.type != Node::Type::array) return wrong_type(spec, node);
  bool good = right_length(spec, node);
  const std::string expected = describe_unit(spec.unit) + " or an expression";
  std::vector<VectorExpression::Term> terms;
  value.resolved = OrderedJson::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(node.items.size(), 3); ++i) {
    const Node& item = node.items[i];
    VectorExpression::Term& term = terms.emplace_back(0.0);
    OrderedJson& out = value.resolved.emplace_back(nullptr);
    if (item.type == Node::Type::null && spec.may_leave_free)
      value.held[i] = false;
    else
      good &= read_term(spec, item, expected, term, out);
  }
  if (good) value.expression = VectorExpression(terms, scope_of(spec));
  return good;
}

const Section* choose_kind(const Node& node, std::span<const Section> kinds, std::string_view what, bool bare,
                           ReadContext& context, const Section* standard, std::span<const std::string> others) {
  const std::string name(what);
  std::vector<std::string> names;
  for (const Section& kind : kinds) names.push_back(kind.name);
  if (!others.empty()) {
    names.insert(names.end(), others.begin(), others.end());
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
  }
  const bool by_string = bare && node.type == Node::Type::string;
  if (!by_string && node.type != Node::Type::object) {
    context.problem(node, "expected " + std::string(bare ? "a string or " : "") + "an object " +
                              (standard ? "(" : "with \"type\" (") + name + "), got " + describe_value(node));
    return nullptr;
  }
  const Node* type = by_string ? &node : node.find("type");
  const std::string available = names.empty() ? "no " + name + " is available" : "available: " + quoted_list(names);
  if (!type && standard) return standard;
  if (!type) {
    context.problem(node.at, child_pointer(node.pointer, "type"), "missing key; expected a " + name + "; " + available);
    return nullptr;
  }
  if (type->type != Node::Type::string) {
    context.problem(*type, "expected a string (" + name + "), got " + describe_value(*type));
    return nullptr;
  }
  for (const Section& kind : kinds) {
    if (kind.name != type->text) continue;
    if (kind.only_dimension && context.dimension && kind.only_dimension != context.dimension) {
      context.problem(*type, name + " " + in_quotes(kind.name) + " works in " + std::to_string(kind.only_dimension) +
                                 "-D only, but this experiment is " + std::to_string(context.dimension) + "-D");
    }
    return &kind;
  }
  if (std::find(others.begin(), others.end(), type->text) != others.end()) {
    context.problem(*type, name + " " + in_quotes(type->text) + " is not built yet: `./mpm build` builds everything");
    return nullptr;
  }
  context.problem(*type, "unknown " + name + " " + in_quotes(type->text) + suggestion(type->text, names, available));
  return nullptr;
}

}  // namespace mpm

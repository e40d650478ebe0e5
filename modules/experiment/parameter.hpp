#pragma once
// Every section of an experiment file is a table of parameters; one reader walks them all and one writer turns them
// into a JSON Schema.

#include <array>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/diagnostics.hpp"
#include "experiment/expression.hpp"
#include "experiment/input_file.hpp"
#include "experiment/located_json.hpp"
#include "plugin/abi.h"

namespace mpm {

using OrderedJson = nlohmann::ordered_json;

enum class ParameterType {
  number,  ///< with `unit`: also a string such as "0.5 mm"
  integer,
  boolean,
  choice,  ///< a string out of `choices`; or `or_boolean`
  string,
  vector,             ///< as many numbers as the experiment has dimensions
  expression,         ///< a number, a number with a unit, or a formula
  expression_vector,  ///< as many of them as the experiment has dimensions
  points,             ///< list of vectors, from `least_items` to `most_items`
  names,  ///< list of strings, each once; out of `choices` unless that is empty; or `or_boolean`; or objects
          ///< of its `table`
  nested  ///< read by code of its own; its schema is its `table`, or `definition` names it
};

struct Section;

/// One key of a section. The chained setters let tables read as sentences.
struct ParameterSpec {
  std::string name;
  ParameterType type = ParameterType::number;
  std::string unit;  ///< SI; "" a pure number; "any" whatever dimension
  std::string doc;   ///< one sentence
  bool required = false;
  OrderedJson default_value;  ///< null: none. A vector's default is a list, or one number for all components
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool above_minimum = false, below_maximum = false;  ///< the bound itself is excluded
  std::vector<std::string> choices;
  std::string word;             ///< a number may also be this word ("auto")
  std::string variables;        ///< letters that an expression may use
  bool may_leave_free = false;  ///< components of an expression vector may be null
  bool may_be_boolean = false;  ///< names may be true (all) or false (none), a choice true or false
  bool may_be_null = false;     ///< null says "none", and is kept
  bool unlisted = false;        ///< read to be refused by name: no message offers it
  int components = 0;           ///< components of a vector; 0: as the dimension of the experiment
  std::size_t least_items = 0, most_items = 100000;  ///< number of points
  std::string definition;                            ///< definition of a nested key
  std::shared_ptr<const Section> table;              ///< keys of a nested key, where one place alone has them
  std::uint32_t offset = 0;                          ///< offset of a plugin's parameter, in its block

  ParameterSpec& needed() { return required = true, *this; }
  ParameterSpec& standard(OrderedJson value) { return default_value = std::move(value), *this; }
  ParameterSpec& from(double value) { return minimum = value, above_minimum = false, *this; }
  ParameterSpec& above(double value) { return minimum = value, above_minimum = true, *this; }
  ParameterSpec& to(double value) { return maximum = value, below_maximum = false, *this; }
  ParameterSpec& below(double value) { return maximum = value, below_maximum = true, *this; }
  ParameterSpec& of(std::vector<std::string> names) { return choices = std::move(names), *this; }
  ParameterSpec& or_word(std::string text) { return word = std::move(text), *this; }
  ParameterSpec& over(std::string letters) { return variables = std::move(letters), *this; }
  ParameterSpec& leave_free() { return may_leave_free = true, *this; }
  ParameterSpec& not_offered() { return unlisted = true, *this; }
  ParameterSpec& or_boolean() { return may_be_boolean = true, *this; }
  ParameterSpec& or_null() { return may_be_null = true, *this; }
  ParameterSpec& with_components(int count) { return components = count, *this; }
  ParameterSpec& items(std::size_t least, std::size_t most) { return least_items = least, most_items = most, *this; }
  ParameterSpec& defined_as(std::string name_) { return definition = std::move(name_), *this; }
  ParameterSpec& made_of(Section section);
};

/// Starts the description of a key.
ParameterSpec parameter(std::string name, ParameterType type, std::string unit, std::string doc);
ParameterSpec from_plugin(const mpm_parameter& declared);

/// What a message says there should be: "a length (m) above 0", "an integer from 1 to 8", "one of "first", "last"".
std::string describe_expected(const ParameterSpec& spec);

/// A section of the file, or one kind of a choice that "type" makes.
struct Section {
  std::string name;  ///< the value of "type" when `tagged`
  std::string doc;
  std::vector<ParameterSpec> parameters;
  bool tagged = false;     ///< the object also has the key "type"
  int only_dimension = 0;  ///< 2 or 3 when it has a meaning there alone
};

/// What reading gathers along the way.
struct ReadContext {
  std::string file;
  int dimension = 0;  ///< 0 while unknown: any length of vector is then accepted
  std::vector<std::pair<std::string, double>> constants;
  std::vector<Problem> problems;
  std::vector<InputFile> inputs;  ///< files that the experiment names

  void problem(const Node& at, std::string message) { problem(at.at, at.pointer, std::move(message)); }
  void problem(const Position& at, std::string pointer, std::string message);
};

/// The values of one object, checked against a section: unknown keys, missing keys, types, units, ranges. Every mistake
/// becomes a problem of the context; values that are missing or wrong read as zero, and `valid` says so.
class Fields {
 public:
  /// Reads `object`. When it is null the section is absent: all defaults (what is required there has been missed by the
  /// parent).
  Fields(const Node* object, Section section, ReadContext& context);

  bool given(std::string_view name) const { return value(name).node != nullptr; }
  bool valid(std::string_view name) const { return value(name).valid; }
  double number(std::string_view name) const { return value(name).number; }
  int integer(std::string_view name) const { return static_cast<int>(value(name).number); }
  bool boolean(std::string_view name) const { return value(name).number != 0; }
  /// The text of a string or choice; the word of a number that may be one, else "".
  const std::string& text(std::string_view name) const { return value(name).text; }
  /// The position of the chosen name in `choices`.
  int choice(std::string_view name) const { return static_cast<int>(value(name).number); }
  const Vector3& vector(std::string_view name) const { return value(name).vector; }
  const std::vector<Vector3>& points(std::string_view name) const { return value(name).points; }
  const std::vector<std::string>& names(std::string_view name) const { return value(name).names; }
  const VectorExpression& expression(std::string_view name) const { return value(name).expression; }
  ScalarExpression scalar_expression(std::string_view name) const { return ScalarExpression(value(name).expression); }
  /// Components of an expression vector that are not null.
  const std::array<bool, 3>& held(std::string_view name) const { return value(name).held; }
  /// Whether the file says null, where the key may be null.
  bool is_null(std::string_view name) const { return value(name).is_null; }
  /// The fields of a nested key that has a table; all defaults when it is absent.
  Fields nested(std::string_view name) const;
  /// The value as it stands in the file; null when absent.
  const Node* node(std::string_view name) const { return value(name).node; }
  /// The value, or the whole object when it is absent: where a problem about it belongs.
  const Node& place(std::string_view name) const { return given(name) ? *node(name) : *object_; }
  const Section& section() const { return section_; }

  /// The object with defaults filled and numbers in SI; nested values are for their readers to put.
  OrderedJson resolved;

 private:
  struct Value {
    const Node* node = nullptr;
    bool valid = false, is_null = false;
    double number = 0;
    std::string text;
    Vector3 vector{};
    std::vector<Vector3> points;
    std::vector<std::string> names;
    VectorExpression expression;
    std::array<bool, 3> held{true, true, true};
    OrderedJson resolved;
  };

  const Value& value(std::string_view name) const;
  void check_keys();
  void read(const ParameterSpec& spec, const Node* node);
  void use_default(const ParameterSpec& spec, Value& value);
  bool read_value(const ParameterSpec& spec, const Node& node, Value& value);
  bool read_number(const ParameterSpec& spec, const Node& node, Value& value);
  bool read_text(const ParameterSpec& spec, const Node& node, Value& value);
  bool read_names(const ParameterSpec& spec, const Node& node, Value& value);
  bool read_vector(const ParameterSpec& spec, const Node& node, Vector3& vector, OrderedJson& out);
  bool read_points(const ParameterSpec& spec, const Node& node, Value& value);
  bool read_expression(const ParameterSpec& spec, const Node& node, Value& value);
  bool read_expression_vector(const ParameterSpec& spec, const Node& node, Value& value);
  ExpressionScope scope_of(const ParameterSpec& spec) const;
  bool read_term(const ParameterSpec& spec, const Node& node, const std::string& expected, VectorExpression::Term& term,
                 OrderedJson& out);
  void report_range(const ParameterSpec& spec, const Node& node, double value);
  bool right_length(const ParameterSpec& spec, const Node& node);
  bool wrong_type(const ParameterSpec& spec, const Node& node);

  const Node* object_;
  Section section_;
  ReadContext& context_;
  std::map<std::string, Value, std::less<>> values_;
};

/// The kind that an object's "type" names, or that a bare string names when `bare` allows it. Null, with a problem
/// recorded, when there is none; an object without "type" means `standard`, unless that is null. `what` names it in
/// messages: "geometry", "material". They also name `others`, which are no mistakes but not at hand.
const Section* choose_kind(const Node& node, std::span<const Section> kinds, std::string_view what, bool bare,
                           ReadContext& context, const Section* standard = nullptr,
                           std::span<const std::string> others = {});

/// The SI value of a number or of a string with a unit; nothing, with a problem recorded, when it is neither.
bool read_si(const Node& node, std::string_view unit, std::string_view expected, double& value, ReadContext& context);

}  // namespace mpm

#include "study/axis_reader.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/units.hpp"

namespace mpm::study {
namespace {

using Type = ParameterType;

constexpr std::size_t longest_label = 60;

Section axis_section(bool by_pointer, bool in_list) {
  Section section{"axis", "an axis", {}};
  if (in_list) section.parameters.push_back(parameter("pointer", Type::string, "", "JSON pointer that the axis sets."));
  section.parameters.push_back(parameter("name", Type::string, "", "What figures call the axis; default the pointer."));
  section.parameters.push_back(parameter("label", Type::string, "", "Quantity on figures and in tables."));
  section.parameters.push_back(parameter("unit", Type::string, "", "Unit of the numbers as figures show them."));
  section.parameters.push_back(
      parameter("values", Type::nested, "", "a list of values").needed().defined_as("axis_values"));
  if (by_pointer || in_list) {
    section.parameters.push_back(parameter("labels", Type::names, "", "One a value."));
    section.parameters.push_back(
        parameter("scale", Type::number, "any", "Numbers are multiplied by it before they are set."));
  }
  return section;
}

Section choice_section() {
  return {"value of a named axis",
          "a value with \"label\" and \"set\"",
          {parameter("label", Type::string, "", "Name of the value.").needed(),
           parameter("set", Type::nested, "", "an object of values by JSON pointer").needed().defined_as("set"),
           parameter("value", Type::number, "any", "Its place on the axis of a figure.")}};
}

std::string cut(std::string text) {
  if (text.size() <= longest_label) return text;
  std::size_t length = longest_label;
  while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) --length;  // keep characters whole
  return text.substr(0, length) + "…";
}

std::string label_of(const Node& value) {
  switch (value.type) {
    case Node::Type::null:
      return "none";
    case Node::Type::boolean:
      return value.boolean ? "true" : "false";
    case Node::Type::number:
      return number_text(value.number);
    case Node::Type::string:
      return cut(value.text);
    case Node::Type::array:
      return cut(json_of(value).dump());
    case Node::Type::object:
      break;
  }
  const Node* type = value.find("type");
  if (!type || type->type != Node::Type::string) return cut(json_of(value).dump());
  std::string label = type->text;
  for (const Member& member : value.members)
    if (member.key != "type") label += " " + member.key + " " + label_of(member.value);
  return cut(label);
}

std::optional<double> number_of(const Node& value) {
  if (value.type == Node::Type::number) return value.number;
  if (value.type != Node::Type::string || !looks_like_quantity(value.text)) return std::nullopt;
  try {
    return to_si(value.text, "any");
  } catch (const UnitError&) {
    return std::nullopt;  // the experiment's reader says what is wrong with it
  }
}

std::optional<Choice> pointer_choice(const std::string& pointer, const Node& value, std::optional<double> scale,
                                     StudyContext& context) {
  Choice choice{label_of(value), number_of(value), {}};
  OrderedJson set = json_of(value);
  if (scale) {
    if (value.type != Node::Type::number) {
      context.problem(value, "expected a number, which \"scale\" multiplies, got " + describe_value(value));
      return std::nullopt;
    }
    set = value.number * *scale;
  }
  choice.overrides.push_back(pointer + "=" + set.dump());
  context.keep_place(choice.overrides.back(), value);
  return choice;
}

void read_pointer_values(Axis& axis, const std::string& pointer, const Node& values, const Fields* fields,
                         StudyContext& context) {
  axis.pointers = {pointer};
  std::optional<double> scale;
  if (fields && fields->given("scale")) scale = fields->number("scale");
  for (const Node& value : values.items)
    if (auto choice = pointer_choice(pointer, value, scale, context)) axis.choices.push_back(std::move(*choice));
  if (!fields || !fields->given("labels")) return;
  const auto& labels = fields->names("labels");
  if (labels.size() != values.items.size())
    context.problem(*fields->node("labels"), std::to_string(labels.size()) + " labels for " +
                                                 std::to_string(values.items.size()) + " values; give one a value");
  for (std::size_t k = 0; k < std::min(labels.size(), axis.choices.size()); ++k) axis.choices[k].label = labels[k];
}

void read_named_values(Axis& axis, const Node& values, StudyContext& context) {
  for (const Node& item : values.items) {
    const Fields fields(&item, choice_section(), context);
    if (!fields.given("set")) continue;
    Choice choice{fields.text("label"), std::nullopt, {}};
    if (fields.given("value")) choice.number = fields.number("value");
    choice.overrides = read_set(*fields.node("set"), context, axis.pointers);
    axis.choices.push_back(std::move(choice));
  }
  std::sort(axis.pointers.begin(), axis.pointers.end());
  axis.pointers.erase(std::unique(axis.pointers.begin(), axis.pointers.end()), axis.pointers.end());
}

bool is_filled_list(const Node& values, StudyContext& context) {
  if (values.type == Node::Type::array && !values.items.empty()) return true;
  context.problem(values, values.type == Node::Type::array
                              ? "the list of values is empty"
                              : "expected a list of values, got " + describe_value(values));
  return false;
}

void refuse_equal_labels(const Axis& axis, const Node& values, StudyContext& context) {
  for (std::size_t k = 0; k < axis.choices.size(); ++k)
    for (std::size_t i = 0; i < k; ++i)
      if (axis.choices[i].label == axis.choices[k].label && k < values.items.size())
        context.problem(values.items[k], "a second value is called " + in_quotes(axis.choices[k].label) +
                                             ": leave it out, or give \"labels\"");
}

/// Reads an axis in full: an object with "values". `key` is its key in an object of axes, empty in a list.
std::optional<Axis> read_full_axis(const std::string& key, const Node& node, StudyContext& context) {
  const bool in_list = key.empty();
  const Fields fields(&node, axis_section(key.starts_with('/'), in_list), context);
  std::string pointer = key.starts_with('/') ? key : "";
  if (in_list && fields.given("pointer")) pointer = fields.text("pointer");
  Axis axis;
  axis.name = fields.given("name") ? fields.text("name") : in_list ? pointer : key;
  if (axis.name.empty() && node.type == Node::Type::object)
    context.problem(node, "an axis needs \"pointer\" or \"name\"");
  axis.label = fields.given("label") ? fields.text("label") : pointer.empty() ? axis.name : word_of(pointer);
  axis.unit = fields.text("unit");
  if (!fields.given("values") || !is_filled_list(*fields.node("values"), context)) return std::nullopt;
  const Node& values = *fields.node("values");
  if (pointer.empty()) {
    for (const char* needless : {"labels", "scale"})
      if (in_list && fields.given(needless))
        context.problem(*fields.node(needless), "belongs to an axis with \"pointer\"");
    read_named_values(axis, values, context);
  } else if (is_pointer(pointer, fields.place(in_list ? "pointer" : "values"), context)) {
    read_pointer_values(axis, pointer, values, &fields, context);
  }
  refuse_equal_labels(axis, values, context);
  return axis;
}

std::optional<Axis> read_axis(const std::string& key, const Node& node, StudyContext& context) {
  if (node.type != Node::Type::array) return read_full_axis(key, node, context);
  if (!key.starts_with('/')) {
    context.problem(node,
                    "the key " + in_quotes(key) +
                        " is no JSON pointer, which begins with \"/\"; a named axis is an object with \"values\"");
    return std::nullopt;
  }
  if (!is_filled_list(node, context)) return std::nullopt;
  Axis axis{key, word_of(key), "", {}, {}};
  read_pointer_values(axis, key, node, nullptr, context);
  refuse_equal_labels(axis, node, context);
  return axis;
}

}  // namespace

void StudyContext::keep_place(const std::string& override_or_pointer, const Node& value) {
  places.emplace(override_or_pointer,
                 file + ":" + std::to_string(value.at.line) + ":" + std::to_string(value.at.column));
}

OrderedJson json_of(const Node& node) {
  switch (node.type) {
    case Node::Type::null:
      return nullptr;
    case Node::Type::boolean:
      return node.boolean;
    case Node::Type::number:
      if (node.number == std::floor(node.number) && std::abs(node.number) < 9e15) return std::llround(node.number);
      return node.number;
    case Node::Type::string:
      return node.text;
    case Node::Type::array: {
      OrderedJson list = OrderedJson::array();
      for (const Node& item : node.items) list.push_back(json_of(item));
      return list;
    }
    case Node::Type::object:
      break;
  }
  OrderedJson object = OrderedJson::object();
  for (const Member& member : node.members) object[member.key] = json_of(member.value);
  return object;
}

std::string word_of(const std::string& pointer) {
  std::string rest = pointer;
  if (rest.ends_with("/type")) rest.resize(rest.size() - 5);
  std::string word = rest.substr(rest.find_last_of('/') + 1);
  std::replace(word.begin(), word.end(), '_', ' ');
  return word.empty() ? pointer : word;
}

bool is_pointer(const std::string& pointer, const Node& at, StudyContext& context) {
  if (pointer.size() > 1 && pointer[0] == '/' && pointer.find('=') == std::string::npos) return true;
  context.problem(at, in_quotes(pointer) + " is no JSON pointer into an experiment, such as /grid/cell_size");
  return false;
}

bool overwrites(const std::string& later, const std::string& earlier) {
  return earlier == later || earlier.starts_with(later + "/");
}

std::vector<std::string> read_set(const Node& node, StudyContext& context, std::vector<std::string>& pointers) {
  std::vector<std::string> overrides;
  if (node.type != Node::Type::object) {
    context.problem(node, "expected an object of values by JSON pointer, got " + describe_value(node));
    return overrides;
  }
  for (const Member& member : node.members) {
    if (!is_pointer(member.key, member.value, context)) continue;
    pointers.push_back(member.key);
    overrides.push_back(member.key + "=" + json_of(member.value).dump());
    context.keep_place(overrides.back(), member.value);
  }
  return overrides;
}

std::vector<Axis> read_axes(const Node& node, StudyContext& context) {
  std::vector<Axis> axes;
  std::vector<const Node*> places;
  const auto add = [&](const std::string& key, const Node& value) {
    if (auto axis = read_axis(key, value, context)) axes.push_back(std::move(*axis)), places.push_back(&value);
  };
  if (node.type == Node::Type::object)
    for (const Member& member : node.members) add(member.key, member.value);
  else if (node.type == Node::Type::array)
    for (const Node& item : node.items) add("", item);
  else
    context.problem(node, "expected an object of axes by JSON pointer, or a list of axes, got " + describe_value(node));
  for (std::size_t k = 0; k < axes.size(); ++k)
    for (std::size_t i = 0; i < k; ++i) {
      if (axes[i].name == axes[k].name)
        context.problem(*places[k], "a second axis is called " + in_quotes(axes[k].name));
      for (const std::string& later : axes[k].pointers)
        for (const std::string& earlier : axes[i].pointers)
          if (overwrites(later, earlier))
            context.problem(*places[k], "sets " + later + ", which overwrites " + earlier + " of the axis " +
                                            in_quotes(axes[i].name) +
                                            (later == earlier ? "" : ": put this axis before that one"));
    }
  return axes;
}

}  // namespace mpm::study

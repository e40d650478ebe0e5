#include "experiment/located_json.hpp"

#include <cctype>
#include <fstream>
#include <limits>
#include <optional>
#include <set>
#include <sstream>

#include "experiment/json_cursor.hpp"

namespace mpm {
namespace {

constexpr std::size_t deepest = 64;  ///< bound, so that walking the tree needs little stack, whatever the input

using Json = nlohmann::json;

/// Follows the events of nlohmann's parser with a cursor of its own, since that parser reports no positions.
class Builder final : public nlohmann::json_sax<Json> {
 public:
  Builder(std::string_view text, std::string file) : cursor_(text), file_(std::move(file)) {}

  bool null() override {
    return put(Node::Type::null, [](Node&) {});
  }
  bool boolean(bool value) override {
    return put(Node::Type::boolean, [=](Node& node) { node.boolean = value; });
  }
  bool number_integer(number_integer_t value) override { return put_number(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return put_number(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) override { return put_number(value); }
  bool string(string_t& value) override {
    return put(Node::Type::string, [&](Node& node) { node.text = std::move(value); });
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Node::Type::object); }
  bool start_array(std::size_t) override { return open(Node::Type::array); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& value) override {
    cursor_.skip_separators();
    Frame& frame = stack_.back();
    frame.key = value;
    frame.key_at = cursor_.position();
    cursor_.skip_token();
    if (!frame.keys.insert(value).second) {
      add_problem(frame.key_at, "the key " + in_quotes(value) + " appears twice in one object");
    }
    state_ = JsonState::after_key;
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
    const bool in_object = !stack_.empty() && stack_.back().node.type == Node::Type::object;
    const bool out_of_range = error.id == 406;
    const JsonFault fault = describe_fault(cursor_, state_, in_object, !stack_.empty(), out_of_range);
    add_problem(fault.at, fault.message);
    return false;
  }

  Node root;
  std::vector<Problem> problems;

 private:
  struct Frame {
    Node node;
    std::string key;  ///< key of the member being read
    Position key_at;
    std::set<std::string> keys;
  };

  void add_problem(Position at, std::string message) {
    problems.push_back({file_, at.line, at.column, "", std::move(message)});
  }

  bool put_number(double value) {
    return put(Node::Type::number, [=](Node& node) { node.number = value; });
  }

  template <class Fill>
  bool put(Node::Type type, Fill fill) {
    Node node = start(type);
    fill(node);
    attach(std::move(node));
    return true;
  }

  Node start(Node::Type type) {
    cursor_.skip_separators();
    Node node;
    node.type = type;
    node.at = cursor_.position();
    cursor_.skip_token();
    return node;
  }

  bool open(Node::Type type) {
    Node node = start(type);
    if (stack_.size() >= deepest) {
      add_problem(node.at, "nested more than " + std::to_string(deepest) + " levels deep");
      return false;
    }
    stack_.push_back({std::move(node), {}, {}, {}});
    state_ = JsonState::after_open;
    return true;
  }

  bool close() {
    cursor_.skip_separators();
    cursor_.skip_token();
    Node node = std::move(stack_.back().node);
    stack_.pop_back();
    attach(std::move(node));
    return true;
  }

  void attach(Node node) {
    state_ = JsonState::after_value;
    if (stack_.empty()) {
      root = std::move(node);
    } else if (Frame& frame = stack_.back(); frame.node.type == Node::Type::array) {
      frame.node.items.push_back(std::move(node));
    } else {
      frame.node.members.push_back({frame.key, frame.key_at, std::move(node)});
    }
  }

  JsonCursor cursor_;
  std::string file_;
  JsonState state_ = JsonState::start;
  std::vector<Frame> stack_;
};

void assign_pointers(Node& node, std::string pointer) {
  node.pointer = std::move(pointer);
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    assign_pointers(node.items[i], node.pointer + "/" + std::to_string(i));
  }
  for (Member& member : node.members) assign_pointers(member.value, child_pointer(node.pointer, member.key));
}

void mark_option(Node& node, std::string_view option) {
  node.at = {0, 0, option};
  for (Node& item : node.items) mark_option(item, option);
  for (Member& member : node.members) {
    member.at = {0, 0, option};
    mark_option(member.value, option);
  }
}

std::optional<Node> parse_value(std::string_view text) {
  Builder builder(text, "--set");
  const bool ok = Json::sax_parse(text.begin(), text.end(), &builder);
  if (!ok || !builder.problems.empty()) return std::nullopt;
  return std::move(builder.root);
}

Node option_value(std::string_view text) {
  Node value;
  if (auto parsed = parse_value(text)) {
    value = std::move(*parsed);
  } else {
    value.type = Node::Type::string;
    value.text = text;
  }
  mark_option(value, "--set");
  return value;
}

/// Splits "/a/b~1c" into its keys, unescaped.
std::vector<std::string> pointer_keys(std::string_view pointer) {
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    if (pointer[i] == '/') {
      keys.emplace_back();
    } else if (pointer[i] == '~' && i + 1 < pointer.size() && (pointer[i + 1] == '0' || pointer[i + 1] == '1')) {
      keys.back() += pointer[++i] == '0' ? '~' : '/';
    } else {
      keys.back() += pointer[i];
    }
  }
  return keys;
}

/// The item that `key` names in an array; size() when it is no index of one.
std::size_t array_index(const Node& array, const std::string& key) {
  if (key.empty() || key.size() > 9 || key.find_first_not_of("0123456789") != std::string::npos) {
    return array.items.size();
  }
  return std::min<std::size_t>(std::stoul(key), array.items.size());
}

Node* child(Node& node, const std::string& key) {
  if (node.type == Node::Type::object) return node.find(key);
  if (node.type != Node::Type::array) return nullptr;
  const std::size_t index = array_index(node, key);
  return index < node.items.size() ? &node.items[index] : nullptr;
}

std::string shown(const Node& node) {
  return node.pointer.empty() ? "the top level" : node.pointer;
}

/// Says what the nearest existing place holds.
std::string contents(const Node& node, const std::string& wanted) {
  if (node.type == Node::Type::array) return "a list of " + std::to_string(node.items.size());
  if (node.type != Node::Type::object) return describe_value(node);
  std::vector<std::string> keys;
  for (const Member& member : node.members) keys.push_back(member.key);
  return "an object with " + (keys.empty() ? "no keys" : quoted_list(keys)) + did_you_mean(wanted, keys);
}

std::string override_problem(Node& root, std::string_view pointer, Node value) {
  const std::vector<std::string> keys = pointer_keys(pointer);
  Node* parent = &root;
  for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
    Node* next = child(*parent, keys[i]);
    if (!next) {
      return "there is no " + child_pointer(parent->pointer, keys[i]) + "; the nearest that exists, " + shown(*parent) +
             ", is " + contents(*parent, keys[i]);
    }
    parent = next;
  }
  const std::string& last = keys.back();
  Node* target = child(*parent, last);
  if (!target && parent->type == Node::Type::object) {
    parent->members.push_back({last, {0, 0, "--set"}, {}});
    target = &parent->members.back().value;
  } else if (!target && parent->type == Node::Type::array && last == std::to_string(parent->items.size())) {
    target = &parent->items.emplace_back();
  }
  if (!target) return "cannot be set: the nearest that exists, " + shown(*parent) + ", is " + contents(*parent, last);
  const std::string place = child_pointer(parent->pointer, last);
  *target = std::move(value);
  assign_pointers(*target, place);
  return {};
}

}  // namespace

const Node* Node::find(std::string_view key) const {
  return const_cast<Node*>(this)->find(key);
}

Node* Node::find(std::string_view key) {
  for (Member& member : members) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

std::string child_pointer(std::string_view parent, std::string_view key) {
  std::string pointer(parent);
  pointer += '/';
  for (const char c : key) {
    if (c == '~')
      pointer += "~0";
    else if (c == '/')
      pointer += "~1";
    else
      pointer += c;
  }
  return pointer;
}

Node parse_located(std::string_view text, const std::string& file) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw InputError({{file, 0, 0, "", "the file is empty; expected an experiment, an object in { }"}});
  }
  Builder builder(text, file);
  const bool ok = Json::sax_parse(text.begin(), text.end(), &builder, Json::input_format_t::json, true, true);
  if (!ok && builder.problems.empty()) builder.problems.push_back({file, 1, 1, "", "not valid JSON"});
  if (!builder.problems.empty()) throw InputError(std::move(builder.problems));
  assign_pointers(builder.root, "");
  return std::move(builder.root);
}

const Node& nearest_node(const Node& root, std::string_view pointer) {
  Node* nearest = &const_cast<Node&>(root);
  for (const std::string& key : pointer_keys(pointer)) {
    Node* const next = child(*nearest, key);
    if (!next) break;
    nearest = next;
  }
  return *nearest;
}

Node read_located(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError({{name, 0, 0, "", "there is no such file"}});
  if (std::filesystem::is_directory(status)) {
    throw InputError({{name, 0, 0, "", "is a directory; expected an experiment file"}});
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (stream && stream.peek() != std::ifstream::traits_type::eof()) text << stream.rdbuf();
  if (!stream.is_open() || stream.bad()) throw InputError({{name, 0, 0, "", "cannot be read"}});
  return parse_located(text.str(), name);
}

void apply_overrides(Node& root, std::span<const std::string> overrides, std::vector<Problem>& problems) {
  for (const std::string& text : overrides) {
    const std::size_t equals = text.find('=');
    if (text.empty() || text[0] != '/' || equals == std::string::npos) {
      problems.push_back(
          {"--set", 0, 0, "", in_quotes(text) + " is not of the form /json/pointer=value, e.g. /grid/cell_size=0.1"});
      continue;
    }
    const std::string pointer = text.substr(0, equals);
    const std::string message =
        override_problem(root, pointer, option_value(std::string_view(text).substr(equals + 1)));
    if (!message.empty()) problems.push_back({"--set", 0, 0, pointer, message});
  }
}

void set_from_option(Node& root, std::string_view key, std::string_view value, std::string_view option) {
  if (root.type != Node::Type::object) return;
  Node node;
  node.type = Node::Type::string;
  node.text = value;
  node.pointer = child_pointer("", key);
  node.at = {0, 0, option};
  if (Node* existing = root.find(key)) {
    *existing = std::move(node);
  } else {
    root.members.push_back({std::string(key), {0, 0, option}, std::move(node)});
  }
}

std::string describe_value(const Node& node) {
  switch (node.type) {
    case Node::Type::null:
      return "null";
    case Node::Type::boolean:
      return node.boolean ? "true" : "false";
    case Node::Type::number:
      return "the number " + number_text(node.number);
    case Node::Type::string:
      return "the string " + in_quotes(node.text);
    case Node::Type::array:
      return "a list";
    case Node::Type::object:
      return "an object";
  }
  return {};
}

namespace {
void collect_positions(const Node& node, std::vector<std::pair<std::string, std::pair<int, int>>>& out) {
  out.push_back({node.pointer, {node.at.line, node.at.column}});
  for (const Node& item : node.items) collect_positions(item, out);
  for (const Member& member : node.members) collect_positions(member.value, out);
}
}  // namespace

std::vector<std::pair<std::string, std::pair<int, int>>> all_positions(const Node& root) {
  std::vector<std::pair<std::string, std::pair<int, int>>> positions;
  collect_positions(root, positions);
  return positions;
}

}  // namespace mpm

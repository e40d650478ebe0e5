#pragma once
// JSON with a position for every value and key. Comments (// and /* */) are allowed, a key twice is not.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiment/diagnostics.hpp"

namespace mpm {

/// Where a value was written. Lines and columns count from 1, columns in characters, not bytes.
struct Position {
  int line = 0, column = 0;
  std::string_view option;  ///< the option that gave the value ("--set"), empty when it stands in the file
};

struct Member;

/// One JSON value and where it stands.
struct Node {
  enum class Type { null, boolean, number, string, array, object };

  Type type = Type::null;
  Position at;
  std::string pointer;  ///< JSON pointer from the root, "" for the root itself
  bool boolean = false;
  double number = 0;
  std::string text;             ///< text of a string
  std::vector<Node> items;      ///< items of an array
  std::vector<Member> members;  ///< members of an object, in the order of the file

  /// The value of a key, or null when the object has no such key.
  const Node* find(std::string_view key) const;
  Node* find(std::string_view key);
};

struct Member {
  std::string key;
  Position at;
  Node value;
};

/// Parses text. Throws InputError on a syntax error, a repeated key or nesting beyond 64 levels; `file` names it there.
Node parse_located(std::string_view text, const std::string& file);

/// The value at a JSON pointer or, where there is none, the nearest around it.
const Node& nearest_node(const Node& root, std::string_view pointer);

/// Reads and parses a file. Throws InputError also when it is missing, a directory, unreadable or empty.
Node read_located(const std::filesystem::path& file);

/// Applies "/json/pointer=value" overrides in order; the value is JSON if it parses as such, else a string.
/// Adds a problem, located as "--set", for each that names a place which does not exist.
void apply_overrides(Node& root, std::span<const std::string> overrides, std::vector<Problem>& problems);

/// Sets a key of the root to a string, as an option of the command line did.
void set_from_option(Node& root, std::string_view key, std::string_view value, std::string_view option);

/// The value in words: "the string "x"", "the number 3", "an object", …
std::string describe_value(const Node& node);

/// The pointer of a member, with ~ and / escaped.
std::string child_pointer(std::string_view parent, std::string_view key);

/// Pointer and position of every value, in the order of the file; line 0 for values that options gave.
std::vector<std::pair<std::string, std::pair<int, int>>> all_positions(const Node& root);

}  // namespace mpm

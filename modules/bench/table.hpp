#pragma once
// What a section found: tables and targets, as text, CSV, Markdown and JSON.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace mpm::bench {

using Json = nlohmann::ordered_json;

struct Column {
  std::string key;     ///< key in JSON: "rate"
  std::string header;  ///< header with the unit: "rate (M/s)"
};

/// A word, a number to three or four digits, or nothing.
using Cell = std::variant<std::monostate, std::string, double>;

struct Table {
  std::string id, title;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
  std::string note = {};

  std::string text() const;      ///< aligned, one line a row
  std::string csv() const;       ///< RFC 4180, full precision
  std::string markdown() const;  ///< a pipe table
  Json json() const;             ///< an object a row, which leaves out cells that are empty
};

struct Target {
  std::string id, meaning;
  double measured = 0, limit = 0;
  bool at_least = true;
  bool held() const { return at_least ? measured >= limit : measured <= limit; }  ///< false for NaN
};

struct SectionResult {
  std::string name;
  std::vector<Table> tables;
  std::vector<Target> targets;

  std::string text() const;
  Json json() const;
};

/// Targets of several sections as one table.
Table target_table(const std::vector<Target>& targets);

/// The number in four significant digits, "12.3" or "1.2e+09"; "-" when not finite.
std::string short_number(double value);

}  // namespace mpm::bench

#include "bench/table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "support/csv.hpp"
#include "support/numbers.hpp"

namespace mpm::bench {
namespace {

std::string cell_text(const Cell& cell) {
  if (const auto* word = std::get_if<std::string>(&cell)) return *word;
  if (const auto* number = std::get_if<double>(&cell)) return short_number(*number);
  return "-";
}

/// Width of a text in characters, not bytes: continuation bytes of UTF-8 take no room.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](unsigned char c) { return (c & 0xc0) != 0x80; }));
}

bool is_number_column(const Table& table, std::size_t column) {
  return std::none_of(table.rows.begin(), table.rows.end(),
                      [&](const auto& row) { return std::holds_alternative<std::string>(row[column]); });
}

}  // namespace

std::string short_number(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  char text[32];
  if (size < 1e7 && value == std::floor(value))
    std::snprintf(text, sizeof text, "%.0f", value);
  else if (size != 0 && (size < 1e-3 || size >= 1e6))
    std::snprintf(text, sizeof text, "%.3g", value);
  else
    std::snprintf(text, sizeof text, "%.*f",
                  size == 0 || size >= 1000 ? 0
                  : size >= 100             ? 1
                  : size >= 10              ? 2
                                            : 3,
                  value);
  return text;
}

std::string Table::text() const {
  std::vector<std::size_t> widths;
  for (const Column& column : columns) widths.push_back(width_of(column.header));
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(cell_text(row[c])));
  std::string out = title + "\n";
  const auto line = [&](auto&& word) {
    std::string text;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string cell = word(c), room(widths[c] - width_of(cell), ' ');
      text += (c ? "  " : "") + (is_number_column(*this, c) ? room + cell : cell + room);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + "\n";
  };
  line([&](std::size_t c) { return columns[c].header; });
  for (const auto& row : rows) line([&](std::size_t c) { return cell_text(row[c]); });
  if (!note.empty()) out += note + "\n";
  return out;
}

std::string Table::csv() const {
  support::CsvText csv;
  std::vector<std::string> cells;
  for (const Column& column : columns) cells.push_back(column.header);
  csv.row(cells);
  for (const auto& row : rows) {
    cells.clear();
    for (const Cell& cell : row) {
      const auto* word = std::get_if<std::string>(&cell);
      const auto* number = std::get_if<double>(&cell);
      cells.push_back(word ? *word : number && std::isfinite(*number) ? support::full_precision(*number) : "");
    }
    csv.row(cells);
  }
  return csv.text();
}

std::string Table::markdown() const {
  std::string out = "|", rule = "|";
  for (std::size_t c = 0; c < columns.size(); ++c) {
    out += " " + columns[c].header + " |";
    rule += is_number_column(*this, c) ? "---:|" : "---|";
  }
  out += "\n" + rule + "\n";
  for (const auto& row : rows) {
    out += "|";
    for (const Cell& cell : row) out += " " + cell_text(cell) + " |";
    out += "\n";
  }
  return note.empty() ? out : out + "\n" + note + "\n";
}

Json Table::json() const {
  Json all = Json::array();
  for (const auto& row : rows) {
    Json object = Json::object();
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string& key = columns[c].key;
      if (const auto* word = std::get_if<std::string>(&row[c]))
        object[key] = *word;
      else if (const auto* number = std::get_if<double>(&row[c]); number && std::isfinite(*number))
        object[key] = *number;
    }
    all.push_back(std::move(object));
  }
  return all;
}

Table target_table(const std::vector<Target>& targets) {
  Table table{"targets",
              "Targets",
              {{"target", "target"}, {"required", "required"}, {"measured", "measured"}, {"verdict", "verdict"}},
              {}};
  for (const Target& target : targets)
    table.rows.push_back({target.meaning, (target.at_least ? "at least " : "at most ") + short_number(target.limit),
                          short_number(target.measured), target.held() ? "held" : "missed"});
  return table;
}

std::string SectionResult::text() const {
  std::string out = "== " + name + " ==\n";
  for (const Table& table : tables) out += "\n" + table.text();
  if (!targets.empty()) out += "\n" + target_table(targets).text();
  return out;
}

Json SectionResult::json() const {
  Json json = Json::object();
  for (const Table& table : tables) json[table.id] = table.json();
  json["targets"] = Json::array();
  for (const Target& target : targets)
    json["targets"].push_back({{"id", target.id},
                               {"meaning", target.meaning},
                               {"measured", std::isfinite(target.measured) ? Json(target.measured) : Json()},
                               {"limit", target.limit},
                               {"at_least", target.at_least},
                               {"verdict", target.held() ? "held" : "missed"}});
  return json;
}

}  // namespace mpm::bench

#include "support/csv.hpp"

#include <fcntl.h>
#include <limits>
#include <optional>
#include <stdexcept>

#include "support/files.hpp"
#include "support/numbers.hpp"

namespace mpm::support {
namespace {

namespace fs = std::filesystem;

std::string header_line_of(const std::vector<std::string>& header) {
  CsvText line;
  line.row(header);
  return line.text();
}

template <typename ValueAt>
void append_row(std::string& text, std::size_t columns, ValueAt&& value_at) {
  for (std::size_t i = 0; i < columns; ++i) {
    if (i > 0) text += ',';
    append_shortest(text, value_at(i));
  }
  text += '\n';
}

std::vector<std::string> split_cells(std::string_view line) {
  std::vector<std::string> cells(1);
  bool inside_quotes = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (inside_quotes && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (c == '"') {
      inside_quotes = !inside_quotes;
    } else if (c == ',' && !inside_quotes) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The name without its unit: "kinetic energy (J)" -> "kinetic energy".
std::string_view without_unit(std::string_view name) {
  const auto bracket = name.rfind('(');
  const bool has_unit = bracket != std::string_view::npos && !name.empty() && name.back() == ')';
  return has_unit ? trimmed(name.substr(0, bracket)) : name;
}

/// The number in a cell; an empty cell is NaN.
std::optional<double> cell_number(std::string_view cell) {
  return trimmed(cell).empty() ? std::numeric_limits<double>::quiet_NaN() : number_in(cell);
}

void append_cells(Table& table, std::string_view line, const fs::path& path, std::size_t line_number) {
  const std::vector<std::string> cells = split_cells(line);
  if (cells.size() != table.header.size()) {
    throw csv_mistake(
        path, line_number,
        "this row has " + std::to_string(cells.size()) + " cells, the header " + std::to_string(table.header.size()));
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::optional<double> value = cell_number(cells[i]);
    if (!value) throw csv_mistake(path, line_number, "'" + cells[i] + "' is not a number");
    table.columns[i].push_back(*value);
  }
  table.lines.push_back(line_number);
}

/// Calls `take` with each line that is not empty and its number. Returns false when the last line has no end and was
/// left out: "0.12" may be the start of "0.1234", and no row is better than a wrong one.
template <typename Take>
bool for_each_line(const fs::path& path, Take&& take) {
  const std::string bytes = read_file(path);
  std::string_view rest = bytes;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);  // spreadsheets put this mark before their text
  for (std::size_t line_number = 1; !rest.empty(); ++line_number) {
    const auto end = rest.find('\n');
    if (end == std::string_view::npos) return false;
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(end + 1);
    if (!line.empty()) take(line, line_number);
  }
  return true;
}

void require_even(const Table& table) {
  if (table.header.size() != table.columns.size()) throw std::invalid_argument("a table needs one name a column");
  for (const auto& column : table.columns) {
    if (column.size() != table.rows()) throw std::invalid_argument("the columns of a table must be equally long");
  }
}

}  // namespace

std::runtime_error csv_mistake(const fs::path& path, std::size_t line, const std::string& what) {
  return std::runtime_error(path.string() + ":" + std::to_string(line) + ": " + what);
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string cell = "\"";
  for (const char c : text) {
    if (c == '"') cell += '"';
    cell += c == '\n' || c == '\r' ? ' ' : c;
  }
  return cell + '"';
}

void CsvText::row(std::span<const std::string> cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) text_ += ',';
    text_ += csv_cell(cells[i]);
  }
  text_ += '\n';
}

CsvAppender::CsvAppender(fs::path path, const std::vector<std::string>& header)
    : path_(std::move(path)), columns_(header.size()) {
  const std::string header_line = header_line_of(header);
  if (!fs::exists(path_)) write_atomically(path_, header_line);
  file_ = FileDescriptor(::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC));
  if (!file_.valid()) throw MachineError::from_errno("append to", path_, errno);
  open_existing(header_line);
}

void CsvAppender::open_existing(const std::string& header_line) {
  const std::string bytes = read_file(path_);
  if (!bytes.starts_with(header_line)) {
    throw std::invalid_argument(path_.string() + " has other columns than this run: move it aside");
  }
  whole_bytes_ = bytes.rfind('\n') + 1;
  if (whole_bytes_ < bytes.size() && ::ftruncate(file_.number(), static_cast<off_t>(whole_bytes_)) != 0) {
    throw MachineError::from_errno("repair", path_, errno);
  }
}

void CsvAppender::row(std::span<const double> values) {
  if (values.size() != columns_) {
    throw std::invalid_argument(path_.string() + ": a row of " + std::to_string(values.size()) + " numbers for " +
                                std::to_string(columns_) + " columns");
  }
  std::string line;
  append_row(line, columns_, [&](std::size_t i) { return values[i]; });
  if (const int error = file_.write_all(line); error != 0) {
    // Shrinking needs no space, so it works on a full disk; if even that fails, readers still tolerate the cut line.
    [[maybe_unused]] const int ignored = ::ftruncate(file_.number(), static_cast<off_t>(whole_bytes_));
    throw MachineError::from_errno("append to", path_, error);
  }
  whole_bytes_ += line.size();
}

void CsvAppender::sync() {
  if (::fsync(file_.number()) != 0) throw MachineError::from_errno("write", path_, errno);
}

const std::vector<double>* Table::find(std::string_view name) const {
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (header[i] == name) return &columns[i];
  }
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (without_unit(header[i]) == without_unit(name)) return &columns[i];
  }
  return nullptr;
}

Table read_csv(const fs::path& path) {
  Table table;
  table.last_line_was_cut = !for_each_line(path, [&](std::string_view line, std::size_t line_number) {
    if (table.header.empty()) {
      for (const std::string& cell : split_cells(line)) table.header.emplace_back(trimmed(cell));
      table.columns.resize(table.header.size());
    } else {
      append_cells(table, line, path, line_number);
    }
  });
  return table;
}

std::vector<std::vector<std::string>> read_csv_cells(const fs::path& path) {
  std::vector<std::vector<std::string>> rows;
  for_each_line(path, [&](std::string_view line, std::size_t) { rows.push_back(split_cells(line)); });
  return rows;
}

void write_csv(const fs::path& path, const Table& table) {
  require_even(table);
  std::string text = header_line_of(table.header);
  for (std::size_t r = 0; r < table.rows(); ++r) {
    append_row(text, table.columns.size(), [&](std::size_t c) { return table.columns[c][r]; });
  }
  write_atomically(path, text);
}

void drop_rows_after(const fs::path& path, double last) {
  if (!fs::exists(path)) return;
  const std::string bytes = read_file(path);
  std::size_t kept = bytes.find('\n') + 1;
  for (std::size_t end; (end = bytes.find('\n', kept)) != std::string::npos; kept = end + 1) {
    const std::string_view line(bytes.data() + kept, end - kept);
    const std::optional<double> first = cell_number(line.substr(0, line.find(',')));
    if (!first || !(*first <= last)) break;
  }
  if (kept < bytes.size()) write_atomically(path, std::string_view(bytes).substr(0, kept));
}

bool holds_whole_lines(const fs::path& path, std::size_t bytes) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  char last = 0;
  return file.valid() && bytes > 0 && ::pread(file.number(), &last, 1, static_cast<off_t>(bytes - 1)) == 1 &&
         last == '\n';
}

void cut_to(const fs::path& path, std::size_t bytes) {
  if (::truncate(path.c_str(), static_cast<off_t>(bytes)) != 0) throw MachineError::from_errno("shorten", path, errno);
}

}  // namespace mpm::support

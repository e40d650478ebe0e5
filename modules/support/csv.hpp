// Comma-separated tables: words and numbers of a figure, and rows of numbers that are appended while a run goes on.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "support/file_descriptor.hpp"

namespace mpm::support {

/// The `text` as a cell of a table: in quotes where a comma, a quote or a line end asks for them (RFC 4180). A line end
/// becomes a space, because a row is always one line: a line that a crash cut short can then be recognised.
std::string csv_cell(std::string_view text);

/// Collects rows of words and of numbers that are written already (support/numbers.hpp).
class CsvText {
 public:
  void row(std::span<const std::string> cells);
  void row(std::initializer_list<std::string> cells) { row(std::span<const std::string>(cells.begin(), cells.size())); }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Appends rows to a CSV file so that a killed process leaves whole rows.
///
/// A missing file is created with its header. An existing one is continued if its header is the same (a resumed run); a
/// last line cut by a crash is removed first. A file has one writer.
class CsvAppender {
 public:
  /// Opens the file. `header` holds a quantity and its unit a column: "time (s)", "kinetic energy (J)". Throws
  /// MachineError when the file cannot be opened; std::invalid_argument when it exists with another header.
  CsvAppender(std::filesystem::path path, const std::vector<std::string>& header);

  /// Writes one row, each number in the shortest form that reads back to the same bits. Throws std::invalid_argument
  /// when the count differs from the header's; MachineError when the disk is full (the file then ends with its last
  /// whole row and can be appended to again).
  void row(std::span<const double> values);

  /// Length of the file in bytes, header and whole rows.
  std::size_t bytes() const { return whole_bytes_; }
  /// Returns when all rows are on the disk. Throws MachineError.
  void sync();

 private:
  void open_existing(const std::string& header_line);

  std::filesystem::path path_;
  std::size_t columns_;
  FileDescriptor file_;
  std::size_t whole_bytes_ = 0;
};

struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<double>> columns;  ///< one vector a column, all of the same length
  std::vector<std::size_t> lines;            ///< number of each row's line in the file it was read from, from 1
  bool last_line_was_cut = false;            ///< the last line had no line end and was left out

  /// The column of this name, with or without its unit: "time (s)" or "time". nullptr when there is none.
  const std::vector<double>* find(std::string_view name) const;
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// A mistake in a table as messages write it: "FILE:LINE: what".
std::runtime_error csv_mistake(const std::filesystem::path& path, std::size_t line, const std::string& what);

/// Reads a table with one header line. An empty cell is NaN. Throws MachineError when the file cannot be read;
/// std::runtime_error naming path and line when a row is malformed.
Table read_csv(const std::filesystem::path& path);

/// Reads a table that also holds words (the twin of a figure): its whole lines, the header first, as cells. Throws
/// MachineError when the file cannot be read.
std::vector<std::vector<std::string>> read_csv_cells(const std::filesystem::path& path);

/// Writes a whole table at once (the twin of a figure). Throws MachineError, and std::invalid_argument on ragged
/// columns.
void write_csv(const std::filesystem::path& path, const Table& table);

/// Keeps the rows whose first column is at most `last` (in that column's unit), byte for byte, before a run resumes
/// from a checkpoint older than its last row. Does nothing when the file is missing. Throws MachineError.
void drop_rows_after(const std::filesystem::path& path, double last);

/// Whether the file's first `bytes` bytes are there and end with a whole line.
bool holds_whole_lines(const std::filesystem::path& path, std::size_t bytes);

/// Cuts the file to its first `bytes` bytes, before a run resumes from a checkpoint that counted them. Throws
/// MachineError.
void cut_to(const std::filesystem::path& path, std::size_t bytes);

}  // namespace mpm::support

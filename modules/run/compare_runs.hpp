#pragma once
// What differs between two recorded runs, and by how much.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mpm::app {

/// A value that differs, in words.
struct ValueDifference {
  std::string place;          ///< JSON pointer
  std::string first, second;  ///< values; "not there" where there is none
};

/// A number that differs most at some place. `relative` is the difference over the size that the number is held
/// against; infinite where one of the two is not a number.
struct NumberDifference {
  std::string name;  ///< JSON pointer, or column of metrics.csv
  double first = 0, second = 0;
  double absolute = 0, relative = 0;
  double scale = 0;               ///< the size that it is held against
  std::string held_against = "";  ///< what that size is: "sum of m |v|"; empty where one of the two is not a number
  double step = -1, time = 0;     ///< of a column: where, s
};

struct RunComparison {
  std::vector<ValueDifference> experiment;  ///< keys of experiment.json
  std::vector<ValueDifference> words;       ///< of summary.json, whatever is no pair of numbers, without /performance
  std::vector<NumberDifference> numbers;    ///< of summary.json, without /performance
  std::vector<NumberDifference> columns;    ///< of metrics.csv, one a column that differs
  std::vector<std::string> only_first, only_second;                ///< columns of metrics.csv that one run alone has
  std::size_t rows_first = 0, rows_second = 0, rows_compared = 0;  ///< of metrics.csv; rows of the same step
  std::vector<std::string> files_first, files_second;              ///< files that one run alone has
  std::vector<std::string> files_differ;  ///< files of both whose bytes differ, but for those that tell times

  /// The largest relative difference of any number but the ledger's books, which are rounding.
  double largest() const;
  /// Whether columns, rows and words are the same and all numbers differ by `tolerance` at most. Above a tolerance of 0
  /// books and warnings, which tell of rounding, are not judged.
  bool equal_within(double tolerance) const;
};

/// Compares two run folders. A number is held against the largest of its vector over the runs, an energy or heat against
/// the largest of them all, a momentum against the scale that summary.json names, and what is zero but for rounding (a
/// force that cancels by symmetry) against what momentum, mass and time make of its family. Throws
/// output::FolderRefused for what is no run, support::MachineError and std::runtime_error for what cannot be read.
RunComparison compare_runs(const std::filesystem::path& first, const std::filesystem::path& second);

/// The comparison as text for people, of differences above the tolerance and at most some of each kind.
std::string text_of(const RunComparison& comparison, double tolerance);
nlohmann::ordered_json json_of(const RunComparison& comparison, double tolerance);

}  // namespace mpm::app

#pragma once
// A measured number with its name and unit. Whatever lists numbers (ledgers, metrics, what a failure found) makes rows
// once; files and figures take their words from them.

#include <string>

namespace mpm {

struct ValueRow {
  std::string name;
  std::string unit;  ///< SI, empty for a pure number
  double value = 0;
  bool closes = false;  ///< what the rows before it leave unexplained
};

/// The head of a column: "total energy (J)".
inline std::string heading(const ValueRow& row) {
  return row.unit.empty() ? row.name : row.name + " (" + row.unit + ")";
}

/// The key of a row in a JSON file, whose numbers are in SI units: "internal_force".
inline std::string key_of(const ValueRow& row) {
  std::string key = row.name;
  for (char& c : key)
    if (c == ' ') c = '_';
  return key;
}

}  // namespace mpm

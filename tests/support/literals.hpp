#pragma once
// Numbers that stand in the texts of the program, its tests and its experiments, so that a page's number can be looked for
// where it comes from.

#include <cmath>
#include <cstdlib>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "support/page.hpp"

namespace mpm::test {

/// All numbers of a sentence of a page but those of names, of code and of links.
inline std::vector<PrintedNumber> numbers_in(const std::string& sentence, const std::vector<std::string>& names) {
  std::string left = sentence;
  for (const char* typed :
       {"`[^`]*`", "!\\[[^\\]]*\\]\\([^)]*\\)", "\\]\\([^)]*\\)", "[Ll]essons? [0-9]", "exit code [0-9]"})
    left = std::regex_replace(left, std::regex(typed), " ");
  for (const std::string& name : names) left = std::regex_replace(left, std::regex(name), " ");
  left = std::regex_replace(left, std::regex("([0-9])½"), "$1.5");
  left = std::regex_replace(left, std::regex("½"), "0.5");
  left = std::regex_replace(left, std::regex("([0-9]) (?=[0-9]{3}(?![0-9.]))"), "$1");  // 54 516
  static const std::regex number("[0-9]+(?:\\.[0-9]+)?(?:e[-+]?[0-9]+)?(?:·10)?(?:⁻|⁰|¹|²|³|⁴|⁵|⁶|⁷|⁸|⁹)*"),
      raised("(?:⁻|⁰|¹|²|³|⁴|⁵|⁶|⁷|⁸|⁹)+");
  std::vector<PrintedNumber> numbers;
  for (std::sregex_iterator match(left.begin(), left.end(), number), end; match != end; ++match) {
    const std::string text = match->str();
    const bool is_power = text.find("·10") != std::string::npos || text.starts_with("10⁻");
    const std::string plain = is_power ? text : std::regex_replace(text, raised, "");
    const std::size_t power = plain.find('e');
    const double scale = power == std::string::npos ? 1 : std::stod("1" + plain.substr(power));
    const PrintedNumber now = printed_number(plain.substr(0, power));
    numbers.push_back({now.value * scale, now.half_unit * scale});
  }
  return numbers;
}

/// A text of C++ without the numbers of included names and of the widths of what is printed.
inline std::string without_words(const std::string& text) {
  std::istringstream lines(text);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#include")) continue;
    kept += std::regex_replace(line, std::regex("%[-+ #]?[0-9]*(\\.[0-9]+)?l*[a-zA-Z]"), " ") + '\n';
  }
  return kept;
}

/// The numbers of a text, of C++ without those of names and widths, and what those below 1 lack to it.
inline const std::vector<double>& literals_of(const std::string& file) {
  static std::map<std::string, std::vector<double>> read;
  const auto [entry, is_new] = read.try_emplace(file);
  if (!is_new) return entry->second;
  static const std::regex literal("[0-9]*\\.?[0-9]+(?:e[-+]?[0-9]+)?");
  std::string text = mpm::support::read_file(MPM_SOURCE_DIR "/" + file);
  if (file.ends_with(".cpp") || file.ends_with(".hpp")) text = without_words(text);
  for (std::sregex_iterator match(text.begin(), text.end(), literal), end; match != end; ++match) {
    const double value = std::strtod(match->str().c_str(), nullptr);  // some are too small for a double
    entry->second.push_back(value);
    if (value > 0 && value < 1) entry->second.push_back(1 - value);
  }
  return entry->second;
}

/// Whether a number as it is printed is this one, in whatever unit of a power of ten. What is printed with three digits or more
/// may be rounded.
inline bool is_printed_as(double number, const PrintedNumber& printed) {
  const double value = std::abs(printed.value);
  if (value == 0) return true;
  if (number <= 0) return false;
  const double margin = value >= 200 * printed.half_unit ? printed.half_unit / value : 0;
  const double power = std::round(std::log10(value / number));
  return std::abs(number * std::pow(10.0, power) / value - 1) <= margin + 1e-9;
}

/// Whether it stands in one of the files.
inline bool stands_in(const PrintedNumber& printed, const std::vector<std::string>& files) {
  for (const std::string& file : files)
    for (const double number : literals_of(file))
      if (is_printed_as(number, printed)) return true;
  return printed.value == 0;
}

}  // namespace mpm::test

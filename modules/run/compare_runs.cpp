#include "run/compare_runs.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "output/json_differences.hpp"
#include "output/run_folder.hpp"
#include "output/summary_value.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/numbers.hpp"

namespace mpm::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using support::Table;

using support::infinity;

/// Files that tell times, commands and folders, or that are compared number by number.
const std::set<std::string> compared_otherwise{"experiment.json", "manifest.json", "summary.json", "report.html",
                                               "metrics.csv"};

/// The object in a file; an empty one where there is no file, as a run that was killed leaves it.
Json json_in(const fs::path& file) {
  if (!fs::is_regular_file(file)) return Json::object();
  Json json = Json::parse(support::read_file(file), nullptr, false);
  if (!json.is_object())
    throw std::runtime_error(file.string() + " is damaged: it holds no JSON object; run the experiment again");
  return json;
}

double size_of(double a, double b) {
  return std::max(std::abs(a), std::abs(b));
}

/// A size that a number is held against, and what it is.
struct Scale {
  double size = 0;
  std::string name;
};

/// The difference of two numbers that are held against a scale. Two that are not numbers are the same.
std::optional<NumberDifference> difference(const std::string& name, double a, double b, const Scale& scale) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return std::nullopt;
  const double absolute = std::abs(a - b), own = size_of(a, b);
  if (!std::isfinite(absolute)) return NumberDifference{name, a, b, infinity, infinity};
  const bool by_itself = !(scale.size > own);
  const double size = by_itself ? own : scale.size;
  return NumberDifference{name, a, b, absolute, absolute / size, size, by_itself ? "itself" : scale.name};
}

/// Whether a number is one of the ledger's books, which are rounding in a program without a fault and so are held
/// against nothing.
bool is_book(const std::string& name) {
  return name.starts_with("/energy/books") || name.starts_with("book ");
}

// ---- scales --------------------------------------------------------------------------------------------------------

/// Numbers of a pair of runs that others are held against.
struct Sizes {
  double energy = 0, heat = 0;
  double momentum = 0, angular_momentum = 0;  ///< sum of m |v|, sum of m |x| |v|
  double mass = 0, time = 0;
  double rounding = 1e-9;  ///< what is below this share of the scale of its family is zero but for rounding

  double length() const { return momentum > 0 ? angular_momentum / momentum : 0; }
  double over_time(double size) const { return time > 0 ? size / time : 0; }
  double speed() const { return mass > 0 ? momentum / mass : 0; }
};

double largest_below(const Json* value) {
  if (!value) return 0;
  if (value->is_number()) return std::abs(value->get<double>());
  if (!value->is_object()) return 0;
  double largest = 0;
  for (const auto& [key, child] : value->items())
    if (!key.ends_with("over_initial") && key != "gain") largest = std::max(largest, largest_below(&child));
  return largest;
}

Sizes sizes_of(const Json& a, const Json& b, bool in_float) {
  Sizes sizes;
  if (in_float) sizes.rounding = 1e-4;
  for (const Json* summary : {&a, &b}) {
    const auto take = [&](double& size, const char* path) {
      size = std::max(size, largest_below(output::value_at(*summary, path)));
    };
    for (const char* path : {"energy.kinetic", "energy.strain", "energy.gravitational", "energy.total"})
      take(sizes.energy, path);
    for (const char* path : {"heat.content", "heat.latent"}) take(sizes.heat, path);
    take(sizes.momentum, "scales.momentum");
    take(sizes.angular_momentum, "scales.angular_momentum");
    take(sizes.mass, "mass");
    take(sizes.time, "simulated_time");
  }
  return sizes;
}

/// The scale of the family of quantities that a name tells of: what momentum, time and mass of the runs make of it. A
/// name in blanks, as columns have it.
Scale scale_of_family(const std::string& name, const Sizes& sizes) {
  const auto has = [&](const char* word) { return name.find(word) != std::string::npos; };
  if (has("angular momentum")) return {sizes.angular_momentum, "sum of m |x| |v|"};
  if (has("angular velocity"))
    return {sizes.length() > 0 ? sizes.speed() / sizes.length() : 0, "mean |v| over mean |x|"};
  if (has("momentum")) return {sizes.momentum, "sum of m |v|"};
  if (has("moment of inertia")) return {sizes.mass * sizes.length() * sizes.length(), "mass times mean |x|^2"};
  if (has("moment")) return {sizes.over_time(sizes.angular_momentum), "sum of m |x| |v| over the simulated time"};
  if (has("force") || has("reaction")) return {sizes.over_time(sizes.momentum), "sum of m |v| over the simulated time"};
  if (has("velocity") || has("speed")) return {sizes.speed(), "sum of m |v| over the mass"};
  if (has("centre of mass") || has("position") || has("displacement"))
    return {sizes.length(), "mean distance from the origin"};
  return {};
}

/// The scale of a vector, a tensor or a number of its own: the largest of its components over the runs. One that is zero
/// but for rounding is held against its family, and so are momenta, which are sums in which much cancels.
Scale scale_of(const std::string& name, double largest, const Sizes& sizes) {
  const Scale family = scale_of_family(name, sizes);
  const bool sums_up = name.find("momentum") != std::string::npos;
  if (sums_up || largest < sizes.rounding * family.size) return family;
  return {largest, "the largest of its components over the run"};
}

/// The name without the component at its end: "velocity_x" and "contact force x" without theirs.
std::string without_component(const std::string& name) {
  const std::size_t last = name.find_last_of("_ /");
  if (last == std::string::npos || last == 0) return name;
  const std::string end = name.substr(last + 1);
  const bool component = !end.empty() && end.size() <= 2 && end.find_first_not_of("xyz") == std::string::npos;
  return component ? name.substr(0, last) : name;
}

// ---- summary.json ------------------------------------------------------------------------------------------------

/// What a pointer's number is held against together: all components of its vector, at the start, at the end, and the
/// largest and smallest over the run.
std::string group_of_pointer(std::string pointer) {
  for (const char* moment : {"/initial", "/final", "/smallest", "/largest"})
    if (const std::size_t at = pointer.find(moment), end = at + std::string(moment).size();
        at != std::string::npos && (end == pointer.size() || pointer[end] == '/'))
      pointer.erase(at, end - at);
  return without_component(pointer);
}

void add_largest(const Json& value, const std::string& pointer, std::map<std::string, double>& largest) {
  if (value.is_number()) {
    double& size = largest[group_of_pointer(pointer)];
    size = std::max(size, std::abs(value.get<double>()));
  } else if (value.is_object()) {
    for (const auto& [key, child] : value.items()) add_largest(child, pointer + "/" + key, largest);
  }
}

Scale scale_in_summary(const std::string& pointer, const std::map<std::string, double>& largest, const Sizes& sizes) {
  const bool share =
      pointer.find("over_initial") != std::string::npos || pointer.ends_with("gain") || pointer.starts_with("/limits");
  if (share) return {1, "one, as a share"};
  if (pointer.starts_with("/energy")) return {sizes.energy, "the largest energy"};
  if (pointer.starts_with("/heat") && pointer.find("temperature") == std::string::npos)
    return {sizes.heat, "the largest heat"};
  if (pointer.starts_with("/momentum/angular")) return {sizes.angular_momentum, "sum of m |x| |v|"};
  std::string name = pointer;
  std::replace(name.begin(), name.end(), '_', ' ');
  const auto group = largest.find(group_of_pointer(pointer));
  return scale_of(name, group == largest.end() ? 0 : group->second, sizes);
}

void compare_summaries(Json a, Json b, const Sizes& sizes, RunComparison& result) {
  for (Json* summary : {&a, &b}) summary->erase("performance");
  std::map<std::string, double> largest;
  for (const Json* summary : {&a, &b}) add_largest(*summary, "", largest);
  for (const output::JsonDifference& found : output::differences(a, b)) {
    const bool numbers = found.first && found.second && found.first->is_number() && found.second->is_number();
    if (!numbers) {
      result.words.push_back({found.pointer, output::short_text(found.first), output::short_text(found.second)});
    } else if (auto one = difference(found.pointer, found.first->get<double>(), found.second->get<double>(),
                                     scale_in_summary(found.pointer, largest, sizes))) {
      result.numbers.push_back(std::move(*one));
    }
  }
}

// ---- metrics.csv -------------------------------------------------------------------------------------------------

/// What a column is held against together: columns of one group share the largest number.
std::string group_of(const std::string& header) {
  const std::string name = header.substr(0, header.find(" ("));
  // In a plane energies are those a metre of depth.
  if (header.ends_with(" (J)") || header.ends_with(" (J/m)"))
    return name.find("heat") == std::string::npos ? "energies" : "heats";
  return without_component(name);
}

std::map<std::string, double> group_sizes(const Table& a, const Table& b) {
  std::map<std::string, double> largest;
  for (const Table* table : {&a, &b})
    for (std::size_t k = 0; k < table->header.size(); ++k)
      for (const double value : table->columns[k])
        if (double& size = largest[group_of(table->header[k])]; std::isfinite(value))
          size = std::max(size, std::abs(value));
  return largest;
}

/// Rows of the two tables that have the same step.
std::vector<std::pair<std::size_t, std::size_t>> common_rows(const Table& a, const Table& b) {
  std::vector<std::pair<std::size_t, std::size_t>> rows;
  const auto *steps = a.find("step"), *others = b.find("step");
  if (!steps || !others) return rows;
  for (std::size_t i = 0, j = 0; i < steps->size() && j < others->size();) {
    if ((*steps)[i] == (*others)[j])
      rows.emplace_back(i++, j++);
    else if ((*steps)[i] < (*others)[j])
      ++i;
    else
      ++j;
  }
  return rows;
}

std::vector<std::string> missing_in(const std::vector<std::string>& these, const std::vector<std::string>& those) {
  std::vector<std::string> missing;
  for (const std::string& name : these)
    if (std::find(those.begin(), those.end(), name) == those.end()) missing.push_back(name);
  return missing;
}

void compare_tables(const Table& a, const Table& b, const Sizes& sizes, RunComparison& result) {
  result.rows_first = a.rows(), result.rows_second = b.rows();
  result.only_first = missing_in(a.header, b.header);
  result.only_second = missing_in(b.header, a.header);
  const auto rows = common_rows(a, b);
  result.rows_compared = rows.size();
  const auto largest = group_sizes(a, b);
  for (std::size_t k = 0; k < a.header.size(); ++k) {
    const std::vector<double>* other = b.find(a.header[k]);
    if (!other) continue;
    const std::string group = group_of(a.header[k]);
    const Scale scale = group == "energies" ? Scale{largest.at(group), "the largest energy"}
                        : group == "heats"  ? Scale{largest.at(group), "the largest heat"}
                                            : scale_of(group, largest.at(group), sizes);
    std::optional<NumberDifference> worst;
    for (const auto& [i, j] : rows) {
      auto one = difference(a.header[k], a.columns[k][i], (*other)[j], scale);
      if (!one || (worst && !(one->absolute > worst->absolute))) continue;
      one->step = (*a.find("step"))[i];
      one->time = a.find("time") ? (*a.find("time"))[i] : 0;
      worst = std::move(one);
    }
    if (worst) result.columns.push_back(std::move(*worst));
  }
}

Table table_in(const fs::path& file) {
  return fs::is_regular_file(file) ? support::read_csv(file) : Table{};
}

// ---- files -------------------------------------------------------------------------------------------------------

std::vector<std::string> files_below(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(folder).string());
  std::sort(names.begin(), names.end());
  return names;
}

void compare_files(const fs::path& first, const fs::path& second, RunComparison& result) {
  const auto names = files_below(first), others = files_below(second);
  result.files_first = missing_in(names, others);
  result.files_second = missing_in(others, names);
  for (const std::string& name : names) {
    if (compared_otherwise.count(name) || !fs::is_regular_file(second / name)) continue;
    if (fs::file_size(first / name) != fs::file_size(second / name) ||
        support::read_file(first / name) != support::read_file(second / name))
      result.files_differ.push_back(name);
  }
}

// ---- what is printed -----------------------------------------------------------------------------------------------

constexpr std::size_t most_lines = 12;  ///< of one kind

std::string exactly(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

void add_list(std::string& text, const std::string& head, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  text += head + "\n";
  for (std::size_t k = 0; k < std::min(lines.size(), most_lines); ++k) text += "  " + lines[k] + "\n";
  if (lines.size() > most_lines) text += "  ... and " + std::to_string(lines.size() - most_lines) + " more\n";
}

std::vector<std::string> lines_of(const std::vector<ValueDifference>& values) {
  std::vector<std::string> lines;
  for (const ValueDifference& one : values) lines.push_back(one.place + ": " + one.first + " | " + one.second);
  return lines;
}

/// Those above the tolerance, the largest first; without books, which no tolerance judges.
std::vector<NumberDifference> above(std::vector<NumberDifference> numbers, double tolerance) {
  std::erase_if(numbers, [&](const NumberDifference& one) {
    return one.relative <= tolerance || (tolerance > 0 && is_book(one.name));
  });
  std::stable_sort(numbers.begin(), numbers.end(),
                   [](const auto& a, const auto& b) { return a.relative > b.relative; });
  return numbers;
}

std::vector<std::string> lines_of(const std::vector<NumberDifference>& numbers) {
  std::vector<std::string> lines;
  for (const NumberDifference& one : numbers)
    lines.push_back(
        one.name + ": " + exactly(one.first) + " | " + exactly(one.second) + ", differ by " +
        support::three_digits(one.absolute) + ", relative " + support::three_digits(one.relative) +
        (one.held_against.empty() ? "" : " of " + support::three_digits(one.scale) + " (" + one.held_against + ")") +
        (one.step < 0 ? ""
                      : ", most at step " + exactly(one.step) + ", t = " + support::three_digits(one.time) + " s"));
  return lines;
}

Json json_of(const std::vector<ValueDifference>& values) {
  Json list = Json::array();
  for (const ValueDifference& one : values)
    list.push_back({{"place", one.place}, {"first", one.first}, {"second", one.second}});
  return list;
}

Json json_of(const std::vector<NumberDifference>& numbers) {
  Json list = Json::array();
  for (const NumberDifference& one : numbers) {
    list.push_back({{"name", one.name},
                    {"first", one.first},
                    {"second", one.second},
                    {"absolute", one.absolute},
                    {"relative", one.relative},
                    {"scale", one.scale},
                    {"held_against", one.held_against}});
    if (one.step >= 0) list.back()["step"] = one.step, list.back()["time"] = one.time;
  }
  return list;
}

}  // namespace

double RunComparison::largest() const {
  double largest = 0;
  for (const auto* list : {&numbers, &columns})
    for (const NumberDifference& one : *list)
      if (!is_book(one.name)) largest = std::max(largest, one.relative);
  return largest;
}

bool RunComparison::equal_within(double tolerance) const {
  if (!only_first.empty() || !only_second.empty() || rows_first != rows_compared || rows_second != rows_compared)
    return false;
  if (tolerance == 0) return words.empty() && numbers.empty() && columns.empty();
  return largest() <= tolerance && std::all_of(words.begin(), words.end(), [](const ValueDifference& one) {
           return one.place.starts_with("/warnings");
         });
}

RunComparison compare_runs(const fs::path& first, const fs::path& second) {
  const fs::path a = output::RunFolder::open(first).root(), b = output::RunFolder::open(second).root();
  RunComparison result;
  const Json experiment = json_in(a / "experiment.json"), other = json_in(b / "experiment.json");
  for (const output::JsonDifference& found : output::differences(experiment, other))
    result.experiment.push_back({found.pointer, output::short_text(found.first), output::short_text(found.second)});
  const Json summary = json_in(a / "summary.json"), other_summary = json_in(b / "summary.json");
  const auto in_float = [](const Json& file) { return file.value("precision", "") == "float"; };
  const Sizes sizes = sizes_of(summary, other_summary, in_float(experiment) || in_float(other));
  compare_summaries(summary, other_summary, sizes, result);
  compare_tables(table_in(a / "metrics.csv"), table_in(b / "metrics.csv"), sizes, result);
  compare_files(a, b, result);
  return result;
}

std::string text_of(const RunComparison& c, double tolerance) {
  std::string text;
  add_list(text, "experiment.json differs (first | second):", lines_of(c.experiment));
  add_list(text, "summary.json differs in words:", lines_of(c.words));
  add_list(text, "summary.json differs in numbers:", lines_of(above(c.numbers, tolerance)));
  add_list(text, "metrics.csv has columns in the first alone:", c.only_first);
  add_list(text, "metrics.csv has columns in the second alone:", c.only_second);
  if (c.rows_first != c.rows_compared || c.rows_second != c.rows_compared)
    text += "metrics.csv has " + std::to_string(c.rows_first) + " and " + std::to_string(c.rows_second) +
            " rows, of which " + std::to_string(c.rows_compared) + " have the same step and are compared\n";
  add_list(text, "metrics.csv differs:", lines_of(above(c.columns, tolerance)));
  add_list(text, "files in the first alone:", c.files_first);
  add_list(text, "files in the second alone:", c.files_second);
  add_list(text, "files with other bytes:", c.files_differ);
  const double largest = c.largest();
  text += largest == 0          ? "all numbers that both have are the same\n"
          : std::isinf(largest) ? "a number of one run is none in the other\n"
                                : "the numbers that both have agree within " + support::three_digits(largest) + "\n";
  text += c.equal_within(tolerance) ? "equal" : "not equal";
  return text + (tolerance > 0 ? " within the tolerance of " + support::three_digits(tolerance) : "") + "\n";
}

Json json_of(const RunComparison& c, double tolerance) {
  return {
      {"equal", c.equal_within(tolerance)},
      {"tolerance", tolerance},
      {"largest_relative_difference", c.largest()},
      {"experiment", json_of(c.experiment)},
      {"summary", {{"words", json_of(c.words)}, {"numbers", json_of(c.numbers)}}},
      {"metrics",
       {{"rows", {c.rows_first, c.rows_second}},
        {"rows_compared", c.rows_compared},
        {"columns_only_in_first", c.only_first},
        {"columns_only_in_second", c.only_second},
        {"columns", json_of(c.columns)}}},
      {"files", {{"only_in_first", c.files_first}, {"only_in_second", c.files_second}, {"differ", c.files_differ}}}};
}

}  // namespace mpm::app

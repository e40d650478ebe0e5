#include "output/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "support/csv.hpp"
#include "support/numbers.hpp"

namespace mpm::output::report {
namespace {

namespace fs = std::filesystem;

constexpr double limit = 1e-12;

double number_in(const Json& summary, std::initializer_list<const char*> keys) {
  const Json* value = member(summary, keys);
  return value != nullptr && value->is_number() ? value->get<double>() : NAN;
}

/// The largest energy of one kind in any recorded row, J.
double largest_energy(const fs::path& metrics) {
  double largest = NAN;
  std::error_code ignored;
  if (!fs::is_regular_file(metrics, ignored)) return largest;
  try {
    const support::Table table = support::read_csv(metrics);
    for (const char* kind : {"kinetic energy", "strain energy", "gravitational energy"})
      if (const auto* energies = table.find(kind))
        for (const double energy : *energies) largest = std::fmax(largest, std::abs(energy));
  } catch (const std::runtime_error&) {
    return NAN;  // a damaged table costs a judgement, not the report
  }
  return largest;
}

/// The numbers that a figure's curves show, from its CSV twin: a row is a point of a named series (render/curves.cpp),
/// or a place on the axis with the value of every series there (render/stacked.cpp).
std::vector<double> shown_numbers(const fs::path& twin) {
  std::vector<double> numbers;
  const auto rows = support::read_csv_cells(twin);
  if (rows.empty()) return numbers;
  const bool is_a_row_a_point = rows.front().size() > 3 && rows.front()[0] == "series" && rows.front()[1] == "kind";
  const std::size_t first = is_a_row_a_point ? 3 : 1, last = is_a_row_a_point ? 4 : rows.front().size();
  for (std::size_t row = 1; row < rows.size(); ++row)
    for (std::size_t cell = first; cell < std::min(last, rows[row].size()); ++cell)
      numbers.push_back(support::number_in(rows[row][cell]).value_or(NAN));
  return numbers;
}

/// The next number of two significant digits that is not below a positive `value`.
double two_digits_up(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit) * unit;
}

}  // namespace

RoundingRule::RoundingRule(const Run& run) : figures_(run.folder / "figures") {
  const double momentum = number_in(run.summary, {"scales", "momentum"});
  const double spin = number_in(run.summary, {"scales", "angular_momentum"});
  const double time = number_in(run.summary, {"simulated_time"});
  sizes_["momentum"] = {momentum, "Σ m |v|"};
  sizes_["angular_momentum"] = {spin, "Σ m |x| |v|"};
  const double energy = largest_energy(run.folder / "metrics.csv");
  for (const char* stem : {"energy", "dissipation", "ledger"})
    sizes_[stem] = {energy, "the largest kinetic, strain or gravitational energy"};
  sizes_["contact"] = {momentum / time, "Σ m |v| over the simulated time"};
  sizes_["reactions"] = sizes_["contact_pairs"] = sizes_["contact"];
  sizes_["contact_pair_impulses"] = sizes_["momentum"];
  sizes_["contact_nodes"] = {1, "one node"};
  sizes_["error"] = {spin / momentum, "the mean distance from the origin"};
  sizes_["volume_ratio"] = {1, "one"};
}

std::optional<std::string> RoundingRule::remark(const std::string& stem) const {
  const auto size = sizes_.find(stem);
  const fs::path twin = figures_ / (stem + ".csv");
  std::error_code ignored;
  if (size == sizes_.end() || !std::isfinite(size->second.value) || !fs::is_regular_file(twin, ignored)) return {};
  const std::vector<double> numbers = shown_numbers(twin);
  if (numbers.empty()) return {};
  const double resting = stem == "volume_ratio" ? 1 : 0;
  double largest = 0;
  for (const double number : numbers) {
    if (!std::isfinite(number)) return {};
    largest = std::max(largest, std::abs(number - resting));
  }
  if (largest > limit * size->second.value) return {};
  if (largest == 0) return resting == 1 ? "one throughout" : "zero throughout";
  return "rounding, at most " + number_html(two_digits_up(largest / size->second.value)) + " of " + size->second.name;
}

}  // namespace mpm::output::report

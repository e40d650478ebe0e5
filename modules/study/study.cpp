#include "study/study.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include "experiment/reader.hpp"

namespace mpm::study {
namespace {

constexpr std::size_t longest_part = 48;  ///< characters that an axis may take of a folder's name

/// What a label becomes in the name of a folder.
std::string as_file_name(const std::string& label) {
  std::string name;
  for (const char c : label) {
    const bool plain =
        std::isalnum(static_cast<unsigned char>(c)) || std::string_view("._+-").find(c) != std::string::npos;
    if (plain)
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
    if (name.size() == longest_part) break;
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  while (name.starts_with('.')) name.erase(0, 1);
  return name.empty() ? "value" : name;
}

}  // namespace

std::string with_unit(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : label + " (" + unit + ")";
}

bool Axis::is_numeric() const {
  return std::all_of(choices.begin(), choices.end(), [](const Choice& choice) { return choice.number.has_value(); });
}

std::string Axis::title() const {
  return with_unit(label, unit);
}

ExpressionScope scope_of_measures(const Study& study, const std::vector<std::size_t>& choices) {
  ExpressionScope scope{"x", {}};
  for (std::size_t k = 0; k < study.axes.size(); ++k) {
    const Axis& axis = study.axes[k];
    const bool is_there = !axis.choices.empty() && axis.is_numeric();
    if (is_there && is_name(axis.name) && is_free_in_formulas(axis.name))
      scope.constants.emplace_back(axis.name, *axis.choices[choices[k]].number);
  }
  return scope;
}

std::string Measure::title() const {
  return with_unit(label, unit);
}

std::string Bisection::title() const {
  return with_unit(label, unit);
}

std::size_t Study::axis_index(const std::string& name) const {
  const auto found = std::find_if(axes.begin(), axes.end(), [&](const Axis& axis) { return axis.name == name; });
  return static_cast<std::size_t>(found - axes.begin());
}

const Axis* Study::axis(const std::string& name) const {
  const std::size_t index = axis_index(name);
  return index < axes.size() ? &axes[index] : nullptr;
}

const Measure* Study::measure(const std::string& name) const {
  const auto found = std::find_if(measures.begin(), measures.end(), [&](const Measure& m) { return m.name == name; });
  return found == measures.end() ? nullptr : &*found;
}

std::vector<Combination> expand(const Study& study) {
  std::vector<Combination> all;
  std::set<std::string> taken;
  std::vector<std::size_t> at(study.axes.size(), 0);
  for (bool more = true; more;) {
    Combination combination{"", at, study.overrides};
    for (std::size_t k = 0; k < at.size(); ++k) {
      const Choice& choice = study.axes[k].choices[at[k]];
      combination.name += (k ? "-" : "") + as_file_name(choice.label);
      combination.overrides.insert(combination.overrides.end(), choice.overrides.begin(), choice.overrides.end());
    }
    if (combination.name.empty()) combination.name = "run";
    const std::string name = combination.name;
    for (int copy = 2; !taken.insert(combination.name).second; ++copy)
      combination.name = name + "." + std::to_string(copy);
    all.push_back(std::move(combination));
    more = false;
    for (std::size_t k = at.size(); k-- > 0 && !more;) {
      more = ++at[k] < study.axes[k].choices.size();
      if (!more) at[k] = 0;
    }
  }
  return all;
}

}  // namespace mpm::study

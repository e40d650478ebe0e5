#include "study/summary_value.hpp"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "experiment/diagnostics.hpp"
#include "experiment/expression.hpp"

namespace mpm::study {
namespace {

std::string three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

const Json* value_at(const Json& summary, const std::string& path) {
  if (path.starts_with('/')) {
    try {
      return &summary.at(Json::json_pointer(path));
    } catch (const Json::exception&) {  // no such place, or no pointer
      return nullptr;
    }
  }
  const Json* value = &summary;
  std::stringstream names(path);
  for (std::string name; std::getline(names, name, '.');) {
    if (!value->is_object() || !value->contains(name)) return nullptr;
    value = &(*value)[name];
  }
  return value;
}

double number_at(const Json& summary, const std::string& path) {
  const Json* value = path.empty() ? nullptr : value_at(summary, path);
  return value && value->is_number() ? value->get<double>() : not_measured;
}

double evaluate(const Measure& measure, const Json& summary) {
  const double x = number_at(summary, measure.path);
  if (measure.formula.empty() || !std::isfinite(x)) return x;
  const VectorExpression::Term term = measure.formula;
  const VectorExpression formula(std::span(&term, 1), {"x", {}});
  return formula({x, 0, 0}, {x, 0, 0}, 0)[0];
}

bool all_hold(const std::vector<Bound>& bounds, const Json& summary, std::vector<std::string>& broken) {
  const std::size_t before = broken.size();
  for (const Bound& bound : bounds) {
    const double value = number_at(summary, bound.path);
    if (!std::isfinite(value))
      broken.push_back(bound.path + " is no number in summary.json");
    else if (bound.at_least && value < *bound.at_least)
      broken.push_back(bound.path + " is " + three_digits(value) + ", below " + number_text(*bound.at_least));
    else if (bound.at_most && value > *bound.at_most)
      broken.push_back(bound.path + " is " + three_digits(value) + ", above " + number_text(*bound.at_most));
  }
  return broken.size() == before;
}

std::vector<std::string> flags_in(const Json& summary) {
  const Json* flags = value_at(summary, "flags");
  return flags && flags->is_array() ? flags->get<std::vector<std::string>>() : std::vector<std::string>{};
}

}  // namespace mpm::study

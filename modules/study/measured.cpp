#include "study/measured.hpp"

#include <cmath>
#include <cstdio>

#include "experiment/diagnostics.hpp"
#include "experiment/expression.hpp"
#include "output/summary_value.hpp"

namespace mpm::study {
namespace {

std::string three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

double evaluate(const Study& study, const Measure& measure, const Combination& combination, const Json& summary) {
  const double x = output::number_at(summary, measure.path);
  if (measure.formula.empty() || !std::isfinite(x)) return x;
  const VectorExpression::Term term = measure.formula;
  try {
    const VectorExpression formula(std::span(&term, 1), scope_of_measures(study, combination.choices));
    return formula({x, 0, 0}, {x, 0, 0}, 0)[0];
  } catch (const ExpressionError&) {  // checked when read: without x, it has no finite value of these axes
    return not_measured;
  }
}

bool all_hold(const std::vector<Bound>& bounds, const Json& summary, std::vector<std::string>& broken) {
  const std::size_t before = broken.size();
  for (const Bound& bound : bounds) {
    const double value = output::number_at(summary, bound.path);
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
  const Json* flags = output::value_at(summary, "flags");
  return flags && flags->is_array() ? flags->get<std::vector<std::string>>() : std::vector<std::string>{};
}

}  // namespace mpm::study

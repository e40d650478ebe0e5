#include "study/analysis.hpp"

#include <algorithm>
#include <cmath>

namespace mpm::study {
namespace {

bool among(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Least squares of log y over log x; NaN when there are not two different x.
double slope(const std::vector<std::pair<double, double>>& points) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [x, y] : points) {
    const double u = std::log(x), v = std::log(y);
    sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  const double n = static_cast<double>(points.size()), spread = sxx - sx * sx / n;
  return points.size() > 1 && spread > 1e-12 ? (sxy - sx * sy / n) / spread : not_measured;
}

/// Whether a point comes before another. Points are compared by everything that is measured of them, so that the order
/// is the same on every call.
bool cheaper(const ParetoPoint& a, const ParetoPoint& b) {
  if (a.cost != b.cost) return a.cost < b.cost;
  if (a.error != b.error) return a.error < b.error;
  return a.result->combination.name < b.result->combination.name;
}

bool more_exact(const ParetoPoint& a, const ParetoPoint& b) {
  return a.error != b.error ? a.error < b.error : cheaper(a, b);
}

}  // namespace

const std::string& label_on(const Study& study, const Result& result, const std::string& axis) {
  const std::size_t k = study.axis_index(axis);
  return study.axes.at(k).choices.at(result.combination.choices.at(k)).label;
}

double number_on(const Study& study, const Result& result, const std::string& axis) {
  const std::size_t k = study.axis_index(axis);
  return study.axes.at(k).choices.at(result.combination.choices.at(k)).number.value_or(not_measured);
}

bool is_shown(const Study& study, const FigureRequest& figure, const Result& result) {
  return std::all_of(figure.where.begin(), figure.where.end(), [&](const auto& condition) {
    return among(condition.second, label_on(study, result, condition.first));
  });
}

std::vector<Group> group(const Results& results, const FigureRequest& figure, const std::vector<std::string>& within,
                         const std::vector<std::string>& named) {
  std::vector<Group> groups;
  std::vector<std::vector<std::size_t>> keys;
  const Study& study = results.study;
  for (const Result& result : results.results) {
    if (!is_shown(study, figure, result)) continue;
    std::vector<std::size_t> key = result.combination.choices;
    for (std::size_t k = 0; k < key.size(); ++k)
      if (among(within, study.axes[k].name)) key[k] = 0;
    const auto found = std::find(keys.begin(), keys.end(), key);
    const auto index = static_cast<std::size_t>(found - keys.begin());
    if (found == keys.end()) {
      keys.push_back(key);
      std::vector<std::string> without = within;
      without.insert(without.end(), named.begin(), named.end());
      for (std::size_t k = 0; k < study.axes.size(); ++k) {  // an axis on which all shown results agree tells nothing
        const auto same = std::find_if(figure.where.begin(), figure.where.end(),
                                       [&](const auto& where) { return where.first == study.axes[k].name; });
        if (study.axes[k].choices.size() == 1 || (same != figure.where.end() && same->second.size() == 1))
          without.push_back(study.axes[k].name);
      }
      groups.push_back({label_of(study, result.combination, without), {}});
    }
    groups[index].results.push_back(&result);
  }
  return groups;
}

std::vector<Order> observed_orders(const Results& results, const FigureRequest& figure) {
  std::vector<Order> orders;
  for (const Group& one : group(results, figure, {figure.x})) {
    std::vector<std::pair<double, double>> points;
    for (const Result* result : one.results) {
      const double x = number_on(results.study, *result, figure.x), y = result->value(figure.value);
      if (x > 0 && y > 0) points.emplace_back(x, y);
    }
    std::sort(points.begin(), points.end());
    Order order{one.label, points.size(), slope(points), not_measured, not_measured, not_measured};
    if (points.size() > 1) order.finest = slope({points[0], points[1]});
    if (!points.empty()) order.smallest_x = points[0].first, order.y = points[0].second;
    orders.push_back(order);
  }
  return orders;
}

std::vector<ParetoPoint> pareto(const Results& results, const FigureRequest& figure, const std::string& cost,
                                const std::string& error) {
  std::vector<ParetoPoint> points;
  for (const Result& result : results.results) {
    const ParetoPoint point{&result, result.value(cost), result.value(error), nullptr};
    const bool usable = result.outcome.status == Status::done && result.flags.empty() && std::isfinite(point.cost) &&
                        std::isfinite(point.error);
    if (usable && is_shown(results.study, figure, result)) points.push_back(point);
  }
  std::sort(points.begin(), points.end(), cheaper);
  for (ParetoPoint& point : points) {
    const auto better = std::find_if(points.begin(), points.end(), [&](const ParetoPoint& other) {
      const bool no_worse = other.cost <= point.cost && other.error <= point.error;
      return no_worse && (other.cost < point.cost || other.error < point.error);
    });
    if (better != points.end()) point.dominated_by = better->result;
  }
  return points;
}

Advice advise_for_error(const Results& results, const std::string& cost, double error) {
  Advice advice;
  advice.near = pareto(results, {}, cost, results.study.error);
  for (const ParetoPoint& point : advice.near)
    if (point.error <= error) advice.good.push_back(point);
  std::sort(advice.near.begin(), advice.near.end(), more_exact);
  return advice;
}

Advice advise_within(const Results& results, const std::string& limited, double limit) {
  Advice advice;
  advice.near = pareto(results, {}, limited, results.study.error);
  for (const ParetoPoint& point : advice.near)
    if (point.cost <= limit) advice.good.push_back(point);
  std::sort(advice.good.begin(), advice.good.end(), more_exact);
  return advice;
}

}  // namespace mpm::study

#pragma once
// What results say when they are laid side by side: groups, observed orders, Pareto fronts, advice.

#include <string>
#include <vector>

#include "study/results.hpp"

namespace mpm::study {

/// Results that differ in the named axes alone, in the order of the study.
struct Group {
  std::string label;  ///< labels of the results on the other axes
  std::vector<const Result*> results;
};

/// Whether the figure shows this result.
bool is_shown(const Study& study, const FigureRequest& figure, const Result& result);

/// The shown results, grouped by the axes that are not in `within`. `named`: axes that the labels leave out too.
std::vector<Group> group(const Results& results, const FigureRequest& figure, const std::vector<std::string>& within,
                         const std::vector<std::string>& named = {});

/// Label of a result on one axis.
const std::string& label_on(const Study& study, const Result& result, const std::string& axis);
/// The number of a result on one axis; NaN when it has none.
double number_on(const Study& study, const Result& result, const std::string& axis);

/// An observed order: the slope of log y over log x.
struct Order {
  std::string label;
  std::size_t points = 0;        ///< finished runs with a positive value
  double fitted = 0;             ///< least squares over all points; NaN below two
  double finest = 0;             ///< slope between the two smallest x; NaN below two points
  double smallest_x = 0, y = 0;  ///< numbers of the finest run
};

std::vector<Order> observed_orders(const Results& results, const FigureRequest& figure);

/// A point of error against cost.
struct ParetoPoint {
  const Result* result = nullptr;
  double cost = 0, error = 0;
  const Result* dominated_by = nullptr;  ///< the cheapest that is no worse in both and better in one; null on the front
};

/// The shown, finished and unflagged results that have both, by cost.
std::vector<ParetoPoint> pareto(const Results& results, const FigureRequest& figure, const std::string& cost,
                                const std::string& error);

/// The combinations to take, best first.
struct Advice {
  std::vector<ParetoPoint> good;  ///< reach the target: the cheapest first, or the most exact within the cost
  std::vector<ParetoPoint> near;  ///< where none reaches it: those that come nearest
};

/// The cheapest combinations that reach `error`.
Advice advise_for_error(const Results& results, const std::string& cost, double error);
/// The most exact combinations whose `limited` (a measure) does not exceed `limit`.
Advice advise_within(const Results& results, const std::string& limited, double limit);

}  // namespace mpm::study

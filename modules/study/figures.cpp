#include "study/figures.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/expression.hpp"
#include "render/plot.hpp"
#include "study/analysis.hpp"
#include "study/figure_parts.hpp"
#include "support/csv.hpp"

namespace mpm::study {
namespace {

namespace fs = std::filesystem;
using render::Plot;
using render::Series;
using render::SeriesKind;

/// Whether a logarithmic axis shows all and tells more than a linear one.
bool spans_a_decade(const std::vector<double>& values) {
  if (values.empty()) return false;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *least > 0 && *most >= 10 * *least;
}

/// The series of one value against the numbers of an axis.
Series line_of(const Results& results, const FigureRequest& figure, const Group& one) {
  std::vector<std::pair<double, double>> points;
  for (const Result* result : one.results)
    if (const double y = result->value(figure.value); std::isfinite(y))
      points.emplace_back(number_on(results.study, *result, figure.x), y);
  std::sort(points.begin(), points.end());
  Series series;
  series.label = one.label.empty() ? results.study.measure(figure.value)->label : one.label;
  for (const auto& [x, y] : points) {
    series.x.push_back(x);
    series.y.push_back(y);
  }
  return series;
}

/// The series of the figure's formula over the numbers of its axis.
Series exact_line(const Results& results, const FigureRequest& figure) {
  constexpr int intervals = 120;
  const VectorExpression::Term term = figure.exact;
  const VectorExpression formula(std::span(&term, 1), {"x", {}});
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Choice& choice : results.study.axis(figure.x)->choices) {
    low = std::min(low, *choice.number);
    high = std::max(high, *choice.number);
  }
  Series series;
  series.label = figure.exact_label;
  series.kind = SeriesKind::exact;
  for (int k = 0; k <= intervals; ++k) {
    const double share = static_cast<double>(k) / intervals;
    const double x = figure.log_x ? low * std::pow(high / low, share) : low + (high - low) * share;
    series.x.push_back(x);
    series.y.push_back(formula({x, 0, 0}, {x, 0, 0}, 0)[0]);
  }
  return series;
}

/// The request for one panel: the figure with the results of that panel alone.
FigureRequest for_panel(const FigureRequest& figure, const std::string& label) {
  FigureRequest panel = figure;
  std::erase_if(panel.where, [&](const auto& condition) { return condition.first == figure.panels; });
  panel.where.emplace_back(figure.panels, std::vector<std::string>{label});
  return panel;
}

/// Labels of the panels that hold a result.
std::vector<std::string> panels_of(const Results& results, const FigureRequest& figure) {
  std::vector<std::string> labels;
  for (const Choice& choice : results.study.axis(figure.panels)->choices)
    for (const Result& result : results.results)
      if (is_shown(results.study, figure, result) && label_on(results.study, result, figure.panels) == choice.label) {
        labels.push_back(choice.label);
        break;
      }
  return labels;
}

/// Draws a plot, or its panels when the figure has an axis of panels. `series_of` makes the series of one panel.
template <class SeriesOf>
void draw(const Results& results, const FigureRequest& figure, Plot plot, const fs::path& stem, SeriesOf series_of) {
  if (figure.panels.empty()) {
    plot.series = series_of(figure);
    return render::write_figure(plot, stem);
  }
  render::Multiples multiples;
  multiples.title = plot.title;
  multiples.x_label = plot.x_label;
  multiples.y_label = plot.y_label;
  multiples.footnote = plot.footnote;
  multiples.log_x = plot.log_x;
  multiples.log_y = plot.log_y;
  multiples.slope_triangles = plot.slope_triangles;
  multiples.pareto_front = plot.pareto_front;
  const std::string axis = results.study.axis(figure.panels)->label;
  for (const std::string& label : panels_of(results, figure))
    multiples.panels.push_back({axis + ": " + label, series_of(for_panel(figure, label))});
  render::write_figure(multiples, stem);
}

void draw_lines(const Results& results, const FigureRequest& figure, const fs::path& stem) {
  const Study& study = results.study;
  const Measure& measure = *study.measure(figure.value);
  const Axis& x = *study.axis(figure.x);
  const bool convergence = figure.type == FigureType::convergence;
  Plot plot;
  plot.title = title_of(results, figure);
  plot.x_label = x.title();
  plot.y_label = measure.title();
  plot.footnote = footnote(results, figure, true);
  plot.log_x = figure.log_x || convergence;
  plot.log_y = figure.log_y || convergence;
  plot.slope_triangles = convergence;
  draw(results, figure, plot, stem, [&](const FigureRequest& one) {
    std::vector<Series> series;
    std::vector<std::string> within{figure.x};
    for (const Group& alone : group(results, one, within)) series.push_back(line_of(results, figure, alone));
    std::erase_if(series, [](const Series& line) { return line.x.empty(); });
    if (!figure.exact.empty()) series.push_back(exact_line(results, figure));
    return series;
  });
}

/// The axis whose values have colours: the one that is named, else the first with several.
std::string axis_of_series(const Study& study, const FigureRequest& figure) {
  if (!figure.series.empty()) return figure.series;
  for (const Axis& axis : study.axes)
    if (axis.choices.size() > 1 && axis.name != figure.panels) return axis.name;
  return "";
}

/// The points of the front that have room for their names, the most exact first.
std::vector<const Result*> with_room(const std::vector<ParetoPoint>& points, const Plot& plot) {
  const auto place = [](double value, bool is_log) { return is_log ? std::log(value) : value; };
  double lo[2] = {1e300, 1e300}, hi[2] = {-1e300, -1e300};
  const auto at = [&](const ParetoPoint& point, int axis) {
    return axis == 0 ? place(point.cost, plot.log_x) : place(point.error, plot.log_y);
  };
  for (const ParetoPoint& point : points)
    for (const int axis : {0, 1}) {
      lo[axis] = std::min(lo[axis], at(point, axis));
      hi[axis] = std::max(hi[axis], at(point, axis));
    }
  std::vector<const ParetoPoint*> named;
  for (auto point = points.rbegin(); point != points.rend(); ++point) {
    const bool is_close = std::any_of(named.begin(), named.end(), [&](const ParetoPoint* other) {
      return std::abs(at(*other, 0) - at(*point, 0)) <= 0.2 * (hi[0] - lo[0]) &&
             std::abs(at(*other, 1) - at(*point, 1)) <= 0.05 * (hi[1] - lo[1]);
    });
    if (!point->dominated_by && !is_close) named.push_back(&*point);
  }
  std::vector<const Result*> results;
  for (const ParetoPoint* point : named) results.push_back(point->result);
  return results;
}

/// What stands beside the points of a front: the rest of their names, where there is room; in a crowd their numbers by
/// cost; in a crowd of panels nothing.
enum class FrontLabels { names, numbers, none };

FrontLabels labels_for(const FigureRequest& figure, std::size_t points) {
  constexpr std::size_t most_beside_names = 100;
  if (points <= most_beside_names) return FrontLabels::names;
  return figure.panels.empty() ? FrontLabels::numbers : FrontLabels::none;
}

/// The key to a front's numbers: "1: linear, pic · 2: gimp, flip".
std::string key_of(const Study& study, const std::vector<ParetoPoint>& points,
                   const std::vector<std::string>& without) {
  std::string key;
  int number = 0;
  for (const ParetoPoint& point : points)
    if (!point.dominated_by)
      key += (key.empty() ? "" : " · ") + std::to_string(++number) + ":\u00a0" +
             label_of(study, point.result->combination, without);
  return key;
}

/// Axes that tell nothing of a point: those with a single value, and the one of the panels.
std::vector<std::string> axes_not_in_names(const Study& study, const FigureRequest& figure) {
  std::vector<std::string> without{figure.panels};
  for (const Axis& axis : study.axes)
    if (axis.choices.size() == 1) without.push_back(axis.name);
  return without;
}

/// The axes not in names and those that the figure holds fixed, which its title names.
std::vector<std::string> axes_not_in_labels(const Study& study, const FigureRequest& figure) {
  std::vector<std::string> without = axes_not_in_names(study, figure);
  for (const auto& [axis, labels] : figure.where)
    if (labels.size() == 1) without.push_back(axis);
  return without;
}

/// The series of points by colour; what stands beside those of the front leaves out what the colour says.
std::vector<Series> points_by_series(const Results& results, const FigureRequest& figure, const std::string& cost,
                                     const Plot& plot, FrontLabels labels) {
  const Study& study = results.study;
  const std::string by = axis_of_series(study, figure);
  const std::vector<std::string> not_in_names = axes_not_in_names(study, figure);
  std::vector<std::string> without = axes_not_in_labels(study, figure);
  without.push_back(by);
  std::vector<Series> all;
  const auto add_to = [&](const std::string& label) -> Series& {
    for (Series& series : all)
      if (series.label == label) return series;
    all.push_back({label, {}, {}, {}, SeriesKind::point, {}});
    return all.back();
  };
  if (!by.empty())  // series follow the order of the axis, the same in every panel
    for (const Choice& choice : study.axis(by)->choices) add_to(choice.label);
  const auto points = pareto(results, figure, cost, figure.value);
  const auto named = labels == FrontLabels::names ? with_room(points, plot) : std::vector<const Result*>();
  int number = 0;
  for (const ParetoPoint& point : points) {
    const auto name = [&](const Result* result) { return label_of(study, result->combination, not_in_names); };
    Series& series = add_to(by.empty() ? study.title : label_on(study, *point.result, by));
    series.x.push_back(point.cost);
    series.y.push_back(point.error);
    series.point_names.push_back(name(point.result));
    series.dominated_by.push_back(point.dominated_by ? name(point.dominated_by) : "");
    std::string label;
    if (std::find(named.begin(), named.end(), point.result) != named.end())
      label = label_of(study, point.result->combination, without);
    else if (labels == FrontLabels::numbers && !point.dominated_by)
      label = std::to_string(++number);
    series.point_labels.push_back(label);
  }
  std::erase_if(all, [](const Series& series) { return series.x.empty(); });
  return all;
}

void draw_pareto(const Results& results, const FigureRequest& figure, const std::string& cost, const fs::path& stem) {
  const Measure &x = *results.study.measure(cost), &y = *results.study.measure(figure.value);
  const auto points = pareto(results, figure, cost, figure.value);
  const FrontLabels labels = labels_for(figure, points.size());
  std::vector<double> costs, errors;
  for (const ParetoPoint& point : points) {
    costs.push_back(point.cost);
    errors.push_back(point.error);
  }
  if (costs.empty()) return;  // a measure that no summary has, such as a count of operations
  Plot plot;
  plot.title = title_of(results, figure);
  plot.x_label = x.title();
  plot.y_label = y.title();
  plot.footnote = footnote(results, figure, true) +
                  (figure.panels.empty() ? " · pale: dominated" : " · pale: dominated in its panel");
  if (labels == FrontLabels::numbers)
    plot.footnote += " · front: " + key_of(results.study, points, axes_not_in_labels(results.study, figure));
  plot.log_x = spans_a_decade(costs);
  plot.log_y = spans_a_decade(errors);
  plot.pareto_front = true;
  draw(results, figure, plot, stem,
       [&](const FigureRequest& one) { return points_by_series(results, one, cost, plot, labels); });
}

std::string unit_in(const std::string& header) {
  const auto at = header.find(" (");
  return at == std::string::npos ? "" : header.substr(at);
}

/// The first entry, each `every`th after it, and the last.
std::vector<double> taken_every(const std::vector<double>& values, int every) {
  std::vector<double> taken;
  for (std::size_t row = 0; row < values.size(); ++row)
    if (row % static_cast<std::size_t>(every) == 0 || row + 1 == values.size()) taken.push_back(values[row]);
  return taken;
}

void draw_curves(const Results& results, const FigureRequest& figure, const fs::path& folder, const fs::path& stem) {
  Plot plot;
  plot.title = title_of(results, figure);
  plot.x_label = "time t (s)";
  plot.y_label = figure.column;
  plot.log_y = figure.log_y;
  std::size_t missing = 0;
  std::vector<std::string> without;
  if (!figure.panels.empty()) without.push_back(figure.panels);
  const auto series_of = [&](const FigureRequest& one) {
    std::vector<Series> all;
    for (const Group& alone : group(results, one, {}, without)) {
      const fs::path file = folder / alone.results.front()->folder / "metrics.csv";
      std::error_code ignored;
      if (alone.results.front()->folder.empty() || !fs::is_regular_file(file, ignored)) continue;
      const support::Table table = support::read_csv(file);
      const auto *time = table.find("time"), *column = table.find(figure.column);
      if (!time || !column) {
        ++missing;
        continue;
      }
      if (figure.over_initial)
        plot.y_label = figure.column + " over its initial value";
      else
        for (const std::string& header : table.header)
          if (header.substr(0, header.find(" (")) == figure.column) plot.y_label = figure.column + unit_in(header);
      std::vector<double> values = taken_every(*column, figure.every);
      if (figure.over_initial && !values.empty())
        for (const double first = values.front(); double& value : values) value /= first;
      all.push_back({alone.label, taken_every(*time, figure.every), std::move(values), {}, SeriesKind::computed, {}});
    }
    return all;
  };
  series_of(figure);  // this call finds the unit
  if (missing > 0) throw std::runtime_error(std::to_string(missing) + " runs have no column \"" + figure.column + "\"");
  plot.footnote = footnote(results, figure, false);
  draw(results, figure, plot, stem, series_of);
}

void draw_one(const Results& results, const FigureRequest& figure, const fs::path& folder) {
  const fs::path stem = folder / "figures" / figure.name;
  switch (figure.type) {
    case FigureType::convergence:
    case FigureType::small_multiples:
      return draw_lines(results, figure, stem);
    case FigureType::pareto:
      for (const std::string& cost : figure.costs)
        draw_pareto(results, figure, cost, fs::path(stem.string() + "_" + cost));
      return;
    case FigureType::heat_map:
      return draw_heat_maps(results, figure, stem);
    case FigureType::curves:
      return draw_curves(results, figure, folder, stem);
    case FigureType::outcome_map:
      return draw_outcome_map(results, figure, stem);
  }
}

}  // namespace

std::string count_of(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what;
}

std::string footnote(const Results& results, const FigureRequest& figure, bool finished_only) {
  std::size_t shown = 0, missing = 0;
  for (const Result& result : results.results)
    if (is_shown(results.study, figure, result))
      (!finished_only || is_finished(result.outcome.status) ? shown : missing)++;
  std::string text =
      "study " + results.study.file.filename().string() + " · " + count_of(shown, shown == 1 ? "run" : "runs");
  if (missing > 0) text += " · " + count_of(missing, "not shown: refused, stopped or not run");
  return text;
}

std::string title_of(const Results& results, const FigureRequest& figure) {
  return figure.title.empty() ? results.study.title : figure.title;
}

std::string outcome_words(const Result& result) {
  switch (result.outcome.status) {
    case Status::done:
      break;
    case Status::failed:
      return result.outcome.cause.empty() ? "stopped" : "stopped: " + result.outcome.cause;
    default:
      return name_of(result.outcome.status);
  }
  if (result.flags.empty()) return "bounded";
  return result.flags.front().starts_with("energy") ? "gained energy" : "volume ratio out of range";
}

std::vector<std::string> draw_figures(const Results& results, const fs::path& folder) {
  std::vector<std::string> troubles;
  fs::create_directories(folder / "figures");
  for (const FigureRequest& figure : results.study.figures) {
    try {
      draw_one(results, figure, folder);
    } catch (const std::exception& error) {
      troubles.push_back("figure \"" + figure.name + "\": " + error.what());
    }
  }
  return troubles;
}

}  // namespace mpm::study

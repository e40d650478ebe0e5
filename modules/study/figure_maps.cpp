#include <algorithm>
#include <array>
#include <cmath>

#include "render/plot.hpp"
#include "study/analysis.hpp"
#include "study/figure_parts.hpp"
#include "study/figures.hpp"

namespace mpm::study {
namespace {

namespace fs = std::filesystem;

/// The words that tell one heat map of a figure from the next: "filter none, grid 32 cells".
std::string layer_words(const Study& study, const FigureRequest& figure, const Result& result) {
  std::string words;
  for (const Axis& axis : study.axes) {
    const bool fixed = std::any_of(figure.where.begin(), figure.where.end(), [&](const auto& condition) {
      return condition.first == axis.name && condition.second.size() == 1;
    });
    if (axis.name == figure.x || axis.name == figure.y || axis.name == figure.over || axis.choices.size() == 1 || fixed)
      continue;
    words += (words.empty() ? "" : ", ") + axis.label + " " + label_on(study, result, axis.name);
  }
  return words;
}

/// A number of a heat map and the words beside it.
struct Cell {
  double value = not_measured;
  std::string note;
};

Cell cell_of(const Study& study, const FigureRequest& figure, const Result& result) {
  Cell cell{result.value(figure.value), ""};
  if (!std::isfinite(cell.value)) {
    cell.note = outcome_words(result);
    if (cell.note == "bounded") cell.note = "no value";  // the run came to its end without such a number
  }
  if (!result.flags.empty()) cell.note = "!";
  if (study.bisection && result.outcome.status == Status::failed) cell.note = "none";
  if (study.bisection && figure.value == critical_measure && result.stable && !result.unstable) cell.note = "or more";
  return cell;
}

/// Signs of what became of runs that are not bounded, short enough for a cell; the last is for all else.
constexpr std::pair<const char*, const char*> signs[] = {
    {"gained energy", "+"}, {"volume ratio out of range", "J"}, {"stopped", "×"}, {"neither", "?"}};

/// The number of bounded runs, and what became of the others: "7" and "+2 ×1".
Cell bounded_of(const std::vector<const Result*>& runs) {
  std::array<int, std::size(signs)> others{};
  int bounded = 0;
  for (const Result* run : runs) {
    const std::string words = outcome_words(*run);
    const auto* sign = std::find_if(std::begin(signs), std::end(signs) - 1,
                                    [&](const auto& known) { return words.starts_with(known.first); });
    if (words == "bounded")
      ++bounded;
    else
      ++others[static_cast<std::size_t>(sign - std::begin(signs))];
  }
  const bool refused =
      std::all_of(runs.begin(), runs.end(), [](const Result* run) { return run->outcome.status == Status::refused; });
  if (refused) return {not_measured, "refused"};
  Cell cell{static_cast<double>(bounded), ""};
  for (std::size_t k = 0; k < others.size(); ++k)
    if (others[k] > 0)
      cell.note += (cell.note.empty() ? "" : " ") + std::string(signs[k].second) + std::to_string(others[k]);
  return cell;
}

bool has_sign(const std::string& note, const char* sign) {
  return note.find(sign) != std::string::npos;
}

/// The cell of all runs that share it.
Cell cell_of(const Study& study, const FigureRequest& figure, const std::vector<const Result*>& runs) {
  if (figure.take == Take::bounded) return bounded_of(runs);
  Cell taken;
  for (const Result* run : runs) {
    const Cell cell = cell_of(study, figure, *run);
    const bool better = figure.take == Take::smallest ? cell.value < taken.value : cell.value > taken.value;
    if (better || std::isnan(taken.value)) taken = cell;
  }
  // A number taken from some of the runs says how many are not as they should be.
  if (!figure.over.empty() && !study.bisection && std::isfinite(taken.value)) taken.note = bounded_of(runs).note;
  return taken;
}

std::string value_label_of(const Study& study, const FigureRequest& figure, std::size_t runs_a_cell) {
  if (figure.take == Take::bounded) return "runs bounded, of " + std::to_string(runs_a_cell);
  const std::string label = study.measure(figure.value)->title();
  if (figure.over.empty()) return label;
  return (figure.take == Take::smallest ? "smallest of " : "largest of ") + std::to_string(runs_a_cell) + ": " + label;
}

void draw_heat_map(const Results& results, const FigureRequest& figure, const fs::path& stem, const Group& layer,
                   bool alone) {
  const Study& study = results.study;
  const Axis &x = *study.axis(figure.x), &y = *study.axis(figure.y);
  render::HeatMap map;
  map.title = title_of(results, figure) + (alone ? "" : ", " + layer_words(study, figure, *layer.results.front()));
  map.x_label = x.title();
  map.y_label = y.title();
  map.footnote = "study " + study.file.filename().string() + " · " + count_of(layer.results.size(), "runs");
  map.log_scale = figure.log_x;
  const auto labels_shown = [&](const Axis& axis) {
    std::vector<std::string> labels;
    for (const Choice& choice : axis.choices)
      if (std::any_of(layer.results.begin(), layer.results.end(),
                      [&](const Result* r) { return label_on(study, *r, axis.name) == choice.label; }))
        labels.push_back(choice.label);
    return labels;
  };
  map.x_names = labels_shown(x);
  map.y_names = labels_shown(y);
  std::vector<std::vector<const Result*>> cells(map.x_names.size() * map.y_names.size());
  for (const Result* result : layer.results) {
    const auto column = std::find(map.x_names.begin(), map.x_names.end(), label_on(study, *result, figure.x));
    const auto row = std::find(map.y_names.begin(), map.y_names.end(), label_on(study, *result, figure.y));
    cells[static_cast<std::size_t>((row - map.y_names.begin()) * static_cast<std::ptrdiff_t>(map.x_names.size()) +
                                   (column - map.x_names.begin()))]
        .push_back(result);
  }
  std::size_t most = 0;
  bool has_flags = false;
  for (const auto& runs : cells) {
    const Cell cell = cell_of(study, figure, runs);
    map.values.push_back(cell.value);
    map.notes.push_back(cell.note);
    most = std::max(most, runs.size());
    has_flags |= cell.note == "!";
  }
  map.value_label = value_label_of(study, figure, most);
  if (has_flags) map.footnote += " · !: broke a limit";
  if (std::find(map.notes.begin(), map.notes.end(), "none") != map.notes.end())
    map.footnote += " · none: unstable from the beginning";
  if (!figure.over.empty())
    for (const auto& known : signs)
      if (std::any_of(map.notes.begin(), map.notes.end(),
                      [&](const std::string& note) { return has_sign(note, known.second); }))
        map.footnote += std::string(" · ") + known.second + ": " + known.first;
  render::write_figure(map, stem);
}

/// Names of what can become of a run. The order gives the colours: the common ones have the same in every map, and what
/// stopped does not look good.
std::vector<std::string> outcomes_of(const std::vector<Group>& rows) {
  std::vector<std::string> seen;
  for (const Group& row : rows)
    for (const Result* result : row.results)
      if (result->outcome.status != Status::not_run && result->outcome.status != Status::interrupted)
        seen.push_back(outcome_words(*result));
  const auto stopped =
      std::find_if(seen.begin(), seen.end(), [](const std::string& word) { return word.starts_with("stopped"); });
  std::vector<std::string> words{"bounded", stopped == seen.end() ? "stopped" : *stopped, "refused", "gained energy",
                                 "volume ratio out of range"};
  for (const std::string& word : seen)
    if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  return words;
}

}  // namespace

void draw_heat_maps(const Results& results, const FigureRequest& figure, const fs::path& stem) {
  const auto layers = group(results, figure, {figure.x, figure.y, figure.over});
  for (std::size_t k = 0; k < layers.size(); ++k)
    draw_heat_map(results, figure, layers.size() == 1 ? stem : fs::path(stem.string() + "_" + std::to_string(k + 1)),
                  layers[k], layers.size() == 1);
}

void draw_outcome_map(const Results& results, const FigureRequest& figure, const fs::path& stem) {
  const Study& study = results.study;
  render::OutcomeMap map;
  map.title = title_of(results, figure);
  map.x_label = study.axis(figure.x)->title();
  map.footnote = footnote(results, figure, false);
  map.log_x = figure.log_x;
  const auto rows = group(results, figure, {figure.x});
  for (const Group& row : rows)
    for (const Result* result : row.results) map.x.push_back(number_on(study, *result, figure.x));
  std::sort(map.x.begin(), map.x.end());
  map.x.erase(std::unique(map.x.begin(), map.x.end()), map.x.end());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    map.y.push_back(static_cast<double>(k + 1));
    map.y_names.push_back(rows[rows.size() - 1 - k].label);  // the first row on top
  }
  map.outcome.assign(map.x.size() * map.y.size(), -1);
  map.outcomes = outcomes_of(rows);
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (const Result* result : rows[k].results) {
      const auto known = std::find(map.outcomes.begin(), map.outcomes.end(), outcome_words(*result));
      if (known == map.outcomes.end()) continue;  // not run yet
      const auto column = std::find(map.x.begin(), map.x.end(), number_on(study, *result, figure.x)) - map.x.begin();
      const std::size_t row = rows.size() - 1 - k;
      map.outcome[row * map.x.size() + static_cast<std::size_t>(column)] =
          static_cast<int>(known - map.outcomes.begin());
    }
  render::write_figure(map, stem);
}

}  // namespace mpm::study

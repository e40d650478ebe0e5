#include "drive/results.hpp"

#include <algorithm>
#include <cmath>

#include "drive/sections.hpp"
#include "support/csv.hpp"

namespace mpm::drive {
namespace {

using Json = nlohmann::ordered_json;
using render::Plot;
using render::Series;

const std::vector<std::string>& stress_names() {
  static const std::vector<std::string> names{"xx", "yy", "zz", "yz", "xz", "xy"};  // the order of Sym<3>
  return names;
}

/// The components of stress that can be other than zero.
std::vector<int> stress_indices(int dimension) {
  return dimension == 2 ? std::vector<int>{0, 1, 2, 5} : std::vector<int>{0, 1, 2, 3, 4, 5};
}

std::string unit_text(const std::string& unit) {
  return unit.empty() ? "" : " (" + unit + ")";
}

/// The components of F less the identity, named and with the change of each over the path.
double range_of(const Course& course, int i, int j) {
  double low = INFINITY, high = -INFINITY;
  for (const Row& row : course.rows) low = std::min(low, row.F(i, j)), high = std::max(high, row.F(i, j));
  return high - low;
}

template <class Value>
Json extremes(const Course& course, Value value) {
  double low = INFINITY, high = -INFINITY;
  for (const Row& row : course.rows) low = std::min(low, value(row)), high = std::max(high, value(row));
  return {{"smallest", low}, {"largest", high}};
}

Json state_of(const DriveExperiment& path, const Course& course, const Row& row) {
  Json json{{"time", row.time}};
  for (const std::string& name : components_of_matrix(path.experiment.dimension))
    json["deformation_gradient"][name] = row.F(name[0] - 'x', name[1] - 'x');
  json["volume_ratio"] = row.response.volume_ratio;
  for (const int k : stress_indices(path.experiment.dimension))
    json["stress"][stress_names()[k]] = row.response.kirchhoff.s[k] / row.response.volume_ratio;
  json["von_mises_stress"] = von_mises_stress(row.response);
  json["pressure"] = pressure(row.response);
  json["stored_energy"] = row.response.stored;
  json["dissipated_energy"] = row.dissipated;
  json["work"] = row.work;
  json["wave_speed"] = row.response.wave_speed;
  for (std::size_t k = 0; k < course.columns.size(); ++k) {
    std::string name = course.columns[k].name;
    std::replace(name.begin(), name.end(), ' ', '_');
    json["state"][name] = row.state[k];
  }
  return json;
}

/// Curves of the stresses that are not zero all along, over x; equal ones are one curve with all their names.
std::vector<Series> stress_curves(const DriveExperiment& path, const Course& course, const std::vector<double>& x) {
  std::vector<Series> curves;
  double largest = 0;
  for (const Row& row : course.rows)
    for (const double tau : row.response.kirchhoff.s)
      largest = std::max(largest, std::abs(tau / row.response.volume_ratio));
  for (const int k : stress_indices(path.experiment.dimension)) {
    Series curve{stress_names()[k], x, {}};
    for (const Row& row : course.rows) curve.y.push_back(row.response.kirchhoff.s[k] / row.response.volume_ratio);
    const auto near = [&](double a, double b) { return std::abs(a - b) <= 1e-9 * largest; };
    if (std::all_of(curve.y.begin(), curve.y.end(), [&](double y) { return near(y, 0); })) continue;
    const auto same = std::find_if(curves.begin(), curves.end(), [&](const Series& other) {
      return std::equal(curve.y.begin(), curve.y.end(), other.y.begin(), near);
    });
    if (same == curves.end())
      curves.push_back(std::move(curve));
    else
      same->label += ", " + curve.label;
  }
  return curves;
}

/// The part of a curve that belongs to a stage, with the point where the stage began: a loop's ways can be told apart.
Series part_of(const Series& curve, const Course& course, int stage) {
  Series part{curve.label};
  for (std::size_t k = 1; k < course.rows.size(); ++k) {
    if (course.rows[k].stage != stage) continue;
    if (part.x.empty()) part.x.push_back(curve.x[k - 1]), part.y.push_back(curve.y[k - 1]);
    part.x.push_back(curve.x[k]), part.y.push_back(curve.y[k]);
  }
  return part;
}

std::vector<double> times(const Course& course) {
  std::vector<double> t;
  for (const Row& row : course.rows) t.push_back(row.time);
  return t;
}

Plot plot_of(const DriveExperiment& path, const std::string& what, const std::string& footnote) {
  Plot plot;
  const std::string& title = path.experiment.title;
  plot.title = what + (title.empty() ? "" : ": " + title);
  plot.footnote = footnote;
  return plot;
}

}  // namespace

double pressure(const Response& response) {
  return -trace(response.kirchhoff) / (3 * response.volume_ratio);
}

double von_mises_stress(const Response& response) {
  return std::sqrt(1.5 * squared_norm(deviator(response.kirchhoff))) / std::abs(response.volume_ratio);
}

double residual(const Course& course, const Row& row) {
  return row.work - (row.response.stored - course.rows.front().response.stored) - row.dissipated;
}

double turnover(const Course& course) {
  double sum = 0;
  for (std::size_t k = 1; k < course.rows.size(); ++k) sum += std::abs(course.rows[k].work - course.rows[k - 1].work);
  return sum;
}

std::vector<std::string> headings(const DriveExperiment& path, const Course& course) {
  std::vector<std::string> names{"time (s)", "step", "stage"};
  for (const std::string& name : components_of_matrix(path.experiment.dimension))
    names.push_back("deformation gradient " + name);
  names.emplace_back("volume ratio");
  for (const int k : stress_indices(path.experiment.dimension))
    names.push_back("stress " + stress_names()[k] + " (Pa)");
  for (const char* name : {"von Mises stress (Pa)", "pressure (Pa)", "stored energy (J/m^3)",
                           "dissipated energy (J/m^3)", "work (J/m^3)", "ledger residual (J/m^3)", "wave speed (m/s)"})
    names.emplace_back(name);
  for (const StateColumn& column : course.columns) {
    std::string name = column.name;
    std::replace(name.begin(), name.end(), '_', ' ');
    names.push_back("state " + name + unit_text(column.unit));
  }
  return names;
}

std::vector<double> numbers(const DriveExperiment& path, const Course& course, const Row& row) {
  std::vector<double> values{row.time, static_cast<double>(row.step), static_cast<double>(row.stage + 1)};
  for (const std::string& name : components_of_matrix(path.experiment.dimension))
    values.push_back(row.F(name[0] - 'x', name[1] - 'x'));
  values.push_back(row.response.volume_ratio);
  for (const int k : stress_indices(path.experiment.dimension))
    values.push_back(row.response.kirchhoff.s[k] / row.response.volume_ratio);
  for (const double value : {von_mises_stress(row.response), pressure(row.response), row.response.stored,
                             row.dissipated, row.work, residual(course, row), row.response.wave_speed})
    values.push_back(value);
  values.insert(values.end(), row.state.begin(), row.state.end());
  return values;
}

std::pair<int, int> driven_component(const DriveExperiment& path, const Course& course) {
  std::pair<int, int> best{0, 0};
  double most = 1e-12;
  for (const Stage& stage : path.stages)
    for (const Prescribed& imposed : stage.imposed)
      if (const double range = range_of(course, imposed.i, imposed.j); range > most)
        best = {imposed.i, imposed.j}, most = range;
  if (most > 1e-12) return best;
  for (int i = 0; i < path.experiment.dimension; ++i)
    for (int j = 0; j < path.experiment.dimension; ++j)
      if (const double range = range_of(course, i, j); range > most) best = {i, j}, most = range;
  return best;
}

Json summary_of(const DriveExperiment& path, const Course& course) {
  const Row& end = course.rows.back();
  Json json{{"steps", course.rows.size() - 1},
            {"simulated_time", end.time},
            {"newton_iterations", course.iterations},
            {"stress",
             {{"von_mises", extremes(course, [](const Row& row) { return von_mises_stress(row.response); })},
              {"pressure", extremes(course, [](const Row& row) { return pressure(row.response); })}}},
            {"volume_ratio", extremes(course, [](const Row& row) { return row.response.volume_ratio; })}};
  Json& energy = json["energy_per_volume"];
  energy = {{"stored", end.response.stored - course.rows.front().response.stored},
            {"dissipated", end.dissipated},
            {"work", end.work},
            {"residual", residual(course, end)}};
  if (const double all = turnover(course); all > 0) energy["residual_over_turnover"] = residual(course, end) / all;
  for (std::size_t k = 0; k < course.rows.size(); ++k)
    if (k > 0 && (k + 1 == course.rows.size() || course.rows[k + 1].stage != course.rows[k].stage))
      json["stages"][path.stages[course.rows[k].stage].name] = state_of(path, course, course.rows[k]);
  return json;
}

void write_table(const DriveExperiment& path, const Course& course, const std::filesystem::path& file) {
  support::Table table;
  table.header = headings(path, course);
  table.columns.resize(table.header.size());
  for (const Row& row : course.rows) {
    const std::vector<double> values = numbers(path, course, row);
    for (std::size_t k = 0; k < values.size(); ++k) table.columns[k].push_back(values[k]);
  }
  support::write_csv(file, table);
}

Plot stress_figure(const DriveExperiment& path, const Course& course, const std::string& footnote) {
  const auto [i, j] = driven_component(path, course);
  Plot plot = plot_of(path, "Stress against strain", footnote);
  const std::string name{'F', "xyz"[i], "xyz"[j]};
  plot.x_label = "displacement gradient " + name + (i == j ? " − 1" : "");
  plot.y_label = "Cauchy stress (Pa)";
  std::vector<double> x;
  for (const Row& row : course.rows) x.push_back(row.F(i, j) - (i == j ? 1 : 0));
  const std::vector<Series> curves = stress_curves(path, course, x);
  constexpr std::size_t most_curves = 8;
  if (path.stages.size() * curves.size() > most_curves)
    plot.series = curves;
  else
    for (std::size_t k = 0; k < path.stages.size(); ++k)
      for (const Series& curve : curves)
        if (Series part = part_of(curve, course, static_cast<int>(k)); part.x.size() > 1) {
          if (path.stages.size() > 1) part.label += " " + path.stages[k].name;
          plot.series.push_back(std::move(part));
        }
  return plot;
}

Plot stress_over_time_figure(const DriveExperiment& path, const Course& course, const std::string& footnote) {
  Plot plot = plot_of(path, "Stress over time", footnote);
  plot.x_label = "time t (s)";
  plot.y_label = "Cauchy stress (Pa)";
  plot.series = stress_curves(path, course, times(course));
  return plot;
}

Plot energy_figure(const DriveExperiment& path, const Course& course, const std::string& footnote) {
  Plot plot = plot_of(path, "Energy per volume", footnote);
  plot.x_label = "time t (s)";
  plot.y_label = "energy since the start (J/m³)";
  Series work{"work", times(course), {}}, stored{"stored", work.x, {}}, dissipated{"dissipated", work.x, {}},
      rest{"residual", work.x, {}};
  for (const Row& row : course.rows) {
    work.y.push_back(row.work);
    stored.y.push_back(row.response.stored - course.rows.front().response.stored);
    dissipated.y.push_back(row.dissipated);
    rest.y.push_back(residual(course, row));
  }
  plot.series = {std::move(work), std::move(stored), std::move(dissipated), std::move(rest)};
  return plot;
}

}  // namespace mpm::drive

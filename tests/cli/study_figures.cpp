// The figures of shipped studies against the program as it is: a few combinations of every study in experiments/studies and
// experiments/extremes are run again, the study's figures are drawn of them, and the numbers beside those figures are compared
// with the ones in figures/studies. (experiments/papers: papers.cpp.)

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "bench/costs.hpp"
#include "cli/program.hpp"
#include "experiment/diagnostics.hpp"
#include "mpm/cli.hpp"
#include "solvers/solver.hpp"
#include "study/analysis.hpp"
#include "study/figures.hpp"
#include "study/measured.hpp"
#include "study/run_study.hpp"
#include "support/csv.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const fs::path root = MPM_SOURCE_DIR;
const fs::path kept_figures = root / "figures/studies";

// ---- Which figure is whose

bool is_study_file(const fs::path& file) {
  const Json json = Json::parse(slurp(file), nullptr, false, true);
  return file.extension() == ".json" && json.is_object() && json.contains("base") && json.contains("axes");
}

std::vector<fs::path> studies_with_figures() {
  std::vector<fs::path> files;
  for (const char* folder : {"experiments/extremes", "experiments/studies"})
    for (const auto& entry : fs::directory_iterator(root / folder))
      if (is_study_file(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The table of figures/studies that a study's table NAME.csv is kept as: under its own name, or under one that begins with
/// the study's or with what its folder is called. Empty where it is not kept.
fs::path kept_table(const fs::path& study, const std::string& name) {
  const std::string folder = study.parent_path().filename();
  std::vector<std::string> names{study.stem().string() + "_" + name, name};
  if (folder == "extremes") names.insert(names.begin(), "extremes_" + name);
  for (const std::string& one : names)
    if (fs::is_regular_file(kept_figures / (one + ".csv"))) return kept_figures / (one + ".csv");
  return {};
}

std::string command_of(const fs::path& file) {
  return "./mpm study " + fs::relative(file, root).string();
}

// ---- Which combinations

/// The experiment of a combination, of a bisection at its stable end. Throws InputError where it is refused.
Experiment experiment_of(const study::Study& study, const study::Combination& combination) {
  ReadOptions options = app::read_options(plugins(), {});
  options.overrides = combination.overrides;
  if (const auto& b = study.bisection) options.overrides.push_back(b->pointer + "=" + Json(b->from * b->scale).dump());
  return read_experiment(study.base, plugins(), options);
}

/// The fastest of the elastic waves, m/s, as far as a material says its own; 1 else.
double wave_speed_in(const Experiment& experiment) {
  double speed = 1;
  for (const MaterialSpecification& material : experiment.materials) {
    const Component& law = material.component;
    try {
      speed = larger(speed, std::sqrt(law.parameter("youngs_modulus") / law.parameter("density")));
    } catch (const std::out_of_range&) {  // a law without such a parameter
    }
  }
  return speed;
}

/// Operations that a combination takes, roughly; infinite where it is refused.
double cost_of(const study::Study& study, const study::Combination& combination) {
  constexpr double where_nobody_counted = 1000, start_of_a_run = 5e7;
  try {
    const Experiment experiment = experiment_of(study, combination);
    const Plan plan = make_plan(experiment);
    const double particles = static_cast<double>(plan.particles);
    const double step = experiment.solver.time_step
                            ? *experiment.solver.time_step
                            : solver_of(experiment).limit(experiment, {wave_speed_in(experiment)}).seconds;
    bench::RunFacts facts;
    facts.nodes_per_particle = static_cast<double>(plan.nodes) / std::max(1.0, particles);
    facts.without_ledger = true;
    const auto flops = bench::flops_per_particle(experiment, plan, facts);
    const double runs_of_a_bisection = 8, runs = study.bisection ? runs_of_a_bisection : 1;
    return runs * (start_of_a_run +
                   experiment.solver.end_time / step * particles * (flops ? flops->total() : where_nobody_counted));
  } catch (const InputError&) {
    return std::numeric_limits<double>::infinity();
  }
}

/// Whether any of a figure's tables is kept.
bool is_kept(const fs::path& study, const study::FigureRequest& figure) {
  if (figure.type == study::FigureType::pareto)
    return std::any_of(figure.costs.begin(), figure.costs.end(),
                       [&](const std::string& cost) { return !kept_table(study, figure.name + "_" + cost).empty(); });
  return !kept_table(study, figure.name).empty() || !kept_table(study, figure.name + "_1").empty();
}

/// Which combinations of a study are run again, as indices into `expand`, by these rules alone: the cheapest of those that
/// the most kept figures show, and the cheapest of all that one shows. For the slow test also those that differ from the first on
/// one axis and cost at most four times as much. With each of them all that share its cell of a heat map.
class Choice {
 public:
  Choice(const study::Study& study, const std::vector<study::Combination>& combinations)
      : study_(study), combinations_(combinations) {
    for (const study::FigureRequest& figure : study.figures)
      if (is_kept(study.file, figure)) kept_.push_back(&figure);
    for (const study::Combination& combination : combinations)
      shown_.push_back(std::count_if(kept_.begin(), kept_.end(), [&](const study::FigureRequest* figure) {
        return study::is_shown(study, *figure, {combination, {}, {}, {}, "", {}, {}, {}});
      }));
    cheapest_ = cheapest_shown_by(*std::max_element(shown_.begin(), shown_.end()));
  }

  std::vector<std::size_t> cheapest() { return with_its_cell({cheapest_, cheapest_shown_by(1)}); }
  std::vector<std::size_t> around_the_cheapest() {
    constexpr double most_times = 4;
    std::set<std::size_t> chosen{cheapest_, cheapest_shown_by(1)};
    for (std::size_t axis = 0; axis < study_.axes.size(); ++axis)
      for (const std::size_t k : along(axis, combinations_[cheapest_].choices))
        if (shown_[k] > 0 && cost(k) <= most_times * cost(cheapest_)) chosen.insert(k);
    return with_its_cell(chosen);
  }
  /// Operations of all of these, roughly.
  double cost_of_all(const std::vector<std::size_t>& chosen) {
    double sum = 0;
    for (const std::size_t k : chosen)
      if (std::isfinite(cost(k))) sum += cost(k);
    return sum;
  }

 private:
  /// The cheapest of those that so many kept figures show, axis by axis.
  std::size_t cheapest_shown_by(long figures) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t k = 0; !std::isfinite(least) && k < combinations_.size(); ++k)
      if (shown_[k] >= figures) least = cost(k), best = k;
    for (std::size_t axis = 0; axis < study_.axes.size(); ++axis)
      for (const std::size_t k : along(axis, combinations_[best].choices))
        if (shown_[k] >= figures && cost(k) < least) least = cost(k), best = k;
    return best;
  }
  std::size_t index_of(const std::vector<std::size_t>& choices) const {
    std::size_t index = 0;
    for (std::size_t k = 0; k < choices.size(); ++k) index = index * study_.axes[k].choices.size() + choices[k];
    return index;
  }
  /// Combinations that differ from this one on an axis alone, itself among them.
  std::vector<std::size_t> along(std::size_t axis, std::vector<std::size_t> choices) const {
    std::vector<std::size_t> all;
    for (choices[axis] = 0; choices[axis] < study_.axes[axis].choices.size(); ++choices[axis])
      all.push_back(index_of(choices));
    return all;
  }
  std::vector<std::size_t> with_its_cell(const std::set<std::size_t>& chosen) const {
    std::set<std::size_t> all = chosen;
    for (const study::FigureRequest* figure : kept_)
      if (!figure->over.empty())
        for (const std::size_t k : chosen)
          for (const std::size_t other : along(study_.axis_index(figure->over), combinations_[k].choices))
            all.insert(other);
    return {all.begin(), all.end()};
  }
  double cost(std::size_t k) {
    const auto [entry, is_new] = costs_.try_emplace(k);
    if (is_new) entry->second = cost_of(study_, combinations_[k]);
    return entry->second;
  }

  const study::Study& study_;
  const std::vector<study::Combination>& combinations_;
  std::vector<const study::FigureRequest*> kept_;
  std::vector<long> shown_;  ///< by how many kept figures
  std::map<std::size_t, double> costs_;
  std::size_t cheapest_ = 0;
};

// ---- Running and drawing

/// The chosen combinations run by the program, among all of the study, the others as not run. They stand below `folder`.
study::Results run_chosen(const study::Study& study, std::vector<study::Combination> combinations,
                          const std::vector<std::size_t>& chosen, const Folder& folder) {
  // The same study with one axis, whose values are the chosen combinations. Formulas of measures name the study's own axes.
  study::Study few = study;
  few.overrides.clear();
  for (study::Measure& measure : few.measures) measure.formula.clear();
  few.axes = {study::Axis{"combination", "combination", "", {}, {}}};
  for (const std::size_t k : chosen)
    few.axes[0].choices.push_back({combinations[k].name, std::nullopt, combinations[k].overrides});
  study::ExecutionOptions options;
  options.program = MPM_BUILD_DIR "/bin/mpm";
  options.folder = folder.path();
  options.stop_requested = [] { return false; };
  options.say = [](const std::string&) {};
  study::Results ran = study::run_study(few, plugins(), app::read_options(plugins(), {}), options);
  study::Results results{study, {}, false, ""};
  for (study::Combination& combination : combinations) {
    results.results.emplace_back();
    results.results.back().combination = std::move(combination);
  }
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    study::Combination combination = std::move(results.results[chosen[k]].combination);
    study::Result& result = results.results[chosen[k]] = std::move(ran.results[k]);
    result.combination = std::move(combination);
    const fs::path summary = folder.path() / result.folder / "summary.json";
    for (const study::Measure& measure : study.measures)
      if (result.measures.contains(measure.name) && !measure.formula.empty())
        result.measures[measure.name] =
            study::evaluate(study, measure, result.combination, Json::parse(slurp(summary)));
  }
  return results;
}

// ---- Comparing

/// A row of a figure's table.
struct TableRow {
  std::string words;                                    ///< what names it
  std::optional<double> place;                          ///< its place on the figure's axis
  std::vector<std::pair<std::string, double>> numbers;  ///< by the head of their column
  std::string note;                                     ///< beside the number of a heat map
  bool is_of_no_run = false;                            ///< a formula, or a run that was not run
};

double number_of(const std::string& cell) {
  return cell.empty() ? study::not_measured : std::stod(cell);
}

std::vector<TableRow> rows_of_table(const fs::path& file) {
  const auto cells = support::read_csv_cells(file);
  const auto& head = cells.at(0);
  const auto kind = static_cast<std::size_t>(std::find(head.begin(), head.end(), "kind") - head.begin());
  std::vector<TableRow> rows;
  for (std::size_t k = 1; k < cells.size(); ++k) {
    const auto& row = cells[k];
    TableRow one;
    const auto name_by = [&](std::size_t first, std::size_t count) {
      for (std::size_t cell = first; cell < first + count; ++cell)
        if (!row[cell].empty()) one.words += (one.words.empty() ? "" : ", ") + row[cell];
    };
    if (head[0] == "what") {  // a map of outcomes: what became of which row of it, and where
      name_by(0, row.size());
      one.is_of_no_run = row[0] == study::name_of(study::Status::not_run);
    } else if (kind == head.size()) {  // a heat map
      name_by(0, 2);
      one.numbers = {{head[2], number_of(row[2])}};
      one.note = row[3];
    } else {
      name_by(0, kind + 1);
      one.is_of_no_run = row[kind] == "exact";
      if (head.back() == "dominated by") {  // a front: the number of a point on it depends on all others
        name_by(row.size() - 2, 1);
        one.numbers = {{head[kind + 1], number_of(row[kind + 1])}, {head[kind + 2], number_of(row[kind + 2])}};
      } else {
        one.place = number_of(row[kind + 1]);
        one.numbers = {{head[kind + 2], number_of(row[kind + 2])}};
      }
    }
    rows.push_back(std::move(one));
  }
  return rows;
}

/// A table of a figure, as drawn and as kept.
struct Table {
  fs::path drawn, kept;
  const study::FigureRequest* figure = nullptr;
  std::vector<const study::Result*> results;  ///< of a heat map
};

/// The kept tables of the study's figures; figures and costs of which none is kept are taken out.
std::vector<Table> tables_of(study::Results& results, const fs::path& folder) {
  const fs::path& file = results.study.file;
  auto& figures = results.study.figures;
  std::erase_if(figures, [&](study::FigureRequest& figure) {
    if (!is_kept(file, figure)) return true;
    std::erase_if(figure.costs,
                  [&](const std::string& cost) { return kept_table(file, figure.name + "_" + cost).empty(); });
    return false;
  });
  std::vector<Table> tables;
  const auto add = [&](const std::string& name, const study::FigureRequest& figure,
                       std::vector<const study::Result*> of = {}) {
    if (const fs::path kept = kept_table(file, name); !kept.empty())
      tables.push_back({folder / "figures" / (name + ".csv"), kept, &figure, std::move(of)});
  };
  for (const study::FigureRequest& figure : figures)
    if (figure.type == study::FigureType::pareto) {
      for (const std::string& cost : figure.costs) add(figure.name + "_" + cost, figure);
    } else if (figure.type == study::FigureType::heat_map) {
      const auto layers = study::group(results, figure, {figure.x, figure.y, figure.over});
      for (std::size_t k = 0; k < layers.size(); ++k)
        add(figure.name + (layers.size() == 1 ? "" : "_" + std::to_string(k + 1)), figure, layers[k].results);
    } else {
      add(figure.name, figure);
    }
  return tables;
}

/// Whether all runs that share this cell of a heat map were run.
bool is_whole(const study::Study& study, const Table& table, const TableRow& row) {
  return std::all_of(table.results.begin(), table.results.end(), [&](const study::Result* result) {
    const std::string cell =
        study::label_on(study, *result, table.figure->y) + ", " + study::label_on(study, *result, table.figure->x);
    return cell != row.words || result->outcome.status != study::Status::not_run;
  });
}

/// Numbers agree to this share of themselves, in float to the other, or to a share of the largest number of the column where
/// they are what rounding leaves.
constexpr double share = 1e-6, share_in_float = 1e-4, share_of_largest = 1e-9;

/// Compares the drawn rows of what was run with the kept ones; how many.
std::size_t compare(const study::Study& study, const Table& table, bool in_float) {
  if (!fs::exists(table.drawn)) return 0;  // a front of no points
  const std::vector<TableRow> drawn = rows_of_table(table.drawn), kept = rows_of_table(table.kept);
  std::map<std::string, double> largest;
  for (const TableRow& row : kept)
    for (const auto& [column, value] : row.numbers)
      if (std::isfinite(value)) largest[column] = larger(largest[column], std::abs(value));
  std::size_t compared = 0, stale = 0;
  const auto report = [&](const TableRow& row, const std::string& what) {
    constexpr std::size_t most = 3;
    if (++stale > most) return;
    FAIL_CHECK("figures/studies/" << table.kept.filename().string() << " is not what the program says.\n  study: "
                                  << fs::relative(study.file, root).string() << "\n  combination: " << row.words
                                  << (row.place ? ", " + digits(*row.place) : "") << "\n  " << what
                                  << "\n  write it anew: " << command_of(study.file) << ", then copy runs/"
                                  << study.file.stem().string() << "/figures/" << table.drawn.stem().string()
                                  << ".{csv,png,svg} to figures/studies/" << table.kept.stem().string() << ".*");
  };
  for (const TableRow& row : drawn) {
    if (table.figure->type == study::FigureType::heat_map && !is_whole(study, table, row)) continue;
    if (row.is_of_no_run) continue;
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const TableRow& other) {
      return other.words == row.words &&
             (!row.place || std::abs(*row.place - *other.place) <= 1e-9 * std::abs(*row.place));
    });
    ++compared;
    if (same == kept.end()) {
      report(row, "kept: no such row");
      continue;
    }
    if (same->note != row.note) report(row, "kept: \"" + same->note + "\", now: \"" + row.note + "\"");
    for (std::size_t k = 0; k < row.numbers.size(); ++k) {
      const auto& [column, now] = row.numbers[k];
      const auto& [column_before, before] = same->numbers.at(k);
      const double allowed =
          std::max((in_float ? share_in_float : share) * std::abs(before), share_of_largest * largest[column_before]);
      const bool agree = std::isfinite(now) ? std::abs(now - before) <= allowed : !std::isfinite(before);
      if (column != column_before)
        report(row, "kept: a column \"" + column_before + "\", now: \"" + column + "\"");
      else if (!agree)
        report(row, "column: " + column + "\n  kept: " + digits(before) + "\n  now:  " + digits(now));
    }
  }
  return compared;
}

/// Runs the chosen combinations of a study, draws its figures and compares their tables; how many rows.
std::size_t compare_figures(const study::Study& study, const std::vector<study::Combination>& combinations,
                            const std::vector<std::size_t>& chosen) {
  const Folder folder;
  study::Results results = run_chosen(study, combinations, chosen, folder);
  const std::vector<Table> tables = tables_of(results, folder.path());
  for (const std::string& trouble : study::draw_figures(results, folder.path())) FAIL_CHECK(trouble);
  const bool in_float = std::any_of(chosen.begin(), chosen.end(), [&](std::size_t k) {
    return results.results[k].outcome.status != study::Status::refused &&
           experiment_of(study, results.results[k].combination).precision == Precision::single;
  });
  std::size_t compared = 0;
  for (const Table& table : tables) compared += compare(results.study, table, in_float);
  return compared;
}

}  // namespace

TEST_CASE("every table beside a figure of a study is that of a shipped study, or compared by another test") {
  std::set<std::string> known{"contact_normals.csv", "contact_normals_end.csv",  // contact_normals.cpp
                              "contact_offset.csv"};                             // contact_offset.cpp
  for (const fs::path& file : studies_with_figures()) {
    study::Study study = study::read_study(file);
    study::Results results{study, {}, false, ""};
    for (study::Combination& combination : study::expand(study)) {
      results.results.emplace_back();
      results.results.back().combination = std::move(combination);
    }
    for (const Table& table : tables_of(results, {})) {
      INFO(file << ", " << table.kept);
      CHECK(known.insert(table.kept.filename().string()).second);
    }
  }
  for (const auto& entry : fs::directory_iterator(kept_figures))
    if (entry.path().extension() == ".csv") {
      INFO(entry.path());
      CHECK(known.contains(entry.path().filename().string()));
    }
}

TEST_CASE("the cheapest combinations of every shipped study come to the numbers beside its figures") {
  constexpr double most_operations = 2e9;  // some two seconds on one core; dearer studies are left to the slow test
  std::size_t compared = 0;
  for (const fs::path& file : studies_with_figures()) {
    INFO(file.string());
    const study::Study study = study::read_study(file);
    const auto combinations = study::expand(study);
    Choice choice(study, combinations);
    const auto chosen = choice.cheapest();
    if (choice.cost_of_all(chosen) > most_operations) continue;
    const std::size_t rows = compare_figures(study, combinations, chosen);
    CHECK(rows > 0);
    compared += rows > 0 ? 1 : 0;
  }
  CHECK(compared >= 45);
}

TEST_CASE("combinations around the cheapest of every shipped study come to the numbers beside its figures", "[slow]") {
  for (const fs::path& file : studies_with_figures()) {
    INFO(file.string());
    const study::Study study = study::read_study(file);
    const auto combinations = study::expand(study);
    CHECK(compare_figures(study, combinations, Choice(study, combinations).around_the_cheapest()) > 0);
  }
}

// The verbs `study` and `advise`: many runs of one experiment, and what to take from them.

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <span>

#include "experiment/diagnostics.hpp"
#include "experiment/units.hpp"
#include "mpm/cli.hpp"
#include "mpm/drive.hpp"
#include "mpm/stop_on_signal.hpp"
#include "output/manifest.hpp"
#include "output/run_folder.hpp"
#include "study/analysis.hpp"
#include "study/figures.hpp"
#include "study/report.hpp"
#include "study/run_study.hpp"
#include "support/files.hpp"
#include "support/processors.hpp"

namespace mpm::app {
namespace {

namespace fs = std::filesystem;
using study::Results;
using Json = nlohmann::ordered_json;

Json study_json_in(const fs::path& folder) {
  std::error_code ignored;
  const fs::path file = folder / "study.json";
  if (!fs::is_regular_file(file, ignored)) return nullptr;
  return Json::parse(support::read_file(file), nullptr, false);
}

fs::path default_folder(const fs::path& file) {
  return fs::path("runs") / file.stem();
}

/// The folder of an earlier call of the study, or a new one; nothing else is written to.
fs::path folder_for(const StudyOptions& options) {
  const fs::path folder =
      fs::weakly_canonical(fs::absolute(options.out.empty() ? default_folder(options.file) : options.out));
  std::error_code error;
  if (fs::exists(folder) && !fs::is_directory(folder))
    throw output::FolderRefused(folder.string() + " is a file; choose another folder with --out");
  if (fs::exists(folder) && !fs::is_empty(folder) && !study::is_study_json(study_json_in(folder)))
    throw output::FolderRefused(folder.string() +
                                " holds files that are not an earlier study (no study.json), and none of them will be "
                                "touched; empty it, or choose another folder with --out");
  fs::create_directories(folder, error);
  if (error) throw support::MachineError::from_errno("create the folder", folder, error.value());
  return folder;
}

/// Removes what a killed study left half-written; the runs look after their own.
void remove_temporary_files(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::path> left;
  for (const fs::path& place : {folder, folder / "records", folder / "figures"})
    for (const auto& entry : fs::directory_iterator(place, ignored)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with('.') && name.ends_with(".tmp") && entry.is_regular_file(ignored))
        left.push_back(entry.path());
    }
  for (const fs::path& path : left) fs::remove(path, ignored);
}

void write_study_json(const Results& results, const Json& machine, const fs::path& folder) {
  support::write_atomically(
      folder / "study.json",
      study::json_of(results, machine, MPM_VERSION).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// Removes figures of an earlier call that this one does not draw: they would lie.
void remove_old_figures(const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder / "figures", error);
  if (error) throw support::MachineError::from_errno("remove the old figures in", folder / "figures", error.value());
}

int code_of(const Results& results, const std::vector<std::string>& troubles) {
  if (results.interrupted) return interrupted;
  const bool machine = std::any_of(results.results.begin(), results.results.end(), [](const study::Result& result) {
    return result.outcome.status == study::Status::machine_failed;
  });
  if (machine || !troubles.empty()) return machine_failed;
  return study::objections(results).empty() ? done : expectation_failed;
}

/// Warns of measures that no finished run has, as one whose place is misspelt: its columns and figures are empty.
void warn_of_empty_measures(const Results& results) {
  const auto has = [](const study::Measure& measure) {
    return [&](const study::Result& result) { return result.measures.contains(measure.name); };
  };
  const auto is_done = [](const study::Result& result) { return result.outcome.status == study::Status::done; };
  if (std::none_of(results.results.begin(), results.results.end(), is_done)) return;
  for (const study::Measure& measure : std::span(results.study.measures).first(results.study.own_measures))
    if (std::none_of(results.results.begin(), results.results.end(), has(measure)))
      std::cerr << "warning: measure " << in_quotes(measure.name) << ": no run has a finite number at " << measure.path
                << " of its summary.json\n";
}

void print_end(const Results& results, const fs::path& folder) {
  warn_of_empty_measures(results);
  const auto reused = std::count_if(results.results.begin(), results.results.end(),
                                    [](const study::Result& result) { return result.outcome.reused; });
  std::cout << results.results.size() << " combinations: " << study::counted(results.results);
  if (reused > 0) std::cout << "; " << reused << " reused from an earlier call";
  std::cout << "\nreport: " << (folder / "report.html").lexically_proximate(fs::current_path()).string() << std::endl;
}

/// Writes everything but study.json, which is written first: a figure that fails costs no numbers.
std::vector<std::string> write_outputs(const Results& results, const Json& machine, const fs::path& folder) {
  support::write_atomically(folder / "table.csv", study::table_csv(results));
  remove_old_figures(folder);
  const auto troubles = study::draw_figures(results, folder);
  study::write_report(results, machine, MPM_VERSION, troubles, folder);
  return troubles;
}

Results empty_results(const study::Study& plan, const std::string& command) {
  Results results{plan, {}, true, command};
  for (study::Combination& combination : study::expand(plan)) {
    study::Result result;
    result.combination = std::move(combination);
    results.results.push_back(std::move(result));
  }
  return results;
}

/// Runs the study. One of which nothing can be run leaves no folder that was not there.
Results run_or_leave_nothing(const study::Study& plan, const Registry& registry,
                             const study::ExecutionOptions& execution, bool is_new) {
  try {
    return study::run_study(plan, registry, read_options(registry, {}), execution);
  } catch (const InputError&) {
    std::error_code ignored;
    if (is_new) fs::remove_all(execution.folder, ignored);
    throw;
  }
}

// ---- advise ------------------------------------------------------------------------------------------------------

constexpr std::size_t most_alternatives = 4;

fs::path study_folder(const fs::path& given) {
  std::error_code ignored;
  const fs::path folder = fs::is_regular_file(given, ignored) && given.filename() != "study.json"
                              ? default_folder(given)
                          : given.filename() == "study.json" ? given.parent_path()
                                                             : given;
  if (fs::is_regular_file(folder / "study.json", ignored)) return folder;
  refuse_input(given.string(),
               fs::exists(given, ignored)
                   ? folder.string() + " holds no study.json: run `mpm study FILE` first, or name its folder"
                   : "there is no such study: give the folder that `mpm study` wrote, or its file");
}

Results read_results(const fs::path& folder) {
  try {
    return study::results_from(study_json_in(folder));
  } catch (const std::runtime_error& error) {
    refuse_input((folder / "study.json").string(), error.what());
  }
}

/// A number with the measure's unit, or as it is where the unit is none that the program knows.
double target_value(const std::string& text, const std::string& unit, const std::string& option) {
  try {
    if (const auto number = parse_number(text)) return *number;
    return to_si(text, unit.empty() || unit == "%" ? "" : unit) * (unit == "%" ? 100 : 1);
  } catch (const UnitError& error) {
    refuse_input(option, error.what());
  }
}

std::string three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string amount(const study::Measure& measure, double value) {
  return measure.label + " " + three_digits(value) + (measure.unit.empty() ? "" : " " + measure.unit);
}

struct Question {
  const study::Measure *error, *cost;
  std::string target;  ///< target in words
};

/// What the run of this point warned of; nothing where its folder is gone.
std::vector<std::string> warnings_of(const study::ParetoPoint& point, const fs::path& folder) {
  const fs::path file = folder / point.result->folder / "summary.json";
  if (!fs::exists(file)) return {};
  const Json summary = Json::parse(support::read_file(file), nullptr, false);
  return summary.is_object() ? summary.value("warnings", std::vector<std::string>()) : std::vector<std::string>();
}

std::string sentence(const Results& results, const Question& question, const study::ParetoPoint& point) {
  return study::label_of(results.study, point.result->combination) + ": " + amount(*question.error, point.error) +
         ", " + amount(*question.cost, point.cost);
}

void print_advice(const Results& results, const Question& question, const study::Advice& advice,
                  const fs::path& folder) {
  if (!results.study.note.empty()) std::cout << "note: " << results.study.note << "\n";
  if (advice.good.empty()) {
    std::cout << "no combination has " << question.target << "\n";
    for (std::size_t k = 0; k < std::min(advice.near.size(), most_alternatives); ++k)
      std::cout << (k == 0 ? "nearest: " : "         ") << sentence(results, question, advice.near[k]) << "\n";
    return;
  }
  const study::ParetoPoint& best = advice.good.front();
  std::cout << "take " << sentence(results, question, best) << "\n"
            << "because it has " << question.target << "; " << advice.good.size() << " of " << advice.near.size()
            << " measured combinations have\n"
            << "evidence: " << (folder / best.result->folder).string() << "\n";
  for (const std::string& warning : warnings_of(best, folder)) std::cout << "warning: " << warning << "\n";
  for (std::size_t k = 1; k < std::min(advice.good.size(), most_alternatives); ++k)
    std::cout << (k == 1 ? "next: " : "      ") << sentence(results, question, advice.good[k]) << "\n";
}

Json json_of(const Results& results, const study::ParetoPoint& point, const fs::path& folder) {
  Json json{{"name", point.result->combination.name},
            {"error", point.error},
            {"cost", point.cost},
            {"folder", (folder / point.result->folder).string()},
            {"warnings", warnings_of(point, folder)}};
  for (std::size_t k = 0; k < results.study.axes.size(); ++k)
    json["axes"][results.study.axes[k].name] =
        results.study.axes[k].choices[point.result->combination.choices[k]].label;
  return json;
}

void print_json(const Results& results, const Question& question, const study::Advice& advice, const fs::path& folder) {
  Json json{{"target", question.target}, {"error", question.error->name}, {"cost", question.cost->name}};
  if (!results.study.note.empty()) json["note"] = results.study.note;
  json["good"] = Json::array();
  json["near"] = Json::array();
  for (const auto& point : advice.good) json["good"].push_back(json_of(results, point, folder));
  for (const auto& point : advice.near) json["near"].push_back(json_of(results, point, folder));
  std::cout << json.dump(2) << "\n";
}

const study::Measure& measure_or_refuse(const Results& results, const std::string& name, const std::string& option) {
  if (const study::Measure* measure = results.study.measure(name)) return *measure;
  std::vector<std::string> names;
  for (const study::Measure& measure : results.study.measures) names.push_back(measure.name);
  refuse_input(option,
               "no measure is called " + in_quotes(name) + suggestion(name, names, "measures: " + quoted_list(names)));
}

/// The measure that stands for the error. What is below zero somewhere is no error: the least of it is not the best.
const study::Measure& error_or_refuse(const Results& results, const std::string& name) {
  const study::Measure& measure = measure_or_refuse(results, name, "--measure");
  for (const study::Result& result : results.results)
    if (result.value(name) < 0)
      refuse_input("--measure", in_quotes(name) + " is below zero in " +
                                    study::label_of(results.study, result.combination) +
                                    ": advice takes the least; give a measure that is zero where nothing is wrong");
  return measure;
}

}  // namespace

int study(const StudyOptions& options) {
  const study::Study plan = study::read_study(options.file, options.overrides);
  refuse_material_point(plan.base, plan.file, options.overrides);
  const Registry registry = load_registry();
  const fs::path folder = folder_for(options);
  const output::FolderLock lock(folder);
  const Json machine = output::machine_description();
  const bool is_new = study_json_in(folder).is_null();
  if (is_new) write_study_json(empty_results(plan, options.command), machine, folder);
  remove_temporary_files(folder);

  const StopOnSignal signals;
  study::ExecutionOptions execution;
  execution.program = fs::read_symlink("/proc/self/exe");
  execution.folder = folder;
  const int processors = support::available_processors();
  const auto [jobs, threads] = study::share_processors(processors, options.jobs, options.threads);
  if (threads < options.threads)
    std::cerr << "each run has " << threads << (threads == 1 ? " thread" : " threads") << ", not " << options.threads
              << ": " << jobs << (jobs == 1 ? " run" : " runs") << " at a time on " << processors
              << (processors == 1 ? " processor\n" : " processors\n");
  execution.jobs = jobs;
  execution.threads = threads;
  execution.command = options.command;
  execution.stop_requested = stop_requested;
  execution.say = [](const std::string& line) { std::cerr << line << "\n"; };
  const Results results = run_or_leave_nothing(plan, registry, execution, is_new);
  write_study_json(results, machine, folder);
  const auto troubles = write_outputs(results, machine, folder);
  for (const std::string& trouble : troubles) std::cerr << trouble << "\n";
  for (const std::string& objection : study::objections(results)) std::cerr << objection << "\n";
  if (results.interrupted) std::cerr << "stopped; go on with: " << options.command << "\n";
  print_end(results, folder);
  return code_of(results, troubles);
}

int advise(const AdviseOptions& options) {
  if (options.error.empty() == options.time.empty())
    refuse_input("command line", "give either --error, what must be reached, or --time, what may be spent");
  const fs::path folder = study_folder(options.study);
  Results results = read_results(folder);
  if (!options.measure.empty()) results.study.error = error_or_refuse(results, options.measure).name;
  if (results.study.error.empty())
    refuse_input(folder.string(), "the study names no \"error\" among its measures; give one with --measure");
  const bool by_error = options.time.empty();
  Question question{&measure_or_refuse(results, results.study.error, folder.string()), nullptr, ""};
  study::Advice advice;
  if (by_error) {
    question.cost = &measure_or_refuse(results, options.by.empty() ? results.study.cost : options.by, "--by");
    const double target = target_value(options.error, question.error->unit, "--error");
    question.target = question.error->label + " of at most " + options.error;
    advice = study::advise_for_error(results, question.cost->name, target);
  } else {
    if (!options.by.empty()) refuse_input("--by", "belongs to --error: --time ranks by error");
    question.cost = &measure_or_refuse(results, "seconds", "--time");
    question.target = question.cost->label + " of at most " + options.time;
    advice = study::advise_within(results, "seconds", target_value(options.time, "s", "--time"));
  }
  if (options.json)
    print_json(results, question, advice, folder);
  else
    print_advice(results, question, advice, folder);
  return advice.good.empty() ? expectation_failed : done;
}

}  // namespace mpm::app

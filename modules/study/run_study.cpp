#include "study/run_study.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <thread>

#include "experiment/diagnostics.hpp"
#include "experiment/located_json.hpp"
#include "solvers/solver.hpp"
#include "study/bisection.hpp"
#include "study/runner.hpp"

namespace mpm::study {
namespace {

constexpr auto pause = std::chrono::milliseconds(5);  ///< pause between looks at the runs

/// What one combination still has to run: a single experiment, or the next of a bisection.
class Task {
 public:
  Task(const Study& study, Result& result) : study_(study), result_(result) {
    if (const auto& b = study.bisection) search_.emplace(b->from, b->to, b->relative_tolerance);
  }

  Result& result() { return result_; }
  /// Nothing is left to run.
  bool is_over() const { return over_; }

  std::string run_name() const {
    return searches() ? result_.combination.name + "@" + number_text(*search_->next()) : result_.combination.name;
  }
  std::vector<std::string> overrides() const {
    std::vector<std::string> all = result_.combination.overrides;
    if (!search_) return all;
    const Bisection& bisection = *study_.bisection;
    const double value = searches() ? *search_->next() : *search_->stable();
    if (searches()) all.insert(all.end(), bisection.overrides.begin(), bisection.overrides.end());
    all.push_back(bisection.pointer + "=" + Json(value * bisection.scale).dump());
    return all;
  }

  void finish(const Outcome& outcome, const Json& summary) {
    if (!searches()) {
      over_ = true;
      const Outcome found = result_.outcome;
      result_.outcome = outcome;
      if (search_) result_.outcome.reused = found.reused && outcome.reused;
      if (outcome.status != Status::refused) result_.folder = "runs/" + result_.combination.name;
      if (is_finished(outcome.status)) measure(summary);
      if (outcome.reason.empty()) result_.outcome.reason = found.reason;
      return;
    }
    const Status status = outcome.status;
    if (status == Status::refused || status == Status::machine_failed || status == Status::interrupted ||
        status == Status::crashed) {
      over_ = true;  // such an outcome says nothing about stability: an unstable run ends with a reason
      result_.outcome = outcome;
      result_.outcome.reason = "at " + number_text(*search_->next()) + ": " + outcome.reason;
      return;
    }
    probe(outcome, summary);
  }

 private:
  bool searches() const { return search_ && search_->next(); }

  void probe(const Outcome& outcome, const Json& summary) {
    std::vector<std::string> broken;
    if (outcome.status != Status::done)
      broken.push_back(outcome.reason.empty() ? name_of(outcome.status) : outcome.reason);
    for (const std::string& flag : flags_in(summary)) broken.push_back(flag);
    const bool stable = broken.empty() && all_hold(study_.bisection->stable_while, summary, broken);
    result_.probes.push_back({*search_->next(), stable, "runs/" + run_name(), stable ? "" : broken.front()});
    result_.outcome.reused = (result_.probes.size() == 1 || result_.outcome.reused) && outcome.reused;
    if (stable) {
      result_.folder = result_.probes.back().folder;
      measure(summary);
    }
    search_->answer(stable);
    result_.stable = search_->stable();
    result_.unstable = search_->unstable();
    if (result_.stable) result_.measures[critical_measure] = *result_.stable;
    if (search_->next()) return;
    over_ = !result_.stable || study_.bisection->overrides.empty();
    if (!result_.stable) {
      result_.outcome.status = Status::failed;
      result_.outcome.reason = "unstable already at " + number_text(study_.bisection->from) + ": " + broken.front();
      result_.outcome.cause = outcome.cause;
      return;
    }
    result_.outcome.status = Status::done;
    if (!result_.unstable) result_.outcome.reason = "stable up to the end of the range";
  }

  void measure(const Json& summary) {
    result_.measures.clear();
    for (const Measure& measure : study_.measures)
      if (const double value = evaluate(study_, measure, result_.combination, summary); std::isfinite(value))
        result_.measures[measure.name] = value;
    if (result_.stable) result_.measures[critical_measure] = *result_.stable;
    result_.flags = flags_in(summary);
  }

  const Study& study_;
  Result& result_;
  std::optional<BisectionSearch> search_;
  bool over_ = false;
};

class Execution {
 public:
  Execution(const Study& study, const Registry& registry, const ReadOptions& read, const ExecutionOptions& options)
      : study_(study),
        registry_(registry),
        read_(read),
        options_(options),
        keys_(options.program),
        runner_(options.program, options.folder, options.threads) {
    results_.study = study;
    results_.command = options.command;
    for (Combination& combination : expand(study))
      results_.results.push_back({std::move(combination), {}, {}, {}, "", {}, {}, {}});
    for (Result& result : results_.results) waiting_.emplace_back(study_, result);
  }

  Results run() {
    while (!waiting_.empty() || runner_.running() > 0) {
      if (options_.stop_requested()) {
        results_.interrupted = true;
        waiting_.clear();
        runner_.stop();
      }
      while (!waiting_.empty() && runner_.running() < static_cast<std::size_t>(options_.jobs) &&
             !options_.stop_requested())
        begin_next();
      if (const auto ended = runner_.poll())
        end(*ended);
      else if (runner_.running() > 0)
        std::this_thread::sleep_for(pause);
    }
    refuse_when_all_are();
    return std::move(results_);
  }

 private:
  /// Takes the next combination as far as it goes without a process.
  void begin_next() {
    Task task = waiting_.front();
    waiting_.pop_front();
    go_on(task);
  }

  void go_on(Task task) {
    while (!task.is_over()) {
      PreparedRun run{task.run_name(), {}, ""};
      try {
        prepare(task, run);
      } catch (const InputError& error) {
        task.finish({Status::refused, reason_of(error, study_, task.overrides())}, {});
        continue;
      }
      if (const auto earlier = runner_.earlier(run)) {
        task.finish(*earlier, runner_.summary(run.name));
        continue;
      }
      runner_.start(run);
      active_.emplace(run.name, task);
      return;
    }
    report(task.result());
  }

  void prepare(const Task& task, PreparedRun& run) {
    ReadOptions read = read_;
    read.overrides = task.overrides();
    const Experiment experiment = read_experiment(study_.base, registry_, read);
    make_plan(experiment);  // what does not run together is refused here, where the study's lines are known
    run.experiment = experiment.resolved;
    run.key = keys_(experiment);
  }

  void end(const Runner::Ended& ended) {
    auto found = active_.find(ended.name);
    Task task = found->second;
    active_.erase(found);
    task.finish(ended.outcome, runner_.summary(ended.name));
    if (!task.is_over() && options_.stop_requested()) {
      task.result().outcome = {Status::interrupted, "the bisection was stopped"};
      return report(task.result());
    }
    go_on(task);
  }

  void report(const Result& result) {
    ++reported_;
    std::string line = "[" + std::to_string(reported_) + "/" + std::to_string(results_.results.size()) + "] " +
                       result.combination.name + ": " + name_of(result.outcome.status);
    if (result.stable) line += ", " + study_.bisection->label + " " + number_text(*result.stable);
    if (!result.outcome.reason.empty()) line += ": " + result.outcome.reason;
    for (const std::string& flag : result.flags) line += ", " + flag;
    options_.say(line + (result.outcome.reused ? " (reused)" : ""));
  }

  void refuse_when_all_are() const {
    if (results_.interrupted) return;
    for (const Result& result : results_.results)
      if (result.outcome.status != Status::refused) return;
    std::vector<Problem> problems;
    std::string last;
    for (const Result& result : results_.results) {
      if (result.outcome.reason == last) continue;
      last = result.outcome.reason;
      problems.push_back({study_.file.string(), 0, 0, "", result.combination.name + ": " + last});
    }
    throw InputError(std::move(problems));
  }

  const Study& study_;
  const Registry& registry_;
  const ReadOptions& read_;
  const ExecutionOptions& options_;
  KeyMaker keys_;
  Runner runner_;
  Results results_;
  std::deque<Task> waiting_;
  std::map<std::string, Task> active_;
  std::size_t reported_ = 0;
};

/// The problem of a value that an override gave, at the place of the study's file where that stands. Those of the base,
/// and of the command line of the study, are where they are.
Problem located(Problem problem, const Study& study, const std::vector<std::string>& overrides) {
  const bool of_override = problem.line == 0 && (problem.file == "--set" || problem.file == "command line");
  std::size_t longest = 0;
  for (const std::string& text : overrides) {
    const std::string pointer = text.substr(0, text.find('='));
    const bool within = of_override && (problem.pointer == pointer || problem.pointer.starts_with(pointer + "/"));
    const bool chose = pointer == problem.pointer + "/type";  // what is wrong with a choice is that of its type
    if (!(within || chose) || pointer.size() < longest) continue;
    longest = pointer.size();
    auto found = study.places.find(text);
    if (found == study.places.end()) found = study.places.find(pointer);
    problem.file = found == study.places.end() ? "--set" : found->second;
    problem.line = problem.column = 0;
  }
  return problem;
}

}  // namespace

std::string reason_of(const InputError& error, const Study& study, const std::vector<std::string>& overrides) {
  std::string text;
  for (const Problem& problem : error.problems())
    text += (text.empty() ? "" : "; ") + located(problem, study, overrides).text();
  return text;
}

Shares share_processors(int processors, int jobs, int threads) {
  if (jobs > 0) return {jobs, std::clamp(processors / jobs, 1, threads)};
  threads = std::min(threads, processors);
  return {processors / threads, threads};
}

Results run_study(const Study& study, const Registry& registry, const ReadOptions& read,
                  const ExecutionOptions& options) {
  read_located(study.base);  // a base that is no JSON is one mistake, not one a combination
  return Execution(study, registry, read, options).run();
}

}  // namespace mpm::study

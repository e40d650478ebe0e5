// The verb `run`: an experiment file in; numbers, figures and a report out.

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "backends/device/device.hpp"
#include "backends/libraries/backend_library.hpp"
#include "backends/make_backend.hpp"
#include "drive/read_drive.hpp"
#include "experiment/diagnostics.hpp"
#include "mpm/cli.hpp"
#include "mpm/drive.hpp"
#include "mpm/run_figures.hpp"
#include "mpm/stop_on_signal.hpp"
#include "output/manifest.hpp"
#include "output/report.hpp"
#include "output/summary_value.hpp"
#include "run/checkpoint.hpp"
#include "run/earlier_run.hpp"
#include "run/limits.hpp"
#include "run/start_checks.hpp"
#include "run/summary.hpp"
#include "support/files.hpp"
#include "support/film_formats.hpp"
#include "support/hash.hpp"
#include "support/processors.hpp"
#include "support/team.hpp"

namespace mpm::app {
namespace {

using Clock = std::chrono::steady_clock;

/// The progress: one line that is rewritten on a terminal, a plain line every tenth of the run elsewhere.
class Progress {
 public:
  explicit Progress(const Simulation& simulation)
      : simulation_(simulation),
        terminal_(isatty(STDERR_FILENO)),
        start_(Clock::now()),
        shown_(start_),
        first_step_(simulation.steps()),
        first_share_(share()) {
    while (next_share_ <= first_share_) next_share_ += 0.1;
  }

  /// Frees the line for another message.
  void clear() const {
    if (terminal_) std::fputs("\r\033[K", stderr);
  }

  void show(bool last = false) {
    const auto now = Clock::now();
    const double share = this->share();
    const bool due = terminal_ ? now - shown_ > std::chrono::milliseconds(200) : share >= next_share_;
    if (!due && !(last && (terminal_ || simulation_.steps() != shown_step_))) return;
    shown_ = now;
    shown_step_ = simulation_.steps();
    while (next_share_ <= share) next_share_ += 0.1;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const double rate = static_cast<double>(simulation_.steps() - first_step_) *
                        static_cast<double>(simulation_.particle_count()) / std::max(elapsed, 1e-9);
    const double done_here = share - first_share_;
    std::fprintf(stderr, "%sstep %ld, t = %.6g s (%3.0f %%), dt = %.3g s, %.3g M particle-steps/s, %.0f s left%s",
                 terminal_ ? "\r\033[K" : "", simulation_.steps(), simulation_.time(), 100 * share,
                 simulation_.last_time_step(), rate / 1e6, done_here > 0 ? elapsed * (1 - share) / done_here : 0.0,
                 terminal_ && !last ? "" : "\n");
    std::fflush(stderr);
  }

 private:
  double share() const { return simulation_.time() / simulation_.experiment().solver.end_time; }

  const Simulation& simulation_;
  bool terminal_;
  Clock::time_point start_, shown_;
  long first_step_;  ///< step at which this process began
  double first_share_, next_share_ = 0.1;
  long shown_step_ = -1;
};

nlohmann::ordered_json manifest(const Experiment& experiment, const RunOptions& options, int threads) {
  nlohmann::ordered_json json{{"program", "mpm"},
                              {"version", MPM_VERSION},
                              {"command", options.command},
                              {"experiment_file", experiment.file.filename().string()}};
  if (const std::string text = support::read_file(experiment.file); true)
    json["experiment_sha256"] = support::sha256(text);
  if (!experiment.inputs.empty()) json["inputs"] = inputs_of(experiment);
  json["seed"] = experiment.seed;
  json["threads"] = threads;
  json["processors"] = support::available_processors();
  json["longest_spin_us"] = support::longest_spin().count();
  json["machine"] = output::machine_description();
  for (const Plugin* plugin : plugins_of(experiment)) {
    const mpm_descriptor& d = *plugin->descriptor;
    json["plugins"].push_back({{"id", d.id},
                               {"kind", kind_name(static_cast<mpm_kind>(d.kind))},
                               {"version", d.version},
                               {"summary", d.summary},
                               {"citation", d.citation},
                               {"file_sha256", support::sha256_of_file(plugin->file)}});
  }
  return json;
}

/// The manifest of the first part, with a line for each resumption, those included whose work was lost again.
nlohmann::ordered_json resumed_manifest(const output::RunFolder& folder, const RunOptions& options, int threads,
                                        long step) {
  auto json = nlohmann::ordered_json::parse(support::read_file(folder.root() / "manifest.json"), nullptr, false);
  if (!json.is_object())
    throw output::FolderRefused((folder.root() / "manifest.json").string() +
                                " is damaged; start anew with --replace in place of --resume");
  json["resumed"].push_back({{"resumed_from_step", step}, {"command", options.command}, {"threads", threads}});
  return json;
}

/// The command that goes on with this run: what is resumed is not replaced.
std::string resume_command(const RunOptions& options) {
  std::string command = options.command;
  if (const auto at = command.find(" --replace"); at != std::string::npos) command.erase(at, 10);
  return command + (options.resume ? "" : " --resume");
}

Outcome outcome_of(const Failure& failure, const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  const FailurePlace place = simulation.place_of(failure);
  return {run_failed, "failed", failure_text(failure, simulation), record_of(failure, place, experiment)};
}

/// The outcome of a run that something keeps from its end; the run can be resumed from there.
Outcome unfinished(const Simulation& simulation) {
  if (!simulation.finished())
    return {interrupted, "interrupted", "stopped by a signal after step " + std::to_string(simulation.steps())};
  if (simulation.time() < simulation.experiment().solver.end_time * (1 - 1e-12))
    return {run_failed, "failed", "max_steps (" + std::to_string(simulation.steps()) + ") was reached before end_time"};
  return {};
}

void say_how_to_resume(const Outcome& outcome, const Checkpoints& checkpoints, const RunOptions& options) {
  const bool too_few_steps = outcome.exit_code == run_failed;
  if (checkpoints.any())
    std::cerr << "resume with: " << resume_command(options) << (too_few_steps ? " --set /solver/max_steps=..." : "")
              << "\n";
  else
    std::cerr << "there is no checkpoint: this run cannot be resumed\n";
}

/// Steps until the end, a failure or a signal.
Outcome step_to_the_end(Simulation& simulation, Recorder& recorder, Checkpoints& checkpoints,
                        const RunOptions& options) {
  Progress progress(simulation);
  recorder.record();
  simulation.observe_when(
      [&](double time, long steps) { return stop_requested() || recorder.due(time, steps) || checkpoints.due(steps); });
  while (!simulation.finished() && !(stop_requested() && simulation.observed())) {
    try {
      simulation.step();
    } catch (const RunFailure& stopped) {
      const Outcome outcome = outcome_of(stopped.failure, simulation);
      recorder.break_off();
      progress.show(true);
      std::cerr << "the run failed: " << outcome.reason
                << "\nremedy: " << remedy_for(stopped.failure, simulation.experiment()) << "\n";
      return outcome;
    } catch (const ImposedValueFailure& stopped) {
      const long step = simulation.steps() + 1;
      const Outcome outcome{run_failed, "failed", failure_text(stopped.imposed, simulation),
                            record_of(stopped.imposed, step)};
      recorder.break_off();
      progress.show(true);
      std::cerr << "the run failed: " << outcome.reason << "\nremedy: " << impossible_value_remedy << "\n";
      return outcome;
    }
    recorder.record();
    checkpoints.write_if_due();
    progress.show();
  }
  const Outcome outcome = unfinished(simulation);
  if (!outcome.reason.empty()) {
    progress.clear();
    checkpoints.write();  // comes before the row below, which the whole run does not have
    say_how_to_resume(outcome, checkpoints, options);
  }
  recorder.record(true);
  progress.show(true);
  if (!outcome.reason.empty()) std::cerr << outcome.reason << "\n";
  return outcome;
}

/// Steps to the end, also when the disk or the memory fails on the way: what was recorded before still gets its
/// summary.
Outcome step_or_say_why(Simulation& simulation, Recorder& recorder, Checkpoints& checkpoints,
                        const RunOptions& options) {
  try {
    return step_to_the_end(simulation, recorder, checkpoints, options);
  } catch (const device::DeviceError& error) {
    recorder.lose_state();  // and the step may be half done: no checkpoint is made of it
    std::cerr << "the device failed: " << error.what() << "\n";
    const Outcome outcome{machine_failed, "failed", error.what()};
    say_how_to_resume(outcome, checkpoints, options);
    return outcome;
  } catch (const support::MachineError& error) {
    std::cerr << "the machine failed: " << error.what() << "\n";
    // The step is whole, and what could not be recorded of it is recorded when the run is resumed.
    checkpoints.write();
    const Outcome outcome{machine_failed, "failed", error.what()};
    say_how_to_resume(outcome, checkpoints, options);
    return outcome;
  }
}

void draw(const Experiment& experiment, Recorder& recorder, const output::RunFolder& folder) {
  recorder.draw_frames();
  const RunLabel label{experiment.title.empty() ? experiment.file.stem().string() : experiment.title,
                       experiment.file.filename().string()};  // not the folder: equal experiments have equal pictures
  const support::Table metrics = support::read_csv(folder.root() / "metrics.csv");
  draw_figures(experiment.figures, metrics, label, folder.figures());
  draw_figures(experiment.column_figures, metrics, label, folder.figures());
}

/// Draws frames and figures. Returns what prevented that, or an empty string. The numbers are on disk by then.
std::string trouble_of_drawing(const Experiment& experiment, Recorder& recorder, const output::RunFolder& folder) {
  try {
    draw(experiment, recorder, folder);
    return "";
  } catch (const std::exception& error) {
    return std::string("pictures are missing: ") + error.what() + "; the numbers are whole, and `mpm figure " +
           folder.root().string() + "` draws figures from them again";
  }
}

void print_result(const Experiment& experiment, const nlohmann::ordered_json& summary,
                  const output::RunFolder& folder) {
  const bool plane = experiment.dimension == 2 && !experiment.axisymmetric();
  if (const auto& total = summary["energy"]["total"]; total.contains("final_over_initial"))
    std::cout << "total energy final/initial " << total["final_over_initial"].get<double>();
  else
    std::cout << "total energy " << total["final"].get<double>() << (plane ? " J/m" : " J")
              << " at the end, none at the start";
  std::cout << ", " << summary["performance"]["particle_steps_per_second"].get<double>() / 1e6
            << " M particle-steps/s\nreport: "
            << (folder.root() / "report.html").lexically_relative(std::filesystem::current_path()).string()
            << std::endl;
}

/// The exit code of a run that has come to its end and needs no resuming.
std::optional<int> already_finished(const Experiment& experiment, const output::RunFolder& folder) {
  const std::optional<int> code = finished_with(folder);
  if (!code) return std::nullopt;
  refuse_other_experiment(experiment,
                          nlohmann::ordered_json::parse(support::read_file(folder.root() / "experiment.json")), folder);
  std::cerr << folder.root().string() << " holds a finished run (exit code " << *code << "): nothing was left to do\n";
  return code;
}

output::RunFolder open_to_resume(const std::filesystem::path& place) {
  if (!std::filesystem::is_regular_file(place / "manifest.json"))
    throw output::FolderRefused(place.string() +
                                " holds no run (no manifest.json), so nothing can be resumed: name "
                                "its folder with --out, or start it without --resume");
  return output::RunFolder::open(place);
}

/// Goes back to the newest checkpoint; the folder then no longer says, nor shows in a film, how the run ended before.
EarlierParts resume(Simulation& simulation, Recorder& recorder, const output::RunFolder& folder,
                    const RunOptions& options, int threads) {
  EarlierParts earlier = restore_newest(simulation, recorder, folder, identity_of(simulation.experiment()));
  folder.write_json("manifest.json", resumed_manifest(folder, options, threads, simulation.steps()));
  // The film goes as well, because the rest of the run may be told to make one of another format, or none.
  for (const char* name : {"summary.json", "report.html"}) std::filesystem::remove(folder.root() / name);
  for (const std::string& format : support::film_formats()) std::filesystem::remove(folder.root() / ("film." + format));
  std::cerr << "resumed from step " << simulation.steps() << ", t = " << number_text(simulation.time()) << " s\n";
  return earlier;
}

/// Writes summary, pictures and report.
Outcome finish(Outcome outcome, nlohmann::ordered_json summary, const Experiment& experiment, Recorder& recorder,
               const output::RunFolder& folder) {
  if (outcome.exit_code == done) {
    const auto failed = judge_expectations(experiment, summary);
    for (const std::string& sentence : failed) std::cerr << sentence << "\n";
    if (!failed.empty()) outcome = {expectation_failed, "expectation failed", failed.front()};
  }
  std::string flagged;
  for (const std::string& flag : judge_limits(experiment, summary)) {
    std::cerr << "flagged: " << flag << "\n";
    flagged += (flagged.empty() ? "" : "; ") + flag;
  }
  if (outcome.exit_code == done && !flagged.empty()) outcome = {expectation_failed, output::limit_broken, flagged};
  for (const auto& warning : summary["warnings"]) std::cerr << "warning: " << warning.get<std::string>() << "\n";
  const auto write_summary = [&] {
    summary["outcome"] = {{"exit_code", outcome.exit_code}, {"status", outcome.status}, {"reason", outcome.reason}};
    summary["outcome"].update(outcome.failure);
    folder.write_json("summary.json", summary);
  };
  write_summary();
  const auto drawing = Clock::now();
  const std::string trouble = trouble_of_drawing(experiment, recorder, folder);
  summary["performance"]["drawing_seconds"] = std::chrono::duration<double>(Clock::now() - drawing).count();
  if (!trouble.empty()) {
    std::cerr << trouble << "\n";
    summary["warnings"].push_back(trouble);
    if (outcome.exit_code == done) outcome = {machine_failed, "failed", trouble};
  }
  write_summary();
  output::write_report(folder.root());
  print_result(experiment, summary, folder);
  return outcome;
}

struct Threads {
  int most = 1;
  bool find_number = false;  ///< use as many as are fastest, up to the most; else exactly so many
};

/// The threads asked for, but at most one for each processor that the process may use: more would only wait for one
/// another's.
Threads threads_for(const Experiment& experiment, const RunOptions& options) {
  if (experiment.backend != "cpu") return {};
  const int processors = support::available_processors();
  if (options.threads > processors)
    std::cerr << "--threads " << options.threads << ": this process may use " << processors
              << (processors == 1 ? " processor, and takes one thread\n"
                                  : " processors, and takes as many threads as are fastest\n");
  if (options.threads > 0 && options.threads <= processors) return {options.threads, false};
  return {processors, true};
}

}  // namespace

int run(const RunOptions& options) {
  refuse_study(options.file, "run");
  if (drive::is_material_point(options.file, options.overrides)) return run_material_point(options);
  const Registry registry = load_registry_for({options.file}, options.overrides);
  auto start = Clock::now();
  const Experiment experiment = read_experiment(options.file, registry, read_options(registry, options));
  const auto read = Clock::now();
  load_backend_library(experiment);
  start += Clock::now() - read;  // a compiler may have run: that is no time of the run
  const auto place = options.out.empty() ? std::filesystem::path("runs") / options.file.stem() : options.out;
  refuse_unknown_records(experiment);
  if (options.resume)
    if (const auto code = already_finished(experiment, open_to_resume(place))) return *code;
  const auto [threads, find_number] = threads_for(experiment, options);
  Simulation simulation(experiment, backend_factory(threads, find_number, options.device));
  const Metrics metrics(simulation);  // metrics are those of step 0, also when the run goes on from a later one
  std::vector<std::string> warnings = check_start(simulation);

  const StopOnSignal signals;
  // The file may lie in the folder that is replaced.
  const auto description = options.resume ? nlohmann::ordered_json() : manifest(experiment, options, threads);
  const auto folder = options.resume ? open_to_resume(place) : folder_for_new_run(place, experiment, options.replace);
  const output::FolderLock lock(folder.root());
  Recorder recorder(simulation, metrics, folder);
  recorder.use_threads(options.threads > 0 ? std::min(options.threads, support::available_processors())
                                           : support::available_processors());
  EarlierParts earlier;
  if (options.resume)
    earlier = resume(simulation, recorder, folder, options, threads);
  else
    folder.write_json("manifest.json", description);
  folder.remove_temporary_files();
  folder.write_json("experiment.json", experiment.resolved);
  folder.write_json("plan.json", simulation.plan().to_json());
  std::cerr << experiment.title << ": " << simulation.particle_count() << " particles, " << experiment.backend
            << " backend, " << threads << (threads == 1 ? " thread" : " threads") << "\n";
  if (!options.resume) recorder.start();

  Checkpoints checkpoints(simulation, recorder, folder, identity_of(experiment), earlier, start);
  const Outcome stepped = step_or_say_why(simulation, recorder, checkpoints, options);
  const double wall = std::chrono::duration<double>(Clock::now() - start).count();
  nlohmann::ordered_json summary = summarise(simulation, metrics, recorder.rows(), wall, earlier);
  summary["performance"]["particle_file_seconds"] = recorder.particle_file_seconds();
  for (const auto& warning : summary["warnings"]) warnings.push_back(warning.get<std::string>());
  if (!checkpoints.trouble().empty()) warnings.push_back(checkpoints.trouble());
  summary["warnings"] = warnings;
  const Outcome outcome = finish(stepped, std::move(summary), experiment, recorder, folder);
  if (outcome.exit_code == done || outcome.exit_code == expectation_failed) checkpoints.remove();
  return outcome.exit_code;
}

}  // namespace mpm::app

#pragma once
// What a study measured: one result a combination, in study.json, from which tables, figures and advice are made.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "study/measured.hpp"
#include "study/study.hpp"

namespace mpm::study {

enum class Status {
  not_run,             ///< the study was stopped before
  done,                ///< finished, every expectation held
  expectation_failed,  ///< finished, but an expectation did not hold
  failed,              ///< stopped with a reason (exit code 3): unstable or invalid
  refused,             ///< refused when it was loaded
  crashed,             ///< ended by a signal, or with a code that no run has
  machine_failed,
  interrupted
};

/// The status as words: "done", "expectation failed", …
const char* name_of(Status status);
/// The status of a name. Throws std::runtime_error when there is none of this name.
Status status_named(const std::string& name);

/// Whether the run came to its end, so that its numbers can be compared.
bool is_finished(Status status);

/// How one process ended.
struct Outcome {
  Status status = Status::not_run;
  std::string reason;
  bool reused = false;  ///< taken from an earlier call, the experiment and the programs being the same
  std::string cause{};  ///< in few words, where a particle stopped the run: name_of(Cause), simulation/failure.hpp
};

/// One run of a bisection.
struct Probe {
  double value = 0;
  bool is_stable = false;
  std::string folder, reason;
};

struct Result {
  Combination combination;
  Outcome outcome;
  std::vector<std::string> flags;          ///< limits that a finished run breaks
  std::map<std::string, double> measures;  ///< by name; only finite ones
  std::string folder;                      ///< folder of the run, relative to the study's; empty when there is none
  std::vector<Probe> probes;               ///< runs of a bisection
  std::optional<double> stable, unstable;  ///< last bracket of a bisection

  /// The value of a measure; NaN when it was not measured.
  double value(const std::string& measure) const;
};

/// The whole study as it stands.
struct Results {
  Study study;
  std::vector<Result> results;  ///< in the order of `expand`
  bool interrupted = false;
  std::string command;
};

/// Labels of the choices, one an axis: "linear, flip, none".
std::string label_of(const Study& study, const Combination& combination, const std::vector<std::string>& without = {});

/// How many results have each status, in words: "20 done, 3 failed, 1 refused".
std::string counted(const std::vector<Result>& results);

/// A sentence for each result that is flagged, failed an expectation or crashed; these make the exit code 4.
std::vector<std::string> objections(const Results& results);

/// The results as study.json holds them.
Json json_of(const Results& results, const Json& machine, const std::string& version);
/// The parts of study.json that advice needs: axes, measures, results. Throws std::runtime_error when it is none.
Results results_from(const Json& json);
/// Whether the text is a study.json, whole.
bool is_study_json(const Json& json);

/// The results as table.csv: a row a combination; the axes' labels, status, reason, flags, then the measures with
/// units.
std::string table_csv(const Results& results);

}  // namespace mpm::study

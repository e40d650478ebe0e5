#pragma once
// Runs a study: takes it from its file to its results.

#include <functional>
#include <string>

#include "experiment/read.hpp"
#include "plugin/registry.hpp"
#include "study/results.hpp"

namespace mpm::study {

struct ExecutionOptions {
  std::filesystem::path program;  ///< program that has the verb `run`
  std::filesystem::path folder;   ///< absolute path of the study's folder, which exists
  int jobs = 1;                   ///< runs at a time
  int threads = 1;                ///< threads of each run
  std::string command;            ///< command as typed
  std::function<bool()> stop_requested;
  std::function<void(const std::string&)> say;  ///< takes progress, a line a call
};

/// How a study shares the processors among its runs.
struct Shares {
  int jobs = 1;     ///< runs at a time
  int threads = 1;  ///< threads of each run
};
/// Shares in which no more threads work than there are processors, each with one at least: `jobs` runs at a time where
/// that is given (> 0), else as many as the processors have threads for; `threads` for each at most. Results do not
/// depend on either.
Shares share_processors(int processors, int jobs, int threads);

/// Why a combination with these overrides is refused, on one line. What the study's file set is located there.
std::string reason_of(const InputError& error, const Study& study, const std::vector<std::string>& overrides);

/// Makes, runs or takes over every combination. `read` carries what experiments may name; its overrides are not used.
/// Throws InputError when the base is no JSON, or when every combination is refused, and support::MachineError.
Results run_study(const Study& study, const Registry& registry, const ReadOptions& read,
                  const ExecutionOptions& options);

}  // namespace mpm::study

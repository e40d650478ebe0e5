#pragma once
// Runs of a study: each a process of its own in a folder of its own, so that one that crashes is a result.

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "experiment/experiment.hpp"
#include "study/results.hpp"

namespace mpm::study {

/// One experiment that is to be run.
struct PreparedRun {
  std::string name;  ///< name of its folder below runs/
  Json experiment;   ///< experiment as resolved
  std::string key;   ///< hash of the experiment and of the programs that compute it
};

/// Names runs by what decides their results.
class KeyMaker {
 public:
  /// Reads the program. Throws support::MachineError when it cannot be read.
  explicit KeyMaker(const std::filesystem::path& program);
  std::string operator()(const Experiment& experiment);

 private:
  const std::string& hash_of(const std::filesystem::path& file);
  std::string program_;
  std::map<std::filesystem::path, std::string> hashes_;
};

/// Starts runs and says how they ended. Below its folder: runs/NAME, the run's folder; records/NAME.experiment.json,
/// what it was given; records/NAME.log, what it printed; records/NAME.json, its key and outcome.
class Runner {
 public:
  Runner(std::filesystem::path program, std::filesystem::path folder, int threads);
  /// Kills what still runs.
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  /// The outcome of an earlier call, when its run finished or failed with the same key and its numbers are there.
  std::optional<Outcome> earlier(const PreparedRun& run) const;
  /// Starts the process; it goes on from the checkpoint of a run with the same key that was stopped. Throws
  /// support::MachineError.
  void start(const PreparedRun& run);
  std::size_t running() const { return children_.size(); }

  struct Ended {
    std::string name;
    Outcome outcome;
  };
  /// A run that has ended; none when all still go on.
  std::optional<Ended> poll();
  /// Asks all to stop at the next step, once.
  void stop();

  std::filesystem::path run_folder(const std::string& name) const { return folder_ / "runs" / name; }
  /// Summary of a run; empty when there is none.
  Json summary(const std::string& name) const;

 private:
  struct Child {
    PreparedRun run;
    bool resumed = false;
  };
  std::filesystem::path record(const std::string& name, const char* ending) const;
  void write_record(const PreparedRun& run, const Outcome& outcome) const;
  bool can_go_on(const PreparedRun& run) const;
  void spawn(const PreparedRun& run, bool resumed);
  Outcome outcome_of(const std::string& name, int wait_status) const;
  std::string last_lines(const std::string& name) const;

  std::filesystem::path program_, folder_;
  int threads_;
  bool stopped_ = false;
  std::map<pid_t, Child> children_;
};

}  // namespace mpm::study

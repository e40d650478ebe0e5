#pragma once
// Checkpoints of a run: written now and then, on a signal and when the disk fails; read by `mpm run FILE --resume`.

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "run/recorder.hpp"
#include "run/summary.hpp"

namespace mpm::app {

/// The plugins that the experiment names, each once.
std::vector<const Plugin*> plugins_of(const Experiment& experiment);

/// The files that bodies are read from, each with its SHA-256.
nlohmann::ordered_json inputs_of(const Experiment& experiment);

/// What a checkpoint belongs to: version of the program, resolved experiment, files of the plugins and of bodies.
nlohmann::ordered_json identity_of(const Experiment& experiment);

/// The first place at which an experiment differs from a recorded one, with the values in few words.
struct ExperimentDifference {
  std::string pointer, now, then;
};
/// Nothing where they are the same. Titles, figures, expectations, the film, max_steps and the cadence of checkpoints
/// may differ: they change no number. Where the run is `resumed` the backend may differ too.
std::optional<ExperimentDifference> difference_to(const Experiment& experiment, const nlohmann::ordered_json& recorded,
                                                  bool resumed = false);

/// Refuses a run whose experiment is another one than `recorded` (a resolved experiment), naming the first difference
/// as JSON pointer (difference_to). Throws InputError.
void refuse_other_experiment(const Experiment& experiment, const nlohmann::ordered_json& recorded,
                             const output::RunFolder& folder);

/// Whether the run in the folder has come to its end (exit code 0 or 4), and the code it ended with.
std::optional<int> finished_with(const output::RunFolder& folder);

/// Puts simulation and recorder where the newest usable checkpoint was; an older one is taken, with a warning, when the
/// newest is damaged. Throws InputError and output::FolderRefused when there is none that fits.
EarlierParts restore_newest(Simulation& simulation, Recorder& recorder, const output::RunFolder& folder,
                            const nlohmann::ordered_json& identity);

/// Writes a run's checkpoints. The one before is kept beside the newest; a failure costs neither them nor the run.
class Checkpoints {
 public:
  /// Begins; keeps references. `start` is when this process began its part of the run.
  Checkpoints(const Simulation& simulation, Recorder& recorder, const output::RunFolder& folder,
              nlohmann::ordered_json identity, EarlierParts earlier, std::chrono::steady_clock::time_point start);

  /// Writes after a step when so many steps or seconds have passed as the experiment says.
  void write_if_due();
  /// Whether write_if_due() would write after so many steps.
  bool due(long steps) const;
  /// Writes now, unless this step has a checkpoint. Returns false when it could not be written; a warning says why.
  bool write();
  /// Removes the checkpoints: the run has ended and needs none any more.
  void remove();

  /// Whether there is a checkpoint that the run can be resumed from.
  bool any() const;
  /// What went wrong with the writing of checkpoints; empty when nothing did.
  const std::string& trouble() const { return trouble_; }

 private:
  void write_file();
  void remove_older() const;

  const Simulation& simulation_;
  Recorder& recorder_;
  const output::RunFolder& folder_;
  nlohmann::ordered_json identity_;
  EarlierParts earlier_;
  std::chrono::steady_clock::time_point start_, last_;
  long last_step_;
  bool failing_ = false;
  std::string trouble_;
};

}  // namespace mpm::app

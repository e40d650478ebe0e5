#pragma once
// Profiles along lines of probes: one CSV file a line, written at times of its own.

#include <filesystem>
#include <optional>
#include <vector>

#include "metrics/metrics.hpp"
#include "support/csv.hpp"

namespace mpm::app {

class Profiles {
 public:
  /// `folder` is where the files lie, probes/NAME.csv of a run folder. It keeps references.
  Profiles(const Simulation& simulation, const Metrics& metrics, std::filesystem::path folder);

  /// Makes the files, or goes on with those that are there.
  void start();
  /// Whether a profile is due at `time` (s).
  bool due(double time) const;
  /// Writes the profiles that are due.
  void record();

  /// Rows are on the disk when `save` returns. `restore` cuts off what was written after it, in place of `start`; it throws
  /// output::CheckpointDamaged where the files do not hold what was written before, having changed nothing.
  void save(ArchiveWriter& archive);
  void check(ArchiveReader& archive);
  void restore();

 private:
  /// A line with its file.
  struct Line {
    const ProbeSpecification* probe;
    std::filesystem::path file;
    std::optional<support::CsvAppender> csv = {};
    std::size_t taken = 0, bytes = 0;  ///< profiles written; length of the file at the checkpoint
  };
  bool due(const Line& line, double time) const;
  static void write(Line& line, const Profile& profile);

  const Simulation& simulation_;
  const Metrics& metrics_;
  std::filesystem::path folder_;
  std::vector<Line> lines_;
};

}  // namespace mpm::app

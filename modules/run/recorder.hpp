#pragma once
// What a run leaves in its folder while it goes on: rows of metrics.csv, frames, VTK files. Recording reads the state
// and changes nothing, so its cadence changes no result.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "metrics/metrics.hpp"
#include "output/record_file.hpp"
#include "output/run_folder.hpp"
#include "render/frame.hpp"
#include "run/particle_series.hpp"
#include "run/profiles.hpp"
#include "run/run_record.hpp"
#include "support/csv.hpp"

namespace mpm::app {

class Recorder {
 public:
  Recorder(const Simulation& simulation, const Metrics& metrics, const output::RunFolder& folder);

  /// The most threads that write files and draw frames; no byte depends on it.
  void use_threads(int threads);

  /// Begins metrics.csv. It is to be called, or `restore`, before anything is recorded.
  void start();

  /// Saves all that a recorder of the same run needs to go on as if it had recorded everything itself. Rows and
  /// snapshots are on the disk when it returns. Throws support::MachineError.
  void save(ArchiveWriter& archive);
  /// Takes the place of `start`: cuts off the rows written after `save`. Throws output::CheckpointDamaged when the
  /// folder does not hold what was recorded until then, having changed nothing in it, and ArchiveError.
  void restore(ArchiveReader& archive);

  /// Records what is due after a step (or before the first). `last` says that the run ends here, whatever is due.
  /// Recording the same step again does nothing, or what failed the first time (support::MachineError).
  void record(bool last = false);
  /// Whether anything is to be recorded at `time` (s) after so many steps.
  bool due(double time, long steps) const;
  /// Draws the frames, with one colour scale over all of them, and the film when asked for.
  void draw_frames();
  /// Seconds that files of particle data have taken.
  double particle_file_seconds() const { return particles_.seconds(); }

  /// What the rows so far came to.
  const RunRecord& rows() const { return rows_; }
  /// Says that the last step failed on its way.
  void break_off() { rows_.break_off(); }
  /// Says that the device has failed in the last step or after it: its particles can no longer be read.
  void lose_state() { rows_.break_off(), rows_.lose_state(); }

 private:
  struct Snapshot {
    double time;
    long step;
    std::vector<float> positions, values;
    std::vector<float> outlines;     ///< edges of rigid bodies in 2-D: from and to, four numbers a piece
    std::vector<float> domain_axes;  ///< domains of 2-D particles that carry one: four numbers a particle
    std::vector<ContactNode> contact_nodes = {};
    std::vector<float> half_sizes =
        {};  ///< of particles, m, where their number changes; else those of the end are right
  };
  void start_rows();
  bool frame_due(double time) const;
  void record_row();
  void record_frame();
  void write_vtk(std::size_t frame);
  /// Draws one frame into the template of all.
  void draw(render::ParticleFrame frame, const Snapshot& snapshot, std::size_t index,
            std::pair<double, double> range) const;
  render::ParticleFrame frame_template() const;

  const Simulation& simulation_;
  const Metrics& metrics_;
  const output::RunFolder& folder_;
  std::optional<support::CsvAppender> csv_;
  ParticleSeries particles_;
  int threads_ = 1;
  output::RecordFile kept_snapshots_;  ///< the first of snapshots_, for a resumed run
  long last_row_ = -1;
  std::size_t frames_taken_ = 0, frames_drawn_ = 0, bytes_held_ = 0;
  std::vector<Snapshot> snapshots_;
  std::vector<std::pair<double, std::string>> vtk_files_;
  RunRecord rows_;
  Profiles profiles_;
};

/// What `mpm run` does after a step: a function that makes, for a simulation, a recorder with a run folder of its own
/// below `folder`.
std::function<std::function<void()>(Simulation&)> recording_in(const std::filesystem::path& folder);

}  // namespace mpm::app

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
#include "support/csv.hpp"

namespace mpm::app {

class Recorder {
 public:
  Recorder(const Simulation& simulation, const Metrics& metrics, const output::RunFolder& folder);

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

  const Totals& latest() const { return latest_; }
  double largest_total_energy() const { return largest_energy_; }
  double smallest_volume_ratio() const { return smallest_J_; }
  double largest_volume_ratio() const { return largest_J_; }
  double largest_contact_force() const { return largest_contact_force_; }
  double largest_penetration() const { return largest_penetration_; }
  double momentum_scale() const { return momentum_scale_; }
  double angular_momentum_scale() const { return angular_momentum_scale_; }
  long most_contact_nodes() const { return most_contact_nodes_; }

 private:
  struct Snapshot {
    double time;
    long step;
    std::vector<float> positions, values;
    std::vector<float> domain_axes;  ///< domains of 2-D particles that carry one: four numbers a particle
  };
  bool frame_due(double time) const;
  void record_row();
  void record_frame();
  void write_vtk(std::size_t frame);
  void draw(const Snapshot& snapshot, std::size_t index, std::pair<double, double> range);
  render::ParticleFrame frame_template() const;

  const Simulation& simulation_;
  const Metrics& metrics_;
  const output::RunFolder& folder_;
  std::optional<support::CsvAppender> csv_;
  output::RecordFile kept_snapshots_;  ///< the first of snapshots_, for a resumed run
  long last_row_ = -1;
  std::size_t frames_taken_ = 0, frames_drawn_ = 0, bytes_held_ = 0;
  std::vector<Snapshot> snapshots_;
  std::vector<std::pair<double, std::string>> vtk_files_;
  Totals latest_;
  double largest_energy_ = 0, smallest_J_ = 1, largest_J_ = 1, largest_contact_force_ = 0, largest_penetration_ = 0;
  double momentum_scale_ = 0, angular_momentum_scale_ = 0;  ///< largest of the recorded rows
  long most_contact_nodes_ = 0;
};

/// What `mpm run` does after a step: a function that makes, for a simulation, a recorder with a run folder of its own
/// below `folder`.
std::function<std::function<void()>(Simulation&)> recording_in(const std::filesystem::path& folder);

}  // namespace mpm::app

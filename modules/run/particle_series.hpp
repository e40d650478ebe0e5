#pragma once
// The files of particle data that an experiment asks for under output/particles.

#include <string>
#include <utility>
#include <vector>

#include "output/run_folder.hpp"
#include "simulation/simulation.hpp"

namespace mpm::app {

class ParticleSeries {
 public:
  /// Keeps references. Files are written by at most `threads` threads; their bytes do not depend on it.
  ParticleSeries(const Simulation& simulation, const output::RunFolder& folder)
      : simulation_(simulation), folder_(folder) {}
  void use_threads(int threads) { threads_ = threads; }

  /// Whether files are to be written at this time (s). Times that one step passes share a file.
  bool due(double time) const;
  /// Writes the files of the present state when they are due. What fails (support::MachineError) is written by the next
  /// call.
  void record();

  void save(ArchiveWriter& archive) const;
  void restore(ArchiveReader& archive);

  /// Seconds that the files have taken, those of earlier parts of the run among them.
  double seconds() const { return seconds_; }

 private:
  using Files = std::vector<std::pair<double, std::string>>;  ///< times (s) and names
  void write(const std::vector<BodyState>& states, std::size_t index) const;
  void write_csv(const std::vector<BodyState>& states, const std::string& name) const;
  void write_grid(const std::vector<BodyState>& states, const std::string& name) const;

  const Simulation& simulation_;
  const output::RunFolder& folder_;
  int threads_ = 1;
  std::size_t times_passed_ = 0;
  Files particles_, grids_;
  double seconds_ = 0;
};

}  // namespace mpm::app

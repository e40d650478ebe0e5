// How far particles are out of the blocks of cells that the cpu backend has sorted them into.
#pragma once

#include <string>
#include <vector>

#include "simulation/saved_state.hpp"
#include "simulation/simulation.hpp"
#include "support/results.hpp"

namespace mpm::test {

/// How far any particle is out of the block of cells that it was sorted into, in cells.
inline double drift_in_checkpoint(const Simulation& simulation) {
  ArchiveWriter written;
  simulation.backend().save(written);
  ArchiveReader archive(written.bytes());
  restore_records(archive, simulation.backend());
  std::string arranged_by;
  std::vector<char> bytes;
  archive.get("arranged_by", arranged_by);
  archive.get("arrangement", bytes);
  ArchiveReader arrangement(bytes);
  double drift = 0;
  arrangement.get("drift", drift);
  return drift;
}

/// How often particles that fly by 0.1 cells a step are sorted in so many steps: each time their drift falls from the most
/// that a tile has room for.
inline int sorts_in(CpuRun& run, int steps) {
  int sorts = 0;
  double before = 0;
  for (int step = 0; step < steps; ++step) {
    run.steps(1);
    const double now = drift_in_checkpoint(run.simulation);
    sorts += before > 0.85 && now < 0.7;
    before = now;
  }
  return sorts;
}

}  // namespace mpm::test

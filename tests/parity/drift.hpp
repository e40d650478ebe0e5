// How far particles are out of the blocks of cells that the cpu backend has sorted them into.
#pragma once

#include <string>
#include <vector>

#include "simulation/saved_state.hpp"
#include "simulation/simulation.hpp"

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

}  // namespace mpm::test

// Particle snapshots as VTK XML files that ParaView and VTK read.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace mpm::output {

/// One quantity of every particle; the unit belongs into the name: "velocity (m/s)".
struct PointField {
  std::string name;
  int components = 1;
  std::vector<double> values;  ///< [particle][component], components varying fastest
};

struct ParticleSnapshot {
  int dimension = 3;              ///< 1, 2 or 3
  double time = 0.0;              ///< s
  std::vector<double> positions;  ///< m, [particle][axis], `dimension` numbers a particle
  std::vector<PointField> fields;
};

/// Writes an UnstructuredGrid (.vtu) with one vertex a particle and Float64 data, bit for bit.
///
/// Positions are padded to three components with zeros, and so are vectors of two components when dimension is 2,
/// because ParaView draws arrows of three. Names are escaped; an empty or repeated name gets a number. Throws
/// std::invalid_argument when a size does not match; MachineError when the file cannot be written.
void write_vtu(const std::filesystem::path& path, const ParticleSnapshot& snapshot);

/// Writes a ParaView collection (.pvd) of times (s) and file names relative to the collection's folder. It is rewritten
/// whole at each call, so that it lists complete files at any moment. Throws MachineError.
void write_pvd(const std::filesystem::path& path, const std::vector<std::pair<double, std::string>>& time_and_file);

}  // namespace mpm::output

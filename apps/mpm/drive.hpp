#pragma once
// The verb `drive`, and what `run` and `check` do with a file whose solver is a material point.

#include <filesystem>
#include <string>
#include <vector>

#include "mpm/cli.hpp"

namespace mpm::app {

struct DriveOptions {
  std::string id;                       ///< material
  std::vector<std::string> parameters;  ///< name=value each
  std::string path;                     ///< a standard path; empty: all
  bool extremes = false;                ///< in place of the paths: what becomes of it at extremes
  long cycles = 100000;                 ///< of the extremes
  std::string cell_size;                ///< of materials that read it, as typed
  double strain = 0.1;                  ///< largest displacement gradient
  double duration = 1;                  ///< s, of one way
  int steps = 100;                      ///< steps of one way
  int dimension = 0;                    ///< 0: 3 where the material can
  std::filesystem::path out;            ///< folder for a run folder a path; empty: the table alone
  bool replace = false;                 ///< whatever runs are there are replaced
  std::string command;                  ///< command as typed
};

/// Follows standard paths with a material and prints a row of each. Throws InputError and PluginError.
int drive_material(const DriveOptions& options);
/// Runs, and validates, a file whose solver is a material point. Throws InputError and FolderRefused.
int run_material_point(const RunOptions& options);
int check_material_point(const RunOptions& options);
/// Throws InputError where the base of a study is a material point.
void refuse_material_point(const std::filesystem::path& base, const std::filesystem::path& study,
                           const std::vector<std::string>& overrides);

}  // namespace mpm::app

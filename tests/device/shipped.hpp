// The experiments that the project ships: single runs, and what studies are made of.
#pragma once

#include <filesystem>
#include <set>

#include "device/device_support.hpp"
#include "drive/read_drive.hpp"
#include "experiment/located_json.hpp"
#include "mpm/cli.hpp"
#include "study/study.hpp"
#include "support/files.hpp"

namespace mpm::test {

/// Every experiment below experiments/, and the base of every study, each once. What `mpm bench` reads as a list of its
/// scenes is neither, and a material point has no backend.
inline std::vector<std::filesystem::path> shipped_experiments() {
  namespace fs = std::filesystem;
  const fs::path root = fs::path(MPM_SOURCE_DIR) / "experiments";
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const fs::path& file = entry.path();
    if (file.extension() != ".json" || file.filename() == "standard.json") continue;
    if (drive::is_material_point(file, {})) continue;
    files.insert(fs::weakly_canonical(study::is_study(read_located(file)) ? study::read_study(file).base : file));
  }
  return {files.begin(), files.end()};
}

inline std::string shipped_name(const std::filesystem::path& file) {
  return file.lexically_relative(std::filesystem::path(MPM_SOURCE_DIR) / "experiments").string();
}

/// Whether it is one of the standard scenes of `mpm bench`, of a million particles.
inline bool is_standard(const std::filesystem::path& file) {
  return file.parent_path().filename() == "benchmarks";
}

/// Reads a shipped experiment for a backend. The standard scenes are coarsened as under `mpm bench --quick`.
inline Experiment read_shipped(const std::filesystem::path& file, const std::string& backend,
                               const std::vector<std::string>& more = {}) {
  ReadOptions options = app::read_options(plugins(), {});
  options.overrides = {"/backend=" + backend};
  if (is_standard(file)) {
    const bool flat = file.filename().string().rfind("block_2d", 0) == 0;
    const double coarser = flat ? 8 : 4;
    for (const char* pointer : {"/grid/cell_size", "/solver/time_step"}) {
      const double value = nlohmann::json::parse(support::read_file(file), nullptr, true, true)
                               .at(nlohmann::json::json_pointer(pointer));
      options.overrides.push_back(std::string(pointer) + "=" + digits(coarser * value));
    }
  }
  options.overrides.insert(options.overrides.end(), more.begin(), more.end());
  return read_experiment(file, plugins(), options);
}

}  // namespace mpm::test

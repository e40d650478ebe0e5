// One file that holds all a run needs to go on: what it belongs to, as JSON, and the state, as bytes.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace mpm::output {

/// The file is no whole checkpoint that this program reads. what() names the path and the reason.
class CheckpointDamaged : public std::runtime_error {
 public:
  CheckpointDamaged(const std::filesystem::path& path, const std::string& reason)
      : std::runtime_error(path.string() + " " + reason) {}
};

struct CheckpointFile {
  nlohmann::ordered_json identity;  ///< what the state belongs to
  std::string state;
};

/// Writes the file whole or not at all; it is on the disk when this returns. Its layout is: magic, format version, byte
/// order, both lengths, SHA-256 of all the rest in hexadecimal, identity, state. Throws MachineError.
void write_checkpoint(const std::filesystem::path& path, const nlohmann::ordered_json& identity,
                      std::string_view state);

/// Reads a checkpoint. Throws CheckpointDamaged when the file is of another kind, format or byte order, cut short or
/// changed, and MachineError when it cannot be read.
CheckpointFile read_checkpoint(const std::filesystem::path& path);

/// The name of a step's file, "step_000000001200.checkpoint": the order of names is that of steps.
std::string checkpoint_name(long step);

/// Checkpoints in a folder, newest first; none when there is no folder.
std::vector<std::filesystem::path> checkpoints_in(const std::filesystem::path& folder);

}  // namespace mpm::output

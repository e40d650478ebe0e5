// A film from the particle frames, where ffmpeg is installed.
#pragma once

#include <filesystem>
#include <optional>

namespace mpm::output {

/// Joins every .png of `frames_folder`, in the order of the numbers in their names, into `target` (.mp4: H.264, .webm:
/// VP9). Returns the target's path, or nothing when ffmpeg is not on PATH or there is no frame. Throws
/// std::invalid_argument for another ending or a rate below 1, and MachineError with ffmpeg's last lines when it fails
/// (no half-written film is left).
std::optional<std::filesystem::path> write_film(const std::filesystem::path& frames_folder,
                                                const std::filesystem::path& target, int frames_per_second);

}  // namespace mpm::output

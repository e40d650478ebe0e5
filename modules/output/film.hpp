// A film from the particle frames, where ffmpeg is installed.
#pragma once

#include <filesystem>
#include <optional>

namespace mpm::output {

/// The rate of a run's film.
inline constexpr int frames_per_second = 20;

/// What is said where ffmpeg is missing.
inline constexpr const char* no_ffmpeg =
    "no film: ffmpeg is not installed (apt-get install ffmpeg); the frames are there";

/// Joins every .png of `frames_folder`, in the order of the numbers in their names, into `target` (.mp4: H.264, .webm:
/// VP9, .webp: animated, at most 640 pixels wide, over and over with a rest of a second at the end). Returns the
/// target's path, or nothing when ffmpeg is not on PATH or there is no frame. Throws std::invalid_argument for another
/// ending or a rate below 1, and MachineError when ffmpeg fails, also for want of an encoder, with its last lines and what
/// is to be done; no half-written film is left.
std::optional<std::filesystem::path> write_film(const std::filesystem::path& frames_folder,
                                                const std::filesystem::path& target, int frames_per_second);

}  // namespace mpm::output

#pragma once
// `mpm drive --extremes`: what becomes of materials that are crushed, torn, drawn, pressed flat and sheared.

#include "experiment/experiment.hpp"
#include "mpm/drive.hpp"

namespace mpm::app {

/// Prints a row of each extreme of a material. Returns the exit code. Throws FolderRefused and std::runtime_error where
/// figures are asked for and cannot be written.
int drive_to_extremes(const DriveOptions& options, const Component& material, int dimension);
/// Prints a row of each material that is installed: what it answers at the extremes, or where it fails. The same.
int drive_every_to_extremes(const DriveOptions& options);

}  // namespace mpm::app

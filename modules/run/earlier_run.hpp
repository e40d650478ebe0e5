#pragma once
// What an earlier run at the place of a new one means for it.

#include <filesystem>

#include "experiment/experiment.hpp"
#include "output/run_folder.hpp"

namespace mpm::app {

/// The folder of a new run. Results of the same experiment are replaced, and standard error says so. Results of another
/// experiment, and an unfinished run that could go on from a checkpoint, are replaced only with `replace`: else throws
/// output::FolderRefused with the remedies, having touched nothing. Throws as RunFolder::create and RunFolder::replace.
output::RunFolder folder_for_new_run(const std::filesystem::path& place, const Experiment& experiment, bool replace);

}  // namespace mpm::app

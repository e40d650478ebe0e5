// The page a run leaves behind: what was computed, whether it can be trusted, and how to do it again.
#pragma once

#include <filesystem>

namespace mpm::output {

/// Writes run_folder/report.html from what the folder holds: experiment.json, manifest.json, summary.json, plan.json
/// (each may be missing or cut), figures/*.svg or *.png and frames/*.png. The page is one file without scripts that
/// loads nothing. Every key of summary.json appears: those the report does not know as plain tables. Throws
/// MachineError when a picture cannot be read or the page cannot be written.
void write_report(const std::filesystem::path& run_folder);

}  // namespace mpm::output

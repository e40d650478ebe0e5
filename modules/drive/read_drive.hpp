#pragma once
// Reads experiment files whose solver is a material point.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "drive/drive.hpp"
#include "experiment/read.hpp"

namespace mpm::drive {

/// The word under /solver/type.
inline constexpr const char* solver_name = "material_point";

/// Whether the file's solver is a material point, after overrides. Throws InputError where the file is no JSON.
bool is_material_point(const std::filesystem::path& file, const std::vector<std::string>& overrides);

/// Reads, checks and resolves the experiment. Throws InputError with every problem found.
DriveExperiment read_drive(const std::filesystem::path& file, const ComponentLookup& components,
                           const std::vector<std::string>& overrides);
/// The same from text; `file` names it in messages.
DriveExperiment read_drive_text(std::string_view text, const std::filesystem::path& file,
                                const ComponentLookup& components, const std::vector<std::string>& overrides = {});

}  // namespace mpm::drive

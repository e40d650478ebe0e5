#pragma once
// report.html of a study.

#include <filesystem>
#include <string>
#include <vector>

#include "study/results.hpp"

namespace mpm::study {

/// Writes folder/report.html: outcome, tables and the figures of folder/figures in one file that loads nothing.
/// `troubles` says what could not be drawn. Throws support::MachineError.
void write_report(const Results& results, const Json& machine, const std::string& version,
                  const std::vector<std::string>& troubles, const std::filesystem::path& folder);

}  // namespace mpm::study

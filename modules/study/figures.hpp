#pragma once
// Figures of a study from its results.

#include <filesystem>
#include <string>
#include <vector>

#include "study/results.hpp"

namespace mpm::study {

/// Draws every figure the study asks for into `folder`/figures; curves come from the runs in `folder`. Returns a
/// sentence for each that could not be drawn.
std::vector<std::string> draw_figures(const Results& results, const std::filesystem::path& folder);

/// The outcome of a run in few words: "bounded", "gained energy", "stopped: left the grid".
std::string outcome_words(const Result& result);

}  // namespace mpm::study

#pragma once
// What the sources that draw a study's figures share.

#include <cstddef>
#include <filesystem>
#include <string>

#include "study/results.hpp"

namespace mpm::study {

/// The count with its noun: "12 runs".
std::string count_of(std::size_t count, const std::string& what);

/// What a figure says at its foot: where it comes from, and what it leaves out.
std::string footnote(const Results& results, const FigureRequest& figure, bool finished_only);

/// The figure's own title, else the study's: the axes say what is shown.
std::string title_of(const Results& results, const FigureRequest& figure);

/// Draws one heat map for each choice on the axes that no map shows.
void draw_heat_maps(const Results& results, const FigureRequest& figure, const std::filesystem::path& stem);

/// Draws what became of each run, a row for each choice on the other axes.
void draw_outcome_map(const Results& results, const FigureRequest& figure, const std::filesystem::path& stem);

}  // namespace mpm::study

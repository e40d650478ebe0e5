#pragma once
// The numbers beside a figure that was drawn anew, and those beside the figure that a page shows.

#include <filesystem>
#include <string>

#include "support/catch.hpp"
#include "support/csv.hpp"

namespace mpm::test {

/// Checks a figure's table against figures/studies/PAGE cell by cell: its values to `epsilon` of themselves, all else as
/// it is written.
inline void check_figure_data(const std::filesystem::path& drawn_file, const std::string& page_file, double epsilon) {
  constexpr std::size_t values = 4;  // the column after panel, series, kind and place
  const auto drawn = support::read_csv_cells(drawn_file);
  const auto page = support::read_csv_cells(MPM_SOURCE_DIR "/figures/studies/" + page_file);
  REQUIRE(drawn.size() == page.size());
  for (std::size_t row = 0; row < page.size(); ++row) {
    INFO("row " << row);
    REQUIRE(drawn[row].size() == page[row].size());
    for (std::size_t cell = 0; cell < page[row].size(); ++cell)
      if (row > 0 && cell == values)
        CHECK(std::stod(drawn[row][cell]) == Approx(std::stod(page[row][cell])).epsilon(epsilon));
      else
        CHECK(drawn[row][cell] == page[row][cell]);
  }
}

}  // namespace mpm::test

#pragma once
// Figures of a run drawn from its recorded numbers, so that they can be drawn again, and several runs laid over one
// another.

#include <filesystem>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "support/csv.hpp"

namespace mpm::app {

/// The names that are valid under "figures" of an experiment.
std::vector<std::string> figure_names();

/// What a figure says of the run at its foot and in its title.
struct RunLabel {
  std::string title, footnote;
};

/// Draws the named figures of one run into `folder` (made when missing). A figure whose columns the run did not record
/// is refused with std::runtime_error naming what to switch on.
void draw_figures(const std::vector<std::string>& names, const support::Table& metrics, const RunLabel& label,
                  const std::filesystem::path& folder);

/// The same of figures of columns.
void draw_figures(const std::vector<ColumnFigure>& figures, const support::Table& metrics, const RunLabel& label,
                  const std::filesystem::path& folder);

/// Refuses an experiment whose figures, expectations, probes or groups name what no run of it records, at the place of the
/// name and with the nearest one that there is. Throws InputError.
void refuse_unknown_records(const Experiment& experiment);

/// The reason a figure cannot be drawn from these columns, or an empty string.
std::string missing_for(const std::string& name, const support::Table& metrics);

}  // namespace mpm::app

#pragma once
// What a followed path leaves behind: a table, a summary, figures.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drive/drive.hpp"
#include "render/plot.hpp"

namespace mpm::drive {

/// Names of the columns of metrics.csv with their units.
std::vector<std::string> headings(const DriveExperiment& path, const Course& course);
/// The row as numbers, in the order of the headings.
std::vector<double> numbers(const DriveExperiment& path, const Course& course, const Row& row);

/// The hydrostatic pressure -tr(sigma)/3, Pa, and von Mises' equivalent stress, Pa.
double pressure(const Response& response);
double von_mises_stress(const Response& response);

/// What the work left unexplained: work less what was stored since the start and dissipated, J/m^3.
double residual(const Course& course, const Row& row);
/// The work's turnover, J/m^3: the sum of the sizes of its steps. A residual is small or large against it.
double turnover(const Course& course);

/// The component of F that the figure of stress against strain has along x: of those that the path imposes the one that
/// changes most, of all where it imposes none that changes.
std::pair<int, int> driven_component(const DriveExperiment& path, const Course& course);

nlohmann::ordered_json summary_of(const DriveExperiment& path, const Course& course);

/// Writes metrics.csv. Throws MachineError.
void write_table(const DriveExperiment& path, const Course& course, const std::filesystem::path& file);

/// Stress against strain, stress and energies over time. `footnote` names the experiment.
render::Plot stress_figure(const DriveExperiment& path, const Course& course, const std::string& footnote);
render::Plot stress_over_time_figure(const DriveExperiment& path, const Course& course, const std::string& footnote);
render::Plot energy_figure(const DriveExperiment& path, const Course& course, const std::string& footnote);

}  // namespace mpm::drive

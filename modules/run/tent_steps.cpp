#include "run/tent_steps.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "plugin/extension_of.hpp"

namespace mpm::app {
namespace {

constexpr std::array rows{TentStep{2, "pic", "", 0.086}, TentStep{2, "pic", "xpic", 0.087},
                          TentStep{2, "pic", "fmpm", 0}, TentStep{2, "aflip", "", 0},
                          TentStep{2, "polypic", "", 0}, TentStep{3, "flip", "", 0},
                          TentStep{3, "polypic", "", 0}};

}  // namespace

std::span<const TentStep> tent_steps() {
  return rows;
}

std::string warning_of_tent_steps(const Experiment& experiment) {
  if (experiment.shape.plugin->id() != "linear" || experiment.solver.time_step ||
      experiment.solver.stress_update != StressUpdate::last)
    return "";
  const std::string_view filter = experiment.filter ? experiment.filter->plugin->id() : std::string_view();
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const TentStep& now) {
    return now.dimension == experiment.dimension && now.filter == filter &&
           now.transfer == experiment.transfer.plugin->id();
  });
  if (row == rows.end()) return "";
  double taken = experiment.solver.courant;
  if (const auto* limits = extension_of<mpm_shape_courant_limit>(*experiment.shape.plugin))
    taken = std::min(taken, limits->limit[experiment.dimension - 2][MPM_GRID_VELOCITY]);
  if (taken <= row->largest) return "";
  char largest[32];
  std::snprintf(largest, sizeof largest, "%.3g", row->largest);
  return "shape \"linear\" with transfer \"" + std::string(row->transfer) + "\"" +
         (filter.empty() ? "" : " and filter \"" + std::string(filter) + "\"") + " stood " +
         (row->largest > 0 ? "courant " + std::string(largest) + " at most" : "no step") +
         " in the study of largest steps: a particle without neighbours near a node may make it unstable at any step; "
         "take another shape, or /solver/stress_update \"modified_last\" (docs/studies/extremes.md)";
}

}  // namespace mpm::app

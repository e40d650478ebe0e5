#include "run/tent_steps.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "solvers/solver.hpp"

namespace mpm::app {
namespace {

constexpr std::array rows{TentStep{2, "pic", "", 0.086}, TentStep{2, "pic", "xpic", 0.087},
                          TentStep{2, "pic", "fmpm", 0}, TentStep{2, "aflip", "", 0},
                          TentStep{2, "polypic", "", 0}, TentStep{3, "flip", "", 0},
                          TentStep{3, "polypic", "", 0}};

constexpr std::array collision_rows{TentCollisions{2, StressUpdate::last, "flip", "", {4, 2, 4, 1}},
                                    TentCollisions{2, StressUpdate::last, "aflip", "", {5, 2, 1, 1}},
                                    TentCollisions{2, StressUpdate::last, "asflip", "", {5, 4, 2, 0}},
                                    TentCollisions{2, StressUpdate::last, "polypic", "", {0, 0, 0, 0}},
                                    TentCollisions{2, StressUpdate::last, "pic", "fmpm", {3, 0, 0, 0}},
                                    TentCollisions{2, StressUpdate::last, "pic", "xpic", {5, 5, 2, 0}},
                                    TentCollisions{2, StressUpdate::first, "polypic", "", {0, 0, 0, 0}},
                                    TentCollisions{2, StressUpdate::modified_last, "asflip", "", {4, 4, 3, 2}},
                                    TentCollisions{2, StressUpdate::modified_last, "apic", "", {5, 5, 1, 2}},
                                    TentCollisions{2, StressUpdate::modified_last, "mls", "", {5, 5, 1, 2}},
                                    TentCollisions{2, StressUpdate::modified_last, "tpic", "", {5, 5, 1, 2}},
                                    TentCollisions{2, StressUpdate::modified_last, "polypic", "", {1, 0, 0, 0}},
                                    TentCollisions{2, StressUpdate::averaged, "aflip", "", {4, 5, 3, 2}},
                                    TentCollisions{2, StressUpdate::averaged, "asflip", "", {3, 3, 3, 2}},
                                    TentCollisions{2, StressUpdate::averaged, "apic", "", {5, 4, 5, 2}},
                                    TentCollisions{2, StressUpdate::averaged, "mls", "", {5, 4, 5, 2}},
                                    TentCollisions{2, StressUpdate::averaged, "tpic", "", {5, 4, 5, 2}},
                                    TentCollisions{2, StressUpdate::averaged, "polypic", "", {0, 0, 1, 0}},
                                    TentCollisions{2, StressUpdate::averaged, "pic", "fmpm", {4, 4, 3, 0}},
                                    TentCollisions{3, StressUpdate::last, "aflip", "", {5, 4, 4, 2}},
                                    TentCollisions{3, StressUpdate::last, "asflip", "", {5, 5, 3, 0}},
                                    TentCollisions{3, StressUpdate::last, "polypic", "", {0, 0, 0, 0}},
                                    TentCollisions{3, StressUpdate::last, "pic", "fmpm", {4, 4, 3, 1}},
                                    TentCollisions{3, StressUpdate::last, "pic", "xpic", {5, 5, 3, 2}},
                                    TentCollisions{3, StressUpdate::first, "polypic", "", {0, 0, 1, 0}},
                                    TentCollisions{3, StressUpdate::modified_last, "polypic", "", {1, 0, 1, 1}},
                                    TentCollisions{3, StressUpdate::averaged, "polypic", "", {0, 3, 1, 0}},
                                    TentCollisions{3, StressUpdate::averaged, "pic", "fmpm", {4, 3, 4, 1}}};

/// What the study of largest steps found of a scheme that takes a longer step, else "".
std::string what_it_stood(int dimension, std::string_view transfer, std::string_view filter, StressUpdate update,
                          double taken) {
  if (update != StressUpdate::last) return "";
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const TentStep& now) {
    return now.dimension == dimension && now.filter == filter && now.transfer == transfer;
  });
  if (row == rows.end() || taken <= row->largest) return "";
  char largest[32];
  std::snprintf(largest, sizeof largest, "%.3g", row->largest);
  return " stood " + (row->largest > 0 ? "courant " + std::string(largest) + " at most" : std::string("no step")) +
         " in the study of largest steps";
}

/// How many of five collisions were bounded at the step that is taken, where that is fewer than half, else "".
std::string what_collisions_did(int dimension, std::string_view transfer, std::string_view filter, StressUpdate update,
                                double taken) {
  const auto row = std::find_if(collision_rows.begin(), collision_rows.end(), [&](const TentCollisions& now) {
    return now.dimension == dimension && now.update == update && now.filter == filter && now.transfer == transfer;
  });
  if (row == collision_rows.end()) return "";
  std::size_t k = 0;
  while (k + 1 < TentCollisions::steps.size() && TentCollisions::steps[k + 1] <= taken * (1 + 1e-9)) ++k;
  if (row->bounded[k] > 2) return "";
  char text[120];
  std::snprintf(text, sizeof text, " was bounded in %d of five collisions at courant %g, in %d at %g", row->bounded[k],
                TentCollisions::steps[k], row->bounded[0], TentCollisions::steps[0]);
  return text;
}

}  // namespace

std::span<const TentStep> tent_steps() {
  return rows;
}

std::span<const TentCollisions> tent_collisions() {
  return collision_rows;
}

std::string warning_of_tent_steps(const Experiment& experiment) {
  if (experiment.shape.plugin->id() != "linear" || experiment.solver.time_step) return "";
  const std::string_view filter = experiment.filter ? experiment.filter->plugin->id() : std::string_view(),
                         transfer = experiment.transfer.plugin->id();
  const StressUpdate update = experiment.solver.stress_update;
  constexpr double speed = 1;
  const double taken = solver_of(experiment).limit(experiment, {speed}).seconds * speed / experiment.grid.cell_size;
  const std::string stood = what_it_stood(experiment.dimension, transfer, filter, update, taken),
                    met = what_collisions_did(experiment.dimension, transfer, filter, update, taken);
  if (stood.empty() && met.empty()) return "";
  return "shape \"linear\" with transfer \"" + std::string(transfer) + "\"" +
         (filter.empty() ? "" : " and filter \"" + std::string(filter) + "\"") + stood +
         (stood.empty() || met.empty() ? "" : " and") + met +
         ": a particle without neighbours near a node may make it unstable at any step; take another shape, or "
         "/solver/stress_update \"modified_last\" with transfer \"pic\", \"flip\" or \"rpic\" "
         "(docs/studies/extremes.md)";
}

}  // namespace mpm::app

#pragma once
// What a scene requires, counted: bytes, passes, calls at the plugin boundary, machine instructions. Nothing is timed,
// so two scenes that require the same give the same numbers.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/counting/single_step.hpp"
#include "simulation/simulation.hpp"

namespace mpm::counting {

/// Calls by what they ask for: "shape", "shape: gradients", "material: stress" ... Entries that are zero are absent.
using Calls = std::map<std::string, long>;

/// A scene that is counted: the base scene with these overrides (experiment/read.hpp).
struct RequiredScene {
  std::string name;
  std::vector<std::string> overrides;
};

struct RequiredRow {
  std::string name;
  std::uint64_t bytes_per_particle = 0, bytes_per_node = 0;  ///< what the plan says
  std::uint64_t particle_bytes = 0, grid_bytes = 0;          ///< what the backend holds
  std::vector<std::string> channels, passes;                 ///< what the plan says, groups and repeats unfolded
  Calls calls;                                               ///< calls of the counted steps
  long steps = 0;                                            ///< number of counted steps
  std::size_t particles = 0;
  /// Instructions of the counted steps of the same scene in 2-D; none where the machine refuses to single-step.
  std::optional<Instructions> instructions;
  std::size_t stepped_particles = 0;  ///< particles of the scene that was single-stepped
  /// Instructions of one particle in one step.
  std::optional<double> instructions_per_particle_step() const {
    if (!instructions) return std::nullopt;
    return static_cast<double>(instructions->all) /
           (static_cast<double>(steps) * static_cast<double>(stepped_particles));
  }
};

/// What is done after every step, made for one simulation (a recorder, say); may be empty.
using AfterStep = std::function<std::function<void()>(Simulation&)>;

/// Two blocks side by side that are counted: float, mls, bspline_quadratic, neo_hookean, nothing recorded.
std::string required_base_scene(int dimension);
/// The base scene alone, the base scene with outputs that do not fall due, and the base scene with one choice more
/// each.
std::vector<RequiredScene> required_scenes();

/// Counts each scene on the cpu backend with one thread. Throws InputError for a scene that cannot be read.
std::vector<RequiredRow> count_required(const Registry& registry, const std::vector<RequiredScene>& scenes,
                                        const AfterStep& after_step = {});

/// A table in Markdown, with a remark where instructions could not be counted.
std::string to_text(const std::vector<RequiredRow>& rows);

}  // namespace mpm::counting

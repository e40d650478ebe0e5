#pragma once
// What a run warns of: where the method is known to fail, and where its own numbers say that something is wrong. Every
// warning names its page.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run/run_record.hpp"

namespace mpm::app {

/// A run warns where it has lost more than this share of its energy without a physical cause, or without any.
inline constexpr double much_energy = 0.25;

/// All warnings of a run that has ended. `summary` holds its energies.
std::vector<std::string> warnings_of(const Simulation& simulation, const Metrics& metrics, const RunRecord& rows,
                                     const nlohmann::ordered_json& summary);

}  // namespace mpm::app

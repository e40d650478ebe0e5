// Checks of the parameters that a plugin refuses.

#include <algorithm>
#include <cstring>

#include "conformance/support.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::conformance {
namespace {

/// Whether a value lies in the range of the number that has a place in the block; a cell size is above 0.
bool is_in_range(const Plugin& plugin, std::size_t place, double value) {
  for (const mpm_parameter& p : plugin.parameters()) {
    if (p.offset / sizeof(double) != place) continue;
    if (p.type != MPM_NUMBER) return false;
    return (p.flags & MPM_ABOVE_MINIMUM ? value > p.minimum : value >= p.minimum) &&
           (p.flags & MPM_BELOW_MAXIMUM ? value < p.maximum : value <= p.maximum);
  }
  return value > 0;
}

/// Whether a block with another value in one place is refused for the same parameter.
bool refuses(const Plugin& plugin, ParameterSample sample, int place, double value, const char* parameter) {
  sample.block[static_cast<std::size_t>(place)] = value;
  const mpm_refusal refusal = refusal_of(plugin, sample);
  return refusal.parameter && std::strcmp(refusal.parameter, parameter) == 0;
}

}  // namespace

/// Takes samples that are accepted and scales each parameter, so that some are refused: each refusal names a parameter, says
/// why, and its limit stands between values that are refused and those that are not.
void check_refusals(const Plugin& plugin, Findings& findings) {
  const auto* table = extension_of<mpm_refusals>(plugin);
  if (!table) return;
  findings.require("refusal_entry", table->ask != nullptr, "asks");
  if (!table->ask) return;
  Random random(20240613);
  bool accepted = true, named = true, explained = true, limited = true, repeatable = true;
  int refused = 0;
  std::string where;
  for (const ParameterSample& sample : sample_parameters(plugin, random)) {
    findings.running("refusals; " + sample.text);
    accepted &= refusal_of(plugin, sample).parameter == nullptr;
    for (std::size_t changed = 0; changed < sample.block.size(); ++changed)
      for (const double factor : {-1.0, 1e-3, 1e3, 1e6}) {
        ParameterSample other = sample;
        other.block[changed] *= factor;
        if (!is_in_range(plugin, changed, other.block[changed])) continue;
        const mpm_refusal refusal = refusal_of(plugin, other), again = refusal_of(plugin, other);
        if (!refusal.parameter) continue;
        ++refused;
        repeatable &= again.parameter == refusal.parameter && again.why == refusal.why &&
                      std::memcmp(&again.limit, &refusal.limit, sizeof(double)) == 0;
        explained &= refusal.why && *refusal.why;
        const int place = place_of(plugin, refusal);
        named &= place >= 0;
        if (place < 0 || !std::isfinite(refusal.limit)) continue;
        const double value = other.block[static_cast<std::size_t>(place)];
        const double away = value > refusal.limit ? 1 : -1;
        const double aside = away * (refusal.limit != 0 ? 1e-9 * std::abs(refusal.limit) : 1e-6 * std::abs(value));
        const double inside = refusal.limit != 0 ? refusal.limit - aside : 0;  // 0 may be the only value left
        const bool stands = !refuses(plugin, other, place, inside, refusal.parameter) &&
                            refuses(plugin, other, place, refusal.limit + aside, refusal.parameter);
        if (limited && !stands)
          where =
              "; " + sample.text + ", parameter " + std::to_string(changed + 1) + " times " + std::to_string(factor);
        limited &= stands;
      }
  }
  findings.require("refusal_leaves_values", accepted, "limits lead to parameters that are accepted");
  findings.require("refusal_refuses", refused > 0, "some parameters within a million times those of samples");
  findings.require("refusal_names_parameter", named, "a declared one, or cell_size of a material that reads it");
  findings.require("refusal_says_why", explained, "in words");
  findings.require("refusal_limit", limited, "what lies beyond it is refused, what lies before it is not" + where);
  findings.require("refusal_repeatable", repeatable, "the same at every call");
}

}  // namespace mpm::conformance

#pragma once
// Conformance: what every plugin of a kind must satisfy, measured through its C entry points only, so that the same
// suite judges the components shipped here and those of others (`mpm test-plugin`).

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/registry.hpp"

namespace mpm {

/// The worst case of one check over all samples of inputs and parameters.
struct ConformanceFinding {
  std::string check;  ///< name, with precision and dimension where they matter: "partition_of_unity [lanes float, 2-D]"
  bool passed = false;
  double measured = 0;
  double bound = 0;    ///< infinite for a quantity that is only reported
  std::string detail;  ///< what was computed and where the worst case lies
};

/// A listener that is told what is about to be run, "energy balance [scalar double, 2-D]; density=1000", so that a
/// plugin that never returns from it can be reported.
using ConformanceProgress = std::function<void(std::string_view)>;

/// Runs every check of the plugin's kind with seeded random inputs, which give the same findings at every call.
std::vector<ConformanceFinding> check_plugin(const Plugin& plugin, const ConformanceProgress& progress = {});

/// The finding as one line for a person: "FAILED gradient_sum [lanes float, 2-D]: measured 0.5, bound 1e-06 (...)".
std::string to_string(const ConformanceFinding& finding);

}  // namespace mpm

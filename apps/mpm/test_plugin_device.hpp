#pragma once
// A plugin's functor as a device's kernels call it, beside the same functor in the plugin's file.

#include "conformance/conformance.hpp"

namespace mpm::app {

/// Runs small scenes with the plugin on backend "cuda" and on the reference backend, and compares the particles: on the
/// host driver, and on device 0 where there is one. What cannot be run for want of a compiler, or because the plugin
/// carries no text, is a finding that passes and says so; a text that does not compile is one that fails.
std::vector<ConformanceFinding> check_plugin_on_device(const Plugin& plugin, const ConformanceProgress& progress);

}  // namespace mpm::app

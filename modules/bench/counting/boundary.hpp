#pragma once
// Counts what a run asks of its plugins: every call at the boundary, and every output that a call requests.

#include <memory>
#include <vector>

#include "bench/counting/required.hpp"
#include "experiment/read.hpp"

namespace mpm::counting {

/// Plugins of a registry whose functions count their calls and then do what they always do. They serve one set at a
/// time, one thread, and scenes of one material.
class CountedPlugins {
 public:
  explicit CountedPlugins(const Registry& registry);
  CountedPlugins(const CountedPlugins&) = delete;
  ~CountedPlugins();

  ComponentLookup lookup() const;
  /// Counts the calls of this experiment from here on; it was read with `lookup`.
  void attach(const Experiment& experiment) const;
  void clear() const;
  Calls calls() const;

 private:
  struct Copy;
  std::vector<std::unique_ptr<Copy>> copies_;
};

}  // namespace mpm::counting

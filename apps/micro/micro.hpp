#pragma once
// What the micro-benchmarks share: batch arrays as the cpu backend lays them out, and how a benchmark is registered.

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "conformance/support.hpp"
#include "plugin/abi.h"
#include "plugin/registry.hpp"

namespace mpm::micro {

inline constexpr int batch = MPM_BATCH;  ///< particles, nodes or pairs of one call

enum class Element { single_precision, double_precision, index };

/// An array [component][64] of float, double or int32, on lines of the cache. An empty one gives a null pointer.
class Buffer {
 public:
  Buffer() = default;
  Buffer(Element element, int components)
      : element_(element), lines_(static_cast<std::size_t>(components * batch) * bytes() / sizeof(Line)) {}

  void* data() { return lines_.empty() ? nullptr : lines_.data(); }
  void set(int component, int lane, double value) {
    if (element_ == Element::single_precision)
      static_cast<float*>(data())[component * batch + lane] = static_cast<float>(value);
    else
      static_cast<double*>(data())[component * batch + lane] = value;
  }
  int components() const { return static_cast<int>(lines_.size() * sizeof(Line) / bytes()) / batch; }
  /// Whether all entries are numbers; indices always are.
  bool finite() {
    bool all = true;
    for (int k = 0; k < components() * batch; ++k)
      if (element_ == Element::single_precision)
        all &= std::isfinite(static_cast<float*>(data())[k]);
      else if (element_ == Element::double_precision)
        all &= std::isfinite(static_cast<double*>(data())[k]);
    return all;
  }
  void copy_from(const Buffer& other) { std::memcpy(lines_.data(), other.lines_.data(), lines_.size() * sizeof(Line)); }

 private:
  struct alignas(64) Line {
    unsigned char bytes[64];
  };
  std::size_t bytes() const { return element_ == Element::double_precision ? 8 : 4; }
  Element element_ = Element::double_precision;
  std::vector<Line> lines_;
};

/// A field that a call changes in place: it is put back before every call, so that no number of calls drifts away. The
/// copy is of cached memory, a cycle or so a particle.
struct Restored {
  Buffer field, start;
  void keep() { start = field; }
  void restore() { field.copy_from(start); }
};

/// The number of benchmarks that could not be measured, for the exit code.
int& failures();

/// Registers a benchmark of `make()`: an object with `run()`, one call for 64 items, and `problem()`, empty when the
/// outputs of a first call are sound.
template <class Make>
void add(const std::string& name, const std::string& item, Make make) {
  const auto measure = [make, item](benchmark::State& state) {
    auto measured = make();
    measured.run();
    const std::string problem = measured.problem();
    if (!problem.empty()) {
      ++failures();
      state.SkipWithError(problem.c_str());
      return;
    }
    for (auto _ : state) {
      measured.run();
      benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * batch);
    state.counters["per_" + item] = benchmark::Counter(
        batch, benchmark::Counter::Flags(benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert));
  };
#ifndef __clang_analyzer__  // the analyser takes the library's list of benchmarks for a leak
  benchmark::RegisterBenchmark(name.c_str(), measure);
#endif
}

/// The name of a variant: "2-D/float".
inline std::string variant_name(int dimension, bool single) {
  return std::to_string(dimension) + "-D/" + (single ? "float" : "double");
}

/// Batch entries of every plugin, named kind/id/dimension/precision/entry. The registry must outlive the run.
void add_plugins(const Registry& registry);
/// Adds the tile kernels and quads of the cpu backend.
void add_tiles();
/// Adds decompositions and elementary functions over lanes.
void add_functions();

}  // namespace mpm::micro

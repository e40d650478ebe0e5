#pragma once
// Measures what passes over particles spend their time on. While it is off, a lap is one branch a chunk.

#include <array>
#include <chrono>
#include <cstdint>

namespace mpm::cpu {

enum class Phase { tiles, weights, gather, transfer, material, move, coefficients, scatter, other, count };

inline constexpr std::array<const char*, static_cast<std::size_t>(Phase::count)> phase_names{
    "tiles", "weights", "gather", "transfer", "material", "move", "coefficients", "scatter", "other"};

class PhaseClock {
 public:
  using Ticks = std::uint64_t;
  std::array<Ticks, static_cast<std::size_t>(Phase::count)> ticks{};

  void measure(bool on) {
    on_ = on;
    if (on) ticks = {}, last_ = now();
  }
  /// Starts a lap: what follows belongs to whatever phase the next lap names.
  void start() {
    if (on_) last_ = now();
  }
  void lap(Phase phase) {
    if (!on_) return;
    const Ticks at = now();
    ticks[static_cast<std::size_t>(phase)] += at - last_;
    last_ = at;
  }
  static Ticks now() {
#if defined(__x86_64__)
    return __builtin_ia32_rdtsc();  // it costs a tenth of a system clock, which would show in what it measures
#else
    return static_cast<Ticks>(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
  }

 private:
  bool on_ = false;
  Ticks last_ = 0;
};

}  // namespace mpm::cpu

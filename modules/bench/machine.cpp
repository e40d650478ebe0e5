#include "bench/machine.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>

#include "kernel/lanes.hpp"
#include "support/team.hpp"

namespace mpm::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Keeps a value alive without storing it anywhere.
template <class V>
void keep(V& value) {
  asm volatile("" : : "m"(value) : "memory");
}

constexpr int chains = 12;  ///< latency 4 times 2 ports is 8; with 2 operands they fit the 16 registers of AVX2

/// Repeats x <- x a + b in `chains` independent registers.
template <class T>
void multiply_add(long repetitions, T seed) {
  using V = typename LaneTypes<T>::Vector;
  const V a = T(0.999) + T(1e-6) * seed - V{}, b = T(1e-3) * seed - V{};
  V x[chains];
  for (int c = 0; c < chains; ++c) x[c] = T(c) * seed - V{};
  for (long r = 0; r < repetitions; ++r)
#pragma GCC unroll 12
    for (int c = 0; c < chains; ++c) x[c] = x[c] * a + b;
  for (int c = 0; c < chains; ++c) keep(x[c]);
}

template <class T>
double peak(int threads, int windows) {
  constexpr double flops = 2.0 * chains * Lanes<T>::width, window_seconds = 2e-3;
  volatile T one = 1;
  long repetitions = 20000;
  support::Team team(threads);
  double best = 0;
  for (int window = 0; window < windows; ++window) {
    const auto start = Clock::now();
    team.for_each(static_cast<std::size_t>(threads), [&](std::size_t) { multiply_add<T>(repetitions, one); });
    const double elapsed = seconds_since(start);
    const double rate = flops * static_cast<double>(repetitions) * threads / elapsed;
    if (rate > best) repetitions = std::max(1000L, static_cast<long>(repetitions * window_seconds / elapsed));
    if (window > 0) best = std::max(best, rate);  // the first one wakes threads
  }
  return best / 1e9;
}

/// Best bytes a second of one loop, piece by piece through `length` elements of 4 bytes; `streams` arrays are named.
template <class Loop>
double best_rate(int threads, std::size_t length, int streams, int repeats, Loop loop) {
  const std::size_t piece = std::min(length, std::size_t{4} << 20);
  double best = 0;
  support::Team team(threads);
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t begin = 0; begin + piece <= length; begin += piece) {
      const auto start = Clock::now();
      const std::size_t lines = piece / 64, parts = static_cast<std::size_t>(threads);
      team.for_each(parts, [&](std::size_t part) {
        loop(begin + 64 * (lines * part / parts), begin + 64 * (lines * (part + 1) / parts));
      });
      best = std::max(best, 4.0 * streams * static_cast<double>(piece) / seconds_since(start));
    }
  return best / 1e9;
}

}  // namespace

const char* instruction_set() {
#if defined(__AVX512F__)
  return "AVX-512";
#elif defined(__AVX2__) && defined(__FMA__)
  return "AVX2, FMA";
#elif defined(__AVX2__)
  return "AVX2";
#else
  return "baseline of the compiler";
#endif
}
int lanes_of_float() {
  return Lanes<float>::width;
}
int lanes_of_double() {
  return Lanes<double>::width;
}

double peak_gflops(bool single, int threads, int windows) {
  return single ? peak<float>(threads, windows) : peak<double>(threads, windows);
}

MemoryBandwidth memory_bandwidth(int threads, std::size_t bytes, int repeats) {
  using L = Lanes<float>;
  const std::size_t length = bytes / sizeof(float) / 64 * 64;
  const auto make = [&] {
    auto* const array = static_cast<float*>(::operator new[](length * sizeof(float), std::align_val_t{64}));
    std::fill_n(array, length, 1.0f);
    return std::unique_ptr<float[], void (*)(float*)>(array,
                                                      [](float* p) { ::operator delete[](p, std::align_val_t{64}); });
  };
  const auto a = make(), b = make(), c = make();
  MemoryBandwidth result;
  result.triad = best_rate(threads, length, 3, repeats, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; i += L::width) (L::load(&b[i]) + 0.5f * L::load(&c[i])).store(&a[i]);
  });
  result.update = best_rate(threads, length, 2, repeats, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; i += L::width) (0.999f * L::load(&a[i])).store(&a[i]);
  });
  result.read = best_rate(threads, length, 1, repeats, [&](std::size_t first, std::size_t last) {
    L sum[4]{L(0.f), L(0.f), L(0.f), L(0.f)};
    for (std::size_t i = first; i + 4 * L::width <= last; i += 4 * L::width)
      for (int k = 0; k < 4; ++k) sum[k] = sum[k] + L::load(&b[i + k * L::width]);
    const L total = sum[0] + sum[1] + sum[2] + sum[3];
    keep(total.v);
  });
  return result;
}

double nanoseconds_between_threads(double seconds) {
  constexpr int rounds_a_look = 64;  // rounds between looks at the clock
  alignas(128) std::atomic<std::uint64_t> line{0};
  alignas(128) std::atomic<bool> stop{false};
  std::thread other([&] {
    for (std::uint64_t mine = 1;; mine += 2) {
      while (line.load(std::memory_order_acquire) != mine)
        if (stop.load(std::memory_order_relaxed)) return;
      line.store(mine + 1, std::memory_order_release);
    }
  });
  std::uint64_t handed = 0;
  const auto to_and_fro = [&] {
    line.store(handed + 1, std::memory_order_release);
    handed += 2;
    while (line.load(std::memory_order_acquire) != handed) {
    }
  };
  to_and_fro();  // the other thread is there
  const auto start = Clock::now();
  const std::uint64_t before = handed;
  double elapsed = 0;
  while (elapsed < seconds) {
    for (int round = 0; round < rounds_a_look; ++round) to_and_fro();
    elapsed = seconds_since(start);
  }
  stop = true;
  other.join();
  return 1e9 * elapsed / static_cast<double>(handed - before);
}

}  // namespace mpm::bench

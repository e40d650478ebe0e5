#pragma once
// The threads that share the loops of a step. Nobody waits for a thread that the system gives no processor: whoever
// runs takes over what others have not begun, and whoever waits sleeps after a short while, so that its processor is
// free for the thread that it waits for.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace mpm::support {

/// How long a thread looks at what it waits for before it sleeps. Waking costs about as much again as this bound, so
/// that neither choice can lose much; a thread that spins through its whole share of a busy processor would keep it
/// from the one that is to end the wait. `OMP_WAIT_POLICY` in the environment is heeded: `passive` sleeps at once,
/// `active` never does.
std::chrono::microseconds longest_spin();

/// Tells the processor that the thread only looks.
inline void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Looks for at most `bound` whether ready() holds; returns what it said last.
template <class Ready>
bool spin_until(Ready&& ready, std::chrono::microseconds bound) {
  constexpr int looks = 32;  // looks for each look at the clock
  if (ready()) return true;
  if (bound.count() == 0) return false;
  const auto start = std::chrono::steady_clock::now();
  do {
    for (int look = 0; look < looks; ++look) {
      relax();
      if (ready()) return true;
    }
  } while (std::chrono::steady_clock::now() - start < bound);
  return false;
}

/// Returns once the value is another one; whoever changes it has to notify.
template <class Value>
void wait_while(const std::atomic<Value>& value, Value old, std::chrono::microseconds bound) {
  if (!spin_until([&] { return value.load(std::memory_order_acquire) != old; }, bound)) value.wait(old);
}

/// A caller and the workers that help it. It serves one call at a time and is not for use inside of a call.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): what threads watch has lines of the cache of its own
class Team {
 public:
  /// Makes a team of `threads` >= 1, the caller among them. Where the system refuses a thread the team has fewer:
  /// results do not depend on their number.
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// The number of threads, which all their numbers are below.
  int size() const { return static_cast<int>(workers_.size()) + 1; }
  /// Lets only the first `threads` take part in calls to come, until it is called again. Without `spin` a thread that
  /// waits sleeps at once, which is best where other programs want the processors.
  void use(int threads, bool spin = true);
  /// The number of threads that take part.
  int used() const { return used_.load(std::memory_order_relaxed); }
  /// How long the team's threads look before they sleep.
  std::chrono::microseconds spin() const { return std::chrono::microseconds(spin_us_.load(std::memory_order_relaxed)); }

  /// Calls part(thread) on the caller, which is thread 0, and on each worker that comes before the caller's call ends;
  /// returns when no call goes on. All has to be done however few of them come: parts take what nobody has taken yet.
  /// An exception of a part is thrown again, the first of several.
  template <class Part>
  void share(Part&& part) {
    if (used() == 1) return part(0);
    using Callable = std::remove_reference_t<Part>;
    call({[](void* context, int thread) { (*static_cast<Callable*>(context))(thread); },
          const_cast<void*>(static_cast<const void*>(std::addressof(part)))});
  }

  /// Calls visit(first, last, thread) for pieces of at most `grain` neighbours that make up 0 to `count`. Each thread
  /// begins with a part of its own, the same in every loop of as many, whose data its cache may still hold.
  template <class Visit>
  void for_each_piece(std::size_t count, std::size_t grain, Visit&& visit) {
    if (used() == 1 || count <= grain) {
      if (count > 0) visit(std::size_t{0}, count, 0);
      return;
    }
    deal(count);
    share([&](int thread) {
      Piece piece;
      while (take(thread, grain, piece)) visit(piece.first, piece.last, thread);
    });
  }
  /// Calls visit(i, thread) for each i below `count`, `grain` neighbours at a time.
  template <class Visit>
  void for_each(std::size_t count, std::size_t grain, Visit&& visit) {
    for_each_piece(count, grain, [&](std::size_t first, std::size_t last, int thread) {
      for (std::size_t i = first; i < last; ++i) visit(i, thread);
    });
  }
  /// Calls visit(i) for each i below `count`, where calls take about as long as one another.
  template <class Visit>
  void for_each(std::size_t count, Visit&& visit) {
    for_each_piece(count, even_grain(count), [&](std::size_t first, std::size_t last, int) {
      for (std::size_t i = first; i < last; ++i) visit(i);
    });
  }
  /// The largest value_of(i) for i below `count`; 0 where none is larger.
  template <class T, class ValueOf>
  T largest(std::size_t count, ValueOf&& value_of) {
    std::atomic<T> largest{0};
    for_each_piece(count, even_grain(count), [&](std::size_t first, std::size_t last, int) {
      T of_piece = 0;
      for (std::size_t i = first; i < last; ++i) of_piece = std::max(of_piece, value_of(i));
      T known = largest.load(std::memory_order_relaxed);
      while (known < of_piece && !largest.compare_exchange_weak(known, of_piece, std::memory_order_relaxed)) {
      }
    });
    return largest;
  }

 private:
  /// A size of pieces large enough that taking one costs little, and small enough that threads end at about the same
  /// time.
  std::size_t even_grain(std::size_t count) const { return 1 + count / (8 * static_cast<std::size_t>(used())); }

  struct Call {
    void (*function)(void*, int) = nullptr;
    void* context = nullptr;
  };
  /// The part that one thread begins with, on lines of the cache of its own.
  struct alignas(128) Part {
    std::atomic<std::size_t> next{0};
    std::size_t last = 0;
    int from = 0;  ///< part that this thread takes from now
  };
  struct Piece {
    std::size_t first = 0, last = 0;
  };

  void call(Call call);
  void run(int thread) noexcept;
  void work(int thread);
  void deal(std::size_t count);
  bool take(int thread, std::size_t grain, Piece& piece);

  /// The state of a call in one word: its number, whether workers may still join it, and how many are in it.
  static constexpr std::uint32_t one_worker = 1, workers = 0x7fff, open = 0x8000, one_call = 0x10000;

  const std::chrono::microseconds longest_spin_;
  std::atomic<std::int64_t> spin_us_;
  std::atomic<int> used_{1};  ///< changes between calls alone
  Call call_;
  std::unique_ptr<Part[]> parts_;
  std::exception_ptr exception_;
  std::mutex mutex_;  ///< guards the exception
  alignas(128) std::atomic<std::uint32_t> state_{0};
  alignas(128) std::atomic<std::uint32_t> asleep_{0};  ///< workers that wait for a call
  std::atomic<std::uint32_t> emptied_{0};              ///< grows when the last worker leaves a call
  std::atomic<bool> ends_{false};
  std::vector<std::thread> workers_;
};

}  // namespace mpm::support

#include "support/team.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

namespace mpm::support {

std::chrono::microseconds longest_spin() {
  const char* const policy = std::getenv("OMP_WAIT_POLICY");
  const auto is = [&](std::string_view lower, std::string_view upper) {
    return policy && (policy == lower || policy == upper);
  };
  if (is("passive", "PASSIVE")) return std::chrono::microseconds(0);
  if (is("active", "ACTIVE")) return std::chrono::hours(24 * 365);
  return std::chrono::microseconds(50);
}

Team::Team(int threads) : longest_spin_(longest_spin()), spin_us_(longest_spin_.count()) {
  threads = std::clamp(threads, 1, static_cast<int>(workers));
  parts_ = std::make_unique<Part[]>(static_cast<std::size_t>(threads));
  workers_.reserve(static_cast<std::size_t>(threads - 1));
  try {
    for (int thread = 1; thread < threads; ++thread) workers_.emplace_back([this, thread] { work(thread); });
  } catch (const std::system_error&) {
    // The caller and the workers that were made do the work.
  }
  use(size());
}

Team::~Team() {
  ends_ = true;
  use(size());
  state_ += one_call;
  state_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void Team::use(int threads, bool spin) {
  spin_us_.store(spin ? longest_spin_.count() : 0, std::memory_order_relaxed);
  threads = std::clamp(threads, 1, size());
  if (used_.exchange(threads) != threads) used_.notify_all();
}

void Team::call(Call call) {
  call_ = call;
  const std::uint32_t number = (state_.load(std::memory_order_relaxed) & ~(open | workers)) + one_call;
  state_.store(number | open);
  if (asleep_.load() > 0) state_.notify_all();
  run(0);
  std::uint32_t emptied = emptied_.load();
  std::uint32_t state = state_.fetch_and(~open);
  while ((state & workers) != 0) {
    wait_while(emptied_, emptied, spin());
    emptied = emptied_.load();
    state = state_.load();
  }
  if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
}

void Team::run(int thread) noexcept {
  try {
    call_.function(call_.context, thread);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    if (!exception_) exception_ = std::current_exception();
  }
}

void Team::work(int thread) {
  std::uint32_t last = 0;  // number of the call that this worker joined or missed last
  const auto news = [&](std::uint32_t state) { return (state & ~(open | workers)) != last && (state & open) != 0; };
  while (true) {
    for (int used = used_.load(); !ends_ && thread >= used; used = used_.load()) used_.wait(used);
    std::uint32_t state = state_.load();
    if (!spin_until([&] { return ends_ || news(state = state_.load()); }, spin())) {
      ++asleep_;
      state = state_.load();
      if (!ends_ && !news(state)) state_.wait(state);
      --asleep_;
      continue;  // a worker that comes too late for this call is awake for the next
    }
    if (ends_) return;
    if (!state_.compare_exchange_strong(state, state + one_worker)) continue;
    last = state & ~(open | workers);
    if (thread < used_) run(thread);
    const std::uint32_t left = --state_;
    if ((left & (open | workers)) != 0) continue;
    ++emptied_;
    emptied_.notify_one();
  }
}

/// Gives each thread its part of a loop. A part that ends where it begins is done.
void Team::deal(std::size_t count) {
  const std::size_t threads = static_cast<std::size_t>(used());
  for (std::size_t k = 0; k < threads; ++k) {
    parts_[k].next.store(count * k / threads, std::memory_order_relaxed);
    parts_[k].last = count * (k + 1) / threads;
    parts_[k].from = static_cast<int>(k);
  }
}

/// Takes the next piece of a thread's own part, and when that is done of the parts after it; false when all are done.
bool Team::take(int thread, std::size_t grain, Piece& piece) {
  const int threads = used();
  int& from = parts_[thread].from;
  for (int looks = 0; looks < threads; ++looks) {
    Part& part = parts_[from];
    if (part.next.load(std::memory_order_relaxed) < part.last) {
      piece.first = part.next.fetch_add(grain, std::memory_order_relaxed);
      piece.last = std::min(piece.first + grain, part.last);
      if (piece.first < part.last) return true;
    }
    from = from + 1 < threads ? from + 1 : 0;
  }
  return false;
}

}  // namespace mpm::support

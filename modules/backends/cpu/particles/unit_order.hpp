#pragma once
// The order in which threads work on the units of a body: those of one colour after those of another, but a unit waits
// for its neighbours alone, so that no thread stands idle between two colours.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <numeric>
#include <vector>

#include "backends/cpu/grid/blocks.hpp"
#include "support/team.hpp"

namespace mpm::cpu {

/// A unit is blocks that lie side by side: a column of two blocks along x (and of two along y in 3-D).
struct Unit {
  std::uint32_t first = 0, last = 0;
};
template <int D>
inline constexpr int colour_count = D == 3 ? 4 : 2;

/// Units of one colour touch no common node, those of two colours only where they are neighbours.
template <int D>
using ColouredUnits = std::array<std::vector<Unit>, colour_count<D>>;

/// A unit and its neighbours that come before it, of other colours, whose nodes it may not touch until they are done.
struct UnitTask {
  Unit unit;
  int waits_for = 0;
  std::array<std::uint32_t, 8> neighbours{};
};

/// The tasks of a body, in an order in which whoever waits waits for one that comes before it, and which thread is to
/// take which of them.
struct UnitOrder {
  std::vector<UnitTask> tasks;
  std::vector<std::vector<std::uint32_t>> of_thread;  ///< numbers of tasks, ascending; a part of space for each thread
};

/// Cuts the body across its longer side into parts of about as many particles, one for each thread: lines of the cache
/// that two threads write travel between their caches, and far where these belong to different groups of processors.
inline void share_out(UnitOrder& order, const std::vector<std::array<int, 2>>& columns,
                      const std::vector<std::uint64_t>& sizes, int threads) {
  std::vector<std::uint32_t> by_place(columns.size());
  std::array<int, 2> least{0, 0}, most{0, 0};
  for (std::uint32_t t = 0; t < by_place.size(); ++t) {
    by_place[t] = t;
    for (int axis = 0; axis < 2; ++axis) {
      least[axis] = t == 0 ? columns[t][axis] : std::min(least[axis], columns[t][axis]);
      most[axis] = t == 0 ? columns[t][axis] : std::max(most[axis], columns[t][axis]);
    }
  }
  const int along = most[1] - least[1] > most[0] - least[0] ? 1 : 0;
  std::sort(by_place.begin(), by_place.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::array{columns[a][along], columns[a][1 - along]} < std::array{columns[b][along], columns[b][1 - along]};
  });
  const std::uint64_t all = std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0});
  order.of_thread.assign(static_cast<std::size_t>(threads), {});
  std::uint64_t before = 0;
  for (const std::uint32_t t : by_place) {
    const std::uint64_t middle = before + sizes[t] / 2;
    order.of_thread[std::min<std::uint64_t>(middle * threads / std::max<std::uint64_t>(all, 1), threads - 1)].push_back(
        t);
    before += sizes[t];
  }
  for (auto& tasks : order.of_thread) std::sort(tasks.begin(), tasks.end());
}

/// Orders the units so that the last to be begun are small, for threads to end at about the same time.
template <int D, class Blocks>
UnitOrder ordered_units(const ColouredUnits<D>& units, const Blocks& blocks, int threads) {
  UnitOrder order;
  BlockTable numbers;
  std::vector<std::array<int, 2>> columns;
  std::vector<std::uint64_t> sizes;
  const auto size = [&](const Unit& unit) {
    std::uint64_t particles = 0;
    for (std::uint32_t b = unit.first; b < unit.last; ++b) particles += blocks[b].count;
    return particles;
  };
  for (int colour = 0; colour < colour_count<D>; ++colour) {
    std::vector<Unit> of_colour = units[colour];
    if (colour + 1 == colour_count<D>)
      std::stable_sort(of_colour.begin(), of_colour.end(),
                       [&](const Unit& a, const Unit& b) { return size(a) > size(b); });
    for (const Unit& unit : of_colour) {
      const BlockCoordinates& at = blocks[unit.first].at;
      const int x = at[0] >> 1, y = D == 3 ? at[1] >> 1 : 0;
      UnitTask task{unit};
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = D == 3 ? -1 : 0; dy <= (D == 3 ? 1 : 0); ++dy) {
          const int found = numbers.find({x + dx, y + dy, 0});
          if (found >= 0) task.neighbours[task.waits_for++] = static_cast<std::uint32_t>(found);
        }
      numbers.insert({x, y, 0}, static_cast<int>(order.tasks.size()));
      order.tasks.push_back(task);
      columns.push_back({x, y});
      sizes.push_back(size(unit));
    }
  }
  // Where all units are neighbours one is in work at a time, and more threads would only hand them to and fro.
  const bool one_by_one =
      std::all_of(units.begin(), units.end(), [](const auto& of_colour) { return of_colour.size() < 2; });
  share_out(order, columns, sizes, one_by_one ? 1 : threads);
  return order;
}

/// One pass over the units, which threads share.
class UnitPass {
 public:
  /// The state of a task.
  enum State : int { not_begun, begun, done };

  /// Threads look for `spin` at a unit in work before they sleep.
  UnitPass(const UnitOrder& order, std::vector<std::atomic<int>>& states,
           std::chrono::microseconds spin = std::chrono::microseconds(0))
      : order_(order), states_(states), spin_(spin) {
    if (states_.size() < order.tasks.size()) states_ = std::vector<std::atomic<int>>(order.tasks.size());
    for (auto& state : states_) state.store(not_begun, std::memory_order_relaxed);
  }

  /// Calls visit(unit), which may not throw, for the units that this thread is the first to take: its own, those that
  /// these wait for, then what others have not begun. A thread waits only for units in work, and these only for units
  /// of colours before, so that nobody waits for ever, and a slow thread delays nobody by what it has not begun.
  template <class Visit>
  void run(int thread, Visit&& visit) {
    const std::size_t parts = order_.of_thread.size();
    for (std::size_t k = 0; k < parts; ++k)
      for (const std::uint32_t task : order_.of_thread[(static_cast<std::size_t>(thread) + k) % parts])
        if (take(task)) work_on(task, visit);
  }

 private:
  bool take(std::uint32_t task) {
    int state = states_[task].load(std::memory_order_relaxed);
    return state == not_begun && states_[task].compare_exchange_strong(state, begun, std::memory_order_relaxed);
  }

  template <class Visit>
  void work_on(std::uint32_t number, Visit&& visit) {
    const UnitTask& task = order_.tasks[number];
    for (int k = 0; k < task.waits_for; ++k) {
      const std::uint32_t before = task.neighbours[k];
      if (take(before)) work_on(before, visit);
      support::wait_while(states_[before], static_cast<int>(begun), spin_);
    }
    visit(task.unit);
    states_[number].store(done);
    states_[number].notify_all();
  }

  const UnitOrder& order_;
  std::vector<std::atomic<int>>& states_;
  const std::chrono::microseconds spin_;
};

}  // namespace mpm::cpu

#pragma once
// In which order threads work on the units of a body: those of one colour after those of another, but a unit waits for
// its neighbours alone, so that no thread stands idle between two colours.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "blocks.hpp"

namespace mpm::cpu {

/// Blocks of one unit lie side by side: a column of two blocks along x (and of two along y in 3-D).
struct Unit {
  std::uint32_t first = 0, last = 0;
};
template <int D>
inline constexpr int colour_count = D == 3 ? 4 : 2;

/// Units of one colour touch no common node, of two colours only where they are neighbours.
template <int D>
using ColouredUnits = std::array<std::vector<Unit>, colour_count<D>>;

/// A unit and its neighbours of the colours before, whose nodes it may not touch until they are done.
struct UnitTask {
  Unit unit;
  int waits_for = 0;
  std::array<std::uint32_t, 8> neighbours{};
};

/// In an order in which whoever waits waits for one that comes before it. The last to be begun are small, so that
/// threads end at about the same time.
template <int D, class Blocks>
std::vector<UnitTask> ordered_units(const ColouredUnits<D>& units, const Blocks& blocks) {
  std::vector<UnitTask> tasks;
  BlockTable numbers;
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
    const std::uint32_t earlier = static_cast<std::uint32_t>(tasks.size());
    for (const Unit& unit : of_colour) {
      const BlockCoordinates& at = blocks[unit.first].at;
      const int x = at[0] >> 1, y = D == 3 ? at[1] >> 1 : 0;
      UnitTask task{unit};
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = D == 3 ? -1 : 0; dy <= (D == 3 ? 1 : 0); ++dy) {
          const int found = numbers.find({x + dx, y + dy, 0});
          if (found >= 0 && static_cast<std::uint32_t>(found) < earlier)
            task.neighbours[task.waits_for++] = static_cast<std::uint32_t>(found);
        }
      numbers.insert({x, y, 0}, static_cast<int>(tasks.size()));
      tasks.push_back(task);
    }
  }
  return tasks;
}

/// One pass over the units, which threads share.
class UnitPass {
 public:
  UnitPass(const std::vector<UnitTask>& tasks, std::vector<std::atomic<bool>>& done) : tasks_(tasks), done_(done) {
    if (done_.size() < tasks.size()) done_ = std::vector<std::atomic<bool>>(tasks.size());
    for (auto& flag : done_) flag.store(false, std::memory_order_relaxed);
  }

  /// Calls visit(unit), which may not throw, for the units that this thread is the first to take.
  template <class Visit>
  void run(Visit&& visit) {
    for (std::uint32_t t; (t = next_.fetch_add(1, std::memory_order_relaxed)) < tasks_.size();) {
      for (int k = 0; k < tasks_[t].waits_for; ++k) done_[tasks_[t].neighbours[k]].wait(false);
      visit(tasks_[t].unit);
      done_[t].store(true);
      done_[t].notify_all();
    }
  }

 private:
  const std::vector<UnitTask>& tasks_;
  std::vector<std::atomic<bool>>& done_;
  std::atomic<std::uint32_t> next_{0};
};

}  // namespace mpm::cpu

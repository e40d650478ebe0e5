// The order in which threads take the units of blocks: whoever shares nodes works one after the other, by colours.
#include <algorithm>
#include <atomic>
#include <map>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "backends/cpu/particles/unit_order.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm::cpu;
using Column = std::pair<int, int>;

struct TestBlock {
  BlockCoordinates at{};
  std::uint32_t count = 0;
};

template <int D>
struct Columns {
  ColouredUnits<D> units;
  std::vector<TestBlock> blocks;
  std::map<Column, int> colour;

  /// Makes some of the columns of a 7 x 5 field (7 in 2-D), two blocks high.
  Columns() {
    for (int c = 0; c < colour_count<D>; ++c)
      for (int x = -3; x < 4; ++x)
        for (int y = 0; y < (D == 3 ? 5 : 1); ++y) {
          if ((x & 1) + 2 * (y & 1) != c || (x == 0 && y == 2)) continue;
          const auto first = static_cast<std::uint32_t>(blocks.size());
          for (int z = 0; z < 2; ++z)
            blocks.push_back({{2 * x + 1, D == 3 ? 2 * y : z, D == 3 ? z : 0}, static_cast<std::uint32_t>(7 + x + y)});
          units[c].push_back({first, static_cast<std::uint32_t>(blocks.size())});
          colour[{x, y}] = c;
        }
  }
  Column column(const Unit& unit) const {
    const BlockCoordinates& at = blocks[unit.first].at;
    return {at[0] >> 1, D == 3 ? at[1] >> 1 : 0};
  }
};

bool are_neighbours(const Column& a, const Column& b) {
  return a != b && std::abs(a.first - b.first) <= 1 && std::abs(a.second - b.second) <= 1;
}

template <int D>
void check_order() {
  const Columns<D> columns;
  const std::vector<UnitTask> tasks = ordered_units<D>(columns.units, columns.blocks, 2).tasks;
  REQUIRE(tasks.size() == columns.colour.size());
  std::set<Column> seen;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const Column here = columns.column(tasks[t].unit);
    CHECK(seen.insert(here).second);
    std::set<Column> waits_for, expected;
    for (int k = 0; k < tasks[t].waits_for; ++k) {
      CHECK(tasks[t].neighbours[k] < t);
      waits_for.insert(columns.column(tasks[tasks[t].neighbours[k]].unit));
    }
    for (const auto& [column, colour] : columns.colour)
      if (are_neighbours(column, here) && colour < columns.colour.at(here)) expected.insert(column);
    CHECK(waits_for == expected);
  }
  // The last colour ends with its smallest unit.
  const auto last_colour = [&](const UnitTask& task) {
    return columns.colour.at(columns.column(task.unit)) == colour_count<D> - 1;
  };
  std::uint32_t before = ~0u;
  for (const UnitTask& task : tasks) {
    if (!last_colour(task)) continue;
    const std::uint32_t size = 2 * columns.blocks[task.unit.first].count;
    CHECK(size <= before);
    before = size;
  }
}

}  // namespace

TEST_CASE("a unit waits for its neighbours of the colours before, and for no other") {
  check_order<2>();
  check_order<3>();
}

TEST_CASE("each thread has a part of space with about as many particles") {
  const Columns<3> columns;
  for (const int threads : {1, 2, 3, 5, 40}) {
    CAPTURE(threads);
    const UnitOrder order = ordered_units<3>(columns.units, columns.blocks, threads);
    REQUIRE(order.of_thread.size() == static_cast<std::size_t>(threads));
    std::set<std::uint32_t> shared_out;
    std::uint64_t all = 0, largest_unit = 0;
    std::vector<std::uint64_t> particles;
    Column last{-100, 0};
    for (const std::vector<std::uint32_t>& tasks : order.of_thread) {
      CHECK(std::is_sorted(tasks.begin(), tasks.end()));
      std::set<Column> part;
      particles.push_back(0);
      for (const std::uint32_t t : tasks) {
        CHECK(shared_out.insert(t).second);
        const Unit& unit = order.tasks[t].unit;
        const std::uint64_t size = 2 * columns.blocks[unit.first].count;
        particles.back() += size;
        all += size;
        largest_unit = mpm::test::larger(largest_unit, size);
        part.insert(columns.column(unit));
      }
      if (part.empty()) continue;
      CHECK(last < *part.begin());  // parts follow one another along x, the longer side
      last = *part.rbegin();
    }
    CHECK(shared_out.size() == order.tasks.size());
    for (const std::uint64_t has : particles) CHECK(has <= all / static_cast<std::uint64_t>(threads) + largest_unit);
  }
  // Parts follow one another across the longer side, also where that is y.
  Columns<3> high;
  for (TestBlock& block : high.blocks) block.at = {block.at[1], block.at[0], block.at[2]};
  const UnitOrder order = ordered_units<3>(high.units, high.blocks, 2);
  std::set<int> first, second;
  for (const std::uint32_t t : order.of_thread[0]) first.insert(high.column(order.tasks[t].unit).second);
  for (const std::uint32_t t : order.of_thread[1]) second.insert(high.column(order.tasks[t].unit).second);
  CHECK(*first.rbegin() <= *second.begin());
}

TEST_CASE("a body of no units is shared out") {
  const UnitOrder order = ordered_units<2>(ColouredUnits<2>{}, std::vector<TestBlock>{}, 3);
  CHECK(order.tasks.empty());
  CHECK(order.of_thread.size() == 1);
}

TEST_CASE("units that are all neighbours fall to one thread") {
  Columns<3> columns;
  for (auto& units : columns.units) units.resize(1);
  CHECK(ordered_units<3>(columns.units, columns.blocks, 2).of_thread.size() == 1);
  columns.units[0] = Columns<3>().units[0];
  CHECK(ordered_units<3>(columns.units, columns.blocks, 2).of_thread.size() == 2);
}

TEST_CASE("neighbouring units are never in work at once and follow their colours, with any number of threads") {
  const Columns<3> columns;
  std::map<Column, std::atomic<int>> state;  // 0 waiting, 1 in work, 2 done
  for (const auto& [column, colour] : columns.colour) state[column] = 0;
  std::vector<std::atomic<int>> states;
  // There may be fewer or more threads than the body was shared out to, as a system may give.
  for (const auto& [parts, threads] : {std::pair{1, 1}, {2, 2}, {5, 5}, {5, 2}, {2, 5}}) {
    const UnitOrder order = ordered_units<3>(columns.units, columns.blocks, parts);
    const std::vector<UnitTask>& tasks = order.tasks;
    CAPTURE(parts, threads);
    for (int repeat = 0; repeat < 50; ++repeat) {
      for (auto& [column, value] : state) value = 0;
      std::atomic<int> wrong{0}, visited{0};
      UnitPass pass(order, states);
      const auto work = [&](int thread) {
        pass.run(thread, [&](const Unit& unit) {
          const Column here = columns.column(unit);
          state.at(here) = 1;
          for (const auto& [column, colour] : columns.colour) {
            if (!are_neighbours(column, here)) continue;
            const int expected = colour < columns.colour.at(here) ? 2 : 0;
            if (state.at(column) != expected) ++wrong;
          }
          if (repeat % 2 == 0) std::this_thread::yield();
          state.at(here) = 2;
          ++visited;
        });
      };
      std::vector<std::thread> others;
      for (int t = 1; t < threads; ++t) others.emplace_back(work, t);
      work(0);
      for (std::thread& other : others) other.join();
      REQUIRE(wrong == 0);
      REQUIRE(visited == static_cast<int>(tasks.size()));
    }
  }
}

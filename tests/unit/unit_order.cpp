// The order in which threads take the units of blocks: whoever shares nodes works one after the other, by colours.
#include <atomic>
#include <map>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "backends/cpu/unit_order.hpp"
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

  /// Some of the columns of a 7 x 5 field (7 in 2-D), two blocks high.
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
  const std::vector<UnitTask> tasks = ordered_units<D>(columns.units, columns.blocks);
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
  // the last colour ends with its smallest unit
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

TEST_CASE("neighbouring units are never in work at once and follow their colours, with any number of threads") {
  const Columns<3> columns;
  const std::vector<UnitTask> tasks = ordered_units<3>(columns.units, columns.blocks);
  std::map<Column, std::atomic<int>> state;  // 0 waiting, 1 in work, 2 done
  for (const auto& [column, colour] : columns.colour) state[column] = 0;
  std::vector<std::atomic<bool>> done;
  for (const int threads : {1, 2, 5}) {
    for (int repeat = 0; repeat < 50; ++repeat) {
      for (auto& [column, value] : state) value = 0;
      std::atomic<int> wrong{0}, visited{0};
      UnitPass pass(tasks, done);
      const auto work = [&] {
        pass.run([&](const Unit& unit) {
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
      for (int t = 1; t < threads; ++t) others.emplace_back(work);
      work();
      for (std::thread& other : others) other.join();
      REQUIRE(wrong == 0);
      REQUIRE(visited == static_cast<int>(tasks.size()));
    }
  }
}

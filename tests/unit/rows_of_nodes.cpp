// Quads and rows of nodes, the registers of the cpu backend's kernels, against their scalars one by one.

#include <array>
#include <vector>

#include "backends/cpu/tiles/row.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::cpu;
using mpm::cpu::Row;  // other tests compiled with these know another

/// Numbers that differ from one another, aligned as the kernels' memory is.
template <class T, std::size_t count>
struct alignas(64) Numbered {
  T at[count];
  explicit Numbered(int first = 1) {
    for (std::size_t i = 0; i < count; ++i) at[i] = static_cast<T>(first + static_cast<int>(i));
  }
};

template <class T, int K>
std::array<T, mpm::cpu::Row<T, K>::scalars> scalars_of(const mpm::cpu::Row<T, K>& row) {
  std::array<T, mpm::cpu::Row<T, K>::scalars> scalars{};
  store_row<T, K>(scalars.data(), row);
  return scalars;
}

/// Calls check.operator()<K>() for stencils of two, three and four nodes an axis.
template <class Check>
void for_each_width(Check&& check) {
  check.template operator()<2>(), check.template operator()<3>(), check.template operator()<4>();
}

}  // namespace

TEMPLATE_TEST_CASE("quads that lie apart are joined to one register", "", float, double) {
  const Numbered<TestType, 4 * 16 * 4> numbers;
  for (const std::size_t step : {4u, 8u, 48u}) {
    INFO(step);
    const QuadLanes<TestType> joined = join_quads<TestType>(numbers.at + 4, step);
    for (int lane = 0; lane < Lanes<TestType>::width; ++lane)
      CHECK(joined[lane] ==
            numbers.at[4 + static_cast<std::size_t>(lane / 4) * step + static_cast<std::size_t>(lane % 4)]);
  }
}

TEMPLATE_TEST_CASE("a register takes of two what it is told, in each block of four", "", float, double) {
  const Numbered<TestType, Lanes<TestType>::width> a(1), b(101);
  const auto x = Lanes<TestType>::load(a.at).v, y = Lanes<TestType>::load(b.at).v;
  const auto mixed = pick<2, 7, 0, 5, TestType>(x, y), same = pick<3, 3, 3, 3, TestType>(x, x);
  for (int block = 0; block < Lanes<TestType>::width; block += 4) {
    CHECK(mixed[block] == a.at[block + 2]);
    CHECK(mixed[block + 1] == b.at[block + 3]);
    CHECK(mixed[block + 2] == a.at[block]);
    CHECK(mixed[block + 3] == b.at[block + 1]);
    for (int i = 0; i < 4; ++i) CHECK(same[block + i] == a.at[block + 3]);
  }
}

TEMPLATE_TEST_CASE("quads become components and components quads, each particle's at its place", "", float, double) {
  constexpr int width = Lanes<TestType>::width, groups = 3;
  CHECK(quad_group<TestType> == 4 * width);
  std::vector<int> taken(2 * groups * 4 * width);
  for (int p = 0; p < 2 * width; ++p) ++taken[quad_place<TestType>(p, groups)];
  for (int p = 0; p < 2 * width; ++p) CHECK(taken[quad_place<TestType>(p, groups)] == 1);
  for (int p = 0; p < width; ++p)
    CHECK(quad_place<TestType>(width + p, groups) == quad_place<TestType>(p, groups) + groups * quad_group<TestType>);

  const auto value = [](int p, int component) { return static_cast<TestType>(10 * p + component + 1); };
  alignas(64) TestType quads[4 * width];
  for (int p = 0; p < width; ++p)
    for (int c = 0; c < 4; ++c) quads[quad_place<TestType>(p, 1) + static_cast<std::size_t>(c)] = value(p, c);
  Lanes<TestType> components[4];
  load_quads<TestType>(quads, components);
  alignas(64) TestType back[4 * width]{};
  store_quads<TestType>(back, components);
  for (int p = 0; p < width; ++p)
    for (int c = 0; c < 4; ++c) {
      CHECK(components[c][p] == value(p, c));
      CHECK(back[quad_place<TestType>(p, 1) + static_cast<std::size_t>(c)] == value(p, c));
    }
}

TEMPLATE_TEST_CASE("a row holds its nodes' scalars, and is added and multiplied one by one", "", float, double) {
  for_each_width([]<int K> {
    using R = mpm::cpu::Row<TestType, K>;
    CHECK(R::nodes == (K == 2 ? 2 : 4));
    CHECK(R::scalars == 4 * R::nodes);
    CHECK(R::vectors * R::width == R::scalars);
    CHECK(R::vectors * R::nodes_a_vector == R::nodes);
    CHECK(sizeof(typename R::Vector) == R::width * sizeof(TestType));
    CHECK(sizeof(typename R::Vector) <= lane_bytes);
    CHECK((R::vectors == 1 || sizeof(typename R::Vector) == lane_bytes));
    const Numbered<TestType, R::scalars + 1> a(1), b(3);
    R x = load_row<TestType, K>(a.at + 1);  // anywhere in memory
    stay_loaded<TestType, K>(x);
    const R y = load_row<TestType, K>(b.at);
    const auto kept = scalars_of<TestType, K>(x), sums = scalars_of<TestType, K>(x + y),
               products = scalars_of<TestType, K>(x * y),
               times_seven = scalars_of<TestType, K>(times<TestType, K>(broadcast<TestType, K>(TestType(7)), x));
    for (std::size_t i = 0; i < R::scalars; ++i) {
      CHECK(kept[i] == a.at[i + 1]);
      CHECK(sums[i] == a.at[i + 1] + b.at[i]);
      CHECK(products[i] == a.at[i + 1] * b.at[i]);
      CHECK(times_seven[i] == 7 * a.at[i + 1]);
    }
  });
}

TEMPLATE_TEST_CASE("a quad is put at each node of a row, or one of its scalars on all of each node", "", float,
                   double) {
  for_each_width([]<int K> {
    using R = mpm::cpu::Row<TestType, K>;
    const Numbered<TestType, 8> quad;
    const auto repeats = scalars_of<TestType, K>(repeated<TestType, K>(quad.at)),
               spreads = scalars_of<TestType, K>(spread<TestType, K>(quad.at)),
               numbers = scalars_of<TestType, K>(node_numbers<TestType, K>());
    for (std::size_t node = 0; node < R::nodes; ++node)
      for (std::size_t c = 0; c < 4; ++c) {
        CHECK(repeats[4 * node + c] == quad.at[c]);
        CHECK(spreads[4 * node + c] == quad.at[node]);
        CHECK(numbers[4 * node + c] == static_cast<TestType>(node));
      }
  });
}

TEMPLATE_TEST_CASE("the nodes of rows come side by side in the rows' order", "", float, double) {
  const auto check = []<int K> {
    using R = mpm::cpu::Row<TestType, K>;
    constexpr int count = R::nodes_a_vector;
    const Numbered<TestType, count * R::scalars> numbers;
    R rows[count];
    for (int i = 0; i < count; ++i) rows[i] = load_row<TestType, K>(numbers.at + i * R::scalars);
    Lanes<TestType> nodes[4];
    for (Lanes<TestType>& node : nodes) node = Lanes<TestType>(TestType(-1));
    nodes_of_rows<TestType, K>(rows, nodes);
    for (int node = 0; node < 4; ++node)
      for (int lane = 0; lane < 4 * count; ++lane)
        CHECK(nodes[node][lane] == numbers.at[lane / 4 * R::scalars + 4 * node + lane % 4]);
  };
  check.template operator()<3>(), check.template operator()<4>();
}

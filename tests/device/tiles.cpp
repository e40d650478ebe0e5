// How the device's kernels find nodes: tiles of blocks and runs of active nodes, images at walls; how they number and stop.

#include <array>

#include "backends/device/kernels/folds.hpp"
#include "backends/device/kernels/gather.hpp"
#include "backends/device/kernels/scatter.hpp"
#include "backends/device/kernels/sorting.hpp"
#include "backends/device/kernels/stopping.hpp"
#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

using Coordinates = std::array<int, 3>;

/// A grid without fields, with the marks of its active nodes.
class BareGrid {
 public:
  BareGrid(int dimension, const Coordinates& cells, const Coordinates& padding) : dimension_(dimension) {
    a.node_count = 1;
    for (int c = 0; c < 3; ++c) {
      a.cells[c] = c < dimension ? cells[c] : 0, a.padding[c] = c < dimension ? padding[c] : 0;
      a.extent[c] = a.cells[c] + 1 + 2 * a.padding[c];
      a.node_count *= a.extent[c];
    }
    active.assign(static_cast<std::size_t>(a.node_count) / device::nodes_of_run + 1, 0);
    a.grid.active = active.data();
  }
  bool holds(const Coordinates& node) const {
    for (int c = 0; c < 3; ++c)
      if (node[c] < -a.padding[c] || node[c] > a.cells[c] + a.padding[c]) return false;
    return true;
  }
  int index(const Coordinates& node) const {
    return ((node[2] + a.padding[2]) * a.extent[1] + node[1] + a.padding[1]) * a.extent[0] + node[0] + a.padding[0];
  }
  int dimension() const { return dimension_; }

  device::Arguments<double> a{};
  std::vector<unsigned char> active;

 private:
  int dimension_;
};

/// All coordinates between two corners, both included.
std::vector<Coordinates> nodes_between(const Coordinates& lower, const Coordinates& upper) {
  std::vector<Coordinates> nodes;
  for (int z = lower[2]; z <= upper[2]; ++z)
    for (int y = lower[1]; y <= upper[1]; ++y)
      for (int x = lower[0]; x <= upper[0]; ++x) nodes.push_back({x, y, z});
  return nodes;
}

/// Lets particles of the third block give to each node of its tile, and to the grid's corners, or to nothing, and compares
/// what has arrived and which runs are active.
template <int D, int Channels>
void check_giving(const Coordinates& cells, const Coordinates& padding, const Coordinates& first_cell, int lanes,
                  bool gives) {
  BareGrid grid(D, cells, padding);
  device::Arguments<double>& a = grid.a;
  std::vector<Coordinates> given;
  std::vector<unsigned char> expected_active(grid.active.size(), 0);
  const Coordinates low{first_cell[0] - 1, first_cell[1] - 1, D == 3 ? first_cell[2] - 1 : 0},
      high{first_cell[0] + 5, first_cell[1] + 5, D == 3 ? first_cell[2] + 5 : 0};
  for (const Coordinates& node : nodes_between(low, high))
    if (grid.holds(node)) {
      given.push_back(node);
      expected_active[grid.index(node) / device::nodes_of_run] = 1;
    }
  if (given.empty()) return;
  if (!gives) given.clear();
  const std::size_t of_tile = given.size();
  if (gives) {
    given.push_back({-a.padding[0], -a.padding[1], -a.padding[2]});
    given.push_back({cells[0] + a.padding[0], cells[1] + a.padding[1], D == 3 ? cells[2] + a.padding[2] : 0});
  }
  for (std::size_t k = of_tile; k < given.size(); ++k) expected_active[grid.index(given[k]) / device::nodes_of_run] = 1;

  const int others = 3, count = static_cast<int>(given.size());
  std::vector<int> order{0, 1, 2}, begin{0, 1, others, others + count};
  for (int p = count - 1; p >= 0; --p) order.push_back(others + p);
  std::array<int, 9> cell{40, 40, 40, 40, 40, 40, first_cell[0], first_cell[1], first_cell[2]};
  a.blocks.order = order.data(), a.blocks.begin = begin.data(), a.blocks.cell = cell.data();

  std::vector<std::vector<double>> found(Channels, std::vector<double>(a.node_count, 0.0)), expected = found;
  std::vector<double*> channel;
  for (auto& values : found) channel.push_back(values.data());
  channel[1] = nullptr;
  for (int p = 0; p < count; ++p)
    for (int k = 0; k < Channels; ++k)
      if (k != 1) expected[k][grid.index(given[p])] += 1 + p * Channels + k;
  auto contribute = [&](int p, auto add) {
    REQUIRE(p >= others);
    std::array<double, Channels> values;
    for (int k = 0; k < Channels; ++k) values[k] = 1 + (p - others) * Channels + k;
    add(given[p - others].data(), values.data());
  };
  std::vector<double> shared(device::channels_together<D, Channels, double> * device::Tile<D>::nodes, std::nan(""));
  const device::Team team(shared.data(), 0, lanes, device::order_downwards);
  device::scatter_block<D, Channels>(team, a, 2, channel.data(), contribute);
  INFO(cells[0] << " cells, block at " << first_cell[0] << ' ' << first_cell[1] << ' ' << first_cell[2]);
  CHECK(found == expected);
  CHECK(grid.active == expected_active);
}

template <int D, int Channels>
void check_tile(const Coordinates& cells, const Coordinates& padding, const Coordinates& first_cell, int lanes) {
  for (const bool gives : {true, false}) check_giving<D, Channels>(cells, padding, first_cell, lanes, gives);
}

/// Compares the numbers of nodes in and around a tile whose first cell is given.
template <int D>
void check_numbers(const Coordinates& first_cell) {
  constexpr int side = 7;
  for (const Coordinates& from : nodes_between({-2, -2, D == 3 ? -2 : 0}, {8, 8, D == 3 ? 8 : 0})) {
    Coordinates node{};
    bool inside = true;
    int number = 0;
    for (int c = 0, stride = 1; c < D; ++c, stride *= side) {
      node[c] = first_cell[c] - 1 + from[c];
      inside = inside && from[c] >= 0 && from[c] < side;
      number += stride * from[c];
    }
    CHECK(device::Tile<D>::index(first_cell.data(), node.data()) == (inside ? number : -1));
    if (!inside) continue;
    Coordinates found{};
    device::Tile<D>::coordinates(first_cell.data(), number, found.data());
    CHECK(found == node);
  }
}

/// All that a fold says.
std::array<int, 9> told(const device::Fold& fold) {
  return {fold.ghost, fold.mirror, fold.axis, fold.side, fold.wall, fold.line, fold.foot, fold.inward, fold.beyond};
}

/// The number of the line along an axis that a node lies on: the lower one of the other axes counts first.
int line_of(const BareGrid& grid, int axis, const Coordinates& node) {
  const int low = axis == 0 ? 1 : 0, high = axis == 2 ? 1 : 2;
  return node[low] + grid.a.padding[low] + grid.a.extent[low] * (node[high] + grid.a.padding[high]);
}

int stride_of(const BareGrid& grid, int axis) {
  return axis == 0 ? 1 : axis == 1 ? grid.a.extent[0] : grid.a.extent[0] * grid.a.extent[1];
}

/// The folds of the line of a node, from the outermost ghosts on.
std::vector<std::array<int, 9>> expected_folds(const BareGrid& grid, int axis, Coordinates node, bool on_walls) {
  const device::Arguments<double>& a = grid.a;
  const int cells = a.cells[axis], stride = stride_of(grid, axis), line = line_of(grid, axis, node);
  const auto index_at = [&](int i) { return node[axis] = i, grid.index(node); };
  std::vector<std::array<int, 9>> folds;
  for (int beyond = a.padding[axis]; beyond >= 0; --beyond)
    for (const int side : {0, 1}) {
      const int wall = a.walls[axis][side], i = side == 0 ? -beyond : cells + beyond;
      const bool reflects = wall != wall_free && wall != wall_periodic;
      int mirror = side == 0 ? beyond : cells - beyond;
      if (wall == wall_periodic) {
        for (mirror = i; mirror < 0;) mirror += cells;
        while (mirror >= cells) mirror -= cells;
      }
      if (wall == wall_free || (beyond == 0 && !(reflects ? on_walls : side == 1))) continue;
      if (!grid.active[index_at(i) / device::nodes_of_run]) continue;
      folds.push_back({index_at(i), index_at(mirror), axis, side, wall, line, index_at(side == 0 ? 0 : cells),
                       side == 0 ? stride : -stride, beyond});
    }
  return folds;
}

int runs_of_kernel = 0;
void count_run(const device::Team&, const device::Arguments<double>&) {
  ++runs_of_kernel;
}

/// What sorting kernels ask of a scene.
struct SortedScene {
  using Scalar = double;
};

/// A scene of a shape of three nodes whose weights tell them apart.
template <int D>
struct StencilScene {
  using Scalar = double;
  static constexpr int dimension = D, width = 3, inverse_second_moment = 1;
  static constexpr bool deformed = false, sized = false, moment_per_particle = false, affine = false;
  struct Particle {
    static constexpr int position = 0;
  };
  struct Shape {
    struct Parameters {};
    static void evaluate(const Parameters&, double x, double& first, double* weight, double* gradient) {
      first = std::floor(x - 0.5);
      for (int k = 0; k < width; ++k) weight[k] = 2 + 3 * k, gradient[k] = 7 - 2 * k;
    }
  };
};

/// Compares the stencils of particles in and around a grid of cells of half a metre whose corner is at 1 m.
template <int D>
void check_stencils() {
  using Scene = StencilScene<D>;
  BareGrid grid(D, {3, 2, 4}, {1, 2, 0});
  device::Arguments<double>& a = grid.a;
  a.cell_size = 0.5, a.inverse_cell_size = 2;
  for (double& lower : a.lower) lower = 1;
  std::vector<Coordinates> first_nodes = nodes_between({-3, -4, D == 3 ? -2 : 0}, {5, 5, D == 3 ? 4 : 0});
  const std::size_t count = first_nodes.size();
  std::vector<double> position(count * D);
  for (std::size_t p = 0; p < count; ++p)
    for (int c = 0; c < D; ++c) position[c * count + p] = 1 + 0.5 * (first_nodes[p][c] + 0.75 + 0.125 * c);
  a.particles.field[0] = position.data(), a.particles.stride = static_cast<int>(count);
  for (std::size_t p = 0; p < count; ++p) {
    const device::StencilOf<Scene, false> stencil(a, static_cast<int>(p));
    Coordinates last = first_nodes[p];
    for (int c = 0; c < D; ++c) last[c] += 2;
    const bool inside = grid.holds(first_nodes[p]) && grid.holds(last);
    CHECK(stencil.inside() == inside);
    if (!inside) continue;
    std::vector<Coordinates> found;
    stencil.for_each_node(a, [&](const device::StencilNode<D, double>& s) {
      Coordinates node{};
      double weight = 1;
      for (int c = 0; c < D; ++c) {
        node[c] = s.node[c];
        const int k = node[c] - first_nodes[p][c];
        weight *= 2 + 3 * k;
        CHECK(s.distance[c] == 0.5 * (k - 0.75 - 0.125 * c));
        double gradient = 2.0 * (7 - 2 * k);
        for (int e = 0; e < D; ++e)
          if (e != c) gradient *= 2 + 3 * (s.node[e] - first_nodes[p][e]);
        CHECK(s.gradient[c] == gradient);
      }
      CHECK(s.weight == weight);
      found.push_back(node);
    });
    CHECK(found == nodes_between(first_nodes[p], last));
  }
  for (int c = 0; c < D; ++c) {
    std::vector<double> nowhere(D, 2.0);
    nowhere[c] = std::nan("");
    a.particles.field[0] = nowhere.data(), a.particles.stride = 1;
    CHECK_FALSE(device::StencilOf<Scene, false>(a, 0).inside());
  }
}

/// A scene whose particles have positions alone.
template <int D>
struct MovedScene {
  using Scalar = double;
  static constexpr int dimension = D;
  static constexpr bool sampled = false, axisymmetric = false;
  struct Particle {
    static constexpr int position = 0, strained_domain = -1;
  };
};

/// Moves a particle, by a step of half a second, to a distance beyond one end of one axis, and asks whether it is still inside.
template <int D>
bool stays(int axis, int side, double beyond, int wall, double& arrived, int other_wall = wall_slip) {
  device::Arguments<double> a{};
  a.cell_size = 0.5, a.dt = 0.5, a.particles.stride = a.particles.count = 1;
  double position[3] = {1.6, 2.7, 3.8};
  Vec<D, double> velocity;
  for (int c = 0; c < D; ++c) {
    a.cells[c] = 3 + c, a.lower[c] = 1 + c, velocity[c] = 0.2 * c;
    for (int& kind : a.walls[c]) kind = wall_slip;
  }
  a.walls[axis][side] = wall, a.walls[axis][1 - side] = wall == wall_periodic ? wall : other_wall;
  const double end = side == 0 ? a.lower[axis] - beyond : a.lower[axis] + 0.5 * a.cells[axis] + beyond;
  velocity[axis] = (end - position[axis]) / a.dt;
  a.particles.field[0] = position;
  const bool inside = device::move_particle<MovedScene<D>>(a, 0, velocity);
  arrived = position[axis];
  return inside;
}

/// A particle stays in the domain up to its walls, which rounding may overstep by a billionth of its size, and up to half a
/// cell beyond separating ones; at a periodic end it comes in again at the other.
template <int D>
void check_ways_out() {
  double arrived = 0;
  for (int axis = 0; axis < D; ++axis)
    for (const int side : {0, 1}) {
      INFO(D << "-D, axis " << axis << ", side " << side);
      const double size = 0.5 * (3 + axis), rounding = 1e-9 * size;
      CHECK(stays<D>(axis, side, -0.25 * size, wall_slip, arrived));
      CHECK(stays<D>(axis, side, 0.9 * rounding, wall_slip, arrived));
      CHECK_FALSE(stays<D>(axis, side, 1.1 * rounding, wall_slip, arrived));
      CHECK(stays<D>(axis, side, 0.9 * rounding, wall_stick, arrived));
      CHECK_FALSE(stays<D>(axis, side, 0.1, wall_stick, arrived));
      CHECK(stays<D>(axis, side, 0.24, wall_separate, arrived));
      CHECK_FALSE(stays<D>(axis, side, 0.26, wall_separate, arrived));
      // The margin of one wall is not that of the other.
      CHECK_FALSE(stays<D>(axis, side, 0.1, wall_prescribed, arrived, wall_separate));
      CHECK(stays<D>(axis, side, 0.1, wall_separate, arrived, wall_prescribed));
      for (const double beyond : {0.1, 0.7 * size, 2.3 * size}) {
        CHECK(stays<D>(axis, side, beyond, wall_periodic, arrived));
        const double over = beyond / size - std::floor(beyond / size), lower = 1 + axis;
        CHECK(std::abs(arrived - (lower + (side == 0 ? 1 - over : over) * size)) < 1e-14);
      }
      CHECK_FALSE(stays<D>(axis, side, std::nan(""), wall_separate, arrived));
    }
}

}  // namespace

TEST_CASE("a particle is inside up to its walls and half a cell beyond separating ones, and comes round periodic faces",
          "[device]") {
  check_ways_out<2>();
  check_ways_out<3>();
}

TEST_CASE("a stencil has all its nodes, and says when one of them is beyond the grid", "[device]") {
  check_stencils<2>();
  check_stencils<3>();
}

TEST_CASE("a tile numbers the nodes from one before its block to two behind it", "[device]") {
  check_numbers<2>({-4, 8, 0});
  check_numbers<3>({4, -8, 12});
}

TEST_CASE("a block's particles give to all nodes of the grid, and the runs of its tile and theirs become active",
          "[device]") {
  for (int cells = 1; cells <= 19; cells += 3)
    for (const int padding : {0, 1, 2, 5})
      for (int x = -4; x <= cells + 4; x += 4)
        for (int y = -4; y <= 8; y += 4) {
          check_tile<2, 3>({cells, 6, 0}, {padding, 2, 0}, {x, y, 0}, x % 8 == 0 ? 32 : 5);
          if (cells % 2 == 0) check_tile<3, 2>({cells, 6, 3}, {padding, 2, 1}, {x, y, y == 0 ? 0 : -4}, 32);
        }
}

TEST_CASE("channels that find no room beside the others have the tile after them", "[device]") {
  REQUIRE(device::channels_together<3, 20, double> == 17);
  REQUIRE(device::channels_together<3, 40, double> == 17);
  check_tile<3, 20>({5, 4, 3}, {1, 1, 1}, {0, 0, 0}, 7);
  check_tile<3, 40>({5, 4, 3}, {1, 1, 1}, {4, 0, 0}, 64);
}

TEST_CASE("each line of the grid has its images at walls and periodic faces, the outermost first or last", "[device]") {
  const std::vector<std::array<int, 2>> pairs{{wall_stick, wall_slip},
                                              {wall_periodic, wall_periodic},
                                              {wall_free, wall_separate},
                                              {wall_prescribed, wall_free}};
  for (const Coordinates& cells : {Coordinates{3, 4, 5}, Coordinates{2, 3, 2}})
    for (const auto& walls : pairs)
      for (const bool all_active : {true, false}) {
        BareGrid grid(3, cells, {2, 1, 2});
        for (std::size_t run = 0; run < grid.active.size(); ++run) grid.active[run] = all_active || run % 3 != 0;
        for (auto& of_axis : grid.a.walls) of_axis[0] = walls[0], of_axis[1] = walls[1];
        for (int axis = 0; axis < 3; ++axis) {
          grid.a.axis = axis;
          Coordinates low{-2, -1, -2}, high{cells[0] + 2, cells[1] + 1, cells[2] + 2};
          low[axis] = high[axis] = 0;
          for (const Coordinates& node : nodes_between(low, high))
            for (const bool on_walls : {false, true}) {
              auto expected = expected_folds(grid, axis, node, on_walls);
              std::vector<std::array<int, 9>> first, last;
              const int line = line_of(grid, axis, node);
              device::for_each_fold_of_line(grid.a, line, true, on_walls,
                                            [&](const device::Fold& fold) { first.push_back(told(fold)); });
              device::for_each_fold_of_line(grid.a, line, false, on_walls,
                                            [&](const device::Fold& fold) { last.push_back(told(fold)); });
              CHECK(first == expected);
              std::reverse(expected.begin(), expected.end());
              CHECK(last == expected);
            }
        }
      }
}

TEST_CASE("a node on walls is told of each of them, and at which line", "[device]") {
  BareGrid grid(3, {3, 4, 5}, {2, 1, 2});
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) grid.a.walls[axis][side] = 2 * axis + side;
  for (const Coordinates& node : nodes_between({-2, -1, -2}, {5, 5, 7})) {
    const int index = grid.index(node);
    std::vector<std::array<int, 9>> found, expected;
    device::for_each_wall_of_node<3>(grid.a, index, node.data(),
                                     [&](const device::Fold& fold) { found.push_back(told(fold)); });
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1})
        if (node[axis] == (side == 0 ? 0 : grid.a.cells[axis]))
          expected.push_back({index, index, axis, side, 2 * axis + side, line_of(grid, axis, node), index,
                              side == 0 ? stride_of(grid, axis) : -stride_of(grid, axis), 0});
    CHECK(found == expected);
  }
}

TEST_CASE("a scan over lanes uses each index once, with the sums of all before it", "[device]") {
  for (const int lanes : {1, 3, 8})
    for (const int count : {0, 1, 5, 8, 20})
      for (const bool starts : {false, true}) {
        INFO(count << " indices on " << lanes << " lanes");
        const std::array<int, 2> start{40, 7};
        std::vector<int> shared(static_cast<std::size_t>(2 * lanes), -1);
        std::vector<std::array<int, 3>> used, expected;
        device::scan_over_lanes(
            device::Team(shared.data(), 0, lanes, device::order_upwards), 10, 10 + count,
            starts ? start.data() : nullptr, [](int index, int* sums) { sums[0] += index, sums[1] += 1; },
            [&](int index, const int* before) {
              used.push_back({index, before[0], before[1]});
            });
        std::array<int, 2> before = starts ? start : std::array<int, 2>{0, 0};
        for (int index = 10; index < 10 + count; ++index) {
          expected.push_back({index, before[0], before[1]});
          before[0] += index, before[1] += 1;
        }
        CHECK(used == expected);
      }
}

TEST_CASE("the sums of a table's chunks become those of all chunks before, and nothing beyond them is touched",
          "[device]") {
  for (const int table : {1, 1023, 1024, 1025, 3072}) {
    INFO(table << " blocks");
    const int chunks = (table - 1) / 1024 + 1, untouched = -9;
    std::vector<int> chunk, before(static_cast<std::size_t>(2 * chunks + 4), untouched), expected, shared(8);
    for (int k = 0; k < chunks + 2; ++k) chunk.push_back(100 + k), chunk.push_back(10 + k);
    int in_order = 0, active = -1, particles = 0, blocks = 0;
    for (int k = 0; k < chunks; ++k) {
      expected.push_back(particles), expected.push_back(blocks);
      particles += 100 + k, blocks += 10 + k;
    }
    expected.resize(before.size(), untouched);
    std::vector<int> begin(static_cast<std::size_t>(blocks + 40), untouched);
    device::Arguments<double> a{};
    a.particles.count = particles;
    a.blocks.table = table, a.blocks.in_order = &in_order, a.blocks.active = &active, a.blocks.begin = begin.data();
    a.blocks.chunk = chunk.data(), a.blocks.before_chunk = before.data();
    device::scan_chunks<SortedScene>(device::Team(shared.data(), 0, 4, device::order_downwards), a);
    CHECK(before == expected);
    CHECK(active == blocks);
    CHECK(begin[static_cast<std::size_t>(blocks)] == particles);
  }
}

TEST_CASE("a launch that an earlier one has stopped does nothing, and the one that stopped runs to its end",
          "[device]") {
  device::Stopped stop = device::nothing_stopped;
  device::Arguments<double> a{};
  a.stop = &stop;
  const auto runs = [&](int launch) {
    runs_of_kernel = 0, a.launch = launch;
    device::run_unless_stopped<count_run>(device::Team(nullptr, 0, 1, device::order_upwards), a);
    return runs_of_kernel == 1;
  };
  CHECK(runs(9));
  a.launch = 5;
  device::report(a, 12);
  CHECK(stop == ((5ull << 32) | 12));
  CHECK(runs(4));
  CHECK(runs(5));
  CHECK_FALSE(runs(6));
  CHECK_FALSE(runs(9));
}

// Single phases on arrays made by hand, where a run would not reach them.

#include "device/device_support.hpp"
#include "operators/edges.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The fields of a grid of `cells` x 1 cells with 3 ghosts a side, slip walls, every node of mass 1 and momentum (1, 2).
struct SmallGrid {
  int nodes;
  std::vector<std::vector<double>> arrays;
  double *mass, *momentum, *velocity;
  std::vector<int> folded;
  device::Arguments<double> a{};

  SmallGrid(int cells, const std::vector<Field>& fields) : nodes((cells + 7) * 8) {
    for (const Field& field : fields) {
      arrays.emplace_back(field.components * nodes);
      a.grid.field[arrays.size() - 1] = arrays.back().data();
      if (field.id == "mass") mass = arrays.back().data();
      if (field.id == "momentum") momentum = arrays.back().data();
      if (field.id == "velocity") velocity = arrays.back().data();
    }
    std::fill_n(mass, nodes, 1.0);
    std::fill_n(momentum, nodes, 1.0);
    std::fill_n(momentum + nodes, nodes, 2.0);
    folded.assign(nodes, 0);
    a.node_count = nodes;
    for (int c = 0; c < 2; ++c) {
      a.cells[c] = c == 0 ? cells : 1, a.padding[c] = 3, a.extent[c] = a.cells[c] + 7;
      for (int side = 0; side < 2; ++side) a.walls[c][side] = wall_slip;
    }
    a.grid.folded = folded.data();
  }
  int node(int i, int j) const { return (j + 3) * a.extent[0] + i + 3; }
};

/// Reflections that take node i into the cell between 0 and 1; it lands on i modulo 2.
int reflections(int i) {
  return i < 0 ? -i : std::max(i - 1, 0);
}

device::Choice usual_choice() {
  return device_choice_of(device_experiment(Mix{}.text(), "double"));
}

}  // namespace

TEST_CASE("in a domain of one cell ghosts fold from wall to wall until they are inside", "[device]") {
  const device::HostDevice device = Devices::shared().of(usual_choice());
  SmallGrid grid(1, usual_choice().node_fields);
  for (const int axis : {0, 1}) {
    grid.a.axis = axis;
    device.run("fold_masses", grid.a, 3, {3, axis == 1});
  }
  double total = 0;
  for (int j = -3; j <= 4; ++j)
    for (int i = -3; i <= 4; ++i) {
      const bool inside = i >= 0 && i <= 1 && j >= 0 && j <= 1;
      INFO("node " << i << ", " << j);
      CHECK(grid.mass[grid.node(i, j)] == (inside ? 16 : 0));  // 4 of 8 nodes a line fold onto each, on both axes
      total += grid.mass[grid.node(i, j)];
    }
  CHECK(total == grid.nodes);
  // -3, 3, -1 and 1 meet at node 1 with the signs -, +, -, + of one component more or less: nothing is left across.
  CHECK(grid.momentum[grid.node(1, 0)] == 0);
  CHECK(grid.momentum[grid.nodes + grid.node(1, 0)] == 0);

  // Filled in the reverse order, every ghost takes the velocity of the node that it ended on.
  for (int j = 0; j <= 1; ++j)
    for (int i = 0; i <= 1; ++i) {
      grid.velocity[grid.node(i, j)] = 10 + i;
      grid.velocity[grid.nodes + grid.node(i, j)] = 20 + j;
    }
  for (const int axis : {1, 0}) {
    grid.a.axis = axis;
    device.run("fill_velocities", grid.a, 3, {3, false});
  }
  for (int j = -3; j <= 4; ++j)
    for (int i = -3; i <= 4; ++i) {
      INFO("node " << i << ", " << j);
      const int sign_x = reflections(i) % 2 ? -1 : 1, sign_y = reflections(j) % 2 ? -1 : 1;
      CHECK(grid.velocity[grid.node(i, j)] == sign_x * (10 + (i & 1)));
      CHECK(grid.velocity[grid.nodes + grid.node(i, j)] == sign_y * (20 + (j & 1)));
    }
}

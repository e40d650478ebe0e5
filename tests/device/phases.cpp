// Single phases on arrays made by hand, where a run would not reach them.

#include <climits>

#include "backends/device/device.hpp"
#include "backends/device/kernels/stopping.hpp"
#include "device/device_support.hpp"
#include "operators/edges.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The fields of a grid of `cells` x 1 cells with 3 ghosts a side, slip walls, every node of mass 1 and momentum (1, 2).
struct SmallGrid {
  int nodes;
  std::vector<std::vector<double>> arrays;
  std::map<std::string, double*> of;  ///< fields by their id
  double *mass, *momentum, *velocity;
  std::vector<int> folded;
  device::Arguments<double> a{};

  SmallGrid(int cells, const std::vector<Field>& fields) : nodes((cells + 7) * 8) {
    for (const Field& field : fields) {
      arrays.emplace_back(field.components * nodes);
      of[field.id] = arrays.back().data();
    }
    mass = of.at("mass"), momentum = of.at("momentum"), velocity = of.at("velocity");
    std::fill_n(mass, nodes, 1.0);
    std::fill_n(momentum, nodes, 1.0);
    std::fill_n(momentum + nodes, nodes, 2.0);
    folded.assign(nodes, 0);
    a.node_count = nodes;
    for (int c = 0; c < 2; ++c) {
      a.cells[c] = c == 0 ? cells : 1, a.padding[c] = 3, a.extent[c] = a.cells[c] + 7;
      for (int side = 0; side < 2; ++side) a.walls[c][side] = wall_slip;
    }
  }
  /// Runs a phase on copies on a device, and takes these back.
  void run(const device::Choice& choice, const std::string& phase, int teams, const TeamShape& team) {
    const device::DeviceSetup setup = device_setup(team);
    device::Device device(*setup.driver, setup.number);
    const device::Composition composition = device::compose(choice);
    device.load(Programs::shared().of(composition), composition.name);
    std::vector<device::DeviceArray<double>> copies;
    for (const std::vector<double>& array : arrays) {
      copies.emplace_back(device, "a field").upload(array);
      a.grid.field[copies.size() - 1] = copies.back().data();
    }
    device::DeviceArray<int> folds(device, "folds");
    folds.upload(folded);
    a.grid.folded = folds.data();
    device::DeviceArray<unsigned char> active(device, "active",
                                              (nodes + device::nodes_of_run - 1) / device::nodes_of_run);
    active.fill(1);
    a.grid.active = active.data();
    device::DeviceArray<device::Stopped> stop(device, "the failed particle");
    stop.upload(std::vector<device::Stopped>{device::nothing_stopped});
    a.stop = stop.data();
    device.launch(phase, a, teams, team.lanes);
    for (std::size_t k = 0; k < copies.size(); ++k) {
      const std::vector<double> values = copies[k].download();
      std::copy(values.begin(), values.end(), arrays[k].begin());
    }
    folded = folds.download();
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

Field summed_field(const std::string& id, int components, AtWall at_wall, Folded folded) {
  Field field;
  field.id = field.name = id, field.owner = Owner::node, field.components = components;
  field.lifetime = Lifetime::step, field.cleared = true;
  field.at_wall = at_wall, field.folded = folded;
  return field;
}

}  // namespace

TEST_CASE("in a domain of one cell ghosts fold from wall to wall until they are inside", "[device]") {
  SmallGrid grid(1, usual_choice().node_fields);
  for (const int axis : {0, 1}) {
    grid.a.axis = axis;
    grid.run(usual_choice(), "fold_masses", 3, {3, axis == 1});
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
    grid.run(usual_choice(), "fill_velocities", 3, {3, false});
  }
  for (int j = -3; j <= 4; ++j)
    for (int i = -3; i <= 4; ++i) {
      INFO("node " << i << ", " << j);
      const int sign_x = reflections(i) % 2 ? -1 : 1, sign_y = reflections(j) % 2 ? -1 : 1;
      CHECK(grid.velocity[grid.node(i, j)] == sign_x * (10 + (i & 1)));
      CHECK(grid.velocity[grid.nodes + grid.node(i, j)] == sign_y * (20 + (j & 1)));
    }
}

TEST_CASE("nodes clear and fold what is added to the plan's list on the host-run device", "[device]") {
  const Experiment experiment = device_experiment(Mix{}.text(), "double");
  Plan plan = make_plan(experiment);
  plan.fields.push_back(summed_field("heat", 1, AtWall::even, Folded::with_mass));
  plan.fields.push_back(summed_field("couple", 2, AtWall::vector, Folded::with_force));
  plan.fields.push_back(summed_field("normal", 2, AtWall::slip, Folded::with_mass));
  const device::Choice choice = device::choice_of(experiment, plan);
  SmallGrid grid(8, choice.node_fields);
  grid.a.walls[0][1] = wall_stick;
  for (std::vector<double>& array : grid.arrays) std::fill(array.begin(), array.end(), 3.0);
  const auto all = [&](const std::string& id, int component, double value) {
    std::fill_n(grid.of.at(id) + component * grid.nodes, grid.nodes, value);
  };
  const auto value = [&](const std::string& id, int component, int i) {
    return grid.of.at(id)[component * grid.nodes + grid.node(i, 1)];
  };
  grid.run(choice, "clear", grid.nodes, {1, false});
  for (const std::string id : {"heat", "couple", "normal", "mass", "momentum"}) CHECK(value(id, 0, 2) == 0);
  CHECK(value("couple", 1, 2) == 0);

  all("mass", 0, 1), all("heat", 0, 1);
  for (const std::string id : {"couple", "normal"}) all(id, 0, 1), all(id, 1, 2);
  grid.run(choice, "fold_masses", 3, {3, false});
  grid.run(choice, "fold_forces", 3, {3, false});
  for (const int i : {1, 7}) {
    INFO("node " << i << " of 8");
    CHECK(value("heat", 0, i) == 2);
    CHECK(value("normal", 0, i) == 0);
    CHECK(value("normal", 1, i) == 4);
    CHECK(value("couple", 0, i) == 0);
    CHECK(value("couple", 1, i) == (i == 1 ? 4 : 0));  // slip mirrors what lies across the wall, stick everything
  }
  CHECK(value("normal", 0, 0) == 0);  // the normal component vanishes on the wall
  CHECK(value("normal", 1, 0) == 2);
  CHECK(value("couple", 0, 0) == 1);
  CHECK(value("heat", 0, 4) == 1);
  CHECK(value("heat", 0, -1) == 0);  // the ghost's heat has been given away
  CHECK(value("couple", 1, -1) == 0);
}

// Particles are sorted into blocks on the device; the expected order is that of a stable sort on the host.

#include <climits>
#include <numeric>
#include <random>

#include "backends/device/sorting.hpp"
#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The order of a body's particles by blocks of 4 cells, x first, and where each block begins.
struct Order {
  std::vector<std::array<int, 3>> cells;
  std::vector<int> begin, order;

  bool operator==(const Order&) const = default;
};

/// Finds it by std::stable_sort; positions in cells, [component][particle].
Order expected_order(const std::vector<double>& x, int dimension) {
  const std::size_t count = x.size() / dimension;
  const auto cell_of = [&](int p) {
    std::array<int, 3> cell{};
    for (int c = 0; c < dimension; ++c) cell[c] = 4 * static_cast<int>(std::floor(x[c * count + p] / 4));
    return cell;
  };
  Order found;
  found.order.resize(count);
  std::iota(found.order.begin(), found.order.end(), 0);
  std::stable_sort(found.order.begin(), found.order.end(), [&](int a, int b) {
    const std::array<int, 3> first = cell_of(a), second = cell_of(b);
    return std::lexicographical_compare(first.rbegin(), first.rend(), second.rbegin(), second.rend());
  });
  for (std::size_t k = 0; k < count; ++k)
    if (k == 0 || cell_of(found.order[k]) != cell_of(found.order[k - 1]))
      found.cells.push_back(cell_of(found.order[k])), found.begin.push_back(static_cast<int>(k));
  found.begin.push_back(static_cast<int>(count));
  return found;
}

/// The particles of a grid of 600 x 40 (x 9) cells of 1 m with 3 ghosts a side, which are sorted on a device.
class Sorted {
 public:
  Sorted(int dimension, std::size_t count, const TeamShape& team, int teams)
      : dimension_(dimension),
        team_(team),
        setup_(device_setup(team)),
        device_(*setup_.driver, setup_.number),
        position_(device_, "positions", dimension * count),
        stop_(device_, "the failed particle") {
    Mix mix;
    mix.dimension = dimension;
    const device::Choice choice = device_choice_of(device_experiment(mix.text(), "double"));
    const device::Composition composition = device::compose(choice);
    device_.load(Programs::shared().of(composition), composition.name);
    a_.inverse_cell_size = a_.cell_size = 1;
    for (int c = 0; c < dimension; ++c) a_.cells[c] = std::array{600, 40, 9}[c], a_.padding[c] = 3;
    blocks_.emplace(device_, "b", a_, dimension, count);
    a_.particles.count = a_.particles.stride = static_cast<int>(count);
    a_.particles.field[device::number_of(choice.particle_fields, "position")] = position_.data();
    a_.blocks = blocks_->table();
    a_.teams = teams;
    stop_.upload(std::vector<device::Stopped>{device::nothing_stopped});
    a_.stop = stop_.data();
  }

  Order sort(const std::vector<double>& x) {
    position_.upload(x);
    const auto over = [&](int count) { return (count + team_.lanes - 1) / team_.lanes; };
    const int particles = over(a_.particles.count), table = over(a_.blocks.table);
    for (const auto& [phase, teams] : {std::pair{"find_blocks", particles},
                                       {"clear_counts", table},
                                       {"count_particles", particles},
                                       {"sum_chunks", blocks_->chunks()},
                                       {"scan_chunks", 1},
                                       {"number_blocks", blocks_->chunks()},
                                       {"place_particles", particles},
                                       {"order_blocks", a_.teams},
                                       {"end_sort", 1}})
      device_.launch(phase, a_, teams, team_.lanes);
    return read();
  }
  /// Reads the order that stands on the device.
  Order read() {
    const auto values = [&](const int* from, std::size_t count) {
      std::vector<int> found(count);
      device_.read(found.data(), reinterpret_cast<std::uintptr_t>(from), count * sizeof(int));
      return found;
    };
    const auto active = static_cast<std::size_t>(values(a_.blocks.active, 1)[0]);
    Order found;
    found.begin = values(a_.blocks.begin, active + 1);
    found.order = values(a_.blocks.order, a_.particles.count);
    const std::vector<int> cells = values(a_.blocks.cell, 3 * active);
    for (std::size_t k = 0; k < active; ++k) {
      found.cells.push_back({});
      for (int c = 0; c < dimension_; ++c) found.cells.back()[c] = cells[3 * k + c];
    }
    return found;
  }
  /// Turns the order round, so that it shows whether a sort makes it anew.
  void spoil() {
    std::vector<int> order = read().order;
    std::reverse(order.begin(), order.end());
    device_.copy_in(reinterpret_cast<std::uintptr_t>(a_.blocks.order), order.data(), order.size() * sizeof(int));
  }
  int chunks() const { return blocks_->chunks(); }

 private:
  int dimension_;
  TeamShape team_;
  device::DeviceSetup setup_;
  device::Device device_;
  device::DeviceArray<double> position_;
  device::DeviceArray<device::Stopped> stop_;
  device::Arguments<double> a_{};
  std::optional<device::Blocks> blocks_;
};

/// Particles thrown over the grid and its ghosts, most of them in a few blocks.
std::vector<double> thrown(int dimension, std::size_t count) {
  std::mt19937 random(5);
  std::vector<double> x;
  for (int c = 0; c < dimension; ++c)
    for (std::size_t p = 0; p < count; ++p) {
      const double cells = std::array{600, 40, 9}[c];
      std::uniform_real_distribution<double> everywhere(-3, cells + 3), near(0, std::min(cells, 6.0));
      x.push_back(p % 5 == 0 ? everywhere(random) : near(random));
    }
  return x;
}

}  // namespace

TEST_CASE("the device sorts particles into blocks as a stable sort does, whatever the order of lanes",
          "[device][sorting]") {
  for (const int dimension : {2, 3})
    for (const std::size_t count : {1u, 3u, 257u, 3000u}) {
      const std::vector<double> x = thrown(dimension, count);
      const Order expected = expected_order(x, dimension);
      for (const TeamShape team : {TeamShape{1, TeamShape::upwards},
                                   {7, TeamShape::downwards},
                                   {32, TeamShape::upwards},
                                   {256, TeamShape::downwards},
                                   {32, TeamShape::shuffled(0)}})
        for (const int teams : {1, 5}) {
          INFO(dimension << "-D, " << count << " particles, " << team.lanes << " lanes, " << teams << " teams");
          Sorted particles(dimension, count, team, teams);
          CHECK((particles.chunks() > 1));
          CHECK((particles.sort(x) == expected));
        }
    }
}

TEST_CASE("the device sorts again only when a particle has left its block", "[device][sorting]") {
  std::vector<double> x = thrown(2, 500);
  Sorted particles(2, 500, {32, TeamShape::upwards}, 3);
  particles.sort(x);
  particles.spoil();
  const Order spoiled = particles.read();
  for (std::size_t p = 0; p < 500; ++p) x[p] = 4 * std::floor(x[p] / 4) + 2;  // all move, none beyond its block
  CHECK((particles.sort(x) == spoiled));
  x[123] += 4;
  CHECK((particles.sort(x) == expected_order(x, 2)));
}

TEST_CASE("positions beyond the grid, and what is no number, are sorted into blocks at its edge", "[device][sorting]") {
  std::vector<double> x{3, 1e30, -1e30, std::numeric_limits<double>::quiet_NaN(), 3, 5, 5, 5};
  Sorted particles(2, 4, {32, TeamShape::upwards}, 3);
  const Order found = particles.sort(x);
  CHECK((found.cells == std::vector<std::array<int, 3>>{{0, 0, 0}, {-4, 4, 0}, {600, 4, 0}}));
  CHECK((found.order == std::vector<int>{0, 2, 3, 1}));
}

TEST_CASE("the number of teams that share the blocks of particles changes rounding only", "[device][sorting]") {
  Mix mix;
  mix.contact = R"({"type": "coulomb", "friction": 0.2})", mix.close = true;
  const std::string text = mix.text();
  DeviceScene usual(text, "double");
  usual.run();
  for (const int teams : {1, 2, 1000}) {
    const Experiment experiment = device_experiment(text, "double");
    device::DeviceSetup setup = device_setup();
    setup.teams = teams;
    Simulation simulation(experiment, device_factory(setup));
    while (!simulation.finished()) simulation.step();
    for (const int body : {0, 1})
      CHECK(state_difference(experiment, usual.body(body), simulation.backend().body_state(body)) <= 1e2 * 0x1p-52);
  }
}

TEST_CASE("the blocks of a grid have room in as many chunks as they fill, and lists as long as particles can fill",
          "[device][sorting]") {
  for (const auto& [table, chunks] : {std::pair{1, 1}, {1023, 1}, {1024, 1}, {1025, 2}, {2048, 2}, {2049, 3}})
    CHECK(device::BlockRoom(table, 10).chunks == chunks);
  CHECK(device::BlockRoom(2000, 10).most == 10);
  CHECK(device::BlockRoom(5, 10).most == 5);
  const device::DeviceSetup setup = device_setup();
  device::Device device(*setup.driver, 0);
  device::Arguments<double> scene{};
  for (int c = 0; c < 3; ++c) scene.cells[c] = 40, scene.padding[c] = 1;
  const device::Blocks blocks(device, "b", scene, 3, 10);
  REQUIRE(blocks.chunks() == 2);
  // Two numbers a chunk of either kind, and neither reaches into the other's room or beyond it.
  const std::size_t of_kind = device::BlockRoom(blocks.table().table, 10).of_chunks / 2;
  CHECK(of_kind == 4);
  CHECK(static_cast<std::size_t>(blocks.table().before_chunk - blocks.table().chunk) == of_kind);
}

// What a run takes on a device, which is counted before it begins: beside what a driver is asked for, and as a hand counts.

#include "backends/device/memory.hpp"

#include <regex>
#include <set>

#include "backends/device/contact_sight.hpp"
#include "backends/device/sorting.hpp"
#include "device/device_support.hpp"
#include "device/scene_size.hpp"
#include "simulation/boundary.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A device of one mebibyte for the time of a test.
struct SmallDevice {
  SmallDevice() {
    device_setup();  // so that the usual ones are not set later
    device::set_host_devices({{"a small one", 1 << 20}});
  }
  ~SmallDevice() { use_usual_devices(); }
};

/// Stands in for the allocation of the host's driver, and refuses one, whose bytes it keeps.
struct OneRefused {
  inline static long before = 0;  ///< how many are given
  inline static std::size_t bytes = 0;
  static device::DriverResult allocate(device::DevicePointer* pointer, std::size_t asked) {
    if (before-- > 0) return device::host_driver().cuMemAlloc_v2(pointer, asked);
    bytes = asked;
    return device::driver_out_of_memory;
  }
};

/// The bytes that a run of one step asks a device for, by what they are for: each allocation is refused once, and said.
std::map<std::string, double> asked_by_name(const Experiment& experiment) {
  device::Driver driver = device::host_driver();
  driver.cuMemAlloc_v2 = OneRefused::allocate;
  device::DeviceSetup setup = device_setup();
  setup.driver = &driver;
  std::map<std::string, double> asked;
  for (long given = 0;; ++given) {
    OneRefused::before = given;
    try {
      Simulation simulation(experiment, device_factory(setup));
      simulation.step();
      return asked;
    } catch (const device::DeviceError& error) {
      const std::string message = error.what();
      std::smatch found;
      REQUIRE(std::regex_search(message, found, std::regex(" to give [\\d.e+]+ \\w+ to (.+), with ")));
      asked[found[1]] += static_cast<double>(OneRefused::bytes);
    }
  }
}

/// The bytes that are counted before the run, by the same names.
std::map<std::string, double> counted_by_name(const Experiment& experiment, const device::SceneSize& size) {
  static const std::map<std::string, std::string> apart{{"contact", "contact"},
                                                        {"welds", "welds"},
                                                        {"contact nodes", "contact nodes"},
                                                        {"exact sums", "exact sums"},
                                                        {"sums", "sums"},
                                                        {"formula numbers", "the numbers of formulas"},
                                                        {"nodes that meet", "nodes that meet"},
                                                        {"rows of particles", "rows of particles"}};
  std::map<std::string, double> counted;
  for (const device::TakenMemory& taken : device::taken_memory(experiment, make_plan(experiment), size)) {
    const bool of_blocks = taken.field == "blocks" || taken.field == "tables of blocks";
    const bool of_loads = taken.field == "loads" || taken.field == "shares of loads";
    const char* const what = of_blocks ? "the blocks of " : of_loads ? "the loads of " : "the particles of ";
    const std::string name = taken.body >= 0            ? what + experiment.bodies[taken.body].name
                             : apart.count(taken.field) ? apart.at(taken.field)
                                                        : "the nodes";
    counted[name] += taken.bytes;
  }
  return counted;
}

/// Three bodies whose contact looks at particles and at the traction between them, and is recorded by the node.
Experiment three_bodies(const std::string& precision, const std::vector<std::string>& overrides = {}) {
  std::string bodies;
  for (const std::string name : {"a", "b", "c"})
    bodies += (bodies.empty() ? R"({"name": ")" : R"(, {"name": ")") + name +
              R"(", "material": "m", "geometry": {"type": "box", "lower": [)" + (name == "a" ? "0.2" : "0.5") + ", " +
              (name == "c" ? "0.5" : "0.2") + R"(], "upper": [)" + (name == "a" ? "0.49" : "0.8") + ", " +
              (name == "c" ? "0.7" : "0.48") + "]}}";
  return device_experiment(R"({"title": "three", "dimension": 2, "gravity": [0, -1], "grid": {"cell_size": 0.1,
      "domain": [[0, 0], [1.3, 0.9]], "boundaries": {"all": "slip"}}, "shape": {"type": "bspline_quadratic"},
      "transfer": {"type": "pic"}, "materials": {"m": {"type": "inviscid_fluid", "density": 1000, "bulk_modulus": 1000}}, "contact": {"type": "adhesion", "normal_strength": 300, "shear_strength": 200,
      "normal": "widest_gap"}, "output": {"ledger": false, "frames": 2, "contact_nodes": true}, "bodies": [)" +
                               bodies + R"(], "solver": {"time_step": 0.001, "end_time": 0.1}})",
                           precision, overrides);
}

/// What is taken by this name, of nodes or of the first body.
device::TakenMemory named(const std::vector<device::TakenMemory>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& taken) { return taken.field == name; });
  INFO(name);
  REQUIRE(found != all.end());
  return *found;
}

}  // namespace

TEST_CASE("every array of a device is counted before a run begins as the driver is asked for it", "[device][memory]") {
  for (const std::string precision : {"double", "float"}) {
    const Experiment experiment =
        three_bodies(precision, {deterministic_sums, R"J(/body_force=["x", "2+t"])J",
                                 R"(/loads=[{"type": "force", "body": "a", "at": [0.31, 0.33], "force": [5, 2]}])",
                                 R"J(/rigid_bodies=[{"name": "floor", "contact": {"type": "frictionless"},
                        "geometry": {"type": "half_space", "point": [0, 0.15], "normal": [0, 1]}}])J"});
    const std::map<std::string, double> asked = asked_by_name(experiment);
    const Simulation simulation(experiment, device_factory());
    device::SceneSize size = scene_size(experiment, simulation.backend());
    size.load_shares = {1, 0, 0};  // one particle is nearest to the point
    const std::map<std::string, double> counted = counted_by_name(experiment, size);
    CHECK(counted.size() == 16);
    std::set<std::string> fixed;  // tables of a fixed length, and the nodes near rigid bodies
    for (const auto& [name, bytes] : asked)
      if (!counted.count(name)) fixed.insert(name);
    CHECK(fixed == std::set<std::string>{"rigid bodies", "the bodies that meet", "the edges of bodies", "the loads",
                                         "the parameters of a material", "the parameters of contact"});
    for (auto [name, bytes] : counted) {
      INFO(name << ", " << precision);
      if (name == "exact sums") bytes += 9 * 4;  // beside them stands the largest exponent of each channel
      REQUIRE(asked.count(name) == 1);
      CHECK(asked.at(name) == bytes);
    }
  }
}

TEST_CASE("what a particle and a node take on a device is as a hand counts it", "[device][memory]") {
  const Experiment experiment = three_bodies("double", {deterministic_sums});
  const Plan plan = make_plan(experiment);
  const std::vector<device::TakenMemory> of_one = device::taken_by_one(experiment, plan);
  struct Expected {
    std::string field;
    int components;
    double bytes;
    bool working;
  };
  // Numbers of 8 bytes, of three velocity fields at a node, and of three pairs of them with an int of 4 bytes. A scatter
  // has 9 channels: mass, momentum and force, the gradient of volume, and the position of mass.
  for (const auto& [field, components, bytes, working] :
       std::vector<Expected>{{"position", 2, 16, false},
                             {"velocity", 2, 16, false},
                             {"stress", 4, 32, true},
                             {"blocks", 2, 8, true},
                             {"momentum", 2, 3 * 16, true},
                             {"folded", 1, 3 * 4, true},
                             {"contact", 4, 3 * (4 * 8 + 4), true},
                             {"nodes that meet", 1, 4, true},
                             {"welds", 3, 3 * 3 * 8, true},
                             {"contact nodes", 6, 3 * (6 * 8 + 4), true},
                             {"exact sums", 18, 18 * 8, true},
                             {"active", 1, 3.0 / 16, true}}) {
    const device::TakenMemory taken = named(of_one, field);
    CHECK(taken.components == components);
    CHECK(taken.bytes == bytes);
    CHECK(taken.working == working);
  }
  // A byte for each run of 16 nodes and velocity field; 17 sums a team, one of the step's end, 8192 of it and 24 totals.
  const auto taken = device::taken_memory(experiment, plan, {{1, 1, 1}, 32, 1, 1});
  CHECK(named(taken, "active").bytes == 3 * 2);
  CHECK(named(device::taken_memory(experiment, plan, {{1, 1, 1}, 33, 1, 1}), "active").bytes == 3 * 3);
  CHECK(named(taken, "sums").bytes == (17 * 33 + 1 + 8192 + 24) * 8);

  // A row has room for half as many particles again as 3 x 3 cells hold, and its lane looks for one node in 16.
  CHECK(named(taken, "rows of particles").bytes == 3 * 54 * 2 * 8);
  const auto large = device::taken_memory(experiment, plan, {{1, 1, 1}, 1000000, 1, 128});
  CHECK(named(large, "rows of particles").bytes == 16384 * 54 * 2 * 8);
  // Rows of 12^3 cells' particles would take more than 256 MiB.
  Mix fine;
  fine.dimension = 3, fine.contact = R"({"type": "coulomb", "normal": "widest_gap"})";
  fine.overrides = {set("/bodies/1/particles_per_cell_axis", "4")};
  const device::SightRoom many(device_experiment(fine.text(), "double", fine.overrides), 10000000, 128);
  CHECK(many.row_length == 2592);
  CHECK(many.lanes() == 34 * 128);
  Mix by_sums = fine;
  by_sums.contact = R"({"type": "coulomb"})";
  CHECK(device::SightRoom(device_experiment(by_sums.text(), "double"), 10000000, 128).numbers() == 0);

  // Without contact a scatter has 5 channels, but that of heat up to 6: heat, its capacity and place, and what walls let in.
  Mix warm;
  warm.material = R"({"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
    "thermal": {"conductivity": 500, "heat_capacity": 10}})";
  warm.overrides = {set("/bodies/0/temperature", "20"), set("/bodies/1/temperature", "25"), deterministic_sums};
  const Experiment heated = device_experiment(warm.text(), "double", warm.overrides);
  CHECK(named(device::taken_by_one(heated, make_plan(heated)), "exact sums").components == 2 * 6);
}

TEST_CASE("what a load asks a run to keep is as a hand counts it", "[device][memory]") {
  const Experiment pushed = three_bodies(
      "double",
      {R"J(/body_force=["X", 0])J", R"(/loads=[{"type": "force", "body": "a", "at": [0.3, 0.3], "force": [5, 2]}])"});
  const std::vector<device::TakenMemory> taken = device::taken_by_one(pushed, make_plan(pushed));
  CHECK_FALSE(named(taken, "initial_position").working);
  // Where each particle's shares begin, of the body that carries some, and a share of 4 + 8 * 16 bytes and its alignment.
  std::vector<int> loaded;
  for (const device::TakenMemory& field : taken)
    if (field.field == "loads") loaded.push_back(field.body);
  CHECK(loaded == std::vector<int>{0});
  CHECK(named(taken, "loads").bytes == 4);
  const auto all = device::taken_memory(pushed, make_plan(pushed), {{9, 9, 9}, 100, 1, 1, {3, 0, 0}});
  CHECK(named(all, "shares of loads").bytes == 3 * 136 + 4);  // and where the last ones end
  CHECK(named(all, "loads").bytes == 9 * 4);
  // The fluid does not keep how it is deformed for itself, and the bodies without a load have the field as well.
  std::vector<int> of_deformation;
  for (const device::TakenMemory& field : taken)
    if (field.field == "deformation") of_deformation.push_back(field.components);
  CHECK(of_deformation == std::vector<int>(3, 2 * 2));
}

TEST_CASE("a run that does not fit is refused with what takes most and whose it is", "[device][memory]") {
  const SmallDevice small;
  const Experiment experiment = three_bodies("double");
  const Plan plan = make_plan(experiment);
  const device::Device device(device::host_driver(), 0);
  const device::SceneSize size{{10, 20, 100000}, 20000, 100, 1};
  double asked = 0;
  for (const device::TakenMemory& taken : device::taken_memory(experiment, plan, size)) asked += taken.bytes;
  // (17 * 100001 + 8217) * 8, 100000 * 32 and 20000 * 156 bytes.
  CHECK_THROWS_WITH(
      device::refuse_what_does_not_fit(device, experiment, plan, size),
      "this run needs " + device::bytes_in_words(asked) +
          " on device a small one, which has 1 MiB free; most is taken by sums of the run (13 MiB), stress of the "
          "particles of c (3.05 MiB), contact nodes of the nodes (2.98 MiB): use larger cells, fewer particles a cell, "
          "--set /precision=float, a device with more memory, or --backend cpu");
}

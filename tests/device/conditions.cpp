// What a scene gives from outside: walls that move, boxes of nodes, body forces; and what a run keeps: its ledger, its
// second moments and its checkpoints.

#include "device/covering.hpp"
#include "parity/heat_scenes.hpp"
#include "parity/rigid_scenes.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string coulomb = R"({"type": "coulomb", "friction": 0.2})";
const std::string flip = R"({"type": "flip"})";
const std::string von_mises =
    R"({"type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 60})";

Mix close_mix(int dimension) {
  Mix mix;
  mix.dimension = dimension;
  mix.close = true;
  return mix;
}

/// A wall that comes towards the bodies, with a velocity along it that depends on place and time.
std::string moving_wall(int dimension) {
  return std::string(R"({"all": "slip", "y_min": {"type": "prescribed", "velocity": ["0.3+t", "0.1*x")") +
         (dimension == 3 ? ", \"0.2*x\"]}}" : "]}}");
}

std::string box(int dimension, const std::string& condition) {
  const std::string corners = dimension == 2 ? R"("lower": [0.2, 0.1], "upper": [0.4, 0.3])"
                                             : R"("lower": [0.2, 0.1, 0.1], "upper": [0.4, 0.3, 0.3])";
  return R"({)" + corners + ", " + condition + "}";
}

/// Every entry of the ledger in each order of the stress update, with both filters, in 2-D and 3-D.
void check_ledgers(bool both_precisions) {
  for (const int dimension : {2, 3}) {
    std::size_t turn = dimension == 2 ? 0 : 1;  // so that each order has each precision with each filter
    for (const std::string& order : orders) {
      ++turn;
      if (dimension == 3 && order == "first") continue;  // 2-D has all orders
      Mix mix = close_mix(dimension);
      mix.material = von_mises, mix.contact = coulomb, mix.stress_update = order;
      mix.filter = R"({"type": "xpic", "order": 2})";
      mix.more = std::string(R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y")J") + (dimension == 3 ? ", 1]" : "]");
      mix.boundaries = R"({"all": "slip", "x_max": "stick", "x_min": "separate"})";
      check_on_device(mix, precisions_in_turn(both_precisions, turn));
      mix.more += R"(, "output": {"ledger_every": 3})";
      mix.filter = R"({"type": "fmpm", "order": 2})";
      check_on_device(mix, precisions_in_turn(both_precisions, turn + 1));
    }
  }
}

}  // namespace

TEST_CASE("walls that move on the host-run device", "[device]") {
  for (const std::string& order : orders) {
    Mix mix = close_mix(2);
    mix.boundaries = moving_wall(2), mix.stress_update = order, mix.contact = coulomb, mix.transfer = flip;
    check_on_device(mix);
  }
  Mix mix = close_mix(3);
  mix.boundaries = moving_wall(3);
  check_on_device(mix);
  // By its place, which is not that of the wall across from it.
  mix = close_mix(2);
  mix.boundaries = R"({"all": "slip", "x_max": {"type": "prescribed", "velocity": ["0.3*x-0.5-t", "0.1*x"]}})";
  check_on_device(mix);
  // A filter's first increment is a velocity, which a moving wall mirrors about its own; the others are differences.
  for (const std::string constraints : {"every_increment", "kept_impulses", "at_end"})
    for (const std::string filter : {"fmpm", "xpic"}) {
      Mix filtered = close_mix(2);
      filtered.boundaries = moving_wall(2);
      filtered.filter =
          "{\"type\": \"" + filter + R"(", "order": 3, "every_steps": 2, "constraints": ")" + constraints + "\"}";
      check_on_device(filtered);
    }
}

TEST_CASE("boxes of conditions on the host-run device", "[device]") {
  for (const int dimension : {2, 3})
    for (const std::string condition :
         {R"("type": "stick")", R"("type": "slip", "axis": "y")", R"("type": "separate", "axis": "x", "side": "+")",
          R"("type": "separate", "axis": "y", "side": "-")", "prescribed"}) {
      Mix mix;
      mix.dimension = dimension;
      const std::string prescribed =
          std::string(R"("type": "prescribed", "velocity": ["0.2*y+t", null)") + (dimension == 3 ? ", 0.1]" : "]");
      mix.more = ", \"node_conditions\": [" + box(dimension, condition == "prescribed" ? prescribed : condition) + "]";
      check_on_device(mix);
    }
  // Nodes are in a box that begins less than a billionth of a cell behind them, and in none that begins farther.
  Mix close_by;
  close_by.more = R"(, "node_conditions": [{"type": "stick", "lower": [0.300000000075, 0.2], "upper": [0.4, 0.4]},
    {"type": "prescribed", "velocity": [0.2, 0.1], "lower": [0.5, 0.3000000005], "upper": [0.7, 0.5]}])";
  check_on_device(close_by);
  // One that reaches beyond the last cells holds the nodes there as well.
  Mix beyond;
  beyond.boundaries = R"({"all": "free"})";
  beyond.overrides = {set("/grid/domain", "[[0, -0.1], [1.3, 0.6]]"), set("/bodies/0/geometry/centre", "[0.31, 0.38]")};
  beyond.more =
      R"(, "node_conditions": [{"type": "prescribed", "velocity": [0.2, 0.1], "lower": [0.5, 0.55], "upper": [2, 2]}])";
  check_on_device(beyond);
  // Where two boxes and a wall hold the same node, the last one counts.
  for (const std::string& order : orders) {
    Mix mix = close_mix(2);
    mix.contact = coulomb, mix.stress_update = order, mix.filter = R"({"type": "fmpm", "order": 2})";
    mix.more = R"(, "node_conditions": [{"type": "prescribed", "velocity": [0.2, "t*x"], "lower": [0.1, 0.2],
                  "upper": [0.3, 0.3]}, {"type": "stick", "lower": [0.25, 0.2], "upper": [0.4, 0.35]}])";
    check_on_device(mix);
  }
}

TEST_CASE("body forces on the host-run device", "[device]") {
  for (const std::string& order : orders) {
    Mix mix = close_mix(2);
    mix.more = R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y"])J", mix.stress_update = order;
    check_on_device(mix);
    mix.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic", "y_max": "separate"})";
    check_on_device(mix);
  }
  Mix mix;
  mix.dimension = 3;
  mix.more = R"J(, "body_force": ["2*sin(3*x)+t", "x-z*y", 1])J";
  check_on_device(mix);
}

TEST_CASE("loads on the host-run device", "[device][loads]") {
  const std::string flat = R"J(, "loads": [
    {"type": "pressure", "body": "a", "where": {"type": "half_space", "point": [0.31, 0], "normal": [1, 0.3]},
     "pressure": "400+100*sin(9*t)+20*x"},
    {"type": "traction", "body": "b", "where": {"type": "half_space", "point": [0, 0.6], "normal": [0, -1]},
     "traction": ["200*X", "-300*y+100*t"]},
    {"type": "force", "body": "a", "at": [0.4, 0.37], "force": [5, "20*t"]},
    {"type": "body_force", "body": "b", "acceleration": ["X", "t-y"]},
    {"type": "spring", "body": "b", "where": {"type": "half_space", "point": [0.52, 0], "normal": [1, 0]},
     "stiffness": [2e3, 1e3], "damping": [50, 100]}])J";
  const std::string deep = R"J(, "loads": [
    {"type": "pressure", "body": "a", "where": {"type": "half_space", "point": [0.27, 0, 0], "normal": [1, 0.3, 0.1]},
     "pressure": "400+100*sin(9*t)"},
    {"type": "line_force", "body": "b", "from": [0.5, 0.15, 0.25], "to": [0.55, 0.35, 0.4], "force": [2, 3, "-t"]},
    {"type": "spring", "body": "b", "where": {"type": "half_space", "point": [0.42, 0, 0], "normal": [1, 0, 0]},
     "stiffness": [2e3, 1e3, 500], "damping": [50, 100, 0]}])J";
  for (const auto& [order, transfer] : {std::pair{"last", "mls"}, std::pair{"first", "flip"},
                                        std::pair{"modified_last", "apic"}, std::pair{"averaged", "apic"}}) {
    Mix mix;
    mix.stress_update = order, mix.transfer = std::string("{\"type\": \"") + transfer + "\"}", mix.more = flat;
    if (mix.stress_update != "first")
      mix.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
    check_on_device(mix);
  }
  Mix mix;
  mix.shape = R"({"type": "cpdi"})", mix.contact = coulomb, mix.filter = R"({"type": "fmpm", "order": 2})";
  mix.more = flat;
  check_on_device(mix);
  mix = {};
  mix.dimension = 3, mix.more = deep;
  check_on_device(mix);
}

TEST_CASE("every entry of the ledger on the host-run device", "[device][ledger]") {
  check_ledgers(false);
  // Steps that are booked alternate with others that visit each particle once.
  Mix seldom = close_mix(2);
  seldom.transfer = flip, seldom.more = R"(, "output": {"ledger_every": 3})";
  seldom.overrides = {set("/solver/end_time", "0.27")};  // so that graphs of steps of all kinds follow each other
  check_on_device(seldom);
  // The entries must all be there, so that none is compared with zero.
  Mix mix = close_mix(2);
  mix.material = von_mises, mix.contact = coulomb;
  mix.transfer = R"({"type": "flip"})", mix.filter = R"({"type": "xpic", "order": 2, "every_steps": 2})";
  mix.more = R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y"])J";
  mix.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
  std::map<std::string, double> largest;  ///< over the kinetic energy at the start
  const auto take_entries = [&] {
    DeviceScene scene(mix.text(), "double", {}, mix.overrides);
    scene.run();
    for (const ValueRow& row : rows_of(scene.simulation.backend().ledger())) {
      double& entry = largest[row.name];
      entry = larger(entry, std::abs(row.value) / scene.metrics.initial().kinetic);
    }
  };
  const auto check_entries = [&] {
    check_on_device(mix);
    take_entries();
  };
  check_entries();
  mix.transfer = R"({"type": "apic"})", mix.shape = R"({"type": "cpdi"})", mix.stress_update = "modified_last";
  mix.filter = R"({"type": "fmpm", "order": 2, "every_steps": 2})";
  check_entries();
  mix.stress_update = "last";
  check_entries();
  mix.more = R"J(, "damping": {"viscous": 3, "local": 0.2}, "loads": [
    {"type": "pressure", "body": "a", "where": {"type": "half_space", "point": [0.31, 0], "normal": [1, 0.3]}, "pressure": 400},
    {"type": "force", "body": "a", "at": [0.4, 0.37], "force": [5, "20*t"]},
    {"type": "spring", "body": "b", "where": {"type": "half_space", "point": [0.52, 0], "normal": [1, 0]},
     "stiffness": [0, 1e3], "damping": [50, 100]}])J";
  mix.material.insert(mix.material.rfind('}'), R"(, "artificial_viscosity": {})");
  check_entries();
  mix = close_mix(2);
  mix.contact = R"({"type": "linear_interface", "normal_stiffness": 3e4, "shear_stiffness": 2e4})";
  check_entries();
  mix = close_mix(2);
  mix.material = R"({"type": "newtonian_fluid", "bulk_modulus": 2000, "viscosity": 3, "density": 1000})";
  check_entries();
  mix.material = R"({"type": "damage", "youngs_modulus": 1000, "poisson_ratio": 0.2, "density": 1000,
    "tensile_strength": 1, "fracture_energy": 9, "band_cells": 1})";
  mix.more = R"J(, "body_force": ["99*sin(9*X)", 0])J";  // which tears
  check_on_device(mix, {"double"});                      // what softens makes rounding grow
  take_entries();
  mix = {};
  mix.close = true, mix.material = material(elastic, melts + "}}");
  mix = warm(mix);  // which tests/device/heat.cpp checks
  mix.boundaries = R"({"all": "slip", "x_min": {"type": "slip", "temperature": 60}})";
  take_entries();
  mix = beside_rigid_bodies(2);  // which tests/device/rigid.cpp checks
  take_entries();
  for (const auto& [name, entry] : largest) {
    INFO(name);
    // These are of the host, between steps: tests/device/particle_changes.cpp.
    if (name == "emitted" || name == "removed" || name == "changed material") continue;
    const bool is_rounding =
        name == "grid book" || name == "filter book" || name == "mass book" || name == "momentum book";
    CHECK((is_rounding ? entry < 1e-12 : entry > 1e-6));
  }
}

TEST_CASE("every entry of the ledger on the host-run device in both precisions", "[device][ledger][slow]") {
  check_ledgers(true);
}

TEST_CASE("the ledger of polynomials, of domains and of rings on the host-run device", "[device][ledger]") {
  for (const std::string shape : {"cpdi", "cpdi2", "gimp_contiguous", "linear"}) {
    Mix mix;
    mix.shape = "{\"type\": \"" + shape + "\"}";
    mix.transfer = shape == "linear" ? R"({"type": "polypic"})" : R"({"type": "apic"})";
    check_on_device(mix);
  }
  Mix mix;
  mix.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
  mix.filter = R"({"type": "fmpm", "order": 2})";
  check_on_device(mix);
}

TEST_CASE("a restored run on the host-run device goes on bit for bit", "[device]") {
  std::vector<Mix> mixes;
  for (const std::string& order : orders) {
    Mix mix;
    mix.shape = R"({"type": "cpdi"})", mix.contact = coulomb, mix.stress_update = order;
    mix.filter = R"({"type": "fmpm", "order": 2, "every_steps": 3})";
    mix.more = R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y"])J";
    mixes.push_back(mix);
  }
  mixes.push_back({});
  mixes.back().shape = R"({"type": "cpdi2"})";
  mixes.push_back({});
  mixes.back().transfer = R"({"type": "polypic", "basis": "full"})";
  mixes.push_back({});
  mixes.back().overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]"),
                            set("/solver/time_step", "\"auto\"")};
  for (const Mix& mix : mixes)
    for (const std::string precision : {"double", "float"}) {
      INFO(mix.name() << " " << precision);
      const std::string text = mix.text();
      DeviceScene whole(text, precision, {}, mix.overrides), resumed(text, precision, {}, mix.overrides);
      const auto steps = [](DeviceScene& scene, int count) {
        for (int k = 0; k < count; ++k) scene.simulation.step();
      };
      steps(whole, 6);
      ArchiveWriter archive;
      whole.simulation.save(archive);
      steps(resumed, 2);  // steps to be forgotten, whatever they did
      ArchiveReader reader(archive.bytes());
      resumed.simulation.restore(reader);
      CHECK(reader.at_end());
      CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
      steps(whole, 5), steps(resumed, 5);
      CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
    }
}

TEST_CASE("a run that is set back to its start on the host-run device goes the same way again", "[device]") {
  Mix plain, glued, warm = warm_mix(2, flip);
  plain.transfer = flip;
  glued.close = true,
  glued.contact = R"({"type": "breakable_glue", "tension_stiffness": 1e4, "compression_stiffness": 5e4,
    "shear_stiffness": 2e4, "normal_strength": 60, "shear_strength": 90, "friction": 0.2})";
  warm.boundaries = R"({"all": "slip", "x_min": {"type": "slip", "temperature": "30+900*t"}})", warm.close = true;
  Mix glued_apart = glued;  // in all of whose steps but the first the same is launched
  glued_apart.overrides.emplace_back(R"(/solver/passes="separate")");
  for (Mix mix : {plain, glued, glued_apart, warm}) {
    INFO(mix.name());
    mix.overrides.emplace_back(R"(/output={"ledger": false})");
    mix.overrides.push_back(set("/solver/end_time", "0.27"));
    DeviceScene scene(mix.text(), "double", {}, mix.overrides);
    const auto results_of_steps = [&](int count) {
      for (int k = 0; k < count; ++k) scene.simulation.step();
      std::vector<double> all = all_results(scene.simulation);
      for (int body = 0; body < 2; ++body)
        for (const auto& [name, values] : scene.simulation.backend().body_state(body).host_state)
          all.insert(all.end(), values.begin(), values.end());
      return all;
    };
    ArchiveWriter archive;
    scene.simulation.save(archive);
    const std::vector<double> first = results_of_steps(4);
    results_of_steps(16);  // so that graphs of all kinds of steps are known
    ArchiveReader reader(archive.bytes());
    scene.simulation.restore(reader);
    CHECK(different(first, results_of_steps(4)) == 0);
  }
}

TEST_CASE("automatic steps grow on the host-run device as particles slow down", "[device]") {
  Mix mix;
  mix.close = true;
  mix.more = R"(, "damping": {"viscous": 40})";
  mix.overrides = {set("/solver/time_step", "\"auto\""), set("/solver/end_time", "0.3"), set("/solver/courant", "0.05"),
                   set("/materials/m/youngs_modulus", "0.5")};
  Scene reference(mix.text(), on_reference(mix));
  DeviceScene device(mix.text(), "double", {}, mix.overrides);
  device.simulation.step();
  const double first = device.simulation.backend().time_step_limit().speed;
  reference.run(), device.run();
  const TimeStepLimit expected = reference.simulation.backend().time_step_limit(),
                      found = device.simulation.backend().time_step_limit();
  CHECK(device.simulation.steps() == reference.simulation.steps());
  CHECK(found.speed == Approx(expected.speed).epsilon(1e-9));
  CHECK(found.particle == expected.particle);
  CHECK(found.speed < 0.9 * first);
}

TEST_CASE("the second moment of each particle is told on the host-run device, whatever the lanes of a team",
          "[device]") {
  Mix mix;
  mix.shape = R"({"type": "gimp_contiguous"})";
  const DeviceScene usual(mix.text(), "double");
  const BodyState expected = usual.body(0);
  REQUIRE(!expected.second_moment.empty());
  const int count = static_cast<int>(usual.simulation.particle_count(0));
  for (const int lanes : {count - 1, count, 7, (count - 1) / 2}) {
    REQUIRE((lanes >= 1 && lanes <= 256));
    INFO(count << " particles, " << lanes << " lanes");
    const DeviceScene other(mix.text(), "double", {lanes, TeamShape::upwards});
    CHECK(other.body(0).second_moment == expected.second_moment);
  }
}

TEST_CASE("particles that have come beyond a separating wall move as the reference backend's on the host-run device",
          "[device]") {
  Mix mix;
  mix.boundaries = R"({"all": "separate"})", mix.transfer = R"({"type": "pic"})";
  mix.overrides = {set("/bodies/0/geometry", R"({"type": "box", "lower": [0.11, 0.3], "upper": [0.16, 0.35]})"),
                   set("/bodies/0/velocity", "[-16, 0]"), set("/solver/end_time", "0.027")};
  DeviceScene scene(mix.text(), "double", {}, mix.overrides);
  scene.run();
  const BodyState state = scene.body(0);
  double least = 1;
  for (std::size_t p = 0; p < state.position.size(); p += 2) least = smaller(least, state.position[p]);
  REQUIRE(least < -0.01);
  check_on_device(mix);
}

TEST_CASE("particles keep what is added to the plan's list on the host-run device", "[device]") {
  Mix mix;
  mix.contact = coulomb, mix.transfer = flip;
  for (const std::string precision : {"double", "float"}) {
    const Experiment experiment = device_experiment(mix.text(), precision);
    Plan plan = make_plan(experiment);
    for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
      Field stretch;
      stretch.id = stretch.name = "stretch", stretch.body = body, stretch.components = 4;
      stretch.first = First::identity;
      plan.fields.push_back(stretch);
    }
    Simulation run(experiment, [&](const Experiment& e, const Plan&, const std::vector<SeededBody>& seeds) {
      return device::make_device_backend(e, plan, seeds, device_setup());
    });
    DeviceScene plain(mix.text(), precision);
    for (int k = 0; k < 9; ++k) run.step(), plain.simulation.step();
    ArchiveWriter archive;
    run.save(archive);
    ArchiveReader reader(archive.bytes());
    run.restore(reader);
    CHECK(different(all_results(plain.simulation, false), all_results(run, false)) == 0);
    const std::vector<double> stretch = run.backend().body_state(1).host_state.at("stretch");
    REQUIRE(stretch.size() == 4 * run.particle_count(1));
    for (std::size_t i = 0; i < stretch.size(); ++i) REQUIRE(stretch[i] == (i % 4 == 0 || i % 4 == 3 ? 1 : 0));
  }
}

// Scenes run through the host driver of the device backend and through the reference backend, compared value by value.
#pragma once

#include <cstdlib>
#include <future>
#include <map>
#include <mutex>
#include <set>

#include "backends/device/cache.hpp"
#include "backends/device/drivers/host_compiler.hpp"
#include "backends/device/drivers/host_driver.hpp"
#include "backends/device/make_device_backend.hpp"
#include "parity/parity.hpp"
#include "support/larger.hpp"
#include "support/trials.hpp"

namespace mpm::test {

/// A plugin as its choice in an experiment. A required parameter that is not named here stops the suite: give it a
/// value fit for these scenes.
inline std::string device_choice(const Plugin& plugin) {
  std::string text = "{\"type\": \"" + std::string(plugin.id()) + "\"";
  for (const mpm_parameter& parameter : plugin.parameters()) {
    if (!(parameter.flags & MPM_REQUIRED)) continue;
    text += std::string(", \"") + parameter.name + "\": " + digits(required_value(plugin, parameter));
  }
  if (plugin.descriptor->kind == MPM_FILTER) text += ", \"every_steps\": 2";
  return text + "}";
}

/// A mix with this plugin in it and the usual partners elsewhere.
inline Mix mix_with(const Plugin& plugin, int dimension) {
  Mix mix;
  mix.dimension = dimension;
  const std::string choice = device_choice(plugin);
  switch (plugin.descriptor->kind) {
    case MPM_SHAPE:
      mix.shape = choice;
      break;
    case MPM_TRANSFER:
      mix.transfer = choice;
      break;
    case MPM_FILTER:
      mix.more += ", \"filter\": " + choice;
      break;
    case MPM_CONTACT:
      mix.contact = choice;
      break;
    case MPM_NORMAL:
    case MPM_DETECTION:
      mix.contact = R"({"type": "coulomb", "friction": 0.2, ")" +
                    std::string(kind_name(static_cast<mpm_kind>(plugin.descriptor->kind))) + "\": " + choice + "}";
      break;
    default:
      mix.material = choice;
  }
  return mix;
}

/// The override that asks for deterministic sums.
inline const std::string deterministic_sums = "/device/sums=deterministic";

/// An experiment on the device. It is read as one of the reference backend, whose refusals the scenes share; so float and
/// the section of the device, which that has not, are chosen afterwards.
inline Experiment device_experiment(const std::string& text, const std::string& precision,
                                    std::vector<std::string> overrides = {}) {
  const bool deterministic = std::erase(overrides, deterministic_sums) > 0;
  for (const char* choice : {"/backend=reference", "/precision=double"}) overrides.emplace_back(choice);
  Experiment experiment = experiment_from(text, overrides);
  if (deterministic) experiment.resolved["device"]["sums"] = "deterministic";
  if (precision == "float") experiment.precision = Precision::single;
  experiment.backend = "cuda";
  return experiment;
}

inline device::Choice device_choice_of(const Experiment& experiment) {
  return device::choice_of(experiment, make_plan(experiment));
}

/// Where programs are kept for other suites and the next run: a folder of the build, or of the environment's
/// MPM_PROGRAMS_OF_TESTS, which tests/mutation sets, as a changed program may keep what is wrong.
inline std::filesystem::path folder_of_programs(const std::string& name) {
  const char* const chosen = std::getenv("MPM_PROGRAMS_OF_TESTS");
  return std::filesystem::path(chosen ? chosen : MPM_BUILD_DIR) / name;
}

/// Compiled compositions, each once.
class Programs {
 public:
  static Programs& shared() {
    static Programs programs;
    return programs;
  }
  std::string of(const device::Composition& composition) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = images_.find(composition.hash); found != images_.end()) return found->second;
    }
    const std::string key = device::cache_key(composition, identity_, {});
    std::optional<std::string> made = kept_.find(key);
    if (!made) {
      made = compiler_.compile(composition);
      kept_.keep(key, *made);
    }
    const std::lock_guard lock(mutex_);
    return images_.emplace(composition.hash, std::move(*made)).first->second;
  }
  /// Compiles several compositions at once, two side by side.
  void prepare(const std::vector<device::Choice>& choices) {
    const auto every_second = [&](std::size_t first) {
      for (std::size_t k = first; k < choices.size(); k += 2) of(device::compose(choices[k]));
    };
    std::future<void> other = std::async(std::launch::async, every_second, 1);
    every_second(0);
    other.get();
  }

 private:
  Programs() {
    // A program here runs for a tenth of a second, so that most of the time goes to its compiler; -Og takes a third less
    // of it than the -O1 of users' programs, which tests/cli runs.
    compiler_.options = {"-Og", "-Wall", "-Wextra", "-Werror"};
    identity_ = compiler_.program + "\n" + compiler_.version();
    for (const std::string& option : compiler_.all_options()) identity_ += "\n" + option;
  }

  device::HostCompiler compiler_;
  std::string identity_;  ///< all that a program depends on beside its text
  const device::ProgramCache kept_{folder_of_programs("host_programs_of_tests"), 512ull << 20};
  std::mutex mutex_;
  std::map<std::string, std::string> images_;  ///< by the composition's hash
};

/// The way in which teams run on the host: how many lanes they have, and in which order these are taken (HostDevice).
struct TeamShape {
  int lanes = 32;
  unsigned order = upwards;

  static constexpr unsigned upwards = 0, downwards = 1;
  static constexpr unsigned shuffled(unsigned seed) { return 2 + seed % 2; }
};

/// The host's devices of these suites: each takes lanes in the order of its number, the last two shuffled by a seed.
inline void use_usual_devices() {
  device::set_host_devices({{"host", 0, TeamShape::upwards},
                            {"host, backwards", 0, TeamShape::downwards},
                            {"host, shuffled", 0, 20},
                            {"host, shuffled otherwise", 0, 311}});
}

inline device::DeviceSetup device_setup(const TeamShape& team = {}) {
  static std::once_flag once;
  std::call_once(once, use_usual_devices);
  device::DeviceSetup setup{
      &device::host_driver(), static_cast<int>(team.order), team.lanes,
      [](const device::Composition& composition, const std::string&) { return Programs::shared().of(composition); }};
  setup.steps_to_forget = 4;  // so that the 14 steps of most scenes come to it
  return setup;
}

inline BackendFactory device_factory(const device::DeviceSetup& setup = device_setup()) {
  return [setup](const Experiment& e, const Plan& plan, const std::vector<SeededBody>& bodies) {
    return device::make_device_backend(e, plan, bodies, setup);
  };
}

/// A scene on the host-run device. Of a case that has one, tests/mutation tries changed programs from the first one on.
class DeviceScene {
 public:
  DeviceScene(const std::string& text, const std::string& precision, const TeamShape& team = {},
              const std::vector<std::string>& overrides = {})
      : experiment((begin_trials(), device_experiment(text, precision, overrides))),
        simulation(experiment, device_factory(device_setup(team))),
        metrics(simulation) {}
  void run() {
    while (!simulation.finished()) simulation.step();
  }
  BodyState body(int index) const { return simulation.backend().body_state(index); }

  const Experiment experiment;
  Simulation simulation;
  Metrics metrics;
};

/// Largest difference of two bodies' states, each value over the scene's scale of it.
inline double state_difference(const Experiment& experiment, const BodyState& expected, BodyState found) {
  const double speed = 1.5, h = experiment.grid.cell_size;  // scales of the scenes in parity.hpp
  wrap_onto(experiment, expected.position, found.position);
  double worst = std::max(difference(expected.position, found.position, 1.0),
                          difference(expected.velocity, found.velocity, speed));
  worst = larger(worst, difference(expected.domain, found.domain, h));
  worst = larger(worst, difference(expected.corners, found.corners, h));
  worst = larger(worst, difference(expected.second_moment, found.second_moment, h * h));
  const auto fields = [&](const auto& a, const auto& b, double scale) {
    REQUIRE(a.size() == b.size());
    for (const auto& [name, values] : a) worst = larger(worst, difference(values, b.at(name), scale));
  };
  fields(expected.transfer_state, found.transfer_state, speed / h);
  REQUIRE(expected.material_state.size() == found.material_state.size());
  for (const auto& [name, values] : expected.material_state)
    worst = larger(worst, difference(values, found.material_state.at(name), size_of(values)));
  REQUIRE(expected.host_state.size() == found.host_state.size());
  for (const auto& [name, values] : expected.host_state)
    worst = larger(worst, difference(values, found.host_state.at(name), scale_of(name, h)));
  return worst;
}

/// The largest difference of all bodies, and of the ledger's entries over the kinetic energy at the start.
template <class Reference>
double scene_difference(const Reference& reference, const DeviceScene& found) {
  double worst = difference(ledger_values(reference), ledger_values(found), reference.metrics.initial().kinetic);
  for (int body = 0; body < static_cast<int>(reference.experiment.bodies.size()); ++body)
    worst = larger(worst, state_difference(reference.experiment, reference.body(body), found.body(body)));
  return worst;
}

/// What is counted and measured of contact in the last step: nodes that stick and slip, penetration in cells, and of each pair
/// the area of what touches, in a cell's faces.
inline std::vector<double> contact_counts(const Backend& backend, const Experiment& experiment) {
  const double h = experiment.grid.cell_size, face = std::pow(h, experiment.dimension - 1);
  const ContactRecord& all = backend.contact_record();
  std::vector<double> values{double(all.nodes), double(all.sticking), double(all.slipping),
                             all.largest_penetration / h};
  for (const PairRecord& pair : backend.contact_pairs())
    values.insert(values.end(), {double(pair.sticking), double(pair.slipping), pair.area / face});
  return values;
}

/// The largest difference of the ledgers' books, each over the kinetic energy, mass or momentum at the start.
template <class Reference>
double book_difference(const Reference& reference, const DeviceScene& found) {
  const Totals& start = reference.metrics.initial();
  const auto expected = rows_of(reference.simulation.backend().ledger()),
             rows = rows_of(found.simulation.backend().ledger());
  double worst = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!rows[k].name.ends_with(" book")) continue;
    const double size = rows[k].unit == "J" ? start.kinetic : start.mass * (rows[k].unit == "kg" ? 1 : 1.5);
    worst = larger(worst, std::abs(rows[k].value - expected[k].value) / size);
  }
  return worst;
}

inline double epsilon_of(const std::string& precision) {
  return precision == "double" ? 0x1p-52 : 0x1p-23;
}

/// Multiples of epsilon that states may differ by after 14 steps, each value relative to its scale: sums over stencils
/// make some tens, and f/m of a node that a particle barely reaches more where gradients do not vanish with weights
/// (linear). Measured: up to 56, and 111 on linear.
inline double device_bound(const Mix& mix) {
  return mix.shape.find("linear") != mix.shape.npos ? 1e4 : 1e3;
}

/// Both precisions, or one of them in turn: programs of both take twice as long to compile.
inline std::vector<std::string> precisions_in_turn(bool both, std::size_t turn) {
  if (both) return {"double", "float"};
  return {turn % 2 == 0 ? "double" : "float"};
}

/// Runs a mix on the reference (in double) and on the device in these precisions; both go 14 steps, in which bodies
/// cross cells. The bound is that of tests/parity in units of the precision's epsilon. A node that a particle barely reaches
/// may break a run with linear shapes, on both.
inline void check_on_device(const Mix& mix, const std::vector<std::string>& precisions = {"double", "float"}) {
  if (!is_chosen_check()) return;
  INFO(mix.name());
  const std::string text = mix.text();
  std::vector<std::string> overrides = mix.overrides;
  std::erase(overrides, deterministic_sums);
  for (const char* choice : {"/backend=reference", "/precision=double"}) overrides.emplace_back(choice);
  Scene reference(text, overrides);
  try {
    while (!reference.simulation.finished()) reference.simulation.step();
  } catch (const std::exception& stop) {
    REQUIRE(mix.shape.find("linear") != mix.shape.npos);
    CHECK_THROWS_WITH(DeviceScene(text, "double", {}, mix.overrides).run(), stop.what());
    return;
  }
  for (const std::string& precision : precisions) {
    INFO(precision);
    DeviceScene scene(text, precision, {}, mix.overrides);
    scene.run();
    REQUIRE(scene.simulation.steps() == reference.simulation.steps());
    const double worst = scene_difference(reference, scene) / epsilon_of(precision);
    CHECK(worst <= device_bound(mix));
  }
}

}  // namespace mpm::test

#include "mpm/test_plugin_device.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "backends/device/drivers/cuda.hpp"
#include "backends/device/drivers/host_compiler.hpp"
#include "backends/device/drivers/nvrtc.hpp"
#include "backends/device/program.hpp"
#include "backends/make_backend.hpp"
#include "conformance/support.hpp"
#include "experiment/diagnostics.hpp"
#include "experiment/read.hpp"
#include "mpm/cli.hpp"
#include "plugin/extension_of.hpp"
#include "solvers/solver.hpp"

namespace mpm::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int steps = 12;               ///< in which particles cross cells
constexpr double cell_size = 0.1;       ///< m
constexpr double courant = 0.2;         ///< of the wave speed at rest
constexpr double bound_of_state = 1e4;  ///< epsilons: nodes that particles barely reach divide by tiny masses
constexpr double most_enlarged =
    1e6;  ///< where a scene enlarges rounding, the bound of state is at most this, epsilons

/// A plugin's choice in an experiment, with a sample of its parameters.
Json choice_of(const Plugin& plugin) {
  conformance::ParameterSample sample;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {  // laws that soften refuse some samples on the scene's cells
    conformance::Random random(seed);
    sample = conformance::sample_parameters(plugin, random).front();
    if (const auto* cells = extension_of<mpm_material_cell_size>(plugin))
      sample.block[cells->offset / sizeof(double)] = cell_size;
    if (!conformance::refusal_of(plugin, sample).parameter) break;
  }
  Json choice{{"type", plugin.id()}};
  for (const mpm_parameter& parameter : plugin.parameters()) {
    const double value = conformance::parameter_value(plugin, sample, parameter.name, parameter.default_value);
    if (parameter.type == MPM_CHOICE) {
      std::istringstream names(parameter.choices);
      std::string name;
      for (int k = 0; k <= static_cast<int>(value); ++k) std::getline(names, name, '|');
      choice[parameter.name] = name;
    } else if (parameter.type == MPM_BOOLEAN) {
      choice[parameter.name] = value != 0;
    } else if (parameter.flags & MPM_REQUIRED) {
      choice[parameter.name] = value;
    }
  }
  return choice;
}

/// A ball that turns, stretches and flies, and one that it meets where there is contact; speeds are in shares of
/// `speed`, m/s. The ball's first velocity is `changed` by a share of it.
Json scene_of(const Plugin& plugin, int dimension, double speed, double time_step, double changed) {
  const bool flat = dimension == 2;
  const auto of = [&](const char* in_plane, const char* in_space) { return Json::parse(flat ? in_plane : in_space); };
  Json scene{{"title", "test-plugin"}, {"dimension", dimension}};
  scene["grid"] = {{"cell_size", cell_size},
                   {"domain", of("[[0, 0], [1.2, 0.8]]", "[[0, 0, 0], [1.2, 0.8, 0.8]]")},
                   {"boundaries", {{"all", "slip"}}}};
  scene["shape"] = {{"type", "bspline_quadratic"}};
  scene["transfer"] = {{"type", "apic"}};
  scene["materials"]["m"] = {
      {"type", "neo_hookean"}, {"youngs_modulus", 1000}, {"poisson_ratio", 0.3}, {"density", 1000}};
  const Json choice = choice_of(plugin);
  switch (plugin.descriptor->kind) {
    case MPM_MATERIAL:
      scene["materials"]["m"] = choice;
      break;
    case MPM_FILTER:
      scene["filter"] = choice;
      scene["filter"]["every_steps"] = 2;
      break;
    case MPM_NORMAL:
    case MPM_DETECTION:
      scene["contact"] = {{"type", "coulomb"},
                          {"friction", 0.3},
                          {std::string(kind_name(static_cast<mpm_kind>(plugin.descriptor->kind))), choice}};
      break;
    default:
      scene[std::string(kind_name(static_cast<mpm_kind>(plugin.descriptor->kind)))] = choice;
  }
  const std::string v = number_text(speed);
  const std::string change = "*(1+" + number_text(changed) + ")";
  const auto velocity = [&](const char* x, const char* y, const char* z) {
    Json parts = Json::array();
    for (const char* part : {x, y, z}) parts.push_back(v + "*(" + part + ")");
    if (flat) parts.erase(2);
    return parts;
  };
  scene["bodies"].push_back(
      {{"name", "a"},
       {"material", "m"},
       {"seeding", "lattice"},
       {"jitter", 0.2},
       {"geometry", {{"type", "ball"}, {"centre", of("[0.4, 0.4]", "[0.4, 0.4, 0.4]")}, {"radius", 0.22}}},
       {"velocity", velocity(("(1-0.9*(y-0.4)+0.3*(x-0.4))" + change).c_str(), "0.1+0.9*(x-0.4)", "0.2+x-y")}});
  const std::uint32_t kind = plugin.descriptor->kind;
  if (kind == MPM_CONTACT || kind == MPM_NORMAL || kind == MPM_DETECTION)
    scene["bodies"].push_back({{"name", "b"},
                               {"material", "m"},
                               {"seeding", "lattice"},
                               {"geometry",
                                {{"type", "box"},
                                 {"lower", of("[0.63, 0.2]", "[0.63, 0.2, 0.2]")},
                                 {"upper", of("[0.83, 0.6]", "[0.83, 0.6, 0.6]")}}}});
  scene["solver"] = {{"time_step", time_step > 0 ? Json(time_step) : Json("auto")},
                     {"courant", courant},
                     {"end_time", 1e9},
                     {"max_steps", steps}};
  return scene;
}

/// The plugin under test before all others of its kind and id.
ComponentLookup partners_of(const Plugin& plugin, const Registry& others) {
  std::vector<const Plugin*> all{&plugin};
  for (const Plugin& other : others.plugins())
    if (other.descriptor->kind != plugin.descriptor->kind || other.id() != plugin.id()) all.push_back(&other);
  return ComponentLookup(all);
}

/// Largest difference of two lists over a scale; infinite for what is not a number.
double difference(const std::vector<double>& a, const std::vector<double>& b, double scale) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double d = k < b.size() ? std::abs(a[k] - b[k]) / scale : std::numeric_limits<double>::infinity();
    if (!(d <= largest)) largest = d == d ? d : std::numeric_limits<double>::infinity();
  }
  return largest;
}

/// Scenes of one plugin, and the comparison.
class Comparison {
 public:
  Comparison(const Plugin& plugin, const Registry& others, int dimension, Precision precision)
      : plugin_(plugin),
        lookup_(partners_of(plugin, others)),
        others_(others),
        dimension_(dimension),
        precision_(precision) {}

  struct Apart {
    double measured, bound;
  };

  /// The largest difference in epsilons, each value over its scale, and how large it may be: four times what the reference
  /// backend makes of a change of two epsilons in one velocity, where that is more than the usual bound. The linear shape's
  /// gradients do not vanish with its weights, so that f / m of a node barely reached is unbounded.
  Apart run(const std::string& device) const {
    const double rest_step = time_step_at_rest(), dt = rest_step / 1.5;
    const double speed = 0.5 * courant * cell_size / rest_step;
    const double epsilon = precision_ == Precision::single ? 0x1p-23 : 0x1p-52;
    const Experiment plain = experiment(speed, dt, "reference");
    const Experiment nearly = experiment(speed, dt, "reference", 2 * epsilon);
    Experiment chosen = plain;
    chosen.backend = "cuda", chosen.precision = precision_;
    Simulation reference(plain, backend_factory()), changed(nearly, backend_factory());
    Simulation found(chosen, backend_factory(1, false, device));
    for (int step = 0; step < steps; ++step) reference.step(), changed.step(), found.step();
    const double enlarged = difference_of(reference, changed, speed) / epsilon;
    return {difference_of(reference, found, speed) / epsilon, std::clamp(4 * enlarged, bound_of_state, most_enlarged)};
  }

 private:
  static double difference_of(const Simulation& a, const Simulation& b, double speed) {
    double worst = 0;
    for (int body = 0; body < static_cast<int>(a.experiment().bodies.size()); ++body)
      worst =
          std::max(worst, difference_of(a.backend().body_state(body), b.backend().body_state(body), speed, cell_size));
    return worst;
  }
  static double difference_of(const BodyState& a, const BodyState& b, double speed, double h) {
    double worst = std::max({difference(a.position, b.position, 1), difference(a.velocity, b.velocity, speed),
                             difference(a.domain, b.domain, h), difference(a.corners, b.corners, h)});
    for (const auto& [name, values] : a.transfer_state)
      worst = std::max(worst, difference(values, b.transfer_state.at(name), speed / h));
    for (const auto& [name, values] : a.material_state) {
      double scale = 1;
      for (const double value : values) scale = std::max(scale, std::abs(value));
      worst = std::max(worst, difference(values, b.material_state.at(name), scale));
    }
    return worst;
  }
  /// The time step of the plugin's material at rest, by which speeds and steps are chosen, s.
  double time_step_at_rest() const {
    const Experiment still = experiment(0, 0, "reference");
    Simulation rest(still, backend_factory());
    rest.step();
    return rest.last_time_step();
  }
  Experiment experiment(double speed, double time_step, const std::string& backend, double changed = 0) const {
    ReadOptions options = read_options(others_, {});
    options.overrides = {"/backend=" + backend};
    return read_experiment_text(scene_of(plugin_, dimension_, speed, time_step, changed).dump(), "test-plugin", lookup_,
                                options);
  }

  const Plugin& plugin_;
  ComponentLookup lookup_;
  const Registry& others_;
  int dimension_;
  Precision precision_;
};

ConformanceFinding not_run(const std::string& check, const std::string& why) {
  return {check, true, 0, std::numeric_limits<double>::infinity(), "not run: " + why};
}

ConformanceFinding compare(const Comparison& comparison, const std::string& check, const std::string& device) {
  try {
    const auto [measured, bound] = comparison.run(device);
    return {check, measured <= bound, measured, bound,
            "particles after " + std::to_string(steps) +
                " steps with the functor's text in the device's kernels, against the plugin's file in the reference "
                "backend, in epsilons"};
  } catch (const InputError& error) {
    return not_run(check, std::string("the scene is refused: ") + error.what());
  } catch (const device::MissingCompiler& error) {
    return not_run(check, error.what());
  } catch (const NotBuilt&) {
    throw;  // no fault of the plugin
  } catch (const std::exception& error) {
    return {check, false, std::numeric_limits<double>::infinity(), bound_of_state, error.what()};
  }
}

}  // namespace

std::vector<ConformanceFinding> check_plugin_on_device(const Plugin& plugin, const ConformanceProgress& progress) {
  const mpm_descriptor& d = *plugin.descriptor;
  if (!d.source || !*d.source)
    return {
        not_run("device", "the plugin carries no text of its functor; build it with mpm_add_plugin(... HEADER file)")};
  const std::vector<std::filesystem::path> folders = Registry::default_folders();
  const Registry others = Registry::from_folders(folders);
  std::vector<std::pair<std::string, std::string>> devices{{"host", "host"}};
  if (std::string why; device::cuda_driver(why) && device::Nvrtc::find(why)) devices.emplace_back("device 0", "0");
  std::vector<ConformanceFinding> findings;
  for (const auto& [name, device] : devices)
    for (const auto& [dimension, precision] :
         {std::pair{2, Precision::double_}, std::pair{2, Precision::single}, std::pair{3, Precision::double_}}) {
      const bool single = precision == Precision::single;
      if (!(d.dimensions & (dimension == 2 ? MPM_2D : MPM_3D))) continue;
      if (!(d.precisions & (1u << (single ? MPM_LANES_FLOAT : MPM_LANES_DOUBLE)))) continue;
      const std::string check =
          "device [" + name + (single ? ", float, " : ", double, ") + std::to_string(dimension) + "-D]";
      if (progress) progress(check);
      findings.push_back(compare(Comparison(plugin, others, dimension, precision), check, device));
    }
  return findings;
}

}  // namespace mpm::app

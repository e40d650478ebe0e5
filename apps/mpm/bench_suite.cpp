#include "mpm/bench_suite.hpp"

#include <stdexcept>
#include <string_view>

#include "backends/make_backend.hpp"
#include "mpm/cli.hpp"
#include "mpm/default_component.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::app {
namespace {

using Json = nlohmann::ordered_json;

struct Embedded {
  std::string_view name, text;
};
constexpr Embedded embedded[] = {
#include "benchmarks.inc"
};

std::string_view text_of(std::string_view name) {
  for (const Embedded& file : embedded)
    if (file.name == name) return file.text;
  throw std::out_of_range("no benchmark file " + std::string(name) + " is compiled in");
}

Edits edits_in(const Json& object) {
  Edits edits;
  for (const auto& [pointer, value] : object.items()) edits.push_back({pointer, value});
  return edits;
}

}  // namespace

const Edits& BenchOption::edits(const std::string& scene) const {
  for (const auto& [name, edits] : edits_of_scene)
    if (name == scene) return edits;
  throw std::out_of_range("option " + name + " has no scene " + scene);
}

BenchSuite::BenchSuite(const Registry& registry, bool quick) : registry_(registry), quick_(quick) {
  const Json file = Json::parse(text_of("standard.json"), nullptr, true, true);
  for (const auto& [name, scene] : file.at("scenes").items())
    scenes_.push_back({name, scene.at("rest"), scene.at("deforming"), scene.at("quick")});
  for (const auto& [name, edits] : file.at("materials").items()) materials_.push_back({name, edits_in(edits)});
  parameters_ = file.at("parameters").get<std::map<std::string, double>>();
  for (const Json& option : file.at("options")) {
    BenchOption read{option.at("name"),
                     option.at("group"),
                     option.value("motion", "deforming"),
                     option.value("section", "options"),
                     option.value("figure", true),
                     {}};
    for (const BenchScene& scene : scenes_) {
      Edits edits = edits_in(option.at("set"));
      if (option.contains("set_in"))
        for (Edit& edit : edits_in(option.at("set_in").at(scene.name))) edits.push_back(std::move(edit));
      read.edits_of_scene.emplace_back(scene.name, std::move(edits));
    }
    options_.push_back(std::move(read));
  }
}

std::optional<double> BenchSuite::parameter(const std::string& name) const {
  const auto found = parameters_.find(name);
  return found == parameters_.end() ? std::nullopt : std::optional(found->second);
}

std::string BenchSuite::unknown_parameter(const Plugin& plugin) const {
  for (const mpm_parameter& declared : plugin.parameters())
    if ((declared.flags & MPM_REQUIRED) && !parameter(declared.name)) return declared.name;
  return "";
}

Component BenchSuite::material(const Plugin& plugin) const {
  constexpr double cell_size = 0.0078125;  // m, of the cube
  Component material = default_component(plugin);
  const auto set = [&](std::size_t offset, double value) { material.parameters.at(offset / sizeof(double)) = value; };
  for (const mpm_parameter& declared : plugin.parameters())
    if (declared.flags & MPM_REQUIRED) set(declared.offset, parameter(declared.name).value());
  if (const auto* cells = extension_of<mpm_material_cell_size>(plugin)) set(cells->offset, cell_size);
  return material;
}

const BenchScene& BenchSuite::scene(const std::string& name) const {
  for (const BenchScene& scene : scenes_)
    if (scene.name == name) return scene;
  throw std::out_of_range("no benchmark scene " + name);
}

Experiment BenchSuite::experiment(const BenchScene& scene, const std::string& motion, const Edits& edits) const {
  const std::string& file = scene.file(motion);
  const std::string_view text = text_of(file);
  const auto set = [](const std::string& pointer, const Json& value) { return pointer + "=" + value.dump(); };
  ReadOptions options = read_options(registry_, {});
  if (quick_) {
    const Json plain = Json::parse(text, nullptr, true, true);
    for (const char* pointer : {"/grid/cell_size", "/solver/time_step"})
      options.overrides.push_back(set(pointer, scene.quick * plain.at(Json::json_pointer(pointer)).get<double>()));
  }
  options.overrides.push_back(set("/solver/end_time", 1e6));
  for (const Edit& edit : edits) options.overrides.push_back(set(edit.pointer, edit.value));
  return read_experiment_text(text, "experiments/benchmarks/" + file, ComponentLookup(registry_), options);
}

Product::Product(Experiment experiment, int threads)
    : Product(std::move(experiment), threads, backend_factory(threads)) {}
Product::Product(Experiment experiment, int threads, const BackendFactory& factory)
    : experiment_(std::move(experiment)), threads_(threads), simulation_(experiment_, factory) {
  simulation_.observe_when([](double, long) { return false; });
}

}  // namespace mpm::app

#pragma once
// The scenes and variants of `mpm bench`: experiments/benchmarks, compiled in, so that the program needs no files
// beside it.

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/measure.hpp"
#include "experiment/read.hpp"
#include "plugin/registry.hpp"
#include "simulation/simulation.hpp"

namespace mpm::app {

/// One change of a scene: JSON pointer and value, as --set takes them.
struct Edit {
  std::string pointer;
  nlohmann::ordered_json value;
};
using Edits = std::vector<Edit>;

struct BenchScene {
  std::string name;             ///< "cube_3d"
  std::string rest, deforming;  ///< file names
  double quick = 1;             ///< factor of cell size and time step under --quick

  const std::string& file(const std::string& motion) const { return motion == "rest" ? rest : deforming; }
};

struct BenchMaterial {
  std::string name;
  Edits edits;
};

struct BenchOption {
  std::string name, group, motion, section;
  bool figure = true;                                         ///< whether it is a point of the roofline
  std::vector<std::pair<std::string, Edits>> edits_of_scene;  ///< edits by name of the scene

  const Edits& edits(const std::string& scene) const;
};

class BenchSuite {
 public:
  BenchSuite(const Registry& registry, bool quick);

  const Registry& registry() const { return registry_; }
  const std::vector<BenchScene>& scenes() const { return scenes_; }
  const std::vector<BenchMaterial>& materials() const { return materials_; }
  const std::vector<BenchOption>& options() const { return options_; }
  /// The value that a parameter without default has in the scenes, if the file names it.
  std::optional<double> parameter(const std::string& name) const;
  /// The first parameter of a plugin that has neither a default nor a value here; empty where there is none.
  std::string unknown_parameter(const Plugin& plugin) const;
  /// The material with these values where it has no defaults, in cells of the cube. Throws std::bad_optional_access where
  /// one is unknown.
  Component material(const Plugin& plugin) const;
  /// The scene of a name. Throws std::out_of_range.
  const BenchScene& scene(const std::string& name) const;

  /// The experiment of a scene, without an end that a measurement would reach. Throws InputError.
  Experiment experiment(const BenchScene& scene, const std::string& motion, const Edits& edits) const;

 private:
  const Registry& registry_;
  bool quick_;
  std::vector<BenchScene> scenes_;
  std::vector<BenchMaterial> materials_;
  std::vector<BenchOption> options_;
  std::map<std::string, double> parameters_;
};

/// The sandbox on one experiment, as between two outputs of a run: no step is observed unless the simulation is told
/// so.
class Product final : public bench::Contender {
 public:
  Product(Experiment experiment, int threads);
  Product(Experiment experiment, int threads, const BackendFactory& factory);
  void step() override { simulation_.step(); }
  std::size_t particle_count() const override { return simulation_.particle_count(); }
  int steps_a_cycle() const override { return 8; }  ///< cycle of re-sorting: 4 to 8 steps where particles are fast

  const Experiment& experiment() const { return experiment_; }
  Simulation& simulation() { return simulation_; }
  int threads() const override { return threads_; }

 private:
  Experiment experiment_;
  int threads_;
  Simulation simulation_;
};

}  // namespace mpm::app

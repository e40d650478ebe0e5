#pragma once
// Reads a file into a checked Experiment, or finds every mistake in it at once.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/diagnostics.hpp"
#include "experiment/experiment.hpp"
#include "experiment/parameter.hpp"

namespace mpm {

/// An exact solution that experiments may name under compare/exact.
struct ExactDescription {
  std::string name, doc;
  std::vector<ParameterSpec> parameters;
};

/// A way to make steps that experiments may name under solver/type. Its keys include `end_time_parameter()` and
/// `max_steps_parameter()` (experiment/sections.hpp), which the reader itself reads.
struct SolverDescription {
  std::string name, doc;
  std::vector<ParameterSpec> parameters;
  /// Puts what its other keys say.
  void (*read)(const Fields& fields, SolverSpecification& solver) = nullptr;
};

/// What the rest of the program offers, so that reading can check names without depending on it.
struct ReadOptions {
  std::vector<std::string> overrides;  ///< applied in order, "/json/pointer=value"
  std::optional<std::string> backend;  ///< as --backend gave it; it wins over the file
  std::vector<ExactDescription> exact;
  std::vector<SolverDescription> solvers;  ///< the first is meant where a file names none
  std::vector<std::string> backends{"reference", "cpu", "cuda"};
  std::vector<std::string> figures;            ///< valid figure names; empty: any
  std::vector<std::string> colour_quantities;  ///< valid for output/colour_by; empty: any
};

/// The plugins to choose from. They must outlive every Experiment read with them.
class ComponentLookup {
 public:
  explicit ComponentLookup(const Registry& registry);
  explicit ComponentLookup(std::vector<const Plugin*> plugins) : plugins_(std::move(plugins)) {}

  const Plugin* find(mpm_kind kind, std::string_view id) const;
  std::vector<const Plugin*> of_kind(mpm_kind kind) const;
  /// The ids of a kind that could be built and chosen too.
  std::vector<std::string> not_built(mpm_kind kind) const;

 private:
  std::vector<const Plugin*> plugins_;
  std::vector<PluginTarget> not_built_;
};

/// Reads, checks and resolves an experiment. Throws InputError with every problem found, in the order of the file.
Experiment read_experiment(const std::filesystem::path& file, const Registry& registry, const ReadOptions& options);
Experiment read_experiment(const std::filesystem::path& file, const ComponentLookup& components,
                           const ReadOptions& options);
/// Reads an experiment from text; `file` names it in messages.
Experiment read_experiment_text(std::string_view text, const std::filesystem::path& file,
                                const ComponentLookup& components, const ReadOptions& options);

}  // namespace mpm

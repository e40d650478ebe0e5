#include "bench/counting/required.hpp"

#include <algorithm>
#include <iomanip>
#include <memory>
#include <sstream>

#include "backends/make_backend.hpp"
#include "bench/counting/boundary.hpp"
#include "bench/counting/single_step.hpp"
#include "experiment/read.hpp"
#include "solvers/solver.hpp"

namespace mpm::counting {
namespace {

constexpr long first_steps = 50, counted_steps = 1;  ///< the first ones bind functions, touch memory, settle the heap

/// A run as it is counted.
class Counted {
 public:
  Counted(const Experiment& experiment, const AfterStep& after_step)
      : simulation(experiment, backend_factory(1)), after_(after_step ? after_step(simulation) : [] {}) {}
  void steps(long count) {
    for (long k = 0; k < count; ++k) {
      simulation.step();
      after_();
    }
  }
  Simulation simulation;

 private:
  std::function<void()> after_;
};

Experiment read(int dimension, const RequiredScene& scene, const ComponentLookup& lookup) {
  ReadOptions options;
  options.solvers = solver_descriptions();
  options.overrides = scene.overrides;
  return read_experiment_text(required_base_scene(dimension), "required.json", lookup, options);
}

RequiredRow count_calls(const RequiredScene& scene, const CountedPlugins& plugins, const AfterStep& after_step) {
  const Experiment experiment = read(3, scene, plugins.lookup());
  plugins.attach(experiment);
  Counted run(experiment, after_step);
  const Plan& plan = run.simulation.plan();
  RequiredRow row;
  row.name = scene.name;
  row.steps = counted_steps;
  row.particles = run.simulation.particle_count();
  row.bytes_per_particle = plan.bytes_per_particle(0);
  row.bytes_per_node = plan.bytes_per_node();
  for (const Field& field : plan.fields)
    if (field.owner == Owner::node)
      row.channels.push_back(field.id + (plan.velocity_fields > 1 ? " x " + std::to_string(plan.velocity_fields) : ""));
  for_each_pass_as_a_rule(plan.step, [&](const Pass& pass) { row.passes.push_back(pass.name()); });
  run.steps(first_steps);
  plugins.clear();
  run.steps(counted_steps);
  row.calls = plugins.calls();
  row.particle_bytes = run.simulation.backend().particle_bytes();
  row.grid_bytes = run.simulation.backend().grid_bytes();
  return row;
}

void count_machine(const RequiredScene& scene, const Registry& registry, const AfterStep& after_step,
                   RequiredRow& row) {
  const Experiment experiment = read(2, scene, ComponentLookup(registry));
  row.stepped_particles = Simulation(experiment, backend_factory(1)).particle_count();
  std::unique_ptr<Counted> run;
  row.instructions = count_instructions(
      [&] {
        run = std::make_unique<Counted>(experiment, after_step);
        run->steps(first_steps);
      },
      [&] { run->steps(counted_steps); });
}

}  // namespace

std::string required_base_scene(int dimension) {
  const std::string common = R"(
  "title": "required", "precision": "float", "backend": "cpu",
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "mls"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "solver": {"time_step": 1e-4, "end_time": 100},
  "output": {"ledger": false, "metrics_every": 1000000, "frames": 0, "checkpoint_every": 0},)";
  if (dimension == 2)
    return "{" + common + R"(
  "dimension": 2, "gravity": [0, -9.81],
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [2.4, 2.4]], "boundaries": {"all": "slip"}},
  "bodies": [
    {"name": "a", "material": "m", "geometry": {"type": "box", "lower": [0.9, 0.9], "upper": [1.2, 1.5]}},
    {"name": "b", "material": "m", "geometry": {"type": "box", "lower": [1.2, 0.9], "upper": [1.5, 1.5]}}]})";
  return "{" + common + R"(
  "dimension": 3, "gravity": [0, 0, -9.81],
  "grid": {"cell_size": 0.1, "domain": [[0, 0, 0], [1.2, 1.2, 1.2]], "boundaries": {"all": "slip"}},
  "bodies": [
    {"name": "a", "material": "m", "geometry": {"type": "box", "lower": [0.5, 0.5, 0.5], "upper": [0.6, 0.7, 0.7]}},
    {"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0.6, 0.5, 0.5], "upper": [0.7, 0.7, 0.7]}}]})";
}

std::vector<RequiredScene> required_scenes() {
  return {{"base", {}},
          {"+ metrics", {"/output/metrics_every=1000"}},
          {"+ numbers", {"/output/metrics_every=1000", "/output/bodies=true"}},
          {"+ frames", {"/output/frames=2", "/output/colour_by=von_mises_stress"}},
          {"+ vtk", {"/output/frames=2", "/output/vtk=true"}},
          {"+ figures", {R"(/figures=["energy", "momentum", "volume_ratio"])"}},
          {"+ checkpoints", {"/output/checkpoint_steps=1000"}},
          {"+ ledger", {"/output/ledger=true"}},
          {"+ ledger, not due", {"/output/ledger=true", "/output/ledger_every=1000"}},
          {"flip", {R"(/transfer={"type": "flip"})"}},
          {"+ fmpm 4", {R"(/filter={"type": "fmpm", "order": 4})"}},
          {"+ contact", {R"(/contact={"type": "coulomb", "friction": 0.3})"}}};
}

std::vector<RequiredRow> count_required(const Registry& registry, const std::vector<RequiredScene>& scenes,
                                        const AfterStep& after_step) {
  const CountedPlugins plugins(registry);
  std::vector<RequiredRow> rows;
  for (const RequiredScene& scene : scenes) {
    rows.push_back(count_calls(scene, plugins, after_step));
    count_machine(scene, registry, after_step, rows.back());
  }
  return rows;
}

std::string to_text(const std::vector<RequiredRow>& rows) {
  std::ostringstream out;
  out << "| scene | bytes a particle | bytes a node | passes | boundary calls a step | instructions a particle-step |\n"
         "|---|---|---|---|---|---|\n";
  bool refused = false;
  for (const RequiredRow& row : rows) {
    long calls = 0;
    for (const char* kind : {"shape", "transfer: scatter", "transfer: gather", "filter", "contact", "material"})
      if (const auto found = row.calls.find(kind); found != row.calls.end()) calls += found->second;
    out << "| " << row.name << " | " << row.bytes_per_particle << " | " << row.bytes_per_node << " | "
        << row.passes.size() << " | " << static_cast<double>(calls) / static_cast<double>(row.steps) << " | ";
    if (const auto instructions = row.instructions_per_particle_step())
      out << std::fixed << std::setprecision(1) << *instructions << std::defaultfloat << " |\n";
    else
      out << "- |\n", refused = true;
  }
  if (refused) out << "\nInstructions were not counted: this machine refuses to single-step a process (ptrace).\n";
  return out.str();
}

}  // namespace mpm::counting

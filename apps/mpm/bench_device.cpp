// `mpm bench --backend cuda`: the standard scenes on a device, with what a particle-step moves and computes, and what
// follows from that for GPUs that nobody had at hand.

#include <algorithm>
#include <iostream>

#include "backends/device/device_plan.hpp"
#include "backends/device/program.hpp"
#include "backends/device/traffic.hpp"
#include "backends/make_backend.hpp"
#include "experiment/diagnostics.hpp"
#include "mpm/bench_sections.hpp"
#include "plan/compatibility.hpp"
#include "solvers/solver.hpp"

namespace mpm::app {
namespace {

using bench::Cell;

/// A GPU by its data sheet, and what is assumed of it. No figure here was measured by this project.
struct Gpu {
  const char* name;
  const char* architecture;
  int multiprocessors;
  double bandwidth;                   ///< B/s
  double flops_single, flops_double;  ///< 1/s, multiply-adds counted as two
  double bus;                         ///< B/s, to the host
};
// NVIDIA A100 (40 GB, SXM4) and H100 (SXM5) data sheets; the bus is PCIe 4 and 5 with 16 lanes, less a fifth.
constexpr Gpu gpus[] = {{"A100", "sm_80", 108, 1.555e12, 19.5e12, 9.7e12, 25e9},
                        {"H100", "sm_90", 132, 3.35e12, 66.9e12, 33.5e12, 50e9}};
constexpr double latency = 600e-9;     ///< s from a load to its value, assumed
constexpr double in_flight = 16;       ///< bytes that a lane waits for at once, assumed: four floats
constexpr double launch = 3e-6;        ///< s between the starts of two launches at least, assumed
constexpr double predicted_for = 1e7;  ///< particles

/// The counts of one scene; they are of few particles, and scale with them.
struct Counted {
  device::StepTraffic moved;
  std::optional<double> flops;
  std::vector<device::DevicePlan> plans;  ///< by GPU
};

/// The share of the bandwidth that a kernel can use: by Little's law what is on its way must fill the latency.
double share_of_bandwidth(const Gpu& gpu, const device::DevicePlan& plan, const std::string& kernel) {
  const auto found = std::find_if(plan.taken.begin(), plan.taken.end(),
                                  [&](const device::KernelResources& taken) { return taken.kernel == kernel; });
  if (found == plan.taken.end()) return 1;  // without a compiler nothing is known of it
  const double lanes = 32.0 * plan.processor.warps * device::occupancy(*found, plan.processor);
  return std::min(1.0, lanes * in_flight * gpu.multiprocessors / (gpu.bandwidth * latency));
}

/// Predicted particle-steps/s, and what of a particle-step's time the bus and the launches take.
struct Prediction {
  double memory = 0, arithmetic = 0, bus = 0, launches = 0;  ///< s a particle-step
  double seconds() const { return std::max(memory, arithmetic) + bus + launches; }
};

Prediction predict(const Gpu& gpu, const device::DevicePlan& plan, const Counted& counted, Precision precision) {
  Prediction result;
  const double steps = static_cast<double>(counted.moved.particles) * counted.moved.steps;
  for (const auto& [kernel, moved] : counted.moved.kernels)
    result.memory += moved.bytes() / steps / (gpu.bandwidth * share_of_bandwidth(gpu, plan, kernel));
  result.arithmetic =
      counted.flops.value_or(0) / (precision == Precision::single ? gpu.flops_single : gpu.flops_double);
  result.bus = counted.moved.copied_per_particle_step() / gpu.bus;
  result.launches = counted.moved.launches_per_step() * launch / predicted_for;
  return result;
}

Experiment on_device(Experiment experiment) {
  experiment.backend = "cuda";
  return experiment;
}

/// Counts of a scene of few particles: quick ones.
Counted count(const Registry& registry, const std::string& scene, const std::string& motion, const Edits& edits) {
  const BenchSuite few(registry, /*quick=*/true);
  const Experiment experiment = on_device(few.experiment(few.scene(scene), motion, edits));
  const Plan plan = make_plan(experiment);
  Counted counted;
  counted.moved = device::count_traffic(experiment, 2);
  const double nodes = static_cast<double>(plan.nodes) / static_cast<double>(plan.particles);
  if (const auto flops = bench::flops_per_particle(experiment, plan, {nodes, motion == "deforming", {}, {}, false}))
    counted.flops = flops->total();
  for (const Gpu& gpu : gpus)
    counted.plans.push_back(device::device_plan(experiment, plan, device::multiprocessor(gpu.architecture)));
  return counted;
}

/// ns a particle-step on the device, the median of the rounds.
double measure(BenchContext& context, const std::string& scene, const std::string& motion, const Edits& edits) {
  Product product(on_device(context.suite.experiment(context.suite.scene(scene), motion, edits)), 1,
                  backend_factory(1, false, context.options.device));
  return 1e9 / context.run_in_turns({&product}).rate(0);
}

bench::Table empty_table(bool measured) {
  bench::Table table{"device", "Standard scenes on a device", {}, {}, ""};
  table.columns = {{"scene", "scene"}, {"motion", "motion"}, {"precision", "precision"}};
  if (measured) table.columns.push_back({"nanoseconds", "measured (ns)"});
  for (const auto& [key, header] :
       {std::pair{"flops", "flop"}, std::pair{"bytes", "bytes"}, std::pair{"copied", "over the bus (bytes)"},
        std::pair{"launches", "launches a step"}})
    table.columns.push_back({key, header});
  for (const Gpu& gpu : gpus) {
    const std::string name = gpu.name;
    table.columns.push_back({"predicted_" + name, "predicted, " + name + " (M/s)"});
    table.columns.push_back({"of_memory_" + name, "of that time memory (%)"});
    table.columns.push_back({"of_bus_" + name, "bus (%)"});
  }
  table.note =
      "flop, bytes, bytes over the bus: a particle-step, counted on the host driver with few particles; each word once "
      "a "
      "launch and direction. Predicted: NOT measured. The larger of bytes over the bandwidth (less where occupancy "
      "keeps "
      "too few bytes on their way) and flop over the peak, then the bus and the launches, for 1e7 particles (docs/"
      "benchmarks/device.md).";
  return table;
}

}  // namespace

int bench_device(const BenchOptions& options) {
  if (!options.sections.empty())
    throw InputError(
        {{"mpm bench", 0, 0, "", "backend cuda has no sections: leave out \"" + options.sections[0] + "\""}});
  const bool measured = !options.predict;
  const bool on_host = measured && device::is_host_device(options.device);
  if (measured) device::setup_for(options.device);  // says what is missing before anything is counted
  const Registry registry = load_registry();
  BenchContext context(registry, options);
  if (on_host && !options.quick)
    throw InputError({{"--device host", 0, 0, "",
                       "the standard scenes take hours on the processor; add --quick, or --predict for the counts"}});
  bench::Table table = empty_table(measured);
  for (const BenchScene& scene : context.suite.scenes())
    for (const std::string motion : {"rest", "deforming"})
      for (const Precision precision : {Precision::single, Precision::double_}) {
        const std::string words = precision == Precision::single ? "float" : "double";
        context.say("counting " + scene.name + " " + motion + " " + words);
        const Edits edits{{"/precision", words}};
        const Counted counted = count(registry, scene.name, motion, edits);
        std::vector<Cell> row{scene.name, motion, words};
        if (measured) row.emplace_back(measure(context, scene.name, motion, edits));
        row.push_back(counted.flops ? Cell(*counted.flops) : Cell());
        row.emplace_back(counted.moved.bytes_per_particle_step());
        row.emplace_back(counted.moved.copied_per_particle_step());
        row.emplace_back(counted.moved.launches_per_step());
        for (std::size_t k = 0; k < std::size(gpus); ++k) {
          const Prediction predicted = predict(gpus[k], counted.plans[k], counted, precision);
          row.emplace_back(1e-6 / predicted.seconds());
          row.emplace_back(100 * std::max(predicted.memory, predicted.arithmetic) / predicted.seconds());
          row.emplace_back(100 * predicted.bus / predicted.seconds());
        }
        table.rows.push_back(std::move(row));
      }
  std::cerr << "predictions are no measurements: no GPU has run this\n";
  if (on_host)
    std::cerr
        << "--device host: the measured times are those of this processor, lane after lane; they mean nothing for a "
           "GPU\n";
  if (options.json)
    std::cout << bench::Json{{"program", "mpm"},
                             {"version", MPM_VERSION},
                             {"command", options.command},
                             {"measured_on_host", on_host},
                             {"table", table.json()}}
                     .dump(2)
              << "\n";
  else
    std::cout << table.markdown() << "\n";
  return done;
}

}  // namespace mpm::app

// Section `freedom`: what it costs that shape, transfer and material are plugins, against the same functors compiled
// into the same kernels.

#include "bench/fused.hpp"
#include "mpm/bench_sections.hpp"

namespace mpm::app {

bench::SectionResult bench_freedom(BenchContext& context) {
  bench::Table table{"boundary",
                     "Plugins against the same functors compiled in (MLS, Neo-Hookean, 1 thread)",
                     {{"scene", "scene"},
                      {"motion", "motion"},
                      {"precision", "precision"},
                      {"plugins", "plugins (M/s)"},
                      {"compiled_in", "compiled in (M/s)"},
                      {"cost", "time with plugins / compiled in"}},
                     {},
                     "The kernels are the same in both; only the calls through the plugins' tables differ."};
  std::vector<bench::Target> targets;
  for (const BenchScene& scene : context.suite.scenes())
    for (const std::string motion : {"rest", "deforming"})
      for (const std::string precision : {"float", "double"}) {
        context.say("freedom: " + scene.name + ", " + motion + ", " + precision);
        const auto experiment = [&] { return context.suite.experiment(scene, motion, {{"/precision", precision}}); };
        Product plugins(experiment(), 1);
        Product compiled(experiment(), 1, [](const Experiment& e, const Plan& plan, std::vector<SeededBody> bodies) {
          return bench::make_fused_backend(e, plan, std::move(bodies), 1);
        });
        const bench::Rates rates = context.run_in_turns({&plugins, &compiled});
        const double cost = rates.ratio(1, 0);
        table.rows.push_back({scene.name, motion, precision, rates.rate(0) / 1e6, rates.rate(1) / 1e6, cost});
        if (motion == "rest")
          targets.push_back({"boundary_" + scene.name + "_" + precision,
                             scene.name + " " + precision + ": time with plugins over compiled in", cost, 1.05, false});
      }
  return {"freedom", {std::move(table)}, std::move(targets)};
}

}  // namespace mpm::app

// Section `materials`: what each law costs in the place of the standard's Neo-Hookean, whoever made it.

#include "mpm/bench_sections.hpp"

namespace mpm::app {
namespace {

using bench::Cell;

bench::Table laws_table() {
  return {
      "laws",
      "What a law costs (float, 1 thread, deforming)",
      {{"scene", "scene"},
       {"law", "law"},
       {"rate", "rate (M/s)"},
       {"spread", "spread (%)"},
       {"time", "ns a particle-step"},
       {"cost", "cost / standard"},
       {"state", "bytes of state"},
       {"flops", "flop of the law"},
       {"all_flops", "flop in all"},
       {"bytes", "bytes moved"}},
      {},
      "cost / standard: time a particle-step over that with neo_hookean in the same rounds (MLS, quadratic B-splines, "
      "fused). Bytes of state are those that the law keeps of a particle."};
}

/// The law in the place of the standard's.
BenchVariant variant_of(const BenchSuite& suite, const Plugin& plugin) {
  nlohmann::ordered_json material{{"type", plugin.id()}};
  for (const mpm_parameter& declared : plugin.parameters())
    if (declared.flags & MPM_REQUIRED) material[declared.name] = suite.parameter(declared.name).value();
  return {std::string(plugin.id()), {{"/materials/jelly", material}}};
}

/// Bytes that the law keeps of a particle.
double state_bytes(const Product& product) {
  const Experiment& experiment = product.experiment();
  const double scalar = experiment.precision == Precision::single ? 4 : 8;
  double components = 0;
  for (const mpm_state& field : experiment.materials[0].component.plugin->state())
    components += state_components(kept_shape(field, experiment.axisymmetric()), experiment.dimension);
  return scalar * components;
}

}  // namespace

bench::SectionResult bench_materials(BenchContext& context) {
  bench::SectionResult result{"materials", {laws_table()}, {}};
  std::vector<BenchVariant> laws;
  for (const Plugin* plugin : context.suite.registry().of_kind(MPM_MATERIAL))
    if (const std::string unknown = context.suite.unknown_parameter(*plugin); unknown.empty())
      laws.push_back(variant_of(context.suite, *plugin));
    else
      context.say("materials: " + std::string(plugin->id()) +
                  " is left out, the benchmarks have no value for its parameter " + unknown);
  for (const BenchScene& scene : context.suite.scenes())
    measure_beside_standard(
        context, "materials", scene, "deforming", laws,
        [&](std::size_t k, Product& product, const BesideStandard& measured) {
          const std::string& law = laws[k].name;
          const Plan& plan = product.simulation().plan();
          const double nodes = bench::nodes_per_particle(product.simulation());
          const auto flops = bench::flops_per_particle(product.experiment(), plan, {nodes, true, {}, {}, false});
          result.tables[0].rows.push_back(
              {scene.name, law, measured.rate / 1e6, 100 * measured.spread, 1e9 / measured.rate, measured.cost,
               state_bytes(product), flops ? Cell(flops->material) : Cell(), flops ? Cell(flops->total()) : Cell(),
               bench::bytes_per_particle(product.experiment(), plan, nodes)});
          if (scene.name != "cube_3d") return;
          const auto at_most = [&](double bound) {
            result.targets.push_back(
                {law, "cube_3d cost of " + law + " over neo_hookean", measured.cost, bound, false});
          };
          if (law == "inviscid_fluid" || law == "linear_elastic") at_most(0.9);
          if (law == "von_mises") at_most(1.35);
        });
  return result;
}

}  // namespace mpm::app

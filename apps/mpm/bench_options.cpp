// Section `options`: what one change of the standard combination costs, in the same rounds as the standard itself.

#include <algorithm>

#include "mpm/bench_sections.hpp"

namespace mpm::app {
namespace {

using bench::Cell;

bench::Table options_table() {
  return {"options",
          "What an option costs (float, 1 thread)",
          {{"scene", "scene"},
           {"option", "option"},
           {"group", "group"},
           {"motion", "motion"},
           {"rate", "rate (M/s)"},
           {"spread", "spread (%)"},
           {"cost", "cost / standard"},
           {"flops", "flop"},
           {"bytes", "bytes"},
           {"gflops", "GFLOP/s"},
           {"share_of_peak", "of FMA peak (%)"},
           {"share_of_memory", "of memory (%)"}},
          {},
          "cost / standard: time a particle-step over that of MLS, quadratic B-splines, Neo-Hookean, float, fused, in "
          "the same rounds."};
}

/// A table of what is measured of options that others have measured too, and of what the width of a stencil costs.
bench::Table remarks(const bench::Table& options) {
  bench::Table table{"remarks",
                     "Beside what is published, and stencils by width",
                     {{"scene", "scene"}, {"what", "what"}, {"measured", "measured"}, {"published", "published"}},
                     {}};
  const auto cost = [&](const std::string& scene, const std::string& name) {
    for (const auto& row : options.rows)
      if (std::get<std::string>(row[0]) == scene && std::get<std::string>(row[1]) == name) return row[6];
    return Cell();
  };
  const Cell scene3(std::string("cube_3d")), scene2(std::string("block_2d"));
  for (const Cell& scene : {scene3, scene2}) {
    const std::string& name = std::get<std::string>(scene);
    const auto add = [&](const std::string& what, const Cell& measured, const std::string& published) {
      table.rows.push_back({scene, what, measured, published.empty() ? Cell() : Cell(published)});
    };
    add("gradients instead of MLS (apic / mls)", cost(name, "apic"), "2 (Hu et al. 2018)");
    add("2 nodes an axis (linear / quadratic, at rest)", cost(name, "linear"), "");
    add("3 nodes an axis, other weights (gimp / quadratic)", cost(name, "gimp"), "");
    add("4 nodes an axis (bspline_cubic / quadratic)", cost(name, "bspline_cubic"), "");
    add("4 nodes an axis, box follows F (gimp_contiguous / quadratic)", cost(name, "gimp_contiguous"), "");
    add("list of about 3 nodes an axis (cpdi / quadratic)", cost(name, "cpdi"), "");
  }
  return table;
}

/// Measures options that share the standard's motion, at most three beside it: memory holds four large contenders.
void run_group(BenchContext& context, const BenchScene& scene, const std::vector<const BenchOption*>& options,
               bench::Table& table, std::vector<bench::Target>& targets) {
  const std::string& motion = options.front()->motion;
  std::string names;
  for (const BenchOption* option : options) names += (names.empty() ? "" : ", ") + option->name;
  context.say("options: " + scene.name + ", " + names);
  std::vector<std::unique_ptr<Product>> products;
  products.push_back(std::make_unique<Product>(context.suite.experiment(scene, motion, {}), 1));
  for (const BenchOption* option : options)
    products.push_back(
        std::make_unique<Product>(context.suite.experiment(scene, motion, option->edits(scene.name)), 1));
  std::vector<bench::Contender*> contenders;
  for (const auto& product : products) contenders.push_back(product.get());
  const bench::Rates rates = context.run_in_turns(contenders);

  for (std::size_t k = 0; k < options.size(); ++k) {
    const BenchOption& option = *options[k];
    const double rate = rates.rate(k + 1), cost = rates.ratio(0, k + 1);
    const Account account = account_of(*products[k + 1], rate, motion != "rest");
    const double peak = context.limits().one.gflops(products[k + 1]->experiment().precision);
    const auto counted = [&](double value) { return account.flops ? Cell(value) : Cell(); };
    table.rows.push_back({scene.name, option.name, option.group, option.motion, rate / 1e6, 100 * rates.spread(k + 1),
                          cost, counted(account.flops.value_or(0)), account.bytes, counted(account.gflops()),
                          counted(100 * account.gflops() / peak),
                          100 * account.gigabytes() / context.limits().one.memory.update});
    if (scene.name != "cube_3d") continue;
    if (account.flops && option.figure && option.group != "precision")
      context.roofline.push_back({option.name, *account.flops / account.bytes, account.gflops()});
    if (option.name == "cpdi") targets.push_back({"cpdi", "cube_3d cpdi float, one thread (M/s)", rate / 1e6, 8, true});
    // The ledger of every step cannot cost as little: docs/design/decisions.md.
    if (option.name == "ledger of every 8th step")
      targets.push_back({"ledger", "cube_3d cost of the ledger of every 8th step over none", cost, 1.1, false});
  }
}

}  // namespace

bench::SectionResult bench_options(BenchContext& context) {
  context.limits();
  bench::SectionResult result{"options", {options_table()}, {}};
  constexpr std::size_t beside_the_standard = 3;
  for (const BenchScene& scene : context.suite.scenes())
    for (const char* motion : {"rest", "deforming"}) {
      std::vector<const BenchOption*> group;
      const auto flush = [&] {
        if (!group.empty()) run_group(context, scene, group, result.tables[0], result.targets);
        group.clear();
      };
      for (const BenchOption& option : context.suite.options()) {
        if (option.motion != motion) continue;
        group.push_back(&option);
        if (group.size() == beside_the_standard) flush();
      }
      flush();
    }
  result.tables.push_back(remarks(result.tables[0]));
  return result;
}

}  // namespace mpm::app

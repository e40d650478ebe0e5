// Sections `options` and `contact`: what one change of the standard combination costs, in the same rounds as the standard
// itself.

#include <algorithm>
#include <stdexcept>

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

/// Contact may cost twice what one body does, a regression for its normal half as much again, and bodies that are apart
/// nothing.
void add_contact_target(const BenchScene& scene, const BenchOption& option, double cost, const bench::Table& table,
                        std::vector<bench::Target>& targets) {
  const auto add = [&](const std::string& over, double measured, double bound) {
    targets.push_back({option.name + " " + scene.name, scene.name + " cost of " + option.name + " over " + over,
                       measured, bound, false});
  };
  const auto cost_of = [&](const std::string& other) {
    for (const auto& row : table.rows)
      if (std::get<std::string>(row[0]) == scene.name && std::get<std::string>(row[1]) == other)
        return std::get<double>(row[6]);
    throw std::logic_error("\"" + other + "\" comes after \"" + option.name + "\" in the suite");
  };
  if (option.name == "contact") add("one body", cost, 2);
  if (option.name.find("regression") != std::string::npos) add("contact", cost / cost_of("contact"), 1.5);
  if (option.name == "contact, bodies apart") add("the same without contact", cost / cost_of("bodies apart"), 1.05);
}

/// Adds a row for each option, which share the standard's motion.
void run_group(BenchContext& context, const std::string& section, const BenchScene& scene, const std::string& motion,
               const std::vector<const BenchOption*>& options, bench::Table& table,
               std::vector<bench::Target>& targets) {
  std::vector<BenchVariant> variants;
  for (const BenchOption* option : options) variants.push_back({option->name, option->edits(scene.name)});
  measure_beside_standard(
      context, section, scene, motion, variants, [&](std::size_t k, Product& product, const BesideStandard& measured) {
        const BenchOption& option = *options[k];
        const Account account = account_of(product, measured.rate, motion != "rest");
        const double peak = context.limits().one.gflops(product.experiment().precision);
        // What contact takes depends on how many particles have another body near.
        const bool is_counted = account.flops && option.group != "contact";
        const auto counted = [&](double value) { return is_counted ? Cell(value) : Cell(); };
        table.rows.push_back({scene.name, option.name, option.group, option.motion, measured.rate / 1e6,
                              100 * measured.spread, measured.cost, counted(account.flops.value_or(0)),
                              counted(account.bytes), counted(account.gflops()), counted(100 * account.gflops() / peak),
                              counted(100 * account.gigabytes() / context.limits().one.memory.update)});
        if (option.group == "contact") add_contact_target(scene, option, measured.cost, table, targets);
        if (scene.name != "cube_3d") return;
        if (is_counted && option.figure && option.group != "precision")
          context.roofline.push_back({option.name, *account.flops / account.bytes, account.gflops()});
        if (option.name == "cpdi")
          targets.push_back({"cpdi", "cube_3d cpdi float, one thread (M/s)", measured.rate / 1e6, 8, true});
        // The ledger of every step cannot cost as little: docs/design/decisions.md.
        if (option.name == "ledger of every 8th step")
          targets.push_back(
              {"ledger", "cube_3d cost of the ledger of every 8th step over none", measured.cost, 1.1, false});
      });
}

}  // namespace

void measure_beside_standard(BenchContext& context, const std::string& section, const BenchScene& scene,
                             const std::string& motion, const std::vector<BenchVariant>& variants,
                             const std::function<void(std::size_t, Product&, const BesideStandard&)>& take) {
  constexpr std::size_t beside_the_standard = 3;  // memory holds four large contenders
  for (std::size_t first = 0; first < variants.size(); first += beside_the_standard) {
    const std::size_t end = std::min(first + beside_the_standard, variants.size());
    std::string names;
    std::vector<std::unique_ptr<Product>> products;
    products.push_back(std::make_unique<Product>(context.suite.experiment(scene, motion, {}), 1));
    for (std::size_t k = first; k < end; ++k) {
      names += (k == first ? "" : ", ") + variants[k].name;
      products.push_back(std::make_unique<Product>(context.suite.experiment(scene, motion, variants[k].edits), 1));
    }
    context.say(section + ": " + scene.name + ", " + names);
    std::vector<bench::Contender*> contenders;
    for (const auto& product : products) contenders.push_back(product.get());
    const bench::Rates rates = context.run_in_turns(contenders);
    for (std::size_t k = first; k < end; ++k) {
      const std::size_t at = k - first + 1;
      take(k, *products[at], {rates.rate(at), rates.spread(at), rates.ratio(0, at)});
    }
  }
}

namespace {

/// Measures the options that `chosen` holds for.
template <class Chosen>
bench::SectionResult measure_options(BenchContext& context, const std::string& section, Chosen&& chosen) {
  context.limits();
  bench::SectionResult result{section, {options_table()}, {}};
  for (const BenchScene& scene : context.suite.scenes())
    for (const char* motion : {"rest", "deforming"}) {
      std::vector<const BenchOption*> group;
      for (const BenchOption& option : context.suite.options())
        if (option.motion == motion && chosen(option)) group.push_back(&option);
      if (!group.empty()) run_group(context, section, scene, motion, group, result.tables[0], result.targets);
    }
  return result;
}

}  // namespace

bench::SectionResult bench_options(BenchContext& context) {
  bench::SectionResult result =
      measure_options(context, "options", [](const BenchOption& option) { return option.section == "options"; });
  result.tables.push_back(remarks(result.tables[0]));
  return result;
}

bench::SectionResult bench_contact(BenchContext& context) {
  return measure_options(context, "contact", [](const BenchOption& option) { return option.group == "contact"; });
}

}  // namespace mpm::app

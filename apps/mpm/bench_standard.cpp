// Section `standard`: every standard scene and material, in both precisions, on 1 and N threads, with the baseline's
// rate of the same rounds, and where the time goes.

#include <map>

#include "bench/baseline.hpp"
#include "mpm/bench_sections.hpp"

namespace mpm::app {
namespace {

using bench::Cell;

class BaselineContender final : public bench::Contender {
 public:
  explicit BaselineContender(const Experiment& experiment) : baseline_(bench::make_baseline(experiment)) {}
  void step() override { baseline_->step(); }
  std::size_t particle_count() const override { return baseline_->particle_count(); }

 private:
  std::unique_ptr<bench::Baseline> baseline_;
};

/// ns a particle-step of one contender by phase and by pass.
struct Phases {
  std::string name;
  std::map<std::string, double> nanoseconds;
};

struct Findings {
  bench::Table rates{
      "rates",
      "Standard scenes",
      {{"scene", "scene"},
       {"motion", "motion"},
       {"material", "material"},
       {"precision", "precision"},
       {"threads", "threads"},
       {"rate", "rate (M/s)"},
       {"spread", "spread (%)"},
       {"over_baseline", "/ baseline"},
       {"over_one_thread", "/ 1 thread"},
       {"over_rest", "/ rest"},
       {"line", "line (ns)"},
       {"flops", "flop"},
       {"bytes", "bytes"},
       {"gflops", "GFLOP/s"},
       {"share_of_peak", "of FMA peak (%)"},
       {"share_of_memory", "of memory (%)"}},
      {},
      "M/s: million particle-steps a second, median of the rounds. Ratios: medians of each round's "
      "ratios. line: what a line of the cache takes from one thread to another, the longer of before and "
      "after the rounds; some 50 where processors share a cache. flop, bytes: a particle-step, counted."};
  std::vector<Phases> phases;
  std::vector<bench::Target> targets;
};

std::string words_of(const BenchScene& scene, const std::string& motion, Precision precision) {
  return scene.name + " " + motion + (precision == Precision::single ? " float" : " double");
}

/// Measures where the time goes, in a window of its own: the clock would disturb the rates.
Phases phases_of(Product& product, const std::string& name, int steps) {
  Simulation& simulation = product.simulation();
  const auto passes_before = simulation.seconds_by_pass();
  simulation.backend().measure_phases(true);
  for (int s = 0; s < steps; ++s) simulation.step();
  const double scale = 1e9 / (static_cast<double>(product.particle_count()) * steps);
  Phases phases{name, {}};
  for (const auto& [phase, seconds] : simulation.backend().phase_seconds())
    phases.nanoseconds["phase " + phase] = seconds * scale;
  simulation.backend().measure_phases(false);
  for (const auto& [pass, seconds] : simulation.seconds_by_pass()) {
    const auto before = passes_before.find(pass);
    phases.nanoseconds["pass " + pass] = (seconds - (before == passes_before.end() ? 0 : before->second)) * scale;
  }
  return phases;
}

class Group {
 public:
  Group(BenchContext& context, const BenchScene& scene, const BenchMaterial& material, Precision precision)
      : context_(context), scene_(scene), material_(material), precision_(precision) {}

  /// Measures product and baseline of both motions on one thread.
  void against_baseline(Findings& findings) {
    std::vector<std::unique_ptr<BaselineContender>> baselines;
    for (const char* motion : motions) {
      products_.push_back(product(motion, 1));
      baselines.push_back(std::make_unique<BaselineContender>(products_.back()->experiment()));
    }
    const bench::Rates rates = run({products_[0].get(), products_[1].get(), baselines[0].get(), baselines[1].get()});
    for (std::size_t m = 0; m < 2; ++m) {
      const double ratio = rates.ratio(m, 2 + m);
      baseline_ratio_[m] = ratio;
      findings.rates.rows.push_back({scene_.name,
                                     std::string(motions[m]),
                                     std::string("baseline"),
                                     precision_name(),
                                     1.0,
                                     rates.rate(2 + m) / 1e6,
                                     100 * rates.spread(2 + m),
                                     1.0,
                                     {},
                                     {},
                                     {},
                                     {},
                                     {},
                                     {},
                                     {},
                                     {}});
      if (scene_.name == "cube_3d") {
        const double wanted = precision_ == Precision::single ? 5 : 3.5;
        target(findings, m, "over_baseline", "one thread over the baseline", ratio, wanted, true);
      }
      findings.phases.push_back(
          phases_of(*products_[m], words_of(scene_, motions[m], precision_), context_.options.quick ? 4 : 16));
    }
    products_.clear();
  }

  /// Measures both motions on 1 and N threads.
  void by_threads(Findings& findings) {
    const std::size_t counts = context_.threads > 1 ? 2 : 1;
    std::vector<bench::Contender*> contenders;
    for (const char* motion : motions)
      for (std::size_t k = 0; k < counts; ++k) {
        products_.push_back(product(motion, k == 0 ? 1 : context_.threads));
        contenders.push_back(products_.back().get());
      }
    const double before = between_threads();
    const bench::Rates rates = run(contenders);
    line_ = std::max(before, between_threads());
    for (std::size_t m = 0; m < 2; ++m)
      for (std::size_t k = 0; k < counts; ++k) add_row(findings, rates, m, k, counts);
    if (scene_.name == "cube_3d" && material_.name == "neo_hookean")
      target(findings, 1, "over_rest", "one thread, the deforming scene over the resting one", rates.ratio(counts, 0),
             0.75, true);
    products_.clear();
  }

 private:
  static constexpr const char* motions[2] = {"rest", "deforming"};

  std::string precision_name() const { return precision_ == Precision::single ? "float" : "double"; }

  std::unique_ptr<Product> product(const std::string& motion, int threads) const {
    Edits edits = material_.edits;
    edits.push_back({"/precision", precision_name()});
    return std::make_unique<Product>(context_.suite.experiment(scene_, motion, edits), threads);
  }

  double between_threads() const { return context_.threads > 1 ? bench::nanoseconds_between_threads(0.02) : 0; }

  bench::Rates run(const std::vector<bench::Contender*>& contenders) const {
    context_.say("standard: " + scene_.name + ", " + material_.name + ", " + precision_name());
    return context_.run_in_turns(contenders);
  }

  void target(Findings& findings, std::size_t motion, const std::string& id, const std::string& meaning,
              double measured, double limit, bool at_least) const {
    const std::string place = words_of(scene_, motions[motion], precision_);
    findings.targets.push_back({id + " " + place, place + ": " + meaning, measured, limit, at_least});
  }

  void add_row(Findings& findings, const bench::Rates& rates, std::size_t m, std::size_t k, std::size_t counts) {
    const std::size_t c = m * counts + k;
    const Account account = account_of(*products_[c], rates.rate(c), m == 1);
    const auto& limits = k == 0 ? context_.limits().one : context_.limits().all;
    const double peak = limits.gflops(precision_);
    const bool plain = material_.name == "neo_hookean";
    std::vector<Cell> row{scene_.name,
                          std::string(motions[m]),
                          material_.name,
                          precision_name(),
                          static_cast<double>(products_[c]->threads()),
                          account.rate / 1e6,
                          100 * rates.spread(c)};
    row.push_back(plain && k == 0 ? Cell(baseline_ratio_[m]) : Cell());
    row.push_back(k == 1 ? Cell(rates.ratio(c, c - 1)) : Cell());
    row.push_back(m == 1 ? Cell(rates.ratio(c, c - counts)) : Cell());
    row.push_back(k == 1 ? Cell(line_) : Cell());
    row.push_back(account.flops ? Cell(*account.flops) : Cell());
    row.push_back(account.bytes);
    row.push_back(account.flops ? Cell(account.gflops()) : Cell());
    row.push_back(account.flops ? Cell(100 * account.gflops() / peak) : Cell());
    row.push_back(100 * account.gigabytes() / limits.memory.update);
    findings.rates.rows.push_back(std::move(row));
    if (account.flops && plain && scene_.name == "cube_3d" && precision_ == Precision::single)
      context_.roofline.push_back(
          {std::string(motions[m]) + (k == 0 ? "" : ", " + std::to_string(context_.threads) + " threads"),
           *account.flops / account.bytes, account.gflops()});
    if (!plain || scene_.name != "cube_3d") return;
    if (k == 0 && account.flops)
      target(findings, m, "share_of_peak", "one thread, % of the FMA peak", 100 * account.gflops() / peak, 25, true);
    if (k == 1 && context_.threads == 2)
      target(findings, m, "over_one_thread", "two threads over one", rates.ratio(c, c - 1), 1.85, true);
  }

  BenchContext& context_;
  const BenchScene& scene_;
  const BenchMaterial& material_;
  Precision precision_;
  std::vector<std::unique_ptr<Product>> products_;
  double baseline_ratio_[2] = {0, 0};
  double line_ = 0;  ///< ns that a line takes from one thread to another
};

/// The table of times: passes first, then what their time goes to; one column a scene.
bench::Table phase_table(const std::vector<Phases>& all) {
  bench::Table table{"phases",
                     "Where the time goes (Neo-Hookean, 1 thread), ns a particle-step",
                     {{"phase", "pass or phase"}},
                     {},
                     "Passes over particles are made of phases; measured in a window of its own."};
  std::map<std::string, std::vector<Cell>> rows;
  for (const Phases& phases : all) {
    table.columns.push_back({phases.name, phases.name});
    for (const auto& [phase, unused] : phases.nanoseconds) rows[phase];
  }
  for (auto& [phase, row] : rows) {
    row.push_back(phase);
    for (const Phases& phases : all) {
      const auto found = phases.nanoseconds.find(phase);
      row.push_back(found == phases.nanoseconds.end() ? Cell() : Cell(found->second));
    }
  }
  for (const char* kind : {"pass ", "phase "})
    for (auto& [phase, row] : rows)
      if (phase.starts_with(kind)) table.rows.push_back(std::move(row));
  return table;
}

}  // namespace

bench::SectionResult bench_standard(BenchContext& context) {
  context.limits();
  Findings findings;
  for (const BenchScene& scene : context.suite.scenes())
    for (const Precision precision : {Precision::single, Precision::double_})
      for (const BenchMaterial& material : context.suite.materials()) {
        Group group(context, scene, material, precision);
        if (material.name == "neo_hookean") group.against_baseline(findings);
        group.by_threads(findings);
      }
  return {"standard", {std::move(findings.rates), phase_table(findings.phases)}, std::move(findings.targets)};
}

}  // namespace mpm::app

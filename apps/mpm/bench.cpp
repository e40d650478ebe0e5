// The verb `bench`: speed on the standard scenes, against the plain baseline of the same run.

#include <algorithm>
#include <iostream>

#include "experiment/diagnostics.hpp"
#include "mpm/bench_sections.hpp"
#include "output/manifest.hpp"
#include "support/processors.hpp"

namespace mpm::app {
namespace {

std::vector<const BenchSection*> chosen(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const BenchSection& section : bench_sections()) known.emplace_back(section.name);
  std::vector<Problem> problems;
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      problems.push_back(
          {"mpm bench", 0, 0, "",
           "no section is called " + in_quotes(name) + suggestion(name, known, "sections are " + quoted_list(known))});
  if (!problems.empty()) throw InputError(std::move(problems));
  std::vector<const BenchSection*> sections;
  for (const BenchSection& section : bench_sections())
    if (names.empty() || std::find(names.begin(), names.end(), section.name) != names.end())
      sections.push_back(&section);
  return sections;
}

bench::Json head_of_document(const BenchOptions& options, int threads, int repeats) {
  bench::Json document{{"program", "mpm"}, {"version", MPM_VERSION}, {"command", options.command}};
  document["machine"] = output::machine_description();
  document["quick"] = options.quick;
  document["repeats"] = repeats;
  document["threads"] = threads;
  document["clock"] = options.processor_time ? "processor" : "wall";
  document["sections"] = bench::Json::object();
  return document;
}

}  // namespace

BenchContext::BenchContext(const Registry& registry, const BenchOptions& bench_options)
    : options(bench_options),
      suite(registry, bench_options.quick),
      threads(bench_options.threads > 0 ? bench_options.threads : support::available_processors()) {
  if (options.quick) protocol = {2, 1, 0.005, false, false};
  if (options.repeats > 0) protocol.repeats = options.repeats;
  protocol.processor_time = options.processor_time;
}

bench::Rates BenchContext::run_in_turns(const std::vector<bench::Contender*>& contenders) {
  bench::Rates rates = bench::run_in_turns(contenders, protocol);
  given_.push_back(rates.given);
  return rates;
}

void BenchContext::say(const std::string& what) const {
  std::cerr << what << "\n";
}

Account account_of(Product& product, double rate, bool deforming) {
  const Plan& plan = product.simulation().plan();
  const double nodes = bench::nodes_per_particle(product.simulation());
  const auto flops = bench::flops_per_particle(product.experiment(), plan, {nodes, deforming, {}, {}, false});
  return {rate, flops ? std::optional(flops->total()) : std::nullopt,
          bench::bytes_per_particle(product.experiment(), plan, nodes)};
}

const std::vector<BenchSection>& bench_sections() {
  static const std::vector<BenchSection> sections{
      {"machine", "peak of multiply-adds and of memory", bench_machine},
      {"standard", "the standard scenes against the baseline, on 1 and N threads, by phase", bench_standard},
      {"options", "what each transfer, shape, filter, contact, ledger and double costs", bench_options},
      {"contact", "what contact costs, bodies apart, and normals that look at particles", bench_contact},
      {"materials", "what each law costs: time, bytes of state, operations", bench_materials},
      {"freedom", "plugins against the same functors compiled in", bench_freedom},
      {"required", "bytes, passes, calls and instructions of what is asked, counted", bench_required},
      {"growth", "cost and memory from 1e5 to 1e7 particles, a huge domain, start-up", bench_growth},
      {"accuracy", "float against double", bench_accuracy},
      {"busy", "the default number of threads against the best, beside programs that keep processors busy", bench_busy},
  };
  return sections;
}

std::string bench_section_list() {
  std::string list;
  for (const BenchSection& section : bench_sections())
    list += std::string("  ") + section.name + std::string(12 - std::string_view(section.name).size(), ' ') +
            section.summary + "\n";
  return list;
}

int bench(const BenchOptions& options) {
  const auto sections = chosen(options.sections);
  if (!options.quick && options.repeats > 0 && options.repeats < 5)
    throw InputError(
        {{"--repeats", 0, 0, "",
          "medians are of at least 5 rounds, not " + std::to_string(options.repeats) + "; --quick takes fewer"}});
  const Registry registry = load_registry();
  BenchContext context(registry, options);
  bench::Json document = head_of_document(options, context.threads, context.protocol.repeats);
  std::vector<bench::SectionResult> results;
  bool all_held = true;
  if (options.quick && !options.json)
    std::cout
        << "--quick: 1/64 of the particles and 2 rounds; shows that everything runs, its numbers mean nothing\n\n";
  for (const BenchSection* section : sections) {
    bench::SectionResult result;
    try {
      result = section->run(context);
    } catch (const RunFailure& stopped) {
      std::cerr << "mpm bench " << section->name << ": a scene became unstable: particle " << stopped.failure.particle
                << " " << name_of(stopped.failure.cause) << "; fewer --repeats end before\n";
      return run_failed;
    }
    result.name = section->name;
    for (const bench::Target& target : result.targets) all_held = all_held && target.held();
    document["sections"][result.name] = result.json();
    if (!options.json) std::cout << result.text() << "\n" << std::flush;
    results.push_back(std::move(result));
    // The report is written after every section: what is measured is kept when a later section ends the program.
    if (!options.out.empty()) write_bench_report(options.out, document, results, context);
  }
  if (!context.given().empty()) {
    const double given = bench::median(context.given());
    document["processor_time_given"] = given;
    if (given < 0.95)
      std::cerr << "warning: other programs were running: the machine gave " << bench::short_number(100 * given)
                << " % of the processor time wanted; rates are too low, and ratios of threads mean nothing"
                << (options.processor_time ? "" : " (--processor-time helps those of one thread)") << "\n";
  }
  if (options.json) std::cout << document.dump(2) << "\n";
  if (!options.out.empty()) write_bench_report(options.out, document, results, context);  // with the share given
  return options.strict && !all_held ? expectation_failed : done;
}

}  // namespace mpm::app

#pragma once
// What the sections of `mpm bench` share, and their table. A section measures and returns tables and targets; printing
// and files are the verb's.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/costs.hpp"
#include "bench/machine.hpp"
#include "bench/measure.hpp"
#include "bench/table.hpp"
#include "mpm/bench_suite.hpp"
#include "mpm/cli.hpp"

namespace mpm::app {

/// The two roofs of the machine, for 1 thread and for all that are used.
struct MachineLimits {
  struct OfThreads {
    int threads = 1;
    double gflops_float = 0, gflops_double = 0;
    bench::MemoryBandwidth memory;
    double gflops(Precision precision) const { return precision == Precision::single ? gflops_float : gflops_double; }
  };
  OfThreads one, all;
};

/// A variant as a point under the roofs.
struct RooflinePoint {
  std::string name;
  double flops_per_byte = 0, gflops = 0;
};

class BenchContext {
 public:
  BenchContext(const Registry& registry, const BenchOptions& options);

  const BenchOptions& options;
  const BenchSuite suite;
  const int threads;  ///< threads of the parallel contenders
  bench::Protocol protocol;
  std::vector<RooflinePoint> roofline;  ///< what sections add for the figure

  /// The machine's limits, measured once, when first asked for.
  const MachineLimits& limits();
  /// Runs contenders by the protocol; notes how busy the machine was.
  bench::Rates run_in_turns(const std::vector<bench::Contender*>& contenders);
  /// Shares of the processor time wanted that the groups were given.
  const std::vector<double>& given() const { return given_; }
  /// Says a line on standard error, so that the tables stay clean.
  void say(const std::string& what) const;

 private:
  std::optional<MachineLimits> limits_;
  std::vector<double> given_;
};

/// Rate, operations, bytes and shares of the roofs of one contender.
struct Account {
  double rate = 0;  ///< particle-steps/s
  std::optional<double> flops;
  double bytes = 0;  ///< bytes a particle-step

  double gflops() const { return flops ? rate * *flops / 1e9 : 0; }
  double gigabytes() const { return rate * bytes / 1e9; }
};
Account account_of(Product& product, double rate, bool deforming);

/// A change of the standard scene.
struct BenchVariant {
  std::string name;
  Edits edits;
};
/// What was measured of a variant: particle-steps/s, the spread of that over the rounds, and the time a particle-step over
/// that of the standard in the same rounds.
struct BesideStandard {
  double rate = 0, spread = 0, cost = 0;
};
/// Runs variants of a scene in turns with the scene as it is, on one thread, and hands each to `take` with its place in
/// the list.
void measure_beside_standard(BenchContext& context, const std::string& section, const BenchScene& scene,
                             const std::string& motion, const std::vector<BenchVariant>& variants,
                             const std::function<void(std::size_t, Product&, const BesideStandard&)>& take);

struct BenchSection {
  const char* name;
  const char* summary;
  bench::SectionResult (*run)(BenchContext&);
};
/// The sections in the order in which they run. A section of its own file is one line here.
const std::vector<BenchSection>& bench_sections();

bench::SectionResult bench_machine(BenchContext& context);
bench::SectionResult bench_standard(BenchContext& context);
bench::SectionResult bench_options(BenchContext& context);
bench::SectionResult bench_contact(BenchContext& context);
bench::SectionResult bench_materials(BenchContext& context);
bench::SectionResult bench_freedom(BenchContext& context);
bench::SectionResult bench_required(BenchContext& context);
bench::SectionResult bench_growth(BenchContext& context);
bench::SectionResult bench_accuracy(BenchContext& context);
bench::SectionResult bench_busy(BenchContext& context);

/// Writes bench.json, a CSV a table, report.md and the roofline figure. Throws MachineError.
void write_bench_report(const std::filesystem::path& folder, const bench::Json& document,
                        const std::vector<bench::SectionResult>& results, BenchContext& context);

}  // namespace mpm::app

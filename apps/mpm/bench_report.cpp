// What `mpm bench --out` writes: the document, a table a file, a report, and the roofline figure.

#include <algorithm>
#include <cmath>
#include <map>

#include "mpm/bench_sections.hpp"
#include "render/plot.hpp"
#include "support/files.hpp"

namespace mpm::app {
namespace {

/// The lower of the two roofs over the range of intensities.
render::Series roof(const MachineLimits::OfThreads& limits, double from, double to) {
  render::Series series;
  series.label = std::to_string(limits.threads) + (limits.threads == 1 ? " thread" : " threads");
  series.kind = render::SeriesKind::exact;
  const double ridge = limits.gflops_float / limits.memory.update;
  for (const double x : {from, std::clamp(ridge, from, to), to}) {
    series.x.push_back(x);
    series.y.push_back(std::min(limits.gflops_float, x * limits.memory.update));
  }
  return series;
}

void write_roofline(const std::filesystem::path& folder, BenchContext& context) {
  if (context.roofline.empty()) return;
  const MachineLimits& limits = context.limits();
  render::Plot plot;
  plot.title = "Roofline: the cube in float under the roofs of this machine";
  plot.x_label = "arithmetic intensity (flop/byte)";
  plot.y_label = "arithmetic rate (GFLOP/s)";
  plot.footnote =
      "roofs: update in place of memory, multiply-adds of the widest vectors; flop and bytes a "
      "particle-step are counted, rates are measured";
  plot.log_x = plot.log_y = true;
  double least = 1e9, most = 0;
  for (const RooflinePoint& point : context.roofline) {
    least = std::min(least, point.flops_per_byte);
    most = std::max(most, point.flops_per_byte);
  }
  const double ridge = limits.all.gflops_float / limits.all.memory.update;
  const double from = 0.7 * least, to = 1.4 * std::max(most, ridge);
  plot.series.push_back(roof(limits.one, from, to));
  if (context.threads > 1) plot.series.push_back(roof(limits.all, from, to));
  // Names stand in the legend: beside the points, which crowd, they would lie on one another.
  for (const RooflinePoint& point : context.roofline)
    plot.series.push_back({point.name, {point.flops_per_byte}, {point.gflops}, {}, render::SeriesKind::point, {}});
  render::write_figure(plot, folder / "roofline");
}

std::string report_text(const bench::Json& document, const std::vector<bench::SectionResult>& results) {
  std::string text = "# Benchmark report\n\nCommand: `" + document.at("command").get<std::string>() + "`, version " +
                     document.at("version").get<std::string>() + ", rounds: " + document.at("repeats").dump() + ".\n";
  if (document.at("quick").get<bool>()) text += "\n**--quick: the numbers mean nothing.**\n";
  for (const bench::SectionResult& result : results) {
    text += "\n## " + result.name + "\n";
    for (const bench::Table& table : result.tables) text += "\n### " + table.title + "\n\n" + table.markdown();
    if (!result.targets.empty()) text += "\n### Targets\n\n" + bench::target_table(result.targets).markdown();
  }
  return text;
}

}  // namespace

void write_bench_report(const std::filesystem::path& folder, const bench::Json& document,
                        const std::vector<bench::SectionResult>& results, BenchContext& context) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw support::MachineError::from_errno("make the folder", folder, error.value());
  support::write_atomically(folder / "bench.json", document.dump(2) + "\n");
  std::vector<bench::Target> targets;
  for (const bench::SectionResult& result : results) {
    for (const bench::Table& table : result.tables)
      support::write_atomically(folder / (result.name + "_" + table.id + ".csv"), table.csv());
    targets.insert(targets.end(), result.targets.begin(), result.targets.end());
  }
  if (!targets.empty()) support::write_atomically(folder / "targets.csv", bench::target_table(targets).csv());
  support::write_atomically(folder / "report.md", report_text(document, results));
  write_roofline(folder, context);
}

}  // namespace mpm::app

// Section `growth`: what a particle-step costs from 1e5 to 1e7 particles, how much memory they take, what an empty
// domain costs and how long a start takes. Every point runs in a process of its own.

#include <algorithm>
#include <cmath>

#include "mpm/bench_point.hpp"
#include "mpm/bench_sections.hpp"

namespace mpm::app {
namespace {

using bench::Json;

/// A cube that flies through a large domain: at 0.15 cells a step along each axis it is sorted every 7 steps.
Json flying_cube(const BenchContext& context, int side_in_cells, int domain_in_cells) {
  const double cell = 0.0078125 * (context.options.quick ? context.suite.scene("cube_3d").quick : 1);
  const double lower = 8 * cell, upper = lower + side_in_cells * cell, end = domain_in_cells * cell, speed = 11.71875;
  return {{"quick", context.options.quick},
          {"scene", "cube_3d"},
          {"motion", "rest"},
          {"cycle", 14},
          {"set",
           {{"/grid/domain", {{0, 0, 0}, {end, end, end}}},
            {"/bodies/0/geometry/lower", {lower, lower, lower}},
            {"/bodies/0/geometry/upper", {upper, upper, upper}},
            {"/bodies/0/velocity", {speed, speed, speed}},
            {"/gravity", {0, 0, 0}}}}};
}

struct Point {
  std::string name;
  int side, domain;
};

constexpr double megabyte = 1e6;

bench::Table growth_table() {
  return {"growth",
          "Growth (3-D, float, 1 thread, re-sorted every 7 steps)",
          {{"point", "point"},
           {"particles", "particles"},
           {"domain", "domain (cells a side)"},
           {"rate", "rate (M/s)"},
           {"spread", "spread (%)"},
           {"cost", "cost / 1e6"},
           {"particle_memory", "particles (MB)"},
           {"grid_memory", "grid (MB)"},
           {"peak_memory", "peak (MB)"},
           {"memory_over_state", "peak / state"}},
          {},
          "peak: growth of the process's largest resident set since its start. state: position, velocity, C, F. cost: "
          "time a particle-step."};
}

void measure_points(BenchContext& context, bench::SectionResult& result) {
  const bool quick = context.options.quick;
  const std::vector<Point> points = quick ? std::vector<Point>{{"1e6 particles", 12, 64},
                                                               {"1e5 particles", 6, 64},
                                                               {"1e7 particles", 16, 64},
                                                               {"4096 cells", 6, 4096}}
                                          : std::vector<Point>{{"1e6 particles", 50, 256},
                                                               {"1e5 particles", 23, 256},
                                                               {"1e7 particles", 108, 256},
                                                               {"4096 cells", 23, 4096}};
  std::vector<std::unique_ptr<RemotePoint>> remote;
  std::vector<bench::Contender*> contenders;
  for (const Point& point : points) {
    context.say("growth: " + point.name);
    remote.push_back(std::make_unique<RemotePoint>(flying_cube(context, point.side, point.domain)));
    contenders.push_back(remote.back().get());
  }
  context.say("growth: rounds");
  const bench::Rates rates = context.run_in_turns(contenders);
  std::vector<double> peak;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Json report = remote[k]->report();
    const double state = report.at("state_bytes"), resident = report.at("peak_bytes");
    peak.push_back(resident);
    result.tables[0].rows.push_back({points[k].name, static_cast<double>(remote[k]->particle_count()),
                                     static_cast<double>(points[k].domain), rates.rate(k) / 1e6, 100 * rates.spread(k),
                                     rates.ratio(0, k), report.at("particle_bytes").get<double>() / megabyte,
                                     report.at("grid_bytes").get<double>() / megabyte, resident / megabyte,
                                     resident / state});
    if (k == 1 || k == 2)
      result.targets.push_back({"flat " + points[k].name, points[k].name + ": cost differs from that of 1e6 by (%)",
                                100 * std::abs(rates.ratio(0, k) - 1), 15, false});
    if (k == 2)
      result.targets.push_back(
          {"memory", points[k].name + ": peak memory over the state", resident / state, 1.5, false});
  }
  result.targets.push_back(
      {"empty domain time", "4096 cells a side over 256: cost a particle-step", rates.ratio(1, 3), 1.05, false});
  result.targets.push_back(
      {"empty domain memory", "4096 cells a side over 256: peak memory", peak[3] / peak[1], 1.05, false});
}

/// Measures the seconds from the start of the program to the end of the first step. The scene is the deforming one,
/// whose velocities are expressions.
void measure_start(BenchContext& context, bench::SectionResult& result) {
  std::vector<double> seconds;
  for (int round = 0; round < context.protocol.repeats; ++round) {
    context.say("growth: start " + std::to_string(round + 1));
    RemotePoint point(
        {{"quick", context.options.quick}, {"scene", "cube_3d"}, {"motion", "deforming"}, {"set", Json::object()}});
    const Json report = point.report();
    seconds.push_back(report.at(context.protocol.processor_time ? "startup_processor_seconds" : "startup_seconds"));
  }
  bench::Table table{"startup",
                     "Start of the deforming cube: plugins, file, particles, first step (1 thread)",
                     {{"run", "run"}, {"seconds", "seconds"}},
                     {}};
  for (std::size_t k = 0; k < seconds.size(); ++k) table.rows.push_back({static_cast<double>(k + 1), seconds[k]});
  table.rows.push_back({{}, bench::median(seconds)});
  table.note = "Last line: the median.";
  result.tables.push_back(std::move(table));
  result.targets.push_back(
      {"startup", "1e6 particles: start to the first step done (s)", bench::median(seconds), 2, false});
}

}  // namespace

bench::SectionResult bench_growth(BenchContext& context) {
  bench::SectionResult result{"growth", {growth_table()}, {}};
  measure_points(context, result);
  measure_start(context, result);
  return result;
}

}  // namespace mpm::app

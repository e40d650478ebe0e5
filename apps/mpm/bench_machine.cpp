// Section `machine`: what the processor and its memory can do at best.

#include "mpm/bench_sections.hpp"
#include "output/manifest.hpp"

namespace mpm::app {

const MachineLimits& BenchContext::limits() {
  if (limits_) return *limits_;
  say("machine: peak and memory");
  const int windows = options.quick ? 5 : 200;
  const std::size_t bytes = options.quick ? std::size_t{16} << 20 : std::size_t{512} << 20;
  const auto measure = [&](int count) {
    return MachineLimits::OfThreads{count, bench::peak_gflops(true, count, windows),
                                    bench::peak_gflops(false, count, windows),
                                    bench::memory_bandwidth(count, bytes, options.quick ? 1 : 4)};
  };
  limits_ = MachineLimits{measure(1), measure(threads)};
  return *limits_;
}

bench::SectionResult bench_machine(BenchContext& context) {
  const MachineLimits& limits = context.limits();
  const auto machine = output::machine_description();
  bench::Table properties{"properties", "Machine", {{"property", "property"}, {"value", "value"}}, {}};
  for (const char* key : {"cpu", "cores", "os", "compiler"})
    if (machine.contains(key))
      properties.rows.push_back(
          {std::string(key), machine[key].is_string() ? machine[key].get<std::string>() : machine[key].dump()});
  properties.rows.push_back({std::string("vectors of the build"),
                             std::string(bench::instruction_set()) + ", " + std::to_string(bench::lanes_of_float()) +
                                 " float or " + std::to_string(bench::lanes_of_double()) + " double lanes"});

  bench::Table peaks{"peaks",
                     "Peaks (best of many short windows)",
                     {{"threads", "threads"},
                      {"gflops_float", "FMA float (GFLOP/s)"},
                      {"gflops_double", "FMA double (GFLOP/s)"},
                      {"triad", "triad (GB/s)"},
                      {"update", "update in place (GB/s)"},
                      {"read", "read (GB/s)"}},
                     {}};
  for (const MachineLimits::OfThreads* of : {&limits.one, &limits.all}) {
    if (of == &limits.all && context.threads == 1) continue;
    peaks.rows.push_back({static_cast<double>(of->threads), of->gflops_float, of->gflops_double, of->memory.triad,
                          of->memory.update, of->memory.read});
  }
  return {"machine", {std::move(properties), std::move(peaks)}, {}};
}

}  // namespace mpm::app

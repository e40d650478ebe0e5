// Section `required`: what a scene holds and does for what it asks, counted.

#include <unistd.h>

#include <filesystem>

#include "bench/counting/required.hpp"
#include "mpm/bench_sections.hpp"
#include "run/recorder.hpp"

namespace mpm::app {

namespace {

/// A temporary folder that goes away with this object.
struct Scratch {
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("mpm_bench_" + std::to_string(getpid()));
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

}  // namespace

bench::SectionResult bench_required(BenchContext& context) {
  context.say("required: bytes, passes, calls and instructions");
  bench::Table table{
      "required",
      "What is paid for what is asked (3-D float, MLS, Neo-Hookean; instructions: 2-D)",
      {{"scene", "scene"},
       {"bytes_per_particle", "bytes a particle"},
       {"bytes_per_node", "bytes a node"},
       {"passes", "passes a step"},
       {"calls", "plugin calls a step"},
       {"instructions", "instructions a particle-step"}},
      {},
      "Counted, not timed: by wrapping the plugins' tables, and by stepping one machine instruction at a "
      "time. The C library's own take a few hundred more or less. \"-\": this machine does not let a "
      "program be stepped."};
  std::vector<bench::Target> targets;
  const Scratch scratch;
  const std::vector<counting::RequiredRow> rows =
      counting::count_required(context.suite.registry(), counting::required_scenes(), recording_in(scratch.path));
  for (const counting::RequiredRow& row : rows) {
    long calls = 0;
    for (const auto& [what, count] : row.calls)
      if (what.find(':') == std::string::npos) calls += count;
    const auto instructions = row.instructions_per_particle_step();
    table.rows.push_back({row.name, static_cast<double>(row.bytes_per_particle),
                          static_cast<double>(row.bytes_per_node), static_cast<double>(row.passes.size()),
                          static_cast<double>(calls) / static_cast<double>(row.steps),
                          instructions ? bench::Cell(*instructions) : bench::Cell()});
  }
  return {"required", {std::move(table)}, std::move(targets)};
}

}  // namespace mpm::app

// mpm_micro, the micro-benchmarks, as a smoke test: it measures every plugin and kernel, for a moment each. Where
// Google Benchmark is not installed the program is not built and the test says so.

#include <algorithm>

#include "cli/program.hpp"
#include "plugin/registry.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr const char* micro = MPM_BUILD_DIR "/bin/mpm_micro";

bool built() {
  if (fs::is_regular_file(micro)) return true;
  WARN("skipped: mpm_micro was not built; it needs Google Benchmark (apt install libbenchmark-dev)");
  return false;
}

Result run_micro(const Folder& folder, Words words) {
  words.insert(words.begin(), micro);
  return Process(folder, words).finish();
}

/// All measurements, made for a moment each.
const Json& measured() {
  static const Json all = [] {
    const Folder folder;
    const Result result = run_micro(folder, {"--benchmark_min_time=0.001", "--benchmark_format=json"});
    INFO(result.err);
    REQUIRE(result.code == 0);
    CHECK(!has(result.err, "left out"));
    Json parsed = Json::parse(result.out, nullptr, false);
    REQUIRE(!parsed.is_discarded());
    return parsed.at("benchmarks");
  }();
  return all;
}

std::size_t count_of(const std::string& beginning) {
  const Json& all = measured();
  return static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [&](const Json& benchmark) {
    return benchmark.at("name").get<std::string>().starts_with(beginning);
  }));
}

}  // namespace

TEST_CASE("mpm_micro measures every plugin in every dimension and precision it declares") {
  if (!built()) return;
  const Registry registry = Registry::from_folders(Registry::default_folders());
  REQUIRE(registry.plugins().size() >= 16);
  const std::size_t entries[] = {2, 2, 1, 1, 1, 1, 5};  // shape, transfer, filter, contact, normal, detection, material
  for (const Plugin& plugin : registry.plugins()) {
    const mpm_kind kind = static_cast<mpm_kind>(plugin.descriptor->kind);
    const auto order =
        static_cast<std::size_t>(std::find(all_kinds().begin(), all_kinds().end(), kind) - all_kinds().begin());
    for (const int dimension : {2, 3})
      for (const bool single : {true, false}) {
        const bool runs = (plugin.descriptor->dimensions & (dimension == 2 ? MPM_2D : MPM_3D)) &&
                          (plugin.descriptor->precisions & (1U << (single ? MPM_LANES_FLOAT : MPM_LANES_DOUBLE)));
        const bool in_batches = kind != MPM_NORMAL || !(plugin.normal().traits & MPM_LOOKS_AT_POINTS);
        const std::string name = std::string(kind_name(kind)) + "/" + std::string(plugin.id()) + "/" +
                                 std::to_string(dimension) + "-D/" + (single ? "float/" : "double/");
        INFO(name);
        CHECK(count_of(name) == (runs && in_batches ? entries[order] : 0));
      }
  }
}

TEST_CASE("mpm_micro measures the kernels of the host") {
  if (!built()) return;
  CHECK(count_of("tile/scatter/") == 4 * 12);  // dimensions and precisions; widths, affine, gradient
  CHECK(count_of("tile/gather/") == 4 * 12);
  CHECK(count_of("quads/") == 4);
  CHECK(count_of("function/nearest_rotation/") == 4);
  CHECK(count_of("function/polar_rotation/") == 4);
  CHECK(count_of("function/log/") == 2);
}

TEST_CASE("no micro-benchmark fails, and each has a time an item") {
  if (!built()) return;
  for (const Json& benchmark : measured()) {
    INFO(benchmark.dump());
    CHECK(!benchmark.contains("error_occurred"));
    CHECK(!benchmark.contains("error_message"));
    CHECK(benchmark.at("cpu_time").get<double>() > 0);
    CHECK(benchmark.at("items_per_second").get<double>() > 0);
    double an_item = 0;
    for (const auto& [key, value] : benchmark.items())
      if (key.starts_with("per_") && value.is_number_float()) an_item = value.get<double>();
    // A call handles 64 items: the two numbers say the same.
    CHECK(an_item * benchmark.at("items_per_second").get<double>() == Approx(1).epsilon(1e-6));
  }
}

TEST_CASE("mpm_micro refuses what it does not know") {
  if (!built()) return;
  const Folder folder;
  const Result option = run_micro(folder, {"--no_such_option"});
  CHECK(option.code == 2);
  CHECK(has(option.err, "no_such_option"));
  const Result name = run_micro(folder, {"--benchmark_filter=no_such_benchmark"});
  CHECK(name.code == 2);
  CHECK(has(name.err, "--benchmark_list_tests"));
  for (const char* time : {"--benchmark_min_time=0.001", "--benchmark_min_time=0.001s"}) {
    const Result result = run_micro(folder, {time, "--benchmark_filter=material/neo_hookean/2-D/float/stress"});
    INFO(time << result.err);
    CHECK(result.code == 0);
    CHECK(has(result.out, "per_particle="));
  }
}

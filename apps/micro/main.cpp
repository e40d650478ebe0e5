// mpm_micro: what one call of a plugin or of a kernel costs. Options are those of Google Benchmark.

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "micro.hpp"

namespace mpm::micro {

int& failures() {
  static int count = 0;
  return count;
}

namespace {

/// The argument as the library wants it: --benchmark_min_time takes seconds with and without a unit, whichever way the
/// library spells them.
std::string with_min_time_of_library(std::string argument) {
  constexpr std::string_view name = "--benchmark_min_time=";
  if (!argument.starts_with(name)) return argument;
#if defined(MPM_MIN_TIME_HAS_UNIT)
  if (!argument.ends_with('s') && !argument.ends_with('x')) argument += 's';
#else
  if (argument.ends_with('s')) argument.pop_back();
#endif
  return argument;
}

int run(int argc, char** argv) {
  std::vector<std::string> words;
  for (int k = 0; k < argc; ++k) words.push_back(with_min_time_of_library(argv[k]));
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  benchmark::Initialize(&argc, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(argc, pointers.data())) return 2;

  const Registry registry = Registry::from_folders(Registry::default_folders());
  for (const std::string& rejected : registry.rejected()) std::fprintf(stderr, "left out: %s\n", rejected.c_str());
  if (registry.plugins().empty()) {
    std::fprintf(stderr, "no plugin was found beside this program; build them: ./mpm build plugins\n");
    return 5;
  }
  add_plugins(registry);
  add_tiles();
  add_functions();
  const std::size_t count = benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  if (count == 0) {
    std::fprintf(stderr, "no benchmark has such a name; --benchmark_list_tests lists them\n");
    return 2;
  }
  if (failures() > 0) std::fprintf(stderr, "%d benchmarks failed; see their lines\n", failures());
  return failures() > 0 ? 3 : 0;
}

}  // namespace
}  // namespace mpm::micro

int main(int argc, char** argv) {
  return mpm::micro::run(argc, argv);
}

// docs/writing_a_plugin.md, followed literally: every block of commands is run as it stands, and what the page says is
// printed is looked for in what was.

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

struct Step {
  std::string commands;
  std::vector<std::string> expected;  ///< lines of the block ```text that follows
};

/// The blocks marked sh, each with the expectation that follows it.
std::vector<Step> steps_of(const fs::path& page) {
  std::vector<Step> steps;
  std::istringstream lines(slurp(page));
  std::string block;
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) {
      inside = !inside;
      block = inside ? line.substr(3) : "";
      if (block == "sh") steps.emplace_back();
    } else if (block == "sh") {
      steps.back().commands += line + "\n";
    } else if (block == "text" && !steps.empty()) {
      steps.back().expected.push_back(line);
    }
  }
  return steps;
}

/// Whether some line of the text holds the parts of `pattern` between "…", in order.
bool holds(const std::string& text, const std::string& pattern) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::size_t at = 0;
    bool found = true;
    const std::string mark = "…";
    for (std::size_t begin = 0; found && begin <= pattern.size();) {
      const std::size_t end = std::min(pattern.find(mark, begin), pattern.size());
      const std::string part = pattern.substr(begin, end - begin);
      const std::size_t place = line.find(part, at);
      found = place != std::string::npos;
      at = place + part.size();
      begin = end + mark.size();
    }
    if (found) return true;
  }
  return false;
}

/// The environment of the script: strict, and compiling quickly; it, not the projects, asks for less optimisation.
constexpr const char* preamble =
    "set -eu\n"
    "export CMAKE_BUILD_TYPE=Quick CXXFLAGS=-O1\n";

/// The script of all steps. One shell runs them, so that what a block exports holds for the next, and stops at the
/// first that fails.
std::string script_of(const std::vector<Step>& steps) {
  std::string script = preamble + std::string("PATH='" MPM_BUILD_DIR "/bin':$PATH\n");
  for (std::size_t k = 0; k < steps.size(); ++k)
    script += "exec >step" + std::to_string(k) + ".log 2>&1\n" + steps[k].commands;
  return script;
}

}  // namespace

TEST_CASE("the page on writing a plugin, followed word for word in a folder with a space in its name") {
  const fs::path page = MPM_SOURCE_DIR "/docs/writing_a_plugin.md";
  const std::vector<Step> steps = steps_of(page);
  REQUIRE(steps.size() >= 9);
  const Folder folder;
  const fs::path scratch = folder / "a scratch folder";
  fs::create_directory(scratch);
  spill(folder / "steps.sh", script_of(steps));
  const Result result = Process(folder, {"/bin/sh", "-c", "cd 'a scratch folder' && . ../steps.sh"}).finish();
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const fs::path log = scratch / ("step" + std::to_string(k) + ".log");
    const std::string text = slurp(log);
    INFO(steps[k].commands << "\nprinted\n" << text);
    REQUIRE(fs::exists(log));
    CHECK(!steps[k].expected.empty());
    for (const std::string& line : steps[k].expected) {
      INFO("expected: " << line);
      CHECK(holds(text, line));
    }
  }
  CHECK(result.code == 0);

  // The page makes claims of the files, and of what ran on the three ways to compute.
  const auto lines = [&](const std::string& name) {
    const std::string text = slurp(scratch / "my_rubber" / name);
    return std::count(text.begin(), text.end(), '\n');
  };
  CHECK(lines("my_rubber.hpp") + lines("my_rubber.cpp") < 60);
  const double oracle = json_in(scratch / "runs/reference/summary.json")["energy"]["total"]["final"];
  CHECK(oracle > 0);
  CHECK(json_in(scratch / "runs/cpu/summary.json")["energy"]["total"]["final"] == Approx(oracle).epsilon(1e-9));
  CHECK(json_in(scratch / "runs/cpu_float/summary.json")["energy"]["total"]["final"] == Approx(oracle).epsilon(1e-3));
  CHECK(json_in(scratch / "runs/cpu_float/experiment.json")["precision"] == "float");
}

TEST_CASE("an installed sandbox writes, builds and tests plugins without its sources") {
  const Folder folder;
  const std::string commands =
      preamble + std::string("cmake --install '" MPM_BUILD_DIR
                             "' --prefix \"$PWD/an installed one\" >/dev/null\n"
                             "PATH=\"$PWD/an installed one/bin:$PATH\"\n"
                             "mpm list | grep neo_hookean\n"
                             "mpm new material soft soft\n"
                             "cmake -G Ninja -S soft -B soft/build\n"
                             "cmake --build soft/build\n"
                             "ctest --test-dir soft/build --output-on-failure\n"
                             "MPM_PLUGIN_PATH=soft/build/plugins mpm check soft/soft.json\n"
                             "MPM_PLUGIN_PATH=soft/build/plugins mpm run soft/soft.json --out run "
                             "--set /output/ledger=false --set /solver/end_time=0.01\n"
                             "! grep -rF '" MPM_SOURCE_DIR
                             "' soft 'an installed one/lib/cmake' 'an installed one/include'\n"
                             "ls 'an installed one/include/mpm/plugin'\n");
  const Result result = Process(folder, {"/bin/sh", "-c", commands}).finish();
  INFO(result.out << result.err);
  CHECK(result.code == 0);
  CHECK(has(result.out, "100% tests passed"));
  CHECK(has(result.out, "soft/soft.json: ok"));
  // The plugin's operations are counted without a word of it in the sandbox.
  CHECK(json_in(folder / "run/summary.json")["performance"]["flops"].is_number());
  CHECK(has(result.out, "abi.h\nextensions.h\nsdk\nsdk.hpp\ntables.hpp\n"));
}

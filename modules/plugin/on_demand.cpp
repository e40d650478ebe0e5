#include "plugin/on_demand.hpp"

#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "plugin/registry.hpp"

namespace mpm {
namespace {

namespace fs = std::filesystem;

fs::path program_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path(".") : program.parent_path();
}

/// The exit status of a command, or -1 where a signal ends it. Throws NotBuilt where it does not start.
int status_of(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (const int error = posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ))
    throw NotBuilt("cannot start " + words[0] + " " + words[1] + ": " + std::generic_category().message(error));
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

std::vector<fs::path> folders_beside_program(std::string_view name) {
  const fs::path program = program_folder();
  return {program / name, program.parent_path() / name, program.parent_path() / "lib" / "mpm" / name};
}

std::string PluginTarget::name() const {
  return std::string(kind_name(kind)) + "_" + id;
}

std::vector<PluginTarget> plugins_not_built() {
  const fs::path build = program_folder().parent_path();
  std::ifstream list(build / "on_demand");
  std::vector<PluginTarget> missing;
  std::error_code error;
  for (std::string target, file; list >> target >> file;) {
    if (fs::exists(build / file, error)) continue;
    for (const mpm_kind kind : all_kinds())
      if (const std::string start = std::string(kind_name(kind)) + "_"; target.starts_with(start))
        missing.push_back({kind, target.substr(start.size())});
  }
  return missing;
}

void build_missing(const std::vector<std::string>& targets) {
  std::string names;
  for (const std::string& target : targets) names += (names.empty() ? "" : " ") + target;
  const char* launcher = std::getenv("MPM_LAUNCHER");
  if (!launcher || !*launcher)
    throw NotBuilt("not built yet: " + names + "; `./mpm build` builds everything, and `./mpm run` what it needs");
  std::vector<std::string> words{"bash", launcher, "needed"};  // it need not be executable
  words.insert(words.end(), targets.begin(), targets.end());
  if (status_of(std::move(words)) != 0)
    throw NotBuilt("could not be built: " + names + "; see the lines above, then call again");
}

}  // namespace mpm

#include "plugin/on_demand.hpp"

#include <spawn.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <csignal>
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

/// While it lives, the signals that end this program go to all that a command has started as well: a compiler that nobody
/// waits for would go on for minutes. Afterwards this program takes them as it would have.
class SignalsPassedOn {
 public:
  SignalsPassedOn() {
    group_ = 0;
    received_ = 0;
    struct sigaction action {};
    action.sa_handler = [](int signal) {
      received_ = signal;
      tell(signal);
    };
    for (std::size_t k = 0; k < signals.size(); ++k) {
      sigaction(signals[k], nullptr, &before_[k]);
      if (before_[k].sa_handler != SIG_IGN) sigaction(signals[k], &action, nullptr);
    }
  }
  ~SignalsPassedOn() {
    for (std::size_t k = 0; k < signals.size(); ++k) sigaction(signals[k], &before_[k], nullptr);
    if (received_) raise(received_);
  }
  SignalsPassedOn(const SignalsPassedOn&) = delete;
  SignalsPassedOn& operator=(const SignalsPassedOn&) = delete;

  /// Takes the group of processes that the command is in.
  void to(pid_t group) {
    group_ = group;
    if (received_) tell(received_);
  }

 private:
  static constexpr std::array signals{SIGHUP, SIGINT, SIGTERM};
  static void tell(int signal) {
    if (group_ > 0) kill(-group_, signal);
  }
  static inline volatile std::sig_atomic_t group_ = 0, received_ = 0;
  std::array<struct sigaction, signals.size()> before_{};
};

/// The exit status of a command, which gets a group of processes of its own, or -1 where a signal ends it. Throws NotBuilt
/// where it does not start.
int status_of(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  SignalsPassedOn passed_on;
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], nullptr, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  if (error)
    throw NotBuilt("cannot start " + words[0] + " " + words[1] + ": " + std::generic_category().message(error));
  passed_on.to(child);
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

#include "backends/device/drivers/host_compiler.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "support/files.hpp"

extern char** environ;

namespace mpm::device {
namespace {

/// A folder of its own under the system's folder for temporary files, which is removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "mpm_device_XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw support::MachineError::from_errno("create the folder", pattern, errno);
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Runs a program found on PATH with its output in `log`; returns its exit status, or 128 and the signal that ended it, as
/// shells do. Throws CompilerError when there is no such program, and where this process is not told how it ended.
int run_program(const std::vector<std::string>& words, const std::filesystem::path& log) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error)
    throw MissingCompiler("no C++ compiler: cannot start \"" + words[0] + "\": " + std::strerror(error) +
                          "; install g++ (Debian: apt install g++)");
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR)
      throw CompilerError("it is not known how \"" + words[0] +
                          "\" ended, as this process ignores SIGCHLD; set it to SIG_DFL");
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::vector<std::string> HostCompiler::all_options() const {
  // The text sees the compiler's own functions only, as it does with NVRTC.
  std::vector<std::string> all{"-std=c++17", "-DMPM_DEVICE_PASS=1", "-nostdinc",         "-nostdinc++",
                               "-fPIC",      "-fno-math-errno",     "-fno-trapping-math"};
  all.push_back("-fno-delete-null-pointer-checks");  // or GCC 12 drops calls (modules/MpmBuild.cmake)
  all.insert(all.end(), options.begin(), options.end());
  // The compiler alone is told of it: the composition has what the linker would take from the sanitizer's library.
  if (records) all.insert(all.end(), {"-DMPM_RECORD=1", "-fsanitize=thread"});
  return all;
}

std::string HostCompiler::compile(const Composition& composition) const {
  const ScratchFolder folder;
  const std::filesystem::path source = folder.path() / "composition.cpp", object = folder.path() / "composition.o",
                              library = folder.path() / "composition.so", log = folder.path() / "messages.txt";
  support::write_atomically(source, composition.text, support::Durability::of_program);
  const auto call = [&](std::vector<std::string> words, const std::filesystem::path& from, const char* option,
                        const std::filesystem::path& to) {
    words.insert(words.end(), {option, from.string(), "-o", to.string(), "-lm"});
    if (const int status = run_program(words, log); status != 0)
      throw CompilerError("\"" + program + "\" does not compile the composition " + composition.name + " (status " +
                          std::to_string(status) + "):\n" + support::read_file(log));
  };
  std::vector<std::string> words{program};
  for (const std::string& option : all_options()) words.push_back(option);
  call(words, source, "-c", object);
  call({program}, object, "-shared", library);
  return support::read_file(library);
}

std::string HostCompiler::version() const {
  const ScratchFolder folder;
  const std::filesystem::path log = folder.path() / "messages.txt";
  if (const int status = run_program({program, "--version"}, log); status != 0)
    throw CompilerError("\"" + program + " --version\" ends with status " + std::to_string(status));
  const std::string text = support::read_file(log);
  return text.substr(0, text.find('\n'));
}

}  // namespace mpm::device

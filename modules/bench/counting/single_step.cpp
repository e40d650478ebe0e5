#include "bench/counting/single_step.hpp"

#include <signal.h>
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace mpm::counting {
namespace {

constexpr int refused = 77;

[[noreturn]] void run_traced(const std::function<void()>& prepare, const std::function<void()>& counted) {
  if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(refused);
  try {
    prepare();
    raise(SIGSTOP);
    counted();
    raise(SIGSTOP);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "the counted process failed: %s\n", error.what());
    _exit(1);
  }
  _exit(0);
}

bool stopped_by(int status, int signal) {
  return WIFSTOPPED(status) && WSTOPSIG(status) == signal;
}

using Ranges = std::vector<std::pair<unsigned long, unsigned long>>;

/// Where the C library lies, in this process and those forked from it.
Ranges c_library() {
  Ranges ranges;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    for (const char* name : {"/libc.so", "/libc-", "/ld-linux", "/libpthread", "[vdso]"}) {
      unsigned long first = 0, last = 0;
      if (line.find(name) != std::string::npos && std::sscanf(line.c_str(), "%lx-%lx", &first, &last) == 2)
        ranges.emplace_back(first, last);
    }
  return ranges;
}

unsigned long place_of(pid_t child) {
#if defined(__x86_64__)
  return static_cast<unsigned long>(ptrace(PTRACE_PEEKUSER, child, offsetof(user_regs_struct, rip), nullptr));
#else
  return 0;
#endif
}

/// Single-steps the child to its second SIGSTOP.
std::optional<Instructions> step_through(pid_t child, const Ranges& foreign) {
  int status = 0;
  if (waitpid(child, &status, 0) != child || !stopped_by(status, SIGSTOP)) return std::nullopt;
  for (Instructions count;; ++count.all) {
    const unsigned long place = place_of(child);
    const bool own = std::none_of(foreign.begin(), foreign.end(),
                                  [&](const auto& range) { return place >= range.first && place < range.second; });
    count.own += own;
    if (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) != 0) return std::nullopt;
    if (waitpid(child, &status, 0) != child || !WIFSTOPPED(status)) return std::nullopt;
    if (stopped_by(status, SIGSTOP)) return count;
    if (!stopped_by(status, SIGTRAP)) return std::nullopt;
  }
}

}  // namespace

std::optional<Instructions> count_instructions(const std::function<void()>& prepare,
                                               const std::function<void()>& counted) {
  const Ranges foreign = c_library();
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) return std::nullopt;
  if (child == 0) run_traced(prepare, counted);
  const std::optional<Instructions> count = step_through(child, foreign);
  kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) == child && !WIFEXITED(status) && !WIFSIGNALED(status)) {
  }
  return count;
}

}  // namespace mpm::counting

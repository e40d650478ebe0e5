#include "counting/single_step.hpp"

#include <signal.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <exception>

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

/// Steps to the second SIGSTOP.
std::optional<long> step_through(pid_t child) {
  int status = 0;
  if (waitpid(child, &status, 0) != child || !stopped_by(status, SIGSTOP)) return std::nullopt;
  for (long count = 1;; ++count) {
    if (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) != 0) return std::nullopt;
    if (waitpid(child, &status, 0) != child || !WIFSTOPPED(status)) return std::nullopt;
    if (stopped_by(status, SIGSTOP)) return count;
    if (!stopped_by(status, SIGTRAP)) return std::nullopt;
  }
}

}  // namespace

std::optional<long> count_instructions(const std::function<void()>& prepare, const std::function<void()>& counted) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) return std::nullopt;
  if (child == 0) run_traced(prepare, counted);
  const std::optional<long> count = step_through(child);
  kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) == child && !WIFEXITED(status) && !WIFSIGNALED(status)) {
  }
  return count;
}

}  // namespace mpm::counting

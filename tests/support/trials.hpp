// Thousands of changed programs tried from one place of a case on, for tests/mutation: what a case does before that place,
// as computing what the reference backend says, is done once for all of them.
#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

/// Makes this process another changed program. It is there only where the program holds mutants (tests/mutation/together.py).
extern "C" __attribute__((weak)) void mpm_become_mutant(int number);

namespace mpm::test {

/// Where the environment's MPM_MUTANTS names a file of numbers, the rest of this process is done by a child for each number:
/// the mutant that MPM_MUTANT tells it, MPM_MUTANTS_AT_ONCE of them at a time. A line of the file MPM_MUTANTS_ENDED says how each
/// has ended, as waitpid tells it, and this process ends with 0. A child may take MPM_MUTANT_SECONDS of processor time, a whole
/// number, and as much time of a clock as fifteen times that. Elsewhere, and in the children, nothing happens.
inline void begin_trials() {
  static bool begun = false;
  const char* const listed = std::getenv("MPM_MUTANTS");
  if (begun || !listed) return;
  begun = true;
  std::ifstream numbers(listed);
  std::ofstream ended(std::getenv("MPM_MUTANTS_ENDED"));
  const auto seconds = static_cast<unsigned>(std::atoi(std::getenv("MPM_MUTANT_SECONDS")));
  const auto at_once = static_cast<std::size_t>(std::atoi(std::getenv("MPM_MUTANTS_AT_ONCE")));
  std::map<pid_t, int> running;
  const auto wait_for_one = [&] {
    int status = -1;
    const pid_t child = wait(&status);
    if (child < 0) _exit(3);
    ended << running.at(child) << ' ' << status << std::endl;
    running.erase(child);
  };
  for (int number = 0; numbers >> number;) {
    if (running.size() >= at_once) wait_for_one();
    const pid_t child = fork();
    if (child < 0) _exit(3);
    if (child == 0) {
      setenv("MPM_MUTANT", std::to_string(number).c_str(), 1);
      if (mpm_become_mutant) mpm_become_mutant(number);
      const rlimit most{seconds, seconds};  // a child begins with no processor time taken
      setrlimit(RLIMIT_CPU, &most);
      alarm(15 * seconds);
      return;
    }
    running.emplace(child, number);
  }
  while (!running.empty()) wait_for_one();
  _exit(0);
}

}  // namespace mpm::test

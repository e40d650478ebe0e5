#include <unistd.h>

#include <cstdlib>

#include "mpm/cli.hpp"

namespace {

/// The OpenMP library reads when it is loaded how long a thread that waits for others spins before it sleeps, so the
/// program begins once more with that said. By default it spins for milliseconds: beside one busy program on two
/// processors, threads then spend their time waiting for the one that has no processor. A user's own settings stand.
void wait_briefly(char** argv) {
  constexpr const char* spins = "5000";
  if (std::getenv("OMP_WAIT_POLICY") || std::getenv("GOMP_SPINCOUNT")) return;
  if (setenv("GOMP_SPINCOUNT", spins, 1) == 0) execv("/proc/self/exe", argv);
}

}  // namespace

int main(int argc, char** argv) {
  wait_briefly(argv);
  return mpm::app::run_command_line(argc, argv);
}

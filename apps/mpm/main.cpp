#include <csignal>

#include "mpm/cli.hpp"

int main(int argc, char** argv) {
  std::signal(SIGCHLD, SIG_DFL);  // compilers and builds say how they end, also where the caller ignores its children
  return mpm::app::run_command_line(argc, argv);
}

#include "mpm/cli.hpp"

int main(int argc, char** argv) {
  return mpm::app::run_command_line(argc, argv);
}

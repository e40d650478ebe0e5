// One check out of a case that makes hundreds, for tests/mutation, which tries thousands of changed programs.
#pragma once

#include <cstdlib>
#include <fstream>

namespace mpm::test {

/// Whether the next check of this process is to be made. All are made but where the environment's MPM_CHECK is a number,
/// which chooses that check alone, counted from 1 (the process then runs one case), and where MPM_CHECKS_COUNTED names a
/// file, which takes a byte for each check, of which none is made.
inline bool is_chosen_check() {
  static int count = 0;
  ++count;
  if (const char* const counted = std::getenv("MPM_CHECKS_COUNTED")) {
    std::ofstream(counted, std::ios::app).put('.');
    return false;
  }
  const char* const chosen = std::getenv("MPM_CHECK");
  return !chosen || std::atoi(chosen) == count;
}

/// Whether this process makes all checks, so that what they need is worth making beforehand.
inline bool makes_all_checks() {
  return !std::getenv("MPM_CHECK") && !std::getenv("MPM_CHECKS_COUNTED");
}

}  // namespace mpm::test

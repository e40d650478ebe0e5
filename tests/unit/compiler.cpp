// What the compiler makes of plain loops. Tests are compiled with -O1, with which GCC 12 drops the call below unless it is told
// that null may be stored to (modules/MpmBuild.cmake): it finds the function pure, as its loop stores relative to a
// null pointer once it has been rewritten.

#include "support/catch.hpp"

namespace {

struct Work {
  double to[4 * 32]{};
  double from[4 * 16]{};
};

[[gnu::noinline]] void keep(Work& work, int first, int lane) {
  for (int c = 0; c < 4; ++c) work.to[c * 32 + first + lane] = work.from[c * 16 + lane];
}

}  // namespace

TEST_CASE("a call that does nothing but store in a loop is not dropped", "[compiler]") {
  Work work;
  for (double& value : work.from) value = 1;
  for (int lane = 0; lane < 16; ++lane) keep(work, 16, lane);
  double sum = 0;
  for (const double value : work.to) sum += value;
  CHECK(sum == 4 * 16);
}

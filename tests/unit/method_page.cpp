// docs/method.md prints how long a step each shape stands: the numbers are those that the shapes state.

#include <array>
#include <string>
#include <vector>

#include "plugin/extension_of.hpp"
#include "support/catch.hpp"
#include "support/page.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("the largest Courant numbers on the page of the method are those of the shapes", "[docs][largest_step]") {
  const Page page("docs/method.md");
  int shapes = 0;
  for (const Plugin* shape : plugins().of_kind(MPM_SHAPE)) {
    const auto* states = extension_of<mpm_shape_courant_limit>(*shape);
    REQUIRE(states != nullptr);
    INFO(shape->id());
    const auto printed = page.read("| `" + std::string(shape->id()) + "` | # · # | # · # | # · # |");
    for (const int dimension : {2, 3})
      for (int velocity = 0; velocity < MPM_STRAIN_VELOCITIES; ++velocity) {
        INFO(dimension << "-D, column " << velocity);
        CHECK(states->limit[dimension - 2][velocity] ==
              Approx(printed.at(static_cast<std::size_t>(2 * velocity + dimension - 2)).value).epsilon(1e-12));
      }
    ++shapes;
  }
  CHECK(shapes == 8);
}

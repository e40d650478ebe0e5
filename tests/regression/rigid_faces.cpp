// How much a flat rigid face gives way: numbers of docs/contact.md and docs/method.md. They are the program's own, and show
// what has changed; the force of the plates is in tests/verification/rigid_bodies.cpp.

#include "support/catch.hpp"
#include "support/larger.hpp"
#include "support/page.hpp"
#include "support/scene.hpp"
#include "verification/rigid_column.hpp"

namespace mpm::test::rigid_column {

// A column between two plates, at eight places between two nodes. What a straight line through the displacements of the column's inner part has
// at its two faces, beside where the plates are, is what the plates give way by.
TEST_CASE("a flat rigid face gives way by a share of a cell's strain, by its place between nodes, as the pages say",
          "[rigid][docs]") {
  const double cell = 0.05, down = 0.002;
  double least = 1, most = 0, mean = 0;
  for (int place = 0; place < 8; ++place) {
    const double lower = -0.5 - cell * place / 8;
    Scene scene(column, {set("/bodies/0/seeding", "fitted"), R"J(/damping={"viscous": 30})J",
                         R"J(/rigid_bodies/1/velocity=[0, "t < 0.1 ? -0.02 : 0"])J",
                         "/grid/domain=[[0, " + digits(lower) + "], [0.2, " + digits(lower + 2) + "]]",
                         "/solver/end_time=0.4"});
    const std::vector<double> start = scene.body(0).position;
    scene.run();
    const std::vector<double> end = scene.body(0).position;
    double count = 0, sums[2] = {}, products[2] = {};  // of Y and of u; of Y Y and of Y u
    for (std::size_t k = 1; k < start.size(); k += 2) {
      const double Y = start[k], u = end[k] - Y;
      if (Y < 0.2 || Y > 0.8) continue;
      count += 1, sums[0] += Y, sums[1] += u, products[0] += Y * Y, products[1] += Y * u;
    }
    const double slope = (count * products[1] - sums[0] * sums[1]) / (count * products[0] - sums[0] * sums[0]);
    const double foot = (sums[1] - slope * sums[0]) / count, head = foot + slope;
    CHECK(slope < -0.0015);
    const double shares[2] = {foot / (cell * slope), (head + down) / (cell * -slope)};
    std::printf("  plates %.3f cells above a node: the lower gives way by %.4f cells, the upper by %.4f\n", place / 8.0,
                shares[0], shares[1]);
    for (const double share : shares) least = smaller(least, share), most = larger(most, share), mean += share / 16;
  }
  for (const auto& printed : {Page("docs/contact.md")
                                  .read("a flat face gives way by # to # of a cell's strain, by "
                                        "where it lies between nodes (mean #)"),
                              Page("docs/method.md")
                                  .read("A flat face gives way by # to # of a cell's strain, by its "
                                        "place between nodes (mean #,")}) {
    CHECK(least == printed[0].rounded());
    CHECK(most == printed[1].rounded());
    CHECK(mean == printed[2].rounded());
  }
}

}  // namespace mpm::test::rigid_column

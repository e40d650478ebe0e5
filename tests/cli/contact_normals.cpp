// The verb contact-normals: its table, its figure, and what it refuses.

#include "cli/figure_data.hpp"
#include "cli/program.hpp"

using namespace mpm::test;

TEST_CASE("contact-normals prints a row for every normal and draws the figure of the page") {
  const Folder folder;
  const Result result = call(folder, {"contact-normals", "--figure", "normals"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK(folder.names() ==
        Words{"normals.csv", "normals.png", "normals.svg", "normals_end.csv", "normals_end.png", "normals_end.svg"});
  for (const char* id : {"average_volume_gradient", "mass_gradient, densities 1:100", "volume_gradient", "own_gradient",
                         "widest_gap", "linear_regression", "logistic_regression"})
    CHECK(has(result.out, std::string("\n") + id));
  CHECK(!has(result.out, "\ngiven"));  // it has no default
  for (const std::string end : {"", "_end"}) {
    INFO("figure " << end);
    check_figure_data(folder / ("normals" + end + ".csv"), "contact_normals" + end + ".csv", 1e-6);
  }
}

TEST_CASE("contact-normals refuses what is no shape with axes, and no folder") {
  const Folder folder;
  const Result misspelt = call(folder, {"contact-normals", "bspline_quadratik"});
  CHECK(misspelt.code == 2);
  CHECK(has(misspelt.err, "did you mean \"bspline_quadratic\"?"));
  const Result list = call(folder, {"contact-normals", "cpdi"});
  CHECK(list.code == 2);
  CHECK(has(list.err, "no shape that is a tensor product is called \"cpdi\""));
  const Result figure = call(folder, {"contact-normals", "linear", "--figure", "nowhere/normals"});
  CHECK(figure.code == 5);
  CHECK(has(figure.err, "nowhere"));
}

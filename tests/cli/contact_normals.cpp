// The verb contact-normals: its table, its figure, and what it refuses.

#include "cli/program.hpp"
#include "support/csv.hpp"

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
    const auto drawn = mpm::support::read_csv_cells(folder / ("normals" + end + ".csv"));
    const auto page = mpm::support::read_csv_cells(MPM_SOURCE_DIR "/figures/studies/contact_normals" + end + ".csv");
    REQUIRE(drawn.size() == page.size());
    for (std::size_t row = 0; row < page.size(); ++row) {
      INFO("row " << row);
      REQUIRE(drawn[row].size() == page[row].size());
      for (std::size_t cell = 0; cell < page[row].size(); ++cell)
        if (row > 0 && cell == 4)
          CHECK(std::stod(drawn[row][cell]) == Approx(std::stod(page[row][cell])).epsilon(1e-6));
        else
          CHECK(drawn[row][cell] == page[row][cell]);
    }
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

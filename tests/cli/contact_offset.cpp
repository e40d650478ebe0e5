// The verb contact-offset: its table, its figure, and what it refuses.

#include "cli/program.hpp"
#include "support/csv.hpp"

using namespace mpm::test;

TEST_CASE("contact-offset prints the check values of the catalogue") {
  const Folder folder;
  const Result quadratic = call(folder, {"contact-offset"});
  CHECK(quadratic.code == 0);
  CHECK(has(quadratic.out, "bspline_quadratic, 2 particles a cell"));
  CHECK(has(quadratic.out, "\n     0.0          0.8438"));
  CHECK(
      has(call(folder, {"contact-offset", "bspline_quadratic", "--particles", "3"}).out, "\n     0.0          0.8272"));
  CHECK(has(call(folder, {"contact-offset", "gimp"}).out, "\n     0.0          0.7500"));
  const std::string cpdi = call(folder, {"contact-offset", "cpdi"}).out;
  CHECK(has(cpdi, "stretched"));
  CHECK(!has(cpdi, "turned"));
  CHECK(folder.names().empty());
}

TEST_CASE("contact-offset draws the figure of the page") {
  const Folder folder;
  const Result result = call(folder, {"contact-offset", "bspline_quadratic", "--particles", "2", "--figure", "offset"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK(folder.names() == Words{"offset.csv", "offset.png", "offset.svg"});
  const auto drawn = mpm::support::read_csv_cells(folder / "offset.csv");
  const auto page = mpm::support::read_csv_cells(MPM_SOURCE_DIR "/figures/studies/contact_offset.csv");
  REQUIRE(drawn.size() == page.size());
  for (std::size_t row = 0; row < page.size(); ++row) {
    INFO("row " << row);
    REQUIRE(drawn[row].size() == page[row].size());
    for (std::size_t cell = 0; cell < page[row].size(); ++cell)
      if (row > 0 && cell == 4)
        CHECK(std::stod(drawn[row][cell]) == Approx(std::stod(page[row][cell])).epsilon(1e-9));
      else
        CHECK(drawn[row][cell] == page[row][cell]);
  }
}

TEST_CASE("contact-offset refuses what is no shape, no number and no folder") {
  const Folder folder;
  const Result shape = call(folder, {"contact-offset", "bspline_quadratik"});
  CHECK(shape.code == 2);
  CHECK(has(shape.err, "did you mean \"bspline_quadratic\"?"));
  CHECK(call(folder, {"contact-offset", "gimp", "--particles", "0"}).code == 2);
  const Result figure = call(folder, {"contact-offset", "gimp", "--figure", "nowhere/offset"});
  CHECK(figure.code == 5);
  CHECK(has(figure.err, "nowhere"));
}

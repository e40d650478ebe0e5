// The verb contact-offset: its table, its figure, and what it refuses.

#include "cli/figure_data.hpp"
#include "cli/program.hpp"

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
  check_figure_data(folder / "offset.csv", "contact_offset.csv", 1e-9);
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

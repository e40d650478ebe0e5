// What a wheel lacks of its spin: the numbers of docs/contact.md. They are the program's own, and show what has changed;
// the closed form, and how near a wheel comes to it, is in tests/verification/rolling_wheel.cpp.

#include "verification/rolling_wheel.hpp"
#include "support/catch.hpp"
#include "support/page.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::rolling_wheel;

// The force of a slipping wheel is what is missing of m g sin, and the arm is I alpha over it: both tend to those of a
// wheel that touches at its rim.
TEST_CASE("friction on a wheel has the right size on coarser grids than the right arm",
          "[friction][rolling][docs][slow]") {
  const Page page("docs/contact.md");
  struct Row {
    const char *cells, *cell_size, *particles;
  };
  for (const Row& row :
       {Row{"5", "0.1", "2"}, {"5", "0.1", "4"}, {"10", "0.05", "2"}, {"10", "0.05", "4"}, {"20", "0.025", "2"}}) {
    INFO(row.cells << " cells a radius, " << row.particles << " particles");
    const auto printed = page.read("| " + std::string(row.cells) + " | " + row.particles + " | # | # |");
    std::vector<std::string> settings = grid(row.cell_size, row.particles);
    settings.push_back(set("/contact/friction", "0.15"));
    const Rolling slips = roll(settings);
    const double force = g * sine - slips.acceleration, arm = slips.spin_up / 2 / force;
    CHECK(force / (0.15 * g * cosine) == printed[0].rounded());
    CHECK(arm == printed[1].rounded());
  }
}

TEST_CASE("shorter steps do not bring back the spin that a wheel lacks", "[friction][rolling][docs][slow]") {
  const auto printed = Page("docs/contact.md").read("spin #, #, # and # % low at `courant` 0.4, 0.2, 0.1 and 0.05");
  std::size_t k = 0;
  for (const char* courant : {"0.4", "0.2", "0.1", "0.05"}) {
    INFO(courant);
    std::vector<std::string> settings = grid("0.05", "2");
    settings.insert(settings.end(), {set("/contact/friction", "0.15"), set("/solver/courant", courant)});
    CHECK(100 * (1 - roll(settings).spin_up / 2.548713) == printed[k++].rounded());
  }
}

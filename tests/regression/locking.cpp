// How little rings widen that lock: numbers of docs/method.md. They are the program's own, and show what has changed;
// Lame's solution is in tests/verification/locking.cpp.

#include "support/catch.hpp"
#include "support/larger.hpp"
#include "support/page.hpp"
#include "verification/locking_tube.hpp"

namespace mpm::test::locking_tube {

TEST_CASE("rings on four cells of their wall widen by what the page on the method says", "[locking][docs]") {
  double least = 1, most = 0, least_mean = 2, most_mean = 0;
  for (const std::string shape : {"linear", "gimp", "cpdi"})
    for (const std::string transfer : {"apic", "flip"}) {
      const double own = error_of({shape, transfer, 0.499, 4, false}),
                   mean = error_of({shape, transfer, 0.499, 4, true});
      least = smaller(least, 1 + own), most = larger(most, 1 + own);
      least_mean = smaller(least_mean, 1 + mean), most_mean = larger(most_mean, 1 + mean);
    }
  const auto printed = Page("docs/method.md")
                           .read(
                               "widens by # to # of Lame's displacement on 4 cells of its wall with linear functions, "
                               "GIMP and CPDI, and with the average by # of it");
  CHECK(least == printed[0].rounded());
  CHECK(most == printed[1].rounded());
  CHECK(least_mean == printed[2].rounded());
  CHECK(most_mean == printed[2].rounded());
}

}  // namespace mpm::test::locking_tube

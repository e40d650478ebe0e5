// The times at which a step updates stress (USF, USL, MUSL), and body forces, on every shape and transfer.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("parity of the orders of a step", "[parity]") {
  std::vector<std::string> laws = variants(MPM_CONTACT);
  laws.insert(laws.begin(), "");
  for (const int dimension : {2, 3})
    for (const std::string& shape : variants(MPM_SHAPE))
      for (const std::string& transfer : variants(MPM_TRANSFER))
        for (const std::string& contact : dimension == 2 ? laws : std::vector<std::string>{laws[1]})
          for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
            Mix mix;
            mix.dimension = dimension;
            mix.shape = shape, mix.transfer = transfer, mix.contact = contact, mix.stress_update = order;
            if (!is_refused(mix)) check_parity(mix);
          }
}

TEST_CASE("parity of body forces", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string& transfer : variants(MPM_TRANSFER))
      for (const std::string order : {"last", "first", "modified_last", "averaged"})
        for (const std::string output : {"", R"(, "output": {"ledger": false})"}) {
          Mix mix;
          mix.dimension = dimension;
          mix.transfer = transfer, mix.stress_update = order;
          mix.more = std::string(R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y")J") +
                     (dimension == 3 ? R"(, "z*X"])" : "]") + output;
          check_parity(mix);
        }
}

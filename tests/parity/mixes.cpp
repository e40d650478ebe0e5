// Every shipped mix of shape, transfer and material, and of shape, transfer and contact law, as found in the registry.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

void check_all_mixes(int dimension) {
  std::vector<std::string> laws = variants(MPM_CONTACT);
  laws.insert(laws.begin(), "");
  long count = 0;
  for (const std::string& shape : variants(MPM_SHAPE))
    for (const std::string& transfer : variants(MPM_TRANSFER))
      for (const std::string& contact : laws)
        for (const std::string& material : variants(MPM_MATERIAL)) {
          // Laws and materials do not meet but in momenta: each law takes one material.
          if (!contact.empty() && material.find("neo_hookean") == material.npos) continue;
          Mix mix;
          mix.dimension = dimension;
          mix.shape = shape, mix.transfer = transfer, mix.contact = contact, mix.material = material;
          // With the tent and their default fraction the affine FLIPs invert a particle here, on either backend.
          for (const std::string affine : {"aflip", "asflip"})
            if (shape.find("linear") != shape.npos && transfer.find("\"" + affine + "\"") != transfer.npos)
              mix.transfer = R"({"type": ")" + affine + R"(", "pic_fraction": 0.2})";
          if (is_refused(mix)) continue;
          check_parity(mix);
          ++count;
        }
  REQUIRE(count >= 4 * 5 * (8 + 2));
}

}  // namespace

TEST_CASE("parity of mixes in 2-D", "[parity]") {
  check_all_mixes(2);
}

TEST_CASE("parity of mixes in 3-D", "[parity]") {
  check_all_mixes(3);
}

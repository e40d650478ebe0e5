// Shipped mixes of shape, transfer and material, and of shape, transfer and contact law, as found in the registry: in every
// run so many that each two of them meet, in the slow part all.

#include "parity/parity.hpp"
#include "support/pairwise.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// What the last choice of a mix is: a material, or a contact law. Laws and materials do not meet but in momenta: each law
/// takes one material.
struct MaterialOrLaw {
  std::string material, contact;
};

std::vector<MaterialOrLaw> materials_and_laws() {
  std::vector<MaterialOrLaw> all;
  for (const std::string& material : variants(MPM_MATERIAL)) all.push_back({material, ""});
  for (const std::string& law : variants(MPM_CONTACT)) all.push_back({Mix{}.material, law});
  return all;
}

class Mixes {
 public:
  explicit Mixes(int dimension) : dimension_(dimension) {}
  Mix mix(const Combination& choice) const {
    Mix mix;
    mix.dimension = dimension_, mix.shape = shapes_[choice[0]], mix.transfer = transfers_[choice[1]];
    mix.material = others_[choice[2]].material, mix.contact = others_[choice[2]].contact;
    // With the tent and their default fraction the affine FLIPs invert a particle here, on either backend.
    for (const std::string affine : {"aflip", "asflip"})
      if (mix.shape.find("linear") != mix.shape.npos && mix.transfer.find("\"" + affine + "\"") != mix.transfer.npos)
        mix.transfer = R"({"type": ")" + affine + R"(", "pic_fraction": 0.2})";
    return mix;
  }
  std::vector<Combination> all() const {
    return all_combinations({shapes_.size(), transfers_.size(), others_.size()},
                            [&](const Combination& choice) { return !is_refused(mix(choice)); });
  }

 private:
  int dimension_;
  std::vector<std::string> shapes_ = variants(MPM_SHAPE), transfers_ = variants(MPM_TRANSFER);
  std::vector<MaterialOrLaw> others_ = materials_and_laws();
};

void check_pairs(int dimension) {
  const Mixes mixes(dimension);
  const std::vector<Combination> all = mixes.all(), few = pairwise(all);
  REQUIRE(all.size() >= 4 * 5 * (8 + 2));
  REQUIRE(few.size() >= 4 * 5);
  for (const Combination& choice : few) check_parity(mixes.mix(choice));
}

void check_all(int dimension) {
  const Mixes mixes(dimension);
  for (const Combination& choice : mixes.all()) check_parity(mixes.mix(choice));
}

}  // namespace

TEST_CASE("parity of mixes in 2-D, so that each two plugins meet", "[parity]") {
  check_pairs(2);
}

TEST_CASE("parity of mixes in 3-D, so that each two plugins meet", "[parity]") {
  check_pairs(3);
}

TEST_CASE("parity of all mixes in 2-D", "[parity][slow]") {
  check_all(2);
}

TEST_CASE("parity of all mixes in 3-D", "[parity][slow]") {
  check_all(3);
}

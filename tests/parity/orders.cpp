// The times at which a step updates stress (USF, USL, MUSL), and body forces, on every shape and transfer: in every run so
// many mixes that each two choices meet, in the slow part all.

#include "parity/parity.hpp"
#include "support/pairwise.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::vector<std::string> orders{"last", "first", "modified_last", "averaged"};

/// Shape, transfer, contact law or none, and order of the stress update; in 3-D one law, as 2-D has all.
class OrderedMixes {
 public:
  explicit OrderedMixes(int dimension) : dimension_(dimension) { laws_.insert(laws_.begin(), ""); }
  Mix mix(const Combination& choice) const {
    Mix mix;
    mix.dimension = dimension_, mix.shape = shapes_[choice[0]], mix.transfer = transfers_[choice[1]];
    mix.contact = laws_[choice[2]], mix.stress_update = orders[choice[3]];
    return mix;
  }
  std::vector<Combination> all() const {
    return all_combinations(
        {shapes_.size(), transfers_.size(), laws_.size(), orders.size()},
        [&](const Combination& choice) { return (dimension_ == 2 || choice[2] == 1) && !is_refused(mix(choice)); });
  }

 private:
  int dimension_;
  std::vector<std::string> shapes_ = variants(MPM_SHAPE), transfers_ = variants(MPM_TRANSFER),
                           laws_ = variants(MPM_CONTACT);
};

}  // namespace

TEST_CASE("parity of the orders of a step, so that each two choices meet", "[parity]") {
  for (const int dimension : {2, 3}) {
    const OrderedMixes mixes(dimension);
    const std::vector<Combination> few = pairwise(mixes.all());
    REQUIRE(few.size() >= 4 * 5);
    for (const Combination& choice : few) check_parity(mixes.mix(choice));
  }
}

TEST_CASE("parity of the orders of a step in all mixes", "[parity][slow]") {
  for (const int dimension : {2, 3}) {
    const OrderedMixes mixes(dimension);
    for (const Combination& choice : mixes.all()) check_parity(mixes.mix(choice));
  }
}

TEST_CASE("parity of body forces", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string& transfer : variants(MPM_TRANSFER))
      for (const std::string& order : orders)
        for (const std::string output : {"", R"(, "output": {"ledger": false})"}) {
          Mix mix;
          mix.dimension = dimension;
          mix.transfer = transfer, mix.stress_update = order;
          mix.more = std::string(R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y")J") +
                     (dimension == 3 ? R"(, "z*X"])" : "]") + output;
          check_parity(mix);
        }
}

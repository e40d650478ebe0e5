// The combinations that parity and device tests take in place of all.

#include "support/pairwise.hpp"

#include "support/catch.hpp"

using namespace mpm::test;

TEST_CASE("few combinations hold every pair of choices that may go together", "[pairwise]") {
  const auto accepted = [](const Combination& c) { return !(c[0] == 1 && c[2] == 3); };
  const std::vector<Combination> all = all_combinations({8, 9, 12, 4}, accepted);
  CHECK(all.size() == 8 * 9 * 12 * 4 - 9 * 4);
  const std::vector<Combination> few = pairwise(all);
  CHECK(few.size() >= 9 * 12);  // each needs a combination of its own
  CHECK(few.size() < 2 * 9 * 12);
  std::set<PairOfChoices> pairs;
  for (const Combination& combination : few) {
    CHECK(accepted(combination));
    pairs.merge(pairs_of(combination));
  }
  CHECK(pairs.size() == 8 * 9 + 8 * 12 + 8 * 4 + 9 * 12 + 9 * 4 + 12 * 4 - 1);
  CHECK(pairwise({}).empty());
}

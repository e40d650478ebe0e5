// Few combinations that stand for all: what two things may be at the same time, some combination has them be.
#pragma once

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

namespace mpm::test {

/// A choice, by its number, for each of several things.
using Combination = std::vector<std::size_t>;

/// All combinations of things that have so many choices each, as far as they are accepted; the last thing varies fastest.
template <class Accepted>
std::vector<Combination> all_combinations(const std::vector<std::size_t>& choices, Accepted accepted) {
  std::vector<Combination> all;
  Combination next(choices.size(), 0);
  for (bool more = true; more;) {
    if (accepted(next)) all.push_back(next);
    more = false;
    for (std::size_t thing = choices.size(); thing-- > 0 && !more;) {
      more = ++next[thing] < choices[thing];
      if (!more) next[thing] = 0;
    }
  }
  return all;
}

/// Two things, by their numbers, and a choice for each.
using PairOfChoices = std::vector<std::size_t>;

inline std::set<PairOfChoices> pairs_of(const Combination& combination) {
  std::set<PairOfChoices> pairs;
  for (std::size_t b = 0; b < combination.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) pairs.insert({a, b, combination[a], combination[b]});
  return pairs;
}

/// Some of these combinations, which hold each pair that any of them holds: time and again the first of those that hold
/// most of the pairs that are left.
inline std::vector<Combination> pairwise(const std::vector<Combination>& all) {
  std::set<PairOfChoices> left;
  std::vector<std::set<PairOfChoices>> pairs;
  for (const Combination& combination : all) {
    pairs.push_back(pairs_of(combination));
    left.insert(pairs.back().begin(), pairs.back().end());
  }
  std::vector<Combination> chosen;
  while (!left.empty()) {
    std::size_t best = 0;
    std::ptrdiff_t most = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::ptrdiff_t count = std::count_if(pairs[k].begin(), pairs[k].end(),
                                                 [&](const PairOfChoices& pair) { return left.count(pair) > 0; });
      if (count > most) best = k, most = count;
    }
    for (const PairOfChoices& pair : pairs[best]) left.erase(pair);
    chosen.push_back(all[best]);
  }
  return chosen;
}

}  // namespace mpm::test

#pragma once
// What a weld would give each pair of fields at every node where they meet, and its sums around a node: laws that read the
// traction (MPM_READS_TRACTION) are told of these.

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "operators/contact.hpp"

namespace mpm::cpu {

class ContactWelds {
 public:
  struct Entry {
    std::size_t pair;         ///< its number (pair_index)
    std::array<int, 3> node;  ///< coordinates
    WeldOfPair weld;
  };

  /// Forgets all, for so many velocity fields.
  void begin(int fields) {
    pairs_.resize(static_cast<std::size_t>(fields * (fields - 1) / 2));
    for (Nodes& nodes : pairs_) nodes.clear();
  }
  void add(const Entry& entry) { pairs_[entry.pair][key(entry.node)] = entry.weld; }
  /// The sum over the nodes up to traction_reach away along each axis, in the same order whatever the number of threads.
  WeldOfPair around(std::size_t pair, const std::array<int, 3>& node) const {
    const Nodes& nodes = pairs_[pair];
    WeldOfPair sum;
    for (int k = -traction_reach; k <= traction_reach; ++k)
      for (int j = -traction_reach; j <= traction_reach; ++j)
        for (int i = -traction_reach; i <= traction_reach; ++i) {
          const auto found = nodes.find(key({node[0] + i, node[1] + j, node[2] + k}));
          if (found != nodes.end()) sum.add(found->second);
        }
    return sum;
  }

 private:
  using Nodes = std::unordered_map<std::uint64_t, WeldOfPair>;

  /// 21 bits a coordinate, far more than a domain has nodes along an axis.
  static std::uint64_t key(const std::array<int, 3>& node) {
    std::uint64_t bits = 0;
    for (const int coordinate : node) bits = bits << 21 | (static_cast<std::uint64_t>(coordinate) & 0x1fffff);
    return bits;
  }

  std::vector<Nodes> pairs_;
};

}  // namespace mpm::cpu

#pragma once
// Things in bins by their place, so that those near a point are found without a look at all others.

#include <array>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <vector>

#include "experiment/vector3.hpp"

namespace mpm {

/// Things of type T in cubes of one side, m; squares in 2-D.
template <class T>
class PointBins {
 public:
  using Bin = std::array<long, 3>;

  PointBins(int dimension, double side) : dimension_(dimension), side_(side) {}

  void add(const Vector3& x, const T& thing) { bins_[bin_of(x)].push_back(thing); }
  /// Adds a thing where `open_around` has been called near x, and nowhere else.
  void add_where_open(const Vector3& x, const T& thing) {
    if (const auto found = bins_.find(bin_of(x)); found != bins_.end()) found->second.push_back(thing);
  }
  /// Whether it would be added at x.
  bool is_open(const Vector3& x) const { return bins_.contains(bin_of(x)); }
  void open_around(const Vector3& x) {
    for_each_bin_around(x, [&](const Bin& bin) { bins_.try_emplace(bin); });
  }
  /// Calls visit(thing) for all that lie less than a side from x along every axis, and for some that lie farther.
  template <class Visit>
  void for_each_near(const Vector3& x, Visit&& visit) const {
    for_each_bin_around(x, [&](const Bin& bin) {
      const auto found = bins_.find(bin);
      if (found == bins_.end()) return;
      for (const T& thing : found->second) visit(thing);
    });
  }

 private:
  struct Hash {
    std::size_t operator()(const Bin& bin) const {
      std::size_t hash = 0;
      for (const long at : bin) hash = hash * 1000003u + static_cast<std::size_t>(at);
      return hash;
    }
  };
  Bin bin_of(const Vector3& x) const {
    Bin bin{};
    for (int c = 0; c < dimension_; ++c) bin[c] = static_cast<long>(std::floor(x[c] / side_));
    return bin;
  }
  template <class Visit>
  void for_each_bin_around(const Vector3& x, Visit&& visit) const {
    const Bin middle = bin_of(x);
    const long deep = dimension_ == 3 ? 1 : 0;
    for (long i = -1; i <= 1; ++i)
      for (long j = -1; j <= 1; ++j)
        for (long k = -deep; k <= deep; ++k) visit(Bin{middle[0] + i, middle[1] + j, middle[2] + k});
  }

  int dimension_;
  double side_;
  std::unordered_map<Bin, std::vector<T>, Hash> bins_;
};

}  // namespace mpm

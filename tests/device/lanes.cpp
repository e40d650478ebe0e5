// What a team's lanes do together: the orders in which the host takes them, and sums over lanes, teams and indices.

#include <array>
#include <numeric>

#include "backends/device/kernels/sums.hpp"
#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr int sums = 5, maxima = 2;

std::vector<int> order_of(int count, unsigned order) {
  std::vector<int> taken;
  for (int k = 0; k < count; ++k) taken.push_back(device::in_order(k, count, order));
  return taken;
}

/// The k-th value that an index gives.
double value_of(int index, int k) {
  return 3 + (index * 37 + k * 11) % 101;
}

/// Sums of the first values of 0 .. count - 1, and the largest of each of the last.
std::array<double, sums> joined(int count) {
  std::array<double, sums> expected{};
  for (int index = 0; index < count; ++index)
    for (int k = 0; k < sums; ++k) {
      const double value = value_of(index, k);
      expected[k] = k < sums - maxima ? expected[k] + value : std::max(expected[k], value);
    }
  return expected;
}

}  // namespace

TEST_CASE("the host takes each lane of a team once, upwards, downwards or in an order of its own by the seed",
          "[device]") {
  for (const int count : {1, 2, 3, 4, 5, 15, 16, 17, 32, 63, 64, 65, 100, 1000}) {
    INFO(count << " lanes");
    std::vector<int> upwards(static_cast<std::size_t>(count));
    std::iota(upwards.begin(), upwards.end(), 0);
    CHECK(order_of(count, device::order_upwards) == upwards);
    CHECK(order_of(count, device::order_downwards) == std::vector<int>(upwards.rbegin(), upwards.rend()));
    std::set<std::vector<int>> orders;
    for (const unsigned seed : {2u, 3u, 4u, 20u, 311u}) {
      std::vector<int> shuffled = order_of(count, seed);
      orders.insert(shuffled);
      std::sort(shuffled.begin(), shuffled.end());
      CHECK(shuffled == upwards);
    }
    if (count > 20) CHECK(orders.size() == 5);
  }
}

// A shuffle of four rounds mixes each number: lanes that are neighbours seldom follow each other.
TEST_CASE("a shuffled team seldom takes neighbours one after another", "[device]") {
  for (const unsigned seed : {2u, 3u, 20u, 311u}) {
    const std::vector<int> order = order_of(1024, seed);
    int neighbours = 0, rising = 0;
    for (std::size_t k = 1; k < order.size(); ++k) {
      neighbours += std::abs(order[k] - order[k - 1]) == 1;
      rising += order[k] > order[k - 1];
    }
    INFO(seed);
    CHECK(neighbours < 20);              // two are expected of an order by chance
    CHECK(std::abs(rising - 512) < 80);  // the standard deviation is nine
  }
}

TEST_CASE("sums and largest values over lanes, teams and indices count each once, whatever their numbers", "[device]") {
  for (const int lanes : {1, 2, 3, 5, 8, 12, 32})
    for (const int count : {1, 4, 13, 32, 100}) {
      INFO(count << " indices on teams of " << lanes << " lanes");
      const int teams = (count + lanes - 1) / lanes;
      std::vector<double> shared(static_cast<std::size_t>(lanes * sums), std::nan("")),
          partial(static_cast<std::size_t>(teams * sums), std::nan(""));
      std::array<double, sums> found{};
      device::Arguments<double> a{};
      a.partial_sums = partial.data(), a.sums = found.data();
      a.sum_count = sums, a.sum_maxima = maxima, a.sum_teams = teams;
      for (int team = 0; team < teams; ++team)
        device::sum_over<sums, maxima>(device::Team(shared.data(), team, lanes, device::order_downwards), a, count,
                                       [](int index, double* values) {
                                         for (int k = 0; k < sums; ++k) values[k] += value_of(index, k);
                                       });
      for (const int joining : {1, 3, lanes}) {
        std::vector<double> of_lane(static_cast<std::size_t>(joining * sums), std::nan(""));
        found.fill(std::nan(""));
        device::join_teams<device::Adding>(device::Team(of_lane.data(), 0, joining, device::order_upwards), a);
        CHECK(found == joined(count));
      }
    }
}

TEST_CASE("the largest of all teams is taken with all that stands beside it, the first where several are equal",
          "[device]") {
  const std::vector<std::array<double, 2>> given{{1, 10}, {7, 20}, {3, 30}, {7, 40}, {0, 50}};
  for (const int lanes : {1, 2, 4, 8}) {
    std::vector<double> shared(static_cast<std::size_t>(lanes * 2)), partial;
    for (const auto& [value, beside] : given) partial.push_back(value), partial.push_back(beside);
    std::array<double, 2> found{};
    device::Arguments<double> a{};
    a.partial_sums = partial.data(), a.sums = found.data();
    a.sum_count = 2, a.sum_teams = static_cast<int>(given.size());
    device::join_teams<device::TakingLargest>(device::Team(shared.data(), 0, lanes, device::order_upwards), a);
    CHECK(found == std::array<double, 2>{7, 20});
  }
}

#pragma once
// The generalised vortex: its motion, and the errors of runs of experiments/studies/generalised_vortex.json.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/page.hpp"
#include "verification/shipped.hpp"

namespace mpm::test::generalised_vortex {

constexpr double pi = std::numbers::pi;
inline const char* vortex = "studies/generalised_vortex.json";

using Vec2 = std::array<double, 2>;

/// The place of a particle at angle and radius, G = T = 1.
inline Vec2 place(double X, double Y, double t) {
  const double q = std::hypot(X, Y) - 1, w = 1 - 16 * q * q, a = std::sin(pi * t) * w * w;
  return {X * std::cos(a) - Y * std::sin(a), X * std::sin(a) + Y * std::cos(a)};
}

inline std::vector<std::string> settings(int cells, const std::string& shape, const std::string& transfer, double twist,
                                         double end) {
  return {set("/grid/cell_size", digits(1.0 / cells)), set("/shape/type", shape), set("/transfer/type", transfer),
          set("/constants/G", digits(twist)), set("/compare/exact/amplitude", digits(twist)),
          set("/solver/end_time", digits(end)),
          // The Courant number is that of experiments/studies/vortex.json.
          set("/solver/courant", twist < 1 ? "0.3" : "0.5")};
}

struct Errors {
  std::vector<double> place, volume, largest_volume;  ///< m, rms; J - 1, exactly zero: rms, and largest of a particle
};

/// The errors on grids of `cells` a metre; NaN where a run stops.
inline Errors errors(const std::vector<int>& cells, const std::string& shape, const std::string& transfer, double twist,
                     double end, int particles_per_cell_axis = 2) {
  Errors found;
  std::vector<double> sizes;
  for (const int n : cells) {
    auto words = settings(n, shape, transfer, twist, end);
    words.push_back(set("/bodies/0/particles_per_cell_axis", std::to_string(particles_per_cell_axis)));
    ShippedScene scene(vortex, words);
    const Totals last = scene.run();
    const std::vector<double> F = scene.simulation.backend().body_state(0).material_state.at("deformation_gradient");
    double sum = 0;
    for (std::size_t k = 0; k < F.size(); k += 4) sum += std::pow(F[k] * F[k + 3] - F[k + 1] * F[k + 2] - 1, 2);
    const bool ended = scene.failure.empty();
    found.place.push_back(ended ? last.position_error_rms : NAN);
    found.volume.push_back(ended ? std::sqrt(4 * sum / static_cast<double>(F.size())) : NAN);
    found.largest_volume.push_back(ended ? std::max(1 - last.smallest_volume_ratio, last.largest_volume_ratio - 1)
                                         : NAN);
    sizes.push_back(1.0 / n);
  }
  print_orders(shape + " " + transfer, sizes, found.place);
  print_orders("  rms J - 1", sizes, found.volume);
  print_orders("  max |J - 1|", sizes, found.largest_volume);
  return found;
}

inline double order(const std::vector<double>& e) {
  return std::log2(e[e.size() - 2] / e.back());
}

/// Whether the page of convergence prints these values at the # of its sentence.
inline void check_page(const std::string& sentence, const std::vector<double>& values) {
  INFO(sentence);
  const auto printed = Page("docs/studies/convergence.md").read(sentence);
  REQUIRE(printed.size() == values.size());
  for (std::size_t k = 0; k < values.size(); ++k) CHECK(values[k] == printed[k].rounded());
}

/// An error falls on every finer grid.
inline void check_falls(const std::vector<double>& e) {
  for (std::size_t k = 1; k < e.size(); ++k) CHECK(e[k] < e[k - 1]);
}

}  // namespace mpm::test::generalised_vortex

// Checks that the work of a material's stress is what it stores and dissipates, along straight and closed paths.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "conformance/material_batch.hpp"

namespace mpm::conformance {
namespace {

/// The balance of every lane along a path, J/m^3.
struct Balance {
  std::array<double, full> work{}, heat{}, stored{};
  std::array<double, full> spent{};  ///< the work of all steps by their sizes
  /// The sum of how the work of a step's last stress and strain differs at most from that of its first:
  /// |change of tau| |increment| + |tau| |increment|^2, as strain is seen from the begin and from the end of the step.
  std::array<double, full> between{};
  std::array<double, full> way{};      ///< the sum of |increment|
  std::array<double, full> longest{};  ///< the largest |increment|

  double residual(int lane) const { return work[lane] - stored[lane] - heat[lane]; }
};

double size_of(const Matrix3& a) {
  return std::sqrt(contraction(a, a));
}

/// Goes on along the path by one step.
void advance(MaterialBatch& batch, const Increments& increments, double dt, Balance& balance) {
  std::array<Matrix3, full> before;
  std::array<double, full> energy;
  for (int lane = 0; lane < full; ++lane) before[lane] = batch.tau(lane), energy[lane] = batch.energy(0, lane);
  batch.advance(increments, dt);
  for (int lane = 0; lane < full; ++lane) {
    // The velocity gradient seen from the end of the step is L (I + dt L)^-1.
    const Matrix3 late = increments[lane] * inverse(sum(Matrix3::identity(), increments[lane])), tau = batch.tau(lane);
    const double done = 0.5 * (contraction(before[lane], increments[lane]) + contraction(tau, late));
    balance.work[lane] += done;
    balance.spent[lane] += std::abs(done);
    balance.heat[lane] += batch.dissipated(0, lane);
    balance.stored[lane] += batch.energy(0, lane) - energy[lane];
    const double size = size_of(increments[lane]);
    balance.between[lane] += (size_of(sum(tau, scaled(before[lane], -1))) + size_of(tau) * size) * size;
    balance.way[lane] += size;
    balance.longest[lane] = std::max(balance.longest[lane], size);
  }
}

/// Stress work minus stored energy minus heat, over the work, for a straight path to `target` within a second, so that
/// laws of rates are strained at one rate whatever the steps. Where hardly any work is done (sand in tension) only
/// rounding is left to compare, and `floor`, J/m^3, stands for the work.
Worst straight_residual(const Context& c, const Increments& target, int steps, double floor) {
  Increments increments;
  for (int lane = 0; lane < full; ++lane) increments[lane] = scaled(target[lane], 1.0 / steps);
  MaterialBatch batch = c.batch();
  batch.evaluate();
  Balance balance;
  for (int k = 0; k < steps; ++k) advance(batch, increments, 1.0 / steps, balance);
  Worst worst;
  for (int lane = 0; lane < full; ++lane)
    worst.add(std::abs(balance.residual(lane)) / std::max(balance.spent[lane], floor), lane);
  return worst;
}

constexpr int turns = 2;

/// Two turns within a second of F = I + sin(angle) A + (1 - cos(angle)) B, with A and B of every lane its own and of sizes from `strain`
/// down to an eighth of it. A quarter of the lanes has no B: they go there and back on a straight line.
std::vector<Increments> closed_path(int dimension, double strain, int steps) {
  Random random(20240611);
  Increments along, across;
  for (int lane = 0; lane < full; ++lane) {
    const double size = strain / (1 << lane / 4 % 4);
    along[lane] = random.matrix(dimension, size), across[lane] = random.matrix(dimension, size);
    if (lane % 4 == 0) across[lane] = {};
  }
  Increments F;
  F.fill(Matrix3::identity());
  std::vector<Increments> path(static_cast<std::size_t>(steps));
  for (std::size_t k = 0; k < path.size(); ++k) {
    // The last place is the first to the last digit.
    const double angle = k + 1 < path.size() ? turns * 2 * std::numbers::pi * static_cast<double>(k + 1) / steps : 0;
    for (int lane = 0; lane < full; ++lane) {
      const Matrix3 next = sum(Matrix3::identity(),
                               sum(scaled(along[lane], std::sin(angle)), scaled(across[lane], 1 - std::cos(angle))));
      path[k][lane] = sum(next, scaled(F[lane], -1)) * inverse(F[lane]);
      F[lane] = next;
    }
  }
  return path;
}

/// What a closed path leaves unexplained: the worst of its quarter turns.
struct Unexplained {
  Worst error;     ///< over what is allowed
  Worst relative;  ///< over the work
  Worst back;      ///< of stress and energy at the end, over rho c^2
};

Unexplained around(const Context& c, double strain, int steps) {
  const std::vector<Increments> path = closed_path(c.variant.dimension, strain, steps);
  const bool finite = is_finite_strain(c.plugin), dissipates = traits_of(c.plugin) & MPM_DISSIPATES;
  const double angle = turns * 2 * std::numbers::pi / steps;
  MaterialBatch batch = c.batch();
  batch.evaluate();
  const MaterialBatch start = batch;
  Balance balance;
  Unexplained found;
  for (int k = 1; k <= steps; ++k) {
    advance(batch, path[static_cast<std::size_t>(k) - 1], 1.0 / steps, balance);
    for (int lane = 0; lane < full && k % (steps / (4 * turns)) == 0; ++lane) {
      const double error = std::abs(balance.residual(lane)), rounding = 64 * c.variant.epsilon() * balance.way[lane];
      // The trapezoidal work is off by at most half of what lies between. Without heat it is of second order, and a
      // stress that bends at a strain, which is met four times a turn, adds an eighth of modulus |increment|^2.
      const double kinks = dissipates ? 0 : balance.longest[lane] * balance.longest[lane];
      const double allowed = 0.5 * balance.between[lane] * (dissipates ? 1 : angle) + (rounding + kinks) * c.modulus +
                             (finite ? 0 : 10 * strain * balance.spent[lane]);
      found.error.add(error / allowed, lane);
      found.relative.add(error / std::max(balance.spent[lane], 1e-4 * c.modulus * strain * strain), lane);
    }
  }
  for (int lane = 0; lane < full; ++lane) {
    found.back.add(largest_difference(batch.tau(lane), start.tau(lane)) / c.modulus, lane);
    found.back.add(std::abs(batch.energy(0, lane) - start.energy(0, lane)) / c.modulus, lane);
  }
  return found;
}

}  // namespace

void check_energy_balance(const Context& c, Random& random) {
  if (c.variant.precision != MPM_SCALAR_DOUBLE) return;
  const bool finite = is_finite_strain(c.plugin);
  const double strain = finite ? 0.05 : 1e-4;
  Increments target;
  for (Matrix3& t : target) t = random.matrix(c.variant.dimension, strain);
  const bool dissipates = traits_of(c.plugin) & MPM_DISSIPATES;
  // A fluid whose volume hardly changes does next to no work: a ten-thousandth of what the modulus makes of the strain counts.
  const double floor = 1e-4 * c.modulus * strain * strain;
  const Worst coarse = straight_residual(c, target, 64, floor), fine = straight_residual(c, target, 256, floor);
  const double order = std::log(coarse.value / fine.value) / std::log(4.0);
  const std::string text =
      "|work - stored - heat| over work, 256 steps; observed order " + std::to_string(order) + c.where;
  c.findings.at_most("energy_balance", c.variant, fine, finite ? (dissipates ? 0.1 : 1e-4) : 10 * strain, text);
  // The trapezoidal work of a conservative law is of second order, the return to a yield surface of first.
  const double least = dissipates ? 0.8 : 1.8;
  if (finite && fine.value > 1e-9)
    c.findings.at_most("energy_balance_order", c.variant, {std::max(0.0, least - order), -1}, 0,
                       "shortfall of the order below " + std::to_string(least) + ": " + text);
}

void check_closed_paths(const Context& c) {
  if (c.variant.precision != MPM_SCALAR_DOUBLE) return;
  const unsigned traits = traits_of(c.plugin);
  const double strain = is_finite_strain(c.plugin) ? 0.2 : 1e-4;
  // Where the coarse steps leap over what the law does in them, as a brittle one breaks, finer ones must not.
  int steps = 64;
  Unexplained coarse = around(c, strain, steps);
  if (!(coarse.error.value <= 1)) coarse = around(c, strain, steps *= 8);
  const Unexplained fine = around(c, strain, 8 * steps);
  const std::string text = "|work - stored - heat| of two turns over what steps leave, " + std::to_string(steps) +
                           " and " + std::to_string(8 * steps) + " steps" + c.where;
  for (const Unexplained& found : {coarse, fine}) c.findings.at_most("closed_path", c.variant, found.error, 1, text);
  c.findings.report("closed_path_unexplained [" + c.variant.name() + "]", fine.relative.value,
                    "|work - stored - heat| over the work, " + std::to_string(8 * steps) + " steps" + c.where);
  if ((traits & MPM_HYPERELASTIC) && !(traits & MPM_DISSIPATES))
    c.findings.at_most("closed_path_returns", c.variant, fine.back, 256 * c.variant.epsilon(),
                       "stress and energy at the end of two turns of a closed path over rho c^2" + c.where);
}

void check_elastic_strains(const Context& c, Random& random) {
  if (c.variant.precision != MPM_SCALAR_DOUBLE) return;
  constexpr double ages = 0x1p40, size = 3e-6;  // s, and a strain
  const bool finite = is_finite_strain(c.plugin);
  const double strain = finite ? 0.4 : 1e-4, back = finite ? 1e-4 : 0.01 * strain,
               density = parameter_value(c.plugin, c.parameters, "density", 1);
  const std::vector<Increments> path = random_path(random, c.variant.dimension, 16, strain);
  MaterialBatch from = after_path(c.plugin, c.variant, c.parameters, path);
  Increments unload;
  for (int lane = 0; lane < full; ++lane) {
    const double last = size_of(path.back()[lane]);
    unload[lane] = scaled(path.back()[lane], last > 0 ? -back / last : 0);
  }
  from.advance(unload);
  from.advance(Increments{}, ages);
  MaterialBatch held = from;
  held.advance(Increments{});
  Worst error;
  int elastic = 0;
  bool pressed = false;
  for (int direction = 0; direction < 6; ++direction) {
    Increments there, back_again;
    for (int lane = 0; lane < full; ++lane) {
      there[lane] = random.matrix(c.variant.dimension, 1);
      there[lane] = scaled(there[lane], size / std::max(size_of(there[lane]), 1e-3));
      back_again[lane] = scaled(there[lane], -1);
    }
    MaterialBatch plus = held, minus = held;
    plus.advance(there), minus.advance(back_again);
    for (int lane = 0; lane < full; ++lane) {
      pressed |= size_of(held.tau(lane)) > 1e-6 * c.modulus;
      const Matrix3 tau = held.tau(lane), both = sum(plus.tau(lane), minus.tau(lane));
      // A law that flows in one of the strains, or whose stress bends there, has no derivative by them.
      const double bend = size_of(sum(both, scaled(tau, -2))),
                   heat = plus.dissipated(0, lane) + minus.dissipated(0, lane);
      if (!(bend <= 1e3 * size * size * c.modulus) || !(std::abs(heat) <= 1e-6 * size * c.modulus)) continue;
      const double stored = plus.energy(0, lane) - minus.energy(0, lane),
                   warmed = plus.dissipated(0, lane) - minus.dissipated(0, lane);
      const double work = contraction(scaled(both, 0.5), scaled(there[lane], 2));
      // Differences err by what stress bends in them, and a crushed particle is stiffer than at rest.
      const double stiff = std::max(c.modulus, density * held.wave(0, lane) * held.wave(0, lane));
      error.add(std::abs(stored + warmed - work) / (2 * size * stiff), lane);
      if (size_of(tau) > 1e-6 * c.modulus) ++elastic;
    }
  }
  c.findings.at_most(
      "stress_from_elastic_energy", c.variant, error, finite ? 1e-8 : 10 * strain * strain,
      "|d(stored energy) - tau : d| over rho c^2 |d|, of small strains in which nothing flows" + c.where);
  c.findings.require("elastic_strains_found [" + c.variant.name() + "]", elastic > 0 || !pressed,
                     "a strain in which nothing flows is found where there is stress" + c.where);
  c.findings.report("elastic_strains_compared [" + c.variant.name() + "]", elastic,
                    "strains of a stressed particle in which nothing flows, of 384" + c.where);
}

}  // namespace mpm::conformance

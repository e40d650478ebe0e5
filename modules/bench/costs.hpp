#pragma once
// What a step has to do, counted: floating-point operations and bytes a particle. The count is of the algorithm as the
// cpu backend does it, useful lanes only: padded lanes, tile copies, address arithmetic and sorting are overhead, not
// work.

#include <optional>
#include <vector>

#include "plan/plan.hpp"
#include "simulation/simulation.hpp"

namespace mpm::bench {

struct Flops {
  double shape = 0, transfer = 0, material = 0;  ///< operations in the plugins
  double scatter = 0, gather = 0;                ///< rows of the stencil, coefficients and moments
  double grid = 0;                               ///< the particle's share of the nodes
  double total() const { return shape + transfer + material + scatter + gather + grid; }
};

/// What a count needs to know of the run itself.
struct RunFacts {
  double nodes_per_particle = 0;
  bool deforming = true;                 ///< materials flow where they can
  std::vector<double> body_shares = {};  ///< shares of the particles, by body; empty: the first body has all
  std::optional<double> filter_passes;   ///< passes of the filter's loop, a step on average; none: as if at every step
  bool without_ledger = false;           ///< leave out what the ledger adds up; else a scene with one is not counted
};

/// Nodes in memory a particle.
double nodes_per_particle(const Simulation& simulation);

/// Facts of a simulation after its last step; materials count as flowing, the ledger's sums do not count.
RunFacts facts_of(const Simulation& simulation);

/// Operations a particle-step; nothing where a plugin does not say its own (mpm_costs), the ledger adds its sums or
/// the scene has temperature, whose operators nobody has counted. Nodes count once, whatever the number of velocity
/// fields.
std::optional<Flops> flops_per_particle(const Experiment& experiment, const Plan& plan, const RunFacts& run);

/// Bytes that must cross memory in a step, a particle: its state is read and written once in a fused pass (read once
/// more where gather and scatter are apart, and once a pass of a filter's loop), and each channel of its nodes
/// likewise. The step is one that nobody looks at: what a fused pass need not store (MPM_REPLACES_MOTION) is not
/// counted.
double bytes_per_particle(const Experiment& experiment, const Plan& plan, double nodes_per_particle);

/// Rows of the tensor-product scatter and gather, `width` nodes an axis (modules/backends/cpu/tiles/tile.hpp).
double scatter_rows(int dimension, int width, bool affine, bool gradient);
double gather_rows(int dimension, int width, bool moment, bool gradient);

/// Sums over a stencil of the products of powers up to `order` an axis, either way, axis by axis
/// (modules/backends/cpu/tiles/higher_kernels.hpp).
double polynomial_sums(int dimension, int width, int order);

}  // namespace mpm::bench

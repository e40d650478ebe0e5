#include "bench/costs.hpp"

#include "kernel/corner_domain.hpp"
#include "kernel/counted.hpp"
#include "kernel/polynomial_basis.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::bench {
namespace {

/// What the step of one experiment asks of the stencil.
struct Wanted {
  int D = 3;
  unsigned traits = 0;
  bool separate_force = false, contact = false, moment_is_gradient = false, moment_of_particle = false;
  bool has(unsigned trait) const { return (traits & trait) != 0; }
  bool stress_by_affine() const { return has(MPM_STRESS_BY_AFFINE); }
  bool affine() const { return has(MPM_GATHERS_AFFINE | MPM_STRAIN_BY_AFFINE); }
  bool moment() const { return affine() && !moment_is_gradient; }
  bool gather_gradient() const {
    return !has(MPM_STRAIN_BY_AFFINE) || has(MPM_GATHERS_GRADIENT) || (affine() && moment_is_gradient);
  }
  bool scatter_gradient() const { return !stress_by_affine() || contact; }
};

// ---- plugins -----------------------------------------------------------------------------------------------------

/// What the plugin says of one call (mpm_costs); nothing where it does not.
template <int D, class T>
std::optional<mpm_cost> cost_of(const Component& component, mpm_cost_case of = {}) {
  const auto* costs = extension_of<mpm_costs>(*component.plugin);
  if (!costs) return std::nullopt;
  of.dimension = D;
  of.single_precision = sizeof(T) == 4;
  mpm_cost cost{};
  costs->count(component.parameters.data(), &of, &cost);
  return cost;
}

/// Evaluations of one stencil with what the host adds to them, and nodes of a list.
struct ShapeCost {
  double plain = 0, with_gradient = 0;
  int width = 0;     ///< 0: a list
  double nodes = 0;  ///< mean number of nodes of a list
};

template <int D, class T>
std::optional<ShapeCost> shape_cost(const Component& component, double half_size, const Wanted& wanted) {
  const auto evaluation = [&](bool gradients) {
    mpm_cost_case of{};
    of.half_size = half_size, of.gradients = gradients;
    return cost_of<D, T>(component, of);
  };
  const auto plain = evaluation(false), with_gradient = evaluation(true);
  if (!plain || !with_gradient) return std::nullopt;
  const bool moment = wanted.moment_of_particle && wanted.affine();
  const mpm_shape& shape = component.plugin->shape();
  if (shape.form == MPM_NODE_LIST) {  // weights and gradients are made together; distances, and the moment's sum
    const double more = plain->nodes * (D + (moment ? 3 * D * D : 0));
    return ShapeCost{plain->operations + more, with_gradient->operations + more, 0, plain->nodes};
  }
  const int width = static_cast<int>(shape.width);
  const double more = D * (1 + (moment ? 3 * width + 1 : 0));  // the offset; sum w d^2 and its inverse
  return ShapeCost{plain->operations + more, with_gradient->operations + more, width, 0};
}

// ---- the host's part ---------------------------------------------------------------------------------------------

/// One scatter of a particle: `stress` coefficients into A or S, the move of b to the first node, the rows.
double scatter_cost(const Wanted& w, const ShapeCost& shape, bool affine, bool gradient, bool stress) {
  const double DD = w.D * w.D;
  double cost = stress ? 2 * DD : 0;
  if (affine) cost += 3 * DD;
  if (gradient) cost += DD;
  if (shape.width > 0) return cost + scatter_rows(w.D, shape.width, affine, gradient);
  const double lanes = w.D + 1;
  return cost + shape.nodes * (2 * lanes + (affine ? 2 * DD : 0) + (gradient ? 2 * DD : 0));
}

double gather_cost(const Wanted& w, const ShapeCost& shape, bool moment, bool gradient) {
  const double DD = w.D * w.D;
  double cost = 0;
  if (moment) cost += (3 + (w.moment_of_particle ? (shape.width > 0 ? 1 : 2 * w.D) : 0)) * DD;
  if (gradient) cost += DD;
  if (shape.width > 0) return cost + gather_rows(w.D, shape.width, moment, gradient);
  return cost + shape.nodes * (2 * w.D + (moment ? 2 * DD : 0) + (gradient ? 2 * DD : 0));
}

/// What corners that the grid moves cost a step: each takes the velocity of its cell, and what moves the particle
/// beyond its own; then the domain's centroid becomes the particle's place.
template <int D, class T>
double corner_cost(double half_size) {
  using S = Counted<T>;
  Vec<D, S> corners[1 << D], x;
  for (int c = 0; c < 1 << D; ++c)
    for (int a = 0; a < D; ++a) corners[c][a] = S(c >> a & 1 ? half_size : -half_size);
  for (int a = 0; a < D; ++a) x[a] = S(5.3);  // any place inside a cell
  const long moved = count_operations([&] { centroid(corner_domain<D, S>(corners), corners); });
  const long tents = count_operations([&] {
    const TentCell<D, S> cell(x, corners[0]);
    for (int which = 0; which < 1 << D; ++which) cell.weight(which);
  });
  const double velocity = (1 << D) * 2 * D + 4 * D;  // to nodes, and dt (v + advection - own) to corner
  return static_cast<double>(moved) + (1 << D) * (static_cast<double>(tents) + velocity + D);
}

/// Costs of the polynomials beyond affine: the bases of the axes, then sums of one axis at a time (higher_kernels.hpp).
struct PolynomialCost {
  double gather = 0, scatter = 0;
};

template <int D, int K, class T>
PolynomialCost polynomial_cost(int order) {
  using S = Counted<T>;
  S w[K];
  for (int k = 0; k < K; ++k) w[k] = S(1.0 / K);
  AxisBasis<K, S> basis;
  const double bases =
      static_cast<double>(D * count_operations([&] { make_axis_basis<K>(w, 1, S(0.5 * (K - 1)), order, basis); }));
  const double cost = bases + polynomial_sums(D, K, order);
  return {cost, cost + D * basis_functions(D, order)};  // coefficients are scattered times the mass
}

template <int D, class T>
PolynomialCost polynomial_cost(int width, int order) {
  if (order == 0) return {};
  if (width == 2) return polynomial_cost<D, 2, T>(order);
  return width == 3 ? polynomial_cost<D, 3, T>(order) : polynomial_cost<D, 4, T>(order);
}

/// Passes over the particles besides the gather and the scatter that every step has.
struct ExtraPasses {
  int strains = 0;                ///< passes that gather a velocity gradient on their own
  int advances = 0;               ///< updates of the material
  int remaps = 0;                 ///< scatters of mass and momentum again (MUSL)
  bool strain_in_gather = false;  ///< the gather strains as well
};

void count_passes(const Plan& plan, ExtraPasses& count) {
  for_each_pass_as_a_rule(plan.step, [&](const Pass& pass) {
    if (pass.has(Act::strain)) ++count.advances;
    if (pass.has(Act::strain) && pass.has(Act::gather)) count.strain_in_gather = true;
    if (pass.has(Act::strain) && !pass.has(Act::gather)) ++count.strains;
    if (pass.has(Act::scatter_momentum) && pass.remap()) ++count.remaps;
  });
}

/// The mean of a cost over the bodies, by their shares of the particles.
template <int D, class T>
std::optional<double> mean_material_cost(const Experiment& experiment, const RunFacts& run) {
  double mean = 0;
  for (std::size_t b = 0; b < experiment.bodies.size(); ++b) {
    const double share = run.body_shares.empty() ? (b == 0 ? 1 : 0) : run.body_shares[b];
    if (share == 0) continue;
    mpm_cost_case of{};
    of.flows = run.deforming;
    const auto cost = cost_of<D, T>(experiment.materials[experiment.bodies[b].material].component, of);
    if (!cost) return std::nullopt;
    mean += share * cost->operations;
  }
  return mean;
}

template <int D, class T>
std::optional<Flops> flops_of(const Experiment& experiment, const Plan& plan, const RunFacts& run) {
  // Nobody has counted what heat, the mean dilation and artificial viscosity take.
  if (experiment.has_temperature() || plan.does(Act::average_dilation) || experiment.has_artificial_viscosity())
    return std::nullopt;
  const mpm_shape& shape_table = experiment.shape.plugin->shape();
  Wanted w;
  w.D = D;
  w.traits = experiment.transfer.plugin->transfer().traits;
  w.separate_force = plan.node_field("force");
  w.contact = plan.resolves_contact();
  w.moment_is_gradient = shape_table.second_moment_kind == MPM_MOMENT_IS_GRADIENT;
  w.moment_of_particle = shape_table.second_moment_kind == MPM_MOMENT_PER_PARTICLE;
  const double half_size = 0.5 / experiment.bodies[0].particles_per_cell_axis;
  const auto shape = shape_cost<D, T>(experiment.shape, half_size, w);
  const auto transfer = cost_of<D, T>(experiment.transfer);
  const auto filter = plan.filters() ? cost_of<D, T>(*experiment.filter) : mpm_cost{};
  const auto material = mean_material_cost<D, T>(experiment, run);
  if (!shape || !transfer || !filter || !material || (plan.has_ledger() && !run.without_ledger)) return std::nullopt;
  const auto stencil = [&](bool gradient) { return gradient ? shape->with_gradient : shape->plain; };

  const double loops = !plan.filters() ? 0
                       : run.filter_passes
                           ? *run.filter_passes
                           : experiment.filter->plugin->filter().iterations(experiment.filter->parameters.data());
  ExtraPasses extra;
  count_passes(plan, extra);
  const bool scatters_affine = w.has(MPM_SCATTERS_AFFINE);
  const bool gathers_affine = w.has(MPM_GATHERS_AFFINE) && !w.moment_is_gradient;
  const bool gathers_gradient = w.has(MPM_GATHERS_GRADIENT) || (w.has(MPM_GATHERS_AFFINE) && w.moment_is_gradient);
  const bool strains_by_affine = w.has(MPM_STRAIN_BY_AFFINE) && !w.moment_is_gradient;
  // A gather that leaves the strain to a pass of its own takes what the transfer reads and no more.
  const bool moment = extra.strain_in_gather ? w.moment() : gathers_affine;
  const bool gradient = extra.strain_in_gather ? w.gather_gradient() : gathers_gradient;
  Flops flops;
  flops.shape = stencil(gradient) + stencil(w.scatter_gradient()) + extra.strains * stencil(!strains_by_affine) +
                extra.remaps * stencil(false) + loops * stencil(gathers_gradient);
  flops.transfer = (1 + loops) * transfer->operations;
  flops.material = extra.advances * *material;
  flops.gather = gather_cost(w, *shape, moment, gradient) + 2 * D +
                 extra.strains * gather_cost(w, *shape, strains_by_affine, !strains_by_affine) +
                 loops * gather_cost(w, *shape, gathers_affine, gathers_gradient);
  if (w.has(MPM_GATHERS_INCREMENT)) flops.gather += gather_cost(w, *shape, false, false);
  if (plan.particle_field(0, "domain")) flops.gather += extra.advances * D * D * (2 * D + 2);
  if (plan.sample_points > 0) flops.gather += corner_cost<D, T>(half_size);
  const PolynomialCost polynomials = polynomial_cost<D, T>(shape->width, plan.basis_order);
  flops.gather += (1 + loops) * polynomials.gather;
  flops.scatter = (1 + loops + extra.remaps) * polynomials.scatter;
  flops.scatter += (loops + extra.remaps) * scatter_cost(w, *shape, scatters_affine, false, false);
  const double apart = scatter_cost(w, *shape, scatters_affine, false, false) +
                       scatter_cost(w, *shape, w.stress_by_affine(), !w.stress_by_affine(), true);
  const double merged = scatter_cost(w, *shape, scatters_affine || w.stress_by_affine(), !w.stress_by_affine(), true);
  const Field* force = plan.node_field("force");
  const double share = !force ? 0 : force->for_ledger ? 1.0 / plan.ledger_every : 1;  // of the steps
  flops.scatter += merged + share * (apart - merged);
  if (w.contact)
    flops.scatter += scatter_cost(w, *shape, false, true, false) + scatter_cost(w, *shape, true, false, false);
  // Nodes compute p / m, + dt f / m, + dt g, and in a loop p / m and the update.
  flops.grid =
      ((4 + extra.remaps) * D + loops * (D + filter->operations)) * experiment.field_count * run.nodes_per_particle;
  return flops;
}

}  // namespace

/// Operations of the rows: each product and each sum of a useful lane, that is of the D momenta and, in the scatter,
/// the mass.
double scatter_rows(int dimension, int width, bool affine, bool gradient) {
  const int D = dimension, K = width, lanes = D + 1;
  double row = 0;  // sums along the last axis: w_k c, + k w_k q, + g_k s
  for (int k = 0; k < K; ++k) row += 2 * lanes + (affine && k > 0 ? 2 * D : 0) + (gradient ? 2 * D : 0);
  double plane = row;
  if (D == 3) plane = K * (row + lanes + (affine ? 2 * D : 0) + (gradient ? 3 * D : 0));
  const double head = lanes + (affine ? D + (D - 1) * D : 0) + (gradient ? 2 * D + (D - 1) * D : 0);
  return K * (head + plane);
}

double gather_rows(int dimension, int width, bool moment, bool gradient) {
  const int D = dimension, K = width;
  double row = D + (gradient ? D : 0);  // k = 0
  for (int k = 1; k < K; ++k) row += 2 * D + (moment ? (k > 1 ? 2 : 1) * D : 0) + (gradient ? 2 * D : 0);
  double plane = D == 3 ? 0 : row;
  if (D == 3)
    for (int j = 0; j < K; ++j)
      plane += row + 2 * D + (moment ? (j > 1 ? 2 : j) * D + 2 * D : 0) + (gradient ? 4 * D : 0);
  double total = 0;
  for (int i = 0; i < K; ++i)
    total += plane + 2 * D + (moment ? (i > 1 ? 2 : i) * D + 2 * (D - 1) * D : 0) + (gradient ? 2 * D * D : 0);
  return total;
}

double polynomial_sums(int dimension, int width, int order) {
  const int D = dimension, K = width, R = order + 1;
  const int line = K * R;  // sums along the last axis
  const int plane = D == 3 ? K * (line + R * R) : line;
  return 2.0 * D * K * (plane + R * R * (D == 3 ? R : 1));
}

double nodes_per_particle(const Simulation& simulation) {
  return static_cast<double>(simulation.backend().grid_bytes()) /
         static_cast<double>(simulation.plan().bytes_per_node()) / static_cast<double>(simulation.particle_count());
}

RunFacts facts_of(const Simulation& simulation) {
  RunFacts facts{nodes_per_particle(simulation), true, {}, {}, true};
  for (std::size_t b = 0; b < simulation.experiment().bodies.size(); ++b)
    facts.body_shares.push_back(static_cast<double>(simulation.particle_count(static_cast<int>(b))) /
                                static_cast<double>(simulation.particle_count()));
  if (simulation.plan().filters() && simulation.steps() > 0)
    facts.filter_passes = static_cast<double>(simulation.filter_passes()) / static_cast<double>(simulation.steps());
  return facts;
}

std::optional<Flops> flops_per_particle(const Experiment& experiment, const Plan& plan, const RunFacts& run) {
  const bool single = experiment.precision == Precision::single;
  if (experiment.dimension == 2)
    return single ? flops_of<2, float>(experiment, plan, run) : flops_of<2, double>(experiment, plan, run);
  return single ? flops_of<3, float>(experiment, plan, run) : flops_of<3, double>(experiment, plan, run);
}

namespace {

/// Scalars of velocity and the transfer's state, where these go from gather to scatter without being stored.
double passed_scalars(const Experiment& experiment, const Plan& plan) {
  const Plugin& transfer = *experiment.transfer.plugin;
  if (!plan.fused() || !(transfer.transfer().traits & MPM_REPLACES_MOTION)) return 0;
  double scalars = experiment.dimension;
  for (const mpm_state& field : transfer.state())
    scalars += state_components(static_cast<mpm_state_shape>(field.shape), experiment.dimension);
  return scalars;
}

}  // namespace

double bytes_per_particle(const Experiment& experiment, const Plan& plan, double nodes_per_particle) {
  const double scalar = experiment.precision == Precision::single ? 4 : 8;
  // The identity is read by sorts alone.
  const double state = static_cast<double>(plan.bytes_per_particle(0)) - 4 - scalar * passed_scalars(experiment, plan);
  const double loops =
      plan.filters() ? experiment.filter->plugin->filter().iterations(experiment.filter->parameters.data()) : 0;
  const double visits = 2 + (plan.fused() ? 0 : 1);  // read and written, and read again where the scatter is apart
  return visits * state + loops * experiment.dimension * scalar +
         2 * static_cast<double>(plan.bytes_per_node()) * nodes_per_particle;
}

}  // namespace mpm::bench

// Checks of transfers: one round trip particles -> grid -> particles on a grid of the suite's own
// (docs/verification.md), with quadratic B-splines, whose second moment h^2/4 is constant.

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "conformance/support.hpp"
#include "kernel/polynomial_basis.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::conformance {
namespace {

constexpr int side = 8;            ///< nodes an axis
constexpr double spacing = 0.125;  ///< m
constexpr double second_moment = spacing * spacing / 4;

unsigned traits_of(const Plugin& plugin) {
  return plugin.transfer().traits;
}

/// All arrays of one batch of particles, for scatter and gather.
struct TransferBatch {
  Variant variant;
  int count;
  Array mass, velocity, b, A, gathered, increment, affine, gradient, particle_velocity, advection;
  std::vector<Array> state;

  TransferBatch(const Plugin& plugin, const Variant& v, int entries) : variant(v), count(entries) {
    const Element element = element_of(v);
    const std::uint32_t n = static_cast<std::uint32_t>(entries);
    const int D = v.dimension;
    mass = Array(element, 1, n);
    for (Array* vector : {&velocity, &b, &gathered, &particle_velocity, &advection}) *vector = Array(element, D, n);
    if (traits_of(plugin) & MPM_SCATTERS_AFFINE) A = Array(element, D * D, n);
    if (traits_of(plugin) & MPM_GATHERS_INCREMENT) increment = Array(element, D, n);
    if (traits_of(plugin) & MPM_GATHERS_AFFINE) affine = Array(element, D * D, n);
    if (traits_of(plugin) & MPM_GATHERS_GRADIENT) gradient = Array(element, D * D, n);
    for (const mpm_state& field : plugin.state())
      state.emplace_back(element, state_components(static_cast<mpm_state_shape>(field.shape), D), n);
  }

  std::vector<void*> state_pointers() {
    std::vector<void*> pointers;
    for (Array& field : state) pointers.push_back(field.data());
    return pointers;
  }

  void scatter(const Plugin& plugin, const ParameterSample& parameters) {
    const std::vector<void*> fields = state_pointers();
    const mpm_scatter_batch batch{static_cast<std::uint32_t>(count),
                                  mass.stride(),
                                  static_cast<std::uint32_t>(variant.dimension),
                                  0,
                                  mass.data(),
                                  velocity.data(),
                                  fields.data(),
                                  b.data(),
                                  A.data()};
    plugin.transfer().scatter[variant.precision][variant.dimension - 2](parameters.data(), &batch);
  }

  void gather(const Plugin& plugin, const ParameterSample& parameters, double dt) {
    const std::vector<void*> fields = state_pointers();
    const mpm_gather_batch batch{static_cast<std::uint32_t>(count),
                                 mass.stride(),
                                 static_cast<std::uint32_t>(variant.dimension),
                                 0,
                                 dt,
                                 gathered.data(),
                                 increment.data(),
                                 affine.data(),
                                 gradient.data(),
                                 particle_velocity.data(),
                                 fields.data(),
                                 advection.data(),
                                 nullptr};  // the second moment is a multiple of the identity
    plugin.transfer().gather[variant.precision][variant.dimension - 2](parameters.data(), &batch);
  }
};

Vector3 vector_of(const Array& array, int dimension, int lane) {
  Vector3 r{};
  for (int i = 0; i < dimension; ++i) r[i] = array(i, lane);
  return r;
}
Matrix3 matrix_of(const Array& array, int dimension, int lane) {
  Matrix3 r{};
  for (int i = 0; i < dimension; ++i)
    for (int j = 0; j < dimension; ++j) r(i, j) = array(i * dimension + j, lane);
  return r;
}
void set_vector(Array& array, int dimension, int lane, const Vector3& v) {
  for (int i = 0; i < dimension; ++i) array.set(i, lane, v[i]);
}
void set_matrix(Array& array, int dimension, int lane, const Matrix3& m) {
  for (int i = 0; i < dimension; ++i)
    for (int j = 0; j < dimension; ++j) array.set(i * dimension + j, lane, m(i, j));
}

/// Where the particles are and what they carry; the same for every precision.
struct Particles {
  std::array<Vector3, full> position{}, velocity{};
  std::array<double, full> mass{};
  std::array<Matrix3, full> affine{};
};

Particles random_particles(Random& random, int dimension) {
  Particles particles;
  for (int lane = 0; lane < full; ++lane) {
    particles.mass[lane] = random.logarithmic(0.1, 10);
    particles.affine[lane] = random.matrix(dimension, 4);
    for (int i = 0; i < dimension; ++i) {
      particles.position[lane][i] = spacing * random.uniform(1, side - 2);
      particles.velocity[lane][i] = random.uniform(-1, 1);
    }
  }
  return particles;
}

/// The quadratic stencil of one particle: calls use(node index, weight, d, gradient of the weight).
template <class Use>
void for_nodes(const Vector3& position, int dimension, Use use) {
  double base[3]{}, w[3][3], slope[3][3];
  for (int a = 0; a < dimension; ++a) {
    const double x = position[a] / spacing;
    base[a] = std::floor(x - 0.5);
    const double f = x - base[a];
    w[a][0] = 0.5 * (1.5 - f) * (1.5 - f), w[a][1] = 0.75 - (f - 1) * (f - 1), w[a][2] = 0.5 * (f - 0.5) * (f - 0.5);
    slope[a][0] = (f - 1.5) / spacing, slope[a][1] = 2 * (1 - f) / spacing, slope[a][2] = (f - 0.5) / spacing;
  }
  for (int node = 0; node < (dimension == 2 ? 9 : 27); ++node) {
    const int k[3] = {node % 3, node / 3 % 3, node / 9};
    double weight = 1;
    Vector3 d{}, gradient{};
    int index = 0;
    for (int a = dimension - 1; a >= 0; --a) {
      weight *= w[a][k[a]];
      d[a] = (base[a] + k[a]) * spacing - position[a];
      index = index * side + static_cast<int>(base[a]) + k[a];
    }
    for (int a = 0; a < dimension; ++a) {
      gradient[a] = slope[a][k[a]];
      for (int other = 0; other < dimension; ++other)
        if (other != a) gradient[a] *= w[other][k[other]];
    }
    use(index, weight, d, gradient);
  }
}

struct Grid {
  std::vector<double> mass = std::vector<double>(side * side * side);
  std::vector<Vector3> before = std::vector<Vector3>(side * side * side), after = before;  ///< momenta, then velocities

  void scatter(const TransferBatch& batch, const Particles& particles) {
    const int D = batch.variant.dimension;
    for (int lane = 0; lane < full; ++lane) {
      const Vector3 b = vector_of(batch.b, D, lane);
      const Matrix3 A = batch.A.components() ? matrix_of(batch.A, D, lane) : Matrix3{};
      for_nodes(particles.position[lane], D, [&](int node, double w, const Vector3& d, const Vector3&) {
        const Vector3 Ad = product(A, d);
        mass[node] += w * batch.mass(0, lane);
        for (int i = 0; i < D; ++i) before[node][i] += w * (b[i] + Ad[i]);
      });
    }
  }

  /// Makes velocities of momenta, and changes each at random by forces of size `kick`.
  void advance(double kick, int dimension, Random& random) {
    for (std::size_t node = 0; node < mass.size(); ++node)
      for (int i = 0; i < dimension; ++i) {
        if (mass[node] > 0) before[node][i] /= mass[node];
        after[node][i] = before[node][i] + (kick > 0 ? random.uniform(-kick, kick) : 0);
      }
  }

  void gather(TransferBatch& batch, const Particles& particles) const {
    const int D = batch.variant.dimension;
    for (int lane = 0; lane < full; ++lane) {
      Vector3 velocity{}, increment{};
      Matrix3 affine{}, gradient{};
      for_nodes(particles.position[lane], D, [&](int node, double w, const Vector3& d, const Vector3& g) {
        for (int i = 0; i < D; ++i) {
          velocity[i] += w * after[node][i];
          increment[i] += w * (after[node][i] - before[node][i]);
          for (int j = 0; j < D; ++j) {
            affine(i, j) += w * after[node][i] * d[j] / second_moment;
            gradient(i, j) += after[node][i] * g[j];
          }
        }
      });
      set_vector(batch.gathered, D, lane, velocity);
      if (batch.increment.components()) set_vector(batch.increment, D, lane, increment);
      if (batch.affine.components()) set_matrix(batch.affine, D, lane, affine);
      if (batch.gradient.components()) set_matrix(batch.gradient, D, lane, gradient);
      set_vector(batch.particle_velocity, D, lane, vector_of(batch.velocity, D, lane));
    }
  }

  Vector3 momentum(int dimension) const {
    Vector3 p{};
    for (std::size_t node = 0; node < mass.size(); ++node)
      for (int i = 0; i < dimension; ++i) p[i] += mass[node] * after[node][i];
    return p;
  }
};

bool first_state_is_matrix(const Plugin& plugin) {
  return !plugin.state().empty() && plugin.state()[0].shape == MPM_STATE_MATRIX;
}
/// Whether state 0 is the affine velocity, and its energy and momentum count.
bool state_is_affine_velocity(const Plugin& plugin) {
  return (traits_of(plugin) & MPM_AFFINE_CARRIES_ENERGY) && first_state_is_matrix(plugin);
}
/// Whether state 0 is the affine velocity, whether it counts or not.
bool has_affine_velocity(const Plugin& plugin) {
  return (traits_of(plugin) & (MPM_AFFINE_CARRIES_ENERGY | MPM_STARTS_WITH_GRADIENT)) && first_state_is_matrix(plugin);
}

Matrix3 antisymmetric(const Matrix3& m) {
  return scaled(sum(m, scaled(transposed(m), -1)), 0.5);
}

TransferBatch loaded(const Plugin& plugin, const Variant& v, const Particles& particles, int count = full) {
  TransferBatch batch(plugin, v, count);
  Random random(7);
  for (int lane = 0; lane < count; ++lane) {
    batch.mass.set(0, lane, particles.mass[lane]);
    set_vector(batch.velocity, v.dimension, lane, particles.velocity[lane]);
    set_vector(batch.particle_velocity, v.dimension, lane, particles.velocity[lane]);
    for (Array& field : batch.state)
      for (int c = 0; c < field.components(); ++c) field.set(c, lane, random.uniform(-1, 1));
    if (!has_affine_velocity(plugin)) continue;
    const Matrix3& affine = particles.affine[lane];
    const bool spin_only = traits_of(plugin) & MPM_KEEPS_SPIN_ONLY;
    set_matrix(batch.state[0], v.dimension, lane, spin_only ? antisymmetric(affine) : affine);
  }
  return batch;
}

/// Linear and angular momentum and kinetic energy of the particles, with what the affine state holds.
struct Totals {
  Vector3 momentum{};
  Matrix3 angular{};  ///< antisymmetric: sum m (x (x) v - v (x) x) and the affine part
  double energy = 0;
  double affine_energy = 0;  ///< energy of an affine velocity that does not count
};

Totals totals(const Plugin& plugin, const TransferBatch& batch, const Array& velocity, const Particles& particles) {
  const int D = batch.variant.dimension;
  Totals t;
  for (int lane = 0; lane < full; ++lane) {
    const double m = batch.mass(0, lane);
    const Vector3 v = vector_of(velocity, D, lane), x = particles.position[lane];
    const Matrix3 C = state_is_affine_velocity(plugin) ? matrix_of(batch.state[0], D, lane) : Matrix3{};
    t.energy += m / 2 * (dot(v, v) + second_moment * contraction(C, C));
    if (has_affine_velocity(plugin) && !state_is_affine_velocity(plugin)) {
      const Matrix3 carried = matrix_of(batch.state[0], D, lane);
      t.affine_energy += m / 2 * second_moment * contraction(carried, carried);
    }
    for (int i = 0; i < D; ++i) {
      t.momentum[i] += m * v[i];
      for (int j = 0; j < D; ++j)
        t.angular(i, j) += m * (x[i] * v[j] - x[j] * v[i] + second_moment * (C(j, i) - C(i, j)));
    }
  }
  return t;
}

double difference(const Vector3& a, const Vector3& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

double bound_of(const Variant& v) {
  return v.single() ? 1e-5 : 1e-12;
}

/// Checks that what a particle gives its nodes sums to its momentum, and that the grid's momentum comes back to the
/// particles.
void check_momentum(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                    const Particles& particles, Random& random, const std::string& where, Findings& findings) {
  const int D = v.dimension;
  TransferBatch batch = loaded(plugin, v, particles);
  batch.scatter(plugin, parameters);
  Worst given, finite;
  for (int lane = 0; lane < full; ++lane) {
    const Vector3 b = vector_of(batch.b, D, lane);
    const Matrix3 A = batch.A.components() ? matrix_of(batch.A, D, lane) : Matrix3{};
    Vector3 error = product(scaled(Matrix3::identity(), -particles.mass[lane]), particles.velocity[lane]);
    for_nodes(particles.position[lane], D, [&](int, double w, const Vector3& d, const Vector3&) {
      const Vector3 Ad = product(A, d);
      for (int i = 0; i < D; ++i) error[i] += w * (b[i] + Ad[i]);
    });
    given.add(difference(error, {}) / particles.mass[lane], lane);
  }
  findings.at_most("scattered_momentum", v, given, bound_of(v), "|sum w (b + A d) - m v| / m" + where);

  Grid grid;
  grid.scatter(batch, particles);
  grid.advance(0.5, D, random);
  grid.gather(batch, particles);
  batch.gather(plugin, parameters, 0x1p-8);
  Worst returned;
  returned.add(difference(totals(plugin, batch, batch.particle_velocity, particles).momentum, grid.momentum(D)) / full);
  for (int lane = 0; lane < full; ++lane) finite.add(difference(vector_of(batch.advection, D, lane), {}), lane);
  findings.at_most("returned_momentum", v, returned, bound_of(v),
                   "|sum m v - momentum of the grid| a particle" + where);
  findings.at_most("advection_velocity", v, finite, 100,
                   "largest velocity that moves a particle, of order 1 m/s" + where);
}

/// Checks a step without forces: momentum and angular momentum stay, energy does not grow, FLIP changes nothing.
void check_force_free(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                      const Particles& particles, Random& random, const std::string& where, Findings& findings) {
  TransferBatch batch = loaded(plugin, v, particles);
  const Totals before = totals(plugin, batch, batch.velocity, particles);
  batch.scatter(plugin, parameters);
  Grid grid;
  grid.scatter(batch, particles);
  grid.advance(0, v.dimension, random);
  grid.gather(batch, particles);
  batch.gather(plugin, parameters, 0x1p-8);
  const Totals after = totals(plugin, batch, batch.particle_velocity, particles);
  Worst momentum, angular, energy, kept;
  momentum.add(difference(after.momentum, before.momentum) / full);
  angular.add(largest_difference(after.angular, before.angular) / full);
  energy.add(after.energy / (before.energy + before.affine_energy) - 1);  // the grid gets both energies
  findings.at_most("momentum", v, momentum, bound_of(v), "change over a force-free round trip, a particle" + where);
  findings.at_most("energy_never_grows", v, energy, bound_of(v), "relative gain over a force-free round trip" + where);
  const std::string round_trip = "change over a force-free round trip, a particle" + where;
  if (state_is_affine_velocity(plugin) && (traits_of(plugin) & MPM_GATHERS_AFFINE))
    findings.at_most("angular_momentum", v, angular, bound_of(v), round_trip);
  else if (has_affine_velocity(plugin))  // the gathered gradient is not the affine moment, or v is not the grid's
    findings.report("angular_momentum [" + v.name() + "]", angular.value, round_trip);
  if ((traits_of(plugin) & MPM_GATHERS_INCREMENT) && parameter_value(plugin, parameters, "pic_fraction", 0) == 0) {
    for (int lane = 0; lane < full; ++lane)
      kept.add(difference(vector_of(batch.particle_velocity, v.dimension, lane),
                          vector_of(batch.velocity, v.dimension, lane)),
               lane);
    findings.at_most("zero_increment_keeps_velocity", v, kept, 0, "change of velocity without forces" + where);
  }
}

/// Checks that v = v0 + B x with C = B comes back unchanged; a transfer that scatters only a rotation is given a spin.
void check_affine(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                  const Particles& random_ones, Random& random, const std::string& where, Findings& findings) {
  const unsigned traits = traits_of(plugin);
  const bool keeps_affine =
      (traits & MPM_SCATTERS_AFFINE) && (traits & (MPM_GATHERS_AFFINE | MPM_GATHERS_GRADIENT)) != 0;
  const int D = v.dimension;
  const bool rigid = !has_affine_velocity(plugin) || (traits & MPM_KEEPS_SPIN_ONLY);
  Matrix3 B = keeps_affine ? random.matrix(D, 4) : Matrix3{};
  if (rigid) B = antisymmetric(B);
  const Vector3 origin = random.direction(D);
  Particles particles = random_ones;
  for (int lane = 0; lane < full; ++lane) {
    const Vector3 Bx = product(B, particles.position[lane]);
    for (int i = 0; i < D; ++i) particles.velocity[lane][i] = origin[i] + Bx[i];
  }
  TransferBatch batch = loaded(plugin, v, particles);
  for (Array& field : batch.state)
    for (int lane = 0; lane < full; ++lane)
      for (int c = 0; c < field.components(); ++c) field.set(c, lane, 0);
  // The state that belongs to the field is what a gather of the exact field leaves.
  for (int lane = 0; lane < full; ++lane) {
    set_vector(batch.gathered, D, lane, particles.velocity[lane]);
    if (batch.increment.components()) set_vector(batch.increment, D, lane, {});
    if (batch.affine.components()) set_matrix(batch.affine, D, lane, B);
    if (batch.gradient.components()) set_matrix(batch.gradient, D, lane, B);
  }
  batch.gather(plugin, parameters, 0x1p-8);
  const std::vector<Array> state = batch.state;
  batch.scatter(plugin, parameters);
  Grid grid;
  grid.scatter(batch, particles);
  grid.advance(0, D, random);
  grid.gather(batch, particles);
  batch.gather(plugin, parameters, 0x1p-8);
  Worst velocity, advection, carried;
  for (int lane = 0; lane < full; ++lane) {
    velocity.add(difference(vector_of(batch.particle_velocity, D, lane), particles.velocity[lane]), lane);
    advection.add(difference(vector_of(batch.advection, D, lane), particles.velocity[lane]), lane);
    // Behind an affine velocity there may be fields that grow with it.
    for (std::size_t field = 0; field < (has_affine_velocity(plugin) ? 1 : state.size()); ++field)
      for (int c = 0; c < state[field].components(); ++c)
        carried.add(std::abs(batch.state[field](c, lane) - state[field](c, lane)), lane);
  }
  const double bound = 10 * bound_of(v);
  const std::string what = !keeps_affine ? "a uniform field" : rigid ? "a rigid field" : "an affine field";
  findings.at_most("round_trip_velocity", v, velocity, bound, "change of v in " + what + where);
  findings.at_most("round_trip_advection", v, advection, bound, "advection velocity against " + what + where);
  findings.at_most("round_trip_state", v, carried, bound, "change of the carried state in " + what + where);
}

/// Fills the gathered moments of a batch with random numbers.
void set_random_moments(TransferBatch& batch, Random random) {
  for (Array* array : {&batch.gathered, &batch.increment, &batch.affine, &batch.gradient})
    for (int lane = 0; lane < batch.count; ++lane)
      for (int c = 0; c < array->components(); ++c) array->set(c, lane, random.uniform(-1, 1));
}

TransferBatch run_both(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                       const Particles& particles, int count = full) {
  TransferBatch batch = loaded(plugin, v, particles, count);
  set_random_moments(batch, Random(11));
  batch.scatter(plugin, parameters);
  batch.gather(plugin, parameters, 0x1p-8);
  return batch;
}

void check_agreement(const TransferBatch& batch, const TransferBatch& oracle, const std::string& where,
                     Findings& findings) {
  Worst coefficients, outcome;
  const auto compare = [&](const Array& a, const Array& b, Worst& worst) {
    for (int lane = 0; lane < full; ++lane)
      for (int c = 0; c < a.components(); ++c)
        worst.add(std::abs(a(c, lane) - b(c, lane)) / (1 + std::abs(b(c, lane))), lane);
  };
  compare(batch.b, oracle.b, coefficients);
  compare(batch.A, oracle.A, coefficients);
  compare(batch.particle_velocity, oracle.particle_velocity, outcome);
  compare(batch.advection, oracle.advection, outcome);
  for (std::size_t field = 0; field < batch.state.size(); ++field)
    compare(batch.state[field], oracle.state[field], outcome);
  const double bound = 16 * batch.variant.epsilon();
  findings.at_most("scatter_agrees_with_scalar", batch.variant, coefficients, bound,
                   "b and A against scalar double" + where);
  findings.at_most("gather_agrees_with_scalar", batch.variant, outcome, bound, "v, state and advection" + where);
}

void check_batches(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                   const Particles& particles, const std::string& where, Findings& findings) {
  bool guards = true, written = true, inputs = true;
  for (int count = MPM_LANES; count <= full; count += MPM_LANES) {
    TransferBatch batch = loaded(plugin, v, particles, count), untouched = batch;
    set_random_moments(batch, Random(11));
    set_random_moments(untouched, Random(11));
    batch.scatter(plugin, parameters);
    inputs &= batch.state == untouched.state && batch.particle_velocity == untouched.particle_velocity;
    batch.gather(plugin, parameters, 0x1p-8);
    inputs &= batch.mass == untouched.mass && batch.velocity == untouched.velocity &&
              batch.gathered == untouched.gathered && batch.increment == untouched.increment &&
              batch.affine == untouched.affine && batch.gradient == untouched.gradient;
    for (const Array* out : {&batch.b, &batch.A, &batch.particle_velocity, &batch.advection})
      guards &= out->guards_intact(), written &= out->all_written();
    for (const Array& field : batch.state) guards &= field.guards_intact();
  }
  findings.require("writes_inside_arrays [" + v.name() + "]", guards, "guards around outputs and state" + where);
  findings.require("writes_every_output [" + v.name() + "]", written, "no output element is left out" + where);
  findings.require("inputs_untouched [" + v.name() + "]", inputs, "mass, velocity, moments; state by scatter" + where);
}

/// Checks the promise of MPM_REPLACES_MOTION.
void check_replaced_motion(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                           const Particles& particles, const std::string& where, Findings& findings) {
  if (!(traits_of(plugin) & MPM_REPLACES_MOTION)) return;
  TransferBatch one = loaded(plugin, v, particles, full), other = one;
  Random random(12);
  for (int lane = 0; lane < full; ++lane) {
    for (int c = 0; c < v.dimension; ++c) other.particle_velocity.set(c, lane, random.uniform(-1, 1));
    for (Array& field : other.state)
      for (int c = 0; c < field.components(); ++c) field.set(c, lane, random.uniform(-1, 1));
  }
  for (TransferBatch* batch : {&one, &other}) {
    set_random_moments(*batch, Random(11));
    batch->gather(plugin, parameters, 0x1p-8);
  }
  bool moves_with_gathered = true;
  for (int lane = 0; lane < full; ++lane)
    for (int c = 0; c < v.dimension; ++c) moves_with_gathered &= one.advection(c, lane) == one.gathered(c, lane);
  findings.require("replaces_motion [" + v.name() + "]",
                   one.particle_velocity == other.particle_velocity && one.state == other.state,
                   "velocity and state after a gather do not depend on those before" + where);
  findings.require("moves_with_gathered_velocity [" + v.name() + "]", moves_with_gathered,
                   "advection velocity is the gathered one" + where);
}

// ---- polynomials beyond affine, whose sums are the host's --------------------------------------------------------

/// Values of the polynomials at the nodes of one particle's quadratic stencil, in the order of for_nodes.
struct Polynomials {
  std::vector<std::array<double, 27>> given, taken;
  Polynomials(const Vector3& position, int dimension, int order) {
    AxisBasis<3, double> axis[3];
    for (int a = 0; a < dimension; ++a) {
      const double x = position[a] / spacing, f = x - std::floor(x - 0.5);
      const double w[3] = {0.5 * (1.5 - f) * (1.5 - f), 0.75 - (f - 1) * (f - 1), 0.5 * (f - 0.5) * (f - 0.5)};
      make_axis_basis<3>(w, 1, f, order, axis[a]);
    }
    const auto add = [&](int, const int* power) {
      std::array<double, 27> give{}, take{};
      for (int node = 0; node < (dimension == 2 ? 9 : 27); ++node) {
        const int k[3] = {node % 3, node / 3 % 3, node / 9};
        give[node] = take[node] = 1;
        for (int a = 0; a < dimension; ++a)
          give[node] *= axis[a].given[power[a]][k[a]], take[node] *= axis[a].taken[power[a]][k[a]];
      }
      given.push_back(give), taken.push_back(take);
    };
    if (dimension == 2)
      for_each_product<2>(order, add);
    else
      for_each_product<3>(order, add);
  }
};

/// Checks one particle alone on the grid with random coefficients: b, A and the polynomials come back unchanged, and
/// what the polynomials give has neither momentum nor angular momentum.
void check_polynomials(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                       const Particles& particles, Random& random, const std::string& where, Findings& findings) {
  const auto* polynomials = extension_of<mpm_transfer_polynomials>(plugin);
  if (!polynomials) return;
  const int asked = polynomials->order(parameters.data()), order = std::min(asked, 2), D = v.dimension;
  findings.require("basis_order [" + v.name() + "]", asked >= 0 && asked < static_cast<int>(MPM_BOX_WIDTH),
                   "0 to 3" + where);
  constexpr unsigned lower_orders = MPM_SCATTERS_AFFINE | MPM_GATHERS_AFFINE | MPM_AFFINE_CARRIES_ENERGY;
  const bool affine = (traits_of(plugin) & lower_orders) == lower_orders && state_is_affine_velocity(plugin);
  findings.require("polynomials_beyond_affine [" + v.name() + "]", affine,
                   "the orders 0 and 1 are v and an affine velocity that counts" + where);
  if (!affine || order < 1) return;
  TransferBatch batch = loaded(plugin, v, particles);
  const TransferBatch before = batch;
  batch.scatter(plugin, parameters);
  Worst returned, moments;
  for (int lane = 0; lane < full; ++lane) {
    const Polynomials polynomials(particles.position[lane], D, order);
    const std::size_t functions = polynomials.given.size();
    std::vector<Vector3> coefficient(functions), back(functions);
    for (Vector3& c : coefficient)
      for (int i = 0; i < D; ++i) c[i] = random.uniform(-1, 1);
    const Vector3 b = vector_of(batch.b, D, lane);
    const Matrix3 A = matrix_of(batch.A, D, lane);
    const double m = batch.mass(0, lane);
    Vector3 velocity{}, momentum{};
    Matrix3 C{}, angular{};
    int node = 0;
    for_nodes(particles.position[lane], D, [&](int, double w, const Vector3& d, const Vector3&) {
      const Vector3 Ad = product(A, d);
      for (int i = 0; i < D; ++i) {
        double higher = 0;  // momentum that the polynomials give
        for (std::size_t k = 0; k < functions; ++k) higher += m * coefficient[k][i] * polynomials.given[k][node];
        // Where the weight vanishes the node has no velocity, and the mean of its polynomials stands for it.
        double field = (b[i] + Ad[i]) / m;
        for (std::size_t k = 0; k < functions; ++k)
          field += w > 0 ? coefficient[k][i] * polynomials.given[k][node] / w : 0;
        momentum[i] += higher;
        for (int j = 0; j < D; ++j)
          angular(i, j) += higher * d[j] / spacing, C(i, j) += w * field * d[j] / second_moment;
        velocity[i] += w * field;
        for (std::size_t k = 0; k < functions; ++k) back[k][i] += polynomials.taken[k][node] * field;
      }
      ++node;
    });
    set_vector(batch.gathered, D, lane, velocity);
    set_matrix(batch.affine, D, lane, C);
    moments.add(std::max(difference(momentum, {}), largest_difference(angular, {})) / m, lane);
    for (std::size_t k = 0; k < functions; ++k) returned.add(difference(back[k], coefficient[k]), lane);
  }
  batch.gather(plugin, parameters, 0x1p-8);
  for (int lane = 0; lane < full; ++lane) {
    returned.add(difference(vector_of(batch.particle_velocity, D, lane), vector_of(before.velocity, D, lane)), lane);
    returned.add(spacing * largest_difference(matrix_of(batch.state[0], D, lane), matrix_of(before.state[0], D, lane)),
                 lane);
  }
  findings.at_most("polynomials_return", v, returned, 10 * bound_of(v),
                   "change of v, C and the coefficients of a particle alone" + where);
  findings.at_most("polynomials_carry_no_momentum", v, moments, bound_of(v),
                   "momentum and angular momentum of the polynomials, over the mass" + where);
}

}  // namespace

void check_transfer(const Plugin& plugin, Findings& findings) {
  Random random(20240603);
  for (const ParameterSample& parameters : sample_parameters(plugin, random))
    for (const Variant& v : variants_of(*plugin.descriptor)) {
      const std::string where = parameters.text.empty() ? "" : "; " + parameters.text;
      const Particles particles = random_particles(random, v.dimension);
      findings.running("momentum", v, where);
      check_momentum(plugin, v, parameters, particles, random, where, findings);
      findings.running("force-free round trip", v, where);
      check_force_free(plugin, v, parameters, particles, random, where, findings);
      findings.running("affine round trip", v, where);
      check_affine(plugin, v, parameters, particles, random, where, findings);
      findings.running("batches", v, where);
      check_batches(plugin, v, parameters, particles, where, findings);
      findings.running("polynomials", v, where);
      check_polynomials(plugin, v, parameters, particles, random, where, findings);
      findings.running("replaced motion", v, where);
      check_replaced_motion(plugin, v, parameters, particles, where, findings);
      if (v.precision == MPM_SCALAR_DOUBLE || !(plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1)) continue;
      findings.running("agreement with scalar", v, where);
      const Variant oracle{MPM_SCALAR_DOUBLE, v.dimension};
      check_agreement(run_both(plugin, v, parameters, particles), run_both(plugin, oracle, parameters, particles),
                      where, findings);
    }
}

}  // namespace mpm::conformance

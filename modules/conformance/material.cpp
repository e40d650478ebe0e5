// Checks of materials: rest state, stress against energy, objectivity, wave speed, admissibility. Work and energy are in
// material_energy.cpp.

#include <algorithm>
#include <cstring>
#include <limits>

#include "conformance/material_batch.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::conformance {
namespace {

void check_rest(const Context& c) {
  MaterialBatch rest = c.batch();
  const std::vector<Array> state = rest.state;
  const std::int32_t index = rest.evaluate();
  Worst stress, energy, ratio;
  bool moves = true;
  for (int lane = 0; lane < full; ++lane) {
    stress.add(largest_difference(rest.tau(lane), {}) / c.modulus, lane);
    energy.add(std::abs(rest.energy(0, lane)) / c.modulus, lane);
    ratio.add(std::abs(rest.ratio(0, lane) - 1), lane);
    moves &= rest.wave(0, lane) > 0 && std::isfinite(rest.wave(0, lane));
  }
  const double bound = 4 * c.variant.epsilon();
  c.findings.at_most("rest_stress", c.variant, stress, bound, "stress of the initial state over rho c^2" + c.where);
  c.findings.at_most("rest_energy", c.variant, energy, bound, "energy of the initial state over rho c^2" + c.where);
  c.findings.at_most("rest_volume_ratio", c.variant, ratio, 0, "|J - 1| of the initial state" + c.where);
  c.findings.require("rest_wave_speed [" + c.variant.name() + "]", moves, "positive and finite" + c.where);
  c.findings.require("rest_admissible [" + c.variant.name() + "]", index == -1, "update returns -1" + c.where);
  c.findings.require("evaluation_keeps_state [" + c.variant.name() + "]", state == rest.state,
                     "a null gradient at rest" + c.where);
}

/// The parameters with those of one unit multiplied.
ParameterSample multiplied(const Context& c, const char* unit, double factor) {
  ParameterSample changed = c.parameters;
  for (const mpm_parameter& p : c.plugin.parameters())
    if (std::strcmp(p.unit, unit) == 0) changed.block[p.offset / sizeof(double)] *= factor;
  return changed;
}

/// Checks what follows from the units alone where parameters are moduli, densities and pure numbers: with moduli of
/// four times the size stresses and energies have four times the size and waves twice the speed, and with four times the
/// density waves have half the speed. A law that reads the cell size may compare the path's rates with speeds over lengths.
void check_units(const Context& c, const std::vector<Increments>& path) {
  if (extension_of<mpm_material_cell_size>(c.plugin)) return;
  for (const mpm_parameter& p : c.plugin.parameters())
    for (const char* known : {"", "rad", "Pa", "kg/m^3"}) {
      if (std::strcmp(p.unit, known) == 0) break;
      if (std::strcmp(known, "kg/m^3") == 0) return;
    }
  const ParameterSample stiff = multiplied(c, "Pa", 4), dense = multiplied(c, "kg/m^3", 4);
  const MaterialBatch batch = after_path(c.plugin, c.variant, c.parameters, path),
                      stiffer = after_path(c.plugin, c.variant, stiff, path),
                      denser = after_path(c.plugin, c.variant, dense, path);
  Worst moduli, density;
  for (int lane = 0; lane < full; ++lane) {
    const double energy = batch.energy(0, lane), heat = batch.dissipated(0, lane), speed = batch.wave(0, lane);
    moduli.add(largest_difference(stiffer.tau(lane), scaled(batch.tau(lane), 4)) / c.modulus, lane);
    moduli.add(std::abs(stiffer.energy(0, lane) - 4 * energy) / c.modulus, lane);
    moduli.add(std::abs(stiffer.dissipated(0, lane) - 4 * heat) / c.modulus, lane);
    moduli.add(std::abs(stiffer.wave(0, lane) / (2 * speed) - 1), lane);
    density.add(largest_difference(denser.tau(lane), batch.tau(lane)) / c.modulus, lane);
    density.add(std::abs(denser.energy(0, lane) - energy) / c.modulus, lane);
    density.add(std::abs(denser.dissipated(0, lane) - heat) / c.modulus, lane);
    density.add(std::abs(2 * denser.wave(0, lane) / speed - 1), lane);
  }
  const double bound = 64 * c.variant.epsilon();
  c.findings.at_most("scales_with_moduli", c.variant, moduli, bound,
                     "stress, energy and heat of four times the moduli over rho c^2, and wave speed" + c.where);
  c.findings.at_most("scales_with_density", c.variant, density, bound,
                     "stress, energy and heat of four times the density over rho c^2, and wave speed" + c.where);
}

/// Checks that no heat is negative. A law that says that it makes energy is exempt, and its least heat is reported: its
/// energy balance must close all the same.
void check_heat(const Context& c, const Worst& negative, double bound) {
  const auto* exempt = extension_of<mpm_material_makes_energy>(c.plugin);
  const std::string detail = "heat of a step over rho c^2" + c.where;
  if (!exempt) return c.findings.at_most("dissipation_not_negative", c.variant, negative, bound, detail);
  c.findings.report("negative_dissipation [" + c.variant.name() + "]", negative.value, "least " + detail);
}

/// Checks along a path of large strains: signs, volume, and that looking at a state does not change it.
void check_path(const Context& c, const std::vector<Increments>& path) {
  MaterialBatch batch = c.batch();
  std::array<double, full> volume;
  volume.fill(1);
  Worst energy, heat, ratio;
  bool finite = true, dissipates = traits_of(c.plugin) & MPM_DISSIPATES;
  for (const Increments& increments : path) {
    batch.advance(increments);
    for (int lane = 0; lane < full; ++lane) {
      volume[lane] *= determinant(sum(Matrix3::identity(), increments[lane]));
      energy.add(-batch.energy(0, lane) / c.modulus, lane);
      heat.add(dissipates ? -batch.dissipated(0, lane) / c.modulus : std::abs(batch.dissipated(0, lane)), lane);
      ratio.add(std::abs(batch.ratio(0, lane) / volume[lane] - 1), lane);
      finite &= std::isfinite(batch.wave(0, lane)) && batch.wave(0, lane) > 0;
    }
  }
  const std::vector<Array> state = batch.state;
  batch.evaluate();
  const double bound = 16 * c.variant.epsilon();
  c.findings.at_most("energy_not_negative", c.variant, energy, bound, "negative energy over rho c^2" + c.where);
  if (dissipates)
    check_heat(c, heat, bound);
  else
    c.findings.at_most("no_dissipation", c.variant, heat, 0, "heat of a step over rho c^2" + c.where);
  c.findings.at_most("volume_ratio", c.variant, ratio, 64 * c.variant.epsilon(), "J against det of the path" + c.where);
  c.findings.require("wave_speed_finite [" + c.variant.name() + "]", finite,
                     "positive and finite along a path" + c.where);
  c.findings.require("evaluation_keeps_state_deformed [" + c.variant.name() + "]", state == batch.state,
                     "a null gradient leaves the state bit for bit" + c.where);
}

/// The index of the state field that holds F, or -1.
int deformation_field(const Plugin& plugin) {
  for (std::size_t k = 0; k < plugin.state().size(); ++k)
    if (std::strcmp(plugin.state()[k].name, "deformation_gradient") == 0 &&
        kept_shape(plugin.state()[k], false) == MPM_STATE_MATRIX)
      return static_cast<int>(k);
  return -1;
}

Matrix3 deformation(const MaterialBatch& batch, int field, int lane) {
  const int D = batch.variant.dimension;
  Matrix3 F = Matrix3::identity();
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) F(i, j) = batch.state[static_cast<std::size_t>(field)](i * D + j, lane);
  return F;
}

/// The gradient dpsi/dF by central differences, all lanes at once; `batch` is left as it was.
Increments energy_gradient(MaterialBatch& batch, int field, double h) {
  const int D = batch.variant.dimension;
  Array& F = batch.state[static_cast<std::size_t>(field)];
  const Array kept = F;
  Increments gradient{};
  for (int c = 0; c < D * D; ++c)
    for (double sign : {1.0, -1.0}) {
      for (int lane = 0; lane < full; ++lane) F.set(c, lane, kept(c, lane) + sign * h);
      batch.evaluate();
      for (int lane = 0; lane < full; ++lane) gradient[lane](c / D, c % D) += sign * batch.energy(0, lane) / (2 * h);
      F = kept;
    }
  batch.evaluate();
  return gradient;
}

/// Checks that tau = (dpsi/dF) F^T, and that the right-hand side is symmetric, as an objective energy makes it.
void check_hyperelastic(const Context& c, const std::vector<Increments>& path) {
  const int field = deformation_field(c.plugin), D = c.variant.dimension;
  c.findings.require("hyperelastic_state", field >= 0, "a hyperelastic material declares `deformation_gradient`");
  if (field < 0 || c.variant.single()) return;
  MaterialBatch batch = after_path(c.plugin, c.variant, c.parameters, path);
  // A law may bend at a strain, as where a crack closes: differences that straddle it err, and a tenth as wide do so less.
  const Increments wide = energy_gradient(batch, field, 1e-5), narrow = energy_gradient(batch, field, 1e-6);
  Worst stress, symmetric;
  for (int lane = 0; lane < full; ++lane) {
    const Matrix3 F = transposed(deformation(batch, field, lane)), exact = wide[lane] * F, nearer = narrow[lane] * F,
                  tau = batch.tau(lane);
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) {
        stress.add(std::min(std::abs(tau(i, j) - exact(i, j)), std::abs(tau(i, j) - nearer(i, j))) / c.modulus, lane);
        symmetric.add(std::min(std::abs(exact(i, j) - exact(j, i)), std::abs(nearer(i, j) - nearer(j, i))) / c.modulus,
                      lane);
      }
  }
  c.findings.at_most("stress_from_energy", c.variant, stress, 1e-8, "|tau - dpsi/dF F^T| over rho c^2" + c.where);
  c.findings.at_most("symmetric_stress", c.variant, symmetric, 1e-8, "skew part of dpsi/dF F^T over rho c^2" + c.where);
}

/// Checks the same path seen from a turning frame: f' = Q_k f Q_{k-1}^T ends at Q tau Q^T, with equal energy and wave
/// speed.
void check_objective(const Context& c, const std::vector<Increments>& path, Random& random) {
  if (c.variant.single()) return;
  MaterialBatch still = c.batch(), turning = c.batch();
  Increments Q;
  Q.fill(Matrix3::identity());
  const double density = parameter_value(c.plugin, c.parameters, "density", 1);
  Worst stress, scalars;
  for (const Increments& increments : path) {
    still.advance(increments);
    Increments turned;
    for (int lane = 0; lane < full; ++lane) {
      const Matrix3 next = random.rotation(c.variant.dimension) * Q[lane];
      const Matrix3 f = next * sum(Matrix3::identity(), increments[lane]) * transposed(Q[lane]);
      turned[lane] = sum(f, scaled(Matrix3::identity(), -1));
      Q[lane] = next;
    }
    turning.advance(turned);
    for (int lane = 0; lane < full; ++lane) {
      const Matrix3 expected = Q[lane] * still.tau(lane) * transposed(Q[lane]);
      // Rounding of the strain is felt with the stiffness that the particle has now.
      const double modulus = std::max(c.modulus, density * still.wave(0, lane) * still.wave(0, lane));
      stress.add(largest_difference(turning.tau(lane), expected) / modulus, lane);
      scalars.add(std::abs(turning.energy(0, lane) - still.energy(0, lane)) / modulus, lane);
      scalars.add(std::abs(turning.dissipated(0, lane) - still.dissipated(0, lane)) / modulus, lane);
      scalars.add(std::abs(turning.wave(0, lane) / still.wave(0, lane) - 1), lane);
    }
  }
  c.findings.at_most("objective_stress", c.variant, stress, 1e-12, "|tau(QF) - Q tau Q^T| over rho c^2" + c.where);
  c.findings.at_most("objective_scalars", c.variant, scalars, 1e-12,
                     "energy, heat, wave speed under rotation" + c.where);
}

/// Stress after steps of increments in dt and in half of it, put together so that what is as large as the rate cancels.
struct RateFreeStress {
  MaterialBatch whole, half;
  RateFreeStress(const MaterialBatch& from, const Increments& increments, double dt) : whole(from), half(from) {
    whole.advance(increments, dt);
    half.advance(increments, dt / 2);
  }
  Matrix3 tau(int lane) const { return sum(scaled(whole.tau(lane), 2), scaled(half.tau(lane), -1)); }
};

/// The squared speed rho0 c^2 of waves along n polarised along a: the derivative of tau(f F) n - (a.n) tau n with f = I
/// + s a (x) n, one-sided to second order in s, so that a plastic law answers for the direction asked. What stress does
/// in a step without strain is taken off, and what is as large as the rate of strain. It is zero where the law has a
/// kink inside the difference (a particle that starts to yield), which no difference resolves, and where little but the
/// rate gives stress.
std::array<Vector3, full> acoustic(const MaterialBatch& from, const std::array<Vector3, full>& n,
                                   const std::array<Vector3, full>& a, double s, double dt) {
  Increments near, far;
  for (int lane = 0; lane < full; ++lane)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        near[lane](i, j) = s * a[lane][i] * n[lane][j], far[lane](i, j) = 2 * near[lane](i, j);
  const RateFreeStress held(from, Increments{}, dt), once(from, near, dt), twice(from, far, dt);
  std::array<Vector3, full> result;
  for (int lane = 0; lane < full; ++lane) {
    const Matrix3 tau = held.tau(lane), tau_1 = once.tau(lane), tau_2 = twice.tau(lane);
    Matrix3 rate, bend, viscous;
    for (int k = 0; k < 9; ++k) {
      rate.m[k] = (4 * tau_1.m[k] - 3 * tau.m[k] - tau_2.m[k]) / (2 * s);
      bend.m[k] = (tau_2.m[k] - 2 * tau_1.m[k] + tau.m[k]) / s;
      viscous.m[k] = (once.half.tau(lane).m[k] - held.half.tau(lane).m[k] - once.whole.tau(lane).m[k] +
                      held.whole.tau(lane).m[k]) /
                     s;
    }
    result[lane] = {};
    if (contraction(bend, bend) > 1e-6 * contraction(rate, rate)) continue;
    if (contraction(viscous, viscous) > 100 * contraction(rate, rate)) continue;
    result[lane] = product(rate, n[lane]);
    const Vector3 convected = product(tau, n[lane]);
    for (int i = 0; i < 3; ++i) result[lane][i] -= dot(a[lane], n[lane]) * convected[i];
  }
  return result;
}

/// The fastest wave over the reported speed that power iteration over polarisations finds, of strains in steps of `dt`,
/// and how many waves it found.
struct FastestWave {
  Worst tightness;
  int found = 0;
};
FastestWave fastest_wave(const Context& c, const MaterialBatch& from, Random& random, double dt) {
  const double density = parameter_value(c.plugin, c.parameters, "density", 1);
  FastestWave fastest;
  for (int direction = 0; direction < 4; ++direction)
    for (double sign : {1e-5, -1e-5}) {
      std::array<Vector3, full> n, a;
      for (int lane = 0; lane < full; ++lane) n[lane] = random.direction(c.variant.dimension), a[lane] = n[lane];
      if (direction % 2)
        for (Vector3& polarisation : a) polarisation = random.direction(c.variant.dimension);
      for (int iteration = 0; iteration < 6; ++iteration) {
        const std::array<Vector3, full> q = acoustic(from, n, a, sign, dt);
        for (int lane = 0; lane < full; ++lane) {
          const double modulus = dot(a[lane], q[lane]), length = std::sqrt(dot(q[lane], q[lane]));
          fastest.tightness.add(std::sqrt(std::max(0.0, modulus) / density) / from.wave(0, lane), lane);
          if (!(length > 0)) continue;
          ++fastest.found;
          for (int i = 0; i < 3; ++i) a[lane][i] = q[lane][i] / length;
        }
      }
    }
  return fastest;
}

/// Checks that the fastest wave does not outrun the reported speed. A law of small strains answers for small strains.
/// Laws whose stress changes without strain are asked once more after a rest of ages, by strains as slow, where their
/// viscosity gives no stress.
void check_wave_speed(const Context& c, Random& random) {
  if (c.variant.precision != MPM_SCALAR_DOUBLE) return;
  constexpr double ages = 0x1p40;  // s
  const bool finite = is_finite_strain(c.plugin);
  const double strain = finite ? 0.6 : 1e-4;
  const std::vector<Increments> path = random_path(random, c.variant.dimension, 16, strain);
  const MaterialBatch from = after_path(c.plugin, c.variant, c.parameters, path);
  FastestWave fastest = fastest_wave(c, from, random, step);
  MaterialBatch held = from;
  held.advance(Increments{});
  bool jumps = false, pressed = false;
  for (int lane = 0; lane < full; ++lane) {
    jumps |= largest_difference(held.tau(lane), from.tau(lane)) > 1e-12 * c.modulus;
    pressed |= largest_difference(from.tau(lane), {}) > 0;
  }
  if (jumps) {
    held.advance(Increments{}, ages);
    const FastestWave slow = fastest_wave(c, held, random, ages);
    fastest.tightness.add(slow.tightness.value, slow.tightness.lane), fastest.found += slow.found;
  }
  c.findings.require("wave_speed_compared [" + c.variant.name() + "]", fastest.found > 0 || !pressed,
                     "a wave is found where there is stress" + c.where);
  const Worst excess{fastest.tightness.value - 1, fastest.tightness.lane};
  c.findings.at_most("wave_speed_bounds_tangent", c.variant, excess, finite ? 1e-6 : 10 * strain,
                     "tangent wave beyond the reported speed, relative" + c.where);
  c.findings.report("wave_speed_tightness [" + c.variant.name() + "]", fastest.tightness.value,
                    "fastest tangent wave found over reported speed" + c.where);
}

/// Checks that J <= 0 and NaN are reported by the index of the first such particle, and spoil no other.
void check_inadmissible(const Context& c, const std::vector<Increments>& path) {
  const MaterialBatch good = after_path(c.plugin, c.variant, c.parameters, path);
  bool index = true, others = true;
  for (int bad : {0, 5, 17, 63})
    for (double amount : {-1.0, -2.5, std::numeric_limits<double>::quiet_NaN()}) {
      std::vector<Increments> spoiled = path;
      spoiled.back()[bad] = {};
      spoiled.back()[bad](0, 0) = amount;
      spoiled.back()[63] = spoiled.back()[bad];
      MaterialBatch batch = c.batch();
      std::int32_t returned = -1;
      for (const Increments& increments : spoiled) returned = batch.advance(increments);
      index &= returned == bad;
      for (int lane = 0; lane < full; ++lane)
        for (int k = 0; k < c.variant.symmetric(); ++k)
          others &= lane == bad || lane == 63 || batch.stress(k, lane) == good.stress(k, lane);
    }
  c.findings.require("inadmissible_index [" + c.variant.name() + "]", index,
                     "J = 0, J < 0 and NaN return the index of the first such particle" + c.where);
  c.findings.require("inadmissible_isolated [" + c.variant.name() + "]", others,
                     "other particles are not changed by it" + c.where);
}

void compare_batches(const MaterialBatch& a, const MaterialBatch& b, double modulus, Worst& stress, Worst& scalars) {
  for (int lane = 0; lane < full; ++lane) {
    stress.add(largest_difference(a.tau(lane), b.tau(lane)) / modulus, lane);
    scalars.add(std::abs(a.energy(0, lane) - b.energy(0, lane)) / modulus, lane);
    scalars.add(std::abs(a.dissipated(0, lane) - b.dissipated(0, lane)) / modulus, lane);
    scalars.add(std::abs(a.ratio(0, lane) - b.ratio(0, lane)), lane);
  }
}

void check_agreement(const Context& c, const std::vector<Increments>& path) {
  MaterialBatch batch = c.batch(), oracle(c.plugin, {MPM_SCALAR_DOUBLE, c.variant.dimension}, c.parameters);
  Worst stress, scalars, wave;
  for (const Increments& increments : path) {
    batch.advance(increments);
    oracle.advance(increments);
    compare_batches(batch, oracle, c.modulus, stress, scalars);
    for (int lane = 0; lane < full; ++lane) wave.add(std::abs(batch.wave(0, lane) / oracle.wave(0, lane) - 1), lane);
  }
  const double bound = 512 * c.variant.epsilon();
  c.findings.at_most("stress_agrees_with_scalar", c.variant, stress, bound,
                     "|tau - tau of scalar double| over rho c^2" + c.where);
  c.findings.at_most("scalars_agree_with_scalar", c.variant, scalars, bound,
                     "energy, heat over rho c^2, and J" + c.where);
  c.findings.at_most("wave_speed_agrees_with_scalar", c.variant, wave, bound, "relative" + c.where);
}

/// Checks that 2-D is plane strain: stress (zz included), energy, heat and J are those of 3-D.
void check_plane_strain(const Context& c, const std::vector<Increments>& path) {
  if (c.variant.dimension != 2 || !(c.plugin.descriptor->dimensions & MPM_3D)) return;
  MaterialBatch plane = c.batch(), space(c.plugin, {c.variant.precision, 3}, c.parameters);
  Worst stress, scalars;
  for (const Increments& increments : path) {
    plane.advance(increments);
    space.advance(increments);
    compare_batches(plane, space, c.modulus, stress, scalars);
  }
  const double bound = 512 * c.variant.epsilon();
  c.findings.at_most("plane_strain_stress", c.variant, stress, bound,
                     "2-D against 3-D, zz included, over rho c^2" + c.where);
  c.findings.at_most("plane_strain_scalars", c.variant, scalars, bound, "energy, heat, J: 2-D against 3-D" + c.where);
}

/// Checks that an axisymmetric particle, strained around the axis too, is one of 3-D, also where it only evaluates.
void check_axisymmetric(const Context& c, std::vector<Increments> path) {
  const bool strains = traits_of(c.plugin) & MPM_STRAINS_AROUND_AXIS;
  if (!strains || c.variant.dimension != 2 || !(c.plugin.descriptor->dimensions & MPM_3D)) return;
  MaterialBatch ring(c.plugin, c.variant, c.parameters, full, true);
  MaterialBatch space(c.plugin, {c.variant.precision, 3}, c.parameters);
  Worst stress, scalars;
  for (Increments& increments : path) {
    for (int lane = 0; lane < full; ++lane) increments[lane](2, 2) = increments[full - 1 - lane](1, 0);
    ring.advance(increments);
    space.advance(increments);
    compare_batches(ring, space, c.modulus, stress, scalars);
    for (MaterialBatch* batch : {&ring, &space}) batch->evaluate();
    compare_batches(ring, space, c.modulus, stress, scalars);
  }
  const double bound = 512 * c.variant.epsilon();
  c.findings.at_most("axisymmetric_stress", c.variant, stress, bound,
                     "2-D with a velocity_gradient_zz against 3-D, over rho c^2" + c.where);
  c.findings.at_most("axisymmetric_scalars", c.variant, scalars, bound,
                     "energy, heat, J: 2-D with a velocity_gradient_zz against 3-D" + c.where);
}

/// Checks that a particle's result does not depend on which particles share its pack: otherwise runs would differ with
/// the order of particles.
void check_neighbours(const Context& c, const std::vector<Increments>& path) {
  constexpr int shift = 5;
  std::vector<Increments> moved = path;
  for (Increments& increments : moved) std::rotate(increments.begin(), increments.begin() + shift, increments.end());
  const MaterialBatch here = after_path(c.plugin, c.variant, c.parameters, path);
  const MaterialBatch there = after_path(c.plugin, c.variant, c.parameters, moved);
  bool same = true;
  for (int lane = 0; lane < full; ++lane) {
    const int other = (lane + full - shift) % full;
    for (int k = 0; k < c.variant.symmetric(); ++k) same &= here.stress(k, lane) == there.stress(k, other);
    same &= here.energy(0, lane) == there.energy(0, other) && here.wave(0, lane) == there.wave(0, other);
  }
  c.findings.require("independent_of_neighbours [" + c.variant.name() + "]", same,
                     "bit-equal results whichever particles share the pack" + c.where);
}

void check_batches(const Context& c, const Increments& increments) {
  bool guards = true, written = true, inputs = true, same = true, optional = true;
  MaterialBatch reference = c.batch();
  reference.advance(increments);
  for (int count = MPM_LANES; count <= full; count += MPM_LANES) {
    MaterialBatch batch(c.plugin, c.variant, c.parameters, count);
    batch.advance(increments);
    const Array gradient = batch.gradient;
    for (const Array* out : {&batch.stress, &batch.energy, &batch.dissipated, &batch.wave, &batch.ratio})
      guards &= out->guards_intact(), written &= out->all_written();
    for (const Array& field : batch.state) guards &= field.guards_intact();
    inputs &= batch.gradient == gradient && gradient.guards_intact();
    for (int lane = 0; lane < count; ++lane)
      for (int k = 0; k < c.variant.symmetric(); ++k) same &= batch.stress(k, lane) == reference.stress(k, lane);
  }
  for (int left_out = 0; left_out < 5; ++left_out) {
    MaterialBatch batch = c.batch();
    Array* outputs[] = {&batch.stress, &batch.energy, &batch.dissipated, &batch.wave, &batch.ratio};
    *outputs[left_out] = Array();
    batch.advance(increments);
    optional &= left_out == 0 || batch.stress == reference.stress;
    optional &= batch.state == reference.state;
  }
  MaterialBatch evaluated = c.batch();
  evaluated.evaluate();
  for (const Array* out :
       {&evaluated.stress, &evaluated.energy, &evaluated.dissipated, &evaluated.wave, &evaluated.ratio})
    written &= out->all_written();
  const std::string variant = " [" + c.variant.name() + "]";
  c.findings.require("writes_inside_arrays" + variant, guards, "guards around outputs and state" + c.where);
  c.findings.require("writes_every_output" + variant, written,
                     "every output that is not null, with and without a gradient" + c.where);
  c.findings.require("inputs_untouched" + variant, inputs, "velocity gradient" + c.where);
  c.findings.require("independent_of_batch" + variant, same, "counts of 16 to 64" + c.where);
  c.findings.require("outputs_optional" + variant, optional, "any output may be null" + c.where);
}

}  // namespace

/// The stiffness rho c^2 at rest: the size by which stress and energy errors are judged.
double stiffness(const Plugin& plugin, const Variant& v, const ParameterSample& parameters) {
  MaterialBatch rest(plugin, {MPM_SCALAR_DOUBLE, v.dimension}, parameters, MPM_LANES);
  rest.evaluate();
  return parameter_value(plugin, parameters, "density", 1) * rest.wave(0, 0) * rest.wave(0, 0);
}

/// Makes `steps` increments that wander around one direction a lane and add up to `strain`; every fourth lane strains
/// little, so that packs hold particles that yield beside some that do not.
std::vector<Increments> random_path(Random& random, int dimension, int steps, double strain) {
  Increments direction;
  for (Matrix3& d : direction) d = random.matrix(dimension, 1);
  std::vector<Increments> path(static_cast<std::size_t>(steps));
  for (Increments& increments : path)
    for (int lane = 0; lane < full; ++lane)
      increments[lane] = scaled(sum(direction[lane], random.matrix(dimension, 1)),
                                (lane % 4 == 3 ? 0.5 * (lane % 16 + 1) / 64 : 0.5) * strain / steps);
  for (Increments& increments : path)
    for (Matrix3& increment : increments)
      for (double& entry : increment.m) entry = static_cast<float>(entry);
  return path;
}

MaterialBatch after_path(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                         const std::vector<Increments>& path) {
  MaterialBatch batch(plugin, v, parameters);
  for (const Increments& increments : path) batch.advance(increments);
  return batch;
}

void check_material(const Plugin& plugin, Findings& findings) {
  const unsigned traits = traits_of(plugin);
  Random random(20240604);
  for (const ParameterSample& parameters : sample_parameters(plugin, random))
    for (const Variant& v : variants_of(*plugin.descriptor)) {
      findings.running("rest", v, "; " + parameters.text);
      const Context c{plugin, v, parameters, stiffness(plugin, v, parameters), "; " + parameters.text, findings};
      const std::vector<Increments> path = random_path(random, v.dimension, 16, 0.4);
      check_rest(c);
      findings.running("path of large strain", v, c.where);
      check_path(c, path);
      check_units(c, path);
      findings.running("stress from energy and objectivity", v, c.where);
      if (traits & MPM_HYPERELASTIC) check_hyperelastic(c, path);
      if (traits & MPM_OBJECTIVE) check_objective(c, path, random);
      findings.running("energy balance", v, c.where);
      check_energy_balance(c, random);
      findings.running("closed paths", v, c.where);
      check_closed_paths(c);
      findings.running("elastic strains", v, c.where);
      Random own(20261130);
      check_elastic_strains(c, own);
      findings.running("wave speed", v, c.where);
      check_wave_speed(c, random);
      findings.running("inadmissible states", v, c.where);
      check_inadmissible(c, path);
      findings.running("agreement with scalar", v, c.where);
      check_agreement(c, path);
      findings.running("plane strain", v, c.where);
      check_plane_strain(c, path);
      findings.running("strain around an axis", v, c.where);
      check_axisymmetric(c, path);
      findings.running("neighbours", v, c.where);
      check_neighbours(c, path);
      findings.running("batches", v, c.where);
      check_batches(c, path.front());
      check_material_extensions(c, path);
    }
}

}  // namespace mpm::conformance

// Checks of what a material offers beyond its core table: trial, tangent, projection, temperature, cell size.

#include <algorithm>
#include <cstring>

#include "conformance/material_batch.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::conformance {
namespace {

/// Gives a batch temperatures about the reference, the same for every batch; none where the material takes none.
void heat(MaterialBatch& batch, double spread = 40) {
  const auto* table = extension_of<mpm_material_temperature>(batch.plugin);
  if (!table) return;
  batch.temperature = Array(element_of(batch.variant), 1, static_cast<std::uint32_t>(batch.count));
  for (int lane = 0; lane < batch.count; ++lane)
    batch.temperature.set(0, lane, table->reference + static_cast<float>(spread * (lane % 8 - 3.5) / 3.5));
}

std::vector<void*> pointers(std::vector<Array>& fields) {
  std::vector<void*> result;
  for (Array& field : fields) result.push_back(field.data());
  return result;
}

/// A batch at the end of a path; in axisymmetric scenes it strains around the axis as well.
MaterialBatch at_end(const Context& c, std::vector<Increments> path, bool axisymmetric) {
  MaterialBatch batch(c.plugin, c.variant, c.parameters, full, axisymmetric);
  heat(batch);
  for (Increments& increments : path) {
    for (int lane = 0; lane < full; ++lane) increments[lane](2, 2) = increments[full - 1 - lane](1, 0);
    batch.advance(increments);
  }
  return batch;
}

// ---- trial -------------------------------------------------------------------------------------------------------

/// What the trial of a batch fills.
struct Trial {
  std::int32_t index = 0;
  Array stress, energy;
  std::vector<Array> state;
};

Trial trial_of(MaterialBatch& batch, const void* velocity_gradient, bool with_state) {
  Trial trial;
  trial.stress = Array(element_of(batch.variant), batch.variant.symmetric(), static_cast<std::uint32_t>(batch.count));
  trial.energy = Array(element_of(batch.variant), 1, static_cast<std::uint32_t>(batch.count));
  for (const Array& field : batch.state)
    trial.state.emplace_back(element_of(batch.variant), field.components(), static_cast<std::uint32_t>(batch.count));
  const std::vector<void*> from = pointers(batch.state), to = pointers(trial.state);
  mpm_trial_batch request{};
  request.count = static_cast<std::uint32_t>(batch.count), request.stride = batch.gradient.stride();
  request.dimension = static_cast<std::uint32_t>(batch.variant.dimension);
  request.dt = step;
  request.velocity_gradient = velocity_gradient;
  request.velocity_gradient_zz = batch.axisymmetric ? batch.hoop.data() : nullptr;
  request.temperature = batch.temperature.data();
  request.state = from.data();
  request.trial_state = with_state ? to.data() : nullptr;
  request.kirchhoff_stress = trial.stress.data();
  request.stored_energy = trial.energy.data();
  const auto* table = extension_of<mpm_material_trial>(batch.plugin);
  trial.index =
      table->evaluate[batch.variant.precision][batch.variant.dimension - 2](batch.parameters.data(), &request);
  return trial;
}

/// Number of entries in which two arrays differ.
int differences(const Array& a, const Array& b, int count) {
  int different = 0;
  for (int k = 0; k < a.components(); ++k)
    for (int lane = 0; lane < count; ++lane)
      different += std::memcmp(std::array{a(k, lane)}.data(), std::array{b(k, lane)}.data(), sizeof(double)) != 0;
  return different;
}

void check_trial(const Context& c, const std::vector<Increments>& path, bool axisymmetric) {
  if (!extension_of<mpm_material_trial>(c.plugin)) return;
  const MaterialBatch from = at_end(c, path, axisymmetric);
  int different = 0;
  bool kept = true, guards = true;
  for (const bool strained : {true, false}) {
    Increments increments = path.front();
    increments[5] = {}, increments[5](0, 0) = -1.5;  // this one is turned inside out: its index is the answer
    MaterialBatch updated = from, tried = from;
    for (MaterialBatch* batch : {&updated, &tried}) batch->strain_by(increments);
    const std::int32_t index = updated.update(strained ? updated.gradient.data() : nullptr, step);
    for (const bool with_state : {true, false}) {
      const Trial trial = trial_of(tried, strained ? tried.gradient.data() : nullptr, with_state);
      different += differences(trial.stress, updated.stress, full) + differences(trial.energy, updated.energy, full);
      different += trial.index != index;
      for (std::size_t k = 0; k < trial.state.size(); ++k) {
        if (with_state) different += differences(trial.state[k], updated.state[k], full);
        guards &= trial.state[k].guards_intact();
      }
      guards &= trial.stress.guards_intact() && trial.energy.guards_intact();
      kept &= tried.state == from.state;
    }
  }
  const std::string name = " [" + c.variant.name() + "]";
  c.findings.at_most("trial_equals_update" + name, different, 0,
                     "entries of stress, energy, state and index other than an update of a copy gives" + c.where);
  c.findings.require("trial_keeps_state" + name, kept, "the state that a trial starts from" + c.where);
  c.findings.require("trial_writes_inside_arrays" + name, guards, "guards around outputs" + c.where);
}

// ---- tangent -----------------------------------------------------------------------------------------------------

/// The tangent d tau / ds of tau(increments + s direction), as the plugin gives it.
Array tangent_of(MaterialBatch& batch, const Increments& increments, const Increments& direction) {
  const Element element = element_of(batch.variant);
  const std::uint32_t n = static_cast<std::uint32_t>(batch.count);
  MaterialBatch along = batch;
  batch.strain_by(increments);
  along.strain_by(direction);
  Array change(element, batch.variant.symmetric(), n);
  const std::vector<void*> state = pointers(batch.state);
  mpm_tangent_batch request{};
  request.count = n, request.stride = batch.gradient.stride();
  request.dimension = static_cast<std::uint32_t>(batch.variant.dimension);
  request.dt = step;
  request.velocity_gradient = batch.gradient.data();
  request.direction = along.gradient.data();
  if (batch.axisymmetric) request.velocity_gradient_zz = batch.hoop.data(), request.direction_zz = along.hoop.data();
  request.temperature = batch.temperature.data();
  request.state = state.data();
  request.stress_change = change.data();
  const auto* table = extension_of<mpm_material_tangent>(batch.plugin);
  table->evaluate[batch.variant.precision][batch.variant.dimension - 2](batch.parameters.data(), &request);
  return change;
}

Increments plus(const Increments& a, const Increments& b, double factor) {
  Increments r;
  for (int lane = 0; lane < full; ++lane) r[lane] = sum(a[lane], scaled(b[lane], factor));
  return r;
}

/// The error of a tangent against differences of the stress: the central one, or that of one side, as a law with a kink
/// has the tangent of one side, beyond what the stress bends by within `put_apart`, by which functors of singular values
/// hold equal stretches apart. Where both sides disagree by much (a yield surface) the particle is left out, as a
/// difference may then hold some of both.
struct TangentError {
  Worst error;
  int compared = 0;
};
TangentError tangent_error(const Context& c, const MaterialBatch& from, const Increments& increments,
                           const Increments& direction) {
  constexpr double h = 0x1p-23, put_apart = 0x1p-26;
  MaterialBatch here = from, ahead = from, behind = from, asked = from;
  here.advance(increments);
  ahead.advance(plus(increments, direction, h));
  behind.advance(plus(increments, direction, -h));
  const Array tangent = tangent_of(asked, increments, direction);
  TangentError result;
  for (int lane = 0; lane < full; ++lane) {
    double kink = 0, size = c.modulus, central = 0, ahead_only = 0, behind_only = 0;
    bool finite = true;
    for (int k = 0; k < c.variant.symmetric(); ++k) {
      const double forward = (ahead.stress(k, lane) - here.stress(k, lane)) / h;
      const double backward = (here.stress(k, lane) - behind.stress(k, lane)) / h;
      kink = std::max(kink, std::abs(forward - backward));
      size = std::max(size, std::abs(tangent(k, lane)));
      central = std::max(central, std::abs(tangent(k, lane) - 0.5 * (forward + backward)));
      ahead_only = std::max(ahead_only, std::abs(tangent(k, lane) - forward));
      behind_only = std::max(behind_only, std::abs(tangent(k, lane) - backward));
      finite &= std::isfinite(tangent(k, lane));
    }
    if (kink > 1e-3 * size && finite) continue;
    ++result.compared;
    const double error = std::min({central, ahead_only, behind_only}) - kink * put_apart / h;
    result.error.add(finite ? std::max(error, 0.0) / size : std::nan(""), lane);
  }
  return result;
}

/// Checks tangents from rest (where singular values are equal), under pure pressure (where they stay so), and at the
/// end of a path.
void check_tangent_differences(const Context& c, const std::vector<Increments>& path, Random& random,
                               bool axisymmetric) {
  MaterialBatch rest(c.plugin, c.variant, c.parameters, full, axisymmetric);
  heat(rest);
  Increments none{}, pressed{}, direction;
  for (int lane = 0; lane < full; ++lane) {
    const double strain = -1e-3 * (lane + 1);
    for (int i = 0; i < c.variant.dimension + (axisymmetric ? 1 : 0); ++i) pressed[lane](i, i) = strain;
    direction[lane] = random.matrix(c.variant.dimension, 1);
    if (axisymmetric) direction[lane](2, 2) = random.uniform(-1, 1);
  }
  const TangentError errors[] = {tangent_error(c, rest, none, direction), tangent_error(c, rest, pressed, direction),
                                 tangent_error(c, at_end(c, path, axisymmetric), path.front(), direction)};
  Worst worst;
  for (const TangentError& one : errors) worst.add(one.error.value, one.error.lane);
  const std::string name = axisymmetric ? "tangent_around_axis" : "tangent_is_derivative";
  c.findings.at_most(name, c.variant, worst, 1e-6,
                     "|dtau - difference of tau| over rho c^2, at rest, pressed and along a path" + c.where);
  c.findings.at_most(name + "_compared [" + c.variant.name() + "]", std::max(0, full / 2 - errors[2].compared), 0,
                     "particles short of half that lie on no kink at the end of a path" + c.where);
}

/// Checks packs against the plain scalar: double to the error of equal singular values put apart, float as often as
/// both take the same side of a yield surface.
void check_tangent_agrees(const Context& c, const std::vector<Increments>& path, Random& random) {
  const Variant scalar{MPM_SCALAR_DOUBLE, c.variant.dimension};
  const Context oracle{c.plugin, scalar, c.parameters, c.modulus, c.where, c.findings};
  MaterialBatch packs = at_end(c, path, false), plain = at_end(oracle, path, false);
  Increments direction;
  for (Matrix3& d : direction) d = random.matrix(c.variant.dimension, 1);
  const Array a = tangent_of(packs, path.front(), direction), b = tangent_of(plain, path.front(), direction);
  Worst worst;
  int apart = 0;
  for (int lane = 0; lane < full; ++lane) {
    double error = 0, size = c.modulus;
    for (int k = 0; k < c.variant.symmetric(); ++k) {
      size = std::max(size, std::abs(b(k, lane)));
      error = std::max(error, std::abs(a(k, lane) - b(k, lane)));
    }
    worst.add(error / size, lane);
    apart += !(error <= 1e-2 * size);
  }
  constexpr int most_apart = full / 16;
  if (c.variant.single())
    c.findings.at_most("tangent_agrees_with_scalar [" + c.variant.name() + "]", apart, most_apart,
                       "particles whose dtau differs by 1 % of rho c^2" + c.where);
  else
    c.findings.at_most("tangent_agrees_with_scalar", c.variant, worst, 1e-6, "over rho c^2" + c.where);
}

void check_tangent(const Context& c, const std::vector<Increments>& path, Random& random, bool axisymmetric) {
  const auto* table = extension_of<mpm_material_tangent>(c.plugin);
  if (!table) return;
  const auto entry = table->evaluate[c.variant.precision][c.variant.dimension - 2];
  c.findings.require("tangent_or_reason [" + c.variant.name() + "]",
                     table->refusal ? *table->refusal && !entry : !!entry,
                     table->refusal ? table->refusal : "an entry for every precision and dimension");
  if (!entry) return;
  if (c.variant.precision == MPM_SCALAR_DOUBLE)
    check_tangent_differences(c, path, random, axisymmetric);
  else if (!axisymmetric && (c.plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1))
    check_tangent_agrees(c, path, random);
}

// ---- projection --------------------------------------------------------------------------------------------------

std::int32_t project(MaterialBatch& batch) {
  const std::vector<void*> state = pointers(batch.state);
  mpm_projection_batch request{};
  request.count = static_cast<std::uint32_t>(batch.count), request.stride = batch.gradient.stride();
  request.dimension = static_cast<std::uint32_t>(batch.variant.dimension);
  request.axisymmetric = batch.axisymmetric;
  request.temperature = batch.temperature.data();
  request.state = state.data();
  const auto* table = extension_of<mpm_material_projection>(batch.plugin);
  const auto entry = table->project[batch.variant.precision][batch.variant.dimension - 2];
  return entry(batch.parameters.data(), &request);
}

/// Strains what the material keeps of F without asking the law: a deformation becomes f F, a symmetric tensor f b f^T.
/// Returns false where no field starts as the identity.
bool strain_beyond_law(MaterialBatch& batch, const Increments& f) {
  const int D = batch.variant.dimension;
  bool found = false;
  for (std::size_t field = 0; field < batch.state.size(); ++field) {
    const mpm_state& row = batch.plugin.state()[field];
    if (row.initial != MPM_INITIAL_IDENTITY) continue;
    found = true;
    Array& array = batch.state[field];
    for (int lane = 0; lane < batch.count; ++lane) {
      if (row.shape == MPM_STATE_SYMMETRIC) {  // the strain keeps the volume: such tensors may be isochoric by law
        Matrix3 isochoric = f[lane];
        const double factor = std::pow(determinant(f[lane]), -1.0 / D);
        for (int i = 0; i < D; ++i)
          for (int j = 0; j < D; ++j) isochoric(i, j) *= factor;
        const Matrix3 b = isochoric * batch.symmetric(array, lane) * transposed(isochoric);
        for (int k = 0; k < 3; ++k) array.set(k, lane, b(k, k));
        if (D == 2)
          array.set(3, lane, b(0, 1));
        else
          array.set(3, lane, b(1, 2)), array.set(4, lane, b(0, 2)), array.set(5, lane, b(0, 1));
      } else {
        Matrix3 F = Matrix3::identity();
        for (int i = 0; i < D; ++i)
          for (int j = 0; j < D; ++j) F(i, j) = array(i * D + j, lane);
        F = f[lane] * F;
        for (int i = 0; i < D; ++i)
          for (int j = 0; j < D; ++j) array.set(i * D + j, lane, F(i, j));
      }
    }
  }
  return found;
}

void check_projection(const Context& c, const std::vector<Increments>& path, Random& random) {
  if (!extension_of<mpm_material_projection>(c.plugin)) return;
  const auto largest_change = [&](const MaterialBatch& a, const MaterialBatch& b, const Increments& Q) {
    Worst worst;
    for (int lane = 0; lane < full; ++lane)
      worst.add(largest_difference(b.tau(lane), Q[lane] * a.tau(lane) * transposed(Q[lane])) / c.modulus, lane);
    return worst;
  };
  Increments same, f, Q;
  same.fill(Matrix3::identity());
  for (int lane = 0; lane < full; ++lane) {
    f[lane] = sum(Matrix3::identity(), random.matrix(c.variant.dimension, 0.2));
    Q[lane] = random.rotation(c.variant.dimension);
  }
  MaterialBatch admissible = at_end(c, path, false), kept = admissible;
  admissible.evaluate(), project(kept), kept.evaluate();
  const double bound = 512 * c.variant.epsilon();
  c.findings.at_most("projection_keeps_admissible", c.variant, largest_change(admissible, kept, same), bound,
                     "change of stress of states that updates reach, over rho c^2" + c.where);

  MaterialBatch trial = at_end(c, path, false);
  const bool found = strain_beyond_law(trial, f);
  c.findings.require("projection_state", found, "a state field that starts as the identity holds what is projected");
  if (!found) return;
  MaterialBatch turned = trial, once = trial;
  strain_beyond_law(turned, Q);
  const std::int32_t index = project(once);
  MaterialBatch twice = once, rested = once;
  project(twice), project(turned);
  trial.evaluate(), once.evaluate(), twice.evaluate(), turned.evaluate();
  rested.advance(Increments{});
  Worst gained, released;
  for (int lane = 0; lane < full; ++lane) {
    gained.add((once.energy(0, lane) - trial.energy(0, lane)) / c.modulus, lane);
    released.add(rested.dissipated(0, lane) / c.modulus, lane);
  }
  c.findings.require("projection_index [" + c.variant.name() + "]", index == -1,
                     "of trial states with J > 0" + c.where);
  c.findings.at_most("projection_once", c.variant, largest_change(once, twice, same), bound,
                     "change of stress by a second projection, over rho c^2" + c.where);
  c.findings.at_most("projection_is_admissible", c.variant, released, bound,
                     "heat of an update without strain afterwards, over rho c^2" + c.where);
  c.findings.at_most("projection_lowers_energy", c.variant, gained, bound, "energy gained, over rho c^2" + c.where);
  if (c.plugin.material().traits & MPM_OBJECTIVE)
    c.findings.at_most("projection_objective", c.variant, largest_change(once, turned, Q), 4 * bound,
                       "|tau of Q F - Q tau Q^T| over rho c^2" + c.where);
}

// ---- temperature and cell size -----------------------------------------------------------------------------------

/// Checks that without temperatures the reference one counts, and that others change something.
void check_temperature(const Context& c, const std::vector<Increments>& path) {
  const auto* table = extension_of<mpm_material_temperature>(c.plugin);
  if (!table) return;
  c.findings.require("reference_temperature", table->reference > 0 && std::isfinite(table->reference), "K, above 0");
  const auto run = [&](double spread) {
    MaterialBatch batch = c.batch();
    if (spread >= 0) heat(batch, spread);
    for (const Increments& increments : path) batch.advance(increments);
    return batch;
  };
  const MaterialBatch absent = run(-1), reference = run(0), heated = run(40);
  const std::string name = " [" + c.variant.name() + "]";
  c.findings.require("absent_temperature_is_reference" + name,
                     absent.stress == reference.stress && absent.state == reference.state,
                     "bit-equal with null and with the reference everywhere" + c.where);
  c.findings.require("temperature_matters" + name, !(heated.stress == reference.stress),
                     "stress 40 K above and below the reference" + c.where);
}

/// Checks that the place in the block is nobody else's, and that another size changes something.
void check_cell_size(const Context& c, const std::vector<Increments>& path) {
  const auto* table = extension_of<mpm_material_cell_size>(c.plugin);
  if (!table) return;
  bool own = true;
  for (const mpm_parameter& parameter : c.plugin.parameters()) own &= parameter.offset != table->offset;
  c.findings.require("cell_size_has_own_place", own, "no declared parameter lies there");
  ParameterSample fine = c.parameters;  // laws that soften refuse cells above a size
  fine.block[table->offset / sizeof(double)] *= 0.5;
  const MaterialBatch here = after_path(c.plugin, c.variant, c.parameters, path);
  const MaterialBatch there = after_path(c.plugin, c.variant, fine, path);
  c.findings.require("cell_size_matters [" + c.variant.name() + "]",
                     !(here.stress == there.stress && here.wave == there.wave),
                     "stress or wave speed on cells of half the size" + c.where);
}

/// Checks that a law that makes energy says where, and that its heat is read at all.
void check_makes_energy(const Context& c) {
  const auto* table = extension_of<mpm_material_makes_energy>(c.plugin);
  if (!table) return;
  c.findings.require("makes_energy_says_where", table->where && *table->where, "in one sentence");
  c.findings.require("makes_energy_dissipates", c.plugin.material().traits & MPM_DISSIPATES,
                     "hosts read the heat of materials with MPM_DISSIPATES alone");
}

/// Checks that a law which names the cause of its dissipation names one that the ledger has, and dissipates.
void check_dissipation(const Context& c) {
  const auto* table = extension_of<mpm_material_dissipation>(c.plugin);
  if (!table) return;
  c.findings.require("dissipation_cause_known",
                     table->cause >= std::uint32_t{MPM_PLASTIC_WORK} && table->cause <= std::uint32_t{MPM_DAMAGE},
                     "an mpm_dissipation_cause");
  c.findings.require("dissipation_cause_dissipates", c.plugin.material().traits & MPM_DISSIPATES,
                     "hosts read the heat of materials with MPM_DISSIPATES alone");
}

/// Checks that clamps have names, and that none acts that is not declared or cannot act with these parameters.
void check_clamps(const Context& c, const std::vector<Increments>& path) {
  const auto* table = extension_of<mpm_material_clamps>(c.plugin);
  if (!table || element_of(c.variant) != Element::double_precision) return;
  bool named = table->count > 0 && table->count <= MPM_CLAMPS && table->clamps;
  for (std::uint32_t k = 0; named && k < table->count; ++k) {
    const mpm_clamp& clamp = table->clamps[k];
    named = clamp.where && *clamp.where && clamp.unit && clamp.what && *clamp.what;
  }
  c.findings.require("clamps_are_named", named, "where each begins, its unit and what it does");
  if (!named) return;
  std::vector<double> bound(table->count);
  table->bounds(c.parameters.data(), bound.data());
  std::uint32_t possible = 0;
  for (std::uint32_t k = 0; k < table->count; ++k) possible |= std::isnan(bound[k]) ? 0u : 1u << k;
  const bool around_axis = c.variant.dimension == 2 && (c.plugin.material().traits & MPM_STRAINS_AROUND_AXIS);
  for (const bool axisymmetric : {false, true}) {
    if (axisymmetric && !around_axis) continue;
    MaterialBatch batch = at_end(c, path, axisymmetric);
    const std::vector<Array> before = batch.state;
    const std::vector<void*> state = pointers(batch.state);
    std::vector<std::uint32_t> acting(batch.gradient.stride(), ~0u);
    mpm_clamp_batch request{};
    request.count = static_cast<std::uint32_t>(batch.count), request.stride = batch.gradient.stride();
    request.dimension = static_cast<std::uint32_t>(c.variant.dimension), request.axisymmetric = axisymmetric;
    request.temperature = batch.temperature.data();
    request.state = state.data(), request.acting = acting.data();
    table->find[c.variant.dimension - 2](c.parameters.data(), &request);
    bool possible_alone = true;
    for (int lane = 0; lane < batch.count; ++lane) possible_alone &= (acting[lane] & ~possible) == 0;
    const std::string name = " [" + c.variant.name() + (axisymmetric ? " axisymmetric]" : "]");
    c.findings.require("clamps_can_act" + name, possible_alone,
                       "no bit of a clamp that is not declared, or whose bound is not a number" + c.where);
    c.findings.require("clamps_keep_state" + name, batch.state == before, "bit-equal" + c.where);
  }
}

}  // namespace

void check_material_extensions(const Context& c, const std::vector<Increments>& path) {
  Random random(20240611);
  const bool around_axis = c.variant.dimension == 2 && (c.plugin.material().traits & MPM_STRAINS_AROUND_AXIS);
  for (const bool axisymmetric : {false, true}) {
    if (axisymmetric && !around_axis) continue;
    c.findings.running("trial", c.variant, c.where);
    check_trial(c, path, axisymmetric);
    c.findings.running("tangent", c.variant, c.where);
    check_tangent(c, path, random, axisymmetric);
  }
  c.findings.running("projection", c.variant, c.where);
  check_projection(c, path, random);
  c.findings.running("temperature and cell size", c.variant, c.where);
  check_temperature(c, path);
  check_cell_size(c, path);
  check_makes_energy(c);
  check_dissipation(c);
  c.findings.running("clamps", c.variant, c.where);
  check_clamps(c, path);
}

}  // namespace mpm::conformance

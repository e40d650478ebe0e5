// Checks of velocity filters: passes, a uniform motion is kept, nodes do not mix, agreement of all instantiations.

#include <algorithm>
#include <array>

#include "conformance/support.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::conformance {
namespace {

/// One call of the plugin with all its arrays.
struct FilterBatch {
  Variant variant;
  int count;
  Array projected, increment, velocity;

  FilterBatch(const Variant& v, int entries) : variant(v), count(entries) {
    for (Array* array : {&projected, &increment, &velocity})
      *array = Array(element_of(v), v.dimension, static_cast<std::uint32_t>(entries));
  }

  void update(const Plugin& plugin, const ParameterSample& parameters, int iteration) {
    mpm_filter_batch batch{};
    batch.count = static_cast<std::uint32_t>(count);
    batch.stride = projected.stride();
    batch.dimension = static_cast<std::uint32_t>(variant.dimension);
    batch.iteration = static_cast<std::uint32_t>(iteration);
    batch.projected = projected.data();
    batch.increment = increment.data();
    batch.velocity = velocity.data();
    plugin.filter().update[variant.precision][variant.dimension - 2](parameters.data(), &batch);
  }
};

/// Projected, increment and velocity of every node, m/s.
struct FilterInput {
  std::array<std::array<Vector3, full>, 3> field{};
};

FilterInput random_input(Random& random, int dimension) {
  FilterInput input;
  for (auto& field : input.field)
    for (Vector3& v : field)
      for (int i = 0; i < dimension; ++i) v[i] = random.uniform(-1, 1);
  return input;
}

FilterBatch loaded(const Variant& v, const FilterInput& input, int count = full, int shift = 0) {
  FilterBatch batch(v, count);
  Array* const arrays[] = {&batch.projected, &batch.increment, &batch.velocity};
  for (std::size_t f = 0; f < 3; ++f)
    for (int lane = 0; lane < count; ++lane)
      for (int i = 0; i < v.dimension; ++i)
        arrays[f]->set(i, lane, input.field[f][static_cast<std::size_t>((lane + shift) % full)][i]);
  return batch;
}

FilterBatch updated(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const FilterInput& input,
                    int iteration, int count = full, int shift = 0) {
  FilterBatch batch = loaded(v, input, count, shift);
  batch.update(plugin, parameters, iteration);
  return batch;
}

/// Largest difference of what two updates wrote, lane against lane + shift.
Worst difference(const FilterBatch& a, const FilterBatch& b, int shift = 0) {
  Worst worst;
  for (int lane = 0; lane < std::min(a.count, b.count); ++lane)
    for (int i = 0; i < a.variant.dimension; ++i) {
      const int other = (lane + shift) % full;
      worst.add(std::abs(a.increment(i, lane) - b.increment(i, other)), lane);
      worst.add(std::abs(a.velocity(i, lane) - b.velocity(i, other)), lane);
    }
  return worst;
}

/// Checks uniform motion: where everything moves alike the projection changes nothing, and no increment may be left to
/// add.
void check_translation(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, Random& random,
                       int iteration, const std::string& where, Findings& findings) {
  FilterInput uniform;
  const Vector3 c = random.direction(v.dimension);
  for (auto& field : uniform.field)
    for (Vector3& value : field)
      for (int i = 0; i < v.dimension; ++i) value[i] = static_cast<float>(c[i]);
  const FilterBatch batch = updated(plugin, v, parameters, uniform, iteration);
  Worst change;
  for (int lane = 0; lane < full; ++lane)
    for (int i = 0; i < v.dimension; ++i) change.add(std::abs(batch.velocity(i, lane) - uniform.field[2][0][i]), lane);
  findings.at_most("uniform_motion_kept", v, change, 4 * v.epsilon(),
                   "change of a uniform velocity whose projection is itself" + where);
}

/// How far u(a + b) differs from u(a) + u(b). It is only reported, since a filter may be nonlinear.
double nonlinearity(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const FilterInput& a,
                    const FilterInput& b, int iteration) {
  FilterInput both = a;
  for (std::size_t f = 0; f < 3; ++f)
    for (std::size_t lane = 0; lane < full; ++lane)
      for (int i = 0; i < v.dimension; ++i) both.field[f][lane][i] += b.field[f][lane][i];
  const FilterBatch u = updated(plugin, v, parameters, a, iteration), w = updated(plugin, v, parameters, b, iteration);
  FilterBatch sum = u;
  for (int lane = 0; lane < full; ++lane)
    for (int i = 0; i < v.dimension; ++i) {
      sum.increment.set(i, lane, u.increment(i, lane) + w.increment(i, lane));
      sum.velocity.set(i, lane, u.velocity(i, lane) + w.velocity(i, lane));
    }
  return difference(updated(plugin, v, parameters, both, iteration), sum).value;
}

/// Checks that writes stay inside the arrays at every batch size, that a node's result is its own, and that the
/// projection stays as it was.
void check_batches(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const FilterInput& input,
                   int iteration, const std::string& where, Findings& findings) {
  constexpr int shift = 5;
  const FilterBatch reference = updated(plugin, v, parameters, input, iteration);
  bool guards = true, finite = true, inputs = true, same = true;
  for (int count = MPM_LANES; count <= full; count += MPM_LANES) {
    const FilterBatch b = updated(plugin, v, parameters, input, iteration, count);
    for (const Array* out : {&b.increment, &b.velocity}) guards &= out->guards_intact();
    inputs &= b.projected == loaded(v, input, count).projected;
    same &= difference(b, reference).value == 0;
    for (int lane = 0; lane < count; ++lane)
      for (int i = 0; i < v.dimension; ++i)
        finite &= std::isfinite(b.increment(i, lane)) && std::isfinite(b.velocity(i, lane));
  }
  const FilterBatch moved = updated(plugin, v, parameters, input, iteration, full, shift);
  findings.require("writes_inside_arrays [" + v.name() + "]", guards, "guards around increment and velocity" + where);
  findings.require("finite [" + v.name() + "]", finite, "increment and velocity of finite input" + where);
  findings.require("inputs_untouched [" + v.name() + "]", inputs, "the projection" + where);
  findings.require("independent_of_batch [" + v.name() + "]", same, "counts of 16 to 64" + where);
  findings.require("independent_of_neighbours [" + v.name() + "]", difference(moved, reference, shift).value == 0,
                   "bit-equal results whichever nodes share the batch" + where);
}

/// The largest gain of one mode by the whole loop. The grid keeps `kept` of the mode in a round trip; the gain is the
/// velocity that an increment of 1, which stands alone, ends as.
double largest_gain(const Plugin& plugin, const ParameterSample& parameters, std::int32_t passes) {
  const Variant v{MPM_SCALAR_DOUBLE, 2};
  FilterBatch batch(v, full);
  for (Array* array : {&batch.projected, &batch.increment, &batch.velocity})
    for (int lane = 0; lane < full; ++lane)
      for (int i = 0; i < 2; ++i) array->set(i, lane, 1);
  for (std::int32_t pass = 1; pass <= passes; ++pass) {
    for (int lane = 0; lane < full; ++lane)
      for (int i = 0; i < 2; ++i) batch.projected.set(i, lane, batch.increment(i, lane) * lane / (full - 1));
    batch.update(plugin, parameters, pass);
  }
  double gain = 0;
  for (int lane = 0; lane < full; ++lane) gain = std::max(gain, std::abs(batch.velocity(0, lane)));
  return gain;
}

/// Checks the step limit: a filter after the forces multiplies the stiffness of a mode by its gain, and the stable step
/// by one over the root of the gain.
void check_step_limit(const Plugin& plugin, const ParameterSample& parameters, std::int32_t passes,
                      const std::string& where, Findings& findings) {
  const auto* table = extension_of<mpm_filter_step_limit>(plugin);
  const bool scalar =
      (plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1) && (plugin.descriptor->dimensions & MPM_2D);
  const bool after = !(plugin.filter().traits & MPM_FILTERS_BEFORE_FORCES);
  if (table) {
    const double limit = table->limit(parameters.data(), 1), twice = table->limit(parameters.data(), 2);
    findings.require("step_limit_shortens", limit > 0 && limit <= 1, "of a step of 1 s, in s" + where);
    findings.at_most("step_limit_proportional", std::abs(twice / limit - 2), 1e-12, "to the unfiltered step" + where);
  }
  if (!after || !scalar) return;
  const double gain = largest_gain(plugin, parameters, passes), limit = table ? table->limit(parameters.data(), 1) : 1;
  findings.at_most("step_limit_covers_gain", gain * limit * limit, 1 + 1e-12,
                   "square of the step over the stable one, of the mode that the filter amplifies most" + where);
}

}  // namespace

void check_filter(const Plugin& plugin, Findings& findings) {
  findings.require("iterations_entry", plugin.filter().iterations != nullptr, "tells how many passes it wants");
  if (!plugin.filter().iterations) return;
  Random random(20240608);
  for (const ParameterSample& parameters : sample_parameters(plugin, random)) {
    const std::string where = parameters.text.empty() ? "" : "; " + parameters.text;
    findings.running("number of passes" + where);
    const std::int32_t passes = plugin.filter().iterations(parameters.data());
    findings.require("iterations_not_negative", passes >= 0, std::to_string(passes) + " passes" + where);
    findings.require("iterations_repeatable", passes == plugin.filter().iterations(parameters.data()),
                     "the same answer at every call" + where);
    findings.running("limit of the step" + where);
    check_step_limit(plugin, parameters, passes, where, findings);
    for (const Variant& v : variants_of(*plugin.descriptor))
      for (int iteration : {1, 2, 7}) {
        const FilterInput input = random_input(random, v.dimension), other = random_input(random, v.dimension);
        findings.running("uniform motion", v, where);
        check_translation(plugin, v, parameters, random, iteration, where, findings);
        findings.running("batches", v, where);
        check_batches(plugin, v, parameters, input, iteration, where, findings);
        findings.report("nonlinearity [" + v.name() + "]", nonlinearity(plugin, v, parameters, input, other, iteration),
                        "|u(a + b) - u(a) - u(b)|" + where);
        if (v.precision == MPM_SCALAR_DOUBLE || !(plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1)) continue;
        findings.running("agreement with scalar", v, where);
        const Variant oracle{MPM_SCALAR_DOUBLE, v.dimension};
        findings.at_most("agrees_with_scalar", v,
                         difference(updated(plugin, v, parameters, input, iteration),
                                    updated(plugin, oracle, parameters, input, iteration)),
                         16 * v.epsilon(), "increment and velocity against scalar double" + where);
      }
  }
}

}  // namespace mpm::conformance

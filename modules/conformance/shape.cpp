// Checks of shape functions: the identities of kernels (docs/verification.md), and agreement of all instantiations.

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "conformance/support.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::conformance {
namespace {

/// One call of the plugin with all its arrays.
struct ShapeBatch {
  Variant variant;
  int width, count;
  Array position, half_size, domain, base, offset, weight, gradient, second_moment;

  ShapeBatch(const Plugin& plugin, const Variant& v, int entries, bool gradients)
      : variant(v), width(static_cast<int>(plugin.shape().width)), count(entries) {
    const Element element = element_of(v);
    const std::uint32_t n = static_cast<std::uint32_t>(entries);
    position = Array(element, v.dimension, n);
    if (plugin.descriptor->needs & MPM_NEEDS_HALF_SIZE) half_size = Array(element, v.dimension, n);
    if (plugin.descriptor->needs & MPM_NEEDS_DOMAIN) domain = Array(element, v.dimension * v.dimension, n);
    base = Array(Element::index, v.dimension, n);
    offset = Array(element, v.dimension, n);
    weight = Array(element, v.dimension * width, n);
    if (gradients) gradient = Array(element, v.dimension * width, n);
    if (gradients && plugin.shape().second_moment_kind == MPM_MOMENT_PER_PARTICLE)
      second_moment = Array(element, v.dimension, n);
  }

  void evaluate(const Plugin& plugin, const ParameterSample& parameters) {
    mpm_shape_batch batch{};
    batch.count = static_cast<std::uint32_t>(count);
    batch.stride = position.stride();
    batch.dimension = static_cast<std::uint32_t>(variant.dimension);
    batch.position = position.data();
    batch.half_size = half_size.data();
    batch.domain = domain.data();
    batch.base = static_cast<std::int32_t*>(base.data());
    batch.offset = offset.data();
    batch.weight = weight.data();
    batch.gradient = gradient.data();
    batch.second_moment = second_moment.data();
    plugin.shape().evaluate[variant.precision](parameters.data(), &batch);
  }

  double w(int axis, int k, int lane) const { return weight(axis * width + k, lane); }
  double g(int axis, int k, int lane) const { return gradient(axis * width + k, lane); }
  /// Whether the stencil holds the particle's domain; it does not where all weights along an axis are zero.
  bool holds(int lane) const {
    for (int a = 0; a < variant.dimension; ++a) {
      bool none = domain.components() > 0;
      for (int k = 0; k < width; ++k) none &= w(a, k, lane) == 0;
      if (none) return false;
    }
    return true;
  }
};

/// Positions and particle boxes of a batch, the same for every precision: representable as float.
struct ShapeInput {
  std::array<Vector3, full> position{}, half_size{};
  std::array<Matrix3, full> domain{};  ///< D*D entries in its upper left corner
};

/// Semi-side vectors in cells, as float numbers: boxes that are undeformed, stretched, sheared, turned, and turned by
/// 90 degrees.
Matrix3 random_domain(Random& random, int lane, int dimension) {
  const double half = lane % 5 == 0 ? 0.5 : random.logarithmic(0.01, 0.5);
  Matrix3 domain{};
  for (int a = 0; a < dimension; ++a)
    for (int b = 0; b < dimension; ++b) {
      double entry = a == b ? half : 0;
      if (lane % 4 == 1) entry = a == b ? half * random.uniform(0.1, 2) : 0;
      if (lane % 4 == 2) entry = half * random.uniform(-1, 1);
      if (lane % 4 == 3) entry = a == 1 && b == 0 ? half : a == 0 && b == 1 ? -half : a == b && a == 2 ? half : 0;
      domain(a, b) = static_cast<float>(entry);
    }
  return domain;
}

ShapeInput shape_input(Random& random, int dimension) {
  ShapeInput input;
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < dimension; ++a) {
      double x = random.uniform(-40, 60);
      // Some positions are the edges of the pieces that a shape is made of, and the numbers next to them.
      if (lane % 8 == 1) x = std::floor(x);
      if (lane % 8 == 2) x = std::floor(x) + 0.5;
      if (lane % 8 == 3) x = std::nextafter(static_cast<float>(std::floor(x)), -1000.0f);
      if (lane % 8 == 4) x = std::nextafter(static_cast<float>(std::floor(x) + 0.5), 1000.0f);
      input.position[lane][a] = x;
      input.half_size[lane][a] = lane % 5 == 0   ? 0.5
                                 : lane % 5 == 1 ? random.logarithmic(0.01, 0.5)
                                                 : random.uniform(0.1, 0.5);
    }
  for (int lane = 0; lane < full; ++lane) input.domain[lane] = random_domain(random, lane, dimension);
  return input;
}

void set_input(ShapeBatch& batch, const ShapeInput& input, int lane) {
  const int D = batch.variant.dimension;
  for (int a = 0; a < D; ++a) {
    batch.position.set(a, lane, input.position[lane][a]);
    if (batch.half_size.components()) batch.half_size.set(a, lane, input.half_size[lane][a]);
    for (int b = 0; b < D && batch.domain.components(); ++b)
      batch.domain.set(a * D + b, lane, input.domain[lane](a, b));
  }
}

ShapeBatch evaluated(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const ShapeInput& input,
                     int count = full, bool gradients = true) {
  ShapeBatch batch(plugin, v, count, gradients);
  for (int lane = 0; lane < count; ++lane) set_input(batch, input, lane);
  batch.evaluate(plugin, parameters);
  return batch;
}

/// Sums over the nodes of one particle's stencil.
struct StencilSums {
  double weight = 0, least_weight = 1;
  Vector3 gradient{}, first{};
  Matrix3 second{}, affine{};    ///< w d d^T and d (x) grad w
  double gradient_identity = 0;  ///< largest |w d_a - D_aa (grad w)_a|
};

/// The second moment of one axis, in cells.
double axis_moment(const ShapeBatch& b, int axis, int lane) {
  double moment = 0;
  for (int k = 0; k < b.width; ++k) {
    const double d = k - b.offset(axis, lane);
    moment += b.w(axis, k, lane) * d * d;
  }
  return moment;
}

StencilSums stencil_sums(const ShapeBatch& b, int lane) {
  const int D = b.variant.dimension, nodes = static_cast<int>(std::lround(std::pow(b.width, D)));
  StencilSums s;
  Vector3 moment{};
  for (int a = 0; a < D; ++a) moment[a] = axis_moment(b, a, lane);
  for (int node = 0; node < nodes; ++node) {
    int k[3] = {node % b.width, node / b.width % b.width, node / b.width / b.width};
    double w = 1;
    Vector3 d{}, gradient{};
    for (int a = 0; a < D; ++a) w *= b.w(a, k[a], lane), d[a] = k[a] - b.offset(a, lane);
    for (int a = 0; a < D; ++a) {
      gradient[a] = b.g(a, k[a], lane);
      for (int other = 0; other < D; ++other)
        if (other != a) gradient[a] *= b.w(other, k[other], lane);
    }
    s.weight += w;
    s.least_weight = std::min(s.least_weight, w);
    for (int i = 0; i < D; ++i) {
      s.gradient[i] += gradient[i];
      s.first[i] += w * d[i];
      s.gradient_identity = std::max(s.gradient_identity, std::abs(w * d[i] - moment[i] * gradient[i]));
      for (int j = 0; j < D; ++j) s.second(i, j) += w * d[i] * d[j], s.affine(i, j) += d[i] * gradient[j];
    }
  }
  return s;
}

/// Checks partition of unity, linear consistency and second moment.
void check_sums(const Plugin& plugin, const ShapeBatch& b, const std::string& where, Findings& findings) {
  const Variant& v = b.variant;
  Worst unity, gradient, linear, affine, constant, identity;
  double least = 1;
  for (int lane = 0; lane < full; ++lane) {
    if (!b.holds(lane)) continue;
    const StencilSums s = stencil_sums(b, lane);
    unity.add(std::abs(s.weight - 1), lane);
    for (int i = 0; i < v.dimension; ++i) {
      gradient.add(std::abs(s.gradient[i]), lane);
      linear.add(std::abs(s.first[i]), lane);
      for (int j = 0; j < v.dimension; ++j) {
        affine.add(std::abs(s.affine(i, j) - (i == j)), lane);
        constant.add(std::abs(s.second(i, j) - (i == j ? plugin.shape().second_moment : 0)), lane);
      }
    }
    identity.add(s.gradient_identity, lane);
    least = std::min(least, s.least_weight);
  }
  const double bound = v.single() ? 1e-6 : 1e-14;
  findings.at_most("partition_of_unity", v, unity, bound, "|sum w - 1|" + where);
  findings.at_most("gradient_sum", v, gradient, b.width * bound, "|sum grad w|" + where);
  findings.at_most("linear_consistency", v, linear, b.width * bound, "|sum w (x_i - x)| in cells" + where);
  findings.at_most("affine_consistency", v, affine, b.width * bound, "|sum (x_i - x) (x) grad w - I|" + where);
  if (plugin.shape().second_moment_kind == MPM_MOMENT_CONSTANT)
    findings.at_most("second_moment_constant", v, constant, b.width * bound, "|sum w d d^T - D I| in cells^2" + where);
  if (plugin.shape().second_moment_kind == MPM_MOMENT_IS_GRADIENT)
    findings.at_most("second_moment_is_gradient", v, identity, b.width * bound, "|w d - D grad w| a node" + where);
  findings.report("negative_weight [" + v.name() + "]", std::max(0.0, -least), "largest negative weight" + where);
}

/// Checks that a moment which the batch exports is that of its weights, and positive.
void check_moment(const ShapeBatch& b, const std::string& where, Findings& findings) {
  if (!b.second_moment.components()) return;
  const Variant& v = b.variant;
  Worst error;
  bool positive = true;
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < v.dimension; ++a) {
      error.add(std::abs(b.second_moment(a, lane) - axis_moment(b, a, lane)), lane);
      positive &= b.second_moment(a, lane) > 0 || !b.holds(lane);
    }
  findings.at_most("second_moment_summed", v, error, v.single() ? 1e-6 : 1e-14,
                   "|D - sum w d^2| along an axis, cells^2" + where);
  findings.require("second_moment_positive [" + v.name() + "]", positive, "above 0 along every axis" + where);
}

/// Checks that the base covers the particle, that offset is position - base, and that every declared node is used by
/// some particle.
void check_stencil(const ShapeBatch& b, const std::string& where, Findings& findings) {
  const Variant& v = b.variant;
  Worst outside, offset;
  std::vector<double> used(static_cast<std::size_t>(b.width), 0);
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < v.dimension; ++a) {
      const double f = b.offset(a, lane);
      outside.add(std::max(-f, f - (b.width - 1)), lane);
      offset.add(std::abs(b.position(a, lane) - b.base(a, lane) - f), lane);
      for (int k = 0; k < b.width; ++k) used[k] = std::max(used[k], b.w(a, k, lane));
    }
  findings.at_most("base_covers", v, outside, 64 * v.epsilon(), "cells by which x lies outside its stencil" + where);
  findings.at_most("offset", v, offset, 64 * v.epsilon(), "|x - base - offset| in cells" + where);
  findings.require("declared_width [" + v.name() + "]", *std::min_element(used.begin(), used.end()) > 0,
                   "each of the declared nodes carries weight for some position" + where);
}

/// The weight (or gradient) of an absolute node, zero outside the stencil.
double at_node(const ShapeBatch& b, bool gradient, int axis, double node, int lane) {
  const int k = static_cast<int>(node - b.base(axis, lane));
  if (k < 0 || k >= b.width) return 0;
  return gradient ? b.g(axis, k, lane) : b.w(axis, k, lane);
}

/// Compares node by node, so that two instantiations may differ in the base where a position rounds across a piece.
void check_agreement(const ShapeBatch& b, const ShapeBatch& oracle, const std::string& where, Findings& findings) {
  Worst weight, gradient;
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < b.variant.dimension; ++a)
      for (int k = -1; k <= b.width; ++k) {
        const double node = oracle.base(a, lane) + k;
        weight.add(std::abs(at_node(b, false, a, node, lane) - at_node(oracle, false, a, node, lane)), lane);
        // Where the stencils differ the particle sits on a kink, where a gradient may jump.
        if (b.base(a, lane) == oracle.base(a, lane))
          gradient.add(std::abs(at_node(b, true, a, node, lane) - at_node(oracle, true, a, node, lane)), lane);
      }
  const double bound = b.variant.single() ? 1e-6 : 1e-14;
  findings.at_most("agrees_with_scalar", b.variant, weight, bound, "|w - w of scalar double|" + where);
  findings.at_most("gradient_agrees_with_scalar", b.variant, gradient, 2 * bound, "|g - g of scalar double|" + where);
}

/// Checks axis derivatives against central differences, away from kinks (where the stencil changes within the
/// difference).
void check_differences(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                       const ShapeInput& input, const std::string& where, Findings& findings) {
  constexpr double step = 0x1p-20;
  ShapeInput before = input, after = input;
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < v.dimension; ++a) before.position[lane][a] -= step, after.position[lane][a] += step;
  const ShapeBatch here = evaluated(plugin, v, parameters, input);
  const ShapeBatch low = evaluated(plugin, v, parameters, before), high = evaluated(plugin, v, parameters, after);
  Worst error;
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < v.dimension; ++a) {
      if (low.base(a, lane) != high.base(a, lane)) continue;
      for (int k = 0; k < here.width; ++k) {
        const double difference = (high.w(a, k, lane) - low.w(a, k, lane)) / (2 * step);
        error.add(std::abs(here.g(a, k, lane) - difference), lane);
      }
    }
  // Within a smooth piece rounding leaves 1e-10; a kink of the gradient inside the difference leaves half a step.
  findings.at_most("gradient_is_derivative", v, error, 1e-5, "|g - dw/dx| by central differences" + where);
}

/// Checks that a shift by whole cells moves the base and changes nothing else, bit for bit.
void check_translation(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                       const ShapeInput& input, const std::string& where, Findings& findings) {
  constexpr int cells = 23;
  ShapeInput still = input, moved = input;
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < v.dimension; ++a) {
      const double x = std::floor(input.position[lane][a] * 4096) / 4096;  // so that the shift is exact in float
      still.position[lane][a] = x;
      moved.position[lane][a] = x + cells;
    }
  const ShapeBatch s = evaluated(plugin, v, parameters, still), m = evaluated(plugin, v, parameters, moved);
  bool shifted = true;
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < v.dimension; ++a) shifted &= m.base(a, lane) - s.base(a, lane) == cells;
  findings.require("translation [" + v.name() + "]",
                   shifted && s.offset == m.offset && s.weight == m.weight && s.gradient == m.gradient,
                   "a shift by whole cells changes only the base" + where);
}

/// Checks that writes stay inside the arrays at every batch size, that inputs stay as they were, and that gradients are
/// optional.
void check_batches(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const ShapeInput& input,
                   const std::string& where, Findings& findings) {
  const ShapeBatch reference = evaluated(plugin, v, parameters, input);
  bool guards = true, written = true, same = true, inputs = true;
  for (int count = MPM_LANES; count <= full; count += MPM_LANES)
    for (bool gradients : {true, false}) {
      ShapeBatch untouched(plugin, v, count, gradients);
      const ShapeBatch b = evaluated(plugin, v, parameters, input, count, gradients);
      for (int lane = 0; lane < count; ++lane) {
        set_input(untouched, input, lane);
        for (int a = 0; a < v.dimension; ++a)
          for (int k = 0; k < b.width; ++k)
            same &= b.w(a, k, lane) == reference.w(a, k, lane) &&
                    (!gradients || b.g(a, k, lane) == reference.g(a, k, lane));
      }
      for (const Array* out : {&b.base, &b.offset, &b.weight, &b.gradient, &b.second_moment}) {
        guards &= out->guards_intact();
        written &= out->all_written();
      }
      inputs &= b.position == untouched.position && b.half_size == untouched.half_size && b.domain == untouched.domain;
    }
  findings.require("writes_inside_arrays [" + v.name() + "]", guards, "guards around the outputs" + where);
  findings.require("writes_every_output [" + v.name() + "]", written, "no output element is left out" + where);
  findings.require("inputs_untouched [" + v.name() + "]", inputs, "positions and boxes" + where);
  findings.require("independent_of_batch [" + v.name() + "]", same,
                   "counts of 16 to 64, with and without gradients" + where);
}

/// Checks shapes that read the domain: undeformed boxes are held, endless ones are held or have no weight at all, and
/// the first node is that of the position whatever the domain.
void check_domains(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const ShapeInput& input,
                   const std::string& where, Findings& findings) {
  if (!(plugin.descriptor->needs & MPM_NEEDS_DOMAIN)) return;
  ShapeInput undeformed = input, endless = input;
  for (int lane = 0; lane < full; ++lane) {
    undeformed.domain[lane] = endless.domain[lane] = {};
    for (int a = 0; a < v.dimension; ++a)
      undeformed.domain[lane](a, a) = 0.5 / (1 + lane % 8), endless.domain[lane](a, a) = 3 + lane;
  }
  const ShapeBatch b = evaluated(plugin, v, parameters, input), u = evaluated(plugin, v, parameters, undeformed),
                   e = evaluated(plugin, v, parameters, endless);
  bool held = true, honest = true;
  for (int lane = 0; lane < full; ++lane) {
    held &= u.holds(lane);
    honest &= !e.holds(lane) || std::abs(stencil_sums(e, lane).weight - 1) < 1e-5;
  }
  findings.require("holds_undeformed_boxes [" + v.name() + "]", held, "1 to 8 particles a cell and axis" + where);
  findings.require("holds_or_has_no_weight [" + v.name() + "]", honest, "domains of 3 cells and more" + where);
  findings.require("base_of_position_alone [" + v.name() + "]", b.base == u.base && b.base == e.base,
                   "the same first node for every domain" + where);
}

/// The largest frequency, in wave speeds over cells, of a line that is evenly filled with two particles a cell whose
/// strains are kept: the nodes' masses are those of a cell, and a wave of phase theta a cell has the stiffness
/// mean_p |sum_i (dN_i/dx)(x_p) exp(i theta i)|^2. Any wave along one axis of a filled body is such a line.
double largest_frequency(const Plugin& plugin, const ParameterSample& parameters) {
  constexpr int phases = 64;
  constexpr double places[] = {0.25, 0.75};
  ShapeInput input;
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < 2; ++a) {
      input.position[lane][a] = places[lane % 2];
      input.half_size[lane][a] = 0.25;
      input.domain[lane](a, a) = 0.25;
    }
  const ShapeBatch batch = evaluated(plugin, {MPM_SCALAR_DOUBLE, 2}, parameters, input);
  double largest = 0;
  for (int n = 1; n <= phases; ++n) {
    const double theta = std::numbers::pi * n / phases;
    double stiffness = 0;
    for (int lane = 0; lane < 2; ++lane) {
      std::complex<double> symbol;
      for (int k = 0; k < batch.width; ++k) symbol += batch.g(0, k, lane) * std::polar(1.0, theta * k);
      stiffness += 0.5 * std::norm(symbol);
    }
    largest = std::max(largest, std::sqrt(stiffness));
  }
  return largest;
}

/// Checks that the Courant number that the shape says it stands is one, and that it is none that an explicit step
/// cannot stand: 2 over the frequency.
void check_courant_limit(const Plugin& plugin, const ParameterSample& parameters, const std::string& where,
                         Findings& findings) {
  const auto* table = extension_of<mpm_shape_courant_limit>(plugin);
  if (!table) return;
  findings.running("largest Courant number" + where);
  const bool scalar = plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1;
  for (std::uint32_t dimension = 2; dimension <= 3; ++dimension) {
    if (!(plugin.descriptor->dimensions & (dimension == 2 ? MPM_2D : MPM_3D))) continue;
    for (const double limit : table->limit[dimension - 2]) {
      const std::string of = " in " + std::to_string(dimension) + "-D" + where;
      findings.require("courant_limit_positive", std::isfinite(limit) && limit > 0, "a number above 0" + of);
      if (plugin.shape().form == MPM_TENSOR_PRODUCT && scalar)
        findings.at_most("courant_limit_below_leapfrog", limit * largest_frequency(plugin, parameters), 2,
                         "times the largest frequency of a filled line" + of);
    }
  }
}

}  // namespace

void check_shape(const Plugin& plugin, Findings& findings) {
  const mpm_shape& shape = plugin.shape();
  findings.require("form", shape.form == MPM_TENSOR_PRODUCT || shape.form == MPM_NODE_LIST, "of mpm_shape_form");
  if (shape.form == MPM_NODE_LIST) {
    Random random(20240611);
    for (const ParameterSample& parameters : sample_parameters(plugin, random))
      check_courant_limit(plugin, parameters, parameters.text.empty() ? "" : "; " + parameters.text, findings);
    return check_list_shape(plugin, findings);
  }
  findings.require("width", shape.width >= 2 && shape.width <= 4, "2 to 4 nodes an axis");
  if (shape.form != MPM_TENSOR_PRODUCT || shape.width < 2 || shape.width > 4) return;
  Random random(20240601);
  for (const ParameterSample& parameters : sample_parameters(plugin, random)) {
    check_courant_limit(plugin, parameters, parameters.text.empty() ? "" : "; " + parameters.text, findings);
    for (const Variant& v : variants_of(*plugin.descriptor)) {
      const std::string where = parameters.text.empty() ? "" : "; " + parameters.text;
      const ShapeInput input = shape_input(random, v.dimension);
      findings.running("sums and stencil", v, where);
      const ShapeBatch b = evaluated(plugin, v, parameters, input);
      check_sums(plugin, b, where, findings);
      check_moment(b, where, findings);
      check_stencil(b, where, findings);
      check_domains(plugin, v, parameters, input, where, findings);
      findings.running("translation", v, where);
      check_translation(plugin, v, parameters, input, where, findings);
      findings.running("batches", v, where);
      check_batches(plugin, v, parameters, input, where, findings);
      if (!(plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1)) continue;
      const Variant oracle{MPM_SCALAR_DOUBLE, v.dimension};
      findings.running("derivatives or agreement", v, where);
      if (v.precision == MPM_SCALAR_DOUBLE)
        check_differences(plugin, v, parameters, input, where, findings);
      else
        check_agreement(b, evaluated(plugin, oracle, parameters, input), where, findings);
    }
  }
}

}  // namespace mpm::conformance

// Checks of shapes that list their nodes: the identities of kernels under random domains, each node once, agreement of
// all instantiations, and of boxes with lists.

#include <algorithm>
#include <array>
#include <limits>

#include "conformance/support.hpp"
#include "kernel/corner_domain.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::conformance {
namespace {

enum Outputs { none = 0, gradients = 1, moments = 2, all = 3 };

int capacity_of(const Plugin& plugin, int dimension) {
  return static_cast<int>(plugin.shape().capacity[dimension - 2]);
}

/// Number of corners of a domain that a particle carries, or 0.
int points_of(const Plugin& plugin, int dimension) {
  return static_cast<int>(plugin.shape().sample_points[dimension - 2]);
}

/// One call of the plugin with all its arrays.
struct ListBatch {
  Variant variant;
  int capacity, count;
  Array position, half_size, domain, samples, node_count, node, weight, gradient, second_moment;

  ListBatch(const Plugin& plugin, const Variant& v, int entries, int outputs)
      : variant(v), capacity(capacity_of(plugin, v.dimension)), count(entries) {
    const Element element = element_of(v);
    const std::uint32_t n = static_cast<std::uint32_t>(entries);
    const int D = v.dimension;
    position = Array(element, D, n);
    if (plugin.descriptor->needs & MPM_NEEDS_HALF_SIZE) half_size = Array(element, D, n);
    if (plugin.descriptor->needs & MPM_NEEDS_DOMAIN) domain = Array(element, D * D, n);
    if (points_of(plugin, D) > 0) samples = Array(element, points_of(plugin, D) * D, n);
    node_count = Array(Element::index, 1, n);
    node = Array(Element::index, capacity * D, n);
    weight = Array(element, capacity, n);
    if (outputs & gradients) gradient = Array(element, capacity * D, n);
    if ((outputs & moments) && plugin.shape().second_moment_kind == MPM_MOMENT_PER_PARTICLE)
      second_moment = Array(element, D * D, n);
  }

  void evaluate(const Plugin& plugin, const ParameterSample& parameters) {
    mpm_list_batch batch{};
    batch.count = static_cast<std::uint32_t>(count);
    batch.stride = position.stride();
    batch.dimension = static_cast<std::uint32_t>(variant.dimension);
    batch.capacity = static_cast<std::uint32_t>(capacity);
    batch.position = position.data();
    batch.half_size = half_size.data();
    batch.domain = domain.data();
    batch.samples = samples.data();
    batch.node_count = static_cast<std::int32_t*>(node_count.data());
    batch.node = static_cast<std::int32_t*>(node.data());
    batch.weight = weight.data();
    batch.gradient = gradient.data();
    batch.second_moment = second_moment.data();
    plugin.shape().evaluate_list[variant.precision][variant.dimension - 2](parameters.data(), &batch);
  }

  /// Number of nodes of a lane, never beyond the arrays, whatever the plugin wrote.
  int nodes(int lane) const { return std::clamp(static_cast<int>(node_count(0, lane)), 0, capacity); }
  double coordinate(int k, int axis, int lane) const { return node(k * variant.dimension + axis, lane); }
  double slope(int k, int axis, int lane) const { return gradient(k * variant.dimension + axis, lane); }
};

/// The inputs of particles, the same for every precision: representable as float.
struct ListInput {
  std::array<Vector3, full> position{}, half_size{};
  std::array<Matrix3, full> domain{};
  std::array<bool, full> flat{};
  std::array<std::array<Vector3, 8>, full> corners{};  ///< corners for shapes with sample points, from the position
  std::array<Vector3, full> centre{};                  ///< mean place of their weights, from the position
};

/// Makes the corners of a lane's parallelepiped, every other one bent as far as it stays upright, and their centroid.
template <int D>
void bend_corners(Random& random, int lane, ListInput& input) {
  Vec<D, double> straight[1 << D], bent[1 << D];
  double size = 1;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) size = std::min(size, std::max(0.01, std::abs(input.domain[lane](i, j))));
  for (int c = 0; c < 1 << D; ++c)
    for (int i = 0; i < D; ++i) {
      double x = 0;
      for (int j = 0; j < D; ++j) x += (c >> j & 1 ? 1 : -1) * input.domain[lane](i, j);
      straight[c][i] = static_cast<float>(x);
      bent[c][i] = static_cast<float>(x + 0.3 * size * random.uniform(-1, 1));
    }
  const bool bend = lane % 2 == 0 && corner_domain<D, double>(bent).upright;
  const Vec<D, double>* const corner = bend ? bent : straight;
  const auto domain = corner_domain<D, double>(corner);
  const Vec<D, double> centre = centroid(domain, corner);
  for (int i = 0; i < D; ++i) {
    input.centre[lane][i] = centre[i];
    for (int c = 0; c < 1 << D; ++c) input.corners[lane][c][i] = corner[c][i];
  }
}

/// Makes domains from a fraction of a cell to several cells, turned and sheared; every sixteenth has collapsed.
ListInput list_input(const Plugin& plugin, Random& random, int dimension) {
  const bool sampled = points_of(plugin, dimension) > 0;  // sampled domains do not collapse, as those have no list
  ListInput input;
  for (int lane = 0; lane < full; ++lane) {
    for (int a = 0; a < dimension; ++a) {
      double x = random.uniform(-40, 60);
      if (lane % 8 == 1) x = std::floor(x);
      if (lane % 8 == 2) x = std::floor(x) + 0.5;
      if (lane % 8 == 3) x = std::nextafter(static_cast<float>(std::floor(x)), -1000.0f);
      input.position[lane][a] = x;
      input.half_size[lane][a] = random.uniform(0.1, 0.5);
    }
    const double size = lane % 4 == 3 ? random.uniform(0.5, 3) : random.uniform(0.05, 0.5);
    Matrix3 shape = sum(Matrix3::identity(), random.matrix(dimension, lane % 8 < 3 ? 0 : 0.3));
    if (lane % 2) shape = random.rotation(dimension) * shape;
    input.flat[lane] = lane % 16 == 15 && !sampled;
    for (int i = 0; i < dimension; ++i)
      for (int j = 0; j < dimension; ++j) {
        const int column = input.flat[lane] && j == 1 ? 0 : j;
        input.domain[lane](i, j) = static_cast<float>(size * shape(i, column));
      }
    if (lane == full - 1 && !sampled) input.domain[lane] = Matrix3{};  // the domain is a point
    if (sampled && dimension == 2) bend_corners<2>(random, lane, input);
    if (sampled && dimension == 3) bend_corners<3>(random, lane, input);
  }
  return input;
}

ListBatch loaded(const Plugin& plugin, const Variant& v, const ListInput& input, int count, int outputs) {
  ListBatch batch(plugin, v, count, outputs);
  const int D = v.dimension;
  for (int lane = 0; lane < count; ++lane)
    for (int a = 0; a < D; ++a) {
      batch.position.set(a, lane, input.position[lane][a]);
      if (batch.half_size.components()) batch.half_size.set(a, lane, input.half_size[lane][a]);
      for (int b = 0; b < D && batch.domain.components(); ++b)
        batch.domain.set(a * D + b, lane, input.domain[lane](a, b));
      for (int c = 0; c < points_of(plugin, D); ++c) batch.samples.set(c * D + a, lane, input.corners[lane][c][a]);
    }
  return batch;
}

ListBatch evaluated(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const ListInput& input,
                    int count = full, int outputs = all) {
  ListBatch batch = loaded(plugin, v, input, count, outputs);
  batch.evaluate(plugin, parameters);
  return batch;
}

/// How far a particle's nodes may lie along an axis, cells.
double reach_of(const Plugin& plugin, const ListInput& input, int axis, int lane) {
  double reach = plugin.shape().reach;
  if (plugin.descriptor->needs & MPM_NEEDS_DOMAIN)
    for (int k = 0; k < 3; ++k) reach += std::abs(input.domain[lane](axis, k));
  double farthest = 0;
  for (int c = 0; c < points_of(plugin, 2) || c < points_of(plugin, 3); ++c)
    farthest = std::max(farthest, std::abs(input.corners[lane][c][axis]));
  reach += farthest;
  return reach;
}

/// The largest entry of the inverse of the domain, by which rounding in a gradient is multiplied; 1 at least.
double steepness(const ListInput& input, int dimension, int lane) {
  if (input.flat[lane]) return 1;
  Matrix3 domain = input.domain[lane];
  if (dimension == 2) domain(2, 2) = 1;
  return std::max(1.0, largest_difference(inverse(domain), {}));
}

/// Checks count and capacity, that each node comes once, and that none is out of reach.
void check_nodes(const Plugin& plugin, const ListBatch& b, const ListInput& input, const std::string& where,
                 Findings& findings) {
  const Variant& v = b.variant;
  Worst beyond;
  bool counted = true, unique = true;
  for (int lane = 0; lane < full; ++lane) {
    counted &= b.node_count(0, lane) >= 1 && b.node_count(0, lane) <= b.capacity;
    for (int k = 0; k < b.nodes(lane); ++k) {
      for (int a = 0; a < v.dimension; ++a)
        beyond.add(std::abs(b.coordinate(k, a, lane) - b.position(a, lane)) - reach_of(plugin, input, a, lane), lane);
      for (int other = 0; other < k; ++other) {
        bool same = true;
        for (int a = 0; a < v.dimension; ++a) same &= b.coordinate(k, a, lane) == b.coordinate(other, a, lane);
        unique &= !same;
      }
    }
  }
  findings.require("node_count [" + v.name() + "]", counted, "1 to capacity nodes a particle" + where);
  findings.require("unique_nodes [" + v.name() + "]", unique, "each node of a particle comes once" + where);
  findings.at_most("reach", v, beyond, 64 * v.epsilon(), "cells beyond sum |domain| + reach" + where);
}

/// Checks, for any domain, sums over the nodes, and the value and slope of a random affine field.
void check_sums(const Plugin& plugin, const ListBatch& b, const ListInput& input, Random& random,
                const std::string& where, Findings& findings) {
  const Variant& v = b.variant;
  const int D = v.dimension;
  Worst unity, gradient, linear, affine, value, slope;
  double least = 1;
  for (int lane = 0; lane < full; ++lane) {
    const Vector3 field = random.direction(D);
    double weights = 0, f = 0, extent = 1;
    Vector3 slopes{}, first{}, f_slope{};
    Matrix3 identity{};
    for (int a = 0; a < D; ++a) extent = std::max(extent, reach_of(plugin, input, a, lane));
    for (int k = 0; k < b.nodes(lane); ++k) {
      const double w = b.weight(k, lane);
      Vector3 d{};
      for (int a = 0; a < D; ++a) d[a] = b.coordinate(k, a, lane) - b.position(a, lane) - input.centre[lane][a];
      weights += w, f += w * dot(field, d), least = std::min(least, w);
      for (int i = 0; i < D; ++i) {
        slopes[i] += b.slope(k, i, lane), first[i] += w * d[i], f_slope[i] += dot(field, d) * b.slope(k, i, lane);
        for (int j = 0; j < D; ++j) identity(i, j) += d[i] * b.slope(k, j, lane);
      }
    }
    const double steep = steepness(input, D, lane);
    unity.add(std::abs(weights - 1), lane);
    value.add(std::abs(f) / extent, lane);
    for (int i = 0; i < D; ++i) {
      gradient.add(std::abs(slopes[i]) / steep, lane);
      linear.add(std::abs(first[i]) / extent, lane);
      slope.add(std::abs(f_slope[i] - field[i]) / (steep * extent), lane);
      for (int j = 0; j < D; ++j) affine.add(std::abs(identity(i, j) - (i == j)) / (steep * extent), lane);
    }
  }
  const double bound = v.single() ? 1e-6 : 1e-14;
  findings.at_most("partition_of_unity", v, unity, bound, "|sum w - 1|" + where);
  findings.at_most("gradient_sum", v, gradient, 3 * bound, "|sum grad w| over the inverse domain" + where);
  findings.at_most("linear_consistency", v, linear, 3 * bound, "|sum w (x_i - x)| over the reach" + where);
  findings.at_most("affine_consistency", v, affine, 3 * bound,
                   "|sum (x_i - x) (x) grad w - I| over reach and inverse domain" + where);
  findings.at_most("affine_value", v, value, 3 * bound, "affine field under a random domain, value" + where);
  findings.at_most("affine_slope", v, slope, 3 * bound, "affine field under a random domain, gradient" + where);
  findings.report("negative_weight [" + v.name() + "]", std::max(0.0, -least), "largest negative weight" + where);
}

/// Checks that the exported second moment is the sum over the nodes, and positive definite for a domain that has not
/// collapsed.
void check_moment(const Plugin& plugin, const ListBatch& b, const ListInput& input, const std::string& where,
                  Findings& findings) {
  if (!b.second_moment.components()) return;
  const Variant& v = b.variant;
  const int D = v.dimension;
  Worst error;
  bool positive = true;
  for (int lane = 0; lane < full; ++lane) {
    Matrix3 moment{}, exported = Matrix3::identity();
    double extent = 1;
    for (int a = 0; a < D; ++a) extent = std::max(extent, reach_of(plugin, input, a, lane));
    for (int k = 0; k < b.nodes(lane); ++k)
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j)
          moment(i, j) += b.weight(k, lane) * (b.coordinate(k, i, lane) - b.position(i, lane)) *
                          (b.coordinate(k, j, lane) - b.position(j, lane));
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) {
        exported(i, j) = b.second_moment(i * D + j, lane);
        error.add(std::abs(exported(i, j) - moment(i, j)) / (extent * extent), lane);
      }
    const double minor = exported(0, 0) * exported(1, 1) - exported(0, 1) * exported(1, 0);
    positive &= input.flat[lane] || (exported(0, 0) > 0 && minor > 0 && determinant(exported) > 0);
  }
  findings.at_most("second_moment_summed", v, error, v.single() ? 1e-6 : 1e-14,
                   "|D - sum w d d^T| over the reach squared" + where);
  findings.require("second_moment_positive [" + v.name() + "]", positive,
                   "positive definite for a domain with a volume" + where);
}

/// The place of a node in a particle's list, or -1.
int find_node(const ListBatch& b, const ListBatch& other, int k, int lane) {
  for (int entry = 0; entry < b.nodes(lane); ++entry) {
    bool same = true;
    for (int a = 0; a < b.variant.dimension; ++a) same &= b.coordinate(entry, a, lane) == other.coordinate(k, a, lane);
    if (same) return entry;
  }
  return -1;
}

/// Compares two lists node by node; a node that only one of them has counts with zero weight in the other.
void check_agreement(const ListBatch& b, const ListBatch& oracle, const ListInput& input, const std::string& where,
                     Findings& findings) {
  const int D = b.variant.dimension;
  Worst weight, gradient;
  for (int lane = 0; lane < full; ++lane) {
    const double steep = steepness(input, D, lane);
    for (const ListBatch* from : {&b, &oracle}) {
      const ListBatch& to = from == &b ? oracle : b;
      for (int k = 0; k < from->nodes(lane); ++k) {
        const int entry = find_node(to, *from, k, lane);
        weight.add(std::abs(from->weight(k, lane) - (entry < 0 ? 0 : to.weight(entry, lane))), lane);
        // A collapsed domain may take the tents' own gradients, which jump where a corner rounds across a grid line.
        for (int a = 0; a < D && !input.flat[lane]; ++a)
          gradient.add(std::abs(from->slope(k, a, lane) - (entry < 0 ? 0 : to.slope(entry, a, lane))) / steep, lane);
      }
    }
  }
  const double bound = b.variant.single() ? 2e-6 : 1e-14;
  findings.at_most("agrees_with_scalar", b.variant, weight, bound, "|w - w of scalar double|" + where);
  findings.at_most("gradient_agrees_with_scalar", b.variant, gradient, bound,
                   "|g - g of scalar double| over the inverse domain" + where);
}

/// Checks that a shift by whole cells moves the nodes and changes nothing else, bit for bit.
void check_translation(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                       const ListInput& input, const std::string& where, Findings& findings) {
  constexpr int cells = 23;
  ListInput still = input, moved = input;
  for (int lane = 0; lane < full; ++lane)
    for (int a = 0; a < v.dimension; ++a) {
      const double x = std::floor(input.position[lane][a] * 4096) / 4096;  // so that the shift is exact in float
      still.position[lane][a] = x;
      moved.position[lane][a] = x + cells;
    }
  const ListBatch s = evaluated(plugin, v, parameters, still), m = evaluated(plugin, v, parameters, moved);
  bool same = s.node_count == m.node_count;
  for (int lane = 0; lane < full; ++lane)
    for (int k = 0; k < s.nodes(lane) && same; ++k) {
      same &= s.weight(k, lane) == m.weight(k, lane);
      for (int a = 0; a < v.dimension; ++a)
        same &=
            m.coordinate(k, a, lane) - s.coordinate(k, a, lane) == cells && s.slope(k, a, lane) == m.slope(k, a, lane);
    }
  findings.require("translation [" + v.name() + "]", same, "a shift by whole cells changes only the nodes" + where);
}

/// Checks that writes stay inside the arrays at every batch size, that inputs stay as they were, and that optional
/// outputs may be null.
void check_batches(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const ListInput& input,
                   const std::string& where, Findings& findings) {
  const ListBatch reference = evaluated(plugin, v, parameters, input);
  bool guards = true, finite = true, same = true, inputs = true;
  for (int count = MPM_LANES; count <= full; count += MPM_LANES)
    for (int outputs : {none, gradients, moments, all}) {
      const ListBatch untouched = loaded(plugin, v, input, count, outputs);
      const ListBatch b = evaluated(plugin, v, parameters, input, count, outputs);
      for (int lane = 0; lane < count; ++lane) {
        same &= b.node_count(0, lane) == reference.node_count(0, lane);
        for (int k = 0; k < b.nodes(lane); ++k) {
          finite &= std::isfinite(b.weight(k, lane));
          same &= b.weight(k, lane) == reference.weight(k, lane);
          for (int a = 0; a < v.dimension; ++a) {
            same &= b.coordinate(k, a, lane) == reference.coordinate(k, a, lane);
            if (!(outputs & gradients)) continue;
            finite &= std::isfinite(b.slope(k, a, lane));
            same &= b.slope(k, a, lane) == reference.slope(k, a, lane);
          }
        }
        for (int c = 0; c < b.second_moment.components(); ++c)
          same &= b.second_moment(c, lane) == reference.second_moment(c, lane);
      }
      for (const Array* out : {&b.node_count, &b.node, &b.weight, &b.gradient, &b.second_moment})
        guards &= out->guards_intact();
      guards &= b.node_count.all_written() && b.second_moment.all_written();
      inputs &= b.position == untouched.position && b.half_size == untouched.half_size &&
                b.domain == untouched.domain && b.samples == untouched.samples;
    }
  findings.require("writes_inside_arrays [" + v.name() + "]", guards, "guards around the outputs" + where);
  findings.require("finite [" + v.name() + "]", finite, "weights and gradients, for collapsed domains too" + where);
  findings.require("inputs_untouched [" + v.name() + "]", inputs, "positions, boxes and domains" + where);
  findings.require("independent_of_batch [" + v.name() + "]", same,
                   "counts of 16 to 64, with and without optional outputs" + where);
}

/// Checks that a domain which its corners turn inside out has no list.
void check_inside_out(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, ListInput input,
                      const std::string& where, Findings& findings) {
  for (auto& corner : input.corners)
    for (int c = 0; c < points_of(plugin, v.dimension); c += 2) std::swap(corner[c], corner[c + 1]);
  const ListBatch b = evaluated(plugin, v, parameters, input);
  bool refused = true;
  for (int lane = 0; lane < full; ++lane) refused &= b.node_count(0, lane) == 0;
  findings.require("inside_out [" + v.name() + "]", refused,
                   "no nodes for corners that have passed one another" + where);
}

// ---- boxes

int places_of(int dimension) {
  constexpr int width = MPM_BOX_WIDTH;
  return dimension == 2 ? width * width : width * width * width;
}

/// The arrays of boxes, for the same particles.
struct BoxBatch {
  Variant variant;
  int count;
  Array base, extent, offset, weight, gradient, second_moment;

  BoxBatch(const Variant& v, int entries, int outputs) : variant(v), count(entries) {
    const Element element = element_of(v);
    const std::uint32_t n = static_cast<std::uint32_t>(entries);
    const int D = v.dimension;
    base = Array(Element::index, D, n);
    extent = Array(Element::index, 1, n);
    offset = Array(element, D, n);
    weight = Array(element, places_of(D), n);
    if (outputs & gradients) gradient = Array(element, D * places_of(D), n);
    if (outputs & moments) second_moment = Array(element, D * D, n);
  }

  void evaluate(const Plugin& plugin, const ParameterSample& parameters, const ListBatch& particles) {
    mpm_box_batch batch{};
    batch.count = static_cast<std::uint32_t>(count);
    batch.stride = weight.stride();
    batch.dimension = static_cast<std::uint32_t>(variant.dimension);
    batch.position = particles.position.data();
    batch.half_size = particles.half_size.data();
    batch.domain = particles.domain.data();
    batch.base = static_cast<std::int32_t*>(base.data());
    batch.extent = static_cast<std::int32_t*>(extent.data());
    batch.offset = offset.data();
    batch.weight = weight.data();
    batch.gradient = gradient.data();
    batch.second_moment = second_moment.data();
    extension_of<mpm_shape_boxes>(plugin)->evaluate[variant.precision][variant.dimension - 2](parameters.data(),
                                                                                              &batch);
  }

  int nodes(int lane) const {
    return std::clamp(static_cast<int>(extent(0, lane)), 0, static_cast<int>(MPM_BOX_WIDTH));
  }
  /// The entry of the node at `node` nodes from the box's first, or -1 when it is outside of the box.
  int place(const std::array<int, 3>& node, int lane) const {
    int entry = 0;
    for (int a = 0; a < variant.dimension; ++a) {
      if (node[a] < 0 || node[a] >= nodes(lane)) return -1;
      entry = entry * static_cast<int>(MPM_BOX_WIDTH) + node[a];
    }
    return entry;
  }
  bool same_particle(int lane, const BoxBatch& other, int shift) const {
    const int D = variant.dimension, n = nodes(lane);
    bool same = extent(0, lane) == other.extent(0, lane);
    for (int a = 0; a < D; ++a)
      same = same && other.base(a, lane) - base(a, lane) == shift && offset(a, lane) == other.offset(a, lane);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < (D == 2 ? 1 : n) && same; ++k) {
          const int entry = place({i, j, k}, lane);
          same = weight(entry, lane) == other.weight(entry, lane);
          for (int a = 0; a < D && gradient.components() && other.gradient.components(); ++a) {
            const int slope = a * places_of(D) + entry;
            same = same && gradient(slope, lane) == other.gradient(slope, lane);
          }
        }
    return same;
  }
};

BoxBatch boxes(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const ListInput& input,
               int count = full, int outputs = all) {
  BoxBatch batch(v, count, outputs);
  batch.evaluate(plugin, parameters, loaded(plugin, v, input, count, outputs));
  return batch;
}

/// Checks that the nodes of the list are those of the box: nowhere else, and with the same weights, gradients and
/// moment.
void check_box_agrees(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const ListInput& input,
                      int outputs, const std::string& where, Findings& findings) {
  const BoxBatch box = boxes(plugin, v, parameters, input, full, outputs);
  const ListBatch list = evaluated(plugin, v, parameters, input, full, outputs);
  const int D = v.dimension, places = places_of(D);
  Worst weight, gradient, moment, offset;
  bool extents = true, held = true;
  int lists = 0;
  for (int lane = 0; lane < full; ++lane) {
    extents &= box.extent(0, lane) >= 0 && box.extent(0, lane) <= MPM_BOX_WIDTH;
    if (!box.nodes(lane)) ++lists;
    if (!box.nodes(lane)) continue;
    const double steep = steepness(input, D, lane);
    double reach = 1;
    for (int a = 0; a < D; ++a) {
      reach = std::max(reach, reach_of(plugin, input, a, lane));
      offset.add(std::abs(box.offset(a, lane) - (list.position(a, lane) - box.base(a, lane))), lane);
    }
    std::vector<bool> listed(static_cast<std::size_t>(places));
    for (int k = 0; k < list.nodes(lane); ++k) {
      std::array<int, 3> node{};
      for (int a = 0; a < D; ++a) node[a] = static_cast<int>(list.coordinate(k, a, lane) - box.base(a, lane));
      const int entry = box.place(node, lane);
      held &= entry >= 0;
      if (entry < 0) continue;
      listed[static_cast<std::size_t>(entry)] = true;
      weight.add(std::abs(list.weight(k, lane) - box.weight(entry, lane)), lane);
      for (int a = 0; a < D && (outputs & gradients); ++a)
        gradient.add(std::abs(list.slope(k, a, lane) - box.gradient(a * places + entry, lane)) / steep, lane);
    }
    for (int i = 0; i < box.nodes(lane); ++i)
      for (int j = 0; j < box.nodes(lane); ++j)
        for (int k = 0; k < (D == 2 ? 1 : box.nodes(lane)); ++k) {
          const int entry = box.place({i, j, k}, lane);
          if (listed[static_cast<std::size_t>(entry)]) continue;
          weight.add(std::abs(box.weight(entry, lane)), lane);
          for (int a = 0; a < D && (outputs & gradients); ++a)
            gradient.add(std::abs(box.gradient(a * places + entry, lane)) / steep, lane);
        }
    for (int c = 0; c < D * D && (outputs & moments); ++c)
      moment.add(std::abs(box.second_moment(c, lane) - list.second_moment(c, lane)) / (reach * reach), lane);
  }
  const double bound = v.single() ? 2e-6 : 1e-14;
  findings.require("box_extent [" + v.name() + "]", extents, "0 to MPM_BOX_WIDTH nodes an axis" + where);
  findings.require("box_holds_list [" + v.name() + "]", held, "every node of the list lies in the box" + where);
  findings.at_most("box_offset", v, offset, v.epsilon(), "|offset - (position - base)|" + where);
  findings.at_most("box_agrees_with_list", v, weight, bound, "|w - w of the list|" + where);
  findings.at_most("box_gradient_agrees_with_list", v, gradient, bound,
                   "|g - g of the list| over the inverse domain" + where);
  findings.at_most("box_second_moment_agrees_with_list", v, moment, bound,
                   "|D - D of the list| over the reach squared" + where);
  findings.report("without_box [" + v.name() + "]", lists, "particles of 64 that take their lists" + where);
}

/// Checks that neither number nor size of the other particles matters, nor which outputs are wanted, nor whole cells.
void check_box_batches(const Plugin& plugin, const Variant& v, const ParameterSample& parameters,
                       const ListInput& input, const std::string& where, Findings& findings) {
  const BoxBatch reference = boxes(plugin, v, parameters, input);
  bool guards = true, same = true, neighbours = true, translated = true;
  for (int count = MPM_LANES; count <= full; count += MPM_LANES)
    for (int outputs : {none, gradients, moments, all}) {
      const BoxBatch b = boxes(plugin, v, parameters, input, count, outputs);
      for (int lane = 0; lane < count; ++lane) same &= !reference.nodes(lane) || b.same_particle(lane, reference, 0);
      for (const Array* out : {&b.base, &b.extent, &b.offset, &b.weight, &b.gradient, &b.second_moment})
        guards &= out->guards_intact();
      guards &= b.base.all_written() && b.extent.all_written();
    }
  constexpr int cells = 23;
  ListInput narrow = input, still = input, moved = input;
  for (int lane = 0; lane < full; ++lane) {
    if (reference.nodes(lane) != 3) {  // all neighbours are made alike
      narrow.position[lane] = {};
      narrow.domain[lane] = scaled(Matrix3::identity(), 0.25);
    }
    for (int a = 0; a < v.dimension; ++a) {
      still.position[lane][a] = std::floor(input.position[lane][a] * 4096) / 4096;
      moved.position[lane][a] = still.position[lane][a] + cells;
    }
  }
  const BoxBatch alone = boxes(plugin, v, parameters, narrow), here = boxes(plugin, v, parameters, still),
                 there = boxes(plugin, v, parameters, moved);
  for (int lane = 0; lane < full; ++lane) {
    neighbours &= reference.nodes(lane) != 3 || alone.same_particle(lane, reference, 0);
    translated &=
        here.extent(0, lane) == there.extent(0, lane) && (!here.nodes(lane) || here.same_particle(lane, there, cells));
  }
  findings.require("box_writes_inside_arrays [" + v.name() + "]", guards, "guards around the outputs" + where);
  findings.require("box_independent_of_batch [" + v.name() + "]", same,
                   "counts of 16 to 64, with and without optional outputs" + where);
  findings.require("box_independent_of_neighbours [" + v.name() + "]", neighbours,
                   "wide ones beside narrow ones" + where);
  findings.require("box_translation [" + v.name() + "]", translated, "a shift by whole cells moves the base" + where);
}

/// Checks that what no box can hold takes its list: a particle that is not a number or reaches far.
void check_box_refuses(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, ListInput input,
                       const std::string& where, Findings& findings) {
  const bool domain = plugin.descriptor->needs & MPM_NEEDS_DOMAIN;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  input.position[0][0] = nan;
  input.position[17][1] = nan;
  input.domain[34](1, 0) = nan;
  input.domain[51](0, 1) = 1e9;
  const BoxBatch b = boxes(plugin, v, parameters, input);
  bool refused = !b.extent(0, 0) && !b.extent(0, 17);
  if (domain) refused = refused && !b.extent(0, 34) && !b.extent(0, 51);
  findings.require("box_refuses [" + v.name() + "]", refused,
                   "no box of a particle that is not a number or far" + where);
}

void check_boxes(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const ListInput& input,
                 const std::string& where, Findings& findings) {
  findings.running("boxes", v, where);
  for (int outputs : {static_cast<int>(moments), static_cast<int>(all)})
    check_box_agrees(plugin, v, parameters, input, outputs, where, findings);
  check_box_batches(plugin, v, parameters, input, where, findings);
  check_box_refuses(plugin, v, parameters, input, where, findings);
}

}  // namespace

void check_list_shape(const Plugin& plugin, Findings& findings) {
  const mpm_shape& shape = plugin.shape();
  const bool sized = shape.capacity[0] >= 1 && shape.capacity[1] >= 1 && shape.capacity[0] <= 4096 &&
                     shape.capacity[1] <= 4096 && shape.reach > 0;
  findings.require("capacity_and_reach", sized, "1 to 4096 nodes and a positive reach");
  findings.require("second_moment_kind", shape.second_moment_kind <= MPM_MOMENT_PER_PARTICLE, "of mpm_second_moment");
  const bool points = (shape.sample_points[0] == 0 && shape.sample_points[1] == 0) ||
                      (shape.sample_points[0] == 4 && shape.sample_points[1] == 8);
  findings.require("sample_points", points, "none, or the corners of a quadrilateral and of a hexahedron");
  if (!sized || !points) return;
  Random random(20240607);
  for (const ParameterSample& parameters : sample_parameters(plugin, random))
    for (const Variant& v : variants_of(*plugin.descriptor)) {
      const std::string where = parameters.text.empty() ? "" : "; " + parameters.text;
      const ListInput input = list_input(plugin, random, v.dimension);
      findings.running("nodes, sums and moment", v, where);
      const ListBatch b = evaluated(plugin, v, parameters, input);
      check_nodes(plugin, b, input, where, findings);
      check_sums(plugin, b, input, random, where, findings);
      check_moment(plugin, b, input, where, findings);
      findings.running("translation", v, where);
      check_translation(plugin, v, parameters, input, where, findings);
      findings.running("batches", v, where);
      check_batches(plugin, v, parameters, input, where, findings);
      if (points_of(plugin, v.dimension) > 0) check_inside_out(plugin, v, parameters, input, where, findings);
      if (extension_of<mpm_shape_boxes>(plugin)) check_boxes(plugin, v, parameters, input, where, findings);
      if (v.precision == MPM_SCALAR_DOUBLE || !(plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1)) continue;
      findings.running("agreement with scalar", v, where);
      check_agreement(b, evaluated(plugin, {MPM_SCALAR_DOUBLE, v.dimension}, parameters, input), input, where,
                      findings);
    }
}

}  // namespace mpm::conformance

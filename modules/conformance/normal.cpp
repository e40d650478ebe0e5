// Checks of contact normals: unit length, exchange of the bodies, rotation of the frame, and what their traits say.

#include <algorithm>
#include <array>

#include "conformance/support.hpp"

namespace mpm::conformance {
namespace {

/// The sums of two bodies at one node.
struct Sums {
  Vector3 mass_gradient_a{}, mass_gradient_b{}, volume_gradient_a{}, volume_gradient_b{};
};
using AllSums = std::array<Sums, full>;

/// Random sums of bodies with any densities whose surfaces face each other more or less.
AllSums random_sums(Random& random, int dimension) {
  AllSums all;
  for (Sums& sums : all) {
    const Vector3 facing = random.direction(dimension);
    for (const bool of_a : {true, false}) {
      const double size = random.logarithmic(0.1, 10), density = random.logarithmic(1e-2, 1e2);
      const Vector3 aside = random.direction(dimension);
      Vector3& volume = of_a ? sums.volume_gradient_a : sums.volume_gradient_b;
      Vector3& mass = of_a ? sums.mass_gradient_a : sums.mass_gradient_b;
      for (int i = 0; i < dimension; ++i) {
        volume[i] = size * ((of_a ? 1 : -1) * facing[i] + 0.5 * aside[i]);
        mass[i] = density * volume[i];
      }
    }
  }
  return all;
}

bool reads_sums(const Plugin& plugin) {
  return plugin.normal().traits & (MPM_READS_MASS_GRADIENT | MPM_READS_VOLUME_GRADIENT);
}
bool has_own(const Plugin& plugin) {
  return plugin.normal().traits & MPM_OWN_NORMALS;
}

struct NormalBatch {
  Variant variant;
  int count;
  Array mass_a, mass_b, volume_a, volume_b, normal, own_a, own_b, found;

  NormalBatch(const Variant& v, const AllSums& all, int entries) : variant(v), count(entries) {
    const Element element = element_of(v);
    const std::uint32_t n = static_cast<std::uint32_t>(entries);
    for (Array* vector : {&mass_a, &mass_b, &volume_a, &volume_b, &normal, &own_a, &own_b})
      *vector = Array(element, v.dimension, n);
    found = Array(Element::index, 1, n);
    for (int lane = 0; lane < entries; ++lane)
      for (int i = 0; i < v.dimension; ++i) {
        mass_a.set(i, lane, all[lane].mass_gradient_a[i]), mass_b.set(i, lane, all[lane].mass_gradient_b[i]);
        volume_a.set(i, lane, all[lane].volume_gradient_a[i]), volume_b.set(i, lane, all[lane].volume_gradient_b[i]);
      }
  }

  /// Hands over no more than the traits ask for.
  void find(const Plugin& plugin, const ParameterSample& parameters) {
    const unsigned traits = plugin.normal().traits;
    const bool masses = traits & MPM_READS_MASS_GRADIENT, volumes = traits & MPM_READS_VOLUME_GRADIENT;
    const auto given = [](bool asked, Array& array) { return asked ? array.data() : nullptr; };
    const mpm_normal_batch batch{static_cast<std::uint32_t>(count),
                                 normal.stride(),
                                 static_cast<std::uint32_t>(variant.dimension),
                                 0,
                                 given(masses, mass_a),
                                 given(masses, mass_b),
                                 given(volumes, volume_a),
                                 given(volumes, volume_b),
                                 normal.data(),
                                 given(has_own(plugin), own_a),
                                 given(has_own(plugin), own_b),
                                 static_cast<std::int32_t*>(found.data())};
    plugin.normal().from_sums[variant.precision][variant.dimension - 2](parameters.data(), &batch);
  }

  Vector3 vector(const Array& array, int lane) const {
    Vector3 r{};
    for (int i = 0; i < variant.dimension; ++i) r[i] = array(i, lane);
    return r;
  }
};

NormalBatch found_normals(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const AllSums& all,
                          int count = full) {
  NormalBatch batch(v, all, count);
  batch.find(plugin, parameters);
  return batch;
}

double distance(const Vector3& u, const Vector3& v, double sign) {
  Vector3 difference;
  for (int i = 0; i < 3; ++i) difference[i] = u[i] - sign * v[i];
  return magnitude(difference);
}

AllSums exchanged(AllSums all) {
  for (Sums& sums : all)
    std::swap(sums.mass_gradient_a, sums.mass_gradient_b), std::swap(sums.volume_gradient_a, sums.volume_gradient_b);
  return all;
}
AllSums turned_by(AllSums all, const Matrix3& rotation) {
  for (Sums& sums : all)
    for (Vector3* v : {&sums.mass_gradient_a, &sums.mass_gradient_b, &sums.volume_gradient_a, &sums.volume_gradient_b})
      *v = product(rotation, *v);
  return all;
}

/// Checks length and direction of every normal, and what the trait says of own ones.
void check_normals(const Plugin& plugin, const NormalBatch& b, const AllSums& all, const std::string& where,
                   Findings& findings) {
  Worst unit, own, outward;
  bool found = true;
  for (int lane = 0; lane < full; ++lane) {
    found &= b.found(0, lane) == 1;
    unit.add(std::abs(magnitude(b.vector(b.normal, lane)) - 1), lane);
    if (has_own(plugin))
      for (const Array* of : {&b.own_a, &b.own_b}) own.add(std::abs(magnitude(b.vector(*of, lane)) - 1), lane);
    if (!reads_sums(plugin)) continue;
    const bool masses = plugin.normal().traits & MPM_READS_MASS_GRADIENT;
    const Sums& sums = all[lane];
    const Vector3 &of_a = masses ? sums.mass_gradient_a : sums.volume_gradient_a,
                  &of_b = masses ? sums.mass_gradient_b : sums.volume_gradient_b;
    const Vector3 n = b.vector(b.normal, lane);
    outward.add(-std::max(dot(n, of_a), -dot(n, of_b)), lane);
  }
  const double bound = 16 * b.variant.epsilon();
  findings.require("finds_a_normal [" + b.variant.name() + "]", found, "1 where there is one" + where);
  findings.at_most("unit_length", b.variant, unit, bound, "| |n| - 1 |" + where);
  findings.at_most("from_a_to_b", b.variant, outward, 0, "the normal against both bodies' gradients" + where);
  if (has_own(plugin)) findings.at_most("own_unit_length", b.variant, own, bound, "of each body's own" + where);
}

/// Checks that exchanging the bodies turns the normal round, that turning the frame turns it, and that sizes do not
/// count. A normal that reads nothing does not know the bodies.
void check_symmetry(const Plugin& plugin, const NormalBatch& b, const ParameterSample& parameters, const AllSums& all,
                    const Matrix3& rotation, const std::string& where, Findings& findings) {
  if (!reads_sums(plugin)) return;
  const NormalBatch e = found_normals(plugin, b.variant, parameters, exchanged(all)),
                    t = found_normals(plugin, b.variant, parameters, turned_by(all, rotation)),
                    s = found_normals(plugin, b.variant, parameters, turned_by(all, scaled(Matrix3::identity(), 1024)));
  Worst exchange, turn, size, own;
  for (int lane = 0; lane < full; ++lane) {
    const Vector3 n = b.vector(b.normal, lane);
    exchange.add(distance(e.vector(e.normal, lane), n, -1), lane);
    turn.add(distance(t.vector(t.normal, lane), product(rotation, n), 1), lane);
    size.add(distance(s.vector(s.normal, lane), n, 1), lane);
    if (!has_own(plugin)) continue;
    own.add(distance(e.vector(e.own_a, lane), b.vector(b.own_b, lane), -1), lane);
    own.add(distance(e.vector(e.own_b, lane), b.vector(b.own_a, lane), -1), lane);
    own.add(distance(t.vector(t.own_a, lane), product(rotation, b.vector(b.own_a, lane)), 1), lane);
  }
  const double bound = 512 * b.variant.epsilon();
  findings.at_most("exchange_of_bodies", b.variant, exchange, bound, "|n + n of the exchanged pair|" + where);
  findings.at_most("rotation_of_frame", b.variant, turn, bound, "|n' - Q n|" + where);
  findings.at_most("independent_of_size", b.variant, size, bound, "|n of larger sums - n|" + where);
  if (has_own(plugin)) findings.at_most("own_normals_of_exchange", b.variant, own, bound, "of each body's own" + where);
}

/// Checks that the momentum trait tells the truth: own normals differ, as momentum would be kept otherwise.
void check_momentum(const Plugin& plugin, const NormalBatch& b, const std::string& where, Findings& findings) {
  if (!has_own(plugin)) return;
  double apart = 0;
  for (int lane = 0; lane < full; ++lane)
    apart = std::max(apart, distance(b.vector(b.own_a, lane), b.vector(b.own_b, lane), 1));
  findings.require("own_normals_differ [" + b.variant.name() + "]", apart > 0.01,
                   "a normal of each body's own that is one for both keeps momentum and says otherwise" + where);
}

/// Checks that there is no normal where nothing was summed.
void check_nothing(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const std::string& where,
                   Findings& findings) {
  if (!reads_sums(plugin)) return;
  const NormalBatch none = found_normals(plugin, v, parameters, AllSums{});
  bool absent = true;
  for (int lane = 0; lane < full; ++lane) absent &= none.found(0, lane) == 0;
  findings.require("none_of_nothing [" + v.name() + "]", absent, "0 where both gradients are zero" + where);
}

void check_agreement(const NormalBatch& b, const NormalBatch& oracle, const std::string& where, Findings& findings) {
  Worst normal;
  for (int lane = 0; lane < full; ++lane)
    normal.add(distance(b.vector(b.normal, lane), oracle.vector(oracle.normal, lane), 1), lane);
  findings.at_most("agrees_with_scalar", b.variant, normal, 256 * b.variant.epsilon(),
                   "|n - n of scalar double|" + where);
}

void check_batches(const Plugin& plugin, const NormalBatch& reference, const ParameterSample& parameters,
                   const AllSums& all, const std::string& where, Findings& findings) {
  constexpr int shift = 5;
  AllSums moved = all;
  std::rotate(moved.begin(), moved.begin() + shift, moved.end());
  const NormalBatch m = found_normals(plugin, reference.variant, parameters, moved);
  bool guards = true, written = true, same = true, inputs = true;
  for (int count = MPM_LANES; count <= full; count += MPM_LANES) {
    const NormalBatch untouched(reference.variant, all, count);
    const NormalBatch b = found_normals(plugin, reference.variant, parameters, all, count);
    for (const Array* out : {&b.normal, &b.found, &b.own_a, &b.own_b}) {
      guards &= out->guards_intact();
      if (has_own(plugin) || out == &b.normal || out == &b.found) written &= out->all_written();
    }
    inputs &= b.mass_a == untouched.mass_a && b.mass_b == untouched.mass_b && b.volume_a == untouched.volume_a &&
              b.volume_b == untouched.volume_b;
    for (int lane = 0; lane < count; ++lane)
      for (int i = 0; i < b.variant.dimension; ++i) {
        same &= b.normal(i, lane) == reference.normal(i, lane);
        same &= reference.normal(i, lane) == m.normal(i, (lane + full - shift) % full);
      }
  }
  const std::string variant = " [" + reference.variant.name() + "]";
  findings.require("writes_inside_arrays" + variant, guards, "guards around the outputs" + where);
  findings.require("writes_every_output" + variant, written, "no output element is left out" + where);
  findings.require("inputs_untouched" + variant, inputs, "the gradients" + where);
  findings.require("independent_of_batch" + variant, same,
                   "counts of 16 to 64, whichever pairs share the pack" + where);
}

void check_sums(const Plugin& plugin, const ParameterSample& parameters, const Variant& v, Random& random,
                Findings& findings) {
  const std::string where = parameters.text.empty() ? "" : "; " + parameters.text;
  const AllSums all = random_sums(random, v.dimension);
  findings.running("normals", v, where);
  const NormalBatch b = found_normals(plugin, v, parameters, all);
  check_normals(plugin, b, all, where, findings);
  findings.running("symmetry and frames", v, where);
  check_symmetry(plugin, b, parameters, all, random.rotation(v.dimension), where, findings);
  check_momentum(plugin, b, where, findings);
  check_nothing(plugin, v, parameters, where, findings);
  findings.running("batches", v, where);
  check_batches(plugin, b, parameters, all, where, findings);
  if (v.precision == MPM_SCALAR_DOUBLE || !(plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1)) return;
  check_agreement(b, found_normals(plugin, {MPM_SCALAR_DOUBLE, v.dimension}, parameters, all), where, findings);
}

// ---- normals that look at points ---------------------------------------------------------------------------------

/// Particles of one body near a node, cells from it.
struct Cloud {
  std::vector<Vector3> places;
  std::vector<double> weights;
};

/// Particles on the side of a plane to which the normal points, or on the other.
Cloud beside_plane(Random& random, int dimension, const Vector3& normal, double side) {
  Cloud cloud;
  const int count = 5 + static_cast<int>(random.uniform(0, 20));
  while (static_cast<int>(cloud.places.size()) < count) {
    Vector3 x{};
    for (int i = 0; i < dimension; ++i) x[i] = random.uniform(-1.5, 1.5);
    if (side * dot(x, normal) < 0.1) continue;
    cloud.places.push_back(x), cloud.weights.push_back(random.uniform(0.1, 1));
  }
  return cloud;
}

class Points {
 public:
  Points(const Plugin& plugin, const ParameterSample& parameters, int dimension)
      : plugin_(plugin), parameters_(parameters), dimension_(dimension) {}

  Vector3 normal(const Cloud& a, const Cloud& b) {
    Array at_a = row(a, true), at_b = row(b, true), weight_a = row(a, false), weight_b = row(b, false);
    Array out(Element::double_precision, 1, 3);
    const mpm_normal_points points{static_cast<std::uint32_t>(a.places.size()),
                                   at_a.stride(),
                                   static_cast<std::uint32_t>(b.places.size()),
                                   at_b.stride(),
                                   static_cast<const double*>(at_a.data()),
                                   static_cast<const double*>(at_b.data()),
                                   static_cast<const double*>(weight_a.data()),
                                   static_cast<const double*>(weight_b.data()),
                                   static_cast<double*>(out.data())};
    found = plugin_.normal().from_points[dimension_ - 2](parameters_.data(), &points) != 0;
    guards = guards && out.guards_intact();
    return {out(0, 0), out(0, 1), out(0, 2)};
  }

  bool found = false, guards = true;

 private:
  /// The first particle once more in the lanes that are left over, without weight.
  static Array row(const Cloud& cloud, bool places) {
    const std::uint32_t count = static_cast<std::uint32_t>(cloud.places.size()),
                        padded = (count + MPM_LANES - 1) / MPM_LANES * MPM_LANES;
    Array array(Element::double_precision, places ? 3 : 1, padded);
    for (std::uint32_t k = 0; k < array.stride(); ++k) {
      const std::size_t from = k < count ? k : 0;
      for (int i = 0; i < (places ? 3 : 1); ++i)
        array.set(i, static_cast<int>(k), places ? cloud.places[from][i] : k < count ? cloud.weights[k] : 0);
    }
    return array;
  }

  const Plugin& plugin_;
  const ParameterSample& parameters_;
  const int dimension_;
};

Cloud turned_by(Cloud cloud, const Matrix3& rotation) {
  for (Vector3& x : cloud.places) x = product(rotation, x);
  return cloud;
}
Cloud mirrored(Cloud cloud, const Vector3& normal) {
  for (Vector3& x : cloud.places) {
    const double along = dot(x, normal);
    for (int i = 0; i < 3; ++i) x[i] -= 2 * along * normal[i];
  }
  return cloud;
}

/// Checks clouds that a plane parts. Between a cloud and its mirror image the normal is the mirror's, whatever it
/// minimizes.
void check_points(const Plugin& plugin, const ParameterSample& parameters, int dimension, Random& random,
                  Findings& findings) {
  const std::string where = parameters.text.empty() ? "" : "; " + parameters.text;
  const Variant v{MPM_SCALAR_DOUBLE, dimension};
  findings.running("points", v, where);
  Points points(plugin, parameters, dimension);
  Worst unit, flat, exchange, turn, mirror;
  bool found = true, across = true;
  for (int k = 0; k < full; ++k) {
    const Vector3 facing = random.direction(dimension);
    const Cloud a = beside_plane(random, dimension, facing, -1), b = beside_plane(random, dimension, facing, 1);
    const Matrix3 rotation = random.rotation(dimension);
    const Vector3 n = points.normal(a, b);
    found &= points.found;
    unit.add(std::abs(magnitude(n) - 1), k);
    if (dimension == 2) flat.add(std::abs(n[2]), k);
    across &= dot(n, facing) > 0;
    exchange.add(distance(points.normal(b, a), n, -1), k);
    turn.add(distance(points.normal(turned_by(a, rotation), turned_by(b, rotation)), product(rotation, n), 1), k);
    mirror.add(distance(points.normal(a, mirrored(a, facing)), facing, 1), k);
  }
  constexpr double bound = 1e-6;  // of what iterations leave
  findings.require("finds_a_normal [" + v.name() + "]", found, "1 where a plane parts the particles" + where);
  findings.at_most("unit_length", v, unit, 16 * v.epsilon(), "| |n| - 1 |" + where);
  findings.at_most("in_the_plane", v, flat, 0, "z of the normal in 2-D" + where);
  findings.require("from_a_to_b [" + v.name() + "]", across, "across the plane that parts the particles" + where);
  findings.at_most("exchange_of_bodies", v, exchange, bound, "|n + n of the exchanged bodies|" + where);
  findings.at_most("rotation_of_frame", v, turn, bound, "|n' - Q n|" + where);
  findings.at_most("mirror_image", v, mirror, bound, "the normal between a body and its mirror image" + where);
  findings.require("writes_inside_arrays [" + v.name() + "]", points.guards, "guards around the normal" + where);
}

}  // namespace

void check_normal(const Plugin& plugin, Findings& findings) {
  Random random(20251120);
  const bool by_points = plugin.normal().traits & MPM_LOOKS_AT_POINTS;
  findings.require("points_share_a_normal", !by_points || !has_own(plugin), "particles give one normal for the pair");
  for (const ParameterSample& parameters : sample_parameters(plugin, random))
    if (by_points) {
      for (const int dimension : {2, 3})
        if (plugin.descriptor->dimensions & (dimension == 2 ? MPM_2D : MPM_3D))
          check_points(plugin, parameters, dimension, random, findings);
    } else {
      for (const Variant& v : variants_of(*plugin.descriptor)) check_sums(plugin, parameters, v, random, findings);
    }
}

}  // namespace mpm::conformance

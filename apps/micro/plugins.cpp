// Benchmarks of plugins through the entries that the cpu backend calls, as loaded at run time: no inlining, the
// parameters of the conformance suite's first sample, batches of 64 in the first-level cache.

#include <memory>
#include <stdexcept>
#include <utility>

#include "micro.hpp"

namespace mpm::micro {
namespace {

using conformance::ParameterSample;
using conformance::Random;

constexpr double step = 0x1p-10;  ///< s

/// One plugin in one dimension and precision.
struct Variant {
  const Plugin* plugin;
  std::shared_ptr<const ParameterSample> parameters;
  int dimension;
  bool single;

  mpm_precision precision() const { return single ? MPM_LANES_FLOAT : MPM_LANES_DOUBLE; }
  Element element() const { return single ? Element::single_precision : Element::double_precision; }
  Buffer buffer(int components) const { return {element(), components}; }
  Buffer indices(int components) const { return {Element::index, components}; }
  Buffer random(Random& random, int components, double low, double high) const {
    Buffer result = buffer(components);
    for (int c = 0; c < components; ++c)
      for (int lane = 0; lane < batch; ++lane) result.set(c, lane, random.uniform(low, high));
    return result;
  }
  /// Matrices of `size` times the unit matrix, with entries up to `spread` beside it.
  Buffer near_unit(Random& random, double size, double spread) const {
    Buffer result = buffer(dimension * dimension);
    for (int c = 0; c < dimension * dimension; ++c)
      for (int lane = 0; lane < batch; ++lane)
        result.set(c, lane, (c % (dimension + 1) == 0 ? size : 0) + random.uniform(-spread, spread));
    return result;
  }
  std::vector<Restored> state(Random& random) const {
    std::vector<Restored> fields;
    for (const mpm_state& field : plugin->state()) {
      const int components = state_components(static_cast<mpm_state_shape>(field.shape), dimension);
      fields.push_back(
          {plugin->descriptor->kind == MPM_MATERIAL ? buffer(components) : this->random(random, components, -1, 1),
           {}});
      if (plugin->descriptor->kind != MPM_MATERIAL) continue;
      for (int c = 0; c < components; ++c)
        for (int lane = 0; lane < batch; ++lane)
          fields.back().field.set(c, lane, conformance::initial_value(field, c, dimension));
    }
    for (Restored& field : fields) field.keep();
    return fields;
  }
  /// A batch's header: count, stride, dimension.
  template <class Batch>
  Batch header() const {
    Batch b{};
    b.count = batch, b.stride = batch, b.dimension = static_cast<std::uint32_t>(dimension);
    return b;
  }
};

std::vector<void*> pointers(std::vector<Restored>& fields) {
  std::vector<void*> all;
  for (Restored& field : fields) all.push_back(field.field.data());
  return all;
}

std::string sound(std::initializer_list<Buffer*> outputs) {
  for (Buffer* output : outputs)
    if (!output->finite()) return "an output is not a number";
  return {};
}

// ---- shapes --------------------------------------------------------------------------------------------------------

struct ShapeCase {
  Variant v;
  Buffer position, half_size, domain, base, offset, weight, gradient, second_moment;

  ShapeCase(const Variant& variant, bool with_gradient) : v(variant) {
    Random random(1);
    const int D = v.dimension, width = static_cast<int>(v.plugin->shape().width);
    position = v.random(random, D, 4, 12);
    if (v.plugin->descriptor->needs & MPM_NEEDS_HALF_SIZE) half_size = v.random(random, D, 0.2, 0.3);
    if (v.plugin->descriptor->needs & MPM_NEEDS_DOMAIN) domain = v.near_unit(random, 0.25, 0.02);
    base = v.indices(D), offset = v.buffer(D), weight = v.buffer(D * width);
    if (with_gradient) gradient = v.buffer(D * width);
    if (v.plugin->shape().second_moment_kind == MPM_MOMENT_PER_PARTICLE) second_moment = v.buffer(D);
  }
  void run() {
    auto b = v.header<mpm_shape_batch>();
    b.position = position.data(), b.half_size = half_size.data(), b.domain = domain.data();
    b.base = static_cast<std::int32_t*>(base.data());
    b.offset = offset.data(), b.weight = weight.data(), b.gradient = gradient.data();
    b.second_moment = second_moment.data();
    v.plugin->shape().evaluate[v.precision()](v.parameters->data(), &b);
  }
  std::string problem() { return sound({&offset, &weight, &gradient, &second_moment}); }
};

struct ListCase {
  Variant v;
  Buffer position, half_size, domain, corners, node_count, node, weight, gradient, second_moment;

  ListCase(const Variant& variant, bool with_gradient) : v(variant) {
    Random random(1);
    const int D = v.dimension, capacity = static_cast<int>(v.plugin->shape().capacity[D - 2]);
    position = v.random(random, D, 4, 12);
    if (v.plugin->descriptor->needs & MPM_NEEDS_HALF_SIZE) half_size = v.random(random, D, 0.2, 0.3);
    if (v.plugin->descriptor->needs & MPM_NEEDS_DOMAIN) domain = v.near_unit(random, 0.25, 0.02);
    const int points = static_cast<int>(v.plugin->shape().sample_points[D - 2]);
    if (points > 0) corners = v.buffer(points * D);
    for (int k = 0; k < points * D; ++k)
      for (int lane = 0; lane < batch; ++lane)
        corners.set(k, lane, (k / D >> k % D & 1 ? 0.25 : -0.25) + random.uniform(-0.01, 0.01));
    node_count = v.indices(1), node = v.indices(capacity * D), weight = v.buffer(capacity);
    if (with_gradient) gradient = v.buffer(capacity * D);
    if (v.plugin->shape().second_moment_kind == MPM_MOMENT_PER_PARTICLE) second_moment = v.buffer(D * D);
  }
  void run() {
    auto b = v.header<mpm_list_batch>();
    b.capacity = v.plugin->shape().capacity[v.dimension - 2];
    b.position = position.data(), b.half_size = half_size.data(), b.domain = domain.data();
    b.samples = corners.data();
    b.node_count = static_cast<std::int32_t*>(node_count.data());
    b.node = static_cast<std::int32_t*>(node.data());
    b.weight = weight.data(), b.gradient = gradient.data(), b.second_moment = second_moment.data();
    v.plugin->shape().evaluate_list[v.precision()][v.dimension - 2](v.parameters->data(), &b);
  }
  std::string problem() {
    for (int lane = 0; lane < batch; ++lane)
      if (static_cast<std::int32_t*>(node_count.data())[lane] <= 0) return "a particle has no node";
    return sound({&weight, &gradient, &second_moment});
  }
};

// ---- transfers -----------------------------------------------------------------------------------------------------

struct ScatterCase {
  Variant v;
  Buffer mass, velocity, b, A;
  std::vector<Restored> state;

  explicit ScatterCase(const Variant& variant) : v(variant) {
    Random random(1);
    const int D = v.dimension;
    mass = v.random(random, 1, 0.5, 1), velocity = v.random(random, D, -1, 1), state = v.state(random);
    b = v.buffer(D);
    if (v.plugin->transfer().traits & MPM_SCATTERS_AFFINE) A = v.buffer(D * D);
  }
  void run() {
    const std::vector<void*> fields = pointers(state);
    auto q = v.header<mpm_scatter_batch>();
    q.mass = mass.data(), q.velocity = velocity.data(), q.state = fields.data(), q.b = b.data(), q.A = A.data();
    v.plugin->transfer().scatter[v.precision()][v.dimension - 2](v.parameters->data(), &q);
  }
  std::string problem() { return sound({&b, &A}); }
};

struct GatherCase {
  Variant v;
  Buffer gathered, increment, affine, gradient, advection;
  Restored velocity;
  std::vector<Restored> state;

  explicit GatherCase(const Variant& variant) : v(variant) {
    Random random(1);
    const int D = v.dimension;
    const std::uint32_t traits = v.plugin->transfer().traits;
    gathered = v.random(random, D, -1, 1), velocity.field = v.random(random, D, -1, 1);
    velocity.keep();
    if (traits & MPM_GATHERS_INCREMENT) increment = v.random(random, D, -1, 1);
    if (traits & MPM_GATHERS_AFFINE) affine = v.random(random, D * D, -1, 1);
    if (traits & MPM_GATHERS_GRADIENT) gradient = v.random(random, D * D, -1, 1);
    advection = v.buffer(D), state = v.state(random);
  }
  void run() {
    velocity.restore();
    for (Restored& field : state) field.restore();
    const std::vector<void*> fields = pointers(state);
    auto q = v.header<mpm_gather_batch>();
    q.dt = step, q.velocity = gathered.data(), q.velocity_increment = increment.data(), q.affine = affine.data();
    q.velocity_gradient = gradient.data(), q.particle_velocity = velocity.field.data();
    q.state = fields.data(), q.advection_velocity = advection.data();
    v.plugin->transfer().gather[v.precision()][v.dimension - 2](v.parameters->data(), &q);
  }
  std::string problem() { return sound({&velocity.field, &advection}); }
};

// ---- filters and contact laws --------------------------------------------------------------------------------------

struct FilterCase {
  Variant v;
  Buffer projected;
  Restored increment, velocity;

  explicit FilterCase(const Variant& variant) : v(variant) {
    Random random(1);
    projected = v.random(random, v.dimension, -1, 1);
    for (Restored* field : {&increment, &velocity}) field->field = v.random(random, v.dimension, -1, 1), field->keep();
  }
  void run() {
    increment.restore(), velocity.restore();
    auto q = v.header<mpm_filter_batch>();
    q.iteration = 1, q.projected = projected.data(), q.increment = increment.field.data();
    q.velocity = velocity.field.data();
    v.plugin->filter().update[v.precision()][v.dimension - 2](v.parameters->data(), &q);
  }
  std::string problem() { return sound({&increment.field, &velocity.field}); }
};

/// Pairs of which half press and half are apart; some stick and some slip.
struct ContactCase {
  Variant v;
  Buffer mass_a, mass_b, momentum_a, momentum_b, normal, separation, area, impulse, dissipated, status, displacement,
      traction, stored, state, reached;

  explicit ContactCase(const Variant& variant) : v(variant) {
    Random random(1);
    const int D = v.dimension;
    mass_a = v.random(random, 1, 0.5, 1), mass_b = v.random(random, 1, 0.5, 1);
    momentum_a = v.random(random, D, -1, 1), momentum_b = v.random(random, D, -1, 1);
    separation = v.random(random, 1, -0.1, 0.1), area = v.random(random, 1, 0.5, 1);
    normal = v.buffer(D), impulse = v.buffer(D), dissipated = v.buffer(1), status = v.indices(1);
    displacement = v.random(random, D, -step, step), stored = v.buffer(1), traction = v.random(random, D, -1, 1);
    state = v.random(random, MPM_CONTACT_STATES, 0, 1), reached = v.buffer(MPM_CONTACT_STATES);
    for (int lane = 0; lane < batch; ++lane) {
      const conformance::Vector3 n = random.direction(D);
      for (int a = 0; a < D; ++a) normal.set(a, lane, n[a]);
    }
  }
  void run() {
    auto q = v.header<mpm_contact_batch>();
    q.stage = MPM_AFTER_FORCES, q.dt = step, q.mass_a = mass_a.data(), q.mass_b = mass_b.data();
    q.momentum_a = momentum_a.data(), q.momentum_b = momentum_b.data(), q.normal = normal.data();
    q.separation = separation.data(), q.area = area.data(), q.impulse = impulse.data();
    q.dissipated = dissipated.data(), q.status = static_cast<std::int32_t*>(status.data());
    if (v.plugin->contact().traits & MPM_COMPLIANT) q.displacement = displacement.data(), q.stored = stored.data();
    if (v.plugin->contact().traits & MPM_READS_TRACTION) q.traction = traction.data();
    if (!v.plugin->state().empty())
      q.state_a = q.state_b = q.gained_a = q.gained_b = state.data(), q.reached = reached.data();
    q.cell_size = 0.2;
    v.plugin->contact().apply[v.precision()][v.dimension - 2](v.parameters->data(), &q);
  }
  std::string problem() { return sound({&impulse, &dissipated}); }
};

/// Bodies that face each other at every node.
struct NormalCase {
  Variant v;
  std::vector<Buffer> gradients;
  Buffer normal, own_a, own_b, found;

  explicit NormalCase(const Variant& variant) : v(variant) {
    Random random(1);
    const int D = v.dimension;
    for (int k = 0; k < 4; ++k) gradients.push_back(v.random(random, D, k % 2 ? -1 : 0.5, k % 2 ? -0.5 : 1));
    for (Buffer* out : {&normal, &own_a, &own_b}) *out = v.buffer(D);
    found = v.indices(1);
  }
  void run() {
    auto q = v.header<mpm_normal_batch>();
    q.mass_gradient_a = gradients[0].data(), q.mass_gradient_b = gradients[1].data();
    q.volume_gradient_a = gradients[2].data(), q.volume_gradient_b = gradients[3].data();
    q.normal = normal.data(), q.own_a = own_a.data(), q.own_b = own_b.data();
    q.found = static_cast<std::int32_t*>(found.data());
    v.plugin->normal().from_sums[v.precision()][v.dimension - 2](v.parameters->data(), &q);
  }
  std::string problem() { return sound({&normal}); }
};

/// Bodies whose faces lie within a cell of each other.
struct DetectionCase {
  Variant v;
  std::vector<Buffer> of_a, of_b;  ///< means, edges, surfaces
  Buffer gap;

  explicit DetectionCase(const Variant& variant) : v(variant) {
    Random random(1);
    for (int k = 0; k < 3; ++k) of_a.push_back(v.random(random, 1, -1, 0)), of_b.push_back(v.random(random, 1, 0, 1));
    gap = v.buffer(1);
  }
  void run() {
    const mpm_detection& detection = v.plugin->detection();
    mpm_detection_batch q{};
    q.count = q.stride = batch, q.gap = gap.data();
    if (detection.traits & MPM_READS_MEAN_POSITION) q.mean_a = of_a[0].data(), q.mean_b = of_b[0].data();
    if (detection.traits & MPM_READS_EDGES) q.edge_a = of_a[1].data(), q.edge_b = of_b[1].data();
    if (detection.traits & MPM_READS_PARTICLE_SURFACES) q.surface_a = of_a[2].data(), q.surface_b = of_b[2].data();
    detection.find[v.precision()](v.parameters->data(), &q);
  }
  std::string problem() { return sound({&gap}); }
};

// ---- materials -----------------------------------------------------------------------------------------------------

enum MaterialOutputs { advances = 1, stress = 2, energy = 4, speed = 8 };

/// A state strained by up to a twentieth in every component; an advance strains it by a thousandth more.
struct MaterialCase {
  Variant v;
  int wanted;
  Buffer gradient, tau, stored, dissipated, wave;
  std::vector<Restored> state;
  std::int32_t inadmissible = -1;

  MaterialCase(const Variant& variant, int outputs) : v(variant), wanted(advances) {
    Random random(1);
    const int D = v.dimension;
    state = v.state(random), tau = v.buffer(D == 2 ? 4 : 6);
    for (Buffer* scalar : {&stored, &dissipated, &wave}) *scalar = v.buffer(1);
    gradient = v.random(random, D * D, -0.05 / step, 0.05 / step);
    run();
    for (Restored& field : state) field.keep();
    gradient = v.random(random, D * D, -0.001 / step, 0.001 / step);
    wanted = outputs;
  }
  void run() {
    if (wanted & advances)
      for (Restored& field : state) field.restore();
    const std::vector<void*> fields = pointers(state);
    auto q = v.header<mpm_material_batch>();
    q.dt = step, q.state = fields.data();
    if (wanted & advances) q.velocity_gradient = gradient.data(), q.dissipated_energy = dissipated.data();
    if (wanted & stress) q.kirchhoff_stress = tau.data();
    if (wanted & energy) q.stored_energy = stored.data();
    if (wanted & speed) q.wave_speed = wave.data();
    inadmissible = v.plugin->material().update[v.precision()][v.dimension - 2](v.parameters->data(), &q);
  }
  std::string problem() {
    if (inadmissible >= 0) return "the plugin calls an ordinary state inadmissible";
    return sound({&tau, &stored, &dissipated, &wave});
  }
};

// ---- registration --------------------------------------------------------------------------------------------------

void add_variant(const Variant& v, const std::string& name) {
  switch (v.plugin->descriptor->kind) {
    case MPM_SHAPE:
      for (const bool gradient : {false, true}) {
        const std::string entry = name + (gradient ? "/weights_gradients" : "/weights");
        if (v.plugin->shape().form == MPM_NODE_LIST)
          add(entry, "particle", [=] { return ListCase(v, gradient); });
        else
          add(entry, "particle", [=] { return ShapeCase(v, gradient); });
      }
      return;
    case MPM_TRANSFER:
      add(name + "/scatter", "particle", [=] { return ScatterCase(v); });
      add(name + "/gather", "particle", [=] { return GatherCase(v); });
      return;
    case MPM_FILTER:
      add(name + "/update", "node", [=] { return FilterCase(v); });
      return;
    case MPM_CONTACT:
      add(name + "/apply", "pair", [=] { return ContactCase(v); });
      return;
    case MPM_NORMAL:  // those that look at particles have no batches
      if (!(v.plugin->normal().traits & MPM_LOOKS_AT_POINTS))
        add(name + "/find", "pair", [=] { return NormalCase(v); });
      return;
    case MPM_DETECTION:
      add(name + "/find", "pair", [=] { return DetectionCase(v); });
      return;
    case MPM_MATERIAL: {
      const std::pair<const char*, int> entries[] = {{"/advance_stress", advances | stress},
                                                     {"/advance", advances},
                                                     {"/stress", stress},
                                                     {"/energy", energy},
                                                     {"/wave_speed", speed}};
      for (const auto& entry : entries)
        add(name + entry.first, "particle", [v, outputs = entry.second] { return MaterialCase(v, outputs); });
      return;
    }
    default:
      throw std::logic_error("no benchmark for this kind of plugin: " + name);
  }
}

}  // namespace

void add_plugins(const Registry& registry) {
  for (const mpm_kind kind : all_kinds())
    for (const Plugin* plugin : registry.of_kind(kind)) {
      Random random(1);
      const auto parameters =
          std::make_shared<const ParameterSample>(conformance::sample_parameters(*plugin, random).front());
      for (const int dimension : {2, 3})
        for (const bool single : {true, false}) {
          const mpm_descriptor& d = *plugin->descriptor;
          if (!(d.dimensions & (dimension == 2 ? MPM_2D : MPM_3D))) continue;
          const Variant v{plugin, parameters, dimension, single};
          if (!(d.precisions & (1U << v.precision()))) continue;
          add_variant(v, std::string(kind_name(kind)) + "/" + std::string(plugin->id()) + "/" +
                             variant_name(dimension, single));
        }
    }
}

}  // namespace mpm::micro

#pragma once
// Contact whose normal or detection looks at particles (simulation/contact_points.hpp). The host finds it once a step on
// copies of particles and nodes, as positions do not move within a step, and hands it to the device for all stages of it.

#include <algorithm>
#include <span>
#include <vector>

#include "backends/device/device_arrays.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/contact_pair.hpp"

namespace mpm::device {

/// The values of one velocity field that detection reads, on the host.
template <class T>
struct ContactFields {
  std::vector<T> mass, volume_gradient, mass_position, mass_gradient;  ///< the last two where they are read

  ContactFields(const VelocityField<T>& field, const Plan& plan)
      : mass(field.arrays.read("mass")), volume_gradient(field.arrays.read("volume_gradient")) {
    if (plan.node_field("mass_position")) mass_position = field.arrays.read("mass_position");
    if (plan.node_field("mass_gradient")) mass_gradient = field.arrays.read("mass_gradient");
  }
  ContactFieldNode at(std::size_t node, int dimension) const {
    ContactFieldNode view;
    view.mass = mass[node];
    for (int c = 0; c < dimension; ++c) {
      const std::size_t at = static_cast<std::size_t>(c) * mass.size() + node;
      view.volume_gradient[c] = volume_gradient[at];
      if (!mass_position.empty()) view.mass_position[c] = mass_position[at];
      if (!mass_gradient.empty()) view.mass_gradient[c] = mass_gradient[at];
    }
    return view;
  }
};

/// The geometry of all pairs of velocity fields at all nodes.
template <class T>
class ContactPairs {
 public:
  ContactPairs(Device& device, const Experiment& experiment, const Plan& plan, const Arguments<T>& scene)
      : experiment_(experiment),
        plan_(plan),
        scene_(scene),
        geometry_(experiment, MPM_SCALAR_DOUBLE),
        points_(experiment) {
    for (int k = 0; k < experiment.field_count * (experiment.field_count - 1) / 2; ++k) pairs_.emplace_back(device);
  }

  /// Finds everything, once the masses of the nodes are known.
  void find(const std::vector<Body<T>>& bodies, const std::vector<VelocityField<T>>& fields) {
    std::vector<ContactFields<T>> found;
    for (const VelocityField<T>& field : fields) found.emplace_back(field, plan_);
    open_nodes(found);
    show_particles(bodies);
    points_.find(0, points_.node_count());
    for (int a = 0; a < experiment_.field_count; ++a)
      for (int b = a + 1; b < experiment_.field_count; ++b) find_pair(found, a, b);
  }
  /// What was found for fields a < b, at the device's addresses.
  FoundContact<T> of(int a, int b) const {
    const Pair& pair = pairs_[pair_number(a, b)];
    return {pair.valid.data(), pair.values.data()};
  }

 private:
  struct Pair {
    DeviceArray<int> valid;
    DeviceArray<T> values;
    explicit Pair(Device& device) : valid(device, "contact"), values(device, "contact") {}
  };
  std::size_t nodes() const { return static_cast<std::size_t>(scene_.node_count); }
  std::size_t pair_number(int a, int b) const { return pair_index(a, b, experiment_.field_count); }
  std::array<int, 3> coordinates(std::size_t node) const {
    std::array<int, 3> at{};
    auto rest = static_cast<int>(node);
    for (int c = 0; c < experiment_.dimension; rest /= scene_.extent[c], ++c)
      at[c] = rest % scene_.extent[c] - scene_.padding[c];
    return at;
  }

  void open_nodes(const std::vector<ContactFields<T>>& found) {
    points_.begin();
    for (std::size_t node = 0; node < nodes(); ++node) {
      int present = 0;
      for (const ContactFields<T>& field : found) present += field.mass[node] > 0;
      if (present > 1) points_.open(coordinates(node));
    }
  }
  void show_particles(const std::vector<Body<T>>& bodies) {
    for (const Body<T>& body : bodies) {
      const bool by_domain = body.number("domain") >= 0;
      const std::vector<T> position = body.arrays.read("position"), size = body.arrays.read("size"),
                           sides = by_domain                 ? body.arrays.read("domain")
                                   : points_.sees_surfaces() ? body.arrays.read("deformation")
                                                             : std::vector<T>();
      const auto n = static_cast<std::size_t>(body.count);
      for (std::size_t p = 0; p < n; ++p) {
        Vector3 x = body.vector(position, p);
        for (int c = 0; c < experiment_.dimension; ++c)
          x[c] = (x[c] - experiment_.grid.lower[c]) / experiment_.grid.cell_size;
        if (!points_.look_around(x, x)) continue;
        const double volume =
            double(body.volume) * (size.empty() || experiment_.axisymmetric() ? 1.0 : double(size[p]));
        points_.add(body.field, x, sides.empty() ? nullptr : sides.data() + p, n,
                    by_domain ? 1.0 : points_.half_side(volume));
      }
    }
  }
  void find_pair(const std::vector<ContactFields<T>>& found, int a, int b) {
    const std::size_t D = experiment_.dimension;
    std::vector<int> valid(nodes());
    std::vector<T> values((D + 2) * nodes());
    std::vector<MetPair> met;
    std::vector<std::size_t> at;
    for (std::size_t node = 0; node < nodes(); ++node) {
      if (!meet(found[a].mass[node], found[b].mass[node], /*weld=*/false)) continue;  // a weld looks at no particle
      met.push_back(
          {coordinates(node), found[a].at(node, experiment_.dimension), found[b].at(node, experiment_.dimension), {}});
      at.push_back(node);
    }
    for (std::span<MetPair> left(met); !left.empty();) {
      const std::size_t count = std::min<std::size_t>(MPM_BATCH, left.size());
      geometry_.find(points_, a, b, left.first(count));
      left = left.subspan(count);
    }
    for (std::size_t i = 0; i < met.size(); ++i) {
      const ContactGeometry& geometry = met[i].geometry;
      const std::size_t node = at[i];
      valid[node] = geometry.valid;
      values[node] = static_cast<T>(geometry.separation), values[nodes() + node] = static_cast<T>(geometry.area);
      for (std::size_t c = 0; c < D; ++c) values[(2 + c) * nodes() + node] = static_cast<T>(geometry.normal[c]);
    }
    pairs_[pair_number(a, b)].valid.upload(valid), pairs_[pair_number(a, b)].values.upload(values);
  }

  const Experiment& experiment_;
  const Plan& plan_;
  const Arguments<T>& scene_;
  PairGeometry geometry_;
  ContactPoints points_;
  std::vector<Pair> pairs_;  ///< [pair_index]
};

}  // namespace mpm::device

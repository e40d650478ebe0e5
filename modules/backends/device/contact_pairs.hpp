#pragma once
// Two velocity fields that meet: the host finds where and how, the device applies the law, and the host counts what it
// gave.

#include <algorithm>
#include <string>
#include <vector>

#include "backends/device/device_arrays.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/contact_pair.hpp"

namespace mpm::device {

/// The fields of one velocity field that detection reads, on the host.
template <class T>
struct ContactFields {
  std::vector<T> mass, volume, volume_gradient, mass_position;

  explicit ContactFields(const VelocityField<T>& field)
      : mass(field.arrays.read("mass")),
        volume(field.arrays.read("volume")),
        volume_gradient(field.arrays.read("volume_gradient")),
        mass_position(field.arrays.read("mass_position")) {}
  ContactFieldNode at(std::size_t node, int dimension) const {
    ContactFieldNode view{mass[node], volume[node], {}, {}};
    for (int c = 0; c < dimension; ++c) {
      const std::size_t at = static_cast<std::size_t>(c) * mass.size() + node;
      view.volume_gradient[c] = volume_gradient[at], view.mass_position[c] = mass_position[at];
    }
    return view;
  }
};

/// What is found and given at the nodes for one pair at a time.
template <class T>
class ContactPairs {
 public:
  /// Without contact there are no nodes.
  ContactPairs(Device& device, const Experiment& experiment, std::size_t nodes)
      : experiment_(experiment),
        geometry_(experiment),
        points_(experiment),
        nodes_(nodes),
        active_on_device_(device, "contact", nodes),
        status_on_device_(device, "contact", nodes),
        normal_on_device_(device, "contact", vectors()),
        separation_on_device_(device, "contact", nodes),
        area_on_device_(device, "contact", nodes),
        impulse_on_device_(device, "contact", vectors()),
        unbalanced_on_device_(device, "contact", vectors()),
        dissipated_on_device_(device, "contact", nodes),
        active_(nodes),
        normal_(vectors()),
        separation_(nodes),
        area_(nodes) {}

  /// The particles near nodes where fields meet, which `find` looks at where the scene asks for them.
  ContactPoints& points() { return points_; }
  /// The coordinates of a node.
  std::array<int, 3> coordinates(std::size_t node, const Arguments<T>& scene) const {
    std::array<int, 3> at{};
    auto rest = static_cast<int>(node);
    for (int c = 0; c < experiment_.dimension; rest /= scene.extent[c], ++c)
      at[c] = rest % scene.extent[c] - scene.padding[c];
    return at;
  }
  /// Finds normal, separation and area at every node that two fields share (simulation/contact_pair.hpp).
  void find(const ContactFields<T>& first, std::size_t a, const ContactFields<T>& second, std::size_t b,
            const Arguments<T>& scene) {
    const bool weld = experiment_.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION;
    const int D = experiment_.dimension;
    for (std::size_t node = 0; node < nodes_; ++node) {
      const ContactFieldNode of_a = first.at(node, D), of_b = second.at(node, D);
      active_[node] = 0;
      if (!meet(of_a.mass, of_b.mass, weld)) continue;
      const ContactGeometry geometry =
          geometry_(points_, coordinates(node, scene), static_cast<int>(a), static_cast<int>(b), of_a, of_b);
      if (!geometry.valid && !weld) continue;
      active_[node] = 1;
      for (int c = 0; c < D; ++c)
        normal_[static_cast<std::size_t>(c) * nodes_ + node] = static_cast<T>(geometry.normal[c]);
      separation_[node] = static_cast<T>(geometry.separation), area_[node] = static_cast<T>(geometry.area);
    }
    active_on_device_.upload(active_), normal_on_device_.upload(normal_);
    separation_on_device_.upload(separation_), area_on_device_.upload(area_);
  }
  ContactArrays<T> table() const {
    return {active_on_device_.data(),     normal_on_device_.data(),  separation_on_device_.data(),
            area_on_device_.data(),       impulse_on_device_.data(), unbalanced_on_device_.data(),
            dissipated_on_device_.data(), status_on_device_.data()};
  }
  /// Waits for what the law gave the pair.
  void read() {
    impulse_ = impulse_on_device_.download(), unbalanced_ = unbalanced_on_device_.download();
    dissipated_ = dissipated_on_device_.download(), status_ = status_on_device_.download();
  }

  /// Adds what was given to the sum over all pairs, and where these are asked for notes the pair itself.
  void add_to(ContactGiven& sum, bool by_pair) const {
    PairGiven pair;
    for_each_active([&](std::size_t node) {
      sum.dissipated += dissipated_[node];
      for (int c = 0; c < experiment_.dimension; ++c) {
        const double impulse = impulse_[static_cast<std::size_t>(c) * nodes_ + node];
        sum.impulse[c] += impulse, pair.impulse[c] += impulse;
      }
      pair.count(status_[node], separation_[node], true);
    });
    if (by_pair) sum.pairs.push_back(pair);
  }
  void add_to(ContactRecord& record, Vector3& unbalanced) const {
    for_each_active([&](std::size_t node) {
      for (int c = 0; c < experiment_.dimension; ++c)
        unbalanced[c] += unbalanced_[static_cast<std::size_t>(c) * nodes_ + node];
      if (status_[node] == MPM_APART) return;
      ++record.nodes;
      ++(status_[node] == MPM_STICKS ? record.sticking : record.slipping);
      record.largest_penetration = std::max(record.largest_penetration, -static_cast<double>(separation_[node]));
    });
  }

 private:
  std::size_t vectors() const { return static_cast<std::size_t>(experiment_.dimension) * nodes_; }
  template <class Visit>
  void for_each_active(Visit visit) const {
    for (std::size_t node = 0; node < nodes_; ++node)
      if (active_[node]) visit(node);
  }

  const Experiment& experiment_;
  PairGeometry geometry_;
  ContactPoints points_;
  std::size_t nodes_;
  DeviceArray<int> active_on_device_, status_on_device_;
  DeviceArray<T> normal_on_device_, separation_on_device_, area_on_device_, impulse_on_device_, unbalanced_on_device_,
      dissipated_on_device_;
  std::vector<int> active_, status_;
  std::vector<T> normal_, separation_, area_, impulse_, unbalanced_, dissipated_;
};

}  // namespace mpm::device

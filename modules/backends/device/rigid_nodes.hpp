#pragma once
// The nodes near rigid bodies, which the host finds once a step where a body moves, and hands to the device.

#include <limits>
#include <vector>

#include "backends/device/device_arrays.hpp"
#include "simulation/rigid_bodies.hpp"

namespace mpm::device {

template <class T>
class RigidNodes {
 public:
  RigidNodes(Device& device, const Experiment& experiment, const Arguments<T>& scene)
      : dimension_(static_cast<std::size_t>(experiment.dimension)), scene_(scene), bodies_(experiment) {
    for (const RigidBodySpecification& body : experiment.rigid_bodies) {
      lists_.emplace_back(device);
      lists_.back().parameters.upload(body.contact.parameters);
    }
  }

  RigidBodies& bodies() { return bodies_; }
  const RigidBodies& bodies() const { return bodies_; }
  /// Finds the nodes of a step. A copy is made wherever a body moves, also of no nodes: a step that needs the host is not
  /// collected in a graph.
  void begin_step() {
    bodies_.begin_step();
    for (std::size_t body = 0; body < lists_.size(); ++body)
      if (bodies_.has_moved(body)) upload(body);
  }
  /// What a phase is told of a body that moves as it does at a time, s.
  RigidArrays of(std::size_t body, double time) const {
    const RigidMotion motion = bodies_.motion(body, time);
    RigidArrays arrays{lists_[body].node.data(), lists_[body].values.data(), {}, {}, 0, 0};
    for (std::size_t c = 0; c < 3; ++c) arrays.velocity[c] = motion.velocity[c], arrays.spin[c] = motion.spin[c];
    arrays.mass = std::numeric_limits<double>::infinity();
    arrays.count = static_cast<long long>(bodies_.nodes(body).size());
    return arrays;
  }
  const double* parameters(std::size_t body) const { return lists_[body].parameters.data(); }

 private:
  struct List {
    DeviceArray<int> node;
    DeviceArray<double> values, parameters;
    explicit List(Device& device)
        : node(device, "rigid bodies"), values(device, "rigid bodies"), parameters(device, "rigid bodies") {}
  };
  int index_of(const std::array<int, 3>& node) const {
    int index = 0;
    for (std::size_t c = dimension_; c-- > 0;) index = index * scene_.extent[c] + node[c] + scene_.padding[c];
    return index;
  }
  void upload(std::size_t body) {
    const std::vector<RigidNode>& nodes = bodies_.nodes(body);
    const std::size_t n = nodes.size();
    std::vector<int> node(std::max<std::size_t>(n, 1));
    std::vector<double> values((2 + 2 * dimension_) * n);
    for (std::size_t k = 0; k < n; ++k) {
      node[k] = index_of(nodes[k].at);
      values[k] = nodes[k].surface.distance, values[n + k] = bodies_.around(nodes[k]);
      for (std::size_t c = 0; c < dimension_; ++c) {
        values[(2 + c) * n + k] = nodes[k].surface.normal[c];
        values[(2 + dimension_ + c) * n + k] = nodes[k].arm[c];
      }
    }
    lists_[body].node.upload(node), lists_[body].values.upload(values);
  }

  const std::size_t dimension_;
  const Arguments<T>& scene_;
  RigidBodies bodies_;
  std::vector<List> lists_;
};

}  // namespace mpm::device

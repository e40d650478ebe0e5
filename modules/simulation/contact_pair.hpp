#pragma once
// How two velocity fields meet at a node, by the scene's choice of normal and detection: by sums over nodes alone
// (operators/contact_geometry.hpp), or by the particles that the node sees (contact_points.hpp).

#include <algorithm>

#include "operators/contact_geometry.hpp"
#include "simulation/contact_detection.hpp"
#include "simulation/contact_points.hpp"

namespace mpm {

class PairGeometry {
 public:
  explicit PairGeometry(const Experiment& experiment) : experiment_(experiment), edges_(edge_models(experiment)) {}

  /// The geometry of fields a < b at a node. `points` holds the particles near it where the scene asks for them.
  ContactGeometry operator()(const ContactPoints& points, const std::array<int, 3>& node, int field_a, int field_b,
                             const ContactFieldNode& a, const ContactFieldNode& b) const {
    const double h = experiment_.grid.cell_size;
    const int D = experiment_.dimension;
    const EdgeTable edge_a = edges_[static_cast<std::size_t>(field_a)].table(),
                    edge_b = edges_[static_cast<std::size_t>(field_b)].table();
    const double around = experiment_.axisymmetric() ? around_axis(experiment_.grid.lower[0] + node[0] * h) : 1.0;
    if (!points.needed()) return contact_geometry(a, b, edge_a, edge_b, h, D, around);
    ContactGeometry result;
    const SeparatedPair pair = points.pair(node, field_a, field_b);
    if (!pair.found) return result;
    Vector3 normal = pair.normal;
    const bool by_gap = points.gives_normal() && pair.parted;
    if (!by_gap && !average_gradient(a, b, D, normal.data())) return result;
    std::copy(normal.begin(), normal.end(), result.normal);
    if (!points.gives_separation())
      result.separation = separation_of_edges(a, b, edge_a, edge_b, normal.data(), h, D);
    else
      result.separation = by_gap ? pair.separation : points.separation(node, field_a, field_b, normal);
    result.area = contact_area(a, b, result.normal, D, around);
    result.valid = true;
    return result;
  }

 private:
  const Experiment& experiment_;
  const std::vector<EdgeModel> edges_;
};

}  // namespace mpm

#pragma once
// The geometry of two velocity fields that meet at a node: shared normal, separation, area. All backends use it.
// Normal and separation follow from sums over nodes, or from the particles that the node sees (contact_points.hpp).

#include <algorithm>
#include <cmath>

#include "simulation/contact_detection.hpp"
#include "simulation/contact_points.hpp"

namespace mpm {

/// The values of the contact channels at one node for one field.
struct ContactFieldNode {
  double mass = 0;
  double volume = 0;               ///< sum w V
  double volume_gradient[3] = {};  ///< sum V grad w, derivative by the particle's position: points out of the body
  double mass_position[3] = {};    ///< sum w m (x_p - x_node), kg m
};

struct ContactGeometry {
  bool valid = false;     ///< both fields present and a normal exists
  double normal[3] = {};  ///< unit, from a to b
  double separation = 0;  ///< m, negative when the surfaces overlap
  double area = 0;        ///< m^2, m in 2-D
};

/// A pair whose lighter field holds less than this share of the mass is skipped (unless the law is a weld).
inline constexpr double contact_prescreen = 1e-5;

/// Whether a law is asked about two fields with these masses at a node.
template <class Scalar>
bool meet(Scalar mass_a, Scalar mass_b, bool weld) {
  if (!(mass_a > 0) || !(mass_b > 0)) return false;
  return weld || std::min(mass_a, mass_b) >= contact_prescreen * (static_cast<double>(mass_a) + mass_b);
}

/// How a pair of fields meets at a node, by the scene's choice of normal and detection.
class PairGeometry {
 public:
  explicit PairGeometry(const Experiment& experiment) : experiment_(experiment), edges_(edge_models(experiment)) {}

  /// The geometry of fields a < b at a node. `points` holds the particles near it where the scene asks for them.
  ContactGeometry operator()(const ContactPoints& points, const std::array<int, 3>& node, int field_a, int field_b,
                             const ContactFieldNode& a, const ContactFieldNode& b) const {
    ContactGeometry result;
    SeparatedPair pair;
    if (points.needed() && !(pair = points.pair(node, field_a, field_b)).found) return result;
    Vector3 normal = pair.normal;
    const bool by_gap = points.gives_normal() && pair.parted;
    if (!by_gap && !average_gradient(a, b, normal)) return result;
    std::copy(normal.begin(), normal.end(), result.normal);
    if (!points.gives_separation())
      result.separation = by_position(edges_[static_cast<std::size_t>(field_a)],
                                      edges_[static_cast<std::size_t>(field_b)], a, b, normal);
    else
      result.separation = by_gap ? pair.separation : points.separation(node, field_a, field_b, normal);
    const double h = experiment_.grid.cell_size;
    result.area = std::sqrt(2 * (a.volume + b.volume) * std::min(a.volume, b.volume)) / h;  // Nairn 2013, eq. 26
    result.valid = true;
    return result;
  }

 private:
  /// The shared average volume gradient (Nairn 2013, CMES 92:271); false where there is none.
  bool average_gradient(const ContactFieldNode& a, const ContactFieldNode& b, Vector3& normal) const {
    double norm = 0;
    for (int i = 0; i < experiment_.dimension; ++i) {
      normal[static_cast<std::size_t>(i)] = a.volume_gradient[i] - b.volume_gradient[i];
      norm += normal[static_cast<std::size_t>(i)] * normal[static_cast<std::size_t>(i)];
    }
    norm = std::sqrt(norm);
    if (!(norm > 0)) return false;
    for (double& component : normal) component /= norm;
    return true;
  }
  /// The separation by edge models that are inverted at the mean positions of mass.
  double by_position(const EdgeModel& edge_a, const EdgeModel& edge_b, const ContactFieldNode& a,
                     const ContactFieldNode& b, const Vector3& normal) const {
    const double h = experiment_.grid.cell_size;
    double position_a = 0, position_b = 0;
    for (int i = 0; i < experiment_.dimension; ++i) {
      position_a += a.mass_position[i] * normal[static_cast<std::size_t>(i)];
      position_b += b.mass_position[i] * normal[static_cast<std::size_t>(i)];
    }
    const double surface_a = edge_a.edge(position_a / (a.mass * h)),
                 surface_b = -edge_b.edge(-position_b / (b.mass * h));
    return (surface_b - surface_a) * h;
  }

  const Experiment& experiment_;
  const std::vector<EdgeModel> edges_;
};

}  // namespace mpm

#pragma once
// How two velocity fields meet at a node, by the scene's choice of normal and detection: by sums over nodes alone
// (operators/contact_geometry.hpp), or by the particles that the node sees (contact_points.hpp).

#include <array>
#include <span>
#include <vector>

#include "operators/contact_geometry.hpp"
#include "simulation/contact_detection.hpp"
#include "simulation/contact_points.hpp"

namespace mpm {

/// Two velocity fields that meet at a node, by its coordinates, and what is found of them.
struct MetPair {
  std::array<int, 3> node{};
  ContactFieldNode a, b;
  ContactGeometry geometry;
};

class PairGeometry {
 public:
  /// `entry` says which entries of normal and detection are called: those for lanes of double, or the plain ones.
  PairGeometry(const Experiment& experiment, mpm_precision entry)
      : experiment_(experiment), edges_(edge_models(experiment)), entry_(entry) {}

  /// Finds the geometry of fields a < b at some nodes, at most MPM_BATCH. `points` holds the particles near them where
  /// the scene asks for them.
  void find(const ContactPoints& points, int field_a, int field_b, std::span<MetPair> pairs) const;

 private:
  void find_normals(std::span<MetPair> pairs) const;
  void find_normal_by_points(const SeparatedPair& seen, MetPair& pair) const;
  void find_gaps(const ContactPoints& points, int field_a, int field_b, std::span<MetPair> pairs) const;
  DetectionPair<double> seen_along_normal(const ContactPoints& points, int field_a, int field_b,
                                          const MetPair& pair) const;
  double area_of(const MetPair& pair) const;

  const Experiment& experiment_;
  const std::vector<EdgeModel> edges_;  ///< of each velocity field, where somebody reads them
  const mpm_precision entry_;
};

}  // namespace mpm

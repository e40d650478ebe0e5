#pragma once
// The particles that a node sees of the bodies that meet there, and what follows from their places: the normal that two
// bodies share and the gap between their surfaces. Positions do not move within a step: all is found once a step, when
// the masses of the nodes are known, and holds for every stage of it.

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// What the particles near a node say of a pair of bodies.
struct SeparatedPair {
  bool found = false;   ///< both bodies have particles near the node
  bool parted = false;  ///< the scene's normal follows from them; else it cannot tell, as where they are mixed
  Vector3 normal{};     ///< unit, from a to b; where parted
  double surface_a = 0,
         surface_b = 0;  ///< ContactPoints::surfaces along it; where parted, and the detection reads them
};

/// How far the outermost particles of two bodies extend along a normal, cells from the node.
struct SurfacePlaces {
  double of_a, of_b;
};

/// One body's particles near a node as a normal looks at them (abi.h, mpm_normal_points).
struct PointRow {
  std::uint32_t count = 0, stride = 0;
  std::vector<double> positions, weights;  ///< [3][stride], cells from the node; [stride]

  /// Takes the particles with these numbers, at least one, from places in cells.
  void take(const std::vector<Vector3>& places, const std::vector<std::uint32_t>& numbers,
            const std::array<int, 3>& node, int dimension);
};
/// The call for the normal between two rows, which it writes to `normal`.
mpm_normal_points points_of(const PointRow& a, const PointRow& b, Vector3& normal);

class ContactPoints {
 public:
  explicit ContactPoints(const Experiment& experiment);

  /// Whether the scene's normal or its detection looks at particles.
  bool needed() const { return gives_normal_ || sees_surfaces_; }
  bool gives_normal() const { return gives_normal_; }
  bool sees_surfaces() const { return sees_surfaces_; }
  /// How far from a node its particles lie at most along an axis, cells; with lists that is beside their domains.
  double reach() const { return reach_; }

  /// Forgets the nodes and particles of the last step.
  void begin();
  /// Says that two bodies or more have mass at a node, by its coordinates.
  void open(const std::array<int, 3>& node);
  /// Looks for the nodes that may see a particle with low <= x <= high, in cells from the domain's corner: those that
  /// are added next must lie there. False where no node may.
  bool look_around(const Vector3& low, const Vector3& high);
  /// Adds a particle of a velocity field, with its images beyond walls and periodic faces: its place in cells from the
  /// domain's corner, and a matrix, row-major, whose columns times `factor` are the semi-sides of its domain in cells:
  /// the domain itself, or the deformation gradient with half the undeformed side. Null where nobody asks for it
  /// (needs_domain).
  template <class T>
  void add(int field, const Vector3& x, const T* matrix, std::size_t stride, double factor) {
    SemiSides semi_sides{};
    for (int i = 0; matrix && i < dimension_; ++i)
      for (int k = 0; k < dimension_; ++k)
        semi_sides[3 * i + k] = factor * static_cast<double>(matrix[(i * dimension_ + k) * stride]);
    add(field, x, semi_sides);
  }
  /// Half the side of an undeformed square or cube of this volume, m^D, in cells: the factor of a deformation gradient. In
  /// axisymmetric scenes it is that of a ring's section.
  double half_side(double volume) const;
  /// Finds the normals of all pairs at the nodes [first, end) of `node_count`, once all particles are there. Any thread
  /// may call it for nodes of its own.
  void find(std::size_t first, std::size_t end);
  std::size_t node_count() const { return count_; }

  /// What was found for a pair of fields; nothing at nodes that were not opened.
  SeparatedPair pair(const std::array<int, 3>& node, int a, int b) const;
  /// The surfaces of a pair's particles along a unit normal from a to b, at a node where both have particles.
  SurfacePlaces surfaces(const std::array<int, 3>& node, int a, int b, const Vector3& normal) const;

 private:
  struct Node {
    std::array<int, 3> at{};
    std::vector<std::vector<std::uint32_t>> particles;  ///< [field], numbers among all
    std::vector<SeparatedPair> pairs;                   ///< [pair_index]
  };
  /// The nodes around a place, each by its coordinates: what look_around has found.
  struct Window {
    std::array<int, 3> low{}, high{};
    bool near_periodic = false,
         near_mirror = false;  ///< whether an image beyond such a face may be seen of what lies there
    std::vector<std::vector<std::uint32_t>*>
        particles;  ///< Node::particles of each; empty where there is no node at all

    std::size_t side(int axis) const { return static_cast<std::size_t>(high[axis]) - low[axis] + 1; }
    bool holds(const std::array<int, 3>& at) const {
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (at[axis] < low[axis] || at[axis] > high[axis]) return false;
      return true;
    }
    std::size_t place(const std::array<int, 3>& at) const {
      const auto from = [&](int axis) { return static_cast<std::size_t>(at[axis] - low[axis]); };
      return (from(0) * side(1) + from(1)) * side(2) + from(2);
    }
  };
  using SemiSides = std::array<double, 9>;  ///< cells, row-major, columns are vectors

  void add(int field, const Vector3& x, const SemiSides& semi_sides);
  void add_images(int field, const Vector3& x, const SemiSides& semi_sides, bool with_itself);
  void keep(const Vector3& x, const SemiSides& semi_sides);
  void add_image(int field, const Vector3& x, const SemiSides& semi_sides);
  double reach_of(const SemiSides& semi_sides, int axis) const;
  double extent(std::uint32_t particle, const Vector3& normal) const;
  SeparatedPair separate(const Node& node, int a, int b) const;
  SurfacePlaces surfaces(const Node& node, int a, int b, const Vector3& normal) const;
  double farthest_seen() const;
  bool near_face(int axis, double low, double high, bool periodic) const;

  const Experiment& experiment_;
  const int dimension_, fields_;
  bool gives_normal_, sees_surfaces_;
  bool by_domain_;                                          ///< how far a particle is seen depends on its domain
  double reach_;                                            ///< cells, of its weights
  std::unordered_map<std::uint64_t, std::uint32_t> found_;  ///< numbers of the nodes that were opened
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cubes_;  ///< the nodes in cubes of cells
  Window window_;
  std::vector<Node> nodes_;  ///< the first count_ are this step's
  std::size_t count_ = 0;
  std::vector<Vector3> places_;  ///< cells
  std::vector<SemiSides> semi_sides_;
};

}  // namespace mpm

#pragma once
// The geometry of two velocity fields that meet at a node: shared normal, separation, area. All backends use it.

#include "kernel/functor.hpp"
#include "kernel/tensor.hpp"

namespace mpm {

/// A monotone table by which the mean position of a body's particles near a node tells where its edge is, both in cells
/// (simulation/contact_detection.hpp).
struct EdgeTable {
  const double *edges, *means;
  int count;

  /// The edge that gives this mean. Means outside the table give its ends.
  MPM_HD double edge(double mean) const {
    if (mean <= means[0]) return edges[0];
    if (mean >= means[count - 1]) return edges[count - 1];
    int lower = 0, upper = count - 1;  // means[lower] <= mean < means[upper]
    while (upper - lower > 1) {
      const int middle = (lower + upper) / 2;
      (means[middle] > mean ? upper : lower) = middle;
    }
    const double share = (mean - means[lower]) / (means[upper] - means[lower]);
    return edges[lower] + share * (edges[upper] - edges[lower]);
  }
};

/// The values of the contact channels at one node for one field.
struct ContactFieldNode {
  double mass = 0;
  double volume_gradient[3] = {};    ///< sum V grad w, derivative by the particle's position: points out of the body
  double mass_gradient[3] = {};      ///< sum m grad w, where the normal reads it
  double mass_position[3] = {};      ///< sum w m (x_p - x_node), kg m, where the detection reads it
  double mass_displacement[3] = {};  ///< sum w m (u_p + (grad u) d), kg m, where the law reads it
};

struct ContactGeometry {
  bool valid = false;     ///< both fields present and a normal exists
  double normal[3] = {};  ///< unit, from a to b
  double own_a[3] = {};   ///< those of each body alone, unit, from a to b, where the normal has MPM_OWN_NORMALS
  double own_b[3] = {};
  double separation = 0;  ///< m, negative when the surfaces overlap
  double area = 0;        ///< m^2, m in 2-D
};

/// A pair whose lighter field holds less than this share of the mass is skipped (unless the law is a weld).
inline constexpr double contact_prescreen = 1e-5;

/// Whether a law is asked about two fields with these masses at a node.
template <class Scalar>
MPM_HD bool meet(Scalar mass_a, Scalar mass_b, bool weld) {
  if (!(mass_a > 0) || !(mass_b > 0)) return false;
  return weld || min(mass_a, mass_b) >= contact_prescreen * (static_cast<double>(mass_a) + mass_b);
}

/// The gradient of the displacement by the present place, I - F^-1. With it a particle says how far material at the node
/// has moved, u_p + (I - F^-1)(x_node - x_p): bodies that turn together have then not moved beside one another, although
/// the particles that a node sees of each lie at some distance from their common surface.
template <class S>
MPM_HD Mat<2, S> displacement_gradient(const Mat<2, S>& F) {
  const scalar_of<S> one = 1;
  const S scale = one / determinant(F);
  return {{one - scale * F(1, 1), scale * F(0, 1), scale * F(1, 0), one - scale * F(0, 0)}};
}
template <class S>
MPM_HD Mat<3, S> displacement_gradient(const Mat<3, S>& F) {
  const scalar_of<S> one = 1;
  const S scale = one / determinant(F);
  Mat<3, S> gradient = Mat<3, S>::identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
      gradient(i, j) = gradient(i, j) - scale * (F(a, c) * F(b, d) - F(a, d) * F(b, c));
    }
  return gradient;
}

/// How far field b has moved since the start beside a, along one axis, m (MPM_COMPLIANT).
MPM_HD double displacement_of_pair(const ContactFieldNode& a, const ContactFieldNode& b, int axis) {
  return b.mass_displacement[axis] / b.mass - a.mass_displacement[axis] / a.mass;
}

/// Finds the normal of averaged volume gradients (Nairn 2013, CMES 92:271), as modules/normals/average_volume_gradient
/// does, where particles tell none; false where there is none.
MPM_HD bool average_gradient(const ContactFieldNode& a, const ContactFieldNode& b, int dimension, double* normal) {
  double norm = 0;
  for (int i = 0; i < dimension; ++i) {
    normal[i] = a.volume_gradient[i] - b.volume_gradient[i];
    norm += normal[i] * normal[i];
  }
  norm = sqrt(norm);
  if (!(norm > 0)) return false;
  for (int i = 0; i < dimension; ++i) normal[i] /= norm;
  return true;
}

/// The mean position of what a node sees of a body, along a normal, in cells from the node.
MPM_HD double mean_position(const ContactFieldNode& body, const double* normal, double cell_size, int dimension) {
  double position = 0;
  for (int i = 0; i < dimension; ++i) position += body.mass_position[i] * normal[i];
  return position / (body.mass * cell_size);
}

/// Fills what a detection reads of mean positions.
MPM_HD void see_means(DetectionPair<double>& seen, const ContactFieldNode& a, const ContactFieldNode& b,
                      const double* normal, double cell_size, int dimension) {
  seen.mean_a = mean_position(a, normal, cell_size, dimension);
  seen.mean_b = mean_position(b, normal, cell_size, dimension);
}

/// Fills what a detection reads of edges, from tables that are inverted at the means.
MPM_HD void see_edges(DetectionPair<double>& seen, const EdgeTable& edge_a, const EdgeTable& edge_b) {
  seen.edge_a = edge_a.edge(seen.mean_a), seen.edge_b = -edge_b.edge(-seen.mean_b);
}

/// The node's share of the area in which two fields touch, m^2 (m in 2-D): by the divergence theorem a body's sum V grad w
/// is the integral of w n over its surface, so that the shares of all nodes add up to the area; where one body ends sooner
/// its share counts. `around` is the length of the node's ring in axisymmetric scenes, m, else 1. The area by volumes
/// (Nairn 2013, eq. 26) adds up to 0.7 to 1.6 times as much, by where the face lies (tests/unit/contact_area.cpp).
MPM_HD double contact_area(const ContactFieldNode& a, const ContactFieldNode& b, const double* normal, int dimension,
                           double around) {
  double of_a = 0, of_b = 0;
  for (int i = 0; i < dimension; ++i)
    of_a += a.volume_gradient[i] * normal[i], of_b -= b.volume_gradient[i] * normal[i];
  return max(0.0, min(of_a, of_b)) * around;
}

/// The length of the ring of a node at this radius, m, in axisymmetric scenes.
MPM_HD double around_axis(double radius) {
  return 6.283185307179586 * max(radius, 0.0);
}

}  // namespace mpm

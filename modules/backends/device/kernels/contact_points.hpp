#pragma once
// Where a contact normal or detection looks at particles, each node at which two fields meet looks for those of both, and
// finds from their places the pair's normal and how far the surfaces are apart. Positions do not move within a step: all of
// it is found once a step, before the forces, and the phase `contact` reads it in every stage. Who is seen says
// operators/contact_points.hpp, for all backends.

#include "backends/device/kernels/contact.hpp"
#include "kernel/points.hpp"
#include "operators/contact_points.hpp"
#include "operators/edges.hpp"

namespace mpm::device {

/// A node looks into blocks farther than it sees, as they were found in the scene's precision, cells.
inline constexpr double block_margin = 1.0 / 16;

/// How particles are seen along an axis, as they are or as images beyond a face, and in which blocks of the axis they lie.
struct SeenAlong {
  bool image;
  double sign, shift, face;  ///< who is at x is seen at sign x + shift; an image is one beyond this face, cells
  int first, last;
};

/// A particle of a body, or an image of it, as a node sees it.
template <class T>
struct SeenParticle {
  Vec<3, double> place;  ///< cells from the node; z is 0 in the plane
  const SeenBody<T>* body;
  int index;
  const SeenAlong* along;  ///< [axis]
};

template <class Scene, class T = typename Scene::Scalar>
MPM_HD void find_coordinates(const Arguments<T>& a, int node, int* at) {
  for (int c = 0; c < Scene::dimension; node /= a.extent[c], ++c) at[c] = node % a.extent[c] - a.padding[c];
}

/// Where the particles lie that a node may see as they are (`face` 0), or as images beyond the lower or the upper face of
/// an axis (1, 2); false where there are none.
template <class T>
MPM_HD bool look_along(const Arguments<T>& a, const BlockArrays& blocks, int axis, int face, int node, double reach,
                       SeenAlong& seen) {
  double low = node - reach, high = node + reach;
  seen = {face > 0, 1, 0, 0, 0, 0};
  if (face > 0) {
    const int wall = a.walls[axis][face - 1], cells = a.cells[axis];
    if (!has_images(wall)) return false;
    seen.face = face == 1 ? 0 : cells;
    if (wall == wall_periodic) {
      seen.shift = face == 1 ? cells : -cells;
      low -= seen.shift, high -= seen.shift;
    } else {
      seen.sign = -1, seen.shift = 2 * seen.face;
      low = seen.shift - node - reach, high = seen.shift - node + reach;
    }
    low = max(low, seen.face - reach), high = min(high, seen.face + reach);
    if (!(low < high)) return false;
  }
  // Whatever lies beyond the table is in a block at its edge.
  const auto block_at = [&](double x) {
    const int block = static_cast<int>(floor(x / block_cells)) - blocks.lower[axis], end = blocks.extent[axis] - 1;
    return block < 0 ? 0 : block > end ? end : block;
  };
  seen.first = block_at(low - block_margin), seen.last = block_at(high + block_margin);
  return true;
}

/// What makes semi-sides in cells of a particle's matrix (SeenBody::sides).
template <class Scene, class T = typename Scene::Scalar>
MPM_HD double unit_of_sides(const SeenBody<T>& body, int p) {
  if (!body.size) return body.half_side;
  const double size = body.size[p];
  return body.half_side * (Scene::dimension == 2 ? sqrt(size) : exp(log(size) / 3));
}

/// How far from a node a particle may lie along an axis to be seen, cells: a list's weights reach beyond its domain.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD double reach_of(const Arguments<T>& a, const SeenBody<T>& body, int p, int axis) {
  constexpr int D = Scene::dimension;
  double reach = a.seen.reach;
  if constexpr (Scene::list)
    for (int k = 0; body.sides && k < D; ++k)
      reach += abs(unit_of_sides<Scene>(body, p) * body.sides[(axis * D + k) * body.stride + p]);
  return max(reach, least_reach);
}

/// Calls visit(SeenParticle) if a node sees this particle so.
template <class Scene, class T, class Visit>
MPM_HD void look_at(const Arguments<T>& a, const SeenBody<T>& body, int p, const SeenAlong* along, const int* node,
                    Visit& visit) {
  SeenParticle<T> seen{{}, &body, p, along};
  for (int c = 0; c < Scene::dimension; ++c) {
    const double x = (double(body.position[c * body.stride + p]) - a.seen.lower[c]) / a.seen.cell_size,
                 reach = reach_of<Scene>(a, body, p, c);
    if (along[c].image && abs(x - along[c].face) >= reach) return;
    const double place = along[c].sign * x + along[c].shift;
    if (node[c] < first_that_sees(place, reach) || node[c] > last_that_sees(place, reach)) return;
    seen.place[c] = place - node[c];
  }
  visit(seen);
}

template <class Scene, class T, class Visit>
MPM_HD void look_into_blocks(const Arguments<T>& a, const SeenBody<T>& body, const SeenAlong* along, const int* node,
                             Visit& visit) {
  constexpr int D = Scene::dimension;
  int side[D], count = 1;
  for (int c = 0; c < D; ++c) side[c] = along[c].last - along[c].first + 1, count *= side[c];
  for (int k = 0; k < count; ++k) {
    int block = 0;
    for (int c = 0, rest = k, stride = 1; c < D; rest /= side[c], stride *= body.blocks.extent[c], ++c)
      block += (along[c].first + rest % side[c]) * stride;
    const int end = body.blocks.next[block];  // the sort has counted up to it
    for (int i = end - body.blocks.count[block]; i < end; ++i)
      look_at<Scene>(a, body, body.blocks.order[i], along, node, visit);
  }
}

/// Calls visit(SeenParticle) for all particles of a field of the pair, 0 or 1, that a node sees, and their images beyond
/// walls and periodic faces. Their order follows from positions and indices alone.
template <class Scene, class T, class Visit>
MPM_HD void for_each_seen(const Arguments<T>& a, int field, const int* node, Visit visit) {
  constexpr int D = Scene::dimension, images = D == 2 ? 9 : 27;
  for (int k = 0; k < a.seen.count[field]; ++k) {
    const SeenBody<T>& body = a.seen.bodies[field][k];
    const double farthest = Scene::list ? -double(*body.nearest) : a.seen.reach;
    for (int image = 0; image < images; ++image) {
      SeenAlong along[D];
      bool any = true;
      for (int c = 0, face = image; c < D; face /= 3, ++c)
        any = any && look_along(a, body.blocks, c, face % 3, node[c], farthest, along[c]);
      if (any) look_into_blocks<Scene>(a, body, along, node, visit);
    }
  }
}

/// Finds how far the lists of a body reach, in whole cells, the first body of `seen`.
template <class Scene>
MPM_HD void find_reach(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  const auto& body = *a.seen.bodies[0];
  for_each_index(team, a.particles.count, [&](int p) {
    double reach = least_reach;
    for (int c = 0; c < Scene::dimension; ++c) reach = max(reach, reach_of<Scene>(a, body, p, c));
    const int cells = static_cast<int>(floor(-min(reach, 1e6)));
    if (cells < Team::look(body.nearest)) Team::lower(body.nearest, cells);
  });
}

/// Writes down the nodes at which `grid` and `other` meet, in any order: what one finds does not depend on the others.
template <class Scene>
MPM_HD void find_meeting_nodes(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  constexpr int D = Scene::dimension, mass = Scene::Node::mass;
  for_each_node(team, a, [&](int node) {
    a.seen.valid[node] = 0;
    if (!meet(a.grid.field[mass][node], a.other.field[mass][node], /*weld=*/false)) return;
    int at[D];
    find_coordinates<Scene>(a, node, at);
    for (int c = 0; c < D; ++c) {
      const int beyond = at[c] < 0 ? 0 : at[c] > a.cells[c] ? 1 : -1;
      if (beyond >= 0 && has_images(a.walls[c][beyond])) return;  // its image is what counts
    }
    a.seen.meeting[Team::take_number(a.seen.meeting_count)] = node;
  });
}

/// The particles of one field that a node sees. The first look keeps their places in the lane's row, from `begin` on;
/// where there is no room for all, each later one finds them anew.
template <class Scene>
class NodeCloud {
  using T = typename Scene::Scalar;
  static constexpr int D = Scene::dimension;

 public:
  MPM_HD NodeCloud(const Arguments<T>& a, int field, const int* node, int lane, int begin)
      : a_(a), field_(field), node_(node), row_(a.seen.rows + lane), begin_(begin), count_(0) {
    for_each_seen<Scene>(a, field, node, [&](const SeenParticle<T>& seen) {
      if (end() < a_.seen.row_length)
        for (int c = 0; c < D; ++c) row_[index(count_, c)] = seen.place[c];
      ++count_;
    });
  }
  MPM_HD int count() const { return count_; }
  /// The place in the row behind the last one.
  MPM_HD int end() const { return begin_ + count_; }

  template <class Visit>
  MPM_HD void for_each(Visit visit) const {
    for_each_place([&](const Vec<3, double>& place) {
      double weight = 1;
      for (int c = 0; c < D; ++c) weight *= quadratic_weight(place[c]);
      visit(place, weight);
    });
  }
  template <int N, class Term>
  MPM_HD void add(Term term, double (&sums)[N]) const {
    for_each([&](const Vec<3, double>& place, double weight) {
      double values[N];
      term(place, weight, values);
      for (int n = 0; n < N; ++n) sums[n] += values[n];
    });
  }
  MPM_HD Vec<3, double> middle() const {
    Vec<3, double> sum{};
    for_each_place([&](const Vec<3, double>& place) {
      for (int c = 0; c < D; ++c) sum[c] += place[c];
    });
    for (int c = 0; c < D; ++c) sum[c] /= count_;
    return sum;
  }
  MPM_HD Vec<3, double> farthest(const Vec<3, double>& along) const {
    Vec<3, double> best{};
    double most = 0;
    bool any = false;
    for_each_place([&](const Vec<3, double>& place) {
      const double at = along[0] * place[0] + along[1] * place[1] + along[2] * place[2];
      if (any && !(at > most)) return;
      best = place, most = at, any = true;
    });
    return best;
  }

 private:
  MPM_HD long long index(int number, int component) const {
    return ((begin_ + number) * static_cast<long long>(D) + component) * a_.seen.lanes;
  }
  template <class Visit>
  MPM_HD void for_each_place(Visit visit) const {
    if (end() > a_.seen.row_length)
      return for_each_seen<Scene>(a_, field_, node_, [&](const SeenParticle<T>& seen) { visit(seen.place); });
    for (int k = 0; k < count_; ++k) {
      Vec<3, double> place{};
      for (int c = 0; c < D; ++c) place[c] = row_[index(k, c)];
      visit(place);
    }
  }

  const Arguments<T>& a_;
  int field_;
  const int* node_;
  double* row_;
  int begin_, count_;
};

/// Finds how far the outermost particles of a field extend along a normal, cells from the node: the way of the first
/// field's, against it of the second's. False where the node sees none.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD bool find_surface(const Arguments<T>& a, int field, const int* node, const double* normal, double& surface) {
  constexpr int D = Scene::dimension;
  bool any = false;
  for_each_seen<Scene>(a, field, node, [&](const SeenParticle<T>& seen) {
    const SeenBody<T>& body = *seen.body;
    const double unit = unit_of_sides<Scene>(body, seen.index);
    double semi_sides[9] = {}, along = 0;
    for (int i = 0; i < D; ++i) {
      along += seen.place[i] * normal[i];
      for (int k = 0; k < D; ++k)
        semi_sides[3 * i + k] = seen.along[i].sign * unit * body.sides[(i * D + k) * body.stride + seen.index];
    }
    const double extent = extent_along(semi_sides, normal, D), at = field == 0 ? along + extent : along - extent;
    if (!any || (field == 0 ? at > surface : at < surface)) surface = at;
    any = true;
  });
  return any;
}

/// Finds the normal of a pair by the particles that the node sees, or where these tell none by averaged gradients; false
/// where there is none, or it does not see both fields.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD bool find_normal_by_points(const Arguments<T>& a, const int* node, const ContactFieldNode& of_a,
                                  const ContactFieldNode& of_b, int lane, ContactGeometry& found) {
  using Normal = typename Scene::Normal;
  constexpr int D = Scene::dimension;
  const NodeCloud<Scene> first(a, 0, node, lane, 0);
  if (first.count() == 0) return false;
  const NodeCloud<Scene> second(a, 1, node, lane, first.end());
  if (second.count() == 0) return false;
  const PointsOfPair<const NodeCloud<Scene>&> points{first, second};
  return Normal::template find<D>(parameters_of<Normal>(a.normal_parameters), points, found.normal) ||
         average_gradient(of_a, of_b, D, found.normal);
}

/// Finds how the fields meet at a node.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD ContactGeometry geometry_by_particles(const Arguments<T>& a, int index, int lane) {
  int node[Scene::dimension];
  find_coordinates<Scene>(a, index, node);
  const ContactFieldNode of_a = contact_field<Scene>(a, a.grid, index), of_b = contact_field<Scene>(a, a.other, index);
  ContactGeometry found;
  if constexpr (Scene::normal_by_particles)
    found.valid = find_normal_by_points<Scene>(a, node, of_a, of_b, lane, found);
  else
    found.valid = find_normal<Scene>(a, of_a, of_b, found);
  DetectionPair<double> seen{};
  if constexpr (Scene::reads_surfaces)
    found.valid = found.valid && find_surface<Scene>(a, 0, node, found.normal, seen.surface_a) &&
                  find_surface<Scene>(a, 1, node, found.normal, seen.surface_b);
  if (found.valid) find_gap<Scene>(a, index, of_a, of_b, seen, found);
  return found;
}

/// Lets the nodes that were written down look. A fixed number of lanes, each with a row of its own, takes them in turn.
template <class Scene>
MPM_HD void look_at_particles(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  team.for_each_lane([&](int lane_of_team) {
    const int lane = team.block() * team.lanes() + lane_of_team, nodes = a.node_count;
    for (int k = lane; k < *a.seen.meeting_count; k += a.seen.lanes) {
      const int node = a.seen.meeting[k];
      const ContactGeometry found = geometry_by_particles<Scene>(a, node, lane);
      if (!found.valid) continue;
      a.seen.valid[node] = 1;
      a.seen.values[node] = static_cast<T>(found.separation), a.seen.values[nodes + node] = static_cast<T>(found.area);
      for (int c = 0; c < Scene::dimension; ++c)
        a.seen.values[(2 + c) * nodes + node] = static_cast<T>(found.normal[c]);
    }
  });
}

}  // namespace mpm::device

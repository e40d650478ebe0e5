#pragma once
// Two velocity fields meet at a node through the contact functor.

#include "backends/device/kernels/conditions.hpp"
#include "backends/device/kernels/gather.hpp"
#include "backends/device/kernels/sums.hpp"
#include "operators/contact.hpp"
#include "operators/contact_geometry.hpp"

namespace mpm::device {

/// What contact does to a pair, summed over its nodes.
enum : int {
  contact_impulse = 0,     ///< 3, on the first field, kg m/s
  contact_unbalanced = 3,  ///< 3, change of the pair's momentum, kg m/s: zero to rounding
  contact_along = 6,       ///< 3, the parts of the impulse along the nodes' normals, kg m/s
  contact_pressing = 9,    ///< sum of their sizes, positive where they push the fields apart, kg m/s
  contact_dissipated,      ///< J
  contact_stored,          ///< J, taken up by springs
  contact_sticking,        ///< nodes
  contact_slipping,
  contact_touching,     ///< area where they touch, m^2
  contact_penetration,  ///< the largest one, m
  contact_gap,          ///< the largest one that was open where the law acted, m
  contact_sums
};
constexpr int contact_maxima = 2;  ///< of these sums, the last ones are not added up: the largest of all nodes counts

/// What contact looks at of one velocity field at a node.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD ContactFieldNode contact_field(const Arguments<T>& a, const NodeArrays<T>& grid, int node) {
  using N = typename Scene::Node;
  ContactFieldNode found{};
  found.mass = grid.field[N::mass][node];
  for (int c = 0; c < Scene::dimension; ++c) {
    const int at = c * a.node_count + node;
    found.volume_gradient[c] = grid.field[N::volume_gradient][at];
    if constexpr (N::mass_gradient >= 0) found.mass_gradient[c] = grid.field[N::mass_gradient][at];
    if constexpr (N::mass_position >= 0) found.mass_position[c] = grid.field[N::mass_position][at];
    if constexpr (N::mass_displacement >= 0) found.mass_displacement[c] = grid.field[N::mass_displacement][at];
  }
  return found;
}

/// The length of a node's ring in axisymmetric scenes, m, else 1.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD double around_node(const Arguments<T>& a, int node) {
  if constexpr (!Scene::axisymmetric) return 1;
  const int column = node % a.extent[0] - a.padding[0];
  return around_axis(double(a.lower[0]) + column * double(a.cell_size));
}

/// Finds the normal of a pair by sums over its node; false where there is none.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD bool find_normal(const Arguments<T>& a, const ContactFieldNode& of_a, const ContactFieldNode& of_b,
                        ContactGeometry& found) {
  using Normal = typename Scene::Normal;
  constexpr int D = Scene::dimension;
  NormalPair<D, double> pair;
  NormalResult<D, double> result{};
  for (int c = 0; c < D; ++c) {
    pair.mass_gradient_a[c] = of_a.mass_gradient[c], pair.mass_gradient_b[c] = of_b.mass_gradient[c];
    pair.volume_gradient_a[c] = of_a.volume_gradient[c], pair.volume_gradient_b[c] = of_b.volume_gradient[c];
  }
  Normal::find(parameters_of<Normal>(a.normal_parameters), pair, result);
  if (!(result.found > 0)) return false;
  for (int c = 0; c < D; ++c) {
    found.normal[c] = result.normal[c];
    if constexpr (Scene::own_normals) found.own_a[c] = result.own_a[c], found.own_b[c] = result.own_b[c];
  }
  return true;
}

/// Finds gap and area of a pair along its normal; `seen` has the surfaces of particles, where the detection reads these.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void find_gap(const Arguments<T>& a, int node, const ContactFieldNode& of_a, const ContactFieldNode& of_b,
                     [[maybe_unused]] DetectionPair<double> seen, ContactGeometry& found) {
  constexpr int D = Scene::dimension;
  if constexpr (!Scene::bypasses_detection) {
    using Detection = typename Scene::Detection;
    const double h = a.cell_size;
    if constexpr (Scene::reads_means || Scene::reads_edges) see_means(seen, of_a, of_b, found.normal, h, D);
    if constexpr (Scene::reads_edges) see_edges(seen, a.edges[0], a.edges[1]);
    if constexpr (!Scene::reads_means) seen.mean_a = seen.mean_b = 0;
    found.separation = h * Detection::gap(parameters_of<Detection>(a.detection_parameters), seen);
  }
  found.area = contact_area(of_a, of_b, found.normal, D, around_node<Scene>(a, node));
}

/// How two fields meet at a node: as follows from sums over nodes, or as the phase before has found by looking at particles.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD ContactGeometry geometry_of_pair(const Arguments<T>& a, int node) {
  ContactGeometry found;
  if constexpr (Scene::contact_by_particles) {
    found.valid = a.seen.valid[node] != 0;
    found.separation = a.seen.values[node], found.area = a.seen.values[a.node_count + node];
    for (int c = 0; c < Scene::dimension; ++c) found.normal[c] = a.seen.values[(2 + c) * a.node_count + node];
  } else {
    const ContactFieldNode of_a = contact_field<Scene>(a, a.grid, node), of_b = contact_field<Scene>(a, a.other, node);
    found.valid = find_normal<Scene>(a, of_a, of_b, found);
    if (found.valid) find_gap<Scene>(a, node, of_a, of_b, {}, found);
  }
  return found;
}

/// Takes the share of a law's impulse that strains no cell by more than the cap.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void cap(const Arguments<T>& a, const ContactPair<Scene::dimension, T>& pair,
                ContactResult<Scene::dimension, T>& result) {
  T square = T(0), across = T(0), sliding = T(0), approach = T(0);
  for (int c = 0; c < Scene::dimension; ++c) {
    const T velocity = pair.momentum_a[c] / pair.mass_a - pair.momentum_b[c] / pair.mass_b;
    square += result.impulse[c] * result.impulse[c], across += result.impulse[c] * pair.normal[c];
    sliding += result.impulse[c] * velocity, approach += pair.normal[c] * velocity;
  }
  const T share = share_under_cap(square, pair.mass_a, pair.mass_b, a.strain_cap * a.cell_size / a.dt);
  if (!(share < T(1))) return;
  for (int c = 0; c < Scene::dimension; ++c) result.impulse[c] *= share;
  result.dissipated = dissipated_by_share(result.dissipated, share, sliding - across * approach,
                                          square - across * across, pair.mass_a, pair.mass_b);
}

/// Asks the law, twice where each body has a normal of its own: what b takes is then that of its normal, and heat is the
/// mean of both. Returns the impulse that b takes with the other sign.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD Vec<Scene::dimension, T> ask_law(const Arguments<T>& a, const ContactGeometry& geometry,
                                        ContactPair<Scene::dimension, T>& pair,
                                        ContactResult<Scene::dimension, T>& result) {
  using Law = typename Scene::Contact;
  constexpr int D = Scene::dimension;
  const auto apply = [&](const double* normal, ContactResult<D, T>& said) {
    for (int c = 0; c < D; ++c) pair.normal[c] = geometry.valid ? static_cast<T>(normal[c]) : T(0);
    Law::apply(parameters_of<Law>(a.contact_parameters), pair, said);
  };
  if constexpr (Scene::own_normals) {
    ContactResult<D, T> of_b;
    apply(geometry.own_a, result);
    apply(geometry.own_b, of_b);
    result.dissipated = T(0.5) * (result.dissipated + of_b.dissipated);
    result.status = max(result.status, of_b.status);
    for (int k = 0; k < Scene::contact_states; ++k) result.reached[k] = max(result.reached[k], of_b.reached[k]);
    if constexpr (Scene::Node::mass_displacement >= 0) result.stored = T(0.5) * (result.stored + of_b.stored);
    return of_b.impulse;
  } else {
    apply(geometry.normal, result);
    if (a.strain_cap > T(0)) cap<Scene>(a, pair, result);
    return result.impulse;
  }
}

/// Whether grips hold all components of a node of `grid`, whose own they are, beside `other`.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD bool held_by_grips(const Arguments<T>& a, const GripArrays<T>* grips, const NodeArrays<T>& grid,
                          const NodeArrays<T>& other, int node) {
  int held = 0;
  const T mass =
      held_mass(grid.field[Scene::Node::mass][node], other.field[Scene::Node::mass][node], Scene::bypasses_detection);
  for (int k = 0; k < a.grip_count; ++k)
    if (grip_holds(grips[k].mass[node], mass)) held |= grips[k].given;
  return held == (1 << Scene::dimension) - 1;
}

/// Which body of a pair grips hold as a whole at a node: 0 the first, 1 the second, -1 none, or both.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD int held_body(const Arguments<T>& a, int node) {
  if constexpr (!Scene::grips) return -1;
  const bool holds_a = held_by_grips<Scene>(a, a.grips, a.grid, a.other, node),
             holds_b = held_by_grips<Scene>(a, a.other_grips, a.other, a.grid, node);
  return holds_a == holds_b ? -1 : holds_a ? 0 : 1;
}

/// Writes what a weld would give the pair of `grid` and `other` at each node, zero where they do not meet.
template <class Scene>
MPM_HD void measure_welds(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.node_count, [&](int node) {
    const int nodes = a.node_count;
    for (int c = 0; c <= D; ++c) a.welds[c * nodes + node] = 0;
    const auto mass_a = a.grid.field[N::mass][node], mass_b = a.other.field[N::mass][node];
    if (!meet(mass_a, mass_b, Scene::bypasses_detection)) return;
    const ContactGeometry geometry = geometry_of_pair<Scene>(a, node);
    if (!geometry.valid) return;
    const int held = held_body<Scene>(a, node);
    for (int c = 0; c < D; ++c) {
      const auto velocity_a = a.grid.field[N::velocity][c * nodes + node],
                 velocity_b = a.other.field[N::velocity][c * nodes + node];
      a.welds[c * nodes + node] =
          held < 0 ? welding_impulse(velocity_a, velocity_b, mass_a, mass_b)
                   : double(momentum_beside(velocity_b, velocity_a, mass_beside_held(held == 0, mass_a, mass_b)));
    }
    a.welds[D * nodes + node] = geometry.area;
  });
}

/// The sum of these over the nodes up to traction_reach away along each axis.
template <class Scene>
MPM_HD WeldOfPair welds_around(const Arguments<typename Scene::Scalar>& a, int node) {
  constexpr int D = Scene::dimension;
  int at[3] = {0, 0, 0}, reach[3] = {0, 0, 0}, stride[3] = {0, 0, 0};
  for (int c = 0, rest = node, step = 1; c < D; rest /= a.extent[c], step *= a.extent[c], ++c)
    at[c] = rest % a.extent[c], reach[c] = traction_reach, stride[c] = step;
  WeldOfPair sum;
  for (int k = -reach[2]; k <= reach[2]; ++k)
    for (int j = -reach[1]; j <= reach[1]; ++j)
      for (int i = -reach[0]; i <= reach[0]; ++i) {
        const int away[3] = {i, j, k};
        int other = node;
        bool exists = true;
        for (int c = 0; c < D; ++c) {
          exists = exists && at[c] + away[c] >= 0 && at[c] + away[c] < a.extent[c];
          other += away[c] * stride[c];
        }
        if (!exists) continue;
        WeldOfPair weld;
        for (int c = 0; c < D; ++c) weld.impulse[c] = a.welds[c * a.node_count + other];
        weld.area = a.welds[D * a.node_count + other];
        sum.add(weld);
      }
  return sum;
}

/// Writes down what the law did at a node.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void note_node(const Arguments<T>& a, int node, const ContactGeometry& geometry,
                      const ContactPair<Scene::dimension, T>& pair, const ContactResult<Scene::dimension, T>& result) {
  constexpr int D = Scene::dimension;
  const NotedContact<T>& noted = a.noted;
  noted.met[node] = static_cast<int>(result.status);
  noted.values[node] = pair.separation, noted.values[a.node_count + node] = pair.area;
  for (int c = 0; c < D; ++c) {
    noted.values[(2 + c) * a.node_count + node] = geometry.valid ? static_cast<T>(geometry.normal[c]) : T(0);
    noted.values[(2 + D + c) * a.node_count + node] = result.impulse[c];
  }
}

/// Tells the law what the particles of both bodies keep, and what they have gained, as means by mass.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void tell_state(const Arguments<T>& a, int node, ContactPair<Scene::dimension, T>& pair) {
  using N = typename Scene::Node;
  pair.first_step = a.first_step;
  if constexpr (Scene::contact_states > 0)
    for (int k = 0; k < Scene::contact_states; ++k) {
      const int at = k * a.node_count + node;
      const T mass_a = a.grid.field[N::mass][node], mass_b = a.other.field[N::mass][node];  // a law may see others
      pair.state_a[k] = a.grid.field[N::mass_state][at] / mass_a;
      pair.state_b[k] = a.other.field[N::mass_state][at] / mass_b;
      pair.gained_a[k] = a.grid.field[N::mass_gain][at] / mass_a;
      pair.gained_b[k] = a.other.field[N::mass_gain][at] / mass_b;
    }
}

/// Writes down at a node of both fields what the pair has reached; a node of three fields keeps the most of both pairs.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void note_reached(const Arguments<T>& a, int node, const ContactResult<Scene::dimension, T>& result) {
  using N = typename Scene::Node;
  if constexpr (Scene::contact_states > 0) {
    if (!a.notes_reached) return;
    const auto note = [&](const NodeArrays<T>& of_field) {
      for (int k = 0; k < Scene::contact_states; ++k) {
        T& reached = of_field.field[N::reached][k * a.node_count + node];
        reached = max(reached, result.reached[k]);
      }
      of_field.field[N::met][node] = T(1);
    };
    note(a.grid), note(a.other);
  }
}

/// Gives the velocities of `grid` and `other` the law's impulse at every node where they meet, and sums what it does.
template <class Scene>
MPM_HD void contact(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  sum_over<contact_sums, contact_maxima>(team, a, a.node_count, [&](int node, double* sums) {
    const int nodes = a.node_count;
    const bool weld = Scene::bypasses_detection;
    if constexpr (Scene::notes_contact)
      if (a.noted.met) a.noted.met[node] = -1;
    if (!is_active(a.grid, node)) return;  // it has no mass of the first field, so that nothing meets there
    ContactPair<D, T> pair;
    pair.mass_a = a.grid.field[N::mass][node], pair.mass_b = a.other.field[N::mass][node];
    if (!meet(pair.mass_a, pair.mass_b, weld)) return;
    const ContactGeometry geometry = geometry_of_pair<Scene>(a, node);
    if (!geometry.valid && !weld) return;
    const T mass_a = pair.mass_a, mass_b = pair.mass_b;
    const int held = held_body<Scene>(a, node);
    if (held >= 0)
      pair.mass_a = mass_beside_held(held == 0, mass_a, mass_b), pair.mass_b = static_cast<T>(a.rigid.mass);
    for (int c = 0; c < D; ++c) {
      const T velocity_a = a.grid.field[N::velocity][c * nodes + node],
              velocity_b = a.other.field[N::velocity][c * nodes + node];
      pair.momentum_a[c] =
          held < 0 ? momentum_of(velocity_a, mass_a) : momentum_beside(velocity_a, velocity_b, pair.mass_a);
      pair.momentum_b[c] = held < 0 ? momentum_of(velocity_b, mass_b) : T(0);
    }
    pair.separation = static_cast<T>(geometry.separation), pair.area = static_cast<T>(geometry.area);
    pair.dt = a.dt, pair.after_forces = a.after_forces, pair.cell_size = a.cell_size;
    if constexpr (Scene::reads_traction) {
      const WeldOfPair welds = welds_around<Scene>(a, node);
      for (int c = 0; c < D; ++c) pair.traction[c] = static_cast<T>(welds.traction(c, double(a.dt)));
    }
    if constexpr (N::mass_displacement >= 0) {
      const ContactFieldNode of_a = contact_field<Scene>(a, a.grid, node),
                             of_b = contact_field<Scene>(a, a.other, node);
      for (int c = 0; c < D; ++c) pair.displacement[c] = static_cast<T>(displacement_of_pair(of_a, of_b, c));
    }
    tell_state<Scene>(a, node, pair);
    ContactResult<D, T> result;
    const Vec<D, T> returned = ask_law<Scene>(a, geometry, pair, result);
    note_reached<Scene>(a, node, result);
    for (int c = 0; c < D; ++c) {
      const int at = c * nodes + node;
      sums[contact_unbalanced + c] += strike_pair<double>(
          a.grid.field[N::velocity][at], a.other.field[N::velocity][at], mass_a, mass_b, result.impulse[c], returned[c],
          [&](bool second, T given) {
            note_impulse<N::contact_impulse, N::standing_contact_impulse>(a, second ? a.other : a.grid, at, given);
          });
      sums[contact_impulse + c] += result.impulse[c];
    }
    if (geometry.valid)
      add_normal_part(result.impulse, Scene::own_normals ? geometry.own_a : geometry.normal, 1, D, sums + contact_along,
                      sums[contact_pressing]);
    sums[contact_dissipated] += result.dissipated;
    if constexpr (N::mass_displacement >= 0) sums[contact_stored] += result.stored;
    if constexpr (Scene::notes_contact)
      if (a.noted.met) note_node<Scene>(a, node, geometry, pair, result);
    const int status = static_cast<int>(result.status);
    if (status == contact_apart) return;
    sums[status == contact_sticks ? contact_sticking : contact_slipping] += 1;
    if (!geometry.valid) return;
    sums[contact_touching] += pair.area;
    sums[contact_penetration] = max(0.0, -double(pair.separation));
    sums[contact_gap] = max(0.0, double(pair.separation));
  });
}

/// Gives particles the mean of what the nodes around them say, over those where their field met another, if it is more than
/// they have.
template <class Scene>
MPM_HD void keep_contact_state(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension, states = Scene::contact_states;
  for_each_index(team, a.particles.count, [&](int p) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    T sum[states] = {}, met = T(0);
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      const int node = node_index<D>(a, s.node);
      met += s.weight * a.grid.field[N::met][node];
      for (int k = 0; k < states; ++k) sum[k] += s.weight * a.grid.field[N::reached][k * a.node_count + node];
    });
    for (int k = 0; k < states; ++k) {
      const int at = k * a.particles.stride + p;
      T& state = a.particles.field[P::contact_state][at];
      const T gain = met > T(0) ? max(sum[k] / met - state, T(0)) : T(0);
      a.particles.field[P::contact_gain][at] = gain;
      state += gain;
    }
  });
}

}  // namespace mpm::device

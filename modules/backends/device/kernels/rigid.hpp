#pragma once
// Material meets a rigid body at the nodes near it, through the functor of its law.

#include "backends/device/kernels/contact.hpp"
#include "operators/rigid_contact.hpp"

namespace mpm::device {

/// What a rigid body does to one velocity field, summed over its nodes.
enum : int {
  rigid_impulse = 0,     ///< 3, on the material, kg m/s
  rigid_moment = 3,      ///< 3, about the origin, kg m^2/s
  rigid_dissipated = 6,  ///< J
  rigid_driven,          ///< J, work of the body
  rigid_sticking,        ///< nodes
  rigid_slipping,
  rigid_penetration,  ///< the largest one, m
  rigid_sums
};

/// The velocity of the rigid body at the k-th of its nodes, m/s.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void velocity_of_rigid_body(const RigidArrays& body, int k, double* velocity) {
  constexpr int D = Scene::dimension;
  double arm[3] = {};
  for (int c = 0; c < D; ++c) arm[c] = body.values[(2 + D + c) * body.count + k];
  for (int c = 0; c < 3; ++c) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    velocity[c] = body.velocity[c] + body.spin[d] * arm[e] - body.spin[e] * arm[d];
  }
}

template <class Scene, class T = typename Scene::Scalar>
MPM_HD ContactGeometry geometry_at_rigid_body(const Arguments<T>& a, int k) {
  constexpr int D = Scene::dimension;
  const RigidArrays& body = a.rigid;
  RigidSurface surface{body.values[k], {}};
  for (int c = 0; c < D; ++c) surface.normal[c] = body.values[(2 + c) * body.count + k];
  return rigid_contact_geometry(contact_field<Scene>(a, a.grid, body.node[k]), a.edges[0], surface,
                                body.values[body.count + k], double(a.cell_size), D);
}

/// Gives the velocities of `grid` the law's impulse at every node near the body that has mass, and sums what it does.
template <class Scene>
MPM_HD void rigid_contact(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Law = typename Scene::Contact;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  sum_over<rigid_sums, 1>(team, a, static_cast<int>(a.rigid.count), [&](int k, double* sums) {
    const int node = a.rigid.node[k];
    const T mass = a.grid.field[N::mass][node];
    if (!(mass > T(0))) return;
    const ContactGeometry geometry = geometry_at_rigid_body<Scene>(a, k);
    double of_body[3], place[3], given[3] = {};
    velocity_of_rigid_body<Scene>(a.rigid, k, of_body);
    ContactPair<D, T> pair;
    pair.mass_a = mass, pair.mass_b = static_cast<T>(a.rigid.mass);
    for (int c = 0; c < D; ++c) {
      pair.momentum_a[c] =
          momentum_of(a.grid.field[N::velocity][c * a.node_count + node] - static_cast<T>(of_body[c]), mass);
      pair.momentum_b[c] = T(0);
      pair.normal[c] = static_cast<T>(geometry.normal[c]);
    }
    pair.separation = static_cast<T>(geometry.separation), pair.area = static_cast<T>(geometry.area);
    pair.dt = a.dt, pair.after_forces = a.after_forces;
    ContactResult<D, T> result;
    Law::apply(parameters_of<Law>(a.contact_parameters), pair, result);
    for (int c = 0; c < D; ++c) {
      const int at = c * a.node_count + node;
      T& velocity = a.grid.field[N::velocity][at];
      velocity = struck(velocity, result.impulse[c], mass);
      note_impulse<N::contact_impulse, N::standing_contact_impulse>(a, a.grid, at, result.impulse[c]);
      given[c] = result.impulse[c];
      sums[rigid_driven] += given[c] * of_body[c];
    }
    place_of_node<D>(a, node, place);
    add_impulse(sums + rigid_impulse, sums + rigid_moment, place, given);
    sums[rigid_dissipated] += result.dissipated;
    const int status = static_cast<int>(result.status);
    if (status == contact_apart) return;
    sums[status == contact_sticks ? rigid_sticking : rigid_slipping] += 1;
    sums[rigid_penetration] = max(0.0, -double(pair.separation));
  });
}

}  // namespace mpm::device

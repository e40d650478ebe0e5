#pragma once
// Two velocity fields meet at a node through the contact functor; normal, separation and area are given.

#include "backends/device/kernels/grid.hpp"
#include "operators/contact.hpp"

namespace mpm::device {

/// Gives the velocities of `grid` and `other` the law's impulse where the pair is active.
template <class Scene>
MPM_HD void contact(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Law = typename Scene::Contact;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.node_count, [&](int node) {
    const int nodes = a.node_count;
    if (!a.contact.active[node]) return;
    ContactPair<D, T> pair;
    pair.mass_a = a.grid.field[N::mass][node], pair.mass_b = a.other.field[N::mass][node];
    for (int c = 0; c < D; ++c) {
      pair.momentum_a[c] = momentum_of(a.grid.field[N::velocity][c * nodes + node], pair.mass_a);
      pair.momentum_b[c] = momentum_of(a.other.field[N::velocity][c * nodes + node], pair.mass_b);
    }
    pair.normal = load<D>(a.contact.normal, nodes, node);
    pair.separation = a.contact.separation[node], pair.area = a.contact.area[node];
    pair.dt = a.dt;
    ContactResult<D, T> result;
    Law::apply(parameters_of<Law>(a.contact_parameters), pair, result);
    for (int c = 0; c < D; ++c) {
      const int at = c * nodes + node;
      a.contact.unbalanced[at] = strike_pair<T>(a.grid.field[N::velocity][at], a.other.field[N::velocity][at],
                                                pair.mass_a, pair.mass_b, result.impulse[c], [&](bool second, T given) {
                                                  note_impulse<N::contact_impulse, N::standing_contact_impulse>(
                                                      a, second ? a.other : a.grid, at, given);
                                                });
    }
    store(a.contact.impulse, nodes, node, result.impulse);
    a.contact.dissipated[node] = result.dissipated;
    a.contact.status[node] = static_cast<int>(result.status);
  });
}

}  // namespace mpm::device

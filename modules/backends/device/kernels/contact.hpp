#pragma once
// Two velocity fields that meet at a node, through the contact functor; normal, separation and area are given.

#include "backends/device/kernels/arrays.hpp"

namespace mpm::device {

/// Momenta of `grid` and `other` take the law's impulse where the pair is active.
template <class Scene>
MPM_HD void contact(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Law = typename Scene::Contact;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.node_count, [&](int node) {
    const int nodes = a.node_count;
    if (!a.contact.active[node]) return;
    ContactPair<D, T> pair;
    pair.mass_a = a.grid.mass[node], pair.mass_b = a.other.mass[node];
    pair.momentum_a = load<D>(a.grid.momentum, nodes, node), pair.momentum_b = load<D>(a.other.momentum, nodes, node);
    pair.normal = load<D>(a.contact.normal, nodes, node);
    pair.separation = a.contact.separation[node], pair.area = a.contact.area[node];
    pair.dt = a.dt;
    ContactResult<D, T> result;
    Law::apply(parameters_of<Law>(a.contact_parameters), pair, result);
    for (int c = 0; c < D; ++c) {
      a.grid.momentum[c * nodes + node] += result.impulse[c];
      a.other.momentum[c * nodes + node] -= result.impulse[c];
    }
    store(a.contact.impulse, nodes, node, result.impulse);
    a.contact.dissipated[node] = result.dissipated;
    a.contact.status[node] = static_cast<int>(result.status);
  });
}

}  // namespace mpm::device

#pragma once
// This part of GridStep averages by volume, against locking. The sum of what particles have scattered and their volume lie
// in the first and the last scalar of a node's group, where the mean takes the sum's place.

#include "backends/cpu/grid/grid_step.hpp"

namespace mpm::cpu {

/// Folds as the masses were folded in this step, divides, and gives ghosts the mean of their mirrors.
template <int D, class T>
void GridStep<D, T>::average(Channel channel) {
  auto& faces = grid_.faces();
  for (const FaceNodes& face : faces)
    for_each_folded(face, [&, signs = mirror_signs(face, AtWall::even)](int field, const MirrorPair& pair) {
      fold_as_is(channel, field, pair, signs);
    });
  for_each_block([&](int field, std::uint32_t first, double*) {
    Q* const nodes = &grid_.quad(channel, field, first);
    for (int k = 0; k < block_nodes; ++k) nodes[k][0] = nodes[k][3] > T(0) ? nodes[k][0] / nodes[k][3] : T(0);
  });
  for (auto face = faces.rbegin(); face != faces.rend(); ++face)
    for_each_folded(*face, [&](int field, const MirrorPair& pair) {
      grid_.quad(channel, field, pair.ghost)[0] = grid_.quad(channel, field, pair.mirror)[0];
    });
}

}  // namespace mpm::cpu

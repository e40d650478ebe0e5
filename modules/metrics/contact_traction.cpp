#include "metrics/contact_traction.hpp"

#include <cmath>
#include <map>

#include "operators/contact.hpp"
#include "plugin/abi.h"

namespace mpm {
namespace {

struct Share {
  Vector3 force{};
  double area = 0;

  void add(const Share& other) {
    for (std::size_t c = 0; c < 3; ++c) force[c] += other.force[c];
    area += other.area;
  }
};

using SharesOfNodes = std::map<std::array<int, 3>, Share>;

/// Nodes of periodic axes are counted from the lower face up to the one below the upper face, which is its image.
int counted(const Experiment& experiment, std::size_t axis, int node) {
  if (experiment.faces[axis][0].type != ConditionType::periodic) return node;
  const int cells = experiment.grid.cells[axis];
  return (node % cells + cells) % cells;
}

/// Whether surfaces touch at a node, as closely as detection knows: by position it makes gaps of hundredths of a cell of
/// turned faces that touch, and a tenth of stretched ones. A node that the law lets part takes no force in this step, and
/// has its area. A detection that reads nothing knows of no gap, so that the law's word is all there is.
bool touches(const Experiment& experiment, const ContactNode& node) {
  if (experiment.contact_detection->plugin->detection().traits == 0) return node.status != MPM_APART;
  return node.status != MPM_APART || node.separation <= 0.1 * experiment.grid.cell_size;
}

/// The touching nodes of one field.
SharesOfNodes nodes_of(const Experiment& experiment, int field, const std::vector<ContactNode>& all) {
  SharesOfNodes nodes;
  for (const ContactNode& node : all) {
    if (!touches(experiment, node) || (node.a != field && node.b != field)) continue;
    Share given{node.force, node.area};
    if (node.b == field)
      for (double& component : given.force) component = -component;
    std::array<int, 3> at{};
    for (std::size_t c = 0; c < static_cast<std::size_t>(experiment.dimension); ++c)
      at[c] = counted(experiment, c, node.node[c]);
    nodes[at].add(given);
  }
  return nodes;
}

/// The sum over the nodes from `first` on, `count` along each axis.
Share sum_of(const Experiment& experiment, const SharesOfNodes& nodes, const std::array<int, 3>& first, int count) {
  Share sum;
  const int depth = experiment.dimension == 3 ? count : 1;
  for (int k = 0; k < depth; ++k)
    for (int j = 0; j < count; ++j)
      for (int i = 0; i < count; ++i) {
        std::array<int, 3> at{first[0] + i, first[1] + j, first[2] + k};
        for (std::size_t c = 0; c < 3; ++c) at[c] = counted(experiment, c, at[c]);
        if (const auto found = nodes.find(at); found != nodes.end()) sum.add(found->second);
      }
  return sum;
}

}  // namespace

std::vector<double> contact_traction(const Experiment& experiment, int body, const BodyState& state,
                                     const std::vector<ContactNode>& nodes) {
  const auto D = static_cast<std::size_t>(experiment.dimension);
  const std::size_t count = state.position.size() / D;
  std::vector<double> traction(3 * count);
  const SharesOfNodes touching = nodes_of(experiment, experiment.bodies[static_cast<std::size_t>(body)].field, nodes);
  for (std::size_t p = 0; p < count && !touching.empty(); ++p) {
    std::array<int, 3> cell{}, around{};
    for (std::size_t c = 0; c < D; ++c) {
      const double x = (state.position[p * D + c] - experiment.grid.lower[c]) / experiment.grid.cell_size;
      cell[c] = static_cast<int>(std::floor(x));
      around[c] = static_cast<int>(std::floor(x + 0.5)) - traction_reach;
    }
    if (!(sum_of(experiment, touching, cell, 2).area > 0)) continue;
    const Share sum = sum_of(experiment, touching, around, 2 * traction_reach + 1);
    for (std::size_t c = 0; c < 3; ++c) traction[3 * p + c] = sum.force[c] / sum.area;
  }
  return traction;
}

}  // namespace mpm

#include "metrics/contact_traction.hpp"

#include <cmath>
#include <map>

#include "plugin/abi.h"

namespace mpm {
namespace {

struct Share {
  Vector3 force{};
  double area = 0;

  void add(double weight, const Share& other) {
    for (std::size_t c = 0; c < 3; ++c) force[c] += weight * other.force[c];
    area += weight * other.area;
  }
};

using Nodes = std::map<std::array<int, 3>, Share>;

/// Nodes of periodic axes are counted from the lower face up to the one below the upper face, which is its image.
int counted(const Experiment& experiment, std::size_t axis, int node) {
  if (experiment.faces[axis][0].type != ConditionType::periodic) return node;
  const int cells = experiment.grid.cells[axis];
  return (node % cells + cells) % cells;
}

/// The touching nodes of one field.
Nodes nodes_of(const Experiment& experiment, int field, const std::vector<ContactNode>& all) {
  Nodes nodes;
  for (const ContactNode& node : all) {
    if (node.status == MPM_APART || (node.a != field && node.b != field)) continue;
    Share given{node.force, node.area};
    if (node.b == field)
      for (double& component : given.force) component = -component;
    std::array<int, 3> at{};
    for (std::size_t c = 0; c < static_cast<std::size_t>(experiment.dimension); ++c)
      at[c] = counted(experiment, c, node.node[c]);
    nodes[at].add(1, given);
  }
  return nodes;
}

}  // namespace

std::vector<double> contact_traction(const Experiment& experiment, int body, const BodyState& state,
                                     const std::vector<ContactNode>& nodes) {
  const auto D = static_cast<std::size_t>(experiment.dimension);
  const std::size_t count = state.position.size() / D;
  std::vector<double> traction(3 * count);
  const Nodes touching = nodes_of(experiment, experiment.bodies[static_cast<std::size_t>(body)].field, nodes);
  for (std::size_t p = 0; p < count && !touching.empty(); ++p) {
    Share sum;
    for (unsigned corner = 0; corner < 1U << D; ++corner) {
      std::array<int, 3> at{};
      double weight = 1;
      for (std::size_t c = 0; c < D; ++c) {
        const double x = (state.position[p * D + c] - experiment.grid.lower[c]) / experiment.grid.cell_size;
        const bool above = (corner >> c & 1) != 0;
        at[c] = counted(experiment, c, static_cast<int>(std::floor(x)) + (above ? 1 : 0));
        weight *= above ? x - std::floor(x) : 1 - (x - std::floor(x));
      }
      if (const auto found = touching.find(at); found != touching.end()) sum.add(weight, found->second);
    }
    for (std::size_t c = 0; c < 3 && sum.area > 0; ++c) traction[3 * p + c] = sum.force[c] / sum.area;
  }
  return traction;
}

}  // namespace mpm

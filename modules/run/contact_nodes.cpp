#include "run/contact_nodes.hpp"

#include "metrics/body_sums.hpp"
#include "plugin/abi.h"
#include "support/csv.hpp"
#include "support/numbers.hpp"

namespace mpm::app {
namespace {

double place(const Experiment& experiment, const ContactNode& node, std::size_t axis) {
  return experiment.grid.lower[axis] + node.node[axis] * experiment.grid.cell_size;
}

}  // namespace

std::string contact_table(const Experiment& experiment, const std::vector<ContactNode>& nodes) {
  const RecordedUnits units = units_of(experiment);
  const auto D = static_cast<std::size_t>(experiment.dimension);
  const std::string axes = "xyz";
  support::CsvText csv;
  std::vector<std::string> cells;
  for (std::size_t c = 0; c < D; ++c) cells.push_back(std::string(1, axes[c]) + " (m)");
  cells.insert(cells.end(), {"first", "second", "state"});
  for (std::size_t c = 0; c < D; ++c) cells.push_back(std::string("normal ") + axes[c]);
  cells.insert(cells.end(), {"separation (m)", "area (" + units.area + ")"});
  for (std::size_t c = 0; c < D; ++c) cells.push_back(std::string("force ") + axes[c] + " (" + units.force + ")");
  csv.row(cells);
  for (const ContactNode& node : nodes) {
    cells.clear();
    const auto add = [&](double value) { support::append_shortest(cells.emplace_back(), value); };
    for (std::size_t c = 0; c < D; ++c) add(place(experiment, node, c));
    cells.push_back(experiment.field_names[static_cast<std::size_t>(node.a)]);
    cells.push_back(experiment.field_names[static_cast<std::size_t>(node.b)]);
    cells.emplace_back(node.status == MPM_STICKS ? "sticks" : node.status == MPM_SLIPS ? "slips" : "apart");
    for (std::size_t c = 0; c < D; ++c) add(node.normal[c]);
    add(node.separation), add(node.area);
    for (std::size_t c = 0; c < D; ++c) add(node.force[c]);
    csv.row(cells);
  }
  return csv.text();
}

std::vector<render::NodeMark> contact_marks(const Experiment& experiment, const std::vector<ContactNode>& nodes) {
  std::vector<render::NodeMark> marks;
  for (const ContactNode& node : nodes) {
    using State = render::NodeMark::State;
    marks.push_back({{place(experiment, node, 0), place(experiment, node, 1)},
                     {node.normal[0], node.normal[1]},
                     node.status == MPM_STICKS  ? State::sticks
                     : node.status == MPM_SLIPS ? State::slips
                                                : State::apart});
  }
  return marks;
}

}  // namespace mpm::app

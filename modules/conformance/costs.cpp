// Checks of the operation counts that a plugin says of itself.

#include "conformance/support.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::conformance {

void check_costs(const Plugin& plugin, Findings& findings) {
  const auto* table = extension_of<mpm_costs>(plugin);
  if (!table) return;
  findings.require("costs_entry", table->count != nullptr, "counts");
  if (!table->count) return;
  const bool list = plugin.descriptor->kind == MPM_SHAPE && plugin.shape().form == MPM_NODE_LIST;
  Random random(20240612);
  for (const ParameterSample& parameters : sample_parameters(plugin, random)) {
    const std::string where = parameters.text.empty() ? "" : "; " + parameters.text;
    findings.running("operation counts" + where);
    const auto count = [&](std::uint32_t dimension, bool single, bool more) {
      const mpm_cost_case of{dimension, single, more, more, 0.25};
      mpm_cost cost{-1, -1};
      table->count(parameters.data(), &of, &cost);
      return cost;
    };
    bool positive = true, whole = true, repeatable = true, ordered = true, nodes = true;
    for (const std::uint32_t dimension : {2u, 3u})
      for (const bool single : {true, false}) {
        const mpm_cost less = count(dimension, single, false), more = count(dimension, single, true);
        positive &= less.operations > 0 && std::isfinite(less.operations);
        whole &= list || less.operations == std::floor(less.operations);
        repeatable &= more.operations == count(dimension, single, true).operations;
        ordered &= less.operations <= more.operations &&
                   count(2, single, true).operations <= count(3, single, true).operations &&
                   count(dimension, true, true).operations <= count(dimension, false, true).operations;
        const double most = list ? plugin.shape().capacity[dimension - 2] : 0;
        nodes &= list ? less.nodes >= 1 && less.nodes <= most : less.nodes == 0;
      }
    findings.require("costs_positive", positive && whole,
                     "a whole number of operations, in the mean of a list" + where);
    findings.require("costs_repeatable", repeatable, "the same at every call" + where);
    findings.require("costs_ordered", ordered,
                     "no less with gradients or flow, in 3-D than in 2-D, in double than in float" + where);
    findings.require("costs_nodes", nodes, "of a list within its capacity, else 0" + where);
  }
}

}  // namespace mpm::conformance

// What the mean dilation adds to a plan, and to no other.

#include <algorithm>

#include "experiment/diagnostics.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* const block = R"J({
  "dimension": 2,
  "grid": {"cell_size": 0.25, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "materials": {"a": {"type": "neo_hookean", "density": 1000, "youngs_modulus": 1e4, "poisson_ratio": 0.2}},
  "bodies": [{"name": "b", "material": "a", "geometry": {"type": "box", "lower": [0.25, 0.25], "upper": [0.75, 0.75]}}],
  "solver": {"time_step": 0.01, "end_time": 1}, "output": {"ledger": false}
})J";

Plan plan_with(const std::vector<std::string>& overrides) {
  return make_plan(experiment_from(block, overrides));
}

/// The passes from the first division on.
std::vector<std::string> passes_with(const std::vector<std::string>& overrides) {
  std::vector<std::string> names;
  const Plan plan = plan_with(overrides);
  for_each_pass(plan.step, [&](const Pass& pass) { names.push_back(pass.name()); });
  names.erase(names.begin(), std::find(names.begin(), names.end(), "momentum to velocity"));
  return names;
}

}  // namespace

TEST_CASE("only a scene that averages the dilation has passes and fields for it", "[plan][dilation]") {
  for (const std::string backend : {"reference", "cpu"}) {
    const Plan own = plan_with({set("/backend", backend)});
    const Plan averaged = plan_with({set("/backend", backend), "/solver/dilation=averaged"});
    for (const Act act :
         {Act::scatter_mean_stress, Act::average_mean_stress, Act::scatter_dilation, Act::average_dilation}) {
      CHECK(!own.does(act));
      CHECK(averaged.does(act));
    }
    for (const char* field :
         {"volume_stress", "stressed_volume", "mean_stress", "volume_rate", "strained_volume", "dilation"}) {
      CHECK(own.node_field(field) == nullptr);
      CHECK(averaged.node_field(field) != nullptr);
    }
  }
  // The cpu backend keeps both averages in one group of four scalars, and forces apart from the momenta.
  const auto bytes = [](const std::string& dilation) {
    return plan_with({"/solver/passes=separate", "/solver/dilation=" + dilation}).bytes_per_node();
  };
  CHECK(bytes("averaged") - bytes("own") == 2 * 4 * sizeof(double));
}

TEST_CASE("averages stand before what takes them in every order of a step", "[plan][dilation]") {
  using Names = std::vector<std::string>;
  const auto passes = [](const std::string& order) {
    return passes_with({"/solver/dilation=averaged", set("/solver/stress_update", order)});
  };
  CHECK(passes("last") == Names{"momentum to velocity", "scatter mean stress", "average mean stress", "scatter force",
                                "apply forces", "scatter dilation", "average dilation", "gather and strain"});
  CHECK(passes("first") == Names{"momentum to velocity", "scatter dilation", "average dilation", "strain",
                                 "scatter mean stress", "average mean stress", "scatter force", "apply forces",
                                 "gather"});
  CHECK(passes("modified_last") == Names{"momentum to velocity", "scatter mean stress", "average mean stress",
                                         "scatter force", "apply forces", "gather", "scatter again",
                                         "momentum to velocity again", "scatter dilation", "average dilation", "strain",
                                         "move"});
  CHECK(passes("averaged") == Names{"momentum to velocity", "scatter dilation", "average dilation", "half strain",
                                    "scatter mean stress", "average mean stress", "scatter force", "apply forces",
                                    "scatter dilation", "average dilation", "gather and half strain"});
}

TEST_CASE("passes of a scene that averages the dilation cannot be fused", "[plan][dilation]") {
  CHECK(plan_with({"/solver/passes=fused"}).fused());
  CHECK_THROWS_WITH(
      plan_with({"/solver/passes=fused", "/solver/dilation=averaged"}),
      ContainsSubstring(R"(passes cannot be fused: /solver/dilation "averaged": nodes average before the )"
                        "forces and before the gather"));
}

// Artificial viscosity on any law: the backends against one another on shapes, transfers, orders, laws, and a restored run.

#include <set>

#include "parity/heat_scenes.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string viscous = R"(/materials/m/artificial_viscosity={"linear": 0.5, "quadratic": 3})";

Mix viscous_mix(int dimension = 2) {
  Mix mix;
  mix.dimension = dimension, mix.overrides = {viscous};
  return mix;
}

/// The second body is of a material without it.
Mix half_viscous() {
  Mix mix = viscous_mix();
  mix.overrides.insert(mix.overrides.end(), {"/materials/n=" + Mix{}.material, R"(/bodies/1/material="n")"});
  return mix;
}

Mix on_an_axis() {
  Mix mix = viscous_mix();
  mix.overrides.insert(mix.overrides.end(),
                       {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]"),
                        R"(/bodies/1/geometry={"type": "box", "lower": [0, -0.1], "upper": [0.21, 0.18]})",
                        R"(/bodies/1/velocity=["-1.1*x", 0.7])"});
  return mix;
}

/// What artificial viscosity dissipated over the energy that the scene began with, on the reference backend.
double share_dissipated(const Mix& mix) {
  Scene scene(mix.text(), on_reference(mix));
  scene.run();
  return scene.simulation.ledger().artificial_viscosity / scene.metrics.initial().kinetic;
}

}  // namespace

TEST_CASE("parity of artificial viscosity on shapes and transfers", "[parity][viscosity]") {
  for (const int dimension : {2, 3}) {
    const std::vector<std::string> shapes{"bspline_quadratic", "gimp", "cpdi", "bspline_cubic"},
        transfers{"flip", "mls", "pic", "apic"};
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      Mix mix = viscous_mix(dimension);
      mix.shape = transfer_named(shapes[k]), mix.transfer = transfer_named(transfers[k]);
      mix.stress_update = orders[k % orders.size()];
      REQUIRE(!is_refused(mix));
      check_parity(mix);
    }
  }
}

TEST_CASE("parity of artificial viscosity in every order, with filters, contact and the mean dilation",
          "[parity][viscosity]") {
  for (const std::string& order : orders)
    for (const std::string filter : {"", R"({"type": "fmpm", "order": 2, "every_steps": 2})"})
      for (const std::string dilation : {"own", "averaged"}) {
        Mix mix = viscous_mix();
        mix.stress_update = order, mix.filter = filter, mix.contact = R"({"type": "coulomb", "friction": 0.2})";
        mix.transfer = transfer_named(filter.empty() ? "flip" : "pic");
        mix.overrides.push_back("/solver/dilation=" + dilation);
        if (!is_refused(mix)) check_parity(mix);
      }
}

TEST_CASE("parity of artificial viscosity on every law", "[parity][viscosity]") {
  std::set<std::string> refused, taken;
  for (const Plugin* plugin : plugins().of_kind(MPM_MATERIAL)) {
    Mix mix = viscous_mix();
    mix.material = variants(*plugin).front();
    if (is_accepted(mix))
      taken.insert(std::string(plugin->id())), check_parity(mix);
    else
      refused.insert(std::string(plugin->id()));
  }
  CHECK(refused.count("ideal_gas") == 1);
  CHECK(taken.size() >= 15);
}

TEST_CASE("parity of artificial viscosity around an axis, of one body of two, of temperature and without a ledger",
          "[parity][viscosity]") {
  for (const std::string& order : orders) {
    Mix ring = on_an_axis();
    ring.stress_update = order;
    check_parity(ring);
  }
  check_parity(half_viscous());
  Mix heated = viscous_mix();
  heated.close = true, heated.boundaries = boundaries(2, "slip");
  heated = warm(heated);
  heated.overrides.push_back("/materials/m/thermal/dissipation_to_heat=0.9");
  check_parity(heated);
  Mix plain = viscous_mix();
  plain.more = R"(, "output": {"ledger": false})";
  CHECK(make_plan(experiment_from(plain.text(), plain.overrides)).fused());
  check_parity(plain);
  plain.overrides.emplace_back("/solver/passes=separate");
  check_parity(plain);
  Mix automatic = viscous_mix();
  automatic.overrides.push_back(set("/solver/time_step", "\"auto\""));
  check_parity(automatic);
}

TEST_CASE("artificial viscosity dissipates in the scenes of parity", "[parity][viscosity]") {
  CHECK(share_dissipated(viscous_mix()) > 1e-3);
  CHECK(share_dissipated(viscous_mix(3)) > 1e-3);
  CHECK(share_dissipated(on_an_axis()) > 1e-4);
  CHECK(share_dissipated(half_viscous()) < 0.9 * share_dissipated(viscous_mix()));
  CHECK(share_dissipated(Mix{}) == 0);
}

TEST_CASE("a restored run with artificial viscosity goes on bit for bit", "[parity][viscosity]") {
  for (const std::string& order : orders)
    for (const std::string precision : {"double", "float"}) {
      Mix mix = viscous_mix();
      mix.stress_update = order, mix.contact = R"({"type": "coulomb", "friction": 0.2})";
      mix.overrides.insert(mix.overrides.end(), {set("/precision", precision), "/solver/end_time=0.9"});
      const std::string text = mix.text();
      CpuRun whole(text, mix.overrides, 1), resumed(text, mix.overrides, 2);
      whole.steps(7);
      ArchiveWriter archive;
      whole.simulation.save(archive);
      resumed.steps(3);
      ArchiveReader reader(archive.bytes());
      resumed.simulation.restore(reader);
      for (CpuRun* run : {&whole, &resumed}) run->steps(9);
      CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
    }
}

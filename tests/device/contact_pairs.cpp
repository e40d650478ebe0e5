// The force of each pair of fields on the device.

#include "device/device_support.hpp"
#include "support/stacked_blocks.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("on the device too a pair's force is what the block above it feels") {
  for (const auto& [transfer, filter] : stacked_schemes()) {
    INFO(transfer << filter);
    DeviceScene scene(stacked_blocks("reference", transfer, filter, "[0, -0.2]"), "double");
    check_newton(scene.simulation, 12, 1e-8);
  }
}

TEST_CASE("the parts of a pair's force and its area are those of the other backends") {
  for (const auto& [transfer, filter] : stacked_schemes()) {
    INFO(transfer << filter);
    // Faces without a gap touch or not by rounding; a weld does not ask.
    const std::string text = stacked_blocks("reference", transfer, filter, "[0.3, -0.2]");
    const std::vector<std::string> weld{R"(/contact={"type": "stick"})"};
    Scene reference(text, weld);
    DeviceScene device(text, "double", {}, weld);
    reference.run_steps(12);
    for (int k = 0; k < 12; ++k) device.simulation.step();
    const std::vector<PairRecord>&expected = reference.simulation.backend().contact_pairs(),
          &found = device.simulation.backend().contact_pairs();
    REQUIRE(found.size() == 3);
    CHECK(expected[2].tangential_force[0] != 0);
    for (std::size_t k = 0; k < found.size(); ++k) {
      for (std::size_t c = 0; c < 3; ++c)
        CHECK(found[k].force[c] == Approx(expected[k].force[c]).epsilon(1e-8).margin(1e-6));
      CHECK(found[k].nodes == expected[k].nodes);
      CHECK(found[k].normal_force == Approx(expected[k].normal_force).epsilon(1e-8).margin(1e-6));
      for (std::size_t c = 0; c < 3; ++c)
        CHECK(found[k].tangential_force[c] == Approx(expected[k].tangential_force[c]).epsilon(1e-8).margin(1e-6));
      CHECK(found[k].area == Approx(expected[k].area).epsilon(1e-10));
    }
  }
}

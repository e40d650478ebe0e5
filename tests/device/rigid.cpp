// Rigid bodies on the host-run device beside the reference backend: laws of their own, several fields, orders, filters.

#include "device/device_support.hpp"
#include "parity/rigid_scenes.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

void check(const Mix& mix) {
  if (!is_chosen_check()) return;
  INFO(mix.name());
  Scene reference(mix.text(), on_reference(mix));
  reference.run();
  for (const std::string precision : {"double", "float"}) {
    DeviceScene device(mix.text(), precision, {}, mix.overrides);
    device.run();
    CHECK(scene_difference(reference, device) <= device_bound(mix) * epsilon_of(precision));
    CHECK(difference(contact_counts(reference.simulation.backend(), reference.experiment),
                     contact_counts(device.simulation.backend(), device.experiment),
                     1.0) <= (precision == "double" ? 1e-9 : 1e-2));
    CHECK(difference_at_rigid_bodies(reference.simulation.backend(), device.simulation.backend(),
                                     reference.experiment) <= (precision == "double" ? 1e-11 : 1e-2));
  }
}

}  // namespace

TEST_CASE("rigid bodies on the host-run device", "[device]") {
  for (const int dimension : {2, 3})
    for (const bool touch : {false, true}) {
      Mix mix = beside_rigid_bodies(dimension);
      if (touch) mix.contact = R"({"type": "coulomb", "friction": 0.2})";
      check(mix);
    }
  for (const std::string order : {"first", "modified_last"}) {
    Mix mix = beside_rigid_bodies(2);
    mix.transfer = R"({"type": "flip"})", mix.stress_update = order;
    check(mix);
  }
  for (const std::string filter : {R"({"type": "fmpm", "order": 3})", R"({"type": "xpic", "order": 3})"}) {
    Mix mix = beside_rigid_bodies(2);
    mix.filter = filter;
    check(mix);
  }
}

// Half-spaces across the axis of symmetry, whose nodes stand for rings; and a liquid, which drags once a step.
TEST_CASE("rigid bodies around an axis, and ones that a liquid drags, on the host-run device", "[device]") {
  for (const std::string law : {R"({"type": "coulomb", "friction": 0.3})",
                                R"({"type": "liquid_contact", "viscosity": 400, "slip_length": 0.02})"})
    for (const bool rings : {false, true}) {
      Mix mix = beside_rigid_bodies(2);
      mix.more =
          R"(, "rigid_bodies": [{"name": "floor", "contact": )" + law +
          R"(, "velocity": [0, "0.5+t"], "geometry": {"type": "half_space", "point": [0, 0.25], "normal": [0, 1]}}])";
      if (rings) mix.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
      check(mix);
    }
}

// A graph holds the launches of a step with all their numbers: a body that begins to move late has to leave it.
TEST_CASE("a rigid body that begins to move late is not left behind by graphs", "[device]") {
  for (const std::string late : {R"(["0", "max(0, t-0.05)*20"])", R"([0, 0])"}) {
    Mix mix = beside_rigid_bodies(2);
    mix.more = R"(, "rigid_bodies": [{"name": "floor", "contact": {"type": "coulomb", "friction": 0.3}, "velocity": )" +
               late + R"(, "geometry": {"type": "half_space", "point": [0, 0.25], "normal": [-0.1, 1]}}])";
    check(mix);
  }
}

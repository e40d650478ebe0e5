// Emitters, sinks and changes of material on the host-run device beside the reference backend.

#include "device/device_support.hpp"
#include "parity/particle_change_scenes.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("particles come, go and change their material on the host-run device", "[device]") {
  std::size_t turn = 0;
  for (const int dimension : {2, 3})
    for (const std::string contact : {"", R"({"type": "coulomb", "friction": 0.2})"}) {
      Mix mix;
      mix.dimension = dimension, mix.contact = contact;
      check_on_device(with_particle_changes(mix), precisions_in_turn(dimension == 2, turn++));
    }
  Mix mix;
  mix.shape = R"({"type": "cpdi"})";
  check_on_device(with_particle_changes(mix), {"double"});
}

TEST_CASE("a body without particles runs on the host-run device", "[device]") {
  for (const std::string contact :
       {"", R"({"type": "coulomb", "friction": 0.2})",
        R"({"type": "coulomb", "normal": "widest_gap", "detection": "particle_surfaces"})"}) {
    Mix mix;
    mix.contact = contact;
    mix.overrides = {
        "/bodies/1/geometry=null", "/bodies/1/jitter=0",
        R"(/bodies/0/becomes={"body": "b", "when": {"quantity": "position_x", "above": 0.4}, "every_steps": 6})",
        R"(/sinks=[{"body": "b", "every_steps": 9,
                        "geometry": {"type": "half_space", "point": [0, 0], "normal": [0, -1]}}])"};
    check_on_device(mix);
  }
}

// Particles of many sizes, and bodies that begin deformed, on the host-run device.

#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

Mix seeded(const std::string& first, const std::string& second) {
  Mix mix;
  mix.overrides = {"/bodies/0/seeding=" + first, "/bodies/1/seeding=" + second};
  if (first == "blue_noise") mix.overrides.emplace_back("/bodies/0/jitter=0");
  return mix;
}

}  // namespace

TEST_CASE("particles of many sizes on the host-run device", "[device][seeding]") {
  for (const std::string shape : {"bspline_quadratic", "cpdi2"})
    for (const auto& [first, second] :
         {std::pair{"partial", "partial"}, {"lattice", "partial"}, {"blue_noise", "fitted"}}) {
      Mix mix = seeded(first, second);
      mix.shape = "{\"type\": \"" + shape + "\"}";
      mix.contact = R"({"type": "coulomb", "friction": 0.2})";
      check_on_device(mix);
    }
  Mix rings = seeded("partial", "lattice");
  rings.overrides.insert(rings.overrides.end(), {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"});
  rings.contact = R"({"type": "coulomb", "friction": 0.2})";
  check_on_device(rings);
  Mix filtered = seeded("partial", "lattice");
  filtered.filter = R"({"type": "fmpm", "order": 2})";
  filtered.more = R"(, "body_force": ["0.3*y", "0.2*x+t"])";
  check_on_device(filtered);
}

TEST_CASE("bodies that begin deformed on the host-run device", "[device][seeding]") {
  for (const std::string shape : {"bspline_quadratic", "gimp_contiguous", "cpdi2"}) {
    Mix mix;
    mix.shape = "{\"type\": \"" + shape + "\"}";
    mix.overrides = {R"J(/bodies/0/initial_displacement=["0.01*sin(9*X)", "0.02*X*Y"])J",
                     R"(/bodies/1/initial_stress={"xx": "-40+30*Y", "xy": 20})"};
    check_on_device(mix);
  }
}

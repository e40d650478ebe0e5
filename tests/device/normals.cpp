// Every contact normal, and detection that looks at particles, on the host-run device.

#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("normals and surfaces of particles on the host-run device", "[device][normals]") {
  const std::string gap = R"({"type": "coulomb", "friction": 0.2, "normal": "widest_gap"})",
                    surfaces = R"({"type": "coulomb", "detection": "particle_surfaces"})",
                    both = R"({"type": "coulomb", "normal": "widest_gap", "detection": "particle_surfaces"})";
  for (const int dimension : {2, 3})
    for (const std::string& contact : {gap, both}) {
      Mix mix;
      mix.dimension = dimension, mix.contact = contact;
      check_on_device(mix);
    }
  Mix domains;
  domains.shape = R"({"type": "cpdi"})", domains.contact = surfaces;
  check_on_device(domains);
  Mix rings;
  rings.contact = both, rings.overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
  check_on_device(rings);
  Mix sizes;
  sizes.contact = surfaces, sizes.overrides = {"/bodies/0/seeding=partial", "/bodies/1/seeding=partial"};
  check_on_device(sizes);
  Mix walls;
  walls.contact = both, walls.close = true;
  walls.boundaries = R"({"all": "separate", "x_min": "periodic", "x_max": "periodic"})";
  check_on_device(walls);
}

TEST_CASE("every normal on the host-run device", "[device][normals]") {
  for (const Plugin* normal : plugins().of_kind(MPM_NORMAL)) {
    for (const int dimension : {2, 3}) check_on_device(mix_with(*normal, dimension));
    Mix rings = mix_with(*normal, 2);
    rings.overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
    check_on_device(rings);
    if (normal->normal().traits & MPM_OWN_NORMALS) continue;  // refused with detection by particles' surfaces
    Mix surfaces = mix_with(*normal, 2);
    surfaces.contact.insert(surfaces.contact.size() - 1, ", \"detection\": \"particle_surfaces\"");
    check_on_device(surfaces);
  }
}

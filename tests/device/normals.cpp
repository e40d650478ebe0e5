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
  for (const int dimension : {2, 3}) {
    Mix capped;
    capped.dimension = dimension, capped.contact = R"({"type": "coulomb", "friction": 0.2, "strain_cap": 0.004})";
    check_on_device(capped);
  }
  Mix walls;
  walls.contact = both, walls.close = true;
  walls.boundaries = R"({"all": "separate", "x_min": "periodic", "x_max": "periodic"})";
  check_on_device(walls);
}

namespace {

/// Every normal in the plane, around an axis, in 3-D and with particles' surfaces.
void check_every_normal(bool both_precisions) {
  std::size_t turn = 0;
  for (const Plugin* normal : plugins().of_kind(MPM_NORMAL)) {
    std::vector<Mix> mixes{mix_with(*normal, 2), mix_with(*normal, 3), mix_with(*normal, 2)};
    mixes[2].overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
    if (!(normal->normal().traits & MPM_OWN_NORMALS)) {  // refused with detection by particles' surfaces
      mixes.push_back(mix_with(*normal, 2));
      mixes[3].contact.insert(mixes[3].contact.size() - 1, ", \"detection\": \"particle_surfaces\"");
    }
    for (std::size_t k = 0; k < mixes.size(); ++k)
      check_on_device(mixes[k], precisions_in_turn(both_precisions, turn + k));
    ++turn;
  }
}

}  // namespace

TEST_CASE("every detection on the host-run device", "[device][normals]") {
  std::size_t turn = 0;
  for (const Plugin* detection : plugins().of_kind(MPM_DETECTION)) {
    std::vector<Mix> mixes{mix_with(*detection, 2), mix_with(*detection, 3), mix_with(*detection, 2)};
    mixes[1].shape = R"({"type": "cpdi"})";
    mixes[2].overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
    for (const Mix& mix : mixes) check_on_device(mix, precisions_in_turn(false, turn++));
  }
}

TEST_CASE("each body has its own edges of particles on the host-run device", "[device][normals]") {
  Mix mix;
  mix.contact = R"({"type": "coulomb", "friction": 0.2})",
  mix.overrides = {set("/bodies/1/particles_per_cell_axis", "3")};
  check_on_device(mix);
}

TEST_CASE("bodies meet at more nodes than a batch holds on the host-run device", "[device][normals]") {
  Mix mix;
  mix.contact = R"({"type": "coulomb", "friction": 0.2, "normal": "widest_gap", "detection": "particle_surfaces"})";
  mix.overrides = {set("/grid/domain", "[[0, -0.1], [1.3, 7.5]]"),
                   set("/bodies/0/geometry", R"({"type": "box", "lower": [0.2, 0], "upper": [0.5175, 7.2]})"),
                   set("/bodies/1/geometry", R"({"type": "box", "lower": [0.52, 0], "upper": [0.81, 7.2]})"),
                   set("/bodies/0/velocity", "[1.4, 0]"), set("/solver/end_time", "0.027")};
  Scene reference(mix.text(), on_reference(mix));
  reference.simulation.step();
  const ContactRecord record = reference.simulation.backend().contact_record();
  REQUIRE(record.sticking + record.slipping > MPM_BATCH);
  check_on_device(mix);
}

TEST_CASE("every normal on the host-run device", "[device][normals]") {
  check_every_normal(false);
}

TEST_CASE("every normal on the host-run device in both precisions", "[device][normals][slow]") {
  check_every_normal(true);
}

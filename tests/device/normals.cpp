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

namespace {

const std::string by_particles =
    R"({"type": "coulomb", "friction": 0.2, "normal": "widest_gap", "detection": "particle_surfaces"})";

/// A body of jittered particles between two corners.
std::string box(const std::string& name, const std::string& lower, const std::string& upper,
                const std::string& velocity, const std::string& more = "") {
  return R"({"name": ")" + name + R"(", "material": "m", "jitter": 0.2, "geometry": {"type": "box", "lower": )" +
         lower + R"(, "upper": )" + upper + R"(}, "velocity": )" + velocity + more + "}";
}

/// Checks a mix in whose last step bodies press against one another, in the plane and in space.
void check_meeting(const Mix& mix, const std::vector<std::string>& precisions) {
  INFO(mix.name());
  Scene reference(mix.text(), on_reference(mix));
  while (!reference.simulation.finished()) reference.simulation.step();
  REQUIRE(reference.simulation.backend().contact_record().nodes > 0);
  check_on_device(mix, precisions);
}

/// The places and velocities of a mix's particles after its run, with rows of this length.
std::vector<std::vector<double>> run_with_row(const Mix& mix, int row) {
  const Experiment experiment = device_experiment(mix.text(), "double", mix.overrides);
  device::DeviceSetup setup = device_setup();
  setup.contact_row = row;
  Simulation simulation(experiment, device_factory(setup));
  while (!simulation.finished()) simulation.step();
  CHECK(simulation.backend().contact_record().nodes > 0);
  std::vector<std::vector<double>> found;
  for (const int body : {0, 1}) {
    found.push_back(simulation.backend().body_state(body).position);
    found.push_back(simulation.backend().body_state(body).velocity);
  }
  return found;
}

}  // namespace

TEST_CASE("bodies meet across a periodic face on the host-run device", "[device][normals]") {
  for (const int dimension : {2, 3}) {
    const bool flat = dimension == 2;
    Mix mix;
    mix.dimension = dimension, mix.contact = by_particles;
    mix.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
    mix.overrides = {
        set("/grid/domain", flat ? "[[0, 0], [0.8, 0.7]]" : "[[0, 0, 0], [0.7, 0.5, 0.5]]"),
        set("/bodies", "[" +
                           box("a", flat ? "[0.55, 0.15]" : "[0.5, 0.1, 0.1]",
                               flat ? "[0.795, 0.55]" : "[0.695, 0.4, 0.4]", flat ? "[0.4, 0.1]" : "[0.4, 0.1, 0]") +
                           ", " +
                           box("b", flat ? "[0.01, 0.15]" : "[0.01, 0.1, 0.1]",
                               flat ? "[0.25, 0.55]" : "[0.2, 0.4, 0.4]", flat ? "[-0.1, -0.1]" : "[-0.1, -0.1, 0.1]") +
                           "]")};
    check_meeting(mix, precisions_in_turn(false, static_cast<std::size_t>(dimension)));
  }
}

TEST_CASE("bodies meet before walls, whose mirror nodes see, on the host-run device", "[device][normals]") {
  std::size_t turn = 0;
  for (const std::string wall : {"slip", "stick", "separate"})
    for (const int dimension : {2, 3}) {
      if (dimension == 3 && wall != "slip") continue;
      const bool flat = dimension == 2;
      Mix mix;
      mix.dimension = dimension, mix.contact = by_particles;
      mix.boundaries = R"({"all": ")" + wall + R"("})";
      mix.overrides = {
          set("/grid/domain", flat ? "[[0, 0.2], [1.1, 0.7]]" : "[[0, 0.2, 0.1], [0.9, 0.6, 0.5]]"),
          set("/bodies", "[" +
                             box("a", flat ? "[0.2, 0.2]" : "[0.2, 0.2, 0.1]",
                                 flat ? "[0.51, 0.6]" : "[0.41, 0.5, 0.4]", flat ? "[0.5, 0]" : "[0.5, 0, 0]") +
                             ", " +
                             box("b", flat ? "[0.53, 0.2]" : "[0.43, 0.2, 0.1]",
                                 flat ? "[0.81, 0.6]" : "[0.61, 0.5, 0.4]", flat ? "[0.1, 0]" : "[0.1, 0, 0]") +
                             "]")};
      check_meeting(mix, precisions_in_turn(false, turn++));
    }
}

TEST_CASE("three fields meet, one of two bodies, and look at particles on the host-run device", "[device][normals]") {
  for (const std::string& contact :
       {by_particles, std::string(R"({"type": "coulomb", "normal": "linear_regression"})")}) {
    Mix mix;
    mix.contact = contact;
    const std::string together = R"(, "field": "left")";
    mix.overrides = {set("/bodies", "[" + box("a", "[0.2, 0.2]", "[0.5175, 0.39]", "[1.4, 0]", together) + ", " +
                                        box("b", "[0.52, 0.2]", "[0.8, 0.45]", "[1.1, 0.1]") + ", " +
                                        box("c", "[0.2, 0.41]", "[0.5175, 0.6]", "[1.4, 0]", together) + ", " +
                                        box("d", "[0.52, 0.455]", "[0.8, 0.7]", "[1.1, -0.1]") + "]")};
    REQUIRE(device_experiment(mix.text(), "double", mix.overrides).field_count == 3);
    check_meeting(mix, {"double", "float"});
  }
}

TEST_CASE("rows that are too short for the particles near a node change no bit", "[device][normals]") {
  for (const std::string normal : {"widest_gap", "linear_regression", "logistic_regression"})
    for (const int dimension : {2, 3}) {
      if (dimension == 3 && normal != "widest_gap") continue;
      INFO(normal << ", " << dimension << "-D");
      Mix mix;
      mix.dimension = dimension;
      mix.contact = R"({"type": "coulomb", "friction": 0.2, "normal": ")" + normal + "\"}";
      const auto whole = run_with_row(mix, -1);
      for (const int row : {0, 7, 20}) CHECK((run_with_row(mix, row) == whole));
    }
}

TEST_CASE("scenes whose contact looks at no particle have nothing of it in their program", "[device][normals]") {
  Mix mix;
  const auto composition = [&](const std::string& contact, const std::string& shape) {
    mix.contact = contact, mix.shape = shape;
    return device::compose(device_choice_of(device_experiment(mix.text(), "double")));
  };
  const auto has = [](const device::Composition& found, const std::string& phase) {
    return std::count(found.entries.begin(), found.entries.end(), phase) > 0;
  };
  const std::string tensor = R"({"type": "bspline_quadratic"})", list = R"({"type": "cpdi"})";
  for (const std::string contact : {R"({"type": "coulomb"})", R"({"type": "stick"})"}) {
    const device::Composition found = composition(contact, list);
    CHECK_THAT(found.text, !ContainsSubstring("NodeCloud"));
    for (const char* phase : {"mpm_find_meeting_nodes", "mpm_look_at_particles", "mpm_find_reach"})
      CHECK_FALSE(has(found, phase));
  }
  for (const std::string& shape : {tensor, list}) {
    const device::Composition found = composition(by_particles, shape);
    CHECK_THAT(found.text, ContainsSubstring("NodeCloud"));
    CHECK(has(found, "mpm_find_meeting_nodes"));
    CHECK(has(found, "mpm_look_at_particles"));
    CHECK(has(found, "mpm_find_reach") == (shape == list));
  }
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

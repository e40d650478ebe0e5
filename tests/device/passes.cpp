// What a step does beside its plugins: walls, images, orders of the step, contact, filters, teams, failures.

#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const Plugin& plugin(mpm_kind kind, const std::string& id) {
  const Plugin* found = plugins().find(kind, id);
  REQUIRE(found);
  return *found;
}

const std::vector<std::string> orders{"last", "first", "modified_last", "averaged"};

const std::vector<std::string> around{set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};

/// Shapes of each form around an axis with contact, in each order of the stress update.
void check_axisymmetric_shapes(bool both_precisions) {
  std::size_t turn = 0;
  for (const std::string shape : {"linear", "cpdi", "gimp_contiguous"}) {
    ++turn;  // beside one for each order, so that an order has each precision
    for (const std::string& order : orders) {
      Mix mix = mix_with(plugin(MPM_CONTACT, "coulomb"), 2);
      mix.shape = "{\"type\": \"" + shape + "\"}", mix.stress_update = order, mix.overrides = around;
      // Rings that grow and cross cells of linear functions are inverted soon, on either backend.
      if (shape == "linear") mix.overrides.emplace_back("/solver/end_time=0.045");
      mix.transfer = order == "last" ? R"({"type": "mls"})" : R"({"type": "flip"})";
      check_on_device(mix, precisions_in_turn(both_precisions, turn++));
    }
  }
}

}  // namespace

TEST_CASE("walls, open sides and periodic images on the host-run device", "[device]") {
  const std::vector<std::string> boundaries{
      R"({"all": "slip"})",
      R"({"all": "stick"})",
      R"({"all": "separate"})",
      R"({"all": "slip", "x_min": "free", "y_max": "free"})",
      R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})",
      R"({"all": "stick", "y_min": "periodic", "y_max": "periodic", "x_min": "separate"})"};
  for (const int dimension : {2, 3})
    for (const std::string& boundary : boundaries)
      for (const std::string& order : orders) {
        if (dimension == 3 && order == "first") continue;  // 2-D has all orders
        Mix mix = mix_with(plugin(MPM_CONTACT, "coulomb"), dimension);
        mix.boundaries = boundary, mix.stress_update = order, mix.close = true;
        mix.transfer = R"({"type": "flip"})";
        check_on_device(mix);
      }
}

TEST_CASE("lists of nodes beyond walls on the host-run device", "[device]") {
  for (const Plugin* shape : plugins().of_kind(MPM_SHAPE)) {
    if (shape->shape().form != MPM_NODE_LIST) continue;
    for (const std::string& order : orders) {
      Mix mix = mix_with(*shape, 2);
      mix.stress_update = order, mix.close = true;
      check_on_device(mix);
      mix.boundaries = R"({"all": "stick", "x_min": "periodic", "x_max": "periodic"})";
      check_on_device(mix);
    }
  }
}

TEST_CASE("lists of nodes that reach beyond a block's tile on the host-run device", "[device]") {
  for (const Plugin* shape : plugins().of_kind(MPM_SHAPE)) {
    if (shape->shape().form != MPM_NODE_LIST) continue;
    Mix mix = mix_with(*shape, 2);
    std::string text = mix.text();
    const auto replace = [&](const std::string& from, const std::string& to) {
      const std::size_t at = text.find(from);
      REQUIRE(at != text.npos);
      text.replace(at, from.size(), to);
    };
    // The body has one soft particle a cell and is pulled to more than twice its length: semi-sides of more than a
    // cell.
    replace("\"youngs_modulus\": 1000", "\"youngs_modulus\": 1");
    replace("\"name\": \"a\",", "\"name\": \"a\", \"particles_per_cell_axis\": 1,");
    replace("1.4-0.9*(y-0.43)", "2.4+16*(x-0.31)");
    Scene reference(text, {set("/backend", "reference"), set("/precision", "double")});
    reference.run();
    const BodyState stretched = reference.body(0);
    const std::vector<double>& domain = stretched.domain.empty() ? stretched.corners : stretched.domain;
    REQUIRE(*std::max_element(domain.begin(), domain.end()) > 1.5 * reference.experiment.grid.cell_size);
    for (const std::string precision : {"double", "float"}) {
      DeviceScene scene(text, precision);
      scene.run();
      CHECK(scene_difference(reference, scene) <= device_bound(mix) * epsilon_of(precision));
    }
  }
}

TEST_CASE("filters with walls, contact, every schedule and order on the host-run device", "[device]") {
  REQUIRE(plugins().of_kind(MPM_FILTER).size() >= 2);
  for (const Plugin* filter : plugins().of_kind(MPM_FILTER))
    for (const std::string constraints : {"every_increment", "kept_impulses", "at_end"})
      for (const std::string& order : orders) {
        Mix mix = mix_with(plugin(MPM_CONTACT, "coulomb"), 2);
        std::string choice = device_choice(*filter);
        choice.insert(choice.size() - 1, R"(, "constraints": ")" + constraints + "\"");
        mix.more += ", \"filter\": " + choice;
        mix.transfer = R"({"type": "flip"})", mix.stress_update = order, mix.close = true;
        mix.boundaries = R"({"all": "slip", "x_max": "separate"})";
        check_on_device(mix);
      }
}

TEST_CASE("the filter's norms on the host-run device are those of the reference backend", "[device]") {
  Mix mix = mix_with(plugin(MPM_FILTER, "fmpm"), 2);
  const std::string text = mix.text();
  Scene reference(text, {set("/backend", "reference"), set("/precision", "double")});
  DeviceScene scene(text, "double", {17, true});
  reference.run_steps(6);
  for (int k = 0; k < 6; ++k) scene.simulation.step();
  const FilterRecord& expected = reference.simulation.backend().filter_record();
  const FilterRecord& found = scene.simulation.backend().filter_record();
  CHECK(found.iterations == 2);
  CHECK(found.iterations == expected.iterations);
  CHECK(found.first_norm == Approx(expected.first_norm).epsilon(1e-12));
  CHECK(found.last_norm == Approx(expected.last_norm).epsilon(1e-12));
  CHECK(expected.last_norm > 0);
}

TEST_CASE("contact forces on the host-run device are those of the reference backend", "[device]") {
  Mix mix = mix_with(plugin(MPM_CONTACT, "stick"), 2);
  mix.close = true;
  for (const std::string transfer : {"apic", "flip"})
    for (const std::string filter : {"", R"({"type": "fmpm", "order": 4})", R"({"type": "xpic", "order": 2})"}) {
      mix.transfer = R"({"type": ")" + transfer + R"("})", mix.filter = filter;
      if (is_refused(mix)) continue;
      INFO(transfer << " " << filter);
      const std::string text = mix.text();
      Scene reference(text, {set("/backend", "reference"), set("/precision", "double")});
      DeviceScene scene(text, "double");
      reference.run();
      scene.run();
      const ContactRecord& expected = reference.simulation.backend().contact_record();
      const ContactRecord& found = scene.simulation.backend().contact_record();
      REQUIRE(expected.nodes > 0);
      CHECK(found.nodes == expected.nodes);
      CHECK(found.sticking == expected.sticking);
      for (int c = 0; c < 2; ++c) CHECK(found.force[c] == Approx(expected.force[c]).epsilon(1e-9));
    }
}

TEST_CASE("automatic time steps on the host-run device are those of the reference backend", "[device]") {
  Mix mix = mix_with(plugin(MPM_MATERIAL, "neo_hookean"), 2);
  std::string text = mix.text();
  const std::size_t at = text.find("\"time_step\": 0.009");
  REQUIRE(at != text.npos);
  text.replace(at, 18, "\"time_step\": \"auto\"");
  Scene reference(text, {set("/backend", "reference"), set("/precision", "double")});
  DeviceScene scene(text, "double");
  reference.run();
  scene.run();
  REQUIRE(reference.simulation.steps() > 8);  // the run is past a second estimate
  CHECK(scene.simulation.steps() == reference.simulation.steps());
  CHECK(scene_difference(reference, scene) <= 1e3 * 0x1p-52);
}

TEST_CASE("bodies of different materials run in one composition", "[device]") {
  const auto materials = plugins().of_kind(MPM_MATERIAL);
  REQUIRE(materials.size() >= 2);
  Mix mix = mix_with(*materials[0], 2);
  std::string text = mix.text();
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != text.npos);
    text.replace(at, from.size(), to);
  };
  replace("\"materials\": {", "\"materials\": {\"n\": " + device_choice(*materials[1]) + ", ");
  replace(R"("name": "b", "material": "m")", R"("name": "b", "material": "n")");
  Scene reference(text, {set("/backend", "reference"), set("/precision", "double")});
  DeviceScene scene(text, "double");
  reference.run();
  scene.run();
  CHECK(scene_difference(reference, scene) <= 1e3 * 0x1p-52);
}

TEST_CASE("teams of any size and order give the same result", "[device]") {
  for (const int dimension : {2, 3}) {
    Mix mix = mix_with(plugin(MPM_FILTER, "xpic"), dimension);
    mix.contact = R"({"type": "coulomb", "friction": 0.2})", mix.close = true;
    mix.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
    const std::string text = mix.text();
    DeviceScene one(text, "double", {1});
    one.run();
    for (const TeamShape team : {TeamShape{1, TeamShape::downwards},
                                 {3, TeamShape::upwards},
                                 {32, TeamShape::downwards},
                                 {32, TeamShape::shuffled(0)},
                                 {256, TeamShape::downwards},
                                 {96, TeamShape::shuffled(1)}}) {
      DeviceScene many(text, "double", team);
      many.run();
      INFO(dimension << "-D, " << team.lanes << " lanes in order " << team.order);
      CHECK(scene_difference(one, many) <= 1e2 * 0x1p-52);
    }
  }
}

TEST_CASE("a particle that cannot go on stops a run on the host-run device", "[device]") {
  SECTION("it leaves the domain through an open side") {
    Mix mix = mix_with(plugin(MPM_TRANSFER, "pic"), 2);
    mix.boundaries = R"({"all": "free"})", mix.close = true;
    std::string text = mix.text();
    text.replace(text.find("\"end_time\": 0.126"), 17, "\"end_time\": 0.9");
    DeviceScene scene(text, "double");
    CHECK_THROWS_WITH(scene.run(), ContainsSubstring("left the domain"));
  }
  SECTION("a deformation of no positive volume") {
    Mix mix = mix_with(plugin(MPM_MATERIAL, "linear_elastic"), 2);
    std::string text = mix.text();
    text.replace(text.find("1.4-0.9*(y-0.43)"), 16, "1.4-900*(x-0.31)");
    DeviceScene scene(text, "double");
    CHECK_THROWS_WITH(scene.run(), ContainsSubstring("inverted"));
  }
}

TEST_CASE("the host-run device refuses a team that shared memory has no room for", "[device]") {
  const Mix mix = mix_with(plugin(MPM_TRANSFER, "pic"), 2);
  CHECK_THROWS_WITH(DeviceScene(mix.text(), "double", {257}), ContainsSubstring("256 lanes"));
}

TEST_CASE("axisymmetric scenes and frozen bodies on the host-run device", "[device][axisymmetric]") {
  for (const Plugin* material : plugins().of_kind(MPM_MATERIAL)) {
    Mix mix = mix_with(*material, 2);
    mix.overrides = around;
    check_on_device(mix);
  }
  check_axisymmetric_shapes(false);
  Mix mix = mix_with(plugin(MPM_SHAPE, "cpdi"), 2);
  mix.overrides = {set("/gravity", "[0, 0]"), set("/bodies/0/frozen", "true")};
  check_on_device(mix);
}

TEST_CASE("axisymmetric shapes on the host-run device in both precisions", "[device][axisymmetric][slow]") {
  check_axisymmetric_shapes(true);
}

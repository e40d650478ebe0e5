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
      CHECK(found[k].largest_gap == Approx(expected[k].largest_gap).epsilon(1e-8).margin(1e-12));
      CHECK(found[k].normal_impulse == Approx(expected[k].normal_impulse).epsilon(1e-8).margin(1e-8));
      for (std::size_t c = 0; c < 3; ++c) {
        CHECK(found[k].impulse[c] == Approx(expected[k].impulse[c]).epsilon(1e-8).margin(1e-8));
        CHECK(found[k].tangential_impulse[c] == Approx(expected[k].tangential_impulse[c]).epsilon(1e-8).margin(1e-8));
      }
    }
  }
}

TEST_CASE("a pair's unbalanced impulse by own normals, and the gap where a law acts, are those of the reference") {
  for (const std::string contact :
       {R"({"type": "coulomb", "friction": 0.2, "normal": "own_gradient"})",
        R"({"type": "adhesion", "normal_strength": 1e9, "shear_strength": 1e9, "reach": 1})"}) {
    INFO(contact);
    Mix mix;
    mix.contact = contact, mix.close = true;
    mix.more = R"(, "output": {"contact_pairs": true})";
    Scene reference(mix.text(), {"/backend=reference", "/precision=double"});
    DeviceScene device(mix.text(), "double");
    double gained = 0, gap = 0;
    while (!reference.simulation.finished()) {
      reference.simulation.step(), device.simulation.step();
      const PairRecord &expected = reference.simulation.backend().contact_pairs().at(0),
                       &found = device.simulation.backend().contact_pairs().at(0);
      for (std::size_t c = 0; c < 3; ++c) {
        gained = larger(gained, std::abs(expected.unbalanced_impulse[c]));
        CHECK(found.unbalanced_impulse[c] == Approx(expected.unbalanced_impulse[c]).epsilon(1e-7).margin(1e-9));
      }
      gap = larger(gap, expected.largest_gap);
      CHECK(found.largest_gap == Approx(expected.largest_gap).epsilon(1e-7).margin(1e-10));
    }
    CHECK((contact.find("own") == std::string::npos || gained > 1e-4));
    CHECK((contact.find("adhesion") == std::string::npos || gap > 0));
  }
}

TEST_CASE("the nodes where bodies meet are those of the reference backend, in every step that is observed") {
  const std::vector<std::string> noting{"/output/frames=2", "/output/contact_nodes=true"};
  const auto same = [](Simulation& expected, Simulation& found) {
    using Key = std::tuple<int, int, std::array<int, 3>>;
    const auto by_place = [](const std::vector<ContactNode>& nodes) {
      std::map<Key, ContactNode> sorted;
      for (const ContactNode& node : nodes) sorted[{node.a, node.b, node.node}] = node;
      CHECK(sorted.size() == nodes.size());
      return sorted;
    };
    const auto of_reference = by_place(expected.backend().contact_nodes()),
               of_device = by_place(found.backend().contact_nodes());
    REQUIRE(of_device.size() == of_reference.size());
    CHECK(!of_device.empty());
    for (const auto& [place, node] : of_reference) {
      REQUIRE(of_device.count(place) == 1);
      const ContactNode& other = of_device.at(place);
      CHECK(other.status == node.status);
      CHECK(other.area == Approx(node.area).epsilon(1e-10));
      CHECK(other.separation == Approx(node.separation).margin(1e-12));
      for (std::size_t c = 0; c < 3; ++c) {
        CHECK(other.normal[c] == Approx(node.normal[c]).margin(1e-9));
        CHECK(other.force[c] == Approx(node.force[c]).epsilon(1e-8).margin(1e-6));
      }
    }
  };
  for (const auto& [transfer, filter] : stacked_schemes()) {
    INFO(transfer << filter);
    const std::string text = stacked_blocks("reference", transfer, filter, "[0.3, -0.2]");
    std::vector<std::string> overrides = noting;
    overrides.emplace_back(R"(/contact={"type": "stick"})");  // faces without a gap touch or not by rounding
    Scene reference(text, overrides);
    DeviceScene device(text, "double", {}, overrides);
    // Steps that nobody looks at leave no nodes, and come to run as one graph.
    for (Simulation* const simulation : {&reference.simulation, &device.simulation})
      simulation->observe_when([](double, long step) { return step % 4 == 0; });
    for (int k = 1; k <= 16; ++k) {
      reference.simulation.step(), device.simulation.step();
      if (k % 4 == 0) same(reference.simulation, device.simulation);
    }
  }
}

TEST_CASE("the error of a pair's normals is that of the reference backend", "[device]") {
  Mix mix;
  mix.contact = R"({"type": "coulomb", "friction": 0.2, "normal": "mass_gradient"})", mix.close = true;
  mix.more = R"(, "output": {"contact_pairs": true, "normal_error": true})";
  const auto errors = [](auto&& scene) {
    while (!scene.simulation.finished()) scene.simulation.step();
    std::map<std::string, double> found;
    for (const auto& [name, value] : chosen(scene.metrics))
      if (name.ends_with("normal error") || name.ends_with("misfit")) found[name] = value;
    return found;
  };
  const auto expected = errors(Scene(mix.text(), {"/backend=reference", "/precision=double"}));
  CHECK(expected.size() == 3);
  for (const std::string precision : {"double", "float"})
    for (const auto& [name, value] : errors(DeviceScene(mix.text(), precision))) {
      INFO(name << ", " << precision);
      CHECK(value > 0);
      CHECK(value == Approx(expected.at(name)).epsilon(precision == "double" ? 1e-6 : 0.01));
    }
}

TEST_CASE("adhesion that holds and gives way on the host-run device", "[device]") {
  const std::string weak = R"({"type": "adhesion", "normal_strength": 300, "shear_strength": 200, "friction": 0.2})";
  for (const int dimension : {2, 3}) {
    Mix mix;
    mix.dimension = dimension, mix.contact = weak;
    check_on_device(mix, {"double"});
  }
  Mix walls;
  walls.contact = weak, walls.close = true, walls.boundaries = R"({"all": "separate"})";
  walls.filter = R"({"type": "fmpm", "order": 2})";
  check_on_device(walls, {"double"});
}

TEST_CASE("glue that breaks on the host-run device", "[device]") {
  const std::string weak =
      R"({"type": "breakable_glue", "tension_stiffness": 1e4, "compression_stiffness": 5e4, "shear_stiffness": 2e4,
          "normal_strength": 60, "shear_strength": 90, "friction": 0.2})";
  for (const int dimension : {2, 3}) {
    Mix mix;
    mix.dimension = dimension, mix.contact = weak;
    check_on_device(mix, {"double"});
  }
  Mix walls;
  walls.contact = weak, walls.close = true, walls.boundaries = R"({"all": "separate"})";
  walls.filter = R"({"type": "fmpm", "order": 2})";
  check_on_device(walls, {"double"});
}

TEST_CASE("glue that was saved on the host-run device goes on there bit for bit", "[device]") {
  Mix mix;
  mix.contact =
      R"({"type": "breakable_glue", "tension_stiffness": 1e4, "compression_stiffness": 5e4, "shear_stiffness": 2e4,
          "normal_strength": 60, "shear_strength": 90, "friction": 0.2})";
  DeviceScene whole(mix.text(), "double"), resumed(mix.text(), "double");
  for (int k = 0; k < 7; ++k) whole.simulation.step();
  ArchiveWriter writer;
  whole.simulation.save(writer);
  for (int k = 0; k < 7; ++k) whole.simulation.step();
  ArchiveReader reader(writer.bytes());
  resumed.simulation.restore(reader);
  for (int k = 0; k < 7; ++k) resumed.simulation.step();
  for (const int body : {0, 1}) {
    const BodyState a = whole.simulation.backend().body_state(body), b = resumed.simulation.backend().body_state(body);
    CHECK(a.position == b.position);
    CHECK(a.host_state == b.host_state);
  }
}

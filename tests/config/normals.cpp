// The contact normal and the detection as the file chooses them: by a word or with parameters, and what is refused by name.

#include "experiment/contact_settings.hpp"
#include "plan/plan.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;

namespace {

/// Two bodies that meet, with plugins as they are built.
std::string scene(const std::string& contact, const std::string& more = "", int dimension = 2) {
  const bool flat = dimension == 2;
  return R"({"title": "t", "dimension": )" + std::to_string(dimension) + R"(, "backend": "reference",
    "grid": {"cell_size": 0.1, "domain": )" +
         (flat ? "[[0, 0], [1, 1]]" : "[[0, 0, 0], [1, 1, 1]]") + R"(},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "contact": )" +
         contact + more + R"(,
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [
      {"name": "a", "material": "m", "geometry": {"type": "ball", "centre": )" +
         (flat ? "[0.3, 0.5]" : "[0.3, 0.5, 0.5]") + R"(, "radius": 0.2}},
      {"name": "b", "material": "m", "geometry": {"type": "ball", "centre": )" +
         (flat ? "[0.7, 0.5]" : "[0.7, 0.5, 0.5]") + R"(, "radius": 0.2}}],
    "solver": {"time_step": 1e-3, "end_time": 0.1}})";
}

/// What is said of a scene when it is read and planned; "accepted" where nothing is.
std::string refusal(const std::string& text) {
  try {
    make_plan(test::experiment_from(text));
    return "accepted";
  } catch (const InputError& error) {
    return error.what();
  }
}

std::string with(const std::string& normal) {
  return R"({"type": "coulomb", "friction": 0.3, "normal": )" + normal + "}";
}

const Field* node_field(const Experiment& experiment, const char* id, Plan& plan) {
  plan = make_plan(experiment);
  return plan.node_field(id);
}

}  // namespace

TEST_CASE("every normal is chosen by a word, or with its parameters", "[normals]") {
  for (const Plugin* plugin : test::plugins().of_kind(MPM_NORMAL)) {
    const std::string id(plugin->id());
    INFO(id);
    if (id == "given") continue;
    CHECK(test::experiment_from(scene(with("\"" + id + "\""))).contact_normal->plugin == plugin);
    CHECK(test::experiment_from(scene(with("{\"type\": \"" + id + "\"}"))).contact_normal->plugin == plugin);
  }
  const Experiment standard = test::experiment_from(scene(R"({"type": "coulomb"})"));
  CHECK(standard.contact_normal->plugin->id() == "average_volume_gradient");
  CHECK(standard.resolved["contact"]["normal"] == "average_volume_gradient");
  const Experiment given = test::experiment_from(scene(with(R"({"type": "given", "x": 3, "y": 4})")));
  CHECK(given.contact_normal->parameter("y") == 4);
  CHECK(given.resolved["contact"]["normal"]["z"] == 0);
  const Experiment fitted = test::experiment_from(scene(with(R"({"type": "linear_regression", "penalty": 1e-3})")));
  CHECK(fitted.contact_normal->parameter("penalty") == 1e-3);
}

TEST_CASE("what is no normal, or cannot be one, is refused by name", "[normals]") {
  const auto says = [](const std::string& text, const std::string& part) {
    INFO(text);
    CHECK_THAT(refusal(text), ContainsSubstring(part));
  };
  says(scene(with("\"widest_gab\"")),
       "/contact/normal: unknown contact normal \"widest_gab\"; did you mean \"widest_gap\"?");
  says(scene(with("\"mass_gradients\"")), "did you mean \"mass_gradient\"?");
  says(scene(with("3")),
       "/contact/normal: expected a string or an object with \"type\" (contact normal), got the number 3");
  says(scene(with("\"given\"")),
       "/contact/normal: contact normal \"given\" needs \"x\": {\"type\": \"given\", \"x\": …}");
  says(scene(with(R"({"type": "given", "x": 1})")), "/contact/normal/y");
  says(scene(with(R"({"type": "given", "x": 0, "y": 0})")),
       "/contact/normal: contact normal \"given\" gives no direction: its components are all zero");
  says(scene(with(R"({"type": "given", "x": 0, "y": 0, "z": 1})")), "gives no direction");
  CHECK(refusal(scene(with(R"({"type": "given", "x": 0, "y": 0, "z": 1})"), "", 3)) == "accepted");
  says(scene(with("\"own_gradient\""), R"(, "filter": {"type": "fmpm", "order": 2})"),
       "/contact/normal: contact normal \"own_gradient\" gives each body an impulse of its own, and a filter");
  says(scene(R"({"type": "coulomb", "normal": "own_gradient", "detection": "particle_surfaces"})"),
       "and \"particle_surfaces\" measures the gap along a normal that both share");
  says(scene(R"({"type": "stick", "normal": "mass_gradient"})"),
       "/contact/normal: \"stick\" joins bodies at every node that they share and looks at no normal");
  CHECK(refusal(scene(with("\"own_gradient\""))) == "accepted");
}

TEST_CASE("a strain cap is refused by laws and normals that a part of an impulse does not fit", "[contact]") {
  const auto says = [](const std::string& contact, const std::string& part) {
    INFO(contact);
    CHECK_THAT(refusal(scene(contact)), ContainsSubstring(part));
  };
  says(R"({"type": "stick", "strain_cap": 0.2})", "/contact/strain_cap: \"stick\" joins bodies as if they were one");
  says(R"({"type": "linear_interface", "normal_stiffness": 3e4, "strain_cap": 0.2})",
       "/contact/strain_cap: \"linear_interface\" stores energy by the whole of its impulse");
  says(R"({"type": "coulomb", "normal": "own_gradient", "strain_cap": 0.2})",
       "/contact/strain_cap: normal \"own_gradient\" gives each body an impulse of its own");
  says(R"({"type": "coulomb", "strain_cap": 0})", "/contact/strain_cap");
  CHECK(refusal(scene(R"({"type": "coulomb", "strain_cap": 0.2, "normal": "widest_gap"})")) == "accepted");
  CHECK(strain_cap_of(test::experiment_from(scene(R"({"type": "coulomb", "strain_cap": 0.2})"))) == 0.2);
  CHECK(strain_cap_of(test::experiment_from(scene(R"({"type": "coulomb"})"))) == 0);
}

// Gradients of volumes make the area of contact too, whatever the normal reads.
TEST_CASE("a scene sums what its normal reads and what makes the area", "[normals]") {
  const auto sums = [](const std::string& normal, const char* id) {
    Plan plan;
    return node_field(test::experiment_from(scene(with(normal))), id, plan) != nullptr;
  };
  for (const char* normal : {"\"average_volume_gradient\"", "\"volume_gradient\"", "\"own_gradient\"", "\"widest_gap\"",
                             "\"linear_regression\"", "\"logistic_regression\""}) {
    INFO(normal);
    CHECK(sums(normal, "volume_gradient"));
    CHECK_FALSE(sums(normal, "mass_gradient"));
  }
  CHECK(sums("\"mass_gradient\"", "mass_gradient"));
  CHECK(sums("\"mass_gradient\"", "volume_gradient"));
  const std::string given = R"({"type": "given", "x": 1, "y": 0})";
  CHECK_FALSE(sums(given, "mass_gradient"));
  CHECK(sums(given, "volume_gradient"));
}

TEST_CASE("every detection is chosen by a word, or with its parameters", "[normals]") {
  const auto detected = [](const std::string& detection) {
    return test::experiment_from(scene(R"({"type": "coulomb", "friction": 0.3, "detection": )" + detection + "}"));
  };
  for (const Plugin* plugin : test::plugins().of_kind(MPM_DETECTION)) {
    const std::string id(plugin->id());
    INFO(id);
    CHECK(detected("\"" + id + "\"").contact_detection->plugin == plugin);
    CHECK(detected("\"" + id + "\"").resolved["contact"]["detection"] == id);
    CHECK(detected("{\"type\": \"" + id + "\"}").contact_detection->plugin == plugin);
  }
  const Experiment standard = test::experiment_from(scene(R"({"type": "coulomb"})"));
  CHECK(standard.contact_detection->plugin->id() == "approach_and_position");
  CHECK(standard.resolved["contact"]["detection"] == "approach_and_position");
  const Experiment fixed = detected(R"({"type": "fixed_offset", "offset": 0.67})");
  CHECK(fixed.contact_detection->parameter("offset") == 0.67);
  CHECK(fixed.resolved["contact"]["detection"]["offset"] == 0.67);
}

TEST_CASE("what is no detection, or reads what a normal cannot give, is refused by name", "[normals]") {
  const auto says = [](const std::string& contact, const std::string& part) {
    INFO(contact);
    CHECK_THAT(refusal(scene(contact)), ContainsSubstring(part));
  };
  says(R"({"type": "coulomb", "detection": "particle_surface"})",
       "/contact/detection: unknown contact detection \"particle_surface\"; did you mean \"particle_surfaces\"?");
  says(R"({"type": "coulomb", "detection": 0.8})",
       "/contact/detection: expected a string or an object with \"type\" (contact detection), got the number 0.8");
  says(R"({"type": "coulomb", "detection": {"type": "fixed_offset", "offset": 9}})", "/contact/detection/offset");
  says(R"({"type": "coulomb", "detection": {"type": "approach", "offset": 1}})",
       "/contact/detection/offset: unknown key \"offset\"");
  says(R"({"type": "stick", "detection": "fixed_offset"})",
       "/contact/detection: \"stick\" joins bodies at every node that they share and looks at no detection");
  CHECK(refusal(scene(R"({"type": "coulomb", "normal": "own_gradient", "detection": "fixed_offset"})")) == "accepted");
  // Laws that hold what is near have to know what is near.
  const std::string adhesion = R"({"type": "adhesion", "normal_strength": 1, "shear_strength": 1, "detection": )";
  says(adhesion + R"("approach"})",
       "/contact/detection: contact \"adhesion\" holds bodies that are near one another, and detection \"approach\" "
       "takes "
       "no gap for open; take \"approach_and_position\"");
  says(R"({"type": "breakable_glue", "tension_stiffness": 1, "compression_stiffness": 1, "shear_stiffness": 1,
           "normal_strength": 1, "shear_strength": 1, "detection": "approach"})",
       "holds bodies that are near one another");
  CHECK(refusal(scene(adhesion + R"("fixed_offset"})")) == "accepted");
}

TEST_CASE("a scene sums positions for a detection that reads them, and carries deformation for surfaces", "[normals]") {
  const auto plan_of = [](const std::string& detection, const std::string& more = "") {
    return make_plan(test::experiment_from(scene(R"({"type": "coulomb", "detection": ")" + detection + "\"}", more)));
  };
  for (const char* detection : {"approach_and_position", "fixed_offset"}) {
    INFO(detection);
    CHECK(plan_of(detection).node_field("mass_position") != nullptr);
    CHECK(plan_of(detection).particle_field(0, "deformation") == nullptr);
  }
  for (const char* detection : {"approach", "particle_surfaces"}) {
    INFO(detection);
    CHECK(plan_of(detection).node_field("mass_position") == nullptr);
  }
  CHECK(plan_of("particle_surfaces").particle_field(0, "deformation") != nullptr);
  CHECK(make_plan(test::experiment_from(scene(R"({"type": "stick"})"))).node_field("mass_position") == nullptr);
  // Beside a rigid body the edge of the material counts, whatever the detection between materials.
  CHECK(plan_of("approach", R"(, "rigid_bodies": [{"name": "floor", "geometry": {"type": "half_space",
      "point": [0, 0.2], "normal": [0, 1]}, "contact": {"type": "frictionless"}}])")
            .node_field("mass_position") != nullptr);
}

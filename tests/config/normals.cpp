// The contact normal as the file chooses it: by a word or with parameters, and what is refused by name.

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

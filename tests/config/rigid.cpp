// Rigid bodies in the file: what is read, the defaults, and what is refused with its place and a remedy.
#include "config/config_support.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The scene of two discs with one rigid body, which these keys describe.
std::vector<std::string> with(const std::string& keys) {
  return {"/rigid_bodies=[{" + keys + "}]", "/compare=null"};
}
const std::string ball = R"("geometry": {"type": "ball", "centre": [0.5, 0.4], "radius": 0.1})";
const std::string law = R"("contact": {"type": "coulomb", "friction": 0.3})";

bool says(const std::vector<std::string>& overrides, const std::string& text) {
  const std::string found = errors(two_discs, overrides);
  INFO(found);
  CHECK(found.find(text) != std::string::npos);
  return true;
}

}  // namespace

TEST_CASE("a rigid body has a geometry, a law, and rests where nothing moves it", "[config]") {
  const Experiment read = read_text(two_discs, with(ball + ", " + law));
  REQUIRE(read.rigid_bodies.size() == 1);
  const RigidBodySpecification& body = read.rigid_bodies[0];
  CHECK(body.name == "rigid_body_0");
  CHECK(body.about == Vector3{0.5, 0.4, 0});
  CHECK_FALSE(body.moves());
  CHECK(body.contact.parameter("friction") == 0.3);
  CHECK(read.supports().back().name == "rigid_body_0");
  CHECK(read.support_of_rigid_body(0) + 1 == static_cast<int>(read.supports().size()));
  CHECK(read.notes_reactions());
  CHECK(read.resolved["rigid_bodies"][0]["angular_velocity"] == 0);
  CHECK(read.resolved["rigid_bodies"][0]["contact"]["friction"] == 0.3);

  const Experiment moved = read_text(two_discs, with(ball + ", " + law +
                                                     R"(, "name": "die", "velocity": ["2*t", 1], )"
                                                     R"("angular_velocity": "3*t", "about": [0.1, 0.2])"));
  CHECK(moved.rigid_bodies[0].moves());
  CHECK(moved.rigid_bodies[0].about == Vector3{0.1, 0.2, 0});
  CHECK(moved.rigid_bodies[0].spin_at(2, 2) == Vector3{0, 0, 6});
  CHECK(moved.rigid_bodies[0].velocity({}, {}, 2) == Vector3{4, 1, 0});
  CHECK(read_text(two_discs, {"/rigid_bodies=[]"}).rigid_bodies.empty());
  CHECK_FALSE(read_text(two_discs).notes_reactions());
}

TEST_CASE("a resolved rigid body is read as it was", "[config]") {
  const auto first = read_text(two_discs, with(ball + ", " + law + R"(, "velocity": ["2*t", 1])")).resolved;
  CHECK(read_text(first.dump()).resolved == first);
}

TEST_CASE("rigid bodies that cannot be are refused", "[config]") {
  says(with(law), "/rigid_bodies/0/geometry: missing");
  says(with(ball), "/rigid_bodies/0/contact: missing");
  says(with(ball + ", " + law + R"(, "velocty": [0, 1])"), "did you mean \"velocity\"?");
  says(with(ball + R"(, "contact": {"type": "colomb"})"), "did you mean \"coulomb\"?");
  says(with(ball + R"(, "contact": {"type": "coulomb", "normal": "widest_gap"})"), "unknown key \"normal\"");
  says(with(ball + ", " + law + R"(, "velocity": ["x", 1])"), "/rigid_bodies/0/velocity/0");
  says(with(ball + ", " + law + R"(, "angular_velocity": [0, 0, 1])"), "/rigid_bodies/0/angular_velocity");
  says(with(ball + ", " + law + R"(, "name": "x_min")"), "there is already a support \"x_min\"");
  says(with(ball + ", " + law + R"(, "name": "a.b")"), "\"a.b\" is no name");
  says({R"(/rigid_bodies={"name": "a"})"}, "expected a list of rigid bodies");
}

TEST_CASE("around an axis a rigid body stays one", "[config]") {
  const auto refusal = [](const std::string& keys) -> std::string {
    try {
      experiment_from(
          R"({"dimension": 2, "grid": {"cell_size": 0.1, "symmetry": "axisymmetric", "domain": [[0, 0], [1, 1]]},
        "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
        "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0, "density": 1}},
        "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 0.5]}}],
        "rigid_bodies": [{)" +
          ball + R"(, "contact": {"type": "frictionless"})" + keys + R"(}], "solver": {"end_time": 1}})");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string along_radius = "a body that moves along its radius (x) does not stay rigid";
  CHECK(refusal(R"(, "angular_velocity": 1)").find("nothing turns in the plane of radius and axis") !=
        std::string::npos);
  CHECK(refusal(R"(, "angular_velocity": "t")").find("nothing turns") != std::string::npos);
  CHECK(refusal(R"(, "angular_velocity": 0)") == "accepted");  // as a resolved experiment has it
  CHECK(refusal(R"(, "velocity": [1, 0])").find(along_radius) != std::string::npos);
  CHECK(refusal(R"(, "velocity": ["t", 0])").find(along_radius) != std::string::npos);
  CHECK(refusal(R"(, "velocity": [0, "t"])") == "accepted");
}

TEST_CASE("rigid bodies beside a frozen body are refused", "[config]") {
  says(with(ball + ", " + law), "accepted");
  std::vector<std::string> frozen = with(ball + ", " + law);
  for (const char* more : {"/bodies/0/frozen=true", "/gravity=[0, 0]", "/contact=null"}) frozen.emplace_back(more);
  says(frozen, "it neither comes near another body nor leaves it");
}

// Names of supports, the reactions that are asked for, damping, and gravity as formulas.
#include <cmath>

#include "config/config_support.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string asks = R"(/output={"reactions": )";

std::string first_line(const std::string& errors) {
  return errors.substr(0, errors.find('\n'));
}

}  // namespace

TEST_CASE("reactions are asked for by name, or of all that hold the material", "[config]") {
  const Experiment all = read_text(two_discs, {asks + "true}", "/node_conditions/1/name=piston"});
  CHECK(all.output.reactions == std::vector<int>{0, 1, 2, 3, 6, 7});  // there is no z, and both boxes hold
  CHECK(all.supports()[7].name == "piston");
  CHECK(all.supports()[6].name == "box_0");
  const Experiment some = read_text(two_discs, {asks + R"(["y_min", "box_1"]})"});
  CHECK(some.output.reactions == std::vector<int>{2, 7});
  CHECK(some.resolved["output"]["reactions"] == nlohmann::ordered_json({"y_min", "box_1"}));
  CHECK(read_text(two_discs, {asks + "false}"}).output.reactions.empty());
  CHECK(read_text(two_discs).output.reactions.empty());
}

TEST_CASE("names that no support has, or that two have, are refused", "[config]") {
  CHECK(first_line(errors(two_discs, {asks + R"(["y_mim"]})"}))
            .find("no wall and no box of nodes that holds the material is called \"y_mim\"; did you mean \"y_min\"?") !=
        std::string::npos);
  CHECK(errors(two_discs, {asks + "3}"}).find("expected true, false or a list of strings, got the number 3") !=
        std::string::npos);
  CHECK(errors(two_discs, {"/node_conditions/0/name=x_min"}).find("there is already a support \"x_min\"") !=
        std::string::npos);
  CHECK(errors(two_discs, {"/node_conditions/0/name=box_1"}).find("there is already a support \"box_1\"") !=
        std::string::npos);
  CHECK(errors(two_discs, {"/node_conditions/0/name=a.b"}).find("\"a.b\" is no name") != std::string::npos);
  CHECK(errors(two_discs, {R"(/grid/boundaries={"all": "free"})", "/node_conditions=null", asks + "true}"})
            .find("nothing holds the material") != std::string::npos);
}

TEST_CASE("damping has a rate and a share", "[config]") {
  const Experiment experiment = read_text(two_discs, {R"(/damping={"viscous": 3, "local": 0.5})", "/compare=null"});
  CHECK(experiment.damping.viscous == 3);
  CHECK(experiment.damping.local == 0.5);
  CHECK(experiment.damping.left_of_velocity(0.1) == Approx(std::exp(-0.3)).epsilon(1e-15));
  CHECK(experiment.damping.left_of_change(0.1) == Approx((1 - std::exp(-0.3)) / 0.3).epsilon(1e-14));
  CHECK(errors(two_discs, {R"(/damping={"local": 1})"}).find("a number of at least 0 and below 1") !=
        std::string::npos);
  CHECK(errors(two_discs, {R"(/damping={"viscous": 1})"}).find("is one without damping") != std::string::npos);
}

TEST_CASE("a box that holds nothing is refused", "[config]") {
  CHECK(first_line(errors(two_discs, {"/node_conditions/1/velocity=[null, null]"})) ==
        "--set: /node_conditions/1/velocity: holds nothing: every component is null; give one a velocity (0 holds it), "
        "or take the type \"thermal\" for a box that holds a temperature alone");
}

TEST_CASE("names of bodies and fields are words, as paths and headings of results need", "[config]") {
  for (const std::string name : {"a.b", "left disc", "a/b", "a-b", "disc (1)", "a,b"})
    for (const std::string key : {"name", "field"}) {
      const std::string found = errors(two_discs, {"/bodies/0/" + key + "=\"" + name + "\""});
      INFO(found);
      CHECK(found.find("/bodies/0/" + key + ": \"" + name +
                       "\" is no name here: letters, digits and _ alone; write \"") != std::string::npos);
    }
  CHECK(errors(two_discs, {"/bodies/0/name=a.b"}).find("write \"a_b\"") != std::string::npos);
  CHECK(errors(two_discs, {R"(/bodies/0/name="")"}).find("is no name here") != std::string::npos);
  CHECK(errors(two_discs, {"/bodies/0/name=Disc_2"}) == "accepted");
}

TEST_CASE("a probe that never meets a particle is refused", "[config]") {
  const auto probe = [](const std::string& place) {
    return first_line(
        errors(two_discs, {R"(/output/probes=[{"name": "p", "quantities": ["pressure"], )" + place + "}]"}));
  };
  const std::string inside =
      " the domain, from (0, 0) to (1, 1) m, where no particle ever is; move it inside, or "
      "enlarge /grid/domain";
  const std::string at = "--set: /output/probes/0/";
  CHECK(probe(R"("nearest": [0.5, 1.5])") == at + "nearest: the point lies outside of" + inside);
  CHECK(probe(R"("place": [-0.1, 0.5])") == at + "place: the point lies outside of" + inside);
  CHECK(probe(R"("line": {"from": [2, 0], "to": [3, 0]})") == at + "line: no point of the line lies in" + inside);
  CHECK(probe(R"("section": {"point": [2, 0], "normal": [1, 0]})") ==
        at + "section: the section does not meet" + inside);
  CHECK(probe(R"("nearest": [1, 1])") == "accepted");
  CHECK(probe(R"("line": {"from": [-1, 0.5], "to": [2, 0.5]})") == "accepted");
  CHECK(probe(R"("section": {"point": [2, 0.5], "normal": [0, 1]})") == "accepted");
}

TEST_CASE("gravity may be formulas of time", "[config]") {
  const Experiment experiment = read_text(two_discs, {R"J(/gravity=["0.5", "-9.81*min(t/0.1,1)"])J", "/compare=null"});
  CHECK(experiment.gravity == Vector3{0.5, 0, 0});
  CHECK(experiment.gravity_at(0.05)[1] == Approx(-4.905).epsilon(1e-14));
  CHECK(experiment.gravity_has_potential(0));
  CHECK_FALSE(experiment.gravity_has_potential(1));
  CHECK(errors(two_discs, {R"(/gravity=[0, "x"])"}).find("\"x\" is not available here; variables are t") !=
        std::string::npos);
  CHECK(errors(two_discs, {R"(/gravity=[0, "-t"])"}).find("is one of constant gravity") != std::string::npos);
  CHECK(errors(two_discs, {R"(/gravity=[0, "1/0"])"}).find("its value is not a finite number") != std::string::npos);
}

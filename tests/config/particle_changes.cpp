// Emitters, sinks and particles that go over to another body: what is read, and what is refused by name and reason.
#include <cmath>

#include "config/config_support.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string without_exact = "/compare=null", emits = R"(/emitters=[{"body": "left", "velocity": [2, 0],
    "geometry": {"type": "box", "lower": [0.1, 0.5], "upper": [0.3, 0.6]}}])";
const std::string drains = R"(/sinks=[{"geometry": {"type": "box", "lower": [0, 0], "upper": [1, 0.1]}}])";
const std::string becomes = R"(/bodies/0/becomes={"body": "right", "when": {"quantity": "speed", "above": 2}})";
const std::string alike = "/bodies/1/particles_per_cell_axis=3";

std::string refused(std::vector<std::string> overrides) {
  overrides.insert(overrides.begin(), without_exact);
  return errors(two_discs, overrides);
}
void check_refused(const std::vector<std::string>& overrides, const std::string& words) {
  const std::string found = refused(overrides);
  INFO(found);
  CHECK(found.find(words) != std::string::npos);
}

}  // namespace

TEST_CASE("emitters, sinks and changes of material are read", "[config]") {
  const Experiment experiment = read_text(two_discs, {without_exact, emits, drains, becomes, alike});
  REQUIRE(experiment.emitters.size() == 1);
  const Emitter& emitter = experiment.emitters[0];
  CHECK(emitter.body == 0);
  CHECK(emitter.name == "emitter_0");
  CHECK(emitter.period == Approx(0.1).epsilon(1e-14));  // 0.2 m at 2 m/s
  CHECK(emitter.max_particles == 10000000);
  CHECK(std::isinf(emitter.until));
  REQUIRE(experiment.sinks.size() == 1);
  CHECK(experiment.sinks[0].body == -1);
  CHECK(experiment.sinks[0].every_steps == 10);
  REQUIRE(experiment.bodies[0].becomes);
  CHECK(experiment.bodies[0].becomes->body == 1);
  CHECK(*experiment.bodies[0].becomes->above == 2);
  CHECK(!experiment.bodies[0].becomes->below);
  CHECK(experiment.bodies[1].takes_particles_in);
  CHECK(experiment.gains_particles(0));
  CHECK(experiment.loses_particles(1));
  CHECK(experiment.changer_of_particles(1) == "/sinks/0");
  CHECK(read_text(two_discs, {without_exact}).changer_of_particles().empty());
  // What is resolved is read again.
  CHECK(errors(experiment.resolved.dump()) == "accepted");
}

TEST_CASE("the length of an emitter is that along its velocity", "[config]") {
  const Experiment experiment = read_text(two_discs, {without_exact, emits, "/emitters/0/velocity=[3, 4]"});
  // The box is 0.2 m by 0.1 m: (0.2*3 + 0.1*4)/5 m at 5 m/s.
  CHECK(experiment.emitters[0].period == Approx(0.2 / 5).epsilon(1e-14));
}

TEST_CASE("batches are due at whole periods from the start of an emitter to its end", "[config]") {
  Emitter emitter;
  emitter.from = 0.2, emitter.period = 0.1, emitter.until = 0.5;
  CHECK(emitter.batches_until(0) == 0);
  CHECK(emitter.batches_until(0.1999) == 0);
  CHECK(emitter.batches_until(0.2) == 1);
  CHECK(emitter.batches_until(0.2999) == 1);
  CHECK(emitter.batches_until(0.3) == 2);
  CHECK(emitter.batches_until(0.45) == 3);
  CHECK(emitter.batches_until(0.5) == 3);  // the one at the end is not emitted
  CHECK(emitter.batches_until(9) == 3);
  emitter.until = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 1000; ++k) {
    CHECK(emitter.batches_until(emitter.due(k)) == k + 1);
    CHECK(emitter.batches_until(emitter.due(k) - 1e-6) == k);
  }
}

TEST_CASE("emitters that cannot be are refused", "[config]") {
  check_refused({emits, "/emitters/0/body=lft"}, "there is no body \"lft\"; did you mean \"left\"?");
  check_refused({emits, "/emitters/0/velocity=[0, 0]"}, "the velocity is zero: nothing would flow");
  check_refused({emits, "/emitters/0/geometry/lower=[-0.1, 0.5]"},
                "the emitter reaches outside the domain: x from -0.1");
  check_refused({emits, R"(/emitters/0/geometry={"type": "half_space", "point": [0.5, 0.5], "normal": [0, 1]})"},
                "the region has no end along the velocity");
  check_refused({emits, R"(/emitters/0/geometry={"type": "ball", "centre": [0.5, 0.5], "radius": 1e-4})",
                 "/bodies/0/seeding=lattice"},
                "no particle lies in the emitter");
  check_refused({emits, "/emitters/0/geometry/upper=[1, 0.6]"}, "the emitter flows out of the domain along x");
  check_refused({emits, "/emitters/0/from=2", "/emitters/0/until=1"},
                "the emitter ends at 1 s, before it begins at 2 s");
  check_refused({emits, "/emitters/0/speed=2"}, "unknown key \"speed\"");
  check_refused({emits, R"(/rigid_bodies=[{"name": "plate", "contact": {"type": "coulomb"},
                             "geometry": {"type": "ball", "centre": [0.5, 0.5], "radius": 0.1}}])",
                 "/emitters/0/body=plate"},
                "\"plate\" is a rigid body, which has no particles");
}

TEST_CASE("sinks that cannot be are refused", "[config]") {
  check_refused({drains, "/sinks/0/body=middle"}, "there is no body \"middle\"");
  check_refused({drains, "/sinks/0/every_steps=0"}, "out of range");
  check_refused({drains, "/sinks/0/from=2", "/sinks/0/until=1"}, "the sink ends at 1 s, before it begins at 2 s");
}

TEST_CASE("changes of material that cannot be are refused", "[config]") {
  check_refused({becomes, "/bodies/0/becomes/body=rihgt"}, "there is no body \"rihgt\"; did you mean \"right\"?");
  check_refused({becomes, "/bodies/0/becomes/body=left"}, "would become what they are");
  check_refused({R"(/bodies/0/becomes={"body": "right", "when": {"quantity": "speed"}})"},
                "the condition has no bound: give \"above\" or \"below\"");
  check_refused({becomes, "/bodies/0/becomes/when/quantity=sped"},
                "there is no quantity \"sped\"; did you mean \"speed\"?");
  check_refused({becomes}, "have different particles_per_cell_axis");
  check_refused({becomes, R"(/materials/jelly={"type": "neo_hookean", "youngs_modulus": 1000, "density": 900})",
                 "/bodies/1/material=jelly", "/bodies/1/particles_per_cell_axis=3"},
                "a particle keeps its mass and its volume, and so its density, but the materials of \"left\" and "
                "\"right\" have 1000 and 900 kg/m^3");
}

TEST_CASE("a body may begin without particles where others give it some", "[config]") {
  CHECK(refused({"/bodies/0/geometry=null"}).find("missing key; expected a geometry") != std::string::npos);
  CHECK(refused({emits, "/bodies/0/geometry=null"}) == "accepted");
  CHECK(read_text(two_discs, {without_exact, emits, "/bodies/0/geometry=null"}).bodies[0].starts_empty);
  check_refused({emits, "/emitters/0/from=1", "/bodies/0/geometry=null", "/bodies/1/geometry=null",
                 R"(/bodies/0/becomes={"body": "right", "when": {"quantity": "speed", "above": 2}})"},
                "the scene begins without a particle");
}

TEST_CASE("what counts on particles that stay is refused beside those that do not", "[config]") {
  const std::string why = "the particles of body \"left\" do not stay the same (/emitters/0); ";
  check_refused({emits, "/bodies/0/frozen=true"}, why + "a frozen body");
  check_refused({emits, R"(/loads=[{"type": "force", "body": "left", "at": [0.2, 0.2], "force": [1, 0]}])"},
                why + "a load at points");
  check_refused({emits, R"(/output/groups=[{"name": "some", "body": "left",
                              "where": {"type": "ball", "centre": [0.2, 0.2], "radius": 0.1}}])"},
                why + "a group sums particles of the start");
  check_refused({emits, R"(/output/probes=[{"name": "one", "nearest": [0.2, 0.2], "quantities": ["speed"]}])"},
                why + "a probe of this kind follows one particle");
  check_refused({emits, "/bodies/0/initial_displacement=[\"0.01*X\", 0]"}, why + "what is emitted begins undeformed");
  const std::string law = R"(/contact={"type": "coulomb", "friction": 0.2})";
  check_refused({emits, law, "/output/contact_nodes=true"}, "the nodes of contact are those of a step");
  check_refused({emits, law, "/output/contact_pairs=true", "/output/normal_error=true"},
                "the normals of contact are those of a step");
  check_refused({emits, law, R"(/output/particles={"count": 2, "fields": ["contact_traction"]})"},
                "tractions of contact are those of a step");
  CHECK(refused({emits, law, R"(/output/particles={"count": 2, "fields": ["velocity"]})"}) == "accepted");
  check_refused({R"(/bodies/0/becomes={"body": "right", "when": {"quantity": "speed", "above": 1, "below": 2}})"},
                "every value is above 1 or below 2");
  check_refused({R"(/bodies/0/becomes={"body": "nobody", "when": "t > 1"})"},
                "/bodies/0/becomes/when: expected an object such as {\"quantity\": \"speed\", \"above\": 1}");
  check_refused({R"(/bodies/0/becomes={"body": "right", "when": {"quantity": "speed", "above": "60 kPa"}})"}, "above");
  CHECK(
      errors(two_discs, {emits}).find("exact solutions follow each particle from the start, and /emitters/0 changes") !=
      std::string::npos);
  CHECK(refused({emits, R"(/loads=[{"type": "body_force", "body": "left", "acceleration": [1, 0]}])"}) == "accepted");
  CHECK(refused({emits, R"(/output/groups=[{"name": "some", "body": "right",
                              "where": {"type": "ball", "centre": [0.8, 0.8], "radius": 0.1}}])"}) == "accepted");
}

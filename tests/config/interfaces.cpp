// Contact laws with springs and liquids: what a scene keeps for them, and what they are refused with by name.

#include <cmath>

#include "plan/plan.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;

namespace {

const std::string springs = R"({"type": "linear_interface", "normal_stiffness": 1e4, "shear_stiffness": 1e4})",
                  liquid = R"({"type": "liquid_contact", "viscosity": 1, "slip_length": 0.1})";

std::string scene(const std::string& contact, const std::string& more = "", const std::string& walls = "\"free\"") {
  return R"({"title": "t", "dimension": 2, "backend": "cpu",
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]], "boundaries": {"x_min": )" +
         walls + R"(, "x_max": )" + walls + R"(}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"})" +
         (contact.empty() ? "" : ", \"contact\": " + contact) + more + R"(,
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [
      {"name": "a", "material": "m", "geometry": {"type": "box", "lower": [0.2, 0.2], "upper": [0.5, 0.6]}},
      {"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0.5, 0.2], "upper": [0.8, 0.6]}}],
    "solver": {"time_step": 1e-3, "end_time": 0.1}})";
}

std::string refusal(const std::string& text) {
  try {
    make_plan(test::experiment_from(text));
    return "accepted";
  } catch (const InputError& error) {
    return error.what();
  }
}

std::string filtered(const std::string& constraints) {
  return R"(, "filter": {"type": "fmpm", "order": 2, "constraints": ")" + constraints + "\"}";
}

std::string beside_rigid_body(const std::string& law) {
  return scene("",
               R"(, "rigid_bodies": [{"geometry": {"type": "ball", "centre": [0.5, 0.9], "radius": 0.1}, "contact": )" +
                   law + "}]");
}

}  // namespace

TEST_CASE("displacements are summed for laws with springs alone", "[interface]") {
  const Plan with = make_plan(test::experiment_from(scene(springs)));
  REQUIRE(with.node_field("mass_displacement"));
  CHECK(with.node_field("mass_displacement")->because.find("/contact: its springs") != std::string::npos);
  REQUIRE(with.particle_field(0, "initial_position"));
  for (const std::string& law : {liquid, std::string(R"({"type": "stick"})"), std::string(R"({"type": "coulomb"})")}) {
    INFO(law);
    const Plan without = make_plan(test::experiment_from(scene(law)));
    CHECK_FALSE(without.node_field("mass_displacement"));
    CHECK_FALSE(without.particle_field(0, "initial_position"));
  }
}

TEST_CASE("laws that act over time are refused where a filter would add them again", "[interface]") {
  for (const std::string& law : {springs, liquid}) {
    CHECK(refusal(scene(law, filtered("every_increment"))) == "accepted");
    for (const char* constraints : {"kept_impulses", "at_end"}) {
      const std::string said = refusal(scene(law, filtered(constraints)));
      INFO(said);
      CHECK(said.find("/contact: contact \"") != std::string::npos);
      CHECK(said.find("take \"constraints\": \"every_increment\"") != std::string::npos);
    }
  }
  CHECK(refusal(beside_rigid_body(liquid)) == "accepted");
}

TEST_CASE("a law that reads the traction is refused where that is not measured", "[interface]") {
  const std::string glue = R"({"type": "adhesion", "normal_strength": 10, "shear_strength": 10})";
  CHECK(refusal(scene(glue)) == "accepted");
  CHECK(refusal(scene(glue, filtered("every_increment"))) == "accepted");
  for (const auto& [said, why] :
       {std::pair{refusal(scene(glue, filtered("at_end"))), "take \"constraints\": \"every_increment\""},
        std::pair{refusal(beside_rigid_body(glue)),
                  "/rigid_bodies/0/contact: contact \"adhesion\" asks for the traction around a node"},
        std::pair{refusal(scene(glue, "", "\"periodic\"")), "whose neighbours end at a periodic face"}}) {
    INFO(said);
    CHECK(said.find(why) != std::string::npos);
  }
}

TEST_CASE("a law with a state keeps it on particles and at nodes, and no other law does", "[glue]") {
  const auto glue = [](const std::string& more = "") {
    return R"({"type": "breakable_glue", "tension_stiffness": 1e4, "compression_stiffness": 5e4, "shear_stiffness": 2e4,
               "normal_strength": 10, "shear_strength": 10)" +
           more + "}";
  };
  const Plan with = make_plan(test::experiment_from(scene(glue())));
  REQUIRE(with.particle_field(1, "contact_state"));
  CHECK(with.particle_field(1, "contact_state")->components == 2);
  CHECK(with.particle_field(1, "contact_state")->because.ends_with("/contact \"breakable_glue\": glued, broken"));
  for (const char* id : {"mass_state", "mass_gain", "reached", "met"}) CHECK(with.node_field(id));
  CHECK(with.does(Act::keep_contact_state));
  const Plan without = make_plan(test::experiment_from(scene(springs)));
  for (const char* id : {"contact_state", "contact_gain"}) CHECK_FALSE(without.particle_field(1, id));
  for (const char* id : {"mass_state", "mass_gain", "reached", "met"}) CHECK_FALSE(without.node_field(id));
  CHECK_FALSE(without.does(Act::keep_contact_state));

  CHECK(refusal(scene(glue(), filtered("every_increment"))) == "accepted");
  for (const auto& [said, why] :
       {std::pair{refusal(scene(glue(), filtered("at_end"))), "take \"constraints\": \"every_increment\""},
        std::pair{refusal(beside_rigid_body(glue())),
                  "/rigid_bodies/0/contact: contact \"breakable_glue\" joins particles by springs"},
        std::pair{refusal(scene(glue(), "", "\"periodic\"")), "close the periodic axis"}}) {
    INFO(said);
    CHECK(said.find(why) != std::string::npos);
  }
  // What a particle keeps does not say towards which of two others.
  std::string three = scene(glue());
  three.insert(three.find("],\n    \"solver\""), R"(, {"name": "c", "material": "m",
      "geometry": {"type": "box", "lower": [0.2, 0.6], "upper": [0.8, 0.9]}})");
  CHECK(
      refusal(three).find("/contact: contact \"breakable_glue\" keeps a state on particles, which does not say towards "
                          "which body, and here there are 3 velocity fields") != std::string::npos);
}

// sqrt(rho h / (12 k)), with 1000 kg/m^3, 0.1 m and the stiffest of the springs.
TEST_CASE("a fixed step that glue does not stand is refused with the longest one, and automatic ones are shorter",
          "[glue]") {
  const std::string stiff = scene(
      R"({"type": "breakable_glue", "tension_stiffness": 1e7, "compression_stiffness": 5e7, "shear_stiffness": 2e7,
          "normal_strength": 10, "shear_strength": 10})");
  const std::string said = refusal(stiff);
  INFO(said);
  CHECK(said.find("/solver/time_step: contact \"breakable_glue\" stands steps of at most 0.000408248 s") !=
        std::string::npos);
  test::Scene scene(stiff, {"/solver/time_step=auto"});
  scene.simulation.step();
  CHECK(scene.simulation.largest_time_step() == Approx(std::sqrt(1000 * 0.1 / (12 * 5e7))).epsilon(1e-12));
  CHECK(scene.simulation.limited_by() == "contact");
}

TEST_CASE("the longest step that glue stands is printed so that it is not refused again", "[glue]") {
  // The limit is 0.00144337567 s, which would be rounded up.
  const std::string stiff = scene(
      R"({"type": "breakable_glue", "tension_stiffness": 4e6, "compression_stiffness": 4e6, "shear_stiffness": 4e6,
          "normal_strength": 10, "shear_strength": 10})");
  CHECK_THROWS_WITH(test::Scene(stiff, {"/solver/time_step=0.002"}),
                    ContainsSubstring("steps of at most 0.00144337 s"));
  CHECK_NOTHROW(test::Scene(stiff, {"/solver/time_step=0.00144337"}));
}

TEST_CASE("springs are refused beside rigid bodies and across periodic axes", "[interface]") {
  const std::string rigid = refusal(beside_rigid_body(springs)), periodic = refusal(scene(springs, "", "\"periodic\""));
  INFO(rigid << "\n" << periodic);
  CHECK(rigid.find("/rigid_bodies/0/contact: contact \"linear_interface\" joins particles by springs") !=
        std::string::npos);
  CHECK(periodic.find("/contact: contact \"linear_interface\" pulls by how far particles have moved") !=
        std::string::npos);
  CHECK(refusal(scene(liquid, "", "\"periodic\"")) == "accepted");
}

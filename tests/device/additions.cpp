// What a scene may hold beside plugins, all in few scenes: whatever a run of one says is what the reference backend says.

#include "device/covering.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Forces and moments on all supports in the last step, and the impulses since the run began.
std::vector<double> reaction_values(const Simulation& simulation) {
  std::vector<double> values;
  for (const Reaction& reaction : simulation.backend().reactions())
    for (const Vector3& vector : {reaction.force, reaction.moment, reaction.impulse})
      values.insert(values.end(), vector.begin(), vector.end());
  return values;
}

/// Checks a scene in double precision; what is compared beside the bodies and the ledger is relative to its own size.
void check(const Mix& mix) {
  if (!is_chosen_check()) return;
  INFO(mix.name());
  std::vector<std::string> overrides = mix.overrides;
  std::erase(overrides, deterministic_sums);
  for (const char* choice : {"/backend=reference", "/precision=double"}) overrides.emplace_back(choice);
  Scene reference(mix.text(), overrides);
  const double content = heat_content(reference);
  while (!reference.simulation.finished()) reference.simulation.step();
  DeviceScene found(mix.text(), "double", {}, mix.overrides);
  found.run();
  const double epsilon = epsilon_of("double"), bound = device_bound(mix) * epsilon;
  REQUIRE(found.simulation.steps() == reference.simulation.steps());
  CHECK(found.simulation.last_time_step() == Approx(reference.simulation.last_time_step()).epsilon(1e-9));
  CHECK(scene_difference(reference, found) <= bound);
  CHECK(book_difference(reference, found) <= bound);
  // A pair whose approach is zero to rounding, as in a filter's passes and beside held nodes, touches or not by its rounding.
  const bool own = mix.contact.find("own_gradient") != mix.contact.npos;
  if (mix.filter.empty() && !own)
    CHECK(difference(contact_counts(reference.simulation.backend(), reference.experiment),
                     contact_counts(found.simulation.backend(), found.experiment), 1.0) <= bound);
  if (content > 0) CHECK(difference(heat_ledger_values(reference), heat_ledger_values(found), content) <= bound);
  for (std::size_t body = 0; body < reference.experiment.bodies.size(); ++body) {
    const int index = static_cast<int>(body);
    CHECK(reference.body(index).initial_position == found.body(index).initial_position);
  }
  const std::vector<double> reactions = reaction_values(reference.simulation);
  REQUIRE(reactions.empty() != (mix.more.find("reactions") != mix.more.npos));
  if (!reactions.empty())
    CHECK(difference(reactions, reaction_values(found.simulation), size_of(reactions)) <= 10 * bound);
  const Totals& start = reference.metrics.initial();
  const double force = start.mass * 1.5 / reference.simulation.last_time_step(), norm = std::sqrt(start.mass) * 1.5;
  CHECK(difference(contact_values(reference, force), contact_values(found, force), 1.0) <= bound);
  CHECK(difference(filter_values(reference, norm), filter_values(found, norm), 1.0) <= bound);
  const auto unbalanced = [&](const auto& scene) {  // rounding, but where each body has a normal of its own
    return scene.simulation.backend().contact_record().momentum_residual / (start.mass * 1.5);
  };
  REQUIRE((unbalanced(reference) > 1e-6) == own);
  CHECK(std::abs(unbalanced(found) - unbalanced(reference)) <= bound);
}

}  // namespace

TEST_CASE("all that a scene may hold beside plugins does on the host-run device what it does on the reference backend",
          "[device]") {
  for (const int dimension : {2, 3})
    for (Mix mix : every_addition(dimension)) {
      check(mix);
      if (mix.close && mix.contact == R"({"type": "coulomb", "friction": 0.2})") {
        Mix own = mix;
        own.contact = R"({"type": "coulomb", "friction": 0.2, "normal": "own_gradient"})", own.filter = "";
        check(own);
      }
      if (mix.contact.find("widest_gap") == mix.contact.npos) continue;
      // A law that keeps a state, and asks for the area that nodes have found by looking at particles.
      mix.contact = R"({"type": "breakable_glue", "tension_stiffness": 1e4, "compression_stiffness": 5e4,
        "shear_stiffness": 2e4, "normal_strength": 60, "shear_strength": 90, "friction": 0.2, "normal": "widest_gap",
        "detection": "particle_surfaces"})";
      check(mix);
    }
}

// With what force a rigid corner presses a block of rubber, and how much of the work it gets back. The bounds are the
// program's own, with some room; the balance of momentum is in tests/verification/contact_extremes.cpp.

#include <cmath>

#include "support/catch.hpp"
#include "verification/shipped.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("the force on a rigid corner stays bounded, and rubber gives most of its work back", "[rigid]") {
  for (const std::string transfer : {"apic", "flip"}) {
    INFO(transfer);
    ShippedScene scene("studies/rigid_corner.json", {set("/transfer/type", transfer)});
    double most_force = 0, most_energy = 0;
    const Totals end = scene.run([&] {
      const Backend& now = scene.simulation.backend();
      const Reaction& corner = now.reactions()[static_cast<std::size_t>(scene.experiment.support_of_rigid_body(0))];
      most_force = larger(most_force, std::abs(corner.force[1]));
      most_energy = larger(most_energy, scene.metrics.measure().total_energy());
    });
    REQUIRE(scene.failure == "");
    CHECK(most_force < 1e5);
    CHECK(scene.simulation.ledger().rigid_bodies < 0.15 * most_energy);
    CHECK(end.total_energy() < 0.02 * most_energy);
  }
}

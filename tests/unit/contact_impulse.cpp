// What contact hands over in a step and the heat of its friction, by hand. FLIP with a fraction of PIC of 1/4 gives
// particles 1/4 of the grid's velocity and 3/4 of its increment.

#include "simulation/contact_impulse.hpp"

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

Experiment blended() {
  return experiment_from(R"J({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip", "pic_fraction": 0.25},
    "contact": {"type": "coulomb", "friction": 0.3},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": [0.2, 0.2], "upper": [0.4, 0.4]}},
               {"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0.4, 0.2], "upper": [0.6, 0.4]}}],
    "solver": {"time_step": 0.01, "end_time": 0.1}})J",
                         {});
}

}  // namespace

TEST_CASE("what contact gives before the forces reaches particles by the share of the velocity, with its heat",
          "[contact]") {
  const Experiment experiment = blended();
  ContactImpulse contact(experiment);
  Ledger ledger;
  contact.before_forces({{8, -4, 0}, 16, {}}, false, &ledger);
  CHECK(ledger.friction == 4);
  CHECK(ledger.friction_taken_back == 12);
  CHECK(contact.handed_over(false) == Vector3{2, -1, 0});
  contact.after_forces({{4, 8, 0}, 2, {}}, &ledger);  // a part of the increment, which particles take wholly
  CHECK(ledger.friction == 6);
  CHECK(ledger.friction_taken_back == 12);
  CHECK(contact.handed_over(false) == Vector3{6, 7, 0});
  CHECK(contact.handed_over(true) == Vector3{12, 4, 0});  // a filter gives the velocity itself
}

TEST_CASE("with a filter all heat of friction stays with the particles", "[contact]") {
  const Experiment experiment = blended();
  ContactImpulse contact(experiment);
  Ledger ledger;
  contact.before_forces({{8, -4, 0}, 16, {}}, true, &ledger);
  CHECK(ledger.friction == 16);
  CHECK(ledger.friction_taken_back == 0);
  contact.after_forces({{4, 8, 0}, 2, {}}, &ledger);
  SECTION("contact that answers to an increment adds to what it gave") {
    contact.in_filter({{1, 2, 0}, 5, {}}, false, &ledger);
    CHECK(contact.handed_over(true) == Vector3{13, 6, 0});
    CHECK(ledger.friction == 23);
  }
  SECTION("contact that answers to the whole velocity again replaces it, once and once more") {
    contact.in_filter({{1, 2, 0}, 5, {}}, true, &ledger);
    CHECK(contact.handed_over(true) == Vector3{1, 2, 0});
    CHECK(ledger.friction == 5);
    contact.in_filter({{3, 3, 0}, 6, {}}, true, &ledger);
    CHECK(contact.handed_over(true) == Vector3{3, 3, 0});
    CHECK(ledger.friction == 6);
  }
}

TEST_CASE("what is kept of contact comes back, and the correction of a filter is what it gave beyond that",
          "[contact]") {
  const Experiment experiment = blended();
  ContactImpulse contact(experiment);
  Ledger ledger;
  contact.before_forces({{8, -4, 0}, 16, {}}, true, &ledger);
  contact.keep();
  contact.in_filter({{1, 2, 0}, 5, {}}, false, &ledger);
  CHECK(contact.handed_over(true) == Vector3{9, -2, 0});
  SECTION("alone") {
    contact.restore(false);
    CHECK(contact.handed_over(true) == Vector3{8, -4, 0});
    // The heat that is replaced is that of the velocity that has come back: 21 - 16 + 1.
    contact.in_filter({{2, 2, 0}, 1, {}}, true, &ledger);
    CHECK(ledger.friction == 6);
  }
  SECTION("with the correction, which joins what the forces bring") {
    contact.restore(true);
    CHECK(contact.handed_over(true) == Vector3{8, -4, 0});
    contact.after_forces({{4, 8, 0}, 2, {}}, &ledger);
    contact.add_correction();
    CHECK(contact.handed_over(true) == Vector3{13, 6, 0});
  }
}

// What lessons 3 to 5 of docs/lessons claim, on the very files the pages name. Most numbers are the
// program's own, as printed there: they show what has changed, and are no verification.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/lesson.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string weld = R"(/contact={"type":"stick"})";

double mean_height(const Lesson& lesson, int body) {
  const BodyState state = lesson.simulation.backend().body_state(body);
  double sum = 0;
  for (std::size_t k = 1; k < state.position.size(); k += 2) sum += state.position[k];
  return sum / (0.5 * static_cast<double>(state.position.size()));
}

double largest_distance(const Lesson& a, const Lesson& b) {
  double largest = 0;
  for (int body = 0; body < 2; ++body) {
    const BodyState s = a.simulation.backend().body_state(body), t = b.simulation.backend().body_state(body);
    for (std::size_t k = 0; k < s.position.size(); ++k)
      largest = std::max(largest, std::abs(s.position[k] - t.position[k]));
  }
  return largest;
}

/// Times and sizes of an impact.
struct Impact {
  double first_strain = -1;                        ///< s at which strain energy is above a thousandth of the total
  double first_nodes = -1, last_nodes = -1;        ///< s at which the contact law acted first and last
  double largest_strain = 0, time_of_largest = 0;  ///< J/m, s
  Totals end;
};

Impact run_impact(Lesson& lesson) {
  Impact impact;
  const double initial = lesson.metrics.initial().total_energy();
  while (!lesson.simulation.finished()) {
    const Totals now = lesson.step();
    if (impact.first_strain < 0 && now.strain > 1e-3 * initial) impact.first_strain = now.time;
    if (now.strain > impact.largest_strain) impact.largest_strain = now.strain, impact.time_of_largest = now.time;
    if (lesson.simulation.backend().contact_record().nodes > 0) {
      if (impact.first_nodes < 0) impact.first_nodes = now.time;
      impact.last_nodes = now.time;
    }
  }
  impact.end = lesson.metrics.measure();
  return impact;
}

/// The bar of lesson 5 by finite differences along its own particles: no grid, no shape functions, nothing shared with
/// the program. Returns the mean position at `times`, m.
std::vector<double> bar_by_finite_differences(double speed, double modulus, double density,
                                              const std::vector<double>& times) {
  constexpr int cells = 400;
  const double dx = 1.0 / cells, dt = 0.1 * dx / std::sqrt(modulus / density);
  std::vector<double> x(cells + 1), v(cells + 1), stress(cells), means;
  for (int i = 0; i <= cells; ++i) x[i] = i * dx, v[i] = speed * x[i];
  double time = 0;
  for (const double wanted : times) {
    for (; time < wanted; time += dt) {
      for (int i = 0; i < cells; ++i) {
        const double stretch = (x[i + 1] - x[i]) / dx;
        stress[i] = 0.5 * modulus * (stretch - 1 / stretch);  // neo-Hookean stress without Poisson's effect
      }
      for (int i = 1; i < cells; ++i) v[i] += dt * (stress[i] - stress[i - 1]) / (density * dx);
      v[cells] -= dt * stress[cells - 1] / (0.5 * density * dx);
      for (int i = 1; i <= cells; ++i) x[i] += dt * v[i];
    }
    double sum = 0.5 * (x[0] + x[cells]);
    for (int i = 1; i < cells; ++i) sum += x[i];
    means.push_back(sum * dx);
  }
  return means;
}

}  // namespace

TEST_CASE("lesson 3: one field squeezes the discs before they touch, contact waits", "[lesson]") {
  const double touch = (0.6 * std::sqrt(2.0) - 0.4) / (0.2 * std::sqrt(2.0));
  CHECK(touch == Approx(1.586).margin(0.0005));

  Lesson one("two_discs_one_field");
  const Impact single = run_impact(one);
  CHECK(single.first_strain == Approx(1.431).margin(0.002));
  CHECK(single.largest_strain == Approx(2.43).margin(0.01));
  CHECK(single.time_of_largest == Approx(2.02).margin(0.01));
  CHECK(one.smallest_volume_ratio == Approx(0.556).margin(0.002));
  CHECK(kept_energy(one, single.end) == Approx(0.966).margin(0.001));

  Lesson stick("two_discs_one_field", {weld});
  const Impact welded = run_impact(stick);
  CHECK(welded.first_nodes == Approx(1.314).margin(0.002));
  CHECK(welded.last_nodes == Approx(2.78).margin(0.01));
  CHECK(largest_distance(one, stick) < 1e-12);  // "to rounding"
  CHECK(largest_distance(one, stick) > 0);      // they are two runs, not one

  Lesson contact("two_discs_contact");
  const Impact bounce = run_impact(contact);
  CHECK(bounce.first_strain == Approx(1.60).margin(0.005));
  CHECK(bounce.first_nodes > touch);
  CHECK(bounce.first_nodes == Approx(1.593).margin(0.002));
  CHECK(bounce.last_nodes == Approx(2.69).margin(0.01));
  CHECK(bounce.largest_strain == Approx(2.33).margin(0.01));
  CHECK(bounce.time_of_largest == Approx(2.10).margin(0.02));
  CHECK(contact.smallest_volume_ratio == Approx(0.746).margin(0.002));
  CHECK(kept_energy(contact, bounce.end) == Approx(0.935).margin(0.001));
}

TEST_CASE("lesson 3: a block is lifted off a contact, and not off one velocity field", "[lesson]") {
  Lesson one("lifted_block_one_field"), contact("lifted_block_contact");
  const double single = one.run().centre_of_mass[1], parted = contact.run().centre_of_mass[1];
  CHECK(single == Approx(0.310).margin(0.001));
  CHECK(parted == Approx(0.401).margin(0.001));
  CHECK(mean_height(one, 0) == Approx(0.21).margin(0.005));
  CHECK(mean_height(one, 1) == Approx(0.41).margin(0.005));
  CHECK(mean_height(contact, 0) == Approx(0.10).margin(0.005));
  CHECK(mean_height(contact, 1) == Approx(0.70).margin(0.005));
  // "Pull with 100 weights": still welded.
  Lesson hard("lifted_block_one_field",
              {"/constants/pull=100", "/grid/domain=[[0,0],[0.4,3]]", "/solver/end_time=0.66"});
  hard.run();
  CHECK(mean_height(hard, 1) - mean_height(hard, 0) == Approx(0.2).margin(0.02));
  CHECK(hard.largest_volume_ratio == Approx(1.07).margin(0.01));
}

TEST_CASE("lesson 4: higher orders lose less, in more and shorter steps", "[lesson]") {
  struct Claim {
    int order;
    double kept, step, increment;
    long steps;
  };
  std::vector<double> kept;
  for (const Claim& claim : {Claim{1, 0.519, 5.76e-3, 1.8, 608}, Claim{2, 0.873, 4.07e-3, 0.033, 870},
                             Claim{4, 0.938, 2.88e-3, 0.010, 1234}, Claim{8, 0.963, 2.04e-3, 0.005, 1748}}) {
    INFO("order " << claim.order);
    Lesson lesson("impact_fmpm", {set("/filter/order", std::to_string(claim.order))});
    lesson.step();
    CHECK(lesson.simulation.time() == Approx(claim.step).epsilon(0.003));
    double increment = 0;
    while (!lesson.simulation.finished()) {
      lesson.step();
      const FilterRecord& record = lesson.simulation.backend().filter_record();
      CHECK(record.iterations == claim.order - 1);
      if (claim.order > 1) CHECK(record.last_norm < record.first_norm);
      CHECK(record.largest_growth <= 1 + 1e-12);
      increment = std::max(increment, record.last_norm);
    }
    if (claim.order > 1) CHECK(increment == Approx(claim.increment).epsilon(0.1));
    CHECK(lesson.simulation.steps() == Approx(claim.steps).margin(2));
    CHECK(kept_energy(lesson, lesson.metrics.measure()) == Approx(claim.kept).margin(0.001));
    CHECK(lesson.largest_energy <= 1.001 * lesson.metrics.initial().total_energy());
    kept.push_back(kept_energy(lesson, lesson.metrics.measure()));
  }
  for (std::size_t k = 1; k < kept.size(); ++k) CHECK(kept[k] > kept[k - 1]);

  Lesson pic("impact_fmpm", {"/filter=null"});
  CHECK(kept_energy(pic, pic.run()) == Approx(kept[0]).epsilon(1e-12));  // order 1 is PIC
  Lesson slow("impact_fmpm", {"/filter/order=1", "/solver/courant=0.15"});
  CHECK(kept_energy(slow, slow.run()) == Approx(0.368).margin(0.001));
  Lesson flip("impact_fmpm", {"/filter=null", "/transfer/type=flip"});
  CHECK(kept_energy(flip, flip.run()) == Approx(0.940).margin(0.001));
  Lesson now_and_then("impact_fmpm", {"/filter/order=2", "/filter/every_steps=10", "/transfer/type=flip"});
  CHECK(kept_energy(now_and_then, now_and_then.run()) == Approx(0.914).margin(0.001));
}

TEST_CASE("lesson 4: a step that order 2 bears turns a particle inside out at order 8", "[lesson]") {
  Lesson two("impact_fmpm", {"/filter/order=2", "/solver/time_step=0.01"});
  CHECK(kept_energy(two, two.run()) == Approx(0.915).margin(0.002));
  Lesson eight("impact_fmpm", {"/solver/time_step=0.01"});
  CHECK_THROWS_AS(eight.run(), RunFailure);
  CHECK(eight.simulation.time() < 3.5);
}

TEST_CASE("lesson 4: with a contact law no order gains energy, a law at the end does", "[lesson]") {
  const std::string law = R"(/contact={"type":"coulomb"})";
  for (const auto& [order, left] :
       {std::pair{1, 0.439}, std::pair{2, 0.811}, std::pair{4, 0.905}, std::pair{8, 0.936}}) {
    Lesson lesson("impact_fmpm", {law, "/filter/order=" + std::to_string(order)});
    CHECK(kept_energy(lesson, lesson.run()) == Approx(left).margin(0.001));
    CHECK(lesson.largest_energy <= lesson.metrics.initial().total_energy() * (1 + 1e-9));
  }
  Lesson at_end("impact_fmpm", {law, "/filter/constraints=at_end"});
  at_end.run();
  CHECK(at_end.largest_energy / at_end.metrics.initial().total_energy() == Approx(1.013).margin(0.001));
  Lesson flip("impact_fmpm", {law, "/filter=null", "/transfer/type=flip"});
  flip.run();
  CHECK(flip.largest_energy / flip.metrics.initial().total_energy() == Approx(1.0025).margin(0.0002));
}

TEST_CASE("lesson 5: only the bar of CPDI comes back", "[lesson]") {
  const std::vector<double> exact = bar_by_finite_differences(8, 10, 1, {0.385, 0.77});
  CHECK(exact[0] == Approx(1.497).margin(0.0005));
  CHECK(exact[1] == Approx(0.467).margin(0.0015));

  const auto largest_and_last = [](Lesson& lesson) {
    double largest = 0;
    Totals now;
    while (!lesson.simulation.finished()) {
      now = lesson.step();
      largest = std::max(largest, now.centre_of_mass[0]);
    }
    return std::array{largest, now.centre_of_mass[0], kept_energy(lesson, now)};
  };
  Lesson cpdi("stretched_bar_cpdi"), fine("stretched_bar_cpdi", {"/grid/cell_size=0.05"});
  const auto coarse = largest_and_last(cpdi), finer = largest_and_last(fine);
  CHECK(coarse[0] == Approx(1.494).margin(0.001));
  CHECK(coarse[1] == Approx(0.471).margin(0.001));
  CHECK(coarse[2] == Approx(0.998).margin(0.001));
  CHECK(cpdi.largest_volume_ratio == Approx(3.95).margin(0.02));
  CHECK(finer[0] == Approx(1.496).margin(0.001));
  CHECK(finer[1] == Approx(0.468).margin(0.001));
  CHECK(std::abs(finer[0] - exact[0]) < std::abs(coarse[0] - exact[0]));
  CHECK(std::abs(finer[1] - exact[1]) < std::abs(coarse[1] - exact[1]));

  struct Claim {
    const char* shape;
    double last, kept, stretch;
  };
  for (const Claim& claim : {Claim{"linear", 3.11, 0.71, 2.37}, Claim{"bspline_quadratic", 2.57, 0.70, 3.24},
                             Claim{"gimp", 2.98, 0.73, 2.88}}) {
    INFO(claim.shape);
    Lesson torn("stretched_bar_gimp", {set("/shape/type", claim.shape)});
    const auto result = largest_and_last(torn);
    CHECK(result[1] == Approx(claim.last).margin(0.02));
    CHECK(result[2] == Approx(claim.kept).margin(0.01));
    CHECK(torn.largest_volume_ratio == Approx(claim.stretch).margin(0.05));
    if (claim.shape == std::string("gimp")) CHECK(torn.smallest_volume_ratio == Approx(0.106).margin(0.005));
  }
  Lesson finer_gimp("stretched_bar_gimp", {"/grid/cell_size=0.05"});
  CHECK(largest_and_last(finer_gimp)[1] == Approx(3.16).margin(0.03));

  // "Let the bar swing on".
  Lesson swing("stretched_bar_cpdi", {"/solver/end_time=1.2"});
  double shortest = 1;
  Totals now;
  while (!swing.simulation.finished()) {
    now = swing.step();
    shortest = std::min(shortest, now.centre_of_mass[0] / swing.metrics.initial().centre_of_mass[0]);
  }
  CHECK(shortest == Approx(0.06).margin(0.005));
  CHECK(swing.largest_energy / swing.metrics.initial().total_energy() == Approx(1.012).margin(0.001));
  CHECK(kept_energy(swing, now) == Approx(0.91).margin(0.005));
}

// What lessons 3 to 5 of docs/lessons claim, on the very files the pages name. The numbers are read from the pages. They
// are the program's own: they show what has changed, and are no verification.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/lesson.hpp"
#include "support/page.hpp"
#include "support/stretched_bar.hpp"

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
      largest = larger(largest, std::abs(s.position[k] - t.position[k]));
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

Page third("docs/lessons/3_weld_or_bounce.md");
const Claim welded_distance(third, "after # s no particle is # m away"),
    geometry(third, "The discs have a radius of # m; simple geometry says that they touch at t = # s"),
    first_shared(third, "they share a first node at # s"), first_strain(third, "and at # s a thousandth of the energy"),
    first_force(third, "With contact the first force acts at # s"),
    squeezed(third, "are squeezed to # of their volume"), flattened(third, "the smallest volume ratio is #"),
    kept_of_both(third, "one field keeps # % of it, contact # %"),
    parted_heights(third, "its centre is at # m, and the lower one stays at # m"),
    rise_together(third, "With one field both rise together by # m"),
    hard_pull(third, "with a pull of # weights the rubber stretches by # % somewhere");

Page fourth("docs/lessons/4_fmpm_order.md");
const std::vector<int> orders{1, 2, 4, 8};
const std::vector<Claim> order_rows{{fourth, "| 1 | # % | # ms | # | # |"},
                                    {fourth, "| 2 | # % | # ms | # | # |"},
                                    {fourth, "| 4 | # % | # ms | # | # |"},
                                    {fourth, "| 8 | # % | # ms | # | # |"}};
const Claim flip_row(fourth, "| FLIP | # % | # ms | # | # |"),
    steps_up(fourth, "from 1 to 2 it is # % of the energy, from 4 to 8 it is # %"),
    cost_of_eight(fourth, "Order 8 costs # times the gathers and scatters of order 1"),
    increments(fourth, "it is at most # for order 2, # for order 4 and # for order 8"),
    size_of_flight(fourth, "the discs fly with √(2 · #) = # in the same unit"),
    with_contact(fourth, "leaves #, #, # and # % at orders 1, 2, 4 and 8"),
    gain_at_end(fourth, "the total energy rises by # % in the impact before it falls"),
    half_step(fourth, "# % is left instead of # %: twice as many averages"),
    now_and_then_left(fourth, "# % is left, at little cost");

Page fifth("docs/lessons/5_large_stretch.md");
const Claim torn_places(fifth, "at t = # s it is at # m (linear), # m (B-splines) and # m (GIMP)"),
    torn_energy(fifth, "and #, # and # % of the energy are lost"), widest(fifth, "up to # times as wide"),
    torn_stretch(fifth, "stretched by more than # (linear), # (GIMP) and # (B-splines)"),
    gimp_squeezed(fifth, "some particles are squeezed to # of their volume"),
    differences(fifth, "| finite differences | # m | # m |"), coarse_row(fifth, "| CPDI, cells of 0.1 m | # m | # m |"),
    fine_row(fifth, "| CPDI, cells of 0.05 m | # m | # m |"), cpdi_kept(fifth, "CPDI keeps # % of the energy"),
    fine_gimp(fifth, "with cells of 0.05 m the centre of mass is at # m"),
    swung(fifth, "squeezed against its clamp to # % of its length"),
    swung_energy(fifth, "the energy rises by # % (the program warns), then # % are lost");

/// Share of a number, in per cent.
double per_cent(double share) {
  return 100 * share;
}

}  // namespace

TEST_CASE("lessons 3 to 5: every number of the pages is read by a test or given by the scene", "[lesson][docs]") {
  third.add_given({"they are up to three cells apart. With contact", "t = 2 s. (Each picture",
                   "From t = 0.6 s on three", "with 3 g − g = 2 g",
                   "After 0.2 s the upper block should be ½ · 2 g · (0.2 s)² = 0.4 m higher",
                   "(3 − 2) weights pull on two blocks, that is g / 2, and ½ · g / 2 · (0.2 s)² = 0.1 m"});
  fourth.add_given({"Order 1 is v = v⁺", "for orders 1, 2, 4, 8", "**Order 1 is PIC**", "only 1/√k of PIC's",
                    "with a step of 10 ms order 2 runs well, and order 8 turns",
                    "Order 4 costs eight times what FLIP costs here", "), and at order 8",
                    "Order k makes k − 1 gathers", "Half the step at order 1", "at order 8. - Filter"});
  fifth.add_given({"starts with 8 m/s", "from 0.5 m out to 1.5 m and back", "with 400 finite differences",
                   "centre of mass at 0.77 s |", "reaches up to 16 nodes in 2-D"});
  // Quantities in words: what shape functions and the method are, and what the scene sets.
  third.add_given({"A quadratic B-spline reaches one and a half cells", "reach one cell instead of one and a half"});
  fourth.add_given({"over its neighbourhood twice", "**The cost grows twice.**",
                    "has fallen to a hundredth of the first", "the noise removed in the tenth"});
  fifth.add_given({"It stretches to three times its length", "**bspline_quadratic**: up to one and a half cells"});
  for (const Page* page : {&third, &fourth, &fifth}) {
    CHECK(page->numbers_of_nobody() == std::vector<std::string>{});
    CHECK(page->words_of_nobody() == std::vector<std::string>{});
  }
}

TEST_CASE("lesson 3: one field squeezes the discs before they touch, contact waits", "[lesson]") {
  const double touch = (0.6 * std::sqrt(2.0) - 2 * geometry.number(0)) / (0.2 * std::sqrt(2.0));
  CHECK(touch == geometry[1]);

  Lesson one("two_discs_one_field");
  const Impact single = run_impact(one);
  CHECK(single.first_strain == first_strain[0]);
  CHECK(one.smallest_volume_ratio == squeezed[0]);
  CHECK(per_cent(kept_energy(one, single.end)) == kept_of_both[0]);

  Lesson stick("two_discs_one_field", {weld});
  const Impact welded = run_impact(stick);
  CHECK(welded.first_nodes == first_shared[0]);
  CHECK(stick.simulation.time() == welded_distance[0]);
  CHECK(largest_distance(one, stick) < welded_distance.number(1));
  CHECK(largest_distance(one, stick) > 0);  // they are two runs, not one

  Lesson contact("two_discs_contact");
  const Impact bounce = run_impact(contact);
  CHECK(bounce.first_nodes > touch);
  CHECK(bounce.first_nodes == first_force[0]);
  CHECK(contact.smallest_volume_ratio == flattened[0]);
  CHECK(per_cent(kept_energy(contact, bounce.end)) == kept_of_both[1]);
}

TEST_CASE("lesson 3: a block is lifted off a contact, and not off one velocity field", "[lesson]") {
  Lesson one("lifted_block_one_field"), contact("lifted_block_contact");
  const double lower = mean_height(one, 0), upper = mean_height(one, 1);
  one.run(), contact.run();
  CHECK(mean_height(one, 0) - lower == rise_together[0]);
  CHECK(mean_height(one, 1) - upper == rise_together[0]);
  CHECK(mean_height(contact, 0) == parted_heights[1]);
  CHECK(mean_height(contact, 1) == parted_heights[0]);

  Lesson hard("lifted_block_one_field", {set("/constants/pull", std::to_string(hard_pull.number(0))),
                                         "/grid/domain=[[0,0],[0.4,3]]", "/solver/end_time=0.66"});
  hard.run();
  CHECK(mean_height(hard, 1) - mean_height(hard, 0) == Approx(0.2).margin(0.02));  // still welded
  CHECK(per_cent(hard.largest_volume_ratio - 1) == hard_pull[1]);
}

TEST_CASE("lesson 4: higher orders lose less, in more and shorter steps", "[lesson]") {
  std::vector<double> kept, gathers;
  for (std::size_t row = 0; row < orders.size(); ++row) {
    const int order = orders[row];
    INFO("order " << order);
    Lesson lesson("impact_fmpm", {set("/filter/order", std::to_string(order))});
    lesson.step();
    CHECK(1e3 * lesson.simulation.time() == order_rows[row][1]);
    double increment = 0, in_flight = 0;
    while (!lesson.simulation.finished()) {
      lesson.step();
      const FilterRecord& record = lesson.simulation.backend().filter_record();
      CHECK(record.iterations == order - 1);
      if (order > 1) CHECK(record.last_norm < record.first_norm);
      CHECK(record.largest_growth <= 1 + 1e-12);
      increment = larger(increment, record.last_norm);
      if (lesson.simulation.time() < 1) in_flight = larger(in_flight, record.last_norm);
    }
    if (order > 1) CHECK(increment == increments[row - 1]);
    if (order > 1) CHECK(in_flight < 1e-12);
    const auto steps = static_cast<double>(lesson.simulation.steps());
    CHECK(steps == order_rows[row][2]);
    CHECK(order * steps == order_rows[row][3]);
    kept.push_back(kept_energy(lesson, lesson.metrics.measure()));
    gathers.push_back(order * steps);
    CHECK(per_cent(kept.back()) == order_rows[row][0]);
    CHECK(lesson.largest_energy <= 1.001 * lesson.metrics.initial().total_energy());
    CHECK(lesson.metrics.initial().total_energy() == size_of_flight[0]);
    CHECK(std::sqrt(2 * lesson.metrics.initial().total_energy()) == size_of_flight[1]);
  }
  for (std::size_t k = 1; k < kept.size(); ++k) CHECK(kept[k] > kept[k - 1]);
  CHECK(per_cent(kept[1] - kept[0]) == steps_up[0]);
  CHECK(per_cent(kept[3] - kept[2]) == steps_up[1]);
  CHECK(gathers[3] / gathers[0] == cost_of_eight[0]);

  Lesson pic("impact_fmpm", {"/filter=null"});
  CHECK(kept_energy(pic, pic.run()) == Approx(kept[0]).epsilon(1e-12));  // order 1 is PIC
  Lesson slow("impact_fmpm", {"/filter/order=1", "/solver/courant=0.15"});
  CHECK(per_cent(kept_energy(slow, slow.run())) == half_step[0]);
  CHECK(per_cent(kept[0]) == half_step[1]);
  Lesson flip("impact_fmpm", {"/filter=null", "/transfer/type=flip"});
  flip.step();
  CHECK(1e3 * flip.simulation.time() == flip_row[1]);
  CHECK(per_cent(kept_energy(flip, flip.run())) == flip_row[0]);
  const auto flip_steps = static_cast<double>(flip.simulation.steps());
  CHECK(flip_steps == flip_row[2]);
  CHECK(flip_steps == flip_row[3]);
  CHECK(gathers[2] / flip_steps == Approx(8).margin(0.5));  // "Order 4 costs eight times what FLIP costs here"
  Lesson now_and_then("impact_fmpm", {"/filter/order=2", "/filter/every_steps=10", "/transfer/type=flip"});
  CHECK(per_cent(kept_energy(now_and_then, now_and_then.run())) == now_and_then_left[0]);
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
  for (std::size_t k = 0; k < orders.size(); ++k) {
    INFO("order " << orders[k]);
    Lesson lesson("impact_fmpm", {law, "/filter/order=" + std::to_string(orders[k])});
    CHECK(per_cent(kept_energy(lesson, lesson.run())) == with_contact[k]);
    CHECK(lesson.largest_energy <= lesson.metrics.initial().total_energy() * (1 + 1e-9));
  }
  Lesson at_end("impact_fmpm", {law, "/filter/constraints=at_end"});
  at_end.run();
  CHECK(per_cent(at_end.largest_energy / at_end.metrics.initial().total_energy() - 1) == gain_at_end[0]);
  Lesson flip("impact_fmpm", {law, "/filter=null", "/transfer/type=flip"});
  flip.run();
  CHECK(flip.largest_energy / flip.metrics.initial().total_energy() == Approx(1.0025).margin(0.0002));
}

TEST_CASE("lesson 5: only the bar of CPDI comes back", "[lesson]") {
  const std::vector<double> exact = bar_by_finite_differences(8, 10, 1, {0.385, 0.77});
  CHECK(exact[0] == differences[0]);
  CHECK(exact[1] == differences[1]);

  const auto largest_and_last = [](Lesson& lesson) {
    double largest = 0;
    Totals now;
    while (!lesson.simulation.finished()) {
      now = lesson.step();
      largest = larger(largest, now.centre_of_mass[0]);
    }
    return std::array{largest, now.centre_of_mass[0], kept_energy(lesson, now)};
  };
  Lesson cpdi("stretched_bar_cpdi"), fine("stretched_bar_cpdi", {"/grid/cell_size=0.05"});
  const auto coarse = largest_and_last(cpdi), finer = largest_and_last(fine);
  CHECK(coarse[0] == coarse_row[0]);
  CHECK(coarse[1] == coarse_row[1]);
  CHECK(per_cent(coarse[2]) == cpdi_kept[0]);
  CHECK(cpdi.largest_volume_ratio == widest[0]);
  CHECK(finer[0] == fine_row[0]);
  CHECK(finer[1] == fine_row[1]);
  CHECK(std::abs(finer[0] - exact[0]) < std::abs(coarse[0] - exact[0]));
  CHECK(std::abs(finer[1] - exact[1]) < std::abs(coarse[1] - exact[1]));

  struct Torn {
    const char* shape;
    std::size_t place, lost, stretch;  ///< where the sentences of the page name the shape
  };
  for (const Torn& row : {Torn{"linear", 1, 0, 0}, Torn{"bspline_quadratic", 2, 1, 2}, Torn{"gimp", 3, 2, 1}}) {
    INFO(row.shape);
    std::vector<std::string> changes{set("/shape/type", row.shape)};
    if (row.shape == std::string("linear")) changes.emplace_back("/solver/time_step=0.001");
    Lesson torn("stretched_bar_gimp", changes);
    const auto result = largest_and_last(torn);
    CHECK(torn.simulation.time() == torn_places[0]);
    CHECK(result[1] == torn_places[row.place]);
    CHECK(per_cent(1 - result[2]) == torn_energy[row.lost]);
    CHECK(torn.largest_volume_ratio == torn_stretch[row.stretch]);
    if (row.shape == std::string("gimp")) CHECK(torn.smallest_volume_ratio == gimp_squeezed[0]);
  }
  Lesson finer_gimp("stretched_bar_gimp", {"/grid/cell_size=0.05"});
  CHECK(largest_and_last(finer_gimp)[1] == fine_gimp[0]);

  // "Let the bar swing on".
  Lesson swing("stretched_bar_cpdi", {"/solver/end_time=1.2"});
  double shortest = 1;
  Totals now;
  while (!swing.simulation.finished()) {
    now = swing.step();
    shortest = smaller(shortest, now.centre_of_mass[0] / swing.metrics.initial().centre_of_mass[0]);
  }
  CHECK(per_cent(shortest) == swung[0]);
  CHECK(per_cent(swing.largest_energy / swing.metrics.initial().total_energy() - 1) == swung_energy[0]);
  CHECK(per_cent(1 - kept_energy(swing, now)) == swung_energy[1]);
}

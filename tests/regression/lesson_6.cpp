// What lesson 6 of docs/lessons claims, on the very file that the page names. The numbers are read from the page. They
// are the program's own: they show what has changed, and are no verification.

#include <numeric>

#include "support/catch.hpp"
#include "support/heat_solutions.hpp"
#include "support/lesson.hpp"
#include "support/page.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double side = 0.16;  ///< m

double melted(const Lesson& lesson) {
  const std::vector<double> fraction = lesson.simulation.backend().body_state(0).host_state.at("melted_fraction");
  return std::accumulate(fraction.begin(), fraction.end(), 0.0) / static_cast<double>(fraction.size());
}

double height(const Lesson& lesson) {
  const BodyState state = lesson.simulation.backend().body_state(0);
  double highest = 0;
  for (std::size_t k = 1; k < state.position.size(); k += 2) highest = larger(highest, state.position[k]);
  return highest;
}

void run_to(Lesson& lesson, double time) {
  while (!lesson.simulation.finished() && lesson.simulation.time() < time) lesson.simulation.step();
}

std::vector<std::string> standing(const std::string& transfer, const std::string& cell_size) {
  return {"/materials/wax/thermal/phase_change/melted/yield_stress=20000", "/solver/end_time=0.5",
          set("/transfer/type", transfer), set("/grid/cell_size", cell_size)};
}

Page page("docs/lessons/6_melting.md");
const Claim frozen(page, "after t = # s nothing is liquid, and the heap of # mm keeps its shape"),
    neumann(page, "2 · # √(αt), which has passed # % of the block at t = # s"),
    steps_taken(page, "# of them in half a second, # times more than conduction alone would need"),
    pic_liquid(page, "the whole block is liquid after # s"),
    finer_grid(page, "more melts (# % instead of # % at t = # s)"), exact_row(page, "| exact | # % | # % |");
const std::vector<std::pair<std::string, Claim>> rows{{"pic", {page, "| PIC | # % | # % |"}},
                                                      {"apic", {page, "| APIC | # % | # % |"}},
                                                      {"flip", {page, "| FLIP | # % | # % |"}},
                                                      {"aflip", {page, "| AFLIP | # % | # % |"}}};

}  // namespace

TEST_CASE("lesson 6: every number of the page is read by a test or given by the scene", "[lesson][docs]") {
  page.add_given({"A block of wax, 160 mm wide and high",
                  "the plate is at 420 K, above the melting temperature of 330 K; then",
                  "it is at 220 K. The block starts at 300 K", "falls from 20 kPa to 50 Pa",
                  "The wax conducts 3000 W/(m K)", "stays at 330 K until it has taken its latent heat, 20 kJ/kg",
                  "(Carslaw & Jaeger 1959, sec. 11.2)", "| cells of 10 mm | cells of 5 mm |"});
  // Quantities in words: of wax, which conducts 0.3 W/(m K) or so, and of the method.
  page.add_given({"ten thousand times too much", "from one half on it has the parameters"});
  CHECK(page.numbers_of_nobody() == std::vector<std::string>{});
  CHECK(page.words_of_nobody() == std::vector<std::string>{});
}

TEST_CASE("lesson 6: the block melts, slumps and is frozen again", "[lesson][heat]") {
  Lesson lesson("melting_block"), fine("melting_block", {"/grid/cell_size=0.005"});
  CHECK(melted(lesson) == 0);
  const double before = height(lesson), heated = finer_grid.number(2);
  run_to(lesson, heated), run_to(fine, heated);
  CHECK(100 * melted(lesson) == finer_grid[1]);
  CHECK(100 * melted(fine) == finer_grid[0]);
  double last_liquid = 0;
  while (!lesson.simulation.finished()) {
    if (melted(lesson) > 0) last_liquid = lesson.simulation.time();
    lesson.simulation.step();
    if (lesson.simulation.time() > frozen.number(0)) CHECK(1000 * height(lesson) == frozen[1]);
  }
  CHECK(last_liquid == frozen[0]);
  CHECK(height(lesson) < 0.7 * before);
  CHECK(melted(lesson) == 0);
}

TEST_CASE("lesson 6: the front of a block that stands is Neumann's, but for PIC", "[lesson][heat]") {
  const ConductingPhase wax{3000, 1000, 900};
  const StefanProblem exact{wax, wax, 20e3, 420, 330, 300};
  const double end = neumann.number(2), front = exact.front(end) / side;
  CHECK(exact.lambda() == neumann[0]);
  for (const Approx& printed : {neumann[1], exact_row[0], exact_row[1]}) CHECK(100 * front == printed);
  for (const auto& [transfer, row] : rows) {
    INFO(transfer);
    Lesson coarse("melting_block", standing(transfer, "0.01")), fine("melting_block", standing(transfer, "0.005"));
    run_to(coarse, end), run_to(fine, end);
    CHECK(100 * melted(coarse) == row[0]);
    CHECK(100 * melted(fine) == row[1]);
    if (transfer != "pic") CHECK(std::abs(melted(fine) - front) < std::abs(melted(coarse) - front));
  }
}

TEST_CASE("lesson 6: how often PIC averages, and how soon all is liquid", "[lesson][heat]") {
  Lesson pic("melting_block", standing("pic", "0.01"));
  while (melted(pic) < 1) pic.simulation.step();
  CHECK(pic.simulation.time() == pic_liquid[0]);
  run_to(pic, 0.5);
  const auto steps = static_cast<double>(pic.simulation.steps());
  CHECK(std::round(steps / 100) * 100 == steps_taken[0]);
  // Conduction alone allows 0.3 of h^2 / 4 alpha in two dimensions, by the page of the method.
  const double alpha = 3000.0 / (900.0 * 1000.0), allowed = 0.3 * 0.01 * 0.01 / (4 * alpha);
  CHECK(steps * allowed / 0.5 == steps_taken[1]);
}

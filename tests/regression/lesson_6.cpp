// What lesson 6 of docs/lessons claims, on the very file that the page names. Most numbers are the
// program's own, as printed there: they show what has changed, and are no verification.

#include <numeric>

#include "support/catch.hpp"
#include "support/heat_solutions.hpp"
#include "support/lesson.hpp"

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
  for (std::size_t k = 1; k < state.position.size(); k += 2) highest = std::max(highest, state.position[k]);
  return highest;
}

void run_to(Lesson& lesson, double time) {
  while (!lesson.simulation.finished() && lesson.simulation.time() < time) lesson.simulation.step();
}

std::vector<std::string> standing(const std::string& transfer, const std::string& cell_size) {
  return {"/materials/wax/thermal/phase_change/melted/yield_stress=20000", "/solver/end_time=0.5",
          set("/transfer/type", transfer), set("/grid/cell_size", cell_size)};
}

}  // namespace

TEST_CASE("lesson 6: the block melts, slumps and is frozen at 1.26 s", "[lesson][heat]") {
  Lesson lesson("melting_block");
  CHECK(melted(lesson) == 0);
  const double before = height(lesson);
  run_to(lesson, 1);
  CHECK(melted(lesson) == Approx(0.593).margin(0.02));
  run_to(lesson, 1.24);
  CHECK(melted(lesson) > 0);
  run_to(lesson, 1.27);
  CHECK(melted(lesson) == 0);
  CHECK(height(lesson) == Approx(0.100).margin(0.002));
  CHECK(height(lesson) < 0.7 * before);
  run_to(lesson, 2);
  CHECK(height(lesson) == Approx(0.100).margin(0.002));
  CHECK(melted(lesson) == 0);
}

TEST_CASE("lesson 6: the front of a block that stands is Neumann's, but for PIC", "[lesson][heat]") {
  const ConductingPhase wax{3000, 1000, 900};
  const StefanProblem exact{wax, wax, 20e3, 420, 330, 300};
  CHECK(exact.lambda() == Approx(0.698).margin(0.0005));
  const double front = exact.front(0.5) / side;
  CHECK(front == Approx(0.356).margin(0.0005));
  struct Claim {
    const char* transfer;
    double coarse, fine;
  };
  for (const Claim& claim :
       {Claim{"pic", 1, 1}, Claim{"apic", 0.406, 0.372}, Claim{"flip", 0.340, 0.349}, Claim{"aflip", 0.345, 0.349}}) {
    INFO(claim.transfer);
    Lesson coarse("melting_block", standing(claim.transfer, "0.01")),
        fine("melting_block", standing(claim.transfer, "0.005"));
    run_to(coarse, 0.5), run_to(fine, 0.5);
    CHECK(melted(coarse) == Approx(claim.coarse).margin(0.004));
    CHECK(melted(fine) == Approx(claim.fine).margin(0.004));
    if (claim.coarse < 1) CHECK(std::abs(melted(fine) - front) < std::abs(melted(coarse) - front));
  }
}

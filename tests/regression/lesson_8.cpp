// What lesson 8 of docs/lessons claims, on the very files that the page names. The numbers are read from the page. Those
// with the average volume gradient are the program's own: they show what has changed, and are no verification. Those of a
// rigid block are exact, and tests/verification/finite_block.cpp holds the program to them.

#include <cmath>

#include "support/catch.hpp"
#include "support/lesson.hpp"
#include "support/page.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The block's mean velocity along the slope and its way, m/s and m, at the end.
struct End {
  double velocity = 0, way = 0;
};

End end_of(const std::string& name, const std::vector<std::string>& overrides = {}) {
  Lesson lesson(name, overrides);
  lesson.run();
  const BodyState block = lesson.simulation.backend().body_state(1);
  const double count = static_cast<double>(block.position.size()) / 2;
  End end{0, -0.2};  // its middle begins at 0.2 m
  for (std::size_t k = 0; k < block.position.size(); k += 2)
    end.velocity += block.velocity[k] / count, end.way += block.position[k] / count;
  return end;
}

const std::string average = "sliding_block_average", gap = "sliding_block_widest_gap";
const std::string short_steps = "/solver/courant=0.1", rubs = "/contact/friction=0.3", finer = "/grid/cell_size=0.025";

Page page("docs/lessons/8_does_it_slide.md");
const Claim textbook(page, "it slides with g sin 30° = # m/s²"), exact(page, "# · (0.4 − 0.05) = # m/s"),
    ends(page, "With the widest gap the block ends with # m/s. With the average it ends with # m/s"),
    ways_average(page,
                 "The block at t = 0.4 s, # m from where it began](../../figures/lessons/sliding_block_average.png)"),
    ways_gap(page,
             "The block at t = 0.4 s, # m from where it began](../../figures/lessons/sliding_block_widest_gap.png)"),
    steps_average(page, "| average volume gradient | # m/s | # m/s |"),
    steps_gap(page, "| widest gap | # m/s | # m/s |"),
    friction(page, "= # m/s², and # m/s after the same time. The widest gap gives # m/s, the average # m/s."),
    finer_average(page, "The average comes nearer, to # m/s."), rests(page, "is more than tan 30° = #.");

constexpr double g = 9.81;

}  // namespace

TEST_CASE("lesson 8: every number of the page is read by a test or given by the scene", "[lesson][docs]") {
  page.add_given({"lies on a slope of 30°", "after 0.4 s the block",
                  "With friction 0.3 a rigid block has g (sin 30° − 0.3 cos 30°)", "The pictures are turned by 30°",
                  "| | `courant` 0.3 | `courant` 0.1 |", "(0.4 − 0.05)"});
  page.add_given({"the weight grows over a tenth of a second"});  // as the scene has it
  CHECK(page.numbers_of_nobody() == std::vector<std::string>{});
  CHECK(page.words_of_nobody() == std::vector<std::string>{});
}

TEST_CASE("lesson 8: the widest gap lets the block slide, the average drags it", "[lesson][friction]") {
  CHECK(g * 0.5 == textbook[0]);
  CHECK(g * 0.5 == exact[0]);
  CHECK(g * 0.5 * 0.35 == exact[1]);
  const End slow = end_of(average), right = end_of(gap);
  for (const Approx& printed : {ends[0], steps_gap[0]}) CHECK(right.velocity == printed);
  for (const Approx& printed : {ends[1], steps_average[0]}) CHECK(slow.velocity == printed);
  CHECK(slow.way == ways_average[0]);
  CHECK(right.way == ways_gap[0]);
  CHECK(end_of(average, {short_steps}).velocity == steps_average[1]);
  CHECK(end_of(gap, {short_steps}).velocity == steps_gap[1]);
}

TEST_CASE("lesson 8: friction, and finer cells", "[lesson][friction]") {
  const double rigid = g * (0.5 - 0.3 * std::sqrt(0.75));
  CHECK(rigid == friction[0]);
  CHECK(rigid * 0.35 == friction[1]);
  CHECK(end_of(gap, {rubs}).velocity == friction[2]);
  CHECK(end_of(average, {rubs}).velocity == friction[3]);
  CHECK(end_of(average, {finer}).velocity == finer_average[0]);
  CHECK(1 / std::sqrt(3.0) == rests[0]);
  // What is proposed at the end.
  for (const std::string& name : {average, gap}) CHECK(end_of(name, {"/transfer/type=flip"}).velocity > 1);
  CHECK(std::abs(end_of(gap, {"/contact/friction=0.6", "/bodies/1/geometry/upper=[0.4,0.1]"}).velocity) < 0.005);
}

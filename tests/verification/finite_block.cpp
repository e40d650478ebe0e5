// A block that ends: its corners do not slow it down where the normal is that of the widest gap between the particles.
// Exact for a rigid block: a = g (sin - mu cos).

#include <cmath>

#include "support/catch.hpp"
#include "verification/finite_block.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::finite_block;

namespace {

struct Transfer {
  std::string name;
  std::vector<std::string> settings;
};
const std::vector<Transfer> transfers{
    {"pic", {set("/transfer/type", "pic")}},
    {"flip", {set("/transfer/type", "flip")}},
    {"apic", {}},
    {"mls", {set("/transfer/type", "mls")}},
    {"fmpm", {set("/transfer/type", "pic"), R"(/filter={"type": "fmpm", "order": 4})"}}};

void check_slides(const Transfer& transfer, double courant) {
  std::vector<std::string> settings = transfer.settings;
  settings.push_back(set("/solver/courant", digits(courant)));
  INFO(transfer.name << ", courant " << courant);
  CHECK(slide(0, 30, settings).acceleration == Approx(exact(0)).epsilon(0.01));
  CHECK(slide(0.3, 30, settings).acceleration == Approx(exact(0.3)).epsilon(0.01));
}

}  // namespace

TEST_CASE("a finite block slides with g (sin - mu cos), along the grid and turned against it", "[friction][finite]") {
  for (const double angle : {0.0, 17.0, 30.0})
    for (const double friction : {0.0, 0.15, 0.3}) {
      INFO(angle << " degrees, friction " << friction);
      CHECK(slide(friction, angle).acceleration == Approx(exact(friction)).epsilon(0.01));
    }
}

TEST_CASE("a finite block slides so with every transfer, and however short the step", "[friction][finite]") {
  for (const Transfer& transfer : transfers)
    for (const double courant : {0.3, 0.1}) check_slides(transfer, courant);
}

TEST_CASE("a finite block slides so with steps a thirtieth as long", "[friction][finite][slow]") {
  for (const Transfer& transfer : transfers)
    for (const double courant : {0.03, 0.01}) check_slides(transfer, courant);
}

// cpdi2 takes no grips, which hold the slope.
TEST_CASE("a finite block slides so on every shape", "[friction][finite]") {
  for (const std::string shape :
       {"linear", "bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp", "cpdi"})
    for (const double angle : {0.0, 30.0}) {
      INFO(shape << ", " << angle << " degrees");
      if (shape == "linear" && angle > 0) continue;  // tents turn a particle of the rubbed rows inside out there
      const std::vector<std::string> settings{set("/shape/type", shape), set("/solver/courant", "0.1")};
      CHECK(slide(0, angle, settings).acceleration == Approx(exact(0)).epsilon(0.01));
    }
}

TEST_CASE("blocks of two, four and eight cells slide alike", "[friction][finite]") {
  for (const std::string width : {"0.1", "0.2", "0.4"})
    for (const double angle : {0.0, 30.0}) {
      INFO(width << " m, " << angle << " degrees");
      const std::vector<std::string> settings{"/bodies/1/geometry/of/upper=[" + width + ", 0.1]"};
      CHECK(slide(0, angle, settings).acceleration == Approx(exact(0)).epsilon(0.01));
      CHECK(slide(0.15, angle, settings).acceleration == Approx(exact(0.15)).epsilon(0.01));
    }
}

// It leans while its weight grows, and slips more at one end than at the other: a start that its speed keeps.
TEST_CASE("a low block close to sticking slides once it has leaned, and one that friction holds stays",
          "[friction][finite]") {
  const auto until = [](const char* end) { return set("/solver/end_time", end); };
  const std::string low = "/bodies/1/geometry/of/upper=[0.4, 0.1]";
  for (const double angle : {0.0, 17.0, 30.0}) {
    INFO(angle << " degrees");
    const double early = slide(0.5, angle, {low, until("0.3")}).speed,
                 late = slide(0.5, angle, {low, until("0.6")}).speed;
    CHECK((late - early) / 0.3 == Approx(exact(0.5)).epsilon(0.02));
    CHECK(std::abs(slide(0.6, angle, {low}).speed) < 0.002 * g * sine * 0.3);
  }
}

TEST_CASE("a block thrown up the slope stops and slides back", "[friction][finite]") {
  // The weight acts from the start here: v falls by g (sin + mu cos) to zero and grows by g (sin - mu cos).
  const double start = -0.8, friction = 0.15, up = g * (sine + friction * cosine), stop = -start / up, end = 0.4;
  for (const double angle : {0.0, 30.0}) {
    const std::string along =
        "[" + digits(start * std::cos(angle * degree)) + ", " + digits(-start * std::sin(angle * degree)) + "]";
    const double down = (30 - angle) * degree;
    const std::vector<std::string> settings{
        "/bodies/1/velocity=" + along, set("/solver/end_time", digits(end)), "/bodies/1/geometry/of/upper=[0.4, 0.1]",
        "/gravity=[" + digits(g * std::sin(down)) + ", " + digits(-g * std::cos(down)) + "]",
        set("/grid/domain", "[[-1.2, -1.4], [1.8, 0.8]]")};
    INFO(angle << " degrees");
    CHECK(slide(friction, angle, settings).speed == Approx(exact(friction) * (end - stop)).epsilon(0.02));
  }
}

TEST_CASE("in 3-D a finite block slides so too", "[friction][finite]") {
  const std::string text = R"J({
  "title": "finite block on a slope in 3-D", "dimension": 3, "gravity": ["4.905*min(1, t/0.05)", "-8.495709211*min(1, t/0.05)", 0],
  "grid": {"cell_size": 0.05, "domain": [[-0.15, -0.1, -0.15], [0.6, 0.25, 0.35]], "boundaries": {"all": "free", "y_min": "stick"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "contact": {"type": "coulomb", "friction": 0.15, "normal": "widest_gap"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "slope", "material": "m", "geometry": {"type": "box", "lower": [-0.1, -0.1, -0.1], "upper": [0.55, 0, 0.3]}},
    {"name": "block", "material": "m", "geometry": {"type": "box", "lower": [0, 0, 0], "upper": [0.2, 0.1, 0.2]}}],
  "solver": {"time_step": "auto", "end_time": 0.2}, "output": {"ledger": false}})J";
  for (const std::string turned :
       {"0 deg", "25 deg"}) {  // about the slope's normal: the block's sides cross the grid's
    Scene scene(text,
                {R"(/bodies/1/geometry={"type": "turned", "axis": [0, 1, 0], "angle": ")" + turned +
                 R"(", "about": [0.1, 0, 0.1], "of": {"type": "box", "lower": [0, 0, 0], "upper": [0.2, 0.1, 0.2]}})"});
    scene.run();
    const BodyState block = scene.body(1);
    double speed = 0;
    for (std::size_t k = 0; k < block.velocity.size(); k += 3)
      speed += 3 * block.velocity[k] / static_cast<double>(block.velocity.size());
    INFO(turned);
    CHECK(speed / (scene.simulation.time() - 0.025) == Approx(exact(0.15)).epsilon(0.01));
  }
}

TEST_CASE("the surfaces of particles let it slide as the position of mass does", "[friction][finite]") {
  const std::vector<std::string> surfaces{set("/contact/detection", "particle_surfaces")};
  for (const double angle : {0.0, 30.0}) {
    INFO(angle << " degrees");
    CHECK(slide(0, angle, surfaces).acceleration == Approx(exact(0)).epsilon(0.01));
    CHECK(slide(0.3, angle, surfaces).acceleration == Approx(exact(0.3)).epsilon(0.01));
  }
}

// It swings between its ends (tests/regression/finite_block.cpp), so that all of a swing counts.
TEST_CASE("friction on a high block close to sticking is mu N, whatever the step and the cells", "[friction][finite]") {
  for (const std::vector<std::string>& finer : refinements) {
    INFO((finer.empty() ? "" : finer[0]));
    const Rocking found = rock(finer);
    for (const Pressed& third : {found.early, found.late})
      CHECK(third.rubbing / third.pressing == Approx(0.5).epsilon(0.03));
  }
}

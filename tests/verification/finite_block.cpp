// A block that ends: its corners do not slow it down where the normal is that of the widest gap between the particles.
// Exact for a rigid block: a = g (sin - mu cos). The weight grows over a tenth of a second, as let go of at once a soft
// block shakes and slips while it presses less.

#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/scene.hpp"
#include "verification/shipped.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* slope = R"J({
  "title": "finite block on a slope", "dimension": 2,
  "grid": {"cell_size": 0.05, "domain": [[-0.8, -1.4], [1.8, 0.8]], "boundaries": {"all": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "contact": {"type": "coulomb", "friction": 0, "normal": "widest_gap"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "slope", "material": "m", "seeding": "fitted", "geometry": {"type": "turned", "angle": 0, "about": [0, 0],
      "of": {"type": "box", "lower": [-0.4, -0.3], "upper": [1.6, 0]}}},
    {"name": "block", "material": "m", "seeding": "fitted", "geometry": {"type": "turned", "angle": 0, "about": [0, 0],
      "of": {"type": "box", "lower": [0, 0], "upper": [0.4, 0.2]}}}],
  "grips": [{"name": "bed", "body": "slope", "velocity": [0, 0], "where": {"type": "turned", "angle": 0, "about": [0, 0],
      "of": {"type": "box", "lower": [-0.4, -0.3], "upper": [1.6, -0.15]}}}],
  "solver": {"time_step": "auto", "courant": 0.3, "end_time": 0.3}, "output": {"ledger": false}})J";

constexpr double g = 9.81, ramp = 0.1, degree = std::numbers::pi / 180;
const double sine = 0.5, cosine = std::sqrt(0.75);
double exact(double friction) {
  return g * (sine - friction * cosine);
}

/// The slope of 30 degrees, turned against the grid by so many.
std::vector<std::string> turned(double angle) {
  const double down = (30 - angle) * degree;
  const std::string grows = "*min(1, t/0.1)", minus = "\"-" + digits(angle) + " deg\"";
  return {"/gravity=[\"" + digits(g * std::sin(down)) + grows + "\", \"" + digits(-g * std::cos(down)) + grows + "\"]",
          set("/bodies/0/geometry/angle", minus), set("/bodies/1/geometry/angle", minus),
          set("/grips/0/where/angle", minus)};
}

struct Slide {
  double acceleration = 0;  ///< its speed along the slope over the time for which the weight has acted, m/s^2
  double speed = 0;         ///< m/s
};

Slide slide(double friction, double angle, std::vector<std::string> settings = {}, double start = 0) {
  std::vector<std::string> all = turned(angle);
  all.push_back(set("/contact/friction", digits(friction)));
  all.insert(all.end(), settings.begin(), settings.end());
  Scene scene(slope, all);
  scene.run();
  const BodyState block = scene.body(1);
  const int D = scene.experiment.dimension;
  Slide found;
  const double count = static_cast<double>(block.velocity.size()) / D;
  for (std::size_t k = 0; k < block.velocity.size(); k += static_cast<std::size_t>(D))
    found.speed +=
        (block.velocity[k] * std::cos(angle * degree) - block.velocity[k + 1] * std::sin(angle * degree)) / count;
  found.acceleration = (found.speed - start) / (scene.simulation.time() - ramp / 2);
  INFO(angle << " degrees, friction " << friction);
  CHECK(scene.simulation.backend().contact_record().momentum_residual < 1e-10);
  return found;
}

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

// Why it is there: the average volume gradient tilts at the block's ends and takes a share of the sliding speed in every
// step. Our own numbers, 43 % missing at courant 0.3 (docs/contact.md).
TEST_CASE("with the average volume gradient the same block is slowed down, the more the shorter the step",
          "[friction][finite]") {
  const std::string average = set("/contact/normal", "average_volume_gradient");
  const double longer = slide(0, 0, {average}).acceleration,
               shorter = slide(0, 0, {average, set("/solver/courant", "0.1")}).acceleration;
  CHECK(longer < 0.75 * exact(0));
  CHECK(shorter < 0.8 * longer);
}

// Our own numbers (docs/contact.md): what friction does to a soft block that is half as high as it is long.
TEST_CASE("a high block close to sticking rocks, whatever the step and the cells, and friction stays mu N",
          "[friction][finite]") {
  for (const std::vector<std::string>& finer :
       {std::vector<std::string>{}, {set("/solver/courant", "0.1")}, {set("/grid/cell_size", "0.025")}}) {
    std::vector<std::string> settings = turned(0);
    settings.insert(settings.end(),
                    {set("/contact/friction", "0.5"), set("/transfer/type", "flip"), set("/solver/end_time", "0.4")});
    settings.insert(settings.end(), finer.begin(), finer.end());
    Scene scene(slope, settings);
    struct Third {
      double least = 1e9, most = 0, pressing = 0, rubbing = 0;
    } early, late;
    while (!scene.simulation.finished()) {
      scene.simulation.step();
      const Vector3& force = scene.simulation.backend().contact_record().force;  // on the slope
      const double time = scene.simulation.time(), dt = scene.simulation.last_time_step();
      if (time < 0.15) continue;
      Third& third = time < 0.25 ? early : late;
      if (time > 0.25 && time < 0.3) continue;
      third.least = std::min(third.least, -force[1]), third.most = std::max(third.most, -force[1]);
      third.pressing -= force[1] * dt, third.rubbing += force[0] * dt;
    }
    INFO((finer.empty() ? "" : finer[0]) << ": " << early.most - early.least << " and " << late.most - late.least
                                         << " N");
    CHECK(late.most - late.least > 1.5 * (early.most - early.least));
    CHECK(early.rubbing / early.pressing == Approx(0.5).epsilon(0.03));
    CHECK(late.rubbing / late.pressing == Approx(0.5).epsilon(0.03));
  }
}

// Our own numbers (docs/contact.md): the normal of curved bodies was not what was wrong, and changes little.
TEST_CASE("the widest gap changes the peak force of two spheres by less than four per cent", "[friction][finite]") {
  for (const std::string place : {"1.025", "1.0421875"}) {
    const auto peak = [&](const std::string& normal) {
      ShippedScene scene("studies/hertz_spheres.json",
                         {set("/contact/normal", normal), "/bodies/0/geometry/of/0/centre/1=-" + place,
                          "/bodies/1/geometry/of/0/centre/1=" + place});
      double force = 0;
      scene.run([&] { force = std::max(force, std::abs(scene.simulation.backend().contact_record().force[1])); });
      return force;
    };
    CHECK(peak("widest_gap") == Approx(peak("average_volume_gradient")).epsilon(0.04));
  }
}

// Every law beside itself 1e8 times stiffer, so that the soft body takes 1e4 steps where it would take one. The two are in one
// field of velocity, which welds them, or in contact; the soft one flies at the stiff one at a fiftieth of its waves. What
// holds of any law, by balances alone:
//   momentum stays, in each step to rounding
//   energy is not more than there was, and there is none but that of the soft body's flight
//   by that energy, no particle of the stiff body is pressed by more than v/c2 sqrt(V/Vp), Vp of V its volume, c2 its waves
//   a law that holds tension is calm behind the front: the traction is rho c v at most, twice that where it comes back, so
//   that strains are as 1e8 to 1
// and of two elastic bars the velocity that the impact leaves (experiments/extremes/stiff_bars_scene.json).

#include <cmath>
#include <cstdio>

#include "metrics/particle_quantities.hpp"
#include "support/any_law.hpp"
#include "support/catch.hpp"
#include "verification/shipped.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double ratio = 1e8, mach = 0.02;

struct Meeting {
  int dimension = 2;
  bool contact = false;
  const char* precision = "double";
  double crossings = 0.25;  ///< of a cell by the soft body's waves: how long it runs
  bool is_calm = true;      ///< the stiff one's waves have died by then
};

/// Two cells of the law, and two of the stiffer one, in a channel.
std::string meeting_of(const AnyLaw& law, const Meeting& meeting) {
  const bool flat = meeting.dimension == 2;
  const std::string none = flat ? ", 0" : ", 0, 0", wide = flat ? ", 0.1" : ", 0.1, 0.1";
  return R"({"dimension": )" + std::to_string(meeting.dimension) + R"(, "backend": "cpu", "precision": ")" +
         meeting.precision + R"(",
    "grid": {"cell_size": 0.1, "domain": [[0)" +
         none + "], [2" + wide + R"(]],
             "boundaries": {"all": "slip", "x_min": "free", "x_max": "free"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"})" +
         (meeting.contact ? R"(, "contact": {"type": "frictionless"})" : "") + R"(,
    "materials": {"soft": )" +
         law.text() + R"(, "stiff": )" + law.text(ratio) + R"(},
    "bodies": [
      {"name": "soft", "material": "soft", "velocity": [)" +
         digits(mach * law.speed) + none + R"(],
       "geometry": {"type": "box", "lower": [0.8)" +
         none + R"(], "upper": [1)" + wide + R"(]}},
      {"name": "stiff", "material": "stiff", "geometry": {"type": "box", "lower": [1)" +
         none + R"(], "upper": [1.2)" + wide + R"(]}}],
    "solver": {"time_step": "auto", "end_time": )" +
         digits(meeting.crossings * 0.1 / law.speed) + R"(}, "output": {"ledger": false}})";
}

/// The most that a particle of a body is pressed, 1 - J, and its largest stress over rho c v of the soft body.
struct Pressed {
  double strain = 0, stress = 0;
};
Pressed pressed(const Scene& scene, int body, const AnyLaw& law) {
  Pressed found;
  const MaterialQuantities of = material_quantities(scene.experiment, body, scene.body(body));
  for (const double J : of.volume_ratio) found.strain = larger(found.strain, 1 - J);
  for (const double entry : of.stress) found.stress = larger(found.stress, std::abs(entry));
  found.stress /= law.density * law.speed * mach * law.speed;
  return found;
}

/// Whether the law pulls as much when it is stretched by little as it pushes when it is pressed.
bool holds_tension(const AnyLaw& law, int dimension) {
  const drive::MaterialPoint point(law.material, dimension);
  drive::Matrix pull{}, push{};
  pull(0, 0) = 1e-10, push(0, 0) = -1e-10;
  return point.trial(pull, 1e6).kirchhoff(0, 0) > -0.5 * point.trial(push, 1e6).kirchhoff(0, 0);
}

void check_meetings(const Meeting& meeting, const std::vector<std::string>& settings = {}) {
  std::string left_out;
  const bool is_double = meeting.precision == std::string("double");
  std::printf("%d-D, %s, %s: steps, energy kept, change of momentum, strain of the soft and the stiff one over v/c\n",
              meeting.dimension, meeting.contact ? "contact" : "one field", meeting.precision);
  for (const AnyLaw& law : every_law(meeting.dimension, left_out)) {
    INFO(law.id << ", " << meeting.dimension << "-D, " << (meeting.contact ? "contact" : "one field"));
    Scene scene(meeting_of(law, meeting), settings);
    scene.simulation.observe_when([](double, long) { return false; });
    const Totals start = scene.metrics.initial();
    std::string failure;
    try {
      while (!scene.simulation.finished()) scene.simulation.step();
    } catch (const RunFailure& stopped) {
      failure = cause_text(stopped.failure, scene.experiment);
    }
    CHECK(failure.empty());
    const Totals end = scene.metrics.measure();
    const double steps = static_cast<double>(scene.simulation.steps());
    const Pressed soft = pressed(scene, 0, law), stiff = pressed(scene, 1, law);
    std::printf("  %-23s %7.0f %7.4f %8.1e %9.2e %9.2e\n", law.id.c_str(), steps,
                end.total_energy() / start.total_energy(), end.momentum[0] / start.momentum[0] - 1, soft.strain / mach,
                stiff.strain / mach);
    CHECK(std::abs(end.momentum[0] / start.momentum[0] - 1) < (is_double ? 0x1p-52 : 0x1p-23) * steps);
    CHECK(soft.strain > 0.1 * meeting.crossings * mach);
    if (!is_double) continue;
    CHECK(end.total_energy() <= (1 + 1e-9) * start.total_energy());
    const double particles = static_cast<double>(scene.simulation.particle_count(1));
    CHECK(stiff.strain < mach / std::sqrt(ratio) * std::sqrt(particles));
    if (!meeting.is_calm || !holds_tension(law, meeting.dimension)) continue;
    CHECK(stiff.stress < 2);
    CHECK(stiff.strain < 1e3 / ratio * soft.strain);
  }
  INFO(left_out);
  CHECK(left_out.empty());
}

/// Of two bars the velocity of the stiff one after the impact, over that of the soft one before.
double struck(double stiffer, int cells, const std::vector<std::string>& settings) {
  std::vector<std::string> all{set("/materials/stiff/youngs_modulus", digits(4000 * stiffer)),
                               set("/grid/cell_size", digits(1.0 / cells))};
  const std::string top = digits(1.0 / cells);
  all.push_back("/grid/domain=[[-2, 0], [2, " + top + "]]");
  all.push_back("/bodies/0/geometry/upper=[0, " + top + "]");
  all.push_back("/bodies/1/geometry/upper=[1, " + top + "]");
  all.insert(all.end(), settings.begin(), settings.end());
  ShippedScene scene("extremes/stiff_bars_scene.json", all);
  scene.simulation.observe_when([](double, long) { return false; });
  const Totals start = scene.metrics.initial(), end = scene.run();
  REQUIRE(scene.failure == "");
  CHECK(end.total_energy() <= start.total_energy());
  CHECK(std::abs(end.momentum[0] / start.momentum[0] - 1) < 1e-12);
  const BodyState stiff = scene.simulation.backend().body_state(1);
  double sum = 0;
  for (std::size_t k = 0; k < stiff.velocity.size(); k += 2) sum += stiff.velocity[k];
  return sum / (static_cast<double>(stiff.velocity.size()) / 2) / 0.002;
}

/// What it has after a wave has gone through the soft bar and back.
double exact(double stiffer) {
  const double z = std::sqrt(stiffer);
  return 1 - std::pow((z - 1) / (z + 1), z);
}

}  // namespace

TEST_CASE("every law is welded to one 1e8 times stiffer and takes the strain", "[pairs]") {
  check_meetings({});
}

TEST_CASE("every law meets one 1e8 times stiffer in contact and takes the strain", "[pairs]") {
  check_meetings({.contact = true, .crossings = 0.1});
}

TEST_CASE("every law is welded in 3-D to one 1e8 times stiffer and keeps momentum and energy", "[pairs]") {
  check_meetings({.dimension = 3, .crossings = 0.03, .is_calm = false});
}

TEST_CASE("every law is welded in 3-D to one 1e8 times stiffer and takes the strain", "[pairs][slow]") {
  check_meetings({.dimension = 3});
}

TEST_CASE("every law meets in 3-D one 1e8 times stiffer in contact and takes the strain", "[pairs][slow]") {
  check_meetings({.dimension = 3, .contact = true});
}

TEST_CASE("every law is welded by the reference to one 1e8 times stiffer and takes the strain", "[pairs][slow]") {
  check_meetings({}, {set("/backend", "reference")});
}

// A float has no strain of 1e-10 beside F = I, so that nothing is said of the stiff body's stress and energy.
TEST_CASE("in float every law keeps its momentum beside one 1e8 times stiffer, and takes the strain", "[pairs]") {
  check_meetings({.precision = "float", .crossings = 0.1});
}

// A jump is what the bars exchange, over a front of some cells: the error has to fall as cells do.
TEST_CASE("a soft bar strikes a stiff one as bars in one dimension do, the better the finer the cells", "[pairs]") {
  CHECK(exact(100) == Approx(0.865569).epsilon(1e-6));
  CHECK(exact(1e8) == Approx(1 - std::exp(-2)).epsilon(1e-6));
  std::printf("Velocity of the stiff bar, FLIP, 4, 8, 16 cells: exact\n");
  for (const char* field : {"contact", "one field"})
    for (const double stiffer : {1e2, 1e4}) {
      double before = 1;
      std::printf("  %-10s %.0e", field, stiffer);
      for (const int cells : {4, 8, 16}) {
        std::vector<std::string> settings;
        if (*field == 'o') settings.push_back(set("/contact", "null"));
        const double velocity = struck(stiffer, cells, settings), error = std::abs(velocity - exact(stiffer));
        std::printf(" %8.4f", velocity);
        INFO(field << ", " << stiffer << ", " << cells << " cells");
        CHECK(error < 0.8 * before);
        if (cells == 4)
          CHECK(velocity ==
                Approx(struck(stiffer, cells,
                              {settings.empty() ? set("/title", "bars") : settings[0], set("/backend", "reference")}))
                    .epsilon(1e-9));
        before = error;
      }
      std::printf(" %8.4f\n", exact(stiffer));
      CHECK(before < (*field == 'o' ? 0.16 : 0.055));
    }
}

// Beyond 1e4 the stiff bar is rigid to all that these cells tell.
TEST_CASE("a bar 1e6 times stiffer is struck as one 1e4 times stiffer is", "[pairs]") {
  for (const char* contact : {"null", R"({"type": "frictionless"})"})
    CHECK(struck(1e6, 4, {set("/contact", contact)}) ==
          Approx(struck(1e4, 4, {set("/contact", contact)})).epsilon(0.03));
}

TEST_CASE("a bar 1e8 times stiffer is struck as one 1e4 times stiffer is", "[pairs][slow]") {
  for (const char* contact : {"null", R"({"type": "frictionless"})"})
    CHECK(struck(1e8, 8, {set("/contact", contact)}) ==
          Approx(struck(1e4, 8, {set("/contact", contact)})).epsilon(0.01));
}

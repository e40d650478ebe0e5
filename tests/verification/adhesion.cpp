// A block glued to a plate and pulled off it: slowly it comes off where rho H b is the strength N, suddenly where 2 rho H b
// is, as the wave from its free end doubles the traction.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double strength = 5000, density = 1000, modulus = 1e6;

/// A block 1 m high in a shaft of three cells, whose lower face lies `place` cells above a node, on a plate that is held
/// from a cell below the face on.
/// `pull` is what acts along y, N/kg; the strain is uniaxial, with Poisson's ratio 0.
std::string glued(const std::string& pull, double place = 0.3, double h = 0.1) {
  const double wide = 3 * h, face = place * h;
  const auto box = [&](double from, double to) {
    return R"({"type": "box", "lower": [0, )" + digits(from) + R"(], "upper": [)" + digits(wide) + ", " + digits(to) +
           "]}";
  };
  return R"J({"title": "glued block", "dimension": 2, "grid": {"cell_size": )J" + digits(h) +
         R"J(, "domain": [[0, -0.6], [)J" + digits(wide) +
         R"J(, 2.2]], "boundaries": {"all": "free", "x_min": "slip", "x_max": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "contact": {"type": "adhesion", "normal_strength": 5000, "shear_strength": 5000},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 1000}},
  "bodies": [{"name": "plate", "material": "m", "seeding": "fitted", "geometry": )J" +
         box(face - 4 * h, face) + R"J(}, {"name": "block", "material": "m", "seeding": "fitted", "geometry": )J" +
         box(face, face + 1) + R"J(}],
  "grips": [{"name": "held", "body": "plate", "velocity": [0, 0], "where": )J" +
         box(face - 4 * h, face - h) + R"J(}],
  "body_force": ["0", ")J" +
         pull + R"J("], "solver": {"time_step": "auto", "courant": 0.3, "end_time": 2},
  "output": {"ledger": false, "bodies": true}})J";
}

/// The pull, N/kg, at which a block comes off whose pull grows by `rate`, N/kg a second.
double slow_pull(Scene& scene, double rate = 3) {
  bool held = false;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    const long nodes = scene.simulation.backend().contact_record().sticking;
    if (held && nodes == 0) return rate * scene.simulation.time();
    held = held || nodes > 0;
  }
  return 0;
}

/// A bar of 0.075 m by 2 m that is glued along x = 0.1 to one that is held, and pulled all over by `pull`, N/kg, in a direction
/// `angle` from the face's normal. Towards its ends the pull falls to nothing, so that they let go last; between them the
/// traction is rho w b. It is three cells wide: nodes at the face of a narrower one see its other face as well, and too small an
/// area.
constexpr double bar_width = 0.075, shear_strength = 2500;
std::vector<std::string> bar(const std::string& pull, double angle) {
  const auto box = [](double left, double right) {
    return R"({"type": "box", "lower": [)" + digits(left) + R"(, 0], "upper": [)" + digits(right) + ", 2]}";
  };
  const std::string acts = "(" + pull + ")*min(1, 2*min(Y, 2-Y))*";
  return {R"(/contact={"type": "adhesion", "normal_strength": 5000, "shear_strength": 2500,
                       "normal": {"type": "given", "x": 1, "y": 0}})",
          set("/grid/cell_size", "0.025"),
          "/grid/domain=[[-0.1, -0.2], [0.3, 3]]",
          R"(/grid/boundaries={"all": "free"})",
          "/bodies/0/geometry=" + box(0, 0.1),
          "/bodies/1/geometry=" + box(0.1, 0.1 + bar_width),
          "/grips/0/where=" + box(0, 0.075),
          "/body_force=[\"" + acts + digits(std::cos(angle)) + "\", \"" + acts + digits(std::sin(angle)) + "\"]"};
}

/// The pull at which that traction is on the ellipse.
double pull_of_bar(double angle) {
  const double along = std::cos(angle) > 0 ? std::cos(angle) / strength : 0, across = std::sin(angle) / shear_strength;
  return 1 / (density * bar_width * std::hypot(along, across));
}

/// The time at which a tenth of the nodes that held hold no more, s; 0 if there is none.
double lets_go_at(Scene& scene) {
  long most = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    const long nodes = scene.simulation.backend().contact_record().sticking;
    most = larger(most, nodes);
    if (nodes < 0.8 * static_cast<double>(most)) return scene.simulation.time();
  }
  return 0;
}

double momentum_of_block(const Scene& scene) {
  const BodyState state = scene.body(1);
  double sum = 0;
  for (std::size_t p = 1; p < state.velocity.size(); p += 2) sum += state.mass * state.velocity[p];
  return sum;
}

}  // namespace

TEST_CASE("a block that is pulled slowly comes off where its weight is the strength, wherever its face lies",
          "[adhesion]") {
  for (const double place : {0.0, 0.15, 0.3, 0.5, 0.7, 0.85}) {
    Scene scene(glued("3*t", place));
    INFO("face " << place << " cells above a node");
    CHECK(slow_pull(scene) == Approx(strength / density).epsilon(0.02));
  }
}

TEST_CASE("so it does by every transfer, shape and backend, and in 3-D", "[adhesion]") {
  for (const std::string transfer : {"pic", "flip", "mls"})
    for (const std::string backend : {"reference", "cpu"}) {
      Scene scene(glued("3*t"), {set("/transfer/type", transfer), set("/backend", backend)});
      INFO(transfer << ", " << backend);
      CHECK(slow_pull(scene) == Approx(strength / density).epsilon(0.02));
    }
  for (const std::string shape : {"bspline_cubic", "gimp", "cpdi"}) {
    Scene scene(glued("3*t"), {set("/shape/type", shape)});
    INFO(shape);
    CHECK(slow_pull(scene) == Approx(strength / density).epsilon(0.02));
  }
}

// A pull that grows by r a second makes the block swing. A sudden pull of one makes the traction at the foot go from 0 to
// twice that at rest and back, in triangles of the period 4 H / c; the integral of what is off swings by an eighth of the
// period to either side. So the traction over rho H is r t to r H / (2 c).
TEST_CASE("the slower the pull the nearer, whatever the step, the cells and the particles", "[adhesion]") {
  const double exact = strength / density, swing = 1 / (2 * std::sqrt(modulus / density));
  for (const std::string transfer : {"flip", "apic"})
    for (const auto& [rate, h, courant, particles] : {std::tuple{3.0, 0.1, 0.03, 2},
                                                      {3.0, 0.05, 0.3, 2},
                                                      {1.0, 0.1, 0.1, 2},
                                                      {1.0, 0.05, 0.3, 2},
                                                      {1.0, 0.1, 0.3, 4}}) {
      Scene scene(glued(digits(rate) + "*t", 0.3, h),
                  {set("/transfer/type", transfer), set("/solver/courant", digits(courant)),
                   set("/solver/end_time", digits(6 / rate)),
                   set("/bodies/0/particles_per_cell_axis", std::to_string(particles)),
                   set("/bodies/1/particles_per_cell_axis", std::to_string(particles))});
      INFO(transfer << ", " << rate << " N/kg a second, cells of " << h << " m, courant " << courant << ", "
                    << particles << " particles a cell and axis");
      CHECK(std::abs(slow_pull(scene, rate) - exact) <= rate * swing + 0.002 * exact);
    }
}

TEST_CASE("a block that has come off moves with the pull alone", "[adhesion]") {
  Scene scene(glued("3*t"));
  while (scene.simulation.time() < 1.8) scene.simulation.step();  // it swings back once, and holds again for a moment
  const double start = scene.simulation.time(), before = momentum_of_block(scene);
  while (scene.simulation.time() < 1.9) {
    scene.simulation.step();
    CHECK(scene.simulation.backend().contact_record().sticking == 0);
  }
  const double end = scene.simulation.time(), mass = density * 0.3;
  CHECK(momentum_of_block(scene) - before == Approx(mass * 1.5 * (end * end - start * start)).epsilon(1e-3));
}

TEST_CASE("a block that is pulled suddenly lets go by half of what it bears slowly", "[adhesion]") {
  // In so many steps the wave has come back from the free end, and the traction has begun to fall again.
  const auto lets_go = [](double pull, double h) {
    Scene scene(glued(digits(pull), 0.3, h));
    const double there_and_back = 2 / std::sqrt(modulus / density);
    bool held = false, gone = false;
    while (scene.simulation.time() < 1.6 * there_and_back) {
      scene.simulation.step();
      const long nodes = scene.simulation.backend().contact_record().sticking;
      gone = gone || (held && nodes == 0);
      held = held || nodes > 0;
    }
    return gone;
  };
  const double exact = strength / (2 * density);
  CHECK_FALSE(lets_go(0.95 * exact, 0.1));
  CHECK(lets_go(1.05 * exact, 0.1));
  CHECK_FALSE(lets_go(0.97 * exact, 0.05));
  CHECK(lets_go(1.03 * exact, 0.05));
}

TEST_CASE("a bar that is sheared slowly comes off where its weight is the shear strength, and obliquely on the ellipse",
          "[adhesion]") {
  for (const double degrees : {90.0, 45.0, 20.0, 135.0})
    for (const std::string transfer : {"flip", "apic"})
      for (const double courant : {0.3, 0.1}) {
        if (courant < 0.3 && (transfer == "flip" || degrees != 90)) continue;
        const double angle = degrees * std::numbers::pi / 180, exact = pull_of_bar(angle);
        std::vector<std::string> settings = bar("t*" + digits(exact), angle);
        settings.insert(settings.end(), {set("/transfer/type", transfer), set("/solver/courant", digits(courant)),
                                         set("/solver/end_time", "1.3")});
        Scene scene(glued("0"), settings);
        INFO(degrees << " degrees, " << transfer << ", courant " << courant);
        const double found = lets_go_at(scene);
        CHECK(found == Approx(1).epsilon(0.02));
      }
}

TEST_CASE("a sheared bar holds just below its strength and not just above", "[adhesion]") {
  const double angle = std::numbers::pi / 2;
  for (const double share : {0.97, 1.03}) {
    Scene scene(glued("0"), bar("min(t, " + digits(share) + ")*" + digits(pull_of_bar(angle)), angle));
    INFO(share);
    CHECK((lets_go_at(scene) == 0) == (share < 1));
  }
}

// The residual is that of time integration, and falls with the step. Letting go is no impulse: nothing is booked for it.
TEST_CASE("the books of energy close while adhesion holds and when it lets go", "[adhesion][ledger]") {
  for (const std::string transfer : {"pic", "flip", "apic"})
    for (const std::string backend : {"reference", "cpu"}) {
      if (backend == "reference" && transfer != "apic") continue;
      double residuals[2] = {};
      for (const bool shorter : {false, true}) {
        Scene scene(glued("3*t"), {set("/transfer/type", transfer), set("/backend", backend), "/output/ledger=true",
                                   set("/solver/courant", shorter ? "0.1" : "0.3")});
        INFO(transfer << ", " << backend << (shorter ? ", short steps" : ""));
        double most = 0, before = 0;
        double& residual = residuals[shorter ? 1 : 0];
        bool held = false, gone = false;
        while (scene.simulation.time() < 1.8) {
          const Totals now = scene.run_steps(1);
          const Ledger& ledger = scene.simulation.ledger();
          const ContactRecord& record = scene.simulation.backend().contact_record();
          most = larger(most, now.kinetic + now.strain);
          residual = larger(residual, std::abs(scene.metrics.ledger_residual(now)));
          REQUIRE(std::abs(ledger.grid_book) <= 1e-10 * most);
          REQUIRE(std::abs(ledger.mass_book) <= 1e-10 * density);
          REQUIRE(ledger.friction == 0);
          if (record.sticking + record.slipping == 0) REQUIRE(ledger.contact == before);
          gone = gone || (held && record.sticking == 0), held = held || record.sticking > 0;
          before = ledger.contact;
        }
        CHECK(gone);
        CHECK(scene.simulation.ledger().contact < 0);
        CHECK(residual < (shorter ? 0.015 : 0.03) * most);
      }
      CHECK(residuals[1] < 0.85 * residuals[0]);
    }
}

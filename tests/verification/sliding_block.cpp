// Coulomb friction on an incline, the slope aligned with the grid (gravity is turned instead). The block spans a
// periodic domain: its corners, where averaged volume gradients tilt the normal and drag (docs/method.md), are not this
// case.

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* incline = R"J({
  "title": "block on an incline", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.05, "domain": [[0, 0], [0.5, 1]], "boundaries": {"x_min":"periodic","x_max":"periodic", "y_min": "stick","y_max":"free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "pic"},
  "contact": {"type": "coulomb", "friction": 0.5},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "ground", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.5, 0.2]}},
    {"name": "block", "material": "m", "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.5, 0.4]}}],
  "gravity": [4.905, -8.495709211],
  "solver": {"time_step": "auto", "courant": 0.3, "end_time": 0.6}, "output": {"ledger": true}})J";

/// The block's own velocity and way along the slope over the run, m/s and m; ways are of less than half the domain.
struct Slide {
  double time = 0, velocity = 0, way = 0;
};

Slide slide(const std::string& friction, const std::vector<std::string>& settings) {
  std::vector<std::string> all{set("/contact/friction", friction)};
  all.insert(all.end(), settings.begin(), settings.end());
  Scene scene(incline, all);
  const BodyState start = scene.body(1);
  scene.run();
  const BodyState block = scene.body(1);
  const double count = static_cast<double>(block.velocity.size()) / 2, length = 0.5;
  Slide found{.time = scene.simulation.time()};
  for (std::size_t k = 0; k < block.velocity.size(); k += 2) {
    const double moved = block.position[k] - start.position[k];
    found.velocity += block.velocity[k] / count;
    found.way += (moved - length * std::round(moved / length)) / count;
  }
  return found;
}

constexpr double g = 9.81, sine = 0.5;
const double cosine = std::sqrt(3) / 2;

/// The interface in the middle of a cell: the ground is 0.225 m high, and the block 0.175 m.
const std::vector<std::string> between_nodes{"/bodies/0/geometry/upper=[0.5, 0.225]",
                                             "/bodies/1/geometry/lower=[0, 0.225]"};

bool takes_increments(const Plugin& transfer) {
  return (transfer.transfer().traits & MPM_GATHERS_INCREMENT) != 0;
}

}  // namespace

TEST_CASE("a block on an incline slides with g (sin - mu cos), or stays", "[friction]") {
  const auto check = [](const std::string& name, const std::vector<std::string>& settings) {
    INFO(name);
    const Slide free = slide("0", settings), slides = slide("0.15", settings);
    CHECK(free.velocity == Approx(g * sine * free.time).epsilon(0.005));
    CHECK(slides.velocity == Approx(g * (sine - 0.15 * cosine) * slides.time).epsilon(0.005));
  };
  check("reference, pic", {set("/backend", "reference")});
  for (const std::string transfer : {"pic", "flip", "apic"}) check(transfer, {set("/transfer/type", transfer)});
  std::vector<std::string> apart = between_nodes;
  apart.push_back(set("/transfer/type", "apic"));
  check("apic, interface between nodes", apart);
  // PIC's damping lets a block stay that hardly holds.
  for (const std::string backend : {"reference", "cpu"}) {
    const Slide stays = slide("0.6", {set("/backend", backend)});
    CHECK(std::abs(stays.velocity) < 0.005 * g * sine * stays.time);
  }
}

// Let go of at once, a block swings up and down as well as along the slope, and slips while it presses less. With a weight
// that grows over many of its periods it leans: in shear by density g sin (L Y - Y^2 / 2) / G at Y, L = 0.4 m from the
// ground to its top, and no further.
TEST_CASE("a block that friction holds leans and stays", "[friction]") {
  constexpr double G = 1e6 / 2.6, lean = 1000 * g * sine / G * (0.4 * 0.3 - 0.28 / 3 / 2);
  const std::string grows = "*(0.5*(1-cos(pi*t/0.5))*(t<0.5)+(t>=0.5))";
  for (const std::string transfer : {"pic", "flip", "apic"}) {
    const Slide held = slide("0.6", {set("/transfer/type", transfer), "/gravity=[0, 0]", set("/solver/end_time", "0.8"),
                                     "/body_force=[\"4.905" + grows + "\", \"-8.495709211" + grows + "\"]"});
    INFO(transfer << ": " << held.way << " of " << lean << " m");
    CHECK(held.way == Approx(lean).epsilon(0.1));
  }
}

// With mu(v) = mu_k + (mu_s - mu_k) exp(-v / v_d) a block obeys dv/dt = A - B exp(-v / v_d), A = g (sin - mu_k cos), B =
// g (mu_s - mu_k) cos: exp(v / v_d) grows by A / v_d and loses B / v_d, from 1 at rest. A weight that grows over a time T
// has acted for T / 2 when it is there.
TEST_CASE("a block slides as its friction falls or rises with the speed", "[friction]") {
  constexpr double decay = 0.5, grown = 0.2;
  const auto exact = [](double kinetic, double at_rest, double time) {
    const double A = g * (sine - kinetic * cosine), B = g * (at_rest - kinetic) * cosine;
    return decay * std::log(B / A + (1 - B / A) * std::exp(A * (time - grown / 2) / decay));
  };
  const auto slide_with = [](double kinetic, double at_rest, std::vector<std::string> settings) {
    const std::string grows = "*(0.5*(1-cos(pi*t/0.2))*(t<0.2)+(t>=0.2))";
    settings.insert(settings.end(),
                    {"/gravity=[0, 0]", "/body_force=[\"4.905" + grows + "\", \"-8.495709211" + grows + "\"]",
                     R"(/contact={"type": "velocity_dependent_friction", "friction": )" + digits(kinetic) +
                         R"(, "static_friction": )" + digits(at_rest) + R"(, "decay_speed": 0.5})"});
    return slide("0", settings);
  };
  const auto check = [&](double kinetic, double at_rest, const std::vector<std::string>& settings) {
    const Slide found = slide_with(kinetic, at_rest, settings);
    INFO("friction " << at_rest << " to " << kinetic << ": " << found.velocity << " m/s");
    CHECK(found.velocity == Approx(exact(kinetic, at_rest, found.time)).epsilon(0.005));
  };
  for (const std::string transfer : {"pic", "flip", "apic"})
    for (const std::string courant : {"0.3", "0.1", "0.03"}) {
      INFO(transfer << " courant " << courant);
      const std::vector<std::string> settings{set("/transfer/type", transfer), set("/solver/courant", courant)};
      check(0.1, 0.4, settings);
      check(0.4, 0.1, settings);
    }
  check(0.1, 0.4, {set("/backend", "reference"), set("/solver/courant", "0.1")});
}

// The weight is a body force, whose work the ledger sums: heights mean nothing on a periodic domain.
TEST_CASE("a sliding block turns mu N times its way to heat", "[friction][ledger]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"pic", "flip", "apic"}) {
      Scene scene(incline, {"/gravity=[0, 0]", "/body_force=[4.905, -8.495709211]", set("/contact/friction", "0.15"),
                            set("/backend", backend), set("/transfer/type", transfer)});
      const Totals end = scene.run();
      const double mass = 0.5 * end.mass, a = g * (sine - 0.15 * cosine), way = 0.5 * a * end.time * end.time;
      const double heat = 0.15 * mass * g * cosine * way;
      const Ledger& ledger = scene.simulation.backend().ledger();
      INFO(backend << " " << transfer);
      // What APIC and FLIP keep of the vibrations of the sudden start rubs as well. The work of contact holds what it does
      // before the forces, which FLIP takes back.
      const double rubs = transfer == "pic" ? 0.01 : transfer == "apic" ? 0.02 : 0.15;
      INFO("heat " << ledger.friction << " of " << heat << " J/m, contact " << ledger.contact);
      CHECK(ledger.friction == Approx(heat).epsilon(std::min(rubs, 0.02)));
      CHECK(ledger.contact == Approx(-heat).epsilon(rubs));
      CHECK(ledger.body_force == Approx(mass * g * sine * way).epsilon(0.01));
      CHECK(end.kinetic == Approx(0.5 * mass * a * a * end.time * end.time).epsilon(0.01));
      CHECK(std::abs(scene.metrics.ledger_residual(end)) < 0.01 * heat);
    }
}

TEST_CASE("a block on an incline close to sticking: the shear vibration of the sudden start fades", "[friction]") {
  Scene scene(incline, {set("/contact/friction", "0.5"), set("/solver/end_time", "1.2")});
  double middle = 0, middle_time = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (middle_time > 0 || scene.simulation.time() < 0.4) continue;
    middle = scene.metrics.measure().momentum[0];
    middle_time = scene.simulation.time();
  }
  const Totals end = scene.metrics.measure();
  const double late = (end.momentum[0] - middle) / (0.5 * end.mass) / (end.time - middle_time);
  CHECK(late == Approx(0.65714539).epsilon(0.02));
}

TEST_CASE("gravity along a periodic axis gives its work at every turn", "[ledger]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"pic", "flip", "apic"}) {
      INFO(backend << " " << transfer);
      Scene scene(incline, {R"(/bodies=[{"name": "a", "material": "m", "velocity": [1.5, 0],
                               "geometry": {"type": "ball", "centre": [0.25, 0.55], "radius": 0.1}}])",
                            "/contact=null", "/gravity=[4.905, 0]", set("/backend", backend),
                            set("/transfer/type", transfer), "/solver/time_step=0.0005"});
      const Totals start = scene.metrics.initial(), end = scene.run();
      const double way = 1.5 * 0.6 + 4.905 * 0.6 * 0.6 / 2;
      REQUIRE(way > 3 * 0.5);  // three turns
      const double gained = end.kinetic - start.kinetic;
      CHECK(gained == Approx(start.mass * 4.905 * way).epsilon(1e-9));  // uniform acceleration from 1.5 m/s
      CHECK(scene.simulation.ledger().gravity_without_potential == Approx(gained).epsilon(1e-9));
      CHECK(scene.simulation.ledger().gravity == 0);
      CHECK(end.gravitational == 0);
      CHECK(std::abs(scene.metrics.ledger_residual(end)) < 1e-9 * gained);
    }
}

TEST_CASE("friction heat of a sliding block is mu N s for every transfer, and the ledger closes",
          "[ledger][friction]") {
  const double mu = 0.15, weight = 100 * g * cosine;  // 100 kg press with N
  const double way = 0.5 * g * (sine - mu * cosine) * 0.6 * 0.6;
  for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER)) {
    std::vector<double> residuals;
    for (const std::string courant : {"0.3", "0.1", "0.03"}) {
      INFO(transfer->id() << " courant " << courant);
      Scene scene(incline, {set("/contact/friction", digits(mu)), set("/transfer/type", std::string(transfer->id())),
                            set("/solver/courant", courant)});
      const Totals end = scene.run();
      const Ledger& ledger = scene.simulation.ledger();
      CHECK(ledger.friction == Approx(mu * weight * way).epsilon(0.03));
      CHECK((ledger.friction_taken_back > 0.05 * ledger.friction) == takes_increments(*transfer));
      residuals.push_back(std::abs(scene.metrics.ledger_residual(end)));
      CHECK(residuals.back() < 0.002 * end.kinetic);
    }
    if (transfer->id() != "pic") continue;  // the others keep the shear vibration of the sudden start
    CHECK(residuals[1] < 0.4 * residuals[0]);
    CHECK(residuals[2] < 0.4 * residuals[1]);
  }
}

// With r the ramp and R its integral, N = r m g cos and v = a R, so that mu N v adds up to mu m g cos a R(T)^2 / 2.
TEST_CASE("friction heat of a block whose weight grows slowly is mu N s for every transfer", "[ledger][friction]") {
  constexpr double mu = 0.15, grown = 0.2;
  const std::string grows = "*(0.5*(1-cos(pi*t/0.2))*(t<0.2)+(t>=0.2))";
  const auto check = [&](const std::string& backend, const std::string& transfer, const std::string& courant) {
    INFO(backend << " " << transfer << " courant " << courant);
    Scene scene(incline, {"/gravity=[0, 0]", "/body_force=[\"4.905" + grows + "\", \"-8.495709211" + grows + "\"]",
                          set("/contact/friction", digits(mu)), set("/backend", backend),
                          set("/transfer/type", transfer), set("/solver/courant", courant)});
    const Totals end = scene.run();
    const double a = g * (sine - mu * cosine), R = end.time - grown / 2;
    const double heat = mu * 0.5 * end.mass * g * cosine * a * R * R / 2;
    const Ledger& ledger = scene.simulation.ledger();
    INFO("heat " << ledger.friction << " of " << heat << " J/m");
    CHECK(ledger.friction == Approx(heat).epsilon(0.01));
    CHECK(end.kinetic == Approx(0.25 * end.mass * a * a * R * R).epsilon(0.01));
    CHECK(std::abs(scene.metrics.ledger_residual(end)) < 0.01 * heat);
  };
  for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER))
    for (const std::string courant : {"0.3", "0.1", "0.03"}) check("cpu", std::string(transfer->id()), courant);
  for (const std::string transfer : {"flip", "apic"}) check("reference", transfer, "0.3");
}

TEST_CASE("friction heat of a sliding block is mu N s with filters", "[ledger][friction][filters]") {
  const double mu = 0.15, weight = 100 * g * cosine;
  const double way = 0.5 * g * (sine - mu * cosine) * 0.6 * 0.6;
  for (const std::string filter :
       {R"({"type": "fmpm", "order": 2})", R"({"type": "fmpm", "order": 4, "every_steps": 5})",
        R"({"type": "xpic", "order": 2})"})
    for (const std::string courant : {"0.3", "0.1"}) {
      INFO(filter << " courant " << courant);
      Scene scene(incline, {set("/contact/friction", digits(mu)), set("/transfer/type", "apic"), "/filter=" + filter,
                            set("/solver/courant", courant)});
      scene.run();
      CHECK(scene.simulation.ledger().friction == Approx(mu * weight * way).epsilon(0.03));
    }
}

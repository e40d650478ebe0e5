// Numbers of bodies, groups, probes and pairs against identities from outside: rigid bodies, a falling body, a bar under
// tension, linear fields, Newton's second law of each block of a stack.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"
#include "support/stacked_blocks.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A box about the point 1 m from every wall of a domain of 2 m, with cells of 0.1 m.
std::string box(int dimension, const std::string& transfer, const std::string& velocity, const std::string& output,
                const std::string& more = "") {
  const std::string zeros = dimension == 2 ? "[0, 0]" : "[0, 0, 0]", twos = dimension == 2 ? "[2, 2]" : "[2, 2, 2]";
  const std::string lower = dimension == 2 ? "[0.7, 0.8]" : "[0.7, 0.8, 0.9]",
                    upper = dimension == 2 ? "[1.3, 1.2]" : "[1.3, 1.2, 1.1]";
  return R"({"dimension": )" + std::to_string(dimension) + R"(, "grid": {"cell_size": 0.1, "domain": [)" + zeros + "," +
         twos + R"(], "boundaries": {"all": "free"}}, "shape": {"type": "bspline_quadratic"}, "transfer": )" +
         transfer +
         R"(, "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 1000, "poisson_ratio": 0, "density": 100}},
    "bodies": [{"name": "box", "material": "m", "geometry": {"type": "box", "lower": )" +
         lower + R"(, "upper": )" + upper + R"(}, "velocity": )" + velocity +
         R"(}], "solver": {"time_step": 1e-4, "end_time": 0.01}, "output": {"ledger": false, )" + output + "}" + more +
         "}";
}

/// M (a^2 + b^2) (1 - 1/n^2) / 12 of a lattice of points, n = 20 rows a metre; with the affine motion of a particle that
/// carries one, a second moment of h^2/4 an axis more.
double inertia(double mass, double a, double b, bool affine) {
  const auto side = [](double length) { return length * length - 0.05 * 0.05; };
  return mass * ((side(a) + side(b)) / 12 + (affine ? 2 * 0.1 * 0.1 / 4 : 0.0));
}

}  // namespace

TEST_CASE("a rigid body's spin, inertia, velocity and energy are those of mechanics", "[chosen]") {
  for (const char* transfer : {"flip", "apic"}) {
    INFO(transfer);
    const bool affine = transfer[0] == 'a';
    const std::string type = std::string(R"({"type": ")") + transfer + R"("})";
    const Scene scene(box(2, type, R"J(["0.5-3*(y-1)", "0.25+3*(x-1)"])J", R"("bodies": true)"));
    Numbers now = chosen(scene.metrics);
    const double mass = 100 * 0.6 * 0.4, I = inertia(mass, 0.6, 0.4, affine);
    CHECK(now["body box mass"] == Approx(mass).epsilon(1e-12));
    CHECK(now["body box moment of inertia z"] == Approx(I).epsilon(1e-9));
    CHECK(now["body box angular velocity z"] == Approx(3).epsilon(1e-7));
    CHECK(now["body box angular momentum z"] == Approx(3 * I).epsilon(1e-7));
    CHECK(now["body box velocity x"] == Approx(0.5).epsilon(1e-9));
    CHECK(now["body box momentum y"] == Approx(0.25 * mass).epsilon(1e-9));
    CHECK(now["body box centre of mass x"] == Approx(1).epsilon(1e-12));
    CHECK(now["body box kinetic energy"] == Approx(0.5 * mass * (0.25 + 0.0625) + 0.5 * I * 9).epsilon(1e-7));

    // About an oblique axis the spin is not along the angular momentum.
    const Scene solid(
        box(3, type, R"J(["2*(z-1)-3*(y-1)", "3*(x-1)-(z-1)", "(y-1)-2*(x-1)"])J", R"("bodies": ["box"])"));
    now = chosen(solid.metrics);
    const double M = 100 * 0.6 * 0.4 * 0.2, spin[3] = {1, 2, 3},
                 moments[3] = {inertia(M, 0.4, 0.2, affine), inertia(M, 0.6, 0.2, affine),
                               inertia(M, 0.6, 0.4, affine)};
    for (int c = 0; c < 3; ++c) {
      const std::string axis(1, "xyz"[c]);
      CHECK(now["body box angular velocity " + axis] == Approx(spin[c]).epsilon(1e-6));
      CHECK(now["body box moment of inertia " + axis] == Approx(moments[c]).epsilon(1e-9));
      CHECK(now["body box angular momentum " + axis] == Approx(spin[c] * moments[c]).epsilon(1e-6));
    }
  }
}

TEST_CASE("a falling body's momentum is its weight times the time; groups sum to their body", "[chosen]") {
  Scene scene(box(2, R"({"type": "apic"})", "[0.5, 0]", R"("bodies": true, "groups": [
      {"name": "left", "body": "box", "where": {"type": "half_space", "point": [1, 0], "normal": [1, 0]}},
      {"name": "right", "where": {"type": "half_space", "point": [1, 0], "normal": [-1, 0]}}])",
                  R"(, "gravity": [0, -10])"));
  scene.run_steps(50);
  Numbers now = chosen(scene.metrics);
  const double mass = 100 * 0.6 * 0.4, t = 50 * 1e-4;
  CHECK(now["body box momentum y"] == Approx(-mass * 10 * t).epsilon(1e-10));
  CHECK(now["body box momentum x"] == Approx(mass * 0.5).epsilon(1e-10));
  CHECK(now["group left mass"] == Approx(mass / 2).epsilon(1e-12));
  CHECK(now["group left centre of mass x"] == Approx(0.85 + 0.5 * t).epsilon(1e-10));
  for (const char* what :
       {"mass", "kinetic energy", "strain energy", "gravitational energy", "momentum x", "momentum y"})
    CHECK(now[std::string("group left ") + what] + now[std::string("group right ") + what] ==
          Approx(now[std::string("body box ") + what]).epsilon(1e-11).margin(1e-12));
  // What the file does not ask for has no column.
  const Scene bare(box(2, R"({"type": "apic"})", "[0, 0]", R"("bodies": false)"));
  CHECK(bare.metrics.chosen().rows().empty());
  for (const std::string& column : bare.metrics.columns())
    CHECK((!column.starts_with("body ") && !column.starts_with("probe ") && !column.starts_with("pair ")));
}

TEST_CASE("the force in a bar's middle section is E A eps, and its moment that of the lever", "[chosen]") {
  // The gradient of the velocity is exact inside, so that one step strains the bar by rate times the step.
  const double rate = 2, strain = rate * 1e-4, stress = 1000 * strain;
  const std::string cut = R"("probes": [{"name": "cut", "quantities": ["stress_xx"],
      "section": {"point": [1, 0.9], "normal": [2, 0]}}, {"name": "along", "section": {"point": [1, 1], "normal": [0, 1]}}])";
  Scene scene(box(2, R"({"type": "apic"})", R"J(["2*(x-1)", 0])J", cut));
  scene.run_steps(1);
  Numbers now = chosen(scene.metrics);
  CHECK(now["probe cut area"] == Approx(0.4).epsilon(1e-3));
  CHECK(now["probe cut stress_xx"] == Approx(stress).epsilon(1e-3));
  CHECK(now["probe cut force x"] == Approx(stress * 0.4).epsilon(1e-3));
  CHECK(now["probe cut force y"] == Approx(0).margin(1e-9));
  CHECK(now["probe cut moment z"] == Approx(-0.1 * stress * 0.4).epsilon(1e-3));  // the middle is 0.1 m above the point
  CHECK(now["probe along force y"] == Approx(0).margin(1e-9 * stress));
  CHECK(now["probe along force x"] == Approx(0).margin(1e-9 * stress));

  // Of a whole cylinder: A = pi R^2, along the axis.
  const std::string rings = R"J({"dimension": 2, "grid": {"cell_size": 0.1, "symmetry": "axisymmetric",
      "domain": [[0, 0], [1, 2]], "boundaries": {"all": "free", "x_min": "slip"}}, "shape": {"type": "bspline_quadratic"},
    "transfer": {"type": "apic"}, "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 1000,
      "poisson_ratio": 0, "density": 100}}, "bodies": [{"name": "bar", "material": "m", "geometry": {"type": "box",
      "lower": [0, 0.5], "upper": [0.3, 1.5]}, "velocity": [0, "2*(y-1)"]}],
    "solver": {"time_step": 1e-4, "end_time": 0.01}, "output": {"ledger": false, "bodies": true, "probes": [
      {"name": "cut", "section": {"point": [0, 1], "normal": [0, 1]}}]}})J";
  Scene cylinder(rings);
  cylinder.run_steps(1);
  now = chosen(cylinder.metrics);
  const double pi = std::acos(-1.0);
  CHECK(now["probe cut area"] == Approx(pi * 0.09).epsilon(1e-3));
  CHECK(now["probe cut force y"] == Approx(stress * pi * 0.09).epsilon(1e-3));
  CHECK(now["body bar mass"] == Approx(100 * pi * 0.09).epsilon(1e-12));
  CHECK(now.count("probe cut force x") == 0);
  CHECK(now.count("body bar angular velocity z") == 0);
}

TEST_CASE("probes in a linear field are exact, inside and at the edge, and say nothing beside it", "[chosen]") {
  const std::string probes = R"("probes": [
      {"name": "inside", "quantities": ["velocity_x", "velocity_y"], "place": [1.013, 0.957]},
      {"name": "corner", "quantities": ["velocity_x"], "place": [0.7, 0.8]},
      {"name": "beside", "quantities": ["velocity_x"], "place": [0.6, 1]},
      {"name": "particle", "quantities": ["velocity_x", "position_x", "displacement_y"], "nearest": [0.72, 0.81]},
      {"name": "line", "quantities": ["velocity_x"], "line": {"from": [0.5, 0.9], "to": [1.5, 1.1], "count": 11}}])";
  const auto field = [](double x, double y) { return 1 + 2 * x - 3 * y; };
  Scene scene(box(2, R"({"type": "flip"})", R"(["1+2*x-3*y", "x"])", probes));
  Numbers now = chosen(scene.metrics);
  CHECK(now["probe inside velocity_x"] == Approx(field(1.013, 0.957)).epsilon(1e-11));
  CHECK(now["probe inside velocity_y"] == Approx(1.013).epsilon(1e-11));
  CHECK(now["probe corner velocity_x"] == Approx(field(0.7, 0.8)).margin(1e-12));  // 0
  CHECK(std::isnan(now["probe beside velocity_x"]));
  CHECK(now["probe particle velocity_x"] == Approx(field(0.725, 0.825)).epsilon(1e-12));
  CHECK(now["probe particle position_x"] == Approx(0.725).epsilon(1e-12));
  CHECK(now["probe particle displacement_y"] == 0);
  const Profile profile = scene.metrics.chosen().profile(scene.experiment.output.probes[4]);
  REQUIRE(profile.columns ==
          std::vector<std::string>{"time (s)", "distance (m)", "x (m)", "y (m)", "velocity_x (m/s)"});
  REQUIRE(profile.rows.size() == 11);
  for (const std::vector<double>& row : profile.rows) {
    const bool material = row[2] > 0.69 && row[2] < 1.31;
    if (material) CHECK(row[4] == Approx(field(row[2], row[3])).epsilon(1e-10).margin(1e-12));
    if (row[2] < 0.65 || row[2] > 1.35) CHECK(std::isnan(row[4]));
  }
  CHECK(profile.rows[10][1] == Approx(std::hypot(1, 0.2)));
  // The particle is followed.
  scene.run_steps(20);
  const BodyState state = scene.body();
  now = chosen(scene.metrics);
  bool found = false;
  for (std::size_t k = 0; k < state.position.size(); k += 2)
    if (state.initial_position[k] == Approx(0.725) && state.initial_position[k + 1] == Approx(0.825)) {
      found = true;
      CHECK(now["probe particle position_x"] == state.position[k]);
      CHECK(now["probe particle displacement_y"] == state.position[k + 1] - state.initial_position[k + 1]);
    }
  CHECK(found);

  Scene solid(box(3, R"({"type": "flip"})", R"(["1+2*x-3*y+z", 0, 0])", R"("probes": [
      {"name": "inside", "quantities": ["velocity_x"], "place": [1.013, 0.957, 1.02]}])"));
  CHECK(chosen(solid.metrics)["probe inside velocity_x"] == Approx(field(1.013, 0.957) + 1.02).epsilon(1e-11));
}

TEST_CASE("a pair's force is what the block above it feels", "[chosen][pairs]") {
  for (const auto& [transfer, filter] : stacked_schemes())
    for (const char* backend : {"reference", "cpu"}) {
      INFO(transfer << filter << ", " << backend);
      Scene scene(stacked_blocks(backend, transfer, filter, "[0, -0.2]"));
      check_newton(scene.simulation, backend[0] == 'r' ? 12 : 60, 1e-8);
      Numbers now = chosen(scene.metrics);  // the faces are level
      CHECK(now["pair b1 b2 normal force"] == Approx(-now["pair b1 b2 force y"]));
      CHECK(now["pair b1 b2 normal force"] > 0);
      CHECK(std::abs(now["pair b1 b2 tangential force y"]) < 1e-9 * now["pair b1 b2 normal force"]);
      CHECK(std::abs(now["pair b1 b2 tangential force x"]) <
            0.01 * now["pair b1 b2 normal force"]);  // friction of both ways
    }
}

TEST_CASE("the pairs of three stacked blocks carry what lies above them", "[chosen][pairs]") {
  // Local damping brings the stack to rest and leaves weights as they are.
  Scene scene(stacked_blocks("cpu", R"({"type": "flip", "pic_fraction": 0.05})", ""),
              {"/solver/end_time=1.2", R"(/damping={"local": 0.5})"});
  scene.run();
  Numbers now = chosen(scene.metrics);
  CHECK(now["pair b1 b2 force y"] == Approx(-2 * block_weight).epsilon(1e-3));
  CHECK(now["pair b2 b3 force y"] == Approx(-block_weight).epsilon(1e-3));
  CHECK(now["pair b1 b2 normal force"] == Approx(2 * block_weight).epsilon(1e-3));
  CHECK(now["pair b2 b3 normal force"] == Approx(block_weight).epsilon(1e-3));
  CHECK(std::abs(now["pair b1 b2 tangential force y"]) < 1e-9 * block_weight);
}

// The walls of one cell strain all of it alike, s = 1 + v dt / h a step. Uniaxial stretch s of the neo-Hookean solid: Cauchy
// stresses (mu (s^2 - 1) + lambda ln s) / s along it and lambda ln s / s across.
TEST_CASE("extremes of pressure and von Mises stress are those of two solids in one stretch", "[chosen]") {
  const std::string cell = R"J({"dimension": 2, "grid": {"cell_size": 0.5, "domain": [[0, 0], [0.5, 0.5]],
      "boundaries": {"x_min": "slip", "x_max": {"type": "prescribed", "velocity": [0.2, 0]}, "y_min": "slip", "y_max": "slip"}},
    "shape": {"type": "linear"}, "transfer": {"type": "pic"},
    "materials": {"soft": {"type": "neo_hookean", "youngs_modulus": 100, "poisson_ratio": 0.3, "density": 1000},
                  "stiff": {"type": "neo_hookean", "youngs_modulus": 300, "poisson_ratio": 0.2, "density": 1000}},
    "bodies": [{"name": "a", "material": "soft", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.5, 0.25]}},
               {"name": "b", "material": "stiff", "geometry": {"type": "box", "lower": [0, 0.25], "upper": [0.5, 0.5]}}],
    "solver": {"time_step": 0.01, "end_time": 0.5}, "output": {"bodies": ["a"], "groups": [
      {"name": "both", "where": {"type": "half_space", "point": [0.5, 0], "normal": [1, 0]}}]}})J";
  const double s = std::pow(1 + 0.2 * 0.01 / 0.5, 50);
  const auto pressure = [&](double E, double nu) {
    return -(E / (2 * (1 + nu)) * (s * s - 1) + 3 * E * nu / ((1 + nu) * (1 - 2 * nu)) * std::log(s)) / (3 * s);
  };
  const auto von_mises = [&](double E, double nu) { return E / (2 * (1 + nu)) * (s * s - 1) / s; };
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(cell, {set("/backend", backend)});
    scene.run();
    Numbers now = chosen(scene.metrics);
    CHECK(now["body a smallest pressure"] == Approx(pressure(100, 0.3)).epsilon(1e-10));
    CHECK(now["body a largest pressure"] == Approx(pressure(100, 0.3)).epsilon(1e-10));
    CHECK(now["body a largest von Mises stress"] == Approx(von_mises(100, 0.3)).epsilon(1e-10));
    CHECK(now["group both smallest pressure"] == Approx(pressure(300, 0.2)).epsilon(1e-10));
    CHECK(now["group both largest pressure"] == Approx(pressure(100, 0.3)).epsilon(1e-10));
    CHECK(now["group both largest von Mises stress"] == Approx(von_mises(300, 0.2)).epsilon(1e-10));
  }
}

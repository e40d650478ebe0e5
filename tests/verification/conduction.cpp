// Conduction in a slab: each kind of end against its exact solution, a straight profile, and what insulation keeps.

#include "slab.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const ConductingPhase unit_material{1, 1, 1};

/// A slab with one kind of end, and what it should be.
struct Case {
  const char* name;
  Slab slab;
  std::function<double(double x, double t)> exact;
};

std::vector<Case> cases_of_ends() {
  const SlabOfFixedEnds fixed{unit_material, 1, 300, 310, 5};
  const SlabOfFlux flux{unit_material, 1, 20, 300, 5};
  const SlabOfConvection convection{unit_material, 1, 2, 290, 20};
  std::vector<Case> cases(3);
  cases[0] = {"fixed temperatures", {}, [=](double x, double t) { return fixed.temperature(x, t); }};
  cases[0].slab.x_min = R"({"type": "slip", "temperature": 300})";
  cases[0].slab.x_max = R"({"type": "stick", "temperature": 310})";
  cases[0].slab.start = "300 + 10*x + 5*sin(pi*x)";
  cases[1] = {"a flux", {}, [=](double x, double t) { return flux.temperature(x, t); }};
  cases[1].slab.x_min = R"({"type": "slip", "heat_flux": 20})";
  cases[1].slab.start = "300 + 10*(1 - x)^2 + 5*cos(pi*x)";
  cases[2] = {"convection", {}, [=](double x, double t) { return convection.temperature(x, t); }};
  cases[2].slab.x_min = R"({"type": "stick", "convection": {"coefficient": 2, "temperature": 290}})";
  cases[2].slab.start = "290 + 20*cos(" + digits(convection.root()) + "*(1 - x))";
  return cases;
}

/// The errors with 8, 16 ... cells.
std::vector<double> errors_of(const Case& slab_case, Slab slab, const std::vector<double>& cells) {
  std::vector<double> errors;
  for (const double count : cells) {
    slab.cells = static_cast<int>(count);
    Scene scene(slab.text());
    const Totals end = scene.run();
    errors.push_back(
        temperature_error(scene.body(), slab.dimension, [&](double x) { return slab_case.exact(x, slab.end); }));
    CHECK(relative_heat_residual(scene, end) < 1e-12);
  }
  return errors;
}

}  // namespace

TEST_CASE("conduction is of second order with every kind of end", "[temperature]") {
  for (const std::string& backend : heat_backends())
    for (const char* shape : {"bspline_quadratic", "bspline_cubic", "linear", "b2gimp"})
      for (const Case& with_end : cases_of_ends()) {
        Slab slab = with_end.slab;
        slab.backend = backend, slab.shape = shape;
        const auto errors = errors_of(with_end, slab, {8, 16, 32});
        INFO(backend << " " << shape << ", " << with_end.name << ": errors " << errors[0] << " " << errors[1] << " "
                     << errors[2] << " K");
        CHECK(errors[0] < 0.25);  // temperatures are 10 to 30 K
        CHECK(observed_order({1, 2, 4}, errors) == Approx(-2).margin(0.1));
      }
}

// The changes of temperature that the FLIP family takes from the grid are right only where the projection of the particles
// is: beyond a wall with a flux the mirror image needs the gradient there, which these transfers do not carry.
TEST_CASE("flip conducts with second order with every kind of end", "[temperature]") {
  for (const std::string& backend : heat_backends())
    for (const char* shape : {"bspline_quadratic", "gimp"})
      for (const Case& with_end : cases_of_ends()) {
        Slab slab = with_end.slab;
        slab.backend = backend, slab.shape = shape, slab.transfer = "\"flip\"";
        const auto errors = errors_of(with_end, slab, {8, 16, 32});
        INFO(backend << " " << shape << ", " << with_end.name << ": errors " << errors[0] << " " << errors[1] << " "
                     << errors[2] << " K");
        CHECK(-observed_order({1, 2, 4}, errors) > 1.9);
      }
}

// Where convection brings far more heat than a cell conducts, the wall is all but held at the temperature beyond it.
// FLIP on cubic splines is left out: its errors are as small, 0.04 K on 8 cells, and fall with order 0.5 only.
TEST_CASE("strong convection is of second order too, and stays between the temperatures that it meets",
          "[temperature]") {
  const auto ends = [](double coefficient) {
    Case strong = cases_of_ends()[2];
    const SlabOfConvection convection{unit_material, 1, coefficient, 290, 20};
    strong.exact = [=](double x, double t) { return convection.temperature(x, t); };
    strong.slab.x_min =
        R"({"type": "stick", "convection": {"temperature": 290, "coefficient": )" + digits(coefficient) + "}}";
    strong.slab.start = "290 + 20*cos(" + digits(convection.root()) + "*(1 - x))";
    return strong;
  };
  for (const std::string& backend : heat_backends())
    for (const char* shape : {"bspline_quadratic", "gimp"})
      for (const auto& [transfer, coefficient] : {std::pair{"flip", 50.0}, {"apic", 15.0}, {"apic", 50.0}}) {
        const Case strong = ends(coefficient);
        Slab slab = strong.slab;
        slab.backend = backend, slab.shape = shape, slab.transfer = "\"" + std::string(transfer) + "\"";
        const auto errors = errors_of(strong, slab, {8, 16, 32});
        INFO(backend << " " << shape << " " << transfer << ": errors " << errors[0] << " " << errors[1] << " "
                     << errors[2] << " K");
        CHECK(errors[0] < 0.3);
        CHECK(-observed_order({1, 2, 4}, errors) > 1.8);
      }
  for (const std::string& backend : heat_backends())
    for (const char* shape : {"bspline_quadratic", "linear", "gimp", "cpdi"})
      for (const char* transfer : {"pic", "flip", "apic", "mls", "tpic", "aflip", "asflip"}) {
        if (backend == "reference" && shape != std::string("bspline_quadratic")) continue;
        Slab slab = ends(80).slab;  // ten times what a cell conducts, and the step that bears it
        slab.backend = backend, slab.shape = shape, slab.transfer = "\"" + std::string(transfer) + "\"";
        slab.cells = 8, slab.fourier = 0.015, slab.end = 0.5, slab.start = "310";
        Scene scene(slab.text());
        const Totals end = scene.run();
        INFO(backend << " " << shape << " " << transfer);
        // FLIP keeps what the grid cannot see: here at most a tenth of the 20 K between the slab and its surroundings.
        CHECK(end.lowest_temperature > 290 - (transfer == std::string("flip") ? 2 : 0.1));
        CHECK(end.highest_temperature < 310.1);
      }
}

TEST_CASE("a bar in 3-D conducts as the strip does", "[temperature]") {
  for (const std::string& backend : heat_backends())
    for (const Case& with_end : cases_of_ends()) {
      Slab slab = with_end.slab;
      slab.backend = backend;
      const auto flat = errors_of(with_end, slab, {8});
      slab.dimension = 3;
      const auto solid = errors_of(with_end, slab, {8});
      INFO(backend << ", " << with_end.name);
      CHECK(solid[0] == Approx(flat[0]).epsilon(1e-9));
    }
}

TEST_CASE("every transfer keeps a straight profile between walls to rounding", "[temperature]") {
  for (const std::string& backend : heat_backends())
    for (const char* shape : {"bspline_quadratic", "bspline_cubic", "linear", "gimp", "cpdi"})
      for (const char* transfer : {"pic", "flip", "apic", "mls", "tpic", "aflip", "asflip"}) {
        Slab slab;
        slab.backend = backend, slab.shape = shape, slab.transfer = "\"" + std::string(transfer) + "\"";
        slab.x_min = R"({"type": "slip", "temperature": 300})", slab.x_max = R"({"type": "slip", "temperature": 340})";
        slab.start = "300 + 40*x", slab.cells = 8;
        INFO(backend << " " << shape << " " << transfer);
        Scene scene(slab.text());
        scene.run_steps(20);
        const BodyState state = scene.body();
        CHECK(temperature_error(state, 2, [](double x) { return 300 + 40 * x; }) < 1e-11);
        // The transfer also carries the gradient, 40 K/m along x.
        for (const char* name : {"temperature_of_affine_velocity", "temperature_of_velocity_gradient"}) {
          const auto found = state.host_state.find(name);
          if (found == state.host_state.end()) continue;
          for (std::size_t k = 0; k < found->second.size(); ++k)
            REQUIRE(std::abs(found->second[k] - (k % 2 == 0 ? 40 : 0)) < 1e-9);
        }
      }
}

TEST_CASE("a box of nodes gives its power, and holds its temperature", "[temperature]") {
  for (const std::string& backend : heat_backends()) {
    Slab slab;
    slab.backend = backend, slab.cells = 8, slab.start = "300";
    std::string text = slab.text();
    const std::string heated = R"("node_conditions": [{"type": "thermal", "lower": [0.5, 0], "upper": [0.75, 1],
      "heating": "100*t"}], "shape")";
    Scene scene(text.replace(text.find("\"shape\""), 7, heated));
    const Totals end = scene.run();
    // The power is the left Riemann sum of 100 t over the steps.
    double power = 0;
    const double dt = scene.simulation.largest_time_step();
    for (double t = 0; t < slab.end * (1 - 1e-9); t += dt) power += 100 * t * std::min(dt, slab.end - t);
    INFO(backend);
    CHECK(end.heat_content - scene.metrics.initial().heat_content == Approx(power).epsilon(1e-9));
    CHECK(scene.simulation.backend().heat_ledger().boxes == Approx(power).epsilon(1e-9));
    CHECK(relative_heat_residual(scene, end) < 1e-12);

    text = slab.text();
    Scene held(text.replace(text.find("\"shape\""), 7, R"("node_conditions": [{"type": "stick", "lower": [0, 0],
      "upper": [0.25, 1], "temperature": "300 + 20*t"}], "shape")"));
    const Totals warm = held.run();
    CHECK(held.simulation.backend().heat_ledger().boxes > 0);
    CHECK(relative_heat_residual(held, warm) < 1e-12);
    // Nodes within the box have its temperature, and the particles among them what lies between t and t + dt.
    const BodyState state = held.body();
    for (std::size_t p = 0; p < state.position.size() / 2; ++p)
      if (state.position[2 * p] < 0.125)
        REQUIRE(state.host_state.at("temperature")[p] == Approx(300 + 20 * slab.end).margin(1e-9));
  }
}

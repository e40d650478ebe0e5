// Stefan's problem: a front that melts or freezes its way into a slab (exact solutions: support/heat_solutions.hpp).

#include "slab.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

struct Front {
  double position, temperature;  ///< errors: over the way, and root mean square over the range of temperatures
};

/// The problem of one phase: a solid at its melting temperature beside a wall that is one kelvin warmer, until half of
/// it is melted.
Front melt(const std::string& backend, double stefan_number, int cells) {
  const StefanProblem exact{{1, 1, 1}, {1, 1, 1}, 1 / stefan_number, 301, 300, 300};
  Slab slab;
  slab.backend = backend, slab.cells = cells, slab.fourier = 0.2, slab.start = "300";
  slab.x_min = R"({"type": "slip", "temperature": 301})";
  slab.phase_change = R"(, "phase_change": {"temperature": 300, "latent_heat": )" + digits(1 / stefan_number) + "}";
  slab.end = std::pow(0.5 / (2 * exact.lambda()), 2);
  Scene scene(slab.text());
  const Totals end = scene.run();
  CHECK(relative_heat_residual(scene, end) < 1e-11);
  const BodyState state = scene.body();
  return {melted_length(state, slab) / exact.front(slab.end) - 1,
          temperature_error(state, 2, [&](double x) { return exact.temperature(x, slab.end); })};
}

/// The problem of two phases: water that freezes from a wall at -10 C for an hour. Returns the error of the front.
double freeze(const std::string& backend, double start, int cells) {
  const ConductingPhase ice{2.22, 2090, 917}, water{0.556, 4200, 917};
  const StefanProblem exact{ice, water, 334000, 263.15, 273.15, 273.15 + start};
  Slab slab;
  slab.backend = backend, slab.cells = cells, slab.fourier = 0.2, slab.length = 0.16, slab.end = 3600;
  slab.material = ice;
  slab.start = digits(273.15 + start + 1e-9);  // water starts above the melting temperature
  slab.x_min = R"({"type": "slip", "temperature": 263.15})";
  slab.phase_change = R"(, "phase_change": {"temperature": 273.15, "latent_heat": "334 kJ/kg",
    "melted": {"conductivity": 0.556, "heat_capacity": 4200}})";
  Scene scene(slab.text());
  const Totals end = scene.run();
  CHECK(relative_heat_residual(scene, end) < 1e-11);
  return (slab.length - melted_length(scene.body(), slab)) / exact.front(slab.end) - 1;
}

/// Checks that the error falls with the cell size, about as h: the front is somewhere in a cell.
void check_falling(const std::vector<double>& errors, double last) {
  for (std::size_t k = 1; k < errors.size(); ++k) CHECK(std::abs(errors[k]) < 0.62 * std::abs(errors[k - 1]));
  CHECK(std::abs(errors.back()) < last);
}

}  // namespace

TEST_CASE("a melting front moves as Stefan's solution of one phase", "[temperature]") {
  for (const std::string& backend : heat_backends())
    for (const double stefan_number : {0.05, 0.1, 0.5, 1.0}) {
      std::vector<double> positions, temperatures;
      for (const int cells : {8, 16}) {
        const Front error = melt(backend, stefan_number, cells);
        positions.push_back(error.position), temperatures.push_back(error.temperature);
      }
      INFO(backend << ", Stefan number " << stefan_number << ": errors " << positions[0] << " " << positions[1] << ", "
                   << temperatures[0] << " " << temperatures[1] << " K");
      check_falling(positions, 0.014);
      CHECK(temperatures[1] < temperatures[0]);
      CHECK(temperatures[1] < 0.02);
    }
}

TEST_CASE("water freezes from a cold wall as Neumann's solution of two phases", "[temperature]") {
  for (const std::string& backend : heat_backends()) {
    std::vector<double> warm;
    for (const int cells : {16, 32}) warm.push_back(freeze(backend, 10, cells));
    INFO(backend << ": errors " << warm[0] << " " << warm[1]);
    check_falling(warm, 0.04);
    CHECK(std::abs(freeze(backend, 0, 32)) < 0.002);
  }
}

TEST_CASE("fronts converge on fine grids", "[temperature][slow]") {
  for (const std::string& backend : heat_backends()) {
    std::vector<double> warm;
    for (const int cells : {16, 32, 64}) warm.push_back(freeze(backend, 10, cells));
    INFO(backend << ": errors " << warm[0] << " " << warm[1] << " " << warm[2]);
    check_falling(warm, 0.02);
    for (const double stefan_number : {0.1, 1.0}) {
      std::vector<double> positions;
      for (const int cells : {8, 16, 32}) positions.push_back(melt(backend, stefan_number, cells).position);
      INFO(backend << ", Stefan number " << stefan_number << ": errors " << positions[0] << " " << positions[1] << " "
                   << positions[2]);
      check_falling(positions, 0.006);
    }
  }
}

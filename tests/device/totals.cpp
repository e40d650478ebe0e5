// Totals that a device sums itself are those that the host makes of the particles' state.

#include "backends/device/kernels/sums.hpp"
#include "device/covering.hpp"
#include "metrics/body_sums.hpp"
#include "simulation/offers_totals.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The totals as the host makes them of what it reads.
Totals totals_by_state(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  Totals totals = no_totals(experiment);
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyView view(simulation, body);
    for (std::size_t p = 0; p < view.count; ++p) {
      add_particle(view, p, totals);
      if (experiment.has_temperature()) add_heat(view, p, totals);
    }
  }
  refer_to_centre_of_mass(totals);
  return totals;
}

/// Checks totals to some roundings of the sizes that they are sums of. Energies of strain are found in double precision from
/// the state, whatever its own: 1 J/kg is Young's modulus over the density in these scenes.
void check_totals(const Totals& expected, const Totals& found, double epsilon) {
  constexpr double roundings = 1e3;
  const auto check = [&](const char* name, double wanted, double value, double size, double unit) {
    INFO(name);
    CHECK(std::abs(value - wanted) <= roundings * unit * size);
  };
  const double double_epsilon = epsilon_of("double"), mass = expected.mass;
  check("mass", mass, found.mass, mass, double_epsilon);
  check("strain energy", expected.strain, found.strain, mass + expected.strain, double_epsilon);
  check("kinetic energy", expected.kinetic, found.kinetic, expected.kinetic, epsilon);
  check("gravitational energy", expected.gravitational, found.gravitational, mass, double_epsilon);
  for (std::size_t c = 0; c < 3; ++c) {
    check("momentum", expected.momentum[c], found.momentum[c], expected.momentum_scale, double_epsilon);
    check("angular momentum", expected.angular_momentum[c], found.angular_momentum[c], expected.angular_momentum_scale,
          epsilon);
    check("centre of mass", expected.centre_of_mass[c], found.centre_of_mass[c], 1, double_epsilon);
  }
  check("momentum scale", expected.momentum_scale, found.momentum_scale, expected.momentum_scale, double_epsilon);
  check("spin scale", expected.angular_momentum_scale, found.angular_momentum_scale, expected.angular_momentum_scale,
        double_epsilon);
  check("smallest J", expected.smallest_volume_ratio, found.smallest_volume_ratio, 1, double_epsilon);
  check("largest J", expected.largest_volume_ratio, found.largest_volume_ratio, 1, double_epsilon);
  check("speed", expected.largest_speed, found.largest_speed, 1, double_epsilon);
  const double heat = std::abs(expected.heat_content) + std::abs(expected.latent_heat);
  check("heat", expected.heat_content, found.heat_content, heat, epsilon);
  check("latent heat", expected.latent_heat, found.latent_heat, heat, epsilon);
  CHECK(found.lowest_temperature == expected.lowest_temperature);
  CHECK(found.highest_temperature == expected.highest_temperature);
}

void check_mix(const Mix& mix, const std::string& precision) {
  if (!is_chosen_check()) return;
  INFO(mix.name() << " " << precision);
  DeviceScene scene(mix.text(), precision, {}, mix.overrides);
  REQUIRE(dynamic_cast<const OffersTotals*>(&scene.simulation.backend()));
  check_totals(totals_by_state(scene.simulation), scene.metrics.initial(), epsilon_of(precision));
  for (int step = 0; step < 6; ++step) scene.simulation.step();
  const Totals expected = totals_by_state(scene.simulation);
  REQUIRE(expected.strain > 0);
  check_totals(expected, scene.metrics.measure(), epsilon_of(precision));
}

/// What a measurement of a scene copies from the host-run device, and how often it waits.
std::pair<std::uint64_t, long> cost_of_measuring() {
  const DeviceScene scene(Mix{}.text(), "double");
  const std::uint64_t bytes = device::bytes_copied_on_host();
  const long waits = device::calls_on_host("cuStreamSynchronize");
  scene.metrics.measure();
  return {device::bytes_copied_on_host() - bytes, device::calls_on_host("cuStreamSynchronize") - waits};
}

}  // namespace

TEST_CASE("totals that the host-run device sums are those of the particles' state, in every scene",
          "[device][totals]") {
  for (const int dimension : {2, 3}) {
    std::size_t turn = 0;
    for (const Mix& mix : every_kernel(dimension)) {
      const bool melts = mix.material.find("phase_change") != mix.material.npos;
      check_mix(mix, turn % 2 == 0 ? "double" : "float");
      if (melts) check_mix(mix, turn % 2 == 0 ? "float" : "double");
      ++turn;
    }
  }
  for (const std::string precision : {"double", "float"})
    for (const std::string shape : {"linear", "bspline_cubic", "cpdi"}) {
      Mix rings;
      rings.shape = R"({"type": ")" + shape + R"("})";
      rings.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
      check_mix(rings, precision);
    }
}

TEST_CASE("measuring waits for the host-run device once a body and copies sums alone", "[device][totals]") {
  const auto [bytes, waits] = cost_of_measuring();
  CHECK(waits == 2);
  CHECK(bytes < 2 * 30 * sizeof(double));
}

TEST_CASE("extremes over particles begin with the first one, and what is no number stays", "[device][totals]") {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const auto joined = [](std::array<double, 3> values, const std::array<double, 3>& more) {
    device::AddingParticles::join(values.data(), more.data(), 3, 1);
    return values;
  };
  using Values = std::array<double, 3>;
  CHECK(joined({0, 0, 0}, {2, 5, -7}) == Values{2, 5, -7});  // no particle before: zero is no value
  CHECK(joined({1, 3, -9}, {0, 0, 0}) == Values{1, 3, -9});  // none to add
  CHECK(joined({1, 3, -9}, {2, 5, -7}) == Values{3, 8, -7});
  CHECK(joined({1, 3, -4}, {2, 5, -7}) == Values{3, 8, -4});
  CHECK(std::isnan(joined({1, 3, -4}, {1, 0, none})[2]));
  CHECK(std::isnan(joined({1, 3, none}, {1, 0, 5})[2]));
}

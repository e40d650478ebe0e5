// Bodies that begin displaced, strained or stressed, against what is exact.

#include <cmath>
#include <numbers>

#include "metrics/particle_quantities.hpp"
#include "shipped.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double pi = std::numbers::pi;

/// A scene of one body at rest, with further keys of the body.
std::string at_rest(const std::string& body, const std::string& material, int dimension = 2,
                    const std::string& grid = "") {
  const std::string flat = dimension == 2 ? "" : ", 0", full = dimension == 2 ? "" : ", 0.6";
  return R"({"dimension": )" + std::to_string(dimension) + R"(, "grid": {"cell_size": 0.1, "domain": [[0, 0)" + flat +
         "], [1, 1" + (dimension == 2 ? "" : ", 1") + "]]" + grid +
         R"(}, "shape": {"type": "cpdi"}, "transfer": {"type": "apic"}, "materials": {"m": )" + material +
         R"(}, "bodies": [{"name": "b", "material": "m", )" + body +
         R"(, "geometry": {"type": "box", "lower": [0.2, 0.2)" + (dimension == 2 ? "" : ", 0.2") +
         R"(], "upper": [0.6, 0.6)" + full + R"(]}}], "solver": {"time_step": 1e-5, "end_time": 1}})";
}

const std::string rubber = R"({"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000})";
constexpr double lambda = 1000 * 0.3 / (1.3 * 0.4), mu = 1000 / 2.6;

std::vector<double> cauchy_of(const Scene& scene) {
  const BodyState state = scene.body();
  const MaterialQuantities material = material_quantities(scene.experiment, 0, state);
  std::vector<double> stress = material.stress;
  const std::size_t components = scene.experiment.dimension == 2 ? 4 : 6;
  for (std::size_t k = 0; k < stress.size(); ++k) stress[k] /= material.volume_ratio[k / components];
  return stress;
}

}  // namespace

TEST_CASE("a manufactured wave that begins with a phase follows the exact solution", "[verification][wave]") {
  // Second order in space from u != 0, as from u = 0.
  std::vector<double> cells, errors;
  for (const int count : {8, 16, 32}) {
    ShippedScene scene("studies/wave_with_phase.json",
                       {set("/grid/cell_size", digits(1.0 / count)), set("/solver/end_time", "0.005")});
    const Totals start = scene.metrics.initial();
    CHECK(start.position_error_max < 1e-14);  // it begins where the solution is
    CHECK(start.velocity_error_max < 1e-11);
    const Totals end = scene.run();
    cells.push_back(1.0 / count), errors.push_back(end.position_error_rms / 0.05);
  }
  INFO(errors[0] << " " << errors[1] << " " << errors[2]);
  CHECK(observed_order(cells, errors) > 1.7);
}

TEST_CASE("an initial displacement strains the material by its gradient", "[verification][seeding]") {
  // u = (0.1 X + 0.2 Y, -0.05 Y): F is known, and with it the stress of the Neo-Hookean solid.
  Scene scene(at_rest(R"("initial_displacement": ["0.1*X+0.2*Y", "-0.05*Y"], "velocity": ["X", "x"])", rubber));
  const BodyState state = scene.body();
  const double J = 1.1 * 0.95;  // of F = (1.1, 0.2; 0, 0.95)
  const std::vector<double>& kept = state.material_state.at("deformation_gradient");
  const std::vector<double> stress = cauchy_of(scene);
  for (std::size_t p = 0; p < state.position.size() / 2; ++p) {
    const std::size_t components = kept.size() / (state.position.size() / 2);
    CHECK(kept[p * components + 1] == Approx(0.2).epsilon(1e-9));
    CHECK(stress[4 * p] == Approx((mu * (1.21 + 0.04 - 1) + lambda * std::log(J)) / J).epsilon(1e-8));
    CHECK(stress[4 * p + 3] == Approx(mu * 0.2 * 0.95 / J).epsilon(1e-8));
    // x = F X; the domain is F times the particle's box of 0.05 m.
    const double Y = state.position[2 * p + 1] / 0.95, X = (state.position[2 * p] - 0.2 * Y) / 1.1;
    CHECK(state.domain[4 * p] == Approx(1.1 * 0.025).epsilon(1e-9));
    CHECK(state.domain[4 * p + 1] == Approx(0.2 * 0.025).epsilon(1e-9));
    CHECK(state.velocity[2 * p] == Approx(X).epsilon(1e-12));
    CHECK(state.velocity[2 * p + 1] == Approx(state.position[2 * p]).epsilon(1e-12));
    // The velocity's gradient by the place: of X it is F^-1, of x the identity.
    const std::vector<double>& C = state.transfer_state.begin()->second;
    CHECK(C[4 * p] == Approx(1 / 1.1).epsilon(1e-7));
    CHECK(C[4 * p + 1] == Approx(-0.2 / (1.1 * 0.95)).epsilon(1e-7));
    CHECK(C[4 * p + 2] == Approx(1).epsilon(1e-7));
  }
}

TEST_CASE("rings begin stretched around the axis", "[verification][seeding][axisymmetric]") {
  Scene scene(at_rest(R"("initial_displacement": ["0.1*X", 0])", rubber, 2, R"(, "symmetry": "axisymmetric")"));
  const BodyState state = scene.body();
  const std::vector<double> stress = cauchy_of(scene);
  const double J = 1.21, plane = (mu * 0.21 + lambda * std::log(J)) / J;
  double volume = 0;
  for (std::size_t p = 0; p < state.position.size() / 2; ++p) {
    CHECK(stress[4 * p] == Approx(plane).epsilon(1e-8));
    CHECK(stress[4 * p + 2] == Approx(plane).epsilon(1e-8));  // the hoop
    CHECK(state.size[p] == Approx(2 * pi * state.position[2 * p] / 1.1).epsilon(1e-12));
    volume += state.volume * state.size[p];
  }
  CHECK(volume == Approx(pi * (0.36 - 0.04) * 0.4).epsilon(1e-12));  // as undeformed
}

TEST_CASE("every elastic material begins with the stress that is asked for", "[verification][seeding]") {
  const std::string moduli = R"(", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000)";
  for (const std::string type :
       {"neo_hookean", "linear_elastic", "fixed_corotated", "corotated", "hencky", "von_mises", "drucker_prager"}) {
    INFO(type);
    const std::string more = type == "von_mises"        ? R"(, "yield_stress": 400})"
                             : type == "drucker_prager" ? R"(, "friction_angle": 0.6})"
                                                        : "}";
    const std::string material = "{\"type\": \"" + type + moduli + more;
    Scene flat(at_rest(R"("initial_stress": {"xx": "-100-50*X", "yy": -120, "xy": "20*Y"})", material));
    const std::vector<double> stress = cauchy_of(flat);
    const BodyState state = flat.body();
    for (std::size_t p = 0; p < state.position.size() / 2; ++p) {
      CHECK(stress[4 * p] == Approx(-100 - 50 * state.position[2 * p]).epsilon(1e-8));
      CHECK(stress[4 * p + 1] == Approx(-120).epsilon(1e-8));
      CHECK(stress[4 * p + 3] == Approx(20 * state.position[2 * p + 1]).epsilon(1e-8));
    }
    Scene solid(
        at_rest(R"("initial_stress": {"xx": -100, "yy": -90, "zz": -110, "yz": 8, "xz": -5, "xy": 12})", material, 3));
    const std::vector<double> full = cauchy_of(solid);
    const double wanted[] = {-100, -90, -110, 8, -5, 12};
    for (std::size_t k = 0; k < full.size(); ++k) CHECK(full[k] == Approx(wanted[k % 6]).epsilon(1e-8));
  }
  Scene rings(
      at_rest(R"("initial_stress": {"xx": -10, "yy": -20, "zz": -30})", rubber, 2, R"(, "symmetry": "axisymmetric")"));
  const std::vector<double> stress = cauchy_of(rings);
  for (std::size_t p = 0; p < stress.size() / 4; ++p) CHECK(stress[4 * p + 2] == Approx(-30).epsilon(1e-8));
}

TEST_CASE("materials with a rate begin in equilibrium: no stress of the rate, and what relaxes has relaxed",
          "[verification][seeding]") {
  const std::string sheared = R"("initial_deformation_gradient": {"xy": 0.2})";
  // Beside the strain by the first step, of 1e-5 s from rest, shear stress is the equilibrium modulus times 0.2.
  const std::pair<std::string, double> rows[] = {
      {R"({"type": "kelvin_voigt", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000, "viscosity": 50})",
       mu * 0.2},
      {R"({"type": "prony", "shear_modulus": 300, "bulk_modulus": 800, "density": 1000, "branch_modulus_1": 400,
           "relaxation_time_1": 2, "branch_modulus_2": 0, "relaxation_time_2": 1})",
       300 * 0.2},
      {R"({"type": "oldroyd_b", "bulk_modulus": 800, "density": 1000, "polymer_viscosity": 50, "relaxation_time": 2,
           "solvent_viscosity": 5})",
       0.0}};
  for (const auto& [material, expected] : rows) {
    CAPTURE(material);
    const Scene scene(at_rest(sheared, material));
    const std::vector<double> stress = cauchy_of(scene);
    for (std::size_t p = 0; p < stress.size() / 4; ++p)
      REQUIRE(stress[4 * p + 3] == Approx(expected).epsilon(1e-9).margin(1e-9));
  }
}

TEST_CASE("stress that a material cannot have, and displacements that cannot be, are refused with their place",
          "[verification][seeding]") {
  const auto refused = [](const std::string& text) {
    try {
      Scene scene(text);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const std::string steel =
      R"({"type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 10})";
  CHECK_THAT(
      refused(at_rest(R"("initial_stress": {"xy": 20})", steel)),
      ContainsSubstring("/bodies/0/initial_stress") && ContainsSubstring("material \"m\" this stress at (0.225, "));
  for (const char* nowhere : {"sqrt(-X)", "1/(X-0.225)"})
    CHECK_THAT(refused(at_rest(R"("initial_stress": {"xy": ")" + std::string(nowhere) + "\"}", rubber)),
               ContainsSubstring("/bodies/0/initial_stress") && ContainsSubstring("xy: is not a finite number at ("));
  CHECK_THAT(refused(at_rest(R"("initial_displacement": ["-2*X+1", 0])", rubber)),
             ContainsSubstring("/bodies/0/initial_displacement: ") && ContainsSubstring("inside out"));
  CHECK_THAT(refused(at_rest(R"("initial_displacement": ["0.5", 0])", rubber)),
             ContainsSubstring("moves a particle out of the domain"));
}

TEST_CASE("seeded bodies fly and turn as their mass says", "[verification][seeding]") {
  // A ball of partial particles keeps mass, momentum and spin; the ledger's book of mass stays empty.
  for (const std::string seeding : {"fitted", "partial", "random", "blue_noise"}) {
    INFO(seeding);
    Scene scene(R"({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [2, 2]]},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "materials": {"m": )" +
                rubber + R"(}, "bodies": [{"name": "b", "material": "m", "seeding": ")" + seeding +
                R"(", "geometry": {"type": "ball", "centre": [0.7313, 0.7171], "radius": 0.4}, "velocity": [2, 1]}],
      "solver": {"end_time": 0.2}})");
    const Totals start = scene.metrics.initial(), end = scene.run();
    CHECK(start.mass == Approx(1000 * pi * 0.16).epsilon(1e-4));
    CHECK(end.momentum[0] == Approx(2 * start.mass).epsilon(1e-12));
    CHECK(end.centre_of_mass[0] == Approx(0.7313 + 0.4).margin(1e-5));
    CHECK(end.total_energy() == Approx(start.total_energy()).epsilon(1e-10));
    CHECK(std::abs(scene.simulation.ledger().mass_book) < 1e-9);
  }
}

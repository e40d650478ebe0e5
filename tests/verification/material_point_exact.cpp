// One particle of a material along imposed paths, against forms that are exact at any strain: to rounding, and not to the order of
// the strain as tests/verification/material_point.cpp has it of the small-strain forms.

#include <cmath>
#include <string>

#include "drive/results.hpp"
#include "driven_path.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::drive;
using namespace mpm::driven_path;

namespace {

constexpr double shear = 1000, bulk = 2000, yield = 10;

Json metal(const std::string& energy) {
  return {{"type", "von_mises"},
          {"youngs_modulus", 9 * bulk * shear / (3 * bulk + shear)},
          {"poisson_ratio", (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear))},
          {"density", 1000},
          {"yield_stress", yield},
          {"volumetric_energy", energy}};
}

/// J U'(J) of the volumetric energies, over K.
double volumetric(const std::string& energy, double J) {
  return energy == "logarithmic" ? std::log(J) : energy == "quadratic" ? J * (J - 1) : (J * J - 1) / 2;
}

/// Concrete of ft = 3 MPa, E = 30 GPa and Gc = 100 J/m^2, pulled along x with free sides to the logarithmic strain `strain`.
Course pulled(const std::string& softening, double cell_size, double strain, int steps) {
  const Json concrete{{"type", "damage"},        {"youngs_modulus", 30e9}, {"poisson_ratio", 0.2},  {"density", 2400},
                      {"tensile_strength", 3e6}, {"fracture_energy", 100}, {"softening", softening}};
  const Json pull = stage({{"xx", "exp(" + Json(strain).dump() + "*t)"}}, steps, {{"yy", 0}, {"zz", 0}});
  return follow(path_of(concrete, Json::array({pull}), 3, cell_size));
}

}  // namespace

// Once all of it flows the deviator has the length of the yield stress and the direction of the path: (2, -1, -1)/3 times it.
TEST_CASE("material point: a metal that flows has its yield stress and the pressure of its volume at any strain") {
  for (const std::string energy : {"logarithmic", "quadratic", "simo"})
    for (const double stretch : {0.7, 0.95, 1.05, 1.5})
      for (const int steps : {10, 200}) {
        CAPTURE(energy, stretch, steps);
        const double sign = stretch > 1 ? 1 : -1;
        const std::string along = "1 + " + Json(stretch - 1).dump() + "*t";
        const Row held = end_of(driven(metal(energy), Json::array({stage({{"xx", along}}, steps)})));
        const double pressed = bulk * volumetric(energy, stretch);
        CHECK(held.response.cauchy(0, 0) == Approx((pressed + sign * 2 * yield / 3) / stretch).epsilon(1e-10));
        CHECK(held.response.cauchy(1, 1) == Approx((pressed - sign * yield / 3) / stretch).epsilon(1e-10));
        const Row free =
            end_of(driven(metal(energy), Json::array({stage({{"xx", along}}, steps, {{"yy", 0}, {"zz", 0}})})));
        // tau_xx = 3 J U'(J) = yield stress, of which the volume and the sides' stretch follow.
        const double J = free.F(0, 0) * free.F(1, 1) * free.F(2, 2);
        CHECK(J * free.response.cauchy(0, 0) == Approx(sign * yield).epsilon(1e-10));
        CHECK(3 * bulk * volumetric(energy, J) == Approx(sign * yield).epsilon(1e-9));
      }
}

TEST_CASE("material point: concrete loses its strength over 2 Gc/(ft h), and dissipates Gc, on bands of three widths") {
  for (const double h : {0.01, 0.02, 0.05}) {
    CAPTURE(h);
    const double end = 2 * 100 / (3e6 * h), onset = 3e6 / 30e9;  // 6.667e-3, 3.333e-3 and 1.333e-3 of strain
    const Course half = pulled("linear", h, (end + onset) / 2, 500);
    const Row& row = end_of(half);
    const double J = row.F(0, 0) * row.F(1, 1) * row.F(2, 2);
    CHECK(J * row.response.cauchy(0, 0) == Approx(1.5e6).epsilon(1e-9));
    // Below the curve down to there, less what unloading gives back.
    CHECK(row.dissipated == Approx(100 / h - 1.5e6 * end / 2).epsilon(1e-9));
    const Course whole = pulled("linear", h, 1.01 * end, 500);
    CHECK(std::abs(end_of(whole).response.cauchy(0, 0)) < 1e-3);
    CHECK(end_of(whole).dissipated * h == Approx(100).epsilon(1e-9));
    // Exponential: ft exp(-(e - onset)/es) with the area Gc/h below the whole curve.
    const double es = 100 / (h * 3e6) - onset / 2;
    const Row faded = end_of(pulled("exponential", h, onset + 2 * es, 500));
    const double volume = faded.F(0, 0) * faded.F(1, 1) * faded.F(2, 2);
    CHECK(volume * faded.response.cauchy(0, 0) == Approx(3e6 * std::exp(-2)).epsilon(1e-9));
  }
}

// p = p_H (1 - G x/2) + G E. The integral of dE = -p dJ from rest was taken by mpmath with 30 digits.
TEST_CASE("material point: copper that is pressed without a shock is off its Hugoniot by the heat it lacks") {
  const Json copper{{"type", "mie_gruneisen"}, {"bulk_modulus", 8930. * 3940 * 3940}, {"density", 8930}};
  struct Case {
    double J, cold, pressure;
  };
  for (const auto& [J, cold, pressure_exact] : {Case{0.95, 7.688684e9, 8.0703610077e9},
                                                {0.9, 1.723322e10, 1.89314482217e10},
                                                {0.8, 4.503859e10, 5.35995689791e10},
                                                {0.7, 9.529530e10, 1.20405357382e11}}) {
    CAPTURE(J);
    const Json press = stage({{"xx", "1 + " + Json(J - 1).dump() + "*t"}}, 100);
    Json still = copper;
    still["quadratic_viscosity"] = 0, still["linear_viscosity"] = 0;
    const Row row = end_of(follow(path_of(still, Json::array({press}), 3, 1.0)));
    CHECK(pressure(row.response) == Approx(pressure_exact).epsilon(1e-9));
    CHECK(pressure(row.response) - 1.99 * row.response.stored == Approx(cold).epsilon(3e-7));
    CHECK(row.work == Approx(row.response.stored).epsilon(1e-4));
  }
}

// One particle of a material along imposed paths of strain and stress, against closed forms: the driver, and through it the
// materials as plugins.

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "drive/results.hpp"
#include "drive/standard_paths.hpp"
#include "driven_path.hpp"
#include "support/catch.hpp"
#include "support/fixture_materials.hpp"

using namespace mpm;
using namespace mpm::drive;
using namespace mpm::driven_path;

namespace {

constexpr double young = 1000, poisson = 0.3, mu = 384.615384615384615, lambda = 576.923076923076923;
const std::array<std::string, 3> energies{"logarithmic", "quadratic", "simo"};

Json rubber(const std::string& energy) {
  return {{"type", "neo_hookean"},
          {"youngs_modulus", young},
          {"poisson_ratio", poisson},
          {"density", 1000},
          {"volumetric_energy", energy}};
}

Json elastic(const std::string& type) {
  return {{"type", type}, {"youngs_modulus", young}, {"poisson_ratio", poisson}, {"density", 1000}};
}

/// Axial and lateral stress, or the sides' stretch and the axial stress, of the three volumetric energies.
struct Pairs {
  double stretch;
  std::array<std::array<double, 2>, 3> values;
};

}  // namespace

TEST_CASE("material point: Neo-Hookean in uniaxial strain, three volumetric energies") {
  const Pairs rows[] = {{0.5, {{{-1376.708285, -799.785208}, {-865.384615, -288.461538}, {-1009.615385, -432.692308}}}},
                        {0.8, {{{-333.997753, -160.920830}, {-288.461538, -115.384615}, {-302.884615, -129.807692}}}},
                        {1.5, {{{476.460939, 155.948119}, {608.974359, 288.461538}, {560.897436, 240.384615}}}},
                        {2, {{{776.869379, 199.946302}, {1153.846154, 576.923077}, {1009.615385, 432.692308}}}}};
  for (const Pairs& row : rows)
    for (int k = 0; k < 3; ++k)
      for (const int steps : {1, 30}) {
        CAPTURE(row.stretch, energies[k], steps);
        const std::string ramp = "1 + " + std::to_string(row.stretch - 1) + "*t";
        const Course course = driven(rubber(energies[k]), Json::array({stage({{"xx", ramp}}, steps)}));
        const Response& end = end_of(course).response;
        CHECK(end.cauchy(0, 0) == Approx(row.values[k][0]).epsilon(1e-8));
        CHECK(end.cauchy(1, 1) == Approx(row.values[k][1]).epsilon(1e-8));
        CHECK(end.cauchy(2, 2) == Approx(row.values[k][1]).epsilon(1e-8));
      }
}

TEST_CASE("material point: Neo-Hookean in uniaxial stress, the sides found by Newton's method") {
  const Pairs rows[] = {{0.5, {{{1.21076739, -638.048474}, {1.15470054, -625.0}, {1.17834984, -630.731284}}}},
                        {1.5, {{{.88017459, 488.287861}, {.87186846, 502.544650}, {.87423283, 498.445007}}}},
                        {2, {{{.79807754, 1015.412883}, {.77950319, 1073.654855}, {.78426354, 1058.333134}}}}};
  for (const Pairs& row : rows)
    for (int k = 0; k < 3; ++k)
      for (const int steps : {1, 20})
        for (const Slopes slopes : {Slopes::tangent, Slopes::differences}) {
          CAPTURE(row.stretch, energies[k], steps);
          const std::string ramp = "1 + " + std::to_string(row.stretch - 1) + "*t";
          const Json path = Json::array({stage({{"xx", ramp}}, steps, {{"yy", 0}, {"zz", 0}})});
          const Course course = driven(rubber(energies[k]), path, 3, slopes);
          const Row& end = end_of(course);
          CHECK(end.F(1, 1) == Approx(row.values[k][0]).epsilon(1e-7));
          CHECK(end.F(2, 2) == Approx(row.values[k][0]).epsilon(1e-7));
          CHECK(end.response.cauchy(0, 0) == Approx(row.values[k][1]).epsilon(1e-8));
          CHECK(std::abs(end.response.cauchy(1, 1)) < 1e-8);
          if (steps == 20) CHECK(course.iterations <= 5 * steps);  // quadratic convergence: the slopes are right
        }
}

TEST_CASE("material point: Newton's method takes no more steps with the plugin's tangent than with differences") {
  const Json sides{{"yy", -600}, {"zz", -600}, {"xy", 200}};
  for (const Json& motion : {Json{{"deformation_gradient", {{"xx", "1 + t"}, {"yz", "t"}}}},
                             Json{{"velocity_gradient", {{"xx", "1"}, {"zx", "t"}}}}}) {
    Json path = motion;
    path["steps"] = 20, path["stress"] = sides;
    const Course by_tangent = driven(rubber("simo"), Json::array({path})),
                 by_differences = driven(rubber("simo"), Json::array({path}), 3, Slopes::differences);
    CHECK(by_tangent.iterations <= by_differences.iterations + 1);
    CHECK(by_tangent.iterations <= 5 * 20);
    for (const Course& course : {by_tangent, by_differences}) {
      CHECK(end_of(course).response.cauchy(1, 1) == Approx(-600).epsilon(1e-11));
      CHECK(end_of(course).response.cauchy(2, 2) == Approx(-600).epsilon(1e-11));
      CHECK(end_of(course).response.cauchy(0, 1) == Approx(200).epsilon(1e-11));
    }
    CHECK(end_of(by_tangent).response.cauchy(0, 0) ==
          Approx(end_of(by_differences).response.cauchy(0, 0)).epsilon(1e-9));
  }
}

TEST_CASE("material point: Neo-Hookean in simple shear, by F, by the velocity gradient and by the shear stress") {
  for (const std::string& energy : energies)
    for (const double gamma : {-0.7, 0.5, 1.5}) {
      CAPTURE(energy, gamma);
      const Json by_F = Json::array({stage({{"xy", gamma}})}),
                 by_L = Json::array({{{"steps", 10}, {"velocity_gradient", {{"xy", gamma}}}}}),
                 by_stress = Json::array({{{"steps", 4}, {"stress", {{"xy", std::to_string(mu * gamma) + "*t"}}}}});
      for (const Json& path : {by_F, by_L, by_stress}) {
        const Course course = driven(rubber(energy), path);
        const Row& end = end_of(course);
        CHECK(end.F(0, 1) == Approx(gamma).epsilon(1e-7));
        CHECK(end.response.cauchy(0, 1) == Approx(mu * gamma).epsilon(1e-7));
        CHECK(end.response.cauchy(0, 0) == Approx(mu * gamma * gamma).epsilon(1e-6));
        CHECK(std::abs(end.response.cauchy(1, 1)) < 1e-9);
        CHECK(std::abs(end.response.cauchy(2, 2)) < 1e-9);
      }
    }
}

TEST_CASE("material point: fixed corotated, stretched, sheared, turned inside out and turned") {
  const Json material = elastic("fixed_corotated");
  const auto stress = [&](const Json& F) { return end_of(driven(material, Json::array({stage(F)}))).response; };
  const Response pressed = stress({{"xx", 0.5}}), pulled = stress({{"xx", 2}}), sheared = stress({{"xy", 0.5}});
  CHECK(pressed.cauchy(0, 0) == Approx(-673.07692).epsilon(1e-8));
  CHECK(pressed.cauchy(1, 1) == Approx(-288.46154).epsilon(1e-7));
  CHECK(pulled.cauchy(0, 0) == Approx(1346.15385).epsilon(1e-8));
  CHECK(pulled.cauchy(2, 2) == Approx(576.92308).epsilon(1e-8));
  CHECK(sheared.cauchy(0, 0) == Approx(121.99207).epsilon(1e-7));
  CHECK(sheared.cauchy(0, 1) == Approx(198.04952).epsilon(1e-7));
  CHECK(sheared.cauchy(1, 1) == Approx(22.96731).epsilon(1e-6));
  CHECK(std::abs(sheared.cauchy(2, 2)) < 1e-10);
  const double c = 0.6, s = 0.8;  // F of the stretch by two along x, turned about z
  const Response turned = stress({{"xx", 2 * c}, {"xy", -s}, {"yx", 2 * s}, {"yy", c}});
  CHECK(turned.cauchy(0, 0) == Approx(c * c * pulled.cauchy(0, 0) + s * s * pulled.cauchy(1, 1)).epsilon(1e-12));
  CHECK(turned.cauchy(0, 1) == Approx(c * s * (pulled.cauchy(0, 0) - pulled.cauchy(1, 1))).epsilon(1e-12));
  const Course inverted = driven(material, Json::array({stage({{"xx", -0.5}})}));  // a run would stop there too
  REQUIRE(inverted.stop);
  CHECK(inverted.stop->reason == "the material does not take the state: det F is -0.5, J -0.5");
}

namespace {

/// G = 1000 and K = 2000; the yield stress is 1e-3, so that strains are some 1e-6: the finite-strain law differs from the
/// small-strain numbers by terms of the order of the strain.
constexpr double shear = 1000, bulk = 2000, yield = 1e-3, small = 1e-5;
constexpr double metal_young = 9 * bulk * shear / (3 * bulk + shear);

Json metal(double hardening) {
  return {{"type", "von_mises"},
          {"youngs_modulus", metal_young},
          {"poisson_ratio", (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear))},
          {"density", 1000},
          {"yield_stress", yield},
          {"hardening_modulus", hardening}};
}

std::string ramp(double from, double to) {
  return Json(from).dump() + " + (" + Json(to - from).dump() + ")*t";
}

}  // namespace

TEST_CASE("material point: J2 in uniaxial strain and simple shear") {
  const Course pressed = driven(metal(0), Json::array({stage({{"xx", ramp(1, 1 + 2e-6)}}, 200)}));
  CHECK(pressed.rows[50].response.cauchy(0, 0) == Approx(1.6666667e-3).epsilon(small));  // it yields at sy/(2 G)
  CHECK(end_of(pressed).response.cauchy(0, 0) == Approx(4.6666667e-3).epsilon(small));   // K eps + 2 sy/3
  const double hardening = 600, strength = yield / std::sqrt(3.0), turn = strength / shear;
  const Course sheared = driven(metal(hardening), Json::array({stage({{"xy", ramp(0, 3 * turn)}}, 90)}));
  CHECK(sheared.rows[30].response.cauchy(0, 1) == Approx(strength).epsilon(small));
  CHECK(end_of(sheared).response.cauchy(0, 1) ==
        Approx(strength + shear * hardening / (3 * shear + hardening) * 2 * turn).epsilon(small));
}

TEST_CASE(
    "material point: J2 in uniaxial stress yields at sy, hardens with E H / (E + H), unloads and yields in reverse") {
  const double hardening = metal_young / 4, tangent = metal_young * hardening / (metal_young + hardening),
               turn = yield / metal_young;
  const Json free{{"yy", 0}, {"zz", 0}};
  const auto to = [&](double from, double strain, int steps) {
    return stage({{"xx", ramp(1 + from * turn, 1 + strain * turn)}}, steps, free);
  };
  for (const Slopes slopes : {Slopes::tangent, Slopes::differences}) {
    const Course course =
        driven(metal(hardening), Json::array({to(0, 3, 90), to(3, 2.5, 10), to(2.5, -1, 70)}), 3, slopes);
    const double top = yield + tangent * 2 * turn, plastic = (top - yield) / hardening;
    CHECK(course.rows[30].response.cauchy(0, 0) == Approx(yield).epsilon(small));
    CHECK(course.rows[90].response.cauchy(0, 0) == Approx(top).epsilon(small));
    CHECK(course.rows[100].response.cauchy(0, 0) == Approx(top - metal_young * 0.5 * turn).epsilon(small));
    // Reverse yield at -(sy + H ep), at the strain where the elastic line meets it; from there with the tangent again.
    const double reverse = -(yield + hardening * plastic), strain = 3 * turn + (reverse - top) / metal_young;
    CHECK(end_of(course).response.cauchy(0, 0) == Approx(reverse + tangent * (-turn - strain)).epsilon(small));
    double side = 0;
    for (const Row& row : course.rows) side = mpm::test::larger(side, std::abs(row.response.cauchy(1, 1)));
    CHECK(side < 1e-13 * (bulk + 4 * shear / 3));  // what rounding of a strain leaves
  }
}

TEST_CASE("material point: sand in triaxial compression fails where Mohr and Coulomb say, and holds no tension") {
  const Json sand{{"type", "drucker_prager"},
                  {"youngs_modulus", 1e7},
                  {"poisson_ratio", 0.3},
                  {"density", 1600},
                  {"friction_angle", "30 deg"}};
  const Json confined{{"steps", 10}, {"stress", {{"xx", "-1e5*t"}, {"yy", "-1e5*t"}, {"zz", "-1e5*t"}}}};
  Json squeeze{{"steps", 200}, {"velocity_gradient", {{"xx", -0.06}}}, {"stress", {{"yy", -1e5}, {"zz", -1e5}}}};
  const Course course = driven(sand, Json::array({confined, squeeze}));
  const Response& end = end_of(course).response;
  CHECK(pressure(course.rows[10].response) == Approx(1e5).epsilon(1e-10));
  CHECK(-end.cauchy(0, 0) == Approx(3e5).epsilon(1e-8));                    // s1 = s3 (1 + sin phi)/(1 - sin phi)
  CHECK(end.cauchy(1, 1) - end.cauchy(0, 0) == Approx(2e5).epsilon(1e-8));  // q_f
  const double q = course.rows[20].response.cauchy(1, 1) - course.rows[20].response.cauchy(0, 0);
  CHECK(q < 1.9e5);
  CHECK(q / (pressure(course.rows[20].response) - 1e5) == Approx(3).epsilon(1e-8));
  const Course pulled = driven(sand, Json::array({stage({{"xx", 1.01}}, 5)}));
  CHECK(std::abs(end_of(pulled).response.cauchy(0, 0)) < 1e-6);
}

TEST_CASE("material point: snow keeps its clamped stretch, and hardens by the rest") {
  struct Case {
    double compression, hardening, stretch, plastic, factor;
  };
  for (const Case& c : {Case{0.025, 10, 0.9, 0.92307692, 2.15810553}, Case{0.05, 5, 0.8, 0.84210526, 2.20223705}})
    for (const int steps : {1, 40}) {
      const Json snow{{"type", "snow"},
                      {"youngs_modulus", young},
                      {"poisson_ratio", poisson},
                      {"density", 400},
                      {"critical_compression", c.compression},
                      {"hardening", c.hardening}};
      const Course course = driven(snow, Json::array({stage({{"xx", ramp(1, c.stretch)}}, steps)}));
      const Row& end = end_of(course);
      const auto column = std::find_if(course.columns.begin(), course.columns.end(),
                                       [](const StateColumn& of) { return of.name == "plastic_volume_ratio"; });
      REQUIRE(column != course.columns.end());
      CHECK(end.state[static_cast<std::size_t>(column - course.columns.begin())] == Approx(c.plastic).epsilon(1e-8));
      const double s = 1 - c.compression;  // tau = 2 mu (s - 1) s + lambda (s - 1) s of fixed corotated
      CHECK(end.response.kirchhoff(0, 0) == Approx(c.factor * (2 * mu + lambda) * (s - 1) * s).epsilon(1e-8));
      CHECK(end.response.volume_ratio == Approx(c.stretch).epsilon(1e-12));
    }
}

namespace mpm::test {  // so that it finds mpm::log

/// A liquid without viscosity: pressure -K ln J / J, nothing else.
struct Liquid : ElasticSolid {
  struct Parameters {
    double bulk_modulus, density;
  };
  template <class T>
  struct Constants {
    T bulk, inverse_density;
    MPM_HD explicit Constants(const Parameters& p) : bulk(T(p.bulk_modulus)), inverse_density(T(1 / p.density)) {}
  };
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    Sym<G::dimension, S> tau{};
    for (int i = 0; i < 3; ++i) tau.s[i] = c.bulk * log(determinant(state.deformation_gradient));
    return tau;
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S l = log(determinant(state.deformation_gradient));
    return real<S>(0.5) * c.bulk * l * l;
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const ElasticState<G>&) {
    return sqrt(S(c.inverse_density * c.bulk));
  }
  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(bulk_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "bulk modulus"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density")};
  static constexpr mpm_state state[] = {NeoHookean::state[0]};
};

}  // namespace mpm::test

namespace {

template <class F>
ComponentLookup one_material() {
  static constexpr mpm_descriptor descriptor = sdk::material<F>(mpm::test::fixture_manual, "struct Fixture {};");
  static const Plugin plugin{&descriptor, "test"};
  return ComponentLookup(std::vector<const Plugin*>{&plugin});
}

}  // namespace

TEST_CASE("material point: the free sides of a liquid, which no stress tells apart, move alike") {
  const ComponentLookup liquid = one_material<mpm::test::Liquid>();
  const Json file{{"materials", {{"m", {{"type", "fixture"}, {"bulk_modulus", 2e9}, {"density", 1000}}}}},
                  {"solver",
                   {{"type", "material_point"},
                    {"stages", Json::array({stage({{"xx", "1 + t"}}, 50, {{"yy", -1e5}, {"zz", -1e5}})})}}}};
  const Course course = follow(read_drive_text(file.dump(), "FILE", liquid));
  const Row& end = end_of(course);
  CHECK(end.F(1, 1) == Approx(end.F(2, 2)).epsilon(1e-12));
  const double J = end.F(0, 0) * end.F(1, 1) * end.F(2, 2);  // p = -K ln J / J
  CHECK(-2e9 * std::log(J) / J == Approx(1e5).epsilon(1e-6));
  CHECK(pressure(end.response) == Approx(1e5).epsilon(1e-7));
}

TEST_CASE("material point: a material that reads a cell size has the one that the file gives") {
  const ComponentLookup band = one_material<mpm::test::BandHardening>();
  const auto text = [&](const Json& cell_size) {
    Json solver{
        {"type", "material_point"},
        {"stages", Json::array({stage({{"xx", ramp(1, 1 + 3 * yield / metal_young)}}, 90, {{"yy", 0}, {"zz", 0}})})}};
    if (!cell_size.is_null()) solver["cell_size"] = cell_size;
    Json material = metal(0);
    material.erase("hardening_modulus");
    material["type"] = "fixture", material["stiffness"] = 10 * metal_young;
    return Json{{"materials", {{"m", material}}}, {"solver", solver}}.dump();
  };
  for (const double h : {0.05, 0.2}) {
    const double hardening = 10 * metal_young * h, tangent = metal_young * hardening / (metal_young + hardening);
    const Course course = follow(read_drive_text(text(h), "FILE", band));
    CHECK(end_of(course).response.cauchy(0, 0) == Approx(yield + 2 * tangent * yield / metal_young).epsilon(small));
  }
  try {
    read_drive_text(text(nullptr), "FILE", band);
    FAIL("a cell size is missing, and nothing was said");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find("reads the cell size of a grid: give \"cell_size\", m") != std::string::npos);
  }
}

TEST_CASE("material point: the work is that of the closed form, and the ledger closes") {
  // W = mu/2 (l^2 - 1 - 2 ln l) + lambda/2 (l - 1)^2 in uniaxial strain
  const double l = 1.8, exact = mu / 2 * (l * l - 1 - 2 * std::log(l)) + lambda / 2 * (l - 1) * (l - 1);
  const Course course = driven(rubber("quadratic"), Json::array({stage({{"xx", ramp(1, l)}}, 40)}));
  CHECK(end_of(course).work == Approx(exact).epsilon(1e-9));
  CHECK(course.rows.back().response.stored == Approx(exact).epsilon(1e-12));
  CHECK(course.rows.back().dissipated == 0);

  // A closed loop of stretch, shear and turning gives everything back.
  const Json loop = Json::array({stage({{"xx", "1 + 0.4*sin(2*pi*t)"},
                                        {"xy", "0.3*(1 - cos(2*pi*t))"},
                                        {"yx", "-0.2*sin(4*pi*t)"},
                                        {"zz", "1 + 0.1*(1 - cos(2*pi*t))"}},
                                       200)});
  const Course closed = driven(rubber("simo"), loop);
  CHECK(std::abs(end_of(closed).work) < 1e-9 * turnover(closed));
  CHECK(std::abs(residual(closed, closed.rows.back())) < 1e-9 * turnover(closed));

  // Perfect plasticity dissipates sy times the equivalent plastic strain; in uniaxial strain that is
  // 2/3 (eps - sy/(2 G)) (the deviatoric strain that is not elastic).
  const Course yielding = driven(metal(0), Json::array({stage({{"xx", ramp(1, 1 + 2e-6)}}, 2000)}));
  CHECK(end_of(yielding).dissipated == Approx(yield * 2 / 3 * (2e-6 - yield / (2 * shear))).epsilon(2e-3));
  CHECK(std::abs(residual(yielding, yielding.rows.back())) < 2e-3 * turnover(yielding));
}

TEST_CASE("material point: a velocity gradient multiplies F by I + dt L, a formula by its value in mid-step") {
  const Course constant = driven(elastic("neo_hookean"),
                                 Json::array({{{"duration", 2}, {"steps", 8}, {"velocity_gradient", {{"xx", 0.3}}}}}));
  CHECK(end_of(constant).F(0, 0) == Approx(std::pow(1 + 0.3 * 0.25, 8)).epsilon(1e-13));
  const Course linear = driven(
      elastic("neo_hookean"), Json::array({{{"duration", 2}, {"steps", 1}, {"velocity_gradient", {{"yx", "0.4*t"}}}}}));
  CHECK(end_of(linear).F(1, 0) == Approx(0.8).epsilon(1e-13));
}

TEST_CASE("material point: plane strain is 3-D with its third axis held") {
  const Json material = rubber("logarithmic"), flat_stress{{"yy", "-100*t"}};
  const Course flat =
                   driven(material, Json::array({stage({{"xx", "1 + 0.3*t"}, {"yx", "0.1*t"}}, 10, flat_stress)}), 2),
               full =
                   driven(material, Json::array({stage({{"xx", "1 + 0.3*t"}, {"yx", "0.1*t"}}, 10, flat_stress)}), 3);
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      CHECK(end_of(flat).response.cauchy(i, j) ==
            Approx(end_of(full).response.cauchy(i, j)).epsilon(1e-10).margin(1e-9));
  CHECK(end_of(flat).F(1, 1) == Approx(end_of(full).F(1, 1)).epsilon(1e-10));
  CHECK(end_of(flat).response.cauchy(1, 1) == Approx(-100).epsilon(1e-10));
  CHECK(end_of(flat).response.cauchy(2, 2) != 0);
}

TEST_CASE("material point: the standard paths measure E, G, K and M") {
  const double k = young / (3 * (1 - 2 * poisson));
  const std::array<std::pair<const char*, double>, 3> expected{
      {{"uniaxial", young}, {"simple_shear", mu}, {"oedometer", k + 4 * mu / 3}}};
  PathSize size;
  size.strain = 1e-6, size.steps = 1;
  for (const auto& [name, modulus] : expected) {
    CAPTURE(name);
    const DriveExperiment path =
        read_drive_text(standard_path(name, size, elastic("neo_hookean")).dump(), "FILE", lookup());
    const Course course = follow(path);
    const auto [i, j] = driven_component(path, course);
    REQUIRE(course.rows.size() == 3);
    CHECK(course.rows[1].response.cauchy(i, j) / (course.rows[1].F(i, j) - (i == j)) == Approx(modulus).epsilon(1e-5));
    CHECK(std::abs(end_of(course).response.cauchy(i, j)) < 1e-9);  // it ends where it began
  }
  const DriveExperiment path =
      read_drive_text(standard_path("isotropic", size, elastic("neo_hookean")).dump(), "FILE", lookup());
  const Response pressed = follow(path).rows[1].response;
  CHECK(-pressure(pressed) / std::log(pressed.volume_ratio) == Approx(k).epsilon(1e-5));
}

TEST_CASE("material point: a request to stop is heard between two steps") {
  const DriveExperiment path = path_of(elastic("neo_hookean"), Json::array({stage({{"xx", "1 + t"}}, 10), stage({})}));
  int asked = 0;
  const Course course = follow(path, Slopes::tangent, [&] { return ++asked > 4; });
  CHECK(course.is_interrupted);
  CHECK(!course.stop);
  REQUIRE(course.rows.size() == 5);
  CHECK(course.rows.back().step == 4);
  CHECK(course.rows.back().time == Approx(0.4));
  CHECK(!follow(path).is_interrupted);
}

TEST_CASE("material point: a path that cannot be followed stops with place, reason and remedy") {
  const Course inverted = driven(rubber("simo"), Json::array({stage({{"xx", "1 - 2*t"}}, 10)}));
  REQUIRE(inverted.stop);
  CHECK(inverted.stop->step == 5);
  CHECK(inverted.rows.size() == 5);
  CHECK(inverted.stop->reason.starts_with("the material does not take the state: det F is"));

  // The same where a stress is prescribed too: no stress was missed, for none was found.
  const Course pushed = driven(rubber("simo"), Json::array({stage({{"xx", -0.5}}, 1, {{"yy", 0}, {"zz", 0}})}));
  REQUIRE(pushed.stop);
  INFO(pushed.stop->reason);
  CHECK(pushed.stop->reason == "the material does not take the state: det F is -0.5, J -0.5");

  Json sand{{"type", "drucker_prager"}, {"youngs_modulus", 1e7}, {"poisson_ratio", 0.3}, {"density", 1600}};
  sand["friction_angle"] = "30 deg";
  const Course pulled = driven(sand, Json::array({{{"steps", 1}, {"stress", {{"xx", 100}, {"yy", 100}}}}}));
  REQUIRE(pulled.stop);
  CHECK(pulled.stop->reason.starts_with("no strain was found with the prescribed stress: stress "));
  CHECK(pulled.stop->reason.find("is to be 100 Pa and misses it by 100 Pa") != std::string::npos);

  const Course formula = driven(rubber("simo"), Json::array({stage({{"xx", "1 + 0.1*log(1.35 - t)"}}, 10), stage({})}));
  REQUIRE(!formula.stop);
  const Course wrong = driven(rubber("simo"), Json::array({stage({{"xx", "1 + 0*sqrt(0.55 - t)"}}, 10)}));
  REQUIRE(wrong.stop);
  CHECK(wrong.stop->step == 6);
  CHECK(wrong.stop->reason.find("/solver/stages/0/deformation_gradient/xx is not a finite number at t = 0.6 s") == 0);
}

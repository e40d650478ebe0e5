// Averages of dilation and mean stress (docs/method.md, "Mean dilation"): what no program is needed to know of them.
// locking.cpp has what they are for.

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/particle_quantities.hpp"
#include "operators/dilation.hpp"
#include "parity/heat_scenes.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string averaged = "/solver/dilation=averaged";
const std::vector<std::pair<std::string, std::string>> runs{
    {"reference", "double"}, {"cpu", "double"}, {"cpu", "float"}};

double epsilon_of(const std::string& precision) {
  return precision == "float" ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon();
}

std::vector<std::string> with(std::vector<std::string> settings, const std::vector<std::string>& more) {
  settings.insert(settings.end(), more.begin(), more.end());
  return settings;
}

/// The sum of the particles' volumes, m^3.
double volume_of(const Scene& scene, int body) {
  const BodyState state = scene.body(body);
  const std::vector<double> ratio = material_quantities(scene.experiment, body, state).volume_ratio;
  double sum = 0;
  for (std::size_t p = 0; p < ratio.size(); ++p) sum += state.volume * state.size_of(p) * ratio[p];
  return sum;
}

/// A body of next to no stiffness that stretches, shears and turns everywhere alike, for one step: then places have moved
/// and velocities have not.
std::string affine_scene(int dimension) {
  const bool flat = dimension == 2;
  return R"J({"dimension": )J" + std::to_string(dimension) + R"J(, "grid": {"cell_size": 0.1, "domain": )J" +
         (flat ? "[[0.2, 0], [1.6, 1.4]]" : "[[0.2, 0, 0], [1.4, 1.2, 1.2]]") +
         R"J(, "boundaries": {"all": "free"}}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
         "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0.3, "density": 1000}},
         "bodies": [{"name": "a", "material": "m", "jitter": 0.3, "geometry": {"type": "box", "lower": )J" +
         (flat ? "[0.5, 0.4], \"upper\": [1.1, 0.9]}, \"velocity\": [\"0.9*x\", \"-0.4*y\"]}]"
               : "[0.5, 0.4, 0.4], \"upper\": [0.8, 0.7, 0.8]}, \"velocity\": [\"0.9*x+0.3*y\", \"0.2*x-0.4*z\", "
                 "\"0.3*z-0.5*x\"]}]") +
         R"J(, "solver": {"time_step": 0.08, "end_time": 0.08}})J";
}

}  // namespace

TEST_CASE("the relative change of a volume is the determinant's, in two and three directions", "[dilation]") {
  const double dt = 0.125;  // the numbers and their products have few digits: the determinant loses none
  const Mat<2, double> plane{{0.5, -1.25, 0.75, -0.25}};
  const Mat<3, double> space{{0.5, -1.25, 0.75, -0.25, 1.5, 0.125, 2.0, -0.5, -0.75}};
  const auto stepped = [&](auto L) {
    for (int i = 0; i < L.dimension; ++i)
      for (int j = 0; j < L.dimension; ++j) L(i, j) = (i == j) + dt * L(i, j);
    return L;
  };
  CHECK(dilation_of(plane, dt) == Approx((determinant(stepped(plane)) - 1) / dt).epsilon(1e-14));
  CHECK(dilation_of(space, dt) == Approx((determinant(stepped(space)) - 1) / dt).epsilon(1e-14));
  const Deformation<2, double> ring{plane, 0.625};
  CHECK(dilation_of(ring, dt) == Approx((determinant(stepped(plane)) * (1 + dt * 0.625) - 1) / dt).epsilon(1e-14));
  for (const double mean : {-4.0, -0.3, 1e-9, 0.2, 3.0}) {  // the volume becomes that of the mean dilation
    Mat<2, double> a = plane;
    Mat<3, double> b = space;
    Deformation<2, double> c = ring;
    take_mean_dilation(a, mean, dt), take_mean_dilation(b, mean, dt), take_mean_dilation(c, mean, dt);
    CHECK(dilation_of(a, dt) == Approx(mean).epsilon(1e-6));
    CHECK(dilation_of(b, dt) == Approx(mean).epsilon(1e-6));
    CHECK(dilation_of(c, dt) == Approx(mean).epsilon(1e-6));
    // Shear in the stepped shape stays in proportion.
    CHECK(a(0, 1) / (1 + dt * a(0, 0)) == Approx(plane(0, 1) / (1 + dt * plane(0, 0))).epsilon(1e-12));
    CHECK(b(1, 2) / (1 + dt * b(2, 2)) == Approx(space(1, 2) / (1 + dt * space(2, 2))).epsilon(1e-12));
  }
  Mat<3, double> none = space;
  take_mean_dilation(none, -9.0, dt);  // 1 + dt mean < 0
  CHECK(none(0, 0) == space(0, 0));
}

TEST_CASE("a body that deforms everywhere alike is strained as without the average", "[dilation]") {
  for (const int dimension : {2, 3})
    for (const auto& [backend, precision] : runs)
      for (const std::string symmetry : {"none", "axisymmetric"}) {
        if (dimension == 3 && symmetry != "none") continue;
        for (const std::string transfer : {"apic", "mls", "tpic"}) {
          std::vector<std::string> settings{set("/backend", backend), set("/precision", precision),
                                            set("/transfer/type", transfer)};
          if (symmetry != "none") settings.push_back(set("/grid/symmetry", symmetry));
          Scene own(affine_scene(dimension), settings), mean(affine_scene(dimension), with(settings, {averaged}));
          own.run(), mean.run();
          INFO(dimension << "-D " << symmetry << " " << transfer << " on " << backend << " " << precision);
          const BodyState expected = own.body(), found = mean.body();
          const auto& [name, values] = *expected.material_state.begin();
          // The velocity of a node that hardly any particle reaches is rounded more than others: 145 at most.
          CHECK(difference(values, found.material_state.at(name), 1.0) < 200 * epsilon_of(precision));
          CHECK(difference(expected.position, found.position, 1.0) <= epsilon_of(precision));
          CHECK(std::abs(volume_of(own, 0) - 1) > 1e-3);  // something happened
        }
      }
}

TEST_CASE("the average keeps the volume of all particles of a velocity field together", "[dilation]") {
  for (const int dimension : {2, 3})
    for (const auto& [backend, precision] : runs)
      for (const std::string walls : {R"({"all": "slip"})", R"({"all": "stick"})",
                                      R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})"})
        for (const std::string& order : orders) {
          Mix mix;
          mix.dimension = dimension, mix.close = true, mix.boundaries = walls, mix.stress_update = order;
          mix.contact = R"({"type": "coulomb", "friction": 0.2})";
          mix.overrides = {set("/backend", backend), set("/precision", precision)};
          Scene own(mix.text(), mix.overrides), mean(mix.text(), with(mix.overrides, {averaged}));
          // The first strain of both is by the same velocity; USAVG strains twice in a step.
          if (order == "averaged") continue;
          own.run_steps(1), mean.run_steps(1);
          INFO(mix.name() << " on " << backend << " " << precision);
          for (const int body : {0, 1}) {
            const double volume = volume_of(own, body);
            CHECK(std::abs(volume_of(mean, body) / volume - 1) < 30 * epsilon_of(precision));
          }
          const auto ratios = [](const Scene& scene) {
            return material_quantities(scene.experiment, 0, scene.body()).volume_ratio;
          };
          CHECK(difference(ratios(own), ratios(mean), 1.0) > 1e-6);
        }
}

namespace {

/// A bar that swings along its axis, resolved by 13 cells (ledger_books.cpp), and a block that hardly changes its volume while
/// it swings freely.
const char* bar = R"J({
  "dimension": 2,
  "grid": {"cell_size": 2, "domain": [[0, 0], [40, 2]],
           "boundaries": {"x_min": "slip", "x_max": "free", "y_min": "slip", "y_max": "slip"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 100, "poisson_ratio": 0, "density": 1}},
  "bodies": [{"name": "bar", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [26, 2]},
              "velocity": ["0.1*sin(5*pi*x/52)", 0]}],
  "solver": {"time_step": 0.02, "end_time": 4, "dilation": "averaged"}})J";
const char* block = R"J({
  "dimension": 2,
  "grid": {"cell_size": 2, "domain": [[-12, -12], [12, 12]], "boundaries": {"all": "free"}},
  "shape": {"type": "gimp"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 100, "poisson_ratio": 0.49, "density": 1}},
  "bodies": [{"name": "block", "material": "m", "geometry": {"type": "box", "lower": [-6, -6], "upper": [6, 6]},
              "velocity": ["0.1*sin(pi*x/12)", "-0.1*sin(pi*y/12)"]}],
  "solver": {"time_step": 0.01, "end_time": 2, "dilation": "averaged"}})J";

/// The largest residual of the ledger over the energy at the start, in runs with these steps.
std::vector<double> residuals(const char* text, const std::vector<double>& steps, std::vector<std::string> settings) {
  std::vector<double> largest;
  settings.emplace_back();
  for (const double step : steps) {
    settings.back() = set("/solver/time_step", digits(step));
    Scene scene(text, settings);
    largest.push_back(0);
    while (!scene.simulation.finished())
      largest.back() = larger(largest.back(), std::abs(scene.metrics.ledger_residual(scene.run_steps(1))));
    largest.back() /= scene.metrics.initial().total_energy();
  }
  return largest;
}

}  // namespace

TEST_CASE("forces of the mean stress do the work that strain by the mean dilation takes", "[dilation][ledger]") {
  const auto report = [](const std::string& name, const std::vector<double>& found) {
    std::printf("  %-44s residual %.2e %.2e %.2e\n", name.c_str(), found[0], found[1], found[2]);
  };
  for (const std::string backend : {"reference", "cpu"}) {
    const std::vector<double> steps{0.02, 0.01, 0.005};
    for (const std::string shape : {"linear", "bspline_quadratic"})
      for (const std::string& update : orders) {
        const std::vector<double> found = residuals(
            bar, steps, {set("/backend", backend), set("/shape/type", shape), set("/solver/stress_update", update)});
        const std::string name = backend + ", bar, " + shape + ", " + update;
        report(name, found);
        INFO(name);
        CHECK(observed_order(steps, found) > 0.85);
        CHECK(found.back() < (update == "averaged" ? 1e-4 : 0.02));
      }
    // USAVG errs in the second order of the step, so that little hides what the average might give or take.
    const std::vector<double> short_steps{0.01, 0.005, 0.0025};
    for (const std::string shape : {"gimp", "bspline_quadratic"}) {
      const std::vector<double> found =
          residuals(block, short_steps,
                    {set("/backend", backend), set("/shape/type", shape), set("/solver/stress_update", "averaged")});
      const std::string name = backend + ", block, " + shape + ", averaged";
      report(name, found);
      INFO(name);
      CHECK(observed_order(short_steps, found) > 1.5);
      CHECK(found.back() < 1e-4);
    }
  }
}

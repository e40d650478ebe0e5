// Particles strained by the mean dilation around them (docs/method.md, "Mean dilation"): what no program is needed to know
// of the average, and the ledger's row of it. locking.cpp has what it is for.

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
  CHECK(dilation_of(ring, dt) ==
        Approx((determinant(stepped(plane)) * (1 + dt * 0.625) - 1) / dt).epsilon(1e-14));
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
      for (const std::string walls :
           {R"({"all": "slip"})", R"({"all": "stick"})", R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})"})
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

/// A bar that swings, resolved by 13 cells (ledger_books.cpp), and a block that bends while it is nearly incompressible.
const char* bar = R"J({
  "dimension": 2,
  "grid": {"cell_size": 2, "domain": [[0, 0], [40, 2]],
           "boundaries": {"x_min": "slip", "x_max": "free", "y_min": "slip", "y_max": "slip"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 100, "poisson_ratio": 0, "density": 1}},
  "bodies": [{"name": "bar", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [26, 2]},
              "velocity": ["0.1*sin(5*pi*x/52)", 0]}],
  "solver": {"time_step": 0.02, "end_time": 4, "dilation": "averaged"}})J";

struct Largest {
  double residual = 0, averaged = 0;  ///< over the energy at the start
};
Largest largest(const std::vector<std::string>& settings) {
  Scene scene(bar, settings);
  Largest found;
  while (!scene.simulation.finished()) {
    const Totals now = scene.run_steps(1);
    found.residual = std::max(found.residual, std::abs(scene.metrics.ledger_residual(now)));
    found.averaged = std::max(found.averaged, std::abs(scene.simulation.ledger().averaged_strain));
  }
  const double energy = scene.metrics.initial().total_energy();
  return {found.residual / energy, found.averaged / energy};
}

}  // namespace

TEST_CASE("the ledger's residual with the mean dilation falls with the step, its row does not", "[dilation][ledger]") {
  const std::vector<double> steps{0.02, 0.01, 0.005};
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape : {"linear", "bspline_quadratic"})
      for (const std::string update : {"last", "first", "modified_last", "averaged"}) {
        std::vector<double> residuals, rows;
        for (const double step : steps) {
          const Largest found = largest({set("/backend", backend), set("/shape/type", shape),
                                         set("/solver/stress_update", update), set("/solver/time_step", digits(step))});
          residuals.push_back(found.residual), rows.push_back(found.averaged);
        }
        INFO(backend << " " << shape << " " << update << ": residuals " << residuals[0] << " " << residuals[1] << " "
                     << residuals[2] << ", averaged strain " << rows.back());
        std::printf("  %-9s %-18s %-13s residual %.2e %.2e %.2e averaged strain %.2e\n", backend.c_str(), shape.c_str(),
                    update.c_str(), residuals[0], residuals[1], residuals[2], rows.back());
        CHECK(observed_order(steps, residuals) > 0.85);
        CHECK(rows[1] == Approx(rows[2]).epsilon(0.02));
        CHECK(rows.back() > 0.02);
      }
}

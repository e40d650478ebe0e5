// Columns of metrics.csv that no other test holds to an identity from outside: the momentum that flows in and out, the heat
// of melting, and the norm of a filter's increment.

#include <cmath>
#include <complex>
#include <numbers>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The number of the column of metrics.csv whose heading begins so.
double column(const Scene& scene, const std::string& name) {
  const std::vector<std::string> columns = scene.metrics.columns();
  const std::vector<double> row = scene.metrics.row(scene.metrics.measure());
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (columns[k].starts_with(name)) return row[k];
  throw std::runtime_error("metrics.csv has no column " + name);
}

/// The weight of the quadratic B-spline of a node at a distance, cells.
double spline(double x) {
  const double d = std::abs(x);
  return d < 0.5 ? 0.75 - d * d : d < 1.5 ? 0.5 * (1.5 - d) * (1.5 - d) : 0;
}

}  // namespace

// A stream of the density rho and the section A at the speed v takes rho A v^2 t of momentum in, batch by batch, and out.
TEST_CASE("a stream brings and takes density times area times the square of its speed", "[metrics][particle_changes]") {
  for (const char* backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(R"J({"title": "stream", "dimension": 2,
        "grid": {"cell_size": 0.1, "domain": [[0, 0], [3, 0.9]], "boundaries": {"all": "free"}},
        "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
        "materials": {"m": {"type": "newtonian_fluid", "density": 800, "bulk_modulus": 1e-6, "viscosity": 0}},
        "bodies": [{"name": "water", "material": "m"}],
        "emitters": [{"body": "water", "geometry": {"type": "box", "lower": [0.1, 0.3], "upper": [0.3, 0.6]},
                      "velocity": [2, 0]}],
        "sinks": [{"geometry": {"type": "box", "lower": [2, 0], "upper": [3, 0.9]}}],
        "solver": {"time_step": 0.001, "end_time": 1.5}})J",
                {set("/backend", backend)});
    scene.run();
    // Fifteen batches of 0.1 s have come since the first, which was there at the start; what is 1.7 m on its way is gone.
    const double rate = 800 * 0.3 * 2 * 2, batch = rate * 0.1;
    CHECK(column(scene, "emitted momentum x") == Approx(15 * batch).epsilon(1e-9));
    CHECK(std::abs(column(scene, "emitted momentum y")) < 1e-9 * batch);
    CHECK(column(scene, "removed momentum x") == Approx(rate * (1.5 - 1.7 / 2)).margin(batch));
    CHECK(column(scene, "removed momentum x") == Approx(2 * column(scene, "removed mass")).epsilon(1e-6));
  }
}

// A block that is warmed alike everywhere takes the power for its heat capacity until it melts, and then for its melting.
TEST_CASE("the latent heat of a block is the heat that it has been given beyond its melting point",
          "[metrics][temperature]") {
  for (const char* backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(R"J({"title": "melting", "dimension": 2,
        "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]],
                 "boundaries": {"all": "slip"}},
        "node_conditions": [{"type": "thermal", "lower": [-1, -1], "upper": [2, 2], "heating": 3000}],
        "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
        "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 1000, "poisson_ratio": 0, "density": 100,
          "thermal": {"conductivity": 1, "heat_capacity": 10,
                      "phase_change": {"temperature": 305, "latent_heat": 200}}}},
        "bodies": [{"name": "a", "material": "m", "temperature": 300,
                    "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 1]}}],
        "solver": {"time_step": 0.01, "end_time": 4}})J",
                {set("/backend", backend)});
    // 100 kg take 5000 J until they melt, which needs 20000 J.
    scene.run();
    CHECK(column(scene, "latent heat") == Approx(3000 * 4 - 5000).epsilon(1e-6));
    CHECK(column(scene, "lowest temperature") == Approx(305).epsilon(1e-9));
    CHECK(column(scene, "highest temperature") == Approx(305).epsilon(1e-9));
  }
}

// Two particles a cell stand in every cell alike, so that a wave of nodes stays one when PIC gathers and scatters it: its
// amplitude becomes s = mean |W|^2 of itself, W = sum_i w_ip e^(i k (x_i - x_p)). The increment of order m is what m - 1
// passes leave of the wave, (1 - s)^(m - 1) of it, and the particles' wave has s / conj(W) of a node's from the start.
TEST_CASE("the norm of a filter's increment falls by what the grid loses of a wave", "[metrics][filters]") {
  constexpr int cells = 8;
  const double wave = 2 * std::numbers::pi / cells;
  std::complex<double> both{};
  double kept = 0;
  for (const double x : {0.25, 0.75}) {
    std::complex<double> sum{};
    for (int i = -2; i <= 3; ++i) sum += spline(x - i) * std::exp(std::complex<double>(0, wave * (i - x)));
    kept += std::norm(sum) / 2, both += sum / 2.0;
  }
  const double mass = 1000 * 0.8 * 0.8, speed = std::abs(both);
  for (const char* backend : {"reference", "cpu"})
    for (const std::string type : {"fmpm", "xpic"})
      for (const int order : {2, 3, 5}) {
        INFO(backend << " " << type << " " << order);
        Scene scene(R"J({"title": "wave", "dimension": 2,
            "grid": {"cell_size": 0.1, "domain": [[0, 0], [0.8, 0.8]], "boundaries": {"all": "periodic"}},
            "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "pic"},
            "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1000}},
            "bodies": [{"name": "a", "material": "m", "seeding": "lattice",
                        "geometry": {"type": "box", "lower": [0, 0], "upper": [0.8, 0.8]},
                        "velocity": ["sin(2*pi*x/0.8)", 0]}],
            "solver": {"time_step": 1e-6, "end_time": 1}})J",
                    {set("/backend", backend),
                     "/filter={\"type\": \"" + type + "\", \"order\": " + std::to_string(order) + "}"});
        scene.run_steps(1);
        const double norm = std::sqrt(mass / 2) * speed * std::pow(1 - kept, order - 1);
        CHECK(column(scene, "filter increment norm") == Approx(norm).epsilon(1e-6));
      }
}

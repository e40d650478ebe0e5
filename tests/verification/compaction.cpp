// A column of 50 m settles under its own weight and its particles cross cells on the way (AMPLE set-up, nu = 0). Exact
// Cauchy stress: -density g (l0 - Y), whatever the material, since the area does not change.

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double youngs_modulus = 1e6, density = 80, gravity = 10, height = 50;

/// The column. Gravity grows smoothly over 20 s, eleven periods of the column, so that it settles without swinging.
std::string column(const std::string& shape, double cell) {
  const double top = std::ceil(height / cell + 1) * cell;
  return R"({"dimension": 2, "backend": "cpu", "grid": {"cell_size": )" + digits(cell) + R"(, "domain": [[0, 0], [)" +
         digits(cell) + ", " + digits(top) + R"(]], "boundaries": {"all": "slip"}},
    "shape": {"type": ")" +
         shape + R"("}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 80}},
    "bodies": [{"name": "column", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [)" +
         digits(cell) +
         R"(, 50]}}], "body_force": [0, "5*cos(pi*t/20) - 5"],
    "solver": {"stress_update": "modified_last", "time_step": "auto", "courant": 0.4, "end_time": 20}, "output": {
    "ledger" : false
  }
})";
}

/// The stress of a Neo-Hookean column at nu = 0: sigma = mu (l - 1 / l), l the vertical stretch, mu = E / 2.
double stress(double stretch) {
  return 0.5 * youngs_modulus * (stretch - 1 / stretch);
}
double exact_stress(double initial_height) {
  return -density * gravity * (height - initial_height);
}
double stretch_of(double sigma) {
  const double s = sigma / youngs_modulus;
  return s + std::sqrt(s * s + 1);
}

struct Settled {
  double stress_error = 0;  ///< sum |sigma_p - sigma| V0 / (g density l0 V)
  double top_error = 0;     ///< m
};

Settled settle(const std::string& shape, double cell) {
  Scene scene(column(shape, cell));
  const BodyState start = scene.body();
  scene.run();
  const BodyState end = scene.body();
  const auto& F = end.material_state.at("deformation_gradient");
  Settled result;
  const std::size_t count = start.position.size() / 2;
  double highest = 0, exact_top = 0;
  for (std::size_t p = 0; p < count; ++p) {
    const double Y = start.position[2 * p + 1];
    result.stress_error +=
        std::abs(stress(F[4 * p + 3]) - exact_stress(Y)) / (gravity * density * height * static_cast<double>(count));
    if (Y <= highest) continue;
    highest = Y;
    result.top_error = end.position[2 * p + 1];
  }
  for (int k = 0; k < 1000; ++k) exact_top += stretch_of(exact_stress((k + 0.5) * highest / 1000)) * highest / 1000;
  result.top_error = std::abs(result.top_error - exact_top);
  return result;
}

}  // namespace

TEST_CASE("a settling column: linear shapes stall at crossings, GIMP, CPDI and splines converge", "[column]") {
  const std::vector<double> cells{2.5, 1.25, 0.625};
  const auto errors = [&](const char* shape) {
    std::vector<double> list;
    for (const double cell : cells) {
      const Settled settled = settle(shape, cell);
      list.push_back(settled.stress_error);
      INFO(shape << " h = " << cell << ": stress " << settled.stress_error << ", top " << settled.top_error << " m");
      if (std::string(shape) != "linear") CHECK(settled.top_error < 0.02);
    }
    return list;
  };
  const auto linear = errors("linear");
  INFO("linear: " << linear[0] << " " << linear[1] << " " << linear[2]);
  CHECK(linear[2] > linear[0]);  // the finer the cells, the more of them are crossed
  for (const char* shape : {"gimp", "cpdi"}) {
    const auto list = errors(shape);
    INFO(shape << ": " << list[0] << " " << list[1] << " " << list[2]);
    CHECK(list[1] < 0.65 * list[0]);
    CHECK(list[2] < 0.65 * list[1]);
    CHECK(list[2] < 0.05 * linear[2]);
  }
  // Without a particle size the weights of two rows a cell do not sum evenly over a node: the spline gains more slowly.
  const auto spline = errors("bspline_quadratic");
  INFO("bspline_quadratic: " << spline[0] << " " << spline[1] << " " << spline[2]);
  CHECK(spline[1] < spline[0]);
  CHECK(spline[2] < spline[1]);
  CHECK(spline[2] < 0.5 * linear[2]);
}

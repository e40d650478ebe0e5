// Blocks that rest on one another. Contact carries the weight of what lies above; a single velocity field carries it
// too, but is a weld: what rests on it cannot be lifted off.

#include <cmath>
#include <functional>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Three blocks of 0.25 m fill a shaft of 0.5 m. Weight grows over 0.5 s (many periods of the stack) and then rests;
/// from 1 s on, `lift` times its weight acts upwards on the topmost block.
std::string stack(const std::string& contact, const std::string& shape, double lift) {
  const std::string weight = "-5*(1-cos(pi*t/0.5))*(t<0.5)-10*(t>=0.5)";
  std::string bodies;
  for (int k = 0; k < 3; ++k)
    bodies += std::string(k ? "," : "") + R"({"name": "block_)" + std::to_string(k + 1) +
              R"(", "material": "m", "geometry": {"type": "box", "lower": [0, )" + digits(0.25 * k) +
              R"(], "upper": [0.5, )" + digits(0.25 * (k + 1)) + "]}}";
  return R"({"dimension": 2, "backend": "cpu", "grid": {"cell_size": 0.05, "domain": [[0, 0], [0.5, 1.25]],
      "boundaries": {"all": "slip"}}, "shape": {"type": ")" +
         shape + R"("}, "transfer": {"type": "flip", "pic_fraction": 0.02},)" + contact +
         R"("materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [)" +
         bodies + R"(], "body_force": [0, ")" + weight + "+(t>1)*(Y>0.5)*10*" + digits(lift) + R"("],
      "solver": {"time_step": "auto", "courant": 0.4, "end_time": 1.1}, "output": {"ledger": false}})";
}

const std::string frictionless = R"("contact": {"type": "coulomb", "friction": 0},)";
constexpr double block_weight = 1000 * 0.5 * 0.25 * 10;

double height_of(const Scene& scene, int body) {
  const BodyState state = scene.body(body);
  double sum = 0;
  for (std::size_t k = 1; k < state.position.size(); k += 2) sum += state.position[k];
  return sum / (0.5 * static_cast<double>(state.position.size()));
}

constexpr double pressure_slope = 1000 * 10, stack_height = 0.75;  // Pa/m, m
constexpr double mu = 1e6 / 2.6, lambda = 0.3 * 1e6 / (1.3 * 0.4);

/// The Cauchy stress along y of the neo-Hookean law at F = diag(1, l).
double stress(double l) {
  return (mu * (l * l - 1) + lambda * std::log(l)) / l;
}

/// The mean of f over the heights Y of a block before it settles.
double mean_over_block(int block, const std::function<double(double)>& f) {
  constexpr int parts = 100;
  double sum = 0;
  for (int k = 0; k < parts; ++k) sum += f(0.25 * (block + (k + 0.5) / parts)) / parts;
  return sum;
}

/// The height at rest of what began at Y. The shaft keeps its width: the stress is the weight above, and gives the stretch
/// by bisection.
double settled(double Y) {
  constexpr int parts = 50;
  double height = 0;
  for (int k = 0; k < parts; ++k) {
    const double weight = pressure_slope * (stack_height - Y * (k + 0.5) / parts);
    double low = 0.9, high = 1;
    while (high - low > 1e-12) {
      const double middle = 0.5 * (low + high);
      (stress(middle) < -weight ? low : high) = middle;
    }
    height += low * Y / parts;
  }
  return height;
}

/// The mean Cauchy stress along y over a body, Pa.
double mean_stress(const Scene& scene, int body) {
  const BodyState state = scene.body(body);
  const auto& F = state.material_state.at("deformation_gradient");
  double sum = 0;
  for (std::size_t k = 0; k < F.size(); k += 4) {
    const double J = F[k] * F[k + 3] - F[k + 1] * F[k + 2];
    sum += (mu * (F[k + 2] * F[k + 2] + F[k + 3] * F[k + 3] - 1) + lambda * std::log(J)) / J;
  }
  return 4 * sum / static_cast<double>(F.size());
}

}  // namespace

TEST_CASE("the contacts of a resting stack carry what lies above them", "[stack]") {
  for (const char* shape : {"bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp", "cpdi"}) {
    Scene scene(stack(frictionless, shape, 0), {"/solver/end_time=1.5"});
    while (scene.simulation.time() < 1) scene.simulation.step();
    // The impulse is summed over six periods 4 L / c of the vibration that is left.
    double impulse = 0, samples = 0, carried[3] = {}, height[3] = {};
    while (!scene.simulation.finished()) {
      scene.simulation.step();
      if (scene.simulation.steps() % 10 == 0) {
        samples += 1;
        for (int body = 0; body < 3; ++body)
          carried[body] += mean_stress(scene, body), height[body] += height_of(scene, body);
      }
      impulse += scene.simulation.backend().contact_record().force[1] * scene.simulation.last_time_step();
    }
    const double force = impulse / 0.5;
    INFO(shape << ": " << force / block_weight << " weights of a block");
    CHECK(std::abs(force) ==
          Approx(3 * block_weight).epsilon(0.01));  // two blocks above the lower contact, one above the upper
    for (int body = 0; body < 3; ++body) {
      // In its middle a block carries half of itself and all that lies above, whatever way the sum of both forces is
      // shared among the contacts.
      const double weight = pressure_slope * (stack_height - 0.125 - 0.25 * body);
      const double rest = mean_over_block(body, settled), before = 0.125 + 0.25 * body;
      INFO("block " << body << ": stress " << carried[body] / samples << " of " << -weight << " Pa, lower by "
                    << before - height[body] / samples << " of " << before - rest << " m");
      CHECK(carried[body] / samples == Approx(-weight).margin(0.01 * pressure_slope * stack_height));
      // Contact settles by up to half a hundredth of a cell beside what the blocks are squeezed by, 0.6 to 2 mm.
      CHECK(before - height[body] / samples == Approx(before - rest).epsilon(0.15));
      CHECK(std::abs(scene.metrics.measure().largest_speed) < 0.01);
    }
  }
}

TEST_CASE("what rests can be lifted off a contact, and not off a single velocity field", "[stack]") {
  // The block is drawn upwards with three times its weight and leaves with 2 g, for 0.1 s.
  const auto lifted = [](const std::string& contact) {
    Scene scene(stack(contact, "bspline_quadratic", 3));
    scene.run();
    return std::pair{height_of(scene, 1), height_of(scene, 2)};
  };
  const auto [below, above] = lifted(frictionless);
  CHECK(above == Approx(0.625 + 0.5 * 20 * 0.01).margin(0.01));
  CHECK(below < 0.375);
  // Stick is the same weld as no contact at all: three weights pull on three blocks and nothing moves.
  for (const char* weld : {"", R"("contact": {"type": "stick"},)"}) {
    const auto [welded_below, welded_above] = lifted(weld);
    CHECK(welded_above < 0.63);
    CHECK(welded_below > below + 1e-4);
  }
}

// Blocks that rest on one another. Contact carries the weight of what lies above; a single velocity field carries it
// too, but is a weld: what rests on it cannot be lifted off.

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
    bodies += std::string(k ? "," : "") + R"({"name": "block )" + std::to_string(k + 1) +
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

}  // namespace

TEST_CASE("the contacts of a resting stack carry what lies above them", "[stack]") {
  for (const char* shape : {"bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp", "cpdi"}) {
    Scene scene(stack(frictionless, shape, 0), {"/solver/end_time=1.5"});
    while (scene.simulation.time() < 1) scene.simulation.step();
    // The impulse is summed over six periods 4 L / c of the vibration that is left.
    double impulse = 0;
    while (!scene.simulation.finished()) {
      scene.simulation.step();
      impulse += scene.simulation.backend().contact_record().force[1] * scene.simulation.last_time_step();
    }
    const double force = impulse / 0.5;
    INFO(shape << ": " << force / block_weight << " weights of a block");
    CHECK(std::abs(force) ==
          Approx(3 * block_weight).epsilon(0.01));  // two blocks above the lower contact, one above the upper
    for (int body = 0; body < 3; ++body) {
      // The stack of 0.75 m is 5 mm shorter at its top.
      CHECK(height_of(scene, body) == Approx(0.125 + 0.25 * body).margin(0.006));
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

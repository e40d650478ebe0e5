// PolyPIC: what its polynomials conserve and reproduce, and that a whole basis loses nothing.

#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/catch.hpp"
#include "support/differences.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::vector<std::string> backends{"reference", "cpu"};
const char *multilinear = R"({"type": "polypic", "basis": "multilinear"})",
           *full = R"({"type": "polypic", "basis": "full"})";

/// The particles are jittered, of soft material and without forces; a step without time is a visit of the grid alone.
std::string block(int dimension, const std::string& velocity) {
  const bool flat = dimension == 2;
  return R"({"title": "block", "dimension": )" + std::to_string(dimension) +
         R"(, "grid": {"cell_size": 0.1, "domain": )" + (flat ? "[[0, 0], [3, 3]]" : "[[0, 0, 0], [2, 2, 2]]") +
         R"(, "boundaries": {"all": "free"}}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "polypic"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-6, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [{"name": "block", "material": "m", "jitter": 0.3, "geometry": {"type": "box", "lower": )" +
         (flat ? "[1, 1], \"upper\": [1.6, 1.4]" : "[0.8, 0.8, 0.8], \"upper\": [1.1, 1.1, 1.0]") +
         R"(}, "velocity": )" + velocity + R"(}], "solver": {"time_step": 1e-14, "end_time": 1}})";
}
const char* rough_2d = R"J(["1 - 4*(y-1.2) + 0.5*sin(31*x)", "-2 + 4*(x-1.3) + 0.5*cos(27*y)"])J";
const char* rough_3d = R"J(["1 - 4*(y-1.2) + 0.5*sin(31*z)", "-2 + 4*(x-1.3) - 2*z", "2*y + 0.5*sin(29*x)"])J";
std::string rough(int dimension) {
  return block(dimension, dimension == 2 ? rough_2d : rough_3d);
}

const std::vector<double>& coefficients(const BodyState& state) {
  return state.transfer_state.at(polynomial_coefficients);
}

}  // namespace

TEST_CASE("PolyPIC keeps momentum and angular momentum over every visit of the grid", "[round_trip][polypic]") {
  for (const std::string& backend : backends)
    for (const std::string shape :
         {"linear", "bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp"})
      for (const int dimension : {2, 3})
        for (const char* transfer : {multilinear, full}) {
          if (transfer == full && shape.find("gimp") != shape.npos) continue;                      // refused by name
          if (backend == "reference" && dimension == 3 && shape != "bspline_quadratic") continue;  // slow
          Scene scene(rough(dimension),
                      {set("/backend", backend), set("/shape/type", shape), set("/transfer", transfer)});
          const Totals start = scene.metrics.initial(), end = scene.run_steps(10);
          INFO(backend << " " << shape << " " << dimension << "-D " << transfer << " lost " << lost_spin(start, end));
          CHECK(end.mass == Approx(start.mass).epsilon(1e-13));
          for (int c = 0; c < dimension; ++c)
            CHECK(std::abs(end.momentum[c] - start.momentum[c]) < 1e-12 * start.mass * 2);
          CHECK(lost_spin(start, end) < 1e-11);
          CHECK(end.kinetic < (1 + 1e-12) * start.kinetic);
        }
}

TEST_CASE("PolyPIC keeps angular momentum of a moving body on splines", "[round_trip][polypic]") {
  for (const std::string& backend : backends)
    for (const char* transfer : {multilinear, full}) {
      Scene scene(rough(2), {set("/backend", backend), set("/transfer", transfer), "/solver/time_step=1e-3",
                             "/materials/m/youngs_modulus=1e5"});
      const Totals start = scene.metrics.initial(), end = scene.run_steps(100);
      CHECK(lost_spin(start, end) < 1e-11);
      for (int c = 0; c < 2; ++c) CHECK(std::abs(end.momentum[c] - start.momentum[c]) < 1e-12 * start.mass * 2);
    }
}

TEST_CASE("a whole basis loses nothing: gather and scatter of resting particles are the identity",
          "[round_trip][polypic]") {
  // One visit makes a field of the grid's; all later ones leave particles and energy as they are.
  for (const std::string& backend : backends)
    for (const std::string shape : {"linear", "bspline_quadratic", "bspline_cubic"})
      for (const int dimension : {2, 3})
        for (const char* transfer : {multilinear, full}) {
          if (backend == "reference" && dimension == 3 && shape == "bspline_cubic") continue;  // slow
          Scene scene(rough(dimension),
                      {set("/backend", backend), set("/shape/type", shape), set("/transfer", transfer)});
          scene.run_steps(1);
          const BodyState once = scene.body();
          const Totals before = scene.metrics.measure(), after = scene.run_steps(3);
          const BodyState later = scene.body();
          INFO(backend << " " << shape << " " << dimension << "-D " << transfer);
          const double change = largest_difference(once.velocity, later.velocity),
                       of_basis = largest_difference(coefficients(once), coefficients(later));
          if (transfer == full || shape == "linear") {  // on two nodes an axis the multilinear basis is whole
            CHECK(change < 1e-11);
            CHECK(of_basis < 1e-10);
            CHECK(after.kinetic == Approx(before.kinetic).epsilon(1e-12));
          } else {
            CHECK(change > 1e-4);
            CHECK(after.kinetic < 0.9999 * before.kinetic);
          }
        }
}

TEST_CASE("a multilinear field passes PolyPIC unchanged once its particles hold it", "[round_trip][polypic]") {
  // The first coefficients are zero, so the field's own, h^2 times the factor of x y, are written into a saved state.
  const double h = 0.1, factor[2] = {3, -5};
  for (const std::string shape :
       {"linear", "bspline_quadratic", "bspline_cubic", "gimp", "gimp_contiguous", "b2gimp"}) {
    const std::vector<std::string> choice{set("/backend", "reference"), set("/shape/type", shape)};
    Scene scene(block(2, R"(["1 + 2*x - y + 3*x*y", "-2 + y - 5*x*y"])"), choice);
    ArchiveWriter saved;
    scene.simulation.save(saved);
    std::vector<char> bytes = saved.bytes();
    const std::string tag = polynomial_coefficients;
    const auto found = std::search(bytes.begin(), bytes.end(), tag.begin(), tag.end());
    REQUIRE(found != bytes.end());
    const std::size_t particles = scene.body().position.size() / 2;
    for (std::size_t k = 0; k < 2 * particles; ++k) {  // particle by particle
      const double value = h * h * factor[k % 2];
      std::memcpy(&*found + tag.size() + k * sizeof value, &value, sizeof value);
    }
    ArchiveReader reader(bytes);
    scene.simulation.restore(reader);
    const BodyState before = scene.body();
    scene.run_steps(3);
    const BodyState after = scene.body();
    Scene apic(block(2, R"(["1 + 2*x - y + 3*x*y", "-2 + y - 5*x*y"])"),
               {choice[0], choice[1], R"(/transfer={"type": "apic"})"});
    apic.run_steps(3);
    INFO(shape);
    // The bound is that of the first gradient, a central difference over 2e-5 m.
    CHECK(largest_difference(before.velocity, after.velocity) < 1e-10);
    for (std::size_t k = 0; k < 2 * particles; ++k)
      CHECK(std::abs(coefficients(after)[k] - h * h * factor[k % 2]) < 1e-10);
    CHECK(largest_difference(before.velocity, apic.body().velocity) > 1e-3);
  }
}

TEST_CASE("PolyPIC is refused where it has no axes or no weights, by name", "[polypic]") {
  const auto refusal = [](const std::string& shape, const std::string& transfer) -> std::string {
    try {
      Scene scene(rough(2), {set("/shape/type", shape), set("/transfer", transfer)});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(refusal("cpdi", multilinear).find("the nodes of shape \"cpdi\" have no axes") != std::string::npos);
  CHECK(refusal("gimp", full).find("outer weights of shape \"gimp\" vanish") != std::string::npos);
  CHECK(refusal("gimp", multilinear).empty());
}

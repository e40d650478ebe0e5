// Contact beside a slip wall: a body and its mirror image have one normal at the nodes of the wall, along it. Without
// the image the averaged volume gradients of two bodies that weigh there unequally point into the wall.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The two bars run into each other in the middle of a cell; y = 0 cuts them in half.
const char* whole = R"J({
  "dimension": 2, "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, -0.8], [3, 0.8]], "boundaries": {"all": "free"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"}, "contact": {"type": "coulomb", "friction": 0.3},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "left", "material": "m", "velocity": ["1 + x*y^2", "0.5*y"],
     "geometry": {"type": "box", "lower": [1, -0.3], "upper": [1.55, 0.3]}},
    {"name": "right", "material": "m", "velocity": ["-1", "-0.5*y*x"],
     "geometry": {"type": "box", "lower": [1.55, -0.3], "upper": [2, 0.3]}}],
  "solver": {"time_step": 1e-3, "end_time": 1}, "output": {"ledger": false}})J";

double largest_difference_of_upper_half(const BodyState& full, const BodyState& half) {
  double error = 0;
  std::size_t k = 0;
  for (std::size_t p = 0; p < full.position.size(); p += 2) {
    if (full.position[p + 1] < 0) continue;
    REQUIRE(k < half.position.size());
    for (std::size_t c = 0; c < 2; ++c) error = larger(error, std::abs(full.velocity[p + c] - half.velocity[k + c]));
    k += 2;
  }
  REQUIRE(k == half.position.size());
  return error;
}

}  // namespace

TEST_CASE("a slip wall is the plane of symmetry of two bodies in contact", "[contact][walls]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape : {"linear", "bspline_quadratic", "gimp", "cpdi"})
      for (const std::string transfer : {"flip", "apic"})
        for (const auto& [filtered, normal] : std::vector<std::pair<bool, std::string>>{
                 {false, ""}, {true, ""}, {false, "widest_gap"}, {false, "surfaces"}}) {
          if (filtered && transfer == "flip") continue;
          std::vector<std::string> common{set("/backend", backend), set("/shape/type", shape),
                                          set("/transfer/type", transfer)};
          if (filtered) common.emplace_back(R"(/filter={"type": "fmpm", "order": 3})");
          if (normal == "widest_gap") common.emplace_back("/contact/normal=widest_gap");
          if (normal == "surfaces") common.emplace_back("/contact/detection=particle_surfaces");
          std::vector<std::string> upper = common;
          upper.insert(upper.end(),
                       {"/grid/domain=[[0,0],[3,0.8]]", R"(/grid/boundaries={"all":"free","y_min":"slip"})",
                        "/bodies/0/geometry/lower=[1,0]", "/bodies/1/geometry/lower=[1.55,0]"});
          Scene full(whole, common), half(whole, upper);
          full.run_steps(20), half.run_steps(20);
          INFO(backend << " " << shape << " " << transfer << (filtered ? " fmpm " : " ") << normal);
          CHECK(full.simulation.backend().contact_record().nodes > 0);
          for (const int body : {0, 1})
            CHECK(largest_difference_of_upper_half(full.body(body), half.body(body)) < 1e-10);
        }
}

// Breakable glue, whose law keeps a state on particles: reference and cpu, in 2-D, around an axis and in 3-D, whole and while
// it breaks.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The impact loads the glue with some 500 Pa, beyond these strengths at some nodes and steps.
std::string weak(const std::string& more = "") {
  return R"({"type": "breakable_glue", "tension_stiffness": 1e4, "compression_stiffness": 5e4, "shear_stiffness": 2e4,
             "normal_strength": 250, "shear_strength": 300, "friction": 0.2)" +
         more + "}";
}

/// The share of the second body's glue that has broken.
double broken(const Scene& scene) {
  const BodyState state = scene.body(1);
  const std::vector<double>& kept = state.host_state.at("contact_state");
  double glued = 0, broken = 0;
  for (std::size_t p = 0; p < kept.size(); p += 2) glued += kept[p], broken += std::min(kept[p], kept[p + 1]);
  return broken / glued;
}

/// Compares a mix, and makes sure that its glue does not break all at once.
void check_breaking(const Mix& mix) {
  Scene scene(mix.text(), mix.overrides);
  int partly = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    partly += broken(scene) > 0.05 && broken(scene) < 0.9;
  }
  INFO(mix.name());
  CHECK(partly > 1);
  CHECK(broken(scene) > 0.4);
  check_parity(mix);
}

}  // namespace

TEST_CASE("parity of glue that breaks", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string filter : {"", R"({"type": "fmpm", "order": 2})"}) {
      Mix mix;
      mix.dimension = dimension, mix.contact = weak(), mix.filter = filter;
      check_breaking(mix);
    }
  Mix rings;
  rings.contact = weak(), rings.overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
  check_breaking(rings);
  Mix walls;
  walls.contact = weak(), walls.close = true, walls.boundaries = R"({"all": "separate"})";
  check_parity(walls);
  for (const char* normal : {R"(, "normal": "widest_gap")", R"(, "normal": "own_gradient")"}) {
    Mix other;
    other.contact = weak(normal);
    check_parity(other);
  }
  for (const char* shape : {R"({"type": "cpdi"})", R"({"type": "bspline_cubic"})", R"({"type": "gimp_contiguous"})"}) {
    Mix other;
    other.contact = weak(), other.shape = shape, other.stress_update = "modified_last";
    check_parity(other);
  }
}

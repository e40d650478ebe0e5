// Adhesion, whose law reads the traction around a node: reference and cpu, in 2-D, around an axis and in 3-D, while it
// holds and while it gives way.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The traction of the impact, of some 1500 Pa, is beyond these strengths at some nodes and steps.
const std::string weak = R"({"type": "adhesion", "normal_strength": 300, "shear_strength": 200, "friction": 0.2})",
                  strong = R"({"type": "adhesion", "normal_strength": 1e6, "shear_strength": 1e6})";

}  // namespace

TEST_CASE("parity of adhesion that holds and gives way", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string& contact : {weak, strong})
      for (const std::string filter : {"", R"({"type": "fmpm", "order": 2})"}) {
        Mix mix;
        mix.dimension = dimension, mix.contact = contact, mix.filter = filter;
        check_parity(mix);
      }
  Mix rings;
  rings.contact = weak, rings.overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
  check_parity(rings);
  Mix walls;
  walls.contact = weak, walls.close = true, walls.boundaries = R"({"all": "separate"})";
  check_parity(walls);
  Mix by_particles;
  by_particles.contact =
      R"({"type": "adhesion", "normal_strength": 300, "shear_strength": 200, "normal": "widest_gap"})";
  check_parity(by_particles);
}

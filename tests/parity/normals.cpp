// Contact whose normal or detection looks at particles, with every shape, order and wall.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string normals[] = {R"({"type": "coulomb", "friction": 0.2, "normal": "widest_gap"})",
                               R"({"type": "coulomb", "friction": 0.2, "detection": "particle_surfaces"})",
                               R"({"type": "coulomb", "normal": "widest_gap", "detection": "particle_surfaces"})"};

}  // namespace

TEST_CASE("parity of normals and surfaces of particles with every shape and order", "[parity][normals]") {
  for (const int dimension : {2, 3})
    for (const std::string& shape : variants(MPM_SHAPE))
      for (const std::string& contact : normals)
        for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
          if (dimension == 3 && order != "last") continue;  // 2-D has all orders
          Mix mix;
          mix.dimension = dimension;
          mix.shape = shape, mix.contact = contact, mix.stress_update = order;
          if (shape.find("linear") != shape.npos)  // tents turn a soft particle between the bodies inside out
            mix.material = R"({"type": "neo_hookean", "youngs_modulus": 4000, "poisson_ratio": 0.3, "density": 1000})";
          check_parity(mix);
        }
}

TEST_CASE("parity of normals and surfaces of particles beside walls, around an axis, with filters and sizes",
          "[parity][normals]") {
  for (const int dimension : {2, 3})
    for (const std::string boundaries :
         {R"({"all": "slip"})", R"({"all": "stick"})", R"({"all": "periodic"})",
          R"({"all": "separate", "x_min": "periodic", "x_max": "periodic"})", R"({"all": "slip", "y_max": "free"})"}) {
      Mix mix;
      mix.dimension = dimension;
      mix.contact = normals[2], mix.boundaries = boundaries, mix.close = true;
      check_parity(mix);
    }
  for (const std::string& contact : normals) {
    Mix rings;
    rings.contact = contact, rings.boundaries = R"({"all": "slip", "x_max": "free"})";
    rings.overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
    check_parity(rings);
    Mix filtered;
    filtered.contact = contact, filtered.filter = R"({"type": "fmpm", "order": 2})";
    check_parity(filtered);
    Mix sizes;
    sizes.contact = contact, sizes.overrides = {"/bodies/0/seeding=blue_noise", "/bodies/1/seeding=random",
                                                "/bodies/0/jitter=0", "/bodies/1/jitter=0"};
    check_parity(sizes);
  }
}

// Every contact normal, and detection that looks at particles: with every law, shape, order and wall.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string normals[] = {R"({"type": "coulomb", "friction": 0.2, "normal": "widest_gap"})",
                               R"({"type": "coulomb", "friction": 0.2, "detection": "particle_surfaces"})",
                               R"({"type": "coulomb", "normal": "widest_gap", "detection": "particle_surfaces"})"};

/// Contact with a law and a normal, both as JSON objects.
std::string contact_of(const std::string& law, const std::string& normal) {
  return law.substr(0, law.size() - 1) + ", \"normal\": " + normal + "}";
}

const std::string coulomb = R"({"type": "coulomb", "friction": 0.2})";

bool is(const std::string& choice, const std::string& id) {
  return choice.find("\"" + id + "\"") != choice.npos;
}

}  // namespace

TEST_CASE("parity of every detection with laws, shapes, orders, walls and sizes", "[parity][normals]") {
  const auto with = [](const std::string& law, const std::string& detection) {
    return law.substr(0, law.size() - 1) + ", \"detection\": " + detection + "}";
  };
  for (const std::string& detection : variants(MPM_DETECTION)) {
    for (const int dimension : {2, 3})
      for (const std::string& law : variants(MPM_CONTACT)) {
        if (is(law, "stick")) continue;  // a weld looks at no gap
        Mix mix;
        mix.dimension = dimension, mix.contact = with(law, detection);
        if (!is_refused(mix)) check_parity(mix);  // a law that holds what is near refuses a detection without a gap
      }
    for (const std::string& shape : variants(MPM_SHAPE))
      for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
        Mix mix;
        mix.shape = shape, mix.contact = with(coulomb, detection), mix.stress_update = order;
        if (shape.find("linear") != shape.npos)  // tents turn a soft particle between the bodies inside out
          mix.material = R"({"type": "neo_hookean", "youngs_modulus": 4000, "poisson_ratio": 0.3, "density": 1000})";
        check_parity(mix);
      }
    Mix rings;
    rings.contact = with(coulomb, detection), rings.boundaries = R"({"all": "slip", "x_max": "free"})";
    rings.overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
    check_parity(rings);
    Mix walls;
    walls.contact = with(coulomb, detection), walls.close = true;
    walls.boundaries = R"({"all": "separate", "x_min": "periodic", "x_max": "periodic"})";
    check_parity(walls);
    Mix sizes;
    sizes.contact = with(coulomb, detection);
    sizes.overrides = {"/bodies/0/seeding=blue_noise", "/bodies/1/seeding=random", "/bodies/0/jitter=0",
                       "/bodies/1/jitter=0"};
    check_parity(sizes);
    Mix filtered;
    filtered.contact = with(coulomb, detection), filtered.filter = R"({"type": "fmpm", "order": 2})";
    check_parity(filtered);
  }
}

TEST_CASE("parity of every normal with every law", "[parity][normals]") {
  for (const int dimension : {2, 3})
    for (const std::string& normal : variants(MPM_NORMAL))
      for (const std::string& law : variants(MPM_CONTACT)) {
        if (is(law, "stick")) continue;  // a weld looks at no normal
        Mix mix;
        mix.dimension = dimension, mix.contact = contact_of(law, normal);
        check_parity(mix);
      }
}

TEST_CASE("parity of every normal around an axis, beside walls, with sizes, filters and orders", "[parity][normals]") {
  for (const std::string& normal : variants(MPM_NORMAL)) {
    Mix rings;
    rings.contact = contact_of(coulomb, normal), rings.boundaries = R"({"all": "slip", "x_max": "free"})";
    rings.overrides = {"/grid/symmetry=axisymmetric", "/gravity=[0, -1.3]"};
    check_parity(rings);
    for (const std::string boundaries :
         {R"({"all": "separate", "x_min": "periodic", "x_max": "periodic"})", R"({"all": "stick"})"}) {
      Mix walls;
      walls.contact = contact_of(coulomb, normal), walls.boundaries = boundaries, walls.close = true;
      check_parity(walls);
    }
    Mix sizes;
    sizes.contact = contact_of(coulomb, normal);
    sizes.overrides = {"/bodies/0/seeding=blue_noise", "/bodies/1/seeding=random", "/bodies/0/jitter=0",
                       "/bodies/1/jitter=0"};
    check_parity(sizes);
    Mix remapped;
    remapped.contact = contact_of(coulomb, normal), remapped.stress_update = "modified_last";
    check_parity(remapped);
    if (is(normal, "own_gradient")) continue;  // refused with a filter
    Mix filtered;
    filtered.contact = contact_of(coulomb, normal), filtered.filter = R"({"type": "fmpm", "order": 2})";
    check_parity(filtered);
  }
}

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

TEST_CASE("parity of contact under a strain cap", "[parity][normals]") {
  for (const int dimension : {2, 3})
    for (const std::string law :
         {R"({"type": "frictionless", "strain_cap": 0.004})",
          R"({"type": "coulomb", "friction": 0.2, "strain_cap": 0.004})",
          R"({"type": "coulomb", "friction": 2, "strain_cap": 0.004, "normal": "widest_gap"})"}) {
      Mix mix;
      mix.dimension = dimension, mix.contact = law;
      check_parity(mix);
      mix.filter = R"({"type": "fmpm", "order": 2, "constraints": "every_increment"})";
      if (!is_refused(mix)) check_parity(mix);
    }
}

// Parameters that lie in their ranges and do not fit one another, the cell size or the scene: the plugins of the build say
// so, and the message stands at the place in the file, with the nearest value that fits.
#include "drive/read_drive.hpp"
#include "experiment/read.hpp"
#include "solvers/solver.hpp"
#include "support/catch.hpp"

using namespace mpm;

namespace {

const Registry& plugins() {
  static const Registry registry = Registry::from_folders(Registry::default_folders());
  return registry;
}

/// What is wrong with a scene of one material, or "accepted".
std::string refusal(const std::string& material, const std::string& cell_size, int dimension = 2,
                    const std::string& symmetry = "plane_strain") {
  const bool flat = dimension == 2;
  const std::string text = R"J({ "dimension": )J" + std::to_string(dimension) + R"J(, "grid": {"cell_size": )J" +
                           cell_size + R"J(, "domain": )J" +
                           (flat ? "[[0, 0], [1, 1]], \"symmetry\": \"" + symmetry + "\"" : "[[0, 0, 0], [1, 1, 1]]") +
                           R"J(}, "shape": {"type": "linear"}, "transfer": {"type": "apic"},
    "materials": {"m": )J" +
                           material + R"J(},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", )J" +
                           (flat ? R"J("lower": [0.2, 0.2], "upper": [0.8, 0.8]}}])J"
                                 : R"J("lower": [0.2, 0.2, 0.2], "upper": [0.8, 0.8, 0.8]}}])J") +
                           R"J(, "solver": {"end_time": 1}})J";
  ReadOptions options;
  options.solvers = solver_descriptions();
  try {
    read_experiment_text(text, "test.json", ComponentLookup(plugins()), options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// A material of E = 10 GPa, ft = 5 MPa and Gc = 50 J/m^2, which is usable on cells below 4 cm.
const std::string brittle = R"J("type": "damage", "youngs_modulus": "10 GPa", "poisson_ratio": 0.2, "density": 2400,
                                "tensile_strength": "5 MPa", "fracture_energy": 50)J";
const std::string snaps_back =
    "at its strength a band this wide holds more elastic energy than its crack dissipates, so that it would snap back; "
    "take "
    "smaller cells or a larger fracture_energy";

const std::string spruce = R"J("type": "transversely_isotropic", "youngs_modulus_axial": "12 GPa",
    "youngs_modulus_transverse": "700 MPa", "poisson_ratio_transverse": 0.31, "shear_modulus_axial": "750 MPa",
    "density": 500)J";
const std::string upright = R"J(, "poisson_ratio_axial": 0.42, "axis_x": 0, "axis_y": 1)J";

}  // namespace

TEST_CASE("cells on which damage would snap back are refused with the largest usable one", "[config]") {
  CHECK(refusal("{" + brittle + "}", "0.01") == "accepted");
  CHECK(refusal("{" + brittle + "}", "0.05") ==
        "test.json:1:41: /grid/cell_size: material \"damage\" cannot have \"cell_size\" 0.05 m, at most 0.04 m: " +
            snaps_back);
  CHECK(refusal("{" + brittle + "}", "0.04").find("\"cell_size\" 0.04 m, which is the limit itself: at its strength") !=
        std::string::npos);
  CHECK(refusal("{" + brittle + ", \"softening\": \"bilinear\"}", "\"25 mm\"") ==
        "test.json:1:41: /grid/cell_size: material \"damage\" cannot have \"cell_size\" 0.025 m, at most 0.024 m: " +
            snaps_back);
  CHECK(refusal("{" + brittle + ", \"band_cells\": 2}", "0.03", 3).find("at most 0.02 m") != std::string::npos);
  // Of a value that is no cell size nothing more is said.
  CHECK(refusal("{" + brittle + "}", "-1").find("damage") == std::string::npos);
  CHECK(refusal("{" + brittle + ", \"softening\": \"sudden\"}", "0.05").find("snap back") == std::string::npos);
}

TEST_CASE("cells on which a crack on a plane would snap back, pulled or sheared, are refused", "[config]") {
  // E = 10 GPa, mu = E/2.4: 2 E Gc/ft^2 = 0.04 m, and 2 mu Gs/ts^2 = 0.01 m with Gs = 30 J/m^2.
  const auto cracks = [](const std::string& more) {
    std::string text = "{" + brittle + R"J(, "shear_strength": "5 MPa", )J" + more + "}";
    return text.replace(text.find("damage"), 6, "anisotropic_damage");
  };
  const std::string weak = R"J("shear_fracture_energy": 30)J", tough = R"J("shear_fracture_energy": 300)J";
  CHECK(refusal(cracks(weak), "0.005") == "accepted");
  CHECK(refusal(cracks(tough), "0.02") == "accepted");
  CHECK(refusal(cracks(weak), "0.02") ==
        "test.json:1:41: /grid/cell_size: material \"anisotropic_damage\" cannot have \"cell_size\" 0.02 m, at most "
        "0.01 m: at its shear strength a band this wide holds more elastic energy than its crack dissipates as it "
        "slides, "
        "so that it would snap back; take smaller cells or a larger shear_fracture_energy");
  CHECK(refusal(cracks(tough), "0.05") ==
        "test.json:1:41: /grid/cell_size: material \"anisotropic_damage\" cannot have \"cell_size\" 0.05 m, at most "
        "0.04 m: at its tensile strength a band this wide holds more elastic energy than its crack dissipates, so that "
        "it "
        "would snap back; take smaller cells or a larger fracture_energy");
  CHECK(refusal(cracks(weak + R"J(, "shear_softening": "bilinear")J"), "0.02").find("at most 0.006 m: at its shear") !=
        std::string::npos);
  CHECK(refusal(cracks(tough + R"J(, "softening": "bilinear")J"), "0.05", 3).find("at most 0.024 m: at its tensile") !=
        std::string::npos);
  CHECK(refusal(cracks(weak + R"J(, "band_cells": 2)J"), "0.02").find("at most 0.005 m") != std::string::npos);
}

TEST_CASE("a material that melts into one that would snap back is refused", "[config]") {
  const std::string melts =
      R"J(, "thermal": {"conductivity": 1, "heat_capacity": 1, "phase_change": {"temperature": 300,
      "latent_heat": 1, "melted": {"fracture_energy": 5}}}})J";
  const std::string found = refusal("{" + brittle + melts, "0.01");
  INFO(found);
  CHECK(found.find("/grid/cell_size: material \"damage\" cannot have \"cell_size\" 0.01 m, at most 0.004 m") !=
        std::string::npos);
}

TEST_CASE("a material point refuses a cell size that a grid could not have", "[config]") {
  const auto drive = [](const std::string& size) -> std::string {
    const std::string text = "{\"materials\": {\"m\": {" + brittle +
                             "}}, \"solver\": {\"type\": \"material_point\", \"cell_size\": " + size +
                             ", \"stages\": [{\"deformation_gradient\": {\"xx\": 1}}]}}";
    try {
      drive::read_drive_text(text, "FILE", ComponentLookup(plugins()), {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  CHECK(drive("0.03") == "accepted");
  const std::string found = drive("0.05");
  INFO(found);
  CHECK(found.find("/solver/cell_size: material \"damage\" cannot have \"cell_size\" 0.05 m, at most 0.04 m: " +
                   snaps_back) != std::string::npos);
}

TEST_CASE("an axis that 2-D does not hold and a stiffness that is not positive are refused", "[config]") {
  for (const char* symmetry : {"plane_strain", "axisymmetric"}) {
    CHECK(refusal("{" + spruce + upright + "}", "0.1", 2, symmetry) == "accepted");
    const std::string found = refusal("{" + spruce + upright + ", \"axis_z\": 0.5}", "0.1", 2, symmetry);
    INFO(found);
    CHECK(found.find(
              "/materials/m/axis_z: material \"transversely_isotropic\" cannot have \"axis_z\" 0.5, at most 0: in "
              "2-D the axis lies in the plane (axis_z = 0) or across it (axis_x = axis_y = 0)") != std::string::npos);
  }
  CHECK(refusal("{" + spruce + upright + ", \"axis_z\": 0.5}", "0.1", 3) == "accepted");
  const std::string none = refusal("{" + spruce + ", \"poisson_ratio_axial\": 0.42, \"axis_x\": 0}", "0.1");
  INFO(none);
  CHECK(none.find("/materials/m/axis_x: material \"transversely_isotropic\" cannot have \"axis_x\" 0: the axis has no "
                  "length") != std::string::npos);
  const std::string soft = refusal("{" + spruce + ", \"poisson_ratio_axial\": -2.5}", "0.1", 3);
  INFO(soft);
  CHECK(soft.find("/materials/m/poisson_ratio_axial: material \"transversely_isotropic\" cannot have "
                  "\"poisson_ratio_axial\" -2.5, at least -2.43193045: the stiffness is positive definite where") !=
        std::string::npos);
}

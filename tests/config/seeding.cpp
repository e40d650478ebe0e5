// Seedings, initial states and files of bodies: what good ones become, and whole error texts of bad ones.
#include <fstream>

#include "config/config_support.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The two discs with further keys of the left one, and files beside the experiment.
class Discs {
 public:
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string errors_of(const std::string& keys, const std::string& geometry = "") const {
    try {
      read(keys, geometry);
    } catch (const InputError& error) {
      std::string text = replaced(error.what(), (folder_ / "experiment.json").string(), "FILE");
      return replaced(text, folder_.path().string(), "FOLDER");
    }
    return "accepted";
  }
  Experiment read(const std::string& keys, const std::string& geometry = "") const {
    std::string text = replaced(two_discs, "\"particles_per_cell_axis\": 3, \"jitter\": 0.1,", keys);
    const std::string ball = "\"geometry\": {\"type\": \"ball\", \"centre\": [0.2, 0.2], \"radius\": \"20 cm\"},";
    if (!geometry.empty()) text = replaced(text, ball, geometry == "none" ? "" : "\"geometry\": " + geometry + ",");
    return read_experiment(experiment_file(folder_, text), components(), options());
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("a seeding is a word or an object, and fitted where none is named", "[config]") {
  const Discs discs;
  CHECK(discs.read("").bodies[0].seeding.kind == SeedingKind::fitted);
  CHECK(discs.read("").resolved["bodies"][0]["seeding"].dump() == R"({"type":"fitted"})");
  CHECK(discs.read(R"("seeding": "lattice",)").bodies[0].seeding.kind == SeedingKind::lattice);
  const Experiment partial = discs.read(R"("seeding": "partial",)");
  CHECK(partial.bodies[0].seeding.kind == SeedingKind::partial);
  CHECK(partial.bodies[0].seeding.smallest_share == 0.05);
  CHECK(partial.resolved["bodies"][0]["seeding"].dump() == R"({"type":"partial","smallest_share":0.05})");
  CHECK(discs.read(R"("seeding": {"type": "blue_noise", "relaxations": 3},)").bodies[0].seeding.relaxations == 3);
  CHECK(
      discs.errors_of(R"("seeding": "fited",)") ==
      R"(FILE:22:55: /bodies/0/seeding: unknown seeding "fited"; did you mean "fitted"? (available: "lattice", "fitted", "partial", "random", "blue_noise", "points"))");
  CHECK(discs.errors_of(R"("seeding": {"type": "partial", "smallest_share": 0.6},)") ==
        "FILE:22:93: /bodies/0/seeding/smallest_share: out of range: expected a number from 0 to 0.5, got 0.6");
  CHECK(discs.errors_of(R"("seeding": "random", "jitter": 0.1,)") ==
        "FILE:22:75: /bodies/0/jitter: jitter moves particles off a lattice, and these lie on none; remove it");
}

TEST_CASE("geometry may be turned and moved, and says what it cannot be", "[config]") {
  const Discs discs;
  const std::string box = R"({"type": "box", "lower": [0.2, 0.2], "upper": [0.4, 0.3]})";
  const Experiment turned = discs.read("", R"({"type": "turned", "angle": "90 deg", "of": )" + box + "}");
  const auto [lower, upper] = turned.bodies[0].geometry->bounds();
  CHECK(lower[0] == Approx(0.25).epsilon(1e-12));  // about the middle
  CHECK(upper[1] == Approx(0.35).epsilon(1e-12));
  CHECK(turned.resolved["bodies"][0]["geometry"]["about"][1].get<double>() == Approx(0.25));
  const Experiment moved = discs.read("", R"({"type": "shifted", "by": [0.1, 0], "of": )" + box + "}");
  CHECK(moved.bodies[0].geometry->bounds().first[0] == Approx(0.3).epsilon(1e-12));
  CHECK(discs.errors_of("", R"({"type": "turned", "angle": 1, "axis": [0, 0, 1], "of": )" + box + "}")
            .find("/bodies/0/geometry/axis: \"axis\" has no meaning in 2-D, where all turns in the plane") !=
        std::string::npos);
  CHECK(discs.errors_of("", R"({"type": "shifted", "by": [0.9, 0], "of": )" + box + "}")
            .find("the body reaches outside the domain: x from 1.1 to 1.3 m") != std::string::npos);
}

TEST_CASE("points of a file are the body", "[config]") {
  const Discs discs;
  const std::string seeding = R"("seeding": {"type": "points", "file": "points.csv"},)";
  discs.put("points.csv", "x (m),y (m),mass (kg)\n0.2,0.3,2\n0.25,0.31,4\n");
  const Experiment read = discs.read(seeding, "none");
  REQUIRE(read.bodies[0].seeding.points->size() == 2);
  CHECK((*read.bodies[0].seeding.points)[1].volume == Approx(4e-3));  // of 1 g/cm^3
  CHECK(read.bodies[0].varies_in_size());
  REQUIRE(read.inputs.size() == 1);
  CHECK(read.inputs[0].sha256.size() == 64);
  CHECK(read.inputs[0].path.is_absolute());
  CHECK(discs.errors_of(seeding) ==
        "FILE:23:18: /bodies/0/geometry: the points of the file are the body; remove \"geometry\"");
  const auto refused = [&](const std::string& text) {
    discs.put("points.csv", text);
    return discs.errors_of(seeding, "none");
  };
  const std::string at = "FILE:22:82: /bodies/0/seeding/file: FOLDER/points.csv:";
  CHECK(refused("x,y\n0.2,1.3\n") == at + "2: the point lies outside the domain, or is no number");
  CHECK(refused("x,y,volume\n0.2,0.3,1\n0.2,0.3,0\n") == at + "3: expected a volume above 0");
  CHECK(refused("x,volume\n0.2,1\n") == at + "1: there is no column \"y\"");
  CHECK(refused("x,y,weight\n0.2,0.3,1\n") ==
        at + "1: column \"weight\" has no meaning here; known are x, y, in 3-D z, volume and mass");
  CHECK(refused("x,y\n") == at + "1: there is no point in the file");
  CHECK(refused("x,y\n0.2\n") == at + "2: this row has 1 cells, the header 2");
  CHECK(refused("x,y\n0.2,0.3\n\n0.3,0.3\n0.2,0.3\n") ==
        at + "5: the point is that of line 2 again: two particles in one place never part; remove one of the lines");
  CHECK(refused("x,y\n\n0.2,1.3\n") == at + "3: the point lies outside the domain, or is no number");
  CHECK(refused("x,y\n0.2,0.3\n0.3,0.3") ==
        at + "3: the last line has no end, so that a part of it may be missing; end it with a line break");
  CHECK(discs.errors_of(R"("seeding": {"type": "points", "file": "none.csv"},)", "none") ==
        "FILE:22:82: /bodies/0/seeding/file: there is no file FOLDER/none.csv; a path counts from the folder of the "
        "experiment file");
}

TEST_CASE("pictures and surfaces that are none are refused with their place", "[config]") {
  const Discs discs;
  discs.put("not.png", "no picture");
  CHECK(discs.errors_of("", R"({"type": "mask", "file": "not.png", "lower": [0.1, 0.1], "upper": [0.5, 0.5]})")
            .find("FILE:23:43: /bodies/0/geometry/file: FOLDER/not.png: ") == 0);
  CHECK(discs.errors_of("", R"({"type": "stl", "file": "not.png"})").find("\"stl\" works in 3-D only") !=
        std::string::npos);
}

TEST_CASE("initial states are read by component, and what cannot be is refused", "[config]") {
  const Discs discs;
  const Experiment read = discs.read(R"("initial_stress": {"xx": "-1 kPa", "xy": "1e3*Y"},)");
  REQUIRE(read.bodies[0].stress);
  CHECK((*read.bodies[0].stress)[0]({}, {}, 0) == -1000);
  CHECK((*read.bodies[0].stress)[5]({}, {0, 2, 0}, 0) == 2000);
  CHECK(read.bodies[0].deformed());
  const Experiment stretched = discs.read(R"("initial_deformation_gradient": {"xy": 0.5},)");
  CHECK((*stretched.bodies[0].deformation_gradient)[0]({}, {}, 0) == 1);
  CHECK((*stretched.bodies[0].deformation_gradient)[1]({}, {}, 0) == 0.5);
  // A run folder's experiment is read again, so that it must not hold what is refused.
  CHECK(read.resolved["bodies"][0]["initial_stress"].dump() == R"({"xx":-1000.0,"xy":"1e3*Y","yy":0.0})");
  CHECK(stretched.resolved["bodies"][0]["initial_deformation_gradient"].dump() ==
        R"({"xx":1.0,"xy":0.5,"yx":0.0,"yy":1.0})");
  CHECK(discs.errors_of(R"("initial_stress": {"zz": 1},)") ==
        "FILE:22:69: /bodies/0/initial_stress/zz: in plane strain the stress out of the plane follows from the "
        "others; remove \"zz\"");
  CHECK(discs.errors_of(R"("initial_deformation_gradient": {"xz": 1},)") ==
        "FILE:22:83: /bodies/0/initial_deformation_gradient/xz: in 2-D nothing is sheared out of the plane; remove "
        "\"xz\"");
  CHECK(discs.errors_of(R"("initial_stress": {"xx": 1}, "initial_displacement": [0, 0],)") ==
        "FILE:22:62: /bodies/0/initial_stress: the stress follows from \"initial_displacement\"; give one of them");
}

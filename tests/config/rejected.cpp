// Whole error texts of bad experiments.
#include "config/config_support.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {
/// The errors of the two discs with another geometry in the place of the left disc.
std::string errors_of_geometry(std::string_view geometry) {
  return errors_after(R"({"type": "ball", "centre": [0.2, 0.2], "radius": "20 cm"})", geometry);
}
bool has_message(const std::string& errors, const std::string& part) {
  UNSCOPED_INFO(errors);
  return errors.find(part) != std::string::npos;
}
constexpr const char* functions =
    R"("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "floor", )"
    R"("atan2", "pow", "if", "min", "max", "pi")";
}  // namespace

TEST_CASE("five mistakes are listed at once in the order of the file", "[config]") {
  std::string text = two_discs;
  text = replaced(text, "\"domain\": [[0, 0]", "\"domian\": [[0, 0]");
  text = replaced(text, "\"flip\"", "\"flop\"");
  text = replaced(text, "1 kPa", "1 mm");
  text = replaced(text, "\"end_time\": 3.5", "\"end_time\": \"soon\"");
  text = replaced(text, "\"frames\": 40", "\"frames\": -1");
  CHECK(errors(text) ==
        R"(FILE:6:11: /grid/domain: missing key; expected a list of points, each a list of numbers
FILE:8:5: /grid/domian: unknown key "domian"; did you mean "domain"? (valid keys: "cell_size", "domain", "symmetry", "boundaries")
FILE:16:24: /transfer/type: unknown transfer "flop"; did you mean "flip"? (available: "flip", "apic", "slow_double")
FILE:19:57: /materials/rubber/youngs_modulus: expected a pressure (Pa), got a length (mm)
FILE:32:81: /solver/end_time: expected a time (s), got the string "soon"
FILE:33:24: /output/frames: out of range: expected an integer from 0 to 100000, got -1)");
}

TEST_CASE("wrong types and ranges", "[config]") {
  CHECK(errors_after("\"dimension\": 2", "\"dimension\": \"2\"") ==
        "FILE:4:16: /dimension: expected 2 or 3, got the string \"2\"");
  CHECK(errors_after("\"radius\": \"20 cm\"", "\"radius\": \"-1 mm\"") ==
        "FILE:23:67: /bodies/0/geometry/radius: out of range: expected a length (m) above 0, got -0.001 (-1 mm)");
  CHECK(errors_after("\"friction\": 0.3", "\"friction\": true, \"normal\": \"regression\"") ==
        "FILE:17:46: /contact/friction: expected a number from 0 to 10, got true\n"
        "FILE:17:62: /contact/normal: unknown contact normal \"regression\"; available: \"average_volume_gradient\", "
        "\"widest_gap\", \"given\"");
  CHECK(
      errors_after("[\"energy\", \"contact\"]", "[\"energi\", \"energy\", \"energy\", 3]") ==
      R"(FILE:34:15: /figures/0: expected one of "energy", "dissipation", "contact", got "energi"; did you mean "energy"?
FILE:34:35: /figures/2: "energy" is listed twice
FILE:34:45: /figures/3: expected a string or a figure of columns, got the number 3)");
  CHECK(errors_after("\"gravity\": [0, \"-9.81 m/s^2\"]", "\"gravity\": [0, 1, 2]") ==
        "FILE:30:14: /gravity: expected 2 components in a 2-D experiment, got 3");
  CHECK(errors("[]") == "FILE:1:1: expected an object (an experiment), got a list");
}

TEST_CASE("an empty object lacks every required key", "[config]") {
  CHECK(errors("{}") == R"(FILE:1:1: /dimension: missing key; expected 2 or 3
FILE:1:1: /grid: missing key; expected a grid
FILE:1:1: /shape: missing key; expected a shape function
FILE:1:1: /transfer: missing key; expected a transfer scheme
FILE:1:1: /materials: missing key; expected an object of materials by name
FILE:1:1: /bodies: missing key; expected a list of bodies
FILE:1:1: /solver: missing key; expected a solver)");
}

TEST_CASE("plugins that do not exist or cannot do what is asked", "[config]") {
  CHECK(errors_after("\"dimension\": 2,", "\"dimension\": 2, \"filter\": {\"type\": \"fmpm\"},") ==
        "FILE:4:38: /filter/type: unknown filter \"fmpm\"; no filter is available");
  CHECK(
      errors_after("{\"type\": \"flip\", \"pic_fraction\": 0.1}", "{\"type\": \"slow_double\", \"iterations\": 2.5}") ==
      "FILE:16:24: /transfer/type: transfer \"slow_double\" does not offer double on backend \"cpu\"; "
      "it offers double on the reference backend\n"
      "FILE:16:53: /transfer/iterations: expected an integer from 1 to 20, got the number 2.5");
  const std::string deep = errors(two_discs, {"/dimension=3", "/shape/type=only_flat"});
  CHECK(deep.find("--set: /shape/type: shape \"only_flat\" works in 2-D only, but this experiment is 3-D") !=
        std::string::npos);
}

TEST_CASE("float is refused on the reference backend, where it was asked for", "[config]") {
  const std::string reason =
      "precision \"float\" is not available on backend \"reference\", which computes in double only; "
      "set precision to \"double\" or backend to \"cpu\"";
  const std::string both = "\"dimension\": 2, \"precision\": \"float\", \"backend\": \"reference\",";
  CHECK(errors_after("\"dimension\": 2,", both) == "FILE:4:32: /precision: " + reason);
  ReadOptions chosen = options();
  chosen.backend = "reference";
  const std::string single = replaced(two_discs, "\"dimension\": 2,", "\"dimension\": 2, \"precision\": \"float\",");
  CHECK(errors_with(single, chosen) == "--backend: /backend: " + reason);
  chosen.backend = "cdua";
  CHECK(errors_with(two_discs, chosen) ==
        "--backend: /backend: expected one of \"reference\", \"cpu\", \"cuda\", got \"cdua\"; "
        "did you mean \"cuda\"?");
}

TEST_CASE("the domain is a whole number of cells", "[config]") {
  CHECK(errors_after("[1, 1]],\n    \"bound", "[1, 0.5]],\n    \"bound").find("whole") == std::string::npos);
  CHECK(errors_after("[1, 1]],\n    \"bound", "[1, 0.99]],\n    \"bound") ==
        "FILE:8:15: /grid/domain: the domain is 0.99 m along y, which is 39.6 cells of 0.025 m; nearest whole: "
        "0.975 m (39 cells) or 1 m (40 cells)");
  CHECK(errors_after("[1, 1]],\n    \"bound", "[1, 0]],\n    \"bound") ==
        "FILE:8:15: /grid/domain: the upper corner is not above the lower one along y: 0 to 0 m");
  CHECK(errors(two_discs, {"/grid/cell_size=1e-9"}).find("more than 1048576 cells along x (1 m of 1e-09 m)") !=
        std::string::npos);
}

TEST_CASE("boundary and node conditions", "[config]") {
  const std::string wall = "{\"type\": \"prescribed\", \"velocity\": [\"A*sin(t)\", 0]}";
  CHECK(
      errors_after(wall, "\"periodic\"") ==
      "FILE:9:44: /grid/boundaries/x_min: \"x_min\" is periodic but \"x_max\" is not; periodic joins the two faces of "
      "an axis, so set both");
  CHECK(errors_after(wall, "\"prescribed\"") ==
        "FILE:9:44: /grid/boundaries/x_min: needs a velocity: {\"type\": \"prescribed\", \"velocity\": [...]}");
  CHECK(errors_after("\"all\": \"slip\"", "\"all\": \"slide\", \"z_min\": \"slip\"") ==
        R"(FILE:9:27: /grid/boundaries/all: unknown boundary condition "slide"; did you mean "slip"? )"
        R"((available: "slip", "stick", "separate", "free", "periodic", "prescribed"))"
        "\n"
        R"(FILE:9:36: /grid/boundaries/z_min: unknown key "z_min"; did you mean "x_min"? )"
        R"((valid keys: "all", "x_min", "x_max", "y_min", "y_max"))");
  CHECK(errors_after("\"axis\": \"y\", \"side\": \"-\"", "\"axis\": \"z\", \"side\": -1") ==
        "FILE:12:68: /node_conditions/0/axis: there is no z axis in a 2-D experiment\n"
        "FILE:12:81: /node_conditions/0/side: expected one of \"+\", \"-\", got the number -1");
  CHECK(errors_after("\"lower\": [0, 0], \"upper\": [1, 0], \"axis\"",
                     "\"lower\": [0, 2], \"upper\": [-1, 3], \"axis\"") ==
        "FILE:12:35: /node_conditions/0/lower: the box holds no node: it lies outside the domain along y\n"
        "FILE:12:52: /node_conditions/0/upper: the upper corner lies below the lower one along x: 0 to -1 m");
}

TEST_CASE("bodies, materials and fields", "[config]") {
  CHECK(errors_after("\"material\": \"rubber\", \"part", "\"material\": \"ruber\", \"part") ==
        "FILE:22:34: /bodies/0/material: there is no material \"ruber\"; did you mean \"rubber\"? "
        "(materials: \"rubber\")");
  CHECK(errors_after("\"name\": \"right\"", "\"name\": \"left\"") ==
        "FILE:25:14: /bodies/1/name: there are two bodies named \"left\"");
  CHECK(errors_after("\"name\": \"right\"", "\"name\": \"right\", \"field\": \"left\"") ==
        "FILE:17:14: /contact: contact needs two velocity fields or more, but all bodies name the field \"left\"");
  const std::string ball =
      R"("material": "rubber", "geometry": {"type": "ball", "centre": [0.5, 0.5], "radius": 0.2}})";
  CHECK(errors(two_discs, {"/bodies=[{\"name\": \"only\", " + ball + "]"}) ==
        "FILE:17:14: /contact: contact needs two velocity fields or more, but there is one body, \"only\"; "
        "remove \"contact\" or add a body");
  CHECK(errors(two_discs, {"/contact=null", "/bodies/0/field=one"}) ==
        "--set: /bodies/0/field: without \"contact\" all bodies share one velocity field; remove \"field\"");
  std::string nine;
  for (int i = 0; i < 9; ++i) nine += (i ? ", {\"name\": \"b" : "{\"name\": \"b") + std::to_string(i) + "\", " + ball;
  CHECK(
      errors(two_discs, {"/bodies=[" + nine + "]"}) ==
      "--set: /bodies: at most 8 velocity fields, got 9; give bodies that need no contact between them one \"field\"");
}

TEST_CASE("geometry that is degenerate or outside", "[config]") {
  CHECK(errors_of_geometry(R"({"type": "ball", "centre": [0.1, 0.2], "radius": 0.2})") ==
        "FILE:23:18: /bodies/0/geometry: the body reaches outside the domain: x from -0.1 to 0.3 m, where the domain "
        "spans 0 to 1 m");
  CHECK(errors_of_geometry(R"({"type": "polygon", "points": [[0,0],[1,1],[1,0],[0,1]]})") ==
        "FILE:23:48: /bodies/0/geometry/points: the polygon crosses or touches itself: edges 0-1 and 2-3 "
        "(points count from 0)");
  CHECK(errors_of_geometry(R"({"type": "polygon", "points": [[0,0],[1,1]]})") ==
        "FILE:23:48: /bodies/0/geometry/points: expected at least 3 points, got 2");
  CHECK(errors_of_geometry(R"({"type": "box", "lower": [0.5, 0.5], "upper": [0.2, 0.6]})") ==
        "FILE:23:64: /bodies/0/geometry/upper: the upper corner is not above the lower one along x: 0.5 to 0.2 m");
  CHECK(
      errors_of_geometry(
          R"({"type": "ring", "centre": [0.5, 0.5], "inner_radius": 0.2, "outer_radius": 0.1, "axis": "x"})") ==
      "FILE:23:94: /bodies/0/geometry/outer_radius: out of range: expected a length (m) above the inner radius of 0.2, "
      "got 0.1\n"
      "FILE:23:107: /bodies/0/geometry/axis: \"axis\" has no meaning in 2-D, where a ring is an annulus");
  CHECK(errors_of_geometry(R"({"type": "half_space", "point": [0.5, 0.5], "normal": [0, 0]})") ==
        "FILE:23:72: /bodies/0/geometry/normal: the normal is zero; it has to point out of the material");
  CHECK(
      errors_of_geometry(R"({"type": "half_space", "point": [0.5, 7], "normal": [0, -1]})") ==
      "FILE:23:18: /bodies/0/geometry: no particle lies in the body: it is empty, or thinner than the particle spacing "
      "of 0.008333333333 m");
  CHECK(errors_of_geometry(R"({"type": "half_space", "point": [0.2, 0.5], "normal": [1, 0]})") == "accepted");
  CHECK(
      errors_of_geometry(R"({"type": "intersection", "of": [{"type": "ball", "centre": [0.2, 0.2], "radius": 0.1},
                                                              {"type": "ball", "centre": [0.6, 0.6], "radius": 0.1}]})") ==
      "FILE:23:18: /bodies/0/geometry: no particle lies in the body: it is empty, or thinner than the particle spacing "
      "of 0.008333333333 m");
  CHECK(
      errors_of_geometry(R"({"type": "union", "of": [{"type": "bal"}, "ball"]})") ==
      R"(FILE:23:52: /bodies/0/geometry/of/0/type: unknown geometry "bal"; did you mean "ball"? )"
      R"((available: "ball", "box", "ring", "polygon", "half_space", "union", "difference", "intersection", "turned", "shifted", "stl", "mask"))"
      "\n"
      R"(FILE:23:60: /bodies/0/geometry/of/1: expected an object with "type" (geometry), got the string "ball")");
  CHECK(errors_of_geometry(R"({"type": "union", "of": []})") ==
        "FILE:23:42: /bodies/0/geometry/of: a union takes at least 1 geometry, got 0");
}

TEST_CASE("expressions and constants", "[config]") {
  std::string text = replaced(two_discs, "pi*t", "pi*t*z");
  text = replaced(text, "\"w\": ", "\"sin\": ");
  text = replaced(text, "\"velocity\": [\"0.1 m/s\", \"A*x\"]", "\"velocity\": [\"0.1 mm\", \"A*x +* 2\"]");
  CHECK(errors(text) ==
        R"(FILE:5:28: /constants/sin: "sin" already has a meaning in expressions
FILE:24:19: /bodies/0/velocity/0: expected a velocity (m/s), got a length (mm)
FILE:24:29: /bodies/0/velocity/1: in the expression "A*x +* 2" at character 6: unexpected operator "*"
FILE:31:25: /body_force/1: in the expression "pi*t*z" at character 6: "z" is not available here; variables are x y X Y t)");
  CHECK(
      errors_after("\"A*x\"", "\"amplitude*x\"") ==
      "FILE:24:30: /bodies/0/velocity/1: in the expression \"amplitude*x\" at character 1: unknown name \"amplitude\"; "
      "known: " +
          std::string(functions) + ", \"A\", \"w\", \"x\", \"y\", \"X\", \"Y\"");
}

TEST_CASE("output and comparisons", "[config]") {
  CHECK(errors_after("\"frames\": 40, \"vtk\": true", "\"film\": true, \"vtk\": true, \"colour_by\": \"sped\"") ==
        R"(FILE:33:22: /output/film: a film needs "frames" of at least 2
FILE:33:35: /output/vtk: VTK files are written at frames: set "frames"
FILE:33:54: /output/colour_by: expected one of "speed", "pressure", "density", got "sped"; did you mean "speed"?)");
  CHECK(errors_after("\"vtk\": true", "\"film\": \"web\"") ==
        "FILE:33:36: /output/film: expected true, false or one of \"mp4\", \"webm\", \"webp\", got \"web\"; did you "
        "mean \"webm\"?");
  CHECK(errors_after("\"vtk\": true", "\"film\": 1") ==
        "FILE:33:36: /output/film: expected true, false or one of \"mp4\", \"webm\", \"webp\", got the number 1");
  CHECK(errors_after("\"vtk\": true", "\"vtk\": true, \"ledger\": false, \"ledger_every\": 10") ==
        "FILE:33:74: /output/ledger_every: there is no ledger to make entries in: set \"ledger\" to true");
  CHECK(errors_after("\"at_least\": 0.98", "\"at_least\": 0.98, \"at_most\": 0.9, \"tolerance\": 0.1") ==
        "FILE:37:16: /compare/expect/0: nothing is both at least 0.98 and at most 0.9\n"
        "FILE:37:109: /compare/expect/0/tolerance: a tolerance belongs to \"equals\", which is not given");
  CHECK(errors_after(", \"at_least\": 0.98", "") ==
        "FILE:37:16: /compare/expect/0: expects nothing: give \"at_least\", \"at_most\" or \"equals\"");
  CHECK(errors_after("\"rolling\", \"start\": \"2 ms\"", "\"roling\"") ==
        "FILE:36:23: /compare/exact/type: unknown exact solution \"roling\"; did you mean \"rolling\"? "
        "(available: \"rolling\")");
}

TEST_CASE("limits", "[config]") {
  const auto with = [](const std::string& limits) {
    return errors_after("\"figures\":", "\"limits\": " + limits + ",\n \"figures\":");
  };
  CHECK(has_message(with(R"({"energy_gain": -0.1})"),
                    "/limits/energy_gain: out of range: expected a number of at least 0 or null, got -0.1"));
  CHECK(has_message(with(R"({"volume_ratio": [2, 0.5]})"), "/limits/volume_ratio: expected the smaller ratio first"));
  CHECK(has_message(with(R"({"volume_ratio": 0.5})"),
                    "/limits/volume_ratio: expected a list of 2 numbers or null, got the number 0.5"));
  CHECK(has_message(with(R"({"volume_ratio": [0.1, 2, 3]})"), "/limits/volume_ratio: expected 2 components, got 3"));
  CHECK(has_message(with(R"({"isolated": null})"), "/limits/isolated: expected true or false, got null"));
  CHECK(has_message(with(R"({"isolated": false, "energy_gain": 0.1})"), "and \"isolated\" is false"));
  CHECK(has_message(with(R"({"energy": 1})"), "unknown key \"energy\""));
}

TEST_CASE("overrides that cannot be applied", "[config]") {
  CHECK(errors(two_discs, {"grid/cell_size=1", "/grid/boundaries/x/type=slip", "/bodies/7/name=x", "/title/x=1",
                           "/bodies/0/geometry/radius=9 mm/s"}) ==
        R"(--set: "grid/cell_size=1" is not of the form /json/pointer=value, e.g. /grid/cell_size=0.1
--set: /grid/boundaries/x/type: there is no /grid/boundaries/x; the nearest that exists, /grid/boundaries, is an object with "all", "x_min"
--set: /bodies/7/name: there is no /bodies/7; the nearest that exists, /bodies, is a list of 2
--set: /title/x: cannot be set: the nearest that exists, /title, is the string "Two elastic discs"
--set: /bodies/0/geometry/radius: expected a length (m), got a velocity (mm/s))");
}

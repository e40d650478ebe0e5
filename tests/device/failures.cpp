// A particle that cannot go on stops a run with the same record on the reference, the cpu and the host-run device.

#include <optional>

#include "device/device_support.hpp"
#include "simulation/imposed_value.hpp"
#include "simulation/offers_totals.hpp"

using namespace mpm;
using namespace std::string_literals;
using namespace mpm::test;

namespace {

struct Stop {
  Failure failure;
  std::string text;
  long step;
};
template <class AnyScene>
std::optional<Stop> stop_of(AnyScene& scene) {
  try {
    while (!scene.simulation.finished()) scene.simulation.step();
  } catch (const RunFailure& stopped) {
    return Stop{stopped.failure, cause_text(stopped.failure, scene.experiment), scene.simulation.steps()};
  }
  return std::nullopt;
}

/// Runs a scene of doubles on all three; returns what the reference stopped with.
Failure common_failure(const std::string& text, const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> chosen = overrides;
  chosen.insert(chosen.end(), {"/backend=reference", "/precision=double"});
  Scene reference(text, chosen);
  chosen[overrides.size()] = "/backend=cpu";
  Scene cpu(text, chosen);
  DeviceScene device(text, "double", {}, overrides);
  const std::optional<Stop> expected = stop_of(reference);
  REQUIRE(expected);
  for (const auto& [name, found] : {std::pair{"cpu", stop_of(cpu)}, {"device", stop_of(device)}}) {
    INFO(name << ", reference: " << expected->text);
    REQUIRE(found);
    CHECK(found->text == expected->text);
    CHECK(found->failure.cause == expected->failure.cause);
    CHECK(found->failure.body == expected->failure.body);
    CHECK(found->failure.particle == expected->failure.particle);
    CHECK(found->failure.axis == expected->failure.axis);
    const double value = found->failure.value, wanted = expected->failure.value;
    CHECK(std::isfinite(value) == std::isfinite(wanted));
    CHECK(std::isnan(value) == std::isnan(wanted));
    if (std::isfinite(wanted)) CHECK(value == Approx(wanted).epsilon(1e-6));
    CHECK(found->step == expected->step);
  }
  // What stopped the run keeps nobody from measuring what it has left.
  const auto& totals = dynamic_cast<const OffersTotals&>(device.simulation.backend());
  REQUIRE(totals.totals_of(0));
  CHECK(totals.totals_of(0)->mass == Approx(device.metrics.initial().mass / device.experiment.bodies.size()));
  return expected->failure;
}

/// A box in a domain of 60 x 4 cells of 1 m that moves as it was thrown, without stress.
std::string thrown(const std::string& shape, const std::string& transfer, const std::string& velocity,
                   const std::string& more = "") {
  return R"J({"title": "thrown", "dimension": 2,
    "grid": {"cell_size": 1, "domain": [[0, 0], [60, 4]], "boundaries": {"all": "free"})J" +
         more + R"J(},
    "shape": {"type": ")J" +
         shape + R"J("}, "transfer": {"type": ")J" + transfer + R"J("},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [1, 1], "upper": [3, 3]},
                "velocity": )J" +
         velocity + R"J(}], "solver": {"time_step": 0.01, "end_time": 10}, "output": {"ledger": false}})J";
}

}  // namespace

TEST_CASE("every backend names the axis and the place at which a particle leaves the domain", "[device][failure]") {
  const Failure below = common_failure(thrown("bspline_quadratic", "pic", R"J(["1", "-30"])J"));
  CHECK(below.cause == Cause::left_domain);
  CHECK(below.axis == 1);
  CHECK(below.value < 0);
  // By a corner: the first axis counts.
  const Failure corner = common_failure(thrown("bspline_quadratic", "pic", R"J(["-200", "-200"])J"));
  CHECK(corner.cause == Cause::left_domain);
  CHECK(corner.axis == 0);
  // The upper end of a domain is where cells of this size end.
  const Failure above = common_failure(thrown("bspline_quadratic", "pic", R"J(["1", "30"])J"), {"/grid/cell_size=0.5"});
  CHECK(above.cause == Cause::left_domain);
  CHECK(above.axis == 1);
  CHECK(above.value > 4);
}

TEST_CASE("every backend measures the way out from the domain's corner and from half a cell beyond separating walls",
          "[device][failure]") {
  const auto axis_of = [](const std::string& velocity, const std::vector<std::string>& overrides) {
    const Failure failure = common_failure(thrown("bspline_quadratic", "pic", velocity), overrides);
    CHECK(failure.cause == Cause::left_domain);
    return failure.axis;
  };
  CHECK(axis_of(R"J(["0", "-30"])J", {"/grid/domain=[[50, 7], [54, 67]]", "/bodies/0/geometry/lower=[51, 8]",
                                      "/bodies/0/geometry/upper=[53, 10]"}) == 1);
  // 0.3 cells beyond a separating wall are no way out, below a free one are.
  const std::string right = "/bodies/0/geometry/lower=[58.5, 1]", end = "/bodies/0/geometry/upper=[59, 3]";
  CHECK(axis_of(R"J(["-160", "-200"])J", {R"(/grid/boundaries/x_min="separate")"}) == 1);
  CHECK(axis_of(R"J(["160", "-200"])J", {R"(/grid/boundaries/x_max="separate")", right, end}) == 1);
  CHECK(axis_of(R"J(["-160", "-200"])J", {R"(/grid/boundaries/x_max="separate")"}) == 0);
  // The half is one of a cell, whatever its size: 0.3 m are a way out here, though a wall beside is nearer.
  CHECK(axis_of(R"J(["-145", "0"])J", {R"(/grid/boundaries/x_min="separate")", "/grid/cell_size=0.5",
                                       "/bodies/0/geometry/lower=[1, 0]", "/bodies/0/geometry/upper=[3, 1]"}) == 0);
}

TEST_CASE("every backend names the second body where its particle is the first that cannot go on",
          "[device][failure]") {
  const std::string both = R"J(/bodies=[{"name": "a", "material": "m", "velocity": ["0.1", "0"],
      "geometry": {"type": "box", "lower": [20, 1], "upper": [22, 3]}},
    {"name": "b", "material": "m", "geometry": {"type": "box", "lower": [1, 1], "upper": [3, 3]}, "velocity": )J";
  for (const auto& [transfer, velocity, cause] : {std::tuple{"pic", R"J(["-30", "0"])J", Cause::left_domain},
                                                  {"flip", R"J(["-30", "0"])J", Cause::left_domain},
                                                  {"apic", R"J(["-150*(x-2)", "0"])J", Cause::inverted}}) {
    INFO(transfer << " " << velocity);
    const Failure failure = common_failure(thrown("bspline_quadratic", transfer, "[0, 0]"), {both + velocity + "}]"});
    CHECK(failure.cause == cause);
    CHECK(failure.body == 1);
  }
}

TEST_CASE("every backend names what is not a number", "[device][failure]") {
  const std::string text = thrown("bspline_quadratic", "pic", R"J(["1", "1"])J");
  const Failure failure = common_failure(text, {R"J(/body_force=["sqrt(0.035-t)", "0"])J"});
  CHECK(std::string(name_of(failure.cause)) == "not a number");
}

TEST_CASE("every backend names the load that is no number, and the first particle of the experiment's order",
          "[device][failure]") {
  const std::string text = thrown("bspline_quadratic", "pic", R"J(["1", "1"])J");
  const std::string of_body = R"J({"type": "body_force", "body": "b", "acceleration": ["0.1", "log(3.04 - x)"]})J";
  const std::string edge = R"J("where": {"type": "half_space", "point": [2.5, 0], "normal": [-1, 0]})J";
  const Failure pulled = common_failure(text, {"/loads=[" + of_body + "]"});
  CHECK(pulled.cause == Cause::force_not_a_number);
  CHECK(pulled.particle > 0);
  CHECK(pulled.formula.find(": /loads/0/acceleration/1: is not a finite number") != std::string::npos);
  // With a force of all bodies, which is good, and one on the surface, which is not.
  const std::string pressed = R"J({"type": "pressure", "body": "b", )J" + edge + R"J(, "pressure": "1e-9/(Y - Y)"})J";
  const Failure both =
      common_failure(text, {R"J(/body_force=["X", "t"])J", "/loads=[" + of_body + ", " + pressed + "]"});
  CHECK(both.formula.find(": /loads/1/pressure: is not a finite number at t = 0 s") != std::string::npos);
  // Both are none in the same step: the particle of the lower index is named, whichever load it has.
  for (const auto& [begin, end, first] :
       {std::tuple{"1.3", "1.7", "/loads/0/acceleration/1"}, std::tuple{"2.3", "1.7", "/loads/1/pressure"}}) {
    const std::string pull =
        std::string(R"J({"type": "body_force", "body": "b", "acceleration": ["0.1", "sqrt(if(x > )J") + begin +
        R"J(, 0.035-t, 1))"]})J";
    const std::string press = R"J({"type": "pressure", "body": "b", )J" + edge +
                              R"J(, "pressure": "1e-9*sqrt(if(X > )J" + end + R"J(, 0.035-t, 1))"})J";
    INFO(begin << " " << end);
    const Failure at_once = common_failure(text, {"/loads=[" + pull + ", " + press + "]"});
    CHECK(at_once.formula.find(first) != std::string::npos);
  }
}

TEST_CASE("every backend names the grip whose velocity is no number, and where its first such particle is",
          "[device][failure]") {
  const std::string text = thrown("bspline_quadratic", "pic", R"J(["1", "1"])J");
  const auto words_of = [](auto& scene) -> std::string {
    try {
      while (!scene.simulation.finished()) scene.simulation.step();
    } catch (const ImposedValueFailure& stopped) {
      return std::to_string(scene.simulation.steps()) + " " + stopped.what();
    }
    return "";
  };
  // By the time at the end of a step, and by the place of a particle that has come there.
  for (const std::string velocity : {R"J([null, "sqrt(0.035-t)"])J", R"J([null, "log(3.045-x)"])J"}) {
    INFO(velocity);
    const std::string grips = "/grips=[{\"body\": \"b\", \"velocity\": " + velocity +
                              R"J(, "where": {"type": "half_space", "point": [1.9, 0], "normal": [-1, 0]}}])J";
    Scene reference(text, {grips, "/backend=reference", "/precision=double"});
    const std::string expected = words_of(reference);
    CHECK(expected.find("/grips/0/velocity/1: is not a finite number at t = ") != std::string::npos);
    CHECK(expected.substr(0, 2) == (velocity.find("sqrt") != velocity.npos ? "3 " : "30"));
    DeviceScene device(text, "double", {}, {grips});
    CHECK(words_of(device) == expected);
    DeviceScene in_float(text, "float", {}, {grips});
    CHECK(words_of(in_float).substr(0, 2) == expected.substr(0, 2));
  }
}

TEST_CASE("a device in float names the grip that is told more than its range holds, with axis and place",
          "[device][failure]") {
  for (const int dimension : {2, 3}) {
    Mix mix;
    mix.dimension = dimension;
    const std::string last =
        dimension == 2 ? R"J(["1", "if(t > 0.03, 1e39, 1)"])J" : R"J([null, "1", "if(t > 0.03, 1e39, 1)"])J";
    mix.more = R"(, "grips": [{"body": "a", "velocity": )" + last + R"(, "where": {"type": "half_space", "point": )" +
               (dimension == 2 ? "[0.25, 0], \"normal\": [1, 0]}}]" : "[0.25, 0, 0], \"normal\": [1, 0, 0]}}]");
    DeviceScene scene(mix.text(), "float");
    std::string words;
    try {
      scene.run();
    } catch (const ImposedValueFailure& stopped) {
      words = stopped.what();
      CHECK(stopped.imposed.name == (dimension == 2 ? "velocity along y" : "velocity along z"));
      CHECK(std::isinf(stopped.imposed.value));
    }
    INFO(words);
    CHECK_THAT(words, ContainsSubstring("/grips/0/velocity/" + std::to_string(dimension - 1) +
                                        ": is not a finite number at t = 0.036 s, ("));
    CHECK(std::count(words.begin() + static_cast<long>(words.find('(')), words.end(), ',') == dimension - 1);
    CHECK(words.ends_with(") m"));
  }
}

TEST_CASE("every backend in float names the load that is more than its range holds, and its axis",
          "[device][failure]") {
  const std::string edge = R"J("where": {"type": "half_space", "point": [0.31, 0], "normal": [1, 0]}, )J";
  const std::string large = R"J("if(t > 0.03, 1e39, x)")J";
  for (const auto& [load, wanted] :
       {std::pair(R"J("type": "force", "at": [0.31, 0.43], "force": [1, "if(t > 0.03, -1e39, 1)"])J"s, "force/1"s),
        std::pair(R"("type": "traction", )" + edge + "\"traction\": [" + large + ", 2]", "traction/0"s),
        std::pair(R"("type": "pressure", )" + edge + "\"pressure\": " + large, "pressure"s),
        std::pair(R"("type": "body_force", "acceleration": [1, )" + large + "]", "acceleration/1"s)}) {
    INFO(load);
    Mix mix;
    // A force on everything comes first, and is good.
    mix.more = R"(, "body_force": ["x", "y"], "loads": [{"body": "a", )" + load + "}]";
    DeviceScene device(mix.text(), "float");
    Scene cpu(mix.text(), {"/backend=cpu", "/precision=float"});
    const std::optional<Stop> found = stop_of(device), other = stop_of(cpu);
    REQUIRE(found);
    REQUIRE(other);
    CHECK(found->step == other->step);
    CHECK_THAT(found->failure.formula, ContainsSubstring("/loads/0/" + wanted + ": is not a finite number at t = 0.0"));
    CHECK(std::isinf(found->failure.value));
    CHECK(std::signbit(found->failure.value) == (wanted == "force/1"));
    CHECK(other->failure.formula == found->failure.formula);
    CHECK(other->failure.particle == found->failure.particle);
    CHECK(other->text == found->text);
  }
}

TEST_CASE("a device names the load that is no number in float alone, and the particle", "[device][failure]") {
  // The difference loses what float cannot hold of x, and leaves a number above zero in double precision alone.
  const std::string root =
      R"J(, "loads": [{"type": "spring", "body": "a", "where": {"type": "half_space", "point": [0.31, 0],
    "normal": [1, 0]}, "stiffness": [1, 1]}, {"type": "pressure", "body": "a", "where": {"type": "half_space",
    "point": [0.31, 0], "normal": [1, 0]}, "pressure": "sqrt((y+1e4)-1e4-y+1e-6)"}])J";
  Mix mix;
  mix.more = root;
  // The traction before it, on the same particles, is good.
  mix.more.insert(mix.more.find("[{") + 1, R"J({"type": "traction", "body": "a", "where": {"type": "half_space",
    "point": [0.31, 0], "normal": [1, 0]}, "traction": ["1+x", "y"]}, )J");
  DeviceScene in_double(mix.text(), "double"), in_float(mix.text(), "float");
  CHECK_FALSE(stop_of(in_double));
  const std::optional<Stop> found = stop_of(in_float);
  REQUIRE(found);
  CHECK(found->step == 0);
  CHECK_THAT(found->failure.formula, ContainsSubstring("/loads/2/pressure: is not a finite number at t = 0 s"));
  CHECK(std::isnan(found->failure.value));
  const double y = in_float.simulation.backend().body_state(0).position[2 * found->failure.particle + 1];
  CHECK(y > 0.2);
}

TEST_CASE("every backend names the axis along which a step goes beyond all numbers", "[device][failure]") {
  // 2^1023 m/s for 4 s. All weights and sums are powers of two and their sums, so that no velocity has a gradient.
  for (const int axis : {0, 1}) {
    const std::string velocity = axis == 0 ? R"J(["2^1023", "1"])J" : R"J(["1", "2^1023"])J";
    const Failure failure = common_failure(thrown("bspline_quadratic", "pic", velocity), {"/solver/time_step=4"});
    CHECK(failure.cause == Cause::position_not_a_number);
    CHECK(failure.axis == axis);
    CHECK(std::isinf(failure.value));
  }
}

TEST_CASE("every backend names a temperature that is not a number", "[device][failure]") {
  const std::string text = thrown("bspline_quadratic", "pic", R"J(["1", "1"])J");
  for (const std::string temperature : {"20+sqrt(9.6-x)", "20+10^(500*(x-9))"}) {  // the second one is infinite
    const Failure failure =
        common_failure(text, {R"(/materials/m/thermal={"conductivity": 1e-3, "heat_capacity": 1})",
                              "/bodies/0/geometry/upper=[12, 3]", "/bodies/0/temperature=\"" + temperature + "\""});
    CHECK(failure.cause == Cause::temperature_not_a_number);
    CHECK(failure.particle > 0);
    CHECK(!std::isfinite(failure.value));
  }
  // Heat that brings the largest numbers beyond all numbers.
  const Failure infinite = common_failure(
      text, {R"(/materials/m/thermal={"conductivity": 1e-3, "heat_capacity": 1e-9})", "/bodies/0/temperature=1.7e308",
             R"(/node_conditions=[{"type": "thermal", "heating": 1e301, "lower": [0, 0], "upper": [4, 4]}])"});
  CHECK(infinite.cause == Cause::temperature_not_a_number);
  CHECK(infinite.axis == -1);
  CHECK(std::isinf(infinite.value));
}

TEST_CASE("every backend names an inverted particle with its volume ratio", "[device][failure]") {
  const Failure failure = common_failure(thrown("bspline_quadratic", "apic", R"J(["-150*(x-2)", "0"])J"));
  CHECK(failure.cause == Cause::inverted);
  CHECK(failure.value <= 0);
}

TEST_CASE("every backend names a particle that reaches the axis", "[device][failure]") {
  // A particle that moves with the grid is crushed before; one that moves with its own velocity is not.
  const Failure failure =
      common_failure(thrown("bspline_quadratic", "asflip", R"J(["-90", "0"])J", R"(, "symmetry": "axisymmetric")"),
                     {R"(/transfer={"type": "asflip", "beta_max": 1, "threshold": -1})",
                      R"(/grid/boundaries={"all": "free", "x_min": "slip"})"});
  CHECK(failure.cause == Cause::reached_axis);
  CHECK(failure.axis == 0);
  CHECK(failure.value <= 0);
}

TEST_CASE("every backend lets a particle with corners leave the domain", "[device][failure]") {
  const Failure failure = common_failure(thrown("cpdi2", "pic", R"J(["1", "-30"])J"));
  CHECK(failure.cause == Cause::left_domain);
  CHECK(failure.axis == 1);
}

TEST_CASE("a state of the device that is read before a particle cannot go on changes nothing", "[device][failure]") {
  const std::string text = thrown("gimp_contiguous", "tpic", R"J(["2*x", "0"])J");
  DeviceScene scene(text, "double"), read(text, "double");
  const std::optional<Stop> expected = stop_of(scene);
  REQUIRE(expected);
  std::vector<double> moments;
  std::optional<Stop> found;
  try {
    for (;;) {
      read.simulation.step();
      moments = read.simulation.backend().body_state(0).second_moment;
    }
  } catch (const RunFailure& stopped) {
    found = Stop{stopped.failure, cause_text(stopped.failure, read.experiment), read.simulation.steps()};
  }
  CHECK(found->text == expected->text);
  CHECK(found->failure.particle == expected->failure.particle);
  CHECK(found->step == expected->step);
  // The domain that has outgrown its stencil has no second moment any more.
  REQUIRE(moments.size() % 4 == 0);
  CHECK(std::isnan(moments[4 * expected->failure.particle]));
}

TEST_CASE("every backend names a domain that is too long, inside out or too far", "[device][failure]") {
  CHECK(common_failure(thrown("gimp_contiguous", "tpic", R"J(["2*x", "0"])J")).cause == Cause::domain_outgrew_stencil);
  // A shear of 80 in one step: the lower row stays, its domains reach 20 cells to either side.
  CHECK(common_failure(thrown("cpdi", "tpic", R"J(["80*(y-1.25)", "0"])J"),
                       {"/solver/time_step=1", "/bodies/0/geometry/upper=[2, 2]"})
            .cause == Cause::domain_beyond_grid);
  // Domains of a whole cell and steps of a cell: corners pass one another before any particle's own J does.
  CHECK(common_failure(thrown("cpdi2", "apic", R"J(["30*sin(1.5*y)*0.1*x", "20*sin(1.5*x)"])J"),
                       {"/bodies/0/particles_per_cell_axis=1", "/grid/domain=[[0, 0], [20, 20]]",
                        "/bodies/0/geometry/lower=[7, 7.5]", "/bodies/0/geometry/upper=[12, 12.5]"})
            .cause == Cause::domain_inside_out);
}

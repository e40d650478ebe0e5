// Limits: which numbers of a summary break them, and which scenes are not judged.
#include "run/limits.hpp"

#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::app;
using namespace mpm::test;
using Json = nlohmann::ordered_json;
using Flags = std::vector<std::string>;

namespace {

/// A disc that falls nowhere, with more keys.
Experiment scene(const std::string& keys = "", const std::string& boundaries = R"({"all": "slip"})") {
  return experiment_from(R"J({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]], "boundaries": )J" +
                         boundaries + R"J(},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "ball", "centre": [0.5, 0.5], "radius": 0.2}}],
    "solver": {"end_time": 1})J" +
                         keys + "}");
}

Json summary(double gain, double smallest, double largest) {
  return {{"energy", {{"total", {{"gain", gain}}}}},
          {"stability", {{"smallest_volume_ratio", smallest}, {"largest_volume_ratio", largest}}}};
}

Flags flags(const Experiment& experiment, Json numbers) {
  const Flags found = judge_limits(experiment, numbers);
  CHECK(numbers["flags"].get<Flags>() == found);
  REQUIRE(numbers["limits"].size() == 5);
  return found;
}

}  // namespace

TEST_CASE("energy gained and volume ratios out of range are flagged by name", "[limits]") {
  const Experiment standard = scene();
  CHECK(flags(standard, summary(0.01, 0.1, 10)).empty());
  CHECK(flags(standard, summary(0.0321, 0.3, 4)) == Flags{"energy gain of 3.21 % (limit 1 %)"});
  CHECK(flags(standard, summary(0, 0.099, 10.1)) ==
        Flags{"smallest volume ratio J 0.099 (limit 0.1)", "largest volume ratio J 10.1 (limit 10)"});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(flags(standard, summary(nan, nan, nan)).size() == 3);
  const Experiment wider = scene(R"(, "limits": {"energy_gain": 0.05, "volume_ratio": [0.01, 1.5]})");
  CHECK(flags(wider, summary(0.04, 0.02, 1.4)).empty());
  CHECK(flags(wider, summary(0.06, 0.02, 1.6)).size() == 2);
  CHECK(flags(scene(R"(, "limits": {"energy_gain": null, "volume_ratio": null})"), summary(9, 1e-9, 1e9)).empty());
}

TEST_CASE("the summary holds each limit with its verdict, or why there is none", "[limits]") {
  Json numbers = summary(0.02, 0.5, 2);
  judge_limits(scene(R"(, "limits": {"volume_ratio": null})"), numbers);
  CHECK(numbers["limits"] == Json::parse(R"([
    {"metric": "energy.total.gain", "at_most": 0.01, "value": 0.02, "held": false},
    {"metric": "stability.smallest_volume_ratio", "value": 0.5, "not_judged": "no limit is asked for"},
    {"metric": "stability.largest_volume_ratio", "value": 2.0, "not_judged": "no limit is asked for"},
    {"metric": "energy.total.numerical_loss", "value": null, "not_judged": "no limit is asked for"},
    {"metric": "energy.total.unexplained_loss", "value": null, "not_judged": "no limit is asked for"}])"));
  numbers["energy"]["total"].erase("gain");
  CHECK(judge_limits(scene(), numbers).empty());
  CHECK(numbers["limits"][0]["value"].is_null());
  CHECK(numbers["limits"][0]["not_judged"] == "not recorded: the scene begins without energy");
}

TEST_CASE("a gain is not judged where work is done from outside, unless the file says otherwise", "[limits]") {
  CHECK(work_from_outside(scene()).empty());
  const std::string force = R"J(, "body_force": ["sin(t)", 0])J", gravity = R"(, "gravity": [0, -10])";
  CHECK(work_from_outside(scene(force)) == "/body_force works on the scene");
  CHECK(work_from_outside(scene(R"(, "loads": [{"type": "force", "body": "b", "at": [0.5, 0.5], "force": [1, 0]}])")) ==
        "/loads/0 works on the scene");
  CHECK(work_from_outside(scene(gravity)).empty());
  CHECK(work_from_outside(scene(gravity, R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})")).empty());
  CHECK(work_from_outside(scene(gravity, R"({"all": "slip", "y_min": "periodic", "y_max": "periodic"})")) ==
        "/gravity works on the scene: it points along a periodic direction");
  CHECK(work_from_outside(scene("", R"({"all": "slip", "y_max": {"type": "prescribed", "velocity": [1, 0]}})")) ==
        "/grid/boundaries/y_max works on the scene: the wall moves");
  CHECK(work_from_outside(scene(R"(, "node_conditions": [{"type": "stick", "lower": [0, 0], "upper": [1, 0.1]}])"))
            .empty());
  CHECK(work_from_outside(scene(R"(, "node_conditions": [
    {"type": "prescribed", "lower": [0, 0], "upper": [1, 0.1], "velocity": [1, null]}])")) ==
        "/node_conditions/0 works on the scene: its nodes are moved");

  CHECK(flags(scene(force), summary(5, 1, 1)).empty());
  CHECK(flags(scene(force + R"(, "limits": {"isolated": true})"), summary(5, 1, 1)).size() == 1);
  CHECK(flags(scene(R"(, "limits": {"isolated": false})"), summary(5, 1, 1)).empty());
}

TEST_CASE("losses without a physical cause are flagged where the file sets a limit", "[limits]") {
  const auto losing = [](double numerical, double unexplained) {
    Json numbers = summary(0, 1, 1);
    numbers["energy"]["total"]["numerical_loss"] = numerical;
    numbers["energy"]["total"]["unexplained_loss"] = unexplained;
    return numbers;
  };
  CHECK(flags(scene(), losing(0.98, 0.5)).empty());  // a warning, no flag
  const std::string limited = R"(, "limits": {"numerical_loss": 0.1, "unexplained_loss": 0.02})";
  CHECK(flags(scene(limited), losing(0.1, 0.02)).empty());
  CHECK(flags(scene(limited), losing(0.98, 0.021)) == Flags{"numerical loss of 98 % of the energy (limit 10 %)",
                                                            "unexplained loss of 2.1 % of the energy (limit 2 %)"});
  CHECK(flags(scene(limited), losing(std::numeric_limits<double>::quiet_NaN(), 0)).size() == 1);
  // Gravity has a potential; a force from the file does work, and what is lost of it nobody knows.
  CHECK(flags(scene(limited + R"J(, "body_force": ["sin(t)", 0])J"), losing(0.98, 0.5)).empty());
  CHECK(flags(scene(limited + R"(, "output": {"ledger": false})"), losing(0.98, 0.5)).empty());
}

TEST_CASE("the numerical gain is the sum of rows without a physical cause", "[limits]") {
  Ledger ledger;
  double sum = 0, value = 1;
  for (double Ledger::*row :
       {&Ledger::scatter, &Ledger::gather, &Ledger::boundary, &Ledger::contact, &Ledger::friction, &Ledger::filter,
        &Ledger::filtered_strain, &Ledger::filtered_gravity, &Ledger::remapped_strain, &Ledger::second_moment})
    ledger.*row = value, sum += value, value *= 2;
  for (double Ledger::*row :
       {&Ledger::material, &Ledger::body_force, &Ledger::gravity_without_potential, &Ledger::internal_force,
        &Ledger::stress_power, &Ledger::stored, &Ledger::friction_taken_back})
    ledger.*row = 1e6;
  CHECK(numerical_gain(ledger) == sum);
}

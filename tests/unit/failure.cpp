// Why a run stopped, in words: every cause has its own, and each a remedy.
#include "simulation/failure.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "run/summary.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;
using Json = nlohmann::ordered_json;

namespace {

/// A disc of a shape of this name.
Experiment with_shape(const std::string& shape) {
  return experiment_from(
      R"J({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[-1, 0], [1.6, 1]], "boundaries": {"all": "free"}},
    "shape": {"type": ")J" +
      shape + R"J("}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "disc", "material": "m", "geometry": {"type": "ball", "centre": [0.5, 0.5], "radius": 0.2}}],
    "solver": {"end_time": 1}})J");
}

/// What each cause is called, what it says of these failures, and what helps.
struct Said {
  Failure failure;
  std::string shape, name, text, remedy;
  std::vector<std::string> values;
};
const std::vector<Said> all_said{
    {{Cause::too_many_particles, 0, 0, -1, 200},
     "linear",
     "too many particles",
     "too many particles: body \"disc\" may have 200, as its emitter says",
     "a larger max_particles of the emitter",
     {"max_particles = 200"}},
    {{Cause::no_particle_left},
     "linear",
     "no particle is left",
     "no particle is left: sinks have taken all of the scene",
     "a /solver/end_time before the sinks have taken everything",
     {}},
    {{Cause::domain_outgrew_stencil, 0, 4},
     "gimp_contiguous",
     "its domain has grown too long",
     "its domain has grown too long for the 4 nodes an axis of shape \"gimp_contiguous\"",
     "/shape/type \"cpdi\"",
     {"nodes an axis = 4"}},
    {{Cause::domain_inside_out, 0, 4},
     "cpdi2",
     "its domain is turned inside out",
     "its domain is turned inside out: the corners that shape \"cpdi2\" moves with the grid have passed one another",
     "/shape/type \"cpdi\"",
     {}},
    {{Cause::domain_beyond_grid, 0, 4},
     "cpdi",
     "its domain reaches too far",
     "its domain reaches more than 8 cells beyond the domain's edge",
     "a larger /grid/domain, more particles a cell",
     {"longest reach (cells) = 8"}},
    {{Cause::force_not_a_number, 0, 4, 1, INFINITY, "scene.json:5:18: /body_force/1: is not a finite number at t = 2 s",
      "body force along y", "N/kg"},
     "linear",
     "not a number",
     "not a number: scene.json:5:18: /body_force/1: is not a finite number at t = 2 s",
     "check that expression",
     {"body force along y (N/kg) = inf"}},
    {{Cause::temperature_not_a_number, 0, 4, -1, INFINITY},
     "linear",
     "not a number",
     "not a number: its temperature is no longer finite",
     "check the expressions that warm or cool",
     {"temperature (K) = inf"}},
    {{Cause::deformation_not_a_number, 0, 4},
     "linear",
     "not a number",
     "not a number: its deformation is no longer finite",
     "check the expressions of the file",
     {}},
    {{Cause::inverted, 0, 4, -1, -0.5},
     "bspline_quadratic",
     "inverted",
     "inverted: its volume ratio J is not positive",
     "a transfer with more damping",
     {"volume ratio = -0.5"}},
    {{Cause::inverted, 0, 4, -1, -0.5},
     "linear",
     "inverted",
     "inverted: its volume ratio J is not positive",
     "smaller steps do not help",
     {"volume ratio = -0.5"}},
    {{Cause::position_not_a_number, 0, 4, 1, NAN},
     "linear",
     "not a number",
     "not a number: its position is no longer finite",
     "check the expressions of the file",
     {"y (m) = nan"}},
    {{Cause::reached_axis, 0, 4, 0, -0.25},
     "linear",
     "reached the axis r = 0",
     "reached the axis r = 0, where its ring has no circumference",
     "move with the velocity of the grid",
     {"r (m) = -0.25"}},
    {{Cause::left_domain, 0, 4, 0, 1.75},
     "linear",
     "left the domain",
     "left the domain at x = 1.75 m",
     "a larger /grid/domain, or a wall that holds the material",
     {"x (m) = 1.75", "lower end (m) = -1", "upper end (m) = 1.6"}},
    {{Cause::speed_not_a_number, 0, 4, -1, INFINITY},
     "linear",
     "not a number",
     "not a number: its wave or particle speed gives no time step",
     "check the expressions of the file",
     {"speed (m/s) = inf"}}};

std::vector<std::string> texts(const std::vector<ValueRow>& rows) {
  std::vector<std::string> all;
  for (const ValueRow& row : rows) {
    char value[32];
    std::snprintf(value, sizeof value, "%g", row.value);
    all.push_back(heading(row) + " = " + value);
  }
  return all;
}

}  // namespace

TEST_CASE("every cause of a failure has its words, its numbers and a remedy", "[failure]") {
  std::set<Cause> said;
  for (const Said& one : all_said) {
    INFO(one.text);
    const Experiment experiment = with_shape(one.shape);
    CHECK(name_of(one.failure.cause) == one.name);
    CHECK(cause_text(one.failure, experiment) == one.text);
    CHECK(remedy_for(one.failure, experiment).find(one.remedy) != std::string::npos);
    CHECK(texts(values_of(one.failure, experiment)) == one.values);
    CHECK(std::string(RunFailure(one.failure).what()) == one.name);
    said.insert(one.failure.cause);
  }
  CHECK(said.size() == all_causes().size());
}

TEST_CASE("a failure's place is told with step, time, particle, body and position", "[failure]") {
  const Failure failure{Cause::left_domain, 0, 12, 0, 1.75};
  const FailurePlace place{3, 0.025, {1.75, NAN}};
  const Experiment experiment = with_shape("linear");
  CHECK(place_text(failure, place, experiment) == "step 3, t = 0.025 s: particle 12 of body \"disc\" at (1.75, nan) m");
}

TEST_CASE("a failure's record has cause, where, values and remedy", "[failure]") {
  const Failure failure{Cause::left_domain, 0, 12, 0, 1.75};
  const Json record = app::record_of(failure, {3, 0.025, {1.75, 0.5}}, with_shape("linear"));
  CHECK(record["cause"] == "left the domain");
  CHECK(record["where"] == Json::parse(R"({"step": 3, "time": 0.025, "body": "disc", "particle": 12,
                                           "position": [1.75, 0.5]})"));
  CHECK(record["values"] == Json::parse(R"([{"name": "x", "unit": "m", "value": 1.75},
                                            {"name": "lower end", "unit": "m", "value": -1.0},
                                            {"name": "upper end", "unit": "m", "value": 1.6}])"));
  CHECK(record["remedy"] == remedy_for(failure, with_shape("linear")));
  CHECK(record.size() == 4);
}

TEST_CASE("of several failures of a pass domains come first, then temperatures, deformations and positions",
          "[failure]") {
  // Each comes before the next; of one kind the lowest body, then the lowest particle, then the lowest axis.
  const std::vector<Failure> order{{Cause::domain_beyond_grid, 0, 7},       {Cause::domain_outgrew_stencil, 1, 2},
                                   {Cause::temperature_not_a_number, 1, 3}, {Cause::inverted, 0, 3},
                                   {Cause::deformation_not_a_number, 1, 0}, {Cause::inverted, 1, 1},
                                   {Cause::left_domain, 0, 0, 0},           {Cause::position_not_a_number, 0, 0, 1},
                                   {Cause::reached_axis, 0, 1, 0},          {Cause::speed_not_a_number, 0, 0}};
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = 0; j < order.size(); ++j) {
      INFO(i << " and " << j);
      CHECK(comes_before(order[i], order[j]) == (i < j));
    }
  FirstFailure first;
  CHECK(!first.any());
  first.raise();
  for (const std::size_t k : {6, 4, 3, 7, 5}) first.note(order[k]);
  CHECK(first.any());
  try {
    first.raise();
    FAIL("nothing was thrown");
  } catch (const RunFailure& stopped) {
    CHECK(stopped.failure.cause == Cause::inverted);
    CHECK(stopped.failure.body == 0);
    CHECK(stopped.failure.particle == 3);
  }
  CHECK(!first.any());
}

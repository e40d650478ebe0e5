// Studies without runs: reading, combinations, bisection, Pareto fronts, orders, advice, flags, what study.json keeps.

#include <cmath>

#include "experiment/diagnostics.hpp"
#include "study/analysis.hpp"
#include "study/bisection.hpp"
#include "study/figures.hpp"
#include "study/results.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::study;

namespace {

const char* small = R"J({
  // a comment
  "title": "Small", "base": "scene.json", "set": {"/output/frames": 0},
  "axes": {
    "/transfer/type": ["pic", "flip"],
    "/filter": {"values": [null, {"type": "fmpm", "order": 4}], "labels": ["none", "FMPM(4)"]},
    "grid": {"label": "cell size h", "unit": "m", "values": [
      {"label": "coarse", "value": 0.1, "set": {"/grid/cell_size": 0.1, "/solver/time_step": 1e-3}},
      {"label": "fine", "value": 0.05, "set": {"/grid/cell_size": 0.05, "/solver/time_step": "auto"}}]}
  },
  "measure": {"e": {"value": "/error/position/rms", "formula": "x/2", "unit": "m"}},
  "error": "e", "figures": [{"type": "convergence", "x": "grid"}, "pareto"]
})J";

std::string mistakes(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read_study_text(text, "s.json", overrides);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  REQUIRE(text.find(from) != std::string::npos);
  return text.replace(text.find(from), from.size(), to);
}

void check_mistake(const std::string& from, const std::string& to, const std::string& message) {
  const std::string all = mistakes(changed(small, from, to));
  INFO(all);
  INFO("expected: " << message);
  CHECK(all.find(message) != std::string::npos);
}

/// Results as if every run had finished with these errors and costs.
Results measured(const std::vector<std::pair<double, double>>& cost_and_error) {
  Results results;
  results.study = read_study_text(small, "s.json");
  const auto combinations = expand(results.study);
  REQUIRE(combinations.size() == cost_and_error.size());
  for (std::size_t k = 0; k < combinations.size(); ++k) {
    Result result;
    result.combination = combinations[k];
    result.outcome.status = Status::done;
    result.folder = "runs/" + combinations[k].name;
    result.measures = {{"seconds", cost_and_error[k].first}, {"e", cost_and_error[k].second}};
    results.results.push_back(result);
  }
  return results;
}

}  // namespace

TEST_CASE("a study is read with its axes, measures and figures", "[study]") {
  const Study study = read_study_text(small, "folder/s.json");
  CHECK(study.base == "folder/scene.json");
  REQUIRE(study.axes.size() == 3);
  CHECK(study.axes[0].name == "/transfer/type");
  CHECK(study.axes[0].label == "transfer");
  CHECK(study.axes[1].choices[0].overrides == std::vector<std::string>{"/filter=null"});
  CHECK(study.axes[1].choices[1].overrides == std::vector<std::string>{R"(/filter={"type":"fmpm","order":4})"});
  CHECK(study.axes[1].choices[1].label == "FMPM(4)");
  CHECK(study.axes[2].title() == "cell size h (m)");
  CHECK(study.axes[2].is_numeric());
  CHECK(!study.axes[0].is_numeric());
  CHECK(study.axes[2].choices[1].number == 0.05);
  REQUIRE(study.measure("seconds"));
  CHECK(study.cost == "seconds");
  REQUIRE(study.figures.size() == 2);
  CHECK(study.figures[0].value == "e");
  CHECK(study.figures[1].costs == std::vector<std::string>{"seconds", "particle_steps", "flops"});
}

TEST_CASE("combinations: the first axis slowest, base settings before axes, readable unique names", "[study]") {
  const auto all = expand(read_study_text(small, "s.json"));
  REQUIRE(all.size() == 8);
  CHECK(all[0].name == "pic-none-coarse");
  CHECK(all[1].name == "pic-none-fine");
  CHECK(all[7].name == "flip-FMPM_4-fine");
  CHECK(all[7].overrides == std::vector<std::string>{"/output/frames=0", R"(/transfer/type="flip")",
                                                     R"(/filter={"type":"fmpm","order":4})", "/grid/cell_size=0.05",
                                                     R"(/solver/time_step="auto")"});
  const auto alike =
      expand(read_study_text(R"({"base": "b", "axes": {"/title": ["a b", "a/b", "..", "a_b"]}})", "s.json"));
  CHECK(alike[0].name == "a_b");
  CHECK(alike[1].name == "a_b.2");
  CHECK(alike[2].name == "value");
  CHECK(alike[3].name == "a_b.3");
}

TEST_CASE("values that are quantities have SI numbers; scaled ones keep their own", "[study]") {
  const Study study = read_study_text(R"({"base": "b", "axes": [
    {"pointer": "/grid/cell_size", "values": ["5 mm", 0.01]},
    {"pointer": "/solver/time_step", "name": "step", "scale": 0.5, "values": [1, 3]}]})",
                                      "s.json");
  CHECK(study.axes[0].choices[0].number == Approx(0.005));
  CHECK(study.axes[0].choices[0].overrides[0] == R"(/grid/cell_size="5 mm")");
  CHECK(study.axes[1].name == "step");
  CHECK(study.axes[1].choices[1].number == 3);
  CHECK(study.axes[1].choices[1].overrides[0] == "/solver/time_step=1.5");
}

TEST_CASE("mistakes in a study, with place and remedy", "[study]") {
  CHECK(mistakes(small).empty());
  check_mistake("\"title\"", "\"titel\"", "s.json:3:3: /titel: unknown key \"titel\"; did you mean \"title\"?");
  check_mistake("\"base\": \"scene.json\",", "", "/base: missing key");
  check_mistake("[\"pic\", \"flip\"]", "[]", "/axes/~1transfer~1type: the list of values is empty");
  check_mistake("[\"pic\", \"flip\"]", "[\"pic\", \"pic\"]", "a second value is called \"pic\"");
  check_mistake("\"/filter\"", "\"filter\"", "/axes/filter/labels: unknown key");
  check_mistake("\"FMPM(4)\"]", "\"FMPM(4)\", \"more\"]", "3 labels for 2 values");
  check_mistake("\"/filter\":", "\"/transfer\":", "sets /transfer, which overwrites /transfer/type of the axis");
  check_mistake("{\"/output/frames\": 0}", "{\"/filter\": null}", "/filter is overwritten by the axis \"/filter\"");
  check_mistake("\"x/2\"", "\"y/2\"", "/measure/e/formula");
  check_mistake("\"error\": \"e\"", "\"error\": \"ee\"", "no measure is called \"ee\"; did you mean \"e\"?");
  check_mistake("\"x\": \"grid\"", "\"x\": \"grd\"", "no axis is called \"grd\"; did you mean \"grid\"?");
  check_mistake("\"x\": \"grid\"", "\"x\": \"/filter\"", "have no numbers");
  check_mistake("\"pareto\"", "\"paretto\"", "unknown figure \"paretto\"; did you mean \"pareto\"?");
  check_mistake("\"error\": \"e\",", "", "shows the error: name it with \"error\"");
  check_mistake("\"error\": \"e\",", "\"error\": \"e\", \"limits\": {\"isolated\": false, \"energy_gain\": 0.1},",
                "and \"isolated\" is false");
  check_mistake("\"error\": \"e\",", "\"error\": \"e\", \"bisect\": {\"pointer\": \"/grid\", \"from\": 1, \"to\": 2},",
                "overwrites /grid/cell_size of the axis \"grid\"");
  check_mistake(
      "\"error\": \"e\",",
      "\"error\": \"e\", \"bisect\": {\"pointer\": \"/a\", \"from\": 1, \"to\": 0, \"stable_while\": [{\"value\": "
      "\"/b\"}]},",
      "demands nothing: give \"at_least\" or \"at_most\"");
  check_mistake("\"error\": \"e\",",
                "\"error\": \"e\", \"bisect\": {\"pointer\": \"/a/b\", \"from\": 1, \"to\": 2, \"set\": {\"/a\": 1}},",
                "/a is what is bisected");
  check_mistake(
      "\"error\": \"e\",",
      "\"error\": \"e\", \"bisect\": {\"pointer\": \"/a\", \"from\": 1, \"to\": 2, \"set\": {\"/filter\": null}},",
      "/filter is overwritten by the axis \"/filter\"");
  CHECK(mistakes(small, {"/grid/cell_size=1"}).find("--set: /grid/cell_size: /grid/cell_size is overwritten") == 0);
}

TEST_CASE("an exact curve of small multiples is a formula of x", "[study]") {
  const auto with = [](const std::string& keys) {
    return R"J({"base": "b", "axes": {"/a": [1, 2], "/b": [1, 2]}, "measure": {"e": "/e"}, "figures": [
      {"type": "small_multiples", "x": "/a", "panels": "/b", "value": "e")J" +
           keys + "}]}";
  };
  const Study study = read_study_text(with(R"J(, "exact": "2*x")J"), "s.json");
  CHECK(study.figures[0].exact == "2*x");
  CHECK(study.figures[0].exact_label == "2*x");
  CHECK(read_study_text(with(R"J(, "exact": "x", "exact_label": "ours")J"), "s.json").figures[0].exact_label == "ours");
  CHECK(mistakes(with(R"J(, "exact": "2*y")J")).find("/figures/0/exact") != std::string::npos);
  CHECK(mistakes(with(R"J(, "exact_label": "ours")J")).find("give \"exact\" too") != std::string::npos);
}

TEST_CASE("cells of a heat map may take the runs of an axis together", "[study]") {
  const auto with = [](const std::string& keys) {
    return R"J({"base": "b", "axes": {"/a": [1, 2], "/b": [1, 2], "/c": [1, 2]}, "measure": {"e": "/e"}, "figures": [
      {"type": "heat_map", "x": "/a", "y": "/b")J" +
           keys + "}]}";
  };
  const FigureRequest figure =
      read_study_text(with(R"J(, "over": "/c", "take": "bounded")J"), "s.json").figures.front();
  CHECK(figure.over == "/c");
  CHECK(figure.take == Take::bounded);
  CHECK(read_study_text(with(R"J(, "over": "/c", "value": "e")J"), "s.json").figures[0].take == Take::smallest);
  CHECK(mistakes(with(R"J(, "over": "/a", "value": "e")J")).find("columns or rows too") != std::string::npos);
  CHECK(mistakes(with(R"J(, "take": "largest", "value": "e")J")).find("with \"over\"") != std::string::npos);
  CHECK(mistakes(with(R"J(, "over": "/c")J")).find("shows the error") != std::string::npos);
}

TEST_CASE("bisection brackets the last stable value with few questions", "[study]") {
  BisectionSearch search(0.1, 10, 0.01);
  int questions = 0;
  while (const auto value = search.next()) {
    search.answer(*value <= 1.7);
    ++questions;
  }
  REQUIRE(search.stable());
  REQUIRE(search.unstable());
  CHECK(*search.stable() <= 1.7);
  CHECK(*search.unstable() > 1.7);
  CHECK(*search.unstable() - *search.stable() <= 0.01 * *search.stable());
  CHECK(questions == 2 + 9);  // log(100) / 2^9 < log(1.01)

  BisectionSearch downwards(1, 0.001, 0.1);  // finds the smallest cell: large is stable
  while (const auto value = downwards.next()) downwards.answer(*value >= 0.03);
  CHECK(*downwards.stable() >= 0.03);
  CHECK(*downwards.unstable() < 0.03);
  CHECK(*downwards.stable() < 0.034);

  BisectionSearch never(1, 2, 0.1);
  never.answer(false);
  CHECK(!never.next());
  CHECK(!never.stable());
  BisectionSearch always(1, 2, 0.1);
  always.answer(true);
  always.answer(true);
  CHECK(!always.next());
  CHECK(always.stable() == 2);
  CHECK(!always.unstable());
}

TEST_CASE("the Pareto front names what dominates each point", "[study]") {
  // The pairs are cost and error, in the order of the combinations.
  const Results results = measured({{1, 8}, {2, 4}, {2, 4}, {3, 5}, {4, 1}, {4, 2}, {5, 1}, {0.5, 9}});
  const auto points = pareto(results, {}, "seconds", "e");
  REQUIRE(points.size() == 8);
  std::vector<std::string> front;
  for (const ParetoPoint& point : points)
    if (!point.dominated_by) front.push_back(point.result->combination.name);
  CHECK(front == std::vector<std::string>{"flip-FMPM_4-fine", "pic-none-coarse", "pic-FMPM_4-coarse", "pic-none-fine",
                                          "flip-none-coarse"});
  for (const ParetoPoint& point : points) {
    if (point.result->combination.name == "pic-FMPM_4-fine")
      CHECK(point.dominated_by->combination.name == "pic-FMPM_4-coarse");
    if (point.result->combination.name == "flip-FMPM_4-coarse")
      CHECK(point.dominated_by->combination.name == "flip-none-coarse");
  }
}

TEST_CASE("advice: the cheapest that reaches an error, the most exact within a cost, never a flagged one", "[study]") {
  Results results = measured({{1, 8}, {2, 4}, {3, 4}, {3, 5}, {4, 1}, {6, 2}, {5, 1}, {0.5, 9}});
  CHECK(advise_for_error(results, "seconds", 4).good.front().result->combination.name == "pic-none-fine");
  CHECK(advise_for_error(results, "seconds", 4).good.size() == 5);
  CHECK(advise_for_error(results, "seconds", 0.5).good.empty());
  CHECK(advise_for_error(results, "seconds", 0.5).near.front().error == 1);
  CHECK(advise_within(results, "seconds", 3.5).good.front().result->combination.name == "pic-none-fine");
  CHECK(advise_within(results, "seconds", 0.1).good.empty());
  results.results[1].flags = {"energy gain of 2 % (limit 1 %)"};
  CHECK(advise_for_error(results, "seconds", 4).good.front().result->combination.name == "pic-FMPM_4-coarse");
  results.results[2].outcome.status = Status::expectation_failed;
  CHECK(advise_for_error(results, "seconds", 4).good.front().result->combination.name == "flip-none-coarse");
}

TEST_CASE("observed orders of each combination", "[study]") {
  // The pairs (coarse, fine) have second order, first order, none, and a growing error.
  Results results = measured({{1, 4}, {1, 1}, {1, 2}, {1, 1}, {1, 3}, {1, 3}, {1, 1}, {1, 2}});
  const auto orders = observed_orders(results, results.study.figures[0]);
  REQUIRE(orders.size() == 4);
  CHECK(orders[0].label == "pic, none");
  CHECK(orders[0].fitted == Approx(2));
  CHECK(orders[1].finest == Approx(1));
  CHECK(orders[2].fitted == Approx(0).margin(1e-12));
  CHECK(orders[3].fitted == Approx(-1));
  CHECK(orders[0].smallest_x == 0.05);
  results.results[0].measures.erase("e");
  CHECK(std::isnan(observed_orders(results, results.study.figures[0])[0].fitted));
}

TEST_CASE("limits of a study are those of every run, before what it sets and its axes", "[study]") {
  const auto with = [](const std::string& keys) {
    return R"J({"base": "b", "set": {"/limits/isolated": true}, "axes": {"/limits/volume_ratio": [[0.1, 2], [0.5, 2]]}, )J" +
           keys + "}";
  };
  const Study study = read_study_text(with(R"J("limits": {"energy_gain": 2})J"), "s.json");
  CHECK(study.overrides == std::vector<std::string>{R"(/limits={"energy_gain":2.0})", "/limits/isolated=true"});
  CHECK(read_study_text(with(R"J("limits": {"energy_gain": null, "volume_ratio": [0.1, 2]})J"), "s.json")
            .overrides.front() == R"(/limits={"energy_gain":null,"volume_ratio":[0.1,2.0]})");
  CHECK(mistakes(R"J({"base": "b", "axes": {"/limits": [null]}, "limits": {"energy_gain": 1}})J")
            .find("/limits is overwritten by the axis") != std::string::npos);
  CHECK(flags_in(Json{{"flags", {"a", "b"}}}) == std::vector<std::string>{"a", "b"});
  CHECK(flags_in(Json::object()).empty());
}

TEST_CASE("numbers of a summary by formula and against bounds", "[study]") {
  const Json json{{"error", {{"position", {{"rms", 0.25}}}}}};
  CHECK(evaluate({}, {"e", "/error/position/rms", "", "", "abs(1-2*x)"}, {}, json) == Approx(0.5));
  CHECK(std::isnan(evaluate({}, {"e", "/missing", "", "", "1"}, {}, json)));
  std::vector<std::string> broken;
  CHECK(all_hold({{"/error/position/rms", 0.2, 0.3}}, json, broken));
  CHECK(!all_hold({{"/error/position/rms", {}, 0.2}, {"/missing", 0.0, {}}}, json, broken));
  CHECK(broken ==
        std::vector<std::string>{"/error/position/rms is 0.25, above 0.2", "/missing is no number in summary.json"});
}

TEST_CASE("the formula of a measure names the numbers of the axes", "[study]") {
  const auto with = [](const std::string& formula) {
    return R"J({"base": "b", "axes": {
      "/constants/P": {"name": "load", "scale": 100, "values": [1, 2.5]},
      "/transfer/type": ["pic", "flip"],
      "depth": {"values": [{"label": "deep", "value": 8, "set": {"/constants/d": 1}}]},
      "sin": {"values": [{"label": "s", "value": 3, "set": {"/constants/s": 1}}]}},
      "measure": {"e": {"value": "/sag", "formula": ")J" +
           formula + R"J("}}})J";
  };
  const Study study = read_study_text(with("x/load + depth"), "s.json");
  const Json summary{{"sag", 5}};
  for (const Combination& combination : expand(study))
    CHECK(evaluate(study, study.measures.at(0), combination, summary) ==
          Approx(5 / (combination.choices[0] == 0 ? 1 : 2.5) + 8));
  CHECK(evaluate(study, read_study_text(with("sin(0) + x"), "s.json").measures.at(0), expand(study)[0], summary) == 5);
  // An axis without numbers has no place in a formula, nor has one of another name.
  CHECK(mistakes(with("x/type")).find("unknown name \"type\"; known:") != std::string::npos);
  CHECK(mistakes(with("x/type")).find("a formula cannot name the axis \"/transfer/type\", \"sin\"") !=
        std::string::npos);
  CHECK(std::isnan(
      evaluate(study, read_study_text(with("1/(load-1)"), "s.json").measures.at(0), expand(study)[0], summary)));
  CHECK(mistakes(with("x/laod")).find("did you mean \"load\"") != std::string::npos);
}

TEST_CASE("study.json keeps what advice needs", "[study]") {
  Results results = measured({{1, 8}, {2, 4}, {3, 4}, {3, 5}, {4, 1}, {6, 2}, {5, 1}, {0.5, 9}});
  results.study.note = "steps of a tenth";
  results.results[1].flags = {"a flag"};
  results.results[2].outcome = {Status::failed, "step 3: inverted: its volume ratio", false, "inverted"};
  const Json json = json_of(results, Json::object(), "1");
  CHECK(is_study_json(json));
  const Results read = results_from(Json::parse(json.dump()));
  REQUIRE(read.results.size() == 8);
  CHECK(read.study.error == "e");
  CHECK(read.study.note == "steps of a tenth");
  CHECK(read.results[1].flags == results.results[1].flags);
  CHECK(read.results[2].outcome.status == Status::failed);
  CHECK(read.results[2].outcome.cause == "inverted");
  CHECK(read.results[1].outcome.cause.empty());
  CHECK(label_of(read.study, read.results[7].combination) == "flip, FMPM(4), fine");
  CHECK(advise_for_error(read, "seconds", 4).good.front().result->combination.name == "flip-none-coarse");
  CHECK(objections(read) == std::vector<std::string>{"pic-none-fine: a flag"});
  Json damaged = json;
  damaged["runs"][0]["choices"][0] = 17;
  CHECK_THROWS_AS(results_from(damaged), std::runtime_error);
  damaged = json;
  damaged["runs"][0].erase("status");
  CHECK_THROWS_AS(results_from(damaged), std::runtime_error);
  CHECK_THROWS_AS(results_from(Json::object()), std::runtime_error);
  CHECK(table_csv(results).find("pic-none-fine,pic,none,fine,done,,a flag,4,2,,\n") != std::string::npos);
}

TEST_CASE("what became of a run, in few words", "[study]") {
  Result result;
  result.outcome = {Status::failed,
                    "step 3, t = 0.1 s: particle 4 of body \"b\" at (0.5, nan) m left the domain at x = 2 m", false,
                    "left the domain"};
  CHECK(outcome_words(result) == "stopped: left the domain");
  result.outcome = {Status::failed, "max_steps (10) was reached before end_time", false};
  CHECK(outcome_words(result) == "stopped");
  result.outcome = {Status::done, "", false};
  CHECK(outcome_words(result) == "bounded");
  result.flags = {"energy gain of 3 % (limit 1 %)"};
  CHECK(outcome_words(result) == "gained energy");
}

TEST_CASE("the shipped studies are studies of experiments that exist", "[study]") {
  for (const char* name : {"studies/transfer_trade", "extremes/time_step", "extremes/largest_step"}) {
    INFO(name);
    const Study study = read_study(std::string(MPM_SOURCE_DIR "/experiments/") + name + ".json");
    CHECK(std::filesystem::is_regular_file(study.base));
    CHECK(expand(study).size() >= 15);
    CHECK(!study.figures.empty());
  }
}

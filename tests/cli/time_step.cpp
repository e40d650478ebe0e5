// What limits the automatic time step is named in the summary and in the report, with the particle where a particle's
// speed limits it.

#include <cmath>

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

/// A warm bar whose conductivity, W/(m K), decides whether waves or heat limit the step.
Json bar(double conductivity) {
  return {{"dimension", 2},
          {"grid", {{"cell_size", 0.1}, {"domain", {{0, 0}, {1, 1}}}, {"boundaries", {{"all", "slip"}}}}},
          {"shape", {{"type", "bspline_quadratic"}}},
          {"transfer", {{"type", "apic"}}},
          {"materials",
           {{"a",
             {{"type", "neo_hookean"},
              {"density", 1000},
              {"youngs_modulus", 1000},
              {"poisson_ratio", 0.3},
              {"thermal", {{"conductivity", conductivity}, {"heat_capacity", 1000}}}}}}},
          {"bodies",
           {{{"name", "b"},
             {"material", "a"},
             {"temperature", "300 + x"},
             {"geometry", {{"type", "box"}, {"lower", {0, 0}}, {"upper", {1, 0.5}}}}}}},
          {"solver", {{"end_time", 0.06}}},
          {"output", {{"frames", 0}}}};
}

/// The summary of a run of the scene, and its report.
std::pair<Json, std::string> run_of(const Json& scene) {
  const Folder folder;
  const Result result = run_scene(folder, scene);
  INFO(result.err);
  REQUIRE(result.code == 0);
  return {json_in(folder / "run/summary.json"), slurp(folder / "run/report.html")};
}

}  // namespace

TEST_CASE("a step that diffusion limits is named so, without a particle") {
  // By hand: courant h^2 rho c / (2 D k) = 0.3 * 0.01 * 1e6 / (4 * 1e5) s.
  const auto [summary, report] = run_of(bar(1e5));
  CHECK(std::abs(summary["time_step"]["max"].get<double>() - 7.5e-3) < 1e-12);
  CHECK(summary["time_step"]["limited_by"] == "diffusion");
  CHECK(summary["time_step"]["smallest_limited_by"] == "diffusion");
  CHECK_FALSE(summary.contains("limiting_particle"));
  CHECK(has(report, "<small>limited by diffusion</small>"));
  CHECK_FALSE(has(report, "(wave "));
}

TEST_CASE("a step that waves limit is named so, with the particle") {
  const auto [summary, report] = run_of(bar(1));
  CHECK(summary["time_step"]["limited_by"] == "wave");
  REQUIRE(summary.contains("limiting_particle"));
  CHECK(summary["limiting_particle"].get<std::string>().starts_with("particle "));
  CHECK(has(report, "<small>limited by particle "));
  CHECK(has(report, " of b (wave "));
}

TEST_CASE("a step that a filter shortens is named so, with the particle, and the last one by the end of the run") {
  Json scene = bar(1);
  scene["materials"]["a"].erase("thermal"), scene["bodies"][0].erase("temperature");
  scene["filter"] = {{"type", "fmpm"}, {"order", 4}};
  scene["solver"] = {{"end_time", 0.1}};
  const auto [summary, report] = run_of(scene);
  CHECK(summary["time_step"]["limited_by"] == "filter order");
  CHECK(summary["time_step"]["smallest_limited_by"] == "end of the run");
  CHECK(summary["limiting_particle"].get<std::string>().starts_with("particle "));
  CHECK(has(report, "<small>limited by filter order, particle "));
  scene["filter"]["order"] = 1;  // divides the step by 1
  CHECK(run_of(scene).first["time_step"]["limited_by"] == "wave");
}

TEST_CASE("a step that the shape does not stand is shortened and named so, with the particle") {
  Json scene = bar(1);
  scene["materials"]["a"].erase("thermal"), scene["bodies"][0].erase("temperature");
  scene["solver"]["end_time"] = 0.2;
  const double asked = run_of(scene).first["time_step"]["max"].get<double>();
  scene["shape"]["type"] = "linear";
  const auto [summary, report] = run_of(scene);
  CHECK(summary["time_step"]["limited_by"] == "shape");
  CHECK(std::abs(summary["time_step"]["max"].get<double>() / asked - 0.1 / 0.3) < 0.01);
  CHECK(summary["limiting_particle"].get<std::string>().starts_with("particle "));
  CHECK(has(report, "<small>limited by shape, particle "));
  scene["solver"]["courant"] = 0.05;
  CHECK(run_of(scene).first["time_step"]["limited_by"] == "wave");
  // With the largest courant that may be asked for, the step is the longest that the combination stands.
  scene["solver"]["courant"] = 2, scene["shape"]["type"] = "bspline_quadratic";
  const auto longest = run_of(scene).first["time_step"];
  CHECK(longest["limited_by"] == "shape");
  CHECK(std::abs(longest["max"].get<double>() / asked - 0.9 / 0.3) < 0.05);
}

TEST_CASE("nothing limits a fixed step") {
  Json scene = bar(1e5);
  scene["solver"] = {{"end_time", 0.01}, {"time_step", 1e-3}};
  const auto [summary, report] = run_of(scene);
  CHECK_FALSE(summary["time_step"].contains("limited_by"));
  CHECK_FALSE(summary["time_step"].contains("smallest_limited_by"));
  CHECK_FALSE(summary.contains("limiting_particle"));
  CHECK_FALSE(has(report, "limited by"));
}

// The verb `bench`: every section on tiny scenes, its tables, files and refusals. What the numbers are is not tested.

#include <cmath>

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

bool is_rate(const Json& row, const char* key = "rate") {
  return row.contains(key) && row[key].is_number() && std::isfinite(row[key].get<double>()) && row[key] > 0;
}

const Json* row_with(const Json& rows, const Json& values) {
  for (const Json& row : rows) {
    bool all = true;
    for (const auto& [key, value] : values.items()) all = all && row.contains(key) && row[key] == value;
    if (all) return &row;
  }
  return nullptr;
}

void check_standard(const Json& standard, const Json& document) {
  for (const char* scene : {"cube_3d", "block_2d"})
    for (const char* motion : {"rest", "deforming"})
      for (const char* precision : {"float", "double"}) {
        INFO(scene << " " << motion << " " << precision);
        const Json place{{"scene", scene}, {"motion", motion}, {"precision", precision}, {"threads", 1}};
        Json baseline = place, product = place;
        baseline["material"] = "baseline", product["material"] = "neo_hookean";
        const Json* found = row_with(standard["rates"], baseline);
        REQUIRE(found);
        CHECK(is_rate(*found));
        found = row_with(standard["rates"], product);
        REQUIRE(found);
        CHECK(is_rate(*found));
        for (const char* key : {"over_baseline", "flops", "bytes", "gflops", "share_of_peak", "share_of_memory"})
          CHECK(is_rate(*found, key));
        if (document["threads"] > 1) {
          product["threads"] = document["threads"];
          found = row_with(standard["rates"], product);
          REQUIRE(found);
          CHECK(is_rate(*found, "over_one_thread"));
        }
      }
  const Json* fused = row_with(standard["phases"], {{"phase", "pass gather, strain and scatter"}});
  REQUIRE(fused);
  CHECK(is_rate(*fused, "cube_3d deforming float"));
}

}  // namespace

TEST_CASE("bench --quick measures every section", "[bench]") {
  const Folder folder;
  const Result result = call(folder, {"bench", "--quick", "--json", "--out", "out"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  const Json document = Json::parse(result.out);
  CHECK(document == json_in(folder / "out/bench.json"));
  CHECK(document["quick"] == true);
  CHECK(document["repeats"] == 2);
  const Json& sections = document["sections"];

  for (const Json& row : sections["machine"]["peaks"])
    for (const char* key : {"gflops_float", "gflops_double", "triad", "update", "read"}) CHECK(is_rate(row, key));
  check_standard(sections["standard"], document);
  for (const char* scene : {"cube_3d", "block_2d"})
    for (const char* option : {"pic",
                               "flip",
                               "apic",
                               "tpic",
                               "rpic",
                               "aflip",
                               "asflip",
                               "linear",
                               "bspline_cubic",
                               "gimp",
                               "gimp_contiguous",
                               "b2gimp",
                               "cpdi",
                               "fmpm 2",
                               "fmpm 4",
                               "xpic 2",
                               "xpic 4",
                               "contact",
                               "ledger",
                               "double",
                               "separate passes"}) {
      INFO(scene << " " << option);
      const Json* row = row_with(sections["options"]["options"], {{"scene", scene}, {"option", option}});
      REQUIRE(row);
      CHECK(is_rate(*row));
      CHECK(is_rate(*row, "cost"));
    }
  // Every law that is shipped has a row in every scene. F is 9 or 4 numbers of 4 bytes, a gas keeps three scalars.
  for (const auto& folder : fs::directory_iterator(fs::path(MPM_SOURCE_DIR) / "modules/materials"))
    for (const char* scene : {"cube_3d", "block_2d"}) {
      const std::string law = folder.path().filename().string();
      INFO(scene << " " << law);
      const Json* row = row_with(sections["materials"]["laws"], {{"scene", scene}, {"law", law}});
      REQUIRE(row);
      for (const char* key : {"rate", "cost", "flops", "state"}) CHECK(is_rate(*row, key));
      CHECK((*row)["all_flops"] > (*row)["flops"]);
      if (law == "neo_hookean") CHECK((*row)["state"] == (std::string(scene) == "cube_3d" ? 36 : 16));
      if (law == "ideal_gas") CHECK((*row)["state"] == 12);
    }
  CHECK(sections["growth"]["growth"].size() == 4);
  for (const Json& row : sections["growth"]["growth"])
    for (const char* key : {"rate", "cost", "particle_memory", "peak_memory"}) CHECK(is_rate(row, key));
  CHECK(is_rate(sections["growth"]["startup"].back(), "seconds"));
  CHECK(sections["accuracy"]["float_against_double"].size() == 4);
  for (const Json& row : sections["accuracy"]["float_against_double"]) {
    CHECK(is_rate(row, "position_rms"));
    CHECK(row["position_largest"] < 1e-3);  // a difference in cells
  }
  const Json& busy = sections["busy"]["busy"];
  for (const Json& loops : {Json(0), document["threads"]})
    for (const char* threads : {"1", "default"}) {
      const Json* row = row_with(busy, {{"busy", loops}, {"threads", threads}});
      REQUIRE(row);
      CHECK(is_rate(*row));
      CHECK(is_rate(*row, "over_best"));
    }
  // What is counted and not timed does not depend on the machine: the page has the same.
  const std::string tables = slurp(fs::path(MPM_SOURCE_DIR) / "docs/benchmarks/tables.md");
  CHECK(sections["required"]["required"].size() >= 12);
  for (const Json& row : sections["required"]["required"]) {
    std::string cells = "| " + row["scene"].get<std::string>() + " |";
    for (const char* key : {"bytes_per_particle", "bytes_per_node", "passes", "calls"})
      cells += " " + std::to_string(row[key].get<long>()) + " |";
    INFO(cells << " (mpm bench required; docs/benchmarks/tables.md)");
    CHECK(has(tables, cells));
  }
  for (const char* section : {"standard", "options", "growth", "busy"})
    for (const Json& target : sections[section]["targets"]) {
      INFO(target.dump());
      CHECK(target["measured"].is_number());
      CHECK((target["verdict"] == "held" || target["verdict"] == "missed"));
    }
  for (const char* file : {"report.md", "roofline.png", "roofline.svg", "roofline.csv", "standard_rates.csv",
                           "standard_phases.csv", "options_options.csv", "growth_growth.csv", "targets.csv"})
    CHECK(fs::file_size(folder / "out" / file) > 100);
}

TEST_CASE("the standard scenes hold a million particles and run by themselves", "[bench]") {
  const fs::path scenes = fs::path(MPM_SOURCE_DIR) / "experiments/benchmarks";
  for (const char* name : {"cube_3d_rest", "cube_3d_deforming", "block_2d_rest", "block_2d_deforming"}) {
    INFO(name);
    const Folder folder;
    const std::string file = (scenes / (std::string(name) + ".json")).string();
    Result result = call(folder, {"check", file});
    REQUIRE(result.code == 0);
    CHECK(has(result.out, "about 1000000 particles"));
    const bool three = has(name, "3d");
    const std::string cell = three ? "0.03125" : "0.0078125", step = three ? "4e-4" : "1e-4";
    result = call(folder, {"run", file, "--set", "/grid/cell_size=" + cell, "--set", "/solver/time_step=" + step,
                           "--set", "/output/metrics_every=10", "--out", "out"});
    INFO(result.err);
    REQUIRE(result.code == 0);
    const Json stability = json_in(folder / "out/summary.json")["stability"];
    CHECK(stability["smallest_volume_ratio"] > 0.2);
    CHECK(stability["smallest_volume_ratio"] < (has(name, "rest") ? 1.001 : 0.8));  // the scene deforms where it should
  }
}

TEST_CASE("bench prints tables, a line a row", "[bench]") {
  const Folder folder;
  const Result result = call(folder, {"bench", "machine", "--quick"});
  REQUIRE(result.code == 0);
  CHECK(has(result.out, "== machine =="));
  CHECK(has(result.out, "FMA float (GFLOP/s)"));
  CHECK_FALSE(has(result.out, "== standard =="));
  CHECK(folder.names().empty());
}

TEST_CASE("bench refuses what it does not know", "[bench]") {
  const Folder folder;
  Result result = call(folder, {"bench", "standrd"});
  CHECK(result.code == 2);
  CHECK(has(result.err, "\"standrd\""));
  CHECK(has(result.err, "did you mean \"standard\"?"));
  result = call(folder, {"bench", "--repeats", "3", "machine"});
  CHECK(result.code == 2);
  CHECK(has(result.err, "at least 5"));
  result = call(folder, {"bench", "--threads", "0"});
  CHECK(result.code == 2);
  CHECK(has(call(folder, {"bench", "--help"}).out, "accuracy"));
}

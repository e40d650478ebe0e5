// The report: safe, whole, honest about failure, and readable numbers.
#include <cmath>
#include <nlohmann/json.hpp>

#include "output/html.hpp"
#include "output/report.hpp"
#include "output/run_folder.hpp"
#include "support/base64.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/numbers.hpp"
#include "unit/output_support.hpp"

namespace fs = std::filesystem;
using namespace mpm::output;
using namespace mpm::support;
using namespace mpm::output::testing;

namespace {

const std::string picture = std::string("\x89PNG\r\n\x1a\n", 8) + "not a real picture";

RunFolder sample_run(const fs::path& path, int exit_code) {
  RunFolder run = RunFolder::create(path);
  run.write_json("experiment.json", {{"title", "Discs <script>alert(1)</script> & \"rings\""},
                                     {"dimension", 2},
                                     {"precision", "double"},
                                     {"transfer", {{"type", "flip"}}}});
  Json plugin = {
      {"id", "flip"}, {"kind", "transfer"}, {"version", "1.0"}, {"citation", "Brackbill 1986, https://doi.org/x"}};
  run.write_json("manifest.json", {{"command", {"mpm", "run", "two discs.json"}}, {"plugins", Json::array({plugin})}});
  Json held = {{"metric", "energy.total"}, {"at_least", 0.98}, {"value", 0.991}, {"held", true}};
  Json failed = {{"metric", "error.l2"}, {"at_most", 1e-7}, {"value", 0.02}, {"held", false}, {"tolerance", 0.125}};
  run.write_json(
      "summary.json",
      {{"outcome", {{"exit_code", exit_code}, {"status", "x"}, {"reason", exit_code ? "NaN at <step> 12" : ""}}},
       {"warnings", {"coarse & <slow>"}},
       {"energy",
        {{"kinetic", 123456789.0},
         {"ledger", {{"a_residual_cause", 0.5}, {"friction", -0.25}, {"rest", 1e-17}, {"wall", 0.125}}},
         {"ledger_closed_by", "rest"}}},
       {"performance",
        {{"particle_steps_per_second", 2.9e7},
         {"peak_memory", 3221225472},
         {"seconds_by_pass", {{"scatter", 3.0}, {"gather", 1.0}}}}},
       {"unheard_of", {{"nested", {{"deep_value", 42}}}}},
       {"expect", Json::array({held, failed})}});
  write_atomically(run.figures() / "kinetic_energy.png", picture);
  write_atomically(run.figures() / "kinetic_energy.csv", "t\n1\n");
  for (int i = 0; i < 30; ++i) write_atomically(run.frames() / ("frame_" + std::to_string(i) + ".png"), picture);
  return run;
}

std::string report_of(const RunFolder& run) {
  write_report(run.root());
  return read_file(run.root() / "report.html");
}

}  // namespace

TEST_CASE("the report escapes, embeds and loads nothing", "[output][report]") {
  const TemporaryFolder scratch;
  const std::string html = report_of(sample_run(scratch / "run", 0));
  CHECK(contains(html, "Discs &lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;rings&quot;"));
  CHECK(contains(html, "coarse &amp; &lt;slow&gt;"));
  CHECK(contains(html, "https://doi.org/x"));
  CHECK(count_of(html, "src=\"data:image/png;base64," + base64(picture)) == 1 + 8);
  CHECK(contains(html, ">frame 0<"));
  CHECK(contains(html, ">frame 29<"));
  CHECK(contains(html, "href=\"figures/kinetic_energy.csv\""));
  for (const char* loads : {"<script", "<link", "<iframe", "@import", "url(", "src=\"http", "href=\"http", "src=\"/"}) {
    CAPTURE(loads);
    CHECK_FALSE(contains(html, loads));
  }
}

TEST_CASE("the report shows every recorded number, also of unknown groups", "[output][report]") {
  const TemporaryFolder scratch;
  const std::string html = report_of(sample_run(scratch / "run", 0));
  for (const char* shown : {"deep value", "42", "1.23457×10<sup>8</sup>", "10<sup>−17</sup>", "2.9×10<sup>7</sup>",
                            "75\xC2\xA0%", "friction", "✓ held", "✗ not held", "at most 1×10<sup>−7</sup>",
                            "tolerance 0.125", "3\xC2\xA0GiB", "mpm run &#39;two discs.json&#39;"}) {
    CAPTURE(shown);
    CHECK(contains(html, shown));
  }
  CHECK_FALSE(contains(html, "e+0"));
}

TEST_CASE("the card of the total energy shows the total, not the first energy that has a ratio", "[output][report]") {
  const TemporaryFolder scratch;
  const RunFolder run = sample_run(scratch / "run", 0);
  run.write_json(
      "summary.json",
      {{"outcome", {{"exit_code", 0}, {"status", "done"}, {"reason", ""}}},
       {"energy", {{"kinetic", {{"final_over_initial", 0.125}}}, {"total", {{"final_over_initial", 0.9375}}}}}});
  const std::string html = report_of(run);
  const std::size_t card = html.find("total energy, final / initial");
  REQUIRE(card != std::string::npos);
  CHECK(html.substr(card, 100).find("0.9375") != std::string::npos);
  CHECK(html.substr(card, 100).find("0.125") == std::string::npos);
}

TEST_CASE("a failed run says so in red, with the reason", "[output][report]") {
  const TemporaryFolder scratch;
  const std::string good = report_of(sample_run(scratch / "good", 0));
  CHECK(contains(good, "class=\"banner good\""));
  CHECK_FALSE(contains(good, "class=\"banner bad\""));
  const std::string bad = report_of(sample_run(scratch / "bad", 3));
  CHECK(contains(bad, "class=\"banner bad\""));
  CHECK(contains(bad, "NaN at &lt;step&gt; 12"));
  CHECK(contains(bad, "exit code 3"));
  CHECK_FALSE(contains(bad, "class=\"banner good\""));
}

TEST_CASE("the row that closes the ledger stands last, by its mark and not by its name", "[output][report]") {
  const TemporaryFolder scratch;
  const std::string html = report_of(sample_run(scratch / "run", 0));
  const std::size_t total = html.find("<tr class=\"total\">"), end = html.find("</table>", total);
  REQUIRE(total != std::string::npos);
  CHECK(html.find("<tr class=\"total\">", total + 1) > end);
  CHECK(html.substr(total, end - total).find("wall") == std::string::npos);
  CHECK(html.substr(total, end - total).find(">rest<") != std::string::npos);
  for (const char* cause : {">a residual cause<", ">friction<", ">wall<"}) CHECK(html.find(cause) < total);
  CHECK_FALSE(contains(html, "ledger closed by"));
}

TEST_CASE("missing and cut files cost a note, not the report", "[output][report]") {
  const TemporaryFolder scratch;
  const RunFolder run = RunFolder::create(scratch / "run");
  CHECK(contains(report_of(run), "No outcome was recorded"));
  run.write_text("summary.json", "{\"energy\": {\"kinetic\": 1");
  run.write_text("plan.json", "[1, 2]");
  const std::string html = report_of(run);
  CHECK(contains(html, "summary.json, plan.json"));
}

TEST_CASE("odd types anywhere in the record are shown, not fatal", "[output][report]") {
  const TemporaryFolder scratch;
  const RunFolder run = RunFolder::create(scratch / "run");
  const Json odd[] = {nullptr, 1.5, "text", Json::array(), Json::object(), Json::array({1, "a", Json::object()}), true};
  for (const Json& value : odd) {
    Json experiment, summary, manifest;
    for (const char* key : {"title", "dimension", "materials", "bodies", "grid", "solver", "transfer"})
      experiment[key] = value;
    for (const char* key :
         {"outcome", "warnings", "energy", "momentum", "contact", "error", "expect", "performance", "steps"}) {
      summary[key] = value;
    }
    for (const char* key : {"plugins", "command", "machine"}) manifest[key] = value;
    run.write_json("experiment.json", experiment);
    run.write_json("summary.json", summary);
    run.write_json("manifest.json", manifest);
    run.write_json("plan.json", {{"passes", value}, {"fields", Json::array({value, value})}});
    CHECK_NOTHROW(write_report(run.root()));
    run.write_json("summary.json", {{"energy", {{"ledger", value}}}, {"performance", {{"seconds_by_pass", value}}}});
    CHECK_NOTHROW(write_report(run.root()));
  }
}

namespace {

/// The twin that render/curves.cpp writes: two curves of three points.
void draw_curves(const RunFolder& run, const std::string& stem, const std::vector<double>& numbers) {
  std::string twin = "series,kind,time t (s),\"y, shown\",error,point\n";
  for (std::size_t k = 0; k < numbers.size(); ++k)
    twin += std::string(k < 3 ? "p x" : "p y") + ",line," + std::to_string(k % 3) + "," +
            mpm::support::full_precision(numbers[k]) + ",,\n";
  write_atomically(run.figures() / (stem + ".csv"), twin);
  write_atomically(run.figures() / (stem + ".png"), picture);
}

/// A run with sum m |v| = 10 kg m/s, sum m |x| |v| = 40 kg m^2/s, 5 s, at most 8 J: energies are rounding to 8e-12 J.
RunFolder run_with_sizes(const fs::path& path) {
  RunFolder run = RunFolder::create(path);
  run.write_json("summary.json",
                 {{"simulated_time", 5.0}, {"scales", {{"momentum", 10.0}, {"angular_momentum", 40.0}}}});
  write_atomically(run.root() / "metrics.csv",
                   "time (s),kinetic energy (J),strain energy (J),gravitational energy (J)\n0,8,0,0\n5,1,2,-3\n");
  return run;
}

bool is_folded(const std::string& html, const std::string& caption) {
  return contains(html, "<details><summary><b>" + caption + "</b>: ");
}

}  // namespace

TEST_CASE("figures stand in the order of a reader's questions, after the frames", "[output][report]") {
  const TemporaryFolder scratch;
  const RunFolder run = run_with_sizes(scratch / "run");
  for (const char* stem : {"volume_ratio", "angular_momentum", "a_figure_of_my_own", "error", "ledger", "contact_nodes",
                           "momentum", "contact", "dissipation", "energy"})
    write_atomically(run.figures() / (std::string(stem) + ".png"), picture);
  write_atomically(run.frames() / "frame_0000.png", picture);
  const std::string html = report_of(run);
  std::size_t last = 0;
  for (const char* caption : {"frame 0000", "energy", "dissipation", "contact", "contact nodes", "error", "ledger",
                              "volume ratio", "momentum", "angular momentum", "a figure of my own"}) {
    const std::size_t place = html.find("alt=\"" + std::string(caption) + "\"");
    CAPTURE(caption);
    REQUIRE(place != std::string::npos);
    CHECK(place > last);
    last = place;
  }
}

TEST_CASE("a figure of rounding is folded away behind the others, and says how small it is", "[output][report]") {
  const TemporaryFolder scratch;
  const RunFolder run = run_with_sizes(scratch / "run");
  draw_curves(run, "momentum", {0, 9e-12, -3e-15, 0, 0, 1e-13});
  draw_curves(run, "angular_momentum", {0, -1.01e-15, 0, 0, 0, 0});
  draw_curves(run, "contact", {0, 0, 0, 0, 0, 0});
  draw_curves(run, "volume_ratio", {1, 1 + 4.44e-16, 1, 1, 1, 1});
  draw_curves(run, "error", {0, 3.9e-12, 0, 0, 0, 0});
  draw_curves(run, "dissipation", {0, 7.9e-12, 0, 0, 0, 0});
  write_atomically(run.figures() / "ledger.csv", "time t (s),\"filter, all (J)\",residual (J)\n0,1e-13,-7.9e-12\n");
  write_atomically(run.figures() / "ledger.png", picture);
  draw_curves(run, "energy", {8, 2, -3, 0, 0, 0});
  const std::string html = report_of(run);
  CHECK(contains(html, "<b>angular momentum</b>: rounding, at most 2.6×10<sup>−17</sup> of Σ m |x| |v|</summary>"));
  CHECK(contains(html, "<b>contact</b>: zero throughout"));
  for (const char* caption : {"momentum", "volume ratio", "error", "dissipation", "ledger"}) {
    CAPTURE(caption);
    CHECK(is_folded(html, caption));
    CHECK(html.find("alt=\"" + std::string(caption) + "\"") > html.find("alt=\"energy\""));
  }
  CHECK_FALSE(is_folded(html, "energy"));
}

TEST_CASE("a figure that may show more than rounding is not folded", "[output][report]") {
  const TemporaryFolder scratch;
  const RunFolder run = run_with_sizes(scratch / "run");
  draw_curves(run, "momentum", {0, 0, 0, 0, 0, -1.1e-11});     // one number above the limit is enough
  draw_curves(run, "angular_momentum", {0, NAN, 0, 0, 0, 0});  // the numbers of a run that broke down
  draw_curves(run, "contact", {0, 2.1e-12, 0, 0, 0, 0});       // 10 kg m/s in 5 s are 2 N
  draw_curves(run, "contact_nodes", {0, 1, 0, 0, 0, 0});
  draw_curves(run, "volume_ratio", {1, 1, 1, 1, 1, 1 + 1.1e-12});
  draw_curves(run, "error", {0, 4.1e-12, 0, 0, 0, 0});  // the mean distance from the origin is 4 m
  draw_curves(run, "dissipation", {0, 8.1e-12, 0, 0, 0, 0});
  write_atomically(run.figures() / "ledger.csv", "time t (s),filter (J),residual (J)\n0,0,0\n5,0,8.1e-12\n");
  write_atomically(run.figures() / "ledger.png", picture);
  draw_curves(run, "my_own", {0, 0, 0, 0, 0, 0});  // no size is known for it
  CHECK_FALSE(contains(report_of(run), "<details><summary><b>"));

  const RunFolder unknown = RunFolder::create(scratch / "no_summary");
  write_atomically(unknown.root() / "metrics.csv", "time (s),kinetic energy (J)\n0,8\n5,what\n");
  draw_curves(unknown, "momentum", {0, 0, 0, 0, 0, 0});
  draw_curves(unknown, "dissipation", {0, 0, 0, 0, 0, 0});
  CHECK_FALSE(contains(report_of(unknown), "<details><summary><b>"));
}

TEST_CASE("numbers are written for people", "[output][html]") {
  CHECK(number_html(0.0) == "0");
  CHECK(number_html(-0.0) == "0");
  CHECK(number_html(0.1) == "0.1");
  CHECK(number_html(123456.7) == "123457");
  CHECK(number_html(999999.96) == "1×10<sup>6</sup>");
  CHECK(number_html(0.00012345678) == "0.000123457");
  CHECK(number_html(-1.5e-7) == "−1.5×10<sup>−7</sup>");
  CHECK(number_html(1e5) == "100000");
  CHECK(number_html(1e100) == "1×10<sup>100</sup>");
  CHECK(number_html(INFINITY) == "∞");
  CHECK(number_html(NAN) == "not a number");
  CHECK(integer_html(1234) == "1234");
  CHECK(integer_html(-1234567) == "−1\u202F234\u202F567");
  CHECK(bytes_html(96) == "96\u00A0B");
  CHECK(bytes_html(1536) == "1.5\u00A0KiB");
  CHECK(escape_html("a\xFF\x01<é>") == "a\uFFFD\uFFFD&lt;é&gt;");
  CHECK(relative_link("figures/a b\"c:d.csv") == "figures/a%20b%22c%3Ad.csv");
}

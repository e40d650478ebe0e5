// The report: safe, whole, honest about failure, and readable numbers.
#include <cmath>
#include <nlohmann/json.hpp>

#include "output/html.hpp"
#include "output/report.hpp"
#include "output/run_folder.hpp"
#include "support/base64.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
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
       {"energy", {{"kinetic", 123456789.0}, {"ledger", {{"friction", -0.25}, {"residual", 1e-17}}}}},
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

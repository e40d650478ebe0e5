// docs/benchmarks/index.md says what docs/benchmarks/tables.md holds: a bench that is run anew cannot leave the words behind.

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/page.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

using Cells = std::vector<std::string>;

/// The pages of tables: that of the first machine, that of another, that of the laws, and that of contact.
constexpr const char *first_machine = "tables.md", *intel = "tables_intel.md", *laws = "materials.md",
                     *contact = "contact.md";

/// The table below the first heading of a page that begins with these words, its header first.
std::vector<Cells> table(const std::string& heading, const std::string& file = first_machine) {
  std::istringstream page(support::read_file(MPM_SOURCE_DIR "/docs/benchmarks/" + file));
  std::vector<Cells> rows;
  bool below = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("#")) {
      if (below) break;
      below = line.starts_with("### " + heading) || line.starts_with("## " + heading);
    }
    if (!below || !line.starts_with("| ")) continue;
    Cells cells;
    for (std::size_t from = 2, bar; (bar = line.find(" |", from)) != std::string::npos; from = bar + 3)
      cells.push_back(line.substr(from, bar - from));
    rows.push_back(cells);
  }
  if (rows.size() < 2) throw std::runtime_error("docs/benchmarks/" + file + " has no table below " + heading);
  return rows;
}

/// The numbers of one column in the rows that begin with these cells ("*": any cell).
std::vector<double> numbers(const std::string& heading, const Cells& first, const std::string& column,
                            const std::string& file = first_machine) {
  const std::vector<Cells> rows = table(heading, file);
  const auto at = std::find(rows[0].begin(), rows[0].end(), column) - rows[0].begin();
  std::vector<double> found;
  for (auto row = rows.begin() + 1; row != rows.end(); ++row) {
    const auto same = [](const std::string& wanted, const std::string& cell) {
      return wanted == "*" || wanted == cell;
    };
    if (std::equal(first.begin(), first.end(), row->begin(), same) && row->at(at) != "-")
      found.push_back(std::stod(row->at(at)));
  }
  if (found.empty()) throw std::runtime_error("no number below " + heading + " in the column " + column);
  return found;
}
double number(const std::string& heading, const Cells& first, const std::string& column,
              const std::string& file = first_machine) {
  const auto found = numbers(heading, first, column, file);
  if (found.size() != 1) throw std::runtime_error("several numbers below " + heading + " in the column " + column);
  return found[0];
}
double cube(const std::string& motion, const std::string& precision, int threads, const std::string& column,
            const std::string& file = first_machine) {
  return number("Standard scenes", {"cube_3d", motion, "neo_hookean", precision, std::to_string(threads)}, column,
                file);
}
double cost(const std::string& option, const std::string& file = first_machine) {
  return number("What an option costs", {"cube_3d", option}, "cost / standard", file);
}
double law(const std::string& name, const std::string& column) {
  return number("What a law costs", {"cube_3d", name}, column, laws);
}
/// How many targets of a page have this verdict.
double targets(const std::string& verdict, const std::string& file) {
  std::istringstream page(support::read_file(MPM_SOURCE_DIR "/docs/benchmarks/" + file));
  double count = 0;
  for (std::string line; std::getline(page, line);) count += line.ends_with("| " + verdict + " |");
  return count;
}

/// Checks a sentence of a page against the numbers that it must print, and notes it.
auto numbers_said_by(Page& page) {
  return [&page](const std::string& sentence, const std::vector<double>& values) {
    INFO(sentence);
    const auto printed = page.read(sentence);
    REQUIRE(printed.size() == values.size());
    for (std::size_t k = 0; k < values.size(); ++k) CHECK(values[k] == printed[k].rounded());
    page.add_measured(sentence);
  };
}

}  // namespace

TEST_CASE("the numbers of the benchmarks' page are those of its tables", "[docs]") {
  Page page("docs/benchmarks/index.md");
  page.keep_from_to("What they say", "A target that is missed");
  const auto says = numbers_said_by(page);
  const std::string rate = "rate (M/s)", baseline = "/ baseline", rest = "/ rest", peak = "of FMA peak (%)",
                    one = "/ 1 thread";
  says("| one thread, float: million particle-steps a second; over the baseline | #; # | #; # | # |",
       {cube("rest", "float", 1, rate), cube("rest", "float", 1, baseline), cube("deforming", "float", 1, rate),
        cube("deforming", "float", 1, baseline), cube("deforming", "float", 1, rest)});
  says("| one thread, double | #; # | #; # | # |",
       {cube("rest", "double", 1, rate), cube("rest", "double", 1, baseline), cube("deforming", "double", 1, rate),
        cube("deforming", "double", 1, baseline), cube("deforming", "double", 1, rest)});
  says("| share of the multiply-add peak, float; double | # %; # % | # %; # % |",
       {cube("rest", "float", 1, peak), cube("rest", "double", 1, peak), cube("deforming", "float", 1, peak),
        cube("deforming", "double", 1, peak)});
  says("| two threads over one, float; double | #; # | #; # |",
       {cube("rest", "float", 2, one), cube("rest", "double", 2, one), cube("deforming", "float", 2, one),
        cube("deforming", "double", 2, one)});
  says("with two threads: # million at rest (# GFLOP/s), # deforming",
       {cube("rest", "float", 2, rate), cube("rest", "float", 2, "GFLOP/s"), cube("deforming", "float", 2, rate)});

  const auto lines = numbers("Standard scenes", {"cube_3d"}, "line (ns)");
  says("(column \"line\": # to # ns in the cube's rows)",
       {*std::min_element(lines.begin(), lines.end()), *std::max_element(lines.begin(), lines.end())});

  const std::string parts = "Where the time goes", deforming = "cube_3d deforming float";
  double whole = 0;
  const std::vector<Cells> rows = table(parts);
  for (auto row = rows.begin() + 1; row != rows.end(); ++row)
    if (row->front().starts_with("pass ")) whole += number(parts, {row->front()}, deforming);
  says("sorting takes # ns of #, and the scatter # in place of #,",
       {number(parts, {"pass sort"}, deforming), whole, number(parts, {"phase scatter"}, deforming),
        number(parts, {"phase scatter"}, "cube_3d rest float")});

  const auto plugins = numbers("Plugins against", {"*"}, "time with plugins / compiled in");
  says("Plugins cost at most # %", {100 * (*std::max_element(plugins.begin(), plugins.end()) - 1)});
  says("Gradients cost # times MLS", {cost("apic")});
  says("cubic B-splines # times quadratic ones, CPDI # times (# million a second), PolyPIC # times",
       {cost("bspline_cubic"), cost("cpdi"), number("What an option costs", {"cube_3d", "cpdi"}, rate),
        cost("polypic")});
  says("The ledger costs # % where it is entered in every eighth step (`ledger_every`), and # % where",
       {100 * (cost("ledger of every 8th step") - 1), 100 * (cost("ledger") - 1)});

  const std::string growth = "Growth (3-D", memory = "peak / state";
  CHECK(number(growth, {"1e7 particles"}, memory) < number(growth, {"1e6 particles"}, memory));
  says("takes less memory than with 10⁶, and # times the time of a step; with 10⁵ it takes # times the time",
       {number(growth, {"1e7 particles"}, "cost / 1e6"), number(growth, {"1e5 particles"}, "cost / 1e6")});
  page.add_given({"(23 November 2026, two cores of a virtual machine",
                  "with AMD's Zen 5 and AVX-512, no GPU; float, 3-D,", "The aim of 90 million",
                  "With 10⁷ particles a particle"});
  CHECK(page.numbers_of_nobody() == std::vector<std::string>{});
}

TEST_CASE("the numbers of another processor and of the laws are those of its tables", "[docs]") {
  Page page("docs/benchmarks/index.md");
  page.keep_from_to("## On another processor", "## What contact costs");
  const auto says = numbers_said_by(page);
  const std::string rate = "rate (M/s)", baseline = "/ baseline", peaks = "Peaks", update = "triad (GB/s)";
  says("whose memory moves # GB/s where that of the first moves #",
       {number(peaks, {"2"}, update, intel), number(peaks, {"2"}, update)});
  says("One thread steps # million particles a second at rest and # million deforming; two threads # and # million",
       {cube("rest", "float", 1, rate, intel), cube("deforming", "float", 1, rate, intel),
        cube("rest", "float", 2, rate, intel), cube("deforming", "float", 2, rate, intel)});
  says("One thread is # and # times as fast as the baseline",
       {cube("rest", "float", 1, baseline, intel), cube("deforming", "float", 1, baseline, intel)});
  const auto plugins = numbers("Plugins against", {"*"}, "time with plugins / compiled in", intel);
  says("Plugins cost up to # %", {100 * (*std::max_element(plugins.begin(), plugins.end()) - 1)});
  says("costs # % where it is entered in every eighth step and # % where",
       {100 * (cost("ledger of every 8th step", intel) - 1), 100 * (cost("ledger", intel) - 1)});
  const double missed = targets("missed", intel);
  says("Of # targets # are missed", {missed + targets("held", intel), missed});

  for (const std::string name : {"inviscid_fluid", "linear_elastic", "corotated", "newtonian_fluid", "von_mises",
                                 "ideal_gas", "hencky", "damage", "drucker_prager", "snow", "cam_clay"})
    says("| `" + name + "` | # | # | # |",
         {law(name, "cost / standard"), law(name, "bytes of state"), law(name, "flop of the law")});
  says("the laws, costs # of the standard", {law("neo_hookean", "cost / standard")});
  says("| `prony`, two branches | # | # | # |",
       {law("prony", "cost / standard"), law("prony", "bytes of state"), law("prony", "flop of the law")});
  says("comes to # in the cube and # in the block; `linear_elastic` costs #,",
       {law("inviscid_fluid", "cost / standard"),
        number("What a law costs", {"block_2d", "inviscid_fluid"}, "cost / standard", laws),
        law("linear_elastic", "cost / standard")});
  const std::vector<std::string> wide{"johnson_cook", "von_mises_power", "von_mises_voce", "von_mises_table"};
  double spread = 0;
  for (const auto& row : table("What a law costs", laws))
    if (row[0] == "block_2d" || (row[0] == "cube_3d" && std::find(wide.begin(), wide.end(), row[1]) == wide.end()))
      spread = larger(spread, std::stod(row[3]));
  says("spread by at most # % in all rows but", {spread});
  says("which spread by #, #, # and # %:", {law(wide[0], "spread (%)"), law(wide[1], "spread (%)"),
                                            law(wide[2], "spread (%)"), law(wide[3], "spread (%)")});
  CHECK(law("linear_elastic", "bytes of state") == law("neo_hookean", "bytes of state"));
  says("the law takes # of the # ns of the standard",
       {number("Where the time goes", {"phase material"}, "cube_3d deforming float", intel),
        number("What a law costs", {"cube_3d", "neo_hookean"}, "ns a particle-step", intel)});
  CHECK(law("von_mises", "cost / standard") <= 1.35);
  for (const std::string name : {"hencky", "damage", "drucker_prager", "mohr_coulomb", "mu_i", "snow", "cam_clay"})
    CHECK(law(name, "cost / standard") >= 1.9);
  page.add_given({"27 November 2026", "29 November 2026", "AMD's Zen 4", "machine with AVX-512",
                  "at most 0.9 of Neo-Hookean", "hardly come to 0.9;", "at most 1.35 and does",
                  "at least 1.9 times Neo-Hookean"});
  CHECK(page.numbers_of_nobody() == std::vector<std::string>{});
}

TEST_CASE("the numbers of what contact costs are those of its tables", "[docs]") {
  Page page("docs/benchmarks/index.md");
  page.keep_from_to("## What contact costs", "## Scenes");
  const auto says = numbers_said_by(page);
  const auto cost_in = [](const std::string& scene, const std::string& option) {
    return number("What an option costs", {scene, option}, "cost / standard", contact);
  };
  const auto both = [&](const std::string& option) {
    return std::vector{cost_in("cube_3d", option), cost_in("block_2d", option)};
  };
  says("| averaged gradients (the default) | # | # |", both("contact"));
  says("| `widest_gap` | # | # |", both("contact, widest gap"));
  says("| `linear_regression` | # | # |", both("contact, linear regression"));
  says("| `logistic_regression` | # | # |", both("contact, logistic regression"));
  const auto over = [&](const std::string& option, const std::string& other) {
    return std::vector{cost_in("cube_3d", option) / cost_in("cube_3d", other),
                       cost_in("block_2d", option) / cost_in("block_2d", other)};
  };
  says("Linear regression comes to # in the cube and # in the block", over("contact, linear regression", "contact"));
  says("ten to thirty times, comes to # and #", over("contact, logistic regression", "contact"));
  says("blocks of air between them cost # and # of what they cost without",
       over("contact, bodies apart", "bodies apart"));
  for (const double cost : both("contact")) CHECK(cost <= 2);
  double spread = 0, spread_of_logistic = 0;
  for (const auto& row : table("What an option costs", contact))
    if (row[0] != "scene") {
      double& largest = row[1] == "contact, logistic regression" ? spread_of_logistic : spread;
      largest = larger(largest, std::stod(row[5]));
    }
  says("rounds spread by up to # %, those of logistic regression by # %", {spread, spread_of_logistic});
  page.add_given({"30\nNovember 2026", "to cost at most 2 and does", "at most 1.5 of the default normal"});
  CHECK(page.numbers_of_nobody() == std::vector<std::string>{});
}

TEST_CASE("the ceilings on the page of devices are those of its tables", "[docs]") {
  Page page("docs/benchmarks/device.md");
  const std::string tables = "device_tables.md";
  const auto says = numbers_said_by(page);
  const auto ceiling = [&](const std::string& scene, const std::string& kernel) {
    return number("Kernels of " + scene + ", sm_90", {"`" + kernel + "`"}, "occupancy", tables);
  };
  says("`advance_0` (# % in the cube, # % in the block) and in `fold_masses` (# %)",
       {ceiling("cube_3d_rest", "advance_0"), ceiling("block_2d_rest", "advance_0"),
        ceiling("block_2d_rest", "fold_masses")});
  CHECK(ceiling("cube_3d_rest", "fold_masses") == ceiling("block_2d_rest", "fold_masses"));
  says("That of `add_teams` (# %) means nothing", {ceiling("cube_3d_rest", "add_teams")});
  for (const std::string scene : {"cube_3d_rest", "block_2d_rest"})
    for (const auto& row : table("Kernels of " + scene + ", sm_90", tables))
      if (row[0].find("add_teams") == row[0].npos && row[0].find("advance") == row[0].npos && row[0] != "kernel")
        CHECK(std::stod(row[5]) >= ceiling("cube_3d_rest", "fold_masses"));
  double least = 100;
  std::string where;
  for (const std::string processor : {"sm_80", "sm_90"})
    for (const auto& row : table("Shipped experiments, " + processor, tables))
      if (row[0] != "experiment") {
        CHECK(row[5] == "0");  // nothing spills
        if (std::stod(row[6]) < least) least = std::stod(row[6]), where = row[0] + row[6];
      }
  says("shipped experiment is # %, of `advance_0` in `papers/plate_impact.json`", {least});
  CHECK(where.find("`papers/plate_impact.json`") == 0);
  CHECK(where.find("`advance_0`") != where.npos);
}

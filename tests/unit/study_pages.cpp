// Tables of docs/studies against the numbers that the studies' figures were drawn from (figures/studies/*.csv): a page
// that is edited, or a study that is run anew, cannot leave the other behind.

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "study/study.hpp"
#include "support/catch.hpp"
#include "support/csv.hpp"
#include "support/page.hpp"
#include "support/scene.hpp"

using namespace mpm::test;

namespace {

using Cells = std::vector<std::vector<std::string>>;

Cells figure(const std::string& name) {
  return mpm::support::read_csv_cells(MPM_SOURCE_DIR "/figures/studies/" + name + ".csv");
}

/// The last cells of the only row of the figure that begins with these cells; the value stands in `column`.
double value(const Cells& cells, const std::vector<std::string>& first, std::size_t column) {
  const std::vector<std::string>* found = nullptr;
  for (const auto& row : cells)
    if (row.size() > column && std::equal(first.begin(), first.end(), row.begin())) {
      if (found != nullptr) throw std::runtime_error("two rows begin with " + first.front());
      found = &row;
    }
  if (found == nullptr) throw std::runtime_error("no row begins with " + first.front() + ", " + first.back());
  return std::stod(found->at(column));
}

/// Rows of the first table after these words of the page, cells without blanks, stars and marks of code.
Cells table_after(const std::string& file, const std::string& words) {
  const std::string page = mpm::support::read_file(MPM_SOURCE_DIR "/docs/studies/" + file);
  const std::size_t at = page.find(words);
  if (at == std::string::npos) throw std::runtime_error(file + " does not say: " + words);
  Cells table;
  std::size_t line = page.find("\n|", at);
  while (line != std::string::npos && page.compare(line + 1, 1, "|") == 0) {
    const std::size_t end = page.find('\n', line + 1);
    std::vector<std::string> cells;
    for (std::size_t bar = line + 1, next; (next = page.find('|', bar + 1)) < end; bar = next)
      cells.push_back(std::regex_replace(page.substr(bar + 1, next - bar - 1), std::regex("^ +| +$|[*`]"), ""));
    table.push_back(cells);
    line = end;
  }
  return table;
}

/// Size of the errors' cell: 1/32 m and the like, as the figures write it.
double error_at(const Cells& cells, const std::string& shape, const std::string& transfer, const std::string& size) {
  return value(cells, {"shape: " + shape, transfer, "computed", size}, 4);
}

Approx printed(const std::string& cell) {
  return printed_number(cell).rounded();
}

}  // namespace

TEST_CASE("the table of the impact is the figure's", "[docs]") {
  const Page page("docs/studies/disc_impact.md");
  const Cells cells = figure("disc_impact");
  struct Row {
    std::string text;                  ///< row of the page, a # for each number
    std::vector<std::string> schemes;  ///< scheme and column of each #, up to those that are published
    std::vector<std::string> contacts;
  };
  const std::string one = "one field", two = "two fields";
  const std::vector<Row> rows{
      {"| FLIP | # % | **# %** |", {"FLIP", "FLIP"}, {one, two}},
      {"| FLIP, USF · USAVG · MUSL | # · # · # % | # · # · # % |",
       {"FLIP, USF", "FLIP, USAVG", "FLIP, MUSL", "FLIP, USF", "FLIP, USAVG", "FLIP, MUSL"},
       {one, one, one, two, two, two}},
      {"| FLIP with 1 % PIC | # % | # % |", {"FLIP, 1 % PIC", "FLIP, 1 % PIC"}, {one, two}},
      {"| AFLIP, ASFLIP, 1 % PIC | #, # % | #, # % |",
       {"AFLIP, 1 % PIC", "ASFLIP, 1 % PIC", "AFLIP, 1 % PIC", "ASFLIP, 1 % PIC"},
       {one, one, two, two}},
      {"| APIC, MLS, TPIC | #, #, # % | #, #, # % |",
       {"APIC", "MLS", "TPIC", "APIC", "MLS", "TPIC"},
       {one, one, one, two, two, two}},
      {"| RPIC | # % | # % |", {"RPIC", "RPIC"}, {one, two}},
      {"| PIC = FMPM(1) | # % | **# %** |", {"PIC", "PIC"}, {one, two}},
      {"| FMPM(2), (3) | #, # % | #, # % |", {"FMPM(2)", "FMPM(3)", "FMPM(2)", "FMPM(3)"}, {one, one, two, two}},
      {"| FMPM(4) | # % | # % |", {"FMPM(4)", "FMPM(4)"}, {one, two}},
      {"| FMPM(8) | # % | **# %** |", {"FMPM(8)", "FMPM(8)"}, {one, two}},
      {"| FMPM(16) | # % | **# %** |", {"FMPM(16)", "FMPM(16)"}, {one, two}},
      {"| XPIC(2), XPIC(4) | #, # % | #, # % |", {"XPIC(2)", "XPIC(4)", "XPIC(2)", "XPIC(4)"}, {one, one, two, two}}};
  for (const Row& row : rows) {
    INFO(row.text);
    const auto numbers = page.read(row.text);
    REQUIRE(numbers.size() == row.schemes.size());
    for (std::size_t k = 0; k < numbers.size(); ++k)
      CHECK(value(cells, {row.schemes[k], row.contacts[k]}, 2) == numbers[k].rounded());
  }
  // Against the published numbers stands the column of two fields, for every scheme.
  for (const std::string scheme : {"FLIP", "PIC", "FMPM(8)", "FMPM(16)"}) {
    INFO(scheme);
    const auto numbers = page.read("| " + scheme + " | # % | # % | # |");
    const double here = value(cells, {scheme, two}, 2);
    CHECK(here == numbers[0].rounded());
    CHECK(numbers[0].value - numbers[1].value == numbers[2].rounded());
  }
}

TEST_CASE("the table of what moves the impact's losses is the figure's", "[docs]") {
  const Cells table = table_after("disc_impact.md", "Energy lost with one thing changed at a time"),
              cells = figure("disc_impact_contact");
  const std::map<std::string, std::string> name{
      {"nothing", "nothing"},
      {"both discs a quarter of a cell further", "a quarter of a cell further"},
      {"normal by logistic regression", "logistic regression"},
      {"float", "float"},
      {"twice the step", "twice the step"}};
  REQUIRE(table.size() == 2 + name.size());
  for (std::size_t row = 2; row < table.size(); ++row)
    for (std::size_t k = 1; k < table[0].size(); ++k) {
      INFO(table[row][0] << ", " << table[0][k]);
      if (table[row][k] == "inverts")
        CHECK_THROWS(value(cells, {name.at(table[row][0]), table[0][k]}, 2));
      else
        CHECK(value(cells, {name.at(table[row][0]), table[0][k]}, 2) == printed(table[row][k]));
    }
}

TEST_CASE("the table of curved bodies in contact is the figure's", "[docs]") {
  const Page page("docs/contact.md");
  const Cells cells = figure("curved_contact");
  for (const std::string grid :
       {"10 cells, 4 a cell", "20 cells, 2 a cell", "10 cells, 8 a cell", "20 cells, 4 a cell", "40 cells, 2 a cell"}) {
    INFO(grid);
    double least = 10, largest = 0, mean = 0;
    int count = 0;
    for (const auto& row : cells)
      if (row.size() > 4 && row[0] == "grid: " + grid && row[2] == "computed") {
        const double force = std::stod(row[4]);
        least = smaller(least, force), largest = larger(largest, force), mean += force / 8, ++count;
      }
    REQUIRE(count == 8);
    const bool coarse = grid == "10 cells, 4 a cell" || grid == "20 cells, 2 a cell";
    const auto numbers = page.read("| " + grid + (coarse ? " | 25 mm" : " | 12.5 mm") + " | # | # | # |");
    CHECK(least == numbers[0].rounded());
    CHECK(largest == numbers[1].rounded());
    CHECK(mean == numbers[2].rounded());
  }
}

TEST_CASE("the table of locking is the figure's", "[docs]") {
  const Page page("docs/method.md");
  const Cells cells = figure("locking");
  for (const std::string shape : {"linear", "gimp", "cpdi", "bspline_quadratic"})
    for (const std::string dilation : {"own", "averaged"}) {
      const auto numbers =
          page.read("| `" + shape + (dilation == "own" ? "`, its own" : "`, averaged") + " | # | # | # | # | # |");
      std::size_t column = 0;
      for (const char* nu : {"0.40000000000000002", "0.20000000000000001", "0.10000000000000001", "0.02", "0.002"}) {
        INFO(shape << ", " << dilation << ", 1 - 2 nu = " << nu);
        CHECK(value(cells, {"shape: " + shape, dilation, "computed", nu}, 4) == numbers[column++].rounded());
      }
    }
}

TEST_CASE("the table of the ledger's errors is the figures'", "[docs]") {
  const std::map<std::string, std::string> figures{
      {"scatter", "scatter"},       {"gather", "gather"},    {"internal force", "internal_force"},
      {"contact", "contact_work"},  {"filter", "filter"},    {"boundary", "boundary"},
      {"plasticity", "plasticity"}, {"residual", "residual"}};
  const Cells table = table_after("ledger.md", "differences from N = 1");
  REQUIRE(table.size() == 23);
  REQUIRE(table[0] == std::vector<std::string>{"", "exact", "N = 2", "5", "10", "20", "50"});
  std::string scene;
  for (std::size_t row = 2; row < table.size(); ++row) {
    std::string cause = table[row][0];
    if (const std::size_t colon = cause.find(": "); colon != std::string::npos)
      scene = cause.substr(0, colon), cause = cause.substr(colon + 2);
    INFO(scene << ": " << cause);
    const Cells cells = figure("ledger_" + figures.at(cause));
    const double exact = value(cells, {scene, "N = 1"}, 2);
    CHECK(exact == printed(table[row][1]));
    for (std::size_t k = 2; k < 7; ++k) {
      const std::string every = k == 2 ? "N = 2" : "N = " + table[0][k];
      INFO(every);
      CHECK(value(cells, {scene, every}, 2) - exact == printed(table[row][k]));
    }
  }
}

TEST_CASE("the table of the position updates is the figures'", "[docs]") {
  const Cells one = figure("position_update_one_field"), two = figure("position_update");
  const Cells table = table_after("position_update.md", "lost in %:");
  REQUIRE(table.size() == 8);
  for (std::size_t row = 2; row < table.size(); ++row) {
    INFO(table[row][0]);
    std::size_t column = 0;
    for (const Cells* cells : {&one, &two})
      for (const std::string update : {"new_velocity", "mean_velocity"})
        CHECK(value(*cells, {table[row][0], update}, 2) == printed(table[row][++column]));
  }
  // The order that the figure's line has.
  const Cells wave = figure("position_update_wave");
  const auto slope = [&](const std::string& update) {
    const std::vector<std::string> line{"filter: FMPM(4)", update, "computed"};
    double x[2], y[2];
    int k = 0;
    for (const std::string step : {"0.0001", "6.2500000000000003e-06"}) {
      std::vector<std::string> first = line;
      first.push_back(step);
      x[k] = std::log(std::stod(step)), y[k++] = std::log(value(wave, first, 4));
    }
    return (y[0] - y[1]) / (x[0] - x[1]);
  };
  CHECK(std::abs(slope("new_velocity") - 2) < 0.1);
  CHECK(std::abs(slope("mean_velocity") - 1) < 0.02);
}

TEST_CASE("the table of the stress updates is the figure's", "[docs]") {
  const Page page("docs/studies/stress_update.md");
  const Cells cells = figure("stress_update_drift_1");
  const std::vector<std::string> updates{"USF", "USL", "MUSL", "USAVG"};
  for (const auto& [written, layout] :
       {std::pair{"linear, 1 a cell", "linear, 1 a cell"}, std::pair{"linear, 4 a cell", "linear, 4 a cell"},
        std::pair{"quadratic B-spline, 4 a cell", "quadratic, 4 a cell"}}) {
    const auto numbers = page.read(std::string("| FLIP, ") + written + " | # % | # % | # % | # % |");
    for (std::size_t k = 0; k < updates.size(); ++k)
      CHECK(value(cells, {layout, updates[k]}, 2) == numbers[k].rounded());
  }
}

TEST_CASE("the table of particles a cell is the figure's", "[docs]") {
  const Page page("docs/studies/particles_per_cell.md");
  const Cells cells = figure("particles_per_cell");
  const std::map<std::string, std::string> rows{{"linear", "linear"},
                                                {"GIMP", "gimp"},
                                                {"quadratic B-spline", "bspline_quadratic"},
                                                {"cubic B-spline", "bspline_cubic"},
                                                {"CPDI", "cpdi"}};
  for (const auto& [written, shape] : rows) {
    INFO(written);
    const auto numbers = page.read("| " + written + " | # % | # % | # % | # % | # % |");
    for (std::size_t k = 0; k < numbers.size(); ++k)
      CHECK(100 * value(cells, {"shape: " + shape, "16 cells", "computed", std::to_string(k + 1)}, 4) ==
            numbers[k].rounded());
  }
}

TEST_CASE("the orders of convergence are the slopes of the figures' lines", "[docs]") {
  const std::string page = "convergence.md";
  const std::map<std::string, std::string> tables{
      {"no particle crosses a cell:\n", "manufactured_order_no_crossing_transfers"},
      {"particles cross up to 1.6 cells:\n", "manufactured_order_crossing_transfers"},
      {"G = 0.1, at t = T/2:\n", "vortex_small_twist_transfers"},
      {"G = 1, at t = T/5:\n", "vortex_large_twist_transfers"}};
  for (const auto& [words, name] : tables) {
    const Cells table = table_after(page, words), cells = figure(name);
    REQUIRE(table.size() == 10);  // names, a line, eight shapes
    for (std::size_t row = 2; row < table.size(); ++row)
      for (std::size_t column = 1; column <= 10; ++column) {
        const std::string shape = table[row][0],
                          transfer = table[0][column] == "polypic, full" ? "polypic full" : table[0][column];
        INFO(name << ", " << shape << ", " << transfer);
        const auto error = [&](const std::string& size) {
          return value(cells, {"transfer: " + transfer, shape, "computed", size}, 4);
        };
        if (table[row][column] == "stops" || table[row][column] == "–")
          CHECK_THROWS(error("0.03125"));
        else
          CHECK(std::log2(error("0.0625") / error("0.03125")) == printed(table[row][column]));
      }
  }
  const Cells period = table_after(page, "Observed orders between 16 and 24 cells:\n");
  REQUIRE(period.size() == 10);
  for (std::size_t row = 2; row < period.size(); ++row)
    for (int column = 1; column <= 4; ++column) {
      const Cells cells = figure(column <= 2 ? "manufactured_period_small" : "manufactured_period_large");
      const std::string transfer = column % 2 == 1 ? "apic" : "aflip";
      INFO(period[row][0] << ", " << column << ", " << transfer);
      const double order = std::log(error_at(cells, period[row][0], transfer, "0.0625") /
                                    error_at(cells, period[row][0], transfer, "0.041666666666666664")) /
                           std::log(1.5);
      CHECK(order == printed(period[row][column]));
    }
}

TEST_CASE("the orders to 128 cells are the slopes of the figure's lines", "[docs]") {
  const Cells table = table_after("convergence.md", "### To 128 cells"), cells = figure("manufactured_fine");
  const std::vector<std::string> sizes{"0.0625", "0.03125", "0.015625", "0.0078125"};
  REQUIRE(table.size() == 8);  // names, a line, three schemes in two ways
  for (std::size_t row = 2; row < table.size(); ++row) {
    INFO(table[row][0] << ", " << table[row][1]);
    const std::string places =
        table[row][1] == "lattice" ? "on a lattice" : "shifted at random by up to a quarter of their spacing";
    std::vector<double> errors;
    for (const std::string& size : sizes)
      errors.push_back(value(cells, {"particles: " + places, table[row][0], "computed", size}, 4));
    for (std::size_t k = 0; k < 3; ++k) CHECK(std::log2(errors[k] / errors[k + 1]) == printed(table[row][2 + k]));
    CHECK(100 * errors.back() / 0.05 == printed(table[row][5]));  // of the amplitude
    if (table[row][1] != "lattice" || table[row][0].starts_with("quadratic")) continue;
    const Page page("docs/studies/convergence.md");
    const auto spread = page.read("over the last three grids at orders of # ± # and # ± #");
    const std::size_t first = table[row][0].starts_with("cpdi") ? 0 : 2;
    const double before = std::log2(errors[1] / errors[2]), last = std::log2(errors[2] / errors[3]);
    CHECK(0.5 * (before + last) == spread[first].rounded());
    CHECK(0.5 * std::abs(before - last) == spread[first + 1].rounded());
  }
}

TEST_CASE("the orders with their spread are the slopes of the figures' lines", "[docs]") {
  struct Table {
    std::string words, figure, panels;
    std::vector<std::string> sizes;
    std::size_t rows;
  };
  for (const Table& now : {Table{"**It is the rim.**",
                                 "manufactured_turned_rim",
                                 "particles: ",
                                 {"0.0625", "0.03125", "0.015625", "0.0078125"},
                                 8},
                           Table{"### Turned against the grid",
                                 "manufactured_turned",
                                 "axes of the wave: ",
                                 {"0.0625", "0.03125", "0.015625", "0.0078125", "0.00390625"},
                                 8},
                           Table{"**Volumes of their own.**",
                                 "manufactured_places",
                                 "seeding: ",
                                 {"0.0625", "0.03125", "0.015625", "0.0078125", "0.00390625"},
                                 8},
                           Table{"**CPDI on the same places**",
                                 "manufactured_places_cpdi",
                                 "seeding: ",
                                 {"0.0625", "0.03125", "0.015625", "0.0078125"},
                                 5},
                           Table{"In 3-D, on 24, 48 and 96 cells",
                                 "manufactured_turned_3d",
                                 "axes of the wave: ",
                                 {"0.041666666669999998", "0.020833333329999999", "0.01041666667"},
                                 6}}) {
    const Cells table = table_after("convergence.md", now.words), cells = figure(now.figure);
    REQUIRE(table.size() == now.rows);
    for (std::size_t row = 2; row < table.size(); ++row) {
      INFO(now.words << ": " << table[row][0] << ", " << table[row][1]);
      const std::string axes = table[row][1] == "turned" ? "turned by 30 degrees" : table[row][1];
      std::vector<double> errors, orders;
      // A figure of one shape alone names its line by what it shows.
      const bool is_alone = now.figure == "manufactured_places_cpdi";
      const std::string line = is_alone ? "position error over the amplitude" : table[row][0];
      for (const std::string& size : now.sizes)
        errors.push_back(value(cells, {now.panels + axes, line, "computed", size}, 4));
      for (std::size_t k = 0; k + 1 < errors.size(); ++k) {
        orders.push_back(std::log2(errors[k] / errors[k + 1]));
        CHECK(orders.back() == printed(table[row][2 + k]));
      }
      const double amplitude = now.figure.starts_with("manufactured_places") ? 1 : 0.05;  // these are over it
      CHECK(100 * errors.back() / amplitude == printed(table[row].back()));
      const std::string& spread = table[row][table[row].size() - 2];  // of the last three grids
      const std::size_t sign = spread.find(" ± ");
      REQUIRE(sign != std::string::npos);
      const double before = orders[orders.size() - 2], last = orders.back();
      CHECK(0.5 * (before + last) == printed(spread.substr(0, sign)));
      CHECK(0.5 * std::abs(before - last) == printed(spread.substr(sign + 4)));
    }
  }
}

TEST_CASE("what random places add to the error is read from the figure", "[docs]") {
  const Cells table = table_after("convergence.md", "### Particles in random places"),
              cells = figure("manufactured_random");
  REQUIRE(table.size() == 6);
  const std::map<std::string, std::string> labels{
      {"none", "on a lattice"}, {"1/16", "shifted by up to 1/16 of their spacing"}, {"1/8", "1/8"}, {"1/4", "1/4"}};
  const auto error = [&](const std::string& particles, const std::string& shift) {
    return 100 * value(cells, {"particles a cell and axis: " + particles, labels.at(shift), "computed", "0.015625"}, 4);
  };
  for (std::size_t row = 2; row < table.size(); ++row) {
    INFO(table[row][0]);
    CHECK(error("2", table[row][0]) == printed(table[row][1]));
    CHECK(error("4", table[row][0]) == printed(table[row][2]));
  }
  const auto added = [&](const std::string& particles, const std::string& shift) {
    return std::sqrt(std::pow(error(particles, shift), 2) - std::pow(error(particles, "none"), 2));
  };
  const Page page("docs/studies/convergence.md");
  const auto by_two = page.read("is #, # and # % with 2 particles an axis");
  CHECK(added("2", "1/16") == by_two[0].rounded());
  CHECK(added("2", "1/8") == by_two[1].rounded());
  CHECK(added("2", "1/4") == by_two[2].rounded());
  CHECK(added("4", "1/4") == page.read("an axis it is # % for the largest").front().rounded());
}

TEST_CASE("what limits the convergence is read from the figure", "[docs]") {
  const Cells table = table_after("convergence.md", "### What limits it"), cells = figure("manufactured_limits");
  REQUIRE(table.size() == 5);
  for (std::size_t row = 2; row < table.size(); ++row)
    for (const auto& [column, refined] :
         {std::pair{1, "nothing"}, std::pair{2, "particles: 4 a cell and axis"}, std::pair{3, "step: a quarter"}}) {
      INFO(table[row][0] << ", " << refined);
      const std::string panel = "shape and transfer: " + table[row][0];
      const double coarse = value(cells, {panel, refined, "computed", "0.03125"}, 4),
                   fine = value(cells, {panel, refined, "computed", "0.015625"}, 4);
      const std::size_t blank = table[row][column].find(' ');
      CHECK(100 * fine / 0.05 == printed(table[row][column].substr(0, blank)));
      CHECK(std::log2(coarse / fine) == printed(table[row][column + 3]));
    }
}

TEST_CASE("the studies that say so take steps of a tenth of the estimate", "[docs]") {
  for (const std::string name : {"transfer_trade", "manufactured_order", "manufactured_fine", "particles_per_cell"}) {
    const mpm::study::Study study = mpm::study::read_study(MPM_SOURCE_DIR "/experiments/studies/" + name + ".json");
    INFO(name << ": " << study.note);
    CHECK(study.note.find(
              "steps of a tenth of the estimate h / (wave speed + particle speed), a third of the automatic") !=
          std::string::npos);
    const mpm::study::Axis* grids = nullptr;
    for (const auto& axis : study.axes)
      for (const std::string& pointer : axis.pointers)
        if (pointer == "/solver/time_step") grids = &axis;
    REQUIRE(grids != nullptr);
    for (const auto& grid : grids->choices) {
      INFO(grid.label);
      const auto first_step = [&](const std::vector<std::string>& more) {
        std::vector<std::string> overrides = grid.overrides;
        overrides.insert(overrides.end(), more.begin(), more.end());
        Scene scene(mpm::support::read_file(study.base), overrides);
        scene.run_steps(1);
        return scene.simulation.time();
      };
      const double taken = first_step({});
      CHECK(taken / first_step({"/solver/time_step=auto", "/solver/courant=0.1"}) == Approx(1.1).margin(0.15));
      CHECK(taken / first_step({"/solver/time_step=auto"}) == Approx(1. / 3).margin(0.05));
      const bool says = study.note.find("(all of it with linear shape functions)") != std::string::npos;
      CHECK(says == (name != "manufactured_fine"));
      if (says) CHECK(taken / first_step({"/solver/time_step=auto", "/shape/type=linear"}) == Approx(1.1).margin(0.15));
    }
  }
}

namespace {

/// Compares a table of targets, the cheapest of all runs and the cheapest of some with the figure's points.
void check_cheapest(const Cells& points, const Cells& table, const std::function<bool(const std::string&)>& is_one_of) {
  const auto cheapest = [&](double error, bool all) {
    const std::vector<std::string>* best = nullptr;
    for (const auto& row : points)
      if (row[1] == "point" && std::stod(row[3]) <= error && (all || is_one_of(row[6])) &&
          (best == nullptr || std::stod(row[2]) < std::stod(best->at(2))))
        best = &row;
    return best;
  };
  const std::regex last_error(".*: ([0-9.]+) %");
  for (std::size_t row = 2; row < table.size(); ++row) {
    INFO("target " << table[row][0]);
    const double target = std::stod(table[row][0]) / 100;
    for (const std::size_t column : {1, 3}) {
      const auto* best = cheapest(target, column == 1);
      if (table[row][column] == "none") {
        CHECK(best == nullptr);
        continue;
      }
      REQUIRE(best != nullptr);
      INFO(best->at(6));
      CHECK(std::stod(best->at(2)) == printed(table[row][column + 1]));
      std::smatch error;
      if (std::regex_match(table[row][column], error, last_error))
        CHECK(100 * std::stod(best->at(3)) == printed(error[1]));
      else
        CHECK(table[row][column] == "the same");
    }
  }
}

bool has_no_filter(const std::string& run) {
  return run.find(", none, ") != std::string::npos;
}

}  // namespace

TEST_CASE("the table of the trade at the largest steps names the cheapest runs of its figure", "[docs]") {
  const Cells points = figure("transfer_trade_largest_pareto_flops");
  const Cells table = table_after("transfer_trade.md", "## At the largest stable step");
  REQUIRE(table.size() == 9);
  check_cheapest(points, table, [](const std::string& run) {
    return !has_no_filter(run) && run.find("every 4 steps") == std::string::npos;
  });
  const Page page("docs/studies/transfer_trade.md");
  std::size_t runs = 0;
  for (const auto& row : points) runs += row[1] == "point";
  CHECK(static_cast<double>(runs) == page.read("Error against operations of # runs, each at its").front().rounded());

  const auto shares = page.read("FMPM(4) stands # to # times the step of PIC alone, FMPM(8) # to # times");
  std::map<std::string, double> of_pic;
  std::map<std::string, std::pair<double, double>> range{{"FMPM(4)", {9, 0}}, {"FMPM(8)", {9, 0}}};
  for (const auto& row : figure("transfer_trade_largest_step")) {
    if (row[2].empty() || row[0] == "shape") continue;
    if (row[1] == "none") of_pic[row[0]] = std::stod(row[2]);
    if (!range.count(row[1])) continue;
    auto& [least, most] = range[row[1]];
    const double share = std::stod(row[2]) / of_pic.at(row[0]);
    least = smaller(least, share), most = larger(most, share);
  }
  CHECK(range["FMPM(4)"].first == shares[0].rounded());
  CHECK(range["FMPM(4)"].second == shares[1].rounded());
  CHECK(range["FMPM(8)"].first == shares[2].rounded());
  CHECK(range["FMPM(8)"].second == shares[3].rounded());
}

TEST_CASE("the short table of the trade names the cheapest runs of its figure", "[docs]") {
  const Cells points = figure("transfer_trade_pareto_flops"), table = table_after("transfer_trade.md", "### In short");
  REQUIRE(table.size() == 10);  // names, a line, eight targets
  check_cheapest(points, table, has_no_filter);
}

TEST_CASE("what advice answers on the page of the trade is in its figure", "[docs]") {
  Cells points = figure("transfer_trade_pareto_flops");
  points.erase(points.begin());
  const std::string page = mpm::support::read_file(MPM_SOURCE_DIR "/docs/studies/transfer_trade.md");
  const auto three_digits = [](const std::string& number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", std::stod(number));
    return std::string(text);
  };
  const std::regex answer(
      "(?:take|next:| {5}) ([a-z0-9_]+, [^:\n]+): position error over the amplitude ([0-9.e-]+)(?:, floating-point "
      "operations ([0-9.e+]+))?");
  int answers = 0, ranked = 0;
  double before = 0;
  for (std::sregex_iterator found(page.begin(), page.end(), answer), end; found != end; ++found, ++answers) {
    INFO(found->str());
    const auto point =
        std::find_if(points.begin(), points.end(), [&](const auto& row) { return row[6] == (*found)[1]; });
    REQUIRE(point != points.end());
    CHECK(three_digits(point->at(3)) == (*found)[2]);
    if (!(*found)[3].matched) continue;
    CHECK(three_digits(point->at(2)) == (*found)[3]);
    const double cost = std::stod(point->at(2));  // the next in the order of those that reach 1 %
    CHECK(std::count_if(points.begin(), points.end(), [&](const auto& row) {
            return std::stod(row[3]) <= 0.01 && std::stod(row[2]) > before && std::stod(row[2]) <= cost;
          }) == 1);
    before = cost;
    ++ranked;
  }
  CHECK(answers == 8);
  CHECK(ranked == 4);
  const auto reach =
      std::count_if(points.begin(), points.end(), [](const auto& row) { return std::stod(row[3]) <= 0.01; });
  CHECK(page.find("of at most 1%; " + std::to_string(reach) + " of " + std::to_string(points.size()) + " measured") !=
        std::string::npos);
}

TEST_CASE("the table of what a spinning disc loses is the figures'", "[docs]") {
  const Cells table = table_after("spin.md", "Lost in three turns"), curves = figure("spin"),
              energies = figure("spin_energy");
  const auto lost = [&](const std::string& cells, const std::string& scheme) {
    double first = std::nan(""), last = first;
    for (const auto& row : curves)
      if (row.size() > 4 && row[0] == "cell size h: " + cells + " cells across" && row[1] == scheme) {
        if (std::isnan(first)) first = std::stod(row[4]);
        last = std::stod(row[4]);
      }
    return 100 * (1 - last / first);
  };
  int compared = 0;
  for (const auto& row : table)
    for (const auto& [name, scheme] : {std::pair<std::string, std::string>{"FLIP", "FLIP"},
                                       {"FLIP with 1 % PIC", "FLIP, 1 % PIC"},
                                       {"FMPM(4)", "FMPM(4)"},
                                       {"FMPM(2)", "FMPM(2)"},
                                       {"XPIC(2)", "XPIC(2)"},
                                       {"PIC", "PIC"}}) {
      if (row[0] != name) continue;
      INFO(scheme);
      const auto number = [](const std::string& cell) { return printed(cell.substr(0, cell.find(' '))); };
      CHECK(lost("10", scheme) == number(row[1]));
      CHECK(lost("20", scheme) == number(row[2]));
      CHECK(value(energies, {scheme, "bspline_quadratic"}, 2) == number(row[3]));
      ++compared;
    }
  CHECK(compared == 6);
}

TEST_CASE("the table of the precisions is the figures'", "[docs]") {
  const Cells table = table_after("precision.md", "By how much float changes the error"),
              positions = figure("precision_long"), velocities = figure("precision_long_velocity");
  REQUIRE(table.size() == 6);
  const std::map<std::string, std::string> shapes{{"quadratic B-spline", "bspline_quadratic"}, {"CPDI", "cpdi"}};
  const std::regex name("(.*), (\\d+ cells), .*"), number("[0-9]·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+");
  for (std::size_t row = 2; row < table.size(); ++row) {
    INFO(table[row][0]);
    std::smatch parts;
    REQUIRE(std::regex_match(table[row][0], parts, name));
    const std::string panel = "shape: " + shapes.at(parts[1]), grid = parts[2];
    for (const std::size_t column : {1, 2}) {
      const Cells& cells = column == 1 ? positions : velocities;
      const std::string& changes = table[row][column];
      std::sregex_iterator change(changes.begin(), changes.end(), number);
      for (const char* periods : {"0.5", "5", "50"}) {
        INFO(table[0][column] << ", " << periods << " periods");
        const double full = value(cells, {panel, "double, " + grid, "computed", periods}, 4),
                     half = value(cells, {panel, "float, " + grid, "computed", periods}, 4);
        REQUIRE(change != std::sregex_iterator());
        CHECK(std::abs(half / full - 1) == printed((*change++)[0]));
      }
    }
  }
}

TEST_CASE("what is said of noise that no node sees is read from the figures", "[docs]") {
  const Page page("docs/studies/null_space.md");
  const Cells wave = figure("null_space"), shapes = figure("null_space_shapes");
  const auto noisy = [&](const std::string& scheme) { return value(wave, {scheme, "wave with noise"}, 2); };
  const auto clean = [&](const std::string& scheme) { return value(wave, {scheme, "wave without noise"}, 2); };
  const auto compare = [&](const std::string& words, const std::vector<double>& found) {
    INFO(words);
    const auto numbers = page.read(words);
    REQUIRE(numbers.size() == found.size());
    for (std::size_t k = 0; k < found.size(); ++k) CHECK(found[k] == numbers[k].rounded());
  };
  compare("FLIP ends with the noise it was given (# %), and makes noise of its own: # %",
          {noisy("FLIP"), clean("FLIP")});
  compare("halves the harm (# against # %) but 5 % of PIC damps the wave more than the noise did (# %)",
          {noisy("FLIP, 1 % PIC"), clean("FLIP, 1 % PIC"), noisy("FLIP, 5 % PIC")});
  compare("forget it at once and err by # to # %. PIC and RPIC forget the wave too (# %:",
          {noisy("MLS"), noisy("TPIC"), noisy("PIC")});
  compare("and makes # % by itself; FMPM(4) at every step makes # %, and # % on CPDI",
          {clean("FLIP, FMPM(4) every 10 steps"), clean("FMPM(4)"), value(shapes, {"FMPM(4)", "cpdi"}, 2)});
  compare("errs more than XPIC(2) on B-splines (# and # %)", {noisy("XPIC(5)"), noisy("XPIC(2)")});
  compare("FMPM(4) on CPDI errs by # % where APIC errs by # %",
          {value(shapes, {"FMPM(4)", "cpdi"}, 2), value(shapes, {"APIC", "cpdi"}, 2)});
  for (const char* scheme : {"APIC", "PolyPIC"}) {
    INFO(scheme);
    CHECK(noisy(scheme) > noisy("MLS"));
    CHECK(noisy(scheme) < noisy("TPIC"));
  }
}

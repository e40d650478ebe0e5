// The automatic step knows what a combination stands: its limit against the study's measured largest steps, and runs of
// the study's scenes at the default `courant` and at the largest one that may be asked for. `ctest -V` shows tables.

#include <fstream>
#include <map>
#include <sstream>

#include "shipped.hpp"
#include "support/catch.hpp"
#include "support/csv.hpp"
#include "support/energies.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A transfer and a filter, as the studies name them.
struct Scheme {
  const char *name, *transfer, *filter;
};
constexpr const char *fmpm = R"({"type": "fmpm", "order": 4})", *xpic = R"({"type": "xpic", "order": 4})";
constexpr Scheme schemes[] = {{"PIC", "pic", ""},       {"FLIP", "flip", ""},    {"AFLIP", "aflip", ""},
                              {"ASFLIP", "asflip", ""}, {"APIC", "apic", ""},    {"MLS", "mls", ""},
                              {"TPIC", "tpic", ""},     {"RPIC", "rpic", ""},    {"PolyPIC", "polypic", ""},
                              {"FMPM(4)", "pic", fmpm}, {"XPIC(4)", "pic", xpic}};
const std::vector<std::string> updates{"last", "first", "modified_last", "averaged"};

/// The settings of the studies largest_step.json and largest_step_3d.json, with the automatic step.
std::vector<std::string> settings(int dimension, const std::string& shape, const Scheme& scheme,
                                  const std::string& update, double courant) {
  std::vector<std::string> all{set("/shape/type", shape), set("/solver/stress_update", update),
                               set("/solver/courant", digits(courant)), set("/solver/time_step", "\"auto\"")};
  const std::string basis = std::string(scheme.transfer) == "polypic" ? R"(, "basis": "multilinear")" : "";
  all.push_back(set("/transfer", R"({"type": ")" + std::string(scheme.transfer) + '"' + basis + "}"));
  if (*scheme.filter) all.push_back(set("/filter", scheme.filter));
  if (dimension == 3)
    for (const char* body : {"0", "1"})
      all.push_back(set("/bodies/" + std::string(body) + "/particles_per_cell_axis", "2"));
  else
    all.insert(all.end(), {set("/grid/cell_size", "0.05"), set("/solver/end_time", "3")});
  return all;
}
std::string scene_of(int dimension) {
  return dimension == 2 ? "lessons/two_discs_one_field.json" : "extremes/two_balls_scene.json";
}
bool is_refused(const std::string& shape, const Scheme& scheme) {
  return std::string(scheme.transfer) == "polypic" && shape.starts_with("cpdi");
}

/// The Courant number of a step that is taken where nothing limits it but waves.
double courant_of(const Experiment& experiment) {
  constexpr double speed = 1;
  return solver_of(experiment).limit(experiment, {speed}).seconds * speed / experiment.grid.cell_size;
}

/// Runs to the end. Returns the largest energy over the first, less 1, of energies at one time; infinity where the run
/// stops.
double gain_of(const std::string& path, const std::vector<std::string>& overrides, const std::string& update) {
  ShippedScene scene(path, overrides);
  std::vector<double> kinetic{scene.metrics.initial().kinetic}, strain{scene.metrics.initial().strain};
  scene.run([&] {
    const Totals now = scene.metrics.measure();
    kinetic.push_back(now.kinetic), strain.push_back(now.strain);
    REQUIRE(std::isfinite(now.kinetic + now.strain));
  });
  const double first = kinetic[0] + strain[0];
  double gain = 0;
  for (const double total : energies_at_one_time(kinetic, strain, update)) gain = larger(gain, total / first - 1);
  return scene.failure.empty() ? gain : INFINITY;
}
constexpr double bounded = 0.01;  ///< the most that a run gains which is called bounded

void check_bounded(int dimension, const std::string& shape, const Scheme& scheme, const std::string& update,
                   double courant) {
  if (is_refused(shape, scheme)) return;
  INFO(dimension << "-D " << shape << " " << scheme.name << " " << update << ", courant " << courant);
  CHECK(gain_of(scene_of(dimension), settings(dimension, shape, scheme, update, courant), update) <= bounded);
}

const std::vector<std::string> smooth{"gimp", "gimp_contiguous", "b2gimp", "bspline_quadratic", "bspline_cubic", "cpdi",
                                      "cpdi2"};

struct Row {
  std::string shape, scheme;
  double largest;
};
/// What the study measured: shape, scheme, largest stable step over h / (wave speed + particle speed).
std::vector<Row> measured(const std::string& name) {
  std::ifstream file(MPM_SOURCE_DIR "/figures/studies/" + name + ".csv");
  std::vector<Row> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::stringstream columns(line);
    Row row{};
    std::string number;
    std::getline(columns, row.shape, ',');
    if (columns.peek() == '"')
      columns.get(), std::getline(columns, row.scheme, '"'), columns.get();
    else
      std::getline(columns, row.scheme, ',');
    std::getline(columns, number, ',');
    if (number.empty() || row.shape == "linear") continue;
    row.largest = std::stod(number);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

namespace {

// With FMPM(4) the limit of the shape is halved, as always; where a filter is refused or a run of the study is missing
// there is no row.
void check_limits_by_usl(int dimension, const std::string& study, double within) {
  const std::vector<Row> rows = measured(study);
  REQUIRE(rows.size() > 50);
  std::printf("Largest Courant number in %d-D: measured, limit of the automatic step\n", dimension);
  for (const Row& row : rows)
    for (const Scheme& scheme : schemes)
      if (row.scheme == scheme.name) {
        const double limit =
            courant_of(shipped(scene_of(dimension), settings(dimension, row.shape, scheme, "last", 2)));
        std::printf("  %-18s%-8s %.3f %.3f\n", row.shape.c_str(), scheme.name, row.largest, limit);
        INFO(row.shape << " " << scheme.name << ": measured " << row.largest << ", limit " << limit);
        CHECK(limit <= row.largest);
        CHECK(limit * within >= row.largest);
      }
}

}  // namespace

TEST_CASE("in 2-D by USL the study's largest steps are 1 to 1.5 times the limit of the step", "[largest_step]") {
  check_limits_by_usl(2, "largest_step", 1.5);
}

TEST_CASE("in 3-D by USL the study's largest steps are 1 to 1.8 times the limit of the step", "[largest_step]") {
  check_limits_by_usl(3, "largest_step_3d", 1.8);
}

// The half step by which USAVG strains ahead lets FLIP stand more than with USL; its limit is that of the column for the
// grid's velocity, which is not raised for one order alone (docs/method.md, "The time step").
TEST_CASE("in 2-D by USAVG with FLIP the study's largest steps are 1 to 2 times the limit", "[largest_step]") {
  int rows = 0;
  for (const Row& row : measured("largest_step"))
    if (row.scheme == "FLIP, USAVG") {
      const double limit = courant_of(shipped(scene_of(2), settings(2, row.shape, schemes[1], "averaged", 2)));
      INFO(row.shape << ": measured " << row.largest << ", limit " << limit);
      CHECK(limit <= row.largest);
      CHECK(limit * 2 >= row.largest);
      ++rows;
    }
  CHECK(rows == 7);
}

// The study's rows in 2-D are the least of three orders, so what one of them stands may be more.
TEST_CASE("where only what particles carry strains, the study's largest steps are 1 to 1.8 times the limit",
          "[largest_step]") {
  int rows = 0;
  for (const auto& [dimension, name, these] :
       {std::tuple{2, "largest_step_orders", std::vector<std::string>{"first", "modified_last"}},
        std::tuple{3, "largest_step_orders_3d_1", std::vector<std::string>{"first"}},
        std::tuple{3, "largest_step_orders_3d_2", std::vector<std::string>{"modified_last"}}})
    for (const Row& row : measured(name))
      for (const Scheme& scheme :
           {schemes[0], schemes[7]}) {  // PIC and RPIC replace the velocity and carry no gradient
        if (row.scheme != scheme.name) continue;
        for (const std::string& update : these) {
          const double limit =
              courant_of(shipped(scene_of(dimension), settings(dimension, row.shape, scheme, update, 2)));
          INFO(dimension << "-D " << row.shape << " " << scheme.name << " " << update << ": measured " << row.largest
                         << ", limit " << limit);
          CHECK(limit <= row.largest);
          CHECK(limit * 1.8 >= row.largest);
        }
        ++rows;
      }
  CHECK(rows == 3 * 14);
}

// The study lets a gain of 10 % pass, as the energies are those of different times, and the limits are those of USL but
// where only what particles carry strains.
TEST_CASE("in 3-D by USF, MUSL and USAVG the study's largest steps are 1 to 2.6 times the limit", "[largest_step]") {
  int rows = 0;
  for (const auto& [name, update] :
       {std::pair{"largest_step_orders_3d_1", "first"}, std::pair{"largest_step_orders_3d_2", "modified_last"},
        std::pair{"largest_step_orders_3d_3", "averaged"}})
    for (const Row& row : measured(name))
      for (const Scheme& scheme : schemes) {
        if (row.scheme != scheme.name) continue;
        const double limit = courant_of(shipped(scene_of(3), settings(3, row.shape, scheme, update, 2)));
        INFO(row.shape << " " << scheme.name << " " << update << ": measured " << row.largest << ", limit " << limit);
        CHECK(limit <= row.largest);
        // USF with kept or filtered velocities is held for its energy, not for its stability: see the next case.
        const bool is_held = update == std::string("first") && (limit == Approx(0.12) || *scheme.filter);
        if (!is_held) CHECK(limit * 2.6 >= row.largest);
        ++rows;
      }
  CHECK(rows == 3 * (5 * 11 + 2 * 10));
}

// The limit of USF with kept velocities is for its energy, which FLIP gains most of: the study's largest steps, 0.77 to 1.06
// times the estimate, let ten times that gain pass.
TEST_CASE("in 3-D USF with FLIP gains at most 1 % at its limit, and more at 1.25 times that step", "[largest_step]") {
  std::printf("USF with FLIP in 3-D: shape, limit, energy gained at the limit and at 1.25 times it (%%)\n");
  double most = 0;
  for (const std::string shape : {"gimp", "bspline_quadratic", "cpdi"}) {
    std::vector<std::string> all = settings(3, shape, schemes[1], "first", 2);
    const double limit = courant_of(shipped(scene_of(3), all)), at_limit = gain_of(scene_of(3), all, "first");
    ShippedScene first(scene_of(3), all);
    first.simulation.step();
    all.push_back(set("/solver/time_step", digits(1.25 * first.simulation.last_time_step())));
    const double longer = gain_of(scene_of(3), all, "first");
    std::printf("  %-18s%.3f %.3f %.3f\n", shape.c_str(), limit, 100 * at_limit, 100 * longer);
    INFO(shape);
    CHECK(limit == Approx(0.12));
    CHECK(at_limit <= bounded);
    most = larger(most, longer);
  }
  CHECK(most > bounded);
}

TEST_CASE("every material stands its whole estimate wherever it stands any step, as the studies found",
          "[largest_step]") {
  // figures/studies/largest_step_laws_1.csv, _2 and estimated_step_laws_1, _2: material, strain, steps over h / c at rest.
  const auto steps_of = [](const std::string& name) {
    std::map<std::string, double> steps;
    for (const char* part : {"_1", "_2"})
      for (const auto& row : support::read_csv_cells(MPM_SOURCE_DIR "/figures/studies/" + name + part + ".csv"))
        if (row[0] != "material") steps[row[0] + ", " + row[1]] = row[2].empty() ? 0 : std::stod(row[2]);
    return steps;
  };
  const auto largest = steps_of("largest_step_laws"), estimated = steps_of("estimated_step_laws");
  REQUIRE(largest.size() == 216);
  REQUIRE(estimated.size() == 216);
  int stable = 0;
  for (const auto& [state, step] : largest) {
    INFO(state);
    if (step == 0) continue;  // noise grows at any step: stability/steps_of_laws.cpp says where it may
    CHECK(step >= estimated.at(state));
    CHECK(step <= 30 * estimated.at(state));
    ++stable;
  }
  CHECK(stable == 179);  // docs/studies/extremes.md says which states are the others
}

// USF with kept velocities gains energy in proportion to the step.
TEST_CASE("at the default courant only tents and USF with kept velocities shorten the step", "[largest_step]") {
  for (const int dimension : {2, 3})
    for (const std::string& shape : smooth)
      for (const Scheme& scheme : schemes)
        for (const std::string& update : updates) {
          if (is_refused(shape, scheme)) continue;
          INFO(dimension << "-D " << shape << " " << scheme.name << " " << update);
          const double kept = dimension == 2 ? 0.2 : 0.12;
          const bool keeps = std::string(scheme.transfer).ends_with("flip") || scheme.filter == xpic;
          const double courant =
              courant_of(shipped(scene_of(dimension), settings(dimension, shape, scheme, update, 0.3)));
          CHECK(courant == Approx(scheme.filter == fmpm ? 0.15 : update == "first" && keeps ? kept : 0.3));
        }
  std::map<std::string, double> flip{{"last", 0.1}, {"first", 0.2}, {"modified_last", 0.3}, {"averaged", 0.1}};
  for (const int dimension : {2, 3}) {
    if (dimension == 3) flip["first"] = 0.12;
    for (const std::string& update : updates) {
      INFO(dimension << "-D " << update);
      const auto linear = [&](const Scheme& scheme) {
        return courant_of(shipped(scene_of(dimension), settings(dimension, "linear", scheme, update, 0.3)));
      };
      CHECK(linear(schemes[1]) == Approx(flip.at(update)));
      CHECK(linear(schemes[4]) == Approx(0.1));
    }
  }
}

TEST_CASE("at the default courant the study's discs are stable", "[largest_step]") {
  for (const std::string shape : {"bspline_quadratic", "gimp", "cpdi"})
    for (const Scheme& scheme : {schemes[1], schemes[4], schemes[9]})
      for (const std::string& update : updates) check_bounded(2, shape, scheme, update, 0.3);
}

TEST_CASE("every combination is stable at the default courant and at the limit of the step", "[largest_step][slow]") {
  for (const std::string& shape : smooth)
    for (const Scheme& scheme : schemes)
      for (const std::string& update : updates)
        for (const double courant : {0.3, 2.0}) check_bounded(2, shape, scheme, update, courant);
}

TEST_CASE("every combination is stable in 3-D at the default courant and at the limit", "[largest_step][slow]") {
  for (const std::string& shape : smooth)
    for (const Scheme& scheme : schemes)
      for (const std::string& update : updates)
        for (const double courant : {0.3, 2.0}) check_bounded(3, shape, scheme, update, courant);
}

// Where the velocity of the grid strains, a particle without neighbours that passes a node makes tents unstable at any
// step (lone_particle.cpp), and chance decides which runs meet that. Where only what particles carry strains, they stand
// the default step.
TEST_CASE("tents are stable by USF and MUSL, and by USL more often than at the step that others take",
          "[largest_step][slow]") {
  for (const std::string update : {"first", "modified_last"})
    for (const int k : {0, 1, 7, 9, 10}) check_bounded(2, "linear", schemes[k], update, 0.3);
  int limited = 0, unlimited = 0, runs = 0;
  for (const Scheme& scheme : {schemes[0], schemes[1], schemes[7], schemes[10], schemes[4]})
    for (const double shift : {0.0, 0.003, 0.007, 0.011, 0.017}) {
      std::vector<std::string> all = settings(2, "linear", scheme, "last", 0.3);
      all.push_back(set("/bodies/0/geometry/centre", "[" + digits(0.2 + shift) + ", " + digits(0.2 + 2 * shift) + "]"));
      limited += gain_of(scene_of(2), all, "last") <= bounded;
      // The step that others take at the same courant: 0.3 h / (wave speed + particle speed).
      all.push_back(set("/solver/time_step", digits(0.3 * 0.0384122)));
      unlimited += gain_of(scene_of(2), all, "last") <= bounded;
      ++runs;
    }
  std::printf("Tents by USL: of %d runs %d are bounded with the limit, %d without\n", runs, limited, unlimited);
  CHECK(limited >= 3 * unlimited);
  CHECK(2 * limited > runs);
  CHECK(limited < runs);  // no limit makes tents sure (docs/method.md, "The time step")
}

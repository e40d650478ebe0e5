// What good files become.
#include <cmath>
#include <numbers>

#include "config/config_support.hpp"
#include "plugin/extensions.h"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

void check_same(const std::optional<VectorExpression>& a, const std::optional<VectorExpression>& b) {
  REQUIRE(a.has_value() == b.has_value());
  if (!a) return;
  CHECK(a->is_constant() == b->is_constant());
  CHECK((*a)({0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, 0.7) == (*b)({0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, 0.7));
}

void check_same(const Component& a, const Component& b) {
  CHECK(a.plugin == b.plugin);
  CHECK(a.parameters == b.parameters);
  CHECK(a.pointer == b.pointer);
}

void check_same_geometry(const Geometry& a, const Geometry& b) {
  CHECK(a.bounds() == b.bounds());
  int different = 0;
  for (int i = 0; i < 8000; ++i) {
    const int column = i % 20, row = i / 20 % 20, layer = i / 400;
    const Vector3 point{column / 20.0, row / 20.0, layer / 20.0};
    different += a.contains(point) != b.contains(point);
  }
  CHECK(different == 0);
}

void check_same_scene(const Experiment& a, const Experiment& b) {
  CHECK(a.grid.cell_size == b.grid.cell_size);
  CHECK(a.grid.lower == b.grid.lower);
  CHECK(a.grid.upper == b.grid.upper);
  CHECK(a.grid.cells == b.grid.cells);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      CHECK(a.faces[axis][side].type == b.faces[axis][side].type);
      check_same(a.faces[axis][side].velocity, b.faces[axis][side].velocity);
    }
  }
  REQUIRE(a.boxes.size() == b.boxes.size());
  for (std::size_t i = 0; i < a.boxes.size(); ++i) {
    CHECK(a.boxes[i].type == b.boxes[i].type);
    CHECK(a.boxes[i].lower == b.boxes[i].lower);
    CHECK(a.boxes[i].upper == b.boxes[i].upper);
    CHECK(a.boxes[i].axis == b.boxes[i].axis);
    CHECK(a.boxes[i].side == b.boxes[i].side);
    CHECK(a.boxes[i].held == b.boxes[i].held);
    check_same(a.boxes[i].velocity, b.boxes[i].velocity);
  }
  REQUIRE(a.bodies.size() == b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    CHECK(a.bodies[i].name == b.bodies[i].name);
    CHECK(a.bodies[i].material == b.bodies[i].material);
    CHECK(a.bodies[i].field == b.bodies[i].field);
    CHECK(a.bodies[i].particles_per_cell_axis == b.bodies[i].particles_per_cell_axis);
    CHECK(a.bodies[i].jitter == b.bodies[i].jitter);
    check_same(std::optional(a.bodies[i].velocity), std::optional(b.bodies[i].velocity));
    check_same_geometry(*a.bodies[i].geometry, *b.bodies[i].geometry);
  }
}

void check_same_experiment(const Experiment& a, const Experiment& b) {
  CHECK(a.title == b.title);
  CHECK(a.description == b.description);
  CHECK(a.dimension == b.dimension);
  CHECK(a.precision == b.precision);
  CHECK(a.backend == b.backend);
  CHECK(a.seed == b.seed);
  check_same_scene(a, b);
  check_same(a.shape, b.shape);
  check_same(a.transfer, b.transfer);
  REQUIRE(a.contact.has_value() == b.contact.has_value());
  if (a.contact) check_same(*a.contact, *b.contact);
  REQUIRE((a.contact_normal.has_value() == b.contact_normal.has_value()));
  if (a.contact_normal) CHECK(a.contact_normal->plugin == b.contact_normal->plugin);
  REQUIRE((a.contact_detection.has_value() == b.contact_detection.has_value()));
  if (a.contact_detection) CHECK(a.contact_detection->plugin == b.contact_detection->plugin);
  CHECK(a.field_count == b.field_count);
  CHECK(a.field_names == b.field_names);
  REQUIRE(a.materials.size() == b.materials.size());
  for (std::size_t i = 0; i < a.materials.size(); ++i) {
    CHECK(a.materials[i].name == b.materials[i].name);
    check_same(a.materials[i].component, b.materials[i].component);
  }
  CHECK(a.gravity == b.gravity);
  check_same(a.body_force, b.body_force);
  CHECK(a.solver.stress_update == b.solver.stress_update);
  CHECK(a.solver.time_step == b.solver.time_step);
  CHECK(a.solver.courant == b.solver.courant);
  CHECK(a.solver.end_time == b.solver.end_time);
  CHECK(a.solver.max_steps == b.solver.max_steps);
  CHECK(a.output.metrics_every == b.output.metrics_every);
  CHECK(a.output.frames == b.output.frames);
  CHECK(a.output.colour_by == b.output.colour_by);
  CHECK(a.output.vtk == b.output.vtk);
  CHECK(a.output.film == b.output.film);
  CHECK(a.output.ledger == b.output.ledger);
  CHECK(a.figures == b.figures);
  REQUIRE(a.exact.has_value() == b.exact.has_value());
  if (a.exact) CHECK((a.exact->type == b.exact->type && a.exact->values == b.exact->values));
  REQUIRE(a.expectations.size() == b.expectations.size());
  for (std::size_t i = 0; i < a.expectations.size(); ++i) {
    CHECK(a.expectations[i].metric == b.expectations[i].metric);
    CHECK(a.expectations[i].at_least == b.expectations[i].at_least);
    CHECK(a.expectations[i].at_most == b.expectations[i].at_most);
    CHECK(a.expectations[i].equals == b.expectations[i].equals);
    CHECK(a.expectations[i].tolerance == b.expectations[i].tolerance);
  }
  CHECK(a.limits.isolated == b.limits.isolated);
  CHECK(a.limits.energy_gain == b.limits.energy_gain);
  CHECK(a.limits.volume_ratio == b.limits.volume_ratio);
  CHECK(a.resolved == b.resolved);
}

const char* const smallest_3d = R"({"dimension": 3, "grid": {"cell_size": 0.25, "domain": [[0,0,0],[1,1,1]],
  "boundaries": {"all": "stick", "z_min": "periodic", "z_max": "periodic"}},
  "shape": {"type": "linear"}, "transfer": {"type": "apic"},
  "materials": {"m": {"type": "linear_elastic", "density": 1, "youngs_modulus": 1}},
  "bodies": [{"name": "b", "material": "m", "velocity": ["-y", "x", "0.1 m/s"],
    "geometry": {"type": "ring", "centre": [0.5,0.5,0.5], "inner_radius": 0, "outer_radius": 0.4, "axis": "z", "length": 1}}],
  "body_force": ["z*Z", "0", "t"],
  "solver": {"end_time": 1}})";

}  // namespace

TEST_CASE("the two discs are read as written", "[config]") {
  const Experiment e = read_text(two_discs);
  CHECK(e.title == "Two elastic discs");
  CHECK(e.dimension == 2);
  CHECK(e.precision == Precision::double_);
  CHECK(e.backend == "cpu");
  CHECK(e.grid.cell_size == 0.025);
  CHECK(e.grid.cells == std::array<int, 3>{40, 40, 1});
  CHECK(e.faces[0][0].type == ConditionType::prescribed);
  CHECK((*e.faces[0][0].velocity)({}, {}, 2)[0] == Approx(0.05 * std::sin(2.0)));
  CHECK(e.faces[0][1].type == ConditionType::slip);
  REQUIRE(e.boxes.size() == 2);
  CHECK(e.boxes[0].axis == 1);
  CHECK(e.boxes[0].side == -1);
  CHECK(e.boxes[1].held == std::array<bool, 3>{false, true, true});
  CHECK(e.shape.plugin->id() == "bspline_quadratic");
  CHECK(e.transfer.parameter("pic_fraction") == 0.1);
  CHECK_THROWS_AS(e.transfer.parameter("nothing"), std::out_of_range);
  CHECK(e.materials[0].component.parameters == std::vector<double>{1000, 1000, 0.3, 1});
  CHECK(e.field_count == 2);
  CHECK(e.field_names == std::vector<std::string>{"left", "right"});
  CHECK(e.bodies[1].field == 1);
  CHECK(e.bodies[0].velocity({2, 0, 0}, {}, 0) == Vector3{0.1, 0.1, 0});
  CHECK(e.gravity == Vector3{0, -9.81, 0});
  CHECK(e.body_force->uses_initial_position());
  CHECK(e.solver.stress_update == StressUpdate::modified_last);
  CHECK(e.solver.time_step == 0.001);
  CHECK(e.exact->values == std::vector<std::pair<std::string, double>>{{"start", 0.002}});
  CHECK(e.expectations[0].at_least == 0.98);
}

TEST_CASE("the resolved experiment reads back as the same one", "[config]") {
  for (const char* text : {two_discs, smallest_3d}) {
    const Experiment original = read_text(text);
    check_same_experiment(read_text(original.resolved.dump(2)), original);
  }
}

TEST_CASE("defaults are filled and the step is automatic", "[config]") {
  const Experiment e = read_text(smallest_3d);
  CHECK_FALSE(e.solver.time_step.has_value());
  CHECK(e.solver.courant == 0.3);
  CHECK(e.output.metrics_every == 10);
  CHECK(e.faces[2][1].type == ConditionType::periodic);
  CHECK(e.faces[0][0].type == ConditionType::stick);
  CHECK(e.field_count == 1);
  CHECK(e.bodies[0].velocity({0.5, 0.25, 0}, {}, 0) == Vector3{-0.25, 0.5, 0.1});
  CHECK(e.resolved["output"]["ledger"] == true);
  CHECK(e.resolved["solver"]["time_step"] == "auto");
}

TEST_CASE("a film is none, of a format, or mp4 where none is named", "[config][film]") {
  const auto format = [](const std::string& film) {
    return read_text(two_discs, {"/output/film=" + film}).output.film;
  };
  CHECK(read_text(two_discs).output.film.empty());
  CHECK(format("false").empty());
  CHECK(format("true") == "mp4");
  for (const char* name : {"mp4", "webm", "webp"}) CHECK(format(name) == name);
  const Experiment animated = read_text(two_discs, {"/output/film=webp"});
  check_same_experiment(read_text(animated.resolved.dump(2)), animated);
}

TEST_CASE("limits have defaults, and null takes one away", "[config]") {
  const Experiment e = read_text(smallest_3d);
  CHECK(!e.limits.isolated);
  CHECK(e.limits.energy_gain == 0.01);
  CHECK(e.limits.volume_ratio == std::array{0.1, 10.0});
  CHECK(e.resolved["limits"].dump() == R"({"energy_gain":0.01,"volume_ratio":[0.1,10.0]})");
  const auto with = [](const std::string& limits) { return read_text(smallest_3d, {"/limits=" + limits}); };
  const Experiment none = with(R"({"energy_gain": null, "volume_ratio": null, "isolated": false})");
  CHECK(!none.limits.energy_gain);
  CHECK(!none.limits.volume_ratio);
  CHECK(none.limits.isolated == false);
  check_same_experiment(read_text(none.resolved.dump(2)), none);
  CHECK(with(R"({"volume_ratio": [0.5, 2]})").limits.volume_ratio == std::array{0.5, 2.0});
  CHECK(with("null").limits.energy_gain == 0.01);
}

TEST_CASE("positions point into the file, at the nearest part for what was not written", "[config]") {
  const TemporaryFolder folder;
  const auto file = experiment_file(folder, two_discs);
  const Experiment e = read_experiment(file, components(), options({"/solver/courant=0.1"}));
  const std::string name = file.string();
  CHECK(e.where("/grid/cell_size") == name + ":7:18");
  CHECK(e.where("/bodies/1") == name + ":25:5");
  CHECK(e.where("/solver/max_steps") == name + ":32:13");
  CHECK(e.where("/solver/courant") == "command line");
  CHECK(e.where("/nothing/at/all") == name + ":2:1");
}

TEST_CASE("overrides take JSON, else a string, and add what is missing", "[config]") {
  const Experiment e = read_text(
      two_discs, {"/grid/cell_size=50 mm", "/transfer={\"type\": \"apic\"}", "/contact=null", "/solver/time_step=auto",
                  "/solver/courant=0.25", "/gravity/1=-1", "/bodies/0/name=first", "/figures/2=dissipation"});
  CHECK(e.grid.cell_size == 0.05);
  CHECK(e.transfer.plugin->id() == "apic");
  CHECK_FALSE(e.contact.has_value());
  CHECK_FALSE(e.solver.time_step.has_value());
  CHECK(e.solver.courant == 0.25);
  CHECK(e.gravity[1] == -1);
  CHECK(e.bodies[0].name == "first");
  CHECK(e.figures == std::vector<std::string>{"energy", "contact", "dissipation"});
  CHECK(e.resolved["gravity"][1] == -1.0);
}

TEST_CASE("the command line's backend wins", "[config]") {
  ReadOptions chosen = options();
  chosen.backend = "reference";
  const TemporaryFolder folder;
  const Experiment e = read_experiment(experiment_file(folder, two_discs), components(), chosen);
  CHECK(e.backend == "reference");
  CHECK(e.resolved["backend"] == "reference");
}

TEST_CASE("a byte order mark and Windows line ends do no harm", "[config]") {
  CHECK(errors("\xEF\xBB\xBF" + replaced(two_discs, "\n", "\r\n")) == "accepted");
}

TEST_CASE("bodies may share a field", "[config]") {
  const std::string text =
      replaced(two_discs, "\"name\": \"right\",", R"("name": "third", "material": "rubber", "field": "left",
     "geometry": {"type": "box", "lower": [0.8, 0], "upper": [1, 0.2]}}, {"name": "right",)");
  const Experiment e = read_text(text);
  CHECK(e.field_count == 2);
  CHECK(e.bodies[1].field == 0);
  CHECK(e.bodies[2].field == 1);
}

TEST_CASE("a material that asks for the cell size gets it behind its parameters", "[config]") {
  mpm_descriptor softening = descriptor("softening", MPM_MATERIAL, both, every_precision, elastic_parameters, 4);
  softening.parameter_bytes += sizeof(double);
  softening.extension = [](const char* id) -> const void* {
    static constexpr mpm_material_cell_size table{MPM_MATERIAL_CELL_SIZE_VERSION, 4 * sizeof(double)};
    return std::string_view(id) == MPM_MATERIAL_CELL_SIZE_ID ? &table : nullptr;
  };
  const Plugin plugin{&softening, "test"};
  std::vector<const Plugin*> all{&plugin};
  for (const mpm_kind kind : all_kinds())
    for (const Plugin* other : components().of_kind(kind)) all.push_back(other);
  const std::string text = replaced(two_discs, "\"neo_hookean\"", "\"softening\"");
  const Experiment e = read_experiment_text(text, "test.json", ComponentLookup(all), options());
  const std::vector<double>& block = e.materials.at(0).component.parameters;
  REQUIRE(block.size() == 5);
  CHECK(block[0] == 1000);
  CHECK(block[4] == 0.025);
}

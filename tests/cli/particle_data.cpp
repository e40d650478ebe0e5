// Particle data in files: what is written when, what is refused, and that pictures do not depend on threads.

#include <cmath>

#include "cli/program.hpp"
#include "support/csv.hpp"
#include "support/processors.hpp"

using namespace mpm::test;

namespace {

Words names_in(const fs::path& folder) {
  Words names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

void runs(const Folder& folder, const Json& scene, const Words& more = {}) {
  const Result result = run_scene(folder, scene, more);
  INFO(result.err);
  REQUIRE(result.code == 0);
}

Json with_particles(Json scene, Json particles) {
  scene["output"]["particles"] = std::move(particles);
  return scene;
}

/// Times in a collection, in its order.
std::vector<double> times_in(const fs::path& pvd) {
  std::vector<double> times;
  const std::string text = slurp(pvd), key = "timestep=\"";
  for (auto at = text.find(key); at != std::string::npos; at = text.find(key, at + 1))
    times.push_back(std::stod(text.substr(at + key.size())));
  return times;
}

void refused(const Json& particles, const Words& parts, const Json& base = ball()) {
  const Folder folder;
  spill(folder / "scene.json", with_particles(base, particles).dump(1));
  const Result result = call(folder, {"check", "scene.json"});
  INFO(result.err);
  CHECK(result.code == 2);
  CHECK(has(result.err, "scene.json:"));
  for (const std::string& part : parts) {
    INFO(part);
    CHECK(has(result.err, part));
  }
}

}  // namespace

TEST_CASE("particles are written at times of their own") {
  const Folder folder;
  runs(folder, with_particles(ball(), {{"count", 3}}));
  const fs::path place = folder / "run/particles";
  CHECK(names_in(place) == Words{"particles.pvd", "particles_0000.vtu", "particles_0001.vtu", "particles_0002.vtu"});
  const auto thirds = times_in(place / "particles.pvd");
  REQUIRE(thirds.size() == 3);
  for (std::size_t k = 0; k < 3; ++k) CHECK(thirds[k] == Approx(0.05 * static_cast<double>(k)));

  runs(folder, with_particles(ball(), {{"every_time", 0.03}, {"format", "csv"}}));
  CHECK(names_in(place).size() == 4);  // at 0, 0.03, 0.06 and 0.09
  CHECK(!fs::exists(place / "particles.pvd"));

  // A step is never cut to fit: each time belongs to the first step at or after it, and two in one step share a file.
  runs(folder, with_particles(ball(), {{"times", {"5 ms", 0.0211, 0.0219, 0.1}}, {"grid", true}}));
  const auto times = times_in(place / "particles.pvd");
  REQUIRE(times.size() == 3);
  CHECK(times[0] == Approx(0.006));
  CHECK(times[1] == Approx(0.022));
  CHECK(times[2] == Approx(0.1));
  CHECK(times_in(place / "grid.pvd") == times);
  CHECK(json_in(folder / "run/summary.json")["performance"]["particle_file_seconds"].get<double>() > 0);
  CHECK(json_in(folder / "run/experiment.json")["output"]["particles"]["times"] == Json{0.005, 0.0211, 0.0219, 0.1});

  // The resolved experiment writes the same files.
  const std::string bytes = slurp(place / "particles_0001.vtu");
  fs::copy_file(folder / "run/experiment.json", folder / "again.json");
  const Result again = call(folder, {"run", "again.json", "--out", "again", "--threads", "1"});
  INFO(again.err);
  REQUIRE(again.code == 0);
  CHECK((slurp(folder / "again/particles/particles_0001.vtu") == bytes));
}

TEST_CASE("a table of particles holds every field with its unit, one row a particle") {
  const Folder folder;
  runs(folder, with_particles(ball(), {{"format", {"csv"}}, {"fields", "all"}, {"count", 2}}));
  const auto table = mpm::support::read_csv(folder / "run/particles/particles_0001.csv");
  CHECK(table.rows() == 52);
  for (const char* column : {"x (m)", "z (m)", "velocity y (m/s)", "mass (kg)", "volume (m³)", "initial_position x (m)",
                             "cauchy_stress xy (Pa)", "kirchhoff_stress zz (Pa)", "deformation_gradient yx",
                             "affine_velocity xx (1/s)", "stored_energy (J/m³)", "body"}) {
    INFO(column);
    CHECK(table.find(column));
  }
  // The ball flies at (0.1, 0.1) for 0.1 s and its mass is that of its particles: 52 of a 4th of a cell each.
  const auto &x = *table.find("x (m)"), &X = *table.find("initial_position x (m)"), &m = *table.find("mass (kg)");
  for (std::size_t k = 0; k < x.size(); ++k) {
    CHECK(x[k] - X[k] == Approx(0.01));
    CHECK(m[k] == Approx(1000 * 0.01 / 4));
  }
  CHECK(slurp(folder / "run/plan.json").find("initial places are written") != std::string::npos);
}

TEST_CASE("what a scene does not hold is refused at its place, with what there is") {
  const std::string available = "; available are velocity, speed, body, mass, volume, initial_position, displacement, ";
  refused({{"count", 2}, {"fields", {"mass", "velocity_gradient"}}},
          {"/output/particles/fields/1: there is no field \"velocity_gradient\" here: the transfer of this scene keeps "
           "no velocity gradient",
           available, "deformation_gradient, affine_velocity\n"});
  Json metal = ball();
  metal["materials"]["m"] = {
      {"type", "von_mises"}, {"youngs_modulus", 1e5}, {"poisson_ratio", 0.3}, {"yield_stress", 100}, {"density", 1000}};
  refused({{"count", 2}, {"fields", "deformation_gradient"}},
          {"/output/particles/fields: there is no field \"deformation_gradient\" here: no material of this scene keeps "
           "a deformation gradient"},
          metal);
  refused({{"count", 2}, {"fields", {"contact_traction"}}}, {"no two bodies of this scene meet by \"contact\""});
  refused({{"count", 2}, {"fields", {"temperature"}}}, {"no material of this scene has it in its \"thermal\""});
  refused({{"count", 2}, {"fields", {"presure"}}}, {"there is no field \"presure\" here; did you mean \"pressure\"?"});
  refused({{"count", 2}, {"fields", {"mass", "mass"}}}, {"/fields/1: \"mass\" stands twice in the list"});
  refused({{"count", 2}, {"fields", 3}}, {"/fields: expected \"all\" or a list of names of fields, got the number 3"});
  refused({{"fields", "all"}}, {"says not when to write: give one of \"count\", \"every_time\" and \"times\""});
  refused({{"count", 2}, {"times", {0}}}, {"says twice when to write"});
  refused({{"times", {0.05, 0.02}}}, {"/times/1: times must rise: 0.02 comes after 0.05"});
  refused({{"times", {0.2}}}, {"/times/0: 0.2 s is not within the run, which ends at 0.1 s"});
  refused({{"every_time", 1e-9}}, {"makes 100000001 files of the run of 0.1 s; at most 100000 are written"});
  refused({{"count", 2}, {"format", "xml"}}, {"/format: expected \"vtk\" or \"csv\", got the string \"xml\""});
  refused({{"count", 2}, {"format", "csv"}, {"grid", true}, {"shape", "domains"}, {"compress", false}},
          {"/grid: acts on VTK files alone: add \"vtk\" to \"format\", or remove \"grid\"", "remove \"shape\"",
           "remove \"compress\""});
  refused({{"count", 2}, {"every", 3}}, {"/every: unknown key"});
}

TEST_CASE("the traction of contact stands on the particles that touch, and presses them apart") {
  const Folder folder;
  Json scene = with_particles(two_balls(), {{"times", {0, 0.2}}, {"format", "csv"}, {"fields", {"contact_traction"}}});
  scene["solver"]["end_time"] = 0.2;  // in the middle of the impact
  runs(folder, scene);
  const auto before =
      *mpm::support::read_csv(folder / "run/particles/particles_0000.csv").find("contact_traction x (Pa)");
  CHECK(*std::max_element(before.begin(), before.end()) == 0);  // there has been no step
  const auto table = mpm::support::read_csv(folder / "run/particles/particles_0001.csv");
  const auto &x = *table.find("x (m)"), &y = *table.find("y (m)"), &along = *table.find("contact_traction x (Pa)"),
             &up = *table.find("contact_traction y (Pa)");
  int touched = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (along[k] == 0 && up[k] == 0) continue;
    ++touched;
    CHECK((k < x.size() / 2) == (along[k] + up[k] < 0));  // the first ball is the lower left one
    CHECK(std::abs(x[k] + y[k] - 0.9) < 0.3);             // near the plane between the balls
  }
  CHECK(touched > 4);
  CHECK(touched < static_cast<int>(x.size()));
}

TEST_CASE("a transfer that keeps the velocity gradient writes it") {
  const Folder folder;
  Json scene = with_particles(ball(), {{"count", 2}, {"format", "csv"}, {"fields", {"velocity_gradient"}}});
  scene["transfer"]["type"] = "tpic";
  runs(folder, scene);
  CHECK(mpm::support::read_csv(folder / "run/particles/particles_0001.csv").find("velocity_gradient zz (1/s)"));
}

TEST_CASE("all backends and precisions write particles and grids that agree") {
  const Folder folder;
  Json scene =
      with_particles(two_balls(), {{"count", 2}, {"format", {"csv", "vtk"}}, {"fields", "all"}, {"grid", true}});
  std::vector<mpm::support::Table> tables;
  for (const auto& [backend, precision] :
       {std::pair{"reference", "double"}, std::pair{"cpu", "double"}, std::pair{"cpu", "float"}}) {
    scene["backend"] = backend;
    scene["precision"] = precision;
    runs(folder, scene);
    tables.push_back(mpm::support::read_csv(folder / "run/particles/particles_0001.csv"));
    CHECK(fs::exists(folder / "run/particles/grid_0001.vti"));
  }
  for (std::size_t k = 0; k < tables[0].header.size(); ++k) {
    INFO(tables[0].header[k]);
    double largest = 0, differ = 0, differ_float = 0;
    for (std::size_t p = 0; p < tables[0].rows(); ++p) {
      largest = larger(largest, std::abs(tables[0].columns[k][p]));
      differ = larger(differ, std::abs(tables[1].columns[k][p] - tables[0].columns[k][p]));
      differ_float = larger(differ_float, std::abs(tables[2].columns[k][p] - tables[0].columns[k][p]));
    }
    CHECK(differ <= 1e-9 * largest + 1e-12);
    CHECK(differ_float <= 2e-2 * largest + 1e-4);
  }
}

TEST_CASE("VTK's own reader sees domains, tensors and the nodes of each field") {
  const Folder folder;
  const char* python = "/usr/bin/python3";
  if (!fs::exists(python) || Process(folder, {python, "-c", "import vtkmodules.vtkIOXML"}).finish().code != 0) {
    WARN("VTK for Python is not installed: its reader was not asked");
    return;
  }
  runs(folder, with_particles(two_balls(), {{"count", 2},
                                            {"fields", {"mass", "cauchy_stress", "velocity"}},
                                            {"shape", "domains"},
                                            {"grid", true},
                                            {"numbers", "double"}}));
  spill(folder / "read.py", R"py(
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLImageDataReader
def read(reader, name):
    reader.SetFileName("run/particles/" + name)
    reader.Update()
    return reader.GetOutput()
cells = read(vtkXMLUnstructuredGridReader(), "particles_0000.vtu")
data = cells.GetCellData()
mass = data.GetArray("mass (kg)")
assert cells.GetCellType(0) == 9 and cells.GetNumberOfPoints() == 4 * cells.GetNumberOfCells()
assert data.GetArray("cauchy_stress (Pa)").GetNumberOfComponents() == 9
assert data.GetArray("velocity (m/s)").GetTuple3(0) == (1.0, 1.0, 0.0)
total = sum(mass.GetValue(k) for k in range(mass.GetNumberOfTuples()))
image = read(vtkXMLImageDataReader(), "grid_0000.vti")
assert image.GetDimensions() == (21, 21, 1)
nodes = image.GetPointData()
names = sorted(nodes.GetArrayName(k) for k in range(nodes.GetNumberOfArrays()))
assert names == ["mass of ball (kg)", "mass of other (kg)", "velocity of ball (m/s)", "velocity of other (m/s)"], names
ball, other = nodes.GetArray("mass of ball (kg)"), nodes.GetArray("mass of other (kg)")
found = sum(ball.GetValue(k) + other.GetValue(k) for k in range(ball.GetNumberOfTuples()))
assert abs(found - total) < 1e-9 * total
v = nodes.GetArray("velocity of other (m/s)")
assert all(abs(v.GetTuple3(k)[0] + 1) < 1e-12 for k in range(v.GetNumberOfTuples()) if other.GetValue(k) > 0)
)py");
  const Result result = Process(folder, {python, "read.py"}).finish();
  INFO(result.out << result.err);
  CHECK(result.code == 0);
}

TEST_CASE("files and pictures have the same bytes for any number of threads") {
  const Folder folder;
  Json scene = with_particles(two_balls(), {{"count", 3}, {"fields", "all"}, {"grid", true}});
  scene["output"]["frames"] = 4;
  scene["grid"]["cell_size"] = 0.0125;
  scene["solver"] = {{"time_step", 0.001}, {"end_time", 0.01}};
  spill(folder / "scene.json", scene.dump());
  for (const char* threads : {"1", "3"}) {
    const fs::path place = fs::path(threads) / "run";
    const Result result = call(folder, {"run", "scene.json", "--out", place, "--threads", threads});
    INFO(result.err);
    REQUIRE(result.code == 0);
    CHECK(json_in(folder / place / "summary.json")["performance"]["drawing_seconds"].get<double>() > 0);
  }
  if (mpm::support::available_processors() < 2) WARN("one processor: both runs had one thread");
  for (const char* below : {"frames", "particles"})
    for (const std::string& name : names_in(folder / "1/run" / below)) {
      INFO(name);
      CHECK((slurp(folder / "1/run" / below / name) == slurp(folder / "3/run" / below / name)));
    }
}

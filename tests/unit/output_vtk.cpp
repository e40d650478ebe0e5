// VTK files: sizes checked, well formed, and read back by VTK itself where it is installed.
#include <cstdlib>
#include <iostream>
#include <limits>

#include "output/vtk.hpp"
#include "output/vtk_data.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "unit/output_support.hpp"

namespace fs = std::filesystem;
using namespace mpm::output;
using namespace mpm::support;
using namespace mpm::output::testing;

namespace {

ParticleSnapshot plane_snapshot() {
  ParticleSnapshot snapshot;
  snapshot.dimension = 2;
  snapshot.time = 0.1;
  snapshot.positions = {0.0, 1.0, 0.25, 1.0 / 3.0, 1e-300, -5.0};
  snapshot.fields = {{"pressure <\"p\" & 'q'> (Pa)", 1, {1.5, std::numeric_limits<double>::denorm_min(), -2e300}},
                     {"velocity (m/s)", 2, {1, 2, 3, 4, 5, 6}},
                     {"stress (Pa)", 9, std::vector<double>(27, 0.125)},
                     {"", 1, {7, 8, 9}},
                     {"", 1, {10, 11, 12}}};
  return snapshot;
}

bool system_python_runs(const std::string& code) {
  return std::system(("/usr/bin/python3 -c '" + code + "' >/dev/null 2>&1").c_str()) == 0;
}

/// Runs a script that fails by assertion; the scratch folder is its first argument.
int run_script(const TemporaryFolder& scratch, const std::string& script) {
  write_atomically(scratch / "check.py", script);
  return std::system(
      ("/usr/bin/python3 '" + (scratch / "check.py").string() + "' '" + scratch.path().string() + "'").c_str());
}

}  // namespace

TEST_CASE("a snapshot whose sizes do not match is refused by name", "[output][vtk]") {
  const TemporaryFolder scratch;
  ParticleSnapshot snapshot = plane_snapshot();
  snapshot.fields[1].values.pop_back();
  CHECK(contains(message_of<std::invalid_argument>([&] { write_vtu(scratch / "p.vtu", snapshot); }), "velocity"));
  snapshot = plane_snapshot();
  snapshot.positions.pop_back();
  CHECK_THROWS_AS(write_vtu(scratch / "p.vtu", snapshot), std::invalid_argument);
  snapshot.dimension = 4;
  CHECK_THROWS_AS(write_vtu(scratch / "p.vtu", snapshot), std::invalid_argument);
  CHECK(entries_in(scratch.path()) == 0);
}

TEST_CASE("VTK files are well-formed XML", "[output][vtk]") {
  const TemporaryFolder scratch;
  write_vtu(scratch / "p.vtu", plane_snapshot());
  write_vtu(scratch / "none.vtu", ParticleSnapshot{});
  write_pvd(scratch / "all.pvd", {{0.0, "p.vtu"}, {0.1, "a & b.vtu"}});
  const std::string pvd = read_file(scratch / "all.pvd");
  CHECK(contains(pvd, "timestep=\"0.1\""));
  CHECK(contains(pvd, "a &amp; b.vtu"));
  if (!system_python_runs("import xml.dom.minidom")) {
    std::cout << "SKIPPED: no /usr/bin/python3 to parse the XML\n";
    return;
  }
  CHECK(run_script(scratch, R"python(import sys, xml.dom.minidom as dom
for name in ("p.vtu", "none.vtu", "all.pvd"):
    assert dom.parse(sys.argv[1] + "/" + name).documentElement.tagName == "VTKFile", name
)python") == 0);
}

TEST_CASE("VTK's own reader finds the particles and their values", "[output][vtk]") {
  const TemporaryFolder scratch;
  if (!system_python_runs("import vtk")) {
    std::cout << "SKIPPED: VTK's own reader (python3-vtk9) is not installed\n";
    return;
  }
  write_vtu(scratch / "p.vtu", plane_snapshot());
  write_vtu(scratch / "none.vtu", ParticleSnapshot{});
  CHECK(run_script(scratch, R"python(import sys, vtk
def read(name):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(sys.argv[1] + "/" + name)
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()
grid = read("p.vtu")
assert grid.GetNumberOfPoints() == 3 and grid.GetNumberOfCells() == 3
assert grid.GetCellType(2) == vtk.VTK_VERTEX and grid.GetCell(2).GetPointId(0) == 2
assert grid.GetPoint(1) == (0.25, 1 / 3, 0.0) and grid.GetPoint(2) == (1e-300, -5.0, 0.0)
assert grid.GetFieldData().GetArray("TimeValue").GetValue(0) == 0.1
data = grid.GetPointData()
assert data.GetNumberOfArrays() == 5
pressure = data.GetArray("pressure <\"p\" & 'q'> (Pa)")
assert [pressure.GetValue(i) for i in range(3)] == [1.5, 5e-324, -2e300]
velocity = data.GetArray("velocity (m/s)")
assert velocity.GetNumberOfComponents() == 3 and velocity.GetTuple3(2) == (5.0, 6.0, 0.0)
assert data.GetArray("stress (Pa)").GetNumberOfComponents() == 9
assert data.GetArray("field 2").GetValue(0) == 10
assert read("none.vtu").GetNumberOfPoints() == 0
)python") == 0);
}

namespace {

/// More numbers than one block of compression holds, and not a whole number of blocks.
VtkCells many_points() {
  VtkCells cells;
  cells.time = 0.25;
  std::vector<double> points;
  std::vector<float> ramp;
  for (int k = 0; k < 40000; ++k) {
    points.insert(points.end(), {0.5 * k, -1.0, 1.0 / (k + 1)});
    ramp.push_back(static_cast<float>(k) / 3);
  }
  cells.points = std::move(points);
  cells.of_cell = {{"ramp & <co> (m)", 1, std::move(ramp)}};
  return cells;
}

VtkCells one_hexahedron() {
  VtkCells cells;
  cells.cell = VtkCell::hexahedron;
  cells.points = std::vector<float>{0, 0, 0, 2, 0, 0, 2, 3, 0, 0, 3, 0, 0, 0, 4, 2, 0, 4, 2, 3, 4, 0, 3, 4};
  cells.of_cell = {{"stress (Pa)", 9, std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}}};
  return cells;
}

VtkImage small_image() {
  VtkImage image;
  image.origin = {-1, 0.5, 0};
  image.spacing = 0.25;
  image.nodes = {3, 2, 1};
  image.of_node = {{"mass (kg)", 1, std::vector<double>{0, 1, 2, 3, 4, 5}}};
  return image;
}

}  // namespace

TEST_CASE("sizes of compact VTK files are checked", "[output][vtk]") {
  const TemporaryFolder scratch;
  VtkCells cells = one_hexahedron();
  cells.of_cell[0].components = 6;
  CHECK(contains(message_of<std::invalid_argument>([&] { write_vtu(scratch / "p.vtu", cells, {}); }), "stress"));
  cells.cell = VtkCell::quadrilateral;
  cells.points = std::vector<float>(9);
  CHECK_THROWS_AS(write_vtu(scratch / "p.vtu", cells, {}), std::invalid_argument);
  VtkImage image = small_image();
  image.nodes[2] = 2;
  CHECK_THROWS_AS(write_vti(scratch / "i.vti", image, {}), std::invalid_argument);
  CHECK(entries_in(scratch.path()) == 0);
}

TEST_CASE("the bytes of compact VTK files do not depend on the number of threads", "[output][vtk]") {
  const TemporaryFolder scratch;
  write_vtu(scratch / "one.vtu", many_points(), {true, 1});
  write_vtu(scratch / "four.vtu", many_points(), {true, 4});
  write_vtu(scratch / "raw.vtu", many_points(), {false, 1});
  CHECK((read_file(scratch / "one.vtu") == read_file(scratch / "four.vtu")));
  CHECK(fs::file_size(scratch / "one.vtu") < fs::file_size(scratch / "raw.vtu") / 2);
  // 40000 points of 24 bytes, values of 4, connectivity and offsets of 4 each, types of 1
  CHECK(fs::file_size(scratch / "raw.vtu") > 40000u * 37);
}

TEST_CASE("VTK's own reader finds compact files as they were written", "[output][vtk]") {
  const TemporaryFolder scratch;
  if (!system_python_runs("import vtk")) {
    std::cout << "SKIPPED: VTK's own reader (python3-vtk9) is not installed\n";
    return;
  }
  for (const bool compress : {true, false}) {
    const std::string kind = compress ? "zlib" : "raw";
    write_vtu(scratch / (kind + "_points.vtu"), many_points(), {compress, 2});
    write_vtu(scratch / (kind + "_hexahedron.vtu"), one_hexahedron(), {compress, 1});
    write_vtu(scratch / (kind + "_none.vtu"), VtkCells{}, {compress, 1});
    write_vti(scratch / (kind + "_image.vti"), small_image(), {compress, 1});
  }
  CHECK(run_script(scratch, R"python(import sys, vtk
def read(reader, name):
    reader.SetFileName(sys.argv[1] + "/" + name)
    reader.Update()
    assert reader.GetErrorCode() == 0, name
    return reader.GetOutput()
for kind in ("zlib", "raw"):
    points = read(vtk.vtkXMLUnstructuredGridReader(), kind + "_points.vtu")
    assert points.GetNumberOfPoints() == points.GetNumberOfCells() == 40000
    assert points.GetPoint(3) == (1.5, -1.0, 0.25) and points.GetPoint(39999) == (19999.5, -1.0, 1 / 40000)
    assert points.GetCellType(7) == vtk.VTK_VERTEX and points.GetCell(7).GetPointId(0) == 7
    assert points.GetFieldData().GetArray("TimeValue").GetValue(0) == 0.25
    ramp = points.GetPointData().GetArray("ramp & <co> (m)")
    assert ramp.GetDataType() == vtk.VTK_FLOAT and ramp.GetValue(39999) == 13333.0 and ramp.GetValue(30) == 10.0
    solid = read(vtk.vtkXMLUnstructuredGridReader(), kind + "_hexahedron.vtu")
    assert solid.GetNumberOfCells() == 1 and solid.GetCellType(0) == vtk.VTK_HEXAHEDRON
    measure = vtk.vtkCellSizeFilter()
    measure.SetInputData(solid)
    measure.Update()
    assert abs(measure.GetOutput().GetCellData().GetArray("Volume").GetValue(0) - 24) < 1e-12
    assert solid.GetCellData().GetArray("stress (Pa)").GetTuple9(0) == tuple(range(1, 10))
    assert read(vtk.vtkXMLUnstructuredGridReader(), kind + "_none.vtu").GetNumberOfPoints() == 0
    image = read(vtk.vtkXMLImageDataReader(), kind + "_image.vti")
    assert image.GetDimensions() == (3, 2, 1) and image.GetSpacing()[0] == 0.25
    assert image.GetPoint(5) == (-0.5, 0.75, 0.0)
    assert image.GetPointData().GetArray("mass (kg)").GetValue(5) == 5
)python") == 0);
}

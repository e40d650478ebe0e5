// VTK files: sizes checked, well formed, and read back by VTK itself where it is installed.
#include <cstdlib>
#include <iostream>
#include <limits>

#include "output/vtk.hpp"
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

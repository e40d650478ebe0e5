// Bodies from files: surfaces, pictures, points.
#include <cmath>

#include "experiment/mask.hpp"
#include "experiment/read_files.hpp"
#include "experiment/surface_mesh.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/hash.hpp"

namespace mpm {

namespace fs = std::filesystem;

std::optional<fs::path> input_file(const Fields& fields, ReadContext& context, OrderedJson& resolved) {
  if (!fields.given("file") || !fields.valid("file")) return std::nullopt;
  const Node& place = *fields.node("file");
  const fs::path path = fs::absolute(fs::path(context.file).parent_path() / fields.text("file")).lexically_normal();
  resolved["file"] = path.string();  // so that the experiment runs again from its run folder
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    context.problem(place,
                    "there is no file " + path.string() + "; a path counts from the folder of the experiment file");
    return std::nullopt;
  }
  try {
    context.inputs.push_back({place.pointer, path, support::sha256_of_file(path)});
  } catch (const support::MachineError& failure) {
    context.problem(place, failure.what());
    return std::nullopt;
  }
  return path;
}

GeometryPointer read_surface(const Fields& fields, ReadContext& context, OrderedJson& resolved) {
  const auto path = input_file(fields, context, resolved);
  if (!path || !fields.valid("scale")) return nullptr;
  try {
    SurfaceMesh surface = read_stl(*path, fields.number("scale"));
    check_closed(surface);
    return make_enclosed(std::move(surface.triangles));
  } catch (const SurfaceError& error) {
    context.problem(*fields.node("file"), path->string() + ": " + error.what());
  }
  return nullptr;
}

GeometryPointer read_mask(const Fields& fields, ReadContext& context, OrderedJson& resolved) {
  const auto path = input_file(fields, context, resolved);
  if (!path) return nullptr;
  for (const char* key : {"lower", "upper", "threshold", "inside"})
    if (!fields.valid(key)) return nullptr;
  const Vector3 &lower = fields.vector("lower"), &upper = fields.vector("upper");
  if (!(lower[0] < upper[0] && lower[1] < upper[1])) {
    context.problem(fields.place("upper"), "the upper corner is not above the lower one along both axes");
    return nullptr;
  }
  try {
    return make_mask(read_picture(*path), lower, upper, fields.number("threshold"), fields.text("inside") == "bright");
  } catch (const std::runtime_error& error) {
    context.problem(*fields.node("file"), path->string() + ": " + error.what());
  }
  return nullptr;
}

namespace {

/// Columns of a table of points, or null for one that is not there.
struct Columns {
  const std::vector<double>*place[3]{}, *volume = nullptr, *mass = nullptr;
};

bool find_columns(const support::Table& table, int dimension, Columns& columns, std::string& why) {
  constexpr const char* axes[] = {"x", "y", "z"};
  for (int c = 0; c < dimension; ++c) {
    columns.place[c] = table.find(axes[c]);
    if (!columns.place[c]) why = std::string("line 1: there is no column ") + in_quotes(axes[c]);
  }
  columns.volume = table.find("volume"), columns.mass = table.find("mass");
  if (columns.volume && columns.mass) why = "line 1: columns \"volume\" and \"mass\" say the same twice";
  for (const std::string& name : table.header) {
    const std::vector<double>* column = table.find(name);
    bool known = column == columns.volume || column == columns.mass;
    for (const auto* place : columns.place) known = known || column == place;
    if (!known && why.empty())
      why = "line 1: column " + in_quotes(name) + " has no meaning here; known are x, y, in 3-D z, volume and mass";
  }
  if (why.empty() && table.rows() == 0) why = "there is no point in it";
  return why.empty();
}

}  // namespace

std::vector<SeededPoint> read_seeded_points(const fs::path& path, int dimension, const GridSpecification& grid,
                                            double density, bool& have_volumes) {
  const support::Table table = support::read_csv(path);
  Columns columns;
  std::string why;
  if (!find_columns(table, dimension, columns, why)) throw std::runtime_error(path.string() + ": " + why);
  const auto* const amounts = columns.volume ? columns.volume : columns.mass;
  have_volumes = amounts != nullptr;
  std::vector<SeededPoint> points;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const std::string line = path.string() + ": line " + std::to_string(row + 2) + ": ";
    SeededPoint point;
    for (int c = 0; c < dimension; ++c) {
      const double x = point.place[c] = (*columns.place[c])[row];
      if (!(x >= grid.lower[c] && x <= grid.upper[c]))
        throw std::runtime_error(line + "the point lies outside the domain, or is no number");
    }
    if (grid.symmetry == Symmetry::axisymmetric && !(point.place[0] > 0))
      throw std::runtime_error(line + "the point lies on the axis, where a ring has no volume");
    if (amounts) {
      point.volume = (*amounts)[row] / (columns.mass ? density : 1);
      if (!(point.volume > 0) || !std::isfinite(point.volume))
        throw std::runtime_error(line + "expected a " + (columns.mass ? "mass" : "volume") + " above 0");
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace mpm

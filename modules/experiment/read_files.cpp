// Bodies from files: surfaces, pictures, points.
#include <algorithm>
#include <cmath>
#include <numeric>

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

/// Throws what is wrong with the header.
Columns find_columns(const support::Table& table, const fs::path& path, int dimension) {
  constexpr const char* axes[] = {"x", "y", "z"};
  const auto mistake = [&](const std::string& what) { return support::csv_mistake(path, 1, what); };
  Columns columns;
  for (int c = 0; c < dimension; ++c) {
    columns.place[c] = table.find(axes[c]);
    if (!columns.place[c]) throw mistake(std::string("there is no column ") + in_quotes(axes[c]));
  }
  columns.volume = table.find("volume"), columns.mass = table.find("mass");
  if (columns.volume && columns.mass) throw mistake("columns \"volume\" and \"mass\" say the same twice");
  for (const std::string& name : table.header) {
    const std::vector<double>* column = table.find(name);
    bool known = column == columns.volume || column == columns.mass;
    for (const auto* place : columns.place) known = known || column == place;
    if (!known)
      throw mistake("column " + in_quotes(name) + " has no meaning here; known are x, y, in 3-D z, volume and mass");
  }
  if (table.rows() == 0) throw mistake("there is no point in the file");
  return columns;
}

/// Refuses two points in one place: as two particles they never part.
void refuse_equal_points(const std::vector<SeededPoint>& points, const support::Table& table, const fs::path& path) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return points[a].place < points[b].place; });
  for (std::size_t k = 1; k < order.size(); ++k)
    if (points[order[k - 1]].place == points[order[k]].place)
      throw support::csv_mistake(path, table.lines[order[k]],
                                 "the point is that of line " + std::to_string(table.lines[order[k - 1]]) +
                                     " again: two particles in one place never part; remove one of the lines");
}

}  // namespace

std::vector<SeededPoint> read_seeded_points(const fs::path& path, int dimension, const GridSpecification& grid,
                                            double density, bool& have_volumes) {
  const support::Table table = support::read_csv(path);
  const Columns columns = find_columns(table, path, dimension);
  if (table.last_line_was_cut)
    throw support::csv_mistake(
        path, table.lines.back() + 1,
        "the last line has no end, so that a part of it may be missing; end it with a line break");
  const auto* const amounts = columns.volume ? columns.volume : columns.mass;
  have_volumes = amounts != nullptr;
  std::vector<SeededPoint> points;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto mistake = [&](const std::string& what) { return support::csv_mistake(path, table.lines[row], what); };
    SeededPoint point;
    for (int c = 0; c < dimension; ++c) {
      const double x = point.place[c] = (*columns.place[c])[row];
      if (!(x >= grid.lower[c] && x <= grid.upper[c]))
        throw mistake("the point lies outside the domain, or is no number");
    }
    if (grid.symmetry == Symmetry::axisymmetric && !(point.place[0] > 0))
      throw mistake("the point lies on the axis, where a ring has no volume");
    if (amounts) {
      point.volume = (*amounts)[row] / (columns.mass ? density : 1);
      if (!(point.volume > 0) || !std::isfinite(point.volume))
        throw mistake(std::string("expected a ") + (columns.mass ? "mass" : "volume") + " above 0");
    }
    points.push_back(point);
  }
  refuse_equal_points(points, table, path);
  return points;
}

}  // namespace mpm

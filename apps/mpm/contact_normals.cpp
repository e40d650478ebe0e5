// The verb contact-normals: how far contact normals turn from the true one.

#include <iomanip>
#include <iostream>
#include <sstream>

#include "mpm/cli.hpp"
#include "mpm/default_component.hpp"
#include "mpm/evenly.hpp"
#include "render/plot.hpp"
#include "simulation/normal_errors.hpp"

namespace mpm::app {
namespace {

constexpr double disc_radius = 8;      // cells
constexpr int places = 32;             // of each surface in its cell
constexpr double density_ratio = 100;  // of the denser body to the other

/// One row of the table, one curve of a panel.
struct Row {
  std::string name;
  Component normal;
  double density_ratio;
};

bool needs_parameters(const Plugin& plugin) {
  for (const mpm_parameter& parameter : plugin.parameters())
    if (parameter.flags & MPM_REQUIRED) return true;
  return false;
}

/// All normals that need no parameters; those that densities turn between bodies of two densities, as between bodies of one
/// they are those of volumes.
std::vector<Row> rows_of(const Registry& registry) {
  std::vector<Row> rows;
  for (const Plugin* plugin : registry.of_kind(MPM_NORMAL)) {
    if (needs_parameters(*plugin)) continue;
    const bool by_mass = plugin->normal().traits & MPM_READS_MASS_GRADIENT;
    rows.push_back({std::string(plugin->id()) + (by_mass ? ", densities 1:100" : ""), default_component(*plugin),
                    by_mass ? density_ratio : 1});
  }
  return rows;
}

std::string number(double value) {
  std::ostringstream text;
  text << std::setw(10) << std::fixed << std::setprecision(2) << value;
  return text.str();
}

std::vector<NormalErrors> errors_of(const Row& row, const Component& shape, TouchingSurface surface, int particles,
                                    const std::vector<double>& angles) {
  return normal_errors(row.normal, shape, {surface, particles, row.density_ratio}, angles, places);
}

void print_table(const std::vector<Row>& rows, const Component& shape) {
  const std::vector<double> angles{0, 15, 30, 45};
  std::cout << "Angle between contact normals and the true one, rms over nodes, degrees, with " << shape.plugin->id()
            << "\n";
  for (const int particles : {2, 4}) {
    std::cout << "\n" << particles << " particles a cell and axis       face at";
    for (const double angle : angles) std::cout << std::setw(8) << angle << "°";
    std::cout << "     disc  block's end\n";
    for (const Row& row : rows) {
      std::cout << std::left << std::setw(36) << row.name << std::right;
      const auto print = [&](TouchingSurface surface, const std::vector<double>& at) {
        for (const NormalErrors& errors : errors_of(row, shape, surface, particles, at))
          std::cout << number(errors.rms);
      };
      print(TouchingSurface::face, angles), print(TouchingSurface::disc, {22.5}),
          print(TouchingSurface::end_of_block, {0});
      std::cout << "\n";
    }
  }
  std::cout
      << "\nEach body's particles lie on a lattice of its own, turned and shifted otherwise at each of 32 places of "
         "the surface. Nodes\ncount as what contact gives there: by V_a V_b / (V_a + V_b). The disc has a radius of 8 "
         "cells; the block ends on a half plane,\nand nodes less than two cells from its end count. The second of "
         "two densities is that of the block, or around the disc.\n";
}

render::Panel panel(const std::string& title, const std::vector<Row>& rows, const Component& shape, int particles,
                    TouchingSurface surface) {
  render::Panel result{title, {}};
  const bool disc = surface == TouchingSurface::disc;
  const std::vector<double> angles = disc ? evenly(2.5, 42.5, 9) : evenly(0, 45, 10);
  for (const Row& row : rows) {
    std::vector<double> errors;
    for (const NormalErrors& one : errors_of(row, shape, surface, particles, angles)) errors.push_back(one.rms);
    result.series.push_back({row.name, angles, errors});
  }
  return result;
}

/// Draws panels for some surfaces, each with 2 and 4 particles a cell and axis.
void draw(const std::vector<Row>& rows, const Component& shape,
          const std::vector<std::pair<TouchingSurface, std::string>>& surfaces, const std::filesystem::path& stem) {
  render::Multiples figure;
  figure.title = "Error of contact normals with " + std::string(shape.plugin->id());
  figure.x_label = "angle of the surface against the grid (degrees)";
  figure.y_label = "rms error of the normal (degrees)";
  for (const auto& [surface, name] : surfaces)
    for (const int particles : {2, 4})
      figure.panels.push_back(
          panel(name + ", " + std::to_string(particles) + " particles a cell", rows, shape, particles, surface));
  figure.columns = 2;
  figure.height = surfaces.size() > 1 ? 1300 : 900;
  render::write_figure(figure, stem);
}

}  // namespace

int contact_normals(const std::string& id, const std::filesystem::path& figure) {
  const Registry registry = load_registry();
  const Component shape = default_shape(registry, id, Shapes::tensor_products);
  const std::vector<Row> rows = rows_of(registry);
  print_table(rows, shape);
  if (figure.empty()) return done;
  const std::filesystem::path end = figure.string() + "_end";
  draw(rows, shape, {{TouchingSurface::face, "flat face"}, {TouchingSurface::disc, "disc of radius 8 cells"}}, figure);
  draw(rows, shape, {{TouchingSurface::end_of_block, "end of a block"}}, end);
  for (const std::filesystem::path& stem : {figure, end}) std::cout << "\n" << stem.string() << ".png, .svg, .csv";
  std::cout << "\n";
  return done;
}

}  // namespace mpm::app

// The verb contact-offset: how far apart a node sees two bodies that touch.

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <numbers>
#include <sstream>

#include "mpm/cli.hpp"
#include "mpm/default_component.hpp"
#include "mpm/evenly.hpp"
#include "render/plot.hpp"
#include "simulation/contact_offset.hpp"

namespace mpm::app {
namespace {

/// One column of the table, one curve of the figure.
struct Column {
  std::string name;
  TouchingFaces faces;
};

bool follows_axes(const Plugin& shape) {
  return shape.shape().form != MPM_NODE_LIST;
}

std::vector<Column> by_angle(const Plugin& shape, int particles) {
  std::vector<Column> columns{{"along the grid", {particles}}};
  if (!follows_axes(shape)) return columns;
  for (const int degrees : {15, 30, 45})
    columns.push_back({"turned by " + std::to_string(degrees) + "°", {particles, degrees * std::numbers::pi / 180}});
  return columns;
}

std::vector<Column> by_stretch(int particles) {
  return {{"stretched 0.6", {particles, 0, 0.6}}, {"stretched 1.5", {particles, 0, 1.5}}};
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

/// Pads to a width in characters, a degree sign being one of them.
std::string padded(const std::string& text, std::size_t width) {
  const auto characters = static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
  return std::string(characters < width ? width - characters : 0, ' ') + text;
}

/// The largest gap that detection finds between touching faces, of either sign, in cells.
double largest_gap(const Component& shape, const TouchingFaces& faces) {
  double largest = 0;
  for (const double gap : found_gaps(shape, faces, evenly(-0.5, 0.5, 41)))
    if (std::isfinite(gap)) largest = std::max(largest, std::abs(gap));
  return largest;
}

void print_table(const Component& shape, int particles) {
  std::vector<Column> columns = by_angle(*shape.plugin, particles);
  for (Column& column : by_stretch(particles)) columns.push_back(std::move(column));
  const std::vector<double> places = evenly(0, 0.5, 6);
  std::vector<std::vector<double>> offsets;
  for (const Column& column : columns) {
    offsets.push_back(contact_offsets(shape, column.faces, places));
    offsets.back().push_back(mean_contact_offset(shape, column.faces));
  }
  constexpr std::size_t width = 16;
  std::cout
      << "Contact offset of " << shape.plugin->id() << ", " << particles
      << (particles == 1 ? " particle" : " particles")
      << " a cell and axis: how far apart a node sees\nthe mean positions of two bodies that touch, in cells, by the "
         "distance of their faces from the node\n\nfaces at";
  for (const Column& column : columns) std::cout << padded(column.name, width);
  for (std::size_t row = 0; row <= places.size(); ++row) {
    std::cout << "\n" << padded(row < places.size() ? number(places[row], 1) : "mean", 8);
    for (const auto& column : offsets) std::cout << padded(number(column[row], 4), width);
  }
  std::cout << "\n" << padded("gap", 8);
  for (const Column& column : columns) std::cout << padded(number(largest_gap(shape, column.faces), 4), width);
  std::cout
      << "\n\nRows of particles are parallel to the faces; all is the mean over the places along them. The last row is "
         "the largest\ngap, to either side, that detection by position finds between such faces where a node sees "
         "both: it "
         "knows of faces\nalong the grid and of particles as they were seeded. \"detection\": \"particle_surfaces\" "
         "takes the "
         "particles' own sides\ninstead, and finds none.\n";
}

render::Panel panel(const Component& shape, const std::string& title, const std::vector<Column>& columns) {
  render::Panel result{title, {}};
  const std::vector<double> places = evenly(-0.5, 0.5, 41);
  for (const Column& column : columns)
    result.series.push_back({column.name, places, contact_offsets(shape, column.faces, places)});
  return result;
}

void draw(const Component& shape, int particles, const std::filesystem::path& stem) {
  std::vector<Column> counts;
  for (const int n : {1, 2, 3, 4})
    counts.push_back({std::to_string(n) + (n == 1 ? " particle" : " particles") + " a cell and axis", {n}});
  std::vector<Column> stretches = by_stretch(particles);
  stretches.insert(stretches.begin(), {"along the grid", {particles}});
  const std::string of = ", " + std::to_string(particles) + " a cell";
  render::Multiples figure;
  figure.title = "Contact offset of " + std::string(shape.plugin->id());
  figure.x_label = "distance of the faces from the node (cells)";
  figure.y_label = "contact offset (cells)";
  figure.panels.push_back(panel(shape, "particles a cell", counts));
  if (follows_axes(*shape.plugin))
    figure.panels.push_back(panel(shape, "angle of the face" + of, by_angle(*shape.plugin, particles)));
  figure.panels.push_back(panel(shape, "stretch across the face" + of, stretches));
  figure.columns = static_cast<int>(figure.panels.size());
  figure.height = 800;
  render::write_figure(figure, stem);
}

}  // namespace

int contact_offset(const std::string& id, int particles, const std::filesystem::path& figure) {
  const Registry registry = load_registry();
  const Component shape = default_shape(registry, id, Shapes::all);
  print_table(shape, particles);
  if (figure.empty()) return done;
  draw(shape, particles, figure);
  std::cout << "\n" << figure.string() << ".png, .svg, .csv\n";
  return done;
}

}  // namespace mpm::app

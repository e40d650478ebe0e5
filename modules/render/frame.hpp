// A picture of the particles at one instant, in two or three dimensions.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mpm::render {

/// Maps of values to colours. viridis is sequential; diverging is blue-white-red with zero at white; categorical takes
/// the values 0, 1, 2, ...
enum class ColourMap { viridis, diverging, categorical };

/// A node where bodies meet in a 2-D picture, metres: a dot where they stick, a ring where they slip, a cross where they
/// are apart; and a line along the normal.
struct NodeMark {
  enum class State { apart, sticks, slips };
  std::array<double, 2> place{}, normal{};
  State state = State::apart;
};

/// Lengths in metres, times in seconds; n is the number of particles.
struct ParticleFrame {
  int dimension = 2;
  std::array<double, 3> lower{}, upper{};  ///< the domain
  std::vector<float> positions = {};       ///< n * dimension
  std::vector<float> half_size = {};       ///< n: half the particle's side; in 3-D a ball of the same volume is drawn
  std::vector<float> domain_axes = {};     ///< optional, 2-D: n * 4, semi-side vectors of the parallelogram to draw
  std::vector<float> values = {};          ///< n, in `unit`
  std::vector<float> outlines = {};        ///< optional, 2-D: 4 numbers a piece of a rigid body's edge, from and to, m
  std::string quantity = {}, unit = {};    ///< colour bar: "von Mises stress σᵥ" and "Pa"
  std::vector<std::string> categories = {};  ///< names of the values 0, 1, 2, ... of a categorical map
  ColourMap map = ColourMap::viridis;
  std::optional<std::pair<double, double>> range = {};  ///< colour scale, to be fixed over a film; else from the values
  double time = 0;
  long step = 0;
  std::vector<NodeMark> marks = {};  ///< 2-D: drawn over the particles; for their normals cell_size must be given
  double cell_size = 0;              ///< > 0: light grid lines in 2-D, unless the cells are smaller than a few pixels
  int up_axis = -1;                  ///< 3-D: the axis that points upwards on the picture; -1 is the last
  std::string title = {}, footnote = {};
  int width = 1600, height = 1000;  ///< pixels
};

/// Writes STEM.png, STEM.csv (positions and values) and, in 2-D up to 20 000 particles, STEM.svg. Particles with a
/// number that is not finite are left out; the footnote says so. Throws std::invalid_argument when array lengths, the
/// domain or the size do not fit, and std::runtime_error naming path and cause when a file cannot be written, or no
/// font or GL context is there.
void write_frame(const ParticleFrame& frame, const std::filesystem::path& stem);

}  // namespace mpm::render

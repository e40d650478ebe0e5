// The samples of a part of a picture, and particles painted into them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/canvas.hpp"

namespace mpm::render {

/// All samples of a tile as RGBA of 8 bits each, rows from the top.
struct TileSamples {
  Box box;      ///< in pixels of the picture
  int samples;  ///< a pixel in each direction
  int columns, rows;
  std::vector<std::uint8_t>& rgba;
  std::uint8_t* at(int column, int row) const {
    return rgba.data() +
           4 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column));
  }
};

/// Fills a convex quadrilateral of a few samples with an opaque colour, in tiles of one picture. Neighbours that share
/// a side leave no gap and do not overlap.
class SpeckPainter {
 public:
  /// Nothing is painted outside `clip`, in pixels.
  SpeckPainter(const TileSamples& tile, const Box& clip);
  void fill(const std::array<Point, 4>& corners, const Colour& colour) const;

 private:
  const TileSamples& tile_;
  int x0_, y0_, x1_, y1_;  ///< samples within the clip
};

}  // namespace mpm::render

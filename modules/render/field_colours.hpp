// The colour of a particle's value, and the key that says which is which.
#pragma once

#include <vector>

#include "render/chart.hpp"
#include "render/frame.hpp"

namespace mpm::render {

/// Resolves a frame's colour scale once for all of its particles.
class FieldColours {
 public:
  /// Resolves the scale; `shown` holds the indices of the particles that are drawn.
  FieldColours(const ParticleFrame& frame, const std::vector<std::size_t>& shown);

  Colour operator()(double value) const;

  /// Pixels that the key needs at the right.
  double key_width(const Canvas& canvas, const Theme& theme, double height) const;
  /// Draws the colour bar, or the list of categories, at the left edge of the box.
  void draw_key(Canvas& canvas, const Theme& theme, const Box& box) const;

 private:
  Ticks ticks(const Theme& theme, double height) const;
  void draw_bar(Canvas& canvas, const Theme& theme, const Box& box) const;
  std::vector<std::string> heading(const Canvas& canvas, const Theme& theme, double height) const;

  ColourMap map_;
  std::string label_;
  std::vector<std::string> categories_;
  double lo_ = 0, hi_ = 1;
  bool is_above_ = false, is_below_ = false;  ///< values beyond a range that was given
};

}  // namespace mpm::render

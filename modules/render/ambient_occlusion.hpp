// How much open sky each pixel of a rendered scene sees.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace mpm::render {

/// A sample for each pixel of a part of a picture: how far ahead of the eye it lies, and which way it faces.
struct GeometryBuffer {
  GeometryBuffer(int columns, int rows) : width(columns), height(rows) {
    for (auto* values : {&ahead, &normal_x, &normal_y, &normal_z})
      values->resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  }
  void set(std::size_t at, float distance, const std::array<float, 3>& normal) {
    ahead[at] = distance, normal_x[at] = normal[0], normal_y[at] = normal[1], normal_z[at] = normal[2];
  }
  /// What lies `ahead` in column x and row y lies at `ahead` times (right_of(x), up_of(y), -1), seen from the eye.
  float right_of(int x) const { return left + static_cast<float>(x) * pixel; }
  float up_of(int y) const { return top - static_cast<float>(y) * pixel; }

  int width, height;
  float left = 0, top = 0, pixel = 1;
  float longest_reach = 1;   ///< pixels within which neighbours may darken
  std::vector<float> ahead;  ///< m; 0 marks the background
  std::vector<float> normal_x, normal_y, normal_z;
};

/// Open fraction of the hemisphere in [0, 1] per pixel, 1 for the background. `radii` are the lengths in the scene's
/// unit within which neighbours darken.
std::vector<float> open_sky(const GeometryBuffer& geometry, const std::array<double, 2>& radii);

}  // namespace mpm::render

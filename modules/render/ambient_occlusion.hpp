// How much open sky each pixel of a rendered scene sees.
#pragma once

#include <array>
#include <vector>

namespace mpm::render {

/// A sample for each pixel: where it lies seen from the eye (z < 0 in front), and which way it faces; z = 0 marks the
/// background.
struct GeometryBuffer {
  int width = 0, height = 0;
  std::vector<std::array<float, 3>> position, normal;
};

/// Open fraction of the hemisphere in [0, 1] per pixel, 1 for the background. `radii` are the lengths in the scene's
/// unit within which neighbours darken; `scale` is pixels per unit of tangent.
std::vector<float> open_sky(const GeometryBuffer& geometry, const std::array<double, 2>& radii, double scale);

}  // namespace mpm::render

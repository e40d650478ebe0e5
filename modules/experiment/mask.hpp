#pragma once
// Pictures as regions of the plane.

#include <filesystem>

#include "experiment/geometry.hpp"

namespace mpm {

/// Darkness of a picture: 1 black and opaque, 0 white or transparent; rows from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<double> darkness;
};

/// Reads a PNG file. Throws std::runtime_error with libpng's reason.
Picture read_picture(const std::filesystem::path& path);

/// Where a picture that spans a box is at least as dark as `threshold`, or where `bright` at most: darkness is linear
/// between the middles of pixels.
GeometryPointer make_mask(Picture picture, const Vector3& lower, const Vector3& upper, double threshold, bool bright);

}  // namespace mpm

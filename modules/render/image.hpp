// A raster image in memory, and PNG.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace mpm::render {

/// 8-bit RGB, rows from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  Image() = default;
  Image(int w, int h) : width(w), height(h), rgb(static_cast<std::size_t>(w) * h * 3, 255) {}
  std::uint8_t* at(int x, int y) { return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x); }
  const std::uint8_t* at(int x, int y) const { return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x); }
};

/// The mean of `samples` by `samples` values for each pixel, of RGBA values in rows of `columns`.
Image mean_of(const std::vector<std::uint8_t>& rgba, int columns, int rows, int samples);

/// The bytes of a PNG file. Throws std::runtime_error when libpng refuses.
std::string encode_png(const Image& image);

/// Reads a PNG file. Throws std::runtime_error naming the path and libpng's reason.
Image read_png(const std::filesystem::path& path);

}  // namespace mpm::render

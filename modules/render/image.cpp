#include "render/image.hpp"

#include <bit>
#include <cstring>
#include <stdexcept>

#include <png.h>
#include <zlib.h>

namespace mpm::render {

namespace {

/// What libpng needs to write; freed however the writing ends.
struct PngWriter {
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

[[noreturn]] void fail(png_structp, png_const_charp message) {
  throw std::runtime_error(std::string("PNG could not be encoded: ") + message);
}

}  // namespace

Image mean_of(const std::vector<std::uint8_t>& rgba, int columns, int rows, int samples_a_side) {
  static_assert(std::endian::native == std::endian::little, "red is the lowest of four sums");
  Image result(columns / samples_a_side, rows / samples_a_side);
  const std::size_t row = static_cast<std::size_t>(columns) * 4, samples = static_cast<std::size_t>(samples_a_side);
  const unsigned count = static_cast<unsigned>(samples * samples);
  std::vector<std::uint8_t> mean(count * 255 + 1);  // of a sum, rounded
  for (unsigned sum = 0; sum < mean.size(); ++sum) mean[sum] = static_cast<std::uint8_t>((sum + count / 2) / count);
  std::vector<std::uint16_t> sums(row);  // over the rows of a pixel
  for (int y = 0; y < result.height; ++y) {
    const std::uint8_t* top = rgba.data() + static_cast<std::size_t>(y) * samples * row;
    for (std::size_t i = 0; i < row; ++i) sums[i] = top[i];
    for (std::size_t j = 1; j < samples; ++j)
      for (std::size_t i = 0; i < row; ++i) sums[i] = static_cast<std::uint16_t>(sums[i] + top[j * row + i]);
    std::uint8_t* out = result.at(0, y);
    const std::uint16_t* next = sums.data();
    for (int x = 0; x < result.width; ++x, out += 3) {
      // The four sums of a sample are added at once, as one number: none of them grows into the next.
      std::uint64_t four = 0;
      for (std::size_t i = 0; i < samples; ++i, next += 4) {
        std::uint64_t sample;
        std::memcpy(&sample, next, sizeof sample);
        four += sample;
      }
      for (int c = 0; c < 3; ++c) out[c] = mean[four >> 16 * c & 0xFFFF];
    }
  }
  return result;
}

std::string encode_png(const Image& image) {
  std::string bytes;
  PngWriter writer;
  writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, nullptr);
  if (writer.png) writer.info = png_create_info_struct(writer.png);
  if (!writer.info) throw std::runtime_error("PNG could not be encoded: no memory");
  png_set_write_fn(
      writer.png, &bytes,
      [](png_structp png, png_bytep data, png_size_t size) {
        static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
      },
      [](png_structp) {});
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
               8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // One filter and runs of bytes alone: as large as level 3 within a tenth, in three quarters of the time.
  png_set_compression_level(writer.png, 1);
  png_set_compression_strategy(writer.png, Z_RLE);
  png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
  png_write_info(writer.png, writer.info);
  for (int y = 0; y < image.height; ++y)
    png_write_row(writer.png,
                  image.rgb.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) * 3);
  png_write_end(writer.png, nullptr);
  return bytes;
}

Image read_png(const std::filesystem::path& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  const auto fail = [&] { throw std::runtime_error("cannot read '" + path.string() + "': " + header.message); };
  if (!png_image_begin_read_from_file(&header, path.c_str())) fail();
  header.format = PNG_FORMAT_RGB;
  Image image(static_cast<int>(header.width), static_cast<int>(header.height));
  if (!png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr)) fail();
  return image;
}

}  // namespace mpm::render

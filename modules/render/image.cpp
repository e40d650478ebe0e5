#include "render/image.hpp"

#include <stdexcept>

#include <png.h>

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
  // Level 3 with one filter takes a fifth of the time of libpng's own choice; frames become a tenth larger.
  png_set_compression_level(writer.png, 3);
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

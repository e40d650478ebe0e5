#include "render/image.hpp"

#include <stdexcept>

#include <png.h>

namespace mpm::render {

std::string encode_png(const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr)) {
    throw std::runtime_error(std::string("PNG could not be encoded: ") + header.message);
  }
  bytes.resize(size);
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

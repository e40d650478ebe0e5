// The one file that owns OSMesa, so that another off-screen surface can take its place.
#include "render/osmesa_context.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <GL/osmesa.h>

namespace mpm::render {

void OsMesaContext::Deleter::operator()(void* context) const {
  OSMesaDestroyContext(static_cast<OSMesaContext>(context));
}

OsMesaContext::OsMesaContext(int width, int height) : width_(width), height_(height) {
  const std::string remedy =
      "; check that the Debian package libosmesa6 is installed, that memory suffices, and ask for a smaller figure";
  if (width <= 0 || height <= 0) throw std::runtime_error("an image needs a positive size" + remedy);
  pixels_.assign(static_cast<std::size_t>(width) * height * 4, 255);
  const int attributes[] = {
      OSMESA_FORMAT, OSMESA_RGBA, OSMESA_DEPTH_BITS, 24, OSMESA_PROFILE, OSMESA_COMPAT_PROFILE, 0};
  context_.reset(OSMesaCreateContextAttribs(attributes, nullptr));
  if (!context_) throw std::runtime_error("OSMesa could not make an off-screen OpenGL context" + remedy);
  auto* context = static_cast<OSMesaContext>(context_.get());
  if (!OSMesaMakeCurrent(context, pixels_.data(), GL_UNSIGNED_BYTE, width, height)) {
    throw std::runtime_error("OSMesa refused an image of " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels" + remedy);
  }
  OSMesaPixelStore(OSMESA_Y_UP, 0);
}

OsMesaContext::~OsMesaContext() = default;

void OsMesaContext::finish() {
  glFinish();
}

std::vector<float> OsMesaContext::depth() {
  finish();
  std::vector<float> values(static_cast<std::size_t>(width_) * height_);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, values.data());
  for (int row = 0; row < height_ / 2; ++row) {
    std::swap_ranges(values.begin() + static_cast<std::ptrdiff_t>(row) * width_,
                     values.begin() + static_cast<std::ptrdiff_t>(row + 1) * width_,
                     values.begin() + static_cast<std::ptrdiff_t>(height_ - 1 - row) * width_);
  }
  return values;
}

}  // namespace mpm::render

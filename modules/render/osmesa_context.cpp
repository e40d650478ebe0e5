// The one file that owns OSMesa, so that another off-screen surface can take its place.
#include "render/osmesa_context.hpp"

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <string>

#include <GL/osmesa.h>

namespace mpm::render {

void OsMesaContext::Deleter::operator()(void* context) const {
  OSMesaDestroyContext(static_cast<OSMesaContext>(context));
}

namespace {
constexpr std::size_t most_idle = 2;  ///< frames and the tiles of a figure take turns
constexpr const char* remedy =
    "; check that the Debian package libosmesa6 is installed, that memory suffices, and ask for a smaller figure";
}  // namespace

std::vector<std::unique_ptr<OsMesaContext::Surface>>& OsMesaContext::idle() {
  static thread_local std::vector<std::unique_ptr<Surface>> surfaces;
  return surfaces;
}

std::unique_ptr<OsMesaContext::Surface> OsMesaContext::made(int width, int height) {
  // The first context of a program sets up what all share.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  if (width <= 0 || height <= 0) throw std::runtime_error(std::string("an image needs a positive size") + remedy);
  auto surface = std::make_unique<Surface>();
  surface->width = width, surface->height = height;
  surface->pixels.resize(static_cast<std::size_t>(width) * height * 4);
  const int attributes[] = {OSMESA_FORMAT, OSMESA_RGBA, OSMESA_DEPTH_BITS, 0, OSMESA_PROFILE, OSMESA_COMPAT_PROFILE, 0};
  surface->context.reset(OSMesaCreateContextAttribs(attributes, nullptr));
  if (!surface->context)
    throw std::runtime_error(std::string("OSMesa could not make an off-screen OpenGL context") + remedy);
  return surface;
}

OsMesaContext::OsMesaContext(int width, int height) {
  auto& kept = idle();
  const auto fitting = std::find_if(kept.begin(), kept.end(), [&](const std::unique_ptr<Surface>& surface) {
    return surface->width == width && surface->height == height;
  });
  if (fitting != kept.end()) {
    surface_ = std::move(*fitting);
    kept.erase(fitting);
  } else {
    surface_ = made(width, height);
  }
  auto* context = static_cast<OSMesaContext>(surface_->context.get());
  if (!OSMesaMakeCurrent(context, surface_->pixels.data(), GL_UNSIGNED_BYTE, width, height)) {
    throw std::runtime_error("OSMesa refused an image of " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels" + remedy);
  }
  OSMesaPixelStore(OSMESA_Y_UP, 0);
  glPushAttrib(GL_ALL_ATTRIB_BITS);
  glPushClientAttrib(GL_CLIENT_ALL_ATTRIB_BITS);
}

OsMesaContext::~OsMesaContext() {
  auto* context = static_cast<OSMesaContext>(surface_->context.get());
  if (!OSMesaMakeCurrent(context, surface_->pixels.data(), GL_UNSIGNED_BYTE, width(), height())) return;
  glFinish();
  glPopClientAttrib();
  glPopAttrib();
  auto& kept = idle();
  if (kept.size() == most_idle) kept.erase(kept.begin());
  kept.push_back(std::move(surface_));
}

void OsMesaContext::finish() {
  glFinish();
}

}  // namespace mpm::render

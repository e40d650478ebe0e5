// An OpenGL context that draws into memory, without a window or a display.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace mpm::render {

/// A compatibility context without depth buffer; it is current on the creating thread while it lives, unless another is
/// made. Each thread keeps the last few for the next pictures of their size: to make one costs more than to draw. State
/// and matrices are as in a new one; textures and programs are to be deleted by who made them.
class OsMesaContext {
 public:
  /// Makes a context of `width` by `height` pixels. Throws std::runtime_error with a remedy when the context cannot be
  /// made.
  OsMesaContext(int width, int height);
  ~OsMesaContext();
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;

  int width() const { return surface_->width; }
  int height() const { return surface_->height; }
  /// The picture as RGBA, rows from the top; complete after finish(), when it may be painted over if nothing is drawn
  /// any more. It begins as an earlier picture left it.
  std::vector<std::uint8_t>& pixels() { return surface_->pixels; }
  /// Waits for all drawing.
  void finish();

 private:
  struct Deleter {
    void operator()(void* context) const;
  };
  struct Surface {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
    std::unique_ptr<void, Deleter> context;
  };
  static std::unique_ptr<Surface> made(int width, int height);
  static std::vector<std::unique_ptr<Surface>>& idle();

  std::unique_ptr<Surface> surface_;
};

}  // namespace mpm::render

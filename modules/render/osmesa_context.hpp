// An OpenGL context that draws into memory, without a window or a display.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace mpm::render {

/// A compatibility context with depth buffer; it is current on the creating thread while it lives, unless another is
/// made.
class OsMesaContext {
 public:
  /// Makes a context of `width` by `height` pixels. Throws std::runtime_error with a remedy when the context cannot be
  /// made.
  OsMesaContext(int width, int height);
  ~OsMesaContext();
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  /// The picture as RGBA, rows from the top; complete after finish().
  const std::vector<std::uint8_t>& pixels() const { return pixels_; }
  /// Waits for all drawing.
  void finish();
  /// Depth of every pixel in [0, 1], rows from the top; waits for all drawing.
  std::vector<float> depth();

 private:
  struct Deleter {
    void operator()(void* context) const;
  };
  int width_, height_;
  std::vector<std::uint8_t> pixels_;
  std::unique_ptr<void, Deleter> context_;
};

}  // namespace mpm::render

#include "experiment/mask.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace mpm {
namespace {

class Mask final : public Geometry {
 public:
  Mask(Picture picture, const Vector3& lower, const Vector3& upper, double threshold, bool bright)
      : picture_(std::move(picture)), lower_(lower), upper_(upper), threshold_(threshold), bright_(bright) {
    double across = 0, up = 0;
    for (int y = 0; y < picture_.height; ++y)
      for (int x = 0; x < picture_.width; ++x) {
        if (x > 0) across = std::max(across, std::abs(pixel(x, y) - pixel(x - 1, y)));
        if (y > 0) up = std::max(up, std::abs(pixel(x, y) - pixel(x, y - 1)));
      }
    steepest_ =
        std::hypot(across * picture_.width / (upper[0] - lower[0]), up * picture_.height / (upper[1] - lower[1]));
  }
  bool contains(const Vector3& point) const override { return distance(point) <= 0; }
  std::pair<Vector3, Vector3> bounds() const override { return {lower_, upper_}; }
  double distance(const Vector3& point) const override {
    const double beyond = std::max(std::max(lower_[0] - point[0], point[0] - upper_[0]),
                                   std::max(lower_[1] - point[1], point[1] - upper_[1]));
    double lacks = threshold_ - darkness(point);
    if (bright_) lacks = -lacks;
    if (steepest_ == 0) return lacks > 0 ? std::max(beyond, upper_[0] - lower_[0]) : beyond;
    return std::max(beyond, lacks / steepest_);
  }
  /// The line on which the distance vanishes, by marching squares of `spacing` or of a pixel, whichever is smaller.
  Surface surface(double spacing, const std::pair<Vector3, Vector3>&) const override {
    Surface pieces;
    long count[2];
    double side[2];
    for (int c = 0; c < 2; ++c) {
      const double length = upper_[c] - lower_[c];
      count[c] =
          std::lround(std::ceil(length / std::min(spacing, length / (c == 0 ? picture_.width : picture_.height))));
      side[c] = length / static_cast<double>(count[c]);
    }
    // A square more on every side, so that edges of the picture are found too.
    for (long j = -1; j <= count[1]; ++j)
      for (long i = -1; i <= count[0]; ++i) {
        const auto corner = [&](int right, int up) -> Vector3 {
          return {lower_[0] + (static_cast<double>(i + right) - 1e-6) * side[0],
                  lower_[1] + (static_cast<double>(j + up) - 1e-6) * side[1], 0};
        };
        add_crossing(pieces, corner(0, 0), corner(1, 0), corner(1, 1));
        add_crossing(pieces, corner(0, 0), corner(1, 1), corner(0, 1));
      }
    return pieces;
  }
  std::pair<double, double> extent(const Vector3& direction) const override {
    return make_box(2, lower_, upper_)->extent(direction);
  }

 private:
  /// Adds the edge across which the distance changes its sign in a triangle, where it is taken as linear.
  void add_crossing(Surface& pieces, const Vector3& a, const Vector3& b, const Vector3& c) const {
    const Vector3 corners[] = {a, b, c};
    const double values[] = {distance(a), distance(b), distance(c)};
    std::vector<Vector3> ends;
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      if ((values[k] <= 0) == (values[l] <= 0)) continue;
      const double share = values[k] / (values[k] - values[l]);
      ends.push_back({corners[k][0] + share * (corners[l][0] - corners[k][0]),
                      corners[k][1] + share * (corners[l][1] - corners[k][1]), 0});
    }
    if (ends.size() != 2) return;
    const double x = ends[1][0] - ends[0][0], y = ends[1][1] - ends[0][1], length = std::hypot(x, y);
    if (length == 0) return;
    Vector3 normal{y / length, -x / length, 0};
    // It points to the corners outside.
    for (int k = 0; k < 3; ++k) {
      const double side = normal[0] * (corners[k][0] - ends[0][0]) + normal[1] * (corners[k][1] - ends[0][1]);
      if (values[k] > 0 && side < 0) {
        normal = {-normal[0], -normal[1], 0};
        break;
      }
    }
    pieces.push_back({{(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2, 0}, normal, length});
  }

  double pixel(int x, int y) const {
    x = std::clamp(x, 0, picture_.width - 1), y = std::clamp(y, 0, picture_.height - 1);
    return picture_.darkness[static_cast<std::size_t>(y) * picture_.width + x];
  }
  double darkness(const Vector3& p) const {
    const double x = std::clamp((p[0] - lower_[0]) / (upper_[0] - lower_[0]), 0.0, 1.0) * picture_.width - 0.5;
    const double y = std::clamp((upper_[1] - p[1]) / (upper_[1] - lower_[1]), 0.0, 1.0) * picture_.height - 0.5;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const double u = x - i, v = y - j;
    return (1 - v) * ((1 - u) * pixel(i, j) + u * pixel(i + 1, j)) +
           v * ((1 - u) * pixel(i, j + 1) + u * pixel(i + 1, j + 1));
  }

  Picture picture_;
  Vector3 lower_, upper_;
  double threshold_;
  bool bright_;
  double steepest_ = 0;  ///< 1/m, bound of the gradient of the darkness
};

}  // namespace

Picture read_picture(const std::filesystem::path& path) {
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, path.c_str())) throw std::runtime_error(image.message);
  image.format = PNG_FORMAT_GA;
  std::vector<png_byte> bytes(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr)) {
    const std::string reason = image.message;
    png_image_free(&image);
    throw std::runtime_error(reason);
  }
  Picture picture;
  picture.width = static_cast<int>(image.width), picture.height = static_cast<int>(image.height);
  for (std::size_t k = 0; k + 1 < bytes.size(); k += 2)
    picture.darkness.push_back((1 - bytes[k] / 255.0) * (bytes[k + 1] / 255.0));
  return picture;
}

GeometryPointer make_mask(Picture picture, const Vector3& lower, const Vector3& upper, double threshold, bool bright) {
  return std::make_shared<Mask>(std::move(picture), lower, upper, threshold, bright);
}

}  // namespace mpm

#include "render/colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace mpm::render {
namespace {

constexpr Colour from_hex(unsigned rgb) {
  return {((rgb >> 16) & 255) / 255.0, ((rgb >> 8) & 255) / 255.0, (rgb & 255) / 255.0};
}

/// Okabe & Ito (2008); black is kept for exact and published data, yellow comes last because it is faint on white.
constexpr std::array<Colour, 7> kPalette{from_hex(0x0072B2), from_hex(0xD55E00), from_hex(0x009E73), from_hex(0xE69F00),
                                         from_hex(0xCC79A7), from_hex(0x56B4E9), from_hex(0xF0E442)};

/// ColorBrewer's red-blue map with its centre moved from light grey to pure white.
constexpr std::array<Colour, 11> kDiverging{
    from_hex(0x053061), from_hex(0x2166AC), from_hex(0x4393C3), from_hex(0x92C5DE), from_hex(0xD1E5F0), kWhite,
    from_hex(0xFDDBC7), from_hex(0xF4A582), from_hex(0xD6604D), from_hex(0xB2182B), from_hex(0x67001F)};

/// Polynomial fit of matplotlib's viridis by M. Zucker, coefficients of t^0 ... t^6.
constexpr std::array<Colour, 7> kViridis{{{0.2777273272, 0.0054073445, 0.3340998053},
                                          {0.1050930431, 1.4046135299, 1.3845901626},
                                          {-0.3308618287, 0.2148475595, 0.0950951630},
                                          {-4.6342304990, -5.7991009734, -19.3324409563},
                                          {6.2282699363, 14.1799333668, 56.6905526007},
                                          {4.7763849977, -13.7451453777, -65.3530326334},
                                          {-5.4354558559, 4.6458526122, 26.3123352496}}};

double relative_luminance(const Colour& c) {
  const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
}

}  // namespace

Colour palette(std::size_t index) {
  return kPalette[index % kPalette.size()];
}

Colour viridis(double t) {
  t = std::clamp(t, 0.0, 1.0);
  Colour sum{0, 0, 0};
  for (auto c = kViridis.rbegin(); c != kViridis.rend(); ++c) {
    sum = {sum.r * t + c->r, sum.g * t + c->g, sum.b * t + c->b};
  }
  return {std::clamp(sum.r, 0.0, 1.0), std::clamp(sum.g, 0.0, 1.0), std::clamp(sum.b, 0.0, 1.0)};
}

Colour diverging(double t) {
  const double position = (std::clamp(t, -1.0, 1.0) + 1) / 2 * (kDiverging.size() - 1);
  const auto cell = std::min(static_cast<std::size_t>(position), kDiverging.size() - 2);
  return mix(kDiverging[cell], kDiverging[cell + 1], position - static_cast<double>(cell));
}

Colour mix(const Colour& a, const Colour& b, double t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t, a.a + (b.a - a.a) * t};
}

Colour readable_text(const Colour& colour) {
  // 4.5:1 against white is WCAG's threshold for normal text.
  Colour result = colour;
  while (1.05 / (relative_luminance(result) + 0.05) < 4.5) result = {result.r * 0.95, result.g * 0.95, result.b * 0.95};
  return result;
}

Colour text_upon(const Colour& ground) {
  // Contrasts are ratios of luminances raised by 0.05; black and white tie where that is the root of 1.05 x 0.05.
  return relative_luminance(ground) + 0.05 > std::sqrt(1.05 * 0.05) ? kBlack : kWhite;
}

std::string hex(const Colour& colour) {
  const auto byte = [](double v) { return static_cast<int>(std::lround(std::clamp(v, 0.0, 1.0) * 255)); };
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", byte(colour.r) & 255, byte(colour.g) & 255, byte(colour.b) & 255);
  return text;
}

}  // namespace mpm::render

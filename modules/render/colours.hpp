// Colours: the fixed palette of series and the maps of fields.
#pragma once

#include <cstddef>
#include <string>

namespace mpm::render {

/// sRGB components and opacity, each in [0, 1].
struct Colour {
  double r = 0, g = 0, b = 0, a = 1;
  friend bool operator==(const Colour&, const Colour&) = default;
};

inline constexpr Colour kInk{0.13, 0.13, 0.13};
inline constexpr Colour kQuiet{0.40, 0.40, 0.40};
inline constexpr Colour kGrid{0.88, 0.88, 0.88};
inline constexpr Colour kWhite{1, 1, 1};
inline constexpr Colour kBlack{0, 0, 0};

/// The Okabe-Ito palette in the project's fixed order; it repeats after seven colours.
Colour palette(std::size_t index);

/// Viridis at t in [0, 1]; t is clamped.
Colour viridis(double t);

/// Blue-white-red at t in [-1, 1], exactly white at 0; t is clamped.
Colour diverging(double t);

/// The mixture a + (b - a) t, opacity included.
Colour mix(const Colour& a, const Colour& b, double t);

/// A colour of the same hue, dark enough to be read as text on white.
Colour readable_text(const Colour& colour);

/// Black or white, whichever is easier to read upon `ground`.
Colour text_upon(const Colour& ground);

/// The colour as "#rrggbb", opacity left out.
std::string hex(const Colour& colour);

}  // namespace mpm::render

// Glyphs of the one sans font of all figures, rasterised by FreeType.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace mpm::render {

/// A glyph ready to be laid out: which outline, at which scale of the em, raised by how much of the em.
struct GlyphPlace {
  int face = 0;        ///< index into the font set
  unsigned glyph = 0;  ///< FreeType's glyph index
  double scale = 1;    ///< superscripts and subscripts are smaller
  double rise = 0;     ///< em, upwards
  double advance = 0;  ///< em of the whole string's size
};

/// Coverage 0..255 in rows of `width`; (left, top) is the bitmap's corner from the pen, y upwards, pixels.
struct GlyphBitmap {
  int width = 0, height = 0, left = 0, top = 0;
  std::vector<std::uint8_t> coverage;
};

/// The fonts of figures: Open Sans, with DejaVu Sans for the glyphs it lacks; either alone will do. Each thread has one
/// instance.
class FontSet {
 public:
  /// The calling thread's fonts. Throws std::runtime_error naming the Debian package when no usable font is installed.
  static FontSet& of_this_thread();

  std::vector<GlyphPlace> place(std::string_view utf8, bool bold) const;
  /// The bitmap of a glyph; `pixels` is the size of the em in pixels.
  GlyphBitmap rasterise(int face, unsigned glyph, double pixels) const;
  /// Width of the text in em.
  double width(std::string_view utf8, bool bold) const;

  ~FontSet();

 private:
  FontSet();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Height of a capital letter in em, for vertical centring.
inline constexpr double kCapHeight = 0.714;
/// Depth of descenders below the baseline in em.
inline constexpr double kDescent = 0.24;

/// Code points of a UTF-8 string; malformed bytes become U+FFFD.
std::vector<char32_t> decode_utf8(std::string_view utf8);

}  // namespace mpm::render

#include "render/font.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include <ft2build.h>
#include FT_FREETYPE_H

namespace mpm::render {
namespace {

constexpr std::array<const char*, 2> kRegular{"open-sans/OpenSans-Regular.ttf", "dejavu/DejaVuSans.ttf"};
constexpr std::array<const char*, 2> kBold{"open-sans/OpenSans-Bold.ttf", "dejavu/DejaVuSans-Bold.ttf"};
constexpr std::array<const char*, 3> kFolders{"/usr/share/fonts/truetype", "/usr/local/share/fonts/truetype",
                                              "/usr/share/fonts"};

std::string find_font(const char* name) {
  for (const char* folder : kFolders) {
    const auto path = std::filesystem::path(folder) / name;
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored)) return path.string();
  }
  return {};
}

/// Superscripts are the ordinary glyph, smaller and raised: a font's own set is rarely complete, and a mix of fonts
/// shows.
struct Shifted {
  char32_t base;
  double rise;
};

Shifted shifted_glyph(char32_t code) {
  constexpr double up = 0.36, down = -0.14;
  switch (code) {
    case U'¹':
      return {U'1', up};
    case U'²':
      return {U'2', up};
    case U'³':
      return {U'3', up};
    case U'⁺':
      return {U'+', up};
    case U'⁻':
      return {U'−', up};
    case U'ⁿ':
      return {U'n', up};
    case U'ⁱ':
      return {U'i', up};
    case U'₊':
      return {U'+', down};
    case U'₋':
      return {U'−', down};
    default:
      break;
  }
  if (code == U'⁰' || (code >= U'⁴' && code <= U'⁹')) return {U'0' + (code - U'⁰'), up};
  if (code >= U'₀' && code <= U'₉') return {U'0' + (code - U'₀'), down};
  return {0, 0};
}

}  // namespace

std::vector<char32_t> decode_utf8(std::string_view utf8) {
  std::vector<char32_t> codes;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const int extra = lead < 0x80 ? 0 : (lead >> 5) == 6 ? 1 : (lead >> 4) == 14 ? 2 : (lead >> 3) == 30 ? 3 : -1;
    char32_t code = extra < 0 ? 0xFFFD : extra == 0 ? lead : lead & (0x3F >> extra);
    std::size_t used = 1;
    for (int k = 0; k < extra; ++k, ++used) {
      if (i + used >= utf8.size() || (static_cast<unsigned char>(utf8[i + used]) & 0xC0) != 0x80) {
        code = 0xFFFD;
        break;
      }
      code = (code << 6) | (static_cast<unsigned char>(utf8[i + used]) & 0x3F);
    }
    codes.push_back(code);
    i += used;
  }
  return codes;
}

struct FontSet::Impl {
  FT_Library library = nullptr;
  std::vector<FT_Face> faces;
  std::vector<int> regular, bold;  ///< faces in the order in which a glyph is looked for

  void open(const char* name, std::vector<int>& chain) {
    const std::string path = find_font(name);
    FT_Face face = nullptr;
    if (path.empty() || FT_New_Face(library, path.c_str(), 0, &face) != 0) return;
    chain.push_back(static_cast<int>(faces.size()));
    faces.push_back(face);
  }

  std::pair<int, unsigned> find(char32_t code, bool is_bold) const {
    const auto& chain = is_bold && !bold.empty() ? bold : regular;
    for (const int face : chain) {
      const unsigned glyph = FT_Get_Char_Index(faces[face], code);
      if (glyph != 0) return {face, glyph};
    }
    return {chain.front(), 0};
  }

  double advance(int face, unsigned glyph) const {
    if (FT_Load_Glyph(faces[face], glyph, FT_LOAD_NO_SCALE) != 0) return 0;
    return static_cast<double>(faces[face]->glyph->advance.x) / faces[face]->units_per_EM;
  }
};

FontSet::FontSet() : impl_(std::make_unique<Impl>()) {
  if (FT_Init_FreeType(&impl_->library) != 0) throw std::runtime_error("FreeType could not be started");
  for (const char* name : kRegular) impl_->open(name, impl_->regular);
  for (const char* name : kBold) impl_->open(name, impl_->bold);
  if (impl_->regular.empty()) {
    FT_Done_FreeType(impl_->library);
    throw std::runtime_error(
        "no font for the figures was found under /usr/share/fonts: install the Debian package fonts-open-sans or "
        "fonts-dejavu-core");
  }
}

FontSet::~FontSet() {
  if (impl_) FT_Done_FreeType(impl_->library);
}

FontSet& FontSet::of_this_thread() {
  // A FreeType library may be used by one thread at a time.
  static thread_local FontSet fonts;
  return fonts;
}

std::vector<GlyphPlace> FontSet::place(std::string_view utf8, bool bold) const {
  std::vector<GlyphPlace> places;
  for (const char32_t code : decode_utf8(utf8)) {
    const Shifted shifted = shifted_glyph(code);
    const double scale = shifted.base ? 0.68 : 1;
    const auto [face, glyph] = impl_->find(shifted.base ? shifted.base : code, bold);
    places.push_back({face, glyph, scale, shifted.rise, impl_->advance(face, glyph) * scale});
  }
  return places;
}

GlyphBitmap FontSet::rasterise(int face_index, unsigned glyph, double pixels) const {
  FT_Face face = impl_->faces.at(face_index);
  FT_Set_Char_Size(face, 0, std::lround(pixels * 64), 72, 72);
  GlyphBitmap bitmap;
  // Hinting would make the text's width depend on the size; supersampling gives the sharpness instead.
  if (FT_Load_Glyph(face, glyph, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP) != 0) return bitmap;
  if (FT_Render_Glyph(face->glyph, FT_RENDER_MODE_NORMAL) != 0) return bitmap;
  const FT_Bitmap& source = face->glyph->bitmap;
  bitmap.width = static_cast<int>(source.width);
  bitmap.height = static_cast<int>(source.rows);
  bitmap.left = face->glyph->bitmap_left;
  bitmap.top = face->glyph->bitmap_top;
  for (int row = 0; row < bitmap.height; ++row) {
    const auto* begin = source.buffer + static_cast<std::ptrdiff_t>(row) * source.pitch;
    bitmap.coverage.insert(bitmap.coverage.end(), begin, begin + bitmap.width);
  }
  return bitmap;
}

double FontSet::width(std::string_view utf8, bool bold) const {
  double sum = 0;
  for (const GlyphPlace& place : place(utf8, bold)) sum += place.advance;
  return sum;
}

}  // namespace mpm::render

// SPDX-License-Identifier: Apache-2.0
#include "font.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace film {
namespace {

constexpr std::string_view kCut = "...";

FT_ULong printable(char letter) {
  const bool is_ascii = letter >= ' ' && letter <= '~';
  return static_cast<FT_ULong>(is_ascii ? letter : '?');
}

/// How many letters of the text fit into the width, at least one.
std::size_t fitting(const Font& font, std::string_view text, int width, int size) {
  std::size_t fits = 1;
  std::size_t too_many = text.size() + 1;
  while (fits + 1 < too_many) {
    const std::size_t middle = fits + (too_many - fits) / 2;
    (font.width(text.substr(0, middle), size) <= width ? fits : too_many) = middle;
  }
  return fits;
}

std::vector<std::string> wrap(const Font& font, std::string_view text, int width, int size) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    std::size_t end = fitting(font, text, width, size);
    if (end < text.size() && text[end] != ' ') {
      const auto blank = text.substr(0, end).rfind(' ');
      if (blank != std::string_view::npos && blank > 0) end = blank;
    }
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(end);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  }
  return lines;
}

}  // namespace

struct Font::Face {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  std::map<int, std::array<FT_Pos, 128>> known_advances;

  Face() = default;
  Face(const Face&) = delete;
  Face& operator=(const Face&) = delete;
  ~Face() {
    FT_Done_Face(face);
    FT_Done_FreeType(library);
  }
  /// In 64ths of a pixel, of ASCII; finding them out takes longer than adding them.
  const std::array<FT_Pos, 128>& advances(int size) {
    const auto [known, is_new] = known_advances.try_emplace(size);
    if (!is_new) return known->second;
    FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(size));
    for (char letter = ' '; letter <= '~'; ++letter) {
      const auto* const found = glyph(letter, FT_LOAD_DEFAULT);
      known->second.at(printable(letter)) = found == nullptr ? 0 : found->advance.x;
    }
    return known->second;
  }
  /// Null where the font has not even a replacement for the letter.
  FT_GlyphSlot glyph(char letter, int flags) const {
    return FT_Load_Char(face, printable(letter), flags) == 0 ? face->glyph : nullptr;
  }
};

Font::Font(std::unique_ptr<Face> face) : face_(std::move(face)) {}
Font::Font(Font&&) noexcept = default;
Font::~Font() = default;

segue::Result<Font> Font::open(const std::filesystem::path& file) {
  auto made = std::make_unique<Face>();
  if (FT_Init_FreeType(&made->library) != 0 || FT_New_Face(made->library, file.c_str(), 0, &made->face) != 0)
    return segue::fail(segue::ErrorCode::Unsupported, "FreeType cannot read the font " + file.string());
  return Font(std::move(made));
}

int Font::width(std::string_view text, int size) const {
  const auto& advances = face_->advances(size);
  FT_Pos width = 0;
  for (const char letter : text)
    width += advances.at(printable(letter));
  return static_cast<int>((width + 63) / 64);
}

void Font::write(Picture& picture, int left, int baseline, std::string_view text, int size,
                 Colour colour) const {
  FT_Set_Pixel_Sizes(face_->face, 0, static_cast<FT_UInt>(size));
  FT_Pos at = FT_Pos{left} * 64;
  for (const char letter : text) {
    const auto* const glyph = face_->glyph(letter, FT_LOAD_RENDER);
    if (glyph == nullptr) continue;
    const FT_Bitmap& bitmap = glyph->bitmap;
    for (int y = 0; y < static_cast<int>(bitmap.rows); ++y) {
      for (int x = 0; x < static_cast<int>(bitmap.width); ++x)
        picture.blend(static_cast<int>(at / 64) + glyph->bitmap_left + x, baseline - glyph->bitmap_top + y,
                      colour, bitmap.buffer[y * bitmap.pitch + x]);
    }
    at += glyph->advance.x;
  }
}

int line_height(int size) {
  return size * 5 / 4;
}

FittedText fit_text(const Font& font, std::string_view text, const Area& place, int largest, int smallest) {
  FittedText fitted;
  std::size_t room = 0;
  for (fitted.size = largest;; --fitted.size) {
    fitted.lines = wrap(font, text, place.width, fitted.size);
    room = static_cast<std::size_t>(std::max(1, place.height / line_height(fitted.size)));
    if (fitted.lines.size() <= room) return fitted;
    if (fitted.size <= smallest) break;
  }
  fitted.lines.resize(room);
  std::string& last = fitted.lines.back();
  while (!last.empty() && font.width(last + std::string(kCut), fitted.size) > place.width)
    last.pop_back();
  last += kCut;
  return fitted;
}

}  // namespace film

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "picture.hpp"

namespace film {

/// Writes with a TrueType font (FreeType). Text is ASCII; all else is written as question marks. Sizes are in
/// pixels. One thread at a time.
class Font {
 public:
  /// Unsupported where FreeType cannot read the file.
  static segue::Result<Font> open(const std::filesystem::path& file);
  Font(Font&&) noexcept;
  ~Font();

  [[nodiscard]] int width(std::string_view text, int size) const;
  void write(Picture& picture, int left, int baseline, std::string_view text, int size, Colour colour) const;

 private:
  struct Face;
  explicit Font(std::unique_ptr<Face> face);
  std::unique_ptr<Face> face_;
};

/// A text in lines that are as wide as their place at the most.
struct FittedText {
  int size = 0;
  std::vector<std::string> lines;
};
/// The distance of the baselines of two lines.
int line_height(int size);
/// As large as fits into width and height, from `largest` down to `smallest`. Lines break at blanks, and
/// within a word only where it is wider than the place. Of a text that does not even fit when it is small,
/// the last line ends with "...".
FittedText fit_text(const Font& font, std::string_view text, const Area& place, int largest, int smallest);

}  // namespace film

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/printable.hpp>

namespace segue {

namespace {

constexpr char32_t kEndOfControls = 0xA0;  ///< 0x80 to 0x9F are the C1 control characters

/// The length that the first byte of a character of several bytes announces; 0 for any other byte.
std::size_t announced_length(unsigned char first) {
  if (first >= 0xC2 && first <= 0xDF) return 2;
  if (first >= 0xE0 && first <= 0xEF) return 3;
  return first >= 0xF0 && first <= 0xF4 ? 4 : 0;
}

/// Characters that change the order in which others are shown, or begin a line or a paragraph.
bool moves_text(char32_t code) {
  return code == 0x61C || code == 0x200E || code == 0x200F || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::size_t printable_length(std::string_view text) {
  if (text.empty()) return 0;
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) return first >= 0x20 && first != 0x7F ? 1 : 0;
  const std::size_t length = announced_length(first);
  if (length == 0 || text.size() < length) return 0;
  char32_t code = first & (0xFFU >> (length + 1));
  for (const char c : text.substr(1, length - 1)) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0U) != 0x80U) return 0;
    code = code << 6U | (byte & 0x3FU);
  }
  // Forms that are longer than needed, halves of pairs, and numbers without a character are not UTF-8.
  constexpr char32_t kLeast[] = {0, 0, kEndOfControls, 0x800, 0x10000};
  const bool half = code >= 0xD800 && code <= 0xDFFF;
  return code >= kLeast[length] && code <= 0x10FFFF && !half && !moves_text(code) ? length : 0;
}

std::string printable(std::string_view text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const bool kept = text[0] == '\n' || text[0] == '\t';
    const std::size_t length = kept ? 1 : printable_length(text);
    if (length == 0) {
      const auto byte = static_cast<unsigned char>(text[0]);
      result.append("\\x").append(1, kHex[byte >> 4U]).append(1, kHex[byte & 15U]);
    } else {
      result.append(text.substr(0, length));
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}

}  // namespace segue

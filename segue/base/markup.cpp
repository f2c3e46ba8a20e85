// SPDX-License-Identifier: Apache-2.0
#include <segue/base/markup.hpp>

namespace segue {

std::string escape_markup(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (c == '"')
      safe += "&quot;";
    else if (c == '\'')
      safe += "&#39;";
    else
      safe += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
  }
  return safe;
}

}  // namespace segue

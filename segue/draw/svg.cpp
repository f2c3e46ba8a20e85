// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/svg.hpp>

#include <segue/base/text.hpp>

#include <fmt/format.h>

namespace segue::draw::svg {

void begin(Out out, double width, double height) {
  fmt::format_to(out,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 "
                 "{0:g} {1:g}\" "
                 "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"{0:g}\" height=\"{1:g}\" "
                 "fill=\"white\"/>\n",
                 width, height);
}

void text(Out out, double x, double y, std::string_view anchor, std::string_view content,
          std::string_view style) {
  fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}{}>{}</text>\n", x, y, anchor,
                 style.empty() ? "" : " ", style, escape_markup(content));
}

void line(Out out, double x1, double y1, double x2, double y2, std::string_view style) {
  fmt::format_to(out, "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1, x2, y2,
                 style);
}

}  // namespace segue::draw::svg

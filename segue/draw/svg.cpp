// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/base/utf8.hpp>
#include <segue/draw/svg.hpp>

#include <fmt/format.h>

namespace segue::draw::svg {

namespace {

std::string title_element(std::string_view title) {
  return title.empty() ? std::string() : "<title>" + escape_markup(title) + "</title>";
}

}  // namespace

void begin(Out out, double width, double height, double font_size, std::string_view title) {
  fmt::format_to(out,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 "
                 "{0:g} {1:g}\" font-family=\"sans-serif\" font-size=\"{2:g}\"{3}>\n{4}"
                 "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"white\"/>\n",
                 width, height, font_size, title.empty() ? "" : " role=\"img\"",
                 title.empty() ? "" : title_element(title) + '\n');
}

std::string shortened(std::string_view name, std::size_t most) {
  return name.size() <= most ? std::string(name) : "\u2026" + std::string(ending_of(name, most - 1));
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

void rect(Out out, double x, double y, double width, double height, std::string_view style,
          std::string_view title) {
  fmt::format_to(out, "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" {}", x, y, width,
                 height, style);
  if (title.empty())
    fmt::format_to(out, "/>\n");
  else
    fmt::format_to(out, ">{}</rect>\n", title_element(title));
}

void circle(Out out, double x, double y, double radius, std::string_view style) {
  fmt::format_to(out, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" {}/>\n", x, y, radius, style);
}

void path(Out out, std::string_view data, std::string_view style) {
  fmt::format_to(out, "<path d=\"{}\" {}/>\n", data, style);
}

void begin_group(Out out, std::string_view title) {
  fmt::format_to(out, "<g>{}\n", title_element(title));
}

void end_group(Out out) {
  fmt::format_to(out, "</g>\n");
}

}  // namespace segue::draw::svg

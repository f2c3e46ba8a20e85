// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iterator>
#include <string>
#include <string_view>

/// The writer that all SVG files go through. Contents and titles may hold any characters and are escaped
/// here; `style` is further attributes, copied as they are. Lengths are in pixels.
namespace segue::draw::svg {

using Out = std::back_insert_iterator<std::string>;

/// Opens a file: the common font on white. It ends with kEnd. `title`: for screen readers; may be empty.
void begin(Out out, double width, double height, double font_size = 13, std::string_view title = {});
inline constexpr std::string_view kEnd = "</svg>\n";

/// A name of `most` bytes at most, cut in front: the end of a path tells more than its beginning.
std::string shortened(std::string_view name, std::size_t most);

/// `anchor`: start, middle or end.
void text(Out out, double x, double y, std::string_view anchor, std::string_view content,
          std::string_view style = {});
void line(Out out, double x1, double y1, double x2, double y2, std::string_view style);
/// `title` is shown while a pointer rests on the rectangle.
void rect(Out out, double x, double y, double width, double height, std::string_view style,
          std::string_view title = {});
void circle(Out out, double x, double y, double radius, std::string_view style);
/// `data`: as in the attribute `d`.
void path(Out out, std::string_view data, std::string_view style);
/// Elements up to `end_group` share the title.
void begin_group(Out out, std::string_view title);
void end_group(Out out);

}  // namespace segue::draw::svg

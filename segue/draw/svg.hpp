// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iterator>
#include <string>
#include <string_view>

/// What the pictures of the command line share. Texts may hold any characters; lengths are in pixels.
namespace segue::draw::svg {

using Out = std::back_insert_iterator<std::string>;

/// The start of a file in the common font on white, `</svg>` its end.
void begin(Out out, double width, double height);
inline constexpr std::string_view kEnd = "</svg>\n";

/// `anchor`: start, middle or end; `style`: further attributes.
void text(Out out, double x, double y, std::string_view anchor, std::string_view content,
          std::string_view style = {});
void line(Out out, double x1, double y1, double x2, double y2, std::string_view style);

}  // namespace segue::draw::svg

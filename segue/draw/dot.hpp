// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace segue::draw {

/// The text as a name or label in a file for Graphviz: in double quotes, with its escapes.
std::string dot_quoted(std::string_view text);

}  // namespace segue::draw

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace segue {

/// Text of unknown origin, safe for a terminal: control characters other than line feeds and tabs (of one or
/// two bytes), those that change the order in which text is shown (U+202E), and bytes that are not UTF-8, are
/// escaped as in "\x1b".
std::string printable(std::string_view text);

/// How many bytes the character has with which `text` begins; 0 where printable() escapes its first byte.
/// Line feeds and tabs count as control characters here.
std::size_t printable_length(std::string_view text);

}  // namespace segue

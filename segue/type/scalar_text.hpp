// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>
#include <string_view>

/// How scalars are spelled: shared by the readers and writers of this folder.
namespace segue::type::detail {

/// A plain (unquoted) YAML scalar by the 1.2 core schema. Keeps the source text where it prints differently.
Value resolve_plain(std::string_view text);

/// Shortest text that reads back as exactly this number and is always recognisable as one with a fraction or
/// exponent: "1.0", "1.0e+20", ".inf", ".nan".
std::string print_float(double number);

/// Null, bool or number as it is printed plain. Requires a scalar that is not text.
std::string print_scalar(const Value& value);

/// The text with every byte that does not belong to well-formed UTF-8 replaced by U+FFFD.
std::string valid_utf8(std::string_view text);

}  // namespace segue::type::detail

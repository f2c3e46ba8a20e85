// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/type/type.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>

namespace segue::type {

/// Checks a value against a type and reports every mismatch. The message begins with the path
/// ("properties.range.max: expected a number, got 'far'"); the place, from the value's mark, is in `where`.
/// Compounds may be given in part, durations as text ("100ms") or ticks, enums as symbol (":SYMBOL", too) or
/// number, lists of numbers also as {data: [...]}; null is an optional without value; a text property takes a
/// plain number as it was written. Opaque and unknown parts accept anything. A list is not checked further
/// after ten invalid items. Codes: type-mismatch, out-of-range, unknown-symbol, unknown-field, wrong-count,
/// more-mismatches.
void check_value(const Value& value, const Type& type, std::string_view path, const std::string& file,
                 Diagnostics& diagnostics);

}  // namespace segue::type

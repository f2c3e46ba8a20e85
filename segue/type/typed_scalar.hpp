// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/type.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <string>

/// Which values a type accepts: the rules shared by checking and encoding. Error messages begin with
/// "expected" and contain no path and no place.
namespace segue::type::detail {

/// Follows aliases, and opaque types to their marshalling types; nullptr where the layout is unknown and any
/// value is accepted (null, pointers, opaques without marshalling type).
const Type* layout_of(const Type& type);

/// A whole number within the range of the type's size and sign; a duration's text ("100ms") as its ticks.
/// Signed numbers come as two's complement.
Result<std::uint64_t> integer_for(const Value& value, const Type& type);

/// A number within the range of a float of the type's size; a duration's text as its ticks.
Result<double> float_for(const Value& value, const Type& type);

Result<bool> boolean_for(const Value& value);

/// Text, or a number or boolean as it was written.
Result<std::string> text_for(const Value& value);

/// A symbol, also as Rock writes it (":SYMBOL"), or the number of one.
Result<std::int64_t> symbol_for(const Value& value, const Type& type);

/// The items for an array or container: the list itself, or the list in Rock's {data: [...]} where the
/// items are numbers. nullptr where the value has neither form.
const Value::List* items_for(const Value& value, const Type& element);

}  // namespace segue::type::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

/// The robot in the browser: an HTTP and WebSocket server that turns what a running robot offers into
/// documents, and requests of a page into calls.
namespace segue::web {

/// The change that turns the map `from` into the map `to`: {"set": {key: value}, "remove": [key], "in": {key:
/// change}}, each where it is not empty. Maps are compared entry by entry, all else is set anew. Linear in
/// the size of both. Requires maps.
type::Value change_between(const type::Value& from, const type::Value& to);

/// The list as a map, which change_between() compares entry by entry: the key of each map of the list is made
/// of its texts at `keys`, joined by blanks. Items without them, and repetitions, are left out.
type::Value keyed(const type::Value::List& list, std::initializer_list<std::string_view> keys);

}  // namespace segue::web

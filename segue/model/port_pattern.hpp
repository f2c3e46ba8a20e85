// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <string>
#include <string_view>

/// Names of port families: regular expressions (ECMAScript) that a whole port name must match. They come from
/// files, so their cost is bounded: no back references, no large expansions, no names longer than an
/// identifier. Compiled once per process and expression; all functions are thread safe.
namespace segue::model {

/// Whether the expression is allowed; the error says why not.
Result<void> check_port_pattern(const std::string& pattern);

/// False for an invalid expression.
bool matches_port_pattern(const std::string& pattern, std::string_view name);

/// Rock's expressions are searched for anywhere in a name; ours must match the whole of it:
/// "^debug_" becomes "debug_.*".
std::string whole_match_pattern(std::string_view searched);

}  // namespace segue::model

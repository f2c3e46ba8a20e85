// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <filesystem>
#include <string>
#include <string_view>

namespace segue::type {

/// YAML 1.2, core schema, as a Value with line and column of every node. One document; an empty text is null.
/// Plain scalars: null and ~, true and false, integers (decimal, 0x, 0o), floats, .inf, .nan; all else is
/// text (yes, no, on and off, dates, numbers beyond a double's range), and so is everything quoted. Tags
/// outside the core schema are ignored. Errors, reported with their place: duplicate keys, keys that are not
/// scalars, merge keys (<<), nesting beyond 200, anchors and aliases that expand to more than a million
/// nodes, a second document. A value that an alias repeats carries the place of its anchor. `file` is only
/// used in messages.
Result<Value> parse_yaml(std::string_view text, const std::string& file = {});

/// Reads and parses; the error names the file.
Result<Value> load_yaml(const std::filesystem::path& file);

/// Block style, with small leaf maps and lists in flow style; numbers as they were written where that is
/// known. parse_yaml() restores an equal value. Invalid UTF-8 is replaced by U+FFFD.
std::string to_yaml(const Value& value);

}  // namespace segue::type

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>

namespace segue::type {

/// RFC 8259. Refuses nesting beyond 200 and duplicate keys.
Result<Value> parse_json(std::string_view text, const std::string& file = {});

/// Indented by `indent` spaces, or on one line where that is negative. Invalid UTF-8 is replaced by U+FFFD;
/// NaN and infinities, which JSON lacks, become null.
std::string to_json(const Value& value, int indent = 2);

}  // namespace segue::type

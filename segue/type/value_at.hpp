// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>
#include <string_view>

namespace segue::type {

/// The text under a key of a map; "" where there is none, or the value is not a map.
[[nodiscard]] std::string text_at(const Value& map, std::string_view key);

}  // namespace segue::type

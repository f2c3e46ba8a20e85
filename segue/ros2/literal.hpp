// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/ros2/interface_definition.hpp>

#include <string_view>

namespace segue::ros2 {

/// The value of a constant or a default as it is written in a .msg file: a number, true, false, text with or
/// without quotes, and for several items a list such as [1, 2]. InvalidArgument where it does not fit the
/// type.
Result<type::Value> parse_default(std::string_view text, const FieldType& type);

}  // namespace segue::ros2

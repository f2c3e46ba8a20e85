// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace segue {

/// What is wrong with a key of a file that means nothing there, or nothing if it is among `known` or begins
/// with "x-": such keys belong to others.
std::optional<std::string> problem_of_key(std::string_view key, std::span<const std::string> known);

}  // namespace segue

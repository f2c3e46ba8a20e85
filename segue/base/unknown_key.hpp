// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace segue {

/// The problem of a key that has no meaning in a file; nothing if it is among `known` or begins with "x-":
/// such keys belong to other programs.
std::optional<std::string> problem_of_key(std::string_view key, std::span<const std::string> known);

}  // namespace segue

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>

#include <string_view>
#include <vector>

namespace segue::model {

/// Joins the names of controllers that run at once: "arm+drive". No controller has it in its own name.
inline constexpr char kControllerSeparator = '+';

/// The controllers that `name` means: "arm" and "drive" for "drive+arm"; sorted, each once; none for "".
std::vector<NetworkName> controllers_in(std::string_view name);
/// The name of these controllers together, sorted.
NetworkName joined_name(const std::vector<NetworkName>& controllers);

}  // namespace segue::model

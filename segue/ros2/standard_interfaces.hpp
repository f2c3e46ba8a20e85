// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace segue::ros2 {

/// The text of each interface of the folder `interfaces`, as in its .msg, .srv or .action file, by name.
/// Valid as long as the process. Thread safe.
const std::map<std::string, std::string_view, std::less<>>& standard_interfaces();

}  // namespace segue::ros2

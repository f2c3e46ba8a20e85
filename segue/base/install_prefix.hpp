// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace segue {

/// Where Segue may be installed, or built: the folders around that of this program and that of its libraries
/// (<prefix>/lib, <prefix>/lib/<architecture>), the likeliest first. Any thread.
std::vector<std::filesystem::path> install_prefixes();

}  // namespace segue

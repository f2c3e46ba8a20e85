// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace segue {

/// 256 random bits of the system in hexadecimal digits. Throws std::system_error where it gives none.
std::string random_secret();

/// Compares in a time that does not depend on where the texts differ.
bool equal_secrets(std::string_view a, std::string_view b);

}  // namespace segue

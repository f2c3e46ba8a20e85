// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace segue {

/// 256 random bits of the system in hexadecimal digits. Throws std::system_error where it gives none.
std::string random_secret();

/// 64 random bits of the system, not 0. Throws as random_secret().
std::uint64_t random_number();

/// Compares in a time that does not depend on where the texts differ.
bool equal_secrets(std::string_view a, std::string_view b);

}  // namespace segue

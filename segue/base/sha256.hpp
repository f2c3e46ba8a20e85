// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace segue {

/// The SHA-256 digest (FIPS 180-4) of `content` as 64 hexadecimal digits, as `sha256sum` prints it. To name
/// contents, not to protect secrets.
std::string sha256(std::string_view content);

}  // namespace segue

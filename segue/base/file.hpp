// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace segue {

/// Reads the whole file. Fails for directories and for files larger than `limit` bytes. Blocks.
Result<std::string> read_file(const std::filesystem::path& path, std::size_t limit = std::size_t{1} << 30);

/// Replaces the file atomically (temporary file beside it, fsync, rename). Blocks.
Result<void> write_file(const std::filesystem::path& path, std::string_view content);
/// Replaces the file like write_file(), for a secret: at no time anybody but this user may read it (mode
/// 0600).
Result<void> write_private_file(const std::filesystem::path& path, std::string_view content);

/// Files that match a pattern whose last part may contain '*' and '?', sorted; a plain path yields itself.
std::vector<std::filesystem::path> glob_files(const std::filesystem::path& pattern);

}  // namespace segue

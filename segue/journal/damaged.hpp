// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>

namespace segue::journal::detail {

/// Renames a damaged file and what belongs to it (`-wal`, `-shm`) to "PATH.broken-N", N counting from 1; of
/// those the five latest are kept. The new name, or why it cannot be renamed.
Result<std::filesystem::path> move_aside(const std::filesystem::path& path);

}  // namespace segue::journal::detail

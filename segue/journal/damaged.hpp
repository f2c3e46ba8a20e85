// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>

namespace segue::journal::detail {

/// Renames a damaged file and its companions (`-wal`, `-shm`) to "PATH.broken-N", N counting from 1, and
/// keeps the five latest of these. Returns the new name. PermissionDenied if it cannot be renamed.
Result<std::filesystem::path> move_aside(const std::filesystem::path& path);

}  // namespace segue::journal::detail

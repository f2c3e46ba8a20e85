// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>

namespace segue {

/// The file system's facts about a file, by which a change of its content is seen without reading it. A file
/// that was written or replaced has another stamp, unless both happened within a tick of the kernel's clock
/// (10 ms at most).
struct FileStamp {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::uint64_t size = 0;                         ///< bytes
  std::chrono::system_clock::time_point changed;  ///< last write or other change (ctime)
  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};

/// NotFound, PermissionDenied or IoError where there is no such file. Follows links. From any thread.
Result<FileStamp> stamp_of(const std::filesystem::path& path);

}  // namespace segue

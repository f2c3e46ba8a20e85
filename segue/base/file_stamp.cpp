// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file_stamp.hpp>
#include <segue/base/text.hpp>

#include <sys/stat.h>

#include <cerrno>
#include <cstring>

namespace segue {

Result<FileStamp> stamp_of(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    const int number = errno;
    const ErrorCode code = number == ENOENT   ? ErrorCode::NotFound
                           : number == EACCES ? ErrorCode::PermissionDenied
                                              : ErrorCode::IoError;
    return fail(code, "cannot read " + quote(path.string()) + ": " + std::strerror(number));
  }
  const auto since_1970 =
      std::chrono::seconds(status.st_ctim.tv_sec) + std::chrono::nanoseconds(status.st_ctim.tv_nsec);
  return FileStamp{status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
                   std::chrono::system_clock::time_point(
                       std::chrono::duration_cast<std::chrono::system_clock::duration>(since_1970))};
}

}  // namespace segue

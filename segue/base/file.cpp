// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace segue {
namespace fs = std::filesystem;
namespace {

Error system_failure(const fs::path& path, std::string_view verb) {
  const int number = errno;
  const ErrorCode code = number == ENOENT   ? ErrorCode::NotFound
                         : number == EACCES ? ErrorCode::PermissionDenied
                                            : ErrorCode::IoError;
  return fail(code,
              "cannot " + std::string(verb) + " " + quote(path.string()) + ": " + std::strerror(number));
}

/// Writes everything and closes the descriptor in every case; false leaves the reason in errno.
bool write_and_close(int descriptor, std::string_view content) {
  bool good = true;
  while (good && !content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written >= 0) {
      content.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      good = false;
    }
  }
  good = good && ::fsync(descriptor) == 0;
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return good;
}

fs::path temporary_of(const fs::path& path) {
  return path.string() + ".tmp" + std::to_string(::getpid());
}

Result<void> replace_file(const fs::path& path, std::string_view content, mode_t mode, int flags) {
  const fs::path temporary = temporary_of(path);
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | flags, mode);
  if (descriptor < 0) return system_failure(path, "write");
  if (!write_and_close(descriptor, content) || ::rename(temporary.c_str(), path.c_str()) != 0) {
    Error error = system_failure(path, "write");
    ::unlink(temporary.c_str());
    return error;
  }
  return {};
}

/// Whether the path names input that a shell gives a program (`<(...)`, /dev/stdin), or /dev/null, which is
/// always empty. Any other pipe or device may keep its reader waiting for ever.
bool is_given_stream(const fs::path& path) {
  const std::string name = path.string();
  return name.starts_with("/dev/fd/") || name.starts_with("/proc/self/fd/") || name == "/dev/stdin" ||
         name == "/dev/null";
}

}  // namespace

Result<std::string> read_file(const fs::path& path, std::size_t limit) {
  std::error_code ignored;
  const auto status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    return fail(ErrorCode::IoError, quote(path.string()) + " is a directory, expected a file");
  }
  if (fs::exists(status) && !fs::is_regular_file(status) && !is_given_stream(path)) {
    return fail(ErrorCode::IoError, quote(path.string()) + " is a pipe or a device, expected a file");
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return system_failure(path, "read");
  std::string content;
  std::string chunk(std::size_t{64} << 10, '\0');
  while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || stream.gcount() > 0) {
    content.append(chunk, 0, static_cast<std::size_t>(stream.gcount()));
    if (content.size() > limit) {
      return fail(ErrorCode::ResourceExhausted,
                  quote(path.string()) + " is larger than " + std::to_string(limit) + " bytes");
    }
  }
  if (stream.bad()) return system_failure(path, "read");
  return content;
}

Result<void> write_file(const fs::path& path, std::string_view content) {
  return replace_file(path, content, 0644, O_TRUNC);
}

Result<void> write_private_file(const fs::path& path, std::string_view content) {
  // The rest of an interrupted attempt may have another mode.
  ::unlink(temporary_of(path).c_str());
  return replace_file(path, content, 0600, O_EXCL);
}

std::vector<fs::path> glob_files(const fs::path& pattern) {
  const std::string name = pattern.filename().string();
  if (name.find_first_of("*?") == std::string::npos) return {pattern};
  std::vector<fs::path> found;
  std::error_code error;
  const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (matches_glob(name, entry.path().filename().string())) found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace segue

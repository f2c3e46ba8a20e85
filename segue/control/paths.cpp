// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/control/detail/socket.hpp>
#include <segue/control/server.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

namespace segue::control {

namespace {

constexpr mode_t kOwnerOnly = 0700;
constexpr std::string_view kExtension = ".sock";

std::filesystem::path folder_by_environment() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && *runtime != '\0') return std::filesystem::path(runtime) / "segue";
  return "/tmp/segue-" + std::to_string(::geteuid());
}

/// In /tmp anybody may have made the folder before us, or put a link there.
Result<void> check_folder(const std::filesystem::path& folder) {
  struct stat status {};
  if (::lstat(folder.c_str(), &status) != 0) {
    return fail(ErrorCode::IoError,
                "cannot look at " + quote(folder.native()) + ": " + std::generic_category().message(errno));
  }
  if (!S_ISDIR(status.st_mode) || status.st_uid != ::geteuid()) {
    return fail(ErrorCode::PermissionDenied,
                quote(folder.native()) +
                    " is not a folder of this user, so sockets in it cannot be trusted; remove it, or set "
                    "XDG_RUNTIME_DIR to a folder of your own");
  }
  if ((status.st_mode & 0777) != kOwnerOnly && ::chmod(folder.c_str(), kOwnerOnly) != 0) {
    return fail(ErrorCode::PermissionDenied, "cannot make " + quote(folder.native()) +
                                                 " private: " + std::generic_category().message(errno));
  }
  return {};
}

}  // namespace

Result<std::filesystem::path> socket_folder() {
  const auto folder = folder_by_environment();
  if (::mkdir(folder.c_str(), kOwnerOnly) != 0 && errno != EEXIST) {
    const std::string reason = std::generic_category().message(errno);
    return fail(ErrorCode::IoError, "cannot make the folder for sockets " + quote(folder.native()) + ": " +
                                        reason + "; set XDG_RUNTIME_DIR to a folder of your own");
  }
  const auto checked = check_folder(folder);
  if (!checked) return checked.error();
  return folder;
}

Result<std::filesystem::path> socket_path(std::string_view robot) {
  if (!is_identifier(robot)) {
    return fail(
        ErrorCode::InvalidArgument,
        quote(robot) + " cannot be a robot's name: a letter first, then letters, digits, '_', '-', '.'");
  }
  const auto folder = socket_folder();
  if (!folder) return folder.error();
  return *folder / (std::string(robot) + std::string(kExtension));
}

std::vector<std::string> running_robots() {
  std::vector<std::string> names;
  const auto folder = socket_folder();
  if (!folder) return names;
  std::error_code failed;
  for (std::filesystem::directory_iterator entry(*folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    if (entry->path().extension() != kExtension) continue;
    if (!detail::remove_if_stale(entry->path())) names.push_back(entry->path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace segue::control

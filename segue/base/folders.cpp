// SPDX-License-Identifier: Apache-2.0
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>

#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

namespace segue {

namespace {

constexpr mode_t kOwnerOnlyFolder = 0700;

std::filesystem::path folder_by_environment() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && *runtime != '\0') return std::filesystem::path(runtime) / "segue";
  return "/tmp/segue-" + std::to_string(::geteuid());
}

/// Empty unless it is an absolute path: others are to be ignored (XDG Base Directory Specification).
std::filesystem::path absolute_path_in(const char* variable) {
  const char* value = std::getenv(variable);
  const std::filesystem::path folder = value == nullptr ? "" : value;
  return folder.is_absolute() ? folder : std::filesystem::path();
}

/// Anybody may have created the folder in /tmp before us, or have put a link there.
Result<void> check_folder(const std::filesystem::path& folder) {
  struct stat status {};
  if (::lstat(folder.c_str(), &status) != 0) {
    return fail(ErrorCode::IoError,
                "cannot inspect " + quote(folder.native()) + ": " + std::generic_category().message(errno));
  }
  if (!S_ISDIR(status.st_mode) || status.st_uid != ::geteuid()) {
    return fail(ErrorCode::PermissionDenied,
                quote(folder.native()) +
                    " is not a folder of this user, so sockets in it cannot be trusted; remove it, or set "
                    "XDG_RUNTIME_DIR to a folder of your own");
  }
  if ((status.st_mode & 0777) != kOwnerOnlyFolder && ::chmod(folder.c_str(), kOwnerOnlyFolder) != 0) {
    return fail(ErrorCode::PermissionDenied, "cannot make " + quote(folder.native()) +
                                                 " private: " + std::generic_category().message(errno));
  }
  return {};
}

}  // namespace

Result<void> make_private_folder(const std::filesystem::path& folder) {
  if (::mkdir(folder.c_str(), kOwnerOnlyFolder) != 0 && errno != EEXIST) {
    const std::string reason = std::generic_category().message(errno);
    return fail(ErrorCode::IoError, "cannot make the folder for sockets " + quote(folder.native()) + ": " +
                                        reason + "; set XDG_RUNTIME_DIR to a folder of your own");
  }
  return check_folder(folder);
}

Result<std::filesystem::path> runtime_folder() {
  auto folder = folder_by_environment();
  if (auto made = make_private_folder(folder); !made) return std::move(made.error());
  return folder;
}

Result<std::filesystem::path> configuration_folder() {
  if (const auto given = absolute_path_in("XDG_CONFIG_HOME"); !given.empty()) return given / "segue";
  if (::geteuid() == 0) return std::filesystem::path("/etc/segue");
  if (const auto home = absolute_path_in("HOME"); !home.empty()) return home / ".config" / "segue";
  return fail(ErrorCode::InvalidState,
              "there is no folder for configuration: neither XDG_CONFIG_HOME nor HOME names one");
}

std::vector<std::filesystem::path> install_prefixes() {
  namespace fs = std::filesystem;
  std::vector<fs::path> prefixes;
  std::error_code failed;
  const fs::path self = fs::read_symlink("/proc/self/exe", failed);
  if (!failed) prefixes.push_back(self.parent_path().parent_path());
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&install_prefixes), &info) != 0 && info.dli_fname != nullptr) {
    const fs::path own = fs::absolute(info.dli_fname, failed).parent_path();
    prefixes.push_back(own.parent_path());
    prefixes.push_back(own.parent_path().parent_path());
  }
  return prefixes;
}

}  // namespace segue

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>
#include <segue/control/server.hpp>
#include <segue/rpc/detail/socket.hpp>

#include <algorithm>
#include <string>
#include <system_error>

namespace segue::control {

namespace {

constexpr std::string_view kExtension = ".sock";

/// The socket of the computer's process server; no robot may have this name.
constexpr std::string_view kProcessServer = "host";
/// The socket of the computer's daemon; no identifier, so never a robot.
constexpr std::string_view kDaemon = "@host";

}  // namespace

Result<std::filesystem::path> socket_folder() {
  return runtime_folder();
}

Result<std::filesystem::path> socket_path(std::string_view robot) {
  if (!is_identifier(robot)) {
    return fail(
        ErrorCode::InvalidArgument,
        quote(robot) + " cannot be a robot's name: a letter first, then letters, digits, '_', '-', '.'");
  }
  if (robot == kProcessServer) {
    return fail(ErrorCode::InvalidArgument,
                "a robot cannot be named 'host': that is the process server's; choose another name");
  }
  const auto folder = socket_folder();
  if (!folder) return folder.error();
  return *folder / (std::string(robot) + std::string(kExtension));
}

Result<std::filesystem::path> daemon_socket() {
  const auto folder = socket_folder();
  if (!folder) return folder.error();
  return *folder / (std::string(kDaemon) + std::string(kExtension));
}

std::vector<std::string> running_robots() {
  std::vector<std::string> names;
  const auto folder = socket_folder();
  if (!folder) return names;
  std::error_code failed;
  for (std::filesystem::directory_iterator entry(*folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    if (entry->path().extension() != kExtension || entry->path().stem() == kProcessServer ||
        entry->path().stem() == kDaemon) {
      continue;
    }
    if (!detail::remove_if_stale(entry->path())) names.push_back(entry->path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace segue::control

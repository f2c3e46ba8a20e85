// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>
#include <segue/base/lock_file.hpp>
#include <segue/base/process_state.hpp>
#include <segue/base/text.hpp>
#include <segue/base/unix_socket.hpp>
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/os_process.hpp>
#include <segue/process_server/process_place.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>

namespace segue::process_server::detail {

namespace {

namespace fs = std::filesystem;

/// The program and its first argument.
std::string command_of(int pid) {
  const std::string path = "/proc/" + std::to_string(pid) + "/cmdline";
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::array<char, 1024> buffer{};
  const ssize_t size = file.valid() ? ::read(file.get(), buffer.data(), buffer.size()) : 0;
  const std::string_view text(buffer.data(), size < 0 ? 0 : static_cast<std::size_t>(size));
  const auto first = std::min(text.find('\0'), text.size());
  const auto second = std::min(text.find('\0', std::min(first + 1, text.size())), text.size());
  std::string command(text.substr(0, second));
  std::replace(command.begin(), command.end(), '\0', ' ');
  return command;
}

bool is_ours(int pid) {
  struct stat status {};
  return ::stat(("/proc/" + std::to_string(pid)).c_str(), &status) == 0 && status.st_uid == ::geteuid();
}

bool has_ended(int pidfd) {
  pollfd waited{pidfd, POLLIN, 0};
  return ::poll(&waited, 1, 0) != 0;
}

}  // namespace

ProcessPlace::ProcessPlace(fs::path path, Descriptor lock, Descriptor socket)
    : path_(std::move(path)), lock_(std::move(lock)), socket_(std::move(socket)) {}

Result<ProcessPlace> ProcessPlace::claim(const fs::path& socket, TimePoint deadline) {
  if (const auto address = socket_address(socket); !address) return address.error();
  const fs::path path = lock_of(socket);
  auto lock = lock_when_ended(path, deadline);
  if (!lock) return lock.error();
  if (!lock->has_value()) {
    return fail(ErrorCode::AlreadyExists, "a process that holds " + quote(socket.native()) + " runs already");
  }
  if (!write_record((*lock)->get(), {})) {
    const int reason = errno;
    ::unlink(path.c_str());
    return system_error("cannot write the lock " + quote(path.native()), reason);
  }
  auto bound = listen_at(socket);
  if (!bound) {
    ::unlink(path.c_str());
    return bound.error();
  }
  return ProcessPlace(socket, std::move(**lock), std::move(*bound));
}

ProcessPlace::~ProcessPlace() {
  if (kept_ || !lock_.valid()) return;  // an invalid lock: moved from
  ::unlink(path_.c_str());
  ::unlink(lock_of(path_).c_str());
}

bool remove_if_stale(const fs::path& socket) {
  const auto lock = try_lock(lock_of(socket));
  if (!lock || !lock->has_value()) return false;
  ::unlink(socket.c_str());
  ::unlink(lock_of(socket).c_str());
  return true;
}

Result<std::optional<FoundProcess>> find_process(const fs::path& socket, const std::string& title) {
  std::error_code ignored;
  if (!fs::exists(socket, ignored) || remove_if_stale(socket)) return std::optional<FoundProcess>{};
  const auto record = read_record(lock_of(socket));
  if (!record || record->pid == 0) {
    return fail(ErrorCode::Unavailable, "process " + title + " is just starting");
  }
  // The pid may have been given to another process. So its pidfd is opened first, and what /proc says of the
  // pid is believed only if the process of that pidfd still lives afterwards: then both are about the same
  // process.
  FoundProcess found{record->pid, Descriptor(open_pidfd(record->pid)), record->software};
  if (!found.pidfd.valid()) {
    if (errno == ESRCH) return std::optional<FoundProcess>{};
    return system_error("cannot watch process " + title, errno);
  }
  const bool fits =
      is_ours(found.pid) && command_of(found.pid) == std::string(kDeploymentProgram) + ' ' + title;
  if (!fits || is_ending(found.pid) || has_ended(found.pidfd.get())) return std::optional<FoundProcess>{};
  return std::optional<FoundProcess>(std::move(found));
}

std::string process_title(const std::string& robot, const fs::path& socket) {
  return robot + '/' + socket.stem().string();
}

}  // namespace segue::process_server::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <filesystem>
#include <optional>
#include <string>

/// How a deployment process is found: by its socket and by a lock file beside it, which the process holds
/// locked as long as it lives and which contains its pid and version. Internal.
namespace segue::process_server::detail {

/// Ownership of a process's name: a held lock and a listening socket. Both are handed to the process that is
/// started; the lock is released when its last holder closes it.
class ProcessPlace {
 public:
  /// Takes the name and replaces what a dead process left there; waits until `deadline` for a process that is
  /// ending. AlreadyExists where a process holds the name, or a server that is about to start one. The socket
  /// has mode 0600.
  static Result<ProcessPlace> claim(const std::filesystem::path& socket, TimePoint deadline);
  ProcessPlace(ProcessPlace&&) = default;
  ProcessPlace& operator=(ProcessPlace&&) = delete;
  /// Removes socket and lock unless keep() was called.
  ~ProcessPlace();

  [[nodiscard]] int lock() const { return lock_.get(); }
  [[nodiscard]] int socket() const { return socket_.get(); }
  /// From now on the socket and the lock belong to the process that was started.
  void keep() { kept_ = true; }

 private:
  ProcessPlace(std::filesystem::path path, Descriptor lock, Descriptor socket);
  std::filesystem::path path_;
  Descriptor lock_;
  Descriptor socket_;
  bool kept_ = false;
};

/// A process that was found by its socket.
struct FoundProcess {
  int pid = 0;
  Descriptor pidfd;
  std::string software;
};

/// The process that holds `socket`, after it has been checked that it is a living deployment process of this
/// user with that title. Nothing where there is none or it is ending; what a dead process left is removed.
/// Unavailable where it has not written its pid yet.
Result<std::optional<FoundProcess>> find_process(const std::filesystem::path& socket,
                                                 const std::string& title);

/// Removes socket and lock unless somebody holds the lock; false then.
bool remove_if_stale(const std::filesystem::path& socket);

/// The argument by which `ps` tells processes apart: "rover/drivers".
std::string process_title(const std::string& robot, const std::filesystem::path& socket);

}  // namespace segue::process_server::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <filesystem>
#include <optional>
#include <string>

/// Where a deployment process can be found: its socket, and beside it a lock that its life holds and in which
/// it says who it is. Internal.
namespace segue::process::detail {

/// A name taken: the lock is held and the socket listens. Both are to be handed to the process; the lock then
/// ends with its last holder.
class ProcessPlace {
 public:
  /// AlreadyExists where a process, or a server that is about to start one, holds the name. What a dead
  /// process left is replaced; one that is ending is waited for until `deadline`. The socket has mode 0600.
  static Result<ProcessPlace> claim(const std::filesystem::path& socket, TimePoint deadline);
  ProcessPlace(ProcessPlace&&) = default;
  ProcessPlace& operator=(ProcessPlace&&) = delete;
  /// Removes socket and lock unless keep() was called.
  ~ProcessPlace();

  [[nodiscard]] int lock() const { return lock_.get(); }
  [[nodiscard]] int socket() const { return socket_.get(); }
  /// The process has them now.
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

/// The process that holds the place of `socket`, checked to be a living deployment process of this user with
/// that title. Nothing where there is none or it is ending; what a dead one left is removed. Unavailable
/// where one is only just starting.
Result<std::optional<FoundProcess>> find_process(const std::filesystem::path& socket,
                                                 const std::string& title);

/// Removes socket and lock where nobody holds the lock; false where somebody does.
bool remove_if_stale(const std::filesystem::path& socket);

/// What `ps` shows behind the program's name: "rover/drivers".
std::string process_title(const std::string& robot, const std::filesystem::path& socket);

}  // namespace segue::process::detail

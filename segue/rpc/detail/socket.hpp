// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>

#include <filesystem>

/// Unix sockets with an owner: the parts of server and client that do not depend on Cap'n Proto.
namespace segue::control::detail {

/// A listening socket and the lock on its path. The system releases the lock with the process, so a socket
/// whose lock is free is stale.
class ListeningSocket {
 public:
  /// Binds with mode 0600 and listens. AlreadyExists where another server owns the path; waits until
  /// `deadline` for one whose process is ending.
  static Result<ListeningSocket> open(const std::filesystem::path& path, TimePoint deadline);
  /// Takes a socket that is bound and listens already; its file stays. InvalidArgument where it is no such
  /// socket.
  static Result<ListeningSocket> adopt(Descriptor socket);
  ListeningSocket(ListeningSocket&&) = default;
  ListeningSocket& operator=(ListeningSocket&&) = delete;
  /// Removes the socket and the lock file that open() made.
  ~ListeningSocket();

  [[nodiscard]] int descriptor() const { return socket_.get(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  ListeningSocket(std::filesystem::path path, Descriptor lock, Descriptor socket);
  std::filesystem::path path_;
  Descriptor lock_;
  Descriptor socket_;
};

/// Connects. Unavailable where no process listens, PermissionDenied where the server runs as another user
/// than ours or root. Waits for a server whose queue is full.
Result<Descriptor> connect_socket(const std::filesystem::path& path, const Wait& wait);

/// Removes a socket without a server; false where there is one.
bool remove_if_stale(const std::filesystem::path& path);

/// PermissionDenied unless the process at the other end runs as our user or as root.
Result<void> check_peer(int socket);

}  // namespace segue::control::detail

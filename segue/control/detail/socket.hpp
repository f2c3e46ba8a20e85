// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <filesystem>

/// Unix sockets with an owner: the parts of server and client that know nothing of Cap'n Proto.
namespace segue::control::detail {

/// A listening socket and the lock that says who owns its path. The lock dies with the process, so a socket
/// whose lock can be had is stale.
class ListeningSocket {
 public:
  /// Binds with mode 0600 and listens. AlreadyExists where another server holds the path; one whose process
  /// is ending is waited for until `deadline`.
  static Result<ListeningSocket> open(const std::filesystem::path& path, TimePoint deadline);
  /// One that somebody else has bound and listens on; its file stays. InvalidArgument where it is none.
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

/// Connects; Unavailable where nobody listens, PermissionDenied where the server runs as somebody else (not
/// us, not root). Waits up to `timeout` for a server whose queue is full.
Result<Descriptor> connect_socket(const std::filesystem::path& path, Duration timeout);

/// Removes a socket that nobody serves any more; false where somebody does.
bool remove_if_stale(const std::filesystem::path& path);

/// PermissionDenied unless the process at the other end runs as us or as root.
Result<void> check_peer(int socket);

}  // namespace segue::control::detail

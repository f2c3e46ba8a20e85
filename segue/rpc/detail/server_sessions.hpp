// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/connection_table.hpp>
#include <segue/rpc/detail/bootstrap_server.hpp>
#include <segue/rpc/detail/caller.hpp>
#include <segue/rpc/detail/encryption.hpp>

#include <kj/async-io.h>

#include <optional>
#include <string>
#include <vector>

namespace segue::control::detail {

class Session;

/// The sockets on which a server listens. The descriptors stay open as long as the sessions.
struct Doors {
  int local = -1;   ///< a Unix socket; -1: none
  int remote = -1;  ///< TCP; -1: none
  std::optional<Credentials> credentials;
  std::string user;  ///< the name of this program's user, which clients of the Unix socket get
};

/// The connections of a server: accepts them, checks the peer, drops those that do not say hello in time
/// (with TLS: that have not ended the handshake by then either) or that may not stay (ConnectionTable; hello
/// is where they come in), and stops reading from those that do not read their answers. Created, used and
/// destroyed in the event loop's thread.
class Sessions final : private kj::TaskSet::ErrorHandler {
 public:
  Sessions(ServerCore& core, kj::AsyncIoContext& io, const Doors& doors);
  ~Sessions() noexcept;

  void stop_accepting();
  /// Whether no call is in progress and no answer waits to be sent.
  [[nodiscard]] bool idle() const;

 private:
  friend class Session;
  /// One of the doors, while clients are accepted there.
  struct Door {
    kj::Own<kj::ConnectionReceiver> receiver;
    bool is_local = true;
    kj::Promise<void> accepting = nullptr;
  };

  void taskFailed(kj::Exception&& exception) override;
  void open(int socket, bool is_local);
  kj::Promise<void> accept(Door& door);
  void admit_local(const kj::AsyncIoStream& accepted);
  void admit_remote(const kj::AsyncIoStream& accepted);
  void add(kj::Own<Session> session);
  /// Looks after certificates now and then.
  kj::Promise<void> watch();

  ServerCore& core_;
  kj::LowLevelAsyncIoProvider& io_;
  kj::Timer& timer_;
  const std::optional<Credentials> credentials_;
  const std::string user_;
  std::vector<kj::Own<Door>> doors_;
  std::vector<Session*> sessions_;
  ConnectionTable table_;
  kj::TaskSet tasks_;  ///< holds the sessions
  kj::Promise<void> watching_ = nullptr;
};

}  // namespace segue::control::detail

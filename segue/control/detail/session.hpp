// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/detail/caller.hpp>
#include <segue/control/detail/socket.hpp>

#include <capnp/rpc-twoparty.h>

#include <cstddef>
#include <vector>

namespace segue::control::detail {

class Session;

/// The connections of a server: accepts them, checks the peer, limits their number, drops those that do not
/// say hello in time, and stops reading from those that do not read their answers. Created, used and
/// destroyed in the event loop's thread.
class Sessions final : private kj::TaskSet::ErrorHandler {
 public:
  static constexpr std::size_t kMaxClients = 64;
  /// Connections beyond kMaxClients, of clients that have not said hello yet or are told why they are
  /// refused. Where there are more, the oldest of them is closed, so silent connections keep nobody out.
  static constexpr std::size_t kMaxOthers = 64;

  Sessions(ServerCore& core, kj::AsyncIoContext& io, const ListeningSocket& socket);
  ~Sessions() noexcept;

  void stop_accepting();
  /// Whether no call is in progress and no answer waits to be sent.
  [[nodiscard]] bool idle() const;
  /// How many clients have said hello and been accepted.
  [[nodiscard]] std::size_t clients() const;

 private:
  friend class Session;
  void taskFailed(kj::Exception&& exception) override;
  kj::Promise<void> accept();
  void admit(const kj::AsyncIoStream& accepted);
  void make_room();

  ServerCore& core_;
  kj::LowLevelAsyncIoProvider& io_;
  kj::Timer& timer_;
  kj::Own<kj::ConnectionReceiver> receiver_;
  std::vector<Session*> sessions_;  ///< in the order in which they were accepted
  kj::TaskSet tasks_;               ///< holds the sessions
  kj::Promise<void> accepting_;
};

}  // namespace segue::control::detail

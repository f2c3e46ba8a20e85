// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/refusal_log.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/rpc/detail/event_loop.hpp>
#include <segue/rpc/detail/offered_service.hpp>
#include <segue/rpc/detail/tally.hpp>
#include <segue/rpc/peer.hpp>

#include <atomic>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace segue::control::detail {

struct ClientState;

/// The class of a call, whose calls compete with each other for places.
enum class CallLane : std::uint8_t {
  Ordinary,
  Urgent  ///< it ends motion: has places and threads that nothing else takes
};

/// Which calls may be in progress at once. Observers leave threads to those who command the robot, and to
/// each other: a person who only observes has as many calls as one client, however many connections are open.
/// For use in the loop's thread.
class CallLimits {
 public:
  static constexpr std::size_t kMostOfClient = 16;
  static constexpr std::size_t kMostOfObserver = 16;
  static constexpr std::size_t kMostOfAllObservers = 48;
  static constexpr std::size_t kMostUrgentOfClient = 4;

  /// ResourceExhausted where it may not be begun; otherwise it counts until end().
  Result<void> begin(ClientState& client, CallLane lane);
  void end(ClientState& client, CallLane lane);

 private:
  Result<void> begin_of_observer(const std::string& name);
  void end_of_observer(const std::string& name);

  std::map<std::string, std::size_t> of_observers_;  ///< by the names of persons; only those that have calls
  std::size_t of_all_observers_ = 0;
};

/// The state that all clients of a server share.
struct ServerCore {
  static constexpr std::size_t kMaxCalls = 64;
  static constexpr std::size_t kMaxUrgentCalls = 64;

  explicit ServerCore(OfferedService& what) : offered(what) {}
  [[nodiscard]] std::string_view noun() const { return offered.kind().noun; }

  OfferedService& offered;
  std::atomic<bool> stopping{false};
  RefusalLog refusals{"control"};  ///< used in the loop's thread only
  CallLimits calls;                ///< used in the loop's thread only
  EventLoop loop;
  Tally batches;  ///< in progress, on threads of the service
  Tally watches;  ///< questions that the service has not answered yet
  [[nodiscard]] concurrent::ThreadPool& pool_of(CallLane lane) {
    return lane == CallLane::Urgent ? urgent_pool : pool;
  }
  /// Destroyed before the loop, to which their jobs post.
  concurrent::ThreadPool pool{"segue-calls", {kMaxCalls, 8}};
  concurrent::ThreadPool urgent_pool{"segue-urgent", {kMaxUrgentCalls, 1}};
};

inline constexpr std::size_t kMaxListenersPerClient = 4;

/// The state that all capabilities of a client share; outlives the connection while calls are in progress.
struct ClientState {
  Peer peer;
  std::size_t calls = 0;
  std::size_t urgent_calls = 0;
  std::size_t batches = 0;  ///< of actions, in progress
  std::size_t watches = 0;
  std::size_t streams = 0;
  std::size_t listeners = 0;
};

}  // namespace segue::control::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/controller_registry.hpp>
#include <segue/runtime/controller_set.hpp>
#include <segue/runtime/network_parts.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/switch_result.hpp>

#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <vector>

/// Requests that wait for the worker of a Runtime. Plain values; the queue's mutex protects them.
namespace segue::runtime::detail {

/// Longer deadlines are cut to this: adding an arbitrary duration to a time point could overflow.
inline constexpr Duration kLongestDeadline = std::chrono::hours(24);

/// The state of the runtime after a request: Failed where the robot runs neither the old network nor the
/// requested one nor its fallback. `before`: the state before the request.
RuntimeState state_after(const SwitchResult& result, RuntimeState before);

/// Applied files whose running controller has not gone to its new version yet.
struct PendingApply {
  std::uint64_t number = 0;
  Definitions before;  ///< in force again if the transition fails
  std::vector<ControllerChange> changes;
  RequestOptions options;
  std::promise<ApplyResult> promise;
};

model::NetworkName name_of(const Request& request);

/// Differences of requests that the runtime makes itself, or for a task, to those of others.
struct Privileges {
  bool although_halted = false;  ///< accepted although the robot is halted, or lost to another runtime
  /// Tasks on computers that cannot be reached are left as they are, in place of a refusal.
  bool leaves_lost_hosts = false;
  bool leaves_faulty = false;  ///< see KeptNetworks
  /// Refused after a halt, as long as nobody else has commanded the robot: of requests of tasks.
  bool yields_to_halt = false;
  /// Pools of processes end, too, and are not started again before the next request.
  bool ends_pools = false;
};

/// A request that waits for the worker, with the promise of its result.
struct PendingRequest {
  std::uint64_t number = 0;
  Request request;
  RequestOptions options;
  std::promise<SwitchResult> promise;
  Privileges privileges{};
  std::optional<NetworkParts> parts{};  ///< of what shall run; nothing: it may be about anything
  bool at_commit = false;  ///< it is answered when its network runs, before the old one is retired
  bool is_answered = false;
};

/// The request whose turn it is, until its result is known.
struct ServedRequest {
  std::uint64_t number = 0;
  model::NetworkName to;
  std::string who;
  std::uint64_t lease = 0;  ///< of who has requested it
  std::optional<std::string> cancelled_by{};
  bool ended = false;                                   ///< its transition has
  std::vector<std::promise<SwitchResult>> cancelled{};  ///< who waits for its end
};

}  // namespace segue::runtime::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/change_count.hpp>
#include <segue/runtime/health.hpp>
#include <segue/runtime/pending.hpp>
#include <segue/runtime/pool_report.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/transaction.hpp>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace segue::runtime::detail {

/// What the worker of a Runtime shares with the threads that call it.
struct SharedState {
  ChangeCount changes;  ///< has no need of the mutex
  /// Protects all below. Never held while the host is called, since the host may call on_event(), which takes
  /// it. The belief, the log, leases and halts have locks of their own, which may be taken within it.
  mutable std::mutex mutex;
  std::condition_variable wake;
  bool stopping = false;
  std::uint64_t requests = 0;
  Definitions definitions;
  std::optional<PendingRequest> waiting;
  std::optional<ServedRequest> served;
  std::optional<PendingApply> waiting_apply;  ///< served when no request waits
  RuntimeState state = RuntimeState::Idle;
  std::optional<std::optional<model::Network>>
      pending_reset;  ///< a reset requested during a transition; done after it
  std::deque<SwitchResult> history;
  std::shared_ptr<Transaction> transaction;
  std::shared_ptr<LeftActions> left_actions;  ///< of transactions that made way; never null, has its own lock
  bool transaction_yields = false;  ///< it only prepares or collects, so files that are applied supersede it
  bool wake_requested = false;      ///< the worker has to supervise now (an event, or the end of a request)
  std::vector<model::NetworkName> requests_to_prepare;
  std::uint64_t prepare_lease = 0;  ///< with which these were requested and end; 0: none
  std::optional<std::promise<std::vector<Readiness>>> prepare_waiting;
  std::vector<Readiness> readiness;
  bool look_ahead_due = false;
  std::vector<UnresolvedFault> unresolved;
  std::vector<UnresolvedFault> in_repair;    ///< faults that are being mended, or will be
  std::set<model::HostName> returned_hosts;  ///< reachable again, not yet brought to what they should run
  std::map<model::DeploymentKey, std::string> ended;  ///< processes that ended and are still missing, and why
  std::map<std::string, Handling> handled;            ///< of present faults, by name, at the last supervision
  bool pools_begin_again = false;                     ///< somebody has asked for a repair
  std::map<model::TaskId, PoolInstance> pool_faults;  ///< instances of pools that do not run
  std::atomic<bool> pools_run = true;                 ///< since the last request; until the next one
};

}  // namespace segue::runtime::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/change_count.hpp>
#include <segue/runtime/health.hpp>
#include <segue/runtime/pending.hpp>
#include <segue/runtime/pool_report.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/transaction.hpp>

#include <atomic>
#include <cstdint>
#include <deque>
#include <future>
#include <map>
#include <memory>
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
  mutable Mutex mutex;
  ConditionVariable wake;
  bool stopping SEGUE_GUARDED_BY(mutex) = false;
  std::uint64_t requests SEGUE_GUARDED_BY(mutex) = 0;
  Definitions definitions SEGUE_GUARDED_BY(mutex);
  std::optional<PendingRequest> waiting SEGUE_GUARDED_BY(mutex);
  std::optional<ServedRequest> served SEGUE_GUARDED_BY(mutex);
  std::optional<PendingApply> waiting_apply SEGUE_GUARDED_BY(mutex);  ///< served when no request waits
  RuntimeState state SEGUE_GUARDED_BY(mutex) = RuntimeState::Idle;
  /// A reset requested during a transition; done after it.
  std::optional<std::optional<model::Network>> pending_reset SEGUE_GUARDED_BY(mutex);
  std::deque<SwitchResult> history SEGUE_GUARDED_BY(mutex);
  std::shared_ptr<Transaction> transaction SEGUE_GUARDED_BY(mutex);
  /// Of transactions that made way. Has its own lock; made before the worker starts, and stays.
  std::shared_ptr<LeftActions> left_actions;
  /// It only prepares or collects, so files that are applied supersede it.
  bool transaction_yields SEGUE_GUARDED_BY(mutex) = false;
  /// The worker has to supervise now (an event, or the end of a request).
  bool wake_requested SEGUE_GUARDED_BY(mutex) = false;
  std::vector<model::NetworkName> requests_to_prepare SEGUE_GUARDED_BY(mutex);
  /// With which these were requested and end; 0: none.
  std::uint64_t prepare_lease SEGUE_GUARDED_BY(mutex) = 0;
  std::optional<std::promise<std::vector<Readiness>>> prepare_waiting SEGUE_GUARDED_BY(mutex);
  std::vector<Readiness> readiness SEGUE_GUARDED_BY(mutex);
  bool look_ahead_due SEGUE_GUARDED_BY(mutex) = false;
  std::vector<UnresolvedFault> unresolved SEGUE_GUARDED_BY(mutex);
  /// Faults that are being mended, or will be.
  std::vector<UnresolvedFault> in_repair SEGUE_GUARDED_BY(mutex);
  /// Reachable again, not yet brought to what they should run.
  std::set<model::HostName> returned_hosts SEGUE_GUARDED_BY(mutex);
  /// Processes that ended and are still missing, and why.
  std::map<model::DeploymentKey, std::string> ended SEGUE_GUARDED_BY(mutex);
  /// Of present faults, by name, at the last supervision.
  std::map<std::string, Handling> handled SEGUE_GUARDED_BY(mutex);
  bool pools_begin_again SEGUE_GUARDED_BY(mutex) = false;  ///< somebody has asked for a repair
  /// Instances of pools that do not run.
  std::map<model::TaskId, PoolInstance> pool_faults SEGUE_GUARDED_BY(mutex);
  std::atomic<bool> pools_run = true;  ///< since the last request; until the next one
};

}  // namespace segue::runtime::detail

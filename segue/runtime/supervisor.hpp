// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/model/ids.hpp>
#include <segue/runtime/belief.hpp>
#include <segue/runtime/halts.hpp>
#include <segue/runtime/health.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_parts.hpp>
#include <segue/runtime/supervision.hpp>
#include <segue/runtime/switching.hpp>
#include <segue/solve/repair.hpp>

#include <set>
#include <vector>

namespace segue::runtime::detail {

/// Looks at the robot between requests and does what is left to do: repairs faults, starts instances of
/// pools, removes leftovers, brings back computers that were away, and prepares standby controllers. The
/// worker's, but for host_returned() and snapshot(), which any thread may call.
class Supervisor {
 public:
  /// All must outlive this.
  Supervisor(RuntimeParts& parts, Switching& switching, const Halts& halts);

  /// Takes a snapshot, and does what it shows to be left. Blocks.
  void supervise();
  /// When that is due next, if nothing happens before.
  [[nodiscard]] TimePoint next() const;
  /// A new controller runs as requested: attempts are counted anew.
  void begin_anew();

  /// A computer is reachable again, and not yet brought to what it should run.
  void host_returned(const model::HostName& host);
  /// The parts of the robot and their problems. Asks the host; blocks meanwhile.
  [[nodiscard]] RobotSnapshot snapshot();

 private:
  /// Does what is left to do, where the robot is still commanded; returns what cannot be done.
  std::vector<UnresolvedFault> put_right(const std::set<model::HostName>& returned, const Observation& seen);
  /// `hosts` had returned before the snapshot was taken.
  void bring_back(const std::set<model::HostName>& hosts, const Observation& seen);
  /// Both return what as many attempts as the policy permits could not resolve.
  std::vector<UnresolvedFault> handle_faults(const Observation& seen);
  std::vector<UnresolvedFault> collect_leftovers(const Observation& seen);
  void repair_now(const std::vector<DetectedFault>& faults, const Observation& seen);
  [[nodiscard]] std::vector<UnresolvedFault> left_of(const std::vector<DetectedFault>& faults,
                                                     const Observation& seen) const;
  [[nodiscard]] std::vector<DetectedFault> leftovers() const;
  /// Forgets processes that ended if they are there again, or are no longer wanted.
  void forget_ended(const model::Network& observed);
  void note_in_repair(const std::vector<DetectedFault>& faults);
  void report_given_up(const std::vector<DetectedFault>& faults);
  void fall_back(const Observation& seen);
  /// Executes what concerns `scope` of the transition to the desired network, beside which `pools_part` runs.
  /// `force`: processes that it replaces are killed. Whether that is done.
  bool repair(Cause cause, const Observation& seen, const solve::RepairScope& scope,
              const model::Network& pools_part, bool force = false);
  void look_ahead();
  /// Executes a plan that only prepares, and notes in `ahead` where that has failed.
  void prepare(const Observation& seen, const SwitchPlan& plan, LookAheadPlan& ahead);
  /// Parts that were requested and are not there; where nothing was requested, tasks that are broken.
  [[nodiscard]] std::vector<DetectedFault> faults_in(const model::Network& observed) const;
  [[nodiscard]] RobotSnapshot judge(task_host::TaskHost::View seen);  ///< without differences
  [[nodiscard]] std::set<model::HostName> returned_hosts() const;

  RuntimeParts& parts_;
  Switching& switching_;
  const Halts& halts_;
  RepairScheduler repairs_;
  RepairScheduler leftover_repairs_;
  /// Not reachable since the start, while nothing has been requested: what they hold is not known.
  std::set<model::HostName> unseen_hosts_;
  TimePoint next_observation_ = RealClock::instance().now();
  mutable Mutex mutex_;
  std::set<model::HostName> returned_hosts_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime::detail

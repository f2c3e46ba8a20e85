// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/belief.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/instance_allocator.hpp>
#include <segue/runtime/instance_calls.hpp>
#include <segue/runtime/journaling.hpp>
#include <segue/runtime/known_faults.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/pool_report.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/supervision.hpp>
#include <segue/solve/repair.hpp>
#include <segue/task_host/task_host.hpp>
#include <segue/task_host/watches.hpp>

#include <atomic>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace segue::runtime::detail {

/// Keeps the instances of pools running, makes more where callers wait, and ends those that nobody needs.
/// Pools are not part of what is requested: whatever of them is there
/// stays as it is in each transition (KeptNetworks::pools), so no switch waits for an instance, or fails with
/// one; starting them is the business of supervision alone. Thread safe but for what says otherwise.
class PoolKeeper {
 public:
  struct Sources {
    task_host::TaskHost& host;
    const Belief& belief;
    const KnownFaults& faults;
    EventLog& log;
    JournalKeeper& journal;
  };
  /// `sources`, `options` and the objects that they refer to must outlive this. `notify` is called, from any
  /// thread, when an instance is to be ended; it must not block.
  PoolKeeper(const Sources& sources, const RuntimeOptions& options, std::function<void()> notify);

  /// The instances that shall run now.
  [[nodiscard]] model::Network wanted() const;
  /// The most instances that there may be, as they shall be.
  [[nodiscard]] const model::Network& network() const { return network_; }
  /// The parts of `network` that belong to pools which are kept, as they are there; without() gives all
  /// others.
  [[nodiscard]] model::Network part(const model::Network& network) const;
  [[nodiscard]] model::Network without(const model::Network& network) const;
  /// Why a network cannot be requested: it names what belongs to a pool.
  [[nodiscard]] std::optional<Error> refusal_for(const model::Network& network) const;

  /// Whether instances are kept running, or may be ended as all else. When they are kept again, pools begin
  /// with their least numbers.
  void keep(bool kept);
  [[nodiscard]] bool is_kept() const { return is_kept_; }
  /// Somebody has asked for a repair: attempts are counted anew.
  void begin_again() { begins_again_ = true; }

  /// An operation of any task, as TaskHost::call(). Blocks until it has ended.
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, const Wait& wait);
  /// As ServedRuntime::take_instance().
  void take(const model::InstanceQuestion& what, const Wait& wait, model::InstanceAnswer answered);
  /// Ends all waits with an error.
  void close() { waits_.close(); }
  /// A task or a process has failed or ended.
  void on_event(const task_host::TaskEvent& event);
  void on_event(const task_host::ProcessEvent& event);
  /// `tasks`: what their host says of them.
  [[nodiscard]] std::vector<PoolReport> report(const std::vector<task_host::TaskReport>& tasks) const;

  /// Carries out what concerns `scope` of the transition from what was seen to what should run with
  /// `pools_part`. `force`: processes that it replaces are killed. Whether that is done.
  using Repair = std::function<bool(const Observation& seen, const solve::RepairScope& scope,
                                    const model::Network& pools_part, bool force)>;
  /// Starts instances that do not run, or work for nobody, makes one for which a caller waits, and ends those
  /// that are not needed, each by a transition of its own. Blocks. Called by one thread, which calls next(),
  /// too.
  void look_after(const Repair& repair);
  /// When the next attempt to start or to end one is due.
  [[nodiscard]] std::optional<TimePoint> next() const;

 private:
  /// Takes a snapshot, and notes which instances run.
  std::vector<DetectedFault> find_faults();
  void end_abandoned(const Repair& repair);
  void start_missing(const Repair& repair);
  void note_instances();
  void make_one(const Repair& repair);
  /// Ends instances that run and shall not, such as those that an earlier runtime has made.
  void end_unneeded(const Repair& repair);
  void end(const model::TaskId& instance, const Repair& repair);
  void start(const DetectedFault& fault, const Repair& repair);
  void note_faults(const std::vector<DetectedFault>& faults);
  /// Why it does not run, and what has been done about it.
  [[nodiscard]] std::string reason_of(const DetectedFault& fault) const;

  const Sources sources_;
  const RuntimeOptions& options_;
  const model::Network network_;
  const std::function<void()> notify_;
  InstanceCalls calls_;
  InstanceAllocator allocator_;
  // Neither orders accesses to anything else.
  std::atomic<bool> is_kept_ = true;
  std::atomic<bool> begins_again_ = false;
  // Of the thread that calls look_after().
  RepairScheduler repairs_;
  RepairScheduler removals_;
  std::set<model::TaskId> have_run_;
  mutable Mutex mutex_;
  /// Instances that do not run.
  std::map<model::TaskId, PoolInstance> faults_ SEGUE_GUARDED_BY(mutex_);
  task_host::detail::Watches waits_{task_host::detail::Watches::kPollPeriod, "segue-pools"};  ///< of callers
};

}  // namespace segue::runtime::detail

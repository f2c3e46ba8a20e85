// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/concurrent/notifier.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/fleet/merged_view.hpp>
#include <segue/fleet/placement_table.hpp>
#include <segue/fleet/process_record.hpp>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <thread>
#include <vector>

namespace segue::fleet::detail {

/// The processes of a robot, the runtime's own among them: starts, adopts, watches and polls them, and keeps
/// track of which task lives where. Thread safe; no lock is held while a process is called. Where two locks
/// are needed, the fleet's is taken before that of a record or of the placement table, neither of which calls
/// anything.
class Fleet : public std::enable_shared_from_this<Fleet> {
 public:
  Fleet(deploy::DeploymentService& own, process_server::ProcessService& processes, Connector connector,
        process_server::Launch launch, const DeployedOptions& options);
  /// Adopts the processes that run already and begins to watch. To be called once.
  void begin();
  /// Stops watching and closes all connections; the processes run on. No thread uses this any more when it
  /// returns.
  void close();

  Result<void> deploy(const model::Deployment& deployment, TimePoint deadline);
  Result<void> undeploy(const model::DeploymentKey& key, TimePoint deadline);
  /// Kills a process at once, whatever tasks it holds.
  Result<void> kill(const model::DeploymentKey& key, TimePoint deadline);
  /// Ends all processes but the runtime's own, whatever tasks they hold.
  void end_all(TimePoint deadline);
  /// Sends every process its part of the network that stand-ins have to fit, now and whenever one is
  /// deployed.
  void expect(const model::Network& network);

  /// Polls all processes in parallel; those that do not answer in time are given as they were polled last.
  /// Blocks for the options' patience at most. poll_merged() gives them as one view.
  std::vector<ProcessView> poll();
  MergedView poll_merged();

  [[nodiscard]] RecordPtr find(const model::DeploymentKey& key) const;
  /// The process is at fault: it counts as one that a transition replaces. Not the runtime's own, which none
  /// can replace.
  void blame(const Suspect& process, const std::string& why);
  /// The process of that incarnation.
  [[nodiscard]] RecordPtr find(sample_link::Incarnation incarnation) const;
  [[nodiscard]] std::vector<RecordPtr> all() const;
  /// An incarnation of a task: its process, and its plain id there.
  struct Located {
    RecordPtr record;
    model::TaskId task;
  };
  /// The incarnation that an id means. NotFound where there is none.
  Result<Located> locate(const model::TaskId& id, Which which = Which::Current) const;
  [[nodiscard]] PlacementTable& placements() { return placements_; }

  [[nodiscard]] concurrent::ThreadPool& pool() { return pool_; }
  using Events = concurrent::Notifier<task_host::HostEvent>;
  [[nodiscard]] Events& events() { return events_; }
  /// Periodic work for the watching thread: it polls all processes and removes orphaned endpoints.
  void set_housekeeping(std::function<void()> work);

 private:
  /// A process that is being started.
  struct Starting {
    std::vector<process_server::ProcessInfo> exits;  ///< of its name, the former owner of the name included
    [[nodiscard]] std::optional<process_server::ProcessInfo> exit_of(int pid) const;
  };

  void adopt();
  /// Returns the outcome, for an event.
  std::string adopt(const process_server::ProcessInfo& process);
  Result<RecordPtr> start(const model::Deployment& deployment, TimePoint deadline);
  Result<void> connect_when_ready(const RecordPtr& record, TimePoint deadline);
  std::optional<process_server::ProcessInfo> wait_for_exit_of_starting(const ProcessRecord& record,
                                                                       Duration patience);
  /// A service that is destroyed on a thread of the pool: its last user may be a thread of its own.
  std::shared_ptr<deploy::DeploymentService> shared(std::unique_ptr<deploy::DeploymentService> service);
  /// Connects to the process and checks its identity.
  Result<void> open(const RecordPtr& record, TimePoint deadline);
  void listen_to(const RecordPtr& record, deploy::DeploymentService& service);
  Result<RecordPtr> deployed(const model::DeploymentKey& key) const;
  /// Ends a process by `how` and removes it from the tables.
  Result<void> end_by(const RecordPtr& record,
                      const std::function<Result<process_server::ExitReason>()>& how);
  static Result<void> check_empty(const ProcessView& view);
  void send_expectations(deploy::DeploymentService& service, const model::DeploymentKey& key);

  void poll_processes(const std::vector<RecordPtr>& records);
  void run_polls(const RecordPtr& record);
  std::shared_ptr<const deploy::Snapshot> fetch_snapshot(const RecordPtr& record);
  /// Connects again after the connection broke; false where that fails or the process has ended.
  bool reconnect(const RecordPtr& record);
  bool runs(const ProcessRecord& record);
  void on_disconnected(const std::weak_ptr<ProcessRecord>& which);
  void on_exit(const process_server::ProcessInfo& process);
  /// Handles the end of a process that ended by itself: reports it and its tasks.
  void handle_end(const RecordPtr& record, const process_server::ExitReason& reason);
  /// Reports a process that was to end, if it had to be killed, or had ended by a defect before.
  void report_defect(const ProcessRecord& record, const process_server::ExitReason& reason);
  /// Removes a process that has ended from the tables and returns its tasks; nothing where that was done
  /// before.
  std::optional<std::vector<model::TaskId>> remove(const RecordPtr& record);
  /// Releases the connection to a process that has ended, and its memory in all other processes.
  void release(const RecordPtr& record);
  void report(const ProcessRecord& record, const ProcessRecord::Change& change);
  void report_all_tasks(const ProcessView& view, std::optional<TaskState> state, const std::string& message);
  void report_task(const model::TaskId& task, TaskState state, std::string message);
  void update_placements(const ProcessRecord& record, std::uint64_t poll, const deploy::Snapshot& snapshot);
  void watch();

  process_server::ProcessService& processes_;
  const Connector connector_;
  const process_server::Launch launch_;
  const DeployedOptions options_;
  const RecordPtr own_;
  concurrent::ThreadPool pool_{"segue-fleet", {64, 12}};
  Events events_{500};
  PlacementTable placements_;

  mutable Mutex mutex_;        ///< protects everything below except the thread
  ConditionVariable changed_;  ///< a process ended, or closed_ was set
  /// The processes without the runtime's own; none of them has ended.
  std::map<model::DeploymentKey, RecordPtr> records_ SEGUE_GUARDED_BY(mutex_);
  std::map<model::DeploymentKey, Starting> starting_ SEGUE_GUARDED_BY(mutex_);
  std::vector<model::Network> expected_ SEGUE_GUARDED_BY(mutex_);  ///< one of each name
  std::function<void()> housekeeping_ SEGUE_GUARDED_BY(mutex_);
  bool closed_ SEGUE_GUARDED_BY(mutex_) = false;
  std::thread watcher_;
};

}  // namespace segue::fleet::detail

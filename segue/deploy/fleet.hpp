// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/deployed_task_host.hpp>
#include <segue/deploy/event_queue.hpp>
#include <segue/deploy/merged_view.hpp>
#include <segue/deploy/placement_table.hpp>
#include <segue/deploy/process_record.hpp>
#include <segue/deploy/worker_pool.hpp>

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <thread>
#include <vector>

namespace segue::deploy::detail {

using RecordPtr = std::shared_ptr<ProcessRecord>;

/// The processes of a robot, the runtime's own among them: starts, finds, watches and looks at them, and
/// knows which task lives where. Thread safe; nothing is locked while a process is called.
class Fleet : public std::enable_shared_from_this<Fleet> {
 public:
  Fleet(DeploymentService& own, process::ProcessService& processes, Connector connector,
        process::Launch launch, const DeployedOptions& options);
  /// Adopts what runs, begins to watch.
  void begin();
  /// Leaves the processes as they are. Nothing of this is called any more when it returns.
  void close();

  Result<void> deploy(const model::Deployment& deployment, TimePoint deadline);
  Result<void> undeploy(const model::DeploymentKey& key, TimePoint deadline);
  /// At once, whatever it holds.
  Result<void> kill(const model::DeploymentKey& key, TimePoint deadline);
  /// Ends all processes but the own one, whatever they hold.
  void end_all(TimePoint deadline);
  /// Tells every process what concerns it, now and when it is deployed.
  void expect(const model::Network& network);

  /// All processes as they are now; those that do not answer in time as they were.
  std::vector<ProcessView> poll();
  MergedView poll_merged();

  [[nodiscard]] RecordPtr find(const model::DeploymentKey& key) const;
  /// The process of that incarnation.
  [[nodiscard]] RecordPtr find(link::Incarnation incarnation) const;
  [[nodiscard]] std::vector<RecordPtr> all() const;
  /// The process in which the incarnation lives that an id means, and its plain id there.
  struct Located {
    RecordPtr record;
    model::TaskId task;
  };
  Result<Located> locate(const model::TaskId& id, Which which = Which::Current) const;
  [[nodiscard]] PlacementTable& placements() { return placements_; }

  [[nodiscard]] WorkerPool& pool() { return pool_; }
  [[nodiscard]] EventQueue& events() { return events_; }
  /// Whom to call in a watch, beside the look: takes off what was left over.
  void set_housekeeping(std::function<void()> work);

 private:
  /// A process on its way in.
  struct Starting {
    std::vector<process::ProcessInfo> exits;  ///< of its name; one may be of whoever had the name before
    [[nodiscard]] std::optional<process::ProcessInfo> exit_of(int pid) const;
  };

  void adopt();
  /// Says what became of it.
  std::string adopt(const process::ProcessInfo& process);
  Result<RecordPtr> start(const model::Deployment& deployment, TimePoint deadline);
  Result<void> connect_when_ready(const RecordPtr& record, TimePoint deadline);
  std::optional<process::ProcessInfo> wait_for_exit_of_starting(const ProcessRecord& record,
                                                                Duration patience);
  /// Connects, and checks who answers.
  Result<void> open(const RecordPtr& record, TimePoint deadline);
  void listen_to(const RecordPtr& record, DeploymentService& service);
  Result<RecordPtr> deployed(const model::DeploymentKey& key) const;
  /// Lets go of it once `how` has ended it.
  Result<void> end_by(const RecordPtr& record, const std::function<Result<process::ExitReason>()>& how);
  static Result<void> check_empty(const ProcessView& view);
  void send_expectations(DeploymentService& service, const model::DeploymentKey& key);

  void poll_processes(const std::vector<RecordPtr>& records);
  void run_polls(const RecordPtr& record);
  std::shared_ptr<const Snapshot> fetch_snapshot(const RecordPtr& record);
  /// After a connection broke: true where there is a new one.
  bool reconnect(const RecordPtr& record);
  bool runs(const ProcessRecord& record);
  void on_disconnected(const std::weak_ptr<ProcessRecord>& which);
  void on_exit(const process::ProcessInfo& process);
  /// It ended by itself.
  void handle_end(const RecordPtr& record, const process::ExitReason& reason);
  /// It has ended: out of the tables. Gives the tasks that went with it; nothing where that is known.
  std::optional<std::vector<model::TaskId>> remove(const RecordPtr& record);
  /// Lets go of a process that is gone, here and in all others.
  void release(const RecordPtr& record);
  void report(const ProcessRecord& record, const ProcessRecord::Change& change);
  void report_all_tasks(const ProcessView& view, std::optional<TaskState> state, const std::string& message);
  void report_task(const model::TaskId& task, TaskState state, std::string message);
  void update_placements(const ProcessRecord& record, std::uint64_t poll, const Snapshot& snapshot);
  void watch();

  process::ProcessService& processes_;
  const Connector connector_;
  const process::Launch launch_;
  const DeployedOptions options_;
  const RecordPtr own_;
  WorkerPool pool_{12, 64};
  EventQueue events_;
  PlacementTable placements_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<model::DeploymentKey, RecordPtr> records_;  ///< the own one aside
  std::map<model::DeploymentKey, Starting> starting_;
  std::vector<model::Network> expected_;
  std::function<void()> housekeeping_;
  bool closed_ = false;
  std::thread watcher_;
};

}  // namespace segue::deploy::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/fleet/commit_coordinator.hpp>
#include <segue/fleet/fleet.hpp>
#include <segue/fleet/remote_connector.hpp>
#include <segue/model/transition.hpp>
#include <segue/task_host/split_batch.hpp>

#include <map>
#include <memory>
#include <vector>

namespace segue::fleet::detail {

/// Whether the link that a network insists on can carry a connection between two processes.
Result<void> check_link(const model::Connection& connection, const model::DeploymentKey& from,
                        const model::DeploymentKey& to);

/// Sends every action to the process that has to carry it out, by plain ids: of a task that a transition
/// moves, Recover, Stop, Cleanup and Disconnect mean the present incarnation, all others the new one where
/// there is one. Thread safe.
class ActionDispatcher {
 public:
  ActionDispatcher(Fleet& fleet, RemoteConnector& connector, CommitCoordinator& commits)
      : fleet_(fleet), connector_(connector), commits_(commits) {}

  /// Begins actions that do not depend on each other: one message for each process, all processes at the same
  /// time; `completed` as TaskHost::begin_all says. Those that need a process which stops answering fail then
  /// as DeadlineExceeded, since a transition replaces it; not those of the runtime's own process, which
  /// none can replace.
  void begin(std::vector<model::Action> actions, TimePoint deadline, task_host::Completion completed);
  void conclude(const model::Transition& transition);
  void withdraw();

 private:
  using Indices = task_host::SplitBatch::Indices;

  /// A hand-over of state from a task of one process to a task of another.
  struct HandOver {
    std::size_t index = 0;
    Fleet::Located from;
    Fleet::Located to;
  };

  /// The actions of a batch, divided by the place where each is carried out.
  struct Plan {
    std::map<RecordPtr, Indices> at_process;
    Indices processes;  ///< deploy, undeploy
    std::vector<RemoteConnection> connect;
    Indices connect_indices;
    std::vector<RemoteConnection> disconnect;
    Indices disconnect_indices;
    std::vector<HandOver> hand_overs;
    std::vector<task_host::Completed> refused;

    /// The actions that need an answer of a process, other than to begin or to end.
    [[nodiscard]] std::map<RecordPtr, Indices> by_process() const;
  };
  /// An action at a silent process may end twice.
  struct Batch : task_host::SplitBatch {
    Batch(std::vector<model::Action> all, TimePoint until, task_host::Completion completed, Plan placed)
        : SplitBatch(std::move(all), std::move(completed)), deadline(until), plan(std::move(placed)) {}

    const TimePoint deadline;
    const Plan plan;
    std::vector<SilenceWatch> watches;
  };
  using BatchPtr = std::shared_ptr<Batch>;

  Plan plan(const std::vector<model::Action>& actions) const;
  Result<void> place(std::size_t index, const model::Action& action, Plan& plan) const;
  Result<void> place_connection(std::size_t index, const model::Action& action, Plan& plan) const;
  Result<void> place_hand_over(std::size_t index, const model::HandOverAction& what, Plan& plan) const;
  static Result<void> hand_over(const HandOver& what, TimePoint deadline);
  Result<void> place_config(std::size_t index, const model::ConfigAction& what, Plan& plan) const;
  static void watch_silence(const BatchPtr& batch);
  void begin_at(const RecordPtr& record, const Indices& indices, const BatchPtr& batch);
  /// Begins the actions that block, on threads of the fleet: processes that begin or end, hand-overs and
  /// connections between processes.
  void begin_blocking(const BatchPtr& batch);
  void begin_connections(const BatchPtr& batch);
  Result<void> perform_on_process(const model::Action& action, TimePoint deadline);
  void note_placement(const model::Action& action, const RecordPtr& record, const Result<void>& outcome);

  Fleet& fleet_;
  RemoteConnector& connector_;
  CommitCoordinator& commits_;
};

}  // namespace segue::fleet::detail

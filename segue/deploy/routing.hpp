// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/fleet.hpp>
#include <segue/deploy/remote_connector.hpp>
#include <segue/host/batch_outcomes.hpp>
#include <segue/model/transition.hpp>

#include <map>
#include <span>
#include <vector>

namespace segue::deploy::detail {

/// Whether the link that a network insists on can carry a connection between two processes.
Result<void> check_link(const model::Connection& connection, const model::DeploymentKey& from,
                        const model::DeploymentKey& to);

/// Sends every action to where it has to be carried out, by plain ids: of a task that a transition moves,
/// Recover, Stop, Cleanup and Disconnect mean the incarnation that stands, all others the new one where there
/// is one. Thread safe.
class Router {
 public:
  Router(Fleet& fleet, RemoteConnector& connector) : fleet_(fleet), connector_(connector) {}

  /// Actions that do not depend on each other: what goes to one process goes as one message, all processes
  /// side by side; each tells what has ended as TaskHost::perform_all says. Returns when all are told.
  void perform(std::span<const model::Action> actions, TimePoint deadline, const host::Completion& completed);
  void conclude(const model::Transition& transition);
  void withdraw();

 private:
  using Outcomes = std::shared_ptr<host::BatchOutcomes>;
  using Services = std::vector<std::shared_ptr<DeploymentService>>;
  using Indices = std::vector<std::size_t>;

  /// From a task of one process to one of another.
  struct HandOver {
    std::size_t index = 0;
    Fleet::Located from;
    Fleet::Located to;
  };

  /// Who has to do what.
  struct Plan {
    std::map<RecordPtr, Indices> at_process;
    Indices processes;  ///< deploy, undeploy
    std::vector<RemoteConnection> connect;
    Indices connect_indices;
    std::vector<RemoteConnection> disconnect;
    Indices disconnect_indices;
    std::vector<HandOver> hand_overs;
  };

  Plan plan(std::span<const model::Action> actions, const Outcomes& outcomes) const;
  Result<void> place(std::size_t index, const model::Action& action, Plan& plan) const;
  Result<void> place_connection(std::size_t index, const model::Action& action, Plan& plan) const;
  Result<void> place_hand_over(std::size_t index, const model::HandOverAction& what, Plan& plan) const;
  static Result<void> hand_over(const HandOver& what, TimePoint deadline);
  Result<void> place_config(std::size_t index, const model::ConfigAction& what, Plan& plan) const;
  /// What blocks: processes that begin or end, and connections between processes.
  std::vector<WorkerPool::Job> blocking(const Plan& plan, std::span<const model::Action> actions,
                                        TimePoint deadline, const Outcomes& outcomes);
  Result<void> perform_on_process(const model::Action& action, TimePoint deadline);
  /// Gives the service, which must live until all of it are told.
  std::shared_ptr<DeploymentService> begin_at(const RecordPtr& record, const Indices& indices,
                                              std::span<const model::Action> actions, TimePoint deadline,
                                              const Outcomes& outcomes);
  void note_placement(const model::Action& action, const RecordPtr& record, const Result<void>& outcome);

  Fleet& fleet_;
  RemoteConnector& connector_;
};

}  // namespace segue::deploy::detail

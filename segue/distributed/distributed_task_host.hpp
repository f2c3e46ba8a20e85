// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/distributed/gateways.hpp>
#include <segue/distributed/host_link.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/model/component_model.hpp>
#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_forwarder.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace segue::distributed {

struct DistributedOptions {
  /// The runtime that commands the robot, and the way processes are started on other hosts.
  RobotRequest request;
  GatewaySettings gateways;
  /// Components are simulated where a host has no library for them; their samples carry no values.
  bool stand_in = false;
  /// All components are simulated.
  bool only_stand_ins = false;
  /// Period in which leases are renewed, clocks measured and lost hosts looked for.
  Duration watch = std::chrono::seconds(1);
  /// How long a host may take to be connected.
  Duration patience = std::chrono::seconds(4);
  /// How long a host that has voted for a commit waits for it.
  Duration promise = std::chrono::seconds(2);
  /// Measures promises to commit on the runtime's computer; outlives the host.
  const Clock* clock = &RealClock::instance();
};

/// One TaskHost over the deployments of a robot on several computers: the runtime's own and those of daemons.
///
/// A phase sends each host one message, unless it has to wait for something that happens on another host:
/// hosts carry out their actions in their partial order by themselves. All hosts prepare a transition; its
/// commit takes two rounds: each host that takes part promises to commit within a time limit, and then all
/// are told to. A host that does not promise, or promises too late, keeps all of them from committing. One
/// that falls silent in between may have committed or not: commit() fails, and once the host is back,
/// observe() shows what it did.
///
/// A host that says that another runtime has got the robot since speaks for all of them: the robot is lost,
/// for good. Leases on other hosts are given up, no host is asked again, and loss() says why.
///
/// While a host cannot be reached, observe() lacks what is there, and tasks() has what was known last, marked
/// as unknown. Actions there fail with Unavailable; so do those of a transition during which the connection
/// to a host was lost and made anew, since that host has given up the transition.
class DistributedTaskHost final : public task_host::TaskForwarder<task_host::TaskHost> {
 public:
  /// `own` is the part on the runtime's computer. It and `catalog` must outlive this. Connects to all hosts;
  /// those that cannot be reached are looked for from then on. Blocks for the options' patience at most.
  DistributedTaskHost(fleet::DeployedTaskHost& own, std::vector<HostPlace> hosts,
                      const model::ComponentCatalog& catalog, DistributedOptions options);
  /// Gives up the leases; processes run on.
  ~DistributedTaskHost() override;

  /// AlreadyExists where another runtime has the robot on a host; Superseded where it is lost. Other hosts
  /// that cannot be reached are not an error.
  [[nodiscard]] Result<void> commands_all() const;
  /// When the hosts that refuse were asked last: the earliest of these times. Nothing where none refuses.
  [[nodiscard]] std::optional<TimePoint> refused_at() const;
  /// Ends the robot's processes on all hosts that can be reached, whatever they hold. Blocks until then.
  void end_processes(TimePoint deadline);

  [[nodiscard]] bool stands_in(const model::ComponentName& component) const override;
  Result<void> can_make(const model::ComponentName& component) const override;
  /// Refuses unknown hosts, components that their host does not offer, component libraries that differ
  /// between hosts, and links that do not lead from host to host.
  [[nodiscard]] Diagnostics check(const model::Network& network) const override;
  void expect(const model::Network& target) override;
  void begin_transition(const model::Network& before, const model::Network& target) override;
  /// Waits until the senders of `target` have found their receivers.
  void get_ready(const model::Network& target) override;
  Result<void> arm_commit(const model::Transition& transition, TimePoint deadline) override;
  Result<void> commit() override;
  [[nodiscard]] bool side_by_side() const override { return true; }
  void conclude(const model::Transition& transition) override;
  void withdraw() override;
  [[nodiscard]] std::vector<task_host::ComputerReport> computers() const override;
  [[nodiscard]] std::optional<Error> loss() const override;
  [[nodiscard]] model::Network expanded(model::Network network) const override;
  [[nodiscard]] model::Network condensed(model::Network network) const override;

  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override;
  void perform_in_order(std::vector<model::Action> actions, Duration action_deadline,
                        const task_host::EarlyEnd& early_end, task_host::Completion completed) override;
  [[nodiscard]] model::Network observe() const override;
  [[nodiscard]] std::vector<task_host::TaskReport> tasks() const override;
  [[nodiscard]] View snapshot() const override;
  [[nodiscard]] std::vector<task_host::ConnectionReport> connections() const override;
  void set_listener(Listener listener) override;

 protected:
  [[nodiscard]] Result<task_host::TaskPlace> find_place(const model::TaskId& task,
                                                        task_host::Purpose purpose) const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::distributed

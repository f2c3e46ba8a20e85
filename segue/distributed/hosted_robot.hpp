// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/fleet/deployed_task_host.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/task_host/task_access.hpp>
#include <segue/task_host/task_host.hpp>

#include <cstdint>
#include <vector>

/// Robots on several computers: what the daemon of a computer offers, and one TaskHost over all of them.
namespace segue::distributed {

/// Everything of a robot that a host holds at one moment.
using HostView = fleet::DeployedTaskHost::View;

/// A task that carries samples between hosts, and how many of the others it has to find.
struct LinkWait {
  model::TaskId task;
  int count = 0;
  friend bool operator==(const LinkWait&, const LinkWait&) = default;
};

/// A robot's deployments on one host, for the runtime that commands them. The network functions get the part
/// of a network that is on this host: its deployments, their tasks, and connections among these. Transitions
/// proceed as TaskHost says; here every step has an answer. Once another runtime has got the robot, every
/// function answers Superseded and does nothing; after release(), Unavailable. Thread safe.
class HostedRobot : public task_host::TaskAccess {
 public:
  /// Extends the lease. The host gives the robot to another runtime when it has not been extended for as long
  /// as Lease::kValidity.
  virtual Result<void> renew() = 0;
  /// Ends the lease: another runtime may command the robot at once. Processes run on.
  virtual Result<void> release() = 0;

  virtual Result<HostView> snapshot() = 0;
  virtual Result<void> expect(const model::Network& target) = 0;
  /// Begins a transition. Does not wait for the host, which carries out later calls after this one.
  virtual Result<void> begin_transition(const model::Network& before, const model::Network& target) = 0;
  /// Begins to carry out actions in their partial order, and returns without waiting; `completed` as
  /// TaskHost::perform_in_order says, but it may be called by several threads at the same time.
  virtual void begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                              task_host::Completion completed) = 0;
  /// Lets no further action of begin_in_order() begin. Does not block.
  virtual void begin_no_more() = 0;
  /// Makes the host ready for `target`, and waits until all `links` have found their counterparts on other
  /// hosts, until `deadline` at most; DeadlineExceeded where one has not.
  virtual Result<void> get_ready(const model::Network& target, const std::vector<LinkWait>& links,
                                 TimePoint deadline) = 0;
  /// Arms the host for `transition`, which has the actions of this host only; `number` names it in vote() and
  /// commit().
  virtual Result<void> arm_commit(const model::Transition& transition, std::uint64_t number,
                                  TimePoint deadline) = 0;
  /// Whether the host can commit transition `number` now. If so, it promises to do so whenever commit()
  /// arrives within `validity` from now on its own clock, and refuses a later one.
  virtual Result<void> vote(std::uint64_t number, Duration validity) = 0;
  /// Commits: connections begin and end. InvalidState where the host has not promised, or not for this
  /// transition, or the promise is too old: nothing has changed then.
  virtual Result<void> commit(std::uint64_t number) = 0;
  virtual Result<void> conclude(const model::Transition& transition) = 0;
  virtual Result<void> withdraw() = 0;
  /// Ends all processes of the robot on this host, whatever they hold.
  virtual Result<void> end_processes(TimePoint deadline) = 0;

  /// Called from any thread; must not block. When this returns, the former listener is not being called.
  virtual void set_listener(task_host::TaskHost::Listener listener) = 0;
};

}  // namespace segue::distributed

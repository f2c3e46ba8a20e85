// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/model/network.hpp>
#include <segue/task_host/reports.hpp>
#include <segue/task_host/task_access.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace segue::model {
struct Transition;
}

/// Creates tasks, moves them through their life cycle and observes them.
namespace segue::task_host {

struct EarlyEnd;

/// The tasks of a robot: carries out transitions on them and reports their states. All functions may be
/// called from any thread.
class TaskHost : public TaskAccess {
 public:
  /// Whether tasks of this component are stand-ins here (model::StandsIn), or its code is there without a
  /// model among stand-ins.
  [[nodiscard]] virtual bool stands_in(const model::ComponentName& component) const;
  /// Whether tasks of this component can be made here; NotFound with what to install where not.
  virtual Result<void> can_make(const model::ComponentName& component) const;
  /// Other reasons why a network cannot run here, such as tasks on computers that cannot be reached or links
  /// that cannot carry a connection.
  [[nodiscard]] virtual Diagnostics check(const model::Network& network) const;
  /// Announces the target of a transition before its first action. May prepare for it, but does not change
  /// what runs.
  virtual void expect(const model::Network& target);
  /// A transition from `before`, as it was observed, to `target` begins; includes expect(). Until conclude()
  /// or withdraw(), actions that take down mean the tasks of `before`: one that has ended since is not found,
  /// whatever the transition creates under its id. Where `target` places a task in a process that holds a
  /// leftover incarnation of it, actions that create and start mean that one.
  virtual void begin_transition(const model::Network& before, const model::Network& target);
  /// Called when all actions before the commit to `target` are done. Does ahead of time what later actions
  /// would otherwise have to do, without changing what runs. Failures are found again by those actions.
  virtual void get_ready(const model::Network& target);
  /// Called when all actions of Prepare are done. From commit() on, connections that actions of Prepare have
  /// made carry samples, and those that actions of Retire disconnect carry none any more; not before. With
  /// Order::Paper nothing waits for commit(). An error: the transition cannot commit.
  virtual Result<void> arm_commit(const model::Transition& transition, TimePoint deadline);
  /// All actions of Commit are done. Connections begin and end, all at the same instant of a computer. An
  /// error: they have not, or not on all computers; what runs then must be observed.
  virtual Result<void> commit();
  /// Whether a task that moves to another process can be created there while its old incarnation still runs.
  [[nodiscard]] virtual bool side_by_side() const { return false; }
  /// All actions of the transition are done. From now on plain ids denote the new incarnations. Removed tasks
  /// and replaced incarnations are destroyed (their processes stay); tasks that the transition redefines get
  /// their new definitions.
  virtual void conclude(const model::Transition& transition);
  /// The transition is given up, before commit(): what would have begun with that is removed. Plain ids
  /// denote the previous incarnations again; new ones remain, under their full ids, until they are removed.
  virtual void withdraw();

  /// The computers of the robot, where it has others than the runtime's own.
  [[nodiscard]] virtual std::vector<ComputerReport> computers() const;
  /// Why the robot is lost, for good: another runtime commands it on other computers. Tasks on this one can
  /// still be brought to rest. Nothing: it is not lost.
  [[nodiscard]] virtual std::optional<Error> loss() const { return std::nullopt; }
  /// A network as it runs here: with the tasks that carry samples between computers, which observe() shows,
  /// too. condensed() is the reverse. Both leave other networks as they are.
  [[nodiscard]] virtual model::Network expanded(model::Network network) const;
  [[nodiscard]] virtual model::Network condensed(model::Network network) const;

  /// Carries out one action and waits for its end. The result of CallOperation is dropped; call() returns it.
  /// DeadlineExceeded: the true state must be observed.
  Result<void> perform(const model::Action& action, Deadline deadline);

  /// Carries out actions in their partial order: each begins once those of `actions` that its `after` names
  /// are done; others count as done. Blocks until each was reported, once, by `completed`, which may be
  /// called from any thread and must not block. The first failure, or `early_end`,
  /// lets nothing new begin. `action_deadline` is for each action, from its begin; one that has not ended by
  /// then counts by what is observed of it. One that is left in progress is reported as if it had not begun;
  /// how it ends must be observed.
  virtual void perform_in_order(std::vector<model::Action> actions, Duration action_deadline,
                                const EarlyEnd& early_end, Completion completed);

  /// The network that actually runs: every configured or named task with its actual state, properties and
  /// placement, every connection, every deployment.
  [[nodiscard]] virtual model::Network observe() const = 0;

  [[nodiscard]] virtual std::vector<TaskReport> tasks() const = 0;
  /// observe(), tasks() and connections() at once, for which each process is asked once.
  struct View {
    model::Network network;
    std::vector<TaskReport> tasks;
    std::vector<ConnectionReport> connections;
  };
  [[nodiscard]] virtual View snapshot() const;
  [[nodiscard]] virtual std::vector<ConnectionReport> connections() const = 0;

  /// Called from any thread when a task changes its state or a process ends other than by an action; must not
  /// block. When set_listener returns, no call of the previous listener is in progress.
  using Listener = std::function<void(const HostEvent&)>;
  virtual void set_listener(Listener listener) = 0;
};

}  // namespace segue::task_host

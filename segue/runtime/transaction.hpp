// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/network_parts.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/transition_execution.hpp>
#include <segue/task_host/task_host.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

namespace segue::runtime::detail {

/// The host on which transitions are executed, the components it has, and the log of events.
struct TransitionContext {
  task_host::TaskHost& host;
  const model::ComponentCatalog& catalog;
  EventLog& log;
};

/// Executes a transition atomically: prepare, commit and retire, or back to the old network.
///
/// A failure in prepare or commit is undone: the solver computes a transition from the observed network back
/// to the old one, which leaves untouched parts alone. If that fails too, the fallback network is tried. Two
/// kinds of failures are not undone. If an action of commit fails that only takes something down (a task that
/// will not stop would block every later switch as well), the solver replans once from the observed network
/// to the target. And if an action of retire fails, the new network runs already; leftovers are reported.
class Transaction {
 public:
  struct Options {
    Duration action_deadline{0};
    std::optional<model::Network> fallback;  ///< tried if the old network cannot be restored
    /// Called before each commit, also of what undoes; must not block.
    std::function<void(const model::Transition&)> before_commit{};
    /// Called once the transition has been committed, not for what undoes, before anything is retired.
    std::function<void()> committed{};
    std::shared_ptr<LeftActions> left{};  ///< gets what is in progress when it makes way; not null
  };

  /// `before` is the network that runs now. References must outlive this.
  Transaction(const TransitionContext& context, const model::Network& before, const SwitchPlan& plan,
              Options options);

  /// Blocks; to be called once. Fills in outcome, times, actions, undo and error. Whatever the outcome, the
  /// caller has to observe the host afterwards to know what runs.
  void run(SwitchResult& result);

  /// A newer request waits: prepare ends early as superseded and leaves what it has created, retire ends
  /// early and leaves the rest, commit is finished. From any thread; does not block.
  void supersede();
  /// Ends early as supersede() does, and what prepare has in progress is only waited for where it concerns
  /// what runs or `wanted`, the parts of the network that comes next: a task of neither may take as long as
  /// it likes.
  void make_way(NetworkParts wanted);
  /// The robot is to come to rest: so does retire, and an undo, too, ends early and leaves the rest.
  void make_way_to_rest(NetworkParts rest);
  /// The runtime ends: no further action begins and nothing is undone. From any thread; does not block.
  void abandon();
  /// Before the point of commit: no further action begins, and what was done is undone as after a failure.
  /// Returns who cancelled it, which may have been somebody else before. InvalidState where it goes on:
  /// behind that point it completes, and what fails or was superseded ends by itself. From any thread; does
  /// not block.
  Result<std::string> cancel(const std::string& who);

  /// Committed: the point of commit is passed, nothing of Retire has begun.
  enum class Stage { Prepare, Commit, Committed, Retire, Undo };
  [[nodiscard]] Stage stage() const;

 private:
  void leave_all_but(NetworkParts needed) SEGUE_REQUIRES(mutex_);
  /// Begins a stage; false if the transaction was abandoned, cancelled or superseded.
  bool enter(Stage stage);
  /// From here on it cannot be cancelled; false if it was before.
  bool pass_point_of_commit();
  /// From here on it cannot be cancelled; who did before.
  std::optional<std::string> enter_undo();
  std::shared_ptr<Execution> begin(const model::Transition& transition);
  /// Why a transition was not committed.
  struct Failure {
    std::string what;  ///< "'start a' failed"
    Error error;
    bool took_down = false;  ///< an action of commit failed that only takes something down
  };
  void forward(SwitchResult& result);
  /// Between prepare and commit; an error where the transition cannot commit.
  Result<void> arm(const model::Transition& transition, const model::Network& target);
  [[nodiscard]] static std::optional<Failure> failure_of(const Execution& execution,
                                                         const Result<void>& armed,
                                                         const Result<void>& stored);
  void retire(Execution& execution, SwitchResult& result);
  void go_back(const std::optional<Failure>& failed, SwitchResult& result);
  /// Solves again after an action failed that takes something down; true if that led to the target.
  bool replan(const Failure& failed, SwitchResult& result);
  void end_early(SwitchResult& result);
  /// `why` for the log. The stage is Undo.
  Undo undo(const std::string& why);
  /// The network that runs now, without computers that are lost, or were lost at any time since the
  /// transition was planned: their tasks were not part of it, or they have given them up. The runtime looks
  /// after these computers when the transition has ended.
  struct Observed {
    model::Network network;
    std::set<model::HostName> lost;
  };
  [[nodiscard]] Observed observe() const;
  [[nodiscard]] std::set<model::HostName> lost_meanwhile() const;
  /// Solves from the observed network to what of `whole` can be reached and executes that; appends to
  /// `actions`.
  std::optional<Error> bring_to(const model::Network& whole, std::vector<ActionRecord>& actions);
  void on_event(const ActionRecord& record);

  const TransitionContext& context_;
  const model::Network before_;  ///< without leftover incarnations
  const SwitchPlan& plan_;
  const Options options_;
  const std::map<model::HostName, std::uint64_t> connections_;  ///< to computers, when it began
  TimePoint started_{};                                         ///< of run()
  mutable Mutex mutex_;  ///< protects all members below; actions run without it
  std::shared_ptr<Execution> execution_ SEGUE_GUARDED_BY(mutex_);
  Stage stage_ SEGUE_GUARDED_BY(mutex_) = Stage::Prepare;
  bool superseded_ SEGUE_GUARDED_BY(mutex_) = false;
  bool rests_ SEGUE_GUARDED_BY(mutex_) = false;  ///< the robot is to come to rest
  bool abandoned_ SEGUE_GUARDED_BY(mutex_) = false;
  std::optional<std::string> cancelled_by_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/execution.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/runtime.hpp>

#include <memory>
#include <mutex>
#include <optional>

namespace segue::runtime::detail {

/// What transitions are carried out on.
struct Ground {
  host::TaskHost& host;
  const model::ComponentCatalog& catalog;
  EventLog& log;
};

/// A transition as a whole: prepare, commit and retire, or back to what ran before.
///
/// A failure in prepare or commit is undone: from what truly runs then, the solver finds the way back, which
/// leaves alone what had not been touched. Where that fails too, the fallback network is tried. Two failures
/// are not undone. One in commit that concerns only what was to be taken down (a task that fails to stop has
/// stopped all the same; back, it would be in the way for ever): the solver finds another way on from what
/// runs, once. And one in retire: the new network runs; what is left over is told.
class Transaction {
 public:
  struct Options {
    Duration action_deadline{0};
    std::optional<model::Network> fallback;  ///< nothing: none
  };

  /// `before` is what runs. References must outlive this.
  Transaction(const Ground& ground, const model::Network& before, const Plan& plan, Options options);

  /// Blocks; called once. Fills in outcome, times, actions, what was undone and the error. Afterwards, what
  /// runs has to be looked at, whatever the outcome.
  void run(SwitchResult& result);

  /// From any thread, at any time: a newer request waits. Prepare ends early, as superseded, and leaves what
  /// it made; retire ends early and leaves what is left; a commit goes on to its end.
  void give_way();
  /// From any thread: no further action begins, nothing is undone.
  void cancel();

 private:
  enum class Stage { Prepare, Commit, Retire, Back };

  /// False where nothing further is to begin.
  bool enter(Stage stage);
  std::shared_ptr<Execution> begin(const model::Transition& transition);
  void forward(SwitchResult& result);
  void retire(Execution& execution, SwitchResult& result);
  /// Whether another way led to the target after all.
  bool find_another_way(const ActionRecord& failed, SwitchResult& result);
  void end_early(SwitchResult& result);
  Undo go_back(const ActionRecord& failed);
  /// Brings the robot to `target` from whatever runs; appends what was done to `actions`.
  std::optional<Error> bring_to(const model::Network& target, std::vector<ActionRecord>& actions);
  void on_action(const ActionRecord& record);

  const Ground& ground_;
  const model::Network& before_;
  const Plan& plan_;
  const Options options_;
  std::mutex mutex_;
  std::shared_ptr<Execution> execution_;
  Stage stage_ = Stage::Prepare;
  bool giving_way_ = false;
  bool cancelled_ = false;
};

}  // namespace segue::runtime::detail
